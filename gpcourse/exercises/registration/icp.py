"""The exercise on iterative closest points. It is judged by the pose, not only by where the points are."""

from __future__ import annotations

from collections.abc import Callable
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
    landscape,
    motion,
    moved,
    parts,
    random_motion,
    random_turn,
    random_waves,
    turn,
)
from gpcourse.exercises.registration.rigid import best_motion, linearised_step, plane_motion
from gpcourse.geometry.arrays import FloatArray
from gpcourse.reference import registration as reference


def _as_pose(arguments: tuple[Any, ...], value: Any) -> FloatArray:
    """Canonical form: the pose, and the loss at the start, all to about 1e-6.

    The large last number sets the scale on which answers are compared. Rounding grows over the iterations,
    and a loop may run once more or less near its end; both change much less than a wrong step does.
    """
    R, t, history = value
    numbers = [np.ravel(R), np.ravel(t), [float(history[0]), float(len(history) == arguments[3]), 100.0]]
    return np.concatenate([np.asarray(part, dtype=float) for part in numbers])


ICP = Exercise(
    reference.icp,
    notes="ch. 2, Iterative Closest Points",
    hints=[
        "Each iteration: move, match, reject, minimise. You have functions for the last three.",
        "Where is the source after two steps? Write R₂(R₁x + t₁) + t₂ as one motion.",
        "The target stays. What need not be done again in each iteration?",
        "When has an iteration changed nothing? A motion has two parts, and both may be at work.",
    ],
    canonical=_as_pose,
    time_limit=6.0,
)

Result = tuple[FloatArray, FloatArray, FloatArray]


def _result(value: object, most: int, on: str) -> Result:
    R, t, history = parts(value, 3, "three things (R, t, history)", on=on)
    pose = motion((R, t), on=on)
    losses = expect.array(history, (None,), "The history", on=on)
    expect.that(len(losses) >= 1, "The history is empty: it should hold the loss of each iteration.", on=on)
    message = f"The history has {len(losses)} entries; at most {most} iterations were asked for."
    expect.that(len(losses) <= most, message, on=on)
    return *pose, losses


def _expect_pose(
    mine: Result,
    want: Motion,
    source: FloatArray,
    target: FloatArray,
    tolerance: float,
    on: str,
    scale: float = 1.0,
) -> None:
    """Expect the rotation within `tolerance`, in radians, and points within 3 `scale` times that."""
    R, t, _ = mine
    details: dict[str, Any] = {"on": on, **pictures.of_alignment(target, source, (R, t), want)}
    angle = angle_between(R, want[0])
    expect.that(
        angle <= tolerance,
        "The rotation of the pose is not right: R and t together should move the source, as it was given, "
        "onto the target.",
        yours=f"{np.degrees(angle):.3g}° off",
        truth=f"within {np.degrees(tolerance):.2g}°",
        **details,
    )
    off = float(np.linalg.norm(moved(source, R, t) - moved(source, *want), axis=1).max())
    expect.that(
        off <= 3 * tolerance * scale,
        "The rotation is right, but the translation puts the source in the wrong place.",
        yours=f"{off:.3g} off",
        truth=f"within {3 * tolerance * scale:.2g}",
        **details,
    )


def _nudge(rng: Rng, angle: float, shift: float) -> Motion:
    """Return a small motion; about a point that is not the origin, as everywhere below."""
    direction = rng.normal(size=3)
    return random_turn(rng, angle), shift * direction / np.linalg.norm(direction)


def _displaced(
    rng: Rng, points: FloatArray, angle: float, shift: float, centre: FloatArray
) -> tuple[FloatArray, Motion]:
    """Move points a little about `centre`; return them and the motion that takes them back."""
    R, t = _nudge(rng, angle, shift)
    t = t + centre - R @ centre
    return moved(points, R, t), inverse(R, t)


def _turned_and_lowered(rng: Rng, centre: FloatArray, angle: float, drop: FloatArray) -> Motion:
    """Return a turn about `centre`, after which everything goes down by `drop`."""
    R = random_turn(rng, angle)
    return R, centre - R @ centre - drop


