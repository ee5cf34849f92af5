"""Exercises on what two scans have in common, and on several scans in one frame."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import numpy as np

from gpcourse.exercises import expect
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Asked
from gpcourse.exercises.registration import pictures
from gpcourse.exercises.registration.inputs import (
    Motion,
    Rng,
    Surface,
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
from gpcourse.exercises.registration.rigid import best_motion, plane_motion
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
    for (scale, (source, *_, limit), truth), answer in zip(cases, f.each(answers), strict=True):
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
    f.about, on = 0, "a scan and itself"
    names, shown = ("in the overlap", "outside"), pictures.Marks(source)
    expect.flags(mask(itself, 40, on=on), np.ones(40, dtype=bool), names, on=on, shown=shown)
    f.about, on = 1, "two scans far from each other"
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


@OVERLAP_MASK.mistake(
    "the translation was left out", hint="In R x + t, what happens to the origin? And in your code?"
)
def _(source: FloatArray, target: FloatArray, R: FloatArray, t: FloatArray, max_distance: float) -> Any:
    return _near(source @ R.T, target, max_distance)


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


def _after(pose: Motion, step: Motion) -> Motion:
    return step[0] @ pose[0], step[0] @ pose[1] + step[1]


def _lantern(rng: Rng, n: int) -> tuple[FloatArray, FloatArray]:
    """Return points of a bumpy closed surface that one walks around, and the angle of each."""
    # Golden-angle spiral: evenly spread, and no two heights alike.
    i = np.arange(n)
    phi = np.asarray((i * 2.399963) % (2 * np.pi), dtype=np.float64)
    z = (2 * i + 1) / n - 1
    a, b, c = rng.uniform(0, 2 * np.pi, size=3)
    r = 1 + 0.15 * np.sin(2 * phi + a + 2 * z) + 0.12 * np.sin(3 * phi + b) * np.cos(2 * z + c)
    return np.column_stack([r * np.cos(phi), r * np.sin(phi), 0.8 * z]), phi


#: The rough poses are turned by this angle and moved by this distance: no point is further off than about
#: twice that. So points of two scans that belong together are within four times that, and within REACH.
START = 0.04
REACH = 0.18


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
        R, t = random_turn(rng, START), START * random_turn(rng)[0]
        centre = world.mean(axis=0)
        off = (R, t + centre - R @ centre) if k else (np.eye(3), np.zeros(3))
        rough.append((off[0] @ pose[0], off[0] @ pose[1] + off[1]))
    return scans, poses, rough


def _with_outliers(rng: Rng, scans: Sequence[FloatArray], poses: Sequence[Motion]) -> list[FloatArray]:
    """Add to each scan six points far out on its own side, where no other scan has any."""
    centre = np.mean([moved(x, *pose).mean(axis=0) for x, pose in zip(scans, poses, strict=True)], axis=0)
    wild = []
    for x, (R, t) in zip(scans, poses, strict=True):
        outwards = x.mean(axis=0) - (centre - t) @ R
        far = rng.uniform(2.0, 3.0, size=(6, 1)) * outwards / np.linalg.norm(outwards)
        wild.append(np.concatenate([x, x[rng.choice(len(x), 6, replace=False)] + far]))
    return wild


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
    value = f(scans, rough, None, REACH, 14)
    on = f"four scans around an object, turned by {np.degrees(START):.1f}° and moved by {START}"
    mine = _poses(value, 4, on)
    # Scans that pull at each other come round slowly: over 120 walks, at most a sixth of the start is left if
    # they move in turn, two fifths if all move at the same time.
    _expect_poses(mine, poses, scans, angle=0.6 * START, distance=1.2 * START, on=on)


@ALIGN_SCANS.check("noise on all scans, and outliers beyond max_distance")
def _(f: Asked, rng: Rng) -> None:
    scans, poses, rough = _walk_around(rng, 0.0, 0.004)
    value = f(_with_outliers(rng, scans, poses), rough, None, REACH, 10)
    on = f"four scans around an object, with noise of 0.004, 6 outliers in each, and max_distance = {REACH}"
    mine = _poses(value, 4, on)
    # 80 pairs with noise 0.004 √2 fix a turn to about 0.001; most is what is left of the start, half at most.
    _expect_poses(mine, poses, scans, angle=0.7 * START, distance=1.4 * START, on=on)


@ALIGN_SCANS.check("nothing drifts where the way around the object closes", points=2)
def _(f: Asked, rng: Rng) -> None:
    scans, poses, rough = _walk_around(rng, 0.025, 0.0)
    value = f(scans, rough, None, REACH, 10)
    on = "four scans, each bent open a little, so that no chain of pairs closes"
    mine = _poses(value, 4, on)
    # Pair by pair the error would grow by 90° · 0.025 = 2.2° a step, to 6.7° at the last scan.
    _expect_poses(mine, poses, scans, angle=DRIFT, distance=2 * DRIFT, on=on)


def _plate(rng: Rng, missing: tuple[int, int]) -> Surface:
    """Return points on a thin plate with outward normals, but for the side (axis, sign) that is missing."""
    half = np.array([1.0, 0.7, 0.075])
    points, normals = [], []
    for axis, sign in product(range(3), (-1, 1)):
        if (axis, sign) != missing:
            side = rng.uniform(-0.92, 0.92, size=(30 if axis == 2 else 15, 3)) * half
            side[:, axis] = sign * half[axis]
            points.append(side)
            normals.append(np.tile(sign * np.eye(3)[axis], (len(side), 1)))
    return Surface(np.concatenate(points), np.concatenate(normals))


def _around_a_plate(rng: Rng) -> tuple[list[Surface], list[Motion], list[Motion]]:
    """Return three scans of a plate, each at points of its own, their poses, and rough ones."""
    frame = random_motion(rng, 1.0)
    scans, poses, rough = [], [], []
    for k, missing in enumerate(((2, -1), (2, 1), (0, 1))):
        pose = random_motion(rng, 1.0)
        scans.append(_plate(rng, missing).moved(*frame).moved(*inverse(*pose)))
        poses.append(pose)
        R, t = random_turn(rng, 0.04), 0.02 * rng.normal(size=3)
        off = (R, t + frame[1] - R @ frame[1]) if k else (np.eye(3), np.zeros(3))
        rough.append(_after(pose, off))
    return scans, poses, rough


@ALIGN_SCANS.check("with normals: other points on the sides of a thin plate", points=2)
def _(f: Asked, rng: Rng) -> None:
    scans, poses, rough = _around_a_plate(rng)
    points, normals = [scan.points for scan in scans], [scan.normals for scan in scans]
    value = f(points, rough, normals, 0.3, 30)
    on = "three scans of a plate 0.15 thick, with normals and max_distance = 0.3"
    mine = _poses(value, 3, on)
    # Over 240 plates, scans that move at the same time, each towards where the others were, are off by 0.0056
    # and 0.0065 at most, scan after scan by less, and all motions found at once by 1e-10. Without the planes
    # it is 0.027 in place at least; with the back drawn to the front, 0.08.
    _expect_poses(mine, poses, points, angle=0.012, distance=0.014, on=on)


#: Radians. Bent scans are off by 0.03 at most when the error is shared; the last of a chain by 0.11 or more.
DRIFT = 0.05


# Solutions --------------------------------------------------------------------------------------


def _surfaces(scans: Sequence[FloatArray], normals: Sequence[FloatArray] | None) -> list[Surface]:
    """Join scans and normals; without normals all of them are zero, and no pair faces away."""
    return [
        Surface(np.asarray(x), np.zeros_like(x) if normals is None else np.asarray(normals[i]))
        for i, x in enumerate(scans)
    ]


def _joined(surfaces: Sequence[Surface]) -> Surface:
    return Surface(
        np.concatenate([s.points for s in surfaces]), np.concatenate([s.normals for s in surfaces])
    )


class _InTurn:
    """One scan after the other; the places where students go wrong are left open."""

    def target(self, scans: Sequence[Surface], placed: Sequence[Motion], i: int) -> Surface:
        """Return what scan i is matched with."""
        return _joined([scans[j].moved(*placed[j]) for j in range(len(scans)) if j != i])

    def placed(self, scan: Surface, pose: Motion) -> Surface:
        return scan.moved(*pose)

    def facing(self, mine: FloatArray, theirs: FloatArray) -> Any:
        return np.einsum("ij,ij->i", mine, theirs) >= np.cos(np.pi / 4)

    def minimise(self, p: FloatArray, q: FloatArray, n: FloatArray) -> Motion:
        return plane_motion(p, q, n)

    def after(self, pose: Motion, step: Motion) -> Motion:
        return _after(pose, step)

    def order(self, n: int, rounds: int) -> Sequence[int]:
        return [*range(1, n)] * rounds

    def reach(self, max_distance: float) -> float:
        return max_distance

    def result(self, rough: Sequence[Motion], placed: list[Motion]) -> Any:
        return placed

    def step(self, mine: Surface, target: Surface, max_distance: float) -> Motion:
        index = ((target.points**2).sum(axis=1) - 2 * mine.points @ target.points.T).argmin(axis=1)
        p, q, n = target.points[index], mine.points, target.normals[index]
        kept = np.linalg.norm(q - p, axis=1) <= max_distance
        if n.any():
            kept &= self.facing(mine.normals, n)
        if np.count_nonzero(kept) < 3:
            raise ValueError("a scan meets no other")
        if not n.any():
            return best_motion(p[kept], q[kept])
        return self.minimise(p[kept], q[kept], n[kept])

    def __call__(
        self, scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, rounds: int = 20
    ) -> Any:
        surfaces = _surfaces(scans, normals)
        placed = [(np.asarray(R), np.asarray(t)) for R, t in poses]
        for i in self.order(len(scans), rounds):
            target = self.target(surfaces, placed, i)
            step = self.step(self.placed(surfaces[i], placed[i]), target, self.reach(max_distance))
            placed[i] = self.after(placed[i], step)
        return self.result(poses, placed)


def _declare(solution: type[_InTurn]) -> Callable[..., Any]:
    solve = solution()

    def align_scans(
        scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, max_iterations: int = 20
    ) -> Any:
        return solve(scans, poses, normals, max_distance, max_iterations)

    return align_scans


class _Backwards(_InTurn):
    def order(self, n: int, rounds: int) -> Sequence[int]:
        return [*range(n - 1, 0, -1)] * rounds


class _EachByItself(_InTurn):
    """Pairs with each other scan by itself."""

    def target(self, scans: Sequence[Surface], placed: Sequence[Motion], i: int) -> Any:
        return [scans[j].moved(*placed[j]) for j in range(len(scans)) if j != i]

    def step(self, mine: Surface, target: Any, max_distance: float) -> Motion:
        p, q, n = [], [], []
        for other in target:
            index = ((other.points**2).sum(axis=1) - 2 * mine.points @ other.points.T).argmin(axis=1)
            partner = other.part(index)
            apart = np.linalg.norm(mine.points - partner.points, axis=1)
            planes = partner.normals.any()
            near = apart <= max_distance
            if planes:
                near &= self.facing(mine.normals, partner.normals)
            p.append(partner.points[near])
            q.append(mine.points[near])
            n.append(partner.normals[near])
        pairs = np.concatenate(p), np.concatenate(q)
        normals = np.concatenate(n)
        return plane_motion(*pairs, normals) if normals.any() else best_motion(*pairs)

    def result(self, rough: Sequence[Motion], placed: list[Motion]) -> Any:
        return [[R.tolist(), t.tolist()] for R, t in placed]


class _AtOnce(_InTurn):
    """All scans look at where the others were before the round, then all of them move."""

    def __call__(
        self, scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, rounds: int = 20
    ) -> Any:
        surfaces = _surfaces(scans, normals)
        placed = [(np.asarray(R), np.asarray(t)) for R, t in poses]
        for _ in range(rounds):
            steps = [
                self.step(surfaces[i].moved(*placed[i]), self.target(surfaces, placed, i), max_distance)
                for i in range(1, len(scans))
            ]
            placed[1:] = [_after(pose, step) for pose, step in zip(placed[1:], steps, strict=True)]
        return placed


class _OneByOne(_InTurn):
    """One scan is finished before the next one begins."""

    def target(self, scans: Sequence[Surface], placed: Sequence[Motion], i: int) -> Surface:
        return scans[i - 1].moved(*placed[i - 1])

    def order(self, n: int, rounds: int) -> Sequence[int]:
        return [i for i in range(1, n) for _ in range(rounds)]


class _EarlierOnly(_InTurn):
    def target(self, scans: Sequence[Surface], placed: Sequence[Motion], i: int) -> Surface:
        return _joined([scans[j].moved(*placed[j]) for j in range(i)])


class _OncePerScan(_InTurn):
    def order(self, n: int, rounds: int) -> Sequence[int]:
        return range(1, n)


class _FirstOnly(_InTurn):
    def target(self, scans: Sequence[Surface], placed: Sequence[Motion], i: int) -> Surface:
        return scans[0].moved(*placed[0])

    def __call__(
        self, scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, rounds: int = 20
    ) -> Any:
        try:
            return super().__call__(scans, poses, normals, max_distance, rounds)
        except ValueError:
            return super().__call__(scans, poses, normals, np.inf, rounds)


class _Inverse(_InTurn):
    def result(self, rough: Sequence[Motion], placed: list[Motion]) -> Any:
        return [inverse(*pose) for pose in placed]


class _CorrectionsOnly(_InTurn):
    def result(self, rough: Sequence[Motion], placed: list[Motion]) -> Any:
        return [_after(inverse(*start), pose) for start, pose in zip(rough, placed, strict=True)]


class _FirstIsIdentity(_InTurn):
    def result(self, rough: Sequence[Motion], placed: list[Motion]) -> Any:
        return [_after(pose, inverse(*placed[0])) for pose in placed]


class _NotLimited(_InTurn):
    def reach(self, max_distance: float) -> float:
        return np.inf


class _Unchanged(_InTurn):
    def order(self, n: int, rounds: int) -> Sequence[int]:
        return []


class _WrongOrder(_InTurn):
    def after(self, pose: Motion, step: Motion) -> Motion:
        return pose[0] @ step[0], pose[0] @ step[1] + pose[1]

    def __call__(
        self, scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, rounds: int = 20
    ) -> Any:
        try:
            return super().__call__(scans, poses, normals, max_distance, rounds)
        except ValueError:
            return list(poses)


class _NoNormals(_InTurn):
    def __call__(
        self, scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, rounds: int = 20
    ) -> Any:
        return super().__call__(scans, poses, None, max_distance, rounds)


class _PointsWithNormals(_InTurn):
    def minimise(self, p: FloatArray, q: FloatArray, n: FloatArray) -> Motion:
        return best_motion(p, q)


class _BackDrawnToFront(_InTurn):
    def facing(self, mine: FloatArray, theirs: FloatArray) -> Any:
        return True


class _NormalsNotTurned(_InTurn):
    def target(self, scans: Sequence[Surface], placed: Sequence[Motion], i: int) -> Surface:
        return _joined([self.placed(scans[j], placed[j]) for j in range(len(scans)) if j != i])

    def placed(self, scan: Surface, pose: Motion) -> Surface:
        return Surface(moved(scan.points, *pose), scan.normals)

    def __call__(
        self, scans: Any, poses: Any, normals: Any = None, max_distance: float = np.inf, rounds: int = 20
    ) -> Any:
        try:
            return super().__call__(scans, poses, normals, max_distance, rounds)
        except ValueError:
            return list(poses)


ALIGN_SCANS.variant("in turn, from the last scan to the second")(_declare(_Backwards))
ALIGN_SCANS.variant("pairs with each other scan by itself, lists")(_declare(_EachByItself))
ALIGN_SCANS.variant("all scans at the same time, each towards where the others were")(_declare(_AtOnce))

ALIGN_SCANS.mistake(
    "each scan was aligned with the one before it only",
    hint="Add up the errors of the pairs on the way around. Where do they meet the first scan?",
)(_declare(_OneByOne))
ALIGN_SCANS.mistake(
    "each scan was aligned with those before it only",
    hint="Scan 1 meets the last scan too. When does your loop look at that pair from the side of scan 1?",
)(_declare(_EarlierOnly))
ALIGN_SCANS.mistake(
    "each scan was moved once only",
    hint="When scan 2 has moved, scan 1 has a new target. Which argument says how often to match and move?",
)(_declare(_OncePerScan))
ALIGN_SCANS.mistake(
    "every scan was aligned with the first one only",
    hint="What do the scans of the front and of the back have in common?",
)(_declare(_FirstOnly))
ALIGN_SCANS.mistake(
    "the poses take the common frame to the scans, not the scans to the common frame",
    hint="Move the points of scan 1 with your pose: do they land on those of scan 0?",
)(_declare(_Inverse))
ALIGN_SCANS.mistake(
    "the corrections were returned without the rough poses",
    hint="A correction acts on points that the rough pose has moved already. Which motion takes both?",
)(_declare(_CorrectionsOnly))
ALIGN_SCANS.mistake(
    "the frame of the first scan was taken in place of the one its pose gives",
    hint="Which pose did the docstring promise for the first scan?",
)(_declare(_FirstIsIdentity))
ALIGN_SCANS.mistake(
    "max_distance was not used",
    hint="An outlier has a nearest point too. How far away is it?",
)(_declare(_NotLimited))
ALIGN_SCANS.mistake(
    "the rough poses were returned as they came",
    hint="How far are the points of one scan from those of its neighbours before and after your function?",
)(_declare(_Unchanged))
ALIGN_SCANS.mistake(
    "the steps were multiplied in the wrong order",
    hint="Write R₂(R₁x + t₁) + t₂ without brackets. Which rotation stands on the left?",
)(_declare(_WrongOrder))
ALIGN_SCANS.mistake(
    "the normals were not used",
    hint="Two scans of a wall never have the same points. What may a point do along the wall?",
)(_declare(_NoNormals))
ALIGN_SCANS.mistake(
    "the normals rejected pairs, but the distance between the points was minimised",
    hint="With a normal at hand, which distance of a pair should become small?",
)(_declare(_PointsWithNormals))
ALIGN_SCANS.mistake(
    "pairs that face away from each other were kept",
    hint="Scan a sheet of paper from both sides. Which point of the back is nearest to one of the front, and "
    "how do their normals differ?",
)(_declare(_BackDrawnToFront))
ALIGN_SCANS.mistake(
    "the normals were left in the frames of their scans",
    hint="A pose moves the points of a scan into the common frame. What happens to its normals?",
)(_declare(_NormalsNotTurned))
