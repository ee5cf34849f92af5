"""Exercises on the choice of points: at random, evenly, by their normals, and for a stable fit."""

from __future__ import annotations

from typing import Any

import numpy as np

from gpcourse.exercises import expect
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Asked
from gpcourse.exercises.registration import pictures
from gpcourse.exercises.registration.inputs import (
    Rng,
    Surface,
    brute_force,
    landscape,
    parts,
    random_motion,
    random_turn,
    sample,
    turn,
)
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.reference import registration as reference

# At random --------------------------------------------------------------------------------------


def _traits(arguments: tuple[Any, ...], value: Any) -> list[Any]:
    """Canonical form of a random sample: what does not depend on the draws."""
    n, k = arguments[0], arguments[1]
    chosen = expect.indices(value)
    ordered = np.sort(chosen)
    steps = np.diff(ordered)
    # Of 25 draws from 30 some repeat, with a probability of 1 − 1e-9; of 4 draws from 10 they need not.
    repeated = bool(n < 2 * k and len(np.unique(chosen)) < len(chosen))
    return [len(chosen), repeated, ordered.tolist() == list(range(k)), len(set(steps.tolist())) == 1]


RANDOM_SAMPLING = Exercise(
    reference.random_sampling,
    notes="ch. 2, step 1",
    hints=[
        "Draw without putting back. numpy.random.default_rng(seed) makes a generator that can do that.",
        "Which argument of the generator's choice decides whether a number may come twice?",
    ],
    canonical=_traits,
)


@RANDOM_SAMPLING.check("k different indices of n")
def _(f: Asked, rng: Rng) -> None:
    cases = [(30, 25, int(rng.integers(2**31))), (12, 12, int(rng.integers(2**31))), (9, 1, 5)]
    answers = [f(*case) for case in cases]
    for (n, k, seed), answer in zip(cases, f.each(answers), strict=True):
        sample(answer, n, k, on=f"{k} of {n} points, seed {seed}")


@RANDOM_SAMPLING.check("every index is equally likely, whichever others are chosen", points=2)
def _(f: Asked, rng: Rng) -> None:
    seeds = rng.integers(2**31, size=100)
    answers = [f(10, 4, int(seed)) for seed in seeds]
    on = "4 of 10 points, with 100 seeds"
    samples = [sample(a, 10, 4, on=on) for a in f.each(answers)]
    counts = np.bincount(np.concatenate(samples), minlength=10)
    # Binomial, 100 trials of probability 0.4: 40 ± 4.9. Six deviations are passed by one in 10⁸.
    wrong = np.flatnonzero(np.abs(counts - 40) > 29)
    if len(wrong):
        i = int(wrong[0])
        raise expect.Wrong(
            f"Point {i} is not chosen as often as the others.",
            yours=f"{counts[i]} times in 100 samples",
            truth="about 40 times",
            on=on,
        )
    # Around a circle of ten, the six pairs of four random points are 1 to 5 apart: 4/3 pairs a sample are k
    # apart, for k below 5. In 100 samples that makes 133 ± 8, measured; seven deviations.
    steps = np.abs(np.array(samples)[:, :, None] - np.array(samples)[:, None])
    for k in range(1, 5):
        pairs = int(np.count_nonzero((steps == k) | (steps == 10 - k))) // 2
        expect.that(
            abs(pairs - 133) <= 56,
            f"Points that are {k} apart in the list come together too often or too rarely: they are not "
            "drawn one by one.",
            yours=f"{pairs} such pairs in 100 samples (the list taken as a circle)",
            truth="about 133",
            on=on,
        )


@RANDOM_SAMPLING.check("the same seed gives the same sample, another seed another")
def _(f: Asked, rng: Rng) -> None:
    a, b = (int(seed) for seed in rng.choice(2**31, 2, replace=False))
    first, again, other = (sample(f(60, 20, seed), 60, 20) for seed in (a, a, b))
    expect.that(
        np.array_equal(first, again),
        "The same seed gives another sample: nobody could repeat your experiment.",
        on=f"seed {a}, twice",
    )
    expect.that(
        set(first.tolist()) != set(other.tolist()),
        "Two seeds give the same sample: is the seed used?",
        on=f"seeds {a} and {b}",
    )


@RANDOM_SAMPLING.variant("the first of a permutation")
def _(n_points: int, k: int, seed: int) -> Any:
    return np.random.default_rng(seed).permutation(n_points)[:k].tolist()


@RANDOM_SAMPLING.variant("the smallest of n random numbers")
def _(n_points: int, k: int, seed: int) -> Any:
    return np.argsort(np.random.default_rng([seed, 1]).random(n_points))[:k].astype(float)


@RANDOM_SAMPLING.mistake(
    "points are put back, so that one may be drawn twice",
    hint="Choose 25 of 30 points and count the different ones.",
)
def _(n_points: int, k: int, seed: int) -> Any:
    return np.random.default_rng(seed).integers(0, n_points, size=k)


@RANDOM_SAMPLING.mistake(
    "the first k points were taken", hint="A scanner stores points line by line. Where are the first k?"
)
def _(n_points: int, k: int, seed: int) -> Any:
    return np.arange(k)


