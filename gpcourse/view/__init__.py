"""Pictures of meshes, half-edges, points and curves.

In a notebook::

    from gpcourse import view

    view.mesh(torus, gaussian_curvature, value_name="K")
    view.halfedges(cube, highlight=[0, 5])
    view.side_by_side(view.mesh(before), view.mesh(after))

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


def mesh(subject: object, values: object = None, *, labels: str | None = None, **settings: Any) -> Picture:
    """Show a mesh, plain or coloured by values; ``labels="halfedges"`` is `halfedges`.

    The settings are those of `mesh_scene`: ``title, direction, smooth, edges, colour, face_colours,
    values_on, colour_map, limits, value_name, alt``.
    """
    if labels == "halfedges" and isinstance(subject, HalfedgeMesh):
        if values is not None:
            raise ArrayError("values cannot be shown under numbered half-edges; leave out one of the two")
        return Picture(halfedge_scene(subject, **settings))
    return Picture(mesh_scene(subject, values, labels=labels, **settings))


def halfedges(
    mesh: HalfedgeMesh, highlight: Mapping[int, str] | Sequence[int] | None = None, **settings: Any
) -> Picture:
    """Draw every half-edge as a numbered arrow inside its face; `highlight` some of them.

    The settings are those of `halfedge_scene`: ``faces, labels, vertex_numbers, title, direction, alt``.
    """
    return Picture(halfedge_scene(mesh, highlight, **settings))


def neighbours(subject: object, vertex: int, order: Sequence[int], **settings: Any) -> Picture:
    """Number the neighbours of a vertex in the order given. Settings: ``title, direction, alt``."""
    return Picture(neighbours_scene(subject, vertex, order, **settings))


def points(positions: object, values: object = None, **settings: Any) -> Picture:
    """Show points. Settings: ``colour, size, title, direction, colour_map, limits, value_name, alt``."""
    return Picture(points_scene(positions, values, **settings))


def curves(lines: object, **settings: Any) -> Picture:
    """Show one curve or several. Settings: ``colours, closed, on, width, title, direction, alt``."""
    return Picture(curves_scene(lines, **settings))


def side_by_side(*pictures: Picture | Scene, shared_scale: bool = True, alt: str | None = None) -> Picture:
    """Put pictures in a row; values in all of them are coloured by one scale if `shared_scale`."""
    scenes = [picture.scene if isinstance(picture, Picture) else picture for picture in pictures]
    return Picture(scene.side_by_side(scenes, shared_scale=shared_scale, alt=alt))
