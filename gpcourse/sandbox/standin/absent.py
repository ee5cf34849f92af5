"""Stands for the reference solutions, which are not there while a notebook is graded."""

from __future__ import annotations

from importlib import import_module
from typing import Any


class ReferenceIsAbsent(RuntimeError):
    """A function called a reference solution."""


class Absent:
    """A reference solution that is not there."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __call__(self, *_: object, **__: object) -> Any:
        name = self._name
        raise ReferenceIsAbsent(
            f"reference.{name} is not there while a notebook is graded; call your own {name}"
        )


def __getattr__(name: str) -> Any:
    if name.startswith("_"):
        raise AttributeError(name)
    if "__path__" in globals():  # the package: a chapter's module is there, empty
        return import_module(f"{__name__}.{name}")
    return Absent(name)
