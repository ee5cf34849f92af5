"""A page measured in points, and the marks that can be made on it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gpcourse.geometry.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Page:
    """A figure on which everything is placed in points from its lower left corner.

    With `rastered`, blended triangles become pixels where all else is lines and outlines.
    """

    def __init__(self, figure: Figure, *, rastered: bool = False) -> None:
        from matplotlib.transforms import Affine2D

        self._figure = figure
        self._rastered = rastered
        self._transform = Affine2D().scale(1 / 72) + figure.dpi_scale_trans
        self._count = 0
        self._clip: Any = None

    def clip(self, box: tuple[float, float, float, float] | None) -> None:
        """Confine what follows to a box (left, bottom, width, height)."""
        from matplotlib.transforms import Bbox, TransformedBbox

        self._clip = box and TransformedBbox(Bbox.from_bounds(*box), self._transform)

    def add(self, artist: Any, *, placed_already: bool = False) -> None:
        """Put `artist`, measured in points, on top of all that is there."""
        if not placed_already:
            artist.set_transform(self._transform)
        artist.set_zorder(self._count)
        self._count += 1
        self._figure.add_artist(artist)
        if self._clip is not None:
            artist.set_clip_box(self._clip)

    def polygons(self, outlines: Sequence[FloatArray], fill: Any, edge: Any, line: Any) -> None:
        """Fill polygons in the order given."""
        from matplotlib.collections import PolyCollection

        if len(outlines):
            self.add(
                PolyCollection(outlines, facecolors=fill, edgecolors=edge, linewidths=line, joinstyle="round")
            )

    def lines(self, lines: Sequence[FloatArray], colours: Any, line: float, *, dashed: bool = False) -> None:
        """Draw polylines."""
        from matplotlib.collections import LineCollection

        if len(lines):
            style: Any = (0, (2.2, 1.8)) if dashed else "solid"
            self.add(
                LineCollection(lines, colors=colours, linewidths=line, linestyles=style, capstyle="round")
                if not dashed
                else LineCollection(lines, colors=colours, linewidths=line, linestyles=[style])
            )

    def triangles(self, outlines: FloatArray, colours: FloatArray) -> None:
        """Fill (t, 3, 2) triangles, blending the (t, 3, 3) colours of their corners."""
        from matplotlib.collections import TriMesh
        from matplotlib.tri import Triangulation

        if len(outlines):
            flat = outlines.reshape(-1, 2)
            blend = TriMesh(Triangulation(flat[:, 0], flat[:, 1], np.arange(len(flat)).reshape(-1, 3)))
            blend.set_facecolor(np.column_stack([colours.reshape(-1, 3), np.ones(len(flat))]))  # type: ignore[arg-type]
            blend.set_rasterized(self._rastered)
            self.add(blend)

    def dots(self, centres: FloatArray, sizes: Any, colours: Any, edge: Any, line: float = 0.6) -> None:
        """Draw discs of so many points across."""
        from matplotlib.collections import CircleCollection

        if len(centres):
            across = np.broadcast_to(np.asarray(sizes, dtype=float), (len(centres),))
            discs = CircleCollection(
                np.pi / 4 * across**2,
                offsets=centres,
                offset_transform=self._transform,
                facecolors=colours,
                edgecolors=edge,
                linewidths=line,
            )
            self.add(discs, placed_already=True)

    def texts(self, paths: Sequence[Any], colours: Any, *, halo: float = 0.0) -> None:
        """Draw outlines of letters, with a white rim where they lie on something."""
        from matplotlib.collections import PathCollection

        if len(paths):
            if halo:
                rim = (1.0, 1.0, 1.0, 0.85)
                self.add(PathCollection(paths, facecolors=[rim], edgecolors=[rim], linewidths=halo))
            self.add(PathCollection(paths, facecolors=colours, edgecolors="none", linewidths=0))
