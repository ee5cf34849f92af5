"""A module whose functions do nothing: there is nobody to look while a notebook is graded."""

from __future__ import annotations

from typing import Any


class Silent:
    """Can be called, entered and asked for anything, and does nothing."""

    def __call__(self, *_: object, **__: object) -> Silent:
        return self

    def __getattr__(self, name: str) -> Silent:
        if name.startswith("__"):
            raise AttributeError(name)
        return self

    def __enter__(self) -> Silent:
        return self

    def __exit__(self, *_: object) -> None:
        return None


def __getattr__(name: str) -> Any:
    if name.startswith("__"):
        raise AttributeError(name)
    return Silent()
