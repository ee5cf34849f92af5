"""Inputs that tell right from wrong, and truths that do not come from the reference."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gpcourse.errors import ArrayError
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.geometry.halfedge_mesh import HOLE, NONE, HalfedgeMesh
from gpcourse.reference.halfedge import halfedge_mesh

Rng = np.random.Generator
FaceLists = list[list[int]]


def face_lists(shape: shapes.Shape) -> FaceLists:
    """Write the faces of a shape as a list of index lists."""
    return [[int(v) for v in face] for face in shape.faces]


def closed_triangles(rng: Rng) -> shapes.Shape:
    """Draw a small torus of triangles with vertices of valence 3, numbered at random."""
    return shapes.random_closed(rng, 20, genus=1)


def bounded_triangles(rng: Rng) -> shapes.Shape:
    """Draw a small torus of triangles with two holes, numbered at random."""
    return shapes.random_bounded(rng, 40, genus=1, loops=2)


def closed_polygons(rng: Rng) -> shapes.Shape:
    """Draw a closed mesh of polygons of several sizes, numbered at random."""
    return shapes.shuffled(shapes.prism(int(rng.integers(5, 8))), rng)


def with_isolated_vertices(shape: shapes.Shape, rng: Rng) -> tuple[FloatArray, FaceLists, IntArray]:
    """Spread three vertices without faces among those of a shape.

    Returns the vertices, the faces and the isolated vertices. The first and the last vertex are among the
    isolated ones: an index of -1 or 0 by mistake then meets one of them.
    """
    n = len(shape.vertices)
    inner = int(rng.integers(2, n))
    isolated = np.array([0, inner, n + 2])
    place = np.setdiff1d(np.arange(n + 3), isolated)
    vertices = rng.normal(size=(n + 3, 3))
    vertices[place] = shape.vertices
    return vertices, [[int(place[v]) for v in face] for face in shape.faces], isolated


def mesh_of(shape: shapes.Shape, rng: Rng | None = None) -> HalfedgeMesh:
    """Build the half-edges of a shape; with `rng`, number them and choose the representatives at random."""
    mesh = halfedge_mesh(shape.vertices, shape.faces)
    return mesh if rng is None else renumbered(mesh, rng)


def renumbered(mesh: HalfedgeMesh, rng: Rng) -> HalfedgeMesh:
    """Number the half-edges at random, so that no solution can live on the numbering of ours."""
    new = rng.permutation(mesh.n_halfedges)
    records: dict[str, Any] = {}
    for name in ("twin", "next", "prev"):
        records[name] = np.empty_like(new)
        records[name][new] = new[getattr(mesh, name)]
    for name in ("origin", "face"):
        records[name] = np.empty_like(new)
        records[name][new] = getattr(mesh, name)
    order = rng.permutation(mesh.n_halfedges)
    of_vertex = np.full(mesh.n_vertices, NONE)
    of_vertex[records["origin"][order]] = order
    inside = order[records["face"][order] != HOLE]
    of_face = np.full(mesh.n_faces, NONE)
    of_face[records["face"][inside]] = inside
    return HalfedgeMesh(**records, vertex_halfedge=of_vertex, face_halfedge=of_face, vertices=mesh.vertices)


def with_representatives(mesh: HalfedgeMesh, halfedges: list[int]) -> HalfedgeMesh:
    """Make each of `halfedges` the representative of its vertex and its face."""
    of_vertex, of_face = mesh.vertex_halfedge.copy(), mesh.face_halfedge.copy()
    for h in halfedges:
        of_vertex[mesh.origin[h]] = h
        if mesh.face[h] != HOLE:
            of_face[mesh.face[h]] = h
    return replace(mesh, vertex_halfedge=of_vertex, face_halfedge=of_face)


def neighbours_ccw(faces: FaceLists, v: int) -> list[int]:
    """List the neighbours of `v` counter-clockwise, from the faces alone.

    In a face (…, a, v, b, …) the edge to b comes before the edge to a, counter-clockwise seen from
    outside. A boundary vertex has a neighbour that follows no other: there the list starts.
    """
    after = {}
    for face in faces:
        if v in face:
            i = face.index(v)
            after[face[(i + 1) % len(face)]] = face[i - 1]
    if not after:
        return []
    first = next(iter(set(after) - set(after.values())), next(iter(after)))
    ring = [first]
    while ring[-1] in after and after[ring[-1]] != first:
        ring.append(after[ring[-1]])
    return ring


def hole_cycles(faces: FaceLists) -> list[list[int]]:
    """List the vertices along each hole, from the faces alone.

    A border is an edge a -> b of one face that no other face runs along the other way; the hole has b -> a.
    """
    sides = {(face[i - 1], face[i]) for face in faces for i in range(len(face))}
    after = {b: a for a, b in sides if (b, a) not in sides}
    cycles = []
    while after:
        first, v = after.popitem()
        cycle = [first]
        while v != first:
            cycle.append(v)
            v = after.pop(v)
        cycles.append(cycle)
    return cycles


def positions(mesh: HalfedgeMesh) -> FloatArray:
    """Return the positions of a mesh that is known to have some."""
    if mesh.vertices is None:
        raise ArrayError("the mesh has no positions; give it some with mesh.with_vertices(...)")
    return mesh.vertices


def n_edges(faces: FaceLists) -> int:
    """Count the edges of a mesh from its faces alone."""
    return len({frozenset((face[i - 1], face[i])) for face in faces for i in range(len(face))})


def from_smallest(cycle: list[int]) -> list[int]:
    """Turn a cycle so that it starts with its smallest item."""
    if not cycle:
        return cycle
    i = cycle.index(min(cycle))
    return cycle[i:] + cycle[:i]


def as_cycle(arguments: tuple[Any, ...], value: Any) -> list[int]:
    """Canonical form of an answer that may start anywhere on a cycle."""
    return from_smallest([int(v) for v in np.asarray(value).ravel()])


def as_rows(arguments: tuple[Any, ...], value: Any) -> list[Any]:
    """Canonical form of a half-edge mesh: what each half-edge knows, without the half-edges' numbers."""
    ends = np.append(value.origin, -9)
    sides = np.append(value.face, -9)
    around = (np.arange(value.n_halfedges), value.twin, value.next, value.prev)
    rows = np.column_stack([column[h] for h in around for column in (ends, sides)])
    rows = rows[np.lexsort(rows.T)]
    vertices = ends[value.vertex_halfedge]
    return [rows, vertices, sides[value.face_halfedge]]
