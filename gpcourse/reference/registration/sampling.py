"""Selection: which points of a scan to match, and which motions they hold."""

from __future__ import annotations

import numpy as np

from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.reference.registration.inputs import as_cloud, as_count, as_normals, as_seed

#: Normals are sorted into cubes of side 1/3, about 20° wide.
_CELLS_PER_UNIT = 3


def random_sampling(n_points: int, k: int, seed: int) -> IntArray:
    """Choose `k` of `n_points` points at random: any `k` of them are as likely as any others.

    Parameters
    ----------
    n_points : int
    k : int
        At most `n_points`.
    seed : int
        For ``numpy.random.default_rng``: the same seed gives the same points.

    Returns
    -------
    (k,) int array
        Different indices, in any order.

    References
    ----------
    Notes ch. 2, step 1.
    """
    n_points = as_count(n_points, 2**62, "n_points")
    return np.random.default_rng(as_seed(seed)).choice(n_points, size=as_count(k, n_points), replace=False)


def uniform_sampling(points: FloatArray, k: int) -> IntArray:
    """Choose `k` points that are spread evenly: each next one is the farthest from all chosen so far.

    Parameters
    ----------
    points : (n, 3) float array
    k : int
        At most n.

    Returns
    -------
    (k,) int array
        Different indices, in the order in which they were chosen. The first may be any point.

    References
    ----------
    Notes ch. 2, step 1.
    """
    points = as_cloud(points, "points")
    k = as_count(k, len(points))
    chosen = np.zeros(k, dtype=np.int64)
    distances = np.full(len(points), np.inf)
    for i in range(1, k):
        newest = points[chosen[i - 1]]
        distances = np.minimum(distances, ((points - newest) ** 2).sum(axis=1))
        distances[chosen[i - 1]] = -1.0  # not again, not even where points coincide
        chosen[i] = distances.argmax()
    return chosen


def normal_space_sampling(normals: FloatArray, k: int, seed: int) -> IntArray:
    """Choose `k` points whose normals are spread evenly over all directions.

    Sort the normals into cells of similar direction, and take from each cell in turn, at random, until k are
    chosen; a cell that is empty is left out.

    Parameters
    ----------
    normals : (n, 3) float array
        Unit vectors.
    k : int
        At most n.
    seed : int
        For ``numpy.random.default_rng``: the same seed gives the same points.

    Returns
    -------
    (k,) int array
        Different indices, in any order.

    References
    ----------
    Notes ch. 2, step 1, *Normal-based sampling*.
    """
    normals = as_normals(normals, "normals", "normals", len(np.atleast_1d(normals)))
    k = as_count(k, len(normals))
    shuffled = np.random.default_rng(as_seed(seed)).permutation(len(normals))
    cells = np.round(_CELLS_PER_UNIT * normals[shuffled]).astype(np.int64)
    _, cell, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    # The turn in which a point is taken is its place among the points of its own cell.
    by_cell = np.argsort(cell.ravel(), kind="stable")
    turn = np.empty(len(normals), dtype=np.int64)
    turn[by_cell] = np.arange(len(normals)) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.asarray(shuffled[np.argsort(turn, kind="stable")[:k]])


def slippage_analysis(points: FloatArray, normals: FloatArray) -> tuple[FloatArray, FloatArray]:
    r"""Find the motions that move a surface least away from itself.

    A small motion (r, t) moves x by :math:`r \times x + t`, and away from the surface by
    :math:`r \cdot (x \times n) + t \cdot n`. The mean square of that is a quadratic form:

    .. math:: C = \frac1n \sum_i \begin{pmatrix} x_i \times n_i \\ n_i \end{pmatrix}
              \begin{pmatrix} x_i \times n_i \\ n_i \end{pmatrix}^{\!\top}

    Its eigenvectors with an eigenvalue near 0 are the motions in which the surface slips along itself.

    Parameters
    ----------
    points : (n, 3) float array
        Positions; x is measured from their centroid, in units of their mean distance from it.
    normals : (n, 3) float array
        Unit normals; their sign does not matter.

    Returns
    -------
    eigenvalues : (6,) float array
        Ascending, without a unit: neither the scale nor the place of the points matters.
    motions : (6, 6) float array
        Column j is the unit eigenvector of eigenvalue j: three components of r, then three of t.

    References
    ----------
    Notes ch. 2, step 1, *Slippage analysis*; Gelfand, Ikemoto, Rusinkiewicz, Levoy 2003.
    """
    A = _constraints(points, normals)
    eigenvalues, motions = np.linalg.eigh(A.T @ A / len(A))
    return eigenvalues, motions


def _constraints(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Return a row [x × n, n] for each point."""
    points = as_cloud(points, "points")
    normals = as_normals(normals, "normals", "points", len(points))
    x = points - points.mean(axis=0)
    x /= np.linalg.norm(x, axis=1).mean() or 1.0
    return np.column_stack([np.cross(x, normals), normals])


def stable_sampling(points: FloatArray, normals: FloatArray, k: int) -> IntArray:
    """Choose `k` points that hold all motions about equally well.

    The hold of a point on a motion is the square of what the motion moves it along its normal. The six
    motions are those of the slippage analysis. Again and again, look for the motion on which the chosen
    points have the least hold together, and take the point that is not chosen yet and has most hold on it.

    Parameters
    ----------
    points : (n, 3) float array
    normals : (n, 3) float array
        Unit normals.
    k : int
        At most n.

    Returns
    -------
    (k,) int array
        Different indices, in the order in which they were chosen.

    References
    ----------
    Notes ch. 2, step 1, *Stable sampling*; Gelfand, Ikemoto, Rusinkiewicz, Levoy 2003.
    """
    A = _constraints(points, normals)
    k = as_count(k, len(A))
    _, motions = slippage_analysis(points, normals)
    hold = (A @ motions) ** 2
    best_first = [iter(column) for column in np.argsort(-hold, axis=0, kind="stable").T.tolist()]
    chosen: dict[int, None] = {}  # keeps the order
    total = np.zeros(6)
    while len(chosen) < k:
        weakest = best_first[int(total.argmin())]
        i = next(i for i in weakest if i not in chosen)
        chosen[i] = None
        total += hold[i]
    return np.array(list(chosen), dtype=np.int64)
