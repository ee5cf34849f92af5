"""Exercises on the motion between points whose partners are known."""

from __future__ import annotations

from typing import Any

import numpy as np

from gpcourse.exercises import expect
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Asked
from gpcourse.exercises.registration import pictures
from gpcourse.exercises.registration.inputs import (
    Motion,
    Rng,
    inverse,
    motion,
    moved,
    random_motion,
    random_turn,
    turn,
)
from gpcourse.geometry.arrays import FloatArray
from gpcourse.reference import registration as reference

# Point to point ---------------------------------------------------------------------------------

RIGID_TRANSFORM = Exercise(
    reference.rigid_transform,
    notes="ch. 2, step 4, Point-to-Point",
    hints=[
        "Where does the best motion take the centroid of q? That leaves the rotation only.",
        "The notes write points as columns, numpy keeps them as rows. Which product of the centred arrays "
        "has shape (3, 3) and belongs to q on the left?",
        "numpy.linalg.svd returns three arrays. Read in its documentation what the third one is.",
        "Weights decide how much a pair counts, in every sum that you form.",
    ],
)


def _expect_motion(mine: Motion, want: Motion, size: float, pq: Motion, on: str) -> None:
    drawn = pictures.of_alignment(*pq, mine, want, pairs=True)
    # Measured: the singular vectors leave 3e-15 on these clouds. 1e-12 is what the course asks for.
    expect.close(mine[0], want[0], 1e-12, "R", on=on, **drawn)
    expect.close(mine[1], want[1], 1e-12 * (1 + size), "t", on=on, **drawn)


def _expect_best(mine: Motion, p: FloatArray, q: FloatArray, w: FloatArray, on: str) -> None:
    """Expect that no other motion has a smaller sum of squares.

    The conditions are necessary and sufficient: no translation improves (the residuals sum to zero), no
    small turn does (S = RH is symmetric), and no large one (the two smallest eigenvalues of S do not sum
    to less than zero).
    """
    R, t = mine
    w = w / w.sum()
    size = float(np.ptp(p, axis=0).max())
    details: dict[str, Any] = {"on": on, **pictures.of_alignment(p, q, mine, pairs=True)}
    left = w @ (p - moved(q, R, t))
    # Rounding leaves 1e-16 of the size; 1e-7 also admits single precision of unit-sized clouds.
    expect.that(
        not float(np.abs(left).max()) > 1e-6 * size,
        "A translation would improve the fit: what is left between the pairs does not average to zero.",
        yours=f"it averages to {left.round(6).tolist()}",
        **details,
    )
    S = R @ ((q - w @ q) * w[:, None]).T @ (p - w @ p)
    slack = 1e-6 * float(np.abs(S).max())
    turns = float(np.abs(S - S.T).max())
    expect.that(turns <= slack, "A small turn would improve the fit.", **details)
    low = np.linalg.eigvalsh((S + S.T) / 2)
    half_turn = "R is a rotation, but not the best one: a half turn away is a better one."
    expect.that(low[0] + low[1] >= -slack, half_turn, **details)


def _mirrored(rng: Rng) -> tuple[FloatArray, FloatArray, Motion]:
    """Return p, q near a plane, where p is q mirrored in it and moved.

    The columns of q are orthogonal and its third is the shortest, so the best rotation is exactly the
    motion, and the best orthogonal matrix is a reflection.
    """
    columns = np.linalg.qr(np.column_stack([np.ones(14), rng.normal(size=(14, 3))]))[0][:, 1:]
    flat = columns * [3.0, 2.0, 0.1]
    frame = random_turn(rng)
    R, t = random_motion(rng)
    return moved((flat * [1, 1, -1]) @ frame.T, R, t), flat @ frame.T, (R, t)


@RIGID_TRANSFORM.check("a known motion is found, to 1e-12", points=2)
def _(f: Asked, rng: Rng) -> None:
    cases = []
    for n, scale in ((9, 1.0), (4, 100.0), (30, 0.01)):
        q = scale * (rng.normal(size=(n, 3)) + rng.normal(size=3))
        want = random_motion(rng, scale)
        p = moved(q, *want)
        cases.append((p, q, want, scale, f(p, q)))
    for f.about, (p, q, want, scale, answer) in enumerate(cases):
        on = f"{len(q)} points of size {scale:g}"
        _expect_motion(motion(answer, on=on, clouds=(p, q)), want, 4 * scale, (p, q), on)


