"""Exercises on fairing: energies, and the surfaces of least energy."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from gpcourse.exercises import expect, pictures
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Asked
from gpcourse.exercises.smoothing import truths
from gpcourse.exercises.smoothing.inputs import (
    SINGLE,
    Rng,
    apart,
    bounded,
    closed,
    faces_of,
    grid,
    matrices,
    patch,
    sphere,
    turned,
)
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.reference import smoothing as reference

#: What solving may lose besides the last digits of single precision.
SOLVED = 5 * SINGLE

# Energies ---------------------------------------------------------------------------------------

DIRICHLET_ENERGY = Exercise(
    reference.dirichlet_energy,
    notes="ch. 6 §14",
    hints=[
        "C is negative semi-definite, an energy is not. Which sign must stand before xᵀCx?",
        "For several columns the energies are added. Which entries of XᵀCX are they?",
    ],
)


def _expect_energies(
    answers: Iterable[Any], truths_: list[float], names: list[str], sizes: list[float]
) -> None:
    for value, truth, on, size in zip(answers, truths_, names, sizes, strict=True):
        mine = expect.number(value, "The energy", on=on)
        expect.close(mine, truth, SOLVED * size, "The energy", on=on)


@DIRICHLET_ENERGY.check("a linear function on a flat patch: its squared slope times the area")
def _(f: Asked, rng: Rng) -> None:
    flat, slope = turned(patch(rng), rng), rng.normal(size=3)
    C, _M = matrices(flat)
    normal = np.cross(*truths.opposite_edges(flat.vertices, faces_of(flat))[0, :2])
    normal /= np.linalg.norm(normal)
    # Only what lies in the plane of the patch is a slope there.
    inside = slope - (slope @ normal) * normal
    area = float(truths.face_areas(flat.vertices, faces_of(flat)).sum())
    value = f(C, flat.vertices @ slope + 3.0)
    truth = float(inside @ inside) * area
    # The 3 is larger than the function: its squares cancel.
    _expect_energies([value], [truth], ["a flat irregular patch"], [10 * float(abs(C).max())])


@DIRICHLET_ENERGY.check("of the positions themselves: twice the area", points=2)
def _(f: Asked, rng: Rng) -> None:
    many = [sphere(rng, float(rng.choice([0.01, 100.0]))), bounded(rng)]
    many[1] = many[1].moved(-many[1].vertices.mean(axis=0))
    answers = [f(matrices(shape)[0], shape.vertices) for shape in many]
    areas = [float(truths.face_areas(shape.vertices, faces_of(shape)).sum()) for shape in many]
    sizes = [10 * area for area in areas]
    _expect_energies(f.each(answers), [2 * area for area in areas], ["a sphere", "a mesh with holes"], sizes)


@DIRICHLET_ENERGY.check("a mode of frequency ω, of length 1 in M, has the energy ω")
def _(f: Asked, rng: Rng) -> None:
    shape = closed(rng)
    C, M = matrices(shape)
    frequencies, phi = truths.modes(C, M)
    i, j = (int(mode) for mode in rng.choice(np.arange(1, 12), 2, replace=False))
    answers = [f(C, phi[:, i]), f(C, phi[:, [i, j]])]
    truth = [float(frequencies[i]), float(frequencies[i] + frequencies[j])]
    sizes = [10 * float(frequencies[12])] * 2
    _expect_energies(
        f.each(answers), truth, ["one mode of a closed mesh", "two modes of a closed mesh"], sizes
    )


@DIRICHLET_ENERGY.variant("edge by edge: weights times squared differences")
def _(C: Any, x: FloatArray) -> Any:
    D, columns = truths.dense(C), x.reshape(len(x), -1)
    squared = np.square(columns[:, None, :] - columns[None, :, :]).sum(axis=2)
    return 0.5 * float((D * squared).sum())


@DIRICHLET_ENERGY.variant("the trace of the product, as an array")
def _(C: Any, x: FloatArray) -> Any:
    columns = x.reshape(len(x), -1)
    return np.array([-np.trace(columns.T @ truths.dense(C) @ columns)])


@DIRICHLET_ENERGY.mistake("the sign is missing: the energy is negative", hint="Can an energy be negative?")
def _(C: Any, x: FloatArray) -> Any:
    return float((x * (C @ x)).sum())


@DIRICHLET_ENERGY.mistake(
    "the result was halved",
    hint="Some books put a ½ before the integral. Do the notes (§14)?",
)
def _(C: Any, x: FloatArray) -> Any:
    return -0.5 * float((x * (C @ x)).sum())


@DIRICHLET_ENERGY.mistake(
    "the root was taken",
    hint="What becomes of the energy when x is doubled?",
)
def _(C: Any, x: FloatArray) -> Any:
    return max(-float((x * (C @ x)).sum()), 0.0) ** 0.5


@DIRICHLET_ENERGY.mistake(
    "all entries of XᵀCX were added, not those of its diagonal",
    hint="The energy of x and that of y are added. Is there an energy of x with y?",
)
def _(C: Any, x: FloatArray) -> Any:
    columns = x.reshape(len(x), -1)
    return -float((columns.T @ (C @ columns)).sum())


@DIRICHLET_ENERGY.mistake(
    "the squared length of Cx was taken",
    hint="That measures how x bends. What does a linear function give, and what should it give?",
)
def _(C: Any, x: FloatArray) -> Any:
    return float(np.square(C @ x).sum())


MEMBRANE_ENERGY = Exercise(
    reference.membrane_energy,
    notes="ch. 6 §14",
    hints=[
        "What does a soap film make as small as it can?",
        "The length of a cross product of two sides is the area of a parallelogram.",
    ],
)


@MEMBRANE_ENERGY.check("a cube, a tetrahedron and a flat square")
def _(f: Asked, rng: Rng) -> None:
    s = float(rng.uniform(0.5, 2.0) * rng.choice([0.01, 1.0, 100.0]))
    cells = np.asarray(shapes.cube(s).faces)
    cube = shapes.Shape("cube", shapes.cube(s).vertices, cells[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))
    many = [turned(cube, rng), turned(shapes.tetrahedron(s), rng), turned(grid(rng).scaled(s), rng)]
    answers = [f(shape.vertices, faces_of(shape)) for shape in many]
    # The edges of a tetrahedron in a sphere of radius s have length s √(8/3).
    areas = [6 * s**2, 8 / np.sqrt(3) * s**2, s**2]
    names = [f"{name}, size {s:.3g}" for name in ("a cube of triangles", "a tetrahedron", "a flat square")]
    _expect_energies(f.each(answers), areas, names, areas)


@MEMBRANE_ENERGY.check("obtuse triangles, holes and several components")
def _(f: Asked, rng: Rng) -> None:
    many = [closed(rng), bounded(rng), apart(rng)]
    answers = [f(shape.vertices, faces_of(shape)) for shape in many]
    areas = [_heron(shape) for shape in many]
    _expect_energies(f.each(answers), areas, ["a closed mesh", "a mesh with holes", "two components"], areas)


def _heron(shape: shapes.Shape) -> float:
    """Return the area from the lengths of the sides."""
    total = 0.0
    for sides in np.linalg.norm(truths.opposite_edges(shape.vertices, faces_of(shape)), axis=2):
        a, b, c = np.sort(sides)[::-1]
        total += float(np.sqrt((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c)))) / 4
    return total


@MEMBRANE_ENERGY.variant("half of the Dirichlet energy of the positions")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    x = vertices - vertices.mean(axis=0)
    return -0.5 * float((x * (truths.stiffness(vertices, faces) @ x)).sum())


@MEMBRANE_ENERGY.variant("the sum of the cells' areas, as numpy's own number")
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return np.float32(truths.mixed_areas(vertices, faces).sum())


@MEMBRANE_ENERGY.mistake(
    "the ½ of the triangle's area is missing",
    hint="The length of a cross product is the area of a parallelogram.",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return 2 * truths.face_areas(vertices, faces).sum()


@MEMBRANE_ENERGY.mistake(
    "the vector areas were added before their length was taken",
    hint="The vector areas of a closed surface sum to zero. Does its area?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    e = truths.opposite_edges(vertices, faces)
    return 0.5 * float(np.linalg.norm(np.cross(e[:, 0], e[:, 1]).sum(axis=0)))


@MEMBRANE_ENERGY.mistake(
    "the areas were squared",
    hint="What unit has an area? What unit has your result?",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return float(np.square(truths.face_areas(vertices, faces)).sum())


@MEMBRANE_ENERGY.mistake(
    "the area of each face was returned",
    hint="An energy is one number for the whole surface.",
)
def _(vertices: FloatArray, faces: IntArray) -> Any:
    return truths.face_areas(vertices, faces)


THIN_PLATE_ENERGY = Exercise(
    reference.thin_plate_energy,
    notes="ch. 6 §14",
    hints=[
        "The energy is the integral of |Δx|². Which product integrates over a mesh?",
        "Δx is M⁻¹Cx. Put it into the integral: one M and one M⁻¹ cancel.",
    ],
)


@THIN_PLATE_ENERGY.check("a mode of frequency ω, of length 1 in M, has the energy ω²", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape = closed(rng)
    C, M = matrices(shape)
    frequencies, phi = truths.modes(C, M)
    i, j = (int(mode) for mode in rng.choice(np.arange(1, 12), 2, replace=False))
    answers = [f(C, M, phi[:, i]), f(C, M, phi[:, [i, j]])]
    squares = frequencies**2
    names, sizes = ["one mode of a closed mesh", "two modes of a closed mesh"], [10 * float(squares[12])] * 2
    _expect_energies(f.each(answers), [float(squares[i]), float(squares[i] + squares[j])], names, sizes)


@THIN_PLATE_ENERGY.check("of the positions: four times the integral of H²")
def _(f: Asked, rng: Rng) -> None:
    R = float(rng.uniform(0.5, 2.0) * rng.choice([0.01, 1.0, 100.0]))
    solids = [turned(s, rng) for s in (shapes.tetrahedron(R), shapes.octahedron(R), shapes.icosahedron(R))]
    answers = [f(*matrices(s), s.vertices) for s in solids]
    # Δx = −2x/R² at every corner of a regular solid, so that |Δx|² = 4/R².
    areas = [float(truths.face_areas(s.vertices, faces_of(s)).sum()) for s in solids]
    names = [f"a regular {s.name} on a sphere of radius {R:.3g}" for s in solids]
    energies = [4 * area / R**2 for area in areas]
    _expect_energies(f.each(answers), energies, names, energies)


@THIN_PLATE_ENERGY.check("the integral of the squared Laplacian of any function, cell by cell")
def _(f: Asked, rng: Rng) -> None:
    shape = bounded(rng)
    C, M = matrices(shape)
    x = rng.normal(size=(len(shape.vertices), 2))
    laplacian = truths.laplacian(shape.vertices, faces_of(shape)) @ x
    truth = float((truths.mixed_areas(shape.vertices, faces_of(shape)) @ np.square(laplacian)).sum())
    _expect_energies([f(C, M, x)], [truth], ["two random functions on a mesh with holes"], [truth])


@THIN_PLATE_ENERGY.variant("the quadratic form C M⁻¹ C, dense")
def _(C: Any, M: Any, x: FloatArray) -> Any:
    D, columns = truths.dense(C), x.reshape(len(x), -1)
    K = D @ np.linalg.inv(truths.dense(M)) @ D
    return np.trace(columns.T @ K @ columns)


@THIN_PLATE_ENERGY.variant("the areas times the squared Laplacian, as an array in single precision")
def _(C: Any, M: Any, x: FloatArray) -> Any:
    areas = M.diagonal()
    squared = np.square((C @ x).T / areas)
    return np.array([(squared * areas).sum()], dtype=np.float32)


@THIN_PLATE_ENERGY.mistake(
    "the mass matrix was left out: this is |Cx|²",
    hint="C is integrated over cells. What becomes of your energy when the mesh is scaled?",
)
def _(C: Any, M: Any, x: FloatArray) -> Any:
    return float(np.square(C @ x).sum())


@THIN_PLATE_ENERGY.mistake(
    "the squared Laplacian was added up over the vertices, without their areas",
    hint="An integral weighs each vertex with its cell. Does your sum?",
)
def _(C: Any, M: Any, x: FloatArray) -> Any:
    return float(np.square((C @ x).T / M.diagonal()).sum())


@THIN_PLATE_ENERGY.mistake(
    "M stands where its inverse belongs",
    hint="Δx = M⁻¹Cx. With M in between the two Δx, which M is left?",
)
def _(C: Any, M: Any, x: FloatArray) -> Any:
    return float((np.square(C @ x).T * M.diagonal()).sum())


@THIN_PLATE_ENERGY.mistake(
    "the gradient was measured, not the bending: this is the Dirichlet energy",
    hint="A linear function on a plane does not bend. What is its thin-plate energy?",
)
def _(C: Any, M: Any, x: FloatArray) -> Any:
    return -float((x * (C @ x)).sum())


@THIN_PLATE_ENERGY.mistake(
    "the result was halved",
    hint="Some books put a ½ before the integral. Do the notes (§14)?",
)
def _(C: Any, M: Any, x: FloatArray) -> Any:
    return 0.5 * float((np.square(C @ x).T / M.diagonal()).sum())


# One dimension ----------------------------------------------------------------------------------

EULER_LAGRANGE_1D = Exercise(
    reference.euler_lagrange_1d,
    notes="ch. 6 §14, Calculus of Variations",
    hints=[
        "At a minimum the derivative of the energy with respect to every inner value is zero.",
        "Each inner value occurs in two terms of the sum. Their derivatives give one row of a linear system.",
        "What does f″ = 0 say about f? Does your result look like that when the steps of t are uneven?",
    ],
)


def _samples(rng: Rng) -> FloatArray:
    """Draw parameters with steps that differ up to tenfold, starting anywhere."""
    return np.asarray(rng.uniform(-3.0, 3.0) + np.cumsum(rng.uniform(0.1, 1.0, int(rng.integers(8, 14)))))


def _line(t: FloatArray, left: float, right: float) -> FloatArray:
    return np.asarray(left + (right - left) * (t - t[0]) / (t[-1] - t[0]))


def _expect_string(value: object, t: FloatArray, left: float, right: float, on: str) -> None:
    mine = expect.array(value, (len(t),), "The array of values", on=on)
    size = 5 * max(abs(left), abs(right), 1.0)
    ends = np.array([mine[0] - left, mine[-1] - right])
    expect.close(ends, 0.0, SOLVED * size, "The distance to the given value at an end", on=on)
    # f″ = 0: the slopes of all intervals are the same.
    what = "f, which should be straight,"
    expect.close(mine, _line(t, left, right), SOLVED * size, what, on=on, shown=pictures.Graph(t))


@EULER_LAGRANGE_1D.check("in equal steps, equal differences")
def _(f: Asked, rng: Rng) -> None:
    t = np.linspace(0.0, float(rng.uniform(1.0, 5.0)), int(rng.integers(5, 12)))
    left, right = (float(value) for value in rng.normal(size=2))
    _expect_string(f(t, left, right), t, left, right, "samples in equal steps")


@EULER_LAGRANGE_1D.check("in uneven steps, one straight line all the same", points=2)
def _(f: Asked, rng: Rng) -> None:
    many = [(_samples(rng), float(rng.uniform(-4.0, 4.0)), float(rng.uniform(-4.0, 4.0))) for _ in range(3)]
    answers = [f(t, left, right) for t, left, right in many]
    for value, (t, left, right) in zip(f.each(answers), many, strict=True):
        _expect_string(value, t, left, right, f"{len(t)} samples in uneven steps")


@EULER_LAGRANGE_1D.check("no other function with these ends has less energy")
def _(f: Asked, rng: Rng) -> None:
    t, (left, right) = _samples(rng), (float(value) for value in rng.uniform(-4.0, 4.0, 2))
    value, on = f(t, left, right), "samples in uneven steps"
    mine = expect.array(value, (len(t),), "The array of values", on=on)
    steps = np.diff(t)
    bump = np.sin(np.pi * (t - t[0]) / (t[-1] - t[0]))
    others = [mine + s * bump for s in (0.1, -0.1)] + [_line(t, left, right)]
    ends_kept = abs(mine[0] - left) + abs(mine[-1] - right) <= 1e-4
    expect.that(ends_kept, "The values at the ends are not those that are given.", on=on)
    energy = float((np.diff(mine) ** 2 / steps).sum())
    least = min(float((np.diff(other) ** 2 / steps).sum()) for other in others)
    message = "There is a function with the same ends and less energy."
    yours, truth = f"energy {energy:.6g}", f"energy {least:.6g}"
    slack = SOLVED * (1 + abs(least))
    picture = pictures.of_graph(t, mine)
    expect.that(energy <= least + slack, message, yours=yours, truth=truth, picture=picture)


@EULER_LAGRANGE_1D.variant("interpolation between the ends, in single precision")
def _(t: FloatArray, left: float, right: float) -> Any:
    return np.interp(t, [t[0], t[-1]], [left, right]).astype(np.float32)


@EULER_LAGRANGE_1D.variant("a dense system for the inner values, as a list")
def _(t: FloatArray, left: float, right: float) -> Any:
    weight = 1 / np.diff(t)
    A = np.diag(weight[:-1] + weight[1:]) - np.diag(weight[1:-1], 1) - np.diag(weight[1:-1], -1)
    b = np.zeros(len(t) - 2)
    b[0] += weight[0] * left
    b[-1] += weight[-1] * right
    return [left, *np.linalg.solve(A, b).tolist(), right]


@EULER_LAGRANGE_1D.mistake(
    "the samples were taken to lie in equal steps",
    hint="How long is each interval? A steep piece over a short interval costs more than over a long one.",
)
def _(t: FloatArray, left: float, right: float) -> Any:
    return np.linspace(left, right, len(t))


@EULER_LAGRANGE_1D.mistake(
    "the terms were divided by the squared length of their interval",
    hint="The integral of f′² over an interval is the squared slope times its length.",
)
def _(t: FloatArray, left: float, right: float) -> Any:
    lengths = np.append(0.0, np.cumsum(np.diff(t) ** 2))
    return left + (right - left) * lengths / lengths[-1]


@EULER_LAGRANGE_1D.mistake(
    "the terms were multiplied by the length of their interval, not divided",
    hint="Does the same difference cost more over a short interval or over a long one?",
)
def _(t: FloatArray, left: float, right: float) -> Any:
    # The energy Σ w_i d_i² with Σ d_i given is least for d_i in proportion to 1 / w_i.
    rises = np.append(0.0, np.cumsum(1 / np.diff(t)))
    return left + (right - left) * rises / rises[-1]


@EULER_LAGRANGE_1D.mistake(
    "the parameter was not measured from its start",
    hint="What does your formula give at the first sample, when t does not start at 0?",
)
def _(t: FloatArray, left: float, right: float) -> Any:
    return left + (right - left) * t / t[-1]


@EULER_LAGRANGE_1D.mistake(
    "the ends are the wrong way round",
    hint="Which of the two values belongs to the first sample?",
)
def _(t: FloatArray, left: float, right: float) -> Any:
    return _line(t, right, left)


@EULER_LAGRANGE_1D.mistake(
    "the ends were not fixed: all values are their mean",
    hint="A constant has no energy at all. What keeps the function from being constant?",
)
def _(t: FloatArray, left: float, right: float) -> Any:
    return np.full(len(t), (left + right) / 2)


@EULER_LAGRANGE_1D.mistake(
    "the inner values are 0",
    hint="What does the equation of the sample beside an end say about the value at that end?",
)
def _(t: FloatArray, left: float, right: float) -> Any:
    return np.concatenate([[left], np.zeros(len(t) - 2), [right]])


# Fair surfaces ----------------------------------------------------------------------------------

FAIR = Exercise(
    reference.fair,
    notes="ch. 6 §14",
    hints=[
        "The free vertices are the unknowns; in their rows Δᵏx = 0 has to hold.",
        "Multiply Δᵏ by M: C for k = 1, C M⁻¹ C for k = 2. That is symmetric.",
        "What is known goes to the right-hand side, as in the Laplace equation.",
    ],
    time_limit=4.0,
)


def _sheet(rng: Rng, order: int) -> tuple[shapes.Shape, IntArray]:
    """Draw a bumpy square, turned in space, and the vertices of its `order` outer rings, in any order."""
    square = grid(rng, 4 + 2 * order - 1)
    k = 4 + 2 * order - 1
    column, row = np.rint(k * square.vertices[:, :2]).T
    depth = np.minimum.reduce([column, row, k - column, k - row])
    # Cells that grow threefold along both axes: in equal cells M would hardly matter.
    graded = square.vertices * (1 + square.vertices) / 2
    shaken = graded + rng.uniform(-0.1, 0.1, square.vertices.shape) / k
    bumpy = shapes.Shape(
        square.name, shaken, square.faces, boundary_lengths=square.boundary_lengths, interior=square.interior
    )
    placed = turned(bumpy.moved(rng.uniform(-1, 1, 3)), rng).scaled(float(rng.choice([0.01, 1.0, 100.0])))
    return placed, rng.permutation(np.flatnonzero(depth < order))


def _power(vertices: FloatArray, faces: IntArray, order: int) -> FloatArray:
    """Return the dense C (M⁻¹C)^(order − 1)."""
    C = truths.stiffness(vertices, faces)
    return np.asarray(C @ np.linalg.matrix_power(truths.laplacian(vertices, faces), order - 1))


def _expect_fixed(
    mine: FloatArray, before: FloatArray, faces: IntArray, fixed: IntArray, tolerance: float, on: str
) -> None:
    """Expect that the fixed vertices are where they were."""
    moved = np.zeros_like(before)
    moved[fixed] = mine[fixed] - before[fixed]
    shown = pictures.Field(before, faces, "how far a fixed vertex moved")
    expect.close(moved, 0.0, tolerance, "How far a fixed vertex moved", on=on, shown=shown)


def _expect_fair(f: Asked, rng: Rng, orders: tuple[int, ...]) -> None:
    asked = []
    for order in orders:
        shape, fixed = _sheet(rng, order)
        asked.append((f(shape.vertices, faces_of(shape), fixed, order), shape, fixed, order))
    for f.about, (value, shape, fixed, order) in enumerate(asked):
        on = f"a bumpy sheet, order {order}"
        mine = expect.array(value, shape.vertices.shape, "The array of positions", on=on)
        size = float(np.ptp(shape.vertices, axis=0).max()) + float(np.abs(shape.vertices).max())
        truth = _faired(shape.vertices, faces_of(shape), fixed, order)
        _expect_fixed(mine, shape.vertices, faces_of(shape), fixed, SINGLE * size, on)
        shown = pictures.Positions(shape.vertices, faces_of(shape))
        # The condition numbers stay below 1e3.
        expect.close(mine, truth, SOLVED * size, f"The positions, by Δ^{order} x = 0", on=on, shown=shown)


def _faired(vertices: FloatArray, faces: IntArray, fixed: IntArray, order: int, K: Any = None) -> FloatArray:
    """Solve Kx = 0 in the rows of the free vertices."""
    K = _power(vertices, faces, order) if K is None else K
    free = np.setdiff1d(np.arange(len(vertices)), fixed)
    x = vertices.copy()
    x[free] = np.linalg.solve(K[np.ix_(free, free)], -K[np.ix_(free, fixed)] @ vertices[fixed])
    return x


@FAIR.check("a membrane in a flat frame is flat", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape, fixed = _sheet(rng, 1)
    # The plane that the sheet is nearest to.
    normal = np.linalg.svd(shape.vertices - shape.vertices.mean(axis=0))[2][-1]
    vertices = shape.vertices - shape.vertices.mean(axis=0)
    vertices[fixed] -= np.outer(vertices[fixed] @ normal, normal)
    size = float(np.ptp(vertices, axis=0).max())
    on = "a bumpy sheet in a flat frame, order 1"
    value = f(vertices, faces_of(shape), fixed, 1)
    mine = expect.array(value, vertices.shape, "The array of positions", on=on)
    _expect_fixed(mine, vertices, faces_of(shape), fixed, SINGLE * size, on)
    shown = pictures.Field(mine, faces_of(shape), "height")
    what = "The height over the plane of the frame"
    expect.close(mine @ normal, 0.0, SOLVED * size, what, on=on, shown=shown)
    C = truths.stiffness(vertices, faces_of(shape))
    free = np.setdiff1d(np.arange(len(vertices)), fixed)
    residual = np.zeros_like(mine)
    residual[free] = (C @ mine)[free]
    bound = SOLVED * float(np.abs(C).max()) * max(size, float(np.abs(mine).max()))
    shown = pictures.Field(mine, faces_of(shape), "|Cx|")
    expect.close(residual, 0.0, bound, "Cx at a free vertex", on=on, shown=shown)


@FAIR.check("membrane and thin plate: Δᵏx = 0 where nothing is fixed", points=2)
def _(f: Asked, rng: Rng) -> None:
    _expect_fair(f, rng, (1, 2))


@FAIR.check("order 3, the least change of curvature")
def _(f: Asked, rng: Rng) -> None:
    _expect_fair(f, rng, (3,))


@FAIR.check("a thin plate takes up the slope of its border: a flat sheet with bumps becomes flat again")
def _(f: Asked, rng: Rng) -> None:
    shape, fixed = _sheet(rng, 2)
    normal = np.linalg.svd(shape.vertices - shape.vertices.mean(axis=0))[2][-1]
    vertices = shape.vertices - shape.vertices.mean(axis=0)
    vertices[fixed] -= np.outer(vertices[fixed] @ normal, normal)
    size = float(np.ptp(vertices, axis=0).max())
    on = "a sheet with bumps in the middle, order 2, the fixed vertices as a mask"
    value = f(vertices, faces_of(shape), np.isin(np.arange(len(vertices)), fixed), 2)
    mine = expect.array(value, vertices.shape, "The array of positions", on=on)
    _expect_fixed(mine, vertices, faces_of(shape), fixed, SINGLE * size, on)
    shown = pictures.Field(mine, faces_of(shape), "height")
    expect.close(mine @ normal, 0.0, 10 * SOLVED * size, "The height over the plane", on=on, shown=shown)


def _indices(vertices: FloatArray, fixed: Any) -> IntArray:
    fixed = np.asarray(fixed)
    return np.flatnonzero(fixed) if fixed.dtype == bool else fixed


@FAIR.variant("powers of M⁻¹C, not symmetric, with a mask")
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    mask = np.zeros(len(vertices), dtype=bool)
    mask[fixed] = True
    K = np.linalg.matrix_power(truths.laplacian(vertices, faces), order)
    x = vertices.copy()
    x[~mask] = np.linalg.solve(K[np.ix_(~mask, ~mask)], -K[np.ix_(~mask, mask)] @ vertices[mask])
    return x


@FAIR.variant("rows of the identity for the fixed vertices, about the centre, in single precision")
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    centre, keep = vertices.mean(axis=0), _indices(vertices, fixed)
    K = np.linalg.matrix_power(truths.laplacian(vertices, faces), order)
    K /= np.abs(K).max()
    K[keep] = np.eye(len(K))[keep]
    b = np.zeros_like(vertices)
    b[keep] = vertices[keep] - centre
    return (np.linalg.solve(K, b) + centre).astype(np.float32)


@FAIR.mistake(
    "rows and right-hand side of the fixed vertices were set to zero: they collapse to the origin",
    hint="A row of zeros says 0 = 0. What should the row of a fixed vertex say?",
)
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    return np.zeros_like(vertices)


@FAIR.mistake(
    "the fixed vertices are not felt by the others: the right-hand side is zero",
    hint="Where do the free vertices go? What does the equation of one beside a fixed vertex say?",
)
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    x = np.zeros_like(vertices)
    x[fixed] = vertices[fixed]
    return x


@FAIR.mistake(
    "`fixed` was taken for indices where it is a mask",
    hint="`fixed` may be a mask of true and false, or indices. What does `np.setdiff1d` find in a mask?",
)
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    return _faired(vertices, faces, np.unique(np.asarray(fixed).astype(int)), order)


@FAIR.mistake(
    "`fixed` was taken for a mask where it holds indices",
    hint="`fixed` may be a mask of true and false, or indices. What does `~fixed` do to a number?",
)
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    K, free, x = _power(vertices, faces, order), ~np.asarray(fixed), vertices.copy()
    x[free] = np.linalg.solve(K[np.ix_(free, free)], -K[np.ix_(free, fixed)] @ vertices[fixed])
    return x


@FAIR.mistake(
    "order 1 was solved, whatever the order",
    hint="A membrane meets its frame at any angle. What else does a thin plate keep?",
)
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    return _faired(vertices, faces, _indices(vertices, fixed), 1)


@FAIR.mistake(
    "the power was taken of C, without M⁻¹ in between",
    hint="Δᵏ = M⁻¹C M⁻¹C …: which of the M cancel when the first is multiplied away?",
)
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    K = np.linalg.matrix_power(truths.stiffness(vertices, faces), order)
    return _faired(vertices, faces, _indices(vertices, fixed), order, K)


@FAIR.mistake(
    "the uniform Laplacian was used",
    hint="The uniform Laplacian knows nothing of lengths and angles. Which one do the notes (§14) use?",
)
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    K = np.linalg.matrix_power(truths.mean_of_neighbours(faces, len(vertices)), order)
    return _faired(vertices, faces, _indices(vertices, fixed), order, K)


@FAIR.mistake(
    "the fixed vertices went to the right-hand side with the wrong sign",
    hint="A term that crosses the equals sign changes its sign. On which side of the origin is your surface?",
)
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    x = -_faired(vertices, faces, _indices(vertices, fixed), order)
    x[fixed] = vertices[fixed]
    return x


@FAIR.mistake(
    "the boundary was fixed, and nothing else",
    hint="How many rings does `fixed` hold for order 2? What do you let go of?",
)
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    return _faired(vertices, faces, truths.boundary_vertices(faces), order)


@FAIR.mistake(
    "the other vertices were fixed, and these were moved",
    hint="Which vertices does `fixed` name: those that stay or those that move?",
)
def _(vertices: FloatArray, faces: IntArray, fixed: Any, order: int) -> Any:
    others = np.setdiff1d(np.arange(len(vertices)), _indices(vertices, fixed))
    return _faired(vertices, faces, others, order)
