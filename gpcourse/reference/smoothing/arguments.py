"""What the functions of this chapter are given: matrices, fixed vertices and values, checked."""

from __future__ import annotations

import math
import operator

import numpy as np
from scipy import sparse

from gpcourse.errors import ArrayError, GeometryError, MeshError
from gpcourse.geometry.arrays import FloatArray, IntArray


def as_matrix(value: object, name: str) -> sparse.csr_array:
    """Return a square matrix, sparse or dense, as csr_array with finite entries, or raise ArrayError."""
    try:
        matrix: sparse.csr_array = sparse.csr_array(value, dtype=np.float64)  # type: ignore[call-overload]
    except (TypeError, ValueError):
        raise ArrayError(
            f"{name} is a {type(value).__name__}; give a square matrix, sparse or dense"
        ) from None
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise ArrayError(f"{name} has shape {matrix.shape}; give a square matrix")
    if not np.isfinite(matrix.data).all():
        raise ArrayError(f"{name} has entries that are not finite; repair the mesh that it was made of")
    return matrix


def cell_areas(M: object, n: int) -> FloatArray:
    """Return the diagonal of a mass matrix for `n` vertices.

    Raises
    ------
    ArrayError
        If the matrix is of another size or not diagonal.
    MeshError
        If an area is not positive; names the vertex.
    """
    mass = as_matrix(M, "M")
    if mass.shape != (n, n):
        raise ArrayError(f"M has shape {mass.shape}; C is for {n} vertices, and M must be too")
    areas = np.asarray(mass.diagonal())
    if np.count_nonzero(mass.data) > np.count_nonzero(areas):
        raise ArrayError("M has entries beside its diagonal; give the areas of the cells on a diagonal")
    bad = np.flatnonzero(~(areas > 0))
    if len(bad):
        raise MeshError(
            f"the cell of vertex {bad[0]} has area {areas[bad[0]]:g}, which is not positive; "
            "remove vertices without faces, and take mixed cells"
        )
    return areas


def as_values(value: object, n: int, name: str, of: str = "vertices") -> FloatArray:
    """Return finite values, (n,) or (n, k), one row for each of `n` vertices, or raise ArrayError."""
    try:
        values = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ArrayError(f"{name} cannot be read as numbers; give a float array") from None
    if values.ndim not in (1, 2) or len(values) != n:
        raise ArrayError(f"{name} has shape {values.shape}; give a value or a row for each of {n} {of}")
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values.reshape(n, -1)).all(axis=1)))
        raise ArrayError(f"{name}[{row}] is {values[row]}; every value must be finite")
    return values


def as_vertex_indices(value: object, n: int, name: str) -> IntArray:
    """Return different vertices below `n`, given by indices or by a mask with a flag for each vertex.

    Indices keep their order; those of a mask ascend.
    """
    marked = np.asarray(value)
    if marked.dtype == bool:
        if marked.shape != (n,):
            raise ArrayError(f"{name} has shape {marked.shape}; give one flag for each of {n} vertices")
        return np.flatnonzero(marked)
    if marked.size == 0:
        return np.empty(0, dtype=np.int64)
    if marked.ndim != 1 or marked.dtype.kind not in "iu":
        raise ArrayError(f"{name} must be a mask or a list of vertex indices")
    outside = np.flatnonzero((marked < 0) | (marked >= n))
    if len(outside):
        raise ArrayError(f"{name} has vertex {marked[outside[0]]}; the indices run from 0 to {n - 1}")
    twice = np.flatnonzero(np.bincount(marked, minlength=n) > 1)
    if len(twice):
        raise ArrayError(f"{name} has vertex {twice[0]} more than once; remove the repetition")
    return marked.astype(np.int64)


def as_number(value: object, name: str, *, least: float = -math.inf) -> float:
    """Return a finite number that is at least `least`, or raise GeometryError."""
    try:
        number = float(value)  # type: ignore[arg-type]  # refuses what is not a number
    except (TypeError, ValueError, OverflowError):
        raise GeometryError(f"{name} is {value!r}; give a number") from None
    if not (math.isfinite(number) and number >= least):
        wanted = "finite" if least == -math.inf else f"finite and at least {least:g}"
        raise GeometryError(f"{name} is {number:g}; it must be {wanted}")
    return number


def as_count(value: object, name: str, *, least: int, most: int | None = None) -> int:
    """Return a whole number from `least` to `most`, or raise GeometryError."""
    try:
        count = operator.index(value)  # type: ignore[arg-type]  # refuses what is not whole
    except TypeError:
        raise GeometryError(f"{name} is {value!r}; give a whole number") from None
    if count < least or (most is not None and count > most):
        span = f"at least {least}" if most is None else f"from {least} to {most}"
        raise GeometryError(f"{name} is {count}; it must be {span}")
    return count
