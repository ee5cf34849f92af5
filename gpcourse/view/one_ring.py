"""The neighbours of a vertex in the order in which somebody returned them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from reprlib import repr as short

import numpy as np

from gpcourse.errors import ArrayError
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray, flatten_polygons
from gpcourse.view.camera import area_vectors, is_flat
from gpcourse.view.checks import as_index
from gpcourse.view.colours import (
    FACE_HALFEDGE,
    FAR,
    FRONT,
    HIGHLIGHT,
    HOLE_HALFEDGE,
    INK,
    PALETTE,
)
from gpcourse.view.compose import camera_for, vertex_labels
from gpcourse.view.scene import Arrows, Camera, Labels, Layer, Mesh, Panel, Points, Scene
from gpcourse.view.subject import as_subject


def neighbours_scene(
    subject: object,
    vertex: int,
    order: Sequence[int],
    *,
    title: str = "",
    direction: object = None,
    alt: str | None = None,
) -> Scene:
    """Number the neighbours of a vertex in the order given, with arrows from each to the next.

    A name in `order` that is not joined to the vertex by an edge is drawn in red, and a neighbour that
    `order` leaves out is ringed in orange.

    Parameters
    ----------
    subject : HalfedgeMesh, shape, or (vertices, faces)
    vertex : int
    order : list of ints
        As a student's function returned it.

    Raises
    ------
    ArrayError
        If `vertex` or a name in `order` is not a vertex.
    """
    vertices, faces = as_subject(subject)
    v = as_index(vertex, len(vertices), "vertex")
    try:
        named = list(order)
    except TypeError:
        raise ArrayError(f"order is {short(order)}; give a list of vertices") from None
    around = [as_index(w, len(vertices), f"order[{i}]") for i, w in enumerate(named)]
    corners, sizes = flatten_polygons(faces, len(vertices))
    ring, near = _ring(corners, sizes, v)
    areas = area_vectors(vertices, corners, sizes)
    camera = _ring_camera(vertices, areas, near, sorted({v, *ring, *around}), direction)
    colours = tuple(FRONT if touches else FAR for touches in near.tolist())
    layers: list[Layer] = [Mesh(vertices, faces, face_colours=colours)]
    layers += _order_layers(vertices, v, around, ring)
    missing = sorted(ring - set(around))
    if missing:
        layers.append(Points(vertices[missing], (PALETTE["orange"],), size=9.0, hidden="show"))
    numbered = sorted({v} | ring | set(around))
    layers += vertex_labels(vertices[numbered], numbered)
    layers.append(Points(vertices[[v]], (HIGHLIGHT,), size=8.0))
    words = _order_described(v, around, ring, missing) if alt is None else alt
    text = f"{title.rstrip('.:')}: {words}" if title and alt is None else words
    return Scene((Panel(tuple(layers), title, camera),), alt=text)


def _ring(corners: IntArray, sizes: IntArray, v: int) -> tuple[set[int], BoolArray]:
    """Return the vertices joined to `v` by an edge, in no order, and which faces touch it."""
    face = np.repeat(np.arange(len(sizes)), sizes)
    ends = np.cumsum(sizes)
    following = np.arange(1, len(corners) + 1)
    following[ends - 1] = ends - sizes
    at = corners == v
    ring = set(corners[following[at]].tolist()) | set(corners[at[following]].tolist())
    near = np.zeros(len(sizes), dtype=bool)
    near[face[at]] = True
    return ring, near


def _ring_camera(
    vertices: FloatArray, areas: FloatArray, near: BoolArray, named: list[int], direction: object
) -> Camera:
    camera = camera_for(vertices, areas, direction)
    normal = areas[near].sum(axis=0)
    if direction is None and np.linalg.norm(normal) > 0 and not is_flat(vertices):
        # The ring is seen best from over the vertex, a little from the side.
        x, y, z = (normal / np.linalg.norm(normal) + 0.2 * np.array([0.3, -0.8, 0.5])).tolist()
        camera = Camera((x, y, z), (0.0, 0.0, 1.0) if abs(z) < 0.9 else (0.0, 1.0, 0.0))
    middle = (vertices[named].min(axis=0) + vertices[named].max(axis=0)) / 2
    reach = float(np.linalg.norm(vertices[named] - middle, axis=1).max())
    if 1.6 * reach < np.linalg.norm(np.ptp(vertices, axis=0)) / 2 and reach > 0:
        x, y, z = middle.tolist()
        return replace(camera, focus=(x, y, z), radius=1.1 * reach)
    return camera


def _order_layers(vertices: FloatArray, v: int, around: list[int], ring: set[int]) -> list[Layer]:
    """Return spokes, numbered badges on them, and arrows from badge to badge."""
    if not around:
        return []
    spokes = vertices[around]
    badges = vertices[v] + 0.62 * (spokes - vertices[v])
    colours = tuple(FACE_HALFEDGE if w in ring else HOLE_HALFEDGE for w in around)
    places = Labels(
        badges, tuple(str(i + 1) for i in range(len(around))), colours, "badge", size=7.5, hidden="show"
    )
    layers: list[Layer] = []
    if len(around) > 1:
        step = badges[1:] - badges[:-1]
        layers.append(
            Arrows(badges[:-1] + 0.24 * step, badges[1:] - 0.24 * step, (INK,), width=1.3, hidden="show")
        )
    stray = [i for i, w in enumerate(around) if w not in ring and w != v]
    if stray:
        tails = np.repeat(vertices[[v]], len(stray), axis=0)
        layers.append(Arrows(tails, spokes[stray], (HOLE_HALFEDGE,), width=1.0, hidden="show"))
    return [*layers, places]


def _order_described(v: int, around: list[int], ring: set[int], missing: list[int]) -> str:
    names = ", ".join(str(w) for w in around) or "none"
    words = f"Vertex {v} and its neighbours in the order returned: {names}"
    stray = [str(w) for w in around if w not in ring]
    if stray:
        words += f"; not neighbours: {', '.join(stray)}"
    if missing:
        words += f"; left out: {', '.join(map(str, missing))}"
    return words + "."
