"""What the checks of this chapter expect: matrices and values per vertex, with a picture of what is wrong."""

from __future__ import annotations

from typing import Any

import numpy as np

from gpcourse.exercises import expect
from gpcourse.exercises.smoothing import pictures
from gpcourse.exercises.smoothing.inputs import SINGLE, faces_of
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import BoolArray, FloatArray


def matrix(value: object, truth: FloatArray, what: str = "The matrix", *, on: str = "") -> None:
    """Expect a matrix, sparse or dense, that equals `truth` entry by entry."""
    mine = expect.array(value, truth.shape, what, on=on)
    expect.close(mine, truth, SINGLE * np.abs(truth).max(), what, on=on)


def values(
    value: object,
    truth: FloatArray,
    shape: shapes.Shape,
    what: str,
    *,
    on: str,
    only: BoolArray | None = None,
    scale: float | None = None,
) -> None:
    """Expect a number or a vector at each vertex of `shape`; `only` some of them are compared.

    `scale` is the size that the tolerance is relative to, where the truth may be zero.
    """
    mine = expect.array(value, truth.shape, what, on=on)
    if only is not None:
        away = ~only if truth.ndim == 1 else np.repeat(~only[:, None], truth.shape[1], axis=1)
        mine = np.where(away, truth, mine)
    size = float(np.abs(truth).max()) if scale is None else scale
    shown = (shape.vertices, faces_of(shape), mine, truth, what.removeprefix("The "))
    picture, handout = pictures.of_values(*shown), pictures.of_own_values(*shown)
    expect.close(mine, truth, SINGLE * size, what, on=on, picture=picture, handout=handout)


def positions(value: object, truth: FloatArray, shape: shapes.Shape, *, on: str) -> None:
    """Expect the vertices of `shape` at new positions."""
    mine = expect.array(value, truth.shape, "The array of positions", on=on)
    size = float(np.ptp(shape.vertices, axis=0).max()) + 1e-2 * float(np.abs(shape.vertices).max())
    picture = pictures.of_positions(shape.vertices, mine, truth, faces_of(shape))
    handout = pictures.of_own_positions(shape.vertices, mine, faces_of(shape))
    what = "The position of a vertex"
    expect.close(mine, truth, SINGLE * size, what, on=on, picture=picture, handout=handout)


def pair(value: Any, what: str, *, on: str = "") -> tuple[Any, Any]:
    """Expect a pair; `what` says of what."""
    expect.that(value is not None, "The result is None: is a `return` missing?", on=on)
    fits = isinstance(value, (tuple, list)) or (isinstance(value, np.ndarray) and value.ndim > 0)
    message = f"The result should be a pair {what}; it is a {type(value).__name__}."
    expect.that(fits, message, yours=expect.brief(value), on=on)
    expect.that(len(value) == 2, f"The result should be a pair {what}; it has {len(value)} parts.", on=on)
    return value[0], value[1]
