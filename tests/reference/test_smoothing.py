"""Chapter 6's reference: what it offers, and what it refuses by name. Its facts are in the folder."""

import sys

import numpy as np
import pytest
from scipy import sparse

from gpcourse.errors import (
    ArrayError,
    DegenerateFaceError,
    GeometryError,
    MeshError,
    SingularSystemError,
)
from gpcourse.geometry import shapes
from gpcourse.reference import smoothing
from gpcourse.reference.smoothing.solvers import conjugate_gradients, factorized

FLAT = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]]), np.array([[0, 1, 2], [0, 3, 1]])
SPHERE = shapes.icosphere(1)
C, M = smoothing.cotangent_matrix(*SPHERE), smoothing.mass_matrix(*SPHERE)
N = len(SPHERE.vertices)
LONELY = np.vstack([SPHERE.vertices, [[5.0, 5, 5]]]), SPHERE.faces


def test_every_public_function_is_documented():
    for name in smoothing.__all__:
        assert "Returns\n" in getattr(smoothing, name).__doc__


@pytest.mark.parametrize(
    "f",
    [
        smoothing.cotangent_matrix,
        smoothing.voronoi_areas,
        smoothing.mixed_areas,
        smoothing.mass_matrix,
        smoothing.laplacian,
        smoothing.mean_curvature_normal,
        smoothing.angle_defect,
        smoothing.discrete_gaussian_curvature,
        smoothing.mesh_quality,
        lambda v, f: smoothing.mean_curvature_flow(v, f, 0.1, 1),
        lambda v, f: smoothing.linear_diffusion(v, f, 0.1, 1),
        lambda v, f: smoothing.fair(v, f, [0], 1),
    ],
)
def test_a_face_without_area_is_named(f):
    with pytest.raises(DegenerateFaceError, match="face 1 has no area"):
        f(*FLAT)


@pytest.mark.parametrize(
    "f",
    [
        smoothing.laplacian,
        smoothing.mean_curvature_normal,
        smoothing.discrete_gaussian_curvature,
        lambda v, f: smoothing.mean_curvature_flow(v, f, 0.1, 1),
        lambda v, f: smoothing.linear_diffusion(v, f, 0.1, 1),
        lambda v, f: smoothing.fair(v, f, [0], 1),
        lambda v, f: smoothing.eigenmodes(smoothing.cotangent_matrix(v, f), smoothing.mass_matrix(v, f), 3),
        lambda v, f: smoothing.stable_step(smoothing.cotangent_matrix(v, f), smoothing.mass_matrix(v, f)),
    ],
)
def test_a_vertex_without_faces_is_named(f):
    with pytest.raises(MeshError, match=rf"vertex {N} .*remove vertices"):
        f(*LONELY)


@pytest.mark.parametrize(
    "f",
    [
        lambda: smoothing.solve_laplace(C, [], []),
        lambda: smoothing.fair(*SPHERE, np.zeros(N, bool), 2),
    ],
)
def test_a_closed_surface_with_nothing_fixed_is_refused_with_the_remedy(f):
    with pytest.raises(SingularSystemError, match=r"nothing is fixed .* vertex 0.*fix at least one"):
        f()


