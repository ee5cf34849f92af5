"""Closed surfaces with any number of handles."""

from __future__ import annotations

import numpy as np

from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.geometry.shapes.grids import edge_midpoints
from gpcourse.geometry.shapes.parameters import whole
from gpcourse.geometry.shapes.shape import Shape


def genus_surface(genus: int = 2, *, subdivisions: int = 2) -> Shape:
    """Return a smooth-looking closed triangle mesh with `genus` handles.

    A plate of cubes with a row of `genus` holes, rounded by subdivision (Catmull and Clark 1978).
    Its quads are cut along the shorter diagonal at last.

    Parameters
    ----------
    genus : int
        Number of handles, from 0 on.
    subdivisions : int
        Steps of rounding; each makes four times as many faces. 0 leaves the cubes.
    """
    genus = whole("genus", genus, 0, 1000)
    subdivisions = whole("subdivisions", subdivisions, 0, 6)
    filled = np.ones((2 * genus + 1, 3, 1), dtype=bool)
    filled[1::2, 1] = False
    vertices, quads = _cube_boundary(filled)
    for _ in range(subdivisions):
        vertices, quads = _rounded(vertices, quads)
    return Shape(f"surface of genus {genus}", vertices, _cut_shorter(vertices, quads), genus=genus)


def _cube_boundary(filled: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> tuple[FloatArray, IntArray]:
    """Return the boundary of the filled unit cells, centred at the origin; quads face outward."""
    padded = np.pad(filled, 1)
    quads = []
    for axis in range(3):
        # The other two axes in the order that makes first x second = axis.
        first, second = np.eye(3, dtype=np.int64)[[(axis + 1) % 3, (axis + 2) % 3]]
        square = np.array([0 * first, first, first + second, second])
        for side in (0, 1):
            outside = ~np.roll(padded, 1 - 2 * side, axis=axis)
            corner = np.argwhere(padded & outside) + side * np.eye(3, dtype=np.int64)[axis]
            quads.append(corner[:, None, :] + (square if side else square[::-1]))
    corners = np.concatenate(quads)
    points, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    return points - centre, index.reshape(-1, 4)


def _rounded(vertices: FloatArray, quads: IntArray) -> tuple[FloatArray, IntArray]:
    """Return one step of the subdivision of Catmull and Clark of a closed mesh of quads."""
    n, m = len(vertices), len(quads)
    ends, edge = edge_midpoints(quads, n)
    middle = vertices[quads].mean(axis=1)
    beside = _sums(edge, middle, len(ends))  # over the two faces of each edge
    on_edge = (vertices[ends].sum(axis=1) + beside) / 4
    valence = np.bincount(quads.ravel(), minlength=n)[:, None]
    face_mean = _sums(quads, middle, n) / valence
    edge_mean = _sums(ends, vertices[ends].mean(axis=1), n) / valence
    moved = (face_mean + 2 * edge_mean + (valence - 3) * vertices) / valence
    ahead, behind = n + edge, n + np.roll(edge, 1, axis=1)
    centre = np.broadcast_to(n + len(ends) + np.arange(m)[:, None], quads.shape)
    return np.vstack([moved, on_edge, middle]), np.stack([quads, ahead, centre, behind], axis=2).reshape(
        -1, 4
    )


def _sums(index: IntArray, rows: FloatArray, length: int) -> FloatArray:
    """Add ``rows[f]`` to every place that ``index[f]`` names."""
    total = np.zeros((length, 3))
    np.add.at(total, index, rows[:, None, :])
    return total


def _cut_shorter(vertices: FloatArray, quads: IntArray) -> IntArray:
    a, b, c, d = (vertices[quads[:, k]] for k in range(4))
    other = np.square(b - d).sum(axis=1) < np.square(a - c).sum(axis=1)
    turned = np.where(other[:, None], np.roll(quads, -1, axis=1), quads)
    return turned[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
