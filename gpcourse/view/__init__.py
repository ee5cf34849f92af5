"""Pictures of meshes, half-edges, points and curves.

In a notebook::

    from gpcourse import view

    view.mesh(torus, gaussian_curvature, value_name="K")
    view.halfedges(cube, highlight=[0, 5])
    view.side_by_side(view.mesh(before), view.mesh(after))
    view.animation([view.mesh(state) for state in flow], names=["start", "one step", "two steps"])

Each returns a `Picture`. What it shows is plain data (`picture.scene`), made without a drawing
library; the drawing itself is behind `gpcourse.view.static`. Code that is not a notebook makes scenes
with `mesh_scene`, `halfedge_scene` and their like and draws them when it needs to.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from gpcourse.errors import ArrayError
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh
from gpcourse.view import scene
from gpcourse.view.compose import curves_scene, mesh_scene, points_scene
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
    "mesh",
    "mesh_scene",
    "neighbours",
    "neighbours_scene",
    "points",
    "points_scene",
    "scene",
    "side_by_side",
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

    The settings are those of `mesh_scene`: ``title, direction, smooth, edges, colour, face_colours,
    values_on, colour_map, limits, value_name, alt``. With ``static=True`` it cannot be turned.
    """
    if labels == "halfedges" and isinstance(subject, HalfedgeMesh):
        if values is not None:
            raise ArrayError("values cannot be shown under numbered half-edges; leave out one of the two")
        return Picture(halfedge_scene(subject, **settings), static=static)
    return Picture(mesh_scene(subject, values, labels=labels, **settings), static=static)


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
    return Picture(halfedge_scene(mesh, highlight, **settings), static=static)


def neighbours(
    subject: object, vertex: int, order: Sequence[int], *, static: bool | None = None, **settings: Any
) -> Picture:
    """Number the neighbours of a vertex in the order given. Settings: ``title, direction, alt``."""
    return Picture(neighbours_scene(subject, vertex, order, **settings), static=static)


def points(
    positions: object, values: object = None, *, static: bool | None = None, **settings: Any
) -> Picture:
    """Show points. Settings: ``colour, size, title, direction, colour_map, limits, value_name, alt``."""
    return Picture(points_scene(positions, values, **settings), static=static)


def curves(lines: object, *, static: bool | None = None, **settings: Any) -> Picture:
    """Show one curve or several. Settings: ``colours, closed, on, width, title, direction, alt``."""
    return Picture(curves_scene(lines, **settings), static=static)


def side_by_side(
    *pictures: Picture | Scene, shared_scale: bool = True, static: bool | None = None, alt: str | None = None
) -> Picture:
    """Put pictures in a row; values in all of them are coloured by one scale if `shared_scale`."""
    scenes = [picture.scene if isinstance(picture, Picture) else picture for picture in pictures]
    return Picture(scene.side_by_side(scenes, shared_scale=shared_scale, alt=alt), static=static)


def animation(
    frames: Sequence[Picture | Scene],
    *,
    names: Sequence[str] | None = None,
    static: bool | None = None,
    alt: str | None = None,
) -> Picture:
    """Show pictures one at a time, with a slider; the still image has up to four of them in a row.

    Parameters
    ----------
    frames : list of pictures
        Of equally many panels. All are seen from where the first is seen.
    names : list of str, optional
        Written beside the slider; "0", "1", … if they are not given.

    Raises
    ------
    ArrayError
        If there is no frame, if panels or names do not match.
    """
    scenes = [frame.scene if isinstance(frame, Picture) else frame for frame in frames]
    texts = [str(i) for i in range(len(scenes))] if names is None else [str(name) for name in names]
    if not scenes:
        raise ArrayError("an animation needs at least one frame")
    if len(texts) != len(scenes):
        raise ArrayError(f"there are {len(texts)} names for {len(scenes)} frames; give one for each")
    for i, one in enumerate(scenes):
        if not isinstance(one, Scene):
            raise ArrayError(f"frame {i} is a {type(one).__name__}; give pictures of gpcourse.view")
        if len(one.panels) != len(scenes[0].panels):
            raise ArrayError(
                f"frame {i} has {len(one.panels)} panels and frame 0 has {len(scenes[0].panels)}"
            )
    count = min(4, len(scenes))
    shown = [scenes[i * (len(scenes) - 1) // max(1, count - 1)] for i in range(count)]
    still = scene.side_by_side(shown, shared_scale=False, alt=alt)
    return Picture(still, static=static, frames=list(zip(texts, scenes, strict=True)))
