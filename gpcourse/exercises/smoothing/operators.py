"""Exercises on the Laplacians of a mesh: uniform and by cotangents."""

from __future__ import annotations

from typing import Any

import numpy as np

from gpcourse.exercises import expect, pictures
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Asked
from gpcourse.exercises.smoothing import expecting, truths
from gpcourse.exercises.smoothing.inputs import (
    SINGLE,
    Rng,
    apart,
    bounded,
    closed,
    faces_of,
    grid,
    inside,
    patch,
    sphere,
    triangle,
    turned,
    with_isolated,
)
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.reference import smoothing as reference

# The uniform Laplacian --------------------------------------------------------------------------

UNIFORM_LAPLACIAN = Exercise(
    reference.uniform_laplacian,
    notes="ch. 6 §5",
    hints=[
        "Row v of the matrix says what is done at vertex v. Which columns does it need?",
        "Every face knows three pairs of neighbours. How often does each pair come up?",
        "Once the matrix holds a 1 for each neighbour, its row sums are the valences.",
    ],
)


def _expect_uniform(f: Asked, inputs: list[tuple[IntArray, FloatArray, str]]) -> None:
    """The function is asked for the faces only; the positions are for the picture."""
    answers = [f(faces, len(vertices)) for faces, vertices, _ in inputs]
    for value, (faces, vertices, on) in zip(f.each(answers), inputs, strict=True):
        expecting.matrix(value, truths.mean_of_neighbours(faces, len(vertices)), vertices, faces, on=on)


@UNIFORM_LAPLACIAN.check("each row is the mean over the neighbours minus the vertex itself", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape = closed(rng)
    tetrahedron = np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
    corners = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.4, 0.4, 1.0]])
    _expect_uniform(
        f,
        [
            (tetrahedron, corners, "a tetrahedron"),
            (faces_of(shape), shape.vertices, "a closed mesh with vertices of valence 3 and more"),
        ],
    )


@UNIFORM_LAPLACIAN.check("a boundary edge makes neighbours as an inner edge does")
def _(f: Asked, rng: Rng) -> None:
    shape = bounded(rng)
    _expect_uniform(
        f,
        [
            (np.array([[2, 0, 1]]), np.eye(3), "a single triangle"),
            (faces_of(shape), shape.vertices, "a mesh with holes"),
        ],
    )


@UNIFORM_LAPLACIAN.check("several components, and isolated vertices have a row of zeros")
def _(f: Asked, rng: Rng) -> None:
    shape = apart(rng)
    faces, n, isolated = with_isolated(faces_of(shape), len(shape.vertices), rng)
    vertices = np.tile(shape.vertices.max(axis=0), (n, 1))
    vertices[np.setdiff1d(np.arange(n), isolated)] = shape.vertices
    _expect_uniform(f, [(faces, vertices, "two components and three isolated vertices")])


def _adjacency(faces: IntArray, n: int) -> FloatArray:
    return np.asarray(truths.mean_of_neighbours(faces, n) > 0, dtype=float)


def _minus_identity(W: FloatArray) -> FloatArray:
    """Divide rows by their sums and take the identity away where there is a row."""
    sums = W.sum(axis=1)
    return np.asarray(W / np.where(sums > 0, sums, 1)[:, None] - np.diag((sums > 0).astype(float)))


@UNIFORM_LAPLACIAN.variant("sets of neighbours, as nested lists")
def _(faces: IntArray, n_vertices: int) -> Any:
    return truths.mean_of_neighbours(faces, n_vertices).tolist()


@UNIFORM_LAPLACIAN.variant(
    "the product of inverse valences and adjacency, as a COO matrix in single precision"
)
def _(faces: IntArray, n_vertices: int) -> Any:
    from scipy import sparse

    tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    ends = np.unique(np.vstack([np.column_stack([tail, head]), np.column_stack([head, tail])]), axis=0)
    W = sparse.coo_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(n_vertices, n_vertices))
    valence = np.asarray(W.sum(axis=1)).ravel()
    inverse = np.divide(1.0, valence, out=np.zeros(n_vertices), where=valence > 0)
    L = sparse.diags(inverse) @ W - sparse.diags((valence > 0).astype(float))
    return L.tocoo().astype(np.float32)


