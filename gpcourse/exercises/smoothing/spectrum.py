"""Exercises on the modes of the Laplacian and what is made of them."""

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
    grid,
    matrices,
    sphere,
)
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import FloatArray
from gpcourse.reference import smoothing as reference

#: Iterative solvers stop somewhere, and single precision adds up over the vertices.
MODES = 1e-5


def _without_basis(arguments: tuple[Any, ...], value: Any) -> Any:
    """Canonical form of modes: their frequencies, and what they span, whatever signs and bases."""
    frequencies, phi = (truths.dense(part) for part in value)
    largest = max(float(np.abs(frequencies).max()), 1e-300)
    return [frequencies, (phi / (1 + np.abs(frequencies) / largest)) @ phi.T]


EIGENMODES = Exercise(
    reference.eigenmodes,
    notes="ch. 6 §9, §12",
    hints=[
        "M⁻¹C is not symmetric. What do the notes (§9) put on both sides of C to make it so?",
        "`numpy.linalg.eigh` and `scipy.sparse.linalg.eigsh` are for symmetric matrices. "
        "Which end of the spectrum do you want?",
        "The vectors that you get are ξ. What is φ, and in which inner product is it of length 1?",
    ],
    canonical=_without_basis,
    time_limit=4.0,
)


def _modes(value: Any, n: int, k: int, on: str) -> tuple[FloatArray, FloatArray]:
    frequencies, phi = expecting.pair(value, "(frequencies, phi)", on=on)
    return (
        expect.array(frequencies, (k,), "The array of frequencies", on=on),
        expect.array(phi, (n, k), "The array of modes", on=on),
    )


