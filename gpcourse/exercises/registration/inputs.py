"""Inputs that tell right from wrong, with motions and surfaces that are known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gpcourse.exercises import expect
from gpcourse.exercises.registration import pictures
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray

Rng = np.random.Generator
Motion = tuple[FloatArray, FloatArray]


def turn(axis: FloatArray, angle: float) -> FloatArray:
    """Return the rotation by `angle` (radians) about `axis`, of any length."""
    x, y, z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation: FloatArray = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * (K @ K)
    return rotation


def random_turn(rng: Rng, angle: float | None = None) -> FloatArray:
    """Return a rotation about a random axis, by `angle` or by something between 30° and 150°."""
    return turn(rng.normal(size=3), rng.uniform(0.5, 2.6) if angle is None else angle)


def random_motion(rng: Rng, scale: float = 1.0) -> Motion:
    """Return a rotation by a good deal, and a translation by about `scale`."""
    return random_turn(rng), scale * rng.normal(size=3)


def moved(points: FloatArray, R: FloatArray, t: FloatArray) -> FloatArray:
    """Return R x + t for each row x."""
    image: FloatArray = points @ R.T + t
    return image


def inverse(R: FloatArray, t: FloatArray) -> Motion:
    """Return the motion that takes R x + t back to x."""
    return R.T, -R.T @ t


def angle_between(A: FloatArray, B: FloatArray) -> float:
    """Return the angle of the rotation that takes A to B, in radians, also where it is small."""
    # ‖A − B‖ = 2√2 sin(θ/2) for rotations: no arccos, which loses half the digits near 0.
    return float(2 * np.arcsin(min(1.0, float(np.linalg.norm(A - B)) / 8**0.5)))


def brute_force(points: FloatArray, queries: FloatArray) -> FloatArray:
    """Return all distances, a row per query."""
    distances: FloatArray = np.linalg.norm(queries[:, None] - points[None], axis=2)
    return distances


def parts(value: object, n: int, names: str, *, on: str = "") -> tuple[Any, ...]:
    """Expect a tuple or list of n things, called `names`."""
    if value is None:
        raise expect.Wrong("The result is None: is a `return` missing?", on=on)
    if not isinstance(value, (tuple, list)) or len(value) != n:
        raise expect.Wrong(f"The result should be {names}.", yours=expect.brief(value), on=on)
    return tuple(value)


def motion(
    value: object, *, on: str = "", names: str = "a pair (R, t)", clouds: Motion | None = None
) -> Motion:
    """Expect a pair of a rotation matrix and a translation; `clouds` are the p and q that it should match."""
    R, t = parts(value, 2, names, on=on)
    rotation = expect.array(R, (3, 3), "R", on=on)
    translation = expect.array(t, (3,), "t", on=on)
    # Rounding leaves about 1e-15; 1e-6 also admits single precision. Values are judged more sharply.
    off = float(np.abs(rotation.T @ rotation - np.eye(3)).max())
    message = "R is not a rotation matrix: RᵀR is not the identity."
    drawn = pictures.of_alignment(*clouds, (rotation, translation), pairs=True) if clouds else {}
    expect.that(off <= 1e-6, message, yours=f"it is off by {off:.2g}", on=on, **drawn)
    det = float(np.linalg.det(rotation))
    message = "R is a reflection: det R should be +1."
    expect.that(det > 0, message, yours=f"det R = {det:.3g}", truth="det R = +1", on=on, **drawn)
    return rotation, translation


def mask(value: object, n: int, what: str = "The mask", *, on: str = "") -> BoolArray:
    """Expect (n,) booleans; zeros and ones are as good."""
    numbers = expect.array(value, (n,), what, on=on)
    message = f"{what} should hold True and False only."
    expect.that(bool(np.isin(numbers, (0, 1)).all()), message, yours=expect.brief(value), on=on)
    flags: BoolArray = numbers == 1
    return flags


def sample(value: object, n_points: int, k: int, *, on: str = "") -> IntArray:
    """Expect k different indices below `n_points`."""
    chosen = expect.indices(value, "The sample", on=on)
    message = f"The sample has {len(chosen)} indices; {k} were asked for."
    expect.that(len(chosen) == k, message, yours=expect.brief(value), on=on)
    inside = bool(((chosen >= 0) & (chosen < n_points)).all())
    message = f"The sample names points that do not exist: indices run from 0 to {n_points - 1}."
    expect.that(inside, message, yours=expect.brief(value), on=on)
    repeated = k - len(np.unique(chosen))
    expect.that(repeated == 0, "The sample takes a point more than once.", yours=f"{repeated} repeats", on=on)
    return chosen


@dataclass(frozen=True)
class Surface:
    """Points on a surface, with their unit normals."""

    points: FloatArray
    normals: FloatArray

    def moved(self, R: FloatArray, t: FloatArray) -> Surface:
        """Return the surface after a motion."""
        return Surface(moved(self.points, R, t), self.normals @ R.T)

    def scaled(self, factor: float) -> Surface:
        """Return the surface, larger by `factor`."""
        return Surface(factor * self.points, self.normals)

    def part(self, chosen: IntArray | BoolArray) -> Surface:
        """Return some of the points."""
        return Surface(self.points[chosen], self.normals[chosen])


def graph(x: FloatArray, y: FloatArray, waves: FloatArray) -> Surface:
    """Return points of z = Σ a sin(k·(x, y) + φ); each row of `waves` is (a, kx, ky, φ)."""
    z, zx, zy = np.zeros_like(x), np.zeros_like(x), np.zeros_like(x)
    for a, kx, ky, phase in waves:
        z += a * np.sin(kx * x + ky * y + phase)
        slope = a * np.cos(kx * x + ky * y + phase)
        zx += kx * slope
        zy += ky * slope
    normals = np.column_stack([-zx, -zy, np.ones_like(x)])
    return Surface(np.column_stack([x, y, z]), normals / np.linalg.norm(normals, axis=1, keepdims=True))


def random_waves(rng: Rng) -> FloatArray:
    """Return four waves that together leave no direction free to slip."""
    directions = rng.uniform(0, 2 * np.pi) + np.array([0.0, 0.9, 1.7, 2.4])
    lengths = rng.uniform(2.5, 4.5, size=4)
    return np.column_stack(
        [
            rng.uniform(0.12, 0.2, size=4),
            lengths * np.cos(directions),
            lengths * np.sin(directions),
            rng.uniform(0, 2 * np.pi, size=4),
        ]
    )


def landscape(rng: Rng, n: int, waves: FloatArray | None = None) -> Surface:
    """Return n points spread over a hilly square of side 2."""
    chosen = random_waves(rng) if waves is None else waves
    side = int(np.ceil(n**0.5))
    x, y = (a.ravel()[:n] for a in np.meshgrid(*2 * [np.linspace(-1, 1, side)], indexing="ij"))
    step = 2 / (side - 1)
    jitter = rng.uniform(-0.3, 0.3, size=(2, len(x))) * step
    order = rng.permutation(len(x))
    return graph((x + jitter[0])[order], (y + jitter[1])[order], chosen)
