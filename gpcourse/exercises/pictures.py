"""Pictures of values that are not right: yours, the expected ones, the difference, the worst place marked.

One class for each kind of value that an answer may hold. Each makes two scenes: one for the student's own
notebook, and one to hand out, which shows the student's values only. Scenes are made when somebody looks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Protocol

import numpy as np

from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.view import mesh_scene, points_scene
from gpcourse.view.compose import camera_for
from gpcourse.view.scene import (
    Camera,
    Curves,
    Labels,
    Layer,
    Panel,
    Points,
    Scene,
    colour_scale,
    side_by_side,
)

Draw = Callable[[], Scene]

WRONG, RIGHT = "red", "green"
#: A picture with numbers in it has room for so many.
FEW = 14


class Shown(Protocol):
    """What numbers are the numbers of, and how to draw them."""

    @property
    def item(self) -> str:
        """What a row of numbers belongs to, as "vertex"; empty where each number is on its own."""

    def scene(self, yours: FloatArray, truth: FloatArray, worst: tuple[int, ...], answers: bool) -> Scene:
        """Show `yours` and where it is worst; with `answers` also the truth and the difference."""


@dataclass(frozen=True, eq=False)
class Field:
    """A number or a vector at every vertex or face of a mesh, or at every point of a cloud (no faces).

    Where the truth is zero everywhere, the values are how far a property is violated: nothing is expected
    beside them. Then `of`, the answer whose property it is, is shown first.
    """

    points: FloatArray
    faces: IntArray | None
    name: str
    of: FloatArray | None = None
    of_name: str = "yours"
    item: str = "vertex"

    def scene(self, yours: FloatArray, truth: FloatArray, worst: tuple[int, ...], answers: bool) -> Scene:
        place = self._place(worst[0])
        if not truth.any():
            own = (
                [] if self.of is None else [self._panel(lengths(self.of), self.of_name, place, self.of_name)]
            )
            title = f"{self.name}, should be 0; worst at {self.item} {worst[0]}"
            return side_by_side([*own, self._panel(lengths(yours), title, place)], shared_scale=False)
        if not answers:
            return self._panel(lengths(yours), f"yours, worst at {self.item} {worst[0]}", place)
        values = lengths(yours), lengths(truth)
        scale = colour_scale([Points(np.zeros((len(x), 3)), values=x) for x in values])
        shared: dict[str, Any] = {}
        if scale is not None:
            shared = {"limits": (scale.low, scale.high), "colour_map": scale.colour_map}
        scenes = [
            self._panel(x, title, place, **shared)
            for x, title in zip(values, ("yours", "expected"), strict=True)
        ]
        title = f"difference, worst at {self.item} {worst[0]}"
        scenes.append(self._panel(lengths(yours - truth, signed=False), title, place, "|difference|"))
        return side_by_side(scenes, shared_scale=False)

    def _place(self, worst: int) -> FloatArray:
        if self.item == "face" and self.faces is not None:
            return np.asarray(self.points[self.faces[worst]].mean(axis=0))
        return np.asarray(self.points[worst])

    def _panel(
        self, values: FloatArray, title: str, place: FloatArray, name: str = "", **settings: Any
    ) -> Scene:
        settings |= {"title": title, "value_name": name or self.name}
        if self.faces is None:
            return marked(points_scene(self.points, values, size=5.0, **settings), place)
        settings |= {"values_on": "faces" if self.item == "face" else "vertices"}
        towards = normal_at(self.points, self.faces, place)
        return marked(mesh_scene((self.points, self.faces), values, direction=towards, **settings), place)


@dataclass(frozen=True, eq=False)
class Positions:
    """The vertices of a mesh, or the points of a cloud (no faces), moved, or in places of their own."""

    before: FloatArray | None
    faces: IntArray | None
    item: str = "vertex"

    def scene(self, yours: FloatArray, truth: FloatArray, worst: tuple[int, ...], answers: bool) -> Scene:
        i = worst[0]
        if not answers:
            stages = [("before", self.before), (f"yours, worst at {self.item} {i}", yours)]
            known = [(title, x) for title, x in stages if x is not None]
            towards = self._towards(known[0][1], i)
            return side_by_side([marked(self._panel(x, title, towards), x[i]) for title, x in known])
        off = lengths(yours - truth, signed=False)
        settings: dict[str, Any] = {"value_name": "distance", "direction": self._towards(truth, i)}
        title = f"distance, worst at {self.item} {i}"
        if self.faces is None:
            last = points_scene(truth, off, title=title, **settings)
        else:
            last = mesh_scene((truth, self.faces), off, title=title, values_on="vertices", **settings)
        towards = self._towards(truth, i)
        scenes = [marked(self._panel(yours, "yours", towards), yours[i])]
        scenes += [marked(self._panel(truth, "expected", towards), truth[i]), marked(last, truth[i])]
        return side_by_side(scenes, shared_scale=False)

    def _towards(self, points: FloatArray, i: int) -> FloatArray | None:
        return None if self.faces is None else normal_at(points, self.faces, points[i])

    def _panel(self, points: FloatArray, title: str, towards: FloatArray | None = None) -> Scene:
        if self.faces is None:
            return points_scene(points, title=title, direction=towards)
        return mesh_scene((points, self.faces), title=title, direction=towards)


@dataclass(frozen=True, eq=False)
class Rows:
    """A matrix over the vertices of a mesh: its worst row, as numbers round the vertex of that row."""

    vertices: FloatArray
    faces: IntArray
    name: str = "the matrix"
    item: str = ""

    def scene(self, yours: FloatArray, truth: FloatArray, worst: tuple[int, ...], answers: bool) -> Scene:
        i, j = worst[0], worst[-1]
        shown = self._near(i, j, yours[i], truth[i])
        title = f"yours: row {i} of {self.name}, sum {_total(yours[i])}"
        panels = [self._panel(yours[i], shown, i, j, title)]
        if not truth.any():
            panels = [self._panel(yours[i], shown, i, j, f"row {i} of {self.name}, should be 0")]
        elif answers:
            panels.append(self._panel(truth[i], shown, i, j, f"expected: row {i}"))
            title = f"difference, worst in column {j}"
            panels.append(self._panel(yours[i] - truth[i], shown, i, j, title))
        words = f"Row {i} of {self.name} as numbers at vertex {i} and its neighbours, {len(panels)} panels."
        return Scene(tuple(panels), alt=words)

    def _near(self, i: int, j: int, yours: FloatArray, truth: FloatArray) -> IntArray:
        """The vertices with a number of the row: i, j and the nearest of those that are not zero."""
        used = np.flatnonzero((yours != 0) | (truth != 0))
        order = np.argsort(np.linalg.norm(self.vertices[used] - self.vertices[i], axis=1))
        return np.unique([i, j, *used[order][:FEW]])

    def _panel(self, row: FloatArray, shown: IntArray, i: int, j: int, title: str) -> Panel:
        towards = normal_at(self.vertices, self.faces, self.vertices[i])
        surface = mesh_scene((self.vertices, self.faces), direction=towards).panels[0]
        middle = (self.vertices[shown].min(axis=0) + self.vertices[shown].max(axis=0)) / 2
        reach = float(np.linalg.norm(self.vertices[shown] - middle, axis=1).max())
        near = replace(surface.camera, focus=tuple(middle), radius=1.25 * reach) if reach else surface.camera
        colours = tuple(WRONG if v == j else "black" for v in shown)
        texts = tuple(f"{row[v]:.3g}".replace("-", "−") for v in shown)
        numbers = Labels(self.vertices[shown], texts, colours, place="badge", size=7.5, hidden="show")
        return Panel((*surface.layers, numbers), title, near)


@dataclass(frozen=True)
class Table:
    """A small matrix, as squares with a number in each."""

    name: str
    item: str = ""

    def scene(self, yours: FloatArray, truth: FloatArray, worst: tuple[int, ...], answers: bool) -> Scene:
        places = ", ".join(map(str, worst))
        values = [("yours", yours)] if answers else [(f"yours, worst at [{places}]", yours)]
        if answers:
            values += [("expected", truth), (f"difference, worst at [{places}]", yours - truth)]
        panels = tuple(self._panel(np.atleast_2d(x), worst, title) for title, x in values)
        return Scene(panels, alt=f"{self.name} as a table, worst at [{places}].")

    def _panel(self, matrix: FloatArray, worst: tuple[int, ...], title: str) -> Panel:
        m, n = matrix.shape
        row, column = (index.ravel() for index in np.indices((m, n)))
        corner = column[:, None] + [0, 1, 1, 0], -row[:, None] + [-1, -1, 0, 0]
        vertices = np.stack([*corner, np.zeros_like(corner[0])], axis=-1).reshape(-1, 3).astype(float)
        size = float(np.abs(matrix).max()) or 1.0
        squares = mesh_scene(
            (vertices, np.arange(4 * m * n).reshape(-1, 4)),
            matrix.ravel(),
            values_on="faces",
            colour_map="RdBu_r",
            limits=(-2 * size, 2 * size),  # pale, so that the numbers can be read
        ).panels[0]
        middles = np.column_stack([column + 0.5, -row - 0.5, 0 * row])
        texts = tuple(f"{x:.2g}".replace("-", "−") for x in matrix.ravel())
        at = worst if len(worst) == 2 else (0, worst[0])
        cells = zip(row.tolist(), column.tolist(), strict=True)
        colours = tuple(WRONG if cell == at else "black" for cell in cells)
        layers: list[Layer] = [*squares.layers]
        layers += [Labels(middles, texts, colours, size=8.0)] if m * n <= 64 else []
        return Panel(tuple(layers), title, Camera((0, 0, 1), (0, 1, 0)))


@dataclass(frozen=True, eq=False)
class Graph:
    """Values over an interval, at increasing places t."""

    t: FloatArray
    item: str = "sample"

    def scene(self, yours: FloatArray, truth: FloatArray, worst: tuple[int, ...], answers: bool) -> Scene:
        i = worst[0]
        if not answers:
            return Scene(
                (self._panel([(yours, "blue")], i, f"yours, worst at sample {i}"),), alt=self._words(i)
            )
        panels = [self._panel([(yours, "blue")], i, "yours"), self._panel([(truth, RIGHT)], i, "expected")]
        both = [(truth, RIGHT), (yours, "blue")]
        panels.append(self._panel(both, i, f"both, worst at sample {i}"))
        return Scene(tuple(panels), alt=self._words(i))

    def _words(self, i: int) -> str:
        return f"Values at {len(self.t)} samples; the worst is sample {i}."

    def _panel(self, curves: list[tuple[FloatArray, str]], i: int, title: str) -> Panel:
        lines = [np.column_stack([self.t, values, 0 * self.t]) for values, _ in curves]
        colours = tuple(colour for _, colour in curves)
        dots = [Points(line, (colour,), size=4.0) for line, colour in zip(lines, colours, strict=True)]
        layers: tuple[Layer, ...] = (
            Curves(tuple(lines), colours),
            *dots,
            Points(lines[-1][i][None], (WRONG,), size=6.0),
        )
        return Panel(layers, title, camera_for(np.concatenate(lines), None, (0, 0, 1)))


@dataclass(frozen=True, eq=False)
class Modes:
    """Inner products of functions on a mesh: the two whose product is worst, and that product.

    `functions` are (n, k), a column each, and `areas` the (n,) weights of the vertices.
    """

    vertices: FloatArray
    faces: IntArray
    functions: FloatArray
    areas: FloatArray
    item: str = ""

    def scene(self, yours: FloatArray, truth: FloatArray, worst: tuple[int, ...], answers: bool) -> Scene:
        a, b = self.functions[:, worst[0]], self.functions[:, worst[1]]
        shown = [(f"your mode {worst[0]}", "φ", a), (f"your mode {worst[1]}", "φ", b)][
            : 1 + (worst[0] != worst[1])
        ]
        product = f"their product times the area; its sum is {yours[worst]:.3g}"
        if worst[0] == worst[1]:
            product = product.replace("their product", "its square")
        shown.append((f"{product}, should be {truth[worst]:g}", "product × area", self.areas * a * b))
        scenes = [
            mesh_scene(
                (self.vertices, self.faces), values, title=title, value_name=name, values_on="vertices"
            )
            for title, name, values in shown
        ]
        return side_by_side(scenes, shared_scale=False)


@dataclass(frozen=True, eq=False)
class Marks:
    """Points of which some are to be marked, True or False each."""

    points: FloatArray
    item: str = "point"

    def scene(self, yours: FloatArray, truth: FloatArray, worst: tuple[int, ...], answers: bool) -> Scene:
        mine, true = yours.astype(bool), truth.astype(bool)
        i = worst[0]
        title = "yours" if answers else f"yours, one of the wrong ones is {self.item} {i}"
        panels = [self._panel(title, (mine, RIGHT), (~mine, "silver"))]
        if answers:
            panels.append(self._panel("expected", (true, RIGHT), (~true, "silver")))
            wrong = mine != true
            panels.append(self._panel("marked wrongly in red", (~wrong, "silver"), (wrong, WRONG)))
        words = f"{len(mine)} points, {int(mine.sum())} of them marked, in green."
        scene = Scene(tuple(panels), alt=words)
        return scene if answers else marked(scene, self.points[i])

    def _panel(self, title: str, *kinds: tuple[Any, str]) -> Panel:
        layers = tuple(
            Points(self.points[flags], (colour,), size=3.5) for flags, colour in kinds if flags.any()
        )
        return Panel(layers, title, camera_for(self.points, None, None))


def _total(row: FloatArray) -> str:
    """Write a sum; what its rounding leaves is zero."""
    total = float(row.sum())
    return "0" if abs(total) < 1e-12 * float(np.abs(row).sum()) else f"{total:.3g}".replace("-", "−")


def of_own(vertices: FloatArray, faces: IntArray, values: FloatArray, name: str) -> Draw:
    """Show the values of an answer, of which a total or a bound is wrong, with the largest marked."""
    return partial(_own, vertices, faces, values, name)


def _own(vertices: FloatArray, faces: IntArray, values: FloatArray, name: str) -> Scene:
    place = vertices[int(np.abs(values).argmax())]
    towards = normal_at(vertices, faces, place)
    scene = mesh_scene((vertices, faces), values, value_name=name, title=f"your {name}", direction=towards)
    return marked(scene, place)


def of_before_and_after(before: FloatArray, yours: FloatArray, faces: IntArray) -> Draw:
    """Show a surface as it was and as it became."""
    return partial(_before_and_after, before, yours, faces)


def _before_and_after(before: FloatArray, yours: FloatArray, faces: IntArray) -> Scene:
    return side_by_side([mesh_scene((x, faces), title=t) for t, x in (("before", before), ("yours", yours))])


def of_graph(t: FloatArray, values: FloatArray) -> Draw:
    """Show values over an interval."""
    return partial(_graph, t, values)


def _graph(t: FloatArray, values: FloatArray) -> Scene:
    line = np.column_stack([t, values, 0 * t])
    layers = (Curves((line,), ("blue",)), Points(line, ("blue",), size=4.0))
    words = f"Your values at {len(t)} samples."
    return Scene((Panel(layers, "yours", camera_for(line, None, (0, 0, 1))),), alt=words)


def lengths(values: FloatArray, *, signed: bool = True) -> FloatArray:
    """Return one number for each row: the value, or the length of a vector; the size if not `signed`."""
    if values.ndim > 1 and values.shape[1] > 1:
        return np.asarray(np.linalg.norm(values, axis=1))
    flat = values.reshape(len(values))
    return flat if signed else np.abs(flat)


def marked(scene: Scene, place: FloatArray) -> Scene:
    """Put a red dot with a white rim on the worst place, seen through whatever is before it."""
    panel = scene.panels[0]
    rim, dot = (Points(place[None], (c,), size=s, hidden="show") for c, s in (("white", 9.0), (WRONG, 6.5)))
    return replace(scene, panels=(replace(panel, layers=(*panel.layers, rim, dot)),))


def normal_at(vertices: FloatArray, faces: IntArray, place: FloatArray) -> FloatArray | None:
    """Return the unit normal at the vertex nearest to a place; None where it vanishes."""
    v = int(np.linalg.norm(vertices - place, axis=1).argmin())
    p, q, r = vertices[np.asarray(faces)[(np.asarray(faces) == v).any(axis=1)]][:, :3].transpose(1, 0, 2)
    normal = np.asarray(np.cross(q - p, r - p).sum(axis=0))
    size = float(np.linalg.norm(normal))
    return normal / size if np.isfinite(size) and size > 0 else None
