"""Sparse symmetric positive definite systems: factor once and solve often, or conjugate gradients."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from gpcourse.errors import SingularSystemError
from gpcourse.geometry.arrays import FloatArray, IntArray

#: Solves a system for a right-hand side of shape (n,) or (n, k).
Solve = Callable[[FloatArray], FloatArray]

#: Largest residual that rounding explains, relative to the terms of ``A x - b``.
_ROUNDING = 1e-10

_INDEFINITE = (
    "the matrix is singular or not positive definite; are some values fixed, is C the cotangent matrix, "
    "and no step negative?"
)


def factorized(A: sparse.csr_array) -> Solve:
    """Factor a symmetric positive definite matrix, and return the function that solves with it.

    CHOLMOD factors it where cholespy is installed (``pip install gpcourse[cholmod]``), else SuperLU.

    Raises
    ------
    SingularSystemError
        If there is no factor, or, when solving, if the solution does not satisfy the system.
    """
    try:
        direct = _by_cholmod(A)
    except ImportError:
        direct = _by_superlu(A)
    norm = abs(A).sum(axis=1).max(initial=0)

    def solve(b: FloatArray) -> FloatArray:
        x = direct(b)
        terms = norm * np.abs(x).max(initial=0) + np.abs(b).max(initial=0)
        if not np.abs(A @ x - b).max(initial=0) <= _ROUNDING * terms:
            raise SingularSystemError(_INDEFINITE)
        return x

    return solve


def _by_cholmod(A: sparse.csr_array) -> Solve:
    """Factor by CHOLMOD, or raise ImportError where it is not installed."""
    from cholespy import CholeskySolverD, MatrixType

    starts, columns = A.indptr.astype(np.int32), A.indices.astype(np.int32)
    try:
        factor = CholeskySolverD(A.shape[0], starts, columns, A.data, MatrixType.CSR)
    except (ValueError, RuntimeError):  # the latter for a matrix without entries
        raise SingularSystemError(_INDEFINITE) from None

    def solve(b: FloatArray) -> FloatArray:
        x = np.empty(b.shape)
        factor.solve(np.ascontiguousarray(b), x)
        return x

    return solve


def _by_superlu(A: sparse.csr_array) -> Solve:
    """Factor by SuperLU, which SciPy has."""
    from scipy.sparse.linalg import splu

    try:
        # Pivots on the diagonal keep the symmetry, as in a Cholesky factorisation: half the time and memory.
        # The rows of a mesh's matrix are short, so that narrow panels waste less: a fifth of the time.
        lu = splu(
            sparse.csc_array(A),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            relax=1,
            panel_size=4,
            options={"SymmetricMode": True},
        )
    except RuntimeError:
        raise SingularSystemError(_INDEFINITE) from None
    return lambda b: np.asarray(lu.solve(b))


def conjugate_gradients(A: sparse.csr_array, b: FloatArray, start: FloatArray) -> FloatArray:
    """Solve a symmetric positive definite system column by column by conjugate gradients.

    Unknowns are scaled so that the diagonal becomes 1, which is the cheapest preconditioner.

    Raises
    ------
    SingularSystemError
        If the iteration does not come to an end, as on a matrix that is not positive definite.
    """
    diagonal = A.diagonal()
    if not (diagonal > 0).all():
        raise SingularSystemError(
            f"entry {int(np.argmin(diagonal > 0))} of the diagonal is not positive; is the step negative?"
        )
    scale = 1 / np.sqrt(diagonal)
    scaled = sparse.csr_array(sparse.diags_array(scale) @ A @ sparse.diags_array(scale))
    columns = zip(np.atleast_2d(b.T), np.atleast_2d(start.T), strict=True)
    x = [scale * _iterate(scaled, scale * right, guess / scale) for right, guess in columns]
    return np.stack(x, axis=-1).reshape(b.shape)


def _iterate(A: sparse.csr_array, b: FloatArray, start: FloatArray) -> FloatArray:
    """Solve for one column; the relative residual ends near rounding."""
    from scipy.sparse.linalg import cg

    x, unfinished = cg(A, b, start, rtol=1e-12)
    # The residual that the iteration carries along can drift from the true one on a nearly singular matrix.
    if unfinished or not np.linalg.norm(b - A @ x) <= 1e-6 * np.linalg.norm(b):
        raise SingularSystemError(
            "conjugate gradients have not converged; take a smaller step or the Cholesky solver"
        )
    return np.asarray(x)


def solve_with_fixed(A: sparse.csr_array, b: FloatArray, fixed: IntArray, values: FloatArray) -> FloatArray:
    """Solve ``A x = b`` in all rows but the fixed ones, where x is given.

    What is known goes to the right-hand side: :math:`A_{II} x_I = b_I - A_{IB} x_B`.

    Raises
    ------
    SingularSystemError
        If a connected part has no fixed vertex; names one of its vertices.
    """
    refuse_free_components(A, fixed)
    free = np.ones(len(b), dtype=bool)
    free[fixed] = False
    x = np.zeros(b.shape)
    x[fixed] = values
    if free.any():
        rows = A[free]
        x[free] = factorized(sparse.csr_array(rows[:, free]))(b[free] - rows @ x)
    return x


def refuse_free_components(A: sparse.csr_array, fixed: IntArray) -> None:
    """Raise SingularSystemError if nothing is fixed in a connected part of the mesh."""
    n_components, component = connected_components(A, directed=False)
    free = np.setdiff1d(np.arange(n_components), component[fixed])
    if len(free):
        part = np.flatnonzero(component == free[0])
        raise SingularSystemError(
            f"nothing is fixed in the part of {len(part)} vertices around vertex {part[0]}: any constant can "
            "be added to a solution there; fix at least one of them"
        )
