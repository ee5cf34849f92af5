"""Exercises on flipping edges."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gpcourse.exercises import expect
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.halfedge import pictures
from gpcourse.exercises.halfedge.inputs import (
    FaceLists,
    Rng,
    as_rows,
    bounded_triangles,
    closed_polygons,
    closed_triangles,
    face_lists,
    from_smallest,
    mesh_of,
    renumbered,
    with_representatives,
)
from gpcourse.exercises.judging import Asked
from gpcourse.geometry import shapes
from gpcourse.geometry.halfedge_mesh import HOLE, HalfedgeMesh
from gpcourse.reference import halfedge as reference

IS_FLIPPABLE = Exercise(
    reference.is_flippable,
    notes="ch. 1, Edge Flip",
    hints=[
        "Which four vertices take part in a flip, and which half-edges lead to them?",
        "There are three reasons against a flip: find for each the records that tell.",
        "Flip an edge of a tetrahedron on paper. Which edge would be there twice?",
        "Count the neighbours of both ends before the flip. Each of them loses one.",
    ],
)


def _ends(mesh: HalfedgeMesh, h: int) -> tuple[int, int]:
    return int(mesh.origin[h]), int(mesh.origin[mesh.twin[h]])


def _expect_flippable(f: Asked, edges: Sequence[tuple[HalfedgeMesh, int, str]]) -> None:
    """Ask about several half-edges, each with the reason against a flip; empty where there is none."""
    answers = [f(mesh, h) for mesh, h, _ in edges]
    for answer, (mesh, h, against) in zip(f.each(answers), edges, strict=True):
        p, q = _ends(mesh, h)
        on = f"half-edge {h} ({p} → {q})"
        mine = expect.boolean(answer, on=on)
        draw = pictures.of_halfedges(mesh, [h, mesh.twin[h]])
        why = against or "Nothing speaks against flipping this edge."
        expect.that(mine != bool(against), why, yours=str(mine), truth=str(not against), on=on, picture=draw)


def _truth(faces: FaceLists, p: int, q: int) -> str:
    """Say why edge p – q must not be flipped, from the faces alone; empty if it may be."""
    sides = [face for face in faces if p in face and q in face]
    if len(sides) < 2:
        return "There is a face on one side of this edge only."
    if any(len(face) != 3 for face in sides):
        return "A face beside this edge is not a triangle."
    r, s = (next(v for v in face if v not in (p, q)) for face in sides)
    if any(r in face and s in face for face in faces):
        return f"The new edge {r} – {s} exists already."
    for v in (p, q):
        neighbours = {w for face in faces if v in face for w in face} - {v}
        if len(neighbours) <= 3:
            return f"Vertex {v} has {len(neighbours)} neighbours and would keep {len(neighbours) - 1}."
    return ""


def _some_edges(shape: shapes.Shape, rng: Rng, most: int = 24) -> list[tuple[HalfedgeMesh, int, str]]:
    mesh, faces = mesh_of(shape, rng), face_lists(shape)
    some = [int(h) for h in rng.permutation(mesh.n_halfedges)[:most]]
    return [(mesh, h, _truth(faces, *_ends(mesh, h))) for h in some]


def _between_stacks() -> shapes.Shape:
    """A tetrahedron with a vertex on two of its faces: edge 0 – 1 has ends of valence 4, and 2 – 3 exists."""
    stacked = [[0, 2, 1], [0, 1, 3]]
    for a, b, c, top in ((0, 3, 2, 4), (1, 2, 3, 5)):
        stacked += [[a, b, top], [b, c, top], [c, a, top]]
    vertices = np.array(
        [[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1], [1, 1, -1], [-1, -1, -1]], dtype=float
    )
    return shapes.Shape("stacked tetrahedron", vertices, np.array(stacked))


@IS_FLIPPABLE.check("inner edges, and edges at a hole from both sides")
def _(f: Asked, rng: Rng) -> None:
    mesh = mesh_of(shapes.shuffled(shapes.disc(3), rng), rng)
    inner = np.flatnonzero((mesh.face != HOLE) & (mesh.face[mesh.twin] != HOLE))
    valence = np.bincount(mesh.origin)
    deep = [int(h) for h in inner if valence[mesh.origin[h]] > 3 and valence[mesh.origin[mesh.twin[h]]] > 3]
    faces = [reference.face_vertices(mesh, i) for i in range(mesh.n_faces)]
    free = [h for h in deep if not _truth(faces, *_ends(mesh, h))]
    hole = int(rng.choice(np.flatnonzero(mesh.face == HOLE)))
    alone = "There is a face on one side of this edge only."
    border = [(mesh, h, alone) for h in (hole, int(mesh.twin[hole]))]
    _expect_flippable(f, [(mesh, free[0], ""), *border])


@IS_FLIPPABLE.check("the new edge must not exist already")
def _(f: Asked, rng: Rng) -> None:
    solid = mesh_of(shapes.tetrahedron(), rng)
    one = int(rng.integers(solid.n_halfedges))
    mesh = mesh_of(_between_stacks(), rng)
    h = next(h for h in range(mesh.n_halfedges) if _ends(mesh, h) == (0, 1))
    why = "In a tetrahedron every two vertices are joined already."
    _expect_flippable(f, [(solid, one, why), (mesh, h, "The new edge 2 – 3 exists already.")])


@IS_FLIPPABLE.check("both ends keep at least three neighbours")
def _(f: Asked, rng: Rng) -> None:
    # Vertex 0 lies on the boundary and has three neighbours; the new edge 1 – 3 does not exist.
    fan = shapes.Shape("fan", rng.normal(size=(5, 3)), np.array([[0, 1, 2], [0, 2, 3], [2, 1, 4], [3, 2, 4]]))
    mesh = mesh_of(fan, rng)
    why = "Vertex 0 has three neighbours and would keep two."
    edge = [h for h in range(mesh.n_halfedges) if set(_ends(mesh, h)) == {0, 2}]
    _expect_flippable(f, [(mesh, h, why) for h in edge])


@IS_FLIPPABLE.check("only triangles have a flip")
def _(f: Asked, rng: Rng) -> None:
    quads = _some_edges(shapes.shuffled(shapes.torus(5, 4, quads=True), rng), rng, most=4)
    _expect_flippable(f, quads + _some_edges(closed_polygons(rng), rng, most=8))


@IS_FLIPPABLE.check("every edge of a closed mesh and of one with holes")
def _(f: Asked, rng: Rng) -> None:
    closed = _some_edges(closed_triangles(rng), rng)
    _expect_flippable(f, closed + _some_edges(bounded_triangles(rng), rng))


def _four(mesh: HalfedgeMesh, h: int) -> tuple[int, int, int, int]:
    """Return both ends of an edge and the corners opposite to it."""
    t = mesh.twin[h]
    p, q = _ends(mesh, h)
    return p, q, int(mesh.origin[mesh.prev[h]]), int(mesh.origin[mesh.prev[t]])


def _flippable_but(
    mesh: HalfedgeMesh,
    h: int,
    *,
    border: str = "both",
    triangles: bool = True,
    fresh: bool = True,
    count: bool = True,
) -> bool:
    """Answer as is_flippable does, with some of its tests left out or changed."""
    t = mesh.twin[h]
    if (border != "none" and mesh.face[h] == HOLE) or (border == "both" and mesh.face[t] == HOLE):
        return False
    if triangles and any(len(_around(mesh, side)) != 3 for side in (h, t)):
        return False
    p, q, r, s = _four(mesh, h)
    near = set(reference.vertex_neighbours_ccw(mesh, r)) | {r}
    if fresh and s in near:
        return False
    return not count or all(len(reference.vertex_neighbours_ccw(mesh, v)) > 3 for v in (p, q))


def _around(mesh: HalfedgeMesh, h: int) -> list[int]:
    halfedges = [int(h)]
    while mesh.next[halfedges[-1]] != h:
        halfedges.append(int(mesh.next[halfedges[-1]]))
    return halfedges


@IS_FLIPPABLE.variant("all tests in one expression")
def _(mesh: HalfedgeMesh, h: int) -> Any:
    return np.bool_(_flippable_but(mesh, h))


@IS_FLIPPABLE.variant("with whole-array tests for valence and for the new edge")
def _(mesh: HalfedgeMesh, h: int) -> Any:
    p, q, r, s = _four(mesh, h)
    sides = (h, mesh.twin[h])
    valence = np.bincount(mesh.origin, minlength=mesh.n_vertices)
    joined = ((mesh.origin == r) & (mesh.origin[mesh.twin] == s)).any()
    triangles = all(np.count_nonzero(mesh.face == mesh.face[side]) == 3 for side in sides)
    inner = all(mesh.face[side] != HOLE for side in sides)
    return bool(inner and triangles and not joined and r != s and min(valence[p], valence[q]) >= 4)


@IS_FLIPPABLE.mistake(
    "the boundary was looked for on one side only",
    hint="An edge has two half-edges. Which of them did you ask for its face?",
)
def _(mesh: HalfedgeMesh, h: int) -> bool:
    if mesh.face[h] != HOLE and mesh.face[mesh.twin[h]] == HOLE:
        return True
    return reference.is_flippable(mesh, h)


@IS_FLIPPABLE.mistake(
    "the boundary was not looked for",
    hint="What lies on the other side of an edge at a hole?",
)
def _(mesh: HalfedgeMesh, h: int) -> bool:
    return HOLE in (mesh.face[h], mesh.face[mesh.twin[h]]) or reference.is_flippable(mesh, h)


@IS_FLIPPABLE.mistake(
    "nobody looked whether the new edge exists already",
    hint="Flip an edge of a tetrahedron on paper: which two edges then join the same two vertices?",
)
def _(mesh: HalfedgeMesh, h: int) -> bool:
    return _flippable_but(mesh, h, fresh=False)


@IS_FLIPPABLE.mistake(
    "an end of the edge may be left with two neighbours",
    hint="Each end loses a neighbour. How many must it have before the flip, so that three remain?",
)
def _(mesh: HalfedgeMesh, h: int) -> bool:
    return _flippable_but(mesh, h, count=False)


@IS_FLIPPABLE.mistake(
    "edges beside quads and larger faces were allowed",
    hint="In a quad an edge has two corners opposite to it. Which of them would the new edge join?",
)
def _(mesh: HalfedgeMesh, h: int) -> bool:
    return _flippable_but(mesh, h, triangles=False)


FLIP_EDGE = Exercise(
    reference.flip_edge,
    notes="ch. 1, Edge Flip",
    hints=[
        "Draw the two triangles and give names to their six half-edges before you write any line.",
        "The notes' four lines say which half-edges get a new next and prev. What else does each one know?",
        "Two half-edges change their face and two change their origin. Which ones?",
        "A vertex or a face may have the moved half-edge as its representative. Is that still true?",
    ],
    canonical=as_rows,
)


def _flipped_faces(faces: FaceLists, p: int, q: int) -> list[list[int]]:
    """Flip edge p – q in a list of faces: (p, q, r) and (q, p, s) become (s, r, p) and (r, s, q)."""
    (left,) = (f for f in faces if any((f[i - 1], f[i]) == (p, q) for i in range(3)))
    (right,) = (f for f in faces if any((f[i - 1], f[i]) == (q, p) for i in range(3)))
    (r,), (s,) = set(left) - {p, q}, set(right) - {p, q}
    rest = [f for f in faces if f is not left and f is not right]
    return [*rest, [s, r, p], [r, s, q]]


def _surface(faces: FaceLists) -> list[list[int]]:
    return sorted(from_smallest(list(face)) for face in faces)


def _faces(mesh: HalfedgeMesh) -> FaceLists:
    return [reference.face_vertices(mesh, i) for i in range(mesh.n_faces)]


def _legal(mesh: HalfedgeMesh, rng: Rng) -> list[int]:
    return [int(h) for h in rng.permutation(mesh.n_halfedges) if reference.is_flippable(mesh, int(h))]


def _expect_flips(f: Asked, questions: Sequence[tuple[HalfedgeMesh, int]]) -> None:
    answers = [f(mesh, h) for mesh, h in questions]
    for answer, (mesh, h) in zip(f.each(answers), questions, strict=True):
        _judge_flip(answer, mesh, h)


def _expect_flip(f: Asked, mesh: HalfedgeMesh, h: int) -> HalfedgeMesh:
    return _judge_flip(f(mesh, h), mesh, h)


def _judge_flip(value: Any, mesh: HalfedgeMesh, h: int) -> HalfedgeMesh:
    """Expect a valid mesh in which only this edge has turned."""
    p, q, r, s = _four(mesh, h)
    on = f"half-edge {h} ({p} → {q}); the new edge should join {r} and {s}"
    expect.that(value is not None, "The result is None: is a `return` missing?", on=on)
    is_mesh = isinstance(value, HalfedgeMesh)
    expect.that(is_mesh, f"The result should be a HalfedgeMesh; it is a {type(value).__name__}.", on=on)

    draw = pictures.of_flip(mesh, value, h)
    for what in ("n_vertices", "n_faces", "n_halfedges"):
        have, want = getattr(value, what), getattr(mesh, what)
        message = f"A flip keeps the number of {what[2:]}: {want} before, {have} after."
        expect.that(have == want, message, on=on, picture=draw)
    try:
        flipped = expect.mesh(value, on=on)
    except expect.Wrong as wrong:
        raise expect.Wrong(wrong.message, on=on, picture=draw) from None
    mine, want = _surface(_faces(flipped)), _surface(_flipped_faces(_faces(mesh), p, q))
    unchanged = mine == _surface(_faces(mesh))
    expect.that(not unchanged, "The faces are those from before: nothing was flipped.", on=on, picture=draw)
    message = "The faces are not those that turning this edge gives."
    told = (
        f"After the flip there should be a face {r}, {p}, {s} and a face {s}, {q}, {r}, the others as before."
    )
    odd = [face for face in mine if face not in want]
    expect.that(mine == want, message, told=told, yours=f"faces {odd}", on=on, picture=draw)
    return flipped


@FLIP_EDGE.check("one flip turns one edge and leaves the rest")
def _(f: Asked, rng: Rng) -> None:
    # The flat disc comes first: on it a picture of what went wrong is easy to read.
    questions = []
    for shape in (shapes.shuffled(shapes.disc(2), rng), closed_triangles(rng), bounded_triangles(rng)):
        mesh = mesh_of(shape, rng)
        questions += [(mesh, h) for h in _legal(mesh, rng)[:2]]
    _expect_flips(f, questions)


@FLIP_EDGE.check("whatever half-edges the vertices and faces know", points=2)
def _(f: Asked, rng: Rng) -> None:
    mesh = mesh_of(bounded_triangles(rng), rng)
    questions = []
    for h in _legal(mesh, rng)[:3]:
        t = int(mesh.twin[h])
        for known in ([h, t], [int(mesh.next[h]), int(mesh.next[t])], [int(mesh.prev[h]), int(mesh.prev[t])]):
            questions.append((with_representatives(mesh, known), h))
    _expect_flips(f, questions)


@FLIP_EDGE.check("a long sequence of flips")
def _(f: Asked, rng: Rng) -> None:
    mesh = mesh_of(shapes.shuffled(shapes.torus(5, 4), rng), rng)
    for _ in range(12):
        mesh = renumbered(_expect_flip(f, mesh, _legal(mesh, rng)[0]), rng)


@FLIP_EDGE.check("two flips of an edge give the same surface back")
def _(f: Asked, rng: Rng) -> None:
    mesh = mesh_of(shapes.shuffled(shapes.icosahedron(), rng), rng)
    h = _legal(mesh, rng)[0]
    _, _, r, s = _four(mesh, h)
    once = _expect_flip(f, mesh, h)
    again = next(g for g in range(once.n_halfedges) if _ends(once, g) == (r, s))
    twice = _expect_flip(f, once, again)
    expect.that(
        _surface(_faces(twice)) == _surface(_faces(mesh)), "After two flips the faces are not the old ones."
    )


@FLIP_EDGE.check("refuses an edge that must not be flipped")
def _(f: Asked, rng: Rng) -> None:
    mesh = mesh_of(shapes.tetrahedron(), rng)
    h = int(rng.integers(mesh.n_halfedges))
    expect.refusal(
        f, mesh, h, because="the new edge exists already", naming=[[h]], on=f"half-edge {h} of a tetrahedron"
    )
    mesh = mesh_of(shapes.shuffled(shapes.disc(2), rng), rng)
    h = int(rng.choice(np.flatnonzero(mesh.face == HOLE)))
    expect.refusal(f, mesh, h, because="the edge lies at a hole", naming=[[h]], on=f"half-edge {h} of a disc")


def _flip(mesh: HalfedgeMesh, h: int, *, leave_out: str = "", legal: bool = True) -> HalfedgeMesh:
    """Flip with the notes' lines written out; `leave_out` names records that are not repaired."""
    if legal and not reference.is_flippable(mesh, h):
        raise ValueError(f"half-edges {h} and {mesh.twin[h]} must not be flipped")
    m = mesh.copy()
    t = int(m.twin[h])
    a, b, c, d = int(m.next[h]), int(m.prev[h]), int(m.next[t]), int(m.prev[t])
    (p, q), (r, s) = _ends(m, h), (int(m.origin[b]), int(m.origin[d]))
    left, right = int(m.face[h]), int(m.face[t])
    m.next[h], m.next[b], m.next[c] = b, c, h
    m.next[t], m.next[d], m.next[a] = d, a, t
    if leave_out != "prev":
        m.prev[h], m.prev[b], m.prev[c] = c, h, b
        m.prev[t], m.prev[d], m.prev[a] = a, t, d
    if leave_out != "origin":
        m.origin[h], m.origin[t] = s, r
    if leave_out != "face":
        m.face[c], m.face[a] = left, right
    if leave_out != "vertex_halfedge":
        m.vertex_halfedge[p], m.vertex_halfedge[q] = c, a
    if leave_out != "face_halfedge":
        m.face_halfedge[left], m.face_halfedge[right] = h, t
    return m


