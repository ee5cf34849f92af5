"""Functions of space and curves, given by their parameters: what a check hands to a function that takes one.

A student's function may take a callable, as ``implicit_normal(F, points, h)``. In grading that runs in
another process, to which no code is sent: an object of this module crosses by its name and its parameters,
and is built anew there (`sandbox.wire`).

What crosses can be read by whoever gets it, so nothing in here is the answer to an exercise. A sphere is the
zero set of a quadratic polynomial, not a distance; a distance that has to be one comes as a table of its
values (`Sampled`), without the formula; a curve comes without its derivatives. The price is that a table is
as exact as its spacing: checks on it need a tolerance of its order. A plane is the exception: `Quadric` with
a unit vector as its linear part *is* its distance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gpcourse.errors import ArrayError
from gpcourse.geometry.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Quadric:
    r"""The polynomial :math:`F(x) = x^\top A x + b \cdot x + c`: planes, spheres, ellipsoids, saddles.

    Parameters
    ----------
    matrix : (3, 3) float array
    vector : (3,) float array
    constant : float
    """

    matrix: FloatArray
    vector: FloatArray
    constant: float

    def __post_init__(self) -> None:
        _floats(self, matrix=(3, 3), vector=(3,), constant=())

    def __call__(self, points: object) -> FloatArray:
        """Return the values at points, an array of shape (..., 3), in an array of shape (...)."""
        x = _points(points)
        bent = np.einsum("...i,ij,...j->...", x, self.matrix, x)
        return np.asarray(bent + x @ self.vector + self.constant)


@dataclass(frozen=True, eq=False)
class Waves:
    r"""A sum of waves, :math:`F(x) = c + \sum_k a_k \sin(w_k \cdot x + p_k)`: smooth, of no special symmetry.

    Parameters
    ----------
    heights, phases : (k,) float arrays
        a and p; phases in radians.
    directions : (k, 3) float array
        w, radians per unit of length.
    constant : float
    """

    heights: FloatArray
    directions: FloatArray
    phases: FloatArray
    constant: float = 0.0

    def __post_init__(self) -> None:
        _floats(self, heights=(None,), directions=(None, 3), phases=(None,), constant=())
        if not len(self.heights) == len(self.directions) == len(self.phases):
            raise ArrayError("heights, directions and phases need one entry for each wave")

    def __call__(self, points: object) -> FloatArray:
        """Return the values at points, an array of shape (..., 3), in an array of shape (...)."""
        angles = _points(points) @ self.directions.T + self.phases
        return np.asarray(np.sin(angles) @ self.heights + self.constant)


@dataclass(frozen=True, eq=False)
class Sampled:
    """A function known on a grid, linear in each coordinate between the nodes; beyond them its nearest value.

    Parameters
    ----------
    values : (i, j, k) float array
        At ``origin + spacing * (i, j, k)``; two nodes along each axis at least.
    origin : (3,) float array
    spacing : float
        Positive, a length.
    """

    values: FloatArray
    origin: FloatArray
    spacing: float

    def __post_init__(self) -> None:
        _floats(self, values=(None, None, None), origin=(3,), spacing=())
        if min(self.values.shape) < 2 or not self.spacing > 0.0:
            raise ArrayError(f"a grid of {self.values.shape} nodes {self.spacing} apart has no cell")

    def __call__(self, points: object) -> FloatArray:
        """Return the values at points, an array of shape (..., 3), in an array of shape (...)."""
        last = np.array(self.values.shape) - 1
        at = np.clip((_points(points) - self.origin) / self.spacing, 0.0, last)
        corner = np.minimum(at.astype(np.int64), last - 1)
        part = at - corner
        result = np.zeros(at.shape[:-1])
        for step in np.ndindex(2, 2, 2):
            weight = np.where(step, part, 1.0 - part).prod(axis=-1)
            result += weight * self.values[tuple(np.moveaxis(corner + step, -1, 0))]
        return result


@dataclass(frozen=True, eq=False)
class TrigonometricCurve:
    r"""The curve :math:`c(t) = t\,d + \sum_k (a_k \cos kt + b_k \sin kt)`: ellipses, helices, knots.

    Parameters
    ----------
    cosines, sines : (n, d) float arrays
        a and b for k = 0, 1, …
    drift : (d,) float array
        What a turn of 2π moves by, divided by 2π; zero for a closed curve.
    """

    cosines: FloatArray
    sines: FloatArray
    drift: FloatArray

    def __post_init__(self) -> None:
        _floats(self, cosines=(None, None), sines=(None, None), drift=(None,))
        if self.cosines.shape != self.sines.shape or self.cosines.shape[1:] != self.drift.shape:
            raise ArrayError(
                "cosines and sines need one row for each k, and as many columns as drift has entries"
            )

    def __call__(self, t: object) -> FloatArray:
        """Return the points at parameters t, an array of shape (...), in an array of shape (..., d)."""
        t = np.asarray(t, dtype=np.float64)[..., None]
        angles = t * np.arange(len(self.cosines))
        return np.asarray(np.cos(angles) @ self.cosines + np.sin(angles) @ self.sines + t * self.drift)


#: All that crosses, by name.
FUNCTIONS: dict[str, type[Quadric | Waves | Sampled | TrigonometricCurve]] = {
    kind.__name__: kind for kind in (Quadric, Waves, Sampled, TrigonometricCurve)
}


def plane(normal: object, offset: float) -> Quadric:
    """Return ``normal · x - offset``: the signed distance where the normal has length one."""
    return Quadric(np.zeros((3, 3)), np.asarray(normal, dtype=float), -offset)


def sphere(centre: object, radius: float) -> Quadric:
    """Return the polynomial ``|x - centre|² - radius²``: zero on the sphere, negative in it, no distance."""
    middle = np.asarray(centre, dtype=float)
    return Quadric(np.eye(3), -2.0 * middle, float(middle @ middle) - radius**2)


def helix(radius: float, climb: float) -> TrigonometricCurve:
    """Return the helix ``(r cos t, r sin t, climb t)``; a circle where `climb` is zero."""
    cosines, sines = np.zeros((2, 2, 3))
    cosines[1, 0] = sines[1, 1] = radius
    return TrigonometricCurve(cosines, sines, np.array([0.0, 0.0, climb]))


def sampled(function: Callable[[FloatArray], FloatArray], low: object, high: object, n: int) -> Sampled:
    """Tabulate a function of points (..., 3) on cubes from `low` to `high`, n of them on the longest side."""
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    spacing = float((high - low).max()) / n
    counts = np.ceil((high - low) / spacing - 1e-9).astype(int) + 1
    nodes = low + spacing * np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
    return Sampled(function(nodes), low, spacing)


def _points(value: object) -> FloatArray:
    x = np.asarray(value, dtype=np.float64)
    if x.shape[-1:] != (3,):
        raise ArrayError(f"points has shape {x.shape}; give an array of shape (..., 3)")
    return x


def _floats(function: object, **shapes: tuple[int | None, ...]) -> None:
    """Turn parameters into finite floats of their shapes, or raise ArrayError."""
    for name, shape in shapes.items():
        try:
            value = np.array(getattr(function, name), dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise ArrayError(f"{name} cannot be read as numbers") from None
        fits = len(value.shape) == len(shape) and all(
            want in (None, have) for want, have in zip(shape, value.shape, strict=True)
        )
        if not fits or not np.isfinite(value).all():
            raise ArrayError(f"{name} has shape {value.shape}, or is not finite")
        object.__setattr__(function, name, value if shape else float(value))
