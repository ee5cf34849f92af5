"""Turn what a layer is given into arrays, numbers and colours, or say what is wrong with it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from gpcourse.errors import ArrayError
from gpcourse.geometry.arrays import FloatArray, as_points
from gpcourse.view.colours import as_colour, as_colour_map


def as_vector(value: object, name: str, *, allow_zero: bool = False) -> tuple[float, float, float]:
    """Return three finite floats, not all zero unless `allow_zero`; ArrayError otherwise."""
    x, y, z = as_points([value], name)[0].tolist()
    if not allow_zero and x == y == z == 0:
        raise ArrayError(f"{name} is zero; it needs a length")
    return (x, y, z)


def as_positions(value: object, name: str) -> FloatArray:
    """Return finite (n, 3) points; an empty list, as JSON has it, is no point."""
    return np.zeros((0, 3)) if isinstance(value, (list, tuple)) and not len(value) else as_points(value, name)


def set_fields(layer: object, **values: object) -> None:
    for name, value in values.items():
        object.__setattr__(layer, name, value)


def set_values(layer: Any, count: int) -> None:
    if layer.values is not None:
        set_fields(layer, values=as_values(layer.values, count))
    if layer.colour_map is not None:
        as_colour_map(layer.colour_map)
    if layer.limits is not None:
        set_fields(layer, limits=as_limits(layer.limits))


def as_values(value: object, count: int) -> FloatArray:
    """Return `count` floats; what is beyond 1e300 counts as infinite, so that differences are finite."""
    if hasattr(value, "toarray"):
        raise ArrayError("values is a sparse matrix; give an array, as values.toarray().ravel()")
    try:
        numbers = np.asarray(value)
        values = numbers.astype(np.float64) if numbers.dtype.kind != "c" else None
    except (TypeError, ValueError):
        raise ArrayError("values cannot be read as numbers; give one number per vertex or face") from None
    if values is None:
        raise ArrayError("values holds complex numbers; give their real part, or their absolute value")
    if values.shape != (count,):
        flat = ", as values.ravel()" if values.size == count else ""
        raise ArrayError(f"values has shape {values.shape}; give {count} numbers{flat or ', one for each'}")
    return np.where(np.abs(values) > 1e300, np.inf, values)


def as_limits(value: object) -> tuple[float, float]:
    try:
        low, high = (float(x) for x in value)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise ArrayError(f"limits is {value!r}; give (low, high)") from None
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise ArrayError(f"limits is ({low}, {high}); give finite numbers with low < high")
    return low, high


def as_texts(value: object, count: int) -> tuple[str, ...]:
    texts = tuple(str(text) for text in value) if isinstance(value, Iterable) else ()
    if isinstance(value, str) or len(texts) not in (0, count):
        raise ArrayError(f"there are {len(texts)} texts for {count} places; give one for each")
    return texts


def as_colours(value: object, count: int, name: str) -> tuple[str, ...]:
    many = [value] if isinstance(value, str) or not isinstance(value, Iterable) else list(value)
    if len(many) not in (1, count):
        raise ArrayError(f"{name} has {len(many)} entries; give one, or {count}")
    seen: dict[object, str] = {}
    for i, colour in enumerate(many):
        if colour not in seen:
            seen[colour] = as_colour(colour, f"{name}[{i}]")
    return tuple(seen[colour] for colour in many) * (count if len(many) == 1 else 1)


def check_same_length(rows: FloatArray, name: str, count: int, other: str) -> None:
    if len(rows) != count:
        raise ArrayError(f"{name} has {len(rows)} rows and {other} has {count}; both need one per arrow")


def as_positive(value: object, name: str) -> float:
    if isinstance(value, (int, float, np.number)) and np.isfinite(value) and value > 0:
        return float(value)
    raise ArrayError(f"{name} is {value!r}; it must be a positive number")


def check_hidden(value: object) -> None:
    if value not in ("hide", "fade", "show"):
        raise ArrayError(f"hidden is {value!r}; it must be 'hide', 'fade' or 'show'")


def as_index(value: object, count: int, name: str) -> int:
    """Return an index below `count`; ArrayError otherwise."""
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool) and 0 <= value < count:
        return int(value)
    raise ArrayError(f"{name} is {value!r}; it must be an index from 0 to {count - 1}")
