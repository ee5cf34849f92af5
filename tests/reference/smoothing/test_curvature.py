"""Discrete curvature against smooth surfaces that are known, with the rate at which it tends to them."""

import numpy as np
import pytest

from gpcourse.geometry import shapes
from gpcourse.reference.smoothing import (
    angle_defect,
    barycentric_areas,
    discrete_gaussian_curvature,
    discrete_mean_curvature,
    discrete_principal_curvatures,
    mean_curvature_normal,
    mesh_quality,
)

SURFACES = {
    "tetrahedron": (shapes.tetrahedron, 2),
    "octahedron": (shapes.octahedron, 2),
    "icosphere": (lambda: shapes.icosphere(2), 2),
    "torus": (lambda: shapes.torus(9, 7), 0),
    "genus 2": (lambda: shapes.genus_surface(2), -2),
    "genus 3": (lambda: shapes.genus_surface(3), -4),
    "disc": (lambda: shapes.disc(3), 1),
    "annulus": (shapes.annulus, 0),
    "cylinder": (shapes.cylinder, 0),
    "Möbius strip": (shapes.moebius, 0),
    "patch": (lambda: shapes.irregular_patch(1), 1),
    "a sphere and a disc": (lambda: shapes.union(shapes.icosphere(1), shapes.disc(2)), 3),
}


@pytest.mark.parametrize("name", SURFACES)
def test_angle_defects_sum_to_the_euler_characteristic(name):
    make, euler = SURFACES[name]
    # Each of a few hundred angles is rounded in the last of its 16 digits.
    assert angle_defect(*make()).sum() == pytest.approx(2 * np.pi * euler, abs=1e-11)


@pytest.mark.parametrize("seed", range(5))
def test_angle_defects_sum_to_the_euler_characteristic_on_random_meshes(seed):
    mesh = shapes.random_bounded(seed, 60, n_components=2)
    euler = 2 * mesh.n_components - 2 * mesh.genus - len(mesh.boundary_lengths)
    assert angle_defect(*mesh).sum() == pytest.approx(2 * np.pi * euler, abs=1e-10)


def test_an_isolated_vertex_has_a_full_turn_and_counts_in_the_euler_characteristic():
    defects = angle_defect(np.vstack([np.eye(3), [[5.0, 5, 5]]]), [[0, 1, 2]])
    np.testing.assert_allclose(defects, [2 * np.pi / 3] * 3 + [2 * np.pi], rtol=1e-14)
    assert defects.sum() == pytest.approx(2 * np.pi * 2)


def test_a_flat_patch_has_no_curvature_and_a_straight_boundary_no_turning():
    patch = shapes.irregular_patch(3, 60)
    defects = angle_defect(*patch)
    corner = np.isin(patch.vertices[:, :2], (0, 1)).all(axis=1)
    np.testing.assert_allclose(defects[corner], np.pi / 2, rtol=1e-12)
    np.testing.assert_allclose(defects[~corner], 0, atol=1e-13)
    assert np.abs(mean_curvature_normal(*patch)[patch.interior]).max() < 1e-8


@pytest.mark.parametrize("radius", [0.01, 1.0, 100.0])
def test_the_mean_curvature_of_a_mesh_inscribed_in_a_sphere_is_exact(radius):
    # As |x_i - x_j|² = 2R² - 2 x_i·x_j, the formula of the Voronoi cell is that of Δx·n.
    sphere = shapes.icosphere(3, radius=radius)
    np.testing.assert_allclose(discrete_mean_curvature(*sphere, sphere.normals), 1 / radius, rtol=1e-12)
    # The vector itself leans from the normal a little.
    np.testing.assert_allclose(
        mean_curvature_normal(*sphere), sphere.normals / radius, rtol=0, atol=0.01 / radius
    )


def orders(errors):
    """The exponents of the edge length, which halves from each error to the next."""
    return np.log2(np.divide(errors[:-1], errors[1:]))


def test_mean_and_gaussian_curvature_converge_on_the_torus_at_second_order():
    tori = [shapes.torus(n) for n in (32, 64, 128)]
    H = [np.abs(discrete_mean_curvature(*t, t.normals) - t.mean_curvature).max() for t in tori]
    K = [np.abs(discrete_gaussian_curvature(*t) - t.gaussian_curvature).max() for t in tori]
    # Measured: 2.03, 2.01 and 1.98, 1.99.
    assert orders(H) == pytest.approx([2, 2], abs=0.06)
    assert orders(K) == pytest.approx([2, 2], abs=0.06)
    assert H[-1] < 1e-3
    assert K[-1] < 1e-2


