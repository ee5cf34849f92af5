"""Flows against their closed forms on spheres, and the quantities that they keep or never raise."""

import numpy as np
import pytest

from gpcourse.errors import MeshError
from gpcourse.geometry import shapes
from gpcourse.geometry.triangles import enclosed_volume, surface_area
from gpcourse.reference.smoothing import (
    cotangent_matrix,
    dirichlet_energy,
    eigenmodes,
    explicit_step,
    implicit_step,
    laplacian,
    linear_diffusion,
    mass_matrix,
    mean_curvature_flow,
    stable_step,
    uniform_laplacian,
)


def operators(mesh):
    return cotangent_matrix(*mesh), mass_matrix(*mesh)


def radii(x):
    return np.linalg.norm(x - x.mean(axis=0), axis=1)


# Explicit


@pytest.mark.parametrize("n", [60, 200])  # dense and iterated
def test_explicit_diffusion_is_stable_up_to_the_bound_and_not_beyond(n):
    mesh = shapes.random_closed(1, n)
    C, M = operators(mesh)
    L, bound = laplacian(*mesh), stable_step(C, M)
    start = np.random.default_rng(0).normal(size=n_vertices(mesh))
    f = start
    for _ in range(50):
        g = explicit_step(f, L, 0.999 * bound)
        assert g @ M @ g <= f @ M @ f * (1 + 1e-12)
        f = g
    for _ in range(50):
        f = explicit_step(f, L, 1.2 * bound)
    # The fastest mode grows by a factor of 1.4 a step: 2e7 in all.
    assert f @ M @ f > 1e6 * (start @ M @ start)


def n_vertices(mesh):
    return len(mesh.vertices)


def test_the_bound_is_two_over_the_largest_frequency():
    C, M = operators(shapes.random_bounded(3, 130))
    w, _ = eigenmodes(C, M, C.shape[0])
    assert stable_step(C, M) == pytest.approx(2 / w[-1], rel=1e-7)
    assert stable_step(100 * C, M) == pytest.approx(2 / w[-1] / 100, rel=1e-7)
    assert stable_step(0 * C, M) == np.inf


def test_a_full_uniform_step_moves_every_vertex_to_the_mean_of_its_neighbours():
    mesh = shapes.octahedron()
    L = uniform_laplacian(mesh.faces, 6)
    np.testing.assert_allclose(explicit_step(mesh.vertices, L, 1.0), 0, atol=1e-15)
    np.testing.assert_allclose(explicit_step(mesh.vertices, L, 0.25), 0.75 * mesh.vertices)


# Implicit


@pytest.mark.parametrize("radius", [0.1, 1.0, 30.0])
def test_an_implicit_step_of_a_sphere_divides_it_by_one_plus_twice_lambda_over_the_squared_radius(radius):
    # Δx = -2x/R² holds exactly for the regular solids, and to second order for finer meshes.
    lam = 0.3 * radius**2
    for solid in (shapes.octahedron(radius), shapes.icosahedron(radius)):
        x = implicit_step(solid.vertices, *operators(solid), lam)
        np.testing.assert_allclose(x, solid.vertices / 1.6, atol=1e-14 * radius)
    errors = []
    for subdivisions in (2, 3, 4):
        sphere = shapes.icosphere(subdivisions, radius=radius)
        x = implicit_step(sphere.vertices, *operators(sphere), lam)
        errors.append(np.abs(x - sphere.vertices / 1.6).max() / radius)
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2, abs=0.16)  # measured: 1.86, 1.96
    assert errors[-1] < 3e-5


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("lam", [1e-3, 1.0, 1e4])
def test_any_step_is_stable_and_keeps_the_centre_and_both_solvers_agree(seed, lam):
    mesh = shapes.random_closed(seed, 80) if seed else shapes.random_bounded(seed, 80)
    C, M = operators(mesh)
    lam *= surface_area(*mesh) / n_vertices(mesh)
    x = mesh.vertices
    after = implicit_step(x, C, M, lam)
    size = np.ptp(x, axis=0).max()
    np.testing.assert_allclose(implicit_step(x, C, M, lam, solver="cg"), after, rtol=0, atol=1e-8 * size)
    away = np.abs(x).max()
    np.testing.assert_allclose(
        (M @ after).sum(axis=0) / M.sum(), (M @ x).sum(axis=0) / M.sum(), atol=1e-10 * away
    )
    assert dirichlet_energy(C, after) < dirichlet_energy(C, x)
    assert (after * (M @ after)).sum() <= (x * (M @ x)).sum()
    np.testing.assert_allclose(M @ after - lam * (C @ after), M @ x, atol=1e-9 * np.abs(M @ x).max())


