"""Laplacians and cells against facts of plane geometry and linear algebra."""

import numpy as np
import pytest

from gpcourse.geometry import shapes
from gpcourse.geometry.triangles import surface_area
from gpcourse.reference.smoothing import (
    barycentric_areas,
    boundary_vertices,
    cotangent_matrix,
    laplacian,
    mass_matrix,
    mixed_areas,
    uniform_laplacian,
    voronoi_areas,
)

CELLS = {"mixed": mixed_areas, "barycentric": barycentric_areas, "voronoi": voronoi_areas}
MESHES = {
    "icosphere": lambda: shapes.icosphere(1),
    "torus": lambda: shapes.torus(9, 7),
    "disc": lambda: shapes.disc(3),
    "annulus": lambda: shapes.annulus(9, 2),
    "Möbius strip": lambda: shapes.moebius(9),
    "obtuse patch": lambda: shapes.irregular_patch(4, 50, stretch=3.0),
    "closed": lambda: shapes.random_closed(1, 50),
    "bounded": lambda: shapes.random_bounded(2, 50),
    "two pieces": lambda: shapes.random_bounded(3, 40, n_components=2),
}
RIGHT = np.array([[0.0, 0, 0], [3, 0, 0], [0, 4, 0]])
OBTUSE = np.array([[0.0, 0, 0], [4, 0, 0], [-1, 1, 0]])
EQUILATERAL = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, np.sqrt(3) / 2, 0]])
ONE = np.array([[0, 1, 2]])

every_mesh = pytest.mark.parametrize("mesh", [pytest.param(make(), id=name) for name, make in MESHES.items()])


def neighbours_of(faces, n):
    rings = [set() for _ in range(n)]
    for a, b, c in np.asarray(faces).tolist():
        rings[a] |= {b, c}
        rings[b] |= {a, c}
        rings[c] |= {a, b}
    return rings


@every_mesh
def test_the_uniform_laplacian_is_the_mean_of_the_neighbours_minus_the_value(mesh):
    f = np.random.default_rng(0).normal(size=len(mesh.vertices))
    rings = neighbours_of(mesh.faces, len(f))
    means = [np.mean(f[list(ring)]) for ring in rings]
    np.testing.assert_allclose(uniform_laplacian(mesh.faces, len(f)) @ f, means - f, rtol=0, atol=1e-13)


def test_an_isolated_vertex_has_a_zero_row_in_the_uniform_laplacian():
    L = uniform_laplacian([[0, 1, 3]], 5).toarray()
    assert not L[[2, 4]].any()
    assert not L[:, [2, 4]].any()
    np.testing.assert_array_equal(L[0, [0, 1, 3]], [-1, 0.5, 0.5])


def test_the_uniform_laplacian_moves_the_vertices_of_a_flat_patch_and_the_cotangent_one_does_not():
    patch = shapes.irregular_patch(7, 100)
    edge = 1 / np.sqrt(len(patch.vertices))
    pull = uniform_laplacian(patch.faces, len(patch.vertices)) @ patch.vertices
    assert np.linalg.norm(pull[patch.interior], axis=1).max() > 0.1 * edge
    assert not pull[:, 2].any()
    C = cotangent_matrix(patch.vertices, patch.faces)
    # Rounding: the cotangents of needles are below 1e3.
    assert np.abs((C @ patch.vertices)[patch.interior]).max() < 1e-11


@every_mesh
def test_the_cotangent_matrix_is_symmetric_and_semi_definite_with_zero_row_sums(mesh):
    C = cotangent_matrix(*mesh)
    size = np.abs(C.data).max()
    assert abs(C - C.T).max() <= 1e-14 * size
    np.testing.assert_allclose(C.sum(axis=1), 0, atol=1e-14 * size)
    values = np.linalg.eigvalsh(C.toarray())
    assert values.max() < 1e-13 * size
    # Only functions that are constant on each piece have no energy.
    assert np.count_nonzero(values > -1e-11 * size) == mesh.n_components


@every_mesh
def test_the_cotangent_matrix_does_not_change_with_place_and_size(mesh):
    C = cotangent_matrix(*mesh)
    Q, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    for factor in (100.0, 0.01):
        moved = factor * mesh.vertices @ Q.T + factor * np.array([1.0, -2.0, 0.5])
        # The meshes lie up to ten sizes from the origin, which takes a digit or two.
        assert abs(cotangent_matrix(moved, mesh.faces) - C).max() < 1e-10 * np.abs(C.data).max()


