"""Operators: the uniform Laplacian, cotangent weights, and the areas of the cells around vertices."""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy import sparse

from gpcourse.errors import GeometryError, MeshError
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray, as_triangles
from gpcourse.geometry.triangles import corner_cotangents, cotangents_and_areas, face_areas


def uniform_laplacian(faces: IntArray, n_vertices: int) -> sparse.csr_array:
    r"""Assemble the uniform Laplacian of a triangle mesh.

    .. math:: \Delta f(v_i) = \frac{1}{|N_1(v_i)|} \sum_{v_j \in N_1(v_i)} f(v_j) - f(v_i)

    It knows which vertices are neighbours, and nothing of lengths and angles: even in a flat patch
    ``L @ vertices`` is not zero.

    Parameters
    ----------
    faces : (m, 3) int array
        Vertex indices of the triangles.
    n_vertices : int
        Number of vertices; those that no face names are isolated.

    Returns
    -------
    (n, n) csr_array
        The mean over the neighbours minus the value itself. Rows sum to zero; the row of an isolated
        vertex is zero. Not symmetric. Dimensionless.

    Raises
    ------
    ValueError
        If an index is out of range or a face names a vertex twice; names the face.

    References
    ----------
    Notes ch. 6 §5, *Uniform Discretization*.
    """
    neighbours = adjacency(faces, n_vertices)
    valence = np.diff(neighbours.indptr)
    mean = sparse.diags_array(1 / np.maximum(valence, 1)) @ neighbours
    return sparse.csr_array(mean - sparse.diags_array((valence > 0).astype(float)))


def cotangent_matrix(vertices: FloatArray, faces: IntArray) -> sparse.csr_array:
    r"""Assemble the cotangent matrix C of a triangle mesh.

    .. math:: c_{ij} = \tfrac12 (\cot\alpha_{ij} + \cot\beta_{ij}),
              \qquad c_{ii} = -\sum_{j \ne i} c_{ij}

    The angles :math:`\alpha_{ij}, \beta_{ij}` are those opposite to the edge in its two faces; an edge on
    the boundary has one. Negative semi-definite and integrated over cells: ``C @ f`` is the Laplacian
    of `f` times the area of the vertex. Divide by the mass matrix for pointwise values.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions, any length unit.
    faces : (m, 3) int array
        Vertex indices, counter-clockwise seen from outside.

    Returns
    -------
    (n, n) csr_array
        Symmetric, zero row sums, dimensionless: the same for a larger mesh of the same shape.

    Raises
    ------
    DegenerateFaceError
        If a face has no area; names the first one.

    References
    ----------
    Notes ch. 6 §5, §8; Pinkall and Polthier 1993. The notes' §11 writes 2C, with 1/2A in the mass matrix.
    """
    # The angle at corner k faces the edge between the other two corners.
    weight = 0.5 * corner_cotangents(vertices, faces)
    corners = as_triangles(faces, len(vertices))
    tail, head = np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)
    shape = (len(vertices), len(vertices))
    W = sparse.coo_array((weight.ravel(), (tail.ravel(), head.ravel())), shape=shape).tocsr()
    W = W + W.T
    return sparse.csr_array(W - sparse.diags_array(W.sum(axis=1)))


def barycentric_areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the area of the barycentric cell of each vertex: a third of every triangle around it.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices.

    Returns
    -------
    (n,) float array
        In squared units of length. They sum to the area of the surface; 0 for an isolated vertex.

    References
    ----------
    Notes ch. 6 §4.
    """
    third = face_areas(vertices, faces) / 3
    return _summed_at_corners(faces, np.repeat(third[:, None], 3, axis=1), len(vertices))


def voronoi_areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    r"""Return the area of the Voronoi cell of each vertex, bounded by bisectors and circumcentres.

    .. math:: A_i = \tfrac18 \sum_{j \in N_1(i)} (\cot\alpha_{ij} + \cot\beta_{ij}) \|x_i - x_j\|^2

    Meant for triangles without an obtuse angle. The circumcentre of an obtuse one lies outside of it:
    the formula then counts what sticks out as negative, and a whole cell may become negative.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices.

    Returns
    -------
    (n,) float array
        In squared units of length. They sum to the area of the surface, obtuse triangles or not.

    Raises
    ------
    DegenerateFaceError
        If a face has no area; names the first one.

    References
    ----------
    Notes ch. 6 §4; Meyer et al. 2003.
    """
    parts = _voronoi_parts(*cotangents_and_areas(vertices, faces))
    return _summed_at_corners(faces, parts, len(vertices))


def mixed_areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the area of the mixed cell of each vertex.

    The Voronoi cell inside triangles without an obtuse angle. An obtuse triangle gives half of its area
    to its obtuse corner and a quarter to each of the others: the middle of the longest edge takes the
    place of the circumcentre.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices.

    Returns
    -------
    (n,) float array
        In squared units of length. They sum to the area of the surface; positive, except that an isolated
        vertex has 0.

    Raises
    ------
    DegenerateFaceError
        If a face has no area; names the first one.

    References
    ----------
    Notes ch. 6 §4, *Mixed Cells*; Meyer et al. 2003, fig. 4.
    """
    cotangents, areas = cotangents_and_areas(vertices, faces)
    parts = _voronoi_parts(cotangents, areas)
    face, corner = np.nonzero(cotangents < 0)  # a triangle has one obtuse corner at most
    parts[face] = areas[face, None] / 4
    parts[face, corner] = areas[face] / 2
    return _summed_at_corners(faces, parts, len(vertices))


