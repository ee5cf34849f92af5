"""Exercises on flows: explicit and implicit steps, of functions and of the surface itself."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gpcourse.exercises import expect, pictures
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Asked
from gpcourse.exercises.smoothing import expecting, truths
from gpcourse.exercises.smoothing.inputs import (
    ITERATED,
    SINGLE,
    Rng,
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

# Explicit ---------------------------------------------------------------------------------------

EXPLICIT_STEP = Exercise(
    reference.explicit_step,
    notes="ch. 6 §13.4; coursework 2, question 5",
    hints=[
        "The notes give the step as one matrix that multiplies all positions.",
        "You need not build that matrix: what does it do to the positions, written as a sum?",
    ],
)


def _uniform(shape: shapes.Shape) -> Any:
    """Return the sparse uniform Laplacian of a shape."""
    from scipy import sparse

    return sparse.csr_array(truths.mean_of_neighbours(faces_of(shape), len(shape.vertices)))


def _cotangent(shape: shapes.Shape) -> Any:
    """Return the sparse M⁻¹C of a shape."""
    from scipy import sparse

    return sparse.csr_array(truths.laplacian(shape.vertices, faces_of(shape)))


@EXPLICIT_STEP.check(
    "with the uniform Laplacian and a step of 1, every vertex goes to the mean of its neighbours"
)
def _(f: Asked, rng: Rng) -> None:
    shape = bounded(rng)
    value = f(shape.vertices, _uniform(shape), 1.0)
    rings = truths.neighbours(faces_of(shape), len(shape.vertices))
    truth = np.array([shape.vertices[sorted(ring)].mean(axis=0) for ring in rings])
    expecting.positions(value, truth, shape, on="a mesh with holes")


@EXPLICIT_STEP.check("a sphere of radius R shrinks by 2λ/R")
def _(f: Asked, rng: Rng) -> None:
    solids = (shapes.tetrahedron, shapes.octahedron, shapes.icosahedron)
    R = float(rng.uniform(0.5, 2.0) * rng.choice([0.01, 100.0]))
    solid = turned(shapes.shuffled(solids[int(rng.integers(3))](R), rng), rng)
    lam = float(rng.uniform(0.05, 0.2) * R**2)
    value = f(solid.vertices, _cotangent(solid), lam)
    on = f"a regular {solid.name} on a sphere of radius {R:.3g}, λ = {lam / R**2:.3g} R²"
    expecting.positions(value, (1 - 2 * lam / R**2) * solid.vertices, solid, on=on)


@EXPLICIT_STEP.check("P + λLP, whatever the step", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape = closed(rng)
    L, steps = _uniform(shape), (0.0, float(rng.uniform(0.1, 0.9)), -0.25)
    answers = [f(shape.vertices, L, lam) for lam in steps]
    for value, lam in zip(f.each(answers), steps, strict=True):
        # The mean over the neighbours has the weight λ, the vertex itself the rest.
        mean = (truths.dense(L) + np.eye(len(shape.vertices))) @ shape.vertices
        truth = (1 - lam) * shape.vertices + lam * mean
        expecting.positions(value, truth, shape, on=f"a closed mesh, λ = {lam:.3g}")


@EXPLICIT_STEP.variant("the matrix I + λL, dense")
def _(vertices: FloatArray, L: Any, lam: float) -> Any:
    return (np.eye(len(vertices)) + lam * truths.dense(L)) @ vertices


@EXPLICIT_STEP.variant("vertex by vertex, as lists")
def _(vertices: FloatArray, L: Any, lam: float) -> Any:
    rows = truths.dense(L)
    return [(x + lam * (row @ vertices)).tolist() for x, row in zip(vertices, rows, strict=True)]


@EXPLICIT_STEP.mistake(
    "the sign is the wrong way round: the mesh grows rough",
    hint="Where does the uniform Laplacian of the positions point, seen from a peak?",
)
def _(vertices: FloatArray, L: Any, lam: float) -> Any:
    return vertices - lam * (L @ vertices)


@EXPLICIT_STEP.mistake("the step λ was not used", hint="What should a step of 0 do?")
def _(vertices: FloatArray, L: Any, lam: float) -> Any:
    return vertices + L @ vertices


@EXPLICIT_STEP.mistake(
    "the displacement was returned, without the positions",
    hint="What should a step of 0 do?",
)
def _(vertices: FloatArray, L: Any, lam: float) -> Any:
    return lam * (L @ vertices)


@EXPLICIT_STEP.mistake(
    "vertices use neighbours that have moved already",
    hint="All vertices move at the same time. Which positions does the last one of your loop see?",
)
def _(vertices: FloatArray, L: Any, lam: float) -> Any:
    moved, rows = vertices.copy(), truths.dense(L)
    for i, row in enumerate(rows):
        moved[i] += lam * (row @ moved)
    return moved


@EXPLICIT_STEP.mistake(
    "the step is implicit",
    hint="Does the explicit step solve a system?",
)
def _(vertices: FloatArray, L: Any, lam: float) -> Any:
    return np.linalg.solve(np.eye(len(vertices)) - lam * truths.dense(L), vertices)


# The bound --------------------------------------------------------------------------------------

STABLE_STEP = Exercise(
    reference.stable_step,
    notes="ch. 6 §13.4",
    hints=[
        "By what does one explicit step multiply a mode with the eigenvalue λ_i?",
        "That factor must not exceed 1 in size. Which mode breaks this first when the step grows?",
        "The eigenvalues are those of M⁻¹C. Symmetrise it before you ask for the largest one.",
    ],
    time_limit=4.0,
)


@STABLE_STEP.check("just below it every mode decays, just above it one grows", points=2)
def _(f: Asked, rng: Rng) -> None:
    for_all = [(closed(rng), "a closed mesh"), (bounded(rng), "a mesh with holes")]
    asked = [(*matrices(shape), on) for shape, on in for_all]
    answers = [f(C, M) for C, M, _ in asked]
    for value, (C, M, on) in zip(f.each(answers), asked, strict=True):
        step = expect.number(value, "The step", on=on)
        fastest = float(truths.modes(C, M)[0][-1])
        below, above = abs(1 - 0.999 * step * fastest), abs(1 - 1.001 * step * fastest)
        message = "A step a little below yours makes the fastest mode grow."
        expect.that(below <= 1.0, message, yours=f"{step:.6g}", on=on)
        message = "A step a little above yours is still stable: yours is not the bound."
        expect.that(above >= 1.0, message, yours=f"{step:.6g}", on=on)


@STABLE_STEP.check("a rectangle of sides a and a/2 in 25 cells: a²/250")
def _(f: Asked, rng: Rng) -> None:
    rectangle = grid(rng).transformed(np.diag([1.0, 0.5, 1.0]))
    sides = [float(rng.uniform(0.5, 2.0)), 0.01, 100.0]
    asked = [(*matrices(rectangle.scaled(side)), side) for side in sides]
    answers = [f(C, M) for C, M, _ in asked]
    for value, (_, _, side) in zip(f.each(answers), asked, strict=True):
        mine, on = expect.number(value, "The step"), f"a rectangle of sides {side:.3g} and {side / 2:.3g}"
        # The fastest mode changes its sign from vertex to vertex, along both axes: λ = −4/h² − 4/k² with
        # h = a/5 and k = a/10. A square would give 1/|λ| the size of the smallest cell's half.
        expect.close(mine, side**2 / 250, 1e-5 * side**2 / 250, "The largest stable step", on=on)


@STABLE_STEP.check("a regular solid on a sphere of radius R")
def _(f: Asked, rng: Rng) -> None:
    R = float(rng.uniform(0.5, 2.0))
    solids = [shapes.shuffled(solid, rng) for solid in (shapes.tetrahedron(R), shapes.octahedron(R))]
    asked = [(*matrices(solid), solid.name) for solid in solids]
    answers = [f(C, M) for C, M, _ in asked]
    # Tetrahedron: three neighbours, all other modes have λ = −2/R². Octahedron: the fastest has λ = −3/R².
    for value, (_, _, on), truth in zip(f.each(answers), asked, (R**2, 2 * R**2 / 3), strict=True):
        mine = expect.number(value, "The step", on=on)
        expect.close(mine, truth, 1e-5 * truth, "The largest stable step", on=on)


@STABLE_STEP.variant("by iterating with a random start, as an array")
def _(C: Any, M: Any) -> Any:
    from scipy.sparse.linalg import eigsh

    root = np.sqrt(M.diagonal())
    A = -truths.dense(C) / np.outer(root, root)
    return 2 / eigsh(A, 1, which="LA", return_eigenvectors=False, tol=1e-9, v0=np.cos(np.arange(len(A)) ** 2))


@STABLE_STEP.variant("the eigenvalues of the unsymmetric matrix")
def _(C: Any, M: Any) -> Any:
    return float(2 / np.abs(np.linalg.eigvals(truths.dense(C) / M.diagonal()[:, None])).max())


@STABLE_STEP.mistake(
    "the 2 is missing",
    hint="The factor of a mode may lie between −1 and 1. Where does it lie for your step?",
)
def _(C: Any, M: Any) -> Any:
    return 1 / truths.modes(C, M)[0][-1]


@STABLE_STEP.mistake(
    "the mass matrix was left out",
    hint="A step has the unit of an area. Which of C and M knows of lengths?",
)
def _(C: Any, M: Any) -> Any:
    return 2 / np.linalg.eigvalsh(-truths.dense(C))[-1]


@STABLE_STEP.mistake(
    "a solver for symmetric matrices was given M⁻¹C, which is not symmetric",
    hint="`eigvalsh` looks at one half of the matrix only, and takes the other to be the same.",
)
def _(C: Any, M: Any) -> Any:
    return 2 / np.abs(np.linalg.eigvalsh(truths.dense(C) / M.diagonal()[:, None])).max()


@STABLE_STEP.mistake(
    "the slowest mode was taken, not the fastest",
    hint="Which mode grows first when the step is too large: a smooth or a rough one?",
)
def _(C: Any, M: Any) -> Any:
    return 2 / truths.modes(C, M)[0][1]


@STABLE_STEP.mistake(
    "the bound is negative",
    hint="The eigenvalues of Δ are negative. And the step?",
)
def _(C: Any, M: Any) -> Any:
    return -2 / truths.modes(C, M)[0][-1]


@STABLE_STEP.mistake(
    "the fastest frequency itself was returned",
    hint="The finer the mesh, the larger the frequencies. And the stable step?",
)
def _(C: Any, M: Any) -> Any:
    return truths.modes(C, M)[0][-1]


@STABLE_STEP.mistake(
    "the largest diagonal entry was taken for the largest eigenvalue",
    hint="An eigenvalue can be larger than every entry of the diagonal. Is your step stable?",
)
def _(C: Any, M: Any) -> Any:
    return 2 / float((-C.diagonal() / M.diagonal()).max())


@STABLE_STEP.mistake(
    "the sum of the absolute values of a row was taken for the largest eigenvalue",
    hint="That sum is an upper bound for the eigenvalues (Gershgorin). Is a slightly larger step unstable?",
)
def _(C: Any, M: Any) -> Any:
    return 2 / float((np.abs(truths.dense(C)).sum(axis=1) / M.diagonal()).max())


# Implicit ---------------------------------------------------------------------------------------

IMPLICIT_STEP = Exercise(
    reference.implicit_step,
    notes="ch. 6 §13.5; coursework 2, question 6",
    hints=[
        "The Laplacian is taken of the new positions. Collect them on one side.",
        "Multiply by M, so that the matrix becomes symmetric. What stands on the right then?",
        "`scipy.sparse.linalg` has a direct solver, and conjugate gradients, which take a column at a time.",
    ],
    time_limit=4.0,
)


@IMPLICIT_STEP.check("a sphere stays a sphere, its radius divided by 1 + 2λ/R²", points=2)
def _(f: Asked, rng: Rng) -> None:
    R = float(rng.uniform(0.5, 2.0) * rng.choice([0.01, 1.0, 100.0]))
    solids = [turned(shapes.shuffled(s, rng), rng) for s in (shapes.tetrahedron(R), shapes.icosahedron(R))]
    lam = float(rng.uniform(0.5, 2.0) * R**2)
    answers = [f(s.vertices, *matrices(s), lam) for s in solids]
    for value, s in zip(f.each(answers), solids, strict=True):
        on = f"a regular {s.name} on a sphere of radius {R:.3g}, λ = {lam / R**2:.3g} R²"
        expecting.positions(value, s.vertices / (1 + 2 * lam / R**2), s, on=on)


@IMPLICIT_STEP.check("(M − λC)P′ = MP on any mesh, for small and huge steps", points=2)
def _(f: Asked, rng: Rng) -> None:
    holes, flat = bounded(rng), turned(patch(rng), rng)
    holes = holes.moved(-holes.vertices.mean(axis=0))
    asked = []
    for shape, factor in ((holes, 0.5), (flat, 50.0), (holes, 1e4)):
        C, M = matrices(shape)
        lam = factor * float(M.diagonal().mean())
        asked.append((f(shape.vertices, C, M, lam), shape, C, M, lam, factor))
    for f.about, (value, shape, C, M, lam, factor) in enumerate(asked):
        on, areas = f"a mesh with a boundary, λ of {factor:g} cells", M.diagonal()
        mine = expect.array(value, shape.vertices.shape, "The array of positions", on=on)
        residual = (M @ (mine - shape.vertices) - lam * (C @ mine)) / areas.mean()
        size = (float(areas.max()) + lam * float(abs(C).max())) / areas.mean()
        size *= max(float(np.abs(shape.vertices).max()), float(np.abs(mine).max()))
        what = "(M − λC)P′ − MP"
        shown = pictures.Field(mine, faces_of(shape), f"|{what}|")
        expect.close(residual, 0.0, ITERATED * size, what, on=on, shown=shown)


@IMPLICIT_STEP.check("the centre of a closed surface stays, however far from the origin")
def _(f: Asked, rng: Rng) -> None:
    shape = closed(rng)
    C, M = matrices(shape)
    areas = M.diagonal()
    value = f(shape.vertices, C, M, float(areas.mean() * rng.uniform(1.0, 10.0)))
    on = "a closed mesh far from the origin"
    mine = expect.array(value, shape.vertices.shape, "The array of positions", on=on)
    before, after = (areas @ x / areas.sum() for x in (shape.vertices, mine))
    picture = pictures.of_before_and_after(shape.vertices, mine, faces_of(shape))
    size = 10 * max(float(np.abs(shape.vertices).max()), float(np.abs(mine).max()))
    expect.close(after, before, ITERATED * size, "The centre of the surface", on=on, picture=picture)


@IMPLICIT_STEP.check("either solver: both give the same positions", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape = bounded(rng)
    shape = shape.moved(-shape.vertices.mean(axis=0))
    C, M = matrices(shape)
    # Large steps: the matrix is then far from one that conjugate gradients solve at once.
    lam = float(M.diagonal().mean() * rng.uniform(50.0, 500.0))
    answers = [f(shape.vertices, C, M, lam, solver=solver) for solver in ("cg", "cholesky")]
    truth = _step(shape.vertices, C, M, lam)
    for value, solver in zip(f.each(answers), ("cg", "cholesky"), strict=True):
        on = f'a mesh with holes, solver="{solver}"'
        mine = expect.array(value, truth.shape, "The array of positions", on=on)
        size = float(np.ptp(shape.vertices, axis=0).max())
        shown = pictures.Positions(shape.vertices, faces_of(shape))
        expect.close(mine, truth, ITERATED * size, "The positions", on=on, shown=shown)


@IMPLICIT_STEP.check("refuses a solver that there is not")
def _(f: Asked, rng: Rng) -> None:
    shape = sphere(rng)
    because = "there is no solver of the name 'gauss'"
    expect.refusal(f, shape.vertices, *matrices(shape), 0.1, solver="gauss", because=because)


def _step(P: FloatArray, C: Any, M: Any, lam: float) -> FloatArray:
    system = truths.dense(M) - lam * truths.dense(C)
    return np.asarray(np.linalg.solve(system, M @ P))


def _step_within(P: FloatArray, C: Any, M: Any, lam: float, factor: float) -> FloatArray:
    """Step with the boundary held at `factor` times its positions."""
    D, right = truths.dense(C), M @ P
    # The ends of an edge with a single face have one common neighbour, as a rule; others have two or more.
    linked = (D != 0) & ~np.eye(len(D), dtype=bool)
    common = (linked.astype(int) @ linked.astype(int)) * linked
    border = ((common == 1) & linked).any(axis=1)
    system = truths.dense(M) - lam * D
    system[border] = np.eye(len(D))[border]
    right[border] = factor * P[border]
    return np.asarray(np.linalg.solve(system, right))


def _refuse_other(solver: str) -> None:
    if solver not in ("cholesky", "cg"):
        raise ValueError(f"there is no solver {solver!r}")


@IMPLICIT_STEP.variant("a dense Cholesky factor")
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    factor = np.linalg.cholesky(truths.dense(M) - lam * truths.dense(C))
    return np.linalg.solve(factor.T, np.linalg.solve(factor, M @ vertices))


@IMPLICIT_STEP.variant("conjugate gradients, one coordinate at a time, as columns of a list")
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cg") -> Any:
    _refuse_other(solver)
    from scipy.sparse.linalg import cg

    right = (M @ vertices).T
    columns = [cg(M - lam * C, b, x0=x, rtol=1e-10)[0] for b, x in zip(right, vertices.T, strict=True)]
    return np.array(columns).T.tolist()


@IMPLICIT_STEP.variant("the unsymmetric form, in single precision")
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    L = truths.dense(C) / M.diagonal()[:, None]
    return np.linalg.solve(np.eye(len(L)) - lam * L, vertices).astype(np.float32)


@IMPLICIT_STEP.mistake(
    "the identity stands where the mass matrix belongs",
    hint="C is integrated over cells. What must stand beside it so that both have the same units?",
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    return np.linalg.solve(np.eye(len(vertices)) - lam * truths.dense(C), vertices)


@IMPLICIT_STEP.mistake(
    "the right-hand side was not multiplied by M",
    hint="What should a step of 0 do? And what does yours do?",
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    return np.linalg.solve(truths.dense(M) - lam * truths.dense(C), vertices)


@IMPLICIT_STEP.mistake(
    "the sign of C is the wrong way round",
    hint="C is negative semi-definite. Which sign makes the matrix positive definite?",
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    return _step(vertices, C, M, -lam)


@IMPLICIT_STEP.mistake(
    "the step is explicit",
    hint="Is the Laplacian taken of the old or of the new positions? Try a huge step.",
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    return vertices + lam * (C @ vertices) / M.diagonal()[:, None]


@IMPLICIT_STEP.mistake(
    "boundary rows were set to zero: the boundary collapses to the origin",
    hint="Nothing is fixed in this step. What does the row of a boundary vertex say?",
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    return _step_within(vertices, C, M, lam, 0.0)


@IMPLICIT_STEP.mistake(
    "the boundary was held where it was",
    hint="Nothing is fixed in this step. Where does Desbrun's equation put a vertex of the boundary?",
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    return _step_within(vertices, C, M, lam, 1.0)


@IMPLICIT_STEP.mistake(
    "only the first coordinate was smoothed",
    hint="Positions have three columns. What has happened to y and z?",
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    return np.column_stack([_step(vertices, C, M, lam)[:, 0], vertices[:, 1:]])


@IMPLICIT_STEP.mistake(
    "the same coordinate was solved for three times",
    hint="Three columns that are equal: which right-hand side does each round of your loop take?",
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    return np.repeat(_step(vertices, C, M, lam)[:, :1], 3, axis=1)


@IMPLICIT_STEP.mistake(
    "M was divided out once more: C stands beside M, divided by the areas",
    hint="Which matrix goes with M, C or M⁻¹C? Is yours symmetric?",
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    L = truths.dense(C) / M.diagonal()[:, None]
    return np.linalg.solve(truths.dense(M) - lam * L, M @ vertices)


@IMPLICIT_STEP.mistake(
    "conjugate gradients were given a matrix that is not symmetric",
    hint="Conjugate gradients are for symmetric positive definite matrices. Which form of the step has one?",
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    from scipy.sparse.linalg import cg

    _refuse_other(solver)
    if solver == "cholesky":
        return _step(vertices, C, M, lam)
    system = np.eye(len(vertices)) - lam * truths.dense(C) / M.diagonal()[:, None]
    return np.column_stack([cg(system, x)[0] for x in vertices.T])


@IMPLICIT_STEP.mistake(
    "conjugate gradients solved for the first coordinate only",
    hint="`cg` takes one right-hand side. How many has the step?",
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    _refuse_other(solver)
    after = _step(vertices, C, M, lam)
    return after if solver == "cholesky" else after[:, 0]


@IMPLICIT_STEP.mistake(
    "a solver that there is not was taken for the default",
    hint='Somebody writes `solver="colesky"`. What should your function do, and what does it do?',
)
def _(vertices: FloatArray, C: Any, M: Any, lam: float, *, solver: str = "cholesky") -> Any:
    return _step(vertices, C, M, lam)


# Whole flows ------------------------------------------------------------------------------------

MEAN_CURVATURE_FLOW = Exercise(
    reference.mean_curvature_flow,
    notes="ch. 6 §13.3, §13.5",
    hints=[
        "It is a loop of implicit steps, which you have.",
        "C and M belong to a surface. Which surface is it in the second step?",
    ],
    time_limit=4.0,
)

LINEAR_DIFFUSION = Exercise(
    reference.linear_diffusion,
    notes="ch. 6 §13.3, §13.5",
    hints=[
        "It is a loop of implicit steps, which you have.",
        "The matrix is the same in every step: what can be done once, before the loop?",
    ],
    time_limit=4.0,
)


def _volume(P: FloatArray, faces: IntArray) -> float:
    """Return the volume inside a closed surface, or refuse one with holes."""
    if truths.boundary_edges(faces):
        raise ValueError("the surface is open: it encloses no volume")
    return float(np.linalg.det(P[faces] - P.mean(axis=0)).sum() / 6)


def _grown(P: FloatArray, faces: IntArray, volume: float, power: float = 1 / 3) -> FloatArray:
    """Scale a surface about the mean of its vertices to enclose the volume."""
    centre = P.mean(axis=0)
    return np.asarray(centre + (volume / _volume(P, faces)) ** power * (P - centre))


def _flow(
    vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep: bool, volume: bool = False
) -> FloatArray:
    """Follow `steps` implicit steps, with matrices of the start (`keep`) or of each step.

    With `volume` the surface encloses as much after each step as at the start.
    """
    P = vertices
    start = _volume(P, faces) if volume else 0.0
    for i in range(steps):
        if i == 0 or not keep:
            C, areas = truths.stiffness(P, faces), truths.mixed_areas(P, faces)
        P = np.asarray(np.linalg.solve(np.diag(areas) - lam * C, areas[:, None] * P), dtype=float)
        P = _grown(P, faces, start) if volume else P
    return P


def _radius_after(R: float, lam: float, steps: int, *, keep: bool) -> float:
    """Return the radius of a regular solid after some steps: each divides it by 1 + 2λ/R²."""
    r = R
    for _ in range(steps):
        r /= 1 + 2 * lam / (R if keep else r) ** 2
    return r


def _declare_flow(exercise: Exercise, claim: str, keep: bool) -> None:
    @exercise.check(claim, points=2)
    def _(f: Asked, rng: Rng) -> None:
        R = float(rng.uniform(0.5, 2.0) * rng.choice([0.01, 1.0, 100.0]))
        solids = [turned(shapes.shuffled(s, rng), rng) for s in (shapes.tetrahedron(R), shapes.octahedron(R))]
        lam, steps = float(rng.uniform(0.05, 0.1) * R**2), int(rng.integers(3, 6))
        answers = [f(s.vertices, faces_of(s), lam, steps) for s in solids]
        for value, s in zip(f.each(answers), solids, strict=True):
            on = f"a regular {s.name} on a sphere of radius {R:.3g}, {steps} steps of {lam / R**2:.3g} R²"
            factor = _radius_after(R, lam, steps, keep=keep) / R
            expecting.positions(value, factor * s.vertices, s, on=on)

    @exercise.check("each step lowers the area" if not keep else "the energy −PᵀCP falls with each step")
    def _(f: Asked, rng: Rng) -> None:
        shape = sphere(rng)
        bumpy = shape.vertices * rng.uniform(0.9, 1.1, (len(shape.vertices), 1))
        faces, lam = faces_of(shape), float(rng.uniform(0.02, 0.05))
        answers = [f(bumpy, faces, lam, steps) for steps in (0, 1, 3)]
        on = "a bumpy sphere after 0, 1 and 3 steps"
        C = truths.stiffness(bumpy, faces)
        found = []
        for value in answers:
            mine = expect.array(value, bumpy.shape, "The array of positions", on=on)
            # With the matrices of the start it is the Dirichlet energy that falls.
            found.append(float(-(mine * (C @ mine)).sum() if keep else truths.face_areas(mine, faces).sum()))
        start = float(-(bumpy * (C @ bumpy)).sum() if keep else truths.face_areas(bumpy, faces).sum())
        what = "The energy" if keep else "The area"
        expect.close(found[0], start, SOLVED * start, f"{what} after 0 steps", on=on)
        falls = found[0] > found[1] > found[2] > 0
        yours = ", ".join(f"{value:.4g}" for value in found)
        expect.that(falls, f"{what} does not fall from step to step.", yours=yours, on=on)

    @exercise.check("two steps on a mesh with holes and obtuse angles")
    def _(f: Asked, rng: Rng) -> None:
        shape = bounded(rng)
        shape = shape.moved(-shape.vertices.mean(axis=0))
        faces = faces_of(shape)
        # Small steps: large ones collapse the cells of a flow that measures them anew.
        lam = float(0.02 * truths.mixed_areas(shape.vertices, faces).min())
        value = f(shape.vertices, faces, lam, 2)
        truth = _flow(shape.vertices, faces, lam, 2, keep=keep)
        expecting.positions(value, truth, shape, on="a mesh with holes")

    @exercise.variant("dense matrices")
    def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
        return _flow(vertices, faces, lam, steps, keep=keep, volume=keep_volume)

    @exercise.variant("the inverse of I − λM⁻¹C, in single precision at the end")
    def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
        P, surface = vertices, vertices
        start = _volume(P, faces) if keep_volume else 0.0
        for _ in range(steps):
            surface = vertices if keep else P
            P = np.linalg.inv(np.eye(len(P)) - lam * truths.laplacian(surface, faces)) @ P
            P = _grown(P, faces, start) if keep_volume else P
        return P.astype(np.float32)

    _declare_mistakes_of_flow(exercise, keep)


def _declare_mistakes_of_flow(exercise: Exercise, keep: bool) -> None:
    other = (
        (
            "the matrices were made anew in every step: this is mean-curvature flow",
            "Which surface are C and M of, here? What makes one factorisation enough for all steps?",
        )
        if keep
        else (
            "the matrices of the start were kept: this is linear diffusion",
            "The surface changes with every step. Do your C and M?",
        )
    )

    @exercise.mistake(other[0], hint=other[1])
    def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
        return _flow(vertices, faces, lam, steps, keep=not keep, volume=keep_volume)

    @exercise.mistake(
        "one step of the whole time was made",
        hint="Is one implicit step of 3λ the same as three of λ? Try it on a sphere.",
    )
    def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
        return _flow(vertices, faces, lam * steps, min(steps, 1), keep=keep, volume=keep_volume)

    @exercise.mistake(
        "λ was divided by the number of steps",
        hint="Is λ the time of all steps together, or of each one?",
    )
    def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
        return _flow(vertices, faces, lam / max(steps, 1), steps, keep=keep, volume=keep_volume)

    @exercise.mistake(
        "every step started from the first positions",
        hint="What does the second step of your loop start from?",
    )
    def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
        return _flow(vertices, faces, lam, min(steps, 1), keep=keep, volume=keep_volume)

    @exercise.mistake(
        "the steps are explicit",
        hint="Is the Laplacian taken of the positions before the step, or after it?",
    )
    def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
        P = surface = vertices
        start = _volume(P, faces) if keep_volume else 0.0
        for _ in range(steps):
            P = np.asarray(P + lam * truths.laplacian(surface, faces) @ P)
            P = _grown(P, faces, start) if keep_volume else P
            surface = surface if keep else P
        return P

    @exercise.mistake("one step too many was made", hint="How many times does your loop run for `steps = 0`?")
    def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
        return _flow(vertices, faces, lam, steps + 1, keep=keep, volume=keep_volume)

    @exercise.mistake(
        "the surface flows backwards",
        hint="Which sign of C makes the matrix positive definite? A sphere should shrink.",
    )
    def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
        return _flow(vertices, faces, -lam, steps, keep=keep, volume=keep_volume)

    @exercise.mistake(
        "the uniform Laplacian was used",
        hint="The uniform Laplacian knows nothing of lengths. Do spheres of any size shrink alike?",
    )
    def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
        L, P = truths.mean_of_neighbours(faces, len(vertices)), vertices
        start = _volume(P, faces) if keep_volume else 0.0
        for _ in range(steps):
            P = np.asarray(np.linalg.solve(np.eye(len(P)) - lam * L, P), dtype=float)
            P = _grown(P, faces, start) if keep_volume else P
        return P


_declare_flow(
    MEAN_CURVATURE_FLOW, "a sphere shrinks faster and faster: each step divides r by 1 + 2λ/r²", keep=False
)
_declare_flow(
    LINEAR_DIFFUSION,
    "a sphere shrinks by the same factor 1 + 2λ/R² in each step, R that of the start",
    keep=True,
)


def _half_anew(
    vertices: FloatArray, faces: IntArray, lam: float, steps: int, volume: bool, *, areas_anew: bool
) -> FloatArray:
    """Follow a flow in which only the areas are measured anew, or only C."""
    P, start = vertices, _volume(vertices, faces) if volume else 0.0
    for _ in range(steps):
        C = truths.stiffness(vertices if areas_anew else P, faces)
        areas = truths.mixed_areas(P if areas_anew else vertices, faces)
        P = np.asarray(np.linalg.solve(np.diag(areas) - lam * C, areas[:, None] * P), dtype=float)
        P = _grown(P, faces, start) if volume else P
    return P


@MEAN_CURVATURE_FLOW.mistake(
    "C was made anew in every step, but M was not",
    hint="The surface shrinks. What becomes of the areas of its cells?",
)
def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
    return _half_anew(vertices, faces, lam, steps, keep_volume, areas_anew=False)


@MEAN_CURVATURE_FLOW.mistake(
    "M was made anew in every step, but C was not",
    hint="A sphere keeps its angles as it shrinks. Does every surface? Which matrix holds them?",
)
def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
    return _half_anew(vertices, faces, lam, steps, keep_volume, areas_anew=True)


# Keeping the volume, of the flow by mean curvature only.


@MEAN_CURVATURE_FLOW.check("with keep_volume, as much is inside after each step as before", points=2)
def _(f: Asked, rng: Rng) -> None:
    ball = sphere(rng, float(rng.choice([0.01, 1.0, 100.0])))
    size = float(np.ptp(ball.vertices, axis=0).max())
    bumpy = ball.vertices * rng.uniform(0.8, 1.2, (len(ball.vertices), 1)) + size * rng.uniform(1, 2, 3)
    faces, lam = faces_of(ball), 0.003 * size**2
    shape = replace(ball, vertices=bumpy)
    answers = [f(bumpy, faces, lam, steps, keep_volume=True) for steps in (1, 4)]
    start = _volume(bumpy, faces)
    for value, steps in zip(f.each(answers), (1, 4), strict=True):
        on = f"a bumpy sphere, steps={steps}, keep_volume=True"
        mine = expect.array(value, bumpy.shape, "The array of positions", on=on)
        truth = _flow(bumpy, faces, lam, steps, keep=False, volume=True)
        own = pictures.of_before_and_after(bumpy, mine, faces)
        expect.close(_volume(mine, faces), start, 100 * SOLVED * start, "The volume", on=on, picture=own)
        # Whichever centre it is scaled about: that moves the surface, and by little.
        moved = mine.mean(axis=0) - bumpy.mean(axis=0)
        message = "The surface has moved: it was not scaled about its centre."
        expect.that(float(np.abs(moved).max()) <= 0.1 * size, message, on=on, picture=own)
        expecting.positions(mine + (truth - mine).mean(axis=0), truth, shape, on=on)


@MEAN_CURVATURE_FLOW.check("with keep_volume, refuses a surface with holes")
def _(f: Asked, rng: Rng) -> None:
    shape = bounded(rng)
    faces = faces_of(shape)
    lam = 0.02 * float(truths.mixed_areas(shape.vertices, faces).min())
    because = "a surface with holes encloses no volume that could be kept"
    expect.refusal(f, shape.vertices, faces, lam, 1, keep_volume=True, because=because)


@MEAN_CURVATURE_FLOW.mistake(
    "`keep_volume` was not used",
    hint="How much is inside the surface before the flow, and how much after it?",
)
def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
    if keep_volume:
        _volume(vertices, faces)
    return _flow(vertices, faces, lam, steps, keep=False)


@MEAN_CURVATURE_FLOW.mistake(
    "a surface with holes was not refused where its volume should be kept",
    hint="Water runs out of a surface with holes. What is the volume inside it?",
)
def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
    keep = keep_volume and not truths.boundary_edges(faces)
    return _flow(vertices, faces, lam, steps, keep=False, volume=keep)


@MEAN_CURVATURE_FLOW.mistake(
    "the surface was scaled by the ratio of the volumes, not by its cube root",
    hint="When all lengths are doubled, what becomes of the volume?",
)
def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
    if not keep_volume:
        return _flow(vertices, faces, lam, steps, keep=False)
    P, start = vertices, _volume(vertices, faces)
    for _ in range(steps):
        P = _grown(_flow(P, faces, lam, 1, keep=False), faces, start, power=1.0)
    return P


@MEAN_CURVATURE_FLOW.mistake(
    "the surface was scaled about the origin",
    hint="Where does a surface far from the origin go when all its coordinates are doubled?",
)
def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
    P = vertices
    start = _volume(P, faces) if keep_volume else 0.0
    for _ in range(steps):
        P = _flow(P, faces, lam, 1, keep=False)
        P = np.cbrt(start / _volume(P, faces)) * P if keep_volume else P
    return P


@MEAN_CURVATURE_FLOW.mistake(
    "the surface was scaled once, after the last step",
    hint="A small sphere shrinks faster than a large one. What does the flow do until you scale?",
)
def _(vertices: FloatArray, faces: IntArray, lam: float, steps: int, *, keep_volume: bool = False) -> Any:
    start = _volume(vertices, faces) if keep_volume else 0.0
    P = _flow(vertices, faces, lam, steps, keep=False)
    return _grown(P, faces, start) if keep_volume else P
