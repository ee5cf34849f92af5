"""Chapter 2's exercises ask for what the course map asks, and their inputs are what they claim to be."""

import numpy as np
import pytest

from gpcourse.exercises.judging import ask_here, judge
from gpcourse.exercises.registration import EXERCISES, icp, inputs, pictures, rigid, sampling, several

BY_NAME = {exercise.name: exercise for exercise in EXERCISES}


def test_the_exercises_of_the_chapter_in_the_order_of_the_notebook():
    assert [exercise.name for exercise in EXERCISES] == [
        "rigid_transform",
        "nearest_neighbours",
        "reject_pairs",
        "trim_pairs",
        "reject_boundary_pairs",
        "point_to_plane_step",
        "icp",
        "overlap_mask",
        "random_sampling",
        "uniform_sampling",
        "normal_space_sampling",
        "slippage_analysis",
        "stable_sampling",
        "align_scans",
    ]


@pytest.mark.parametrize("seed", range(5))
def test_turns_are_rotations_by_the_angle_that_is_asked_for(seed):
    rng = np.random.default_rng(seed)
    axis, angle = rng.normal(size=3), rng.uniform(0.1, 3)
    R = inputs.turn(axis, angle)
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(R @ axis, axis, atol=1e-14)
    assert np.linalg.det(R) == pytest.approx(1)
    assert inputs.angle_between(np.eye(3), R) == pytest.approx(angle)
    # Counter-clockwise seen against the axis.
    assert rigid.angle_of(R, axis) == pytest.approx(angle)


def test_a_small_angle_keeps_its_digits():
    assert inputs.angle_between(np.eye(3), inputs.turn(np.array([1.0, 2, 3]), 1e-9)) == pytest.approx(1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_the_mirrored_cloud_is_fitted_best_by_a_reflection(seed):
    p, q, (R, t) = rigid._mirrored(np.random.default_rng(seed))
    U, _, Vt = np.linalg.svd((q - q.mean(axis=0)).T @ (p - p.mean(axis=0)))
    assert np.linalg.det(Vt.T @ U.T) == pytest.approx(-1)
    # And what is left with the known motion is twice the height over the plane, everywhere.
    left = np.linalg.norm(p - inputs.moved(q, R, t), axis=1)
    assert left.max() < 0.25 * np.ptp(q, axis=0).max()


@pytest.mark.parametrize("seed", range(3))
def test_surfaces_slip_in_as_many_motions_as_they_are_said_to(seed):
    for name, count, surface in sampling._known_surfaces(np.random.default_rng(seed)):
        np.testing.assert_allclose(np.linalg.norm(surface.normals, axis=1), 1, atol=1e-12)
        speeds = sampling._speeds(surface, np.eye(6))
        assert 6 - np.linalg.matrix_rank(speeds, tol=1e-6) == count, name


@pytest.mark.parametrize("seed", range(3))
def test_every_point_of_the_walk_around_is_in_two_scans(seed):
    scans, poses, rough = several._walk_around(np.random.default_rng(seed), 0.0, 0.0)
    placed = np.concatenate([inputs.moved(x, *pose) for x, pose in zip(scans, poses, strict=True)])
    _, times = np.unique(placed.round(9), axis=0, return_counts=True)
    assert (times == 2).all()
    off = [inputs.angle_between(a[0], b[0]) for a, b in zip(poses, rough, strict=True)]
    np.testing.assert_allclose(off, [0, *3 * [several.START]], atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_what_belongs_together_is_within_reach_on_the_walk_around(seed):
    scans, poses, rough = several._walk_around(np.random.default_rng(seed), 0.0, 0.0)
    placed, begun = (
        np.concatenate([inputs.moved(x, *pose) for x, pose in zip(scans, some, strict=True)])
        for some in (poses, rough)
    )
    pairs = np.argsort(placed.round(9)[:, 2], kind="stable").reshape(-1, 2)  # no two heights are alike
    assert np.linalg.norm(placed[pairs[:, 0]] - placed[pairs[:, 1]], axis=1).max() < 1e-9
    assert np.linalg.norm(begun[pairs[:, 0]] - begun[pairs[:, 1]], axis=1).max() < several.REACH


def _panels(name, solution):
    verdict = judge(BY_NAME[name], ask_here(solution), 0)
    wrong = verdict.first_problem.wrong
    assert wrong is not None
    assert wrong.picture is not None, wrong.message
    return wrong.picture().panels


@pytest.mark.parametrize(
    ("name", "mistake", "panels"),
    [
        ("rigid_transform", "t is p̄ − q̄", 3),
        ("nearest_neighbours", "only the query's own side", 1),
        ("point_to_plane_step", "the cross product is reversed", 3),
        ("icp", "the last step was returned", 3),
        ("uniform_sampling", "the distances to the chosen points were added up", 1),
        ("overlap_mask", "the source was not moved", 3),
        ("stable_sampling", "the points were spread evenly", 1),
        ("align_scans", "the rough poses were returned", 2),
    ],
)
def test_a_failure_shows_the_clouds(name, mistake, panels):
    (function,) = [m.function for m in BY_NAME[name].mistakes if m.name.startswith(mistake)]
    assert len(_panels(name, function)) == panels


def test_a_neighbour_that_does_not_exist_is_left_out_of_the_picture():
    scenes = pictures.of_neighbour(np.zeros((3, 3)), np.ones(3), 99, 1)
    assert [len(scenes[kind]().panels[0].layers[2].lines) for kind in ("picture", "handout")] == [1, 0]


def test_an_icp_that_aligns_the_points_but_returns_the_last_step_fails_on_the_pose():
    icp = BY_NAME["icp"]
    (last,) = [m for m in icp.mistakes if m.name.startswith("the last step")]
    verdict = judge(icp, ask_here(last.function), 3)
    assert "pose" in str(verdict.first_problem.wrong)
    assert verdict.mistakes == (last,)


def test_single_precision_is_near_enough_for_a_sample_and_a_mask_but_not_for_a_known_motion():
    def rough(p, q, weights=None):
        R, t = BY_NAME["rigid_transform"].reference(p, q, weights)
        return R.astype(np.float32), t.astype(np.float32)

    verdict = judge(BY_NAME["rigid_transform"], ask_here(rough), 0)
    claims = {r.check.claim: r.outcome for r in verdict.results}
    assert claims["a known motion is found, to 1e-12"] == "failed"
    assert claims["no other motion fits noisy pairs better"] == "passed"


@pytest.mark.parametrize("motion", range(6))
def test_a_sample_that_holds_one_motion_only_is_not_stable(motion):
    def stable_sampling(points, normals, k):
        return np.argsort(-sampling._holds(points, normals)[:, motion], kind="stable")[:k]

    assert [
        judge(BY_NAME["stable_sampling"], ask_here(stable_sampling), s).outcome for s in range(3)
    ] == 3 * ["failed"]


class _TrimmedOnce(icp._Loop):
    def kept(self, distances, keep, max_distance):
        if self.first is None:
            self.first = distances <= np.quantile(distances, keep)
        return self.first & (distances <= max_distance)


class _LimitedOnce(icp._Loop):
    def kept(self, distances, keep, max_distance):
        if self.first is None:
            self.first = distances <= max_distance
        return self.first & (distances <= np.quantile(distances, keep))


@pytest.mark.parametrize("loop", [_TrimmedOnce, _LimitedOnce])
def test_an_icp_that_applies_one_rule_in_its_first_iteration_only_fails(loop):
    def solution(*arguments):
        return loop()(*arguments)

    assert [judge(BY_NAME["icp"], ask_here(solution), s).outcome for s in range(2)] == ["failed", "failed"]
