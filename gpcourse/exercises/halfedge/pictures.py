"""Scenes that show what is wrong. Each function returns a callable, so that nothing is drawn unseen."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from gpcourse.geometry.arrays import FloatArray
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh
from gpcourse.view import halfedge_scene, neighbours_scene
from gpcourse.view.scene import Scene, side_by_side

Draw = Callable[[], Scene]


def of_halfedges(mesh: HalfedgeMesh, halfedges: Sequence[int]) -> Draw:
    """Mark some half-edges of a mesh with positions."""
    return lambda: halfedge_scene(mesh, highlight=[int(h) for h in halfedges])


def of_face(mesh: HalfedgeMesh, f: int) -> Draw:
    """Mark the half-edges of a face."""
    return of_halfedges(mesh, np.flatnonzero(mesh.face == f).tolist())


def of_twin(mesh: HalfedgeMesh, vertices: FloatArray, h: int | None) -> Draw | None:
    """Mark half-edge `h` and what a student's mesh calls its twin."""
    if h is None or len(vertices) != mesh.n_vertices:
        return None
    twin = int(mesh.twin[h])
    both = [h, twin] if 0 <= twin < mesh.n_halfedges else [h]
    return of_halfedges(mesh.with_vertices(vertices), both)


def of_neighbours(mesh: HalfedgeMesh, v: int, order: Sequence[int]) -> Draw:
    """Number the neighbours of `v` in the order that was returned."""
    known = [int(w) for w in order if 0 <= w < mesh.n_vertices]
    return lambda: neighbours_scene(mesh, v, known)


def of_flip(before: HalfedgeMesh, after: HalfedgeMesh, h: int) -> Draw:
    """Show an edge before and after its flip."""

    def draw() -> Scene:
        edge = [h, int(before.twin[h])]
        then = halfedge_scene(before, highlight=edge, title="before")
        if after.n_vertices != before.n_vertices or after.n_halfedges != before.n_halfedges:
            return then
        placed = after if after.vertices is not None else after.with_vertices(before.vertices)
        return side_by_side([then, halfedge_scene(placed, highlight=edge, title="after")])

    return draw
