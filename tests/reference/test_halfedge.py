"""Chapter 1's reference against facts of geometry and topology."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gpcourse.errors import (
    ArrayError,
    DegenerateFaceError,
    FlipError,
    GeometryError,
    MeshError,
    NonManifoldEdgeError,
    OrientationError,
)
from gpcourse.geometry import shapes
from gpcourse.geometry.halfedge_mesh import HOLE, NONE
from gpcourse.reference import halfedge as reference
from gpcourse.reference.halfedge import build_halfedges, halfedge_mesh

CLOSED = {
    "tetrahedron": (shapes.tetrahedron, 0),
    "cube": (shapes.cube, 0),
    "dodecahedron": (shapes.dodecahedron, 0),
    "icosphere": (lambda: shapes.icosphere(2), 0),
    "torus": (lambda: shapes.torus(9, 7), 1),
    "quad torus": (lambda: shapes.torus(9, 7, quads=True), 1),
    "genus 2": (lambda: shapes.genus_surface(2), 2),
    "genus 3": (lambda: shapes.genus_surface(3), 3),
    "random": (lambda: shapes.random_closed(np.random.default_rng(1), 40), 0),
}
BOUNDED = {
    "disc": (lambda: shapes.disc(3), 1),
    "annulus": (shapes.annulus, 2),
    "cylinder": (lambda: shapes.cylinder(6), 2),
}


def mesh_of(make):
    shape = make()
    return halfedge_mesh(shape.vertices, shape.faces)


@pytest.mark.parametrize("name", CLOSED)
def test_closed_surfaces_have_valid_records_and_the_right_genus(name):
    make, genus = CLOSED[name]
    mesh = mesh_of(make)
    mesh.validate()
    assert not (mesh.face == HOLE).any()
    assert reference.boundary_loops(mesh) == []
    assert reference.euler_characteristic(mesh) == 2 - 2 * genus
    assert reference.genus(mesh) == genus


@pytest.mark.parametrize("name", BOUNDED)
def test_bounded_surfaces_have_loops_of_hole_halfedges(name):
    make, loops = BOUNDED[name]
    shape, mesh = make(), mesh_of(make)
    mesh.validate()
    found = reference.boundary_loops(mesh)
    assert len(found) == loops
    assert sorted(map(len, found)) == sorted(shape.boundary_lengths)
    assert reference.genus(mesh) == 0
    assert reference.euler_characteristic(mesh) == 2 - loops


def test_filling_the_holes_of_a_bounded_torus_keeps_its_genus():
    torus = shapes.torus(8, 6)
    mesh = build_halfedges(torus.faces[1:], len(torus.vertices))
    assert reference.euler_characteristic(mesh) == -1
    assert reference.genus(mesh) == 1


def test_faces_come_back_as_they_were_given():
    prism = shapes.prism(6)
    mesh = halfedge_mesh(*prism)
    assert [reference.face_vertices(mesh, f) for f in range(mesh.n_faces)] == [
        list(map(int, f)) for f in prism.faces
    ]


def test_the_packed_sort_and_the_fallback_build_the_same_mesh():
    shape = shapes.random_bounded(np.random.default_rng(3), 60)
    small = build_halfedges(shape.faces, len(shape.vertices))
    # With this many vertices two indices and a half-edge no longer fit in 63 bits.
    many = 2**28
    low = np.minimum(small.origin, small.origin[small.twin])
    high = np.maximum(small.origin, small.origin[small.twin])
    _, packed = reference._sort_by_edge(low, high, small.n_vertices)
    _, fallback = reference._sort_by_edge(low, high, many)
    np.testing.assert_array_equal(packed, fallback)


def test_isolated_vertices_have_no_halfedge_and_no_neighbours():
    mesh = build_halfedges([[1, 2, 4]], 6)
    mesh.validate()
    assert (mesh.vertex_halfedge == NONE).tolist() == [True, False, False, True, False, True]
    assert reference.vertex_neighbours_ccw(mesh, 5) == []
    assert reference.vertex_neighbours_cw(mesh, 0) == []
    assert reference.euler_characteristic(mesh) == 1


def test_a_mesh_without_faces_is_empty():
    mesh = build_halfedges([], 3)
    mesh.validate()
    assert (mesh.n_halfedges, mesh.n_faces, reference.genus(mesh)) == (0, 0, 0)
    with pytest.raises(MeshError, match="no faces"):
        reference.element_statistics(mesh)


@pytest.mark.parametrize(
    ("faces", "error", "names"),
    [
        ([[0, 1, 2], [1, 0, 3], [0, 1, 4]], NonManifoldEdgeError, ["0 – 1", "faces 0, 1 and 2"]),
        ([[0, 1, 2], [0, 1, 3]], OrientationError, ["0 -> 1", "faces 0 and 1"]),
        ([[0, 1, 2], [0, 3, 4]], MeshError, ["vertex 0"]),
        ([[0, 1, 2], [0, 2, 9]], MeshError, ["face 1", "vertex 9"]),
        ([[0, 1, 2], [-1, 2, 1]], MeshError, ["face 1", "vertex -1"]),
        ([[0, 1, 2], [2, 1, 2]], DegenerateFaceError, ["face 1"]),
        ([[0, 1, 2, 3], [2, 1, 0, 4, 1]], DegenerateFaceError, ["face 1"]),
        ([[0, 1]], MeshError, ["face 0", "at least 3"]),
        ([[0, 1.5, 2]], ArrayError, ["integers"]),
        ("faces", ArrayError, ["list of index lists"]),
    ],
)
def test_what_is_no_oriented_manifold_is_refused_by_name(faces, error, names):
    with pytest.raises(error) as raised:
        build_halfedges(faces, 5)
    for name in names:
        assert name in str(raised.value)


def test_two_closed_sheets_that_touch_in_a_vertex_are_refused():
    faces = shapes.tetrahedron().faces
    other = np.where(faces == 0, 0, faces + 3)  # a second tetrahedron that shares vertex 0
    with pytest.raises(MeshError, match="vertex 0 only"):
        build_halfedges(np.vstack([faces, other]), 7)


def test_a_moebius_strip_is_refused():
    strip = shapes.moebius(9)
    with pytest.raises(OrientationError):
        build_halfedges(strip.faces, len(strip.vertices))


@pytest.mark.parametrize("count", [-1, 2.0, "3"])
def test_a_vertex_count_that_is_none_is_refused(count):
    with pytest.raises(ArrayError, match="n_vertices"):
        build_halfedges([[0, 1, 2]], count)


def test_the_fan_check_is_quick_on_a_vertex_of_high_valence():
    k = 5000
    fan = np.column_stack([np.zeros(k, int), 1 + np.arange(k), 1 + (np.arange(k) + 1) % k])
    mesh = build_halfedges(fan, k + 1)
    assert len(reference.vertex_neighbours_ccw(mesh, 0)) == k


def test_neighbours_turn_counter_clockwise_seen_from_outside():
    mesh = mesh_of(lambda: shapes.icosphere(1))
    for v in range(mesh.n_vertices):
        ring = mesh.vertices[reference.vertex_neighbours_ccw(mesh, v)] - mesh.vertices[v]
        turns = np.cross(ring, np.roll(ring, -1, axis=0)) @ mesh.vertices[v]
        assert (turns > 0).all()
        assert sorted(reference.vertex_neighbours_cw(mesh, v)) == sorted(
            reference.vertex_neighbours_ccw(mesh, v)
        )


def test_the_clockwise_walk_is_the_counter_clockwise_one_backwards():
    mesh = mesh_of(lambda: shapes.random_bounded(np.random.default_rng(5), 40))
    for v in range(mesh.n_vertices):
        ccw, cw = reference.vertex_neighbours_ccw(mesh, v), reference.vertex_neighbours_cw(mesh, v)
        assert cw == ccw[:1] + ccw[:0:-1]


@pytest.mark.parametrize("f", [-1, 6])
def test_a_face_that_is_not_there_is_refused(f):
    mesh = mesh_of(shapes.cube)
    with pytest.raises(GeometryError, match=rf"no face {f}; they run from 0 to 5"):
        reference.face_vertices(mesh, f)


def test_a_centroid_moves_with_its_face():
    mesh = mesh_of(lambda: shapes.prism(5))
    shift = np.array([1e3, -2e3, 5.0])
    moved = mesh.with_vertices(mesh.vertices + shift)
    for f in range(mesh.n_faces):
        # Rounding of the sum of five coordinates of size 1e3.
        np.testing.assert_allclose(
            reference.face_centroid(moved, f) - reference.face_centroid(mesh, f), shift, rtol=0, atol=1e-11
        )


def test_a_centroid_needs_positions():
    with pytest.raises(ArrayError, match="no positions"):
        reference.face_centroid(build_halfedges([[0, 1, 2]], 3), 0)


# Flips


def cycles(mesh):
    faces = [reference.face_vertices(mesh, f) for f in range(mesh.n_faces)]
    return sorted(face[face.index(min(face)) :] + face[: face.index(min(face))] for face in faces)


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 10**6))
def test_a_thousand_legal_flips_keep_every_invariant(seed):
    rng = np.random.default_rng(seed)
    mesh = mesh_of(lambda: shapes.random_bounded(rng, 40) if seed % 2 else shapes.random_closed(rng, 30))
    counts = mesh.n_vertices, mesh.n_faces, mesh.n_halfedges, reference.euler_characteristic(mesh)
    flips = 0
    for _ in range(125):  # times eight examples
        h = int(rng.integers(mesh.n_halfedges))
        if not reference.is_flippable(mesh, h):
            continue
        before = np.bincount(mesh.origin)
        p, q = mesh.origin[h], mesh.origin[mesh.twin[h]]
        r, s = mesh.origin[mesh.prev[h]], mesh.origin[mesh.prev[mesh.twin[h]]]
        mesh = reference.flip_edge(mesh, h)
        flips += 1
        change = np.bincount(mesh.origin) - before
        assert change[[p, q]].tolist() == [-1, -1]
        assert change[[r, s]].tolist() == [1, 1]
        assert np.abs(change).sum() == 4
        mesh.validate()
    assert flips > 20
    assert counts == (mesh.n_vertices, mesh.n_faces, mesh.n_halfedges, reference.euler_characteristic(mesh))


def test_two_flips_of_an_edge_give_the_same_surface_back():
    mesh = mesh_of(shapes.icosahedron)
    once = reference.flip_edge(mesh, 7)
    assert cycles(once) != cycles(mesh)
    assert cycles(reference.flip_edge(once, 7)) == cycles(mesh)


def test_a_flip_leaves_its_input_alone():
    mesh = mesh_of(shapes.icosahedron)
    before = mesh.next.copy()
    reference.flip_edge(mesh, 3)
    np.testing.assert_array_equal(mesh.next, before)


def test_illegal_flips_are_refused():
    tetrahedron = mesh_of(shapes.tetrahedron)
    assert not any(reference.is_flippable(tetrahedron, h) for h in range(12))
    with pytest.raises(FlipError, match="half-edge 4"):
        reference.flip_edge(tetrahedron, 4)
    triangle = build_halfedges([[0, 1, 2]], 3)
    assert not any(reference.is_flippable(triangle, h) for h in range(6))
    quads = mesh_of(shapes.cube)
    assert not any(reference.is_flippable(quads, h) for h in range(24))


def test_flips_to_delaunay_raise_the_smallest_angle_and_end():
    patch = shapes.irregular_patch(np.random.default_rng(2), 60)
    mesh = halfedge_mesh(*patch)
    rng = np.random.default_rng(0)
    for _ in range(200):  # spoil it first, keeping it a triangulation of the plane
        h = int(rng.integers(mesh.n_halfedges))
        if reference.is_flippable(mesh, h) and _stays_flat(mesh, h):
            mesh = reference.flip_edge(mesh, h)
    angles = [_sorted_angles(mesh)]
    angles += [_sorted_angles(better) for better in reference.delaunay_flips(mesh)]
    assert len(angles) > 20
    # Each flip raises the sorted vector of all angles in dictionary order (1e-9: rounding of angles).
    for worse, better in itertools.pairwise(angles):
        first = np.flatnonzero(np.abs(better - worse) > 1e-9)[0]
        assert better[first] > worse[first]
    assert angles[-1][0] > angles[0][0]


def _sorted_angles(mesh):
    from gpcourse.geometry.triangles import corner_angles

    faces = np.array([reference.face_vertices(mesh, f) for f in range(mesh.n_faces)])
    return np.sort(corner_angles(mesh.vertices, faces).ravel())


def _stays_flat(mesh, h):
    """A flip in the plane needs a strictly convex quadrilateral."""
    t = mesh.twin[h]
    corners = [mesh.origin[i] for i in (h, mesh.prev[t], t, mesh.prev[h])]
    x = mesh.vertices[corners][:, :2]
    side = np.roll(x, -1, axis=0) - x
    after = np.roll(side, -1, axis=0)
    turn = side[:, 0] * after[:, 1] - side[:, 1] * after[:, 0]
    return bool((turn > 1e-4).all())


# Duals


def test_the_dual_of_a_cube_is_an_octahedron():
    vertices, faces = reference.dual_mesh(mesh_of(shapes.cube))
    dual = halfedge_mesh(vertices, faces)
    dual.validate()
    assert (dual.n_vertices, dual.n_faces, dual.n_halfedges) == (6, 8, 24)
    assert {len(face) for face in faces} == {3}
    # Seen from outside: every face normal points away from the centre.
    a, b, c = (vertices[[face[i] for face in faces]] for i in range(3))
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c - 3 * vertices.mean(axis=0)) > 0).all()


@pytest.mark.parametrize("name", CLOSED)
def test_the_double_dual_has_the_faces_of_the_mesh(name):
    mesh = mesh_of(CLOSED[name][0])
    dual = halfedge_mesh(*reference.dual_mesh(mesh))
    assert (dual.n_vertices, dual.n_faces) == (mesh.n_faces, mesh.n_vertices)
    assert dual.n_halfedges == mesh.n_halfedges
    assert cycles(halfedge_mesh(*reference.dual_mesh(dual))) == cycles(mesh)


def test_no_dual_of_a_mesh_with_a_hole_or_an_isolated_vertex():
    with pytest.raises(MeshError, match="runs along a hole"):
        reference.dual_mesh(mesh_of(lambda: shapes.disc(2)))
    cube = shapes.cube()
    with pytest.raises(MeshError, match="vertex 8 is isolated"):
        reference.dual_mesh(halfedge_mesh(np.vstack([cube.vertices, [[9.0, 9, 9]]]), cube.faces))


# Counting


def test_ratios_on_a_torus_are_exact():
    triangles = reference.element_statistics(mesh_of(lambda: shapes.torus(9, 7)))
    assert (triangles["F/V"], triangles["E/V"], triangles["valence"]) == (2, 3, 6)
    quads = reference.element_statistics(mesh_of(lambda: shapes.torus(9, 7, quads=True)))
    assert (quads["F/V"], quads["E/V"], quads["valence"]) == (1, 2, 4)


def test_the_genus_of_several_components_is_summed():
    both = shapes.union(shapes.torus(5, 4), shapes.genus_surface(2), shapes.disc(2), shapes.octahedron())
    mesh = halfedge_mesh(*both)
    assert reference.genus(mesh) == 3


def test_a_cube_of_six_outward_quads():
    vertices, faces = reference.cube()
    mesh = halfedge_mesh(vertices, faces)
    mesh.validate()
    assert (mesh.n_vertices, mesh.n_faces, mesh.n_halfedges) == (8, 6, 24)
    for face in faces:
        normal = np.cross(vertices[face[1]] - vertices[face[0]], vertices[face[2]] - vertices[face[1]])
        assert normal @ (vertices[face].mean(axis=0) - 0.5) == 0.5
