"""The parameters of the makers of shapes, checked."""

from __future__ import annotations

import math
import operator

import numpy as np

from gpcourse.errors import GeometryError

#: What a maker draws from: a generator, or a whole number that seeds one.
Rng = np.random.Generator | int


def whole(name: str, value: object, least: int, most: int | None = None) -> int:
    """Return `value` as an int in ``least .. most``, or raise GeometryError."""
    try:
        number = operator.index(value)  # type: ignore[arg-type]  # refuses what is not whole
    except TypeError:
        raise GeometryError(f"{name} is {value!r}; give a whole number") from None
    if number < least or (most is not None and number > most):
        span = f"at least {least}" if most is None else f"from {least} to {most}"
        raise GeometryError(f"{name} is {number}; it must be {span}")
    return number


def positive(name: str, value: object) -> float:
    """Return `value` as a positive finite float, or raise GeometryError."""
    try:
        number = float(value)  # type: ignore[arg-type]  # refuses what is not a number
    except (TypeError, ValueError, OverflowError):
        raise GeometryError(f"{name} is {value!r}; give a positive number") from None
    if not (number > 0 and math.isfinite(number)):
        raise GeometryError(f"{name} is {number}; it must be positive and finite")
    return number


def generator(rng: object) -> np.random.Generator:
    """Return `rng` itself, or the generator that it seeds."""
    if isinstance(rng, np.random.Generator):
        return rng
    if isinstance(rng, (int, np.integer)) and not isinstance(rng, bool) and rng >= 0:
        return np.random.default_rng(int(rng))
    raise GeometryError(f"rng is {rng!r}; give numpy.random.default_rng(seed), or the seed itself")
