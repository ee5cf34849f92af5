"""Matching: a tree that finds the nearest point, and the rejection of bad pairs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from gpcourse.errors import ArrayError, GeometryError
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray, as_points
from gpcourse.reference.registration.inputs import (
    as_cloud,
    as_count,
    as_distance,
    as_fraction,
    as_normals,
    as_rows,
)


@dataclass(frozen=True)
class Leaf:
    """A box of a k-d tree with few points: their indices and positions."""

    indices: IntArray
    points: FloatArray


@dataclass(frozen=True)
class Split:
    """A box cut in two by the plane ``x[axis] = value``."""

    axis: int
    value: float
    # Quoted: a solved notebook has no future import, and the name comes after this class.
    below: "Tree"  # noqa: UP037
    above: "Tree"  # noqa: UP037


Tree = Leaf | Split


def build_kdtree(points: FloatArray, leaf_size: int = 8) -> Tree:
    """Sort points into a k-d tree.

    A box with more than `leaf_size` points is cut across its longest side, with half of the points on
    either side of the cut.

    Parameters
    ----------
    points : (n, 3) float array
        At least one point.
    leaf_size : int
        The most points in a box that is not cut.

    Returns
    -------
    Split or Leaf
        The root.

    References
    ----------
    Notes ch. 2, step 2: a hierarchical BSP tree.
    """
    points = as_cloud(points, "points")
    leaf_size = as_count(leaf_size, 2**31, "leaf_size")

    def tree(indices: IntArray) -> Tree:
        inside = points[indices]
        if len(indices) <= leaf_size:
            return Leaf(indices, inside)
        axis = int(np.ptp(inside, axis=0).argmax())
        half = len(indices) // 2
        order = np.argpartition(inside[:, axis], half)
        # Points on the plane itself may be on either side; half on each side, the depth stays log₂ n.
        value = float(inside[order[half], axis])
        return Split(axis, value, tree(indices[order[:half]]), tree(indices[order[half:]]))

    return tree(np.arange(len(points)))


def nearest(tree: Tree, query: FloatArray) -> tuple[float, int, int]:
    """Find the point of a k-d tree that is nearest to `query`.

    Parameters
    ----------
    tree : Split or Leaf
        From `build_kdtree`.
    query : (3,) float array

    Returns
    -------
    distance : float
        Between the query and the nearest point.
    index : int
        The row of that point; any one of them where several are equally near.
    visited : int
        The number of points to which a distance was computed.
    """
    best, index, visited = np.inf, -1, 0

    def search(node: Tree) -> None:
        nonlocal best, index, visited
        if isinstance(node, Leaf):
            distances = np.sqrt(((node.points - query) ** 2).sum(axis=1))
            i = int(distances.argmin())
            visited += len(distances)
            if distances[i] < best:
                best, index = float(distances[i]), int(node.indices[i])
            return
        beyond = float(query[node.axis]) - node.value
        near, far = (node.below, node.above) if beyond < 0 else (node.above, node.below)
        search(near)
        # All points on the other side are at least as far away as the plane is.
        if abs(beyond) < best:
            search(far)

    search(tree)
    return best, index, visited


def nearest_neighbours(
    points: FloatArray, queries: FloatArray, leaf_size: int = 8
) -> tuple[FloatArray, IntArray, IntArray]:
    """Find the nearest of `points` to each of `queries`, with a k-d tree.

    Sort the points into a tree once: a box with more than `leaf_size` points is cut in two. For each query
    go down to its box, then look into other boxes only where a nearer point may lie.

    Parameters
    ----------
    points : (n, 3) float array
        At least one point; some may coincide.
    queries : (m, 3) float array
    leaf_size : int
        The most points in a box that is not cut.

    Returns
    -------
    distances : (m,) float array
        Between each query and its nearest point.
    indices : (m,) int array
        The row of that point; any one of them where several are equally near.
    visited : (m,) int array
        The number of points to which a distance was computed, for each query.

    Raises
    ------
    ValueError
        If there are no points.

    References
    ----------
    Notes ch. 2, step 2: a hierarchical BSP tree, or a k-d tree.
    """
    tree = build_kdtree(points, leaf_size)
    found = [nearest(tree, query) for query in as_points(queries, "queries")]
    distances, indices, visited = zip(*found, strict=True) if found else ((), (), ())
    counts = np.array(indices, dtype=np.int64), np.array(visited, dtype=np.int64)
    return np.array(distances, dtype=np.float64), *counts


_FOR_THREADS = 4000

#: Finds the distance and the index of the nearest point for each row of an array of queries.
Match = Callable[[FloatArray], tuple[FloatArray, IntArray]]


def matcher(points: FloatArray) -> Match:
    """Return a function that finds the nearest of `points` to each row of an array of queries.

    It gives the distances and the indices, as `nearest_neighbours` does, from SciPy's k-d tree.
    """
    find = _finder(points, 1)

    def match(queries: FloatArray) -> tuple[FloatArray, IntArray]:
        distances, indices = find(queries)
        return np.asarray(distances, dtype=np.float64), np.asarray(indices, dtype=np.int64)

    return match


def follower(points: FloatArray, count: int) -> Match:
    r"""Return a function that matches the same `count` queries again and again, while they move.

    It gives what `matcher` gives, and searches only where the nearest point may have changed. Let d₁ and d₂
    be the distances of the nearest and the second nearest point when a query was last searched for. After it
    has moved by m, the first is at most d₁ + m away, and all others at least d₂ − m: while m < (d₂ − d₁) / 2,
    the nearest is still the nearest.
    """
    find = _finder(points, 2)
    searched_at, index = np.zeros((count, 3)), np.zeros(count, dtype=np.int64)
    slack = np.full(count, -1.0)

    def match(queries: FloatArray) -> tuple[FloatArray, IntArray]:
        again = np.flatnonzero(_apart(queries, searched_at) >= slack)
        if len(again):
            moved = queries.take(again, axis=0)  # several times faster than queries[again]
            distances, found = find(moved)
            searched_at[again] = moved
            index[again], slack[again] = found[:, 0], (distances[:, 1] - distances[:, 0]) / 2
        return _apart(queries, points.take(index, axis=0)), index.copy()

    return match


def _finder(points: FloatArray, k: int) -> Callable[[FloatArray], Any]:
    # Imported here: it takes half a second, and most of the chapter does without it.
    from scipy.spatial import cKDTree

    # Cutting boxes in the middle is several times faster than at the median, and the queries hardly notice.
    # They take a fifth less time with leaves of 32 points than with 10, in boxes that fit their points.
    tree = cKDTree(points, leafsize=32, balanced_tree=False)
    # To start threads takes as long as a search for some thousand points.
    return lambda queries: tree.query(queries, k=k, workers=-1 if len(queries) > _FOR_THREADS else 1)


def _apart(p: FloatArray, q: FloatArray) -> FloatArray:
    squares = (p - q) ** 2
    return np.asarray(np.sqrt(squares @ np.ones(3)))  # which NumPy does faster than to sum rows of three


def morton_order(points: FloatArray) -> IntArray:
    """Sort points along a curve that stays in one box of an octree until all of its points are met.

    Queries in this order find in the processor's cache what the query before them has used; and every
    k-th point in this order is an even sample.

    Returns
    -------
    (n,) int array
        A permutation of the rows.
    """
    axes = np.ascontiguousarray(points.T)
    corner = axes.min(axis=1, keepdims=True)
    size = float((axes.max(axis=1, keepdims=True) - corner).max()) or 1.0
    cells = ((axes - corner) * (1023.99 / size)).astype(np.int64)  # 10 bits for each axis
    # Spread the bits of each coordinate to every third place, then lay the three between each other.
    spread = np.arange(1024)
    for shift, mask in ((16, 0xFF0000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        spread = (spread | (spread << shift)) & mask
    x, y, z = spread.take(cells)
    # Key and row in one integer: sorting integers is faster than sorting rows by their keys.
    key = (x | (y << 1) | (z << 2)) << 32
    return np.asarray(np.sort(key | np.arange(len(points))) & 0xFFFFFFFF)


def reject_pairs(  # noqa: PLR0917
    p: FloatArray,
    q: FloatArray,
    normals_p: FloatArray,
    normals_q: FloatArray,
    max_distance: float,
    max_angle: float,
) -> BoolArray:
    """Mark the pairs that are near enough to each other, and face the same way.

    Parameters
    ----------
    p, q : (n, 3) float arrays
        Row i of `q` was matched with row i of `p`.
    normals_p, normals_q : (n, 3) float arrays
        Unit normals at `p` and `q`, outward.
    max_distance : float
        The longest distance that is kept.
    max_angle : float
        The largest angle between the two normals that is kept, in radians from 0 to π.

    Returns
    -------
    (n,) bool array
        True for the pairs to keep.

    References
    ----------
    Notes ch. 2, step 3: match compatible points only.
    """
    p = as_points(p, "p")
    q = as_rows(q, "q", "p", len(p))
    normals_p = as_normals(normals_p, "normals_p", "p", len(p))
    normals_q = as_normals(normals_q, "normals_q", "p", len(p))
    if not 0 <= max_angle <= np.pi:
        raise GeometryError(f"max_angle is {max_angle!r}; give radians from 0 to π")
    distances = np.linalg.norm(p - q, axis=1)
    cosines = np.einsum("ij,ij->i", normals_p, normals_q)
    # The cosine falls as the angle grows.
    return np.asarray((distances <= as_distance(max_distance)) & (cosines >= np.cos(max_angle)))


def trim_pairs(distances: FloatArray, keep: float) -> BoolArray:
    """Mark the closest part of the pairs.

    Parameters
    ----------
    distances : (n,) float array
        Between the two points of each pair.
    keep : float
        The part of the pairs to keep, above 0 and at most 1.

    Returns
    -------
    (n,) bool array
        True for the pairs whose distance is at most the quantile `keep` of all distances.

    References
    ----------
    Notes ch. 2, step 3.
    """
    distances = np.asarray(distances, dtype=np.float64)
    if distances.ndim != 1 or np.isnan(distances).any():
        raise ArrayError("distances must be one number for each pair, none of them NaN")
    keep = as_fraction(keep)
    if keep == 1 or not len(distances):
        return np.ones(len(distances), dtype=bool)
    return np.asarray(distances <= np.quantile(distances, keep))


def reject_boundary_pairs(indices: IntArray, on_boundary: BoolArray) -> BoolArray:
    """Mark the pairs whose partner is not on the boundary of the mesh.

    Where two scans overlap in part, all points outside the overlap find their nearest point on the boundary
    of the other scan, and pull it over.

    Parameters
    ----------
    indices : (m,) int array
        The vertex of the other scan that each point was matched with.
    on_boundary : (n,) bool array
        Which of its vertices lie on its boundary.

    Returns
    -------
    (m,) bool array
        True for the pairs to keep.

    References
    ----------
    Notes ch. 2, step 3.
    """
    indices, flags = np.asarray(indices), np.asarray(on_boundary)
    if flags.dtype != bool or flags.ndim != 1:
        raise ArrayError("on_boundary must be one flag, True or False, for each vertex")
    if indices.ndim != 1 or not (indices.size == 0 or np.issubdtype(indices.dtype, np.integer)):
        raise ArrayError("indices must be one whole number for each pair")
    outside = np.flatnonzero((indices < 0) | (indices >= len(flags)))
    if len(outside):
        i = int(outside[0])
        raise GeometryError(f"indices[{i}] is {indices[i]}; on_boundary has {len(flags)} vertices")
    return np.asarray(~flags[indices.astype(np.int64)])