@RIGID_TRANSFORM.check("no other motion fits noisy pairs better")
def _(f: Asked, rng: Rng) -> None:
    cases = []
    for noise in (0.1, 0.4):
        q = rng.normal(size=(16, 3)) + 2 * rng.normal(size=3)
        p = moved(q, *random_motion(rng, 2.0)) + noise * rng.normal(size=q.shape)
        cases.append((p, q, f(p, q)))
    for f.about, (p, q, answer) in enumerate(cases):
        on = f"{len(q)} noisy pairs"
        _expect_best(motion(answer, on=on, clouds=(p, q)), p, q, np.ones(len(q)), on)


@RIGID_TRANSFORM.check("noisy points near a plane give a rotation, never a reflection", points=2)
def _(f: Asked, rng: Rng) -> None:
    p, q, want = _mirrored(rng)
    noisy = p + 0.02 * rng.normal(size=p.shape)
    exact, rough = f(p, q), f(noisy, q)
    f.about, on = 0, "points near a plane, noisy across it"
    # As above, but the third direction is 30 times shorter: 1e-12 still leaves a hundredfold.
    _expect_motion(motion(exact, on=on, clouds=(p, q)), want, 4.0, (p, q), on)
    f.about = 1
    _expect_best(motion(rough, on=on, clouds=(noisy, q)), noisy, q, np.ones(len(q)), on)


@RIGID_TRANSFORM.check("a mirror image gives the best rotation")
def _(f: Asked, rng: Rng) -> None:
    q = rng.normal(size=(12, 3)) * [3.0, 2.0, 1.0]
    p = moved(-q, *random_motion(rng))
    on = "a cloud and its mirror image"
    _expect_best(motion(f(p, q), on=on, clouds=(p, q)), p, q, np.ones(len(q)), on)


@RIGID_TRANSFORM.check("points in a plane, and points on a line")
def _(f: Asked, rng: Rng) -> None:
    want = random_motion(rng)
    plane = rng.normal(size=(7, 2)) @ rng.normal(size=(2, 3))
    line = rng.normal(size=(6, 1)) * rng.normal(size=3) + rng.normal(size=3)
    answers = [f(moved(q, *want), q) for q in (plane, line)]
    f.about, on = 0, "7 points in a plane"
    p = moved(plane, *want)
    mine = motion(answers[0], on=on, clouds=(p, plane))
    # In a plane the motion is still unique; the worst of 1000 random planes lost four digits.
    expect.close(
        mine[0], want[0], 1e-9, "R", on=on, **pictures.of_alignment(p, plane, mine, want, pairs=True)
    )
    f.about, on = 1, "6 points on a line"
    R, t = motion(answers[1], on=on)
    shown = pictures.Positions(line, None, item="point")
    expect.close(moved(line, R, t), moved(line, *want), 1e-9, "The moved points", on=on, shown=shown)


@RIGID_TRANSFORM.check("weights count in every sum", points=2)
def _(f: Asked, rng: Rng) -> None:
    q = rng.normal(size=(15, 3)) + rng.normal(size=3)
    want = random_motion(rng)
    p = moved(q, *want)
    p[:4] += rng.normal(size=(4, 3))
    trusted = np.where(np.arange(15) < 4, 0.0, rng.uniform(1, 3, size=15))
    noisy = moved(q, *want) + 0.3 * rng.normal(size=q.shape)
    graded = rng.uniform(0.1, 5, size=15)
    exact, rough = f(p, q, trusted), f(noisy, q, graded)
    f.about, on = 0, "15 pairs, 4 of them wrong and of weight 0"
    _expect_motion(motion(exact, on=on, clouds=(p, q)), want, 4.0, (p, q), on)
    f.about, on = 1, "15 noisy pairs with different weights"
    _expect_best(motion(rough, on=on, clouds=(noisy, q)), noisy, q, graded, on)