def _scans(rng: Rng, n: int) -> tuple[FloatArray, FloatArray]:
    """Return a hilly cloud in some place, and its middle."""
    R, t = random_motion(rng, 2.0)
    surface = landscape(rng, n).moved(R, t)
    return surface.points, surface.points.mean(axis=0)


@ICP.check("one iteration is the best motion for the nearest points")
def _(f: Asked, rng: Rng) -> None:
    target, middle = _scans(rng, 81)
    source, _ = _displaced(rng, target[rng.choice(81, 50, replace=False)], 0.2, 0.1, middle)
    cases = [("one iteration, 50 points onto 81", source, target), _both_sides_of_a_wall(rng)]
    answers = [f(source, target, None, 1, 0.0) for _, source, target in cases]
    for (on, source, target), value in zip(cases, f.each(answers), strict=True):
        mine = _result(value, 1, on)
        distances = brute_force(target, source)
        want = best_motion(target[distances.argmin(axis=1)], source)
        _expect_pose(mine, want, source, target, 1e-6, on)
        loss = float(np.sqrt((distances.min(axis=1) ** 2).mean()))
        what = "The loss of the first iteration, the root mean square distance of the pairs before the step,"
        expect.close(float(mine[2][0]), loss, 1e-6 * loss, what, on=on)


def _both_sides_of_a_wall(rng: Rng) -> tuple[str, FloatArray, FloatArray]:
    """Return two scans of a flat wall, each with the noise of the other turned round: a mirror fits best."""
    x, y = (a.ravel() for a in np.meshgrid(*2 * [np.linspace(-1, 1, 9)]))
    wall = np.column_stack([x, y, 0.01 * rng.normal(size=81)]) + 0.05 * rng.uniform(-1, 1, (81, 3)) * [
        1,
        1,
        0,
    ]
    R, t = random_motion(rng, 2.0)
    return "one iteration, two noisy scans of a wall", moved(wall * [1, 1, -1], R, t), moved(wall, R, t)


