"""Paint the layers of a panel onto a page measured in points.

The polygons of a single mesh with one colour a face, if they are few, are painted from the back to the
front and stay outlines in a PDF. All else becomes pixels, each of them of what is nearest there.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray
from gpcourse.view.camera import Projection, area_vectors
from gpcourse.view.depth import PAIRWISE_LIMIT, hidden, painting_order, triangle_fans
from gpcourse.view.lettering import AROUND, MIDDLE, Occupied, placed, width
from gpcourse.view.page import Page
from gpcourse.view.scene import Arrows, ColourScale, Curves, Labels, Layer, Mesh, Points
from gpcourse.view.shading import corner_colours, many_rgb, point_colours

#: Above this many edges their hidden parts are found with fewer samples.
MANY = 3000
#: Above this many labels those without room are left out.
CROWD = 60
EDGE = np.array([0.16, 0.21, 0.29])


class Painter:
    """Paints one panel: knows the projection, the colour scale, and what hides what."""

    def __init__(
        self, page: Page, projection: Projection, scale: ColourScale | None, layers: Sequence[Layer]
    ) -> None:
        self.page, self.projection, self.scale = page, projection, scale
        self.taken = Occupied()
        self._surface(tuple(layer for layer in layers if isinstance(layer, Mesh)))

    def paint(self, layers: Iterable[Layer]) -> None:
        """Paint surfaces first, then what lies on them; labels of the topmost layers choose first."""
        layers = tuple(layers)
        self._meshes(tuple(layer for layer in layers if isinstance(layer, Mesh)))
        for layer in layers:
            if isinstance(layer, Curves):
                self._curves(layer)
            elif isinstance(layer, Points):
                self._points(layer)
            elif isinstance(layer, Arrows):
                self._arrows(layer)
        for layer in reversed(layers):
            if isinstance(layer, Labels):
                self._labels(layer)
        for layer in reversed(layers):
            if isinstance(layer, Arrows) and layer.labels:
                self._arrow_labels(layer)

    # -- surfaces ---------------------------------------------------------------------------

    def _surface(self, meshes: tuple[Mesh, ...]) -> None:
        """Gather the polygons of all meshes, so that they are sorted together."""
        corners, sizes, colours, vertices = [], [], [], [np.empty((0, 3))]
        for mesh in meshes:
            own, count = mesh.polygons
            colours.append(corner_colours(mesh, self.projection.axes, self.scale))
            corners.append(own + sum(map(len, vertices)))
            sizes.append(count)
            vertices.append(mesh.vertices)
        none = np.empty(0, dtype=np.int64)
        self.vertices = np.concatenate(vertices)
        self.corners, self.sizes = np.concatenate([none, *corners]), np.concatenate([none, *sizes])
        self.colours = np.concatenate([np.empty((0, 3)), *colours])
        self.mesh_of = np.repeat(np.arange(len(meshes)), [len(count) for count in sizes])
        self.flat, self.height = self.projection(self.vertices)
        fans, _ = triangle_fans(self.corners, self.sizes)
        self.fans = fans
        self.cover = self.flat[self.corners[fans]]
        self.levels = self.height[self.corners[fans]]

    def _hidden(self, points: FloatArray, clearance: float = 0.012) -> BoolArray:
        """Tell which points of space lie behind a surface, by more than a fraction of the scene."""
        flat, height = self.projection(points)
        return hidden(
            flat, height, self.cover, self.levels, clearance * self.projection.size * self.projection.scale
        )

    def _meshes(self, meshes: tuple[Mesh, ...]) -> None:
        if not len(self.sizes):
            return
        blended = (
            len(self.sizes) > PAIRWISE_LIMIT
            or len(meshes) > 1  # they may cut each other
            or any(
                mesh.smooth
                or mesh.vertex_colours
                or (mesh.values is not None and mesh.values_on == "vertices")
                for mesh in meshes
            )
        )
        if blended:
            self.page.triangles(self.cover, self.levels, self.colours[self.fans])
            self._outlines(meshes)
        else:
            order = painting_order(self.flat, self.height, self.corners, self.sizes)
            self._flat_polygons(order, np.array([mesh.edges for mesh in meshes])[self.mesh_of])
        self._hidden_edges(meshes)

    def _flat_polygons(self, order: IntArray, edged: BoolArray) -> None:
        starts = np.cumsum(self.sizes) - self.sizes
        fill = self.colours[starts]
        line = self._edge_width()
        # Without edges a hairline in the colour of the face closes the gap to its neighbours.
        edge = np.where(edged[:, None], 0.72 * EDGE + 0.28 * fill, fill)
        outlines = [self.flat[self.corners[starts[f] : starts[f] + self.sizes[f]]] for f in order.tolist()]
        self.page.polygons(outlines, fill[order], edge[order], np.where(edged, line, 0.35)[order])

    def _edge_width(self) -> float:
        following = np.arange(1, len(self.corners) + 1)
        ends = np.cumsum(self.sizes)
        following[ends - 1] = ends - self.sizes
        side = self.flat[self.corners[following]] - self.flat[self.corners]
        return float(np.clip(0.03 * np.median(np.linalg.norm(side, axis=1)), 0.2, 0.8))

    def _outlines(self, meshes: tuple[Mesh, ...]) -> None:
        """Draw edges, or the silhouette only, over blended triangles; they also smooth the rim."""
        for m, mesh in enumerate(meshes):
            pairs, rim = edges_and_rim(*self._polygons_of(m), self.vertices, self.projection.axes[2])
            shown = pairs if mesh.edges else pairs[rim]
            if len(shown) > 12 * MANY:
                continue
            seen, _ = self._runs(list(self.vertices[shown]), samples=4 if len(shown) < MANY else 2)
            colour = 0.85 * EDGE + 0.15 if mesh.edges else 0.6 * EDGE + 0.4 * many_rgb((mesh.colour,))[0]
            self.page.lines(
                [line for _, line in seen], [(*colour, 0.8)], self._edge_width() if mesh.edges else 0.5
            )

    def _polygons_of(self, m: int) -> tuple[IntArray, IntArray]:
        of_mesh = self.mesh_of == m
        return self.corners[np.repeat(of_mesh, self.sizes)], self.sizes[of_mesh]

    def _hidden_edges(self, meshes: tuple[Mesh, ...]) -> None:
        for m, mesh in enumerate(meshes):
            if mesh.hidden_edges:
                pairs, _ = edges_and_rim(*self._polygons_of(m), self.vertices, self.projection.axes[2])
                _, behind = self._runs(list(self.vertices[pairs]), samples=16)
                self.page.lines([line for _, line in behind], [(*EDGE, 0.38)], 0.6, dashed=True)

    # -- lines ------------------------------------------------------------------------------

    def _runs(
        self, lines: list[FloatArray], samples: int
    ) -> tuple[list[tuple[int, FloatArray]], list[tuple[int, FloatArray]]]:
        """Cut lines of space where they go behind a surface.

        Returns the visible and the hidden pieces, on the page, each with the index of its line.
        """
        if not lines:
            return [], []
        fine = [_refined(line, samples) for line in lines]
        middles = np.concatenate([(line[1:] + line[:-1]) / 2 for line in fine])
        behind = np.split(self._hidden(middles), np.cumsum([len(line) - 1 for line in fine])[:-1])
        seen: list[tuple[int, FloatArray]] = []
        unseen: list[tuple[int, FloatArray]] = []
        for i, (line, mask) in enumerate(zip(fine, behind, strict=True)):
            flat, _ = self.projection(line)
            cuts = np.flatnonzero(np.diff(mask)) + 1
            for a, b in zip([0, *cuts], [*cuts, len(mask)], strict=True):
                (unseen if mask[a] else seen).append((i, flat[a : b + 1]))
        return seen, unseen

    def _curves(self, layer: Curves) -> None:
        lines = [np.vstack([line, line[:1]]) if layer.closed else line for line in layer.lines]
        most = max((len(line) for line in lines), default=2)
        seen, unseen = self._runs(lines, samples=max(1, 24 // most))
        colours = many_rgb(layer.colours)
        if layer.hidden == "show":
            seen, unseen = seen + unseen, []
        if layer.hidden == "fade":
            self.page.lines(
                [line for _, line in unseen],
                [_faded(colours[i]) for i, _ in unseen],
                layer.width * 0.7,
                dashed=True,
            )
        self.page.lines([line for _, line in seen], [colours[i] for i, _ in seen], layer.width)

    def _points(self, layer: Points) -> None:
        flat, height = self.projection(layer.positions)
        behind = self._hidden(layer.positions) & (layer.hidden != "show")
        order = np.argsort(height, kind="stable")
        colours = point_colours(layer, self.scale)
        rim = 0.5 if layer.size >= 3 else 0.0
        if layer.hidden == "fade":
            faint = order[behind[order]]
            self.page.dots(flat[faint], layer.size * 0.8, 0.35 * colours[faint] + 0.65, "white", rim)
        shown = order[~behind[order]]
        self.page.dots(flat[shown], layer.size, colours[shown], "white" if rim else "none", rim)
        if len(shown) <= 300:
            for centre in flat[shown]:
                self.taken.add(centre, np.full(2, layer.size / 2))

    # -- arrows -----------------------------------------------------------------------------

    def _arrows(self, layer: Arrows) -> None:
        colours = many_rgb(layer.colours)
        tails, _ = self.projection(layer.tails)
        heads, _ = self.projection(layer.heads)
        length = np.linalg.norm(heads - tails, axis=1)
        barb = np.minimum(4.2 * layer.width**0.5 + 1.2, 0.4 * length)
        # The line ends inside its head, whose tip alone marks the end.
        share = 1 - 0.7 * barb / np.where(length > 0, length, 1.0)
        ends = layer.tails + share[:, None] * (layer.heads - layer.tails)
        seen, unseen = self._runs(list(np.stack([layer.tails, ends], axis=1)), samples=12)
        behind = self._hidden(layer.tails + 0.9 * (layer.heads - layer.tails)) & (layer.hidden != "show")
        along = (heads - tails) / np.where(length > 0, length, 1.0)[:, None]
        points = [_arrow_head(*parts) for parts in zip(heads, along, barb, strict=True)]
        if layer.hidden == "show":
            seen, unseen = seen + unseen, []
        if layer.hidden == "fade":
            faint = np.flatnonzero(behind & (length > 1))
            self.page.lines(
                [line for _, line in unseen],
                [_faded(colours[i]) for i, _ in unseen],
                layer.width * 0.8,
                dashed=True,
            )
            self.page.polygons([points[i] for i in faint], [_faded(colours[i]) for i in faint], "none", 0)
        solid = np.flatnonzero(~behind & (length > 1))
        self.page.lines([line for _, line in seen], [colours[i] for i, _ in seen], layer.width)
        self.page.polygons([points[i] for i in solid], colours[solid], "none", 0)

    def _arrow_labels(self, layer: Arrows) -> None:
        tails, _ = self.projection(layer.tails)
        heads, _ = self.projection(layer.heads)
        middles = (layer.tails + layer.heads) / 2
        flat, _ = self.projection(middles)
        behind = self._hidden(middles) & (layer.hidden != "show")
        length = np.linalg.norm(heads - tails, axis=1)
        shown = ~behind if layer.hidden == "hide" else np.ones(len(behind), dtype=bool)
        shown &= length > 3
        if layer.label_sides is not None and len(shown) > CROWD:
            # In a crowd the numbers in faces that are seen edge-on would lie on their neighbours.
            slant = np.linalg.norm(layer.label_sides @ self.projection.axes[:2].T, axis=1)
            shown &= slant >= 0.5 * np.linalg.norm(layer.label_sides, axis=1)
        if not shown.any():
            return
        size = float(np.clip(0.2 * np.median(length[shown]), 4.6, 8.5)) * (1.12 if layer.width > 1.5 else 1.0)
        side = self._sides(layer, heads - tails)
        paths, colours = [], []
        for i in np.flatnonzero(shown).tolist():
            half = np.array([width(layer.labels[i], size) / 2 + 0.4, MIDDLE * size + 0.4])
            # As far from the arrow as the box of the text reaches in that direction.
            reach = float(np.abs(side[i]) @ half) + 0.5 * layer.width + 1.0
            along = (heads[i] - tails[i]) / length[i]
            steps = np.array([0.0, -0.12, 0.12, -0.22]) * length[i]
            place = self.taken.free(flat[i] + side[i] * reach + steps[:, None] * along, half)
            if place is None or not self.page.has_room(place, half):
                continue
            self.taken.add(place, half)
            paths.append(placed(layer.labels[i], place, size, bold=layer.width > 1.5))
            colour = many_rgb((layer.colours[i],))[0]
            colours.append(_faded(colour, 0.75) if behind[i] else (*(0.85 * colour), 1.0))
        self.page.texts(paths, colours, halo=1.6)

    def _sides(self, layer: Arrows, along: FloatArray) -> FloatArray:
        """Return the unit directions on the page from the arrows to their labels."""
        left = np.stack([-along[:, 1], along[:, 0]], axis=1)
        if layer.label_sides is not None:
            wanted = layer.label_sides @ self.projection.axes[:2].T
            left = np.where(((left * wanted).sum(axis=1) < 0)[:, None], -left, left)
        length = np.linalg.norm(left, axis=1, keepdims=True)
        return np.asarray(left / np.where(length > 0, length, 1.0))

    # -- labels -----------------------------------------------------------------------------

    def _labels(self, layer: Labels) -> None:
        flat, height = self.projection(layer.positions)
        behind = self._hidden(layer.positions) & (layer.hidden != "show")
        size = layer.size or float(np.clip(40 / max(1, len(flat)) ** 0.45, 5.0, 9.0))
        middle = (flat.min(axis=0) + flat.max(axis=0)) / 2 if len(flat) else np.zeros(2)
        # What is seen comes first, the nearest before the others.
        order = np.lexsort((-height, behind))
        paths: list[Any] = []
        colours: list[Any] = []
        for i in order.tolist():
            if not layer.texts[i] or (behind[i] and layer.hidden == "hide"):
                continue
            bold = layer.place == "badge"
            half = np.array([width(layer.texts[i], size, bold=bold) / 2 + 0.6, MIDDLE * size + 0.6])
            place = self._label_place(layer, flat[i], half, flat[i] - middle)
            if place is None or not self.page.has_room(place, half):
                continue
            spot = place
            self.taken.add(spot, half)
            colour = many_rgb((layer.colours[i],))[0]
            if layer.place == "badge":
                across = max(2 * float(half[0]) + 2.4, 1.75 * size)
                self.taken.add(spot, np.full(2, across / 2))
                self.page.dots(
                    spot[None],
                    across,
                    "white" if not behind[i] else "#f4f4f4",
                    [_faded(colour) if behind[i] else colour],
                    1.0,
                )
            paths.append(placed(layer.texts[i], spot, size, bold=bold))
            colours.append(_faded(colour, 0.75) if behind[i] else (*colour, 1.0))
        self.page.texts(paths, colours, halo=0.0 if layer.place == "badge" else 1.8)

    def _label_place(
        self, layer: Labels, at: FloatArray, half: FloatArray, outwards: FloatArray
    ) -> FloatArray | None:
        """Return where a label goes; None if it has to be left out of a crowd."""
        if layer.place == "badge":
            return at
        places = at[None]
        if layer.place == "beside":
            towards = AROUND @ outwards / (np.linalg.norm(AROUND, axis=1) * (np.linalg.norm(outwards) or 1.0))
            around = AROUND[np.argsort(-towards, kind="stable")]
            places = np.concatenate([at + around * (half + gap) for gap in (1.6, 3.5, 6.0)])
        free = self.taken.free(places, half)
        return free if free is not None or len(layer.texts) > CROWD else places[0]


def edges_and_rim(
    corners: IntArray, sizes: IntArray, vertices: FloatArray, towards: FloatArray
) -> tuple[IntArray, BoolArray]:
    """Return the (e, 2) edges of polygons, and which of them bound what the viewer sees.

    The rim is made of the edges with one face, and of those between a face that is turned to the viewer
    and one that is turned away.
    """
    ends = np.cumsum(sizes)
    following = np.arange(1, len(corners) + 1)
    following[ends - 1] = ends - sizes
    pairs = np.sort(np.stack([corners, corners[following]], axis=1), axis=1)
    front = np.repeat(area_vectors(vertices, corners, sizes) @ towards > 0, sizes)
    edges, which = np.unique(pairs, axis=0, return_inverse=True)
    which = which.ravel()
    uses = np.bincount(which, minlength=len(edges))
    fronts = np.bincount(which, weights=front, minlength=len(edges))
    return edges, np.asarray((uses == 1) | ((fronts > 0) & (fronts < uses)))


def _refined(line: FloatArray, samples: int) -> FloatArray:
    """Divide each segment of a polyline into `samples` equal parts."""
    step = np.arange(samples) / samples
    fine = line[:-1, None] + step[:, None] * (line[1:] - line[:-1])[:, None]
    return np.vstack([fine.reshape(-1, 3), line[-1:]])


def _arrow_head(tip: FloatArray, along: FloatArray, barb: float) -> FloatArray:
    left = np.array([-along[1], along[0]])
    back = tip - barb * along
    return np.array([tip, back + 0.38 * barb * left, back + 0.22 * barb * along, back - 0.38 * barb * left])


def _faded(colour: FloatArray, share: float = 0.45) -> tuple[float, ...]:
    return (*(0.75 * colour + 0.12), share)