@RANDOM_SAMPLING.mistake(
    "every (n/k)-th point was taken", hint="What do equal steps give on a scan that is stored line by line?"
)
def _(n_points: int, k: int, seed: int) -> Any:
    return np.arange(k) * (n_points // k)


@RANDOM_SAMPLING.mistake(
    "a run of points was taken, from a random start",
    hint="A scanner stores points line by line. Where are k points that follow each other?",
)
def _(n_points: int, k: int, seed: int) -> Any:
    return (np.random.default_rng(seed).integers(n_points) + np.arange(k)) % n_points


@RANDOM_SAMPLING.mistake("the seed was not used", hint="Where does your generator get its seed from?")
def _(n_points: int, k: int, seed: int) -> Any:
    return np.random.default_rng(1).permutation(n_points)[:k]


@RANDOM_SAMPLING.mistake("all points were returned, in random order", hint="How many points were asked for?")
def _(n_points: int, k: int, seed: int) -> Any:
    return np.random.default_rng(seed).permutation(n_points)


# Evenly -----------------------------------------------------------------------------------------

UNIFORM_SAMPLING = Exercise(
    reference.uniform_sampling,
    notes="ch. 2, step 1",
    hints=[
        "For every point keep one number: how far it is from the nearest chosen point.",
        "When a point is chosen, which of these numbers can change, and can they grow?",
        "Which point is worst served by what has been chosen so far?",
    ],
)


def _uneven(rng: Rng, n: int) -> FloatArray:
    """Return a cloud that is far denser on one side."""
    points = rng.uniform(-1, 1, size=(n, 3)) * [1, 1, 0.3]
    points[:, 0] = np.abs(points[:, 0]) ** 3 * 2
    return points @ random_turn(rng).T + rng.normal(size=3)


@UNIFORM_SAMPLING.check(
    "chosen points are further apart than any point is from the nearest of them", points=2
)
def _(f: Asked, rng: Rng) -> None:
    cases = [(_uneven(rng, n), k) for n, k in ((150, 20), (60, 5))]
    cases.append((100 * cases[0][0], 9))
    answers = [f(*case) for case in cases]
    for (points, k), answer in zip(cases, f.each(answers), strict=True):
        on = f"{k} of {len(points)} points, denser on one side"
        chosen = sample(answer, len(points), k, on=on)
        distances = brute_force(points[chosen], points)
        among = distances[chosen] + np.where(np.eye(k, dtype=bool), np.inf, 0)
        # When the last point was chosen, no point was farther from the others than it: a fact of this method.
        hole, gap = float(distances.min(axis=1).max()), float(among.min())
        expect.that(
            gap >= hole * (1 - 1e-9),
            "The sample is not spread evenly: two chosen points are close together while a part of the "
            "cloud has none.",
            yours=f"two are {gap:.3g} apart, and a point is {hole:.3g} from the nearest chosen one",
            on=on,
            picture=pictures.of_sample(points, chosen),
        )


@UNIFORM_SAMPLING.check("one point of each cluster, however few points it has")
def _(f: Asked, rng: Rng) -> None:
    sizes = rng.permutation([1, 2, 5, 20, 40, 60])
    centres = (
        10 * np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])[rng.permutation(8)[:6]]
    )
    label = np.repeat(np.arange(6), sizes)[rng.permutation(128)]
    points = centres[label] + rng.normal(size=(128, 3))
    points += rng.normal(size=3)
    on = f"6 clusters of {', '.join(map(str, sizes))} points"
    chosen = sample(f(points, 6), 128, 6, on=on)
    missed = sorted(set(range(6)) - set(label[chosen].tolist()))
    expect.that(
        not missed,
        f"A cluster of {sizes[missed[0]] if missed else 0} points has none in the sample.",
        on=on,
        picture=pictures.of_sample(points, chosen),
    )


@UNIFORM_SAMPLING.check("points that coincide")
def _(f: Asked, rng: Rng) -> None:
    places = rng.normal(size=(5, 3))
    points = places[rng.permutation(np.repeat(np.arange(5), 3))]
    on = "15 points in 5 places"
    few, every = f(points, 5), f(points, 15)
    f.about = 0
    chosen = sample(few, 15, 5, on=on)
    expect.that(
        len(np.unique(points[chosen], axis=0)) == 5, "Two chosen points are in the same place.", on=on
    )
    f.about = 1
    sample(every, 15, 15, on=f"all of {on}")


