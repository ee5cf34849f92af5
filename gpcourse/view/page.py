"""A page measured in points, and the marks that can be made on it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gpcourse.geometry.arrays import FloatArray
from gpcourse.view.raster import shaded

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Page:
    """A figure on which everything is placed in points from its lower left corner.

    Blended triangles become pixels, as many as the figure has; all else is lines and outlines.
    """

    def __init__(self, figure: Figure) -> None:
        from matplotlib.transforms import Affine2D

        self._figure = figure
        self._transform = Affine2D().scale(1 / 72) + figure.dpi_scale_trans
        self._count = 0
        self._clip: Any = None
        self._box: tuple[float, float, float, float] | None = None

    def clip(self, box: tuple[float, float, float, float] | None) -> None:
        """Confine what follows to a box (left, bottom, width, height)."""
        from matplotlib.transforms import Bbox, TransformedBbox

        self._box = box
        self._clip = box and TransformedBbox(Bbox.from_bounds(*box), self._transform)

    def has_room(self, centre: FloatArray, half: FloatArray) -> bool:
        """Tell whether at least the middle of a text lies in the box, so that it can be read."""
        if self._box is None:
            return True
        left, bottom, width, height = self._box
        low, high = np.array([left, bottom]), np.array([left + width, bottom + height])
        return bool(((centre - 0.5 * half >= low) & (centre + 0.5 * half <= high)).all())

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

    def triangles(self, outlines: FloatArray, heights: FloatArray, colours: FloatArray) -> None:
        """Fill (t, 3, 2) triangles with (t, 3) heights, blending the (t, 3, 3) colours of their corners."""
        from matplotlib.image import BboxImage
        from matplotlib.transforms import Bbox, TransformedBbox

        if not len(outlines):
            return
        unit = 72 / self._figure.dpi  # points per pixel
        edge = np.array([self._figure.bbox.width, self._figure.bbox.height])
        low = np.clip(np.floor(outlines.min(axis=(0, 1)) / unit), 0, edge)
        high = np.clip(np.ceil(outlines.max(axis=(0, 1)) / unit), low + 1, edge + 1)
        width, height = (high - low).astype(int).tolist()
        pixels = shaded(outlines / unit - low, heights, colours, width, height)
        place = Bbox.from_extents(*(unit * low), *(unit * high))
        image = BboxImage(TransformedBbox(place, self._transform), origin="lower", interpolation="nearest")
        image.set_data(pixels)
        self.add(image, placed_already=True)

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
