"""Chapter 1: half-edge meshes.

Files, building, walking, flipping, duals and counting. A vertex and a face know one of their
half-edges each; everything else is found by walking along ``twin``, ``next`` and ``prev``.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NoReturn

import numpy as np

from gpcourse.errors import (
    ArrayError,
    FlipError,
    GeometryError,
    MeshError,
    NonManifoldEdgeError,
    OrientationError,
)
from gpcourse.geometry.arrays import FloatArray, IntArray, Polygons, as_points, flatten_polygons
from gpcourse.geometry.halfedge_mesh import HOLE, NONE, HalfedgeMesh, orbit_labels
from gpcourse.reference.off import read_off, write_off

__all__ = [
    "boundary_loops",
    "build_halfedges",
    "cube",
    "delaunay_flips",
    "dual_mesh",
    "element_statistics",
    "euler_characteristic",
    "face_centroid",
    "face_vertices",
    "flip_edge",
    "genus",
    "halfedge_mesh",
    "is_flippable",
    "read_off",
    "vertex_neighbours_ccw",
    "vertex_neighbours_cw",
    "write_off",
]


# Building ---------------------------------------------------------------------------------------


def build_halfedges(faces: Polygons, n_vertices: int) -> HalfedgeMesh:
    """Build the half-edge records of an oriented polygon mesh.

    Every face of k corners gives k half-edges, one from each corner to the next. Where an edge has
    a face on one side only, a half-edge along the hole is added, so that every half-edge has a twin.

    Parameters
    ----------
    faces : (m, k) int array, or list of m index lists
        The corners of each face, counter-clockwise seen from outside.
    n_vertices : int
        The number of vertices; those that no face names are isolated.

    Returns
    -------
    HalfedgeMesh
        Records `twin`, `next`, `prev`, `origin` and `face` for each half-edge, with ``face == -1``
        along a hole, and one half-edge for each vertex (-1 for an isolated one) and each face.
        Any numbering of the half-edges is right. No positions.

    Raises
    ------
    ValueError
        If an index is out of range, a face names a vertex twice, an edge has more than two faces,
        two faces run along an edge in the same direction, or two sheets touch in a vertex only.
        The message names the face, the edge or the vertex.

    References
    ----------
    Notes ch. 1, *Half-edge Data Structure*; PMP ch. 2.
    """
    corners, sizes = flatten_polygons(faces, n_vertices)
    n_vertices, n_corners = int(n_vertices), len(corners)
    last = np.cumsum(sizes) - 1
    first = last - sizes + 1
    head = np.roll(corners, -1)
    head[last] = corners[first]
    forward, backward = _match_twins(corners, head, last, n_vertices)

    # Where no twin was found there is a hole: its half-edges run the other way along the border.
    n_border = n_corners - 2 * len(forward)
    twin = np.full(n_corners + n_border, NONE)
    twin[forward], twin[backward] = backward, forward
    border = np.flatnonzero(twin[:n_corners] == NONE)
    hole = n_corners + np.arange(n_border)
    twin[border], twin[hole] = hole, border
    origin = np.concatenate([corners, head[border]])

    # Along a face each half-edge is followed by the one after it in the list, but for the last;
    # along a hole by the hole's half-edge that leaves where it ends.
    next_ = np.arange(1, len(twin) + 1)
    prev = np.arange(-1, len(twin) - 1)
    next_[last], prev[first] = first, last
    vertex_halfedge = np.full(n_vertices, NONE)
    vertex_halfedge[head] = next_[:n_corners]
    vertex_halfedge[origin[hole]] = hole
    _refuse_touching_sheets(origin[hole[vertex_halfedge[origin[hole]] != hole]])
    next_[hole] = vertex_halfedge[corners[border]]
    prev[next_[hole]] = hole

    mesh = HalfedgeMesh(
        twin=twin,
        next=next_,
        prev=prev,
        origin=origin,
        face=np.repeat(np.append(np.arange(len(sizes)), HOLE), np.append(sizes, n_border)),
        vertex_halfedge=vertex_halfedge,
        face_halfedge=first,
    )
    _check_fans(mesh)
    return mesh


def _match_twins(
    tail: IntArray, head: IntArray, last: IntArray, n_vertices: int
) -> tuple[IntArray, IntArray]:
    """Pair the half-edges that run along one edge in opposite directions."""
    apart, halfedge = _sort_by_edge(tail, head, n_vertices)
    repeated = np.flatnonzero(apart == 0)
    if len(repeated):
        _refuse_repeated_edge(tail, head, last, int(halfedge[repeated[0]]))
    first = np.flatnonzero(apart == 1)
    return halfedge[:-1][first], halfedge[1:][first]


def _sort_by_edge(tail: IntArray, head: IntArray, n_vertices: int) -> tuple[IntArray, IntArray]:
    """Sort half-edges so that those along one edge are neighbours.

    Returns how far apart neighbours are (0: the same edge in the same direction, 1: in opposite
    directions, more: another edge), and the half-edges in that order. Smaller vertex, larger vertex,
    direction and half-edge are packed into one integer wherever they fit, since sorting plain integers
    is several times faster than sorting indirectly.
    """
    vertex_bits, h_bits = n_vertices.bit_length(), len(tail).bit_length()
    if 2 * vertex_bits + 1 + h_bits <= 63:
        packed = np.minimum(tail, head)  # then in place: fresh arrays cost more than the arithmetic
        packed <<= vertex_bits
        packed |= np.maximum(tail, head)
        packed <<= 1
        packed |= tail > head
        packed <<= h_bits
        packed |= np.arange(len(tail))
        packed.sort()
        apart = np.bitwise_xor(packed[1:], packed[:-1])
        apart >>= h_bits
        packed &= (1 << h_bits) - 1
        return apart, packed
    edge = np.minimum(tail, head) * n_vertices + np.maximum(tail, head)
    direction = 2 * edge + (tail > head)
    order = np.argsort(direction, kind="stable")
    direction = direction[order]
    return np.bitwise_xor(direction[1:], direction[:-1]), order


def _refuse_repeated_edge(tail: IntArray, head: IntArray, last: IntArray, h: int) -> NoReturn:
    """Name the faces along the edge of half-edge h, where another one runs in the same direction."""
    along = ((tail == tail[h]) & (head == head[h])) | ((tail == head[h]) & (head == tail[h]))
    faces = np.searchsorted(last, np.flatnonzero(along)).tolist()
    if len(faces) > 2:
        raise NonManifoldEdgeError(
            f"edge {tail[h]} – {head[h]} belongs to faces {', '.join(map(str, faces[:-1]))} and {faces[-1]}; "
            "an edge has one or two faces: remove the others"
        )
    raise OrientationError(
        f"edge {tail[h]} -> {head[h]} belongs to faces {faces[0]} and {faces[1]} "
        "in the same direction; flip one or remove it"
    )


def _refuse_touching_sheets(crowded: IntArray) -> None:
    if len(crowded):
        raise MeshError(
            f"two sheets of faces touch in vertex {crowded[0]} only; give each sheet a vertex of its own"
        )


def _check_fans(mesh: HalfedgeMesh) -> None:
    """Walk around all vertices at once; together the walks must meet every half-edge."""
    start = h = mesh.vertex_halfedge[mesh.vertex_halfedge != NONE]
    met = 0
    while len(h):
        met += len(h)
        h = mesh.twin[mesh.prev[h]]
        on = h != start
        if not on.all():
            h, start = h[on], start[on]
    if met < mesh.n_halfedges:
        orbits = orbit_labels(mesh.twin[mesh.prev])
        missed = orbits != orbits[mesh.vertex_halfedge[mesh.origin]]
        _refuse_touching_sheets(np.unique(mesh.origin[missed]))


def halfedge_mesh(vertices: FloatArray, faces: Polygons) -> HalfedgeMesh:
    """Build the half-edge mesh of a polygon mesh, positions included.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions, any length unit.
    faces : (m, k) int array, or list of m index lists
        Counter-clockwise seen from outside.

    Raises
    ------
    ValueError
        As `build_halfedges`, or if a position is not finite.
    """
    positions = as_points(vertices, "vertices")
    return build_halfedges(faces, len(positions)).with_vertices(positions)


def cube() -> tuple[FloatArray, list[list[int]]]:
    """Describe a cube by six quads.

    Returns
    -------
    vertices : (8, 3) float array
        The corners, at any position and of any size.
    faces : list of 6 lists of 4 indices
        Each counter-clockwise seen from outside.

    References
    ----------
    Coursework 1, question 1.
    """
    # Vertex i has the binary digits of i as its coordinates: bit 0 is x, bit 1 is y, bit 2 is z.
    vertices = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)], dtype=float)
    bottom, top = [0, 2, 3, 1], [4, 5, 7, 6]
    front, back = [0, 1, 5, 4], [2, 6, 7, 3]
    left, right = [0, 4, 6, 2], [1, 3, 7, 5]
    return vertices, [bottom, top, front, back, left, right]


# Walking ----------------------------------------------------------------------------------------


def face_vertices(mesh: HalfedgeMesh, f: int) -> list[int]:
    """List the vertices of face `f` in counter-clockwise order.

    Parameters
    ----------
    mesh : HalfedgeMesh
    f : int
        A face.

    Returns
    -------
    list of int
        Each corner once, starting anywhere.

    References
    ----------
    Notes ch. 1, walking around a face: ``he = he.next``.
    """
    start = h = _representative(mesh.face_halfedge, f, "face")
    corners = []
    while True:
        corners.append(int(mesh.origin[h]))
        h = mesh.next[h]
        if h == start:
            return corners


def vertex_neighbours_ccw(mesh: HalfedgeMesh, v: int) -> list[int]:
    """List the neighbours of vertex `v` counter-clockwise, seen from outside.

    Parameters
    ----------
    mesh : HalfedgeMesh
    v : int
        A vertex.

    Returns
    -------
    list of int
        Each neighbour once, starting anywhere; empty for an isolated vertex. At a boundary vertex
        the walk crosses the hole, so that the last neighbour before it is not missed.

    References
    ----------
    Notes ch. 1, walking around a vertex: ``he = he.prev.twin``.
    """
    start = h = _representative(mesh.vertex_halfedge, v, "vertex")
    neighbours: list[int] = []
    while h != NONE:
        neighbours.append(int(mesh.origin[mesh.twin[h]]))
        h = mesh.twin[mesh.prev[h]]
        if h == start:
            break
    return neighbours


def vertex_neighbours_cw(mesh: HalfedgeMesh, v: int) -> list[int]:
    """List the neighbours of vertex `v` clockwise, seen from outside.

    Parameters
    ----------
    mesh : HalfedgeMesh
    v : int
        A vertex.

    Returns
    -------
    list of int
        Each neighbour once, starting anywhere; empty for an isolated vertex.

    References
    ----------
    Notes ch. 1, walking around a vertex: ``he = he.twin.next``.
    """
    start = h = _representative(mesh.vertex_halfedge, v, "vertex")
    neighbours: list[int] = []
    while h != NONE:
        neighbours.append(int(mesh.origin[mesh.twin[h]]))
        h = mesh.next[mesh.twin[h]]
        if h == start:
            break
    return neighbours


def boundary_loops(mesh: HalfedgeMesh) -> list[list[int]]:
    """List the vertices along each hole.

    Parameters
    ----------
    mesh : HalfedgeMesh

    Returns
    -------
    list of lists of int
        One list for each hole, in the order in which `next` runs along it, starting anywhere; the
        holes in any order. Empty for a closed mesh.

    References
    ----------
    Notes ch. 1, *Half-edge Data Structure*: "the same face or hole".
    """
    loops = []
    unvisited = dict.fromkeys(np.flatnonzero(mesh.face == HOLE).tolist())
    while unvisited:
        h, _ = unvisited.popitem()
        loop = [int(mesh.origin[h])]
        h = int(mesh.next[h])
        while h in unvisited:
            del unvisited[h]
            loop.append(int(mesh.origin[h]))
            h = int(mesh.next[h])
        loops.append(loop)
    return loops


def face_centroid(mesh: HalfedgeMesh, f: int) -> FloatArray:
    """Return the mean of the corners of face `f`.

    Parameters
    ----------
    mesh : HalfedgeMesh
        With positions.
    f : int
        A face.

    Returns
    -------
    (3,) float array
        In the length unit of the positions.

    References
    ----------
    Coursework 1, question 1.
    """
    return np.asarray(_positions(mesh)[face_vertices(mesh, f)].mean(axis=0))


# Flipping ---------------------------------------------------------------------------------------


def is_flippable(mesh: HalfedgeMesh, h: int) -> bool:
    """Tell whether the edge of half-edge `h` may be flipped.

    It may when there is a triangle on both sides, the new edge does not exist yet, and both ends of
    the old one keep at least three neighbours.

    Parameters
    ----------
    mesh : HalfedgeMesh
    h : int
        A half-edge; its twin gives the same answer.

    Returns
    -------
    bool

    References
    ----------
    Notes ch. 1, *Edge Flip*; PMP ch. 2.
    """
    h = _representative(np.arange(mesh.n_halfedges), h, "half-edge")
    t = mesh.twin[h]
    if mesh.face[h] == HOLE or mesh.face[t] == HOLE:
        return False
    if any(mesh.next[mesh.next[mesh.next[side]]] != side for side in (h, t)):
        return False
    left, right = int(mesh.origin[mesh.prev[h]]), int(mesh.origin[mesh.prev[t]])
    if left == right or right in vertex_neighbours_ccw(mesh, left):
        return False
    return all(len(vertex_neighbours_ccw(mesh, int(mesh.origin[side]))) > 3 for side in (h, t))


def flip_edge(mesh: HalfedgeMesh, h: int) -> HalfedgeMesh:
    r"""Turn the edge of half-edge `h` so that it joins the two opposite corners.

    ::

             r                  r
            / \                /|\
           /   \              / | \
          p --h-> q    →      p  |  q
           \   /              \ | /
            \ /                \|/
             s                  s

    Parameters
    ----------
    mesh : HalfedgeMesh
        Is not changed: work on ``mesh.copy()``.
    h : int
        A half-edge whose edge is flippable.

    Returns
    -------
    HalfedgeMesh
        With the same numbers of vertices, faces and half-edges, numbered in any way.

    Raises
    ------
    ValueError
        If the edge must not be flipped; the message names the half-edge.

    References
    ----------
    Notes ch. 1, *Edge Flip*: the four lines below that set `next` and `prev`.
    """
    if not is_flippable(mesh, h):
        ends = f"{mesh.origin[h]} – {mesh.origin[mesh.twin[h]]}"
        raise FlipError(f"half-edge {h} (edge {ends}) must not be flipped; ask is_flippable first")
    m = mesh.copy()
    t = m.twin[h]
    qr, rp, ps, sq = m.next[h], m.prev[h], m.next[t], m.prev[t]  # named by the vertices they join

    for cycle in ((h, rp, ps), (t, sq, qr)):  # the two new triangles s-r-p and r-s-q
        for here, there in zip(cycle, np.roll(cycle, -1), strict=True):
            m.next[here], m.prev[there] = there, here
            m.face[here] = m.face[cycle[0]]
        m.face_halfedge[m.face[cycle[0]]] = cycle[0]

    p, q = m.origin[h], m.origin[t]
    m.vertex_halfedge[p], m.vertex_halfedge[q] = ps, qr  # h and t leave p and q no longer
    m.origin[h], m.origin[t] = m.origin[sq], m.origin[rp]
    return m


def delaunay_flips(mesh: HalfedgeMesh) -> Iterator[HalfedgeMesh]:
    """Flip edges of a triangle mesh until it is Delaunay; yield the mesh after each flip.

    An edge is flipped while the two angles that face it sum to more than π. In the plane every such flip
    raises the smallest angles, so that the process ends.

    Parameters
    ----------
    mesh : HalfedgeMesh
        Triangles, with positions.

    Yields
    ------
    HalfedgeMesh

    References
    ----------
    Notes ch. 1, *Edge Flip*.
    """
    vertices = _positions(mesh)
    waiting = list(range(mesh.n_halfedges))
    while waiting:
        h = waiting.pop()
        t = int(mesh.twin[h])
        if mesh.face[h] == HOLE or mesh.face[t] == HOLE:
            continue
        # 1e-12 rad is far above rounding: an edge between cocircular triangles stays as it is.
        if _angle_facing(mesh, vertices, h) + _angle_facing(mesh, vertices, t) <= np.pi + 1e-12:
            continue
        if not is_flippable(mesh, h):
            continue
        mesh = flip_edge(mesh, h)
        waiting.extend(int(mesh.next[side]) for side in (h, t))
        waiting.extend(int(mesh.prev[side]) for side in (h, t))
        yield mesh


def _angle_facing(mesh: HalfedgeMesh, vertices: FloatArray, h: int) -> float:
    """Return the angle, in radians, at the corner of the face of `h` that lies opposite `h`."""
    apex = vertices[mesh.origin[mesh.prev[h]]]
    a, b = vertices[mesh.origin[h]] - apex, vertices[mesh.origin[mesh.next[h]]] - apex
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


# The dual, and counting -------------------------------------------------------------------------


def dual_mesh(mesh: HalfedgeMesh) -> tuple[FloatArray, list[list[int]]]:
    """Return the dual of a closed mesh: faces become vertices, and vertices become faces.

    Parameters
    ----------
    mesh : HalfedgeMesh
        Closed, with positions, without isolated vertices.

    Returns
    -------
    vertices : (F, 3) float array
        Row f is the centroid of face f.
    faces : list of V lists of int
        List v names the faces around vertex v, counter-clockwise seen from outside.

    Raises
    ------
    ValueError
        If the mesh has a boundary or an isolated vertex.

    References
    ----------
    Notes ch. 1, *Dual Graph*; coursework 1, question 1.
    """
    if (mesh.face == HOLE).any():
        h = int(np.argmax(mesh.face == HOLE))
        raise MeshError(f"half-edge {h} runs along a hole; only a closed mesh has a dual: fill the hole")
    if (mesh.vertex_halfedge == NONE).any():
        v = int(np.argmax(mesh.vertex_halfedge == NONE))
        raise MeshError(f"vertex {v} is isolated, so its dual face has no corners; remove it")
    centroids = [face_centroid(mesh, f) for f in range(mesh.n_faces)]
    return np.array(centroids).reshape(-1, 3), [_faces_around(mesh, v) for v in range(mesh.n_vertices)]


def _faces_around(mesh: HalfedgeMesh, v: int) -> list[int]:
    start = h = mesh.vertex_halfedge[v]
    faces = []
    while True:
        faces.append(int(mesh.face[h]))
        h = mesh.twin[mesh.prev[h]]
        if h == start:
            return faces


def euler_characteristic(mesh: HalfedgeMesh) -> int:
    """Return V − E + F of the surface.

    Parameters
    ----------
    mesh : HalfedgeMesh
        With any number of components and boundary loops.

    Returns
    -------
    int
        Vertices that belong to no face are not part of the surface and do not count.

    References
    ----------
    Notes ch. 1, *Euler–Poincaré Formula*.
    """
    n_vertices = int(np.count_nonzero(mesh.vertex_halfedge != NONE))
    return n_vertices - mesh.n_halfedges // 2 + mesh.n_faces


def genus(mesh: HalfedgeMesh) -> int:
    r"""Return the number of handles, summed over the components.

    .. math:: \chi = \sum_{\text{components}} \bigl(2 - 2 g - b\bigr)

    where b is the number of boundary loops: a hole that is filled by a disc adds one face and
    leaves V and E as they are.

    Parameters
    ----------
    mesh : HalfedgeMesh
        With any number of components and boundary loops.

    Returns
    -------
    int

    References
    ----------
    Notes ch. 1, *Euler–Poincaré Formula*.
    """
    closed = euler_characteristic(mesh) + len(boundary_loops(mesh))
    return _n_components(mesh) - closed // 2


def _n_components(mesh: HalfedgeMesh) -> int:
    """Let every half-edge take the smallest label among its neighbours until nothing changes."""
    label = np.arange(mesh.n_halfedges)
    while True:
        smallest = np.minimum(label, np.minimum(label[mesh.next], label[mesh.twin]))
        smallest = smallest[smallest]  # a label is a half-edge of the same component: ask that one too
        if np.array_equal(smallest, label):
            return len(np.unique(label))
        label = smallest


def element_statistics(mesh: HalfedgeMesh) -> dict[str, float]:
    """Count the elements of a mesh and relate the counts.

    Parameters
    ----------
    mesh : HalfedgeMesh
        At least one face. Vertices that belong to no face do not count.

    Returns
    -------
    dict
        ``"V"``, ``"E"``, ``"F"``: the numbers of vertices, edges and faces; ``"valence"``: the mean
        number of edges at a vertex; ``"F/V"`` and ``"E/V"``: the ratios.

    Raises
    ------
    ValueError
        If the mesh has no faces.

    References
    ----------
    Notes ch. 1: F ≈ 2V, E ≈ 3V, valence 6 for triangles; F ≈ V, E ≈ 2V, valence 4 for quads.
    """
    if mesh.n_faces == 0:
        raise MeshError("the mesh has no faces, so that the ratios are 0/0; give it at least one face")
    V = int(np.count_nonzero(mesh.vertex_halfedge != NONE))
    E, F = mesh.n_halfedges // 2, mesh.n_faces
    # Every edge has two ends, so the valences of all vertices sum to 2E.
    return {"V": V, "E": E, "F": F, "valence": 2 * E / V, "F/V": F / V, "E/V": E / V}


def _representative(record: IntArray, i: int, what: str) -> int:
    if not 0 <= i < len(record):
        raise GeometryError(f"there is no {what} {i}; they run from 0 to {len(record) - 1}")
    return int(record[i])


def _positions(mesh: HalfedgeMesh) -> FloatArray:
    if mesh.vertices is None:
        raise ArrayError("the mesh has no positions; give it some with mesh.with_vertices(...)")
    return mesh.vertices