def test_the_component_in_which_nothing_is_fixed_is_named():
    both = shapes.union(shapes.icosphere(1), shapes.disc(2))
    with pytest.raises(SingularSystemError, match=rf"part of 19 vertices around vertex {N}"):
        smoothing.solve_laplace(smoothing.cotangent_matrix(*both), [0], [1.0])


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: smoothing.mass_matrix(*SPHERE, cells="thirds"), GeometryError, "cells is 'thirds'"),
        (lambda: smoothing.laplacian(*SPHERE, cells="thirds"), GeometryError, "cells is 'thirds'"),
        (lambda: smoothing.uniform_laplacian([[0, 1, 9]], 5), MeshError, "face 0 names vertex 9"),
        (lambda: smoothing.discrete_mean_curvature(*SPHERE, [[0, 0, 1]]), ArrayError, "normals"),
        (lambda: smoothing.discrete_principal_curvatures([1, 2], [1]), ArrayError, "H has shape"),
        (lambda: smoothing.solve_laplace(C, [0, 0], [1, 1]), ArrayError, "vertex 0 more than once"),
        (lambda: smoothing.solve_laplace(C, [N], [1]), ArrayError, f"vertex {N}; the indices run"),
        (lambda: smoothing.solve_laplace(C, [True], [1]), ArrayError, "one flag for each"),
        (lambda: smoothing.solve_laplace(C, [0.5], [1]), ArrayError, "mask or a list"),
        (lambda: smoothing.solve_laplace(C, [0], [1, 2]), ArrayError, "each of 1 boundary vertices"),
        (lambda: smoothing.solve_laplace(C[:5], [0], [1]), ArrayError, "square"),
        (lambda: smoothing.solve_laplace("C", [0], [1]), ArrayError, "C is a str"),
        (lambda: smoothing.solve_poisson(C, M, np.ones(N), [0]), ArrayError, "belong together"),
        (lambda: smoothing.solve_poisson(C, M, np.ones(5)), ArrayError, "g has shape"),
        (lambda: smoothing.heat_step(C, C, np.ones(N), 1), ArrayError, "beside its diagonal"),
        (lambda: smoothing.heat_step(C, M[:5, :5], np.ones(N), 1), ArrayError, r"M has shape \(5, 5\)"),
        (lambda: smoothing.heat_step(C, -M, np.ones(N), 1), MeshError, "vertex 0 has area -"),
        (lambda: smoothing.heat_step(C, M, np.full(N, np.nan), 1), ArrayError, r"f\[0\] is nan"),
        (lambda: smoothing.heat_step(C * np.nan, M, np.ones(N), 1), ArrayError, "C has entries"),
        (lambda: smoothing.heat_step(C, M, np.ones(N), -1), GeometryError, "t is -1; it must be"),
        (lambda: smoothing.heat_step(C, M, "f", 1), ArrayError, "f cannot be read"),
        (lambda: smoothing.eigenmodes(C, M, N + 1), GeometryError, f"k is {N + 1}; it must be from 1"),
        (lambda: smoothing.eigenmodes(C, M, 2.5), GeometryError, "whole number"),
        (lambda: smoothing.implicit_step(SPHERE.vertices, C, M, 1, solver="lu"), GeometryError, "solver is"),
        (lambda: smoothing.implicit_step(SPHERE.vertices, C, M, -1), GeometryError, "lam is -1"),
        (lambda: smoothing.implicit_step(SPHERE.vertices, C, M, "big"), GeometryError, "lam is 'big'"),
        (lambda: smoothing.mean_curvature_flow(*SPHERE, 1, -1), GeometryError, "steps is -1"),
        (lambda: smoothing.euler_lagrange_1d([0, 1, 1], 0, 1), ArrayError, "increase"),
        (lambda: smoothing.euler_lagrange_1d([0], 0, 1), ArrayError, "at least two"),
        (lambda: smoothing.fair(*SPHERE, [0], 0), GeometryError, "order is 0"),
        (lambda: smoothing.spectral_filter(np.ones(N), np.ones((N, 1)), M, [1, 2]), ArrayError, "resp"),
    ],
)
def test_what_cannot_be_used_is_refused_by_name(call, error, words):
    with pytest.raises(error, match=words):
        call()


def test_dense_matrices_are_as_good_as_sparse_ones():
    f = np.arange(N)
    dense = smoothing.heat_step(C.toarray(), M.toarray(), f, 0.1)
    np.testing.assert_array_equal(dense, smoothing.heat_step(C, M, f, 0.1))


@pytest.fixture(params=["cholmod", "superlu"])
def backend(request, monkeypatch):
    """Each of the two libraries that can factor a matrix."""
    if request.param == "cholmod":
        monkeypatch.delitem(sys.modules, "cholespy")  # tests/conftest.py hides it
        pytest.importorskip("cholespy", reason="the extra gpcourse[cholmod] is not installed")
    return request.param


def test_every_factor_solves_to_rounding_and_agrees_with_conjugate_gradients(backend):
    torus = shapes.torus(24, 12)
    C, M = smoothing.cotangent_matrix(*torus), smoothing.mass_matrix(*torus)
    A = sparse.csr_array(M - 0.1 * C)
    b = M @ np.asarray(torus.vertices)
    solve = factorized(A)
    dense = np.linalg.solve(A.toarray(), b)
    np.testing.assert_allclose(solve(b), dense, rtol=0, atol=1e-12)
    np.testing.assert_allclose(solve(np.asfortranarray(b)), dense, rtol=0, atol=1e-12)
    np.testing.assert_allclose(solve(b[:, 1]), dense[:, 1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(conjugate_gradients(A, b, 0 * b), dense, rtol=0, atol=1e-8)


def test_what_is_not_positive_definite_has_no_factor(backend):
    with pytest.raises(SingularSystemError, match="singular"):
        factorized(sparse.csr_array((3, 3)))
    saddle = sparse.csr_array([[1e-20, 1], [1, 1e-20]])  # no pivots on the diagonal
    with pytest.raises(SingularSystemError, match="not positive definite"):
        factorized(saddle)(np.array([1.0, 2.0]))


def test_conjugate_gradients_refuse_what_is_not_positive_definite():
    with pytest.raises(SingularSystemError, match="diagonal"):
        conjugate_gradients(C, np.ones(N), np.zeros(N))
    with pytest.raises(SingularSystemError, match="converged"):
        conjugate_gradients(-C, np.ones(N), np.zeros(N))
