"""What the functions of this chapter ask of their arguments."""

from __future__ import annotations

import numpy as np

from gpcourse.errors import ArrayError, GeometryError
from gpcourse.geometry.arrays import FloatArray, as_points


def as_cloud(value: object, name: str) -> FloatArray:
    """Return `value` as (n, 3) points, at least one of them."""
    points = as_points(value, name)
    if not len(points):
        raise GeometryError(f"{name} is empty; give at least one point")
    return points


def as_rows(value: object, name: str, beside: str, count: int) -> FloatArray:
    """Return `value` as (count, 3) floats: one row for each row of the argument called `beside`."""
    rows = as_points(value, name)
    if len(rows) != count:
        raise ArrayError(f"{name} has {len(rows)} rows and {beside} has {count}; give one for each")
    return rows


def as_normals(value: object, name: str, beside: str, count: int) -> FloatArray:
    """Return `value` as (count, 3) unit vectors."""
    normals = as_rows(value, name, beside, count)
    length = np.sqrt((normals * normals) @ np.ones(3))
    long = np.flatnonzero(np.abs(length - 1) > 1e-3)  # what is left of a unit vector in a text file
    if len(long):
        i = int(long[0])
        raise GeometryError(f"{name}[{i}] has length {length[i]:.4g}; divide each normal by its length")
    return normals


def as_pose(R: object, t: object, name: str = "R, t") -> tuple[FloatArray, FloatArray]:
    """Return a rotation matrix and a translation."""
    rotation = as_points(R, f"the rotation of {name}")
    shift = np.asarray(t, dtype=np.float64)
    if rotation.shape != (3, 3) or shift.shape != (3,) or not np.isfinite(shift).all():
        raise ArrayError(
            f"{name} has shapes {rotation.shape} and {shift.shape}; give a rotation, (3, 3), and 3 numbers"
        )
    if not np.allclose(rotation.T @ rotation, np.eye(3), rtol=0, atol=1e-6) or np.linalg.det(rotation) < 0:
        raise GeometryError(f"{name} is not a rotation; it needs RᵀR = I and det R = +1")
    return rotation, shift


def as_count(k: object, most: int, name: str = "k") -> int:
    """Return a number of samples, from 1 to `most`."""
    if isinstance(k, bool) or not isinstance(k, (int, np.integer)) or not 1 <= k <= most:
        raise GeometryError(f"{name} is {k!r}; give a whole number from 1 to {most}")
    return int(k)


def as_fraction(value: float, name: str = "keep") -> float:
    """Return a fraction, above 0 and at most 1."""
    if not 0 < value <= 1:
        raise GeometryError(f"{name} is {value!r}; give a fraction above 0 and at most 1")
    return float(value)


def as_distance(value: float, name: str = "max_distance") -> float:
    """Return a length that is not negative; infinity is one."""
    if not value >= 0:
        raise GeometryError(f"{name} is {value!r}; give a distance, 0 or more")
    return float(value)


def as_seed(seed: object) -> int:
    """Return the seed of a random generator, a whole number that is not negative."""
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
        raise GeometryError(f"seed is {seed!r}; give a whole number, 0 or more")
    return int(seed)
