"""Chapter 6's exercises ask for what the course map asks, on inputs that tell right from wrong."""

import time

import numpy as np
import pytest

from gpcourse.exercises import pictures
from gpcourse.exercises.judging import ask_here, judge
from gpcourse.exercises.smoothing import EXERCISES, inputs, truths
from gpcourse.geometry import shapes

SEEDS = range(8)
MADE = {"closed": inputs.closed, "bounded": inputs.bounded, "apart": inputs.apart, "patch": inputs.patch}


def draw(name, seed):
    shape = MADE[name](np.random.default_rng(seed))
    return shape, shape.vertices, inputs.faces_of(shape)


def test_the_exercises_of_the_chapter_in_the_order_of_the_notebook():
    assert [exercise.name for exercise in EXERCISES] == [
        "uniform_laplacian",
        "cotangent_matrix",
        "barycentric_areas",
        "voronoi_areas",
        "mixed_areas",
        "mass_matrix",
        "laplacian",
        "mean_curvature_normal",
        "discrete_mean_curvature",
        "angle_defect",
        "discrete_gaussian_curvature",
        "discrete_principal_curvatures",
        "mesh_quality",
        "solve_laplace",
        "solve_poisson",
        "heat_step",
        "eigenmodes",
        "spectral_coefficients",
        "spectral_reconstruction",
        "spectral_filter",
        "explicit_step",
        "stable_step",
        "implicit_step",
        "linear_diffusion",
        "mean_curvature_flow",
        "dirichlet_energy",
        "membrane_energy",
        "thin_plate_energy",
        "euler_lagrange_1d",
        "fair",
    ]


# The truths are formulas of their own, which must be right themselves.


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", MADE)
def test_cx_is_minus_the_gradient_of_the_area_by_finite_differences(name, seed):
    _, vertices, faces = draw(name, seed)
    rng = np.random.default_rng(seed)
    size = np.ptp(vertices, axis=0).max()
    x = (vertices - vertices.mean(axis=0)) / size
    way, h = rng.normal(size=x.shape), 1e-6
    change = (truths.face_areas(x + h * way, faces).sum() - truths.face_areas(x - h * way, faces).sum()) / (
        2 * h
    )
    assert (truths.area_gradient(x, faces) * way).sum() == pytest.approx(change, rel=1e-5, abs=1e-6)
    assert truths.stiffness(x, faces) @ x == pytest.approx(-truths.area_gradient(x, faces), abs=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", MADE)
def test_the_cells_fill_the_surface_and_the_angles_of_a_face_sum_to_pi(name, seed):
    _, vertices, faces = draw(name, seed)
    areas = truths.face_areas(vertices, faces)
    for corners in (truths.mixed_corners(vertices, faces), truths.circumcentric_corners(vertices, faces)):
        assert corners.sum(axis=1) == pytest.approx(areas, rel=1e-9)
    assert truths.angles(vertices, faces).sum(axis=1) == pytest.approx(np.pi, abs=1e-10)
    assert (truths.mixed_areas(vertices, faces) > 0).all()


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(("name", "chi"), [("closed", 0), ("bounded", -2), ("apart", -2), ("patch", 1)])
def test_the_defects_sum_to_the_euler_characteristic(name, chi, seed):
    _, vertices, faces = draw(name, seed)
    assert truths.defects(vertices, faces).sum() == pytest.approx(2 * np.pi * chi, abs=1e-10)


# The inputs tell right from wrong.


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", MADE)
def test_inputs_have_obtuse_angles_and_vertices_of_valence_3_and_stay_small(name, seed):
    shape, vertices, faces = draw(name, seed)
    rings = truths.neighbours(faces, len(vertices))
    inner = [len(ring) for ring, inside in zip(rings, inputs.inside(shape), strict=True) if inside]
    assert truths.obtuse_corners(vertices, faces).sum() >= 3
    assert min(inner) == 3
    assert len(vertices) <= 150


@pytest.mark.parametrize("seed", SEEDS)
def test_a_patch_is_flat_and_faces_up_and_its_boundary_is_known(seed):
    shape, vertices, faces = draw("patch", seed)
    e = truths.opposite_edges(vertices, faces)
    assert (truths.cross(e[:, 0], e[:, 1])[:, 2] > 0).all()
    assert truths.boundary_vertices(faces).tolist() == np.flatnonzero(~inputs.inside(shape)).tolist()


@pytest.mark.parametrize("seed", SEEDS)
def test_a_sphere_has_no_obtuse_angle_so_that_its_mean_curvature_is_exact(seed):
    ball = inputs.sphere(np.random.default_rng(seed), 3.0)
    faces = inputs.faces_of(ball)
    assert not truths.obtuse_corners(ball.vertices, faces).any()
    pull = truths.laplacian(ball.vertices, faces) @ ball.vertices
    assert (pull * ball.vertices).sum(axis=1) / 3 == pytest.approx(-2 / 3, rel=1e-10)


def test_an_icosphere_would_not_tell_absolute_cosines_from_right_ones():
    ball = shapes.icosphere(2)
    assert not truths.obtuse_corners(ball.vertices, inputs.faces_of(ball)).any()
    rough = inputs.closed(np.random.default_rng(0))
    assert truths.obtuse_corners(rough.vertices, inputs.faces_of(rough)).any()


# The checks are quick, and show what is wrong.


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda e: e.name)
def test_a_check_takes_less_than_150_ms_of_cpu(exercise):
    judge(exercise, ask_here(exercise.reference), 0)  # imports
    spent = []
    for seed in range(3):
        start = time.process_time()
        verdict = judge(exercise, ask_here(exercise.reference), seed)
        spent.append((time.process_time() - start) / len(verdict.results))
    # The smallest: others use the machine too.
    assert min(spent) < 0.15


def test_three_panels_mark_the_vertex_that_is_worst():
    ball = shapes.icosphere(1)
    truth = np.linspace(-1.0, 1.0, len(ball.vertices))
    yours = truth.copy()
    yours[[7, 20]] += 0.1, -0.4
    shown = pictures.Field(ball.vertices, ball.faces, "H")
    scene = shown.scene(yours, truth, (20,), True)
    assert [panel.title for panel in scene.panels] == ["yours", "expected", "difference, worst at vertex 20"]
    scales = scene.scales()
    assert scales[0] == scales[1]
    assert scales[2].high == pytest.approx(0.4)
    for panel in scene.panels:
        assert panel.layers[-1].positions == pytest.approx(ball.vertices[[20]])
        assert np.dot(panel.camera.direction, ball.vertices[20]) > 0
    own = shown.scene(yours, truth, (20,), False)
    assert [panel.title for panel in own.panels] == ["yours, worst at vertex 20"]
