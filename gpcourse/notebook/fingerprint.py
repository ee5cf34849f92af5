"""Telling whether a function is still the one that was checked."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from types import CodeType, FunctionType
from typing import Any


def fingerprint(function: Callable[..., Any]) -> str:
    """Return a short text that changes with the code of `function` and of the functions that it uses.

    Followed are the functions of the same module (in a notebook: those of its cells). Comments,
    docstrings and line numbers do not count; another version of Python may give another text.
    """
    seen: dict[int, FunctionType] = {}
    waiting = [function] if isinstance(function, FunctionType) else []
    while waiting:
        current = waiting.pop()
        if id(current) not in seen:
            seen[id(current)] = current
            waiting.extend(_used(current))
    digest = hashlib.sha256()
    for each in seen.values():
        parts = (each.__name__, repr(each.__defaults__), *_parts(each.__code__))
        digest.update(repr(parts).encode("utf-8", "replace"))
    return digest.hexdigest()[:32]


def _used(function: FunctionType) -> Iterator[FunctionType]:
    for name in _names(function.__code__):
        value = function.__globals__.get(name)
        if isinstance(value, FunctionType) and value.__module__ == function.__module__:
            yield value


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


def _parts(code: CodeType) -> Iterator[object]:
    yield code.co_code
    yield code.co_names
    yield code.co_varnames
    for i, constant in enumerate(code.co_consts):
        if isinstance(constant, CodeType):
            yield tuple(_parts(constant))
        elif i > 0 or not isinstance(constant, str):  # the first text is the docstring
            yield repr(constant)
