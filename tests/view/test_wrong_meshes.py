"""Records that contradict each other are drawn as far as they go, and never raise or run for ever."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gpcourse import view
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh
from gpcourse.reference.halfedge import halfedge_mesh
from gpcourse.view import scene
from gpcourse.view.subject import face_loops, halfedge_heads

QUIET = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}


@st.composite
def garbage(draw):
    """A mesh with any numbers in its records."""
    n_vertices, n_halfedges, n_faces = draw(
        st.tuples(st.integers(0, 6), st.integers(0, 14), st.integers(0, 4))
    )

    def record(length):
        return np.array(draw(st.lists(st.integers(-3, 20), min_size=length, max_size=length)), dtype=np.int64)

    # Few different coordinates, so that vertices coincide and faces degenerate.
    coordinate = st.sampled_from([0.0, 1.0, -1.0, 0.5, 1e9, 1e-9, 1e200])
    row = st.tuples(coordinate, coordinate, coordinate)
    positions = draw(st.lists(row, min_size=n_vertices, max_size=n_vertices))
    records = [record(n_halfedges) for _ in range(5)] + [record(n_vertices), record(n_faces)]
    return HalfedgeMesh(*records, vertices=np.array(positions).reshape(-1, 3))


@settings(max_examples=200, **QUIET)
@given(garbage(), st.data())
def test_scenes_of_garbage_are_made(mesh, data):
    chosen = data.draw(st.lists(st.integers(0, mesh.n_halfedges - 1))) if mesh.n_halfedges else []
    made = view.halfedge_scene(mesh, chosen)
    assert made.to_json() == scene.Scene.from_json(made.to_json()).to_json()
    assert view.mesh(mesh).scene
    if mesh.n_vertices:
        assert view.neighbours(mesh, 0, [0]).scene


@settings(max_examples=25, **QUIET)
@given(garbage())
def test_garbage_is_drawn(mesh):
    assert view.halfedges(mesh, list(range(min(2, mesh.n_halfedges)))).png()[:4] == b"\x89PNG"


def annulus(n=6):
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    faces = [[i, n + i, n + (i + 1) % n, (i + 1) % n] for i in range(n)]
    return halfedge_mesh(np.concatenate([ring, 2 * ring]), faces), faces


def same_cycle(a, b):
    return len(a) == len(b) and any(a[i:] + a[:i] == b for i in range(len(a)))


def test_sound_records_give_every_face_and_every_head():
    mesh, faces = annulus()
    assert all(same_cycle(a, b) for a, b in zip(face_loops(mesh), faces, strict=True))
    np.testing.assert_array_equal(halfedge_heads(mesh), mesh.origin[mesh.twin])


def test_one_wrong_record_costs_one_face_only():
    mesh, faces = annulus()
    broken = mesh.copy()
    broken.next[mesh.face_halfedge[2]] = 999
    loops = face_loops(broken)
    assert len(loops) == len(faces) - 1
    # The half-edge still has its twin to say where it leads.
    np.testing.assert_array_equal(halfedge_heads(broken), mesh.origin[mesh.twin])


@pytest.mark.parametrize("size", [2_000])
def test_a_walk_through_one_endless_cycle_ends_soon(size):
    # Every face starts on the same cycle through all half-edges.
    ring = np.roll(np.arange(size), -1)
    zero = np.zeros(size, dtype=np.int64)
    mesh = HalfedgeMesh(ring, ring, ring, np.arange(size), zero, np.arange(size), np.arange(size))
    assert len(face_loops(mesh)) <= 2


def test_the_surface_may_come_from_the_faces_that_the_student_was_given():
    mesh, faces = annulus()
    broken = mesh.copy()
    broken.next[:] = -1
    made = view.halfedge_scene(broken, faces=faces)
    surface = made.panels[0].layers[0]
    assert len(surface.polygons[1]) == len(faces)
    assert "not drawn" not in made.alt
    broken.twin[0] = -1
    assert "1 lead to no vertex and are not drawn" in view.halfedge_scene(broken).alt
