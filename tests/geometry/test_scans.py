"""The virtual scanner: what it sees, what it misses, and where it says that this is."""

import numpy as np
import pytest

from gpcourse.errors import GeometryError
from gpcourse.geometry import shapes
from gpcourse.geometry.scans import pebble, scan, turntable
from gpcourse.geometry.triangles import face_normals

DIRECTIONS = [(0, 0, 1), (1, 0, 0), (1, -2, 0.5), (-0.3, 0.2, -1)]


@pytest.mark.parametrize("towards", DIRECTIONS)
def test_a_sphere_is_seen_from_one_side_up_to_the_grazing_angle(towards):
    sphere = shapes.icosphere(5, radius=2).moved((5, -3, 1))
    seen = scan(sphere, towards, pixels=90, max_angle=60)
    outward = (seen.placed - [5, -3, 1]) / 2
    # A chord of the mesh lies at most h²/8R inside; edges are below 0.075.
    assert np.abs(np.linalg.norm(outward, axis=1) - 1).max() < 1e-3
    cosine = outward @ (np.array(towards) / np.linalg.norm(towards))
    assert cosine.min() == pytest.approx(np.cos(np.radians(60)), abs=0.03)
    assert np.abs(seen.normals @ seen.R.T - outward).max() < 0.01
    # From a distance, the visible cap is a disc of radius R sin 60° on the grid.
    pitch = np.linalg.norm(np.ptp(sphere.vertices, axis=0)) / 89
    assert len(seen.points) * pitch**2 == pytest.approx(np.pi * 4 * 0.75, rel=0.03)


@pytest.mark.parametrize("towards", DIRECTIONS)
def test_the_pose_is_a_rotation_that_looks_along_the_direction(towards):
    seen = scan(pebble(3), towards)
    assert np.abs(seen.R.T @ seen.R - np.eye(3)).max() < 1e-14
    assert np.linalg.det(seen.R) == pytest.approx(1)
    assert seen.R[:, 2] == pytest.approx(np.array(towards) / np.linalg.norm(towards))


def test_what_is_hidden_is_missing():
    near, far = shapes.icosphere(3, radius=0.5).moved((0, 0, 5)), shapes.icosphere(3)
    both = shapes.union(near, far)
    both = shapes.Shape("both", np.vstack([near.vertices, far.vertices]), both.faces)
    seen = scan(both, (0, 0, 1), pixels=120)
    low = seen.placed[seen.placed[:, 2] < 3]
    across = np.linalg.norm(low[:, :2], axis=1)
    # The small ball hides the middle of the large one, and only that.
    assert across.min() > 0.47
    assert across.min() < 0.55


def test_faces_look_at_the_scanner_and_do_not_span_the_gap():
    seen = scan(pebble(5), (-1, -1, 0.3), pixels=80)
    assert (face_normals(seen.points, seen.faces)[:, 2] > 0).all()
    edges = seen.points[seen.faces] - seen.points[np.roll(seen.faces, 1, axis=1)]
    pitch = np.linalg.norm(np.ptp(pebble(5).vertices, axis=0)) / 79
    assert np.linalg.norm(edges, axis=2).max() <= 4 * pitch * (1 + 1e-9)
    assert 0.02 < seen.on_boundary.mean() < 0.3


def test_the_boundary_of_a_flat_scan_is_its_rim():
    seen = scan(shapes.disc(6), (0, 0, 1), pixels=50)
    across = np.linalg.norm(seen.points[:, :2], axis=1)
    assert across[seen.on_boundary].min() > 0.9 * across.max()
    assert not seen.on_boundary[across < 0.8 * across.max()].any()


def test_noise_is_along_the_ray_and_of_the_size_that_was_asked_for():
    shape = pebble(4)
    quiet, noisy = scan(shape, pixels=100), scan(shape, pixels=100, noise=0.01, rng=3)
    error = noisy.points - quiet.points
    assert np.abs(error[:, :2]).max() == 0
    diagonal = np.linalg.norm(np.ptp(shape.vertices, axis=0))
    n = len(error)
    assert error[:, 2].std() == pytest.approx(0.01 * diagonal, rel=5 / np.sqrt(2 * n))


def test_outliers_are_flagged_and_belong_to_no_face():
    clean, seen = scan(pebble(4), pixels=100), scan(pebble(4), pixels=100, outliers=0.1, rng=1)
    assert seen.outlier.mean() == pytest.approx(0.1, abs=0.03)
    assert not seen.outlier[seen.faces].any()
    assert seen.on_boundary[seen.outlier].all()
    same = np.abs(seen.points - clean.points).max(axis=1) == 0
    assert (same == ~seen.outlier).all()


def test_a_seed_gives_the_same_scan_and_a_turntable_other_noise_each_time():
    first, second = turntable(pebble(3), (0, 0), noise=0.01, rng=5)
    again, _ = turntable(pebble(3), (0, 0), noise=0.01, rng=5)
    assert np.array_equal(first.points, again.points)
    assert not np.array_equal(first.points, second.points)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"noise": -1}, "noise"),
        ({"outliers": 1}, "outliers"),
        ({"max_angle": 90}, "max_angle"),
        ({"pixels": 1}, "pixels"),
        ({"towards": (0, 0, 0)}, "length of towards"),
        ({"rng": "x"}, "rng"),
    ],
)
def test_bad_options_are_refused_by_name(options, message):
    with pytest.raises(GeometryError, match=message):
        scan(pebble(1), **options)


def test_a_scanner_that_sees_nothing_says_so():
    with pytest.raises(GeometryError, match="nothing of disc is seen"):
        scan(shapes.disc(2), (0, 0, -1))
