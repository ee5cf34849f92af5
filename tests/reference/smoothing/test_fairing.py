"""Energies against areas and finite differences; fair surfaces against planes, plates and a soap film."""

import numpy as np
import pytest

from gpcourse.geometry import shapes
from gpcourse.geometry.triangles import surface_area
from gpcourse.reference.smoothing import (
    cotangent_matrix,
    dirichlet_energy,
    euler_lagrange_1d,
    fair,
    mass_matrix,
    membrane_energy,
    thin_plate_energy,
)


def operators(mesh):
    return cotangent_matrix(*mesh), mass_matrix(*mesh)


@pytest.mark.parametrize("seed", range(3))
def test_the_dirichlet_energy_of_the_surface_itself_is_twice_its_area(seed):
    mesh = shapes.random_bounded(seed, 50)
    C = cotangent_matrix(*mesh)
    x = mesh.vertices - mesh.vertices.mean(axis=0)
    assert dirichlet_energy(C, x) == pytest.approx(2 * membrane_energy(*mesh), rel=1e-11)
    # Any other surface has at most the area that its energy says.
    y = x + 0.1 * np.ptp(x) * np.random.default_rng(seed).normal(size=x.shape)
    assert surface_area(y, mesh.faces) < dirichlet_energy(C, y) / 2


def test_the_energies_of_functions_that_are_known():
    patch = shapes.irregular_patch(2, 60, stretch=2.0)
    C, M = operators(patch)
    assert dirichlet_energy(C, patch.vertices @ [3.0, 4.0, 0.0]) == pytest.approx(25, rel=1e-12)
    assert dirichlet_energy(C, np.ones(len(patch.vertices))) == pytest.approx(0, abs=1e-12)
    assert thin_plate_energy(C, M, np.ones(len(patch.vertices))) == pytest.approx(0, abs=1e-12)
    solid = shapes.icosahedron(3.0)  # where Δx = -2x/R² is exact: the integral of 4H²
    assert thin_plate_energy(*operators(solid), solid.vertices) == pytest.approx(4 / 9 * surface_area(*solid))


def slope(energy, x, along, h):
    return (energy(x + h * along) - energy(x - h * along)) / (2 * h)


def test_gradients_by_finite_differences():
    mesh = shapes.random_bounded(4, 40)
    C, M = operators(mesh)
    x = mesh.vertices - mesh.vertices.mean(axis=0)
    size = np.abs(x).max()
    along = np.random.default_rng(1).normal(size=x.shape)
    bending = 2 * C @ ((C @ x) / M.diagonal()[:, None])
    cases = [
        (lambda y: dirichlet_energy(C, y), -2 * C @ x),
        (lambda y: thin_plate_energy(C, M, y), bending),
        (lambda y: membrane_energy(y, mesh.faces), -C @ x),
    ]
    for energy, gradient in cases:
        exact = (gradient * along).sum()
        # The error is of order h², or none for the quadratic ones; rounding is 1e-16 over h.
        assert slope(energy, x, along, 1e-6 * size) == pytest.approx(exact, rel=1e-6)


def test_the_shortest_way_between_two_values_is_straight():
    t = np.sort(np.random.default_rng(2).uniform(-3, 5, size=50))
    f = euler_lagrange_1d(t, 2.0, -7.0)
    np.testing.assert_allclose(f, 2 - 9 * (t - t[0]) / (t[-1] - t[0]), atol=1e-12)

    def energy(g):
        return (np.diff(g) ** 2 / np.diff(t)).sum()

    for seed in range(5):
        bump = np.random.default_rng(seed).normal(size=50)
        bump[[0, -1]] = 0
        assert energy(f + 1e-3 * bump) > energy(f)
    assert euler_lagrange_1d([0, 1], 3, 4).tolist() == [3, 4]


# Fair surfaces


def plate(n, rows, order, height):
    """A flat annulus with `order` rings fixed at each border, lifted to a height of the radius there."""
    mesh = shapes.annulus(n, rows)
    row = np.arange(len(mesh.vertices)) // n
    fixed = (row < order) | (row > rows - order)
    truth = height(np.linalg.norm(mesh.vertices, axis=1))
    # So low that the metric of the lifted mesh is that of the plane.
    low = mesh.vertices.copy()
    low[fixed, 2] = 1e-5 * truth[fixed]
    faired = fair(low, mesh.faces, fixed, order)
    return np.abs(faired[:, 2] / 1e-5 - truth).max()


