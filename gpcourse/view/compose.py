"""Scenes of meshes, points and curves, with a description in words made from the data."""

from __future__ import annotations

from collections.abc import Sequence, Sized
from typing import Any

import numpy as np

from gpcourse.errors import ArrayError
from gpcourse.geometry.arrays import FloatArray, flatten_polygons
from gpcourse.view.camera import FEW, area_vectors, facing, good_camera, is_flat, telling_camera
from gpcourse.view.checks import as_flag, as_positive, as_texts, as_vector
from gpcourse.view.colours import FRONT, INK, as_colour
from gpcourse.view.scene import Arrows, Camera, Curves, Labels, Layer, Mesh, Panel, Points, Scene
from gpcourse.view.subject import as_subject, lifted


def mesh_scene(
    subject: object,
    values: object = None,
    *,
    labels: str | None = None,
    title: str = "",
    direction: object = None,
    smooth: bool = False,
    edges: bool | None = None,
    colour: str = FRONT,
    face_colours: object = None,
    vertex_colours: object = None,
    values_on: str | None = None,
    colour_map: str | None = None,
    limits: tuple[float, float] | None = None,
    value_name: str = "",
    alt: str | None = None,
) -> Scene:
    """Show a mesh, plain or coloured by values.

    Parameters
    ----------
    subject : HalfedgeMesh, shape, or (vertices, faces)
    values : (n,) or (m,) float array, optional
        One per vertex or one per face (per vertex if n = m, unless `values_on` says otherwise).
    labels : None, "vertices" or "faces"
        Number the vertices or the faces.
    direction : 3 floats, optional
        From the mesh towards the viewer.
    face_colours, vertex_colours : names, or (k, 3) float array of red, green, blue from 0 to 1
        One for each face, or for each vertex and blended between them.
    smooth, edges : bool
        Shade with vertex normals; draw edges (by default on up to 3000 faces that are not smooth).
    alt : str, optional
        The description in words; made from the data if it is not given.

    Raises
    ------
    ArrayError, MeshError
        If an argument cannot be drawn; the message names it.
    """
    vertices, faces = as_subject(subject)
    corners, sizes = flatten_polygons(faces, len(vertices))
    if labels not in (None, "vertices", "faces"):
        raise ArrayError(
            f"labels is {labels!r}; it must be None, 'vertices', 'faces', or 'halfedges' for a HalfedgeMesh"
        )
    if values is not None and values_on is None:
        counts = (len(vertices), len(sizes))
        values_on = "faces" if _length(values) == counts[1] != counts[0] else "vertices"
    surface = Mesh(
        vertices,
        faces,
        colour=colour,
        face_colours=face_colours,  # type: ignore[arg-type]  # converted in __post_init__, as are the next two
        vertex_colours=vertex_colours,  # type: ignore[arg-type]
        values=values,  # type: ignore[arg-type]
        values_on=values_on or "vertices",
        colour_map=colour_map,
        limits=limits,
        value_name=value_name,
        edges=(not as_flag(smooth, "smooth") and len(sizes) <= 3000) if edges is None else edges,
        hidden_edges=labels is not None and len(sizes) <= FEW,
        smooth=smooth,
    )
    layers: list[Layer] = [surface, *_numbers(labels, vertices, corners, sizes)]
    camera = camera_for(vertices[np.unique(corners)], area_vectors(vertices, corners, sizes), direction)
    words = f"{described(len(vertices), sizes)}{_numbered(labels)}{_coloured(surface)}."
    return Scene((Panel(tuple(layers), title, camera),), alt=_alt(alt, title, words))


def points_scene(
    positions: object,
    values: object = None,
    *,
    colour: str = "blue",
    size: float | None = None,
    title: str = "",
    direction: object = None,
    colour_map: str | None = None,
    limits: tuple[float, float] | None = None,
    value_name: str = "",
    alt: str | None = None,
) -> Scene:
    """Show (n, 3) or (n, 2) points, in one colour or coloured by (n,) values."""
    places = lifted(positions, "points")
    layer = Points(
        places,
        (as_colour(colour),),
        values=values,  # type: ignore[arg-type]  # converted in __post_init__
        colour_map=colour_map,
        limits=limits,
        value_name=value_name,
        size=float(np.clip(60 / max(1, len(places)) ** 0.4, 1.6, 5.0)) if size is None else size,
    )
    words = f"A cloud of {len(places)} points{_coloured(layer)}."
    panel = Panel((layer,), title, camera_for(places, None, direction))
    return Scene((panel,), alt=_alt(alt, title, words))


