"""Exercises on the cells around the vertices, and the mass matrix."""

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
    sphere,
    triangle,
)
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.reference import smoothing as reference

BARYCENTRIC_AREAS = Exercise(
    reference.barycentric_areas,
    notes="ch. 6 §4",
    hints=[
        "The lines from the centroid to the middles of the edges cut it in three. How large is a part?",
        "Each face gives something to each of its three corners: `np.add.at` or `np.bincount` add it up.",
    ],
)

VORONOI_AREAS = Exercise(
    reference.voronoi_areas,
    notes="ch. 6 §4",
    hints=[
        "Join the circumcentre with the middles of two edges: two right triangles meet at the corner.",
        "The height of such a triangle over an edge of length a is a/2 times the cotangent of the angle "
        "that faces the edge.",
        "Each edge gives the same area to the cells at both of its ends.",
    ],
)

MIXED_AREAS = Exercise(
    reference.mixed_areas,
    notes="ch. 6 §4",
    hints=[
        "Where does the circumcentre of an obtuse triangle lie? What do the notes put in its place?",
        "A corner has three cases: the triangle is not obtuse, obtuse at this corner, or obtuse at another.",
        "With the middle of the longest edge for the circumcentre, what part of the triangle is whose?",
    ],
)

Cells = list[tuple[FloatArray, IntArray, FloatArray, str]]


def _expect_cells(f: Asked, inputs: Cells) -> None:
    answers = [f(vertices, faces) for vertices, faces, _, _ in inputs]
    for value, (vertices, faces, truth, on) in zip(f.each(answers), inputs, strict=True):
        bare = shapes.Shape(
            "mesh", vertices, faces, boundary_lengths=(3,), interior=np.ones(len(vertices), dtype=bool)
        )
        expecting.values(value, truth, bare, "The area of a cell", on=on)


def _placed(corners: FloatArray, rng: Rng, size: float) -> FloatArray:
    """Turn and move a triangle in the plane into space."""
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return np.asarray(size * (np.pad(corners, ((0, 0), (0, 1))) @ Q.T + rng.uniform(-3, 3, 3)))


def _known_triangles(rng: Rng, cells: dict[str, FloatArray]) -> Cells:
    """Place triangles whose cells are known, with the corners in another order and size each time."""
    corners = {
        "an equilateral triangle of side 2": [[0, 0], [2, 0], [1, np.sqrt(3)]],
        "a right triangle with legs 3 and 4": [[0, 0], [3, 0], [0, 4]],
        "an obtuse triangle with sides 5, 5 and 8": [[4, 3], [0, 0], [8, 0]],
    }
    found = []
    for name, size in zip(corners, rng.permutation([0.01, 1.0, 100.0]), strict=True):
        order = rng.permutation(3)
        vertices = _placed(np.array(corners[name], dtype=float)[order], rng, size)
        # An odd order turns the face over, which changes no area.
        found.append(
            (vertices, np.array([[0, 1, 2]]), size**2 * cells[name][order], f"{name}, times {size:g}")
        )
    return found


def _declare_total(exercise: Exercise) -> None:
    @exercise.check("the cells together are as large as the surface")
    def _(f: Asked, rng: Rng) -> None:
        for_all = [
            (closed(rng), "a closed mesh"),
            (bounded(rng), "a mesh with holes"),
            (apart(rng), "two pieces"),
        ]
        answers = [f(shape.vertices, faces_of(shape)) for shape, _ in for_all]
        for value, (shape, on) in zip(f.each(answers), for_all, strict=True):
            mine = expect.array(value, (len(shape.vertices),), "The array of areas", on=on)
            total = float(truths.face_areas(shape.vertices, faces_of(shape)).sum())
            size = max(total, float(np.abs(mine).max()))
            picture = pictures.of_own(shape.vertices, faces_of(shape), mine, "area of a cell")
            what = "The sum of the cells"
            expect.close(float(mine.sum()), total, SINGLE * size, what, on=on, picture=picture)


# Barycentric ------------------------------------------------------------------------------------


@BARYCENTRIC_AREAS.check("each corner has a third of its triangle")
def _(f: Asked, rng: Rng) -> None:
    thirds = {
        "an equilateral triangle of side 2": np.full(3, np.sqrt(3) / 3),
        "a right triangle with legs 3 and 4": np.full(3, 2.0),
        "an obtuse triangle with sides 5, 5 and 8": np.full(3, 4.0),
    }
    _expect_cells(f, _known_triangles(rng, thirds))