@EIGENMODES.check("Cφ = −ωMφ, the φ orthonormal in M, the ω ascending from 0", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape, k = bounded(rng), int(rng.integers(5, 9))
    C, M = matrices(shape)
    n, on = len(shape.vertices), f"a mesh with holes, k = {k}"
    frequencies, phi = _modes(f(C, M, k), n, k, on)
    truth, _vectors = truths.modes(C, M)
    size = float(truth[k])
    expect.close(frequencies, np.sort(frequencies), MODES * size, "The frequencies, sorted,", on=on)
    expect.close(frequencies, truth[:k], MODES * size, "The frequencies", on=on)
    products = phi.T @ (M @ phi)
    shown: pictures.Shown = pictures.Modes(shape.vertices, faces_of(shape), phi, M.diagonal())
    expect.close(products, np.eye(k), MODES, "The inner products φᵀMφ", on=on, shown=shown)
    residual = (C @ phi) / M.diagonal()[:, None] + phi * frequencies
    # Pointwise the fastest frequency, up to some 100 times this, has its part in the rounding.
    scale = float(np.abs(phi).max()) * float(truth[-1])
    for i in range(k):
        shown = pictures.Field(shape.vertices, faces_of(shape), "Δφ + ωφ", phi[:, i], f"your mode {i}")
        what = f"Δφ + ωφ for mode {i}"
        expect.close(residual[:, i], 0.0, MODES * scale, what, on=on, shown=shown)


@EIGENMODES.check("a rectangle that keeps its heat has the frequencies of its cosines")
def _(f: Asked, rng: Rng) -> None:
    square = grid(rng)
    # Sides of different lengths: iterations that start from one vector may miss a repeated frequency.
    a, b = float(rng.uniform(0.1, 10.0)) * np.array([1.0, rng.uniform(0.6, 0.8)])
    C, M = matrices(square.transformed(np.diag([a, b, 1.0])))
    # cos(pπx/a) cos(qπy/b), sampled, is a mode of the five-point stencil: two sines for five cells each way.
    sine = np.square(np.sin(np.pi * np.arange(6) / 10))
    truth = np.sort((100 / a**2 * sine[:, None] + 100 / b**2 * sine).ravel())[:6]
    on = f"a rectangle of sides {a:.3g} and {b:.3g} in 25 cells, k = 6"
    frequencies, _phi = _modes(f(C, M, 6), 36, 6, on)
    expect.close(frequencies, truth, MODES * truth[-1], "The frequencies", on=on)


@EIGENMODES.check("a sphere of radius R: l(l + 1)/R², 2l + 1 times")
def _(f: Asked, rng: Rng) -> None:
    R = float(rng.uniform(0.1, 10.0))
    ball = sphere(rng, R)
    C, M = matrices(ball)
    on = f"a sphere of radius {R:.3g}, k = 9"
    frequencies, _phi = _modes(f(C, M, 9), len(ball.vertices), 9, on)
    truth = np.repeat([0.0, 2.0, 6.0], [1, 3, 5]) / R**2
    # With 42 vertices they are up to 11 % of the largest off, in 200 draws.
    expect.close(frequencies, truth, 0.15 * truth[-1], "The frequencies", on=on)


@EIGENMODES.check("as many zeros as there are pieces")
def _(f: Asked, rng: Rng) -> None:
    two = shapes.shuffled(shapes.union(sphere(rng), sphere(rng, 1.5)), rng)
    C, M = matrices(two)
    on = "two spheres, k = 3"
    frequencies, _phi = _modes(f(C, M, 3), len(two.vertices), 3, on)
    expect.close(frequencies[:2], 0.0, MODES, "The first two frequencies", on=on)
    expect.that(frequencies[2] > 0.5, "The third frequency is zero too.", on=on)


def _symmetric(C: Any, M: Any) -> tuple[FloatArray, FloatArray]:
    """Return frequencies, ascending, and ξ, orthonormal in the plain inner product."""
    frequencies, phi = truths.modes(C, M)
    return frequencies, phi * np.sqrt(M.diagonal())[:, None]


@EIGENMODES.variant("the generalised problem of scipy.linalg, signs and bases as they come")
def _(C: Any, M: Any, k: int) -> Any:
    from scipy.linalg import eigh

    values, vectors = eigh(-truths.dense(C), truths.dense(M))
    return values[:k], -vectors[:, :k]


@EIGENMODES.variant("all modes of the unsymmetric matrix, sorted and made orthonormal in M, as a list")
def _(C: Any, M: Any, k: int) -> Any:
    root = np.sqrt(M.diagonal())[:, None]
    values, vectors = np.linalg.eig(truths.dense(C) / M.diagonal()[:, None])
    order = np.argsort(-values.real)[:k]
    Q, _ = np.linalg.qr(root * vectors[:, order].real)
    return [-values.real[order], Q / root]


@EIGENMODES.mistake(
    "the mass matrix was left out: these are the modes of C",
    hint="What becomes of a frequency when the mesh is scaled? C does not change at all.",
)
def _(C: Any, M: Any, k: int) -> Any:
    values, vectors = np.linalg.eigh(-truths.dense(C))
    return values[:k], vectors[:, :k]


@EIGENMODES.mistake(
    "the largest frequencies were taken, not the smallest",
    hint="What is the frequency of a constant? The smoothest modes are asked for.",
)
def _(C: Any, M: Any, k: int) -> Any:
    frequencies, phi = truths.modes(C, M)
    return frequencies[-k:], phi[:, -k:]


@EIGENMODES.mistake(
    "the right modes come in descending order",
    hint="Where should the constant be: in the first column or in the last?",
)
def _(C: Any, M: Any, k: int) -> Any:
    frequencies, phi = truths.modes(C, M)
    return frequencies[:k][::-1], phi[:, :k][:, ::-1]


@EIGENMODES.mistake(
    "the modes come in no order",
    hint="`np.linalg.eig` does not sort. Which mode should be the first?",
)
def _(C: Any, M: Any, k: int) -> Any:
    values, vectors = np.linalg.eig(-truths.dense(C) / M.diagonal()[:, None])
    phi = vectors.real
    return values.real[:k], (phi / np.sqrt(M.diagonal() @ phi**2))[:, :k]


@EIGENMODES.mistake(
    "a solver for symmetric matrices was given M⁻¹C, which is not symmetric",
    hint="`eigh` looks at one half of the matrix only, and takes the other to be the same. Symmetrise first.",
)
def _(C: Any, M: Any, k: int) -> Any:
    values, vectors = np.linalg.eigh(-truths.dense(C) / M.diagonal()[:, None])
    return values[:k], vectors[:, :k]


@EIGENMODES.mistake(
    "the eigenvalues λ ≤ 0 were returned, not the frequencies −λ",
    hint="Δ is negative semi-definite. What does the docstring call a frequency?",
)
def _(C: Any, M: Any, k: int) -> Any:
    frequencies, phi = truths.modes(C, M)
    return -frequencies[:k], phi[:, :k]


@EIGENMODES.mistake(
    "ξ was returned in place of φ",
    hint="ξ are the eigenvectors of the symmetrised matrix. Which function on the mesh belongs to them (§9)?",
)
def _(C: Any, M: Any, k: int) -> Any:
    frequencies, xi = _symmetric(C, M)
    return frequencies[:k], xi[:, :k]


@EIGENMODES.mistake(
    "ξ was multiplied by the root of M, not divided by it",
    hint="ξ = M^½ φ. What is φ?",
)
def _(C: Any, M: Any, k: int) -> Any:
    frequencies, xi = _symmetric(C, M)
    return frequencies[:k], xi[:, :k] * np.sqrt(M.diagonal())[:, None]


@EIGENMODES.mistake(
    "the modes have length 1 in the plain inner product, not in that of M",
    hint="What is φᵀMφ for one of your modes?",
)
def _(C: Any, M: Any, k: int) -> Any:
    frequencies, phi = truths.modes(C, M)
    return frequencies[:k], (phi / np.linalg.norm(phi, axis=0))[:, :k]


@EIGENMODES.mistake(
    "the frequencies are the roots of what is asked for",
    hint="A drum sounds with the root. What stands in Δφ = λφ?",
)
def _(C: Any, M: Any, k: int) -> Any:
    frequencies, phi = truths.modes(C, M)
    return np.sqrt(np.maximum(frequencies[:k], 0)), phi[:, :k]


@EIGENMODES.mistake(
    "the constant was left out",
    hint="What is the smallest frequency of a closed surface?",
)
def _(C: Any, M: Any, k: int) -> Any:
    frequencies, phi = truths.modes(C, M)
    return frequencies[1 : k + 1], phi[:, 1 : k + 1]


# Coefficients, reconstruction, filter -----------------------------------------------------------

SPECTRAL_COEFFICIENTS = Exercise(
    reference.spectral_coefficients,
    notes="ch. 6 §10",
    hints=[
        "A coefficient is an inner product of f with a mode. In which one are the modes orthonormal?",
        "All coefficients at once are a product of three matrices.",
    ],
)

SPECTRAL_RECONSTRUCTION = Exercise(
    reference.spectral_reconstruction,
    notes="ch. 6 §10, §12; coursework 2, question 4",
    hints=[
        "You have the coefficients already. What is the sum of modes that they belong to?",
        "Only the first k columns of phi take part, in both steps.",
    ],
)

SPECTRAL_FILTER = Exercise(
    reference.spectral_filter,
    notes="ch. 6 §10, §13",
    hints=[
        "Between taking a function apart and putting it together, each coefficient is scaled.",
        "The response may be an array of factors, or a function of the frequencies: `callable` tells which.",
        "With several columns the factors scale rows: which axis is that?",
    ],
)


def _surface(rng: Rng) -> tuple[shapes.Shape, Any, FloatArray, FloatArray]:
    """Draw a mesh: the shape, M, all frequencies and all modes, with signs at random."""
    shape = closed(rng)
    C, M = matrices(shape)
    frequencies, phi = truths.modes(C, M)
    return shape, M, frequencies, phi * rng.choice([-1.0, 1.0], len(frequencies))


def _norm(M: Any) -> float:
    """Return a size that functions with values of about 1 have in the norm of M."""
    return 5 * float(np.sqrt(M.diagonal().sum()))


@SPECTRAL_COEFFICIENTS.check("a combination of modes gives back its coefficients", points=2)
def _(f: Asked, rng: Rng) -> None:
    _shape, M, _frequencies, phi = _surface(rng)
    one, three = rng.normal(size=8), rng.normal(size=(8, 3))
    answers = [f(phi[:, :8] @ one, phi[:, :8], M), f(phi[:, :8] @ three, phi[:, :8], M)]
    for value, truth, on in zip(
        f.each(answers), (one, three), ("one function", "three functions"), strict=True
    ):
        mine = expect.array(value, truth.shape, "The array of coefficients", on=on)
        expect.close(mine, truth, 50 * SINGLE, "The coefficients", on=on)


@SPECTRAL_COEFFICIENTS.check("the inner product over the surface, for functions that are no combination too")
def _(f: Asked, rng: Rng) -> None:
    shape, M, _frequencies, phi = _surface(rng)
    function, on = rng.normal(size=len(shape.vertices)), "a random function and its first seven modes"
    mine = expect.array(f(function, phi[:, :7], M), (7,), "The array of coefficients", on=on)
    areas = M.diagonal().tolist()
    # An integral: the value of f times the value of the mode times the area, added up over the cells.
    truth = [sum(a * u * v for a, u, v in zip(areas, function, phi[:, i], strict=True)) for i in range(7)]
    expect.close(mine, np.array(truth), SINGLE * _norm(M), "The coefficients", on=on)


@SPECTRAL_COEFFICIENTS.check("with all modes, the squares sum to the integral of f²")
def _(f: Asked, rng: Rng) -> None:
    shape, M, _frequencies, phi = _surface(rng)
    function = rng.normal(size=len(shape.vertices))
    on = "a random function and all modes"
    mine = expect.array(f(function, phi, M), function.shape, "The array of coefficients", on=on)
    truth = float(function @ (M @ function))
    expect.close(float(mine @ mine), truth, 10 * SINGLE * truth, "The sum of the squares", on=on)


@SPECTRAL_COEFFICIENTS.variant("one inner product after the other, as lists")
def _(f: FloatArray, phi: FloatArray, M: Any) -> Any:
    areas = M.diagonal()
    return [(np.sum(areas * phi[:, i] * f.T, axis=-1)).tolist() for i in range(phi.shape[1])]


@SPECTRAL_COEFFICIENTS.variant("weighted least squares, in single precision")
def _(f: FloatArray, phi: FloatArray, M: Any) -> Any:
    root = np.sqrt(M.diagonal())
    return np.linalg.lstsq((phi.T * root).T, (f.T * root).T, rcond=None)[0].astype(np.float32)


@SPECTRAL_COEFFICIENTS.mistake(
    "the mass matrix was left out",
    hint="In which inner product are the modes orthonormal? What is φᵀφ, and what is φᵀMφ?",
)
def _(f: FloatArray, phi: FloatArray, M: Any) -> Any:
    return phi.T @ f


@SPECTRAL_COEFFICIENTS.mistake(
    "least squares without areas was used",
    hint="Least squares over the vertices counts a small cell as much as a large one. Does an integral?",
)
def _(f: FloatArray, phi: FloatArray, M: Any) -> Any:
    return np.linalg.lstsq(phi, f, rcond=None)[0]


@SPECTRAL_COEFFICIENTS.mistake(
    "the root of M was used",
    hint="That belongs to ξ. What is the inner product of f and φ?",
)
def _(f: FloatArray, phi: FloatArray, M: Any) -> Any:
    return phi.T @ (f.T * np.sqrt(M.diagonal())).T


@SPECTRAL_COEFFICIENTS.mistake(
    "the inverse of M was used",
    hint="Does a vertex with a large cell count more or less in an integral?",
)
def _(f: FloatArray, phi: FloatArray, M: Any) -> Any:
    return phi.T @ (f.T / M.diagonal()).T


@SPECTRAL_COEFFICIENTS.mistake(
    "the absolute values were returned",
    hint="A mode can take part with either sign. What is lost without it?",
)
def _(f: FloatArray, phi: FloatArray, M: Any) -> Any:
    return np.abs(phi.T @ (M @ f))


@SPECTRAL_RECONSTRUCTION.check("all modes give the function back")
def _(f: Asked, rng: Rng) -> None:
    shape, M, _frequencies, phi = _surface(rng)
    n = len(shape.vertices)
    start = shape.vertices - shape.vertices.mean(axis=0)
    value, on = f(start, phi, M, n), f"the positions of a closed mesh, k = {n}"
    expecting.values(value, start, shape, "The result", on=on, scale=10 * float(np.abs(start).max()))


@SPECTRAL_RECONSTRUCTION.check("one mode gives the mean over the surface")
def _(f: Asked, rng: Rng) -> None:
    shape, M, _frequencies, phi = _surface(rng)
    function = rng.normal(size=len(shape.vertices)) + 2.0
    mean = float(M.diagonal() @ function / M.diagonal().sum())
    value, on = f(function, phi, M, 1), "a random function, k = 1"
    expecting.values(value, np.full(len(function), mean), shape, "The result", on=on, scale=10.0)


@SPECTRAL_RECONSTRUCTION.check("k modes: nothing of them is left in the rest", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape, M, _frequencies, phi = _surface(rng)
    n, k = len(shape.vertices), int(rng.integers(4, 10))
    function, on = rng.normal(size=(n, 3)), f"three random functions, k = {k}"
    mine = expect.array(f(function, phi, M, k), (n, 3), "The result", on=on)
    inside = phi.T @ (M @ mine)
    rest = phi.T @ (M @ (function - mine))
    size = 10 * SINGLE * max(_norm(M), float(np.abs(inside).max()))
    what = f"The part of the result in the modes after the first {k}"
    expect.close(inside[k:], 0.0, size, what, on=on)
    expect.close(rest[:k], 0.0, size, f"The part of the rest in the first {k} modes", on=on)


def _rebuilt(f: FloatArray, phi: FloatArray, M: Any) -> Any:
    return phi @ (phi.T @ (M @ f))


@SPECTRAL_RECONSTRUCTION.variant("adding one mode after the other")
def _(f: FloatArray, phi: FloatArray, M: Any, k: int) -> Any:
    result = np.zeros_like(f)
    for i in range(k):
        result += np.multiply.outer(phi[:, i], phi[:, i] @ (M @ f))
    return result


@SPECTRAL_RECONSTRUCTION.variant("an orthogonal projection by QR, in single precision")
def _(f: FloatArray, phi: FloatArray, M: Any, k: int) -> Any:
    root = np.sqrt(M.diagonal())
    Q, _ = np.linalg.qr((phi[:, :k].T * root).T)
    return ((Q @ (Q.T @ (f.T * root).T)).T / root).T.astype(np.float32)


@SPECTRAL_RECONSTRUCTION.mistake(
    "the mass matrix was left out",
    hint="In which inner product are the modes orthonormal? Try it with all of them.",
)
def _(f: FloatArray, phi: FloatArray, M: Any, k: int) -> Any:
    return phi[:, :k] @ (phi[:, :k].T @ f)


@SPECTRAL_RECONSTRUCTION.mistake(
    "least squares without areas was used",
    hint="With all modes it is right even so. With few, does a small cell count as much as a large one?",
)
def _(f: FloatArray, phi: FloatArray, M: Any, k: int) -> Any:
    return phi[:, :k] @ np.linalg.lstsq(phi[:, :k], f, rcond=None)[0]


@SPECTRAL_RECONSTRUCTION.mistake(
    "all modes were used, whatever k",
    hint="What should the result be for k = 1? Is it constant?",
)
def _(f: FloatArray, phi: FloatArray, M: Any, k: int) -> Any:
    return _rebuilt(f, phi, M)


@SPECTRAL_RECONSTRUCTION.mistake(
    "the k largest coefficients were kept, not the first k",
    hint="Which modes does the task name: those that matter most to f, or the smoothest?",
)
def _(f: FloatArray, phi: FloatArray, M: Any, k: int) -> Any:
    coefficients = phi.T @ (M @ f)
    size = np.linalg.norm(coefficients.reshape(phi.shape[1], -1), axis=1)
    kept = np.argsort(-size)[:k]
    return phi[:, kept] @ coefficients[kept]


@SPECTRAL_RECONSTRUCTION.mistake(
    "the last k modes were used, not the first",
    hint="Which modes are the smooth ones: those at the start or at the end of phi?",
)
def _(f: FloatArray, phi: FloatArray, M: Any, k: int) -> Any:
    return _rebuilt(f, phi[:, -k:], M)


@SPECTRAL_RECONSTRUCTION.mistake(
    "the constant mode was left out, and the mean with it",
    hint="Where does the result lie when the mesh is moved away from the origin?",
)
def _(f: FloatArray, phi: FloatArray, M: Any, k: int) -> Any:
    return _rebuilt(f, phi[:, 1:k], M)


@SPECTRAL_RECONSTRUCTION.mistake(
    "one mode too many was used",
    hint="Is column k among the first k?",
)
def _(f: FloatArray, phi: FloatArray, M: Any, k: int) -> Any:
    return _rebuilt(f, phi[:, : k + 1], M)


@SPECTRAL_RECONSTRUCTION.mistake(
    "the coefficients were returned, not the sum of modes",
    hint="The result is a function on the mesh again. What shape has it?",
)
def _(f: FloatArray, phi: FloatArray, M: Any, k: int) -> Any:
    return phi[:, :k].T @ (M @ f)


@SPECTRAL_FILTER.check("a factor of 1 for every mode changes nothing, of 0 leaves nothing")
def _(f: Asked, rng: Rng) -> None:
    shape, M, _frequencies, phi = _surface(rng)
    function = rng.normal(size=len(shape.vertices))
    ones = np.ones_like(function)
    answers = [f(function, phi, M, ones), f(function, phi, M, 0 * ones)]
    for value, truth, on in zip(
        f.each(answers), (function, 0 * function), ("factors of 1", "factors of 0"), strict=True
    ):
        expecting.values(value, truth, shape, "The result", on=on, scale=20.0)


@SPECTRAL_FILTER.check("each mode is scaled by its own factor", points=2)
def _(f: Asked, rng: Rng) -> None:
    shape, M, frequencies, phi = _surface(rng)
    n = len(shape.vertices)
    factors = np.exp(-frequencies * rng.uniform(0.5, 2.0) / frequencies[4])
    one, three = rng.normal(size=n), rng.normal(size=(n, 3))
    answers = [f(one, phi, M, factors), f(three, phi, M, factors)]
    names = ("a random function", "three random functions")
    for value, function, on in zip(f.each(answers), (one, three), names, strict=True):
        mine = expect.array(value, function.shape, "The result", on=on)
        have, had = phi.T @ (M @ mine), phi.T @ (M @ function)
        size = 10 * SINGLE * max(_norm(M), float(np.abs(have).max()))
        expect.close(have, (had.T * factors).T, size, "A coefficient of the result", on=on)


@SPECTRAL_FILTER.check("what the modes that are given do not span is removed")
def _(f: Asked, rng: Rng) -> None:
    shape, M, _frequencies, phi = _surface(rng)
    n, k = len(shape.vertices), 6
    function, factors = rng.normal(size=n), rng.uniform(0.5, 1.5, k)
    value = f(function, phi[:, :k], M, factors)
    on = f"the first {k} modes only"
    mine = expect.array(value, (n,), "The result", on=on)
    left = phi[:, k:].T @ (M @ mine)
    expect.close(left, 0.0, 10 * SINGLE * max(_norm(M), float(np.abs(left).max())), "What is left", on=on)


def _filtered(f: FloatArray, phi: FloatArray, M: Any, factors: FloatArray) -> Any:
    return phi @ ((phi.T @ (M @ f)).T * factors).T


@SPECTRAL_FILTER.variant("as one matrix")
def _(f: FloatArray, phi: FloatArray, M: Any, response: FloatArray) -> Any:
    return phi @ np.diag(response) @ phi.T @ truths.dense(M) @ f


@SPECTRAL_FILTER.variant("adding one mode after the other, in single precision")
def _(f: FloatArray, phi: FloatArray, M: Any, response: FloatArray) -> Any:
    result = np.zeros_like(f)
    for mode, factor in zip(phi.T, response, strict=True):
        result += factor * np.multiply.outer(mode, mode @ (M @ f))
    return result.astype(np.float32)


@SPECTRAL_FILTER.mistake(
    "the mass matrix was left out",
    hint="In which inner product are the modes orthonormal? Try it with factors of 1.",
)
def _(f: FloatArray, phi: FloatArray, M: Any, response: FloatArray) -> Any:
    return phi @ ((phi.T @ f).T * response).T


@SPECTRAL_FILTER.mistake(
    "the factors were not used",
    hint="What should be left when all factors are 0?",
)
def _(f: FloatArray, phi: FloatArray, M: Any, response: FloatArray) -> Any:
    return _filtered(f, phi, M, np.ones_like(response))


@SPECTRAL_FILTER.mistake(
    "the factors were applied twice, when taking apart and when putting together",
    hint="How often does a factor meet its mode on the way?",
)
def _(f: FloatArray, phi: FloatArray, M: Any, response: FloatArray) -> Any:
    return _filtered(f, phi, M, response**2)


@SPECTRAL_FILTER.mistake(
    "the factors meet the modes in reverse order",
    hint="Which mode does the first factor belong to?",
)
def _(f: FloatArray, phi: FloatArray, M: Any, response: FloatArray) -> Any:
    return _filtered(f, phi, M, response[::-1])


@SPECTRAL_FILTER.mistake(
    "what the factors leave was taken away from the function: the filter is the complement",
    hint="What should be left when all factors are 1?",
)
def _(f: FloatArray, phi: FloatArray, M: Any, response: FloatArray) -> Any:
    return f - _filtered(f, phi, M, response)