def curves_scene(
    lines: object,
    *,
    colours: object = ("blue",),
    closed: bool = False,
    on: object = None,
    width: float = 1.6,
    title: str = "",
    direction: object = None,
    alt: str | None = None,
) -> Scene:
    """Show curves, each a (k, 3) or (k, 2) array, alone or `on` a mesh."""
    many = lines if isinstance(lines, (list, tuple)) and not _is_one_curve(lines) else [lines]
    curves = tuple(lifted(line, f"lines[{i}]") for i, line in enumerate(many))
    points = np.concatenate(curves) if curves else np.zeros((1, 3))
    layers, points, normals, where = _ground(on, points)
    words = ("A curve" if len(curves) == 1 else f"{len(curves)} curves") + where
    layers.append(Curves(curves, colours, width=width, closed=closed))  # type: ignore[arg-type]  # as above
    panel = Panel(tuple(layers), title, camera_for(points, normals, direction))
    return Scene((panel,), alt=_alt(alt, title, f"{words}."))


def vectors_scene(
    at: object,
    vectors: object,
    *,
    on: object = None,
    colour: str = "blue",
    scale: float | None = None,
    title: str = "",
    direction: object = None,
    alt: str | None = None,
) -> Scene:
    """Show arrows: (k, 3) or (k, 2) `vectors` that begin `at` as many points, alone or `on` a mesh.

    The arrows are `scale` times as long as the vectors; by default the longest is an eighth of the scene.

    Raises
    ------
    ArrayError
        If there are not as many vectors as points; the message gives both numbers.
    """
    tails, arrows = lifted(at, "at"), lifted(vectors, "vectors")
    if scale is not None:
        scale = as_positive(scale, "scale")
    if len(tails) != len(arrows):
        raise ArrayError(f"there are {len(arrows)} vectors for {len(tails)} points; give one for each")
    layers, points, normals, where = _ground(on, tails)
    length = np.linalg.norm(arrows, axis=1)
    longest = float(length.max(initial=0.0))
    if scale is None:
        size = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
        scale = 0.125 * (size or 8 * longest or 1.0) / (longest or 1.0)
    if scale * longest > 1e50:
        raise ArrayError(
            f"scale is {scale:.3g}, and arrows get {scale * longest:.3g} long; give a smaller one"
        )
    drawn = length > 0
    layers.append(Arrows(tails[drawn], (tails + scale * arrows)[drawn], (as_colour(colour),), width=1.2))
    words = f"{_count(len(arrows), 'arrow')}{where}; the longest stands for {longest:.3g}."
    panel = Panel(tuple(layers), title, camera_for(points, normals, direction))
    return Scene((panel,), alt=_alt(alt, title, words))


def labels_scene(
    positions: object,
    texts: object,
    *,
    on: object = None,
    colour: str = "black",
    title: str = "",
    direction: object = None,
    alt: str | None = None,
) -> Scene:
    """Write a text beside each of (k, 3) or (k, 2) points, marked by dots, alone or `on` a mesh.

    Raises
    ------
    ArrayError
        If there are not as many texts as points; the message gives both numbers.
    """
    places = lifted(positions, "positions")
    words = as_texts(texts, len(places), exactly=True)
    layers, points, normals, where = _ground(on, places)
    dots, names = vertex_labels(places, words, colours=(as_colour(colour),))
    panel = Panel((*layers, dots, names), title, camera_for(points, normals, direction))
    named = f": {', '.join(words)}" if 0 < len(words) <= FEW else ""
    return Scene((panel,), alt=_alt(alt, title, f"{_count(len(words), 'label')}{where}{named}."))


