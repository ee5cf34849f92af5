"""Scenes that show what is wrong. Each function returns a callable, so that nothing is drawn unseen."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray
from gpcourse.view.compose import camera_for
from gpcourse.view.scene import Curves, Panel, Points, Scene, side_by_side

Draw = Callable[[], Scene]

FIXED, MOVING, WRONG, RIGHT = "blue", "orange", "red", "green"


def _clouds(fixed: FloatArray, moving: FloatArray, title: str, pairs: bool) -> Scene:
    everything = np.concatenate([fixed, moving])
    layers: list[Points | Curves] = [Points(fixed, (FIXED,), size=2.5), Points(moving, (MOVING,), size=2.5)]
    if pairs:
        layers.insert(0, Curves(tuple(np.stack([fixed, moving], axis=1)), ("grey",), width=0.8))
    words = f"{title}: {len(fixed)} fixed points in blue, {len(moving)} moving points in orange."
    return Scene((Panel(tuple(layers), title, camera_for(everything, None, None)),), alt=words)


def of_alignment(p: FloatArray, q: FloatArray, R: FloatArray, t: FloatArray, *, pairs: bool = False) -> Draw:
    """Show both clouds before and after the motion; with `pairs`, join p[i] and q[i]."""
    return lambda: side_by_side(
        [_clouds(p, q, "before", pairs), _clouds(p, q @ R.T + t, "after your motion", pairs)]
    )


def of_neighbour(points: FloatArray, query: FloatArray, yours: int, truth: int) -> Draw:
    """Join a query with the neighbour that was returned, in red, and with the nearest one, in green."""

    def draw() -> Scene:
        lines = tuple(np.stack([query, points[i]]) for i in (yours, truth) if 0 <= i < len(points))
        colours = tuple(c for c, i in ((WRONG, yours), (RIGHT, truth)) if 0 <= i < len(points))
        layers = (
            Points(points, ("grey",), size=2.0),
            Points(query[None], ("black",), size=6.0),
            Curves(lines, colours, width=2.0),
        )
        camera = camera_for(np.concatenate([points, query[None]]), None, None)
        words = (
            f"The query in black, among {len(points)} points, "
            f"joined with point {yours} (yours, red) and {truth} (nearest, green)."
        )
        return Scene((Panel(layers, "yours red, nearest green", camera),), alt=words)

    return draw


def of_sample(points: FloatArray, chosen: IntArray, title: str = "your sample") -> Draw:
    """Mark the chosen points."""

    def draw() -> Scene:
        layers = (Points(points, ("silver",), size=2.0), Points(points[chosen], (WRONG,), size=4.5))
        words = f"{title}: {len(chosen)} chosen points in red among {len(points)}."
        return Scene((Panel(layers, title, camera_for(points, None, None)),), alt=words)

    return draw


def of_marks(points: FloatArray, yours: BoolArray, truth: BoolArray) -> Draw:
    """Show points that are marked rightly (green), marked wrongly (red), and not marked (grey)."""

    def draw() -> Scene:
        kinds = ((yours == truth) & yours, (yours == truth) & ~yours, yours != truth)
        layers = tuple(
            Points(points[kind], (colour,), size=3.5)
            for kind, colour in zip(kinds, (RIGHT, "silver", WRONG), strict=True)
            if kind.any()
        )
        words = f"{int(kinds[2].sum())} of {len(points)} points are marked wrongly, in red."
        title = "marked rightly green, wrongly red"
        return Scene((Panel(layers, title, camera_for(points, None, None)),), alt=words)

    return draw
