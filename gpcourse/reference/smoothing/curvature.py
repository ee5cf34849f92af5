"""Discrete curvature: mean curvature from the Laplacian, Gaussian curvature from angles, and mesh quality."""

from __future__ import annotations

import numpy as np

from gpcourse.errors import ArrayError
from gpcourse.geometry.arrays import FloatArray, IntArray, as_points
from gpcourse.geometry.triangles import corner_angles, face_areas
from gpcourse.reference.smoothing.operators import (
    adjacency,
    boundary_vertices,
    cotangent_matrix,
    mixed_areas,
    refuse_empty_cells,
)


def mean_curvature_normal(vertices: FloatArray, faces: IntArray) -> FloatArray:
    r"""Return the mean curvature normal :math:`H\mathbf{n} = -\tfrac12 \Delta\mathbf{x}` at each vertex.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices, counter-clockwise seen from outside.

    Returns
    -------
    (n, 3) float array
        Per unit of length, pointwise (mixed cells). On a sphere of radius R it points outward with length
        1/R. At a boundary it is no curvature: there it is dominated by the pull of the surface along itself.

    Raises
    ------
    ValueError
        If a face has no area or a vertex belongs to no face; names it.

    References
    ----------
    Notes ch. 6 §3, §6; Meyer et al. 2003.
    """
    areas = mixed_areas(vertices, faces)
    refuse_empty_cells(areas)
    return np.asarray(-0.5 * (cotangent_matrix(vertices, faces) @ vertices) / areas[:, None])


def discrete_mean_curvature(
    vertices: FloatArray, faces: IntArray, normals: FloatArray | None = None
) -> FloatArray:
    r"""Return the mean curvature H at each vertex.

    .. math:: |H| = \tfrac12 \|\Delta\mathbf{x}\| \qquad\text{or}\qquad
              H = -\tfrac12 \Delta\mathbf{x} \cdot \mathbf{n}

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices, counter-clockwise seen from outside.
    normals : (n, 3) float array, optional
        Outward unit normals, which give H its sign. Without them the absolute value is returned.

    Returns
    -------
    (n,) float array
        Per unit of length, pointwise (mixed cells); +1/R on a sphere of radius R. No curvature at a boundary.

    Raises
    ------
    ValueError
        If a face has no area, a vertex belongs to no face, or there is not one normal per vertex.

    References
    ----------
    Notes ch. 6 §6, *Mean Curvature*.
    """
    Hn = mean_curvature_normal(vertices, faces)
    if normals is None:
        return np.asarray(np.linalg.norm(Hn, axis=1))
    n = as_points(normals, "normals")
    if n.shape != Hn.shape:
        raise ArrayError(f"normals has shape {n.shape}; give one normal for each of {len(Hn)} vertices")
    return np.asarray((Hn * n).sum(axis=1))


def angle_defect(vertices: FloatArray, faces: IntArray) -> FloatArray:
    r"""Return what the angles around each vertex lack of a full turn.

    .. math:: 2\pi - \sum_j \theta_j \quad\text{inside}, \qquad
              \pi - \sum_j \theta_j \quad\text{at the boundary}

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices.

    Returns
    -------
    (n,) float array
        In radians, integrated: the Gaussian curvature of the cell, and at the boundary the turning of
        the boundary. They sum to 2π times the Euler characteristic.

    Raises
    ------
    DegenerateFaceError
        If a face has no area; names the first one.

    References
    ----------
    Notes ch. 6 §6, *Gaussian curvature*.
    """
    angles = corner_angles(vertices, faces)
    around = np.bincount(np.ravel(faces), weights=angles.ravel(), minlength=len(vertices))
    full = np.where(boundary_vertices(faces, len(vertices)), np.pi, 2 * np.pi)
    return np.asarray(full - around)


def discrete_gaussian_curvature(vertices: FloatArray, faces: IntArray) -> FloatArray:
    r"""Return the Gaussian curvature K at each vertex: the angle defect over the area of the mixed cell.

    .. math:: K(v_i) = \frac{1}{A_i} \Bigl( 2\pi - \sum_j \theta_j \Bigr)

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices.

    Returns
    -------
    (n,) float array
        Per squared unit of length, pointwise; 1/R² on a sphere of radius R. At a boundary, with π for 2π, it
        is the turning of the boundary over the area, which is no curvature of the surface.

    Raises
    ------
    ValueError
        If a face has no area or a vertex belongs to no face; names it.

    References
    ----------
    Notes ch. 6 §6; Meyer et al. 2003.
    """
    areas = mixed_areas(vertices, faces)
    refuse_empty_cells(areas)
    return np.asarray(angle_defect(vertices, faces) / areas)


def discrete_principal_curvatures(H: FloatArray, K: FloatArray) -> tuple[FloatArray, FloatArray]:
    r"""Return the principal curvatures from mean and Gaussian curvature.

    .. math:: \kappa_{1,2} = H \pm \sqrt{H^2 - K}

    Where a surface is close to a sphere, :math:`H^2 - K` is close to 0, and the errors of a discrete H and K
    can make it negative; it then counts as 0.

    Parameters
    ----------
    H, K : (n,) float arrays
        Mean and Gaussian curvature at the same vertices.

    Returns
    -------
    k1, k2 : (n,) float arrays
        ``k1 >= k2``, per unit of length. Their mean is H; their product is K where nothing was cut off.

    Raises
    ------
    ValueError
        If H and K are of different shapes.

    References
    ----------
    Notes ch. 6 §6.
    """
    mean, gauss = np.asarray(H, dtype=float), np.asarray(K, dtype=float)
    if mean.shape != gauss.shape:
        raise ArrayError(f"H has shape {mean.shape} and K has shape {gauss.shape}; give one each per vertex")
    root = np.sqrt(np.maximum(mean**2 - gauss, 0))
    return mean + root, mean - root


def mesh_quality(vertices: FloatArray, faces: IntArray) -> dict[str, FloatArray | IntArray]:
    r"""Measure the shape of the triangles and the valence of the vertices.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices.

    Returns
    -------
    dict of arrays
        For each face ``"smallest_angle"``, in radians, at most π/3; ``"aspect_ratio"``, the longest edge over
        the shortest altitude times √3/2, at least 1; ``"radius_ratio"``, twice the radius of the incircle
        over that of the circumcircle, at most 1. All three are reached by the equilateral triangle.
        For each vertex ``"valence"``, its number of neighbours (int).

    Raises
    ------
    DegenerateFaceError
        If a face has no area; names the first one.

    References
    ----------
    Notes ch. 6 §7, *Triangle shape*.
    """
    points, angles = as_points(vertices, "vertices"), corner_angles(vertices, faces)
    ahead, behind = points[np.roll(faces, -1, axis=1)], points[np.roll(faces, -2, axis=1)]
    longest = np.linalg.norm(ahead - behind, axis=2).max(axis=1)
    # The shortest altitude stands on the longest edge.
    altitude = 2 * face_areas(vertices, faces) / longest
    return {
        "smallest_angle": angles.min(axis=1),
        "aspect_ratio": np.sqrt(3) / 2 * longest / altitude,
        "radius_ratio": 8 * np.sin(angles / 2).prod(axis=1),
        "valence": np.diff(adjacency(faces, len(points)).indptr).astype(np.int64),
    }
