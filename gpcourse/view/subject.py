"""What can be drawn: the vertices and polygons of whatever a user hands over.

A half-edge mesh may be a student's and wrong. Its faces are read as far as its records lead to
some, and never further than that: nothing here trusts a record, raises on a wrong one, or walks for ever.
"""

from __future__ import annotations

from typing import Any, TypeGuard

import numpy as np

from gpcourse.errors import ArrayError
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray, as_points, flatten_polygons
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh


def as_subject(subject: object) -> tuple[FloatArray, Any]:
    """Return vertices (n, 3) and faces of a mesh, a shape, or a pair (vertices, faces).

    Vertices in the plane get ``z = 0``.

    Raises
    ------
    ArrayError
        If the subject is none of these, or a half-edge mesh without positions.
    """
    if _is_halfedge_mesh(subject):
        return halfedge_positions(subject), face_loops(subject)
    if isinstance(subject, (tuple, list)) and len(subject) == 2:
        vertices, faces = subject
    elif hasattr(subject, "vertices") and hasattr(subject, "faces"):
        vertices, faces = subject.vertices, subject.faces
    else:
        raise ArrayError(
            f"a {type(subject).__name__} cannot be drawn as a mesh; "
            "give a HalfedgeMesh, a shape, or a pair (vertices, faces)"
        )
    positions = lifted(vertices, "vertices")
    flatten_polygons(faces, len(positions))
    return positions, faces


def lifted(value: object, name: str) -> FloatArray:
    """Return points of space; points of the plane get ``z = 0``."""
    points = as_points(value, name, dimension=None)
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    return _in_range(as_points(points, name))


def halfedge_positions(mesh: object) -> FloatArray:
    """Return the positions of a half-edge mesh; ArrayError if it is none or has none."""
    if not _is_halfedge_mesh(mesh):
        raise ArrayError(f"a {type(mesh).__name__} has no half-edges; give a HalfedgeMesh")
    if mesh.vertices is None:
        raise ArrayError("the mesh has no positions to draw; give it some with mesh.with_vertices(positions)")
    return _in_range(as_points(mesh.vertices, "mesh.vertices"))


def face_loops(mesh: HalfedgeMesh) -> list[list[int]]:
    """Return the corners of every face that can be read by walking along `next`.

    A walk that leaves the records, meets a vertex twice, or does not come back gives no face.
    """
    faces = []
    # In a sound mesh every half-edge is met once; more steps than that are not needed.
    budget = 2 * mesh.n_halfedges
    following, origin = mesh.next.tolist(), mesh.origin.tolist()
    for start in mesh.face_halfedge.tolist():
        corners: list[int] = []
        seen: set[int] = set()
        h = start
        while (
            0 <= h < len(following)
            and budget > 0
            and origin[h] not in seen
            and 0 <= origin[h] < mesh.n_vertices
        ):
            corners.append(origin[h])
            seen.add(origin[h])
            h = following[h]
            budget -= 1
            if h == start:
                break
        if h == start and len(corners) >= 3:
            faces.append(corners)
    return faces


def halfedge_heads(mesh: HalfedgeMesh) -> IntArray:
    """Return the vertex that each half-edge leads to, or -1 where the records name none.

    That is where its next starts, or, failing that, where its twin starts.
    """
    heads = _read(mesh.origin, mesh.next)
    by_twin = _read(mesh.origin, mesh.twin)
    usable = _is_vertex(mesh, heads) & (heads != mesh.origin)
    heads = np.where(usable, heads, by_twin)
    usable = _is_vertex(mesh, heads) & (heads != mesh.origin) & _is_vertex(mesh, mesh.origin)
    return np.where(usable, heads, -1)


def left_face(mesh: HalfedgeMesh) -> tuple[IntArray, BoolArray]:
    """Return a face beside each half-edge, or -1, and whether it is its own, on its left."""
    own = np.where((mesh.face >= 0) & (mesh.face < mesh.n_faces), mesh.face, -1)
    other = _read(own, mesh.twin)
    return np.where(own >= 0, own, other), own >= 0


def _in_range(points: FloatArray) -> FloatArray:
    """Change the unit of a flow that has blown up, or of a speck: a browser has numbers of 32 bits."""
    largest = float(np.abs(points).max(initial=0.0))
    return points / largest if largest > 1e15 or 0 < largest < 1e-15 else points


def _read(record: IntArray, at: IntArray) -> IntArray:
    """Return ``record[at]``, and -1 where `at` is not an index."""
    inside = (at >= 0) & (at < len(record))
    return np.where(inside, np.append(record, -1)[np.where(inside, at, -1)], -1)


def _is_vertex(mesh: HalfedgeMesh, index: IntArray) -> BoolArray:
    return np.asarray((index >= 0) & (index < mesh.n_vertices))


def _is_halfedge_mesh(subject: object) -> TypeGuard[HalfedgeMesh]:
    return isinstance(subject, HalfedgeMesh)