def test_the_gaussian_curvature_of_a_sphere_converges_with_mixed_cells_and_not_with_barycentric_ones():
    spheres = [shapes.icosphere(s) for s in (3, 4, 5)]
    mixed = [np.abs(discrete_gaussian_curvature(*s) - 1).max() for s in spheres]
    third = [np.abs(angle_defect(*s) / barycentric_areas(*s) - 1).max() for s in spheres]
    assert orders(mixed) == pytest.approx([2, 2], abs=0.06)  # measured: 1.96, 1.99
    assert third == pytest.approx([0.146] * 3, abs=0.003)  # around the twelve vertices of valence 5


def test_a_cylinder_has_no_gaussian_curvature_and_half_the_mean_curvature_of_a_sphere():
    tubes = [shapes.cylinder(n, n // 2, radius=2.0) for n in (12, 24, 48)]
    H = [np.abs(discrete_mean_curvature(*t, t.normals) - 0.25)[t.interior].max() for t in tubes]
    assert orders(H) == pytest.approx([2, 2], abs=0.06)  # measured: 1.98, 1.99
    assert np.abs(discrete_gaussian_curvature(*tubes[-1])[tubes[-1].interior]).max() < 1e-12


def test_mean_curvature_has_the_sign_that_the_normals_give_it():
    ring = shapes.torus(64, r=0.7)  # thick, so that H < 0 inside
    H = discrete_mean_curvature(*ring, ring.normals)
    inside = ring.mean_curvature < -0.2
    assert inside.any()
    assert (H[inside] < 0).all()
    assert (H[ring.mean_curvature > 0.2] > 0).all()
    np.testing.assert_array_equal(discrete_mean_curvature(*ring, -ring.normals), -H)
    # Without normals only the size is left. The vector leans from the normal by an angle of order h.
    np.testing.assert_allclose(discrete_mean_curvature(*ring), np.abs(H), atol=0.02)


@pytest.mark.parametrize("factor", [100.0, 0.01])
def test_curvatures_follow_the_size(factor):
    mesh = shapes.random_closed(5, 40)
    large = mesh.scaled(factor)
    size = np.abs(mean_curvature_normal(*mesh)).max()
    np.testing.assert_allclose(
        factor * mean_curvature_normal(*large), mean_curvature_normal(*mesh), atol=1e-11 * size
    )
    K = discrete_gaussian_curvature(*mesh)
    np.testing.assert_allclose(
        factor**2 * discrete_gaussian_curvature(*large), K, atol=1e-11 * np.abs(K).max()
    )


def test_principal_curvatures_converge_on_the_torus_at_second_order():
    errors = []
    for n in (32, 64, 128):
        t = shapes.torus(n)
        H, K = discrete_mean_curvature(*t, t.normals), discrete_gaussian_curvature(*t)
        k = np.column_stack(discrete_principal_curvatures(H, K))
        errors.append(np.abs(k - t.principal_curvatures).max())
    assert orders(errors) == pytest.approx([2, 2], abs=0.1)


def test_principal_curvatures_are_real_where_the_discrete_h_and_k_contradict_each_other():
    H, K = np.array([1.0, 1.0, -2.0, 0.0]), np.array([1.01, 0.75, 3.0, -4.0])
    k1, k2 = discrete_principal_curvatures(H, K)
    np.testing.assert_allclose(k1, [1, 1.5, -1, 2])
    np.testing.assert_allclose(k2, [1, 0.5, -3, -2])


def test_the_quality_of_triangles_that_are_known():
    corners = {
        "equilateral": [[0, 0, 0], [2, 0, 0], [1, np.sqrt(3), 0]],
        "3-4-5": [[0, 0, 1], [3, 0, 1], [0, 4, 1]],
        "needle": [[0, 0, 2], [1, 1e-3, 2], [2, 0, 2]],
    }
    vertices = np.concatenate(list(corners.values())).astype(float)
    quality = mesh_quality(7.0 * vertices, np.arange(9).reshape(3, 3))
    np.testing.assert_allclose(quality["smallest_angle"], [np.pi / 3, np.arcsin(0.6), np.arctan(1e-3)])
    half = np.sqrt(3) / 2
    np.testing.assert_allclose(quality["aspect_ratio"], [1, 5 / 2.4 * half, 2000 * half])
    # In a right triangle the radii are (a + b - c) / 2 and c / 2.
    np.testing.assert_allclose(quality["radius_ratio"][:2], [1, 0.8])
    assert quality["radius_ratio"][2] < 1e-5
    assert quality["valence"].tolist() == [2] * 9


def test_valence_counts_neighbours_also_at_a_boundary():
    disc = shapes.disc(2)
    valence = mesh_quality(*disc)["valence"]
    assert (valence[disc.interior] == 6).all()
    assert sorted(set(valence[~disc.interior].tolist())) == [3, 4]
    assert valence.sum() == 2 * (len(disc.vertices) + len(disc.faces) - 1)  # E = V + F - 1
