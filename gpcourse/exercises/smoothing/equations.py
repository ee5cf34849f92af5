"""Exercises on equations: Laplace, Poisson and heat."""

from __future__ import annotations

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
    inside,
    matrices,
    patch,
)
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.reference import smoothing as reference

#: What solving may lose besides the last digits of single precision: the condition numbers of these small
#: systems stay below 1e4.
SOLVED = 5 * SINGLE

#: What `expecting.values` compares with, per size of the solution. Conjugate gradients, as SciPy
#: stops them, were off by up to 5e-5 of it on 60 seeds.
BY_GRADIENTS = 1e-4 / SINGLE

# Laplace ----------------------------------------------------------------------------------------

SOLVE_LAPLACE = Exercise(
    reference.solve_laplace,
    notes="ch. 6 §9",
    hints=[
        "Cut the system into the rows and columns of the given vertices and those of the others.",
        "Only the rows of the others are equations. What stands in them for the given values?",
        "What is known goes to the right-hand side, with its sign changed.",
        "`np.setdiff1d` finds the other vertices; `C[free][:, free]` is their part of the matrix.",
    ],
)


@SOLVE_LAPLACE.check("linear values at the boundary of a flat patch make a linear function", points=2)
def _(f: Asked, rng: Rng) -> None:
    flat, slope = patch(rng), rng.normal(size=3)
    C, _M = matrices(flat)
    boundary = rng.permutation(np.flatnonzero(~inside(flat)))
    truth = flat.vertices @ slope + rng.normal()
    value = f(C, boundary, truth[boundary])
    size = float(np.abs(truth).max())
    expecting.values(value, truth, flat, "f", on="a flat irregular patch", scale=BY_GRADIENTS * size)


@SOLVE_LAPLACE.check("on a square, x² − y², and never more than the largest value at the boundary")
def _(f: Asked, rng: Rng) -> None:
    square = grid(rng)
    C, _M = matrices(square)
    boundary = rng.permutation(np.flatnonzero(~inside(square)))
    x, y, _z = square.vertices.T
    truth, noise = x**2 - y**2, rng.uniform(-1.0, 1.0, len(boundary))
    harmonic, rough = f(C, boundary, truth[boundary]), f(C, boundary, noise)
    f.about = 0
    expecting.values(harmonic, truth, square, "f", on="a square with x² − y² at its boundary", scale=5.0)
    f.about, on = 1, "a square with random values at its boundary"
    mine = expect.array(rough, (len(x),), "f", on=on)
    beyond = np.maximum(mine - noise.max(), noise.min() - mine)
    picture = pictures.of_own(square.vertices, faces_of(square), np.maximum(beyond, 0), "beyond the given")
    message = "Away from the given values, f goes beyond the largest or the smallest of them."
    expect.that(float(beyond.max()) <= SOLVED, message, on=on, picture=picture)