@UNIFORM_LAPLACIAN.mistake(
    "the sum over the neighbours was not divided by their number",
    hint="What does your matrix give for a vertex with six neighbours of value 1, itself of value 0?",
)
def _(faces: IntArray, n_vertices: int) -> Any:
    W = _adjacency(faces, n_vertices)
    return W - np.diag(W.sum(axis=1))


@UNIFORM_LAPLACIAN.mistake(
    "the columns were divided by the numbers of neighbours, not the rows",
    hint="`A / d` divides column j by `d[j]`. What do the entries of a row sum to?",
)
def _(faces: IntArray, n_vertices: int) -> Any:
    W = _adjacency(faces, n_vertices)
    valence = W.sum(axis=1)
    return W / np.maximum(valence, 1) - np.diag((valence > 0).astype(float))


@UNIFORM_LAPLACIAN.mistake(
    "the sign is that of the negative operator",
    hint="A vertex lies below all of its neighbours. Is the mean minus the vertex positive or negative?",
)
def _(faces: IntArray, n_vertices: int) -> Any:
    return -truths.mean_of_neighbours(faces, n_vertices)


@UNIFORM_LAPLACIAN.mistake(
    "the diagonal was forgotten",
    hint="What should the Laplacian of a constant be? Add up a row of your matrix.",
)
def _(faces: IntArray, n_vertices: int) -> Any:
    return np.maximum(truths.mean_of_neighbours(faces, n_vertices), 0)


@UNIFORM_LAPLACIAN.mistake(
    "an edge was counted once for each of its faces",
    hint="An inner edge has two faces, a boundary edge one. Should their neighbours weigh differently?",
)
def _(faces: IntArray, n_vertices: int) -> Any:
    W = np.zeros((n_vertices, n_vertices))
    for shift in (-1, -2):
        np.add.at(W, (faces.ravel(), np.roll(faces, shift, axis=1).ravel()), 1.0)
    return _minus_identity(W)


@UNIFORM_LAPLACIAN.mistake(
    "a boundary edge was entered in one direction only",
    hint="A face runs along each of its edges one way. Who runs along a boundary edge the other way?",
)
def _(faces: IntArray, n_vertices: int) -> Any:
    W = np.zeros((n_vertices, n_vertices))
    W[faces.ravel(), np.roll(faces, -1, axis=1).ravel()] = 1.0
    return _minus_identity(W)


@UNIFORM_LAPLACIAN.mistake(
    "the sum over the neighbours was divided by the number of faces",
    hint="Inside, a vertex has as many faces as neighbours. And at the boundary?",
)
def _(faces: IntArray, n_vertices: int) -> Any:
    W = _adjacency(faces, n_vertices)
    valence = np.bincount(faces.ravel(), minlength=n_vertices)
    return W / np.maximum(valence, 1)[:, None] - np.diag((valence > 0).astype(float))


@UNIFORM_LAPLACIAN.mistake(
    "the matrix was made symmetric by dividing by the roots of both valences",
    hint="Is the mean over the neighbours of v divided by anything that belongs to a neighbour?",
)
def _(faces: IntArray, n_vertices: int) -> Any:
    W = _adjacency(faces, n_vertices)
    root = np.sqrt(np.maximum(W.sum(axis=1), 1))
    return W / np.outer(root, root) - np.diag((W.sum(axis=1) > 0).astype(float))


@UNIFORM_LAPLACIAN.mistake(
    "the vertex itself was counted among its neighbours",
    hint="Look at the sum that the notes take: over whom does it run, and how many are they?",
)
def _(faces: IntArray, n_vertices: int) -> Any:
    W = _adjacency(faces, n_vertices)
    n = W.sum(axis=1)
    return (W - np.diag(n)) / (n + 1)[:, None]