def _ground(on: object, points: FloatArray) -> tuple[list[Layer], FloatArray, FloatArray | None, str]:
    """Return the surface that something is drawn on, what decides the camera, and words for it."""
    if on is None:
        return [], points, None, ""
    vertices, faces = as_subject(on)
    corners, sizes = flatten_polygons(faces, len(vertices))
    surface = Mesh(vertices, faces, edges=len(sizes) <= 3000)
    words = f" on {described(len(vertices), sizes).lower()}"
    return [surface], vertices, area_vectors(vertices, corners, sizes), words


def camera_for(points: FloatArray, normals: FloatArray | None, direction: object) -> Camera:
    """Return the camera that is asked for, or a good one."""
    usual = good_camera(points, normals)
    if direction is None:
        return usual
    x, y, z = as_vector(direction, "direction")
    steep = abs(z) > 0.99 * float(np.linalg.norm([x, y, z]))
    return Camera((x, y, z), (0.0, 1.0, 0.0) if steep else (0.0, 0.0, 1.0))


def camera_at(normal: FloatArray, points: FloatArray, normals: FloatArray) -> Camera:
    """Return a camera that sees what has this normal; straight on if the whole mesh is flat."""
    usual = good_camera(points, normals)
    if is_flat(points):
        return usual
    length = float(np.linalg.norm(normal))
    toward = np.array(usual.direction) / np.linalg.norm(usual.direction)
    if length == 0 or normal @ toward > 0.6 * length:
        return usual
    if len(normals) <= FEW:
        return telling_camera(points, normals, normal / length)
    return facing(normal)


def vertex_labels(positions: FloatArray, names: Sequence[object], **settings: Any) -> list[Layer]:
    """Return dots on vertices and their names beside them."""
    texts = tuple(str(name) for name in names)
    return [
        Points(positions, (INK,), size=4.6 if len(texts) <= 60 else 3.0),
        Labels(positions, texts, place="beside", **settings),
    ]


def described(n_vertices: int, sizes: Any) -> str:
    """Return "A mesh of 8 vertices and 6 quads"."""
    kinds = {3: "triangle", 4: "quad"}
    sorts = np.unique(sizes).tolist()
    kind = kinds.get(sorts[0], f"{sorts[0]}-gon") if len(sorts) == 1 else "polygon"
    return f"A mesh of {_count(n_vertices, 'vertex', 'vertices')} and {_count(len(sizes), kind)}"


def _count(n: int, one: str, many: str | None = None) -> str:
    return f"{n} {one}" if n == 1 else f"{n} {many or one + 's'}"


def _numbers(labels: str | None, vertices: FloatArray, corners: Any, sizes: Any) -> list[Layer]:
    if labels == "vertices":
        used = np.unique(corners)
        return vertex_labels(vertices[used], used.tolist(), hidden="fade" if len(sizes) <= FEW else "hide")
    if labels == "faces" and len(sizes):
        sums = np.add.reduceat(vertices[corners], np.cumsum(sizes) - sizes)
        return [Labels(sums / sizes[:, None], tuple(map(str, range(len(sizes)))), hidden="hide")]
    return []


def _numbered(labels: str | None) -> str:
    return f", the {labels} numbered" if labels else ""


def _coloured(layer: Mesh | Points) -> str:
    if layer.values is None:
        return ""
    known = layer.values[np.isfinite(layer.values)]
    name = layer.value_name or "the values"
    if not len(known):
        return f"; {name} are not finite anywhere"
    missing = len(layer.values) - len(known)
    grey = f"; {missing} values are not finite and shown in grey" if missing else ""
    return f"; colour shows {name}, from {known.min():.3g} to {known.max():.3g}{grey}"


def _alt(alt: str | None, title: str, words: str) -> str:
    if alt is not None:
        return str(alt)
    return f"{str(title).rstrip('.:')}: {words}" if title else words


def _length(values: object) -> int:
    return len(values) if isinstance(values, Sized) and not hasattr(values, "toarray") else 0


def _is_one_curve(lines: Any) -> bool:
    try:
        return len(lines) > 0 and np.ndim(lines[0]) == 1
    except ValueError:
        return False
