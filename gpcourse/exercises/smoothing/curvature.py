"""Exercises on discrete curvature and the quality of triangles."""

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
    bounded,
    closed,
    faces_of,
    interior_rows,
    patch,
    sphere,
    triangle,
    turned,
)
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.reference import smoothing as reference

# The mean curvature normal ----------------------------------------------------------------------

MEAN_CURVATURE_NORMAL = Exercise(
    reference.mean_curvature_normal,
    notes="ch. 6 §3, §6",
    hints=[
        "Which relation of the notes (§3) ties the Laplacian of the positions to H n?",
        "The Laplacian is a matrix by now. Apply it to all three coordinates at once.",
        "On a sphere, which way does Δx point? And H n?",
    ],
    canonical=interior_rows,
)


def _half_gradient(shape: shapes.Shape) -> FloatArray:
    """Return H n from the first variation of the area: half its gradient, per area of the cell."""
    areas = truths.mixed_areas(shape.vertices, faces_of(shape))
    return np.asarray(truths.area_gradient(shape.vertices, faces_of(shape)) / (2 * areas[:, None]))


@MEAN_CURVATURE_NORMAL.check("on a sphere of radius R it points outwards by 1/R")
def _(f: Asked, rng: Rng) -> None:
    R = float(rng.uniform(2.0, 4.0) * rng.choice([0.01, 100.0]))
    ball = sphere(rng, R)
    on = f"a sphere of radius {R:.3g}"
    Hn = expect.array(f(ball.vertices, faces_of(ball)), ball.vertices.shape, "The result", on=on)
    outwards = np.einsum("ij,ij->i", Hn, ball.vertices) / R
    # Exact for vertices on a sphere and Voronoi cells, which mixed ones are without obtuse angles.
    expecting.values(outwards, np.full(len(Hn), 1 / R), ball, "The outward part", on=on, scale=10 / R)


@MEAN_CURVATURE_NORMAL.check("zero inside a flat patch, however irregular")
def _(f: Asked, rng: Rng) -> None:
    flat = turned(patch(rng), rng)
    value, on = f(flat.vertices, faces_of(flat)), "a flat irregular patch"
    # One over the size of a cell: the patch has 4 cells along each side of length 1.
    truth = np.zeros_like(flat.vertices)
    expecting.values(value, truth, flat, "H n", on=on, only=flat.interior, scale=16.0)


@MEAN_CURVATURE_NORMAL.check("half the gradient of the area, per area of the mixed cell", points=2)
def _(f: Asked, rng: Rng) -> None:
    for_all = [(closed(rng), "a closed mesh"), (bounded(rng), "a mesh with holes")]
    answers = [f(shape.vertices, faces_of(shape)) for shape, _ in for_all]
    for value, (shape, on) in zip(f.each(answers), for_all, strict=True):
        expecting.values(value, _half_gradient(shape), shape, "H n", on=on, only=shape.interior)


@MEAN_CURVATURE_NORMAL.variant("the gradient of the area, face by face")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    gradient = np.zeros_like(vertices)
    for face in faces:
        a, b, c = vertices[face]
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal)
        for v, edge in zip(face, (c - b, a - c, b - a), strict=True):
            gradient[v] += np.cross(normal, edge) / 2
    return gradient / (2 * truths.mixed_areas(vertices, faces))[:, None]


@MEAN_CURVATURE_NORMAL.variant("differences to the neighbours, in single precision, zero at the boundary")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    C = truths.stiffness(vertices, faces)
    sums = np.einsum("ij,ijx->ix", C, vertices[:, None, :] - vertices[None, :, :])
    sums[truths.boundary_vertices(faces)] = 0.0
    return (sums / (2 * truths.mixed_areas(vertices, faces))[:, None]).astype(np.float32)


