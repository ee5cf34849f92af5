"""Exercises on matching, and on the rejection of bad pairs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from gpcourse.exercises import expect
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Asked
from gpcourse.exercises.registration import pictures
from gpcourse.exercises.registration.inputs import (
    Rng,
    brute_force,
    mask,
    moved,
    parts,
    random_motion,
    random_turn,
    turn,
)
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray
from gpcourse.reference import registration as reference

# Nearest neighbours -----------------------------------------------------------------------------


def _as_found(arguments: tuple[Any, ...], value: Any) -> list[Any]:
    """Canonical form: where two points are equally near, either may be named."""
    points, queries = np.asarray(arguments[0]), np.asarray(arguments[1])
    distances, indices, visited = value
    index = np.asarray(indices, dtype=int)
    inside = (index >= 0) & (index < len(points))
    apart = np.linalg.norm(queries - points[np.where(inside, index, 0)], axis=1)
    # Two trees visit different numbers of points: only whether they are few, and differ much from query to
    # query, and add up, counts.
    seen = np.asarray(visited, dtype=float)
    share = float(seen.mean()) / len(points)
    uneven = bool(share > 0.1 and len(points) > 1000 and seen.std() > 0.5 * seen.mean())
    many = [share > 0.1, share > 0.9, uneven, bool((np.diff(seen) > 0).all() and len(seen) > 4)]
    return [np.asarray(distances, dtype=float), np.where(inside, apart, -1.0), many]


NEAREST_NEIGHBOURS = Exercise(
    reference.nearest_neighbours,
    notes="ch. 2, step 2",
    hints=[
        "Cut the points in two halves along one axis, and each half again, until few are left.",
        "Go down to the query's own box first: what is found there is a bound for all other boxes.",
        "How far is the query from the cutting plane? Compare lengths with lengths, or squares with squares.",
        "Many points may have the same coordinate, or the same place. Does your cutting still end?",
    ],
    canonical=_as_found,
    time_limit=4.0,
)

Found = tuple[FloatArray, IntArray, IntArray]


def _found(value: object, n: int, m: int, on: str) -> Found:
    distances, indices, visited = parts(value, 3, "three arrays (distances, indices, visited)", on=on)
    d = expect.array(distances, (m,), "The array of distances", on=on)
    i = expect.indices(indices, "The array of indices", on=on)
    expect.that(len(i) == m, f"There are {len(i)} indices for {m} queries.", on=on)
    inside = bool(((i >= 0) & (i < n)).all())
    expect.that(inside, f"An index is outside 0 … {n - 1}.", yours=expect.brief(i), on=on)
    v = expect.indices(visited, "The array of visited points", on=on)
    expect.that(len(v) == m, f"There are {len(v)} numbers of visited points for {m} queries.", on=on)
    return d, i, v


def _expect_nearest(value: object, points: FloatArray, queries: FloatArray, on: str) -> Found:
    d, i, v = _found(value, len(points), len(queries), on)
    truth = brute_force(points, queries)
    least = truth.min(axis=1)
    size = float(np.abs(points).max() + np.abs(queries).max())
    # Another order of summing changes 1e-16 of the coordinates; ‖x‖² + ‖y‖² − 2x·y loses half the digits.
    slack = 1e-9 * size
    chosen = truth[np.arange(len(i)), i]
    far = np.flatnonzero(~(chosen <= least + slack))
    if len(far):
        w = int(far[0])
        nearest = int(truth[w].argmin())
        raise expect.Wrong(
            f"Query {w} has a nearer point than the one that was found"
            f" ({len(far)} of {len(queries)} queries are wrong).",
            yours=f"point {i[w]}, at distance {chosen[w]:.4g}",
            truth=f"there is one at distance {least[w]:.4g}",
            on=on,
            **pictures.of_neighbour(points, queries[w], int(i[w]), nearest),
        )
    shown = pictures.Field(queries, None, "distance", item="query")
    expect.close(d, least, slack, "The distances", on=on, shown=shown)
    none = "Some queries visited no point: a distance to at least one point must be computed."
    expect.that(bool((v >= 1).all()), none, yours=expect.brief(v), on=on)
    return d, i, v


def _cloud(rng: Rng, n: int) -> FloatArray:
    """Return points on a folded sheet, with gaps, so that boxes are of all shapes."""
    u = rng.uniform(-1, 1, size=(n, 2))
    sheet = np.column_stack([u[:, 0], np.sin(4 * u[:, 0]) * 0.3, u[:, 1] * 0.5])
    return moved(sheet, random_turn(rng), rng.normal(size=3))


def _queries(rng: Rng, points: FloatArray, m: int) -> FloatArray:
    """Return queries near the points, among them and on them."""
    near = points[rng.choice(len(points), m)]
    size = np.ptp(points, axis=0).max()
    queries: FloatArray = near + size * rng.normal(size=(m, 3)) * rng.choice(
        [0.0, 0.03, 0.3, 1.0], size=(m, 1)
    )
    return queries


@NEAREST_NEIGHBOURS.check("the same points as by comparing with all", points=2)
def _(f: Asked, rng: Rng) -> None:
    points = _cloud(rng, 150)
    queries = _queries(rng, points, 24)
    small = _cloud(rng, 3)
    asked = ((points, queries), (small, queries[:4]))
    answers = [f(*arguments) for arguments in asked]
    for (cloud, some), answer in zip(asked, f.each(answers), strict=True):
        _expect_nearest(answer, cloud, some, f"{len(cloud)} points, {len(some)} queries")


@NEAREST_NEIGHBOURS.check("at scale 100 and 0.01", points=2)
def _(f: Asked, rng: Rng) -> None:
    cases = []
    for scale in (100.0, 0.01):
        points = scale * _cloud(rng, 150)
        cases.append((scale, points, _queries(rng, points, 24)))
    answers = [f(points, queries) for _, points, queries in cases]
    for (scale, points, queries), answer in zip(cases, f.each(answers), strict=True):
        _expect_nearest(answer, points, queries, f"points of size {scale:g}")


@NEAREST_NEIGHBOURS.check("points that coincide, and points on a line")
def _(f: Asked, rng: Rng) -> None:
    points = _cloud(rng, 12)
    many = points[rng.integers(0, 12, size=90)]
    line = np.round(rng.uniform(-1, 1, size=(60, 1)), 1) * np.eye(3)[rng.integers(3)] + rng.normal(size=3)
    one = np.tile(rng.normal(size=3), (40, 1))
    cases = [
        (cloud, _queries(rng, cloud, 8) + 0.1 * rng.normal(size=(8, 3)), on)
        for cloud, on in (
            (many, "90 points in 12 places"),
            (line, "60 points on a line along an axis, some of them equal"),
            (one, "40 points in one place"),
        )
    ]
    answers = [f(cloud, queries, 4) for cloud, queries, _ in cases]
    for (cloud, queries, on), answer in zip(cases, f.each(answers), strict=True):
        _expect_nearest(answer, cloud, queries, on)


@NEAREST_NEIGHBOURS.check("few points are visited: under 10 % of 1500", points=2)
def _(f: Asked, rng: Rng) -> None:
    # A box that is thin along x: boxes that are cut across x only would all be slices.
    points = rng.uniform(size=(1500, 3)) * [0.25, 1.0, 1.0]
    queries = rng.uniform(size=(20, 3)) * [0.25, 1.0, 1.0]
    answers = [f(scale * points, scale * queries) for scale in (1.0, 30.0)]
    for scale, answer in zip((1.0, 30.0), f.each(answers), strict=True):
        on = f"1500 points spread evenly in a flat box of size {scale:g}"
        _, _, visited = _expect_nearest(answer, scale * points, scale * queries, on)
        share = float(visited.mean()) / len(points)
        message = "The tree saves too little: distances to too many points were computed."
        expect.that(share < 0.1, message, yours=f"{share:.0%} on average", truth="below 10 %", on=on)


@dataclass
class _Tree:
    """A k-d tree with the places where students go wrong left open."""

    points: FloatArray
    leaf_size: int
    axis: Callable[[FloatArray, int], int] = lambda inside, depth: depth % 3
    by_value: bool = False
    prune: Callable[[float, float], bool] = lambda beyond, best: abs(beyond) >= best
    both_sides: bool = True
    root: Any = field(init=False)

    def __post_init__(self) -> None:
        self.root = self._build(np.arange(len(self.points)), 0)

    def _build(self, indices: IntArray, depth: int) -> Any:
        if len(indices) <= self.leaf_size:
            return indices
        inside = self.points[indices]
        axis = self.axis(inside, depth)
        x = inside[:, axis]
        if self.by_value:
            below = x < np.median(x)
            if not below.any() and len(np.unique(inside, axis=0)) == 1:
                raise RecursionError("maximum recursion depth exceeded")
            if depth > 60:
                raise RecursionError("maximum recursion depth exceeded")
            value = float(np.median(x))
            parts = indices[below], indices[~below]
        else:
            order = np.argsort(x, kind="stable")
            half = len(order) // 2
            value = float(x[order[half]])
            parts = indices[order[:half]], indices[order[half:]]
        return axis, value, self._build(parts[0], depth + 1), self._build(parts[1], depth + 1)

    def nearest(self, query: FloatArray) -> tuple[float, int, int]:
        self.best, self.index, self.visited = np.inf, -1, 0
        self._search(self.root, query)
        return self.best, self.index, self.visited

    def _search(self, node: Any, query: FloatArray) -> None:
        if not isinstance(node, tuple):
            if len(node):
                d = np.linalg.norm(self.points[node] - query, axis=1)
                i = int(d.argmin())
                self.visited += len(node)
                if d[i] < self.best:
                    self.best, self.index = float(d[i]), int(node[i])
            return
        axis, value, below, above = node
        beyond = float(query[axis] - value)
        near, far = (below, above) if beyond < 0 else (above, below)
        self._search(near, query)
        if self.both_sides and not self.prune(beyond, self.best):
            self._search(far, query)


def _all(tree: _Tree, queries: FloatArray) -> tuple[FloatArray, IntArray, IntArray]:
    found = [tree.nearest(query) for query in np.asarray(queries)]
    d, i, v = (np.array(column) for column in zip(*found, strict=True))
    return d, i, v


class _Remembering(_Tree):
    """Keeps the best of one query for the next."""

    best, index = np.inf, -1

    def nearest(self, query: FloatArray) -> tuple[float, int, int]:
        self.visited = 0
        self._search(self.root, query)
        return self.best, self.index, self.visited


class _OneAxisOff(_Tree):
    """Counts the axes from another start when it searches."""

    def _search(self, node: Any, query: FloatArray) -> None:
        if isinstance(node, tuple):
            node = ((node[0] + 1) % 3, *node[1:])
        super()._search(node, query)


@NEAREST_NEIGHBOURS.variant("axes in turn, the median by sorting")
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    return [column.tolist() for column in _all(_Tree(points, leaf_size), queries)]


@NEAREST_NEIGHBOURS.variant("the longest side of the box, squares compared with squares, float indices")
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    tree = _Tree(
        points,
        max(1, leaf_size // 2),
        axis=lambda inside, depth: int(np.ptp(inside, axis=0).argmax()),
        prune=lambda beyond, best: beyond * beyond > best * best,
    )
    d, i, v = _all(tree, queries)
    return d, i.astype(float), v[:, None]


@NEAREST_NEIGHBOURS.mistake(
    "only the query's own side of each cut was visited",
    hint="A query close to a cutting plane: may its nearest point lie on the other side?",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    return _all(_Tree(points, leaf_size, both_sides=False), queries)


@NEAREST_NEIGHBOURS.mistake(
    "the distance to the plane was compared with a squared distance",
    hint="Try points of size 0.01: a squared length is then far smaller than the length.",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    return _all(_Tree(points, leaf_size, prune=lambda beyond, best: abs(beyond) >= best**2), queries)


@NEAREST_NEIGHBOURS.mistake(
    "the squared distance to the plane was compared with a distance",
    hint="Try points of size 100: a squared length is then far larger than the length.",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    return _all(_Tree(points, leaf_size, prune=lambda beyond, best: beyond**2 >= best), queries)


@NEAREST_NEIGHBOURS.mistake(
    "the distance to the plane has a sign: from below, the far side was always visited",
    hint="A query far below a cutting plane: is query − value smaller than the best distance?",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    return _all(_Tree(points, leaf_size, prune=lambda beyond, best: beyond >= best), queries)


@NEAREST_NEIGHBOURS.mistake(
    "the best distance of one query was kept for the next",
    hint="What does the second query know before its search begins?",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    return _all(_Remembering(points, leaf_size), queries)


@NEAREST_NEIGHBOURS.mistake(
    "the search compares along another axis than the one that was cut",
    hint="A box was cut across x. Which coordinate of the query says on which side it lies?",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    return _all(_OneAxisOff(points, leaf_size), queries)


@NEAREST_NEIGHBOURS.mistake(
    "the squared distances were returned",
    hint="In which unit is a distance, when the points are in metres?",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    d, i, v = _all(_Tree(points, leaf_size), queries)
    return d**2, i, v


@NEAREST_NEIGHBOURS.mistake(
    "every point was compared with every query",
    hint="That finds the right points. What is the tree for?",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    d = brute_force(points, queries)
    return d.min(axis=1), d.argmin(axis=1), np.full(len(queries), len(points))


@NEAREST_NEIGHBOURS.mistake(
    "every cut is across the first axis",
    hint="What do the boxes look like after five cuts across x? Which points are near to each other in them?",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    # 0.25 / 188 thin slices: the ball about a query meets hundreds of them, which is over 10 %.
    return _all(_Tree(points, leaf_size, axis=lambda inside, depth: 0), queries)


@NEAREST_NEIGHBOURS.mistake(
    "the count of visited points was not set back between the queries",
    hint="The last query should not have visited more than the first. Where does your count start?",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    d, i, v = _all(_Tree(points, leaf_size), queries)
    return d, i, np.cumsum(v)


@NEAREST_NEIGHBOURS.mistake(
    "the cutting never ends where points coincide",
    hint="Cut 40 equal points at their median: how many are below it, and how many are not?",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    return _all(_Tree(points, leaf_size, by_value=True), queries)


@NEAREST_NEIGHBOURS.mistake(
    "the indices count within the box, not in the array that was given",
    hint="When you cut an array in two, which record still knows where a point came from?",
)
def _(points: FloatArray, queries: FloatArray, leaf_size: int = 8) -> Any:
    tree = _Tree(points, leaf_size)
    d, i, v = _all(tree, queries)
    within = np.zeros(len(points), dtype=int)

    def number(node: Any) -> None:
        if isinstance(node, tuple):
            number(node[2])
            number(node[3])
        else:
            within[node] = np.arange(len(node))

    number(tree.root)
    return d, within[i], v


# Rejection --------------------------------------------------------------------------------------

REJECT_PAIRS = Exercise(
    reference.reject_pairs,
    notes="ch. 2, step 3",
    hints=[
        "Two tests, one on lengths and one on angles. When is a pair kept: if one holds, or both?",
        "The dot product of unit vectors is the cosine of their angle. Does it rise or fall with the angle?",
    ],
)


def _pairs(rng: Rng, scale: float) -> tuple[tuple[Any, ...], BoolArray]:
    """Return pairs with known distances and angles, none close to the limits, and which to keep."""
    n = 40
    near, alike = rng.random(n) < 0.5, rng.integers(0, 3, size=n)
    near[0], alike[0] = True, 0
    limit, angle = 0.3 * scale, rng.uniform(0.5, 1.0)
    p = scale * rng.normal(size=(n, 3))
    out = rng.normal(size=(n, 3))
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    q = p + out * (limit * np.where(near, rng.uniform(0, 0.9, n), rng.uniform(1.1, 2, n)))[:, None]
    a = rng.normal(size=(n, 3))
    a /= np.linalg.norm(a, axis=1, keepdims=True)
    # Alike; too far apart; nearly opposite, as on the other side of a thin sheet.
    angles = np.choose(
        alike, [angle * rng.uniform(0, 0.9, n), rng.uniform(1.1 * angle, 1.6, n), rng.uniform(2.9, 3.1, n)]
    )
    angles[0] = 0.005  # within the limit in degrees, too
    b = np.array([turn(np.cross(x, rng.normal(size=3)), w) @ x for x, w in zip(a, angles, strict=True)])
    return (p, q, a, b, limit, angle), near & (alike == 0)


def _expect_mask(value: object, truth: BoolArray, on: str, pairs: pictures.Pairs | None = None) -> None:
    mine = mask(value, len(truth), on=on)
    expect.flags(mine, truth, ("kept", "rejected"), item="pair", on=on, shown=pairs)


@REJECT_PAIRS.check("near pairs with like normals are kept, no others", points=2)
def _(f: Asked, rng: Rng) -> None:
    cases = [_pairs(rng, scale) for scale in (1.0, 100.0, 0.01)]
    answers = [f(*arguments) for arguments, _ in cases]
    for (arguments, truth), answer in zip(cases, f.each(answers), strict=True):
        on = f"40 pairs, max_distance {arguments[4]:g}, max_angle {arguments[5]:.2f}"
        _expect_mask(answer, truth, on, pictures.Pairs(*arguments[:2]))


@REJECT_PAIRS.check("a motion of both clouds changes nothing")
def _(f: Asked, rng: Rng) -> None:
    (p, q, a, b, limit, angle), truth = _pairs(rng, 1.0)
    R, t = random_motion(rng, 20.0)
    answer = f(moved(p, R, t), moved(q, R, t), a @ R.T, b @ R.T, limit, angle)
    _expect_mask(answer, truth, "40 pairs far from the origin", pictures.Pairs(p, q))


def _tests(p: FloatArray, q: FloatArray, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    return np.linalg.norm(p - q, axis=1), np.arccos(np.clip((a * b).sum(axis=1), -1, 1))


@REJECT_PAIRS.variant("pair by pair, with arccos")
def _(p: Any, q: Any, normals_p: Any, normals_q: Any, max_distance: float, max_angle: float) -> Any:
    d, w = _tests(p, q, normals_p, normals_q)
    return [int(x <= max_distance and y <= max_angle) for x, y in zip(d, w, strict=True)]


@REJECT_PAIRS.variant("the angle from the chord, squared distances")
def _(p: Any, q: Any, normals_p: Any, normals_q: Any, max_distance: float, max_angle: float) -> Any:
    chord = np.linalg.norm(normals_p - normals_q, axis=1)
    return (((p - q) ** 2).sum(axis=1) <= max_distance**2) & (chord <= 2 * np.sin(max_angle / 2))


@REJECT_PAIRS.mistake(
    "the mask marks the rejected pairs", hint="What does True mean in the docstring: keep or reject?"
)
def _(p: Any, q: Any, normals_p: Any, normals_q: Any, max_distance: float, max_angle: float) -> Any:
    d, w = _tests(p, q, normals_p, normals_q)
    return ~((d <= max_distance) & (w <= max_angle))


@REJECT_PAIRS.mistake(
    "the cosine was compared with max_angle the wrong way round",
    hint="What is the cosine of two equal normals? Is it larger or smaller than that of your limit?",
)
def _(p: Any, q: Any, normals_p: Any, normals_q: Any, max_distance: float, max_angle: float) -> Any:
    d, w = _tests(p, q, normals_p, normals_q)
    return (d <= max_distance) & (w >= max_angle)


@REJECT_PAIRS.mistake(
    "the cosine was compared with the angle itself",
    hint="A dot product and an angle in radians are different things. Turn one into the other.",
)
def _(p: Any, q: Any, normals_p: Any, normals_q: Any, max_distance: float, max_angle: float) -> Any:
    d, w = _tests(p, q, normals_p, normals_q)
    return (d <= max_distance) & (np.cos(w) <= max_angle)


@REJECT_PAIRS.mistake(
    "the angle was measured in degrees",
    hint="max_angle is in radians. How large is a right angle in your numbers?",
)
def _(p: Any, q: Any, normals_p: Any, normals_q: Any, max_distance: float, max_angle: float) -> Any:
    d, w = _tests(p, q, normals_p, normals_q)
    return (d <= max_distance) & (np.degrees(w) <= max_angle)


@REJECT_PAIRS.mistake(
    "opposite normals were taken for like ones",
    hint="The two sides of a thin sheet: should their points be matched?",
)
def _(p: Any, q: Any, normals_p: Any, normals_q: Any, max_distance: float, max_angle: float) -> Any:
    d, w = _tests(p, q, normals_p, normals_q)
    return (d <= max_distance) & (np.minimum(w, np.pi - w) <= max_angle)


@REJECT_PAIRS.mistake(
    "a pair that passes one of the two tests was kept",
    hint="Should a near pair with opposite normals be kept?",
)
def _(p: Any, q: Any, normals_p: Any, normals_q: Any, max_distance: float, max_angle: float) -> Any:
    d, w = _tests(p, q, normals_p, normals_q)
    return (d <= max_distance) | (w <= max_angle)


@REJECT_PAIRS.mistake(
    "the squared distance was compared with max_distance",
    hint="Try the same pairs at scale 100 and 0.01: should another number of them be kept?",
)
def _(p: Any, q: Any, normals_p: Any, normals_q: Any, max_distance: float, max_angle: float) -> Any:
    d, w = _tests(p, q, normals_p, normals_q)
    return (d**2 <= max_distance) & (w <= max_angle)


@REJECT_PAIRS.mistake(
    "one length was taken of all pairs together",
    hint="How many numbers does your norm return for 40 pairs? Along which axis should it sum?",
)
def _(p: Any, q: Any, normals_p: Any, normals_q: Any, max_distance: float, max_angle: float) -> Any:
    _, w = _tests(p, q, normals_p, normals_q)
    return (np.linalg.norm(p - q) <= max_distance) & (w <= max_angle)


TRIM_PAIRS = Exercise(
    reference.trim_pairs,
    notes="ch. 2, step 3",
    hints=[
        "Sort the distances in your mind: where is the border between kept and rejected?",
        "numpy.quantile finds that border. Which pairs lie below it?",
    ],
)


@TRIM_PAIRS.check("the closest pairs are kept, as many as asked for", points=2)
def _(f: Asked, rng: Rng) -> None:
    cases = []
    for scale, keep in ((1.0, 0.7), (100.0, 0.25), (0.01, 0.9), (1.0, 1.0)):
        distances = scale * rng.gamma(2.0, size=int(rng.integers(41, 60)))
        cases.append((distances, keep))
    answers = [f(*case) for case in cases]
    for (distances, keep), answer in zip(cases, f.each(answers), strict=True):
        on = f"{len(distances)} distances, keep = {keep}"
        mine = mask(answer, len(distances), on=on)
        kept, wanted = int(mine.sum()), keep * len(distances)
        message = "The number of pairs that are kept is not right."
        # Rounding up or down, and counting the border itself or not, are all right.
        expect.that(abs(kept - wanted) <= 1.0, message, yours=str(kept), truth=f"about {wanted:.1f}", on=on)
        largest = float(distances[mine].max(initial=-np.inf))
        smallest = float(distances[~mine].min(initial=np.inf))
        details = {"yours": f"kept up to {largest:.3g}, rejected from {smallest:.3g}", "on": on}
        expect.that(largest <= smallest, "A closer pair was rejected than one that was kept.", **details)


@TRIM_PAIRS.check("few wild pairs do not move the border")
def _(f: Asked, rng: Rng) -> None:
    distances = np.concatenate([rng.uniform(1, 2, size=34), rng.uniform(500, 900, size=6)])
    order = rng.permutation(40)
    answer = f(distances[order], 0.8)
    on = "34 close pairs and 6 wild ones, keep = 0.8"
    mine = mask(answer, 40, on=on)
    wild = int(np.count_nonzero(mine & (distances[order] > 2)))
    expect.that(wild == 0, "Wild pairs are kept.", yours=f"{wild} of 6", truth="none", on=on)
    kept = int(mine.sum())
    message = "The wild pairs change how many are kept."
    expect.that(abs(kept - 32) <= 1, message, yours=str(kept), truth="32", on=on)


@TRIM_PAIRS.variant("by sorting, rounded up")
def _(distances: FloatArray, keep: float) -> Any:
    first = np.argsort(distances)[: int(np.ceil(keep * len(distances) - 1e-9))]
    return np.isin(np.arange(len(distances)), first)


@TRIM_PAIRS.variant("by sorting, rounded down, as a list of 0 and 1")
def _(distances: FloatArray, keep: float) -> Any:
    n = int(keep * len(distances) + 1e-9)
    rank = np.argsort(np.argsort(distances))
    return [int(r < n) for r in rank]


@TRIM_PAIRS.mistake(
    "the farthest pairs are kept", hint="Which pairs are likely to be wrong, near or far ones?"
)
def _(distances: FloatArray, keep: float) -> Any:
    return np.asarray(distances) >= np.quantile(distances, 1 - keep)


@TRIM_PAIRS.mistake(
    "keep was taken for the part to reject", hint="With keep = 0.9, how many pairs should be left?"
)
def _(distances: FloatArray, keep: float) -> Any:
    return np.asarray(distances) <= np.quantile(distances, 1 - keep)


@TRIM_PAIRS.mistake(
    "the border is a part of the largest distance",
    hint="One wild pair doubles the largest distance. Should it change which others are kept?",
)
def _(distances: FloatArray, keep: float) -> Any:
    return np.asarray(distances) <= keep * np.max(distances)


@TRIM_PAIRS.mistake(
    "the first pairs of the list are kept", hint="The pairs come in no order. Which ones are closest?"
)
def _(distances: FloatArray, keep: float) -> Any:
    return np.arange(len(distances)) < round(keep * len(distances))


@TRIM_PAIRS.mistake(
    "keep was used as a distance", hint="keep has no unit. What happens when the scan is 100 times larger?"
)
def _(distances: FloatArray, keep: float) -> Any:
    return np.asarray(distances) <= keep


@TRIM_PAIRS.mistake(
    "entry i of the mask belongs to the i-th place in the sorted order, not to pair i",
    hint="What is the first number of argsort: the rank of pair 0, or the pair of rank 0?",
)
def _(distances: FloatArray, keep: float) -> Any:
    return np.argsort(distances) < keep * len(distances)


REJECT_BOUNDARY_PAIRS = Exercise(
    reference.reject_boundary_pairs,
    notes="ch. 2, step 3",
    hints=[
        "For one pair: which vertex was it matched with, and is that one on the boundary?",
        "numpy looks up many indices at once: which array is indexed, and with what?",
    ],
)


@REJECT_BOUNDARY_PAIRS.check("a pair is kept when its partner is not on the boundary", points=2)
def _(f: Asked, rng: Rng) -> None:
    cases = []
    for m, n in ((50, 30), (12, 40), (25, 25)):
        border = rng.random(n) < 0.4
        border[[0, 1, n - 1]] = rng.permutation([True, False, True])
        cases.append((rng.integers(0, n, size=m), border))
    answers = [f(*case) for case in cases]
    for (indices, border), answer in zip(cases, f.each(answers), strict=True):
        on = f"{len(indices)} pairs, {len(border)} vertices"
        truth = np.array([not border[i] for i in indices.tolist()])
        _expect_mask(answer, truth, on)


@REJECT_BOUNDARY_PAIRS.check("a closed mesh keeps all pairs")
def _(f: Asked, rng: Rng) -> None:
    n = int(rng.integers(10, 20))
    indices = rng.integers(0, n, size=30)
    answer = f(indices, np.zeros(n, dtype=bool))
    _expect_mask(answer, np.ones(30, dtype=bool), "no vertex on the boundary")


@REJECT_BOUNDARY_PAIRS.variant("pair by pair")
def _(indices: IntArray, on_boundary: BoolArray) -> Any:
    return [not on_boundary[int(i)] for i in indices]


@REJECT_BOUNDARY_PAIRS.variant("by a set of inner vertices")
def _(indices: IntArray, on_boundary: BoolArray) -> Any:
    return np.isin(indices, np.flatnonzero(~np.asarray(on_boundary))).astype(float)


@REJECT_BOUNDARY_PAIRS.mistake(
    "the mask marks the pairs on the boundary", hint="What does True mean in the docstring: keep or reject?"
)
def _(indices: IntArray, on_boundary: BoolArray) -> Any:
    return np.asarray(on_boundary)[indices]


@REJECT_BOUNDARY_PAIRS.mistake(
    "the flags of the vertices were returned as they come, without looking up the pairs",
    hint="How many pairs are there, and how many vertices? Which of the two numbers should the mask have?",
)
def _(indices: IntArray, on_boundary: BoolArray) -> Any:
    return ~np.asarray(on_boundary)


@REJECT_BOUNDARY_PAIRS.mistake(
    "the indices that are kept were returned, not a mask",
    hint="The docstring asks for one True or False for each pair.",
)
def _(indices: IntArray, on_boundary: BoolArray) -> Any:
    return np.flatnonzero(~np.asarray(on_boundary)[indices])


@REJECT_BOUNDARY_PAIRS.mistake(
    "every pair is kept",
    hint="What is ~1 in Python, and is it true or false? What is ~True of a numpy array?",
)
def _(indices: IntArray, on_boundary: BoolArray) -> Any:
    return np.ones(len(np.asarray(indices)), dtype=bool)
