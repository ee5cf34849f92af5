"""Normals of a cloud of points, for scans that come without them."""

from __future__ import annotations

import numpy as np

from gpcourse.geometry.arrays import FloatArray
from gpcourse.reference.registration.inputs import as_cloud, as_count


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
    _, neighbours = cKDTree(points).query(points, k=k, workers=-1)
    x = points[neighbours] - points[neighbours].mean(axis=1, keepdims=True)
    _, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", x, x))
    normals = vectors[:, :, 0]
    if towards is not None:
        normals = normals * np.where(normals @ np.asarray(towards, dtype=np.float64) < 0, -1.0, 1.0)[:, None]
    return np.asarray(normals)
