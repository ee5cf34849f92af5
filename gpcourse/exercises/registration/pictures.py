"""Scenes that show what is wrong with a registration; those for values per point are the common ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from gpcourse.exercises.pictures import RIGHT, WRONG, Draw, Field, Marks, Positions, Table
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.view.compose import camera_for, points_scene
from gpcourse.view.scene import Curves, Panel, Points, Scene, side_by_side

__all__ = ["Draw", "Field", "Marks", "Pairs", "Positions", "Table"]

FIXED, MOVING = "blue", "orange"
Motion = tuple[FloatArray, FloatArray]
#: The pictures of one failure, by the names under which `Wrong` takes them.
Both = dict[str, Any]


def of_alignment(
    p: FloatArray, q: FloatArray, mine: Motion, want: Motion | None = None, *, pairs: bool = False
) -> Both:
    """Show both clouds before, after your motion and after the right one; `pairs` joins p[i] and q[i]."""
    return {
        "picture": partial(_alignment, p, q, mine, want, pairs),
        "handout": partial(_alignment, p, q, mine, None, pairs),
    }


def _alignment(p: FloatArray, q: FloatArray, mine: Motion, want: Motion | None, pairs: bool) -> Scene:
    stages = [("before", q), ("yours", q @ mine[0].T + mine[1])]
    if want is not None:
        stages.append(("expected", q @ want[0].T + want[1]))
    return side_by_side([_clouds(p, x, title, pairs) for title, x in stages])


def _clouds(fixed: FloatArray, moving: FloatArray, title: str, pairs: bool) -> Scene:
    everything = np.concatenate([fixed, moving])
    layers: list[Points | Curves] = [Points(fixed, (FIXED,), size=2.5), Points(moving, (MOVING,), size=2.5)]
    if pairs:
        layers.insert(0, Curves(tuple(np.stack([fixed, moving], axis=1)), ("grey",), width=0.8))
    words = f"{title}: {len(fixed)} fixed points in blue, {len(moving)} moving points in orange."
    return Scene((Panel(tuple(layers), title, camera_for(everything, None, None)),), alt=words)


def of_scans(scans: Sequence[FloatArray], mine: Sequence[Motion], want: Sequence[Motion], worst: int) -> Both:
    """Show all scans in your poses, and in the right ones, one of them in orange."""
    return {
        "picture": partial(_scans, scans, mine, want, worst),
        "handout": partial(_scans, scans, mine, None, worst),
    }


def _scans(
    scans: Sequence[FloatArray], mine: Sequence[Motion], want: Sequence[Motion] | None, worst: int
) -> Scene:
    scenes = []
    for title, poses in (("yours", mine), ("expected", want)):
        if poses is not None:
            placed = [x @ R.T + t for x, (R, t) in zip(scans, poses, strict=True)]
            others = np.concatenate(placed[:worst] + placed[worst + 1 :])
            scenes.append(_clouds(others, placed[worst], f"{title}, scan {worst} in orange", pairs=False))
    return side_by_side(scenes)


def of_neighbour(points: FloatArray, query: FloatArray, yours: int, truth: int) -> Both:
    """Join a query with the neighbour that was returned, in red, and with the nearest one, in green."""
    return {
        "picture": partial(_neighbour, points, query, ((yours, WRONG), (truth, RIGHT))),
        "handout": partial(_neighbour, points, query, ((yours, WRONG),)),
    }


def _neighbour(points: FloatArray, query: FloatArray, found: Sequence[tuple[int, str]]) -> Scene:
    known = [(i, colour) for i, colour in found if 0 <= i < len(points)]
    lines = tuple(np.stack([query, points[i]]) for i, _ in known)
    layers = (
        Points(points, ("grey",), size=2.0),
        Points(query[None], ("black",), size=6.0),
        Curves(lines, tuple(colour for _, colour in known), width=2.0),
    )
    camera = camera_for(np.concatenate([points, query[None]]), None, None)
    title = "yours red, nearest green" if len(found) > 1 else "yours red"
    words = f"The query in black, among {len(points)} points, joined with the point that was found: {title}."
    return Scene((Panel(layers, title, camera),), alt=words)


def of_sample(points: FloatArray, chosen: IntArray, title: str = "your sample") -> Draw:
    """Mark the chosen points."""
    return partial(_sample, points, chosen, title)


def _sample(points: FloatArray, chosen: IntArray, title: str) -> Scene:
    layers = (Points(points, ("silver",), size=2.0), Points(points[chosen], (WRONG,), size=4.5))
    words = f"{title}: {len(chosen)} chosen points in red among {len(points)}."
    return Scene((Panel(layers, title, camera_for(points, None, None)),), alt=words)


def of_speeds(points: FloatArray, speeds: FloatArray, column: int) -> Draw:
    """Show how fast each point leaves the surface in the motion of a column."""
    title = f"speed off the surface, column {column} of your motions"
    rounding = 1e-12 * float(np.abs(points).max(initial=1.0))
    speeds = np.where(np.abs(speeds) < rounding, 0.0, speeds)  # else it would fill the whole scale
    return partial(points_scene, points, speeds, size=5.0, title=title, value_name="(r × x + t)·n")


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of points, p[i] and q[i], of which some are kept."""

    p: FloatArray
    q: FloatArray
    item: str = "pair"

    def scene(self, yours: FloatArray, truth: FloatArray, worst: tuple[int, ...], answers: bool) -> Scene:
        mine, true = yours.astype(bool), truth.astype(bool)
        one = np.arange(len(mine)) == worst[0]
        if not answers:
            title = f"you keep the green ones; pair {worst[0]}, in red, is wrong"
            return self._panel(title, (mine & ~one, RIGHT), (~mine & ~one, "silver"), (one, WRONG))
        wrong = mine != true
        return side_by_side(
            [
                self._panel("yours: kept green", (mine, RIGHT), (~mine, "silver")),
                self._panel("expected", (true, RIGHT), (~true, "silver")),
                self._panel("judged wrongly in red", (~wrong, "silver"), (wrong, WRONG)),
            ]
        )

    def _panel(self, title: str, *kinds: tuple[FloatArray, str]) -> Scene:
        lines = np.stack([self.p, self.q], axis=1)
        layers = tuple(
            Curves(tuple(lines[flags]), (colour,), width=1.6) for flags, colour in kinds if flags.any()
        )
        words = f"{title}: {len(lines)} pairs of points, joined by lines."
        return Scene((Panel(layers, title, camera_for(lines.reshape(-1, 3), None, None)),), alt=words)
