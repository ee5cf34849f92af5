"""Connectivity of regular grids, and the refinement of meshes."""

from __future__ import annotations

import numpy as np

from gpcourse.geometry.arrays import IntArray


def grid_quads(n: int, rows: int) -> tuple[IntArray, IntArray]:
    """Return column i and row j of the corners of all n x rows cells, each (n * rows, 4).

    Counter-clockwise when i runs to the right and j upwards; cells row after row. The makers
    fold the columns ``0 .. n`` and rows ``0 .. rows`` into vertices as their surface closes.
    """
    j, i = (index.reshape(-1, 1) for index in np.meshgrid(np.arange(rows), np.arange(n), indexing="ij"))
    return i + np.array([0, 1, 1, 0]), j + np.array([0, 0, 1, 1])


def halved(quads: IntArray) -> IntArray:
    """Cut each quad a b c d into the triangles a b d and b c d."""
    return quads[:, [0, 1, 3, 1, 2, 3]].reshape(-1, 3)


def edge_midpoints(faces: IntArray, n_vertices: int) -> tuple[IntArray, IntArray]:
    """Give every edge a number.

    Returns
    -------
    ends : (e, 2) int array
        The two vertices of each edge.
    edge : (m, k) int array
        The edge from each corner to the next one of its face.
    """
    ahead = np.roll(faces, -1, axis=1)
    keys = np.minimum(faces, ahead) * n_vertices + np.maximum(faces, ahead)
    unique, edge = np.unique(keys, return_inverse=True)
    return np.column_stack(np.divmod(unique, n_vertices)), edge.reshape(faces.shape)
