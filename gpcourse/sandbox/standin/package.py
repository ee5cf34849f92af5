"""gpcourse, as far as it is there while a notebook is graded: geometry, and names that do nothing."""

from __future__ import annotations

from importlib import import_module
from typing import Any

_MODULES = ("shapes", "off")


def working(function: Any, *_: object, **__: object) -> Any:
    """Return the function itself: while grading there is no solution to go on with."""
    return function


def _nothing(*_: object, **__: object) -> None:
    """Stand for check, hint, solution and progress."""


check = hint = solution = progress = _nothing


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return import_module(f"gpcourse.geometry.{name}")
    if name == "HalfedgeMesh":
        return import_module("gpcourse.geometry.halfedge_mesh").HalfedgeMesh
    if name in ("view", "reference"):
        return import_module(f"gpcourse.{name}")
    raise AttributeError(f"module 'gpcourse' has no attribute {name!r} while a notebook is graded")
