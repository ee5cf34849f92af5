"""gpcourse: a course companion for geometry processing.

The names that a student needs are here::

    from gpcourse import check, hint, solution, progress, shapes, view

They are loaded when they are first used, so that importing the package is quick.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_HOMES = {
    "check": "gpcourse.notebook",
    "hint": "gpcourse.notebook",
    "solution": "gpcourse.notebook",
    "progress": "gpcourse.notebook",
    "working": "gpcourse.notebook",
    "HalfedgeMesh": "gpcourse.geometry.halfedge_mesh",
}
_MODULES = {"shapes": "gpcourse.geometry.shapes", "view": "gpcourse.view"}

__all__ = ["HalfedgeMesh", "check", "hint", "progress", "shapes", "solution", "view", "working"]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    if name in _MODULES:
        return import_module(_MODULES[name])
    raise AttributeError(f"module 'gpcourse' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES, *_MODULES})