@BARYCENTRIC_AREAS.check("a vertex collects the thirds of all faces around it", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape, holes = closed(rng), bounded(rng)
    many = [
        (shape.vertices, faces_of(shape), "a closed mesh"),
        # Nothing counts up to a vertex that no face names.
        (
            np.vstack([holes.vertices, holes.vertices[:1]]),
            faces_of(holes),
            "a mesh with holes, and a lone vertex",
        ),
    ]
    _expect_cells(f, [(x, faces, truths.third_areas(x, faces), on) for x, faces, on in many])


_declare_total(BARYCENTRIC_AREAS)


@BARYCENTRIC_AREAS.variant("a loop over the faces, in single precision")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    areas = np.zeros(len(vertices))
    for a, b, c in faces:
        area = 0.5 * np.linalg.norm(np.cross(vertices[b] - vertices[a], vertices[c] - vertices[a]))
        areas[[a, b, c]] += area / 3
    return areas.astype(np.float32)


@BARYCENTRIC_AREAS.variant("Heron's formula and bincount, as a column")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    a, b, c = np.linalg.norm(truths.opposite_edges(vertices, faces), axis=2).T
    s = (a + b + c) / 2
    thirds = np.sqrt(s * (s - a) * (s - b) * (s - c)) / 3
    return np.bincount(faces.ravel(), weights=np.repeat(thirds, 3), minlength=len(vertices))[:, None]


@BARYCENTRIC_AREAS.mistake(
    "the third was forgotten: every corner has all of its faces",
    hint="Add up your cells. How many times does that count each face?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return 3 * truths.third_areas(vertices, faces)


@BARYCENTRIC_AREAS.mistake(
    "the ½ of the triangle's area is missing",
    hint="The length of a cross product is the area of a parallelogram.",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return 2 * truths.third_areas(vertices, faces)


@BARYCENTRIC_AREAS.mistake(
    "the mean of the faces around the vertex was taken",
    hint="A vertex with more faces has a larger cell. Does yours?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return 3 * truths.third_areas(vertices, faces) / np.bincount(faces.ravel(), minlength=len(vertices))


@BARYCENTRIC_AREAS.mistake(
    "`areas[faces] += …` adds once where a vertex comes up several times",
    hint="What does numpy do with an index that comes up twice in `a[index] += 1`? What does `np.add.at` do?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    areas = np.zeros(len(vertices))
    areas[faces] += truths.face_areas(vertices, faces)[:, None] / 3
    return areas


@BARYCENTRIC_AREAS.mistake(
    "the thirds went to the corners of other faces: three whole rounds in place of three times each",
    hint="Is entry k of your list of thirds that of the face which entry k of `faces.ravel()` belongs to?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    thirds = np.tile(truths.face_areas(vertices, faces) / 3, 3)
    return np.bincount(faces.ravel(), weights=thirds, minlength=len(vertices))


@BARYCENTRIC_AREAS.mistake(
    "the areas of the faces were returned, not those of the cells",
    hint="How many cells are there, and how many faces?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.face_areas(vertices, faces)


# Voronoi ----------------------------------------------------------------------------------------


@VORONOI_AREAS.check("an equilateral triangle is cut in thirds, a right one in a half and two quarters")
def _(f: Asked, rng: Rng) -> None:
    cells = {
        "an equilateral triangle of side 2": np.full(3, np.sqrt(3) / 3),
        "a right triangle with legs 3 and 4": np.array([3.0, 1.5, 1.5]),
        # Its circumcentre (4, -7/6), with the apex at (4, 3), lies outside.
        "an obtuse triangle with sides 5, 5 and 8": np.array([25 / 3, 11 / 6, 11 / 6]),
    }
    _expect_cells(f, _known_triangles(rng, cells))


@VORONOI_AREAS.check("the cell ends at the circumcentres and the middles of the edges", points=2)
def _(f: Asked, rng: Rng) -> None:
    R = float(rng.choice([0.01, 1.0, 100.0]))
    _expect_cells(f, [_circumcentric(sphere(rng, R), "a sphere without obtuse angles")])


@VORONOI_AREAS.check("obtuse triangles, whose circumcentre lies outside, count with the sign")
def _(f: Asked, rng: Rng) -> None:
    _expect_cells(
        f, [_circumcentric(closed(rng), "a closed mesh"), _circumcentric(bounded(rng), "a mesh with holes")]
    )


def _circumcentric(shape: shapes.Shape, on: str) -> tuple[FloatArray, IntArray, FloatArray, str]:
    faces = faces_of(shape)
    corners = truths.circumcentric_corners(shape.vertices, faces)
    return shape.vertices, faces, truths.per_vertex(faces, corners, len(shape.vertices)), on


_declare_total(VORONOI_AREAS)


def _eighths(vertices: FloatArray, faces: IntArray, cotangents: FloatArray, power: int = 2) -> FloatArray:
    """Give an eighth of |e|² times the cotangent of the angle facing e to both ends of e."""
    part = np.linalg.norm(truths.opposite_edges(vertices, faces), axis=2) ** power * cotangents / 8
    corners = np.roll(part, -1, axis=1) + np.roll(part, -2, axis=1)
    return truths.per_vertex(faces, corners, len(vertices))


@VORONOI_AREAS.variant("an eighth of the squared edges times the cotangents, in single precision")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _eighths(vertices, faces, truths.cotangents(vertices, faces)).astype(np.float32)


@VORONOI_AREAS.variant("edge by edge, from the cotangent matrix, as a list")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    C = truths.stiffness(vertices, faces)
    squared = np.square(vertices[:, None, :] - vertices[None, :, :]).sum(axis=2)
    return [float(row) for row in (C * squared).sum(axis=1) / 4]


@VORONOI_AREAS.mistake(
    "the cells are barycentric",
    hint="Where do the cells of a triangle's corners meet: at the centroid or at the circumcentre?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.third_areas(vertices, faces)


@VORONOI_AREAS.mistake(
    "the cells are mixed: obtuse triangles are treated apart",
    hint="That is what the mixed cell is for. What does the formula of the Voronoi cell give there?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.mixed_areas(vertices, faces)


@VORONOI_AREAS.mistake(
    "parts that are negative were set to zero",
    hint="Add up your cells on an obtuse triangle. Is the sum its area?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    parts = np.maximum(truths.circumcentric_corners(vertices, faces), 0)
    return truths.per_vertex(faces, parts, len(vertices))


@VORONOI_AREAS.mistake(
    "the factor is twice too large",
    hint="Add up your cells. How does the sum compare with the area of the surface?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return 2 * _eighths(vertices, faces, truths.cotangents(vertices, faces))


@VORONOI_AREAS.mistake(
    "the edges were not squared",
    hint="What unit has your result when the positions are in metres?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _eighths(vertices, faces, truths.cotangents(vertices, faces), power=1)


@VORONOI_AREAS.mistake(
    "the angle beside the edge was taken for the one that faces it",
    hint="The height of the circumcentre over an edge depends on one angle only. Which corner has it?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _eighths(vertices, faces, np.roll(truths.cotangents(vertices, faces), 1, axis=1))


@VORONOI_AREAS.mistake(
    "the absolute value of the cosine makes every angle acute",
    hint="What sign has the cotangent of an obtuse angle? On which side of the edge is the circumcentre?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _eighths(vertices, faces, np.abs(truths.cotangents(vertices, faces)))


# Mixed ------------------------------------------------------------------------------------------


@MIXED_AREAS.check("an obtuse triangle gives half to its obtuse corner and a quarter to each other", points=2)
def _(f: Asked, rng: Rng) -> None:
    cells = {
        "an equilateral triangle of side 2": np.full(3, np.sqrt(3) / 3),
        "a right triangle with legs 3 and 4": np.array([3.0, 1.5, 1.5]),
        "an obtuse triangle with sides 5, 5 and 8": np.array([6.0, 3.0, 3.0]),
    }
    _expect_cells(f, _known_triangles(rng, cells))


@MIXED_AREAS.check("meshes with obtuse and other triangles", points=2)
def _(f: Asked, rng: Rng) -> None:
    many = [
        (closed(rng), "a closed mesh"),
        (bounded(rng), "a mesh with holes"),
        (sphere(rng), "a sphere without obtuse angles"),
    ]
    _expect_cells(
        f, [(s.vertices, faces_of(s), truths.mixed_areas(s.vertices, faces_of(s)), on) for s, on in many]
    )


@MIXED_AREAS.check("whichever corner of the face comes first")
def _(f: Asked, rng: Rng) -> None:
    vertices, faces = triangle(rng, obtuse=True)
    truth = truths.mixed_areas(vertices, faces)
    turns = [np.roll(faces, k, axis=1) for k in range(3)]
    _expect_cells(f, [(vertices, face, truth, f"an obtuse triangle as {face[0].tolist()}") for face in turns])


_declare_total(MIXED_AREAS)


def _assign(vertices: FloatArray, faces: IntArray, corners: FloatArray) -> FloatArray:
    return truths.per_vertex(faces, corners, len(vertices))


@MIXED_AREAS.variant("a loop over the faces and their corners")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    areas = [0.0] * len(vertices)
    for face in faces:
        area = float(truths.face_areas(vertices, face[None])[0])
        cosines = []
        for k in range(3):
            x, y, z = (vertices[face[(k + step) % 3]] for step in range(3))
            cosines.append(float((y - x) @ (z - x)))
        for k in range(3):
            if min(cosines) < 0:
                areas[face[k]] += area / (2 if cosines[k] < 0 else 4)
            else:
                y, z = (k + 1) % 3, (k + 2) % 3
                # The edge to y is as long squared as the two dot products at its ends together.
                to_y, to_z = cosines[k] + cosines[y], cosines[k] + cosines[z]
                areas[face[k]] += (to_y * cosines[z] + to_z * cosines[y]) / (16 * area)
    return areas


@MIXED_AREAS.variant("with np.where over all corners, in single precision")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.mixed_areas(vertices, faces).astype(np.float32)


@MIXED_AREAS.mistake(
    "the corner after the obtuse one got the half",
    hint="Take the triangle with sides 5, 5 and 8. Which of its corners has the largest cell?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    obtuse = truths.obtuse_corners(vertices, faces)
    shares = truths.face_areas(vertices, faces)[:, None] * np.where(np.roll(obtuse, 1, axis=1), 0.5, 0.25)
    voronoi = truths.circumcentric_corners(vertices, faces)
    return _assign(vertices, faces, np.where(obtuse.any(axis=1, keepdims=True), shares, voronoi))


@MIXED_AREAS.mistake(
    "only the first corner of a face was tested",
    hint="Which corner of a face comes first is an accident. Where can the obtuse angle be?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    first = truths.obtuse_corners(vertices, faces)[:, :1]
    shares = truths.face_areas(vertices, faces)[:, None] * np.array([[0.5, 0.25, 0.25]])
    return _assign(vertices, faces, np.where(first, shares, truths.circumcentric_corners(vertices, faces)))


@MIXED_AREAS.mistake(
    "a corner was tested for its own angle only",
    hint="What does a corner get whose own angle is acute, in a triangle that is obtuse elsewhere?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    half = truths.face_areas(vertices, faces)[:, None] / 2
    own = truths.obtuse_corners(vertices, faces)
    return _assign(vertices, faces, np.where(own, half, truths.circumcentric_corners(vertices, faces)))


@MIXED_AREAS.mistake(
    "the half and the quarters are the wrong way round",
    hint="Add up what the three corners of an obtuse triangle get. Is it the whole triangle?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    obtuse = truths.obtuse_corners(vertices, faces)
    shares = truths.face_areas(vertices, faces)[:, None] * np.where(obtuse, 0.25, 0.5)
    voronoi = truths.circumcentric_corners(vertices, faces)
    return _assign(vertices, faces, np.where(obtuse.any(axis=1, keepdims=True), shares, voronoi))


@MIXED_AREAS.mistake(
    "obtuse triangles were cut like all others",
    hint="Where does the circumcentre of an obtuse triangle lie?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return _assign(vertices, faces, truths.circumcentric_corners(vertices, faces))


@MIXED_AREAS.mistake(
    "obtuse triangles were cut in thirds",
    hint="What do the notes (§4) put in the place of a circumcentre that lies outside?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    obtuse = truths.obtuse_corners(vertices, faces).any(axis=1, keepdims=True)
    thirds = truths.face_areas(vertices, faces)[:, None] / 3
    return _assign(vertices, faces, np.where(obtuse, thirds, truths.circumcentric_corners(vertices, faces)))


@MIXED_AREAS.mistake(
    "the cells are barycentric",
    hint="A right triangle gives half of itself to its right corner. What does yours?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.third_areas(vertices, faces)


# The mass matrix --------------------------------------------------------------------------------

MASS_MATRIX = Exercise(
    reference.mass_matrix,
    notes="ch. 6 §8",
    hints=[
        "M times a function integrates it over the cells. Which matrix scales each row by its own area?",
        "All of M is on its diagonal. `scipy.sparse.diags_array` makes such a matrix.",
    ],
)


@MASS_MATRIX.check("a diagonal matrix of the mixed areas", points=2)
def _(f: Asked, rng: Rng) -> None:
    for_all = [(closed(rng), "a closed mesh"), (bounded(rng), "a mesh with holes")]
    answers = [f(shape.vertices, faces_of(shape)) for shape, _ in for_all]
    for value, (shape, on) in zip(f.each(answers), for_all, strict=True):
        place = shape.vertices, faces_of(shape)
        expecting.matrix(value, np.diag(truths.mixed_areas(*place)), *place, on=on)


@MASS_MATRIX.check("the cells that are named")
def _(f: Asked, rng: Rng) -> None:
    shape = bounded(rng)
    names = [str(name) for name in rng.permutation(list(truths.CELLS))]
    answers = [f(shape.vertices, faces_of(shape), cells=name) for name in names]
    for value, name in zip(f.each(answers), names, strict=True):
        place = shape.vertices, faces_of(shape)
        truth = np.diag(truths.CELLS[name](*place))
        expecting.matrix(value, truth, *place, on=f"a mesh with holes and obtuse angles, cells={name!r}")


@MASS_MATRIX.check("refuses cells that there are not")
def _(f: Asked, rng: Rng) -> None:
    shape = closed(rng)
    because = "there are no cells of the name 'hexagonal'"
    expect.refusal(f, shape.vertices, faces_of(shape), cells="hexagonal", because=because)


@MASS_MATRIX.check("1ᵀM1 is the area of the surface")
def _(f: Asked, rng: Rng) -> None:
    start, scale = apart(rng), float(rng.choice([0.01, 100.0]))
    shape = start.scaled(scale)
    on, n = f"two pieces, times {scale:g}", len(shape.vertices)
    M = expect.array(f(shape.vertices, faces_of(shape)), (n, n), "The matrix", on=on)
    area = float(truths.face_areas(shape.vertices, faces_of(shape)).sum())
    # n numbers of single precision.
    expect.close(float(M.sum()), area, SINGLE * max(area, float(np.abs(M).max())), "1ᵀM1", on=on)


@MASS_MATRIX.variant("a dense diagonal matrix")
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return np.diag(truths.cells(vertices, faces, cells))


@MASS_MATRIX.variant("set entry by entry in DOK format, in single precision")
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    from scipy import sparse

    M: Any = sparse.dok_array((len(vertices), len(vertices)), dtype=np.float32)
    for i, area in enumerate(truths.cells(vertices, faces, cells)):
        M[i, i] = area
    return M


@MASS_MATRIX.mistake(
    "the inverse of M was returned",
    hint="Which of M and its inverse grows when the mesh grows?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return np.diag(1 / truths.cells(vertices, faces, cells))


@MASS_MATRIX.mistake(
    "the areas were returned as a vector, not as a matrix",
    hint="What shape has a matrix that stands beside C?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return truths.cells(vertices, faces, cells)


@MASS_MATRIX.mistake(
    "barycentric cells were used where mixed ones are the default",
    hint="Which cells does your function use when nothing is said about them?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "barycentric") -> Any:
    return np.diag(truths.cells(vertices, faces, cells))


@MASS_MATRIX.mistake(
    "Voronoi cells were used where mixed ones are the default",
    hint="Which cells does your function use when nothing is said about them? Try an obtuse triangle.",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "voronoi") -> Any:
    return np.diag(truths.cells(vertices, faces, cells))


@MASS_MATRIX.mistake(
    "the areas were doubled, as in §11 of the notes, where C has no ½",
    hint="The notes write the ½ either into C (§8) or into M (§11). Which of the two do we follow?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return np.diag(2 * truths.cells(vertices, faces, cells))


@MASS_MATRIX.mistake(
    "the areas were divided by their sum",
    hint="1ᵀM1 should be the area of the surface. What is it for your matrix?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    areas = truths.cells(vertices, faces, cells)
    return np.diag(areas / areas.sum())


@MASS_MATRIX.mistake(
    "`cells` was not used: the cells are always mixed",
    hint="Three functions give areas of cells. Which of them does your function call for which name?",
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    truths.cells(vertices, faces, cells)
    return np.diag(truths.mixed_areas(vertices, faces))


@MASS_MATRIX.mistake(
    "a name that there is not was taken for the default",
    hint='Somebody writes `cells="vornoi"`. What should your function do, and what does it do?',
)
def _(vertices: FloatArray, faces: IntArray, *, cells: str = "mixed") -> Any:
    return np.diag(truths.cells(vertices, faces, cells if cells in truths.CELLS else "mixed"))
