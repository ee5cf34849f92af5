"""Normals of a cloud of points, for scans that come without them."""

from __future__ import annotations

import numpy as np

from gpcourse.geometry.arrays import FloatArray, as_points
from gpcourse.reference.registration.inputs import as_cloud, as_count
from gpcourse.reference.registration.nearest import morton_order

#: So many points at a time stay in the processor's cache.
_BLOCK = 8192


def estimate_normals(points: FloatArray, k: int = 16, *, towards: FloatArray | None = None) -> FloatArray:
    r"""Estimate a normal at each point: across the plane that fits its neighbours best.

    .. math:: C_i = \sum_{j \in N_i} (x_j - \bar x_i)(x_j - \bar x_i)^\top

    The normal is the eigenvector of the smallest eigenvalue. Chapter 4 derives it.

    Parameters
    ----------
    points : (n, 3) float array
        At least three.
    k : int
        The number of neighbours, the point itself among them; at least three.
    towards : (3,) array, optional
        The direction to the scanner. Normals are turned to that side; without it the sign is open.

    Returns
    -------
    (n, 3) float array
        Unit vectors.

    References
    ----------
    Notes ch. 4, *PCA based normal estimation*.
    """
    from scipy.spatial import cKDTree

    points = as_cloud(points, "points")
    k = as_count(k, len(points))
    # Neighbours in space are neighbours in memory, for the tree and for what is read at its answers.
    order = morton_order(points)
    points = points[order]
    # Leaves of 20 points in boxes that fit them take a fifth less time than 10 in boxes that do not.
    tree = cKDTree(points, leafsize=20, balanced_tree=False)
    coordinates = np.ascontiguousarray(points.T)
    normals = np.empty_like(points)
    for start in range(0, len(points), _BLOCK):
        block = slice(start, start + _BLOCK)
        _, neighbours = tree.query(points[block], k=k, workers=-1)
        near = (np.take(axis, neighbours) for axis in coordinates)
        x, y, z = (axis - axis.mean(axis=1, keepdims=True) for axis in near)
        pairs = ((x, x), (y, y), (z, z), (x, y), (x, z), (y, z))
        normals[order[block]] = smallest_eigenvector(*(np.einsum("nk,nk->n", a, b) for a, b in pairs))
    if towards is not None:
        away = normals @ as_points([towards], "towards")[0] < 0
        normals[away] *= -1
    return normals


def smallest_eigenvector(  # noqa: PLR0917
    xx: FloatArray, yy: FloatArray, zz: FloatArray, xy: FloatArray, xz: FloatArray, yz: FloatArray
) -> FloatArray:
    r"""Return unit eigenvectors of the smallest eigenvalues of many symmetric 3 × 3 matrices, in closed form.

    With the trace taken out, the characteristic polynomial is that of a cosine of three times an angle:
    :math:`4\cos^3\phi - 3\cos\phi = \cos 3\phi`. The eigenvector is across two rows of :math:`C - \lambda I`.

    Parameters
    ----------
    xx, yy, zz, xy, xz, yz : (n,) float arrays
        The entries of the matrices.

    Returns
    -------
    (n, 3) float array
        Where two eigenvalues are the smallest, any direction in their plane.
    """
    mean = (xx + yy + zz) / 3
    a, b, c = xx - mean, yy - mean, zz - mean
    spread = np.sqrt((a * a + b * b + c * c + 2 * (xy * xy + xz * xz + yz * yz)) / 6)
    spread = np.where(spread > 0, spread, 1.0)
    a, b, c, d, e, f = (entry / spread for entry in (a, b, c, xy, xz, yz))
    determinant = a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)
    angle = np.arccos(np.clip(determinant / 2, -1, 1)) / 3
    smallest = 2 * np.cos(angle + 2 * np.pi / 3)
    a, b, c = a - smallest, b - smallest, c - smallest
    # Of the three cross products of rows, the longest is the most exact.
    across = np.array(
        [
            [d * f - e * b, e * d - a * f, a * b - d * d],
            [d * c - e * f, e * e - a * c, a * f - d * e],
            [b * c - f * f, f * e - d * c, d * f - b * e],
        ]
    )
    lengths = np.sqrt((across**2).sum(axis=1))
    longest = lengths.argmax(axis=0)
    each = np.arange(len(mean))
    vectors, length = across[longest, :, each], lengths[longest, each]
    # All rows are parallel: the two smallest eigenvalues are equal. Anything across one row will do.
    for i in np.flatnonzero(length < 1e-12):
        C = np.array([[a[i], d[i], e[i]], [d[i], b[i], f[i]], [e[i], f[i], c[i]]])
        vectors[i], length[i] = np.linalg.eigh(C)[1][:, 0], 1.0
    return np.asarray(vectors / length[:, None])
