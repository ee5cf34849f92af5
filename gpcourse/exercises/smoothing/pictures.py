"""Scenes that show what is wrong. Each function returns a callable, so that nothing is drawn unseen."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.view import mesh_scene
from gpcourse.view.scene import Scene, side_by_side

Draw = Callable[[], Scene]


def of_values(vertices: FloatArray, faces: IntArray, yours: FloatArray, truth: FloatArray, name: str) -> Draw:
    """Show a value per vertex, as computed and as it is, in one scale of colours."""

    def draw() -> Scene:
        mine = mesh_scene((vertices, faces), _lengths(yours), title="yours", value_name=name)
        right = mesh_scene((vertices, faces), _lengths(truth), title="as it is", value_name=name)
        return side_by_side([mine, right])

    return draw


def of_residual(vertices: FloatArray, faces: IntArray, residual: FloatArray, name: str) -> Draw:
    """Show at which vertices a property is broken, and by how much."""
    return lambda: mesh_scene((vertices, faces), np.abs(_lengths(residual)), value_name=name)


def of_positions(before: FloatArray, yours: FloatArray, truth: FloatArray, faces: IntArray) -> Draw:
    """Show a surface before a step, after yours and after the right one."""

    def draw() -> Scene:
        steps = (("before", before), ("yours", yours), ("as it is", truth))
        return side_by_side([mesh_scene((x, faces), title=title) for title, x in steps])

    return draw


def _lengths(values: FloatArray) -> FloatArray:
    return values if values.ndim == 1 else np.asarray(np.linalg.norm(values, axis=1))
