"""Chapter 0: the warm-up exercise of the welcome notebook."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gpcourse.exercises import expect
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Asked
from gpcourse.geometry.arrays import FloatArray
from gpcourse.reference import welcome as reference


def _direction(arguments: tuple[Any, ...], value: Any) -> Any:
    """Let a vector stand for its line: what was meant to be a number has no length to compare."""
    vector = np.abs(np.asarray(value, dtype=float))
    return vector / max(float(np.linalg.norm(vector)), 1e-12) if vector.shape == (3,) else value


TRIANGLE_AREA = Exercise(
    reference.triangle_area,
    notes="ch. 0",
    hints=(
        "Two sides that leave the same corner span a parallelogram. What part of it is the triangle?",
        "`np.cross` of these two sides is a vector. Its length is the area of the parallelogram.",
        "`np.linalg.norm` gives the length of a vector.",
    ),
    canonical=_direction,
)


def _triangle(rng: np.random.Generator) -> tuple[FloatArray, float]:
    """Return the corners, as rows, of a triangle turned at random, and its area: ½ base × height."""
    base, height, foot = rng.uniform((1.0, 1.0, 0.2), (3.0, 3.0, 0.8))
    flat = np.array([[0.0, 0.0, 0.0], [base, 0.0, 0.0], [foot * base, height, 0.0]])
    axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return flat @ axes.T, 0.5 * base * height


def _area(triangle_area: Asked, corners: FloatArray, truth: float, tolerance: float, on: str) -> None:
    area = expect.number(triangle_area(*corners), "The area", on=on)
    expect.close(area, truth, tolerance, "The area", on=on)


@TRIANGLE_AREA.check("a right triangle with legs 3 and 4 has area 6")
def _(triangle_area: Asked, rng: np.random.Generator) -> None:
    corners = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]])
    _area(triangle_area, corners, 6.0, 1e-5, "the corners (0, 0, 0), (3, 0, 0), (0, 4, 0)")


@TRIANGLE_AREA.check("turning, moving and renaming the corners leave the area as it is")
def _(triangle_area: Asked, rng: np.random.Generator) -> None:
    corners, truth = _triangle(rng)
    # Single precision has 1e-7, and the areas are below 4.5.
    _area(triangle_area, corners, truth, 1e-5, "a triangle turned in space")
    _area(triangle_area, corners[::-1], truth, 1e-5, "the same triangle, its corners in reverse order")
    # 1000 away, double precision places a corner to 1e-13.
    _area(
        triangle_area,
        corners + rng.uniform(500.0, 1000.0, 3),
        truth,
        1e-5,
        "the same triangle, far from the origin",
    )


@TRIANGLE_AREA.check("a triangle s times as large has s² times the area")
def _(triangle_area: Asked, rng: np.random.Generator) -> None:
    corners, truth = _triangle(rng)
    for s in (100.0, 0.01):
        _area(triangle_area, s * corners, s**2 * truth, 1e-5 * s**2, f"a triangle scaled by {s:g}")


@TRIANGLE_AREA.check("corners on one line enclose no area")
def _(triangle_area: Asked, rng: np.random.Generator) -> None:
    a, b = rng.uniform(-1.0, 1.0, (2, 3))
    # Heron's formula is the root of a product with one factor of rounding size: off by up to about 1e-6 here.
    _area(triangle_area, np.array([a, b, a + 2 * (b - a)]), 0.0, 1e-5, "three corners on one line")
    _area(triangle_area, np.array([a, b, b]), 0.0, 1e-5, "two corners in the same place")


@TRIANGLE_AREA.variant("Heron's formula")
def _(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    x, y, z = (np.linalg.norm(side) for side in (c - b, a - c, b - a))
    s = (x + y + z) / 2
    return math.sqrt(max(0.0, float(s * (s - x) * (s - y) * (s - z))))


@TRIANGLE_AREA.variant("half of base times height")
def _(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    base, side = b - a, c - a
    height = side - (side @ base) / (base @ base) * base
    return float(np.linalg.norm(base) * np.linalg.norm(height) / 2)


@TRIANGLE_AREA.variant("the sides' lengths and dot product")
def _(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    u, v = b - a, c - a
    return 0.5 * math.sqrt(max(0.0, float((u @ u) * (v @ v) - (u @ v) ** 2)))


@TRIANGLE_AREA.mistake(
    "the ½ is missing",
    hint="The cross product measures the parallelogram of two sides. How many triangles fill it?",
)
def _(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    return 2 * reference.triangle_area(a, b, c)


@TRIANGLE_AREA.mistake(
    "the third coordinate is ignored",
    hint="Your area is that of the shadow on the xy-plane. What is that of an upright triangle?",
)
def _(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    u, v = b - a, c - a
    return float(0.5 * abs(u[0] * v[1] - u[1] * v[0]))


@TRIANGLE_AREA.mistake(
    "a vector is returned where its length was meant",
    hint="The cross product is a vector, at right angles to the triangle. An area is one number.",
)
def _(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    return np.asarray(0.5 * np.cross(b - a, c - a))


@TRIANGLE_AREA.mistake(
    "the positions of two corners are multiplied, not two sides",
    hint="Your result changes when the triangle is moved. Which vectors do not change then?",
)
def _(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    return 0.5 * float(np.linalg.norm(np.cross(b, c)))


@TRIANGLE_AREA.mistake(
    "two sides are multiplied as if they met at a right angle",
    hint="Half the product of two sides is right for a right angle only. Which quantity knows the angle?",
)
def _(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    return 0.5 * float(np.linalg.norm(b - a) * np.linalg.norm(c - a))


EXERCISES = (TRIANGLE_AREA,)