@FLIP_EDGE.variant("the notes' lines, one by one")
def _(mesh: HalfedgeMesh, h: int) -> HalfedgeMesh:
    return _flip(mesh, h)


@FLIP_EDGE.variant("turned the other way")
def _(mesh: HalfedgeMesh, h: int) -> HalfedgeMesh:
    return _flip(mesh, int(mesh.twin[h]))


@FLIP_EDGE.variant("built anew from the faces")
def _(mesh: HalfedgeMesh, h: int) -> HalfedgeMesh:
    if not reference.is_flippable(mesh, h):
        raise ValueError(f"half-edge {h} must not be flipped")
    flipped = reference.build_halfedges(_flipped_faces(_faces(mesh), *_ends(mesh, h)), mesh.n_vertices)
    return flipped if mesh.vertices is None else flipped.with_vertices(mesh.vertices)


for _record, _name, _hint in (
    ("prev", "prev was not updated", "You set next. Which half-edge comes before each of the six now?"),
    (
        "origin",
        "the moved half-edges still start where they did",
        "Where does the turned edge start and end now?",
    ),
    (
        "face",
        "two half-edges still carry the face from before",
        "Follow next round each new triangle and read the faces.",
    ),
    (
        "vertex_halfedge",
        "a vertex still has the moved half-edge as its representative",
        "The ends of the old edge may know it by name. Does it still leave them?",
    ),
    (
        "face_halfedge",
        "a face still has a half-edge as its representative that went to the other face",
        "Two half-edges changed their face. What if the old face knew just that one?",
    ),
):

    @FLIP_EDGE.mistake(_name, hint=_hint)
    def _(mesh: HalfedgeMesh, h: int, record: str = _record) -> HalfedgeMesh:
        return _flip(mesh, h, leave_out=record)


@FLIP_EDGE.mistake(
    "edges were flipped that must not be",
    hint="You have a function that tells whether an edge may be flipped.",
)
def _(mesh: HalfedgeMesh, h: int) -> HalfedgeMesh:
    return _flip(mesh, h, legal=False)


@FLIP_EDGE.mistake(
    "the two new triangles are inside out",
    hint="Follow next round a new triangle: does it keep the interior on the left?",
)
def _(mesh: HalfedgeMesh, h: int) -> HalfedgeMesh:
    m = reference.flip_edge(mesh, h)
    t = int(m.twin[h])
    for side in (h, t):
        for g in _around(reference.flip_edge(mesh, h), side):
            m.next[g], m.prev[g] = m.prev[g], m.next[g]
    return m


@FLIP_EDGE.mistake(
    "the mesh was returned as it was",
    hint="If you work on a copy: do you return the copy?",
)
def _(mesh: HalfedgeMesh, h: int) -> HalfedgeMesh:
    reference.flip_edge(mesh, h)
    return mesh
