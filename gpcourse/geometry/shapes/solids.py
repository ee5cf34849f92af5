"""Convex polyhedra: the five Platonic solids, prisms and pyramids."""

from __future__ import annotations

from itertools import product

import numpy as np

from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.geometry.shapes.parameters import positive, whole
from gpcourse.geometry.shapes.shape import Shape

_GOLDEN = (1 + np.sqrt(5)) / 2


def tetrahedron(radius: float = 1.0) -> Shape:
    """Return the regular tetrahedron with corners at distance `radius` from its centre, the origin."""
    corners = _unit([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)])
    return _solid("tetrahedron", positive("radius", radius) * corners, -corners, 3)


def cube(side: float = 1.0) -> Shape:
    """Return the cube of six quads, centred at the origin."""
    corners = np.array(list(product((-0.5, 0.5), repeat=3)))
    return _solid("cube", positive("side", side) * corners, _axes(), 4)


def octahedron(radius: float = 1.0) -> Shape:
    """Return the regular octahedron with corners on the axes at distance `radius`."""
    return _solid("octahedron", positive("radius", radius) * _axes(), list(product((-1, 1), repeat=3)), 3)


def icosahedron(radius: float = 1.0) -> Shape:
    """Return the regular icosahedron with corners at distance `radius` from its centre, the origin."""
    corners = positive("radius", radius) * _icosahedron_corners()
    return _solid("icosahedron", corners, _dodecahedron_corners(), 3)


def dodecahedron(radius: float = 1.0) -> Shape:
    """Return the regular dodecahedron, twelve pentagons, with corners at distance `radius`."""
    corners = positive("radius", radius) * _dodecahedron_corners()
    return _solid("dodecahedron", corners, _icosahedron_corners(), 5)


def prism(k: int = 5, *, radius: float = 1.0, height: float = 1.0) -> Shape:
    """Return the upright prism over a regular k-gon: k quads and two k-gons."""
    k = whole("k", k, 3)
    base = _polygon(k, positive("radius", radius))
    half = np.array([0.0, 0.0, positive("height", height) / 2])
    i = list(range(k))
    sides = [[a, b, b + k, a + k] for a, b in zip(i, [*i[1:], 0], strict=True)]
    faces = [[*reversed(i)], *sides, [a + k for a in i]]
    return Shape(f"prism over a {k}-gon", np.vstack([base - half, base + half]), faces)


def pyramid(k: int = 5, *, radius: float = 1.0, height: float = 1.0) -> Shape:
    """Return the upright pyramid over a regular k-gon: k triangles and one k-gon; the apex is vertex k."""
    k = whole("k", k, 3)
    base = _polygon(k, positive("radius", radius))
    i = list(range(k))
    sides = [[a, b, k] for a, b in zip(i, [*i[1:], 0], strict=True)]
    apex = [[0.0, 0.0, positive("height", height)]]
    return Shape(f"pyramid over a {k}-gon", np.vstack([base, apex]), [[*reversed(i)], *sides])


def _solid(name: str, corners: FloatArray, directions: object, k: int) -> Shape:
    """Return the convex solid whose face towards each direction joins the k corners farthest that way."""
    faces = np.array([_face_towards(corners, direction, k) for direction in np.asarray(directions, float)])
    return Shape(name, corners, faces)


def _face_towards(corners: FloatArray, direction: FloatArray, k: int) -> IntArray:
    face = np.sort(np.argsort(corners @ direction)[-k:])
    spokes = corners[face] - corners[face].mean(axis=0)
    # Angles in the plane of the face, counter-clockwise for an eye that `direction` points at.
    across = np.cross(direction, spokes[0]) / np.linalg.norm(direction)
    angles = np.arctan2(spokes @ across, spokes @ spokes[0]) % (2 * np.pi - 1e-9)
    return np.asarray(face[np.argsort(angles)])


def _axes() -> FloatArray:
    return np.vstack([np.eye(3), -np.eye(3)])


def _unit(points: object) -> FloatArray:
    array = np.asarray(points, dtype=float)
    return np.asarray(array / np.linalg.norm(array, axis=1, keepdims=True))


def _icosahedron_corners() -> FloatArray:
    # Three golden rectangles, each in a coordinate plane.
    rectangle = [(0, a, b * _GOLDEN) for a, b in product((-1, 1), repeat=2)]
    return _unit([np.roll(corner, k) for k in range(3) for corner in rectangle])


def _dodecahedron_corners() -> FloatArray:
    # A cube and three rectangles with sides golden and 1/golden.
    rectangle = [(0, a * _GOLDEN, b / _GOLDEN) for a, b in product((-1, 1), repeat=2)]
    rolled = [np.roll(corner, k) for k in range(3) for corner in rectangle]
    return _unit([*product((-1, 1), repeat=3), *rolled])


def _polygon(k: int, radius: float) -> FloatArray:
    angle = 2 * np.pi * np.arange(k) / k
    return radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(k)])
