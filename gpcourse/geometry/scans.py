"""A virtual range scanner: it looks at a shape from a known pose, and keeps what it sees.

The scanner looks down its own z axis, along parallel rays on a square grid. What is hidden behind something
else is missing, and so is what it sees at a grazing angle. A scan is given in the scanner's coordinates,
as from a real device; its pose takes it back to the shape.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gpcourse.errors import GeometryError
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray, as_points, as_triangles
from gpcourse.geometry.shapes.curved import icosphere
from gpcourse.geometry.shapes.parameters import Rng, generator, positive, whole
from gpcourse.geometry.shapes.shape import Shape
from gpcourse.geometry.triangles import vertex_normals

#: Neighbouring pixels further apart than this many pixels lie on different sheets.
_JUMP = 4.0


@dataclass(frozen=True, eq=False, repr=False)
class Scan:
    """What a scanner saw, and from where.

    Attributes
    ----------
    name : str
        What messages and pictures call it.
    points : (n, 3) float array
        Positions in the scanner's coordinates.
    R, t : (3, 3) and (3,) float arrays
        The true pose: ``R @ x + t`` is where a point x lies on the shape.
    faces : (m, 3) int array
        Triangles between neighbouring pixels, counter-clockwise seen from the scanner.
    normals : (n, 3) float array or None
        Unit normals of the shape at the points, in the scanner's coordinates, without the noise. None
        where they are not known, as for a real scan.
    outlier : (n,) bool array
        True for the points that are not on the shape at all. They belong to no triangle.
    """

    name: str
    points: FloatArray
    R: FloatArray
    t: FloatArray
    faces: IntArray
    normals: FloatArray | None
    outlier: BoolArray

    def __repr__(self) -> str:
        return f"<Scan {self.name}: {len(self.points)} points, {len(self.faces)} faces>"

    @property
    def pose(self) -> tuple[FloatArray, FloatArray]:
        """The pose (R, t)."""
        return self.R, self.t

    @property
    def placed(self) -> FloatArray:
        """The points where they lie on the shape."""
        return self.points @ self.R.T + self.t

    @property
    def on_boundary(self) -> BoolArray:
        """Whether each point lies on an edge of one triangle only, or in no triangle."""
        n = len(self.points)
        tail, head = self.faces.ravel(), np.roll(self.faces, -1, axis=1).ravel()
        edges, count = np.unique(np.minimum(tail, head) * n + np.maximum(tail, head), return_counts=True)
        flags = np.ones(n, dtype=bool)
        flags[tail] = False
        flags[np.concatenate(np.divmod(edges[count == 1], n))] = True
        return flags


def pebble(subdivisions: int = 5) -> Shape:
    """Return a closed surface of no symmetry: a ball with bumps, two of them as high as ears, and a dent.

    About 3 long. The ears hide what is behind them, and no motion slips along it.
    """
    ball = icosphere(whole("subdivisions", subdivisions, 0, 7))
    directions = np.array(
        [[1, 0.5, 2], [-0.4, 1.2, 2], [2, -1, -0.3], [-1, -2, 0.5], [-2, 1, -1], [0.3, 0.2, -2]]
    )
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    heights, sharpness = np.array([0.9, 0.7, 0.35, -0.25, 0.3, 0.2]), np.array([14, 18, 6, 8, 10, 5])
    bumps = np.exp(sharpness * (ball.vertices @ directions.T - 1)) @ heights
    return Shape("pebble", ball.vertices * (1 + bumps)[:, None], ball.faces)


def turntable(
    shape: Shape, angles: object = (0, 45, 90, 180, 270), *, tilt: float = 15.0, **scanner: object
) -> list[Scan]:
    """Scan a shape from several sides, as on a turntable.

    Parameters
    ----------
    shape : Shape
        With triangular faces.
    angles : sequence of float
        By how much the table is turned for each scan, in degrees about the z axis.
    tilt : float
        How far the scanner looks down on the table, in degrees.
    **scanner
        Passed on to `scan`. A seed as `rng` is made a different one for each scan.
    """
    rng = generator(scanner.pop("rng", 0))
    turns = np.radians(np.asarray(angles, dtype=np.float64).ravel())
    down = np.radians(tilt)
    return [
        scan(
            shape,
            (np.cos(down) * np.sin(a), -np.cos(down) * np.cos(a), np.sin(down)),
            name=f"{shape.name} {round(np.degrees(a)):03d}",
            rng=rng,
            **scanner,  # type: ignore[arg-type]  # their types are scan's to check
        )
        for a in turns
    ]


def scan(
    shape: Shape,
    towards: object = (0.0, 0.0, 1.0),
    *,
    pixels: int = 80,
    noise: float = 0.0,
    outliers: float = 0.0,
    max_angle: float = 75.0,
    name: str | None = None,
    rng: Rng = 0,
) -> Scan:
    """Look at a shape from one side, and keep what is seen.

    Parameters
    ----------
    shape : Shape
        With triangular faces, counter-clockwise seen from outside.
    towards : (3,) array-like
        The direction from the shape to the scanner, of any length.
    pixels : int
        The number of rays along each side of the grid, which just covers the shape from any side.
    noise : float
        Standard deviation of the range, as a fraction of the diagonal of the shape's bounding box.
    outliers : float
        The fraction of the points that are replaced by points anywhere in the scanner's range, below 1.
    max_angle : float
        Surfaces whose normal is further than this from the ray are missed, in degrees below 90.
    name : str, optional
        What pictures call the scan.
    rng : int or numpy.random.Generator
        For noise and outliers.

    Raises
    ------
    GeometryError
        If an option is out of range, the faces are not triangles, or nothing is seen.
    """
    _refuse_fractions(noise, outliers, max_angle)
    draw = generator(rng)
    R = _frame(towards)
    lowest, highest = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
    centre, diagonal = (lowest + highest) / 2, float(np.linalg.norm(highest - lowest))
    pitch = positive("the diagonal of the shape", diagonal) / (whole("pixels", pixels, 2, 4096) - 1)
    faces = as_triangles(shape.faces, len(shape.vertices))
    seen = _seen(((shape.vertices - centre) @ R) / pitch + (pixels - 1) / 2, faces, pixels)
    normals = shape.normals if shape.normals is not None else vertex_normals(shape.vertices, faces)
    normal = np.einsum("ij,ijk->ik", seen.weights, normals[faces[seen.face]]) @ R
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    facing = normal[:, 2] >= math.cos(math.radians(max_angle))
    row, column, depth = seen.row[facing], seen.column[facing], seen.depth[facing]
    if not len(depth):
        raise GeometryError(f"nothing of {shape.name} is seen; give more pixels, or another direction")
    outlier = draw.random(len(depth)) < outliers
    index = np.full((pixels, pixels), -1)
    index[row[~outlier], column[~outlier]] = np.flatnonzero(~outlier)
    triangles = grid_triangles(index, np.column_stack([column, row, depth]), _JUMP)
    depth = depth + (noise * diagonal / pitch) * draw.normal(size=len(depth))
    depth[outlier] = draw.uniform(0, pixels - 1, size=np.count_nonzero(outlier))
    points = (np.column_stack([column, row, depth]) - (pixels - 1) / 2) * pitch
    return Scan(name or shape.name, points, R, centre, triangles, normal[facing], outlier)


@dataclass(frozen=True, eq=False)
class _Seen:
    """The nearest surface at each pixel that has one: its face, the weights of the corners, its height."""

    row: IntArray
    column: IntArray
    face: IntArray
    weights: FloatArray
    depth: FloatArray


def _refuse_fractions(noise: float, outliers: float, max_angle: float) -> None:
    if not 0 <= noise < math.inf:
        raise GeometryError(f"noise is {noise}; give a fraction of the diagonal, 0 or more")
    if not 0 <= outliers < 1:
        raise GeometryError(f"outliers is {outliers}; give a fraction from 0 to below 1")
    if not 0 < max_angle < 90:
        raise GeometryError(f"max_angle is {max_angle}; give degrees above 0 and below 90")


def _frame(towards: object) -> FloatArray:
    """Return a rotation whose last column is the direction, with the second as upright as can be."""
    direction = as_points([towards], "towards")[0]
    z = direction / positive("the length of towards", np.linalg.norm(direction))
    up = np.array([0.0, 0.0, 1.0]) if abs(z[2]) < 0.99 else np.array([0.0, 1.0, 0.0])
    x = np.cross(up, z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def _seen(corners: FloatArray, faces: IntArray, pixels: int) -> _Seen:
    """Keep the highest of all surfaces over each pixel (a z-buffer); one pixel is one unit of length."""
    a, b, c = (corners[faces[:, k]] for k in range(3))
    # Twice the signed area on the screen; the scanner sees no face from behind, or edge on.
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    front = np.flatnonzero(area > 1e-12)
    boxes = np.stack([a, b, c])[:, front, :2]
    first, last = np.ceil(boxes.min(axis=0)).astype(np.int64), np.floor(boxes.max(axis=0)).astype(np.int64)
    first, last = np.maximum(first, 0), np.minimum(last, pixels - 1)
    wide, high = np.maximum(last - first + 1, 0).T
    # One entry for each pixel in each face's box.
    entry = np.repeat(np.arange(len(front)), wide * high)
    place = np.arange(len(entry)) - np.repeat(np.cumsum(wide * high) - wide * high, wide * high)
    pixel = first[entry] + np.column_stack([place % wide[entry], place // wide[entry]])
    face = front[entry]
    weights = (
        np.column_stack(
            [
                _twice_area(pixel, b[face], c[face]),
                _twice_area(pixel, c[face], a[face]),
                _twice_area(pixel, a[face], b[face]),
            ]
        )
        / area[face, None]
    )
    inside = (weights >= 0).all(axis=1)
    pixel, face, weights = pixel[inside], face[inside], weights[inside]
    depth = np.einsum("ij,ij->i", weights, corners[faces[face], 2])
    # Sort by pixel, then by height: the last of each pixel is what is seen.
    key = pixel[:, 1] * pixels + pixel[:, 0]
    order = np.lexsort((depth, key))
    top = order[np.append(key[order][1:] != key[order][:-1], True)] if len(order) else order
    return _Seen(pixel[top, 1], pixel[top, 0], face[top], weights[top], depth[top])


def _twice_area(pixel: IntArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Return twice the signed area of the triangle from a pixel to an edge, on the screen."""
    x, y = pixel[:, 0], pixel[:, 1]
    return np.asarray((b[:, 0] - x) * (c[:, 1] - y) - (b[:, 1] - y) * (c[:, 0] - x))


def grid_triangles(index: IntArray, points: FloatArray, longest: float) -> IntArray:
    """Join the points of neighbouring pixels by triangles, but not across a jump in depth.

    Parameters
    ----------
    index : (rows, columns) int array
        The point at each pixel, -1 where there is none. Rows upwards and columns to the right, seen from
        the scanner, for faces that look towards it.
    points : (n, 3) float array
    longest : float
        Two points further apart than this lie on different sheets.

    Returns
    -------
    (m, 3) int array
    """
    lower_left, lower_right = index[:-1, :-1], index[:-1, 1:]
    upper_left, upper_right = index[1:, :-1], index[1:, 1:]
    triangles = np.concatenate(
        [
            np.stack([lower_left, lower_right, upper_right], axis=-1).reshape(-1, 3),
            np.stack([lower_left, upper_right, upper_left], axis=-1).reshape(-1, 3),
        ]
    )
    triangles = triangles[(triangles >= 0).all(axis=1)]
    edges = points[triangles] - points[np.roll(triangles, -1, axis=1)]
    return np.asarray(triangles[((edges**2).sum(axis=2) <= longest**2).all(axis=1)], dtype=np.int64)
