"""Texts as outlines, and a place for each label where it does not cover another."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gpcourse.geometry.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.path import Path

#: Half the height of a digit, in font sizes: labels are centred on it.
MIDDLE = 0.365

#: Directions to try for a label beside a point, in units of its own half extents plus a gap.
AROUND = np.array(
    [[1, 1], [-1, 1], [1, -1], [-1, -1], [1.15, 0], [-1.15, 0], [0, 1.25], [0, -1.25]], dtype=float
)


@lru_cache(maxsize=4096)
def outline(text: str, bold: bool = False) -> tuple[Path, float, float]:
    """Return the outline of `text` at size 1 from the origin, and its left and right ends."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.path import Path
    from matplotlib.textpath import TextPath

    if not text.strip():
        return Path(np.zeros((0, 2))), 0.0, 0.0
    font = FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal")
    # A dollar sign would start a formula.
    path = TextPath((0, 0), text.replace("$", r"\$"), size=100, prop=font)
    outlines = np.asarray(path.vertices) / 100
    return Path(outlines, path.codes), float(outlines[:, 0].min()), float(outlines[:, 0].max())


def width(text: str, size: float, *, bold: bool = False) -> float:
    """Return how wide `text` is at `size`, in points."""
    _, left, right = outline(text, bold)
    return (right - left) * size


def placed(text: str, centre: FloatArray, size: float, *, bold: bool = False) -> Path:
    """Return the outline of `text` centred on a point of the page."""
    from matplotlib.path import Path

    path, left, right = outline(text, bold)
    shift = centre - size * np.array([(left + right) / 2, MIDDLE])
    return Path(np.asarray(path.vertices) * size + shift, path.codes)


def wrapped(text: str, size: float, room: float, *, bold: bool = False) -> list[str]:
    """Break `text` between words into lines no wider than `room`, where words allow it."""
    lines: list[str] = []
    for word in text.split():
        if lines and width(f"{lines[-1]} {word}", size, bold=bold) <= room:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines


class Occupied:
    """The boxes on the page that labels have taken already."""

    def __init__(self) -> None:
        self._boxes = np.empty((0, 4))

    def add(self, centre: FloatArray, half: FloatArray) -> None:
        """Take the box around `centre`."""
        self._boxes = np.vstack([self._boxes, np.concatenate([centre - half, centre + half])])

    def overlap(self, centre: FloatArray, half: FloatArray) -> float:
        """Return the area of the box around `centre` that is taken, in square points."""
        low = np.maximum(self._boxes[:, :2], centre - half)
        high = np.minimum(self._boxes[:, 2:], centre + half)
        return float(np.prod(np.maximum(high - low, 0.0), axis=1).sum())

    def free(self, centres: FloatArray, half: FloatArray) -> FloatArray | None:
        """Return the first centre whose box is free, or None."""
        for centre in centres:
            if self.overlap(centre, half) == 0.0:
                return np.asarray(centre)
        return None
