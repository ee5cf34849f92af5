"""Turn what a layer is given into arrays, numbers and colours, or say what is wrong with it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from difflib import get_close_matches
from inspect import signature
from reprlib import repr as short
from typing import Any

import numpy as np

from gpcourse.errors import ArrayError, PictureError
from gpcourse.geometry.arrays import FloatArray, as_points
from gpcourse.view.colours import as_colour, as_colour_map

#: What other libraries call a setting.
_ELSEWHERE = {
    "color": "colour", "colors": "colours", "c": "colour", "cmap": "colour_map", "colormap": "colour_map",
    "clim": "limits", "vmin": "limits", "vmax": "limits", "shading": "smooth", "show_edges": "edges",
    "name": "value_name", "unit": "value_name", "linewidth": "width", "s": "size",
}  # fmt: skip


def check_settings(given: Iterable[str], make: Callable[..., object], call: str) -> None:
    """Raise PictureError if one of the names is no keyword of `make`; `call` is what the user wrote."""
    known = [p.name for p in signature(make).parameters.values() if p.kind is p.KEYWORD_ONLY]
    for name in given:
        if name in known:
            continue
        close = [_ELSEWHERE[name]] if _ELSEWHERE.get(name) in known else get_close_matches(name, known, 1)
        hint = f"did you mean {close[0]}? It" if close else "it"
        raise PictureError(f"{call} has no setting {name!r}; {hint} has {', '.join(known)}")


def as_flag(value: object, name: str) -> bool:
    """Return True or False; ArrayError for all else, since any text counts as true."""
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    raise ArrayError(f"{name} is {short(value)}; it must be True or False")


def as_vector(value: object, name: str, *, allow_zero: bool = False) -> tuple[float, float, float]:
    """Return three finite floats, not all zero unless `allow_zero`; ArrayError otherwise."""
    try:
        given = np.asarray(value)
    except ValueError:
        given = np.zeros(0)
    if given.shape != (3,) or given.dtype.kind not in "fiub" or not np.isfinite(given).all():
        raise ArrayError(f"{name} is {short(value)}; give three finite numbers")
    x, y, z = given.astype(np.float64).tolist()
    largest = max(abs(x), abs(y), abs(z))
    if not allow_zero and largest == 0:
        raise ArrayError(f"{name} is zero; it needs a length")
    if not allow_zero and not 1e-100 < largest < 1e100:  # of a direction no more than that counts
        return (x / largest, y / largest, z / largest)
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
    """Return `count` floats; what is masked is missing, and what is beyond 1e300 counts as infinite.

    So differences of finite ones are finite.
    """
    if hasattr(value, "toarray"):
        raise ArrayError("values is a sparse matrix; give an array, as values.toarray().ravel()")
    try:
        hidden = np.ma.getmaskarray(value) if isinstance(value, np.ma.MaskedArray) else False
        numbers = np.asarray(value)
        values = numbers.astype(np.float64) if numbers.dtype.kind != "c" else None
    except (TypeError, ValueError, OverflowError):
        raise ArrayError("values cannot be read as numbers; give one number per vertex or face") from None
    if values is None:
        raise ArrayError("values holds complex numbers; give their real part, or their absolute value")
    if values.shape != (count,):
        flat = ", as values.ravel()" if values.size == count else ""
        raise ArrayError(f"values has shape {values.shape}; give {count} numbers{flat or ', one for each'}")
    return np.where(hidden, np.nan, np.where(np.abs(values) > 1e300, np.inf, values))


def as_limits(value: object) -> tuple[float, float]:
    try:
        low, high = (float(x) for x in value)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise ArrayError(f"limits is {short(value)}; give (low, high)") from None
    if not (-1e300 <= low < high <= 1e300):
        raise ArrayError(f"limits is ({low}, {high}); give finite numbers with low < high")
    return low, high


def as_text(value: object) -> str:
    return "" if value is None else str(value)


def as_texts(value: object, count: int, *, exactly: bool = False) -> tuple[str, ...]:
    """Return `count` texts; none at all will do unless `exactly`."""
    texts = tuple(str(text) for text in value) if isinstance(value, Iterable) else ()
    if isinstance(value, str) or len(texts) not in ((count,) if exactly else (0, count)):
        raise ArrayError(f"there are {len(texts)} texts for {count} places; give one for each")
    return texts


def as_hex(value: Any, name: str) -> list[str]:
    """Return the rows of an (n, 3) array of red, green and blue, 0 to 1, as ``#rrggbb``."""
    if value.dtype.kind not in "fiub" or value.shape[1] != 3:
        raise ArrayError(
            f"{name} is an array of shape {value.shape} and type {value.dtype}; "
            "give names, or rows of red, green, blue from 0 to 1"
        )
    outside = np.flatnonzero(~((value >= 0) & (value <= 1)).all(axis=1))
    if len(outside):
        i = int(outside[0])
        raise ArrayError(f"{name}[{i}] is {value[i]}; give red, green, blue from 0 to 1 each")
    return ["#" + "".join(f"{c:02x}" for c in row) for row in np.rint(255 * value).astype(int).tolist()]


def as_colours(value: object, count: int, name: str) -> tuple[str, ...]:
    """Return `count` colours, from their names or an (n, 3) array; one stands for all."""
    many: list[object]
    many = [value] if isinstance(value, str) or not isinstance(value, Iterable) else list(value)
    if many and not any(isinstance(colour, str) for colour in many):
        try:
            rows = np.asarray(many)
        except ValueError:
            rows = np.zeros(0)
        many = [*as_hex(rows, name)] if rows.ndim == 2 else many
    if len(many) not in (1, count):
        raise ArrayError(f"{name} has {len(many)} entries; give one, or {count}")
    seen: dict[str, str] = {}
    for i, colour in enumerate(many):
        if not isinstance(colour, str) or colour not in seen:
            hexadecimal = as_colour(colour, f"{name}[{i}]")  # refuses what is not a string
            seen[str(colour)] = hexadecimal
    return tuple(seen[str(colour)] for colour in many) * (count if len(many) == 1 else 1)


def check_same_length(rows: FloatArray, name: str, count: int, other: str) -> None:
    if len(rows) != count:
        raise ArrayError(f"{name} has {len(rows)} rows and {other} has {count}; both need one per arrow")


def as_positive(value: object, name: str) -> float:
    if isinstance(value, (int, float, np.number)) and np.isfinite(value) and value > 0:
        return float(value)
    raise ArrayError(f"{name} is {short(value)}; it must be a positive number")


def check_hidden(value: object) -> None:
    if value not in ("hide", "fade", "show"):
        raise ArrayError(f"hidden is {value!r}; it must be 'hide', 'fade' or 'show'")


def as_index(value: object, count: int, name: str) -> int:
    """Return an index below `count`; ArrayError otherwise."""
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool) and 0 <= value < count:
        return int(value)
    raise ArrayError(f"{name} is {short(value)}; it must be an index from 0 to {count - 1}")
