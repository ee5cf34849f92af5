"""The colour of every corner of a mesh: its own colour or its value, in the light of the camera."""

from __future__ import annotations

import numpy as np

from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.view.camera import area_vectors
from gpcourse.view.colours import BACK, NO_VALUE
from gpcourse.view.scene import ColourScale, Mesh, Points

#: Direction to the light in the camera's frame: over the viewer's left shoulder.
LIGHT = np.array([-0.5, 0.7, 1.0]) / np.linalg.norm([-0.5, 0.7, 1.0])
#: Light bends so far round a surface, so that what turns away is not all equally dark.
WRAP = 0.3
#: What is left in the shade, and where the colour is a value. The shader of the page has the same numbers.
AMBIENT, AMBIENT_OF_VALUES = 0.44, 0.72


def rgb(colour: str) -> FloatArray:
    """Return ``#rrggbb`` as three floats from 0 to 1."""
    return np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255


def value_colours(values: FloatArray, scale: ColourScale) -> FloatArray:
    """Return the (n, 3) colours of values; what is not finite is grey."""
    from matplotlib import colormaps

    known = np.isfinite(values)
    share = (np.where(known, values, scale.low) - scale.low) / (scale.high - scale.low)
    colours = np.asarray(colormaps[scale.colour_map](np.clip(share, 0, 1)))[:, :3]
    return np.where(known[:, None], colours, rgb(NO_VALUE))


def point_colours(points: Points, scale: ColourScale | None) -> FloatArray:
    """Return the (n, 3) colours of points."""
    if points.values is not None and scale is not None:
        return value_colours(points.values, scale)
    return many_rgb(points.colours)


def many_rgb(colours: tuple[str, ...]) -> FloatArray:
    """Return a (k, 3) array of colours."""
    known = {colour: rgb(colour) for colour in set(colours)}
    return np.array([known[colour] for colour in colours]).reshape(-1, 3)


def corner_colours(mesh: Mesh, axes: FloatArray, scale: ColourScale | None) -> FloatArray:
    """Return the (c, 3) colours of all corners of the polygons, in the order of `mesh.polygons`.

    Faces that turn their inner side to the viewer are shown in another colour, so that the
    orientation of an open mesh can be seen. The light leaves what faces the viewer unchanged.
    """
    corners, sizes = mesh.polygons
    face = np.repeat(np.arange(len(sizes)), sizes)
    areas = area_vectors(mesh.vertices, corners, sizes)
    away = (areas @ axes[2] < 0)[face]
    normals = areas[face]
    if mesh.smooth:
        sums = np.zeros_like(mesh.vertices)
        np.add.at(sums, corners, normals)
        normals = sums[corners]
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    seen = normals / np.where(length > 0, length, 1.0) @ axes.T
    seen = np.where(away[:, None], -seen, seen)
    valued = mesh.values is not None and scale is not None
    base = _base(mesh, corners, face, scale)
    back = 0.55 * base + 0.45 * rgb(NO_VALUE) if valued else np.broadcast_to(rgb(BACK), base.shape)
    return _lit(np.where(away[:, None], back, base), seen, AMBIENT_OF_VALUES if valued else AMBIENT)


def _base(mesh: Mesh, corners: IntArray, face: IntArray, scale: ColourScale | None) -> FloatArray:
    if mesh.values is not None and scale is not None:
        at = corners if mesh.values_on == "vertices" else face
        return value_colours(mesh.values, scale)[at]
    if mesh.face_colours is not None:
        return many_rgb(mesh.face_colours)[face]
    if mesh.vertex_colours is not None:
        return many_rgb(mesh.vertex_colours)[corners]
    return np.broadcast_to(rgb(mesh.colour), (len(corners), 3))


def _lit(colours: FloatArray, normals: FloatArray, ambient: float) -> FloatArray:
    light = ambient + (1 - ambient) * np.maximum(normals @ LIGHT + WRAP, 0.0) / (LIGHT[2] + WRAP)
    dark = np.minimum(light, 1.0)[:, None]
    # What turns further to the light than to the viewer gets a trace of white.
    gloss = 0.5 * np.maximum(light - 1.0, 0.0)[:, None]
    return np.asarray(colours * dark * (1 - gloss) + gloss)