def _farthest(points: FloatArray, k: int, start: int, combine: Any = np.minimum) -> IntArray:
    """Choose points one after the other; `combine` joins the old distances with those to the newest."""
    chosen = [start]
    kept = np.linalg.norm(points - points[start], axis=1)
    while len(chosen) < k:
        free = kept.copy()
        free[chosen] = -1.0
        chosen.append(int(free.argmax()))
        kept = combine(kept, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.array(chosen)


@UNIFORM_SAMPLING.variant("starting at the last point")
def _(points: FloatArray, k: int) -> Any:
    return _farthest(points, k, len(points) - 1)


@UNIFORM_SAMPLING.variant("all distances at once, starting near the middle")
def _(points: FloatArray, k: int) -> Any:
    d = brute_force(points, points)
    chosen = [int(d.sum(axis=1).argmin())]
    while len(chosen) < k:
        free = [i for i in range(len(points)) if i not in chosen]
        chosen.append(max(free, key=lambda i: min(d[i, j] for j in chosen)))
    return chosen


@UNIFORM_SAMPLING.mistake(
    "each point is the farthest from the last one only",
    hint="After two points at opposite ends, which one is farthest from the second?",
)
def _(points: FloatArray, k: int) -> Any:
    return _farthest(points, k, 0, lambda old, new: new)


@UNIFORM_SAMPLING.mistake(
    "the distances to the chosen points were added up",
    hint="A point between two chosen ones: is it well served because it is far from the third?",
)
def _(points: FloatArray, k: int) -> Any:
    return _farthest(points, k, 0, np.add)


@UNIFORM_SAMPLING.mistake(
    "the largest distance to a chosen point was kept, not the smallest",
    hint="A point has a chosen one beside it and another far away. Is it well served?",
)
def _(points: FloatArray, k: int) -> Any:
    return _farthest(points, k, 0, np.maximum)


@UNIFORM_SAMPLING.mistake(
    "the points farthest from the first one were taken",
    hint="You have chosen a point. Which distances become smaller, and where do you store that?",
)
def _(points: FloatArray, k: int) -> Any:
    return _farthest(points, k, 0, lambda old, new: old)


@UNIFORM_SAMPLING.mistake(
    "the points farthest from the centroid were taken",
    hint="Where are these points? Is there one in the middle?",
)
def _(points: FloatArray, k: int) -> Any:
    return np.argsort(-np.linalg.norm(points - points.mean(axis=0), axis=1), kind="stable")[:k]


@UNIFORM_SAMPLING.mistake(
    "a point is chosen again where points coincide",
    hint="When all distances are zero, which index does argmax return?",
)
def _(points: FloatArray, k: int) -> Any:
    chosen = [0]
    kept = np.linalg.norm(points - points[0], axis=1)
    while len(chosen) < k:
        chosen.append(int(kept.argmax()))
        kept = np.minimum(kept, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return chosen


# By normals -------------------------------------------------------------------------------------


def _shares(arguments: tuple[Any, ...], value: Any) -> list[Any]:
    """Canonical form of a sample by normals: how the directions share it, roughly, and repeats."""
    normals, k = np.asarray(arguments[0]), arguments[1]
    chosen = expect.indices(value)
    label = np.unique(normals.round(6), axis=0, return_inverse=True)[1].ravel()
    counts = np.bincount(label[chosen], minlength=label.max() + 1)
    known = len(counts) == 6 and k == 24
    own = bool(known and np.array_equal(chosen, _by_direction(normals, k, None)))
    repeated = len(np.unique(chosen)) < len(chosen)
    # If one direction has nearly all points, how few each of the others has is chance.
    most = int(counts.argmax()) if known and counts.max() > 14 else -1
    return [len(chosen), repeated, own, most, ((counts < 2) & (known and most < 0)).tolist()]


NORMAL_SPACE_SAMPLING = Exercise(
    reference.normal_space_sampling,
    notes="ch. 2, step 1, Normal-based sampling",
    hints=[
        "Put the points into boxes by the direction of their normals. How do you number the boxes?",
        "From which box does the next point come, if all directions are to be taken as often?",
        "What do you do with a box that is empty before k points are chosen?",
    ],
    canonical=_shares,
)


def _grooved_normals(rng: Rng, up: int | None = None) -> tuple[FloatArray, IntArray]:
    """Return the normals of a plate with two grooves that cross: top, underside and four walls, and which.

    The plate looks along a coordinate axis (number `up`, or any), tilted towards a wall, so that the two have
    the same longitude.
    """
    axes = np.roll(np.eye(3), rng.integers(3) if up is None else 2 - up, axis=0)
    axes = np.array([axes[2], *rng.permutation(axes[:2])]) * rng.choice([-1, 1], size=(3, 1))
    six = np.concatenate([axes, -axes])[[0, 3, 1, 4, 2, 5]] @ turn(axes[1], rng.uniform(0.05, 0.15)).T
    label = rng.permutation(np.repeat(np.arange(6), [480, 20, 20, 20, 20, 20]))
    return six[label], label


@NORMAL_SPACE_SAMPLING.check("k different indices")
def _(f: Asked, rng: Rng) -> None:
    normals, _ = _grooved_normals(rng)
    cases = [(normals, 24), (normals[:50], 50), (normals, 160), (landscape(rng, 49).normals, 30)]
    answers = [f(*case, int(rng.integers(2**31))) for case in cases]
    for (some, k), answer in zip(cases, f.each(answers), strict=True):
        sample(answer, len(some), k, on=f"{k} of {len(some)} points")


@NORMAL_SPACE_SAMPLING.check("the walls of a groove are taken as often as the plate", points=2)
def _(f: Asked, rng: Rng) -> None:
    # Once with the plate in the plane z = 0, where its normal has no longitude of its own.
    plates = [_grooved_normals(rng, up) for up in (2, None)]
    answers = [[f(n, 24, int(seed)) for seed in rng.integers(2**31, size=8)] for n, _ in plates]
    on = "a plate: 480 normals up, 20 down, 20 on each of the four walls of two grooves; 24 points, 8 seeds"
    for p, (normals, label) in enumerate(plates):
        f.about = 8 * p
        chosen = np.concatenate([sample(a, len(normals), 24, on=on) for a in answers[p]])
        counts = np.bincount(label[chosen], minlength=6)
        # Six directions, 192 draws: 32 each if taken in turn, ± 5.2 if directions are drawn; five deviations.
        # Where two directions of 480 and 20 points share a box, 2 of 192 are expected of the rarer one.
        if not (np.abs(counts - 32) <= 26).all():
            walls = ", ".join(map(str, counts[2:]))
            raise expect.Wrong(
                "The directions are not taken equally often.",
                yours=f"plate {counts[0]}, underside {counts[1]}, walls {walls}",
                truth="about 32 each",
                on=on,
            )


@NORMAL_SPACE_SAMPLING.check("points of one direction are drawn at random, by the seed")
def _(f: Asked, rng: Rng) -> None:
    normals, _ = _grooved_normals(rng)
    seeds = [int(seed) for seed in rng.choice(2**31, 3, replace=False)]
    samples = [sample(f(normals, 24, s), len(normals), 24) for s in [*seeds, seeds[0]]]
    same = np.array_equal(samples[0], samples[-1])
    expect.that(same, "The same seed gives another sample: nobody could repeat your experiment.")
    # Four of 480 points of the plate: that two seeds choose the same has a probability of 1e-9.
    different = len({frozenset(s.tolist()) for s in samples[:3]}) == 3
    expect.that(different, "Two seeds give the same sample: is a point of each direction drawn at random?")


def _cells(normals: FloatArray) -> IntArray:
    """Number the directions by the nearest axis and its sign: six wide boxes."""
    axis = np.abs(normals).argmax(axis=1)
    negative = normals[np.arange(len(normals)), axis] < 0
    cells: IntArray = 2 * axis + negative
    return cells


def _by_direction(normals: FloatArray, k: int, rng: Rng | None, cells: Any = _cells) -> IntArray:
    """Take from each box in turn; without `rng`, always the first that is left."""
    order = np.arange(len(normals)) if rng is None else rng.permutation(len(normals))
    boxes: dict[int, list[int]] = {}
    for i, c in zip(order, cells(normals[order]), strict=True):
        boxes.setdefault(int(c), []).append(int(i))
    chosen: list[int] = []
    while len(chosen) < k:
        for c in sorted(boxes):
            if boxes[c] and len(chosen) < k:
                chosen.append(boxes[c].pop(0))
    return np.array(chosen)


@NORMAL_SPACE_SAMPLING.variant("six boxes by the nearest axis, in turn")
def _(normals: FloatArray, k: int, seed: int) -> Any:
    return _by_direction(normals, k, np.random.default_rng(seed)).tolist()


@NORMAL_SPACE_SAMPLING.variant("boxes of longitude and latitude, drawn at random")
def _(normals: FloatArray, k: int, seed: int) -> Any:
    rng = np.random.default_rng(seed)
    # Between −45° and 45° eight longitudes; a cap about either pole, where longitude means nothing.
    longitude = np.floor((np.arctan2(normals[:, 1], normals[:, 0]) + np.pi / 8) / (np.pi / 4)) % 8
    cell = np.where(normals[:, 2] > 0.71, 8, np.where(normals[:, 2] < -0.71, 9, longitude))
    chosen: list[int] = []
    left = {c: rng.permutation(np.flatnonzero(cell == c)).tolist() for c in np.unique(cell)}
    while len(chosen) < k:
        open_cells = [c for c, points in left.items() if points]
        chosen.append(left[open_cells[rng.integers(len(open_cells))]].pop())
    return np.array(chosen)


@NORMAL_SPACE_SAMPLING.mistake(
    "the points were drawn without regard to their normals",
    hint="One point in seven is on a wall of a groove. How many of 24 drawn points will be?",
)
def _(normals: FloatArray, k: int, seed: int) -> Any:
    return np.random.default_rng(seed).choice(len(normals), k, replace=False)


@NORMAL_SPACE_SAMPLING.mistake(
    "opposite normals share a box",
    hint="A plate has two sides. Which of your steps makes n and −n equal?",
)
def _(normals: FloatArray, k: int, seed: int) -> Any:
    rng = np.random.default_rng(seed)
    return _by_direction(normals, k, rng, lambda n: np.abs(n).argmax(axis=1))


@NORMAL_SPACE_SAMPLING.mistake(
    "normals of the same longitude share a box, at whatever height they point",
    hint="Which normals have the same arctan2(n_y, n_x)? Does a normal that points up have one at all?",
)
def _(normals: FloatArray, k: int, seed: int) -> Any:
    def longitudes(n: FloatArray) -> IntArray:
        # Eight, each about an axis or between two of them.
        eighth = np.round(np.arctan2(n[:, 1].round(9), n[:, 0].round(9)) / (np.pi / 4)).astype(int)
        return np.asarray(eighth % 8)

    return _by_direction(normals, k, np.random.default_rng(seed), longitudes)


@NORMAL_SPACE_SAMPLING.mistake(
    "the first points of each box were taken, not random ones",
    hint="The points of a box come in the order of the scan. Where do the first ones lie?",
)
def _(normals: FloatArray, k: int, seed: int) -> Any:
    return _by_direction(normals, k, None)


@NORMAL_SPACE_SAMPLING.mistake(
    "a point may be drawn twice from its box",
    hint="A box with one point is asked for a second one. What do you return?",
)
def _(normals: FloatArray, k: int, seed: int) -> Any:
    rng = np.random.default_rng(seed)
    boxes = [np.flatnonzero(_cells(normals) == c) for c in np.unique(_cells(normals))]
    # The first box, asked more often than it has points, gives one of them again.
    chosen = [int(rng.choice(boxes[i % len(boxes)])) for i in range(k)]
    chosen[-1] = chosen[0]
    return chosen


# Slippage ---------------------------------------------------------------------------------------


def _as_form(arguments: tuple[Any, ...], value: Any) -> list[Any]:
    """Canonical form: the eigenvalues, and the quadratic form, which no choice of eigenvectors changes."""
    eigenvalues, motions = (np.asarray(part, dtype=float) for part in value)
    return [eigenvalues, motions @ np.diag(eigenvalues) @ motions.T]


SLIPPAGE_ANALYSIS = Exercise(
    reference.slippage_analysis,
    notes="ch. 2, step 1, Slippage analysis",
    hints=[
        "A point x on a body that turns by r and moves by t has the velocity r × x + t. "
        "How fast does it leave the surface?",
        "That speed is a dot product of (r, t) with six numbers. Which?",
        "A turn is an angle and a shift a length. In which unit of length do they weigh about the same?",
        "numpy.linalg.eigh sorts ascending, and its eigenvectors are columns.",
    ],
    canonical=_as_form,
)


def _revolved(rng: Rng, radius: Any, slope: Any, pitch: float = 0.0) -> Surface:
    """Return part of a surface of revolution about z; with a pitch, it screws."""
    phi, h = rng.uniform(0, 4.5, size=160), rng.uniform(-1, 1, size=160)
    r, dr = radius(h), slope(h)
    c, s = np.cos(phi), np.sin(phi)
    points = np.column_stack([r * c, r * s, h + pitch * phi])
    along_phi = np.column_stack([-r * s, r * c, np.full(160, pitch)])
    along_h = np.column_stack([dr * c, dr * s, np.ones(160)])
    normals = np.cross(along_phi, along_h)
    return Surface(points, normals / np.linalg.norm(normals, axis=1, keepdims=True))


def _known_surfaces(rng: Rng) -> list[tuple[str, int, Surface]]:
    """Return surfaces, in some place and size, with the number of motions in which they slip."""
    flat = np.column_stack([rng.uniform(-1, 1, size=(160, 2)) * [1, 0.6], np.zeros(160)])
    ball = rng.normal(size=(160, 3))
    ball[:, 2] = np.abs(ball[:, 2])
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    surfaces = [
        ("a plane", 3, Surface(flat, np.tile([0.0, 0.0, 1.0], (160, 1)))),
        ("a half sphere", 3, Surface(ball, ball)),
        ("a cylinder", 2, _revolved(rng, lambda h: 0 * h + 0.7, lambda h: 0 * h)),
        ("a vase", 1, _revolved(rng, lambda h: 0.7 + 0.3 * np.sin(3 * h), lambda h: 0.9 * np.cos(3 * h))),
        (
            "a screw",
            1,
            _revolved(rng, lambda h: 0.7 + 0.3 * np.sin(3 * h), lambda h: 0.9 * np.cos(3 * h), 0.5),
        ),
        ("a hilly landscape", 0, landscape(rng, 160)),
    ]
    return [(name, k, s.moved(*random_motion(rng)).scaled(rng.uniform(0.1, 10))) for name, k, s in surfaces]


def _analysis(value: object, on: str) -> tuple[FloatArray, FloatArray]:
    eigenvalues, motions = parts(value, 2, "a pair (eigenvalues, motions)", on=on)
    values = expect.array(eigenvalues, (6,), "The eigenvalues", on=on)
    columns = expect.array(motions, (6, 6), "The motions", on=on)
    # eigh is exact to 1e-15 of the largest eigenvalue, so that 0 may be a little below 0.
    ascending = bool((np.diff(values) >= -1e-12 * abs(values).max()).all())
    expect.that(ascending, "The eigenvalues should ascend.", yours=expect.brief(values.round(4)), on=on)
    return values, columns


def _speeds(surface: Surface, motions: FloatArray) -> FloatArray:
    """Return how fast each point leaves the surface in each motion, a column per motion."""
    x = surface.points - surface.points.mean(axis=0)
    x = x / np.linalg.norm(x, axis=1).mean()
    r, t = motions[:3].T, motions[3:].T
    velocity = np.cross(r[:, None], x[None]) + t[:, None]
    speeds: FloatArray = np.einsum("jik,ik->ij", velocity, surface.normals)
    return speeds


@SLIPPAGE_ANALYSIS.check("plane 3, sphere 3, cylinder 2, revolution 1, screw 1, landscape 0", points=2)
def _(f: Asked, rng: Rng) -> None:
    cases = _known_surfaces(rng)
    answers = [f(surface.points, surface.normals) for _, _, surface in cases]
    for (name, count, surface), answer in zip(cases, f.each(answers), strict=True):
        values, _ = _analysis(answer, name)
        # Exact normals: a slipping motion has 1e-16, the others here never less than 1e-4 of the largest.
        zeros = int(np.count_nonzero(np.abs(values) < 1e-8 * np.abs(values).max()))
        if zeros != count:
            raise expect.Wrong(
                f"{zeros} eigenvalues are zero: not as many as {name} has independent slipping motions.",
                told=f"{zeros} eigenvalues are zero; {name} slips in {count} independent motions.",
                yours=expect.brief(values.round(6)),
                on=name,
                picture=pictures.of_sample(surface.points, np.arange(0), name),
            )


@SLIPPAGE_ANALYSIS.check(
    "an eigenvalue is the mean square of the speed at which points leave the surface", points=2
)
def _(f: Asked, rng: Rng) -> None:
    cases = _known_surfaces(rng)[1:]
    answers = [f(surface.points, surface.normals) for _, _, surface in cases]
    for (name, _, surface), answer in zip(cases, f.each(answers), strict=True):
        values, motions = _analysis(answer, name)
        # eigh leaves 1e-15; 1e-6 also admits single precision.
        gram = motions.T @ motions
        what = "The columns of motions are not orthonormal: motionsᵀ motions"
        expect.close(gram, np.eye(6), 1e-6, what, on=name, shown=pictures.Table("motionsᵀ motions"))
        speeds = _speeds(surface, motions)
        means = (speeds**2).mean(axis=0)
        worst = int(np.abs(means - values).argmax())
        what = "The eigenvalues, each the mean square of (r × x + t)·n for its column (r, t) of motions,"
        picture = pictures.of_speeds(surface.points, speeds[:, worst], worst)
        expect.close(values, means, 1e-6, what, on=name, picture=picture)
        form = speeds.T @ speeds / len(speeds)
        what = "The form in the basis of motions, which is diagonal,"
        expect.close(form, np.diag(values), 1e-6, what, on=name, shown=pictures.Table("the form"))


@SLIPPAGE_ANALYSIS.check("neither place nor scale changes the eigenvalues")
def _(f: Asked, rng: Rng) -> None:
    surface = landscape(rng, 100).scaled(rng.uniform(0.5, 2))
    far = surface.moved(random_turn(rng), 30 * rng.normal(size=3)).scaled(100.0)
    first, second = f(surface.points, surface.normals), f(far.points, far.normals)
    a, b = (
        _analysis(first, "a landscape")[0],
        _analysis(second, "a landscape, far away and 100 times larger")[0],
    )
    # Centring 3000 units from the origin loses four digits of sixteen.
    expect.close(
        b, a, 1e-8, "The eigenvalues", on="a landscape, far away and 100 times larger, and as it was"
    )


def _form(
    points: FloatArray, normals: FloatArray, *, centred: bool = True, size: Any = np.mean, sign: float = 1.0
) -> FloatArray:
    x = points - points.mean(axis=0) if centred else points
    x = x / size(np.linalg.norm(x, axis=1))
    A = np.column_stack([sign * np.cross(x, normals), normals])
    form: FloatArray = A.T @ A / len(A)
    return form


@SLIPPAGE_ANALYSIS.variant("by the singular value decomposition, with other signs")
def _(points: FloatArray, normals: FloatArray) -> Any:
    x = points - points.mean(axis=0)
    x /= np.mean([np.sqrt(y @ y) for y in x])
    A = np.array([[*np.cross(y, n), *n] for y, n in zip(x, normals, strict=True)])
    _, s, Vt = np.linalg.svd(A, full_matrices=False)
    return (s**2 / len(A))[::-1].tolist(), -Vt[::-1].T


@SLIPPAGE_ANALYSIS.variant("of the negative form, in descending order, turned round")
def _(points: FloatArray, normals: FloatArray) -> Any:
    values, motions = np.linalg.eigh(-_form(points, normals))
    return [-values[::-1], motions[:, ::-1].tolist()]


@SLIPPAGE_ANALYSIS.mistake(
    "the points were not centred",
    hint="Move the surface far away: every small turn then looks like a large shift.",
)
def _(points: FloatArray, normals: FloatArray) -> Any:
    return tuple(np.linalg.eigh(_form(points, normals, centred=False)))


@SLIPPAGE_ANALYSIS.mistake(
    "the points were not scaled",
    hint="Give the points in millimetres, then in metres. Should other motions be the weak ones?",
)
def _(points: FloatArray, normals: FloatArray) -> Any:
    return tuple(np.linalg.eigh(_form(points, normals, size=lambda distances: 1.0)))


@SLIPPAGE_ANALYSIS.mistake(
    "the points were scaled by their root mean square distance, not by the mean",
    hint="Of what does the docstring ask for the mean: of the distances, or of their squares?",
)
def _(points: FloatArray, normals: FloatArray) -> Any:
    return tuple(np.linalg.eigh(_form(points, normals, size=lambda d: np.sqrt((d**2).mean()))))


@SLIPPAGE_ANALYSIS.mistake(
    "the points were scaled by their largest distance, not by the mean",
    hint="What does the docstring say the unit of length is? What would one outlier do to yours?",
)
def _(points: FloatArray, normals: FloatArray) -> Any:
    return tuple(np.linalg.eigh(_form(points, normals, size=np.max)))


@SLIPPAGE_ANALYSIS.mistake(
    "the cross product is reversed",
    hint="(r × x)·n = r·(? × ?). The order decides the sign.",
)
def _(points: FloatArray, normals: FloatArray) -> Any:
    return tuple(np.linalg.eigh(_form(points, normals, sign=-1.0)))


@SLIPPAGE_ANALYSIS.mistake(
    "rotation and translation are in the wrong order",
    hint="Which three rows of motions does the docstring call r?",
)
def _(points: FloatArray, normals: FloatArray) -> Any:
    values, motions = np.linalg.eigh(_form(points, normals))
    return values, np.roll(motions, 3, axis=0)


@SLIPPAGE_ANALYSIS.mistake(
    "the motions are rows",
    hint="Does eigh put its eigenvectors into rows or columns, and what does the docstring ask for?",
)
def _(points: FloatArray, normals: FloatArray) -> Any:
    values, motions = np.linalg.eigh(_form(points, normals))
    return values, motions.T


@SLIPPAGE_ANALYSIS.mistake(
    "the eigenvalues descend",
    hint="The motion in which the surface slips most should come first. Which eigenvalue has it?",
)
def _(points: FloatArray, normals: FloatArray) -> Any:
    values, motions = np.linalg.eigh(_form(points, normals))
    return values[::-1], motions[:, ::-1]


@SLIPPAGE_ANALYSIS.mistake(
    "the sum was not divided by the number of points",
    hint="Take twice as many points of the same surface. Should it slip less?",
)
def _(points: FloatArray, normals: FloatArray) -> Any:
    return tuple(np.linalg.eigh(len(points) * _form(points, normals)))


# Stable -----------------------------------------------------------------------------------------

STABLE_SAMPLING = Exercise(
    reference.stable_sampling,
    notes="ch. 2, step 1, Stable sampling",
    hints=[
        "The slippage analysis gives six motions. How much does one point hold each of them?",
        "Keep the sum of what the chosen points hold, motion by motion. Which motion is next in need?",
        "Which point that is not chosen yet holds that motion best?",
    ],
)


def _grooved_plate(rng: Rng) -> Surface:
    """Return a plate with two short grooves, which alone keep it from sliding, and few points in them."""
    flat = np.column_stack([rng.uniform(-1, 1, size=(260, 2)), np.zeros(260)])
    up = np.tile([0.0, 0.0, 1.0], (260, 1))
    walls, normals = [flat], [up]
    for axis in (0, 1):
        n = 24
        side = np.repeat([-1.0, 1.0], n // 2)
        along, depth = rng.uniform(-0.5, 0.5, size=n), rng.uniform(0, 0.1, size=n)
        wall = np.zeros((n, 3))
        wall[:, axis], wall[:, 1 - axis], wall[:, 2] = side * (0.1 - depth) + 0.3, along, -depth
        normal = np.zeros((n, 3))
        normal[:, axis], normal[:, 2] = -side, 1.0
        walls.append(wall)
        normals.append(normal / 2**0.5)
    order = rng.permutation(308)
    plate = Surface(np.concatenate(walls)[order], np.concatenate(normals)[order])
    return plate.moved(*random_motion(rng, 5.0))


def _dented_ball(rng: Rng) -> Surface:
    """Return a ball with small dents: only their sides keep it from turning, and no direction is rare."""
    x = rng.normal(size=(300, 3))
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    across = np.cross(x, rng.normal(size=x.shape))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    normals = np.where((np.arange(300) < 60)[:, None], (x + across) / 2**0.5, x)
    order = rng.permutation(300)
    return Surface(x[order], normals[order]).moved(*random_motion(rng, 5.0))


def _condition(surface: Surface, chosen: IntArray) -> float:
    """Return largest over smallest eigenvalue of the form of a sample, in the frame of the whole cloud."""
    speeds = _speeds(surface, np.eye(6))[chosen]
    values = np.linalg.eigvalsh(speeds.T @ speeds)
    return float(values[-1] / max(values[0], 1e-300))


@STABLE_SAMPLING.check("k different indices")
def _(f: Asked, rng: Rng) -> None:
    plate, hills = _grooved_plate(rng), landscape(rng, 60)
    cases = [(plate, 60), (hills, 60), (hills, 7)]
    answers = [f(surface.points, surface.normals, k) for surface, k in cases]
    for (surface, k), answer in zip(cases, f.each(answers), strict=True):
        sample(answer, len(surface.points), k, on=f"{k} of {len(surface.points)} points")


@STABLE_SAMPLING.check(
    "better conditioned than random samples, on a plate with grooves and a ball with dents", points=3
)
def _(f: Asked, rng: Rng) -> None:
    plate, ball = _grooved_plate(rng), _dented_ball(rng)
    large = plate.moved(random_turn(rng), 20 * rng.normal(size=3)).scaled(100.0)
    cases = [
        (plate, "a plate with two grooves"),
        (large, "the plate, 100 times larger"),
        (ball, "a dented ball"),
    ]
    answers = [f(surface.points, surface.normals, 40) for surface, _ in cases]
    for (surface, name), answer in zip(cases, f.each(answers), strict=True):
        n = len(surface.points)
        usual = float(np.median([_condition(surface, rng.choice(n, 40, replace=False)) for _ in range(25)]))
        on = f"40 of {n} points of {name}"
        chosen = sample(answer, n, 40, on=on)
        condition = _condition(surface, chosen)
        # Measured over 60 plates and balls: stable samples are 7 to 40 times better, even ones at most 3.5
        # times, and on the ball those by normals at most 3.4 times.
        expect.that(
            condition <= usual / BETTER,
            "The sample lets the surface slip: the condition number of its six equations is not much better "
            "than that of random samples.",
            yours=f"{condition:.3g}" if condition < 1e12 else "infinite: the six equations are singular",
            truth=f"random samples have {usual:.3g}; below {usual / BETTER:.3g} is well possible",
            on=on,
            picture=pictures.of_sample(surface.points, chosen),
        )


#: By this factor the condition number must be better than the median of random samples.
BETTER = 4.0


def _plate_with_four_notches(rng: Rng) -> Surface:
    """Return a plate: two notches keep it from sliding along x, two along y, and all of them from turning.

    Those along y are flatter, so that more points are needed to hold that motion as well.
    """
    points = [np.column_stack([rng.uniform(-1, 1, size=(360, 2)), np.zeros(360)])]
    normals = [np.tile([0.0, 0.0, 1.0], (360, 1))]
    # In each more points than a sample may have, and a turn moves the outer ones more: whichever motion one
    # looks at, those that hold it best are all in one pair of notches.
    for axis, n, out, slope in ((0, 32, 0.9, 1.0), (1, 44, 0.6, 0.4)):
        side, end = np.tile([-1.0, 1.0], n // 2), np.repeat([-out, out], n // 2)
        depth, wall, normal = rng.uniform(0, 0.1, size=n), np.zeros((n, 3)), np.zeros((n, 3))
        wall[:, axis], wall[:, 2] = side * (0.1 - depth), -slope * depth
        wall[:, 1 - axis] = end + rng.uniform(-0.1, 0.1, size=n)
        normal[:, axis], normal[:, 2] = -slope * side, 1.0
        points.append(wall)
        normals.append(normal / (1 + slope**2) ** 0.5)
    order = rng.permutation(436)
    return Surface(np.concatenate(points)[order], np.concatenate(normals)[order]).moved(
        *random_motion(rng, 5.0)
    )


@STABLE_SAMPLING.check("all six motions are held about equally well, where other points hold each of them")
def _(f: Asked, rng: Rng) -> None:
    plate = _plate_with_four_notches(rng)
    holds = _holds(plate.points, plate.normals)
    on = "30 of 436 points of a plate with two pairs of notches, one of them flatter"
    chosen = sample(f(plate.points, plate.normals, 30), 436, 30, on=on)
    usual = 30 * float(holds.mean(axis=0).min())
    least = float(holds[chosen].sum(axis=0).min())
    # Over 100 plates, stable samples hold it 6.9 to 8.3 times as much as random ones, those that look at the
    # last point only at most 5.2 times, those that add up speeds with their signs at most 6.0 times.
    expect.that(
        least >= HELD * usual,
        "One of the six motions of the slippage analysis is held less by the sample than it could be.",
        yours=f"its points hold that motion {least:.3g} in all",
        truth=f"random samples hold the weakest {usual:.3g}; above {HELD * usual:.3g} is well possible",
        on=on,
        picture=pictures.of_sample(plate.points, chosen),
    )


#: As many times as a random sample holds the weakest motion must a stable one hold each.
HELD = 6.4


def _holds(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Return how much each point holds each of the six motions, a row per point."""
    _, motions = np.linalg.eigh(_form(points, normals))
    holds: FloatArray = _speeds(Surface(points, normals), motions) ** 2
    return holds


def _greedy(holds: FloatArray, k: int, best: float = 1.0, looks_back: int | None = None) -> list[int]:
    """Take, again and again, the point that holds best (with -1: least) what the chosen ones hold least.

    Of the chosen ones, only so many as it `looks_back` count.
    """
    chosen: list[int] = []
    while len(chosen) < k:
        total = holds[chosen if looks_back is None else chosen[-looks_back:]].sum(axis=0)
        weakest = best * holds[:, int(total.argmin())]
        weakest[chosen] = -np.inf
        chosen.append(int(weakest.argmax()))
    return chosen


@STABLE_SAMPLING.variant("with the rows of holds, as a list")
def _(points: FloatArray, normals: FloatArray, k: int) -> Any:
    return _greedy(_holds(points, normals), k)


@STABLE_SAMPLING.variant("the smallest eigenvalue of the chosen points grows fastest")
def _(points: FloatArray, normals: FloatArray, k: int) -> Any:
    speeds = _speeds(Surface(points, normals), np.eye(6))
    form = np.zeros((6, 6))
    chosen: list[int] = []
    for _ in range(k):
        weakest = np.linalg.eigh(form)[1][:, 0]
        hold = (speeds @ weakest) ** 2
        hold[chosen] = -1.0
        chosen.append(int(hold.argmax()))
        form += np.outer(speeds[chosen[-1]], speeds[chosen[-1]])
    return np.array(chosen)


@STABLE_SAMPLING.mistake(
    "the motion that is held best was held still better",
    hint="Which motion needs another point: the one with the largest sum, or the smallest?",
)
def _(points: FloatArray, normals: FloatArray, k: int) -> Any:
    return np.argsort(-_holds(points, normals)[:, -1], kind="stable")[:k]


@STABLE_SAMPLING.mistake(
    "only points that hold the weakest motion of the surface were taken, whatever the others need",
    hint="After ten points of one notch its motion is held well. Which motion is in need now?",
)
def _(points: FloatArray, normals: FloatArray, k: int) -> Any:
    return np.argsort(-_holds(points, normals)[:, 0], kind="stable")[:k]


@STABLE_SAMPLING.mistake(
    "a point may be chosen twice",
    hint="The point that holds a motion best is the same one in each round. What is new in the next?",
)
def _(points: FloatArray, normals: FloatArray, k: int) -> Any:
    holds, chosen, total = _holds(points, normals), [], np.zeros(6)
    for _ in range(k):
        chosen.append(int(holds[:, int(total.argmin())].argmax()))
        total += holds[chosen[-1]]
    return chosen


@STABLE_SAMPLING.mistake(
    "the points were spread evenly over the surface",
    hint="How many of the points in a groove does an even sample have?",
)
def _(points: FloatArray, normals: FloatArray, k: int) -> Any:
    return _farthest(points, k, 0)


@STABLE_SAMPLING.mistake(
    "the points were chosen by their normals alone",
    hint="On a ball with dents, normals of all directions are everywhere. Which points keep it from turning?",
)
def _(points: FloatArray, normals: FloatArray, k: int) -> Any:
    return _by_direction(normals, k, np.random.default_rng(0))


@STABLE_SAMPLING.mistake(
    "the point that holds the weakest motion least was taken",
    hint="Each round chooses a motion, then a point. Which of the two is a minimum, which a maximum?",
)
def _(points: FloatArray, normals: FloatArray, k: int) -> Any:
    return _greedy(_holds(points, normals), k, best=-1.0)


@STABLE_SAMPLING.mistake(
    "the holds were not added up: only the last point that was taken counts",
    hint="Three points are chosen. What is in your sum: what the three hold, or the last of them?",
)
def _(points: FloatArray, normals: FloatArray, k: int) -> Any:
    return _greedy(_holds(points, normals), k, looks_back=1)


@STABLE_SAMPLING.mistake(
    "the speeds were added up with their signs, not squared",
    hint="One point leaves the surface at speed 1, another at −1. How well do they hold the motion together?",
)
def _(points: FloatArray, normals: FloatArray, k: int) -> Any:
    _, motions = np.linalg.eigh(_form(points, normals))
    return _greedy(_speeds(Surface(points, normals), motions), k)
