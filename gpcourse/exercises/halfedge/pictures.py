"""Scenes that show what is wrong. Each function returns a callable, so that nothing is drawn unseen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from gpcourse.exercises.halfedge.inputs import positions
from gpcourse.geometry.arrays import FloatArray
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh
from gpcourse.view import halfedge_scene, neighbours_scene
from gpcourse.view.scene import Camera, Scene, side_by_side

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
    """Show an edge before and after its flip, both seen from above the edge."""

    def draw() -> Scene:
        camera = _above(before, h)
        edge = [h, int(before.twin[h])]
        scenes = [halfedge_scene(before, highlight=edge, title="before", direction=camera.direction)]
        if (after.n_vertices, after.n_halfedges) == (before.n_vertices, before.n_halfedges):
            placed = after.with_vertices(before.vertices)
            scenes.append(halfedge_scene(placed, highlight=edge, title="after", direction=camera.direction))
        near = [replace(scene, panels=(replace(scene.panels[0], camera=camera),)) for scene in scenes]
        return side_by_side(near)

    return draw


def _above(mesh: HalfedgeMesh, h: int) -> Camera:
    """Look along the mean normal of the two triangles at an edge, at their four corners."""
    x, t = positions(mesh), mesh.twin[h]
    p, q, r, s = x[mesh.origin[[h, t, mesh.prev[h], mesh.prev[t]]]]
    normal = np.cross(q - p, r - p) + np.cross(p - q, s - q)
    middle = (p + q + r + s) / 4
    radius = 1.25 * max(float(np.linalg.norm(corner - middle)) for corner in (p, q, r, s))
    up = np.cross(normal, q - p)  # the edge lies level before the flip
    return Camera(direction=tuple(normal), up=tuple(up), focus=tuple(middle), radius=radius)