def _svd(
    p: FloatArray,
    q: FloatArray,
    about: FloatArray | None = None,
    inside: FloatArray | None = None,
    *,
    centred: bool = True,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return U, V of QPᵀ with weights `about` in the centroids and `inside` in the sum, and the centroids."""
    a, b = (np.ones(len(p)) if w is None else np.asarray(w, dtype=float) for w in (about, inside))
    p_mean, q_mean = a @ p / a.sum(), a @ q / a.sum()
    x, y = (p - p_mean, q - q_mean) if centred else (p, q)
    U, _, Vt = np.linalg.svd(y.T @ (b[:, None] * x))
    return U, Vt.T, p_mean, q_mean, np.diag([1.0, 1.0, np.linalg.det(Vt.T @ U.T)])


def best_motion(p: FloatArray, q: FloatArray) -> Motion:
    """Return the motion that takes q to p, for the other exercises' own solutions."""
    U, V, a, b, D = _svd(p, q)
    R = V @ D @ U.T
    return R, a - R @ b


@RIGID_TRANSFORM.variant("by Horn's quaternion")
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    w = np.ones(len(p)) if weights is None else np.asarray(weights)
    w = w / w.sum()
    a, b = w @ p, w @ q
    H = (q - b).T @ (w[:, None] * (p - a))
    skew = np.array([H[1, 2] - H[2, 1], H[2, 0] - H[0, 2], H[0, 1] - H[1, 0]])
    N = np.zeros((4, 4))
    N[0, 0], N[0, 1:], N[1:, 0] = np.trace(H), skew, skew
    N[1:, 1:] = H + H.T - np.trace(H) * np.eye(3)
    s, x, y, z = np.linalg.eigh(N)[1][:, -1]
    R = [
        [s * s + x * x - y * y - z * z, 2 * (x * y - s * z), 2 * (x * z + s * y)],
        [2 * (x * y + s * z), s * s - x * x + y * y - z * z, 2 * (y * z - s * x)],
        [2 * (x * z - s * y), 2 * (y * z + s * x), s * s - x * x - y * y + z * z],
    ]
    return R, (a - np.array(R) @ b).tolist()


@RIGID_TRANSFORM.variant("the transposed covariance, t as a column")
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    w = np.full(len(p), 2.0) if weights is None else np.asarray(weights)
    a, b = np.average(p, axis=0, weights=w), np.average(q, axis=0, weights=w)
    V, _, Ut = np.linalg.svd((p - a).T @ np.diag(w) @ (q - b))
    if np.linalg.det(V @ Ut) < 0:
        V[:, -1] *= -1
    R = V @ Ut
    return [R, (a - R @ b)[:, None]]


@RIGID_TRANSFORM.mistake(
    "the sign of det(VUᵀ) was left out",
    hint="What is the determinant of your R when the noise across a plane is mirrored?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, _ = _svd(p, q, weights, weights)
    return V @ U.T, a - V @ U.T @ b


@RIGID_TRANSFORM.mistake(
    "the whole matrix changed its sign to make the determinant positive",
    hint="Which of the three directions costs least when it is turned round? Turn that one only.",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, _ = _svd(p, q, weights, weights)
    R = V @ U.T * np.sign(np.linalg.det(V @ U.T))
    return R, a - R @ b


@RIGID_TRANSFORM.mistake(
    "the sign went to the first singular direction",
    hint="numpy sorts singular values. Which direction do the noisy points hold least?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, weights, weights)
    R = V @ D[::-1, ::-1] @ U.T
    return R, a - R @ b


@RIGID_TRANSFORM.mistake(
    "a column of R changed its sign, not one of V",
    hint="R = VUᵀ: the last column of V is a direction in space. Which direction is the last column of R?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, weights, weights)
    R = V @ U.T @ D
    return R, a - R @ b


@RIGID_TRANSFORM.mistake(
    "the last column of numpy's Vᵀ changed its sign, which is a row of V",
    hint="numpy returns V transposed. Where in that array is the third singular direction?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, weights, weights)
    R = D @ V @ U.T
    return R, a - R @ b


@RIGID_TRANSFORM.mistake(
    "R is UVᵀ where it should be VUᵀ",
    hint="Move one point by hand with your R. Does it go from q towards p, or the other way?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, weights, weights)
    R = U @ D @ V.T
    return R, a - R @ b


@RIGID_TRANSFORM.mistake(
    "the third array of numpy's svd was used as V",
    hint="Multiply the three arrays that svd returns. In which order do they give back the matrix?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, weights, weights)
    R = V.T @ D @ U.T
    return R, a - R @ b


@RIGID_TRANSFORM.mistake(
    "t is p̄ − q̄, without the rotation",
    hint="The rotation turns q about the origin, and q̄ with it. Where is q̄ then?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, weights, weights)
    return V @ D @ U.T, a - b


@RIGID_TRANSFORM.mistake(
    "q̄ was turned the other way: a row times R is what Rᵀ does to a column",
    hint="Points are rows here. Which product turns a row by R: with R or with Rᵀ on its right?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, weights, weights)
    R = V @ D @ U.T
    return R, a - b @ R


@RIGID_TRANSFORM.mistake(
    "the rotation was applied to p̄ in place of q̄",
    hint="Which of the two clouds is turned?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, weights, weights)
    R = V @ D @ U.T
    return R, R @ a - b


@RIGID_TRANSFORM.mistake(
    "the motion is the inverse one, which moves p onto q",
    hint="Which cloud moves, and which one stays?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, weights, weights)
    R = V @ D @ U.T
    return inverse(R, a - R @ b)


@RIGID_TRANSFORM.mistake(
    "the points were not centred",
    hint="Rotate a cloud that lies far from the origin. What do its own coordinates say about the turn?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, weights, weights, centred=False)
    R = V @ D @ U.T
    return R, a - R @ b


@RIGID_TRANSFORM.mistake(
    "the weights were used in the centroids only",
    hint="A pair of weight zero should count nowhere. In which sum does it still count?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, weights)
    R = V @ D @ U.T
    return R, a - R @ b


@RIGID_TRANSFORM.mistake(
    "the weights were used in the covariance only",
    hint="A pair of weight zero should count nowhere. Does it still pull at a centroid?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    U, V, a, b, D = _svd(p, q, None, weights)
    R = V @ D @ U.T
    return R, a - R @ b


@RIGID_TRANSFORM.mistake(
    "the weights were not used",
    hint="How does your result change when one weight grows?",
)
def _(p: FloatArray, q: FloatArray, weights: Any = None) -> Any:
    return best_motion(p, q)


# Point to plane ---------------------------------------------------------------------------------

POINT_TO_PLANE_STEP = Exercise(
    reference.point_to_plane_step,
    notes="ch. 2, step 4, Point-to-Plane",
    hints=[
        "Replace R q by q + r × q. Which unknowns are left, and how do they enter the residual?",
        "(r × q)·n is linear in r. Which vector is it the dot product of r with?",
        "One row per pair, six columns, one right-hand side: numpy.linalg.lstsq solves it.",
        "The length of r is an angle and its direction an axis. Which rotation is that?",
    ],
)


def _linear(p: FloatArray, q: FloatArray, n: FloatArray) -> FloatArray:
    """Return the six numbers (r, t) of the linearised problem, about the origin."""
    A = np.column_stack([np.cross(q, n), n])
    solution: FloatArray = np.linalg.lstsq(A, np.einsum("ij,ij->i", p - q, n), rcond=None)[0]
    return solution


def _directions(rng: Rng, n: int) -> FloatArray:
    v = rng.normal(size=(n, 3))
    directions: FloatArray = v / np.linalg.norm(v, axis=1, keepdims=True)
    return directions


@POINT_TO_PLANE_STEP.check("one step is exact for a translation")
def _(f: Asked, rng: Rng) -> None:
    cases = []
    for scale in (1.0, 100.0):
        q, t = scale * rng.normal(size=(40, 3)), scale * rng.normal(size=3)
        n = _directions(rng, 40)
        cases.append((q, t, scale, f(q + t, q, n)))
    for f.about, (q, t, scale, answer) in enumerate(cases):
        on = f"a cloud of size {scale:g} and its translate"
        R, shift = motion(answer, on=on)
        drawn = pictures.of_alignment(q + t, q, (R, shift), (np.eye(3), t), pairs=True)
        # Normal equations square a condition number of about 100 scale: at most 1e-8 is lost.
        expect.close(R, np.eye(3), 1e-8, "R, which should be the identity", on=on, **drawn)
        expect.close(shift, t, 1e-8 * scale * 10, "t", on=on, **drawn)


@POINT_TO_PLANE_STEP.check("a small motion is found to first order", points=2)
def _(f: Asked, rng: Rng) -> None:
    cases = []
    for small in (1e-2, 1e-4):
        q, n = rng.normal(size=(40, 3)) + rng.normal(size=3), _directions(rng, 40)
        want = turn(rng.normal(size=3), small), small * rng.normal(size=3)
        p = moved(q, *want)
        cases.append((small, want, p, q, n @ want[0].T, f(p, q, n @ want[0].T)))
    for f.about, (small, want, p, q, _, answer) in enumerate(cases):
        on = f"a turn by {small:g} and a shift of that size"
        R, t = motion(answer, on=on)
        drawn = pictures.of_alignment(p, q, (R, t), want, pairs=True)
        # What is neglected is of second order: measured, it stays below 4 small² on such clouds.
        expect.close(R, want[0], 40 * small**2, "R", on=on, **drawn)
        shown = pictures.Positions(q, None, item="point")
        expect.close(moved(q, R, t), p, 160 * small**2, "The moved points", on=on, shown=shown)


def _turned(rng: Rng) -> tuple[FloatArray, FloatArray, FloatArray, Motion]:
    q = rng.normal(size=(40, 3)) * [1.5, 1.0, 0.8] + rng.normal(size=3)
    R, t = random_turn(rng, rng.uniform(0.45, 0.6)), 0.2 * rng.normal(size=3)
    return moved(q, R, t), q, _directions(rng, 40), (R, t)


@POINT_TO_PLANE_STEP.check("R is the rotation about the axis that the six equations give", points=2)
def _(f: Asked, rng: Rng) -> None:
    cases = []
    for _ in range(2):
        p, q, n, _motion = _turned(rng)
        p = p + 0.05 * rng.normal(size=p.shape)
        cases.append((p, q, n, f(p, q, n)))
    for f.about, (p, q, n, answer) in enumerate(cases):
        on = "a turn by about 30°, with noise"
        R, t = motion(answer, on=on)
        # Rounding leaves 1e-15. I + [r]× is off by r², here by 0.05 or more.
        off = float(np.abs(R.T @ R - np.eye(3)).max())
        message = "R is not a rotation matrix to rounding: RᵀR differs from the identity."
        expect.that(off <= 1e-9, message, yours=f"by {off:.2g}", on=on)
        solution = _linear(p, q, n)
        r, angle = solution[:3], float(np.linalg.norm(solution[:3]))
        # The axis stays where it is. Six normal equations of condition 1e3 lose six digits at most.
        axis = "R r, where r solves the six equations and should be the axis of R"
        drawn = pictures.of_alignment(p, q, (R, t), pairs=True)
        expect.close(R @ r, r, 1e-8, axis, on=on, **drawn)
        expect.that(
            abs(angle_of(R, r) - angle)
            <= angle**3 / 2,  # exponential, Cayley and projection all agree so far
            "The angle of R is not the length of r.",
            yours=f"{angle_of(R, r):.4f}",
            truth=f"about {angle:.4f}",
            on=on,
            **drawn,
        )
        # About which point one turns makes a difference of second order only.
        reach = float(np.linalg.norm(q, axis=1).max())
        expect.close(t, solution[3:], 0.55 * angle**2 * reach + 1e-8, "t", on=on, **drawn)


def angle_of(R: FloatArray, axis: FloatArray) -> float:
    """Return the angle by which R turns about `axis`, positive counter-clockwise."""
    twist = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    length = float(np.linalg.norm(axis)) or 1.0
    return float(np.arctan2(twist @ axis / length, np.trace(R) - 1))


@POINT_TO_PLANE_STEP.check("repeated steps find a turn by 30°")
def _(f: Asked, rng: Rng) -> None:
    p, q, n, _ = _turned(rng)
    steps: list[Motion] = []
    x = q
    for i in range(8):
        on = f"step {i + 1} towards a turn by about 30°"
        steps.append(motion(f(p, x, n), on=on))
        x = moved(x, *steps[-1])
        apart = float(np.abs(x).max())
        expect.that(apart < 1e3, "The points fly away.", on=on, yours=f"as far as {apart:.3g}")
    # The error is squared in each step: 0.6, 0.2, 0.02, 2e-4, 4e-8, 1e-15, whatever the constant is near 1.
    expect.close(
        x, p, 1e-9, "The points after 8 steps", on=on, shown=pictures.Positions(q, None, item="point")
    )


@POINT_TO_PLANE_STEP.variant("about the origin, by least squares, with Rodrigues' formula")
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    solution = _linear(p, q, normals)
    angle = float(np.linalg.norm(solution[:3]))
    return turn(solution[:3], angle) if angle else np.eye(3), solution[3:]


@POINT_TO_PLANE_STEP.variant("normal equations, the exponential as a series, lists")
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    rows = [np.concatenate([n, np.cross(y, n)]) for y, n in zip(q, normals, strict=True)]
    A = np.array(rows)
    b = ((p - q) * normals).sum(axis=1)
    x, y, z = (solution := np.linalg.solve(A.T @ A, A.T @ b))[3:]
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    R, term = np.eye(3), np.eye(3)
    for k in range(1, 25):
        term = term @ K / k
        R = R + term
    return R.tolist(), solution[:3].tolist()


def _exponential(r: FloatArray) -> FloatArray:
    angle = float(np.linalg.norm(r))
    return turn(r, angle) if angle else np.eye(3)


def plane_motion(p: FloatArray, q: FloatArray, n: FloatArray) -> Motion:
    """Return one step towards the planes, for the other exercises' own solutions."""
    solution = _linear(p, q, n)
    return _exponential(solution[:3]), solution[3:]


def linearised_step(p: FloatArray, q: FloatArray, n: FloatArray) -> Motion:
    """Return the step as the six equations give it: I + [r]×, which is no rotation."""
    solution = _linear(p, q, n)
    x, y, z = solution[:3]
    return np.eye(3) + np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]), solution[3:]


@POINT_TO_PLANE_STEP.mistake(
    "the cross product is reversed",
    hint="(r × q)·n = r·(? × ?). The order decides the sign.",
)
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    solution = _linear(p, q, normals)
    return _exponential(-solution[:3]), solution[3:]


@POINT_TO_PLANE_STEP.mistake(
    "the right-hand side has the wrong sign",
    hint="Move q to p: which of the two is subtracted from the other?",
)
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    solution = -_linear(p, q, normals)
    return _exponential(solution[:3]), solution[3:]


@POINT_TO_PLANE_STEP.mistake(
    "t has the wrong sign, R the right one",
    hint="Shift a cloud by (1, 0, 0), and find that motion. Which t brings q to p?",
)
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    solution = _linear(p, q, normals)
    return _exponential(solution[:3]), -solution[3:]


@POINT_TO_PLANE_STEP.mistake(
    "the linearised matrix I + [r]× was returned as the rotation",
    hint="Multiply your R by its transpose. By how much is it off when the turn is 30°?",
)
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    return linearised_step(p, q, normals)


def _euler(r: FloatArray) -> list[FloatArray]:
    return [turn(axis, angle) for axis, angle in zip(np.eye(3), r, strict=True)]


@POINT_TO_PLANE_STEP.mistake(
    "the three numbers were used as Euler angles, in the order Rx Ry Rz",
    hint="Three turns one after the other, or one turn about one axis? They agree to first order only.",
)
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    solution = _linear(p, q, normals)
    X, Y, Z = _euler(solution[:3])
    return X @ Y @ Z, solution[3:]


@POINT_TO_PLANE_STEP.mistake(
    "the three numbers were used as Euler angles, in the order Rz Ry Rx",
    hint="Three turns one after the other, or one turn about one axis? They agree to first order only.",
)
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    solution = _linear(p, q, normals)
    X, Y, Z = _euler(solution[:3])
    return Z @ Y @ X, solution[3:]


@POINT_TO_PLANE_STEP.mistake(
    "the six unknowns were read in the wrong order",
    hint="Which three columns of your matrix belong to the rotation?",
)
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    solution = _linear(p, q, normals)
    return _exponential(solution[3:]), solution[:3]


@POINT_TO_PLANE_STEP.mistake(
    "the equations were set up with p where q is turned",
    hint="Which point does the rotation act on in the formula of the notes?",
)
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    A = np.column_stack([np.cross(p, normals), normals])
    solution = np.linalg.lstsq(A, np.einsum("ij,ij->i", p - q, normals), rcond=None)[0]
    return _exponential(solution[:3]), solution[3:]


@POINT_TO_PLANE_STEP.mistake(
    "the motion is the inverse one, which moves p towards q",
    hint="Which cloud moves, and which one stays?",
)
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    solution = _linear(p, q, normals)
    return inverse(_exponential(solution[:3]), solution[3:])


@POINT_TO_PLANE_STEP.mistake(
    "the distance between the points was minimised, not the distance to the plane",
    hint="Where do the normals enter your sum of squares?",
)
def _(p: FloatArray, q: FloatArray, normals: FloatArray) -> Any:
    return best_motion(p, q)