@SOLVE_LAPLACE.check("Cf = 0 wherever nothing is given, and the given values are kept", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape = closed(rng)
    C, _M = matrices(shape)
    n, on = len(shape.vertices), "a closed mesh with three columns of values at seven vertices"
    fixed = rng.permutation(n)[:7]
    given = rng.normal(size=(7, 3))
    mine = expect.array(f(C, fixed, given), (n, 3), "f", on=on)
    kept = np.zeros((n, 3))
    kept[fixed] = mine[fixed] - given
    place = shape.vertices, faces_of(shape)
    shown = pictures.Field(*place, "|f − given|", mine)
    expect.close(kept, 0.0, SINGLE * 5, "f minus the given value at a given vertex", on=on, shown=shown)
    free = np.setdiff1d(np.arange(n), fixed)
    residual = np.zeros((n, 3))
    residual[free] = (C @ mine)[free]
    size = float(abs(C).max()) * max(1.0, float(np.abs(mine).max()))
    shown = pictures.Field(*place, "|Cf|", mine, "|f|")
    expect.close(residual, 0.0, SOLVED * size, "Cf", on=on, shown=shown)


def _parts(C: Any, boundary: IntArray) -> tuple[FloatArray, IntArray]:
    D = truths.dense(C)
    return D, np.setdiff1d(np.arange(len(D)), boundary)


def _with_fixed(C: Any, b: FloatArray, fixed: IntArray, values: FloatArray) -> FloatArray:
    """Solve Cf = b in the rows that are not fixed."""
    D, free = _parts(C, fixed)
    f = np.zeros((len(D), *values.shape[1:]))
    f[fixed] = values
    f[free] = np.linalg.solve(D[np.ix_(free, free)], b[free] - D[np.ix_(free, fixed)] @ values)
    return f


@SOLVE_LAPLACE.variant("rows of the identity at the given vertices")
def _(C: Any, boundary: IntArray, values: FloatArray) -> Any:
    D = truths.dense(C)
    D[boundary] = np.eye(len(D))[boundary]
    b = np.zeros((len(D), *values.shape[1:]))
    b[boundary] = values
    return np.linalg.solve(D, b)


@SOLVE_LAPLACE.variant("a sparse solve of the inner part, in single precision")
def _(C: Any, boundary: IntArray, values: FloatArray) -> Any:
    from scipy.sparse.linalg import spsolve

    free = np.setdiff1d(np.arange(C.shape[0]), boundary)
    f = np.zeros((C.shape[0], *values.shape[1:]))
    f[boundary] = values
    f[free] = spsolve(C[free][:, free].tocsc(), -(C[free][:, boundary] @ values)).reshape(f[free].shape)
    return f.astype(np.float32)


@SOLVE_LAPLACE.variant("a soft constraint that is very stiff")
def _(C: Any, boundary: IntArray, values: FloatArray) -> Any:
    D = truths.dense(C)
    b = np.zeros((len(D), *values.shape[1:]))
    D[boundary, boundary] -= 1e9
    b[boundary] = -1e9 * values
    return np.linalg.solve(D, b)


@SOLVE_LAPLACE.mistake(
    "the given values went to the right-hand side with the wrong sign",
    hint="A term that crosses the equals sign changes its sign. Compare the inner values with those around.",
)
def _(C: Any, boundary: IntArray, values: FloatArray) -> Any:
    f = -_with_fixed(C, np.zeros((C.shape[0], *values.shape[1:])), boundary, values)
    f[boundary] = values
    return f


@SOLVE_LAPLACE.mistake(
    "the given values are not felt by the others: the right-hand side is zero",
    hint="What does the equation of a vertex beside the boundary say about the boundary's values?",
)
def _(C: Any, boundary: IntArray, values: FloatArray) -> Any:
    f = np.zeros((C.shape[0], *values.shape[1:]))
    f[boundary] = values
    return f


@SOLVE_LAPLACE.mistake(
    "the given values were not put into the result",
    hint="What should f be at a vertex whose value is given?",
)
def _(C: Any, boundary: IntArray, values: FloatArray) -> Any:
    f = _with_fixed(C, np.zeros((C.shape[0], *values.shape[1:])), boundary, values)
    f[boundary] = 0.0
    return f


@SOLVE_LAPLACE.mistake(
    "rows and right-hand side of the given vertices were set to zero: the boundary collapses to 0",
    hint="A row of zeros says 0 = 0. What should the row of a given vertex say?",
)
def _(C: Any, boundary: IntArray, values: FloatArray) -> Any:
    return np.zeros((C.shape[0], *values.shape[1:]))


@SOLVE_LAPLACE.mistake(
    "the values were put at the given vertices in ascending order",
    hint="`values[i]` belongs to vertex `boundary[i]`. Does a mask keep the order of `boundary`?",
)
def _(C: Any, boundary: IntArray, values: FloatArray) -> Any:
    return _with_fixed(C, np.zeros((C.shape[0], *values.shape[1:])), np.sort(boundary), values)


@SOLVE_LAPLACE.mistake(
    "the equations at the given vertices were kept beside their values, as least squares",
    hint="More equations than unknowns: which of them does the Laplace equation not ask for?",
)
def _(C: Any, boundary: IntArray, values: FloatArray) -> Any:
    D, free = _parts(C, boundary)
    f = np.zeros((len(D), *values.shape[1:]))
    f[boundary] = values
    f[free] = np.linalg.lstsq(D[:, free], -D[:, boundary] @ values, rcond=None)[0]
    return f


# Poisson ----------------------------------------------------------------------------------------

SOLVE_POISSON = Exercise(
    reference.solve_poisson,
    notes="ch. 6 §9",
    hints=[
        "Multiply Δf = g by the mass matrix: what is on the left, what on the right?",
        "With given values it is the Laplace equation with another right-hand side.",
        "On a closed surface all rows of C together are zero. What must the right-hand sides sum to, then?",
        "Fix one vertex at 0 and solve; then add the constant that makes the integral of f zero.",
    ],
)


@SOLVE_POISSON.check("on a closed surface, the solution of zero mean", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape = closed(rng)
    C, M = matrices(shape)
    areas = M.diagonal()
    truth = rng.normal(size=len(areas))
    truth -= (areas @ truth) / areas.sum()
    value = f(C, M, (C @ truth) / areas)
    on = "a closed mesh"
    mine = expect.array(value, truth.shape, "f", on=on)
    mean = float(areas @ mine / areas.sum())
    size = max(1.0, float(np.abs(mine).max()))
    expect.close(mean, 0.0, SOLVED * size, "The mean of f over the surface", on=on)
    expecting.values(mine, truth, shape, "f", on=on, scale=BY_GRADIENTS * float(np.abs(truth).max()))


@SOLVE_POISSON.check("with given values: Δf = 4 and x² + y² at the boundary of a square", points=2)
def _(f: Asked, rng: Rng) -> None:
    square = grid(rng)
    size = float(rng.choice([0.01, 1.0, 100.0]))
    C, M = matrices(square.scaled(size))
    boundary = rng.permutation(np.flatnonzero(~inside(square)))
    x, y, _z = size * square.vertices.T
    truth = x**2 + y**2
    value = f(C, M, np.full(len(x), 4.0), boundary, truth[boundary])
    on = f"a square of side {size:g}"
    expecting.values(value, truth, square, "f", on=on, scale=5 * size**2)


@SOLVE_POISSON.check("Cf = Mg on any mesh, with values given at a few vertices")
def _(f: Asked, rng: Rng) -> None:
    shape = bounded(rng)
    C, M = matrices(shape)
    n, on = len(shape.vertices), "a mesh with holes, values given at five vertices"
    fixed, given = rng.permutation(n)[:5], rng.normal(size=5)
    g = rng.normal(size=n) / M.diagonal().mean()
    mine = expect.array(f(C, M, g, fixed, given), (n,), "f", on=on)
    kept = np.zeros(n)
    kept[fixed] = mine[fixed] - given
    place = shape.vertices, faces_of(shape)
    shown = pictures.Field(*place, "f − given", mine)
    expect.close(kept, 0.0, SINGLE * 5, "f minus the given value at a given vertex", on=on, shown=shown)
    residual = C @ mine - M @ g
    residual[fixed] = 0.0
    size = float(abs(C).max()) * max(1.0, float(np.abs(mine).max()))
    shown = pictures.Field(*place, "Cf − Mg", mine, "f")
    expect.close(residual, 0.0, SOLVED * size, "Cf − Mg", on=on, shown=shown)


@SOLVE_POISSON.check("refuses a right-hand side whose integral over a closed surface is not zero")
def _(f: Asked, rng: Rng) -> None:
    shape = closed(rng)
    C, M = matrices(shape)
    g = 1.0 + rng.uniform(0.0, 1.0, len(shape.vertices))
    because = "g is positive all over a closed surface: its integral is not zero, and there is no solution"
    expect.refusal(f, C, M, g, because=because, on="a closed mesh")


def _poisson(
    C: Any,
    b: FloatArray,
    M: Any,
    boundary: IntArray | None,
    values: FloatArray | None,
    *,
    strict: bool = True,
) -> FloatArray:
    """Solve Cf = b, with zero integral where nothing is given."""
    if boundary is not None and values is not None:
        return _with_fixed(C, b, boundary, values)
    if strict and not abs(float(b.sum())) <= 1e-8 * float(np.abs(b).sum()):
        raise ValueError("the integral of g is not zero; subtract its mean")
    f = _with_fixed(C, b, np.array([0]), np.zeros(1))
    areas = M.diagonal()
    return np.asarray(f - areas @ f / areas.sum())


@SOLVE_POISSON.variant("the pseudo-inverse, and a clear error of another class")
def _(
    C: Any, M: Any, g: FloatArray, boundary: IntArray | None = None, values: FloatArray | None = None
) -> Any:
    if boundary is not None:
        return _poisson(C, M @ g, M, boundary, values)
    areas = M.diagonal()
    if abs(areas @ g) > 1e-6 * (areas @ np.abs(g)):
        raise np.linalg.LinAlgError("no solution: the integral of g over the closed surface must be 0")
    f = np.linalg.pinv(truths.dense(C)) @ (areas * g)
    return f - areas @ f / areas.sum()


@SOLVE_POISSON.variant("one more equation for the mean, as a column in single precision")
def _(
    C: Any, M: Any, g: FloatArray, boundary: IntArray | None = None, values: FloatArray | None = None
) -> Any:
    if boundary is not None:
        return _poisson(C, M @ g, M, boundary, values)[:, None].astype(np.float32)
    areas = M.diagonal()
    b = areas * g
    if abs(b.sum()) > 1e-8 * np.abs(b).sum():
        raise ValueError("no solution")
    border = (areas / areas.mean())[:, None]
    system = np.block([[truths.dense(C), border], [border.T, np.zeros((1, 1))]])
    return np.linalg.solve(system, np.append(b, 0.0))[:-1, None].astype(np.float32)


@SOLVE_POISSON.mistake(
    "the right-hand side was not multiplied by M",
    hint="C is integrated over cells, g is given at points. What makes the two comparable?",
)
def _(
    C: Any, M: Any, g: FloatArray, boundary: IntArray | None = None, values: FloatArray | None = None
) -> Any:
    return _poisson(C, np.asarray(g), M, boundary, values, strict=False)


@SOLVE_POISSON.mistake(
    "the sign of the right-hand side is the wrong way round",
    hint="Δf = 4 for x² + y², which bends upwards. Does your solution?",
)
def _(
    C: Any, M: Any, g: FloatArray, boundary: IntArray | None = None, values: FloatArray | None = None
) -> Any:
    return _poisson(C, -(M @ g), M, boundary, values)


@SOLVE_POISSON.mistake(
    "the mean over the vertices was taken away, not the mean over the surface",
    hint="A vertex with a large cell stands for more of the surface. Which mean is zero in the docstring?",
)
def _(
    C: Any, M: Any, g: FloatArray, boundary: IntArray | None = None, values: FloatArray | None = None
) -> Any:
    f = _poisson(C, M @ g, M, boundary, values)
    return f if boundary is not None else f - f.mean()


@SOLVE_POISSON.mistake(
    "one vertex was held at 0, and the mean was not taken away afterwards",
    hint="A constant can be added to every solution on a closed surface. Which solution is asked for?",
)
def _(
    C: Any, M: Any, g: FloatArray, boundary: IntArray | None = None, values: FloatArray | None = None
) -> Any:
    f = _poisson(C, M @ g, M, boundary, values)
    return f if boundary is not None else f - f[0]


@SOLVE_POISSON.mistake(
    "a right-hand side without a solution was not refused",
    hint="Add up all rows of Cf = Mg on a closed surface. What does that say about g?",
)
def _(
    C: Any, M: Any, g: FloatArray, boundary: IntArray | None = None, values: FloatArray | None = None
) -> Any:
    return _poisson(C, M @ g, M, boundary, values, strict=False)


@SOLVE_POISSON.mistake(
    "the given values were taken to be zero",
    hint="What is f at a vertex whose value is given? And what do its neighbours feel?",
)
def _(
    C: Any, M: Any, g: FloatArray, boundary: IntArray | None = None, values: FloatArray | None = None
) -> Any:
    return _poisson(C, M @ g, M, boundary, None if values is None else np.zeros_like(values))


@SOLVE_POISSON.mistake(
    "g was taken to be zero where values are given: this solves the Laplace equation",
    hint="What is the Laplacian of your f inside the square?",
)
def _(
    C: Any, M: Any, g: FloatArray, boundary: IntArray | None = None, values: FloatArray | None = None
) -> Any:
    return _poisson(C, M @ g if boundary is None else np.zeros(len(g)), M, boundary, values)


# Heat -------------------------------------------------------------------------------------------

HEAT_STEP = Exercise(
    reference.heat_step,
    notes="ch. 6 §9, §13",
    hints=[
        "Write the time derivative as a difference quotient, and the Laplacian at the end of the step.",
        "f′ = f + t Δf′. Bring f′ to the left and multiply by M: the matrix is then symmetric.",
        "One sparse solve does it, for several columns at once too.",
    ],
)


@HEAT_STEP.check("a mode of frequency ω is divided by 1 + tω", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape = closed(rng)
    C, M = matrices(shape)
    frequencies, phi = truths.modes(C, M)
    i = int(rng.integers(1, 8))
    t = float(rng.uniform(0.5, 2.0) / frequencies[i])
    mode = phi[:, i] / np.abs(phi[:, i]).max()
    value = f(C, M, mode, t)
    on = f"mode {i} of a closed mesh, t = {t * frequencies[i]:.3g}/ω"
    expecting.values(value, mode / (1 + t * frequencies[i]), shape, "f′", on=on, scale=100.0)


@HEAT_STEP.check("no heat is lost: the integral of f stays, and a constant does")
def _(f: Asked, rng: Rng) -> None:
    shape = bounded(rng)
    C, M = matrices(shape)
    n, areas = len(shape.vertices), M.diagonal()
    start, t = rng.uniform(0.0, 1.0, n), float(areas.mean() * rng.uniform(0.5, 5.0))
    answers = [f(C, M, start, t), f(C, M, np.full(n, 2.0), t)]
    f.about, on = 0, "a mesh with holes"
    mine = expect.array(answers[0], (n,), "f′", on=on)
    total = float(areas @ start)
    expect.close(float(areas @ mine), total, ITERATED * float(areas.sum()), "The integral of f′", on=on)
    f.about = 1
    expecting.values(answers[1], np.full(n, 2.0), shape, "f′", on=f"f = 2 all over {on}", scale=100.0)


@HEAT_STEP.check("(M − tC) f′ = M f, for several columns, and for a huge t", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape = bounded(rng)
    C, M = matrices(shape)
    n, areas = len(shape.vertices), M.diagonal()
    start = rng.normal(size=(n, 2))
    steps = [float(areas.mean() * factor) for factor in (1.0, 1e4)]
    answers = [f(C, M, start, t) for t in steps]
    for value, t, on in zip(f.each(answers), steps, ("t as large as a cell", "a huge t"), strict=True):
        mine = expect.array(value, (n, 2), "f′", on=on)
        residual = (M @ (mine - start) - t * (C @ mine)) / areas.mean()
        size = (float(areas.max()) + t * float(abs(C).max())) / areas.mean()
        what = "(M − tC)f′ − Mf"
        shown = pictures.Field(shape.vertices, faces_of(shape), f"|{what}|", mine, "|f′|")
        expect.close(residual, 0.0, ITERATED * size * max(1.0, np.abs(mine).max()), what, on=on, shown=shown)


@HEAT_STEP.check("what is hottest cools: nothing beyond the extremes before, on a square")
def _(f: Asked, rng: Rng) -> None:
    square = grid(rng)
    C, M = matrices(square)
    start = rng.uniform(0.0, 1.0, len(square.vertices))
    on = "a square of right triangles"
    mine = expect.array(f(C, M, start, 0.5), start.shape, "f′", on=on)
    beyond = np.maximum(mine - start.max(), start.min() - mine)
    picture = pictures.of_own(square.vertices, faces_of(square), np.maximum(beyond, 0), "beyond")
    message = "After the step there are values beyond the largest or the smallest before it."
    expect.that(float(beyond.max()) <= ITERATED, message, on=on, picture=picture)


def _heat(system: FloatArray, right: FloatArray) -> Any:
    return np.linalg.solve(system, right)


@HEAT_STEP.variant("a dense solve")
def _(C: Any, M: Any, f: FloatArray, t: float) -> Any:
    return _heat(truths.dense(M) - t * truths.dense(C), M @ f)


@HEAT_STEP.variant("the unsymmetric form (I − tL) f′ = f, in single precision")
def _(C: Any, M: Any, f: FloatArray, t: float) -> Any:
    L = truths.dense(C) / M.diagonal()[:, None]
    return _heat(np.eye(len(L)) - t * L, f).astype(np.float32)


@HEAT_STEP.variant("by modes")
def _(C: Any, M: Any, f: FloatArray, t: float) -> Any:
    frequencies, phi = truths.modes(C, M)
    return phi @ ((phi.T @ (M @ f)).T / (1 + t * frequencies)).T


@HEAT_STEP.mistake(
    "the identity stands where the mass matrix belongs",
    hint="C is integrated over cells. What must stand beside it so that both have the same units?",
)
def _(C: Any, M: Any, f: FloatArray, t: float) -> Any:
    return _heat(np.eye(len(f)) - t * truths.dense(C), f)


@HEAT_STEP.mistake(
    "the right-hand side was not multiplied by M",
    hint="What does your step do to a constant?",
)
def _(C: Any, M: Any, f: FloatArray, t: float) -> Any:
    return _heat(truths.dense(M) - t * truths.dense(C), f)


@HEAT_STEP.mistake(
    "the sign of C is the wrong way round: heat gathers",
    hint="C is negative semi-definite. Which sign makes the matrix positive definite?",
)
def _(C: Any, M: Any, f: FloatArray, t: float) -> Any:
    return _heat(truths.dense(M) + t * truths.dense(C), M @ f)


@HEAT_STEP.mistake(
    "the step is explicit",
    hint="Is the Laplacian taken of f or of f′? What does your step do for a huge t?",
)
def _(C: Any, M: Any, f: FloatArray, t: float) -> Any:
    return f + t * ((C @ f).T / M.diagonal()).T


@HEAT_STEP.mistake(
    "the heat flowed as it really does, e^(−ωt) for each mode",
    hint="That is what many small steps tend to. By what does a single implicit step multiply a mode?",
)
def _(C: Any, M: Any, f: FloatArray, t: float) -> Any:
    frequencies, phi = truths.modes(C, M)
    return phi @ ((phi.T @ (M @ f)).T * np.exp(-t * frequencies)).T


@HEAT_STEP.mistake(
    "t was not used",
    hint="What should a step with t = 0 do? And what does yours do?",
)
def _(C: Any, M: Any, f: FloatArray, t: float) -> Any:
    return _heat(truths.dense(M) - truths.dense(C), M @ f)
