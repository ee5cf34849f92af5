"""Surfaces whose normals and curvatures are known exactly: sphere, torus, cylinder."""

from __future__ import annotations

import numpy as np

from gpcourse.errors import GeometryError
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray
from gpcourse.geometry.shapes.grids import edge_midpoints, grid_quads, halved
from gpcourse.geometry.shapes.parameters import positive, whole
from gpcourse.geometry.shapes.shape import Shape
from gpcourse.geometry.shapes.solids import icosahedron


def icosphere(subdivisions: int = 3, *, radius: float = 1.0) -> Shape:
    """Return a sphere: an icosahedron with every triangle cut in four, `subdivisions` times.

    20 · 4^s triangles and 10 · 4^s + 2 vertices, all on the sphere about the origin.
    """
    subdivisions = whole("subdivisions", subdivisions, 0, 9)
    radius = positive("radius", radius)
    normals, faces = icosahedron().vertices, np.asarray(icosahedron().faces)
    for _ in range(subdivisions):
        n = len(normals)
        ends, edge = edge_midpoints(faces, n)
        middle = normals[ends].sum(axis=1)
        normals = np.vstack([normals, middle / np.linalg.norm(middle, axis=1, keepdims=True)])
        ab, bc, ca = (n + edge).T
        a, b, c = faces.T
        faces = np.column_stack([a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca]).reshape(-1, 3)
    one = np.ones(len(normals))
    return _curved("icosphere", radius * normals, faces, normals, k1=one / radius, k2=one / radius)


def torus(n: int = 32, m: int | None = None, *, R: float = 1.0, r: float = 0.4, quads: bool = False) -> Shape:
    """Return a torus about the z axis; every vertex has six neighbours, or four with quads.

    Parameters
    ----------
    n, m : int
        Number of vertices around the axis and around the tube. `m` is half of `n` if not given, so that
        doubling `n` halves every edge.
    R, r : float
        Distance of the tube's centre from the axis, and radius of the tube, r < R.
    quads : bool
        Whether to keep the n · m quads. Otherwise 2 · n · m triangles, each row set half a step on from
        the row before, so that no angle is obtuse with the values given here.

    Notes
    -----
    Principal curvatures 1/r and cos v / (R + r cos v), at the angle v around the tube.
    """
    n = whole("n", n, 3)
    m = max(3, n // 2) if m is None else whole("m", m, 3)
    R, r = positive("R", R), positive("r", r)
    if r >= R:
        raise GeometryError(f"r is {r} and R is {R}; the tube meets itself unless r < R")
    # Row j starts j * turn / m steps on; after m rows these are `turn` whole steps, so it closes.
    turn = 0 if quads else m // 2
    i, j = grid_quads(n, m)
    cells = (i + turn * (j // m)) % n + n * (j % m)
    row, column = np.divmod(np.arange(n * m), n)
    u = 2 * np.pi / n * (column + turn * row / m)
    v = 2 * np.pi / m * row
    normals = np.column_stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)])
    centre = np.column_stack([R * np.cos(u), R * np.sin(u), np.zeros(n * m)])
    faces = cells if quads else halved(cells)
    k2 = np.cos(v) / (R + r * np.cos(v))
    return _curved("torus", centre + r * normals, faces, normals, k1=np.full(n * m, 1 / r), k2=k2, genus=1)


def cylinder(
    n: int = 24, rows: int = 8, *, radius: float = 1.0, height: float = 2.0, quads: bool = False
) -> Shape:
    """Return an open tube about the z axis, faces outward, with two boundary loops of `n` edges.

    Parameters
    ----------
    n, rows : int
        Number of vertices around, and of rows of faces.
    quads : bool
        Whether to keep the quads; otherwise every second row of vertices is turned by half a step.
    """
    n, rows = whole("n", n, 3), whole("rows", rows, 1)
    radius, height = positive("radius", radius), positive("height", height)
    i, j = grid_quads(n, rows)
    cells = i % n + n * j
    row, column = np.divmod(np.arange(n * (rows + 1)), n)
    u = 2 * np.pi / n * (column + (0.0 if quads else 0.5) * row)
    normals = np.column_stack([np.cos(u), np.sin(u), np.zeros(len(u))])
    vertices = radius * normals
    vertices[:, 2] = height * (row / rows - 0.5)
    return _curved(
        "cylinder",
        vertices,
        cells if quads else halved(cells),
        normals,
        k1=np.full(len(u), 1 / radius),
        k2=np.zeros(len(u)),
        loops=(n, n),
        interior=(row > 0) & (row < rows),
    )


def _curved(
    name: str,
    vertices: FloatArray,
    faces: IntArray,
    normals: FloatArray,
    *,
    k1: FloatArray,
    k2: FloatArray,
    genus: int = 0,
    loops: tuple[int, ...] = (),
    interior: BoolArray | None = None,
) -> Shape:
    return Shape(
        name,
        vertices,
        faces,
        genus=genus,
        boundary_lengths=loops,
        interior=interior,
        normals=normals,
        mean_curvature=(k1 + k2) / 2,
        gaussian_curvature=k1 * k2,
        principal_curvatures=np.column_stack([k1, k2]),
    )