def mass_matrix(
    vertices: FloatArray,
    faces: IntArray,
    *,
    cells: Literal["mixed", "barycentric", "voronoi"] = "mixed",
) -> sparse.csr_array:
    """Assemble the mass matrix M: the areas of the cells on the diagonal.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices.
    cells : "mixed", "barycentric" or "voronoi"
        Which area a vertex gets.

    Returns
    -------
    (n, n) csr_array
        Diagonal, in squared units of length: ``f @ M @ g`` is the integral of f times g.

    Raises
    ------
    ValueError
        If there are no such cells, or a face has no area.

    References
    ----------
    Notes ch. 6 §8. The notes' §11 has 1/2A in the inverse, with twice the weights in C.
    """
    areas = {"mixed": mixed_areas, "barycentric": barycentric_areas, "voronoi": voronoi_areas}
    if cells not in areas:
        raise GeometryError(f"cells is {cells!r}; give 'mixed', 'barycentric' or 'voronoi'")
    return sparse.csr_array(sparse.diags_array(areas[cells](vertices, faces)))


def laplacian(
    vertices: FloatArray,
    faces: IntArray,
    *,
    cells: Literal["mixed", "barycentric", "voronoi"] = "mixed",
) -> sparse.csr_array:
    r"""Assemble the Laplace–Beltrami operator :math:`\Delta = M^{-1} C`.

    .. math:: \Delta f(v_i) = \frac{1}{2 A_i} \sum_{v_j \in N_1(v_i)}
              (\cot\alpha_{ij} + \cot\beta_{ij}) (f_j - f_i)

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions.
    faces : (m, 3) int array
        Vertex indices, counter-clockwise seen from outside.
    cells : "mixed", "barycentric" or "voronoi"
        Which area a vertex gets.

    Returns
    -------
    (n, n) csr_array
        Pointwise, per squared unit of length. Not symmetric, but `M` times it is. No positive eigenvalue.

    Raises
    ------
    ValueError
        If a face has no area, or the cell of a vertex has none; names it.

    References
    ----------
    Notes ch. 6 §5, §8.
    """
    areas = mass_matrix(vertices, faces, cells=cells).diagonal()
    refuse_empty_cells(areas)
    return sparse.csr_array(sparse.diags_array(1 / areas) @ cotangent_matrix(vertices, faces))


def boundary_vertices(faces: IntArray, n_vertices: int) -> BoolArray:
    """Mark the vertices on a boundary: the ends of the edges that have one face.

    Parameters
    ----------
    faces : (m, 3) int array
        Vertex indices.
    n_vertices : int
        Number of vertices.

    Returns
    -------
    (n,) bool array
        False for isolated vertices.
    """
    corners = as_triangles(faces, n_vertices)
    boundary = np.zeros(n_vertices, dtype=bool)
    suspect = _around_incomplete(corners, n_vertices)
    if not suspect.any():  # a closed surface
        return boundary
    tail, head = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    counted = suspect[tail] & suspect[head]
    tail, head = tail[counted], head[counted]
    edge = np.sort(np.minimum(tail, head) * n_vertices + np.maximum(tail, head))
    # Sorted, the two sides of an inner edge are neighbours.
    same = edge[1:] == edge[:-1]
    single = np.ones(len(edge), dtype=bool)
    single[1:] &= ~same
    single[:-1] &= ~same
    smaller, larger = np.divmod(edge[single], max(n_vertices, 1))
    boundary[smaller] = boundary[larger] = True
    return boundary


def _around_incomplete(corners: IntArray, n_vertices: int) -> BoolArray:
    """Mark the vertices around which faces are missing or turned over, without sorting edges.

    Elsewhere each neighbour is ahead in one face and behind in another: numbers of the neighbours, any
    numbers, added for those ahead and subtracted for those behind, cancel.
    """
    a, b, c = np.random.default_rng(0).integers(2**40, size=n_vertices)[corners.T]
    left = np.stack([b - c, c - a, a - b])
    return np.asarray(np.bincount(corners.T.ravel(), weights=left.ravel(), minlength=n_vertices) != 0)


def adjacency(faces: IntArray, n_vertices: int) -> sparse.csr_array:
    """Assemble the symmetric (n, n) matrix with a 1 for each pair of neighbours."""
    corners = as_triangles(faces, n_vertices)
    tail, head = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    sides = sparse.coo_array((np.ones(len(tail)), (tail, head)), shape=(n_vertices, n_vertices)).tocsr()
    neighbours = sparse.csr_array(sides + sides.T)
    neighbours.data[:] = 1  # an inner edge was counted from both of its faces
    return neighbours


def refuse_empty_cells(areas: FloatArray) -> None:
    """Raise MeshError if the area of a vertex is zero, so that nothing can be divided by it."""
    empty = np.flatnonzero(areas == 0)
    if len(empty):
        raise MeshError(
            f"the cell of vertex {empty[0]} has area 0, by which the Laplacian would be divided; "
            "remove vertices that belong to no face"
        )


def _voronoi_parts(cotangents: FloatArray, areas: FloatArray) -> FloatArray:
    """Return what each corner of each triangle gets of it, up to the circumcentre; (m, 3)."""
    # The edge opposite to α has the squared length 2A (cot β + cot γ), and the three products of two
    # cotangents sum to 1: so the two terms of corner α are together A (1 + cot β cot γ) / 4.
    alpha, beta, gamma = cotangents.T
    others = np.stack([beta * gamma, gamma * alpha, alpha * beta], axis=1)
    return np.asarray((1 + others) * (areas[:, None] / 4))


def _summed_at_corners(faces: IntArray, values: FloatArray, n_vertices: int) -> FloatArray:
    """Add the value of each corner to its vertex."""
    return np.asarray(np.bincount(np.ravel(faces), weights=values.ravel(), minlength=n_vertices), float)
