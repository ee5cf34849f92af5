"""Exercises on building half-edges."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gpcourse.errors import GeometryError
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
    hole_cycles,
    n_edges,
    with_isolated_vertices,
)
from gpcourse.exercises.judging import Asked
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import FloatArray
from gpcourse.geometry.halfedge_mesh import HOLE, NONE, HalfedgeMesh
from gpcourse.reference import halfedge as reference

BUILD_HALFEDGES = Exercise(
    reference.build_halfedges,
    notes="ch. 1, Half-edge Data Structure",
    hints=[
        "Give every corner of every face one half-edge, from that corner to the next. "
        "Which of the records can you fill in without looking at another face?",
        "The twin runs between the same two vertices, the other way. "
        "A dictionary from (tail, head) to the half-edge finds it at once.",
        "A half-edge without a twin borders a hole. Add its twin, with face -1. Where does that one start?",
        "Along a hole, the next half-edge starts where this one ends. Which one starts there?",
    ],
    canonical=as_rows,
)


def _expect_built(f: Asked, vertices: FloatArray, faces: FaceLists, on: str) -> HalfedgeMesh:
    """Expect records that agree with each other, with the faces and with the holes of the input.

    The function is asked for the connectivity only; the positions are for the picture.
    """
    n = len(vertices)
    value = f(faces, n)
    expect.that(value is not None, "The result is None: is a `return` missing?", on=on)
    is_mesh = isinstance(value, HalfedgeMesh)
    expect.that(is_mesh, f"The result should be a HalfedgeMesh; it is a {type(value).__name__}.", on=on)
    counts = (("vertices", value.n_vertices, n), ("faces", value.n_faces, len(faces)))
    for what, have, want in counts:
        message = f"The mesh has {have} {what}, not as many as the input."
        expect.that(have == want, message, told=f"The mesh has {have} {what}; it should have {want}.", on=on)
    edges = n_edges(faces)
    message = f"There are {value.n_halfedges} half-edges. Each edge has two: one on each side."
    told = f"There are {value.n_halfedges} half-edges for {edges} edges. Each edge has two: one on each side."
    expect.that(value.n_halfedges == 2 * edges, message, told=told, on=on)
    mesh = expect.mesh(value, on=on, picture=lambda h: pictures.of_twin(value, vertices, h))
    for i, corners in enumerate(faces):
        mine = reference.face_vertices(mesh, i)
        details = {"yours": str(mine), "truth": str(corners), "on": on}
        expect.that(
            expect.cyclic_equal(mine, corners), f"Walking along next round face {i} goes wrong.", **details
        )
    holes = len(hole_cycles(faces))
    found = len(reference.boundary_loops(mesh))
    message = f"Walking along the holes finds {found} of them, which is not right."
    told = f"Walking along the holes finds {found} of them; there are {holes}."
    expect.that(found == holes, message, told=told, on=on)
    return mesh


@BUILD_HALFEDGES.check("a tetrahedron and a closed mesh of triangles")
def _(f: Asked, rng: Rng) -> None:
    tetrahedron = shapes.tetrahedron()
    _expect_built(f, tetrahedron.vertices, face_lists(tetrahedron), "a tetrahedron")
    shape = closed_triangles(rng)
    _expect_built(f, shape.vertices, face_lists(shape), "a closed mesh of triangles")


@BUILD_HALFEDGES.check("polygons of several sizes")
def _(f: Asked, rng: Rng) -> None:
    shape = closed_polygons(rng)
    _expect_built(f, shape.vertices, face_lists(shape), "a prism")


@BUILD_HALFEDGES.check("holes carry half-edges, linked into loops", points=2)
def _(f: Asked, rng: Rng) -> None:
    _expect_built(f, np.eye(3), [[0, 1, 2]], "a single triangle")
    shape = bounded_triangles(rng)
    _expect_built(f, shape.vertices, face_lists(shape), "a mesh of triangles with holes")


@BUILD_HALFEDGES.check("several components and isolated vertices")
def _(f: Asked, rng: Rng) -> None:
    both = shapes.shuffled(shapes.union(shapes.octahedron(), shapes.disc(2)), rng)
    vertices, faces, _ = with_isolated_vertices(both, rng)
    _expect_built(f, vertices, faces, "an octahedron, a disc and three isolated vertices")


@BUILD_HALFEDGES.check("refuses what is not an oriented manifold, and says where", points=2)
def _(f: Asked, rng: Rng) -> None:
    n = 20
    a, b, *others = (int(v) for v in rng.permutation(n)[:5])
    book = [[a, b, others[0]], [b, a, others[1]], [a, b, others[2]]]
    message = f"edge {a} – {b} belongs to three faces"
    expect.refusal(f, book, n, because=message, naming=[[a, b], [0, 1, 2]], on=f"faces {book}")
    same = [[a, b, others[0]], [a, b, others[1]]]
    message = f"faces 0 and 1 both run from {a} to {b}"
    expect.refusal(f, same, n, because=message, naming=[[a, b], [0, 1]], on=f"faces {same}")
    outside = [[0, 1, 2], [0, 2, n]]
    message = f"face 1 names vertex {n}, and there are {n} vertices"
    expect.refusal(f, outside, n, because=message, naming=[[1], [n]], on=f"faces {outside}")
    repeated = [[0, 1, 2], [2, 1, 3], [a, b, a]]
    message = f"face 2 names vertex {a} twice"
    expect.refusal(f, repeated, n, because=message, naming=[[2], [a]], on=f"faces {repeated}")
    strip = [[int(v) for v in face] for face in shapes.moebius(7).faces]
    expect.refusal(
        f,
        strip,
        len(shapes.moebius(7).vertices),
        because="a Möbius strip has no orientation",
        on="a Möbius strip",
    )


@BUILD_HALFEDGES.variant("a dictionary from (tail, head) to half-edge, in plain loops")
def _(faces: FaceLists, n_vertices: int) -> HalfedgeMesh:
    side: dict[tuple[int, int], int] = {}
    next_: list[int] = []
    prev: list[int] = []
    origin: list[int] = []
    face: list[int] = []
    for f, corners in enumerate(faces):
        first, k = len(origin), len(corners)
        if len(set(corners)) < k:
            raise ValueError(f"face {f} names a vertex twice")
        for i, v in enumerate(corners):
            if not 0 <= v < n_vertices:
                raise ValueError(f"face {f} names vertex {v}")
            w = corners[(i + 1) % k]
            if (v, w) in side:
                raise ValueError(f"faces {face[side[v, w]]} and {f} both run along edge {v} -> {w}")
            side[v, w] = len(origin)
            next_.append(first + (i + 1) % k)
            prev.append(first + (i - 1) % k)
            origin.append(int(v))
            face.append(f)
    border = [(v, w) for (v, w) in side if (w, v) not in side]
    leaving = {w: len(origin) + i for i, (v, w) in enumerate(border)}
    for v, w in border:
        side[w, v] = leaving[w]
        origin.append(w)
        face.append(HOLE)
        next_.append(leaving[v])
        prev.append(NONE)
    for h in leaving.values():
        prev[next_[h]] = h
    twin = [NONE] * len(origin)
    for (v, w), h in side.items():
        twin[h] = side[w, v]
    of_vertex, of_face = [NONE] * n_vertices, [NONE] * len(faces)
    for h in range(len(origin)):
        of_vertex[origin[h]] = h
        if face[h] != HOLE:
            of_face[face[h]] = h
    records = [np.array(r, dtype=int) for r in (twin, next_, prev, origin, face, of_vertex, of_face)]
    return HalfedgeMesh(*records)


@BUILD_HALFEDGES.variant("the half-edges of the holes first")
def _(faces: FaceLists, n_vertices: int) -> HalfedgeMesh:
    mesh = reference.build_halfedges(faces, n_vertices)
    new = np.arange(mesh.n_halfedges)[::-1]
    backwards = {name: new[getattr(mesh, name)][::-1] for name in ("twin", "next", "prev")}
    linked = mesh.vertex_halfedge != NONE
    return HalfedgeMesh(
        **backwards,
        origin=mesh.origin[::-1],
        face=mesh.face[::-1],
        vertex_halfedge=np.where(linked, new[mesh.vertex_halfedge], NONE),
        face_halfedge=new[mesh.face_halfedge],
    )


@BUILD_HALFEDGES.mistake(
    "the half-edges along holes are missing",
    hint="What is the twin of a half-edge at the boundary? Try to walk around its vertex without one.",
)
def _(faces: FaceLists, n_vertices: int) -> HalfedgeMesh:
    mesh = reference.build_halfedges(faces, n_vertices)
    inside = int(np.count_nonzero(mesh.face != HOLE))
    of_vertex = np.full(n_vertices, NONE)
    of_vertex[mesh.origin[:inside]] = np.arange(inside)
    return HalfedgeMesh(
        twin=np.where(mesh.twin[:inside] < inside, mesh.twin[:inside], NONE),
        next=mesh.next[:inside],
        prev=mesh.prev[:inside],
        origin=mesh.origin[:inside],
        face=mesh.face[:inside],
        vertex_halfedge=of_vertex,
        face_halfedge=mesh.face_halfedge,
    )


@BUILD_HALFEDGES.mistake(
    "a twin was chosen by the vertex that it starts from alone",
    hint="Many half-edges leave one vertex. Which of them comes back to where this half-edge started?",
)
def _(faces: FaceLists, n_vertices: int) -> HalfedgeMesh:
    mesh = reference.build_halfedges(faces, n_vertices)
    return replace(mesh, twin=mesh.vertex_halfedge[mesh.origin[mesh.twin]])


@BUILD_HALFEDGES.mistake(
    "the half-edges of a hole are linked the wrong way round",
    hint="Stand on a half-edge of a hole. Where does it end, and which half-edge of the hole starts there?",
)
def _(faces: FaceLists, n_vertices: int) -> HalfedgeMesh:
    mesh = reference.build_halfedges(faces, n_vertices)
    hole = mesh.face == HOLE
    return replace(mesh, next=np.where(hole, mesh.prev, mesh.next), prev=np.where(hole, mesh.next, mesh.prev))


@BUILD_HALFEDGES.mistake(
    "the half-edges of a hole run in the direction of the face beside them",
    hint="A half-edge and its twin run in opposite directions. Where does the twin at the boundary start?",
)
def _(faces: FaceLists, n_vertices: int) -> HalfedgeMesh:
    mesh = reference.build_halfedges(faces, n_vertices)
    return replace(mesh, origin=np.where(mesh.face == HOLE, mesh.origin[mesh.twin], mesh.origin))


@BUILD_HALFEDGES.mistake(
    "the half-edges of a hole carry the face on the other side of the edge",
    hint="Which face lies to the left of a half-edge that runs along a hole?",
)
def _(faces: FaceLists, n_vertices: int) -> HalfedgeMesh:
    mesh = reference.build_halfedges(faces, n_vertices)
    return replace(mesh, face=np.where(mesh.face == HOLE, mesh.face[mesh.twin], mesh.face))


@BUILD_HALFEDGES.mistake(
    "next and prev are swapped",
    hint="Draw one face with its corners in the order of the list. Where does `next` lead?",
)
def _(faces: FaceLists, n_vertices: int) -> HalfedgeMesh:
    mesh = reference.build_halfedges(faces, n_vertices)
    return replace(mesh, next=mesh.prev, prev=mesh.next)


@BUILD_HALFEDGES.mistake(
    "an isolated vertex was given half-edge 0",
    hint="What does your array of representatives hold before anything is written into it?",
)
def _(faces: FaceLists, n_vertices: int) -> HalfedgeMesh:
    mesh = reference.build_halfedges(faces, n_vertices)
    return replace(mesh, vertex_halfedge=np.maximum(mesh.vertex_halfedge, 0))


@BUILD_HALFEDGES.mistake(
    "every face was taken for a triangle",
    hint="How many corners does face 0 of a cube have?",
)
def _(faces: FaceLists, n_vertices: int) -> HalfedgeMesh:
    for _a, _b, _c in faces:
        pass
    return reference.build_halfedges(faces, n_vertices)


@BUILD_HALFEDGES.mistake(
    "bad faces were not refused",
    hint="A dictionary quietly overwrites an entry that is there already. What does that mean for your mesh?",
)
def _(faces: FaceLists, n_vertices: int) -> HalfedgeMesh:
    try:
        return reference.build_halfedges(faces, n_vertices)
    except ValueError:
        return reference.build_halfedges([], n_vertices)


def _cube_features(arguments: tuple[Any, ...], value: Any) -> list[Any]:
    """Canonical form of a cube: what does not depend on labels, size or position."""
    vertices, faces = _vertices_and_faces(value)
    sides = [(f[i - 1], f[i]) for f in faces for i in range(len(f))]
    edges = {frozenset(side) for side in sides}
    lengths = sorted(float(np.linalg.norm(vertices[a] - vertices[b])) for a, b in sides)
    return [
        len(vertices),
        sorted(len(f) for f in faces),
        len(edges),
        len(set(sides)),
        float(np.sign(_volume(vertices, faces))),
        [round(length / lengths[0], 6) for length in lengths],
    ]


def _vertices_and_faces(value: Any) -> tuple[FloatArray, FaceLists]:
    if isinstance(value, HalfedgeMesh) and value.vertices is not None:
        value.validate()
        return value.vertices, [reference.face_vertices(value, f) for f in range(value.n_faces)]
    vertices, faces = value
    return np.asarray(vertices, dtype=float), [[int(v) for v in face] for face in faces]


def _volume(vertices: FloatArray, faces: FaceLists) -> float:
    """Sum the signed volumes of the tetrahedra from the first vertex over fans of the faces."""
    x = vertices - vertices[0]
    fans = [(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)]
    return sum(float(np.linalg.det(x[list(fan)])) for fan in fans) / 6


CUBE = Exercise(
    reference.cube,
    notes="coursework 1, question 1",
    hints=[
        "Draw the cube and number its corners. Then write down each face as seen from outside.",
        "Neighbouring faces run along their common edge in opposite directions. Check one edge by hand.",
        "Seen from outside, the corners of the bottom go the other way round than from above.",
    ],
    canonical=_cube_features,
)


def _cube_parts(f: Asked) -> tuple[FloatArray, FaceLists]:
    value = f()
    expect.that(value is not None, "The result is None: is a `return` missing?")
    if isinstance(value, HalfedgeMesh):
        expect.that(value.vertices is not None, "The mesh has no positions.")
        return _vertices_and_faces(expect.mesh(value))
    pair = isinstance(value, (tuple, list)) and len(value) == 2
    expect.that(pair, "The result should be a pair (vertices, faces).", yours=expect.brief(value))
    vertices = expect.array(value[0], (8, 3), "The vertex array")
    return vertices, expect.polygons(value[1], 8)


@CUBE.check("six quads")
def _(f: Asked, rng: Rng) -> None:
    _, faces = _cube_parts(f)
    sizes = [len(face) for face in faces]
    expect.that(
        sizes == [4] * 6, "A cube has six faces with four corners each.", yours=f"faces with {sizes} corners"
    )


@CUBE.check("the faces close up and run in opposite directions along every edge")
def _(f: Asked, rng: Rng) -> None:
    vertices, faces = _cube_parts(f)
    try:
        mesh = reference.build_halfedges(faces, len(vertices))
    except GeometryError as error:
        drawn = pictures.of_surface(vertices, faces)
        raise expect.Wrong(f"The faces do not fit together: {error}.", picture=drawn) from None
    open_sides = np.flatnonzero(mesh.face == HOLE)
    if len(open_sides):
        a, b = mesh.origin[open_sides[0]], mesh.origin[mesh.twin[open_sides[0]]]
        message = f"Edge {a} – {b} has a face on one side only."
        raise expect.Wrong(message, picture=pictures.of_surface(vertices, faces, [int(a), int(b)]))


@CUBE.check("it is a cube: square faces, all of one size")
def _(f: Asked, rng: Rng) -> None:
    vertices, faces = _cube_parts(f)
    for i, face in enumerate(faces):
        corners = vertices[face]
        drawn = pictures.of_surface(vertices, faces, face)
        expect.that(len(face) == 4, f"Face {i} has {len(face)} corners.", picture=drawn)
        sides = np.roll(corners, -1, axis=0) - corners
        length = np.linalg.norm(vertices[faces[0][1]] - vertices[faces[0][0]])
        # Rounding in eight coordinates is about 1e-16 of the size; 1e-6 also admits float32.
        equal = np.abs(np.linalg.norm(sides, axis=1) - length) <= 1e-6 * length
        right = np.abs((sides * np.roll(sides, -1, axis=0)).sum(axis=1)) <= 1e-6 * length**2
        expect.that(
            length > 0 and equal.all() and right.all(),
            f"Face {i} is not a square with sides {length:.3g}, as long as the first side of face 0.",
            yours=expect.brief(corners),
            picture=pictures.of_surface(vertices, faces, face),
        )


@CUBE.check("the faces are counter-clockwise seen from outside")
def _(f: Asked, rng: Rng) -> None:
    vertices, faces = _cube_parts(f)
    volume = _volume(vertices, faces)
    size = float(np.ptp(vertices, axis=0).max())
    drawn = pictures.of_surface(vertices, faces)
    message = "The faces, some turned in and some out, enclose no volume."
    expect.that(abs(volume) > 1e-3 * size**3, message, picture=drawn)
    expect.that(
        volume > 0,
        "Every face is clockwise seen from outside: the cube is inside out.",
        yours=f"volume {volume:.3g}",
        picture=drawn,
    )


@CUBE.variant("from -1 to 1, faces found by their centres")
def _() -> tuple[Any, Any]:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    faces = []
    for axis in range(3):
        for sign in (-1, 1):
            face = [i for i in range(8) if corners[i, axis] == sign]
            a, b, c, d = face[0], face[1], face[3], face[2]
            normal = np.cross(corners[b] - corners[a], corners[c] - corners[b])
            faces.append((a, b, c, d) if normal[axis] * sign > 0 else (a, d, c, b))
    return corners.tolist(), tuple(faces)


@CUBE.variant("as a half-edge mesh, turned and moved")
def _() -> Any:
    c, s = np.cos(0.3), np.sin(0.3)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    vertices, faces = reference.cube()
    return reference.halfedge_mesh(100 * vertices @ turn.T + [7, -3, 2], faces)


@CUBE.mistake(
    "one face is turned inside out",
    hint="Look at that face from outside. In which sense do its corners follow each other?",
)
def _() -> tuple[Any, Any]:
    vertices, faces = reference.cube()
    return vertices, [faces[0][::-1], *faces[1:]]


@CUBE.mistake(
    "the whole cube is inside out",
    hint="Put your right thumb along the outward normal: your fingers show the order of the corners.",
)
def _() -> tuple[Any, Any]:
    vertices, faces = reference.cube()
    return vertices, [face[::-1] for face in faces]


@CUBE.mistake(
    "the squares were cut into triangles",
    hint="A face may have more than three corners. What does the question ask for?",
)
def _() -> tuple[Any, Any]:
    vertices, faces = reference.cube()
    return vertices, [part for a, b, c, d in faces for part in ([a, b, c], [a, c, d])]


@CUBE.mistake(
    "the corners of each face are listed row by row instead of around the face",
    hint="Draw one face and follow the list of its corners with a pen. Do you cross your own line?",
)
def _() -> tuple[Any, Any]:
    vertices, faces = reference.cube()
    return vertices, [[a, b, d, c] for a, b, c, d in faces]
