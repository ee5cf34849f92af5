"""Exercises on the dual, and on counting elements."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from gpcourse.exercises import expect
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.halfedge import pictures
from gpcourse.exercises.halfedge.inputs import (
    FaceLists,
    Rng,
    bounded_triangles,
    closed_polygons,
    closed_triangles,
    face_lists,
    from_smallest,
    mesh_of,
    n_edges,
    positions,
    renumbered,
    with_isolated_vertices,
)
from gpcourse.exercises.judging import Asked
from gpcourse.exercises.pictures import Positions
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import FloatArray
from gpcourse.geometry.halfedge_mesh import HOLE, NONE, HalfedgeMesh
from gpcourse.reference import halfedge as reference

# The dual ---------------------------------------------------------------------------------------


def _as_dual(arguments: tuple[Any, ...], value: Any) -> list[Any]:
    vertices, faces = value
    return [np.asarray(vertices, dtype=float), [from_smallest([int(f) for f in face]) for face in faces]]


DUAL_MESH = Exercise(
    reference.dual_mesh,
    notes="ch. 1, Dual Graph",
    hints=[
        "Every face becomes a vertex. You can compute its position already.",
        "Every vertex becomes a face. Which faces of the mesh become its corners, and in which order?",
        "Walk around the vertex as in vertex_neighbours_ccw, but read another record.",
        "At a boundary the faces do not close up round the vertex. What should your function say then?",
    ],
    canonical=_as_dual,
)


def _expect_dual(f: Asked, mesh: HalfedgeMesh, faces: FaceLists, on: str) -> tuple[FloatArray, FaceLists]:
    value = f(mesh)
    expect.that(value is not None, "The result is None: is a `return` missing?", on=on)
    pair = isinstance(value, (tuple, list)) and len(value) == 2
    expect.that(pair, "The result should be a pair (vertices, faces).", yours=expect.brief(value), on=on)
    vertices = expect.array(value[0], (len(faces), 3), "The dual's vertex array", on=on)
    rows = value[1]
    length = len(rows) if hasattr(rows, "__len__") else -1
    message = f"The dual has {length} faces; there should be one for each vertex."
    told = f"The dual has {length} faces; there should be one for each of the {mesh.n_vertices} vertices."
    expect.that(length == mesh.n_vertices, message, told=told, on=on)
    mine = expect.polygons(rows, len(faces), "The faces of the dual", on=on)
    centroids = np.array([positions(mesh)[face].mean(axis=0) for face in faces])
    size = float(np.abs(positions(mesh)).max())
    # A mean is rounded by about 1e-16 of the largest coordinate; 1e-6 also admits float32.
    what, shown = "The vertices of the dual, which are centroids", Positions(None, None)
    expect.close(vertices, centroids, 1e-6 * size, what, on=on, shown=shown)
    for v, face in enumerate(mine):
        want = [i for i, corners in enumerate(faces) if v in corners]
        draw = pictures.of_surface(vertices, mine, face)
        details: dict[str, Any] = {"yours": str(face), "on": on, "picture": draw}
        message = f"Face {v} of the dual should name the faces around vertex {v}."
        expect.that(sorted(face) == want, message, truth=f"the faces {want}", **details)
        ring = _faces_around(faces, v)
        if len(ring) > 2 and expect.cyclic_equal(face, ring[::-1]):
            raise expect.Wrong(f"Face {v} of the dual is clockwise seen from outside.", **details)
        message = f"Face {v} of the dual has the right corners in an order that does not go round."
        expect.that(expect.cyclic_equal(face, ring), message, **details)
    return vertices, mine


def _faces_around(faces: FaceLists, v: int) -> list[int]:
    """List the faces around an inner vertex counter-clockwise, from the faces alone."""
    leaving = {face[(face.index(v) + 1) % len(face)]: i for i, face in enumerate(faces) if v in face}
    arriving = {i: faces[i][faces[i].index(v) - 1] for i in leaving.values()}
    ring = [next(iter(arriving))]
    while len(ring) < len(arriving):
        ring.append(leaving[arriving[ring[-1]]])
    return ring


@DUAL_MESH.check("the dual of a cube is an octahedron")
def _(f: Asked, rng: Rng) -> None:
    cube = shapes.cube()
    vertices, faces = _expect_dual(f, mesh_of(cube, rng), face_lists(cube), "a cube")
    lengths = np.array([np.linalg.norm(vertices[a] - vertices[b]) for a, b, _ in faces])
    expect.close(
        lengths, np.full(8, lengths[0]), 1e-6, "The edges of the octahedron, which are all of one length"
    )


@DUAL_MESH.check("triangles and polygons")
def _(f: Asked, rng: Rng) -> None:
    for shape in (closed_triangles(rng), closed_polygons(rng)):
        _expect_dual(f, mesh_of(shape, rng), face_lists(shape), f"a closed mesh of {len(shape.faces)} faces")


@DUAL_MESH.check("the dual of the dual joins the vertices as before")
def _(f: Asked, rng: Rng) -> None:
    shape = shapes.shuffled(shapes.icosphere(1), rng)
    mesh = mesh_of(shape, rng)
    vertices, faces = _expect_dual(f, mesh, face_lists(shape), "an icosphere")
    again = renumbered(reference.halfedge_mesh(vertices, faces), rng)
    _, twice = _expect_dual(f, again, faces, "the dual of an icosphere")
    same = [from_smallest(face) for face in twice] == [from_smallest(face) for face in face_lists(shape)]
    expect.that(same, "The dual of the dual has other faces than the icosphere.")


@DUAL_MESH.check("a mesh with a hole has no dual")
def _(f: Asked, rng: Rng) -> None:
    mesh = mesh_of(shapes.shuffled(shapes.disc(2), rng), rng)
    expect.refusal(f, mesh, because="the mesh is a disc, whose border has no dual faces", on="a disc")


@DUAL_MESH.variant("by relabelling: the dual face of v lists the faces met by he.prev.twin")
def _(mesh: HalfedgeMesh) -> Any:
    if (mesh.face == HOLE).any():
        raise ValueError("only a closed mesh has a dual")
    sums = np.zeros((mesh.n_faces, 3))
    np.add.at(sums, mesh.face, positions(mesh)[mesh.origin])
    step = mesh.twin[mesh.prev]
    faces = []
    for start in mesh.vertex_halfedge:
        ring, h = [mesh.face[start]], step[start]
        while h != start:
            ring.append(mesh.face[h])
            h = step[h]
        faces.append(np.array(ring))
    return sums / np.bincount(mesh.face)[:, None], faces


@DUAL_MESH.variant("clockwise, then turned round")
def _(mesh: HalfedgeMesh) -> Any:
    vertices, faces = reference.dual_mesh(mesh)
    return vertices.tolist(), [tuple(face[2:] + face[:2]) for face in faces]


@DUAL_MESH.mistake(
    "the faces of the dual are clockwise",
    hint="In which sense did you walk around the vertex?",
)
def _(mesh: HalfedgeMesh) -> Any:
    vertices, faces = reference.dual_mesh(mesh)
    return vertices, [face[::-1] for face in faces]


@DUAL_MESH.mistake(
    "the faces around a vertex are listed by number, not in the order in which they go round",
    hint="Draw the polygon that your list describes. Do its sides cross?",
)
def _(mesh: HalfedgeMesh) -> Any:
    vertices, faces = reference.dual_mesh(mesh)
    return vertices, [sorted(face) for face in faces]


@DUAL_MESH.mistake(
    "the faces of the dual name neighbouring vertices instead of faces",
    hint="The corners of a dual face are faces of the mesh. Which record of a half-edge tells its face?",
)
def _(mesh: HalfedgeMesh) -> Any:
    vertices, _ = reference.dual_mesh(mesh)
    return vertices, [reference.vertex_neighbours_ccw(mesh, v) for v in range(mesh.n_vertices)]


@DUAL_MESH.mistake(
    "the vertices of the dual are the vertices of the mesh",
    hint="A face becomes a point. Which point stands for a face?",
)
def _(mesh: HalfedgeMesh) -> Any:
    return mesh.vertices, reference.dual_mesh(mesh)[1]


@DUAL_MESH.mistake(
    "every centroid was taken of three corners",
    hint="How many corners does a face of your mesh have?",
)
def _(mesh: HalfedgeMesh) -> Any:
    _, faces = reference.dual_mesh(mesh)
    three = [reference.face_vertices(mesh, f)[:3] for f in range(mesh.n_faces)]
    return positions(mesh)[np.array(three)].mean(axis=1), faces


@DUAL_MESH.mistake(
    "a mesh with a hole was not refused",
    hint="What does the face of a half-edge along a hole hold, and where does that index point?",
)
def _(mesh: HalfedgeMesh) -> Any:
    try:
        return reference.dual_mesh(mesh)
    except ValueError:
        return np.empty((0, 3)), []


# Counting ---------------------------------------------------------------------------------------

EULER_CHARACTERISTIC = Exercise(
    reference.euler_characteristic,
    notes="ch. 1, Euler–Poincaré Formula",
    hints=[
        "Count vertices, edges and faces of a tetrahedron by hand. What should come out?",
        "How many half-edges does an edge have, also at a hole?",
        "A vertex that no face uses is not part of the surface. How do you recognise it?",
    ],
)


def _expect_numbers(f: Asked, what: str, questions: list[tuple[HalfedgeMesh, int, str]]) -> None:
    """Ask all questions before the first answer is judged: one number alone fits several mistakes."""
    answers = [f(mesh) for mesh, _, _ in questions]
    for answer, (_, want, on) in zip(f.each(answers), questions, strict=True):
        mine = expect.integer(answer, what, on=on)
        expect.that(mine == want, f"{what} is not right.", yours=str(mine), truth=str(want), on=on)


def _euler(faces: FaceLists) -> int:
    """Count V − E + F from the faces alone."""
    return len({v for face in faces for v in face}) - n_edges(faces) + len(faces)


_CHI = "The Euler characteristic"


@EULER_CHARACTERISTIC.check("closed surfaces: sphere, torus, double torus")
def _(f: Asked, rng: Rng) -> None:
    truths = (
        (shapes.icosahedron(), 2, "a sphere"),
        (shapes.torus(5, 4, quads=True), 0, "a torus of quads"),
        (shapes.genus_surface(2), -2, "a double torus"),
    )
    _expect_numbers(f, _CHI, [(mesh_of(shapes.shuffled(s, rng), rng), chi, on) for s, chi, on in truths])


@EULER_CHARACTERISTIC.check("surfaces with holes")
def _(f: Asked, rng: Rng) -> None:
    surfaces = (
        (shapes.disc(2), "a disc"),
        (shapes.annulus(), "an annulus"),
        (bounded_triangles(rng), "a torus with two holes"),
    )
    _expect_numbers(f, _CHI, [(mesh_of(s, rng), _euler(face_lists(s)), on) for s, on in surfaces])


@EULER_CHARACTERISTIC.check("several components, and vertices that belong to no face")
def _(f: Asked, rng: Rng) -> None:
    both = shapes.union(shapes.octahedron(), shapes.disc(2))
    vertices, faces, _ = with_isolated_vertices(both, rng)
    mesh = renumbered(reference.halfedge_mesh(vertices, faces), rng)
    _expect_numbers(f, _CHI, [(mesh, 3, "an octahedron, a disc and three isolated vertices")])


@EULER_CHARACTERISTIC.variant("from unique edges")
def _(mesh: HalfedgeMesh) -> Any:
    ends = np.sort(np.column_stack([mesh.origin, mesh.origin[mesh.twin]]), axis=1)
    return float(len(np.unique(mesh.origin)) - len(np.unique(ends, axis=0)) + mesh.n_faces)


@EULER_CHARACTERISTIC.variant("with a set of edges, as numpy integer")
def _(mesh: HalfedgeMesh) -> Any:
    edges = {frozenset((h, int(mesh.twin[h]))) for h in range(mesh.n_halfedges)}
    return np.int32(len(set(mesh.origin.tolist())) - len(edges) + len(mesh.face_halfedge))


def _count(mesh: HalfedgeMesh) -> tuple[int, int, int]:
    return int(np.count_nonzero(mesh.vertex_halfedge != NONE)), mesh.n_halfedges // 2, mesh.n_faces


@EULER_CHARACTERISTIC.mistake(
    "half-edges were counted as edges",
    hint="How many half-edges run along one edge?",
)
def _(mesh: HalfedgeMesh) -> Any:
    V, E, F = _count(mesh)
    return V - 2 * E + F


@EULER_CHARACTERISTIC.mistake(
    "isolated vertices were counted",
    hint="Is a vertex that no face uses part of the surface?",
)
def _(mesh: HalfedgeMesh) -> Any:
    _, E, F = _count(mesh)
    return mesh.n_vertices - E + F


@EULER_CHARACTERISTIC.mistake(
    "holes were counted as faces",
    hint="What is the Euler characteristic of a disc? Count one triangle by hand.",
)
def _(mesh: HalfedgeMesh) -> Any:
    V, E, F = _count(mesh)
    return V - E + F + len(reference.boundary_loops(mesh))


@EULER_CHARACTERISTIC.mistake(
    "the half-edges along holes were left out when counting edges",
    hint="An edge at a hole has a half-edge on either side too. Which of them have you counted?",
)
def _(mesh: HalfedgeMesh) -> Any:
    V, _, F = _count(mesh)
    return V - int(np.count_nonzero(mesh.face != HOLE)) // 2 + F


@EULER_CHARACTERISTIC.mistake("the signs are wrong", hint="Which of the three counts is taken away?")
def _(mesh: HalfedgeMesh) -> Any:
    V, E, F = _count(mesh)
    return V + E - F


GENUS = Exercise(
    reference.genus,
    notes="ch. 1, Euler–Poincaré Formula",
    hints=[
        "For one closed surface the formula of the notes is enough. Solve it for g.",
        "Fill a hole with a disc: how do V, E and F change? The genus does not.",
        "Two spheres have the characteristic 4 and no handle. What must be counted too?",
    ],
)

_G = "The genus"


@GENUS.check("closed surfaces: sphere, torus, double and triple torus")
def _(f: Asked, rng: Rng) -> None:
    surfaces = (shapes.icosahedron(), shapes.torus(5, 4), shapes.genus_surface(2), shapes.genus_surface(3))
    meshes = [mesh_of(shapes.shuffled(shape, rng), rng) for shape in surfaces]
    _expect_numbers(f, _G, [(mesh, g, f"closed surface {g + 1} of 4") for g, mesh in enumerate(meshes)])


@GENUS.check("surfaces with holes")
def _(f: Asked, rng: Rng) -> None:
    flat = [(mesh_of(shapes.disc(2), rng), 0, "a disc"), (mesh_of(shapes.annulus(), rng), 0, "an annulus")]
    torus = shapes.torus(6, 5)
    faces = face_lists(torus)
    mesh = mesh_of(shapes.Shape("torus with a hole", torus.vertices, np.array(faces[1:])), rng)
    _expect_numbers(f, _G, [*flat, (mesh, 1, "a torus with one triangle taken out")])


@GENUS.check("several components, open and closed")
def _(f: Asked, rng: Rng) -> None:
    both = shapes.union(shapes.torus(5, 4), shapes.torus(4, 5), shapes.disc(2))
    first = mesh_of(shapes.shuffled(both, rng), rng)
    vertices, faces, _ = with_isolated_vertices(shapes.union(shapes.octahedron(), shapes.torus(5, 4)), rng)
    mesh = renumbered(reference.halfedge_mesh(vertices, faces), rng)
    second = "an octahedron, a torus and three isolated vertices"
    _expect_numbers(f, _G, [(first, 2, "two tori and a disc"), (mesh, 1, second)])


def _components(mesh: HalfedgeMesh) -> list[set[int]]:
    """Collect the half-edges of each component by flooding."""
    waiting, found = set(range(mesh.n_halfedges)), []
    while waiting:
        component, front = set(), [waiting.pop()]
        while front:
            h = front.pop()
            component.add(h)
            for g in (int(mesh.next[h]), int(mesh.twin[h])):
                if g in waiting:
                    waiting.remove(g)
                    front.append(g)
        found.append(component)
    return found


@GENUS.variant("component by component, flooding")
def _(mesh: HalfedgeMesh) -> Any:
    total = 0
    for component in _components(mesh):
        h = np.array(sorted(component))
        V, E = len(np.unique(mesh.origin[h])), len(h) // 2
        F = len(np.unique(mesh.face[h][mesh.face[h] != HOLE]))
        starts = set(mesh.origin[h].tolist())
        holes = sum(loop[0] in starts for loop in reference.boundary_loops(mesh))
        total += (2 - (V - E + F + holes)) // 2
    return total


@GENUS.variant("as a float")
def _(mesh: HalfedgeMesh) -> Any:
    chi, holes = reference.euler_characteristic(mesh), len(reference.boundary_loops(mesh))
    return len(_components(mesh)) - (chi + holes) / 2


@GENUS.mistake(
    "the holes were not taken into account",
    hint="An annulus has no handle. What does your formula give for it?",
)
def _(mesh: HalfedgeMesh) -> Any:
    return len(_components(mesh)) - reference.euler_characteristic(mesh) / 2


@GENUS.mistake(
    "the surface was taken to be connected",
    hint="2(1 − g) belongs to one component. How many are there?",
)
def _(mesh: HalfedgeMesh) -> Any:
    return 1 - (reference.euler_characteristic(mesh) + len(reference.boundary_loops(mesh))) / 2


@GENUS.mistake(
    "the formula of the notes was used as if every surface were closed and connected",
    hint="V − E + F = 2(1 − g) holds for one closed surface. Which of the two does your mesh break?",
)
def _(mesh: HalfedgeMesh) -> Any:
    return 1 - reference.euler_characteristic(mesh) / 2


@GENUS.mistake(
    "the formula for one closed surface was used for all, and the result rounded down",
    hint="V − E + F = 2(1 − g) holds for one closed surface. Which of the two does your mesh break?",
)
def _(mesh: HalfedgeMesh) -> Any:
    return (2 - reference.euler_characteristic(mesh)) // 2


@GENUS.mistake(
    "the Euler characteristic was returned in place of the genus",
    hint="A sphere has the characteristic 2. How many handles does it have?",
)
def _(mesh: HalfedgeMesh) -> Any:
    return reference.euler_characteristic(mesh)


@GENUS.mistake(
    "holes were counted with the wrong sign",
    hint="Filling a hole with a disc adds a face. Does V − E + F grow or shrink?",
)
def _(mesh: HalfedgeMesh) -> Any:
    chi, holes = reference.euler_characteristic(mesh), len(reference.boundary_loops(mesh))
    return len(_components(mesh)) - (chi - holes) / 2


ELEMENT_STATISTICS = Exercise(
    reference.element_statistics,
    notes="ch. 1, Euler–Poincaré Formula",
    hints=[
        "V, E and F are those of the Euler characteristic.",
        "Add up the valences of all vertices. How often does that count each edge?",
        "The keys of the result are in the docstring.",
    ],
)

_KEYS = ("V", "E", "F", "valence", "F/V", "E/V")


def _expect_statistics(f: Asked, mesh: HalfedgeMesh, faces: FaceLists, on: str) -> None:
    value = f(mesh)
    expect.that(value is not None, "The result is None: is a `return` missing?", on=on)
    is_dict = isinstance(value, dict)
    expect.that(
        is_dict,
        f"The result should be a dict; it is a {type(value).__name__}.",
        yours=expect.brief(value),
        on=on,
    )
    missing = [key for key in _KEYS if key not in value]
    expect.that(not missing, f"The keys {missing} are missing.", yours=f"keys {list(value)}", on=on)
    V, E, F = len({v for face in faces for v in face}), n_edges(faces), len(faces)
    truth = {"V": V, "E": E, "F": F, "valence": 2 * E / V, "F/V": F / V, "E/V": E / V}
    for key in _KEYS:
        mine = expect.number(value[key], f'"{key}"', on=on)
        # One division is rounded by 1e-16 of the quotient; 1e-6 also admits float32.
        expect.close(mine, truth[key], 1e-6 * truth[key], f'"{key}"', on=on)


@ELEMENT_STATISTICS.check("a torus of triangles: 6, 2 and 3 exactly")
def _(f: Asked, rng: Rng) -> None:
    torus = shapes.torus(6, 5)
    _expect_statistics(f, mesh_of(torus, rng), face_lists(torus), "a torus of triangles")


@ELEMENT_STATISTICS.check("a torus of quads: 4, 1 and 2 exactly")
def _(f: Asked, rng: Rng) -> None:
    torus = shapes.torus(6, 5, quads=True)
    _expect_statistics(f, mesh_of(torus, rng), face_lists(torus), "a torus of quads")


@ELEMENT_STATISTICS.check("meshes with holes, and with isolated vertices")
def _(f: Asked, rng: Rng) -> None:
    shape = bounded_triangles(rng)
    _expect_statistics(f, mesh_of(shape, rng), face_lists(shape), "a mesh with holes")
    vertices, faces, _ = with_isolated_vertices(shapes.disc(2), rng)
    mesh = renumbered(reference.halfedge_mesh(vertices, faces), rng)
    _expect_statistics(f, mesh, faces, "a disc and three isolated vertices")


@ELEMENT_STATISTICS.check("refuses a mesh without faces")
def _(f: Asked, rng: Rng) -> None:
    empty = reference.halfedge_mesh(rng.normal(size=(3, 3)), [])
    expect.refusal(f, empty, because="the mesh has no faces, so that the ratios are 0/0", on="no faces")


def _refuse_empty(mesh: HalfedgeMesh) -> None:
    if mesh.n_faces == 0:
        raise ValueError("the mesh has no faces")


@ELEMENT_STATISTICS.variant("the valences counted one by one")
def _(mesh: HalfedgeMesh) -> Any:
    _refuse_empty(mesh)
    used = [v for v in range(mesh.n_vertices) if mesh.vertex_halfedge[v] != NONE]
    valences = [len(reference.vertex_neighbours_ccw(mesh, v)) for v in used]
    V, E, F = len(used), len({frozenset((h, int(t))) for h, t in enumerate(mesh.twin)}), mesh.n_faces
    return {
        "V": V,
        "E": E,
        "F": F,
        "valence": np.mean(valences),
        "F/V": F / V,
        "E/V": E / V,
        "chi": V - E + F,
    }


@ELEMENT_STATISTICS.variant("single precision")
def _(mesh: HalfedgeMesh) -> Any:
    return {key: np.float32(value) for key, value in reference.element_statistics(mesh).items()}


def _statistics(V: int, E: int, F: int, **other: float) -> dict[str, float]:
    return {"V": V, "E": E, "F": F, "valence": 2 * E / V, "F/V": F / V, "E/V": E / V} | other


def _declare(name: str, hint: str, change: Callable[[HalfedgeMesh, int, int, int], dict[str, float]]) -> None:
    @ELEMENT_STATISTICS.mistake(name, hint=hint)
    def _(mesh: HalfedgeMesh) -> Any:
        _refuse_empty(mesh)
        return change(mesh, *_count(mesh))


_declare(
    "half-edges were counted as edges",
    "How many half-edges run along one edge?",
    lambda mesh, V, E, F: _statistics(V, 2 * E, F),
)
_declare(
    "the mean valence counts every edge once",
    "An edge ends in two vertices. How often does it count among the valences?",
    lambda mesh, V, E, F: _statistics(V, E, F, valence=E / V),
)
_declare(
    "isolated vertices were counted",
    "Is a vertex that no face uses part of the surface?",
    lambda mesh, V, E, F: _statistics(mesh.n_vertices, E, F),
)
_declare(
    "holes were counted as faces",
    "Which half-edges carry the face -1, and is that a face?",
    lambda mesh, V, E, F: _statistics(V, E, F + len(reference.boundary_loops(mesh))),
)


@ELEMENT_STATISTICS.mistake(
    "a mesh without faces was not refused",
    hint="What is F/V of a mesh that has neither faces nor used vertices?",
)
def _(mesh: HalfedgeMesh) -> Any:
    return reference.element_statistics(mesh) if mesh.n_faces else dict.fromkeys(_KEYS, 0.0)


_declare(
    "the ratios are upside down",
    "F/V says how many faces there are for each vertex.",
    lambda mesh, V, E, F: _statistics(V, E, F) | {"F/V": V / F, "E/V": V / E},
)
