"""Fairing: energies of surfaces, and the surfaces of least energy through what is fixed."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from gpcourse.errors import ArrayError
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray, as_points
from gpcourse.geometry.triangles import surface_area
from gpcourse.reference.smoothing.arguments import (
    as_count,
    as_matrix,
    as_number,
    as_values,
    as_vertex_indices,
    cell_areas,
)
from gpcourse.reference.smoothing.operators import cotangent_matrix, mass_matrix
from gpcourse.reference.smoothing.solvers import solve_with_fixed


def dirichlet_energy(C: sparse.csr_array, x: FloatArray) -> float:
    r"""Return the Dirichlet energy :math:`\int \|\nabla x\|^2 = -x^T C x`.

    The membrane energy made quadratic; of the coordinates of the mesh that C is of, twice the area.

    Parameters
    ----------
    C : (n, n) csr_array
        Cotangent matrix.
    x : (n,) or (n, k) float array
        A function, or several, whose energies are summed: the three coordinates of a surface.

    Returns
    -------
    float
        At least 0, in squared units of `x`. Its gradient is ``-2 * C @ x``.

    References
    ----------
    Notes ch. 6 §14, *Membrane energy*.
    """
    stiffness = as_matrix(C, "C")
    values = as_values(x, stiffness.shape[0], "x")
    return float(-(values * (stiffness @ values)).sum())


def membrane_energy(vertices: FloatArray, faces: IntArray) -> float:
    """Return the membrane energy of a surface: its area.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices.

    Returns
    -------
    float
        In squared units of length. Its gradient is ``-C @ vertices``, with the C of these positions.

    References
    ----------
    Notes ch. 6 §14, *Membrane energy*; Pinkall and Polthier 1993.
    """
    return surface_area(vertices, faces)


def thin_plate_energy(C: sparse.csr_array, M: sparse.csr_array, x: FloatArray) -> float:
    r"""Return the thin-plate energy :math:`\int \|\Delta x\|^2 = x^T C M^{-1} C x`.

    The bending energy made quadratic. It equals the integral of
    :math:`\|x_{uu}\|^2 + 2\|x_{uv}\|^2 + \|x_{vv}\|^2` where position and normal are given at the boundary.

    Parameters
    ----------
    C, M : (n, n) csr_arrays
        Cotangent and mass matrix.
    x : (n,) or (n, k) float array
        A function, or several, whose energies are summed.

    Returns
    -------
    float
        At least 0. Its gradient is ``2 * C @ M⁻¹ @ C @ x``.

    Raises
    ------
    ValueError
        If the cell of a vertex is empty; names it.

    References
    ----------
    Notes ch. 6 §14, *Thin-plate energy*.
    """
    stiffness = as_matrix(C, "C")
    areas = cell_areas(M, stiffness.shape[0])
    integrated = stiffness @ as_values(x, len(areas), "x")
    return float((np.square(integrated).T / areas).sum())


def euler_lagrange_1d(t: FloatArray, left: float, right: float) -> FloatArray:
    r"""Minimise :math:`\int f'(t)^2\,dt` among functions with given values at both ends.

    .. math:: \sum_i \frac{(f_{i+1} - f_i)^2}{t_{i+1} - t_i} \to \min

    A minimiser satisfies the Euler–Lagrange equation :math:`f'' = 0`.

    Parameters
    ----------
    t : (n,) float array
        The parameters of the samples, increasing, not necessarily in equal steps.
    left, right : float
        The values at the first and the last sample.

    Returns
    -------
    (n,) float array
        The minimiser at the samples.

    Raises
    ------
    ValueError
        If there are fewer than two samples or they do not increase.

    References
    ----------
    Notes ch. 6 §14, *Calculus of Variations*.
    """
    samples = as_values(np.ravel(t), np.size(t), "t", "samples")
    if len(samples) < 2 or not (np.diff(samples) > 0).all():
        raise ArrayError("t must have at least two samples that increase from each to the next")
    ends = [as_number(left, "left"), as_number(right, "right")]
    # The energy is fᵀ A f: on a line the cotangent weight of an edge is one over its length.
    n, weight = len(samples), 1 / np.diff(samples)
    difference = sparse.eye_array(n - 1, n, k=1) - sparse.eye_array(n - 1, n)
    A = sparse.csr_array(difference.T @ sparse.diags_array(weight) @ difference)
    return solve_with_fixed(A, np.zeros(n), np.array([0, n - 1]), np.array(ends))


def fair(vertices: FloatArray, faces: IntArray, fixed: BoolArray | IntArray, order: int) -> FloatArray:
    r"""Make the free part of a surface as smooth as possible: :math:`\Delta^k \mathbf{x} = 0`.

    Order 1 is a membrane (least Dirichlet energy), 2 a thin plate, 3 varies its curvature least. Solved in
    the symmetric form :math:`C (M^{-1} C)^{k-1} \mathbf{x} = 0`, with C and M of the surface that is given;
    faired again and again with order 1, the surface tends to a minimal one.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices.
    fixed : (n,) bool array, or (f,) int array
        The vertices that stay. For order k the k rings around the free part must be among them, to give the
        position (1), the tangent plane (2) and the curvature (3) along its border. Where free vertices
        lie on a boundary of the mesh, that is left free too.
    order : int
        k, at least 1. The system of order k has a condition number of about (size / edge)^{2k}.

    Returns
    -------
    (n, 3) float array
        The fixed vertices unchanged.

    Raises
    ------
    SingularSystemError
        If a connected part of the mesh has no fixed vertex; names a vertex of it.
    ValueError
        If a face has no area or a vertex belongs to no face.

    References
    ----------
    Notes ch. 6 §14, *Bivariate Variational Calculus*.
    """
    points = as_points(vertices, "vertices")
    stays = as_vertex_indices(fixed, len(points), "fixed")
    C = cotangent_matrix(points, faces)
    inverse = sparse.diags_array(1 / cell_areas(mass_matrix(points, faces), len(points)))
    energy = -C
    for _ in range(as_count(order, "order", least=1) - 1):
        energy = sparse.csr_array(-C @ inverse @ energy)
    return solve_with_fixed(energy, np.zeros_like(points), stays, points[stays])