def test_the_weights_of_one_triangle_are_half_the_cotangents_of_the_opposite_angles():
    C = cotangent_matrix(RIGHT, ONE).toarray()
    assert C[1, 2] == pytest.approx(0, abs=1e-16)  # opposite to the right angle
    assert C[0, 2] == pytest.approx(3 / 4 / 2)
    assert C[0, 1] == pytest.approx(4 / 3 / 2)
    assert cotangent_matrix(OBTUSE, ONE).toarray()[1, 2] == pytest.approx(-1 / 2)


def test_the_energy_of_a_linear_function_is_exact():
    patch = shapes.irregular_patch(5, 80, stretch=4.0)
    slope = np.array([2.0, -3.0, 0.0])
    u = patch.vertices @ slope
    energy = -u @ cotangent_matrix(*patch) @ u
    assert energy == pytest.approx(slope @ slope * surface_area(*patch), rel=1e-12)


@every_mesh
def test_cells_share_out_the_whole_surface(mesh):
    for name, areas in CELLS.items():
        cells = areas(*mesh)
        assert cells.sum() == pytest.approx(surface_area(*mesh), rel=1e-12)
        assert (cells > 0).all() or name == "voronoi"
        np.testing.assert_array_equal(mass_matrix(*mesh, cells=name).toarray(), np.diag(cells))


@pytest.mark.parametrize("turn", [0, 1, 2])
def test_the_cells_of_single_triangles(turn):
    face, corners = np.roll(ONE, turn, axis=1), [0, 1, 2]
    for areas in CELLS.values():
        np.testing.assert_allclose(areas(EQUILATERAL, face)[corners], np.sqrt(3) / 12, rtol=1e-14)
    for areas in (voronoi_areas, mixed_areas):
        np.testing.assert_allclose(areas(RIGHT, face), [3, 1.5, 1.5], rtol=1e-14)
    np.testing.assert_allclose(mixed_areas(OBTUSE, face), [1, 0.5, 0.5], rtol=1e-14)
    # The circumcentre, (2, 3), lies beyond the longest edge: what sticks out there counts as
    # negative for both ends of that edge.
    np.testing.assert_allclose(voronoi_areas(OBTUSE, face), [4.25, -0.25, -2], rtol=1e-13)


def test_voronoi_cells_are_those_of_the_points_in_the_plane():
    from scipy.spatial import ConvexHull, Voronoi

    patch = shapes.irregular_patch(11, 60)  # Delaunay, with obtuse triangles
    plane = patch.vertices[:, :2]
    diagram = Voronoi(plane)
    inside = np.flatnonzero(patch.interior)
    cells = [ConvexHull(diagram.vertices[diagram.regions[diagram.point_region[v]]]).volume for v in inside]
    np.testing.assert_allclose(voronoi_areas(*patch)[inside], cells, rtol=1e-9)
    assert (np.abs(mixed_areas(*patch)[inside] - cells) > 1e-3 * np.mean(cells)).any()


@every_mesh
def test_the_laplacian_is_symmetric_in_the_inner_product_of_the_mass_matrix(mesh):
    M, L = mass_matrix(*mesh), laplacian(*mesh)
    assert abs(M @ L - cotangent_matrix(*mesh)).max() < 1e-12 * abs(M @ L).max()


def test_the_laplacian_of_a_square_is_exact_on_a_regular_patch():
    disc = shapes.disc(5, radius=2.0)
    u = np.square(disc.vertices).sum(axis=1)
    np.testing.assert_allclose((laplacian(*disc) @ u)[disc.interior], 4, rtol=1e-12)


@every_mesh
def test_boundary_vertices_are_those_of_edges_with_one_face(mesh):
    np.testing.assert_array_equal(boundary_vertices(mesh.faces, len(mesh.vertices)), ~mesh.interior)


def test_an_isolated_vertex_is_on_no_boundary():
    assert boundary_vertices([[1, 2, 3]], 5).tolist() == [False, True, True, True, False]
    assert boundary_vertices(np.empty((0, 3), int), 2).tolist() == [False, False]


def test_faces_turned_over_and_fans_that_meet_in_a_vertex_do_not_mislead_about_the_boundary():
    sphere = shapes.icosphere(1)
    mixed = np.where(np.arange(len(sphere.faces))[:, None] % 3 == 0, sphere.faces[:, ::-1], sphere.faces)
    assert not boundary_vertices(mixed, len(sphere.vertices)).any()
    assert boundary_vertices(mixed[1:], len(sphere.vertices)).nonzero()[0].tolist() == sorted(mixed[0])
    bow = [[0, 1, 2], [0, 3, 4]]
    assert boundary_vertices(bow, 6).tolist() == [True] * 5 + [False]
