"""What lies in front of what: the order in which polygons are painted, and which points are hidden."""

from __future__ import annotations

import heapq

import numpy as np

from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray

#: The order of polygons is worked out pair by pair, so for so many at most.
PAIRWISE_LIMIT = 400


def painting_order(page: FloatArray, height: FloatArray, corners: IntArray, sizes: IntArray) -> IntArray:
    """Order a few polygons from the farthest to the nearest.

    Parameters
    ----------
    page, height : (n, 2) and (n,) float arrays
        The vertices on the page and their height towards the viewer, in points.
    corners, sizes : (c,) and (m,) int arrays
        Polygons laid end to end.

    Returns
    -------
    (m,) int array
    """
    starts = np.cumsum(sizes) - sizes
    mean = np.add.reduceat(height[corners], starts) / sizes if len(sizes) else np.empty(0)
    if len(sizes) < 2:
        return np.arange(len(sizes))
    # Pad every polygon to the same number of corners by repeating its last one.
    column = np.minimum(np.arange(int(sizes.max())), sizes[:, None] - 1)
    padded = corners[starts[:, None] + column]
    behind, front = _overlaps(page[padded], height[padded])
    return _topological(mean, behind, front)


def _overlaps(flat: FloatArray, height: FloatArray) -> tuple[IntArray, IntArray]:
    """Return pairs (behind, in front) of polygons that overlap on the page."""
    low, high = flat.min(axis=1), flat.max(axis=1)
    touch = ((low[:, None] < high[None] - 1e-6) & (low[None] < high[:, None] - 1e-6)).all(axis=2)
    i, j = np.nonzero(np.triu(touch, 1))
    apart = _separated(flat[i], flat[j]) | _separated(flat[j], flat[i])
    i, j = i[~apart], j[~apart]
    tolerance = 1e-6 * (1 + np.abs(height).max())
    normal, level = _planes(flat, height)
    # A polygon is behind another if no corner of it is in front of the other's plane, or if no
    # corner of the other is behind its own plane.
    votes = np.zeros(len(i))
    for first, second, sign in ((i, j, 1.0), (j, i, -1.0)):
        gap = height[second] - (np.einsum("pkc,pc->pk", flat[second], normal[first]) + level[first][:, None])
        steep = ~np.isfinite(level[first])
        gap[steep] = 0.0
        votes += sign * ((gap >= -tolerance).all(axis=1) & (gap > tolerance).any(axis=1))
        votes -= sign * ((gap <= tolerance).all(axis=1) & (gap < -tolerance).any(axis=1))
    # votes > 0: the second polygon lies in front of the first.
    forward, backward = votes > 0, votes < 0
    return np.concatenate([i[forward], j[backward]]), np.concatenate([j[forward], i[backward]])


def _separated(a: FloatArray, b: FloatArray) -> BoolArray:
    """Tell for each pair of polygons whether a side of `a` separates them on the page."""
    side = np.roll(a, -1, axis=1) - a
    axis = np.stack([-side[..., 1], side[..., 0]], axis=-1)
    length = np.linalg.norm(axis, axis=-1, keepdims=True)
    axis = axis / np.where(length > 0, length, 1.0)
    on_a = np.einsum("pkc,psc->psk", a, axis)
    on_b = np.einsum("pkc,psc->psk", b, axis)
    gap = np.maximum(on_b.min(axis=2) - on_a.max(axis=2), on_a.min(axis=2) - on_b.max(axis=2))
    return np.asarray(((gap > -1e-3) & (length[..., 0] > 0)).any(axis=1))


