"""The half-edge mesh as index arrays.

Half-edge ``h`` starts at ``origin[h]`` and runs along its face ``face[h]``, counter-clockwise
seen from outside. A hole is bordered by half-edges too: they carry ``face == HOLE`` and are
linked by ``next`` and ``prev`` like those of a face, so that walks around a vertex come round.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gpcourse.errors import ArrayError, HalfedgeError
from gpcourse.geometry.arrays import FloatArray, IntArray, as_points

#: The `face` of a half-edge that runs along a hole, and the half-edge of an isolated vertex.
HOLE = -1
NONE = -1

_PER_HALFEDGE = ("twin", "next", "prev", "origin", "face")
_RECORDS = (*_PER_HALFEDGE, "vertex_halfedge", "face_halfedge")


@dataclass(frozen=True, eq=False)
class HalfedgeMesh:
    """Connectivity of an oriented polygon mesh, and optionally its vertex positions.

    Attributes
    ----------
    twin, next, prev : (h,) int arrays
        The opposite half-edge, and the following and preceding one along the same face or hole.
    origin : (h,) int array
        The vertex that the half-edge leaves.
    face : (h,) int array
        The face on its left, or -1 along a hole.
    vertex_halfedge : (n,) int array
        One half-edge that leaves each vertex; -1 for an isolated vertex.
    face_halfedge : (m,) int array
        One half-edge of each face.
    vertices : (n, 3) float array or None
        Positions, any length unit.

    Making one checks types and lengths only; `validate` checks that the records agree.
    """

    twin: IntArray
    next: IntArray
    prev: IntArray
    origin: IntArray
    face: IntArray
    vertex_halfedge: IntArray
    face_halfedge: IntArray
    vertices: FloatArray | None = None

    def __post_init__(self) -> None:
        for name in _RECORDS:
            object.__setattr__(self, name, _index_array(getattr(self, name), name))
        for name in _PER_HALFEDGE[1:]:
            if len(getattr(self, name)) != len(self.twin):
                raise ArrayError(
                    f"{name} has {len(getattr(self, name))} entries and twin has {len(self.twin)}; "
                    "both need one entry per half-edge"
                )
        if self.vertices is not None:
            object.__setattr__(self, "vertices", as_points(self.vertices, "vertices"))
            if len(self.vertices) != self.n_vertices:
                raise ArrayError(
                    f"vertices has {len(self.vertices)} rows and vertex_halfedge has "
                    f"{self.n_vertices} entries; both need one per vertex"
                )

    @property
    def n_halfedges(self) -> int:
        """The number of half-edges, those of holes included."""
        return len(self.twin)

    @property
    def n_vertices(self) -> int:
        """The number of vertices, isolated ones included."""
        return len(self.vertex_halfedge)

    @property
    def n_faces(self) -> int:
        """The number of faces; holes do not count."""
        return len(self.face_halfedge)

    def __repr__(self) -> str:
        holes = int(np.count_nonzero(self.face == HOLE))
        placed = "" if self.vertices is not None else ", no positions"
        return (
            f"<HalfedgeMesh: {self.n_vertices} vertices, {self.n_faces} faces, "
            f"{self.n_halfedges} half-edges, {holes} of them along holes{placed}>"
        )

    def with_vertices(self, vertices: object) -> HalfedgeMesh:
        """Return the same connectivity with other positions, an (n, 3) array."""
        return replace(self, vertices=vertices)  # type: ignore[arg-type]  # converted in __post_init__

    def copy(self) -> HalfedgeMesh:
        """Return a mesh with arrays of its own, free to be changed in place."""
        own: dict[str, Any] = {name: getattr(self, name).copy() for name in _RECORDS}
        own["vertices"] = None if self.vertices is None else self.vertices.copy()
        return HalfedgeMesh(**own)

    def validate(self) -> None:
        """Check that the records agree with each other.

        Raises
        ------
        HalfedgeError
            Names the first half-edge, vertex or face whose record breaks an invariant.
        """
        self._check_ranges()
        h = np.arange(self.n_halfedges)
        _require(self.twin != h, "half-edge {} is its own twin")
        _require(self.twin[self.twin] == h, "half-edge {}: the twin of its twin is another half-edge")
        _require(self.prev[self.next] == h, "half-edge {}: prev of its next is another half-edge")
        _require(
            self.origin[self.next] == self.origin[self.twin],
            "half-edge {}: its next does not start where its twin starts",
        )
        _require(
            (self.face != HOLE) | (self.face[self.twin] != HOLE),
            "half-edge {} and its twin both run along a hole: no face has this edge",
        )
        _require(self.face[self.next] == self.face, "half-edge {}: its next belongs to another face")
        _require(
            self.face[self.face_halfedge] == np.arange(self.n_faces), "face {}: its half-edge is not its own"
        )
        linked = self.vertex_halfedge != NONE
        at = np.flatnonzero(linked)
        _require(self.origin[self.vertex_halfedge[at]] == at, "vertex {}: its half-edge starts elsewhere", at)
        used = np.zeros(self.n_vertices, dtype=bool)
        used[self.origin] = True
        _require(linked | ~used, "vertex {} has half-edges but no representative")
        self._check_orbits()

    def _check_ranges(self) -> None:
        limits = {
            "twin": (0, self.n_halfedges),
            "next": (0, self.n_halfedges),
            "prev": (0, self.n_halfedges),
            "origin": (0, self.n_vertices),
            "face": (HOLE, self.n_faces),
            "vertex_halfedge": (NONE, self.n_halfedges),
            "face_halfedge": (0, self.n_halfedges),
        }
        for name, (low, high) in limits.items():
            record = getattr(self, name)
            bad = np.flatnonzero((record < low) | (record >= high))
            if len(bad):
                i = int(bad[0])
                about = i if name in _PER_HALFEDGE else None
                raise HalfedgeError(f"{name}[{i}] is {record[i]}; it must lie in {low} .. {high - 1}", about)

    def _check_orbits(self) -> None:
        """Each face is one orbit of next; each vertex is one orbit of next after twin."""
        orbits = orbit_labels(self.next)
        firsts = orbits[self.face_halfedge]
        _require(
            (self.face == HOLE) | (orbits == np.append(firsts, NONE)[self.face]),
            "half-edge {}: next does not lead round the whole of its face",
        )
        around = orbit_labels(self.next[self.twin])
        representative = np.append(self.vertex_halfedge, NONE)[self.origin]
        _require(
            around == around[representative],
            "half-edge {} is not reached by walking around its origin: two fans meet in that vertex",
        )


def orbit_labels(permutation: IntArray) -> IntArray:
    """Label every index by the smallest index on its cycle.

    Parameters
    ----------
    permutation : (h,) int array
        A permutation of ``0 .. h - 1``.

    Returns
    -------
    (h,) int array
        Equal for two indices exactly when they lie on one cycle.
    """
    label, ahead = np.arange(len(permutation)), permutation
    while True:
        # After k rounds a label is the smallest index among the next 2ᵏ; ahead leads past them.
        smaller = np.minimum(label, label[ahead])
        if np.array_equal(smaller, label):
            return label
        label, ahead = smaller, ahead[ahead]


def _index_array(value: object, name: str) -> IntArray:
    try:
        record = np.asarray(value)
    except ValueError:
        raise ArrayError(f"{name} mixes lengths; give a list of indices") from None
    if record.ndim != 1 or not (np.issubdtype(record.dtype, np.integer) or record.size == 0):
        raise ArrayError(f"{name} has shape {record.shape} and type {record.dtype}; give a list of indices")
    return record.astype(np.int64, copy=False)


def _require(holds: np.ndarray[Any, Any], message: str, names: IntArray | None = None) -> None:
    if not holds.all():
        first = int(np.argmin(holds))
        about = first if message.startswith("half-edge") else None
        raise HalfedgeError(message.format(first if names is None else int(names[first])), about)
