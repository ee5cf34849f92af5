"""Truths that do not come from the reference: the same geometry, worked out another way and dense."""

from __future__ import annotations

from typing import Any

import numpy as np

from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray

_AHEAD, _BEHIND = np.array([1, 2, 0]), np.array([2, 0, 1])


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross product; that of numpy takes ten times as long on few vectors."""
    return np.asarray(a[..., _AHEAD] * b[..., _BEHIND] - a[..., _BEHIND] * b[..., _AHEAD])


def opposite_edges(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the (m, 3, 3) edge vectors, row k that which faces corner k."""
    x = vertices[faces]
    return np.asarray(np.roll(x, -2, axis=1) - np.roll(x, -1, axis=1))


def face_areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the (m,) areas."""
    e = opposite_edges(vertices, faces)
    return np.asarray(np.linalg.norm(cross(e[:, 0], e[:, 1]), axis=1) / 2)


def cotangents(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the (m, 3) cotangents of the corners, from the edges: (b² + c² − a²) / 4A."""
    squared = np.square(opposite_edges(vertices, faces)).sum(axis=2)
    total = squared.sum(axis=1, keepdims=True)
    return np.asarray((total - 2 * squared) / (4 * face_areas(vertices, faces)[:, None]))


def angles(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the (m, 3) angles of the corners: twice the arc tangent of half a chord."""
    e = opposite_edges(vertices, faces)
    e = e / np.linalg.norm(e, axis=2, keepdims=True)
    ahead, behind = np.roll(e, -2, axis=1), -np.roll(e, -1, axis=1)
    return np.asarray(
        2 * np.arctan2(np.linalg.norm(ahead - behind, axis=2), np.linalg.norm(ahead + behind, axis=2))
    )


def stiffness(vertices: FloatArray, faces: IntArray) -> FloatArray:
    r"""Return the dense cotangent matrix from gradients of hat functions.

    The gradient of the hat function of corner i is as long as :math:`|e_i| / 2A` and at right angles to
    the edge :math:`e_i` that faces the corner, so that
    :math:`c_{ij} = -\int \nabla\phi_i \cdot \nabla\phi_j = -\sum e_i \cdot e_j / 4A`.
    """
    e = opposite_edges(vertices, faces)
    local = -np.einsum("fix,fjx->fij", e, e) / (4 * face_areas(vertices, faces)[:, None, None])
    C = np.zeros((len(vertices), len(vertices)))
    np.add.at(C, (faces[:, :, None], faces[:, None, :]), local)
    return C


def area_gradient(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the (n, 3) gradient of the surface's area: a corner pulls at right angles to its edge."""
    e = opposite_edges(vertices, faces)
    normal = cross(e[:, 0], e[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    gradient = np.zeros_like(vertices)
    np.add.at(gradient, faces, cross(normal[:, None, :], e) / 2)
    return gradient


def circumcentric_corners(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the (m, 3) signed areas between corner, middle of an edge, circumcentre, middle of the other."""
    x = vertices[faces] - vertices[faces[:, :1]]
    squared = np.square(opposite_edges(vertices, faces)).sum(axis=2)
    weight = squared * (squared.sum(axis=1, keepdims=True) - 2 * squared)
    centre = np.einsum("fk,fkx->fx", weight / weight.sum(axis=1, keepdims=True), x)[:, None, :]
    normal = cross(x[:, 1], x[:, 2])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    ahead, behind = (np.roll(x, -1, axis=1) - x) / 2, (np.roll(x, -2, axis=1) - x) / 2
    twice = cross(ahead, centre - x) + cross(centre - x, behind)
    return np.asarray(np.einsum("fkx,fx->fk", twice, normal) / 2)


def obtuse_corners(vertices: FloatArray, faces: IntArray) -> BoolArray:
    """Return the (m, 3) flags of the corners whose angle exceeds a right one."""
    return np.asarray(cotangents(vertices, faces) < 0)


def mixed_corners(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the (m, 3) parts of each face that belong to its corners' mixed cells."""
    obtuse = obtuse_corners(vertices, faces)
    shares = face_areas(vertices, faces)[:, None] * np.where(obtuse, 0.5, 0.25)
    return np.where(obtuse.any(axis=1, keepdims=True), shares, circumcentric_corners(vertices, faces))


def per_vertex(faces: IntArray, values: FloatArray, n_vertices: int) -> FloatArray:
    """Add up (m, 3) values of corners at their vertices."""
    return np.bincount(faces.ravel(), weights=values.ravel(), minlength=n_vertices).astype(np.float64)


def mixed_areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the (n,) areas of the mixed cells."""
    return per_vertex(faces, mixed_corners(vertices, faces), len(vertices))


def third_areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the (n,) areas of the barycentric cells."""
    thirds = np.repeat(face_areas(vertices, faces)[:, None] / 3, 3, axis=1)
    return per_vertex(faces, thirds, len(vertices))


def voronoi_areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the (n,) signed areas of the cells that end at the circumcentres."""
    return per_vertex(faces, circumcentric_corners(vertices, faces), len(vertices))


#: The areas of cells by the names that the option `cells` knows.
CELLS = {"mixed": mixed_areas, "barycentric": third_areas, "voronoi": voronoi_areas}


def cells(vertices: FloatArray, faces: IntArray, name: str) -> FloatArray:
    """Return the (n,) areas of the cells of that name."""
    if name not in CELLS:
        raise ValueError(f"there are no cells of the name {name!r}")
    return CELLS[name](vertices, faces)


def laplacian(vertices: FloatArray, faces: IntArray, name: str = "mixed") -> FloatArray:
    """Return the dense M⁻¹C with cells of that name."""
    return np.asarray(stiffness(vertices, faces) / cells(vertices, faces, name)[:, None])


def neighbours(faces: IntArray, n_vertices: int) -> list[set[int]]:
    """Return the neighbours of each vertex."""
    around: list[set[int]] = [set() for _ in range(n_vertices)]
    for a, b, c in faces.tolist():
        around[a] |= {b, c}
        around[b] |= {c, a}
        around[c] |= {a, b}
    return around


def mean_of_neighbours(faces: IntArray, n_vertices: int) -> FloatArray:
    """Return the dense uniform Laplacian; the row of an isolated vertex is zero."""
    L = np.zeros((n_vertices, n_vertices))
    for v, ring in enumerate(neighbours(faces, n_vertices)):
        for w in ring:
            L[v, w] = 1 / len(ring)
            L[v, v] = -1
    return L


def boundary_edges(faces: IntArray) -> set[tuple[int, int]]:
    """Return the edges (a, b) that a face runs along and no other runs back."""
    sides = {(f[k - 1], f[k]) for f in faces.tolist() for k in range(3)}
    return {(a, b) for a, b in sides if (b, a) not in sides}


def boundary_vertices(faces: IntArray) -> IntArray:
    """Return the vertices on a boundary, sorted."""
    return np.array(sorted({v for edge in boundary_edges(faces) for v in edge}), dtype=np.int64)


def flat_angles(faces: IntArray, n_vertices: int) -> FloatArray:
    """Return the (n,) angle sums of a flat surface: π at the boundary, 2π elsewhere."""
    total = np.full(n_vertices, 2 * np.pi)
    total[boundary_vertices(faces)] = np.pi
    return total


def defects(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the (n,) angle defects."""
    sums = per_vertex(faces, angles(vertices, faces), len(vertices))
    return np.asarray(flat_angles(faces, len(vertices)) - sums)


def modes(C: Any, M: Any) -> tuple[FloatArray, FloatArray]:
    """Return all frequencies, ascending, and modes that are orthonormal in M, by dense algebra."""
    root = np.sqrt(M.diagonal())
    values, vectors = np.linalg.eigh(-dense(C) / np.outer(root, root))
    return np.asarray(values), np.asarray(vectors / root[:, None])


def dense(matrix: Any) -> FloatArray:
    """Return a matrix as an array."""
    return np.asarray(matrix.toarray() if hasattr(matrix, "toarray") else matrix, dtype=float)