@MEAN_CURVATURE_NORMAL.mistake(
    "the sum was not divided by the area of the cell",
    hint="C x is integrated over the cell. What becomes of your result when the mesh is refined?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return -0.5 * truths.stiffness(vertices, faces) @ vertices


@MEAN_CURVATURE_NORMAL.mistake(
    "the factor ½ is missing: this is −Δx",
    hint="Δx = −2 H n. What is H n, then?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return -truths.laplacian(vertices, faces) @ vertices


@MEAN_CURVATURE_NORMAL.mistake(
    "the factor ½ was applied twice",
    hint="Δx = −2 H n, and the cotangent matrix has a ½ already. How many are left to apply?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return -0.25 * truths.laplacian(vertices, faces) @ vertices


@MEAN_CURVATURE_NORMAL.mistake(
    "the sign is missing: the vectors point inwards on a sphere",
    hint="Δx pulls the vertices of a sphere inwards, and H is positive there. Which way must n point?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return 0.5 * truths.laplacian(vertices, faces) @ vertices


@MEAN_CURVATURE_NORMAL.mistake(
    "the uniform Laplacian was used",
    hint="The uniform Laplacian knows nothing of lengths. What does it give on a flat irregular patch?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return -0.5 * truths.mean_of_neighbours(faces, len(vertices)) @ vertices


@MEAN_CURVATURE_NORMAL.mistake(
    "the vectors were made as long as 1",
    hint="The length of the vector is the mean curvature. What is left of it?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    Hn = -0.5 * truths.laplacian(vertices, faces) @ vertices
    return Hn / np.linalg.norm(Hn, axis=1, keepdims=True)


@MEAN_CURVATURE_NORMAL.mistake(
    "the length was returned in place of the vector",
    hint="H n is a vector at each vertex. What shape should the result have?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return np.linalg.norm(0.5 * truths.laplacian(vertices, faces) @ vertices, axis=1)


@MEAN_CURVATURE_NORMAL.mistake(
    "the sum was divided by the area of all faces around the vertex",
    hint="Cells do not overlap, and rings of faces do. How often would each face be counted?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    ring = 3 * truths.third_areas(vertices, faces)
    return -0.5 * truths.stiffness(vertices, faces) @ vertices / ring[:, None]


@MEAN_CURVATURE_NORMAL.mistake(
    "barycentric cells were used in place of mixed ones",
    hint="Which cells does the docstring name? Compare both on a right triangle.",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return -0.5 * truths.stiffness(vertices, faces) @ vertices / truths.third_areas(vertices, faces)[:, None]


@MEAN_CURVATURE_NORMAL.mistake(
    "Voronoi cells were used in place of mixed ones",
    hint="Which cells does the docstring name? Compare both where an angle is obtuse.",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    areas = truths.voronoi_areas(vertices, faces)
    return -0.5 * truths.stiffness(vertices, faces) @ vertices / areas[:, None]


# Mean curvature ---------------------------------------------------------------------------------

DISCRETE_MEAN_CURVATURE = Exercise(
    reference.discrete_mean_curvature,
    notes="ch. 6 §6; coursework 2, questions 1 and 3",
    hints=[
        "You have the vector H n. What is its length?",
        "A length has no sign. With the outward normal given, which product brings the sign back?",
    ],
    canonical=interior_rows,
)


@DISCRETE_MEAN_CURVATURE.check(
    "a sphere of radius R has H = 1/R with its outward normals, −1/R with inward ones"
)
def _(f: Asked, rng: Rng) -> None:
    R = float(rng.uniform(2.0, 4.0) * rng.choice([0.01, 100.0]))
    ball = sphere(rng, R)
    n, normals = len(ball.vertices), ball.vertices / R
    answers = [f(ball.vertices, faces_of(ball), sign * normals) for sign in (1.0, -1.0)]
    for value, sign, way in zip(f.each(answers), (1.0, -1.0), ("outward", "inward"), strict=True):
        on = f"a sphere of radius {R:.3g} with {way} normals"
        expecting.values(value, np.full(n, sign / R), ball, "H", on=on, scale=10 / R)


@DISCRETE_MEAN_CURVATURE.check("with normals, the ring of a thick torus bends both ways", points=2)
def _(f: Asked, rng: Rng) -> None:
    # On the inner side k1 = 1/r and k2 = -1/(R - r): H is negative there when r > R/2.
    torus = turned(shapes.shuffled(shapes.torus(8, 7, R=1.0, r=0.75), rng), rng).scaled(
        float(rng.uniform(0.5, 2))
    )
    normals = np.asarray(torus.normals)
    value = f(torus.vertices, faces_of(torus), normals)
    truth = np.einsum("ij,ij->i", _half_gradient(torus), normals)
    expecting.values(value, truth, torus, "H", on="a torus with outward normals")


@DISCRETE_MEAN_CURVATURE.check("without normals, the length of H n", points=2)
def _(f: Asked, rng: Rng) -> None:
    for_all = [(closed(rng), "a closed mesh"), (bounded(rng), "a mesh with holes")]
    answers = [f(shape.vertices, faces_of(shape)) for shape, _ in for_all]
    for value, (shape, on) in zip(f.each(answers), for_all, strict=True):
        truth = np.linalg.norm(_half_gradient(shape), axis=1)
        expecting.values(value, truth, shape, "|H|", on=on, only=shape.interior)


@DISCRETE_MEAN_CURVATURE.check("zero inside a flat patch, however irregular")
def _(f: Asked, rng: Rng) -> None:
    flat = patch(rng)
    value = f(flat.vertices, faces_of(flat))
    on = "a flat irregular patch"
    expecting.values(value, np.zeros(len(flat.vertices)), flat, "|H|", on=on, only=flat.interior, scale=16.0)


def _curvature_of(vector: FloatArray, normals: FloatArray | None) -> FloatArray:
    if normals is None:
        return np.asarray(np.linalg.norm(vector, axis=1))
    return np.asarray(np.einsum("ij,ij->i", vector, normals))


def _mean_normal(vertices: FloatArray, faces: IntArray) -> FloatArray:
    return np.asarray(-0.5 * truths.laplacian(vertices, faces) @ vertices)


@DISCRETE_MEAN_CURVATURE.variant("from the gradient of the area")
def _(vertices: FloatArray, faces: IntArray, normals: FloatArray | None = None) -> Any:
    vector = truths.area_gradient(vertices, faces) / (2 * truths.mixed_areas(vertices, faces))[:, None]
    return _curvature_of(vector, normals)


@DISCRETE_MEAN_CURVATURE.variant("coordinate by coordinate, in single precision, as a column")
def _(vertices: FloatArray, faces: IntArray, normals: FloatArray | None = None) -> Any:
    x, y, z = _mean_normal(vertices - vertices.mean(axis=0), faces).T
    if normals is None:
        H = np.sqrt(x**2 + y**2 + z**2)
    else:
        H = x * normals[:, 0] + y * normals[:, 1] + z * normals[:, 2]
    return H.astype(np.float32)[:, None]


@DISCRETE_MEAN_CURVATURE.mistake(
    "the factor ½ is missing: this is the length of Δx",
    hint="Δx = −2 H n. How long is it on a sphere of radius 1?",
)
def _(vertices: FloatArray, faces: IntArray, normals: FloatArray | None = None) -> Any:
    return _curvature_of(2 * _mean_normal(vertices, faces), normals)


@DISCRETE_MEAN_CURVATURE.mistake(
    "the sum was not divided by the area of the cell",
    hint="C x is integrated over the cell. What becomes of your result when the mesh is scaled?",
)
def _(vertices: FloatArray, faces: IntArray, normals: FloatArray | None = None) -> Any:
    return _curvature_of(-0.5 * truths.stiffness(vertices, faces) @ vertices, normals)


@DISCRETE_MEAN_CURVATURE.mistake(
    "the normals were not used: the sign is lost",
    hint="A length is never negative. What sign should H have on the inner side of a thick torus?",
)
def _(vertices: FloatArray, faces: IntArray, normals: FloatArray | None = None) -> Any:
    return _curvature_of(_mean_normal(vertices, faces), None)


@DISCRETE_MEAN_CURVATURE.mistake(
    "the sign is the wrong way round",
    hint="A sphere has H = 1/R with its outward normal. What does Δx·n give there?",
)
def _(vertices: FloatArray, faces: IntArray, normals: FloatArray | None = None) -> Any:
    return _curvature_of(_mean_normal(vertices, faces), None if normals is None else -normals)


@DISCRETE_MEAN_CURVATURE.mistake(
    "the uniform Laplacian was used",
    hint="The uniform Laplacian knows nothing of lengths. What does it give on a flat irregular patch?",
)
def _(vertices: FloatArray, faces: IntArray, normals: FloatArray | None = None) -> Any:
    return _curvature_of(-0.5 * truths.mean_of_neighbours(faces, len(vertices)) @ vertices, normals)


@DISCRETE_MEAN_CURVATURE.mistake(
    "barycentric cells were used in place of mixed ones",
    hint="Which cells does the docstring name? Compare both on a right triangle.",
)
def _(vertices: FloatArray, faces: IntArray, normals: FloatArray | None = None) -> Any:
    ratio = truths.mixed_areas(vertices, faces) / truths.third_areas(vertices, faces)
    return _curvature_of(_mean_normal(vertices, faces) * ratio[:, None], normals)


@DISCRETE_MEAN_CURVATURE.mistake(
    "Voronoi cells were used in place of mixed ones",
    hint="Which cells does the docstring name? Compare both where an angle is obtuse.",
)
def _(vertices: FloatArray, faces: IntArray, normals: FloatArray | None = None) -> Any:
    ratio = truths.mixed_areas(vertices, faces) / truths.voronoi_areas(vertices, faces)
    return _curvature_of(_mean_normal(vertices, faces) * ratio[:, None], normals)


# Gaussian curvature -----------------------------------------------------------------------------

ANGLE_DEFECT = Exercise(
    reference.angle_defect,
    notes="ch. 6 §6",
    hints=[
        "Add up the angles at a vertex. What is their sum where the surface is flat?",
        "A face has three angles. Each belongs to the vertex at that corner.",
        "A flat sheet ends in a straight line. What is the sum of the angles at a vertex on it?",
    ],
)


def _expect_defects(f: Asked, for_all: list[tuple[shapes.Shape, FloatArray | None, str]]) -> None:
    """Expect the defects of each shape; None stands for those worked out from half chords."""
    answers = [f(shape.vertices, faces_of(shape)) for shape, _, _ in for_all]
    for value, (shape, known, on) in zip(f.each(answers), for_all, strict=True):
        truth = truths.defects(shape.vertices, faces_of(shape)) if known is None else known
        # The terms are angles; single precision loses 4e-7 of a sum of 2π.
        expecting.values(value, truth, shape, "The angle defect", on=on, scale=2 * np.pi)


@ANGLE_DEFECT.check("each corner of a regular solid has its share of 4π")
def _(f: Asked, rng: Rng) -> None:
    solids = (shapes.tetrahedron(), shapes.octahedron(), shapes.icosahedron())
    placed = [turned(shapes.shuffled(s, rng), rng).scaled(float(rng.choice([0.01, 1, 100]))) for s in solids]
    _expect_defects(f, [(s, np.full(len(s.vertices), 4 * np.pi / len(s.vertices)), s.name) for s in placed])


@ANGLE_DEFECT.check("zero all over a flat sheet, but for the four right angles of its corners", points=2)
def _(f: Asked, rng: Rng) -> None:
    flat = patch(rng)
    x, y = flat.vertices[:, 0], flat.vertices[:, 1]
    corner = (np.isclose(x, 0) | np.isclose(x, x.max())) & (np.isclose(y, 0) | np.isclose(y, y.max()))
    on = "a flat rectangle of irregular triangles"
    _expect_defects(f, [(turned(flat, rng), np.where(corner, np.pi / 2, 0.0), on)])


@ANGLE_DEFECT.check("2π or π less the angles of the corners at that very vertex", points=2)
def _(f: Asked, rng: Rng) -> None:
    _expect_defects(f, [(closed(rng), None, "a closed mesh"), (bounded(rng), None, "a mesh with holes")])


@ANGLE_DEFECT.check("all defects together are 2πχ")
def _(f: Asked, rng: Rng) -> None:
    # χ = V − E + F: 0 for the torus, −2 with two holes in it, 1 for a disc.
    for_all = [
        (closed(rng), 0, "a torus"),
        (bounded(rng), -2, "a torus with two holes"),
        (patch(rng), 1, "a disc"),
    ]
    answers = [f(shape.vertices, faces_of(shape)) for shape, _, _ in for_all]
    for value, (shape, chi, on) in zip(f.each(answers), for_all, strict=True):
        n = len(shape.vertices)
        mine = expect.array(value, (n,), "The array of defects", on=on)
        picture = pictures.of_own(shape.vertices, faces_of(shape), mine, "defect")
        expect.close(
            float(mine.sum()), 2 * np.pi * chi, n * SINGLE, "The sum of the defects", on=on, picture=picture
        )


def _defect(vertices: FloatArray, faces: IntArray, angles: FloatArray) -> FloatArray:
    """Take angles, (m, 3), from 2π or π at their corners."""
    n = len(vertices)
    return np.asarray(truths.flat_angles(faces, n) - truths.per_vertex(faces, angles, n))


@ANGLE_DEFECT.variant("the arc cosine of normalised edges, in a loop")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    border = set(truths.boundary_vertices(faces).tolist())
    defect = [np.pi if v in border else 2 * np.pi for v in range(len(vertices))]
    for face in faces:
        for k in range(3):
            a = vertices[face[(k + 1) % 3]] - vertices[face[k]]
            b = vertices[face[(k + 2) % 3]] - vertices[face[k]]
            defect[face[k]] -= float(np.arccos(np.clip(a @ b / np.linalg.norm(a) / np.linalg.norm(b), -1, 1)))
    return defect


@ANGLE_DEFECT.variant("the law of cosines, in single precision")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    length = np.linalg.norm(truths.opposite_edges(vertices, faces), axis=2)
    b, c = np.roll(length, -1, axis=1), np.roll(length, -2, axis=1)
    cosine = (b**2 + c**2 - length**2) / (2 * b * c)
    return _defect(vertices, faces, np.arccos(cosine)).astype(np.float32)


@ANGLE_DEFECT.mistake(
    "2π was taken at the boundary too",
    hint="A flat rectangle is not curved. What are the angles along one of its sides together?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return 2 * np.pi - truths.per_vertex(faces, truths.angles(vertices, faces), len(vertices))


@ANGLE_DEFECT.mistake(
    "an angle was added at another corner of its face",
    hint="The sum over the whole surface is right even so. Whose angle lies between the edges to b and to c?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _defect(vertices, faces, np.roll(truths.angles(vertices, faces), 1, axis=1))


@ANGLE_DEFECT.mistake(
    "an angle was added at the corner before its own",
    hint="The sum over the whole surface is right even so. Whose angle lies between the edges to b and to c?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _defect(vertices, faces, np.roll(truths.angles(vertices, faces), -1, axis=1))


@ANGLE_DEFECT.mistake(
    "the absolute value of the cosine makes every angle acute",
    hint="What sign has the cosine of an obtuse angle? Add up your angles in one obtuse triangle.",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    angles = truths.angles(vertices, faces)
    return _defect(vertices, faces, np.minimum(angles, np.pi - angles))


@ANGLE_DEFECT.mistake(
    "the angles are in degrees",
    hint="The course measures angles in radians. How large is a full turn then?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return np.degrees(truths.defects(vertices, faces))


@ANGLE_DEFECT.mistake(
    "2π, in radians, is compared with angles in degrees",
    hint="In which unit does your function measure the angles, and in which one the full turn?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _defect(vertices, faces, np.degrees(truths.angles(vertices, faces)))


@ANGLE_DEFECT.mistake(
    "the sign is the wrong way round",
    hint="The angles at a corner of a cube sum to less than 2π. Is its curvature positive or negative?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return -truths.defects(vertices, faces)


@ANGLE_DEFECT.mistake(
    "the defect was divided by the area of a cell",
    hint="The defect is the curvature of the whole cell. Does it change when the mesh is scaled?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.defects(vertices, faces) / truths.mixed_areas(vertices, faces)


@ANGLE_DEFECT.mistake(
    "the defect was set to zero at the boundary",
    hint="The boundary of a rectangle turns at its corners. Where does 2πχ come from for a flat disc?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    defect = truths.defects(vertices, faces)
    defect[truths.boundary_vertices(faces)] = 0.0
    return defect


DISCRETE_GAUSSIAN_CURVATURE = Exercise(
    reference.discrete_gaussian_curvature,
    notes="ch. 6 §6; coursework 2, question 1",
    hints=[
        "The angle defect is the curvature of a whole cell. What is the curvature of a point of it?",
        "You have the areas of the cells already.",
    ],
)


def _gaussian(shape: shapes.Shape) -> FloatArray:
    areas = truths.mixed_areas(shape.vertices, faces_of(shape))
    return np.asarray(truths.defects(shape.vertices, faces_of(shape)) / areas)


@DISCRETE_GAUSSIAN_CURVATURE.check("a regular solid has the same curvature at each corner, 4π over its area")
def _(f: Asked, rng: Rng) -> None:
    solids = [
        shapes.shuffled(s, rng) for s in (shapes.tetrahedron(), shapes.octahedron(), shapes.icosahedron())
    ]
    sizes = rng.permutation([0.01, 1.0, 100.0])
    placed = [turned(s, rng).scaled(size) for s, size in zip(solids, sizes, strict=True)]
    answers = [f(s.vertices, faces_of(s)) for s in placed]
    for value, s, size in zip(f.each(answers), placed, sizes, strict=True):
        K = 4 * np.pi / truths.face_areas(s.vertices, faces_of(s)).sum()
        expecting.values(value, np.full(len(s.vertices), K), s, "K", on=f"{s.name}, times {size:g}")


@DISCRETE_GAUSSIAN_CURVATURE.check("times the mixed areas it sums to 2πχ: Gauss–Bonnet", points=2)
def _(f: Asked, rng: Rng) -> None:
    for_all = [
        (closed(rng), 0, "a torus"),
        (bounded(rng), -2, "a torus with two holes"),
        (patch(rng), 1, "a disc"),
    ]
    answers = [f(shape.vertices, faces_of(shape)) for shape, _, _ in for_all]
    for value, (shape, chi, on) in zip(f.each(answers), for_all, strict=True):
        n, areas = len(shape.vertices), truths.mixed_areas(shape.vertices, faces_of(shape))
        K = expect.array(value, (n,), "The array of curvatures", on=on)
        picture = pictures.of_own(shape.vertices, faces_of(shape), K, "K")
        expect.close(float(areas @ K), 2 * np.pi * chi, n * SINGLE, "The sum of A K", on=on, picture=picture)


@DISCRETE_GAUSSIAN_CURVATURE.check("the angle defect per area of the mixed cell, boundary included", points=2)
def _(f: Asked, rng: Rng) -> None:
    for_all = [(closed(rng), "a closed mesh"), (bounded(rng), "a mesh with holes")]
    answers = [f(shape.vertices, faces_of(shape)) for shape, _ in for_all]
    for value, (shape, on) in zip(f.each(answers), for_all, strict=True):
        expecting.values(value, _gaussian(shape), shape, "K", on=on)


@DISCRETE_GAUSSIAN_CURVATURE.variant("vertex by vertex, as a list")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    areas = truths.mixed_areas(vertices, faces)
    defects = truths.defects(vertices, faces)
    return [float(d) / float(a) for d, a in zip(defects, areas, strict=True)]


@DISCRETE_GAUSSIAN_CURVATURE.variant("a solve with the mass matrix, in single precision")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    M = np.diag(truths.mixed_areas(vertices, faces))
    return np.linalg.solve(M, truths.defects(vertices, faces)).astype(np.float32)


@DISCRETE_GAUSSIAN_CURVATURE.mistake(
    "the defect was not divided by the area",
    hint="What becomes of the curvature of a sphere when it grows? What becomes of your result?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.defects(vertices, faces)


@DISCRETE_GAUSSIAN_CURVATURE.mistake(
    "2π was taken at the boundary too",
    hint="A flat rectangle is not curved. What are the angles along one of its sides together?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    sums = truths.per_vertex(faces, truths.angles(vertices, faces), len(vertices))
    return (2 * np.pi - sums) / truths.mixed_areas(vertices, faces)


@DISCRETE_GAUSSIAN_CURVATURE.mistake(
    "barycentric cells were used in place of mixed ones",
    hint="Which cells does the docstring name? Compare both on a right triangle.",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.defects(vertices, faces) / truths.third_areas(vertices, faces)


@DISCRETE_GAUSSIAN_CURVATURE.mistake(
    "Voronoi cells were used in place of mixed ones",
    hint="Which cells does the docstring name? How large is a Voronoi cell among obtuse triangles?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.defects(vertices, faces) / truths.voronoi_areas(vertices, faces)


@DISCRETE_GAUSSIAN_CURVATURE.mistake(
    "the defect was divided by the area of all faces around the vertex",
    hint="Add up the areas that you divide by. Are they the surface?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.defects(vertices, faces) / (3 * truths.third_areas(vertices, faces))


@DISCRETE_GAUSSIAN_CURVATURE.mistake(
    "the curvature was set to zero at the boundary",
    hint="What must A K sum to on a disc? How much of it is left to your function there?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    K = truths.defects(vertices, faces) / truths.mixed_areas(vertices, faces)
    K[truths.boundary_vertices(faces)] = 0.0
    return K


@DISCRETE_GAUSSIAN_CURVATURE.mistake(
    "the defect was multiplied by the area",
    hint="What becomes of the curvature of a sphere when it grows? What becomes of your result?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.defects(vertices, faces) * truths.mixed_areas(vertices, faces)


# Principal curvatures ---------------------------------------------------------------------------

DISCRETE_PRINCIPAL_CURVATURES = Exercise(
    reference.discrete_principal_curvatures,
    notes="ch. 6 §6",
    hints=[
        "H is the mean of the two curvatures, K their product. Which equation has them as its roots?",
        "On a smooth surface H² is never below K. On a mesh rounding and errors can make it so. What then?",
    ],
)


def _expect_curvatures(f: Asked, k1: FloatArray, k2: FloatArray, on: str) -> None:
    """Ask for the curvatures that belong to the mean and the product of k1 ≥ k2."""
    n, size = len(k1), float(max(np.abs(k1).max(), np.abs(k2).max()))
    first, second = expecting.pair(f((k1 + k2) / 2, k1 * k2), "(k1, k2)", on=on)
    # The root of H² − K loses half the digits where k1 = k2.
    for value, truth, name in ((first, k1, "k1"), (second, k2, "k2")):
        expect.close(expect.array(value, (n,), name, on=on), truth, 1e-5 * size, name, on=on)


@DISCRETE_PRINCIPAL_CURVATURES.check("their mean is H and their product K, the larger one first", points=2)
def _(f: Asked, rng: Rng) -> None:
    k = float(rng.choice([0.01, 1.0, 100.0])) * rng.normal(size=(2, 12))
    _expect_curvatures(f, k.max(axis=0), k.min(axis=0), "curvatures of any sign")


@DISCRETE_PRINCIPAL_CURVATURES.check("where H² < K, which only errors can make, both are H", points=2)
def _(f: Asked, rng: Rng) -> None:
    H = rng.normal(size=8)
    K = H**2 + rng.uniform(0.0, 0.5, 8)
    on = "H² below K"
    first, second = expecting.pair(f(H, K), "(k1, k2)", on=on)
    for value, name in ((first, "k1"), (second, "k2")):
        expect.close(expect.array(value, (8,), name, on=on), H, SINGLE * np.abs(H).max(), name, on=on)


@DISCRETE_PRINCIPAL_CURVATURES.check("sphere, cylinder and minimal surface")
def _(f: Asked, rng: Rng) -> None:
    R = float(rng.uniform(0.5, 2.0))
    k1, k2 = np.array([1.0, 1.0, 1.0]) / R, np.array([1.0, 0.0, -1.0]) / R
    _expect_curvatures(f, k1, k2, f"a sphere, a cylinder and a minimal surface, R = {R:.3g}")


@DISCRETE_PRINCIPAL_CURVATURES.variant("one vertex after the other, as lists")
def _(H: FloatArray, K: FloatArray) -> Any:
    roots = [max(float(h * h - k), 0.0) ** 0.5 for h, k in zip(H, K, strict=True)]
    return [
        [float(h) + s for h, s in zip(H, roots, strict=True)],
        [float(h) - s for h, s in zip(H, roots, strict=True)],
    ]


@DISCRETE_PRINCIPAL_CURVATURES.variant("as the rows of an array, in single precision")
def _(H: FloatArray, K: FloatArray) -> Any:
    root = np.sqrt(np.where(H**2 > K, H**2 - K, 0.0))
    return np.vstack([H + root, H - root]).astype(np.float32)


@DISCRETE_PRINCIPAL_CURVATURES.mistake(
    "the root of a negative number was taken",
    hint="What does `np.sqrt` give for −0.001? When is H² below K, and what should happen then?",
)
def _(H: FloatArray, K: FloatArray) -> Any:
    with np.errstate(invalid="ignore"):
        root = np.sqrt(H**2 - K)
    return H + root, H - root


@DISCRETE_PRINCIPAL_CURVATURES.mistake(
    "the absolute value of H² − K was taken where it is negative",
    hint="A surface that is a little less round than a sphere can be: which k1 and k2 come nearest to it?",
)
def _(H: FloatArray, K: FloatArray) -> Any:
    root = np.sqrt(np.abs(H**2 - K))
    return H + root, H - root


@DISCRETE_PRINCIPAL_CURVATURES.mistake(
    "where the root does not exist, the curvatures were set to zero",
    hint="Where H² is a little below K, the surface is nearly round. Is it nearly flat?",
)
def _(H: FloatArray, K: FloatArray) -> Any:
    with np.errstate(invalid="ignore"):
        root = np.sqrt(H**2 - K)
    return np.nan_to_num(H + root), np.nan_to_num(H - root)


@DISCRETE_PRINCIPAL_CURVATURES.mistake(
    "they were sorted by size without the sign",
    hint="Which of 1 and −2 is the larger one?",
)
def _(H: FloatArray, K: FloatArray) -> Any:
    root = np.copysign(np.sqrt(np.maximum(H**2 - K, 0)), H)
    return H + root, H - root


@DISCRETE_PRINCIPAL_CURVATURES.mistake(
    "the smaller curvature comes first",
    hint="Which of the two does the docstring call k1?",
)
def _(H: FloatArray, K: FloatArray) -> Any:
    root = np.sqrt(np.maximum(H**2 - K, 0))
    return H - root, H + root


@DISCRETE_PRINCIPAL_CURVATURES.mistake(
    "the root is missing",
    hint="What unit has H² − K? What unit has a curvature?",
)
def _(H: FloatArray, K: FloatArray) -> Any:
    square = np.maximum(H**2 - K, 0)
    return H + square, H - square


@DISCRETE_PRINCIPAL_CURVATURES.mistake(
    "K has the wrong sign under the root",
    hint="On a cylinder K is 0, on a minimal surface H is. Put both into your formula, and a sphere.",
)
def _(H: FloatArray, K: FloatArray) -> Any:
    root = np.sqrt(np.maximum(H**2 + K, 0))
    return H + root, H - root


@DISCRETE_PRINCIPAL_CURVATURES.mistake(
    "H was taken for the sum of the two, not for their mean",
    hint="H of a sphere of radius 1 is 1. What is the sum of its principal curvatures?",
)
def _(H: FloatArray, K: FloatArray) -> Any:
    root = np.sqrt(np.maximum(H**2 / 4 - K, 0))
    return H / 2 + root, H / 2 - root


# Quality ----------------------------------------------------------------------------------------

MESH_QUALITY = Exercise(
    reference.mesh_quality,
    notes="ch. 6 §7",
    hints=[
        "All of it follows from the lengths of the sides and the area of a face.",
        "The altitude on a side is twice the area divided by that side. Which side has the shortest one?",
        "The inscribed circle has radius 2A / (a + b + c), the circumscribed one abc / 4A.",
        "The valence of a vertex is the number of its edges. At a boundary, how many more than its faces?",
    ],
)

_FACE_KEYS = ("smallest_angle", "aspect_ratio", "radius_ratio")


def _expect_quality(f: Asked, inputs: list[tuple[FloatArray, IntArray, dict[str, Any], str]]) -> None:
    answers = [f(vertices, faces) for vertices, faces, _, _ in inputs]
    for value, (vertices, faces, truth, on) in zip(f.each(answers), inputs, strict=True):
        expect.that(value is not None, "The result is None: is a `return` missing?", on=on)
        is_dict = isinstance(value, dict)
        message = f"The result should be a dict; it is a {type(value).__name__}."
        expect.that(is_dict, message, yours=expect.brief(value), on=on)
        missing = [key for key in truth if key not in value]
        expect.that(not missing, f"The keys {missing} are missing.", yours=f"keys {list(value)}", on=on)
        for key, known in truth.items():
            want = np.asarray(known, dtype=float)
            mine = expect.array(value[key], want.shape, f'"{key}"', on=on)
            item = "vertex" if key == "valence" else "face"
            shown = pictures.Field(vertices, faces, key, item=item)
            expect.close(mine, want, SINGLE * np.abs(want).max(), f'"{key}"', on=on, shown=shown)


@MESH_QUALITY.check("an equilateral triangle: 60°, and both ratios 1")
def _(f: Asked, rng: Rng) -> None:
    size, (vertices, faces) = float(rng.choice([0.01, 100.0])), triangle(rng)
    e = truths.opposite_edges(vertices, faces)[0]
    up = np.cross(np.cross(e[0], e[1]), e[0])
    apex = vertices[1] + e[0] / 2 + up / np.linalg.norm(up) * np.linalg.norm(e[0]) * np.sqrt(3) / 2
    corners = size * np.vstack([apex, vertices[1:]])
    truth = {
        "smallest_angle": [np.pi / 3],
        "aspect_ratio": [1.0],
        "radius_ratio": [1.0],
        "valence": [2, 2, 2],
    }
    _expect_quality(f, [(corners, faces, truth, f"an equilateral triangle, times {size:g}")])


@MESH_QUALITY.check("right and obtuse triangles with whole sides", points=2)
def _(f: Asked, rng: Rng) -> None:
    half_root = np.sqrt(3) / 2
    # 3, 4, 5: altitude 12/5 on the side 5, radii 1 and 5/2. 5, 5, 8: altitude 3 on the 8, radii 4/3, 25/6.
    known = [
        ([[0, 0], [3, 0], [0, 4]], np.arctan(3 / 4), 25 / 12, 0.8, "sides 3, 4, 5"),
        ([[4, 3], [0, 0], [8, 0]], np.arctan(3 / 4), 8 / 3, 0.64, "sides 5, 5, 8"),
    ]
    inputs = []
    for corners, angle, aspect, radii, on in known:
        Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        vertices = np.pad(np.array(corners, dtype=float), ((0, 0), (0, 1))) @ Q.T + rng.uniform(-5, 5, 3)
        truth = {"smallest_angle": [angle], "aspect_ratio": [aspect * half_root], "radius_ratio": [radii]}
        inputs.append((vertices[rng.permutation(3)], np.array([[0, 1, 2]]), truth, f"a triangle with {on}"))
    _expect_quality(f, inputs)


def _quality(vertices: FloatArray, faces: IntArray) -> dict[str, Any]:
    """Work out the quality from the half-angle formulas of the triangle's angles."""
    angles = np.sort(truths.angles(vertices, faces), axis=1)
    sines = np.sin(angles)
    # With the circumscribed diameter as unit, sides are sines: the altitude on the longest is the product of
    # the two others. The ratio of the radii is 4 sin(α/2) sin(β/2) sin(γ/2).
    return {
        "smallest_angle": angles[:, 0],
        "aspect_ratio": np.sqrt(3) / 2 * sines[:, 2] / (sines[:, 0] * sines[:, 1]),
        "radius_ratio": 8 * np.sin(angles / 2).prod(axis=1),
        "valence": np.array([len(ring) for ring in truths.neighbours(faces, len(vertices))]),
    }


@MESH_QUALITY.check("every face of a mesh, and the valence of every vertex", points=2)
def _(f: Asked, rng: Rng) -> None:
    for_all = [(closed(rng), "a closed mesh"), (bounded(rng), "a mesh with holes")]
    meshes = [(s.vertices, faces_of(s), on) for s, on in for_all]
    _expect_quality(f, [(vertices, faces, _quality(vertices, faces), on) for vertices, faces, on in meshes])


def _sides(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, FloatArray]:
    return np.linalg.norm(truths.opposite_edges(vertices, faces), axis=2), truths.face_areas(vertices, faces)


@MESH_QUALITY.variant("from the sides and areas, one face after the other, as lists")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    angle, aspect, radii = [], [], []
    for sides, area in zip(*_sides(vertices, faces), strict=True):
        a, b, c = sorted(float(side) for side in sides)
        angle.append(float(np.arctan2(4 * area, b * b + c * c - a * a)))
        aspect.append(c / (2 * area / c) * 0.75**0.5)
        radii.append(16 * area**2 / (a * b * c * (a + b + c)))
    valence = [len(ring) for ring in truths.neighbours(faces, len(vertices))]
    return {"smallest_angle": angle, "aspect_ratio": aspect, "radius_ratio": radii, "valence": valence}


@MESH_QUALITY.variant("from the angles, in single precision, with more keys")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    quality = {key: np.asarray(value, dtype=np.float32) for key, value in _quality(vertices, faces).items()}
    return {**quality, "largest_angle": truths.angles(vertices, faces).max(axis=1)}


def _declare_quality_mistake(name: str, hint: str, key: str, wrong: Any) -> None:
    @MESH_QUALITY.mistake(name, hint=hint)
    def _(vertices: FloatArray, faces: IntArray) -> Any:
        return {**_quality(vertices, faces), key: wrong(vertices, faces)}


_declare_quality_mistake(
    "the angles are in degrees",
    "The course measures angles in radians. What is the angle of an equilateral triangle then?",
    "smallest_angle",
    lambda vertices, faces: np.degrees(_quality(vertices, faces)["smallest_angle"]),
)
_declare_quality_mistake(
    "the largest angle was taken for the smallest",
    "Of the three angles of a face, which one gets small when the face degenerates to a needle?",
    "smallest_angle",
    lambda vertices, faces: truths.angles(vertices, faces).max(axis=1),
)
_declare_quality_mistake(
    "the aspect ratio was not scaled to be 1 for an equilateral triangle",
    "What is the longest side over the shortest altitude of an equilateral triangle?",
    "aspect_ratio",
    lambda vertices, faces: _quality(vertices, faces)["aspect_ratio"] * 2 / np.sqrt(3),
)
_declare_quality_mistake(
    "the aspect ratio compares the longest side with the shortest",
    "An obtuse triangle with two equal sides can be very flat. Does your ratio tell?",
    "aspect_ratio",
    lambda vertices, faces: np.divide(*np.sort(_sides(vertices, faces)[0], axis=1)[:, [2, 0]].T),
)
_declare_quality_mistake(
    "the ratio of the radii was not doubled",
    "What is the inscribed radius over the circumscribed one in an equilateral triangle?",
    "radius_ratio",
    lambda vertices, faces: _quality(vertices, faces)["radius_ratio"] / 2,
)
_declare_quality_mistake(
    "the ratio of the radii is upside down",
    "Is the inscribed circle smaller or larger than the circumscribed one? The ratio is at most 1.",
    "radius_ratio",
    lambda vertices, faces: 1 / _quality(vertices, faces)["radius_ratio"],
)
_declare_quality_mistake(
    "the valence counts faces, not edges",
    "A corner of a single triangle has one face. How many edges does it have?",
    "valence",
    lambda vertices, faces: np.bincount(faces.ravel(), minlength=len(vertices)),
)
