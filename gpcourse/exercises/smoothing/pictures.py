"""Scenes that show what is wrong. Each function returns a callable, so that nothing is drawn unseen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.view import mesh_scene
from gpcourse.view.scene import Points, Scene, colour_scale, side_by_side

Draw = Callable[[], Scene]


def of_values(vertices: FloatArray, faces: IntArray, yours: FloatArray, truth: FloatArray, name: str) -> Draw:
    """Show a value per vertex, as computed, as expected, and the difference, facing the worst vertex."""

    def draw() -> Scene:
        error = _errors(yours, truth)
        worst = int(np.argmax(error))
        mesh, towards = (vertices, faces), _normal(vertices, faces, worst)
        scale = colour_scale([Points(vertices, values=_lengths(x)) for x in (yours, truth)])
        limits = None if scale is None else (scale.low, scale.high)
        colours = None if scale is None else scale.colour_map
        left, middle = (
            mesh_scene(
                mesh,
                _lengths(values),
                title=title,
                value_name=name,
                direction=towards,
                limits=limits,
                colour_map=colours,
            )
            for title, values in (("yours", yours), ("expected", truth))
        )
        right = mesh_scene(
            mesh,
            error,
            title=f"difference, worst at vertex {worst}",
            value_name="|difference|",
            direction=towards,
        )
        scenes = [_marked(scene, vertices, worst) for scene in (left, middle, right)]
        return side_by_side(scenes, shared_scale=False)

    return draw


def of_own_values(
    vertices: FloatArray, faces: IntArray, yours: FloatArray, truth: FloatArray, name: str
) -> Draw:
    """Show a value per vertex as computed, with a mark where it is worst; the truth is not shown."""

    def draw() -> Scene:
        worst = int(np.argmax(_errors(yours, truth)))
        scene = mesh_scene(
            (vertices, faces),
            _lengths(yours),
            title=f"yours, worst at vertex {worst}",
            value_name=name,
            direction=_normal(vertices, faces, worst),
        )
        return _marked(scene, vertices, worst)

    return draw


def of_residual(vertices: FloatArray, faces: IntArray, residual: FloatArray, name: str) -> Draw:
    """Show at which vertices a property is broken, and by how much."""
    return lambda: mesh_scene((vertices, faces), np.abs(_lengths(residual)), value_name=name)


def of_positions(before: FloatArray, yours: FloatArray, truth: FloatArray, faces: IntArray) -> Draw:
    """Show a surface before a step, after yours and after the right one."""

    def draw() -> Scene:
        steps = (("before", before), ("yours", yours), ("expected", truth))
        return side_by_side([mesh_scene((x, faces), title=title) for title, x in steps])

    return draw


def of_own_positions(before: FloatArray, yours: FloatArray, faces: IntArray) -> Draw:
    """Show a surface before a step and after yours; the right one is not shown."""
    steps = (("before", before), ("yours", yours))
    return lambda: side_by_side([mesh_scene((x, faces), title=title) for title, x in steps])


def _marked(scene: Scene, vertices: FloatArray, worst: int) -> Scene:
    """Put a red dot on the worst vertex, which the camera faces."""
    panel = scene.panels[0]
    dot = Points(vertices[worst][None], ("red",), size=6.0)
    return replace(scene, panels=(replace(panel, layers=(*panel.layers, dot)),))


def _normal(vertices: FloatArray, faces: IntArray, v: int) -> FloatArray | None:
    """Return the sum of the vector areas of the faces at a vertex, or None where it vanishes."""
    p, q, r = vertices[faces[(faces == v).any(axis=1)]].transpose(1, 0, 2)
    normal = np.asarray(np.cross(q - p, r - p).sum(axis=0))
    return normal if normal.any() else None


def _errors(yours: FloatArray, truth: FloatArray) -> FloatArray:
    return np.abs(_lengths(yours - truth))


def _lengths(values: FloatArray) -> FloatArray:
    return values if values.ndim == 1 else np.asarray(np.linalg.norm(values, axis=1))
