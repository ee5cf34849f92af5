"""Reading the geometry of an OBJ file: positions and faces, and nothing of materials and textures."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from gpcourse.errors import GeometryError, ObjFormatError
from gpcourse.geometry.arrays import FloatArray, IntArray, as_triangles


def read_obj(text: str) -> tuple[FloatArray, IntArray]:
    """Read the triangles of an OBJ file.

    Polygons are cut into triangles that share their first corner. Normals, textures, groups and materials
    are skipped.

    Parameters
    ----------
    text : str
        The text of the file.

    Returns
    -------
    vertices : (n, 3) float array
    faces : (m, 3) int array

    Raises
    ------
    ObjFormatError
        If a line cannot be read, or a face names a vertex that there is not; names the line.
    """
    vertices: list[list[float]] = []
    faces: list[list[int]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        kind, *words = line.partition("#")[0].split() or [""]
        if kind == "v":
            vertices.append(_position(words, number))
        elif kind == "f":
            a, *rest = _corners(words, len(vertices), number)
            faces.extend([a, b, c] for b, c in pairwise(rest))
    points = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    try:
        return points, as_triangles(np.array(faces, dtype=np.int64).reshape(-1, 3), len(points))
    except GeometryError as error:
        raise ObjFormatError(f"the faces are no triangles: {error}") from None


def _position(words: list[str], number: int) -> list[float]:
    try:
        position = [float(word) for word in words[:3]]
    except ValueError:
        position = []
    if len(position) != 3 or not np.isfinite(position).all():
        raise ObjFormatError(
            f"line {number}: a vertex is `v x y z`, three numbers; it is `v {' '.join(words)}`"
        )
    return position


def _corners(words: list[str], n_vertices: int, number: int) -> list[int]:
    """Return the vertices of a face. They are counted from 1, or back from the last one as -1, -2, …."""
    try:
        named = [int(word.partition("/")[0]) for word in words]
    except ValueError:
        named = []
    if len(named) < 3:
        raise ObjFormatError(
            f"line {number}: a face is `f` and three vertices or more; it is `f {' '.join(words)}`"
        )
    corners = [v - 1 if v > 0 else v + n_vertices for v in named]
    for v, corner in zip(named, corners, strict=True):
        if v == 0 or not 0 <= corner < n_vertices:
            raise ObjFormatError(
                f"line {number}: a face names vertex {v}; {n_vertices} vertices come before it, from 1 on"
            )
    return corners
