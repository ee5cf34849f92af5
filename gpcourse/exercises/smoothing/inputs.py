"""Inputs that tell right from wrong: obtuse angles, valence 3, boundaries, any place and size. All small."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from gpcourse.exercises.smoothing import truths
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray

Rng = np.random.Generator

#: An answer in single precision is off by 6e-8 of its largest number, and by a few times that after sums
#: of a dozen terms. Double precision is off by about 1e-12, far from the origin included.
SINGLE = 2e-6

#: Conjugate gradients as SciPy stops them leave a residual of 1e-5; that is good enough for a flow.
ITERATED = 5e-5


def closed(rng: Rng) -> shapes.Shape:
    """Draw a closed surface with a handle, 26 vertices: valence 3, obtuse angles, any size and place."""
    return shapes.random_closed(rng, 20, genus=1)


def bounded(rng: Rng) -> shapes.Shape:
    """Draw the same kind of surface with two holes."""
    return shapes.random_bounded(rng, 40, genus=1, loops=2)


def apart(rng: Rng) -> shapes.Shape:
    """Draw two components of like size, one closed and one with holes."""
    whole, open_ = closed(rng), bounded(rng)
    ratio = float(np.ptp(open_.vertices, axis=0).max() / np.ptp(whole.vertices, axis=0).max())
    return shapes.shuffled(shapes.union(whole.scaled(ratio), open_), rng)


def faces_of(shape: shapes.Shape) -> IntArray:
    """Return the triangles of a shape."""
    return np.asarray(shape.faces)


def inside(shape: shapes.Shape) -> BoolArray:
    """Return the (n,) flags of the vertices that are not on a boundary."""
    return np.ones(len(shape.vertices), dtype=bool) if shape.interior is None else shape.interior


def patch(rng: Rng, k: int = 4, *, size: float = 1.0) -> shapes.Shape:
    """Draw a flat rectangle of k × k shaken cells in the plane z = 0, with some vertices of valence 3.

    Each cell is cut along either diagonal, whatever angles that makes: this is not a Delaunay mesh.
    """
    column, row = (index.ravel() for index in np.meshgrid(np.arange(k + 1), np.arange(k + 1)))
    free = np.column_stack([(column > 0) & (column < k), (row > 0) & (row < k)])
    plane = np.column_stack([column, row]) + np.where(free, rng.uniform(-0.22, 0.22, free.shape), 0.0)
    corner = np.flatnonzero((column < k) & (row < k))
    quads = np.column_stack([corner, corner + 1, corner + k + 2, corner + k + 1])
    quads = np.where(rng.random(len(quads))[:, None] < 0.5, quads, np.roll(quads, 1, axis=1))
    triangles = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    cut = rng.permutation(len(triangles))[: len(triangles) // 5]
    middle = np.einsum("fk,fkx->fx", rng.dirichlet((8.0, 8.0, 8.0), len(cut)), plane[triangles[cut]])
    new = len(plane) + np.arange(len(cut))
    a, b, c = triangles[cut].T
    split = np.column_stack([a, b, new, b, c, new, c, a, new]).reshape(-1, 3)
    stretched = np.vstack([plane, middle]) * [1.0, rng.uniform(0.4, 0.7)] * size / k
    inner = np.append(free.all(axis=1), np.ones(len(cut), dtype=bool))
    flat = shapes.Shape(
        "flat irregular patch",
        np.pad(stretched, ((0, 0), (0, 1))),
        np.vstack([np.delete(triangles, cut, axis=0), split]),
        boundary_lengths=(4 * k,),
        interior=inner,
    )
    return shapes.shuffled(flat, rng)


def grid(rng: Rng, k: int = 5) -> shapes.Shape:
    """Return a flat square of k × k cells, each cut into two right triangles, numbered at random.

    Its cotangent matrix is the five-point stencil: exact for polynomials of degree two.
    """
    column, row = (index.ravel() for index in np.meshgrid(np.arange(k + 1), np.arange(k + 1)))
    corner = np.flatnonzero((column < k) & (row < k))
    quads = np.column_stack([corner, corner + 1, corner + k + 2, corner + k + 1])
    inner = (column > 0) & (column < k) & (row > 0) & (row < k)
    square = shapes.Shape(
        "square of right triangles",
        np.column_stack([column / k, row / k, 0.0 * row]),
        quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3),
        boundary_lengths=(4 * k,),
        interior=inner,
    )
    return shapes.shuffled(square, rng)


@cache
def unit_sphere() -> shapes.Shape:
    """Return the icosphere of 42 vertices, which takes longer to make than most answers."""
    return shapes.icosphere(1)


def sphere(rng: Rng, radius: float = 1.0) -> shapes.Shape:
    """Return 42 vertices on a sphere about the origin, shaken so little that no angle is obtuse."""
    regular = unit_sphere()
    shaken = regular.vertices + rng.uniform(-0.03, 0.03, regular.vertices.shape)
    normals = shaken / np.linalg.norm(shaken, axis=1, keepdims=True)
    return shapes.shuffled(replace(regular, vertices=radius * normals, normals=normals), rng)


def turned(shape: shapes.Shape, rng: Rng) -> shapes.Shape:
    """Turn a shape about the origin at random."""
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return shape.transformed(Q * np.sign(np.linalg.det(Q)))


def triangle(rng: Rng, *, obtuse: bool | None = None) -> tuple[FloatArray, IntArray]:
    """Draw one triangle in space; `obtuse` decides whether the angle at one of its corners is so."""
    half = rng.uniform(0.6, 1.0)
    height = rng.uniform(0.3, 0.7) * half if obtuse else rng.uniform(1.2, 1.6) * half
    # Over the diameter of a circle: an angle is obtuse inside it and acute outside.
    foot = rng.uniform(0.1, 0.3) * half
    corners = np.array([[-half, 0.0, 0.0], [half, 0.0, 0.0], [foot, height, 0.0]])
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    Q *= np.sign(np.linalg.det(Q))
    turn = np.roll(np.arange(3), int(rng.integers(3)))
    return corners[turn] @ Q.T + rng.uniform(-2, 2, 3), np.array([[0, 1, 2]])


def with_isolated(faces: IntArray, n_vertices: int, rng: Rng) -> tuple[IntArray, int, IntArray]:
    """Spread three vertices without faces among the others: (faces, number of vertices, the isolated)."""
    isolated = np.array([0, int(rng.integers(2, n_vertices)), n_vertices + 2])
    place = np.setdiff1d(np.arange(n_vertices + 3), isolated)
    return place[faces], n_vertices + 3, isolated


def matrices(shape: shapes.Shape) -> tuple[Any, Any]:
    """Return the sparse C and M (mixed cells) of a shape."""
    from scipy import sparse

    faces = faces_of(shape)
    C = sparse.csr_array(truths.stiffness(shape.vertices, faces))
    M = sparse.diags_array(truths.mixed_areas(shape.vertices, faces)).tocsr()
    return C, M


def diagonal(values: FloatArray) -> Any:
    """Return a sparse diagonal matrix."""
    from scipy import sparse

    return sparse.diags_array(values).tocsr()


def interior_rows(arguments: tuple[Any, ...], value: Any) -> Any:
    """Canonical form of values per vertex where the task says nothing of the boundary: the inner ones."""
    faces = np.asarray(arguments[1])
    rows = np.asarray(value.toarray() if hasattr(value, "toarray") else value, dtype=float)
    inner = np.ones(len(arguments[0]), dtype=bool)
    inner[truths.boundary_vertices(faces)] = False
    return rows[inner] if len(rows) == len(inner) else rows