@UNIFORM_LAPLACIAN.mistake(
    "an isolated vertex has a -1 on its diagonal",
    hint="What should the Laplacian of a constant be, at a vertex without neighbours too?",
)
def _(faces: IntArray, n_vertices: int) -> Any:
    return np.maximum(truths.mean_of_neighbours(faces, n_vertices), 0) - np.eye(n_vertices)


# The cotangent matrix ---------------------------------------------------------------------------

COTANGENT_MATRIX = Exercise(
    reference.cotangent_matrix,
    notes="ch. 6 §5, §8",
    hints=[
        "Write down for one triangle which entries of the matrix it adds to, and what.",
        "The angle at a corner faces the edge between the two other corners.",
        "With a and b the edges that leave a corner, its cosine is a·b and its sine |a × b|, "
        "both times the same lengths.",
        "What must the diagonal be so that every row sums to zero?",
    ],
)


@COTANGENT_MATRIX.check(
    "for one triangle, −uᵀCu is the area times the squared slope of the linear u", points=2
)
def _(f: Asked, rng: Rng) -> None:
    asked = []
    for obtuse, size in ((False, 1.0), (True, 100.0), (True, 0.01)):
        vertices, faces = triangle(rng, obtuse=obtuse)
        vertices = size * vertices
        kind = "an obtuse" if obtuse else "an acute"
        asked.append((f(vertices, faces), vertices, faces, f"{kind} triangle of size {size:g}"))
    for f.about, (value, vertices, faces, on) in enumerate(asked):
        C = expect.array(value, (3, 3), "The matrix", on=on)
        e = truths.opposite_edges(vertices, faces)[0]
        u = rng.normal(size=3)
        # The edges that face corners 0 and 1 lie in the plane: the shortest solution is the slope.
        slope = np.linalg.lstsq(e[:2], np.array([u[2] - u[1], u[0] - u[2]]), rcond=None)[0]
        truth = float(truths.face_areas(vertices, faces)[0] * slope @ slope)
        size = float(np.abs(C).max() * (u @ u))
        expect.close(-float(u @ C @ u), truth, 4 * SINGLE * max(size, truth), "−uᵀCu", on=on)


@COTANGENT_MATRIX.check("linear functions are harmonic inside a flat patch", points=2)
def _(f: Asked, rng: Rng) -> None:
    flat = turned(patch(rng), rng)
    value, slope, faces = f(flat.vertices, faces_of(flat)), rng.normal(size=3), faces_of(flat)
    on = "a flat patch with obtuse angles and vertices of valence 3"
    C = expect.array(value, (len(flat.vertices), len(flat.vertices)), "The matrix", on=on)
    expect.that(np.abs(C).max() > 0.1, "The matrix is zero, or nearly so.", on=on)
    residual = np.where(inside(flat), C @ (flat.vertices @ slope), 0.0)
    shown = pictures.Field(flat.vertices, faces, "Cu", flat.vertices @ slope, "u, which is linear")
    size = float(np.abs(C).max() * np.linalg.norm(slope))
    expect.close(residual, 0.0, 4 * SINGLE * size, "Cu of a linear u", on=on, shown=shown)


@COTANGENT_MATRIX.check("symmetric, rows that sum to zero, no positive eigenvalue")
def _(f: Asked, rng: Rng) -> None:
    shape = bounded(rng)
    n, on = len(shape.vertices), "a mesh with two holes"
    C = expect.array(f(shape.vertices, faces_of(shape)), (n, n), "The matrix", on=on)
    expect.that(np.abs(C).max() > 0.1, "The matrix is zero, or nearly so.", on=on)
    tolerance = 8 * SINGLE * float(np.abs(C).max())
    rows = C.sum(axis=1)
    place = shape.vertices, faces_of(shape)
    shown = pictures.Field(*place, "the sum of a row")
    expect.close(rows, 0.0, tolerance, "The row sums", on=on, shown=shown)
    what = "The difference of C and its transpose"
    expect.close(C - C.T, 0.0, tolerance, what, on=on, shown=pictures.Rows(*place, "C − Cᵀ"))
    largest = float(np.linalg.eigvalsh((C + C.T) / 2)[-1])
    expect.close(max(largest, 0.0), 0.0, tolerance, "The largest eigenvalue", on=on)


