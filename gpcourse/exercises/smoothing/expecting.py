"""What the checks of this chapter expect: matrices and values per vertex, with a picture of what is wrong."""

from __future__ import annotations

from typing import Any

import numpy as np

from gpcourse.exercises import expect, pictures
from gpcourse.exercises.smoothing.inputs import SINGLE, faces_of
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray


def matrix(value: object, truth: FloatArray, vertices: FloatArray, faces: IntArray, *, on: str = "") -> None:
    """Expect a matrix over the vertices of a mesh, sparse or dense, that equals `truth` entry by entry."""
    mine = expect.array(value, truth.shape, "The matrix", on=on)
    tolerance = SINGLE * np.abs(truth).max()
    if not (off_diagonal(mine).any() or off_diagonal(truth).any()):
        shown = pictures.Field(vertices, faces, "the diagonal")
        expect.close(mine.diagonal(), truth.diagonal(), tolerance, "The diagonal", on=on, shown=shown)
    expect.close(mine, truth, tolerance, "The matrix", on=on, shown=pictures.Rows(vertices, faces))


def off_diagonal(matrix: FloatArray) -> FloatArray:
    """Return the matrix with zeros on its diagonal."""
    return np.where(np.eye(len(matrix), dtype=bool), 0.0, matrix)


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
    shown = pictures.Field(shape.vertices, faces_of(shape), what.removeprefix("The "))
    expect.close(mine, truth, SINGLE * size, what, on=on, shown=shown)


def positions(value: object, truth: FloatArray, shape: shapes.Shape, *, on: str) -> None:
    """Expect the vertices of `shape` at new positions."""
    mine = expect.array(value, truth.shape, "The array of positions", on=on)
    size = float(np.ptp(shape.vertices, axis=0).max()) + 1e-2 * float(np.abs(shape.vertices).max())
    shown = pictures.Positions(shape.vertices, faces_of(shape))
    expect.close(mine, truth, SINGLE * size, "The positions", on=on, shown=shown)


def pair(value: Any, what: str, *, on: str = "") -> tuple[Any, Any]:
    """Expect a pair; `what` says of what."""
    expect.that(value is not None, "The result is None: is a `return` missing?", on=on)
    fits = isinstance(value, (tuple, list)) or (isinstance(value, np.ndarray) and value.ndim > 0)
    message = f"The result should be a pair {what}; it is a {type(value).__name__}."
    expect.that(fits, message, yours=expect.brief(value), on=on)
    expect.that(len(value) == 2, f"The result should be a pair {what}; it has {len(value)} parts.", on=on)
    return value[0], value[1]