@ICP.check("the pose of a scan is found, exactly without noise", points=2)
def _(f: Asked, rng: Rng) -> None:
    cases = []
    for n, angle, scale in ((100, 0.12, 1.0), (144, 0.35, 0.001)):
        target, middle = _scans(rng, n)
        chosen = rng.choice(n, 3 * n // 4, replace=False)
        source, (R, t) = _displaced(rng, target[chosen], angle, angle / 2, middle)
        source, target, want = scale * source, scale * target, (R, scale * t)
        on = f"{len(source)} of {n} points, turned by {np.degrees(angle):.0f}°, {2 * scale:g} wide"
        cases.append((source, target, want, scale, on, f(source, target, None, 40, 1e-12 * scale)))
    for f.about, (source, target, want, scale, on, value) in enumerate(cases):
        # Once all pairs are right the next step is exact. Over 60 scans that takes 3 to 23 iterations.
        _expect_pose(_result(value, 40, on), want, source, target, 1e-6, on, scale)


@ICP.check("partial overlap, trimmed", points=2)
def _(f: Asked, rng: Rng) -> None:
    cases = []
    for _ in range(2):
        R, t = random_motion(rng, 2.0)
        flat = landscape(rng, 144)
        x = flat.points[:, 0]
        whole = flat.moved(R, t)
        target = whole.points[x < 0.55]
        want = inverse(*_turned_and_lowered(rng, whole.points.mean(axis=0), 0.12, 0.1 * R[:, 2]))
        # Four stray points lie on the target at first, and are off it in the end: no pair is good for ever.
        stray = moved(target[rng.permutation(len(target))], *want)
        stray = stray[brute_force(target, stray).min(axis=1) > 0.05][:4]
        source = moved(np.concatenate([whole.points[x > -0.75], stray]), *inverse(*want))
        cases.append((source, target, want, f(source, target, None, 35, 1e-12, 0.65)))
    on = "two scans that overlap in three quarters, with four stray points, keep = 0.65"
    for source, target, want, value in cases:
        _expect_pose(_result(value, 35, on), want, source, target, 1e-6, on)


@ICP.check("outliers, rejected by distance")
def _(f: Asked, rng: Rng) -> None:
    R, t = random_motion(rng, 2.0)
    target = landscape(rng, 100).moved(R, t).points
    want = inverse(*_turned_and_lowered(rng, target.mean(axis=0), 0.08, 0.2 * R[:, 2]))
    chosen = target[rng.choice(100, 70, replace=False)]
    away = rng.normal(size=3)
    far = chosen[:11] + (0.9 + rng.uniform(0, 1, size=(11, 1))) * away / np.linalg.norm(away)
    # At least 125 of these points (250 scans) are within 0.4 at first, and not in the end.
    above = np.concatenate([target + height * R[:, 2] for height in np.arange(0.4, 0.9, 0.05)])
    reach = brute_force(target, above).min(axis=1)
    first = brute_force(target, moved(above, *inverse(*want))).min(axis=1)
    near = rng.permutation(above[(reach > 0.45) & (reach < 0.6) & (first < 0.36)])[:4]
    far = far[brute_force(target, far).min(axis=1) > 0.6]
    source = moved(np.concatenate([chosen[11:], near, far]), *inverse(*want))
    value = f(source, target, None, 25, 1e-12, 1.0, 0.4)
    on = f"{len(source)} points with outliers, max_distance = 0.4"
    mine = _result(value, 25, on)
    _expect_pose(mine, want, source, target, 1e-6, on)
    distances = brute_force(target, source).min(axis=1)
    loss = float(np.sqrt((distances[distances <= 0.4] ** 2).mean()))
    what = "The loss of the first iteration, the root mean square distance of the pairs that are kept,"
    expect.close(float(mine[2][0]), loss, 1e-6 * loss, what, on=on)


@ICP.check("partial overlap, noise and outliers at once")
def _(f: Asked, rng: Rng) -> None:
    R, t = random_motion(rng, 2.0)
    flat = landscape(rng, 144)
    x = flat.points[:, 0]
    whole = flat.moved(R, t)
    target, chosen = whole.points[x < 0.55], whole.points[x > -0.75]
    wild = rng.choice(len(chosen), 8, replace=False)
    chosen[wild] += rng.uniform(0.6, 1.6, size=(8, 1)) * R[:, 2]
    source, want = _displaced(rng, chosen, 0.06, 0.03, whole.points.mean(axis=0))
    source, target = (
        source + 0.006 * rng.normal(size=source.shape),
        target + 0.006 * rng.normal(size=target.shape),
    )
    value = f(source, target, None, 35, 1e-12, 0.6, 0.4)
    on = "three quarters overlap, noise of 0.006, 8 outliers, keep = 0.6"
    # Over 400 scans, noise turns a right answer by 0.0082 at most, and moves it by 0.0183.
    _expect_pose(_result(value, 35, on), want, source, target, 0.012, on)


def _corner(rng: Rng) -> tuple[Surface, FloatArray]:
    """Return a fine grid on three walls of a room, and other points on the walls, away from the edges."""
    u, v = (a.ravel() for a in np.meshgrid(*2 * [np.linspace(0, 1, 9)]))
    points, normals, others = [], [], []
    for axis in range(3):
        points.append(np.insert(np.column_stack([u, v]), axis, 0.0, axis=1))
        normals.append(np.tile(np.eye(3)[axis], (len(u), 1)))
        others.append(np.insert(rng.uniform(0.35, 0.9, size=(14, 2)), axis, 0.0, axis=1))
    return Surface(np.concatenate(points), np.concatenate(normals)), np.concatenate(others)


@ICP.check("with normals: other points on the same walls", points=2)
def _(f: Asked, rng: Rng) -> None:
    walls, others = _corner(rng)
    R, t = random_motion(rng, 2.0)
    room = walls.moved(R, t)
    order = rng.permutation(len(room.points))
    room = room.part(order)
    source, want = _displaced(rng, moved(others, R, t), 0.08, 0.05, room.points.mean(axis=0))
    value = f(source, room.points, room.normals, 8, 0.0)
    on = "42 points on three walls, onto other points on the walls, with normals"
    mine = _result(value, 8, on)
    # Whichever point of its wall is nearest, the plane is the same: the error is squared in each step.
    _expect_pose(mine, want, source, room.points, 1e-6, on)
    loss = float(np.sqrt((brute_force(room.points, source).min(axis=1) ** 2).mean()))
    what = "The loss of the first iteration, the root mean square distance of the pairs of points,"
    expect.close(float(mine[2][0]), loss, 1e-6 * loss, what, on=on)


@ICP.check("it stops when the loss no longer changes, and not before", points=2)
def _(f: Asked, rng: Rng) -> None:
    # Opposite points: their centroid stays at the origin, and a turn about it shifts nothing.
    waves = random_waves(rng) * [1, 1, 1, 0]
    half = landscape(rng, 64, waves).points
    target = np.concatenate([half, -half]) @ random_turn(rng).T
    want = turn(rng.normal(size=3), 0.16), np.zeros(3)
    source = moved(target, *inverse(*want))
    rough = source + 0.01 * rng.normal(size=source.shape)
    value, rough_value = f(source, target, None, 30, 1e-9), f(rough, target, None, 60, 1e-6)
    on = "a cloud symmetric about the origin, turned about it by 9°"
    mine = _result(value, 30, on)
    _expect_pose(mine, want, source, target, 1e-6, on)
    # With noise the pairs of points settle as well, and then the loss repeats itself: after 20 at most.
    noisy = "the same cloud with noise of 0.01, tolerance 1e-6"
    for losses, most, where in ((mine[2], 30, on), (_result(rough_value, 60, noisy)[2], 60, noisy)):
        expect.that(
            len(losses) < most,
            "The loss stopped changing long ago, and the loop went on to the last iteration.",
            yours=f"{len(losses)} iterations",
            truth=f"fewer than {most}",
            on=where,
        )


# Solutions --------------------------------------------------------------------------------------


class _Loop:
    """An ICP with the places where students go wrong left open; each mistake overrides one."""

    first: FloatArray | None = None

    def accumulate(self, R: FloatArray, t: FloatArray, step: FloatArray, shift: FloatArray) -> Motion:
        return step @ R, step @ t + shift

    def kept(self, distances: FloatArray, keep: float, max_distance: float) -> Any:
        return (distances <= np.quantile(distances, keep)) & (distances <= max_distance)

    def place(self, source: FloatArray, x: FloatArray, pose: Motion, step: Motion) -> FloatArray:
        return moved(x, *step)

    def normals_at(self, normals: FloatArray, index: Any, kept: Any) -> FloatArray:
        chosen: FloatArray = normals[index[kept]]
        return chosen

    def minimise(self, p: FloatArray, q: FloatArray, n: FloatArray | None) -> Motion:
        return best_motion(p, q) if n is None else plane_motion(p, q, n)

    def done(self, history: list[float], step: Motion, tolerance: float) -> bool:
        return history[-1] < tolerance or (len(history) > 1 and abs(history[-2] - history[-1]) < tolerance)

    def loss(self, distances: FloatArray, kept: Any) -> float:
        return float(np.sqrt((distances[kept] ** 2).mean()))

    def partners(self, index: FloatArray) -> FloatArray:
        return index

    def result(self, pose: Motion, step: Motion) -> Motion:
        return pose

    def __call__(
        self,
        source: FloatArray,
        target: FloatArray,
        normals: FloatArray | None = None,
        max_iterations: int = 50,
        tolerance: float = 0.0,
        keep: float = 1.0,
        max_distance: float = np.inf,
    ) -> Any:
        pose: Motion = (np.eye(3), np.zeros(3))
        step, x, history = pose, source, []
        # ‖x − y‖² = ‖x‖² + ‖y‖² − 2x·y, of which ‖x‖² does not matter. Centred, nothing cancels.
        centre = target.mean(axis=0)
        squares = ((target - centre) ** 2).sum(axis=1)
        for _ in range(max_iterations):
            index = (squares - 2 * (x - centre) @ (target - centre).T).argmin(axis=1)
            index = self.partners(index)
            distances = np.linalg.norm(x - target[index], axis=1)
            kept = self.kept(distances, keep, max_distance)
            n = None if normals is None else self.normals_at(normals, index, kept)
            step = self.minimise(target[index[kept]], x[kept], n)
            pose = self.accumulate(*pose, *step)
            x = self.place(source, x, pose, step)
            history.append(self.loss(distances, kept))
            # A lost cloud flies off and overflows: it is lost already.
            if self.done(history, step, tolerance) or not np.abs(x).max() < 1e6:
                break
        return *self.result(pose, step), history


def _declare(solution: type[_Loop]) -> Callable[..., Any]:
    loop = solution()

    def icp(
        source: FloatArray,
        target: FloatArray,
        normals: FloatArray | None = None,
        max_iterations: int = 50,
        tolerance: float = 0.0,
        keep: float = 1.0,
        max_distance: float = np.inf,
    ) -> Any:
        return loop(source, target, normals, max_iterations, tolerance, keep, max_distance)

    return icp


class _FromTheStart(_Loop):
    def place(self, source: FloatArray, x: FloatArray, pose: Motion, step: Motion) -> FloatArray:
        return moved(source, *pose)


class _Homogeneous(_Loop):
    """Poses as 4 × 4 matrices; trimming by sorting, rounded down; the motion read off the moved points."""

    def kept(self, distances: FloatArray, keep: float, max_distance: float) -> Any:
        order = np.argsort(distances)[: int(keep * len(distances) + 1e-9)]
        return order[distances[order] <= max_distance]

    def accumulate(self, R: FloatArray, t: FloatArray, step: FloatArray, shift: FloatArray) -> Motion:
        before, after = np.eye(4), np.eye(4)
        before[:3, :3], before[:3, 3] = R, t
        after[:3, :3], after[:3, 3] = step, shift
        both = after @ before
        return both[:3, :3], both[:3, 3]

    def result(self, pose: Motion, step: Motion) -> Any:
        return pose[0].tolist(), pose[1][:, None]


class _LastStep(_Loop):
    def result(self, pose: Motion, step: Motion) -> Motion:
        return step


class _WrongOrder(_Loop):
    def accumulate(self, R: FloatArray, t: FloatArray, step: FloatArray, shift: FloatArray) -> Motion:
        return R @ step, R @ shift + t


class _SummedShift(_Loop):
    def accumulate(self, R: FloatArray, t: FloatArray, step: FloatArray, shift: FloatArray) -> Motion:
        return step @ R, t + shift


class _Backwards(_Loop):
    def result(self, pose: Motion, step: Motion) -> Motion:
        return inverse(*pose)


class _NotMoved(_Loop):
    def place(self, source: FloatArray, x: FloatArray, pose: Motion, step: Motion) -> FloatArray:
        return source

    def accumulate(self, R: FloatArray, t: FloatArray, step: FloatArray, shift: FloatArray) -> Motion:
        return step, shift


class _MovedTwice(_Loop):
    def place(self, source: FloatArray, x: FloatArray, pose: Motion, step: Motion) -> FloatArray:
        return moved(x, *pose)


class _NotTrimmed(_Loop):
    def kept(self, distances: FloatArray, keep: float, max_distance: float) -> Any:
        return distances <= max_distance


class _NotLimited(_Loop):
    def kept(self, distances: FloatArray, keep: float, max_distance: float) -> Any:
        return distances <= np.quantile(distances, keep)


class _OneRuleIsEnough(_Loop):
    def kept(self, distances: FloatArray, keep: float, max_distance: float) -> Any:
        return (distances <= np.quantile(distances, keep)) | (distances <= max_distance)


class _PartOfTheLargest(_Loop):
    def kept(self, distances: FloatArray, keep: float, max_distance: float) -> Any:
        return (distances <= keep * distances.max()) & (distances <= max_distance)


class _StopsOnShift(_Loop):
    def done(self, history: list[float], step: Motion, tolerance: float) -> bool:
        return bool(np.linalg.norm(step[1]) < tolerance)


class _NeverStops(_Loop):
    def done(self, history: list[float], step: Motion, tolerance: float) -> bool:
        return False


class _Mirror(_Loop):
    def minimise(self, p: FloatArray, q: FloatArray, n: FloatArray | None) -> Motion:
        if n is not None:
            return plane_motion(p, q, n)
        U, _, Vt = np.linalg.svd((q - q.mean(axis=0)).T @ (p - p.mean(axis=0)))
        R = (U @ Vt).T
        return R, p.mean(axis=0) - R @ q.mean(axis=0)


class _Linearised(_Loop):
    def minimise(self, p: FloatArray, q: FloatArray, n: FloatArray | None) -> Motion:
        return best_motion(p, q) if n is None else linearised_step(p, q, n)


class _NoNormals(_Loop):
    def minimise(self, p: FloatArray, q: FloatArray, n: FloatArray | None) -> Motion:
        return best_motion(p, q)


class _NormalsOfOthers(_Loop):
    def normals_at(self, normals: FloatArray, index: Any, kept: Any) -> FloatArray:
        chosen: FloatArray = normals[np.arange(len(index))[kept]]
        return chosen


class _MeanSquare(_Loop):
    def loss(self, distances: FloatArray, kept: Any) -> float:
        return float((distances[kept] ** 2).mean())


class _LossOfAll(_Loop):
    def loss(self, distances: FloatArray, kept: Any) -> float:
        return float(np.sqrt((distances**2).mean()))


class _OnlyBelow(_Loop):
    def done(self, history: list[float], step: Motion, tolerance: float) -> bool:
        return history[-1] < tolerance


class _Signed(_Loop):
    def done(self, history: list[float], step: Motion, tolerance: float) -> bool:
        return history[-1] < tolerance or (len(history) > 1 and history[-1] - history[-2] < tolerance)


class _LossToPlanes(_Loop):
    def minimise(self, p: FloatArray, q: FloatArray, n: FloatArray | None) -> Motion:
        self.across = None if n is None else np.einsum("ij,ij->i", p - q, n)
        return super().minimise(p, q, n)

    def loss(self, distances: FloatArray, kept: Any) -> float:
        if self.across is None:
            return super().loss(distances, kept)
        return float(np.sqrt((self.across**2).mean()))


class _RowsTimesR(_Loop):
    def place(self, source: FloatArray, x: FloatArray, pose: Motion, step: Motion) -> FloatArray:
        turned: FloatArray = x @ step[0] + step[1]
        return turned


class _TurnedByTheNewR(_Loop):
    def accumulate(self, R: FloatArray, t: FloatArray, step: FloatArray, shift: FloatArray) -> Motion:
        return step @ R, step @ R @ t + shift


class _OwnThreshold(_Loop):
    def done(self, history: list[float], step: Motion, tolerance: float) -> bool:
        return len(history) > 1 and abs(history[-2] - history[-1]) < 1e-3


class _RejectedOnce(_Loop):
    def __call__(self, source: FloatArray, target: FloatArray, *options: Any) -> Any:
        self.first = None
        return super().__call__(source, target, *options)

    def kept(self, distances: FloatArray, keep: float, max_distance: float) -> Any:
        self.first = super().kept(distances, keep, max_distance) if self.first is None else self.first
        return self.first


class _MatchedOnce(_Loop):
    def __call__(self, source: FloatArray, target: FloatArray, *options: Any) -> Any:
        self.first = None
        return super().__call__(source, target, *options)

    def partners(self, index: FloatArray) -> FloatArray:
        self.first = index if self.first is None else self.first
        return self.first


ICP.variant("moving the source from the start, by the whole pose")(_declare(_FromTheStart))
ICP.variant("4 × 4 matrices, trimmed by sorting, lists")(_declare(_Homogeneous))

ICP.mistake(
    "the last step was returned, not the whole motion",
    hint="After the last iteration the steps are tiny. How far has the source come since the start?",
)(_declare(_LastStep))
ICP.mistake(
    "the steps were multiplied in the wrong order",
    hint="Write R₂(R₁x + t₁) + t₂ without brackets. Which rotation stands on the left?",
)(_declare(_WrongOrder))
ICP.mistake(
    "the translations were added up without turning them",
    hint="Write R₂(R₁x + t₁) + t₂ without brackets. What happens to t₁?",
)(_declare(_SummedShift))
ICP.mistake(
    "the translation was turned by the whole rotation, not by that of the step",
    hint="Write R₂(R₁x + t₁) + t₂ without brackets. Does R₁ turn t₁? In which order do your two lines run?",
)(_declare(_TurnedByTheNewR))
ICP.mistake(
    "rows of points were multiplied by R in place of its transpose",
    hint="R x is for a column x. Your points are rows: which product turns a row?",
)(_declare(_RowsTimesR))
ICP.mistake(
    "the pose is the inverse one, which moves the target onto the source",
    hint="Which cloud moves, and which one stays?",
)(_declare(_Backwards))
ICP.mistake(
    "the source was not moved between the iterations",
    hint="In the second iteration, from where does a point look for its nearest one?",
)(_declare(_NotMoved))
ICP.mistake(
    "the whole pose was applied again to points that had been moved already",
    hint="Move the source by the whole pose, or the moved points by the step. Which of them do you mix?",
)(_declare(_MovedTwice))
ICP.mistake(
    "keep was not used",
    hint="The part of the source outside the overlap has a nearest point too. What does it pull at?",
)(_declare(_NotTrimmed))
ICP.mistake(
    "max_distance was not used",
    hint="An outlier has a nearest point too. How far away is it?",
)(_declare(_NotLimited))
ICP.mistake(
    "a pair that passes one of the two rules was kept",
    hint="A pair is among the closest, and still too far apart. Should it count?",
)(_declare(_OneRuleIsEnough))
ICP.mistake(
    "the pairs up to a part of the largest distance were kept, not that part of the pairs",
    hint="One wild pair doubles the largest distance. Should it change which others are kept?",
)(_declare(_PartOfTheLargest))
ICP.mistake(
    "the loop stopped because ‖t‖ of a step was small, while the rotation was still at work",
    hint="Turn a symmetric cloud about its centre: how long is t in each step?",
)(_declare(_StopsOnShift))
ICP.mistake(
    "the tolerance was not used, and all iterations were made",
    hint="Compare the last two entries of the history. When may you stop?",
)(_declare(_NeverStops))
ICP.mistake(
    "the sign of det(VUᵀ) was left out, and a nearly flat scan was mirrored",
    hint="Scan a wall twice. What decides if the noise of the one lies before or behind that of the other?",
)(_declare(_Mirror))
ICP.mistake(
    "the linearised matrix I + [r]× was used as the rotation of a step",
    hint="Each step makes the source a little larger. Multiply your R by its transpose.",
)(_declare(_Linearised))
ICP.mistake(
    "the normals were not used",
    hint="Two scans of a wall never have the same points. What may a point do along the wall?",
)(_declare(_NoNormals))
ICP.mistake(
    "the normals were looked up with the numbers of the source points",
    hint="A normal belongs to a point of the target. Which one is the partner of source point i?",
)(_declare(_NormalsOfOthers))
ICP.mistake(
    "the loss is the mean of the squares, without the root",
    hint="In which unit should the history be, when the points are in metres?",
)(_declare(_MeanSquare))
ICP.mistake(
    "the loss counts the rejected pairs as well",
    hint="Which pairs did the step make smaller? Whose distances tell whether it still gains anything?",
)(_declare(_LossOfAll))
ICP.mistake(
    "the loss was measured to the planes, not between the points",
    hint="The docstring says what the history holds, with normals or without. Which distance is it?",
)(_declare(_LossToPlanes))
ICP.mistake(
    "the change of the loss was compared with its sign",
    hint="A loss that falls from 0.5 to 0.3 changes by −0.2. Is that less than the tolerance?",
)(_declare(_Signed))
ICP.mistake(
    "the loop ends when the loss is below the tolerance, and only then",
    hint="Noisy scans never fit exactly. How small does their loss become, and what does it do then?",
)(_declare(_OnlyBelow))
ICP.mistake(
    "the loop ends at a threshold of its own, not at the tolerance that was given",
    hint="Give the scans in millimetres, then in metres. Is your threshold as small for both?",
)(_declare(_OwnThreshold))
ICP.mistake(
    "the points were matched once, before the loop",
    hint="After the first step the source lies elsewhere. Are its nearest points still the same?",
)(_declare(_MatchedOnce))
ICP.mistake(
    "the pairs were rejected once, in the first iteration",
    hint="As the source moves, its pairs come closer or go apart. Are the bad ones still the same?",
)(_declare(_RejectedOnce))