def test_a_membrane_between_two_rings_is_a_logarithm_at_second_order():
    errors = [plate(24 * n, 8 * n, 1, np.log) for n in (1, 2, 4)]
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2, abs=0.06)  # measured: 2.02, 2.00


def test_a_thin_plate_between_two_rings_solves_the_biharmonic_equation():
    errors = [plate(24 * n, 8 * n, 2, lambda r: r**2 * np.log(r)) for n in (1, 2, 4)]
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(1.83, abs=0.1)  # measured: 1.86, 1.81
    assert errors[-1] < 1e-5


def test_the_third_order_between_two_rings_solves_the_triharmonic_equation():
    errors = [plate(24 * n, 8 * n, 3, lambda r: r**4) for n in (1, 2)]
    assert errors[0] < 3e-5  # measured: 2.2e-5, 1.5e-6
    assert errors[1] < 2e-6
    # Neither a membrane nor a thin plate has that shape.
    assert plate(24, 8, 1, lambda r: r**4) > 0.1
    assert plate(24, 8, 2, lambda r: r**4) > 1e-3


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_bump_on_a_plane_is_faired_away(order):
    disc = shapes.disc(8)
    distance = np.linalg.norm(disc.vertices, axis=1)
    fixed = distance > (8 - order + 0.5) / 8
    bumpy = disc.vertices.copy()
    bumpy[~fixed, 2] = 0.2 * np.random.default_rng(3).normal(size=np.count_nonzero(~fixed))
    tilt = np.array([[1, 0, 0], [0, 0.6, 0.8], [0, -0.8, 0.6]])
    faired = fair(bumpy @ tilt, disc.faces, fixed, order)
    np.testing.assert_array_equal(faired[fixed], (bumpy @ tilt)[fixed])
    np.testing.assert_allclose((faired @ tilt.T)[:, 2], 0, atol=1e-10)
    by_index = fair(bumpy @ tilt, disc.faces, np.flatnonzero(fixed)[::-1], order)
    np.testing.assert_allclose(by_index, faired, atol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_no_other_surface_through_the_fixed_vertices_has_less_energy(order):
    mesh = shapes.random_bounded(8, 60)
    fixed = ~mesh.interior
    C, M = operators(mesh)
    energies = {1: lambda x: dirichlet_energy(C, x), 2: lambda x: thin_plate_energy(C, M, x)}
    faired, energy = fair(*mesh, fixed, order), energies[order]
    assert energy(faired) < energy(mesh.vertices)
    for seed in range(5):
        other = np.random.default_rng(seed).normal(size=faired.shape) * 0.01 * np.ptp(faired)
        assert energy(faired + np.where(fixed[:, None], 0, other)) > energy(faired)


def soap_film(n, steps):
    """Fair a cylinder between two rings of radius 1 at distance 1, again and again."""
    film = shapes.cylinder(n, 3 * n // 8, height=1.0)
    x, areas = film.vertices, [surface_area(*film)]
    for _ in range(steps):
        x = fair(x, film.faces, ~film.interior, 1)
        areas.append(surface_area(x, film.faces))
    return x, np.array(areas)


def test_a_membrane_faired_again_and_again_becomes_a_catenoid():
    waist = 0.848337938  # a cosh(1/2a) = 1
    assert waist * np.cosh(0.5 / waist) == pytest.approx(1, abs=1e-8)
    errors = []
    for n in (16, 32):
        x, areas = soap_film(n, 60)
        assert (np.diff(areas) < 1e-12 * areas[0]).all()
        errors.append(np.abs(np.linalg.norm(x[:, :2], axis=1) - waist * np.cosh(x[:, 2] / waist)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)  # measured: 2.04
    exact = np.pi * (1 + waist * np.sinh(1 / waist)) * waist
    assert areas[-1] == pytest.approx(exact, rel=5e-3)
