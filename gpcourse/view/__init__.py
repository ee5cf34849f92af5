"""Pictures of meshes, half-edges, points and curves.

In a notebook::

    from gpcourse import view

    view.mesh(torus, gaussian_curvature, value_name="K")
    view.halfedges(cube, highlight=[0, 5])
    view.side_by_side(view.mesh(before), view.mesh(after))

Each returns a `Picture`. In a notebook it can be turned (drag), zoomed (wheel, after a click) and asked
(hover); it is saved as PNG or HTML; ``static=True``, or GPCOURSE_STATIC=1 in the environment, gives an
image.

What a picture shows is plain data (`picture.scene`), made without a drawing library. Behind it are two
renderers, `gpcourse.view.static` (matplotlib) and `gpcourse.view.interactive` (a page of WebGL). Code that is
not a notebook makes scenes with `mesh_scene`, `halfedge_scene` and their like and draws them when needed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Sized
from dataclasses import replace
from reprlib import repr as short
from typing import Any

from gpcourse.errors import ArrayError
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh
from gpcourse.view import scene
from gpcourse.view.camera import positions as positions_of
from gpcourse.view.checks import check_settings
from gpcourse.view.compose import curves_scene, labels_scene, mesh_scene, points_scene, vectors_scene
from gpcourse.view.connectivity import halfedge_scene
from gpcourse.view.one_ring import neighbours_scene
from gpcourse.view.picture import Picture
from gpcourse.view.scene import Scene

__all__ = [
    "Picture",
    "Scene",
    "animation",
    "curves",
    "curves_scene",
    "halfedge_scene",
    "halfedges",
    "labels",
    "labels_scene",
    "mesh",
    "mesh_scene",
    "neighbours",
    "neighbours_scene",
    "points",
    "points_scene",
    "scene",
    "side_by_side",
    "together",
    "vectors",
    "vectors_scene",
]


def mesh(
    subject: object,
    values: object = None,
    *,
    labels: str | None = None,
    static: bool | None = None,
    **settings: Any,
) -> Picture:
    """Show a mesh, plain or coloured by values; ``labels="halfedges"`` is `halfedges`.

    A dictionary of values, by name, makes several fields; the picture shows the first, and a menu in a
    notebook the others. ``static=True`` gives a picture that does not turn.

    The settings are those of `mesh_scene`: ``title, direction, smooth, edges, colour, face_colours,
    vertex_colours, values_on, colour_map, limits, value_name, alt``.
    """
    if labels == "halfedges" and isinstance(subject, HalfedgeMesh):
        if values is not None:
            raise ArrayError("values cannot be shown under numbered half-edges; leave out one of the two")
        check_settings(settings, halfedge_scene, "view.mesh with labels='halfedges'")
        return Picture(halfedge_scene(subject, **settings), static=static)
    check_settings(settings, mesh_scene, "view.mesh")
    if isinstance(values, Mapping):
        if not values:
            raise ArrayError("there are no values in the dictionary; give at least one field by its name")
        names = tuple(map(str, values))
        fields = tuple(
            _field(subject, field, labels=labels, **(settings | {"value_name": name}))
            for name, field in zip(names, values.values(), strict=True)
        )
        return Picture(_seen(fields[0]), static=static, frames=fields, names=names, chooser="menu")
    return Picture(_seen(mesh_scene(subject, values, labels=labels, **settings)), static=static)


def _field(subject: object, values: object, *, value_name: str, **settings: Any) -> Scene:
    try:
        return mesh_scene(subject, values, value_name=value_name, **settings)
    except ArrayError as error:
        raise ArrayError(f"field {value_name!r}: {error}") from None


def _seen(one: Scene) -> Scene:
    """Return the scene; one without a single face, point or line says so in its title."""
    if any(len(cloud) for panel in one.panels for cloud in positions_of(panel.layers)):
        return one
    return replace(
        one, panels=tuple(replace(panel, title=f"nothing to see: {one.alt}") for panel in one.panels)
    )


def _scenes(pictures: Iterable[object]) -> list[Scene]:
    if isinstance(pictures, (Picture, Scene)):
        raise ArrayError("one picture is given where several are needed; give a list of pictures")
    if not isinstance(pictures, Iterable):
        raise ArrayError(f"pictures is a {type(pictures).__name__}; give a list of pictures")
    scenes = [picture.scene if isinstance(picture, Picture) else picture for picture in pictures]
    for i, one in enumerate(scenes):
        if not isinstance(one, Scene):
            many = isinstance(one, (list, tuple))
            hint = "give the pictures one by one" if many else "make one of it with view.mesh or its like"
            raise ArrayError(f"picture {i} is a {type(one).__name__}; {hint}")
    return scenes  # type: ignore[return-value]


def animation(
    pictures: Sequence[Picture | Scene],
    names: Sequence[str] | None = None,
    *,
    shared_scale: bool = True,
    alt: str | None = None,
    static: bool | None = None,
) -> Picture:
    """Show pictures one at a time, with a slider: a flow, an alignment. They keep one camera.

    Where nothing can move, three of them stand side by side: the first, the middle and the last one.

    Parameters
    ----------
    pictures : sequence of pictures
        The frames; all have as many panels as the first.
    names : sequence of str, optional
        What to call each, as "step 3".
    shared_scale : bool
        Colour the values in all frames by one scale.
    alt : str, optional
        What is to be seen, in words.

    Raises
    ------
    ArrayError
        If there are no pictures, their panels differ in number, or there are not as many names.
    """
    scenes = _scenes(pictures)
    if not scenes:
        raise ArrayError("there are no pictures; give at least one frame")
    for i, one in enumerate(scenes):
        if len(one.panels) != len(scenes[0].panels):
            raise ArrayError(
                f"frame {i} has {len(one.panels)} panels, the first has {len(scenes[0].panels)}; "
                "give frames with equally many"
            )
    if names is not None and (isinstance(names, str) or not isinstance(names, Sized)):
        raise ArrayError(f"names is {short(names)}; give a list of names, one for each frame")
    if names is not None and len(names) != len(scenes):
        raise ArrayError(f"there are {len(names)} names for {len(scenes)} frames; give one for each")
    called = tuple(str(name) for name in names) if names is not None else ()
    few = sorted({0, len(scenes) // 2, len(scenes) - 1})
    still = scene.side_by_side(
        [_titled(scenes[i], called[i] if called else "") for i in few], shared_scale=shared_scale, alt=alt
    )
    frames = scene.with_one_scale(scenes) if shared_scale else tuple(scenes)
    return Picture(still, static=static, frames=frames, names=called, chooser="slider")


def _titled(one: Scene, name: str) -> Scene:
    if not name:
        return one
    panels = tuple(
        replace(panel, title=f"{panel.title}, {name}" if panel.title else name) for panel in one.panels
    )
    return replace(one, panels=panels)


def halfedges(
    mesh: HalfedgeMesh,
    highlight: Mapping[int, str] | Sequence[int] | None = None,
    *,
    static: bool | None = None,
    **settings: Any,
) -> Picture:
    """Draw every half-edge as a numbered arrow inside its face; `highlight` some of them.

    The settings are those of `halfedge_scene`: ``faces, labels, vertex_numbers, title, direction, alt``.
    """
    check_settings(settings, halfedge_scene, "view.halfedges")
    return Picture(halfedge_scene(mesh, highlight, **settings), static=static)


def neighbours(
    subject: object, vertex: int, order: Sequence[int], *, static: bool | None = None, **settings: Any
) -> Picture:
    """Number the neighbours of a vertex in the order given. Settings: ``title, direction, alt``."""
    check_settings(settings, neighbours_scene, "view.neighbours")
    return Picture(neighbours_scene(subject, vertex, order, **settings), static=static)


def points(
    positions: object, values: object = None, *, static: bool | None = None, **settings: Any
) -> Picture:
    """Show (n, 3) or (n, 2) points.

    Settings: ``colour, size, title, direction, colour_map, limits, value_name, alt``.
    """
    check_settings(settings, points_scene, "view.points")
    return Picture(_seen(points_scene(positions, values, **settings)), static=static)


def curves(lines: object, *, static: bool | None = None, **settings: Any) -> Picture:
    """Show one curve or several. Settings: ``colours, closed, on, width, title, direction, alt``."""
    check_settings(settings, curves_scene, "view.curves")
    return Picture(_seen(curves_scene(lines, **settings)), static=static)


def vectors(at: object, vectors: object, *, static: bool | None = None, **settings: Any) -> Picture:
    """Show vectors as arrows. Settings: ``on, colour, scale, title, direction, alt``."""
    check_settings(settings, vectors_scene, "view.vectors")
    return Picture(_seen(vectors_scene(at, vectors, **settings)), static=static)


def labels(positions: object, texts: object, *, static: bool | None = None, **settings: Any) -> Picture:
    """Write a text beside each point. Settings: ``on, colour, title, direction, alt``."""
    check_settings(settings, labels_scene, "view.labels")
    return Picture(_seen(labels_scene(positions, texts, **settings)), static=static)


def together(*pictures: Picture | Scene, static: bool | None = None, alt: str | None = None) -> Picture:
    """Lay pictures of one panel over each other, seen as the first is seen: a mesh, points, arrows.

    Raises
    ------
    ArrayError
        If there is none, or one has several panels.
    """
    scenes = _scenes(pictures)
    if not scenes:
        raise ArrayError("there are no pictures; give at least one")
    for i, one in enumerate(scenes):
        if len(one.panels) != 1:
            raise ArrayError(
                f"picture {i} has {len(one.panels)} panels; pictures with one can be laid over each other"
            )
    layers = tuple(layer for one in scenes for layer in one.panels[0].layers)
    words = " ".join(one.alt for one in scenes) if alt is None else alt
    return Picture(Scene((replace(scenes[0].panels[0], layers=layers),), alt=words), static=static)


def side_by_side(
    *pictures: Picture | Scene, shared_scale: bool = True, static: bool | None = None, alt: str | None = None
) -> Picture:
    """Put pictures in a row; values in all of them are coloured by one scale if `shared_scale`."""
    scenes = _scenes(pictures)
    return Picture(scene.side_by_side(scenes, shared_scale=shared_scale, alt=alt), static=static)
