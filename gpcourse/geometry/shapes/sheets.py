"""Surfaces with a boundary: disc, annulus and Möbius strip."""

from __future__ import annotations

import numpy as np

from gpcourse.errors import GeometryError
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray
from gpcourse.geometry.shapes.grids import grid_quads, halved
from gpcourse.geometry.shapes.parameters import positive, whole
from gpcourse.geometry.shapes.shape import Shape


def disc(rings: int = 4, *, radius: float = 1.0) -> Shape:
    """Return a flat disc in the plane z = 0: a centre and `rings` rings, ring k with 6 k vertices."""
    rings = whole("rings", rings, 1)
    radius = positive("radius", radius)
    ring = np.repeat(np.arange(1, rings + 1), 6 * np.arange(1, rings + 1))
    step = np.concatenate([np.arange(6 * k) for k in range(1, rings + 1)])
    angle = np.pi / 3 * step / ring
    plane = (radius / rings * ring)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    vertices = np.pad(plane, ((1, 0), (0, 1)))
    faces = np.concatenate([_ring_faces(k) for k in range(rings)])
    return flat("disc", vertices, faces, loops=(6 * rings,), interior=np.append(True, ring < rings))


def annulus(n: int = 24, rows: int = 4, *, inner: float = 0.5, outer: float = 1.0) -> Shape:
    """Return a flat ring in the plane z = 0, with two boundary loops of `n` edges.

    Parameters
    ----------
    n, rows : int
        Number of vertices around, and of rows of faces between the loops.
    inner, outer : float
        The two radii.
    """
    n, rows = whole("n", n, 3), whole("rows", rows, 1)
    inner, outer = positive("inner", inner), positive("outer", outer)
    if inner >= outer:
        raise GeometryError(f"inner is {inner} and outer is {outer}; inner must be the smaller one")
    row, column = np.divmod(np.arange(n * (rows + 1)), n)
    angle = 2 * np.pi / n * (column + 0.5 * row)
    distance = inner + (outer - inner) * row / rows
    vertices = np.column_stack([distance * np.cos(angle), distance * np.sin(angle), np.zeros(len(row))])
    i, j = grid_quads(n, rows)
    # The rows go outwards, so columns and rows make a left-handed pair seen from +z.
    faces = halved(i % n + n * j)[:, ::-1]
    return flat("annulus", vertices, faces, loops=(n, n), interior=(row > 0) & (row < rows))


def moebius(n: int = 24, rows: int = 2, *, radius: float = 1.0, width: float = 0.6) -> Shape:
    """Return a Möbius strip: one side, one boundary loop of ``2 n`` edges, and faces that disagree.

    No choice of directions makes neighbours agree along every edge; here they disagree along the
    `rows` edges where the strip closes.

    Parameters
    ----------
    n, rows : int
        Number of vertices around, and of rows of faces across.
    radius, width : float
        Of the middle circle, and of the strip.
    """
    n, rows = whole("n", n, 3), whole("rows", rows, 1)
    radius, width = positive("radius", radius), positive("width", width)
    if width >= 2 * radius:
        raise GeometryError(f"width is {width} and radius is {radius}; the width must be below 2 * radius")
    column, row = np.divmod(np.arange(n * (rows + 1)), rows + 1)
    u = 2 * np.pi / n * column
    across = width * (row / rows - 0.5)
    distance = radius + across * np.cos(u / 2)
    vertices = np.column_stack([distance * np.cos(u), distance * np.sin(u), across * np.sin(u / 2)])
    i, j = grid_quads(n, rows)
    # Column n is column 0 upside down.
    faces = halved((i % n) * (rows + 1) + np.where(i == n, rows - j, j))
    interior = (row > 0) & (row < rows)
    return Shape("Möbius strip", vertices, faces, genus=None, boundary_lengths=(2 * n,), interior=interior)


def flat(
    name: str, vertices: FloatArray, faces: IntArray, *, loops: tuple[int, ...], interior: BoolArray
) -> Shape:
    """Return a shape in the plane z = 0: its normal is +z, its curvatures are zero."""
    zero = np.zeros(len(vertices))
    return Shape(
        name,
        vertices,
        faces,
        boundary_lengths=loops,
        interior=interior,
        normals=np.column_stack([zero, zero, zero + 1]),
        mean_curvature=zero,
        gaussian_curvature=zero.copy(),
        principal_curvatures=np.zeros((len(zero), 2)),
    )


def _ring_faces(k: int) -> IntArray:
    """Return the faces between ring k (the centre is ring 0) and ring k + 1 of a disc."""
    sector = np.arange(6)[:, None]
    inner_first, outer_first = (1 + 3 * k * (k - 1) if k else 0), 1 + 3 * k * (k + 1)
    around = np.arange(k + 1)
    inner = inner_first + (sector * k + around) % max(6 * k, 1)
    outer = outer_first + (sector * (k + 1) + np.arange(k + 2)) % (6 * (k + 1))
    pointing_in = np.stack([inner, outer[:, :-1], outer[:, 1:]], axis=2)
    pointing_out = np.stack([inner[:, :-1], outer[:, 1:-1], inner[:, 1:]], axis=2)
    return np.concatenate([pointing_in.reshape(-1, 3), pointing_out.reshape(-1, 3)])
