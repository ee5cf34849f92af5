"""The records of half-edges: what agrees is accepted, each contradiction has a message of its own."""

import numpy as np
import pytest

from gpcourse.errors import ArrayError, HalfedgeError
from gpcourse.geometry.halfedge_mesh import HOLE, NONE, HalfedgeMesh, orbit_labels


def tetrahedron():
    """Four faces 012, 031, 132, 230; face f has the half-edges 3f, 3f + 1, 3f + 2."""
    return {
        "twin": [5, 8, 11, 10, 6, 0, 4, 9, 1, 7, 3, 2],
        "next": [1, 2, 0, 4, 5, 3, 7, 8, 6, 10, 11, 9],
        "prev": [2, 0, 1, 5, 3, 4, 8, 6, 7, 11, 9, 10],
        "origin": [0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0],
        "face": [0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3],
        "vertex_halfedge": [0, 1, 2, 4],
        "face_halfedge": [0, 3, 6, 9],
    }


def triangle():
    """One face 012 with the half-edges 0, 1, 2; their twins 3, 4, 5 run round the hole the other way."""
    return {
        "twin": [3, 4, 5, 0, 1, 2],
        "next": [1, 2, 0, 5, 3, 4],
        "prev": [2, 0, 1, 4, 5, 3],
        "origin": [0, 1, 2, 1, 2, 0],
        "face": [0, 0, 0, HOLE, HOLE, HOLE],
        "vertex_halfedge": [0, 1, 2],
        "face_halfedge": [0],
    }


def two_triangles(**changes):
    """Two separate triangles, with half-edges 0 .. 5 and 6 .. 11, and vertices 0 .. 2 and 3 .. 5."""
    one, records = triangle(), {}
    step = {"origin": 3, "face": 1, "twin": 6, "next": 6, "prev": 6, "vertex_halfedge": 6, "face_halfedge": 6}
    for name, values in one.items():
        records[name] = values + [value if value == HOLE else value + step[name] for value in values]
    return records | changes


def changed(records, **changes):
    """Set single entries: ``name=(index, value)`` or a list of such pairs."""
    for name, pairs in changes.items():
        for index, value in pairs if isinstance(pairs, list) else [pairs]:
            records[name][index] = value
    return HalfedgeMesh(**records)


@pytest.mark.parametrize("records", [tetrahedron(), triangle(), two_triangles()])
def test_records_that_agree_are_accepted(records):
    HalfedgeMesh(**records).validate()


def test_counts_of_the_tetrahedron_and_the_triangle():
    mesh = HalfedgeMesh(**tetrahedron())
    assert (mesh.n_vertices, mesh.n_halfedges, mesh.n_faces) == (4, 12, 4)
    mesh = HalfedgeMesh(**triangle())
    assert (mesh.n_vertices, mesh.n_halfedges, mesh.n_faces) == (3, 6, 1)
    assert "3 of them along holes, no positions" in repr(mesh)


def test_isolated_vertices_and_empty_meshes_are_accepted():
    HalfedgeMesh(**(triangle() | {"vertex_halfedge": [0, 1, 2, NONE]})).validate()
    for n in (0, 2):
        HalfedgeMesh(*([] for _ in range(5)), vertex_halfedge=[NONE] * n, face_halfedge=[]).validate()