@COTANGENT_MATRIX.check(
    "C times the positions is minus the gradient of the area, boundary included", points=2
)
def _(f: Asked, rng: Rng) -> None:
    for_all = [
        (closed(rng), "a closed mesh"),
        (bounded(rng), "a mesh with holes"),
        (apart(rng), "two components"),
    ]
    answers = [f(shape.vertices, faces_of(shape)) for shape, _ in for_all]
    for value, (shape, on) in zip(f.each(answers), for_all, strict=True):
        n, faces = len(shape.vertices), faces_of(shape)
        C = expect.array(value, (n, n), "The matrix", on=on)
        # The rows sum to zero, so that only the rounding depends on the origin.
        middle = shape.vertices - shape.vertices.mean(axis=0)
        pull, truth = C @ middle, -truths.area_gradient(shape.vertices, faces)
        size = max(float(np.abs(C).max() * np.abs(middle).max()), float(np.abs(truth).max()))
        shown = pictures.Field(shape.vertices, faces, "|Cx|")
        expect.close(pull, truth, 8 * SINGLE * size, "Cx", on=on, shown=shown)


@COTANGENT_MATRIX.check("turning, moving and scaling the mesh leave the matrix as it is")
def _(f: Asked, rng: Rng) -> None:
    shape = closed(rng)
    size = float(np.ptp(shape.vertices, axis=0).max())
    start = shape.moved(-shape.vertices.mean(axis=0)).scaled(1 / size)
    placed = [start, turned(start, rng).moved(rng.uniform(-20, 20, 3)), start.scaled(100), start.scaled(0.01)]
    names = ["of size 1 at the origin", "turned and moved", "100 times as large", "100 times as small"]
    answers = [f(s.vertices, faces_of(s)) for s in placed]
    for value, on in zip(f.each(answers), names, strict=True):
        place = start.vertices, faces_of(start)
        expecting.matrix(value, truths.stiffness(*place), *place, on=f"a mesh {on}")


def _from_weights(vertices: FloatArray, faces: IntArray, weights: FloatArray) -> FloatArray:
    """Assemble (m, 3) weights of corners on the edges that face them, and the diagonal."""
    W = np.zeros((len(vertices), len(vertices)))
    tail, head = np.roll(faces, -1, axis=1).ravel(), np.roll(faces, -2, axis=1).ravel()
    np.add.at(W, (tail, head), weights.ravel())
    W += W.T
    return W - np.diag(W.sum(axis=1))


def _half_cotangents(vertices: FloatArray, faces: IntArray) -> FloatArray:
    return truths.cotangents(vertices, faces) / 2


@COTANGENT_MATRIX.variant("a dense matrix, triangle by triangle")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    C = np.zeros((len(vertices), len(vertices)))
    for face in faces:
        for k in range(3):
            i, j, o = face[k], face[(k + 1) % 3], face[(k + 2) % 3]
            a, b = vertices[i] - vertices[o], vertices[j] - vertices[o]
            w = 0.5 * (a @ b) / np.linalg.norm(truths.cross(a, b))
            C[i, j] += w
            C[j, i] += w
            C[i, i] -= w
            C[j, j] -= w
    return C


@COTANGENT_MATRIX.variant("from the lengths of the edges, as a COO matrix in single precision")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    from scipy import sparse

    C = _from_weights(vertices, faces, _half_cotangents(vertices, faces))
    return sparse.coo_matrix(C.astype(np.float32))


