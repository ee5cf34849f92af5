"""Typed arrays, and the one place where input is turned into them or refused."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gpcourse.errors import ArrayError, DegenerateFaceError, MeshError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

#: Faces as users write them: an (m, k) array, or a list of index lists of mixed lengths.
Polygons = NDArray[np.integer[Any]] | Sequence[Sequence[int]]


def as_points(value: object, name: str = "points", *, dimension: int | None = 3) -> FloatArray:
    """Return `value` as a finite (n, d) float array, or say what is wrong with it.

    Parameters
    ----------
    value : array-like
        n points with d coordinates each.
    name : str
        How the message calls the argument.
    dimension : int or None
        The d that is asked for; None accepts any.

    Raises
    ------
    ArrayError
        If the value is not numeric, not two-dimensional, of another d, or not finite.
    """
    wanted = "d" if dimension is None else str(dimension)
    try:
        given = np.asarray(value)
        if given.dtype.kind in "cSUmM":  # a cast would drop the imaginary part, or read a text as a number
            raise TypeError
        points = given.astype(np.float64, copy=False)
    except (TypeError, ValueError, OverflowError):
        raise ArrayError(f"{name} cannot be read as numbers; give an (n, {wanted}) float array") from None
    if points.ndim != 2 or (dimension is not None and points.shape[1] != dimension):
        raise ArrayError(f"{name} has shape {points.shape}; give an (n, {wanted}) array")
    finite = np.isfinite(points)
    if not finite.all():  # row by row only where there is one to find, which is ten times slower
        row = int(np.argmin(finite.all(axis=1)))
        raise ArrayError(f"{name}[{row}] is {points[row]}; every coordinate must be finite")
    return points


def as_triangles(value: object, n_vertices: int, name: str = "faces") -> IntArray:
    """Return `value` as an (m, 3) int array with indices below `n_vertices`.

    Raises
    ------
    ArrayError
        If the shape is not (m, 3) or the values are not integers.
    MeshError
        If an index is out of range.
    DegenerateFaceError
        If a face names a vertex twice.
    """
    try:
        faces = np.asarray(value)
    except ValueError:
        raise ArrayError(f"{name} mixes lengths; give an (m, 3) array of triangles") from None
    if faces.ndim != 2 or faces.shape[1] != 3:
        raise ArrayError(f"{name} has shape {faces.shape}; give an (m, 3) array of triangles")
    corners, sizes = flatten_polygons(faces, n_vertices, name)
    return corners.reshape(len(sizes), 3)


def flatten_polygons(faces: object, n_vertices: int, name: str = "faces") -> tuple[IntArray, IntArray]:
    """Lay polygons end to end: all corners in one array, and the size of each face.

    Parameters
    ----------
    faces : Polygons
        An (m, k) integer array or a list of m index lists.
    n_vertices : int
        Every index must lie in ``0 .. n_vertices - 1``.

    Returns
    -------
    corners : (c,) int array
        The vertex of each corner, face after face.
    sizes : (m,) int array
        The number of corners of each face; they sum to c.

    Raises
    ------
    ArrayError
        If the faces are not lists of integers, or `n_vertices` is no count.
    MeshError
        If a face has fewer than three corners or an index is out of range.
    DegenerateFaceError
        If a face names a vertex twice.
    """
    if not isinstance(n_vertices, (int, np.integer)) or n_vertices < 0:
        raise ArrayError(f"n_vertices is {n_vertices!r}; give the number of vertices, a whole number")
    corners, sizes = _corners_and_sizes(faces, name)
    small = np.flatnonzero(sizes < 3)
    if len(small):
        f = int(small[0])
        raise MeshError(f"face {f} has {sizes[f]} corners; a face needs at least 3")
    outside = np.flatnonzero((corners < 0) | (corners >= n_vertices))
    if len(outside):
        c = int(outside[0])
        f = int(np.searchsorted(np.cumsum(sizes), c, side="right"))
        there = f"the indices run from 0 to {n_vertices - 1}" if n_vertices else "no index is valid"
        raise MeshError(f"face {f} names vertex {corners[c]}; with {n_vertices} vertices {there}")
    _refuse_repeated_corners(corners, sizes)
    return corners, sizes


def _corners_and_sizes(faces: object, name: str) -> tuple[IntArray, IntArray]:
    if isinstance(faces, np.ndarray) and faces.ndim == 2:
        flat, sizes = faces.ravel(), np.full(len(faces), faces.shape[1], dtype=np.int64)
    elif isinstance(faces, (list, tuple, np.ndarray)):
        try:
            flat = np.array([index for face in faces for index in face])
            sizes = np.array([len(face) for face in faces], dtype=np.int64)
        except (TypeError, ValueError):
            raise ArrayError(f"{name} must be a list of index lists or an (m, k) array") from None
    else:
        raise ArrayError(f"{name} is a {type(faces).__name__}; give a list of index lists or an array")
    if flat.size == 0:
        return np.empty(0, dtype=np.int64), sizes
    if flat.ndim != 1:
        raise ArrayError(
            f"{name} is nested {flat.ndim + 1} deep; give a list of index lists or an (m, k) array"
        )
    if not np.issubdtype(flat.dtype, np.integer):
        raise ArrayError(f"{name} holds {flat.dtype} values; vertex indices are integers")
    return flat.astype(np.int64, copy=False), sizes


def _refuse_repeated_corners(corners: IntArray, sizes: IntArray) -> None:
    if not len(sizes):
        return
    k = int(sizes[0])
    if (sizes == k).all():
        # Equal sizes: compare whole columns, which is far cheaper than a sort.
        table = corners.reshape(-1, k)
        repeated = np.zeros(len(table), dtype=bool)
        for i in range(k):
            for j in range(i):
                repeated |= table[:, i] == table[:, j]
        bad = np.flatnonzero(repeated)
    else:
        face = np.repeat(np.arange(len(sizes)), sizes)
        order = np.lexsort((corners, face))
        same = (np.diff(corners[order]) == 0) & (np.diff(face[order]) == 0)
        bad = face[order][1:][same]
    if len(bad):
        f = int(bad[0])
        start = int(sizes[:f].sum())
        names = corners[start : start + int(sizes[f])].tolist()
        raise DegenerateFaceError(f"face {f} is {names}: a vertex occurs twice; remove the repetition")
