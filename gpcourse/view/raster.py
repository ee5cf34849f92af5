"""Shaded triangles as pixels, the nearest at every one: right where they cut each other, too."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gpcourse.geometry.arrays import FloatArray, IntArray

#: So many samples are looked at together, which bounds the memory.
CHUNK = 2_000_000


def shaded(
    corners: FloatArray, heights: FloatArray, colours: FloatArray, width: int, height: int
) -> NDArray[np.uint8]:
    """Return a (height, width, 4) picture of triangles, rows from the bottom, seen from above; RGBA.

    A pixel belongs to a triangle if its middle does, and shows the triangle that is highest there. Neighbours
    that share an edge share no pixel and leave none out.

    Parameters
    ----------
    corners : (t, 3, 2) float array
        In pixels; the first pixel reaches from 0 to 1.
    heights : (t, 3) float array
        Towards the viewer.
    colours : (t, 3, 3) float array
        Red, green and blue from 0 to 1, blended between the corners.
    """
    turned = _edge_functions(corners)
    nearest = np.full(width * height, -np.inf)
    owner = np.full(width * height, -1, dtype=np.int64)
    slope = np.einsum("tkc,tk->tc", turned, heights)  # height = slope . (x, y, 1)
    for triangle, row, first, last in _spans(corners, width, height):
        count = last - first
        span = np.repeat(np.arange(len(count)), count)
        column = np.arange(len(span)) - (np.cumsum(count) - count)[span] + first[span]
        along = slope[triangle]
        level = (along[:, 1] * (row + 0.5) + along[:, 2] + 0.5 * along[:, 0])[span] + along[span, 0] * column
        pixel = row[span] * width + column
        np.maximum.at(nearest, pixel, level)
        wins = level >= nearest[pixel]
        owner[pixel[wins]] = triangle[span[wins]]
    return _coloured(owner, turned, colours, width, height)


def _edge_functions(corners: FloatArray) -> FloatArray:
    """Return (t, 3, 3): the share of corner k at a point is the product of row k with (x, y, 1)."""
    x, y = corners[..., 0], corners[..., 1]
    following, last = np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)
    parts = np.stack(
        [
            following[..., 1] - last[..., 1],
            last[..., 0] - following[..., 0],
            following[..., 0] * last[..., 1] - last[..., 0] * following[..., 1],
        ],
        axis=2,
    )
    twice = parts[:, 0, 0] * (x[:, 0] - x[:, 2]) + parts[:, 0, 1] * (y[:, 0] - y[:, 2])
    return np.asarray(parts / np.where(twice == 0, np.inf, twice)[:, None, None])


def _spans(
    corners: FloatArray, width: int, height: int
) -> list[tuple[IntArray, IntArray, IntArray, IntArray]]:
    """Return, in chunks, the triangle, the row, the first column and the one after the last of every span."""
    order = np.lexsort((corners[..., 0], corners[..., 1]), axis=1)
    low, middle, high = np.moveaxis(np.take_along_axis(corners, order[..., None], axis=1), 1, 0)
    # A row belongs to a triangle if its middle does; of two neighbours one has what lies on their edge.
    bottom = np.clip(np.ceil(low[:, 1] - 0.5), 0, height).astype(np.int64)
    top = np.clip(np.ceil(high[:, 1] - 0.5), 0, height).astype(np.int64)
    rows = np.maximum(top - bottom, 0)
    triangle = np.repeat(np.arange(len(rows)), rows)
    row = np.arange(len(triangle)) - (np.cumsum(rows) - rows)[triangle] + bottom[triangle]
    y = row + 0.5
    upper = (y >= middle[triangle, 1])[:, None]
    one = _crossing(low[triangle], high[triangle], y)
    start, end = (
        np.where(upper, middle[triangle], low[triangle]),
        np.where(upper, high[triangle], middle[triangle]),
    )
    other = _crossing(start, end, y)
    first = np.clip(np.ceil(np.minimum(one, other) - 0.5), 0, width).astype(np.int64)
    last = np.clip(np.ceil(np.maximum(one, other) - 0.5), 0, width).astype(np.int64)
    found = last > first
    parts = np.array([triangle[found], row[found], first[found], last[found]])
    before = np.cumsum(parts[3] - parts[2]) // CHUNK
    cuts = np.flatnonzero(np.diff(before)) + 1
    return [(part[0], part[1], part[2], part[3]) for part in np.split(parts, cuts, axis=1)]


def _crossing(start: FloatArray, end: FloatArray, y: FloatArray) -> FloatArray:
    """Return where edges, given from their lower end, meet a height: bit for bit the same for both sides."""
    rise = end[:, 1] - start[:, 1]
    share = (y - start[:, 1]) / np.where(rise == 0, np.inf, rise)
    return np.asarray(start[:, 0] + share * (end[:, 0] - start[:, 0]))


def _coloured(
    owner: IntArray, turned: FloatArray, colours: FloatArray, width: int, height: int
) -> NDArray[np.uint8]:
    picture = np.zeros((height * width, 4), dtype=np.uint8)
    seen = np.flatnonzero(owner >= 0)
    row, column = np.divmod(seen, width)
    # Each colour changes evenly over a triangle: so much to the right, so much upwards.
    change = np.einsum("tkc,tkd->tdc", turned, 255 * colours)
    change[..., 2] += 0.5 * change[..., 0] + 0.5 * change[..., 1]
    for channel in range(3):
        right, up, start = change[:, channel].T
        shade = right[owner[seen]] * column + up[owner[seen]] * row + start[owner[seen]]
        picture[seen, channel] = np.rint(np.clip(shade, 0, 255))
    picture[seen, 3] = 255
    return picture.reshape(height, width, 4)