def test_a_step_of_nothing_changes_nothing():
    mesh = shapes.random_closed(5, 40)
    for solver in ("cg", "cholesky"):
        after = implicit_step(mesh.vertices, *operators(mesh), 0.0, solver=solver)
        np.testing.assert_allclose(after, mesh.vertices, rtol=1e-13)


# Whole flows


def test_curvature_flow_shrinks_a_sphere_as_its_closed_form_says():
    solid, lam = shapes.icosahedron(2.0), 0.1
    radius = 2.0
    for _ in range(5):
        radius /= 1 + 2 * lam / radius**2
    np.testing.assert_allclose(radii(mean_curvature_flow(*solid, lam, 5)), radius, rtol=1e-12)
    # Linear diffusion keeps the first Laplacian, and every step divides by the same number.
    slower = 2.0 / (1 + 2 * lam / 4) ** 5
    np.testing.assert_allclose(radii(linear_diffusion(*solid, lam, 5)), slower, rtol=1e-12)


def test_curvature_flow_of_a_sphere_converges_to_the_smooth_flow_at_first_order():
    sphere = shapes.icosphere(2)
    errors = []
    for steps in (8, 16, 32):
        r = radii(mean_curvature_flow(*sphere, 0.1 / steps, steps))
        errors.append(np.abs(r - np.sqrt(1 - 4 * 0.1)).max())  # dR/dt = -2/R
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(1, abs=0.1)  # measured: 0.94, 0.97


@pytest.mark.parametrize("make", [shapes.random_closed, shapes.random_bounded])
def test_the_area_falls_with_every_step_of_curvature_flow(make):
    for seed in range(3):
        mesh = make(seed, 60)
        x = mesh.vertices
        areas = [surface_area(x, mesh.faces)]
        for _ in range(6):
            # A fraction of the squared edge; area(x') ≤ E(x')/2 ≤ E(x)/2 = area(x), for every mesh.
            x = mean_curvature_flow(x, mesh.faces, 0.1 * areas[0] / len(mesh.faces), 1)
            areas.append(surface_area(x, mesh.faces))
        assert (np.diff(areas) < 0).all()


def test_volume_is_kept_on_demand_and_the_shape_becomes_rounder():
    mesh = shapes.random_closed(11, 150, genus=0)
    volume, lam = enclosed_volume(*mesh), 0.5 * surface_area(*mesh) / len(mesh.faces)
    kept = mean_curvature_flow(*mesh, lam, 5, keep_volume=True)
    assert enclosed_volume(kept, mesh.faces) == pytest.approx(volume, rel=1e-11)
    assert enclosed_volume(mean_curvature_flow(*mesh, lam, 5), mesh.faces) < 0.95 * volume
    assert surface_area(kept, mesh.faces) < surface_area(*mesh)
    with pytest.raises(MeshError, match="closed"):
        mean_curvature_flow(*shapes.disc(2), 0.1, 1, keep_volume=True)


def test_linear_diffusion_is_one_system_solved_again_and_again():
    mesh = shapes.random_bounded(12, 60)
    C, M = operators(mesh)
    lam = surface_area(*mesh) / len(mesh.faces)
    x = mesh.vertices
    for _ in range(3):
        x = implicit_step(x, C, M, lam)
    np.testing.assert_allclose(linear_diffusion(*mesh, lam, 3), x, rtol=1e-10)
    np.testing.assert_array_equal(linear_diffusion(*mesh, lam, 0), mesh.vertices)
    np.testing.assert_array_equal(mean_curvature_flow(*mesh, lam, 0), mesh.vertices)
