"""Flows: explicit and implicit steps of diffusion, of functions and of the surface itself."""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy import sparse

from gpcourse.errors import GeometryError
from gpcourse.geometry.arrays import FloatArray, IntArray, as_points
from gpcourse.geometry.triangles import enclosed_volume
from gpcourse.reference.smoothing.arguments import as_count, as_matrix, as_number, as_values, cell_areas
from gpcourse.reference.smoothing.operators import cotangent_matrix, mass_matrix
from gpcourse.reference.smoothing.solvers import conjugate_gradients, factorized


def explicit_step(vertices: FloatArray, L: sparse.csr_array, lam: float) -> FloatArray:
    r"""Make an explicit Euler step of diffusion: :math:`P' = (I + \lambda L) P`.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions; or any (n,) or (n, k) values at the vertices.
    L : (n, n) csr_array
        A Laplacian, pointwise: cotangent or uniform.
    lam : float
        The step, in squared units of length for the cotangent Laplacian, without unit for the uniform one.

    Returns
    -------
    float array of the shape of `vertices`
        Oscillates when `lam` is larger than `stable_step`.

    References
    ----------
    Notes ch. 6 §13.4; coursework 2, question 5.
    """
    matrix = as_matrix(L, "L")
    before = as_values(vertices, matrix.shape[0], "vertices")
    return np.asarray(before + as_number(lam, "lam") * (matrix @ before))


def stable_step(C: sparse.csr_array, M: sparse.csr_array) -> float:
    r"""Return the bound :math:`2 / |\lambda_{\max}|` for the step of explicit diffusion with ``L = M⁻¹C``.

    A step multiplies mode i by :math:`1 + \lambda\lambda_i`. Below the bound all these factors lie between
    -1 and 1; above it the fastest mode grows, and changes its sign with every step.

    Parameters
    ----------
    C, M : (n, n) csr_arrays
        Cotangent and mass matrix.

    Returns
    -------
    float
        In squared units of length; infinite if C is zero.

    Raises
    ------
    ValueError
        If the cell of a vertex is empty; names it.

    References
    ----------
    Notes ch. 6 §13.4.
    """
    from scipy.sparse.linalg import eigsh

    stiffness = as_matrix(C, "C")
    half = sparse.diags_array(1 / np.sqrt(cell_areas(M, stiffness.shape[0])))
    A = sparse.csr_array(-half @ stiffness @ half)
    n = A.shape[0]
    if not A.data.any():
        return np.inf
    if n <= 100:
        largest = float(np.linalg.eigvalsh(A.toarray()).max())
    else:
        start = np.random.default_rng(0).normal(size=n)
        largest = float(eigsh(A, 1, which="LA", v0=start, tol=1e-8, return_eigenvectors=False)[0])
    return 2 / largest


def implicit_step(
    vertices: FloatArray,
    C: sparse.csr_array,
    M: sparse.csr_array,
    lam: float,
    *,
    solver: Literal["cholesky", "cg"] = "cholesky",
) -> FloatArray:
    r"""Make an implicit Euler step of diffusion: :math:`(M - \lambda C)\, P' = M P`.

    The system is symmetric positive definite, which :math:`(I - \lambda L)\, P' = P` is not.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions; or any (n,) or (n, k) values at the vertices.
    C, M : (n, n) csr_arrays
        Cotangent and mass matrix.
    lam : float
        The step, in squared units of length; any `lam` of at least 0 is stable.
    solver : "cholesky" or "cg"
        A sparse factorisation, whose cost does not depend on `lam`; or conjugate gradients, which are faster
        for steps of about the squared length of an edge.

    Returns
    -------
    float array of the shape of `vertices`

    Raises
    ------
    ValueError
        If the cell of a vertex is empty, `lam` is negative, or there is no such solver.

    References
    ----------
    Notes ch. 6 §13.5; Desbrun et al. 1999, eq. 9; coursework 2, question 6.
    """
    stiffness = as_matrix(C, "C")
    areas = cell_areas(M, stiffness.shape[0])
    before = as_values(vertices, len(areas), "vertices")
    system = sparse.csr_array(sparse.diags_array(areas) - as_number(lam, "lam", least=0) * stiffness)
    right = (areas * before.T).T
    if solver == "cholesky":
        return factorized(system)(right)
    if solver == "cg":
        return conjugate_gradients(system, right, before)
    raise GeometryError(f"solver is {solver!r}; give 'cholesky' or 'cg'")


def mean_curvature_flow(
    vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False
) -> FloatArray:
    r"""Let a surface flow by its mean curvature, :math:`\partial\mathbf{x}/\partial t = -2H\mathbf{n}`.

    Implicit steps, with C and M of the surface as it is before each step. A flow that keeps
    them is linear diffusion instead.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices, counter-clockwise seen from outside.
    lam : float
        The step, in squared units of length.
    steps : int
        How many.
    keep_volume : bool
        Whether to scale the surface about its centre after each step so that the volume inside stays the
        same. Without it a closed surface shrinks to a point.

    Returns
    -------
    (n, 3) float array

    Raises
    ------
    ValueError
        If a face has no area (at the start or because the flow collapsed it), or `keep_volume` is asked for
        on a surface that is not closed.

    References
    ----------
    Notes ch. 6 §13.3, §13.5; Desbrun et al. 1999.
    """
    points = as_points(vertices, "vertices")
    volume = enclosed_volume(points, faces) if keep_volume else 0.0
    for _ in range(as_count(steps, "steps", least=0)):
        M = mass_matrix(points, faces)
        points = implicit_step(points, cotangent_matrix(points, faces), M, lam)
        if keep_volume:
            centre = (M @ points).sum(axis=0) / M.sum()
            grown = np.cbrt(volume / enclosed_volume(points, faces))
            points = centre + grown * (points - centre)
    return points


def linear_diffusion(vertices: FloatArray, faces: IntArray, lam: float, steps: int) -> FloatArray:
    """Diffuse the coordinates of a surface, with C and M of the surface at the start kept throughout.

    The system is the same in every step, and factored once.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices.
    lam : float
        The step, in squared units of length.
    steps : int
        How many.

    Returns
    -------
    (n, 3) float array

    Raises
    ------
    ValueError
        If a face has no area or a vertex belongs to no face; names it.

    References
    ----------
    Notes ch. 6 §13.3, §13.5.
    """
    points = as_points(vertices, "vertices")
    M = mass_matrix(points, faces)
    areas = cell_areas(M, len(points))[:, None]
    step = as_number(lam, "lam", least=0)
    solve = factorized(sparse.csr_array(M - step * cotangent_matrix(points, faces)))
    for _ in range(as_count(steps, "steps", least=0)):
        points = solve(areas * points)
    return points
