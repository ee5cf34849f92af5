"""Exercises on what two scans have in common, and on several scans in one frame."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from gpcourse.exercises import expect
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Asked
from gpcourse.exercises.registration import pictures
from gpcourse.exercises.registration.inputs import (
    Motion,
    Rng,
    angle_between,
    brute_force,
    inverse,
    mask,
    motion,
    moved,
    random_motion,
    random_turn,
    turn,
)
from gpcourse.exercises.registration.rigid import best_motion
from gpcourse.geometry.arrays import BoolArray, FloatArray
from gpcourse.reference import registration as reference

# Overlap ----------------------------------------------------------------------------------------

OVERLAP_MASK = Exercise(
    reference.overlap_mask,
    notes="coursework 1, question 2",
    hints=[
        "Which of the two clouds has to be moved before you measure, and by what?",
        "For each moved point, how far is the nearest point of the target?",
    ],
    time_limit=6.0,  # the first call may import SciPy, on a busy machine
)

_Overlap = tuple[FloatArray, FloatArray, FloatArray, FloatArray, float]


def _overlapping(rng: Rng, scale: float) -> tuple[_Overlap, BoolArray]:
    """Return a source, a target, a pose and a distance; no point is close to the limit."""
    target = rng.uniform(-1, 1, size=(70, 3)) * [1, 1, 0.2]
    placed = rng.uniform(-1.5, 1.5, size=(90, 3)) * [1, 1, 0.3]
    limit = 0.3
    least = brute_force(target, placed).min(axis=1)
    clear = (least < 0.9 * limit) | (least > 1.1 * limit)
    placed, least = placed[clear], least[clear]
    # Near enough that clouds that are moved wrongly still overlap somewhere: each mistake marks other points.
    R, t = random_turn(rng, rng.uniform(0.7, 1.2)), 0.25 * random_turn(rng)[0]
    place = 0.5 * random_turn(rng)[0]
    placed, target = placed + place, target + place
    source = moved(placed, *inverse(R, t))
    return (scale * source, scale * target, R, scale * t, scale * limit), least < limit


@OVERLAP_MASK.check("points near the target, once they are moved, are marked", points=2)
def _(f: Asked, rng: Rng) -> None:
    cases = [(scale, *_overlapping(rng, scale)) for scale in (1.0, 100.0, 0.01)]
    answers = [f(*arguments) for _, arguments, _ in cases]
    for (scale, (source, *_, limit), truth), answer in zip(cases, answers, strict=True):
        on = f"{len(source)} points and 70 points of size {scale:g}, max_distance = {limit:g}"
        mine = mask(answer, len(source), on=on)
        expect.flags(mine, truth, ("in the overlap", "outside"), on=on, shown=pictures.Marks(source))


@OVERLAP_MASK.check("all of a scan overlaps with itself, and nothing with a scan far away")
def _(f: Asked, rng: Rng) -> None:
    target = rng.uniform(-1, 1, size=(40, 3))
    R, t = random_motion(rng, 2.0)
    source = moved(target, *inverse(R, t))
    itself = f(source, target, R, t, 0.01)
    nothing = f(source, target + 50.0, R, t, 0.5)
    on = "a scan and itself"
    names, shown = ("in the overlap", "outside"), pictures.Marks(source)
    expect.flags(mask(itself, 40, on=on), np.ones(40, dtype=bool), names, on=on, shown=shown)
    on = "two scans far from each other"
    expect.flags(mask(nothing, 40, on=on), np.zeros(40, dtype=bool), names, on=on, shown=shown)


@OVERLAP_MASK.variant("point by point, as 0 and 1")
def _(source: FloatArray, target: FloatArray, R: FloatArray, t: FloatArray, max_distance: float) -> Any:
    return [int(min(np.linalg.norm(target - (R @ x + t), axis=1)) <= max_distance) for x in source]


@OVERLAP_MASK.variant("the target moved back to the source")
def _(source: FloatArray, target: FloatArray, R: FloatArray, t: FloatArray, max_distance: float) -> Any:
    return (brute_force(moved(target, *inverse(R, t)), source) <= max_distance).any(axis=1)


def _near(placed: FloatArray, target: FloatArray, limit: float) -> BoolArray:
    near: BoolArray = brute_force(target, placed).min(axis=1) <= limit
    return near


@OVERLAP_MASK.mistake("the source was not moved", hint="What are R and t for?")
def _(source: FloatArray, target: FloatArray, R: FloatArray, t: FloatArray, max_distance: float) -> Any:
    return _near(source, target, max_distance)


@OVERLAP_MASK.mistake(
    "the source was moved by the inverse motion", hint="The pose takes the source to the target. Does yours?"
)
def _(source: FloatArray, target: FloatArray, R: FloatArray, t: FloatArray, max_distance: float) -> Any:
    return _near(moved(source, *inverse(R, t)), target, max_distance)


@OVERLAP_MASK.mistake(
    "rows of points were multiplied by R in place of its transpose",
    hint="R x is for a column x. Your points are rows: which product turns a row?",
)
def _(source: FloatArray, target: FloatArray, R: FloatArray, t: FloatArray, max_distance: float) -> Any:
    return _near(source @ R + t, target, max_distance)


@OVERLAP_MASK.mistake("the translation was added before the rotation", hint="In R x + t, what is done first?")
def _(source: FloatArray, target: FloatArray, R: FloatArray, t: FloatArray, max_distance: float) -> Any:
    return _near((source + t) @ R.T, target, max_distance)


@OVERLAP_MASK.mistake(
    "the points outside the overlap are marked", hint="What does True mean in the docstring?"
)
def _(source: FloatArray, target: FloatArray, R: FloatArray, t: FloatArray, max_distance: float) -> Any:
    return ~_near(moved(source, R, t), target, max_distance)


@OVERLAP_MASK.mistake(
    "the squared distance was compared with max_distance",
    hint="Try the same scans at scale 100 and 0.01: should another part of them overlap?",
)
def _(source: FloatArray, target: FloatArray, R: FloatArray, t: FloatArray, max_distance: float) -> Any:
    return brute_force(target, moved(source, R, t)).min(axis=1) ** 2 <= max_distance


@OVERLAP_MASK.mistake(
    "the points of the target are marked, not those of the source",
    hint="How many points has the source, and how many entries has your mask?",
)
def _(source: FloatArray, target: FloatArray, R: FloatArray, t: FloatArray, max_distance: float) -> Any:
    return _near(target, moved(source, R, t), max_distance)


# Several scans ----------------------------------------------------------------------------------


def _as_poses(arguments: tuple[Any, ...], value: Any) -> FloatArray:
    """Canonical form: the poses to about 1e-6; the large last number sets the scale of the comparison."""
    numbers = [np.asarray(part, dtype=float).ravel() for pose in value for part in pose]
    return np.concatenate([*numbers, [100.0]])


ALIGN_SCANS = Exercise(
    reference.align_scans,
    notes="coursework 1, question 5",
    hints=[
        "One scan has to stay, or all of them may drift away together. Which one does the docstring keep?",
        "If each scan is aligned with the one before it only, where does the error of five pairs show?",
        "Put all scans but one where they are by now: together they are one target for the one left.",
        "Going through the scans once is not enough: when one has moved, its neighbours have a new target.",
    ],
    canonical=_as_poses,
    time_limit=6.0,
)


def _lantern(rng: Rng, n: int) -> tuple[FloatArray, FloatArray]:
    """Return points of a bumpy closed surface that one walks around, and the angle of each."""
    # Golden-angle spiral: evenly spread, and no two heights alike.
    i = np.arange(n)
    phi = np.asarray((i * 2.399963) % (2 * np.pi), dtype=np.float64)
    z = (2 * i + 1) / n - 1
    a, b, c = rng.uniform(0, 2 * np.pi, size=3)
    r = 1 + 0.15 * np.sin(2 * phi + a + 2 * z) + 0.12 * np.sin(3 * phi + b) * np.cos(2 * z + c)
    return np.column_stack([r * np.cos(phi), r * np.sin(phi), 0.8 * z]), phi


def _walk_around(
    rng: Rng, stretch: float, noise: float
) -> tuple[list[FloatArray], list[Motion], list[Motion]]:
    """Return four scans of half a lantern each, their true poses, and rough ones; the first pose is exact.

    Every point is in two scans. With a `stretch` each scan is bent open by that part of its angle, so that
    a chain of pairs does not close: what each pair adds in turn is a quarter of the angle times `stretch`.
    """
    points, phi = _lantern(rng, 120)
    start = rng.uniform(0, 2 * np.pi)
    frame = random_motion(rng, 1.0)
    scans, poses, rough = [], [], []
    for k in range(4):
        middle = start + k * np.pi / 2
        seen = np.angle(np.exp(1j * (phi - middle)))
        half = np.abs(seen) < np.pi / 2
        bent = np.array(
            [
                turn(np.array([0.0, 0.0, 1.0]), stretch * a) @ x
                for a, x in zip(seen[half], points[half], strict=True)
            ]
        )
        pose = random_motion(rng, 1.0)
        world = moved(bent, *frame)
        scans.append(moved(world, *inverse(*pose)) + noise * rng.normal(size=world.shape))
        poses.append(pose)
        R, t = random_turn(rng, 0.05), 0.03 * rng.normal(size=3)
        centre = world.mean(axis=0)
        off = (R, t + centre - R @ centre) if k else (np.eye(3), np.zeros(3))
        rough.append((off[0] @ pose[0], off[0] @ pose[1] + off[1]))
    return scans, poses, rough


def _poses(value: object, n: int, on: str) -> list[Motion]:
    if value is None:
        raise expect.Wrong("The result is None: is a `return` missing?", on=on)
    if not isinstance(value, (list, tuple)) or len(value) != n:
        raise expect.Wrong(
            f"The result should be a list of {n} poses (R, t).", yours=expect.brief(value), on=on
        )
    return [motion(pose, on=f"{on}; pose {i}") for i, pose in enumerate(value)]


def _expect_poses(
    mine: Sequence[Motion],
    want: Sequence[Motion],
    scans: Sequence[FloatArray],
    *,
    angle: float,
    distance: float,
    on: str,
) -> None:
    kept = "The first pose should be the one that was given: it fixes the frame."
    same = np.allclose(mine[0][0], want[0][0], rtol=0, atol=1e-6) and np.allclose(
        mine[0][1], want[0][1], atol=1e-6
    )
    expect.that(same, kept, on=on)
    for i, (a, b, scan) in enumerate(zip(mine, want, scans, strict=True)):
        off = angle_between(a[0], b[0])
        shift = float(np.linalg.norm(moved(scan, *a) - moved(scan, *b), axis=1).max())
        if not (off <= angle and shift <= distance):
            raise expect.Wrong(
                f"The pose of scan {i} is not right.",
                yours=f"{np.degrees(off):.3g}° and {shift:.3g} off",
                truth=f"within {np.degrees(angle):.2g}° and {distance:.2g}",
                on=on,
                **pictures.of_scans(scans, mine, want, i),
            )


@ALIGN_SCANS.check("exact scans come to their known poses", points=2)
def _(f: Asked, rng: Rng) -> None:
    scans, poses, rough = _walk_around(rng, 0.0, 0.0)
    value = f(scans, rough, None, 0.35, 10)
    on = "four scans around an object, turned by 3° and moved by 0.05"
    mine = _poses(value, 4, on)
    # Scans that pull at each other come round slowly: measured over 40 walks, 0.013 is left of 0.05.
    _expect_poses(mine, poses, scans, angle=0.025, distance=0.04, on=on)


@ALIGN_SCANS.check("noise on all scans")
def _(f: Asked, rng: Rng) -> None:
    scans, poses, rough = _walk_around(rng, 0.0, 0.004)
    value = f(scans, rough, None, 0.35, 6)
    on = "four scans around an object, with noise of 0.004"
    mine = _poses(value, 4, on)
    # 80 pairs with noise 0.004 √2 fix a turn to about 0.001; most is what is left of the start.
    _expect_poses(mine, poses, scans, angle=0.035, distance=0.07, on=on)


@ALIGN_SCANS.check("nothing drifts where the way around the object closes", points=2)
def _(f: Asked, rng: Rng) -> None:
    scans, poses, rough = _walk_around(rng, 0.025, 0.0)
    value = f(scans, rough, None, 0.35, 10)
    on = "four scans, each bent open a little, so that no chain of pairs closes"
    mine = _poses(value, 4, on)
    # Pair by pair the error would grow by 90° · 0.025 = 2.2° a step, to 6.7° at the last scan.
    _expect_poses(mine, poses, scans, angle=DRIFT, distance=2 * DRIFT, on=on)


#: Radians. Bent scans are off by 0.03 at most when the error is shared; the last of a chain by 0.11 or more.
DRIFT = 0.05


# Solutions --------------------------------------------------------------------------------------


def _step(mine: FloatArray, target: FloatArray, max_distance: float) -> Motion:
    """Return one ICP step of placed points onto a target."""
    index = ((target**2).sum(axis=1) - 2 * mine @ target.T).argmin(axis=1)
    near = np.linalg.norm(mine - target[index], axis=1) <= max_distance
    if np.count_nonzero(near) < 3:
        raise ValueError("a scan meets no other")
    return best_motion(target[index[near]], mine[near])


def _after(pose: Motion, step: Motion) -> Motion:
    return step[0] @ pose[0], step[0] @ pose[1] + step[1]


def _others(scans: Sequence[FloatArray], poses: Sequence[Motion], i: int) -> FloatArray:
    return np.concatenate([moved(scans[j], *poses[j]) for j in range(len(scans)) if j != i])


def _in_turn(
    scans: Sequence[FloatArray],
    poses: Sequence[Motion],
    max_distance: float,
    rounds: int,
    target: Callable[[Sequence[FloatArray], Sequence[Motion], int], FloatArray] = _others,
    after: Callable[[Motion, Motion], Motion] = _after,
    order: Sequence[int] | None = None,
) -> list[Motion]:
    placed = [(np.asarray(R), np.asarray(t)) for R, t in poses]
    for _ in range(rounds):
        for i in order or range(1, len(scans)):
            step = _step(moved(scans[i], *placed[i]), target(scans, placed, i), max_distance)
            placed[i] = after(placed[i], step)
    return placed


@ALIGN_SCANS.variant("in turn, from the last scan to the second")
def _(
    scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, max_iterations: int = 20
) -> Any:
    return _in_turn(scans, poses, max_distance, max_iterations, order=range(len(scans) - 1, 0, -1))


@ALIGN_SCANS.variant("pairs with each other scan by itself, lists")
def _(
    scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, max_iterations: int = 20
) -> Any:
    placed = [(np.asarray(R), np.asarray(t)) for R, t in poses]
    for _ in range(max_iterations):
        for i in range(1, len(scans)):
            mine = moved(scans[i], *placed[i])
            p, q = [], []
            for j in range(len(scans)):
                if j != i:
                    other = moved(scans[j], *placed[j])
                    partner = other[((other**2).sum(axis=1) - 2 * mine @ other.T).argmin(axis=1)]
                    near = np.linalg.norm(mine - partner, axis=1) <= max_distance / 2
                    p.append(partner[near])
                    q.append(mine[near])
            placed[i] = _after(placed[i], best_motion(np.concatenate(p), np.concatenate(q)))
    return [[R.tolist(), t.tolist()] for R, t in placed]


def _solved(scans: Any, poses: Any, max_distance: float, rounds: int) -> list[Motion]:
    return _in_turn(scans, poses, max_distance, rounds)


@ALIGN_SCANS.mistake(
    "each scan was aligned with the one before it only",
    hint="Add up the errors of the pairs on the way around. Where do they meet the first scan?",
)
def _(
    scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, max_iterations: int = 20
) -> Any:
    def before(scans: Sequence[FloatArray], placed: Sequence[Motion], i: int) -> FloatArray:
        return moved(scans[i - 1], *placed[i - 1])

    # One scan is finished before the next one begins; what is out of reach on its own is left out.
    placed = list(poses)
    for i in range(1, len(scans)):
        placed = _in_turn(scans, placed, max_distance / 2, max_iterations, before, order=[i])
    return placed


@ALIGN_SCANS.mistake(
    "every scan was aligned with the first one only",
    hint="What do the scans of the front and of the back have in common?",
)
def _(
    scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, max_iterations: int = 20
) -> Any:
    def first(scans: Sequence[FloatArray], placed: Sequence[Motion], i: int) -> FloatArray:
        return moved(scans[0], *placed[0])

    placed = list(poses)
    try:
        placed = _in_turn(scans, placed, max_distance, max_iterations, first)
    except ValueError:
        placed = _in_turn(scans, placed, np.inf, max_iterations, first)
    return placed


@ALIGN_SCANS.mistake(
    "the poses take the common frame to the scans, not the scans to the common frame",
    hint="Move the points of scan 1 with your pose: do they land on those of scan 0?",
)
def _(
    scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, max_iterations: int = 20
) -> Any:
    return [inverse(*pose) for pose in _solved(scans, poses, max_distance, max_iterations)]


@ALIGN_SCANS.mistake(
    "the corrections were returned without the rough poses",
    hint="A correction acts on points that the rough pose has moved already. Which motion takes both?",
)
def _(
    scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, max_iterations: int = 20
) -> Any:
    found = _solved(scans, poses, max_distance, max_iterations)
    return [_after(inverse(*rough), pose) for rough, pose in zip(poses, found, strict=True)]


@ALIGN_SCANS.mistake(
    "the frame of the first scan was taken in place of the one its pose gives",
    hint="Which pose did the docstring promise for the first scan?",
)
def _(
    scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, max_iterations: int = 20
) -> Any:
    found = _solved(scans, poses, max_distance, max_iterations)
    return [_after(pose, inverse(*found[0])) for pose in found]


@ALIGN_SCANS.mistake(
    "the rough poses were returned as they came",
    hint="How far are the points of one scan from those of its neighbours before and after your function?",
)
def _(
    scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, max_iterations: int = 20
) -> Any:
    return list(poses)


@ALIGN_SCANS.mistake(
    "the steps were multiplied in the wrong order",
    hint="Write R₂(R₁x + t₁) + t₂ without brackets. Which rotation stands on the left?",
)
def _(
    scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, max_iterations: int = 20
) -> Any:
    def wrong(pose: Motion, step: Motion) -> Motion:
        return pose[0] @ step[0], pose[0] @ step[1] + pose[1]

    try:
        return _in_turn(scans, poses, max_distance, max_iterations, after=wrong)
    except ValueError:
        return list(poses)
