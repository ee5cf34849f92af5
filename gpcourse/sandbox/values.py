"""Comparing the values that functions take and give."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, cast

import numpy as np

_PLAIN = (int, float, str, bool)


def same(a: object, b: object, tolerance: float = 0.0) -> bool:
    """Tell whether two values are equal in structure and, to within `tolerance`, in their numbers.

    Lists, tuples and arrays of the same shape and numbers are the same; so are sparse and dense
    matrices. `tolerance` is relative to the largest number of `a`. NaN equals NaN.
    """
    if a is b or _plainly_same(a, b):
        return True
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(same(a[k], b[k], tolerance) for k in a)
    if is_dataclass(a) and is_dataclass(b):
        return type(a) is type(b) and all(
            same(getattr(a, f.name), getattr(b, f.name), tolerance) for f in fields(a)
        )
    if isinstance(a, (str, bytes, type(None))) or isinstance(b, (str, bytes, type(None))):
        return type(a) is type(b) and a == b
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)) and not _numeric(a):
        return len(a) == len(b) and all(same(x, y, tolerance) for x, y in zip(a, b, strict=True))
    return _same_numbers(a, b, tolerance)


def _plainly_same(a: object, b: object) -> bool:
    """Tell quickly that two arrays, or lists of Python's numbers and strings, are equal; else False."""
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.dtype == b.dtype and a.dtype.kind in "biufc" and a.shape == b.shape and bool((a == b).all())
    if isinstance(a, (list, tuple)):
        return a == b if all(type(item) in _PLAIN for item in (*a, *cast(Any, b))) else False
    return False


def _numeric(value: object) -> bool:
    try:
        return bool(np.asarray(value).dtype.kind in "biufc")
    except ValueError:  # lists of different lengths
        return False


def _dense(value: Any) -> Any:
    return value.toarray() if hasattr(value, "toarray") else value


def _same_numbers(a: object, b: object, tolerance: float) -> bool:
    try:
        x, y = np.asarray(_dense(a)), np.asarray(_dense(b))
    except ValueError:
        return False
    if x.shape != y.shape or x.dtype.kind not in "biufc" or y.dtype.kind not in "biufc":
        return False
    if x.size == 0 or tolerance == 0.0:
        return np.array_equal(x, y, equal_nan=x.dtype.kind in "fc" and y.dtype.kind in "fc")
    finite = np.abs(x[np.isfinite(x)])
    scale = float(finite.max()) if finite.size else 1.0
    return np.allclose(x, y, rtol=0.0, atol=tolerance * scale, equal_nan=True)
