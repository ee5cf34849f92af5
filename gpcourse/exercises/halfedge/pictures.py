"""Scenes that show what is wrong. Each function returns a callable, so that nothing is drawn unseen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from gpcourse.exercises.halfedge.inputs import positions
from gpcourse.exercises.pictures import RIGHT, WRONG, Draw
from gpcourse.geometry.arrays import FloatArray
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh
from gpcourse.geometry.shapes import Shape
from gpcourse.view import halfedge_scene, mesh_scene, neighbours_scene
from gpcourse.view.scene import Arrows, Camera, Curves, Labels, Layer, Points, Scene, side_by_side


def of_halfedges(mesh: HalfedgeMesh, halfedges: Sequence[int]) -> Draw:
    """Mark some half-edges of a mesh with positions."""
    return partial(halfedge_scene, mesh, highlight=[int(h) for h in halfedges])


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


def of_loops(shape: Shape, yours: Sequence[Sequence[int]], want: Sequence[Sequence[int]]) -> dict[str, Any]:
    """Draw loops of vertices on a mesh, in the direction of their arrows: yours, and those that there are."""
    return {
        "picture": partial(_loops, shape, [("yours", yours, WRONG), ("expected", want, RIGHT)]),
        "handout": partial(_loops, shape, [("yours", yours, WRONG)]),
    }


def _loops(shape: Shape, many: Sequence[tuple[str, Sequence[Sequence[int]], str]]) -> Scene:
    return side_by_side([_on_mesh(shape, *one) for one in many])


def _on_mesh(shape: Shape, title: str, loops: Sequence[Sequence[int]], colour: str) -> Scene:
    known = [[v for v in loop if 0 <= v < len(shape.vertices)] for loop in loops]
    steps = [(a, b) for loop in known for a, b in zip(loop, [*loop[1:], *loop[:1]], strict=True) if a != b]
    tails, heads = (shape.vertices[[step[k] for step in steps]] for k in (0, 1))
    scene = mesh_scene((shape.vertices, shape.faces), title=title)
    panel = scene.panels[0]
    arrows = Arrows(tails, heads, (colour,), width=2.0, hidden="fade")
    words = f"{title}: {len(loops)} loops of vertices, drawn as arrows on the mesh."
    return Scene((replace(panel, layers=(*panel.layers, arrows)),), alt=words)


def of_centroid(corners: FloatArray, yours: FloatArray, truth: FloatArray) -> dict[str, Any]:
    """Show a face with your point in red and the right one in green."""
    return {
        "picture": partial(_centroid, corners, [("yours", yours, WRONG), ("expected", truth, RIGHT)]),
        "handout": partial(_centroid, corners, [("yours", yours, WRONG)]),
    }


def _centroid(corners: FloatArray, points: Sequence[tuple[str, FloatArray, str]]) -> Scene:
    face = mesh_scene((corners, [list(range(len(corners)))])).panels[0]
    layers: list[Layer] = [*face.layers]
    for name, point, colour in points:
        layers.append(Points(point[None], (colour,), size=7.0, hidden="show"))
        layers.append(Labels(point[None], (name,), (colour,), place="beside", hidden="show"))
    return Scene((replace(face, layers=tuple(layers)),), alt="The face, with the point that was returned.")


def of_surface(vertices: FloatArray, faces: Sequence[Sequence[int]], marked: Sequence[int] = ()) -> Draw:
    """Show the faces as they were returned, their backs in another colour, with some vertices marked."""
    return partial(_surface, vertices, faces, marked)


def _surface(vertices: FloatArray, faces: Sequence[Sequence[int]], marked: Sequence[int]) -> Scene:
    labels = "vertices" if len(vertices) <= 30 else None
    scene = mesh_scene((vertices, faces), labels=labels, title="yours; backs of faces are orange")
    if not len(marked):
        return scene
    panel = scene.panels[0]
    outline = Curves((vertices[list(marked)],), (WRONG,), width=2.2, closed=len(marked) > 2, hidden="show")
    return replace(scene, panels=(replace(panel, layers=(*panel.layers, outline)),))


def of_neighbours(mesh: HalfedgeMesh, v: int, order: Sequence[int]) -> Draw:
    """Number the neighbours of `v` in the order that was returned."""
    known = [int(w) for w in order if 0 <= w < mesh.n_vertices]
    return partial(neighbours_scene, mesh, v, known)


def of_flip(before: HalfedgeMesh, after: HalfedgeMesh, h: int) -> Draw:
    """Show an edge before and after its flip, both seen from above the edge."""
    return partial(_flip, before, after, h)


def _flip(before: HalfedgeMesh, after: HalfedgeMesh, h: int) -> Scene:
    camera = _above(before, h)
    edge = [h, int(before.twin[h])]
    scenes = [halfedge_scene(before, highlight=edge, title="before", direction=camera.direction)]
    if (after.n_vertices, after.n_halfedges) == (before.n_vertices, before.n_halfedges):
        placed = after.with_vertices(before.vertices)
        scenes.append(halfedge_scene(placed, highlight=edge, title="after", direction=camera.direction))
    return side_by_side(
        [replace(scene, panels=(replace(scene.panels[0], camera=camera),)) for scene in scenes]
    )


def _above(mesh: HalfedgeMesh, h: int) -> Camera:
    """Look along the mean normal of the two triangles at an edge, at their four corners."""
    x, t = positions(mesh), mesh.twin[h]
    p, q, r, s = x[mesh.origin[[h, t, mesh.prev[h], mesh.prev[t]]]]
    normal = np.cross(q - p, r - p) + np.cross(p - q, s - q)
    middle = (p + q + r + s) / 4
    radius = 1.25 * max(float(np.linalg.norm(corner - middle)) for corner in (p, q, r, s))
    up = np.cross(normal, q - p)  # the edge lies level before the flip
    return Camera(direction=tuple(normal), up=tuple(up), focus=tuple(middle), radius=radius)
