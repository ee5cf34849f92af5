"""Equations on a mesh: Laplace, Poisson, heat, and the modes of the Laplacian."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from gpcourse.errors import ArrayError, SingularSystemError
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.reference.smoothing.arguments import (
    as_count,
    as_matrix,
    as_number,
    as_values,
    as_vertex_indices,
    cell_areas,
)
from gpcourse.reference.smoothing.solvers import factorized, solve_with_fixed

#: Up to this many vertices all modes at once cost less than a few by iteration.
_DENSE = 300


def solve_laplace(C: sparse.csr_array, boundary: IntArray, values: FloatArray) -> FloatArray:
    r"""Solve the Laplace equation :math:`\Delta f = 0` with given values at the boundary.

    .. math:: C f = 0 \ \text{inside}, \qquad f = f_0 \ \text{at the boundary}

    Parameters
    ----------
    C : (n, n) csr_array
        Cotangent matrix.
    boundary : (b,) int array, or (n,) bool array
        The vertices with given values, by index or as a mask. They need not lie on the boundary of the mesh.
    values : (b,) or (b, k) float array
        A value, or a row of k, for each of these vertices in their order; that of a mask is ascending.

    Returns
    -------
    (n,) or (n, k) float array
        The harmonic function, equal to `values` where they are given.

    Raises
    ------
    SingularSystemError
        If a connected part of the mesh has no given value; names a vertex of it.

    References
    ----------
    Notes ch. 6 §9, *Laplace equation*.
    """
    stiffness = as_matrix(C, "C")
    n = stiffness.shape[0]
    fixed = as_vertex_indices(boundary, n, "boundary")
    known = as_values(values, len(fixed), "values", "boundary vertices")
    return solve_with_fixed(-stiffness, np.zeros((n, *known.shape[1:])), fixed, known)


def solve_poisson(
    C: sparse.csr_array,
    M: sparse.csr_array,
    g: FloatArray,
    boundary: IntArray | None = None,
    values: FloatArray | None = None,
) -> FloatArray:
    r"""Solve the Poisson equation :math:`\Delta f = g`, that is :math:`C f = M g`.

    Parameters
    ----------
    C, M : (n, n) csr_arrays
        Cotangent and mass matrix.
    g : (n,) float array
        The right-hand side, pointwise.
    boundary : (b,) int array or (n,) bool array, optional
        The vertices with given values, by index or as a mask.
    values : (b,) float array, optional
        The values there, in the order of `boundary`.

    Returns
    -------
    (n,) float array
        The solution. Without given values it is determined up to a constant on each connected part, and is
        the one of zero mean: ``sum(M @ f) == 0``.

    Raises
    ------
    SingularSystemError
        If nothing is fixed in a part and the integral of `g` over it is not zero: there is no solution.

    References
    ----------
    Notes ch. 6 §9, *Poisson equation*.
    """
    stiffness = as_matrix(C, "C")
    areas = cell_areas(M, stiffness.shape[0])
    integrated = areas * as_values(np.ravel(g), len(areas), "g")
    if (boundary is None) != (values is None):
        raise ArrayError("boundary and values belong together; give both or neither")
    if boundary is not None:
        fixed = as_vertex_indices(boundary, len(areas), "boundary")
        known = as_values(np.ravel(np.asarray(values)), len(fixed), "values", "boundary vertices")
        return solve_with_fixed(-stiffness, -integrated, fixed, known)
    part = np.asarray(connected_components(stiffness, directed=False)[1], dtype=np.int64)
    _refuse_unsolvable(integrated, part)
    # Fix one vertex of each part at 0; a constant added to each part then makes its mean 0.
    pinned = np.unique(part, return_index=True)[1]
    f = solve_with_fixed(-stiffness, -integrated, pinned, np.zeros(len(pinned)))
    return np.asarray(f - (np.bincount(part, areas * f) / np.bincount(part, areas))[part])


def heat_step(C: sparse.csr_array, M: sparse.csr_array, f: FloatArray, t: float) -> FloatArray:
    r"""Follow the diffusion equation :math:`f_t = \Delta f` for a time `t`, in one implicit step.

    .. math:: (M - t C)\, f' = M f

    Parameters
    ----------
    C, M : (n, n) csr_arrays
        Cotangent and mass matrix.
    f : (n,) or (n, k) float array
        The function, or k functions, at the start.
    t : float
        How long heat flows, in squared units of length; at least 0.

    Returns
    -------
    float array of the shape of `f`
        With the same integral ``sum(M @ f)``. Stable for every `t`.

    Raises
    ------
    ValueError
        If the cell of a vertex is empty, or `t` is negative.

    References
    ----------
    Notes ch. 6 §9, *Diffusion equation*, §13.5.
    """
    stiffness = as_matrix(C, "C")
    areas = cell_areas(M, stiffness.shape[0])
    before = as_values(f, len(areas), "f")
    duration = as_number(t, "t", least=0)
    system = sparse.csr_array(sparse.diags_array(areas) - duration * stiffness)
    return factorized(system)((areas * before.T).T)


def eigenmodes(C: sparse.csr_array, M: sparse.csr_array, k: int) -> tuple[FloatArray, FloatArray]:
    r"""Compute the `k` smoothest modes of the Laplacian, :math:`\Delta\varphi_i = \lambda_i\varphi_i`.

    Symmetrised: :math:`(M^{-1/2} C M^{-1/2})\,\xi_i = \lambda_i\,\xi_i` and
    :math:`\varphi_i = M^{-1/2}\,\xi_i`.

    Parameters
    ----------
    C, M : (n, n) csr_arrays
        Cotangent and mass matrix.
    k : int
        How many, from 1 to n.

    Returns
    -------
    frequencies : (k,) float array
        :math:`-\lambda_i \ge 0`, ascending, per squared unit of length. 0 once for each connected part.
    phi : (n, k) float array
        A mode in each column, orthonormal in the inner product of M: ``phi.T @ M @ phi`` is the identity. The
        sign of a mode, and the basis for a repeated frequency, are arbitrary.

    Raises
    ------
    ValueError
        If `k` is out of range or the cell of a vertex is empty.

    References
    ----------
    Notes ch. 6 §9, *Eigen / spectral analysis*, §12.
    """
    stiffness = as_matrix(C, "C")
    areas = cell_areas(M, stiffness.shape[0])
    count = as_count(k, "k", least=1, most=len(areas))
    half = sparse.diags_array(1 / np.sqrt(areas))
    frequencies, xi = _smallest_modes(sparse.csr_array(-half @ stiffness @ half), count, 1 / areas.sum())
    return np.maximum(frequencies, 0), np.asarray(half @ xi)


def spectral_coefficients(f: FloatArray, phi: FloatArray, M: sparse.csr_array) -> FloatArray:
    r"""Return the coefficients :math:`\langle f, \varphi_i \rangle_M = \varphi_i^T M f`.

    Parameters
    ----------
    f : (n,) or (n, d) float array
        A function, or d of them, such as the coordinates of the vertices.
    phi : (n, k) float array
        Modes, orthonormal in the inner product of M.
    M : (n, n) csr_array
        Mass matrix.

    Returns
    -------
    (k,) or (k, d) float array

    References
    ----------
    Notes ch. 6 §10.
    """
    modes = as_values(phi, np.shape(M)[0], "phi")
    areas = cell_areas(M, len(modes))
    return np.asarray(modes.T @ (areas * as_values(f, len(areas), "f").T).T)


def spectral_reconstruction(f: FloatArray, phi: FloatArray, M: sparse.csr_array, k: int) -> FloatArray:
    r"""Rebuild a function from its first `k` modes.

    .. math:: \sum_{i < k} \langle f, \varphi_i \rangle_M\, \varphi_i

    Parameters
    ----------
    f : (n,) or (n, d) float array
        A function, or d of them, such as the coordinates of the vertices.
    phi : (n, m) float array
        Modes, orthonormal in the inner product of M, smoothest first.
    M : (n, n) csr_array
        Mass matrix.
    k : int
        How many modes to use, from 0 to m.

    Returns
    -------
    float array of the shape of `f`
        The combination of these modes that is closest to `f` in the norm of M.

    References
    ----------
    Notes ch. 6 §12; coursework 2, question 4.
    """
    modes = as_values(phi, np.shape(M)[0], "phi")
    first = modes[:, : as_count(k, "k", least=0, most=modes.shape[1])]
    return np.asarray(first @ spectral_coefficients(f, first, M))


def spectral_filter(f: FloatArray, phi: FloatArray, M: sparse.csr_array, response: FloatArray) -> FloatArray:
    r"""Scale every mode of a function by the response to its frequency.

    .. math:: \sum_i h(-\lambda_i)\, \langle f, \varphi_i \rangle_M\, \varphi_i

    Parameters
    ----------
    f : (n,) or (n, d) float array
        A function, or d of them.
    phi : (n, k) float array
        The modes, orthonormal in the inner product of M.
    M : (n, n) csr_array
        Mass matrix.
    response : (k,) float array
        A factor for each mode, :math:`h(-\lambda_i)`. Diffusion for a time t is
        ``np.exp(-frequencies * t)``.

    Returns
    -------
    float array of the shape of `f`
        What `phi` does not span is removed.

    References
    ----------
    Notes ch. 6 §10, §13.
    """
    coefficients = spectral_coefficients(f, phi, M)
    factors = as_values(response, len(coefficients), "response", "modes")
    return np.asarray(phi @ (factors * coefficients.T).T)


def _smallest_modes(A: sparse.csr_array, k: int, shift: float) -> tuple[FloatArray, FloatArray]:
    """Return the `k` smallest eigenvalues of a positive semi-definite matrix, ascending, and eigenvectors."""
    from scipy.linalg import eigh
    from scipy.sparse.linalg import LinearOperator, eigsh

    n = A.shape[0]
    if n <= _DENSE or k > n // 2:
        values, vectors = eigh(A.toarray(), subset_by_index=[0, k - 1])
        return values, vectors
    # The inverse of A + shift has the smallest eigenvalues of A as its largest, which Lanczos finds first.
    # One over the area is of the size of the first frequency, so that the system is far from singular.
    solve = factorized(sparse.csr_array(A + shift * sparse.eye_array(n)))
    inverse = LinearOperator((n, n), matvec=solve, dtype=np.float64)
    start = np.random.default_rng(0).normal(size=n)
    values, vectors = eigsh(A, k, sigma=-shift, OPinv=inverse, v0=start)
    order = np.argsort(values)
    return values[order], vectors[:, order]


def _refuse_unsolvable(integrated: FloatArray, part: IntArray) -> None:
    """Raise if the integral of the right-hand side over a connected part is not zero up to rounding."""
    total, size = np.bincount(part, integrated), np.bincount(part, np.abs(integrated))
    bad = np.flatnonzero(~(np.abs(total) <= 1e-9 * size))
    if len(bad):
        v = int(np.argmax(part == bad[0]))
        raise SingularSystemError(
            f"the integral of g over the part around vertex {v} is {total[bad[0]]:.3g}, and only if "
            "it is 0 there is a solution; subtract the mean of g, or fix the values of some vertices"
        )