@COTANGENT_MATRIX.variant("the product of gradient, areas and gradient, as a CSC array")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    from scipy import sparse

    e = truths.opposite_edges(vertices, faces)
    normal = np.cross(e[:, 0], e[:, 1])
    twice = np.linalg.norm(normal, axis=1)
    hats = np.cross((normal / twice[:, None])[:, None, :], e) / twice[:, None, None]
    rows = np.repeat(np.arange(3 * len(faces)).reshape(-1, 3), 3, axis=0).reshape(len(faces), 3, 3)
    columns = np.repeat(faces[:, :, None], 3, axis=2)
    shape = (3 * len(faces), len(vertices))
    G = sparse.csc_array((hats.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
    return sparse.csc_array(-G.T @ sparse.diags_array(np.repeat(twice / 2, 3)) @ G)


@COTANGENT_MATRIX.mistake(
    "the factor ½ is missing",
    hint="Two angles face an inner edge. What do the notes (§8) do with the sum of their cotangents?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return 2 * truths.stiffness(vertices, faces)


@COTANGENT_MATRIX.mistake(
    "the sign is that of −C",
    hint="Many libraries return −C. What sign have the diagonal entries in the notes (§8)?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return -truths.stiffness(vertices, faces)


@COTANGENT_MATRIX.mistake(
    "each weight was entered in one direction only",
    hint="Is your matrix symmetric? The weight of an edge belongs to both of its ends.",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    W = np.zeros((len(vertices), len(vertices)))
    ends = np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)
    np.add.at(W, ends, truths.cotangents(vertices, faces) / 2)
    return W - np.diag(W.sum(axis=1))


@COTANGENT_MATRIX.mistake(
    "the diagonal was forgotten",
    hint="What should the Laplacian of a constant be? Add up a row of your matrix.",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    C = truths.stiffness(vertices, faces)
    return C - np.diag(np.diag(C))


@COTANGENT_MATRIX.mistake(
    "the angle beside the edge was taken for the one that faces it",
    hint="Draw a triangle with the corners i, j, k. Where is the angle that the notes call α_ij?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _from_weights(vertices, faces, np.roll(_half_cotangents(vertices, faces), -1, axis=1))


@COTANGENT_MATRIX.mistake(
    "the absolute value of the cosine makes every angle acute",
    hint="What sign has the cosine of an obtuse angle, and what sign its cotangent?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _from_weights(vertices, faces, np.abs(_half_cotangents(vertices, faces)))


@COTANGENT_MATRIX.mistake(
    "negative cotangents were set to zero",
    hint="The cotangent of an obtuse angle is negative. What does Cu give for a linear u if you drop it?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _from_weights(vertices, faces, np.maximum(_half_cotangents(vertices, faces), 0))


@COTANGENT_MATRIX.mistake(
    "a boundary edge has the whole cotangent of its one angle",
    hint="The weight is half the sum over the angles that face the edge, not their mean. And with one?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    weights = _half_cotangents(vertices, faces)
    single = truths.boundary_edges(faces)
    tail, head = np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)
    for corner in np.ndindex(faces.shape):
        if (int(tail[corner]), int(head[corner])) in single:
            weights[corner] *= 2
    return _from_weights(vertices, faces, weights)


@COTANGENT_MATRIX.mistake(
    "the tangent was taken for the cotangent",
    hint="What is the cotangent of a right angle? And what does your formula give for it?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _from_weights(vertices, faces, np.tan(truths.angles(vertices, faces)) / 2)


@COTANGENT_MATRIX.mistake(
    "the angles went into the tangent in degrees",
    hint="In which unit does `np.tan` take an angle? What does your formula give for a right angle?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    degrees = np.degrees(truths.angles(vertices, faces))
    return _from_weights(vertices, faces, 0.5 / np.tan(degrees))


@COTANGENT_MATRIX.mistake(
    "the cosine was taken for the cotangent",
    hint="What is the cosine divided by? Does your formula tell a long vector from a unit vector?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _from_weights(vertices, faces, np.cos(truths.angles(vertices, faces)) / 2)


@COTANGENT_MATRIX.mistake(
    "every common neighbour of two vertices was taken for the third corner of a face",
    hint="Two neighbours of a vertex of valence 3 have more than two common neighbours. "
    "Which of them make a face with the edge?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    rings = truths.neighbours(faces, len(vertices))
    W = np.zeros((len(vertices), len(vertices)))
    for i, ring in enumerate(rings):
        for j in ring:
            for o in sorted(ring & rings[j]):
                a, b = vertices[i] - vertices[o], vertices[j] - vertices[o]
                squared = (a @ a) * (b @ b) - (a @ b) ** 2
                W[i, j] += 0.5 * (a @ b) / np.sqrt(max(float(squared), 1e-300))
    return W - np.diag(W.sum(axis=1))


@COTANGENT_MATRIX.mistake(
    "boundary edges were left out",
    hint="One angle faces a boundary edge. Is the flow of heat along that edge zero?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    border = truths.boundary_edges(faces)
    weights = _half_cotangents(vertices, faces)
    for face, row in zip(faces.tolist(), weights, strict=True):
        for k in range(3):
            if (face[k - 2], face[k - 1]) in border:
                row[k] = 0.0
    return _from_weights(vertices, faces, weights)


@COTANGENT_MATRIX.mistake(
    "the second face of an edge overwrites what the first one gave",
    hint="Two faces add to the entry of an inner edge. What does `C[i, j] = …` do with the first?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    W = np.zeros((len(vertices), len(vertices)))
    for face, row in zip(faces.tolist(), _half_cotangents(vertices, faces), strict=True):
        for k in range(3):
            W[face[k - 2], face[k - 1]] = W[face[k - 1], face[k - 2]] = row[k]
    return W - np.diag(W.sum(axis=1))


@COTANGENT_MATRIX.mistake(
    "the rows were divided by areas already",
    hint="C is integrated over cells; the mass matrix divides it later. Is your matrix symmetric?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.laplacian(vertices, faces)


# Both together ----------------------------------------------------------------------------------

LAPLACIAN = Exercise(
    reference.laplacian,
    notes="ch. 6 §8, §11",
    hints=[
        "You have C and M already.",
        "M is diagonal: its inverse costs nothing. Which side of C does it stand on?",
        "Multiplying by a diagonal matrix from the left scales the rows. By what, here?",
    ],
)


@LAPLACIAN.check("the Laplacian of x² + y² is 4 inside a square of right triangles")
def _(f: Asked, rng: Rng) -> None:
    square = grid(rng)
    size = float(rng.choice([0.01, 1.0, 100.0]))
    moved = turned(square.scaled(size), rng)
    on = f"a flat square of side {size:g}"
    n = len(square.vertices)
    L = expect.array(f(moved.vertices, faces_of(moved)), (n, n), "The matrix", on=on)
    # Its entries are of size 4 / h², h being a fifth of the side: single precision keeps 1e-4 of them.
    u = size**2 * np.square(square.vertices).sum(axis=1)
    expecting.values(
        L @ u, np.full(n, 4.0), square, "The Laplacian", on=on, only=square.interior, scale=100.0
    )


@LAPLACIAN.check("on a sphere of radius R it pulls every vertex inwards by 2/R", points=2)
def _(f: Asked, rng: Rng) -> None:
    R = float(rng.uniform(2.0, 4.0))
    ball = sphere(rng, R)
    n, on = len(ball.vertices), f"a sphere of radius {R:.3g}"
    L = expect.array(f(ball.vertices, faces_of(ball)), (n, n), "The matrix", on=on)
    # Exact for vertices on a sphere and Voronoi cells: (x_j − x_i)·x_i is −½|x_j − x_i|².
    inwards = np.einsum("ij,ij->i", L @ ball.vertices, ball.vertices) / R
    expecting.values(inwards, np.full(n, -2 / R), ball, "The outward part of Δx", on=on, scale=20.0)


@LAPLACIAN.check("the rows of C divided by mixed areas, whatever the mesh", points=2)
def _(f: Asked, rng: Rng) -> None:
    for_all = [(bounded(rng), "a mesh with holes and obtuse angles"), (closed(rng), "a closed mesh")]
    answers = [f(shape.vertices, faces_of(shape)) for shape, _ in for_all]
    for value, (shape, on) in zip(f.each(answers), for_all, strict=True):
        place = shape.vertices, faces_of(shape)
        expecting.matrix(value, truths.laplacian(*place), *place, on=on)


@LAPLACIAN.check("the cells that are named")
def _(f: Asked, rng: Rng) -> None:
    shape = bounded(rng)
    names = [str(name) for name in rng.permutation(list(truths.CELLS))]
    answers = [f(shape.vertices, faces_of(shape), cells=name) for name in names]
    for value, name in zip(f.each(answers), names, strict=True):
        place = shape.vertices, faces_of(shape)
        truth = truths.laplacian(*place, name)
        expecting.matrix(value, truth, *place, on=f"a mesh with holes and obtuse angles, cells={name!r}")


@LAPLACIAN.variant("a dense matrix, its rows divided")
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return truths.laplacian(vertices, faces, cells)


@LAPLACIAN.variant("the product with the inverse of a dense M, in LIL format")
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    from scipy import sparse

    M = np.diag(truths.cells(vertices, faces, cells))
    return sparse.lil_matrix(np.linalg.inv(M) @ truths.stiffness(vertices, faces))


@LAPLACIAN.mistake(
    "the factor ½ was applied twice",
    hint="The notes write the ½ either into C (§8) or into M (§11). Is it in both of yours?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return truths.laplacian(vertices, faces, cells) / 2


@LAPLACIAN.mistake(
    "the factor ½ is missing",
    hint="The notes write the ½ either into C (§8) or into M (§11). Is it in one of yours?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return truths.laplacian(vertices, faces, cells) * 2


@LAPLACIAN.mistake(
    "the columns were divided by the areas, not the rows",
    hint="The Laplacian at a vertex is an average over its own cell. Whose area divides row i?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return truths.laplacian(vertices, faces, cells).T


@LAPLACIAN.mistake(
    "C was not divided by the areas",
    hint="C is integrated over cells. What does it give for x² + y² when the cells shrink?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return truths.stiffness(vertices, faces)


@LAPLACIAN.mistake(
    "C was multiplied by the areas",
    hint="Is Δ made with M, or with its inverse?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return truths.cells(vertices, faces, cells)[:, None] * truths.stiffness(vertices, faces)


@LAPLACIAN.mistake(
    "the symmetric form M^(-½) C M^(-½) was returned",
    hint="That form has the same eigenvalues. Does it have the constants in its null space too?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    root = np.sqrt(truths.cells(vertices, faces, cells))
    return truths.stiffness(vertices, faces) / np.outer(root, root)


@LAPLACIAN.mistake(
    "the sign is that of −Δ",
    hint="x² + y² bends upwards everywhere. What sign has its Laplacian?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return -truths.laplacian(vertices, faces, cells)


@LAPLACIAN.mistake(
    "the rows were divided by the sums of the weights",
    hint="That makes a mean over the neighbours. What happens to it when the mesh is scaled?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    C = truths.stiffness(vertices, faces)
    return C / -np.diag(C)[:, None]


@LAPLACIAN.mistake(
    "barycentric cells were used where mixed ones are the default",
    hint="Which cells does your function use when nothing is said about them?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "barycentric") -> Any:
    return truths.laplacian(vertices, faces, cells)


@LAPLACIAN.mistake(
    "`cells` was not used: the cells are always mixed",
    hint="What does your function hand on to the mass matrix?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return truths.laplacian(vertices, faces)
