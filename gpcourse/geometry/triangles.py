"""Quantities of single triangles and their sums: areas, angles, normals, volume.

Corner k of a face is its k-th vertex. All functions take ``vertices (n, 3)`` and ``faces (m, 3)``,
counter-clockwise seen from outside, and check both.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np

from gpcourse.errors import DegenerateFaceError, GeometryError, MeshError
from gpcourse.geometry.arrays import FloatArray, IntArray, as_points, as_triangles

#: Twice the area over the longest edge squared, at which rounding alone can make a triangle.
FLAT = 1e-15

#: Faces at a time. Arrays of them stay below 64 KB, which fit in the cache, and which the C library hands out
#: again without asking the system for new pages; larger blocks took twice as long at 10⁴ faces.
_BLOCK = 2560


def area_vectors(vertices: object, faces: object) -> FloatArray:
    r"""Return the vector areas :math:`\tfrac12 (b - a) \times (c - a)` of the triangles.

    Returns
    -------
    (m, 3) float array
        Along the outward normal, as long as the area of the face; zero for a degenerate face.
    """
    a, b, c = _corners(vertices, faces)
    return np.asarray(0.5 * np.cross(b - a, c - a))


def face_areas(vertices: object, faces: object) -> FloatArray:
    """Return the (m,) areas, in squared units of length; 0 for a degenerate face."""
    points = as_points(vertices, "vertices")
    triangles = as_triangles(faces, len(points))
    areas = np.empty(len(triangles))
    for block, u, v, _ in _edge_blocks(points, triangles):
        areas[block] = 0.5 * _cross_length(u, v)
    return areas


def surface_area(vertices: object, faces: object) -> float:
    """Return the sum of the areas."""
    return float(face_areas(vertices, faces).sum())


def face_normals(vertices: object, faces: object) -> FloatArray:
    """Return the (m, 3) outward unit normals.

    Raises
    ------
    DegenerateFaceError
        If a face has no area; names the first one.
    """
    a, b, c = _corners(vertices, faces)
    cross = np.cross(b - a, c - a)
    length = np.linalg.norm(cross, axis=1)
    _refuse_flat(length, a, b, c)
    return np.asarray(cross / length[:, None])


def corner_angles(vertices: object, faces: object) -> FloatArray:
    """Return the (m, 3) interior angles at the corners, in radians; each row sums to pi.

    Raises
    ------
    DegenerateFaceError
        If a face has no area.
    """
    sine, cosine = _sines_and_cosines(vertices, faces)
    # The arc tangent of both is exact for every angle; the arc cosine loses half the digits near 0 and pi.
    return np.asarray(np.arctan2(sine[:, None], cosine))


def corner_cotangents(vertices: object, faces: object) -> FloatArray:
    """Return the (m, 3) cotangents of the angles at the corners; negative where the corner is obtuse.

    Raises
    ------
    DegenerateFaceError
        If a face has no area.
    """
    return cotangents_and_areas(vertices, faces)[0]


def cotangents_and_areas(vertices: object, faces: object) -> tuple[FloatArray, FloatArray]:
    """Return the (m, 3) cotangents of `corner_cotangents`, and the (m,) areas of the same faces.

    Raises
    ------
    DegenerateFaceError
        If a face has no area.
    """
    sine, cosine = _sines_and_cosines(vertices, faces)
    return np.asarray(cosine / sine[:, None]), np.asarray(sine / 2)


def vertex_normals(
    vertices: object, faces: object, *, weight: Literal["area", "angle"] = "angle"
) -> FloatArray:
    """Return the (n, 3) unit normals at the vertices, means of the normals of the faces around.

    Parameters
    ----------
    weight : "area" or "angle"
        What a face counts for: its area, or its angle at the vertex. The angle does not depend on
        how the surface is cut into triangles, and tells inside from outside (Baerentzen and Aanaes 2005).

    Raises
    ------
    DegenerateFaceError
        If a face has no area.
    GeometryError
        If a vertex belongs to no face, or the normals around it cancel.
    """
    if weight not in ("area", "angle"):
        raise GeometryError(f"weight is {weight!r}; give 'area' or 'angle'")
    points = as_points(vertices, "vertices")
    triangles = as_triangles(faces, len(points))
    normals = face_normals(points, triangles)
    if weight == "area":
        weights = np.repeat(face_areas(points, triangles)[:, None], 3, axis=1)
    else:
        weights = corner_angles(points, triangles)
    sums = np.zeros_like(points)
    for k in range(3):
        for axis in range(3):
            sums[:, axis] += np.bincount(
                triangles[:, k], weights=weights[:, k] * normals[:, axis], minlength=len(points)
            )
    length = np.linalg.norm(sums, axis=1)
    bad = np.flatnonzero(~(length > 0))
    if len(bad):
        raise GeometryError(
            f"vertex {bad[0]} has no normal: it belongs to no face or the normals around it cancel; remove it"
        )
    return np.asarray(sums / length[:, None])


def enclosed_volume(vertices: object, faces: object) -> float:
    r"""Return the volume inside a closed mesh, :math:`\tfrac16 \sum_f a \cdot (b \times c)`.

    Positive when the faces look outward; the same wherever the mesh lies.

    Raises
    ------
    MeshError
        If an edge is not run along equally often in both directions: the mesh encloses nothing.
    """
    points = as_points(vertices, "vertices")
    triangles = as_triangles(faces, len(points))
    _refuse_open(triangles, len(points))
    if not len(triangles):
        return 0.0
    # Far from the origin the terms would be large and cancel: measure from the middle.
    a, b, c = _corners(points - points[triangles].mean(axis=(0, 1)), triangles)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def _corners(vertices: object, faces: object) -> tuple[FloatArray, FloatArray, FloatArray]:
    points = as_points(vertices, "vertices")
    triangles = as_triangles(faces, len(points))
    return points[triangles[:, 0]], points[triangles[:, 1]], points[triangles[:, 2]]


def _sines_and_cosines(vertices: object, faces: object) -> tuple[FloatArray, FloatArray]:
    """Return the (m,) sines and (m, 3) cosines of the angles, times the product of the two edges there.

    That product makes the sine the same at all three corners: twice the area.
    """
    points = as_points(vertices, "vertices")
    triangles = as_triangles(faces, len(points))
    sine = np.empty(len(triangles))
    cosine = np.empty((len(triangles), 3))
    sound = True
    for block, u, v, w in _edge_blocks(points, triangles):
        sine[block] = twice_area = _cross_length(u, v)
        # The edges run around the face, so that the two at a corner make the outer angle there.
        a, b, c = (-(one * other).sum(axis=0) for one, other in ((v, w), (w, u), (u, v)))
        cosine[block, 0], cosine[block, 1], cosine[block, 2] = a, b, c
        # The squared edge opposite to a corner is the sum of the cosines at the other two.
        longest = np.maximum(np.maximum(b + c, c + a), a + b)
        sound &= bool((twice_area > FLAT * longest).all())
    if not sound:
        _refuse_flat(sine, *_corners(points, triangles))
    return sine, cosine


def _edge_blocks(
    points: FloatArray, triangles: IntArray
) -> Iterator[tuple[slice, FloatArray, FloatArray, FloatArray]]:
    """Yield the edges of a few thousand faces at a time, as (3, k) arrays that stay in the cache.

    The edges opposite to corners 0, 1 and 2, each running counter-clockwise around its face.
    """
    coordinates = np.ascontiguousarray(points.T)
    for start in range(0, len(triangles), _BLOCK):
        block = slice(start, start + _BLOCK)
        # The indices have been checked; without "clip" numpy would check them again.
        a, b, c = (coordinates.take(corner, axis=1, mode="clip") for corner in triangles[block].T)
        yield block, c - b, a - c, b - a


def _cross_length(u: FloatArray, v: FloatArray) -> FloatArray:
    """Return the lengths of the cross products of two (3, k) arrays."""
    x = u[1] * v[2] - u[2] * v[1]
    y = u[2] * v[0] - u[0] * v[2]
    z = u[0] * v[1] - u[1] * v[0]
    return np.asarray(np.sqrt(x * x + y * y + z * z))


def _refuse_flat(twice_area: FloatArray, a: FloatArray, b: FloatArray, c: FloatArray) -> None:
    longest = np.maximum.reduce([np.square(q - p).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))])
    flat = np.flatnonzero(~(twice_area > FLAT * longest))
    if len(flat):
        f = int(flat[0])
        corners = ", ".join(str(p[f].tolist()) for p in (a, b, c))
        raise DegenerateFaceError(f"face {f} has no area: its corners are {corners}; remove or repair it")


def _refuse_open(triangles: IntArray, n_vertices: int) -> None:
    tail = triangles.ravel()
    head = np.roll(triangles, -1, axis=1).ravel()
    there = np.sort(tail * n_vertices + head)
    back = np.sort(head * n_vertices + tail)
    differs = np.flatnonzero(there != back)
    if len(differs):
        edge = min(int(there[differs[0]]), int(back[differs[0]]))
        u, v = divmod(edge, n_vertices)
        raise MeshError(
            f"edge {u} - {v} does not have faces on both sides in opposite directions; "
            "a volume needs a closed, consistently oriented mesh"
        )
