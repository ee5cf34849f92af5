"""Exercises on walking along half-edges."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gpcourse.exercises import expect
from gpcourse.exercises.exercise import DoesNotEnd, Exercise
from gpcourse.exercises.halfedge import pictures
from gpcourse.exercises.halfedge.inputs import (
    FaceLists,
    Rng,
    as_cycle,
    bounded_triangles,
    closed_polygons,
    closed_triangles,
    face_lists,
    from_smallest,
    hole_cycles,
    mesh_of,
    neighbours_ccw,
    positions,
    renumbered,
    with_isolated_vertices,
)
from gpcourse.exercises.judging import Asked
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import FloatArray
from gpcourse.geometry.halfedge_mesh import HOLE, NONE, HalfedgeMesh
from gpcourse.reference import halfedge as reference

# Faces ------------------------------------------------------------------------------------------

FACE_VERTICES = Exercise(
    reference.face_vertices,
    notes="ch. 1, walking around a face",
    hints=[
        "The face knows one of its half-edges. Which record leads from there to the following one?",
        "Every half-edge knows the vertex it starts from. When do you have them all?",
        "A loop that tests before its first step finds itself at the end at once. The notes use do … while.",
    ],
    canonical=as_cycle,
)


def _expect_faces(f: Asked, questions: Sequence[tuple[HalfedgeMesh, FaceLists, int]]) -> None:
    answers = [f(mesh, i) for mesh, _, i in questions]
    for answer, (mesh, faces, i) in zip(f.each(answers), questions, strict=True):
        _judge_face(answer, mesh, faces[i], i)


def _judge_face(answer: Any, mesh: HalfedgeMesh, want: list[int], i: int) -> None:
    on = f"face {i}"
    mine = expect.indices(answer, on=on)
    details = {"yours": str(mine.tolist()), "on": on, "picture": pictures.of_face(mesh, i)}
    message = f"Your list has {len(mine)} corners, which is not how many the face has."
    told = f"The face has {len(want)} corners; your list has {len(mine)}."
    expect.that(len(mine) == len(want), message, told=told, **details)
    message = "These are not the corners of the face."
    expect.that(
        sorted(mine.tolist()) == sorted(want), message, truth=f"the corners {sorted(want)}", **details
    )
    message = "The corners are right, but not in counter-clockwise order."
    expect.same_cycle(mine, want, message, on=on, picture=details["picture"])


@FACE_VERTICES.check("triangles")
def _(f: Asked, rng: Rng) -> None:
    questions = []
    for shape in (shapes.shuffled(shapes.disc(2), rng), closed_triangles(rng)):
        mesh = mesh_of(shape, rng)
        some = rng.choice(mesh.n_faces, 3, replace=False)
        questions += [(mesh, face_lists(shape), int(i)) for i in some]
    _expect_faces(f, questions)


@FACE_VERTICES.check("polygons of any size")
def _(f: Asked, rng: Rng) -> None:
    shape = closed_polygons(rng)
    mesh = mesh_of(shape, rng)
    _expect_faces(f, [(mesh, face_lists(shape), i) for i in range(mesh.n_faces)])


@FACE_VERTICES.check("faces beside a hole")
def _(f: Asked, rng: Rng) -> None:
    shape = bounded_triangles(rng)
    mesh = mesh_of(shape, rng)
    beside = np.unique(mesh.face[mesh.twin[mesh.face == HOLE]])
    some = rng.choice(beside, min(4, len(beside)), replace=False)
    _expect_faces(f, [(mesh, face_lists(shape), int(i)) for i in some])


@FACE_VERTICES.variant("where the half-edges end, as an array")
def _(mesh: HalfedgeMesh, f: int) -> Any:
    corners, h = [], mesh.face_halfedge[f]
    for _ in range(np.count_nonzero(mesh.face == f)):
        corners.append(mesh.origin[mesh.twin[h]])
        h = mesh.next[h]
    return np.array(corners).reshape(-1, 1)


@FACE_VERTICES.variant("recursively")
def _(mesh: HalfedgeMesh, f: int) -> Any:
    def rest(h: int) -> tuple[int, ...]:
        return () if h == mesh.face_halfedge[f] else (int(mesh.origin[h]), *rest(mesh.next[h]))

    start = mesh.face_halfedge[f]
    return (int(mesh.origin[start]), *rest(mesh.next[start]))


@FACE_VERTICES.mistake(
    "the walk followed prev",
    hint="Both next and prev go all the way round the face. Which of them goes counter-clockwise?",
)
def _(mesh: HalfedgeMesh, f: int) -> list[int]:
    return reference.face_vertices(mesh, f)[::-1]


@FACE_VERTICES.mistake(
    "the walk stopped one corner early",
    hint="Look at the condition of your loop: does it look at the half-edge here, or at the one after it?",
)
def _(mesh: HalfedgeMesh, f: int) -> list[int]:
    return reference.face_vertices(mesh, f)[:-1]


@FACE_VERTICES.mistake(
    "the first corner is listed again at the end",
    hint="What has been listed already when the walk comes back to where it started?",
)
def _(mesh: HalfedgeMesh, f: int) -> list[int]:
    corners = reference.face_vertices(mesh, f)
    return [*corners, corners[0]]


@FACE_VERTICES.mistake(
    "the half-edges are listed instead of their vertices",
    hint="A half-edge is an index into the records. Which record turns it into a vertex?",
)
def _(mesh: HalfedgeMesh, f: int) -> list[int]:
    start = mesh.face_halfedge[f]
    halfedges = [int(start)]
    while mesh.next[halfedges[-1]] != start:
        halfedges.append(int(mesh.next[halfedges[-1]]))
    return halfedges


@FACE_VERTICES.mistake(
    "every face was taken for a triangle",
    hint="How do you know that you have come round, without counting?",
)
def _(mesh: HalfedgeMesh, f: int) -> list[int]:
    h = mesh.face_halfedge[f]
    around = [h, mesh.next[h], mesh.next[mesh.next[h]]]
    return [int(mesh.origin[h]) for h in around]


# Neighbours -------------------------------------------------------------------------------------

_NEIGHBOUR_HINTS = [
    "The vertex knows one half-edge that leaves it. Which is the next one that leaves it?",
    "Two steps are needed: one within a face, one across an edge. Try both orders on paper.",
    "The neighbour is where the half-edge ends. Which of its companions starts there?",
    "What does vertex_halfedge hold for a vertex that no face uses?",
]

VERTEX_NEIGHBOURS_CCW = Exercise(
    reference.vertex_neighbours_ccw,
    notes="ch. 1, walking around a vertex",
    hints=_NEIGHBOUR_HINTS,
    canonical=as_cycle,
    time_limit=1.0,
)

VERTEX_NEIGHBOURS_CW = Exercise(
    reference.vertex_neighbours_cw,
    notes="ch. 1, walking around a vertex",
    hints=_NEIGHBOUR_HINTS,
    canonical=as_cycle,
    time_limit=1.0,
)


def _expect_neighbours(
    f: Asked, questions: list[tuple[HalfedgeMesh, int]], faces: FaceLists, sense: int
) -> None:
    """Ask all questions before the first answer is judged: one answer alone fits several mistakes."""
    answers = [f(mesh, v) for mesh, v in questions]
    for (mesh, v), answer in zip(questions, f.each(answers), strict=True):
        _judge_neighbours(answer, mesh, v, neighbours_ccw(faces, v)[::sense], sense)


def _judge_neighbours(answer: Any, mesh: HalfedgeMesh, v: int, ring: list[int], sense: int) -> None:
    on = f"vertex {v}"
    mine = expect.indices(answer, on=on)
    have, want = set(mine.tolist()), set(ring)

    details: dict[str, Any] = {
        "yours": str(mine.tolist()),
        "on": on,
        "picture": pictures.of_neighbours(mesh, v, mine.tolist()),
    }
    if want - have:
        told = f"Neighbour {min(want - have)} is missing: there are {len(want)}."
        raise expect.Wrong("A neighbour is missing.", told=told, **details)
    if have - want:
        raise expect.Wrong(f"Vertex {min(have - want)} is no neighbour of {v}.", **details)
    expect.that(len(mine) == len(ring), "A neighbour is listed more than once.", **details)
    names = {1: "counter-clockwise", -1: "clockwise"}
    # With three neighbours every order is one of the two senses: it may as well be no walk at all.
    if len(ring) > 3 and expect.cyclic_equal(mine.tolist(), ring[::-1]):
        raise expect.Wrong(f"The neighbours are listed {names[-sense]}, not {names[sense]}.", **details)
    message = f"The neighbours are right, but they are not in {names[sense]} order."
    expect.that(expect.cyclic_equal(mine.tolist(), ring), message, **details)


def _declare_neighbour_checks(exercise: Exercise, sense: int) -> None:
    @exercise.check("triangles")
    def _(f: Asked, rng: Rng) -> None:
        shape = closed_triangles(rng)
        mesh, faces = mesh_of(shape, rng), face_lists(shape)
        _expect_neighbours(
            f, [(mesh, int(v)) for v in rng.choice(mesh.n_vertices, 8, replace=False)], faces, sense
        )

    @exercise.check("polygons: only vertices that share an edge are neighbours")
    def _(f: Asked, rng: Rng) -> None:
        shape = closed_polygons(rng)
        mesh, faces = mesh_of(shape, rng), face_lists(shape)
        some = rng.choice(mesh.n_vertices, 4, replace=False)
        _expect_neighbours(f, [(mesh, int(v)) for v in some], faces, sense)

    @exercise.check("a boundary vertex, whatever its representative", points=2)
    def _(f: Asked, rng: Rng) -> None:
        shape = bounded_triangles(rng)
        faces = face_lists(shape)
        border = sorted({v for cycle in hole_cycles(faces) for v in cycle})
        some = rng.choice(border, 4, replace=False)
        _expect_neighbours(f, [(mesh_of(shape, rng), int(v)) for v in some for _ in range(3)], faces, sense)

    @exercise.check("an isolated vertex has no neighbours")
    def _(f: Asked, rng: Rng) -> None:
        vertices, faces, isolated = with_isolated_vertices(shapes.octahedron(), rng)
        mesh = renumbered(reference.halfedge_mesh(vertices, faces), rng)
        for v in isolated:
            mine = expect.indices(f(mesh, int(v)), on=f"isolated vertex {v}")
            expect.that(
                len(mine) == 0,
                f"Vertex {v} belongs to no face.",
                yours=str(mine.tolist()),
                on="an isolated vertex",
            )


_declare_neighbour_checks(VERTEX_NEIGHBOURS_CCW, +1)
_declare_neighbour_checks(VERTEX_NEIGHBOURS_CW, -1)


def _walk(mesh: HalfedgeMesh, v: int, sense: int) -> list[int]:
    """List the half-edges that leave `v`, in one sense."""
    step = mesh.twin[mesh.prev] if sense > 0 else mesh.next[mesh.twin]
    start = int(mesh.vertex_halfedge[v])
    halfedges = [] if start == NONE else [start]
    while halfedges and step[halfedges[-1]] != start:
        halfedges.append(int(step[halfedges[-1]]))
    return halfedges


def _ends(mesh: HalfedgeMesh, halfedges: list[int]) -> list[int]:
    return [int(mesh.origin[mesh.twin[h]]) for h in halfedges]


def _declare_neighbour_solutions(exercise: Exercise, sense: int) -> None:
    names = {1: "counter-clockwise", -1: "clockwise"}

    @exercise.variant("where the preceding half-edges start, as a column")
    def _(mesh: HalfedgeMesh, v: int) -> Any:
        # The half-edge that arrives at v is the twin of one that leaves it.
        arriving = mesh.twin[np.array(_walk(mesh, v, sense), dtype=int)]
        return mesh.origin[arriving].reshape(-1, 1).astype(np.float32)

    @exercise.variant("the other walk, turned round")
    def _(mesh: HalfedgeMesh, v: int) -> Any:
        return tuple(_ends(mesh, _walk(mesh, v, -sense)[::-1]))

    @exercise.mistake(
        f"the walk went {names[-sense]}",
        hint="Draw a vertex with three faces around it and follow your two steps with a finger.",
    )
    def _(mesh: HalfedgeMesh, v: int) -> list[int]:
        return _ends(mesh, _walk(mesh, v, -sense))

    @exercise.mistake(
        "the walk stopped at the hole",
        hint="A boundary vertex has one more neighbour than faces. On which side of the hole did you stop?",
    )
    def _(mesh: HalfedgeMesh, v: int) -> list[int]:
        halfedges = _walk(mesh, v, sense)
        # From the representative on, until a step would have to cross the hole.
        faces = [mesh.face[h] if sense > 0 else mesh.face[mesh.twin[h]] for h in halfedges]
        stop = next((i for i, f in enumerate(faces) if f == HOLE), len(faces) - 1)
        return _ends(mesh, halfedges[: stop + 1])

    @exercise.mistake(
        "the half-edge of a hole was left out together with its neighbour",
        hint="The half-edge along the hole leads to a neighbour too. Which one is lost when you skip it?",
    )
    def _(mesh: HalfedgeMesh, v: int) -> list[int]:
        return _ends(mesh, [h for h in _walk(mesh, v, sense) if mesh.face[h] != HOLE])

    @exercise.mistake(
        "the walk waits for its start, which it never meets again at a hole",
        hint="At a boundary vertex, follow the walk half-edge by half-edge. Where does it leave the vertex?",
    )
    def _(mesh: HalfedgeMesh, v: int) -> list[int]:
        halfedges = _walk(mesh, v, sense)
        if any(mesh.face[h] == HOLE for h in halfedges):
            raise DoesNotEnd
        return _ends(mesh, halfedges)

    @exercise.mistake(
        "the half-edges are listed instead of the vertices they lead to",
        hint="A half-edge is an index into the records. Which vertex does it lead to?",
    )
    def _(mesh: HalfedgeMesh, v: int) -> list[int]:
        return _walk(mesh, v, sense)

    @exercise.mistake(
        "the vertex itself is listed, once for each half-edge",
        hint="Every half-edge of this walk starts in the same vertex. Where do they end?",
    )
    def _(mesh: HalfedgeMesh, v: int) -> list[int]:
        return [int(v) for _ in _walk(mesh, v, sense)]

    @exercise.mistake(
        "the walk stopped one neighbour early",
        hint="Look at the condition of your loop: has the last half-edge been listed when it becomes false?",
    )
    def _(mesh: HalfedgeMesh, v: int) -> list[int]:
        return _ends(mesh, _walk(mesh, v, sense))[:-1]

    @exercise.mistake(
        "the -1 of an isolated vertex was used as a half-edge",
        hint="In numpy, index -1 is the last entry. What does it stand for in vertex_halfedge?",
    )
    def _(mesh: HalfedgeMesh, v: int) -> list[int]:
        if mesh.vertex_halfedge[v] != NONE:
            return _ends(mesh, _walk(mesh, v, sense))
        return _ends(mesh, _walk(mesh, int(mesh.origin[-1]), sense))


_declare_neighbour_solutions(VERTEX_NEIGHBOURS_CCW, +1)
_declare_neighbour_solutions(VERTEX_NEIGHBOURS_CW, -1)


# Holes and centroids ----------------------------------------------------------------------------


def _as_cycles(arguments: tuple[Any, ...], value: Any) -> list[list[int]]:
    return sorted(from_smallest([int(v) for v in np.asarray(loop).ravel()]) for loop in value)


BOUNDARY_LOOPS = Exercise(
    reference.boundary_loops,
    notes="ch. 1, Half-edge Data Structure",
    hints=[
        "Which record tells you that a half-edge runs along a hole?",
        "From one such half-edge, next goes once round the hole. Note which half-edges you have met.",
        "Every half-edge of a hole lies on exactly one loop. Start again while one has not been met.",
    ],
    canonical=_as_cycles,
    time_limit=1.0,
)


def _expect_loops(f: Asked, shape: shapes.Shape, rng: Rng, on: str) -> None:
    value = f(mesh_of(shape, rng))
    want = hole_cycles(face_lists(shape))
    expect.that(value is not None, "The result is None: is a `return` missing?", on=on)
    is_list = isinstance(value, (list, tuple, np.ndarray))
    expect.that(is_list, f"The result should be a list of loops; it is a {type(value).__name__}.", on=on)
    flat = any(np.ndim(np.asarray(loop, dtype=object)) == 0 for loop in value)
    message = "The result should be a list of loops, each a list of vertices; it is one flat list."
    expect.that(not flat, message, yours=expect.brief(value), on=on)
    loops = [expect.indices(loop, f"Loop {i}", on=on).tolist() for i, loop in enumerate(value)]
    message = f"You found {_count(len(loops))}, which is not how many this mesh has."
    told = f"You found {_count(len(loops))}; this mesh has {len(want)}."
    drawn = pictures.of_loops(shape, loops, want)
    expect.that(len(loops) == len(want), message, told=told, yours=expect.brief(loops), on=on, **drawn)
    for loop in loops:
        drawn = pictures.of_loops(shape, [loop], want)
        twice = next((v for v in loop if loop.count(v) > 1), None)
        message = f"Vertex {twice} is listed more than once on its loop."
        expect.that(twice is None, message, yours=expect.brief(loop), on=on, **drawn)
        match = next((cycle for cycle in want if set(cycle) == set(loop)), None)
        details: dict[str, Any] = {"yours": expect.brief(loop), "on": on, **drawn}
        expect.that(match is not None, "These are not the vertices along a hole.", **details)
        if match and len(match) > 2 and expect.cyclic_equal(loop, match[::-1]):
            raise expect.Wrong("The loop runs against the direction of next along the hole.", **details)
        in_order = match and expect.cyclic_equal(loop, match)
        expect.that(in_order, "The vertices are right, but not in order.", **details)


def _count(loops: int) -> str:
    return "1 loop" if loops == 1 else f"{loops} loops"


@BOUNDARY_LOOPS.check("a closed mesh has none")
def _(f: Asked, rng: Rng) -> None:
    _expect_loops(f, closed_triangles(rng), rng, "a closed mesh")


@BOUNDARY_LOOPS.check("a disc has one, an annulus two")
def _(f: Asked, rng: Rng) -> None:
    _expect_loops(f, shapes.shuffled(shapes.disc(2), rng), rng, "a disc")
    _expect_loops(f, shapes.shuffled(shapes.annulus(), rng), rng, "an annulus")


@BOUNDARY_LOOPS.check("several holes and several components")
def _(f: Asked, rng: Rng) -> None:
    both = shapes.union(bounded_triangles(rng), shapes.cylinder(5))
    _expect_loops(f, shapes.shuffled(both, rng), rng, "a mesh with holes beside an open cylinder")


@BOUNDARY_LOOPS.variant("with a set of half-edges, loops as arrays")
def _(mesh: HalfedgeMesh) -> Any:
    seen: set[int] = set()
    loops = []
    for h in range(mesh.n_halfedges):
        if mesh.face[h] == HOLE and h not in seen:
            loop, here = [], h
            while here not in seen:
                seen.add(here)
                loop.append(mesh.origin[here])
                here = int(mesh.next[here])
            loops.append(np.array(loop))
    return loops


@BOUNDARY_LOOPS.variant("from an orbit of next, the largest hole first")
def _(mesh: HalfedgeMesh) -> Any:
    loops = reference.boundary_loops(mesh)
    return tuple(loop[1:] + loop[:1] for loop in sorted(loops, key=len, reverse=True))


@BOUNDARY_LOOPS.mistake(
    "all loops are joined into one list",
    hint="A mesh can have several holes. Where in your list does one end and the next begin?",
)
def _(mesh: HalfedgeMesh) -> Any:
    joined = [v for loop in reference.boundary_loops(mesh) for v in loop]
    return [joined] if joined else []


@BOUNDARY_LOOPS.mistake(
    "only one hole was found",
    hint="Are there half-edges of holes that your walk has not met?",
)
def _(mesh: HalfedgeMesh) -> Any:
    h = int(np.argmax(mesh.face == HOLE))
    here = int(mesh.origin[h])
    return [loop for loop in reference.boundary_loops(mesh) if mesh.face[h] == HOLE and here in loop]


@BOUNDARY_LOOPS.mistake(
    "a loop was started at every half-edge of a hole",
    hint="How many times does your list name the same hole?",
)
def _(mesh: HalfedgeMesh) -> Any:
    return [loop for loop in reference.boundary_loops(mesh) for _ in loop]


@BOUNDARY_LOOPS.mistake(
    "the walk went against the direction of next",
    hint="Which way does the half-edge of a hole run, compared with the face on the other side?",
)
def _(mesh: HalfedgeMesh) -> Any:
    return [loop[::-1] for loop in reference.boundary_loops(mesh)]


@BOUNDARY_LOOPS.mistake(
    "the first vertex of a loop is listed again at its end",
    hint="What has been listed already when the walk comes back to where it started?",
)
def _(mesh: HalfedgeMesh) -> Any:
    return [[*loop, loop[0]] for loop in reference.boundary_loops(mesh)]


@BOUNDARY_LOOPS.mistake(
    "the half-edges are listed instead of their vertices",
    hint="Which record turns a half-edge into the vertex it starts from?",
)
def _(mesh: HalfedgeMesh) -> Any:
    leaving = {int(mesh.origin[h]): int(h) for h in np.flatnonzero(mesh.face == HOLE)}
    return [[leaving[v] for v in loop] for loop in reference.boundary_loops(mesh)]


FACE_CENTROID = Exercise(
    reference.face_centroid,
    notes="coursework 1, question 1",
    hints=[
        "You can list the corners of a face already. Where are their positions?",
        "A mean of points is a point: along which axis of the array do you average?",
    ],
)


def _expect_centroids(f: Asked, questions: Sequence[tuple[HalfedgeMesh, FaceLists, int, float]]) -> None:
    answers = [f(mesh, i) for mesh, _, i, _ in questions]
    for answer, (mesh, faces, i, scale) in zip(f.each(answers), questions, strict=True):
        _judge_centroid(answer, positions(mesh)[faces[i]], scale, f"face {i}, with {len(faces[i])} corners")


def _judge_centroid(answer: Any, corners: FloatArray, scale: float, on: str) -> None:
    mine = expect.array(answer, (3,), "The centroid", on=on)
    want = np.array([sum(column) / len(column) for column in corners.T])
    # A mean of k numbers is rounded by less than k * 1e-16 of the largest; 1e-6 also admits float32.
    size = np.abs(corners).max()
    tolerance, drawn = 1e-6 * size if scale < 1e3 else 1e-7 * size, pictures.of_centroid(corners, mine, want)
    expect.close(mine, want, tolerance, "The centroid", on=on, **drawn)


@FACE_CENTROID.check("triangles")
def _(f: Asked, rng: Rng) -> None:
    shape = closed_triangles(rng)
    mesh = mesh_of(shape, rng)
    some = rng.choice(mesh.n_faces, 3, replace=False)
    _expect_centroids(f, [(mesh, face_lists(shape), int(i), 1.0) for i in some])


@FACE_CENTROID.check("polygons, far from the origin and at any scale")
def _(f: Asked, rng: Rng) -> None:
    questions = []
    for scale in (0.01, 1.0, 100.0):
        shape = closed_polygons(rng)
        bent = shape.vertices * rng.uniform(0.5, 2.0, size=(len(shape.vertices), 1)) + [10, -20, 30]
        mesh = renumbered(reference.halfedge_mesh(scale * bent, shape.faces), rng)
        some = rng.choice(mesh.n_faces, 4, replace=False)
        questions += [(mesh, face_lists(shape), int(i), scale) for i in some]
    _expect_centroids(f, questions)


@FACE_CENTROID.variant("summing while walking")
def _(mesh: HalfedgeMesh, f: int) -> Any:
    start = h = mesh.face_halfedge[f]
    total, count = [0.0, 0.0, 0.0], 0
    while True:
        total = [a + float(b) for a, b in zip(total, positions(mesh)[mesh.origin[h]], strict=True)]
        count += 1
        h = mesh.next[h]
        if h == start:
            return [a / count for a in total]


@FACE_CENTROID.variant("a mean of the half-edges of the face, in single precision")
def _(mesh: HalfedgeMesh, f: int) -> Any:
    return positions(mesh)[mesh.origin[mesh.face == f]].mean(axis=0, keepdims=True).astype(np.float32)


def _corners(mesh: HalfedgeMesh, f: int) -> FloatArray:
    return positions(mesh)[reference.face_vertices(mesh, f)]


@FACE_CENTROID.mistake(
    "the sum of the corners was divided by 3 for every face",
    hint="How many corners did you add up?",
)
def _(mesh: HalfedgeMesh, f: int) -> Any:
    return _corners(mesh, f).sum(axis=0) / 3


@FACE_CENTROID.mistake(
    "the sum of the corners was not divided",
    hint="A centroid lies among the corners. Does yours?",
)
def _(mesh: HalfedgeMesh, f: int) -> Any:
    return _corners(mesh, f).sum(axis=0)


@FACE_CENTROID.mistake(
    "the mean was taken over all coordinates at once",
    hint="x, y and z are averaged each for itself. Which axis of the array is that?",
)
def _(mesh: HalfedgeMesh, f: int) -> Any:
    return _corners(mesh, f).mean()


@FACE_CENTROID.mistake(
    "the first corner was counted twice",
    hint="Is the corner where the walk starts added again when the walk comes back to it?",
)
def _(mesh: HalfedgeMesh, f: int) -> Any:
    corners = _corners(mesh, f)
    return np.vstack([corners, corners[:1]]).mean(axis=0)


@FACE_CENTROID.mistake(
    "the middle of the bounding box was taken",
    hint="Only two corners decide the bounding box along each axis. What about the others?",
)
def _(mesh: HalfedgeMesh, f: int) -> Any:
    corners = _corners(mesh, f)
    return (corners.min(axis=0) + corners.max(axis=0)) / 2