@pytest.mark.parametrize(
    ("mesh", "says"),
    [
        (changed(tetrahedron(), twin=[(0, 0), (5, 5)]), "half-edge 0 is its own twin"),
        (changed(tetrahedron(), twin=(3, 7)), "half-edge 3: the twin of its twin is another half-edge"),
        (changed(tetrahedron(), prev=[(0, 0), (1, 2)]), "half-edge 0: prev of its next is another half-edge"),
        (changed(tetrahedron(), next=(4, 3)), "half-edge 4: prev of its next is another half-edge"),
        (changed(tetrahedron(), origin=(0, 2)), "half-edge 2: its next does not start where its twin starts"),
        (
            changed(triangle() | {"face_halfedge": []}, face=[(0, HOLE), (1, HOLE), (2, HOLE)]),
            "half-edge 0 and its twin both run along a hole",
        ),
        (changed(tetrahedron(), face=(4, 2)), "half-edge 3: its next belongs to another face"),
        (changed(tetrahedron(), face_halfedge=(1, 0)), "face 1: its half-edge is not its own"),
        (changed(tetrahedron(), vertex_halfedge=(3, 0)), "vertex 3: its half-edge starts elsewhere"),
        (changed(tetrahedron(), vertex_halfedge=(2, NONE)), "vertex 2 has half-edges but no representative"),
        (
            HalfedgeMesh(**two_triangles(face=[0, 0, 0, -1, -1, -1] * 2, face_halfedge=[0])),
            "half-edge 6: next does not lead round the whole of its face",
        ),
        (
            # Vertex 3 is vertex 0 too: two triangles that touch in a point.
            HalfedgeMesh(
                **two_triangles(origin=[0, 1, 2, 1, 2, 0, 0, 3, 4, 3, 4, 0], vertex_halfedge=[0, 1, 2, 7, 8])
            ),
            "half-edge 6 is not reached by walking around its origin",
        ),
        (changed(tetrahedron(), twin=(3, 12)), r"twin\[3\] is 12; it must lie in 0 .. 11"),
        (changed(tetrahedron(), next=(3, -1)), r"next\[3\] is -1"),
        (changed(tetrahedron(), prev=(3, 12)), r"prev\[3\] is 12"),
        (changed(tetrahedron(), origin=(3, 4)), r"origin\[3\] is 4; it must lie in 0 .. 3"),
        (changed(tetrahedron(), face=(3, -2)), r"face\[3\] is -2; it must lie in -1 .. 3"),
        (changed(tetrahedron(), vertex_halfedge=(3, 12)), r"vertex_halfedge\[3\] is 12"),
        (changed(tetrahedron(), face_halfedge=(3, -1)), r"face_halfedge\[3\] is -1; it must lie in 0 .. 11"),
    ],
)
def test_every_contradiction_is_named(mesh, says):
    with pytest.raises(HalfedgeError, match=says):
        mesh.validate()


def test_the_error_carries_the_half_edge():
    with pytest.raises(HalfedgeError) as caught:
        changed(tetrahedron(), twin=(3, 7)).validate()
    assert caught.value.halfedge == 3
    with pytest.raises(HalfedgeError) as caught:
        changed(tetrahedron(), face_halfedge=(1, 0)).validate()
    assert caught.value.halfedge is None


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"next": [0, 1]}, "next has 2 entries and twin has 12"),
        ({"face": [0.0] * 12}, "face has shape .* type float64"),
        ({"origin": [[0, 1], [2]]}, "origin mixes lengths"),
        ({"face_halfedge": [[0, 3, 6, 9]]}, r"face_halfedge has shape \(1, 4\)"),
        ({"vertices": np.zeros((3, 3))}, "vertices has 3 rows and vertex_halfedge has 4"),
        ({"vertices": np.zeros((4, 2))}, r"vertices has shape \(4, 2\)"),
        ({"vertices": np.full((4, 3), np.nan)}, "finite"),
    ],
)
def test_records_of_the_wrong_kind_are_refused_at_once(changes, says):
    with pytest.raises(ArrayError, match=says):
        HalfedgeMesh(**(tetrahedron() | changes))


def test_a_copy_is_independent_and_positions_can_be_exchanged():
    mesh = HalfedgeMesh(**tetrahedron(), vertices=np.eye(4)[:, :3])
    copy = mesh.copy()
    copy.twin[0] = 7
    copy.vertices[0] = 9
    mesh.validate()
    assert mesh.vertices[0].tolist() == [1, 0, 0]
    moved = mesh.with_vertices(mesh.vertices + 1)
    assert moved.twin is mesh.twin
    assert moved.vertices[0].tolist() == [2, 1, 1]
    with pytest.raises(ArrayError, match="vertices has 2 rows"):
        mesh.with_vertices([[0, 0, 0], [1, 1, 1]])


@pytest.mark.parametrize("size", [0, 1, 2, 7, 64, 1000])
def test_orbit_labels_are_the_smallest_index_of_each_cycle(size):
    rng = np.random.default_rng(size)
    for _ in range(5):
        permutation = rng.permutation(size)
        labels = orbit_labels(permutation)
        for start in range(size):
            cycle, at = [start], permutation[start]
            while at != start:
                cycle.append(at)
                at = permutation[at]
            assert labels[start] == min(cycle)


def test_orbit_labels_of_one_long_cycle():
    rng = np.random.default_rng(1)
    order = rng.permutation(999)  # one cycle, its length no power of two
    permutation = np.empty_like(order)
    permutation[order] = np.roll(order, -1)
    assert not orbit_labels(permutation).any()


def test_orbit_labels_of_a_very_long_cycle_take_few_rounds():
    # A walk step by step would take 200,000 rounds over all of it, which is minutes.
    assert not orbit_labels(np.roll(np.arange(200_000), 1)).any()