def _planes(flat: FloatArray, height: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Fit ``height = normal · page + level``; level is NaN for a polygon seen edge-on."""
    x, y = flat[..., 0], flat[..., 1]
    mx, my, mh = x.mean(axis=1), y.mean(axis=1), height.mean(axis=1)
    dx, dy, dh = x - mx[:, None], y - my[:, None], height - mh[:, None]
    xx, xy, yy = (dx * dx).sum(axis=1), (dx * dy).sum(axis=1), (dy * dy).sum(axis=1)
    xh, yh = (dx * dh).sum(axis=1), (dy * dh).sum(axis=1)
    det = xx * yy - xy * xy
    flat_enough = det > 1e-9 * (xx + yy) ** 2
    safe = np.where(flat_enough, det, 1.0)
    normal = np.stack([(yy * xh - xy * yh) / safe, (xx * yh - xy * xh) / safe], axis=1)
    level = mh - normal[:, 0] * mx - normal[:, 1] * my
    return normal, np.where(flat_enough, level, np.nan)


def _topological(mean: FloatArray, behind: IntArray, front: IntArray) -> IntArray:
    """Paint whatever has nothing unpainted behind it, the lowest first; break cycles by height."""
    waiting = np.bincount(front, minlength=len(mean))
    above: list[list[int]] = [[] for _ in mean]
    for b, f in zip(behind.tolist(), front.tolist(), strict=True):
        above[b].append(f)
    ready = [(float(mean[k]), k) for k in np.flatnonzero(waiting == 0).tolist()]
    heapq.heapify(ready)
    rest = iter(np.argsort(mean, kind="stable").tolist())
    done = np.zeros(len(mean), dtype=bool)
    order: list[int] = []
    while len(order) < len(mean):
        # In a cycle nothing is ready: take the lowest that is left.
        k = heapq.heappop(ready)[1] if ready else next(k for k in rest if not done[k])
        if done[k]:
            continue
        done[k] = True
        order.append(k)
        for f in above[k]:
            waiting[f] -= 1
            if waiting[f] == 0 and not done[f]:
                heapq.heappush(ready, (float(mean[f]), f))
    return np.array(order, dtype=np.int64)


def triangle_fans(corners: IntArray, sizes: IntArray) -> tuple[IntArray, IntArray]:
    """Cut polygons into fans: (t, 3) positions in `corners`, and the polygon of each triangle."""
    starts = np.cumsum(sizes) - sizes
    face = np.repeat(np.arange(len(sizes)), sizes - 2)
    within = np.arange(len(face)) - np.repeat(np.cumsum(sizes - 2) - (sizes - 2), sizes - 2)
    first = starts[face]
    return np.stack([first, first + within + 1, first + within + 2], axis=1), face


def hidden(
    page: FloatArray, height: FloatArray, triangles: FloatArray, levels: FloatArray, clearance: float
) -> BoolArray:
    """Tell which points lie behind a triangle by more than `clearance`.

    Parameters
    ----------
    page, height : (k, 2) and (k,) float arrays
    triangles, levels : (t, 3, 2) and (t, 3) float arrays
        Corners on the page, and their heights.
    clearance : float
        In points: what is drawn on a surface must not be hidden by it.
    """
    covered = np.zeros(len(page), dtype=bool)
    if not len(triangles) or not len(page):
        return covered
    low, high, top = triangles.min(axis=1), triangles.max(axis=1), levels.max(axis=1)
    # Points in blocks that are close together on the page meet few triangles each.
    cells = max(1, int(np.sqrt(len(page) / 64)))
    span = np.ptp(page, axis=0).max() or 1.0
    cell = ((page - page.min(axis=0)) / span * cells).astype(int)
    order = np.lexsort((cell[:, 0], cell[:, 1]))
    for block in np.array_split(order, max(1, len(order) // 64)):
        near, far = page[block].min(axis=0), page[block].max(axis=0)
        here = ((high >= near) & (low <= far)).all(axis=1) & (top > height[block].min())
        covered[block] = _covered(page[block], height[block] + clearance, triangles[here], levels[here])
    return covered


def _covered(page: FloatArray, height: FloatArray, triangles: FloatArray, levels: FloatArray) -> BoolArray:
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    area = _cross(b - a, c - a)
    seen = np.abs(area) > 1e-9
    a, b, c, levels, area = a[seen], b[seen], c[seen], levels[seen], area[seen]
    p = page[:, None]
    weight_a = _cross(b - p, c - p) / area
    weight_b = _cross(c - p, a - p) / area
    weight_c = 1 - weight_a - weight_b
    inside = (weight_a >= 0) & (weight_b >= 0) & (weight_c >= 0)
    level = weight_a * levels[:, 0] + weight_b * levels[:, 1] + weight_c * levels[:, 2]
    return np.asarray((inside & (level > height[:, None])).any(axis=1))


def _cross(u: FloatArray, v: FloatArray) -> FloatArray:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
