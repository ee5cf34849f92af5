"""Every half-edge as an arrow inside its face.

Meshes that are wrong must be shown too: that is when a student needs the picture.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gpcourse.errors import ArrayError
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh
from gpcourse.view.camera import FEW, area_vectors
from gpcourse.view.checks import as_flag, as_index
from gpcourse.view.colours import (
    FACE_HALFEDGE,
    HIGHLIGHT,
    HOLE_HALFEDGE,
    PALE,
    QUIET_HALFEDGE,
    as_colour,
)
from gpcourse.view.compose import camera_at, camera_for, described, vertex_labels
from gpcourse.view.scene import Arrows, Camera, Layer, Mesh, Panel, Scene
from gpcourse.view.subject import face_loops, halfedge_heads, halfedge_positions, left_face

#: How far an arrow stands off its edge, as a fraction of the way to the middle of the face,
#: and how much it is cut at both ends.
STAND_OFF, TRIM = 0.2, 0.1
#: Above this many half-edges only those near the highlighted ones are drawn.
CROWD = 400


def halfedge_scene(
    mesh: HalfedgeMesh,
    highlight: Mapping[int, str] | Sequence[int] | None = None,
    *,
    faces: object = None,
    labels: bool = True,
    vertex_numbers: bool = True,
    title: str = "",
    direction: object = None,
    alt: str | None = None,
) -> Scene:
    """Draw every half-edge as an arrow to the left of its edge, inside its face, with its number.

    Half-edges of holes lie outside, in red. A mesh with wrong records is drawn as far as they go.

    Parameters
    ----------
    mesh : HalfedgeMesh
        With positions.
    highlight : {half-edge: colour} or list of half-edges, optional
        Drawn bold; the picture is taken from where they are seen, and closer on a large mesh.
    faces : list of index lists, optional
        The surface beneath the arrows, if the records are not to be trusted with it.
    labels, vertex_numbers : bool
        Number the half-edges; number the vertices.

    Raises
    ------
    ArrayError
        If the mesh has no positions, or a highlighted half-edge does not exist.
    """
    labels, vertex_numbers = as_flag(labels, "labels"), as_flag(vertex_numbers, "vertex_numbers")
    vertices = halfedge_positions(mesh)
    chosen = _highlighted(highlight, mesh.n_halfedges)
    surface = Mesh(vertices, face_loops(mesh) if faces is None else faces, colour=PALE)
    corners, sizes = surface.polygons
    surface = replace(surface, hidden_edges=len(sizes) <= FEW)
    lie = _layout(mesh, vertices, area_vectors(vertices, corners, sizes).sum(axis=0))
    camera = _camera(lie, list(chosen), vertices, surface, direction)
    shown = lie.drawn & _near(lie, list(chosen), camera, mesh.n_halfedges)
    layers: list[Layer] = [surface, *_arrows(lie, shown, chosen, mesh, labels)]
    if vertex_numbers:
        ends = np.union1d(mesh.origin[shown], lie.heads[shown])
        layers += vertex_labels(vertices[ends], ends.tolist(), hidden="fade" if len(sizes) <= FEW else "hide")
    words = _described(mesh, sizes, lie, chosen) if alt is None else alt
    text = f"{title.rstrip('.:')}: {words}" if title and alt is None else words
    return Scene((Panel(tuple(layers), title, camera),), alt=text)


@dataclass(frozen=True, eq=False)
class _Lie:
    """Where the arrows of all half-edges lie; `drawn` tells which of them can be drawn at all."""

    tails: FloatArray
    tips: FloatArray
    sides: FloatArray
    normals: FloatArray
    heads: IntArray
    drawn: BoolArray


def _layout(mesh: HalfedgeMesh, vertices: FloatArray, outwards: FloatArray) -> _Lie:
    heads = halfedge_heads(mesh)
    drawn = heads >= 0
    origin = np.where(drawn, mesh.origin, 0)
    at = np.where(drawn, heads, 0)
    place = vertices if len(vertices) else np.zeros((1, 3))
    tail, head = place[origin], place[at]
    beside, own = left_face(mesh)
    middles = _face_middles(mesh, place, origin, drawn)
    # Without a face on either side the arrow is pushed away from the middle of the mesh.
    middle = np.where((beside >= 0)[:, None], middles[beside], place.mean(axis=0))
    inwards = middle - (tail + head) / 2
    edge = head - tail
    length = np.linalg.norm(edge, axis=1)
    drawn &= length > 0
    along = edge / np.where(length > 0, length, 1.0)[:, None]
    across = inwards - (inwards * along).sum(axis=1, keepdims=True) * along
    slide = STAND_OFF * (inwards - across)
    # Inside its face an arrow follows the face's shape; beside a hole it mirrors its twin's.
    reach = np.where(own[:, None], 1.0, -1.0) * STAND_OFF * across
    cut = (STAND_OFF / 2 + TRIM) * edge
    tails, tips = tail + cut + reach + slide, head - cut + reach + slide
    normals = np.cross(along, np.where(own[:, None], across, -across))
    normals = np.where((beside >= 0)[:, None], normals, outwards)
    return _Lie(tails, tips, reach, normals, heads, drawn)


def _face_middles(mesh: HalfedgeMesh, vertices: FloatArray, origin: IntArray, drawn: BoolArray) -> FloatArray:
    """Return the mean of the origins of the half-edges that claim each face; the last row is spare."""
    claims = drawn & (mesh.face >= 0) & (mesh.face < mesh.n_faces)
    sums, counts = np.zeros((mesh.n_faces + 1, 3)), np.zeros(mesh.n_faces + 1)
    np.add.at(sums, mesh.face[claims], vertices[origin[claims]])
    np.add.at(counts, mesh.face[claims], 1)
    return sums / np.maximum(counts, 1)[:, None]


def _camera(lie: _Lie, chosen: list[int], vertices: FloatArray, surface: Mesh, direction: object) -> Camera:
    corners, sizes = surface.polygons
    areas = area_vectors(vertices, corners, sizes)
    points = vertices[np.unique(corners)] if len(corners) else vertices
    chosen = [h for h in chosen if lie.drawn[h]]
    if direction is not None or not chosen:
        camera = camera_for(points, areas, direction)
    else:
        units = lie.normals[chosen] / np.maximum(np.linalg.norm(lie.normals[chosen], axis=1), 1e-300)[:, None]
        camera = camera_at(units.sum(axis=0), points, areas)
    if len(lie.tails) > CROWD and chosen:
        focus = (lie.tails[chosen] + lie.tips[chosen]).mean(axis=0) / 2
        reach = np.linalg.norm(lie.tips[chosen] - focus, axis=1).max()
        step = np.median(np.linalg.norm(lie.tips[chosen] - lie.tails[chosen], axis=1))
        x, y, z = focus.tolist()
        camera = replace(camera, focus=(x, y, z), radius=float(reach + 2.2 * step))
    return camera


def _near(lie: _Lie, chosen: list[int], camera: Camera, count: int) -> BoolArray:
    """Choose the arrows to draw: all, or in a crowd those around the focus."""
    if count <= CROWD or camera.focus is None:
        return np.ones(count, dtype=bool)
    distance = np.linalg.norm((lie.tails + lie.tips) / 2 - np.array(camera.focus), axis=1)
    near = np.zeros(count, dtype=bool)
    near[np.argsort(distance, kind="stable")[:120]] = True
    near[chosen] = True
    return near


def _arrows(
    lie: _Lie, shown: BoolArray, chosen: dict[int, str], mesh: HalfedgeMesh, labels: bool
) -> list[Layer]:
    bold = np.zeros(len(shown), dtype=bool)
    bold[list(chosen)] = True
    quiet = QUIET_HALFEDGE if chosen else FACE_HALFEDGE
    layers: list[Layer] = []
    for emphasised in (False, True):
        which = np.flatnonzero(shown & (bold == emphasised))
        if not len(which):
            continue
        usual = [HOLE_HALFEDGE if mesh.face[h] < 0 else quiet for h in which.tolist()]
        colours = [chosen[h] for h in which.tolist()] if emphasised else usual
        layers.append(
            Arrows(
                lie.tails[which],
                lie.tips[which],
                tuple(colours),
                tuple(str(h) for h in which.tolist()) if labels else (),
                lie.sides[which],
                width=2.0 if emphasised else 0.9,
                hidden="fade" if emphasised else "hide",
            )
        )
    return layers


def _described(mesh: HalfedgeMesh, sizes: Any, lie: _Lie, chosen: dict[int, str]) -> str:
    holes = int(np.count_nonzero(mesh.face < 0))
    lost = int(np.count_nonzero(~lie.drawn))
    words = described(mesh.n_vertices, sizes)
    words += f"; its {mesh.n_halfedges} half-edges are numbered arrows inside their faces"
    if holes:
        words += f", {holes} of them along holes, outside"
    if chosen:
        names = [str(h) for h in list(chosen)[:8]] + (["…"] if len(chosen) > 8 else [])
        words += f"; highlighted: {', '.join(names)}"
    if lost:
        words += f"; {lost} lead to no vertex and are not drawn"
    return words + "."


def _highlighted(highlight: object, count: int) -> dict[int, str]:
    if highlight is None:
        return {}
    if isinstance(highlight, Mapping):
        pairs = list(highlight.items())
    elif isinstance(highlight, (list, tuple, set, frozenset, range, np.ndarray)):
        pairs = [(h, HIGHLIGHT) for h in highlight]
    else:
        raise ArrayError(f"highlight is {highlight!r}; give a list of half-edges or {{half-edge: colour}}")
    return {as_index(h, count, "highlight"): as_colour(colour, f"highlight[{h}]") for h, colour in pairs}
