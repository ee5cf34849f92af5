"""What is known of a shape by construction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gpcourse.errors import ArrayError, GeometryError
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray, as_points, flatten_polygons
from gpcourse.geometry.shapes.parameters import Rng, generator, positive

#: The faces of a shape: an (m, k) array when all have k corners, else lists of mixed lengths.
Faces = IntArray | list[list[int]]

_PER_VERTEX = ("interior", "normals", "mean_curvature", "gaussian_curvature", "principal_curvatures")
_CURVATURES = _PER_VERTEX[2:]


@dataclass(frozen=True, eq=False, repr=False)
class Shape:
    """A mesh and the facts that hold for it by construction.

    Attributes
    ----------
    name : str
        What messages and pictures call it.
    vertices : (n, 3) float array
        Positions.
    faces : (m, k) int array, or list of index lists
        Counter-clockwise seen from outside (from +z for a flat shape).
    genus : int or None
        Number of handles, summed over the components; None for a surface with one side only.
    n_components : int
        Number of connected pieces.
    boundary_lengths : tuple of int
        Number of edges of each boundary loop, longest first; empty for a closed shape.
    interior : (n,) bool array
        False at the vertices on a boundary.
    normals : (n, 3) float array or None
        Exact outward unit normals of the smooth surface that the vertices lie on; None if there is none.
    mean_curvature, gaussian_curvature : (n,) float arrays or None
        Exact; H = (k1 + k2)/2 is +1/R on a sphere of radius R, K = k1 k2.
    principal_curvatures : (n, 2) float array or None
        Exact; the larger first, positive where the surface bends away from the outward normal.
    """

    name: str
    vertices: FloatArray
    faces: Faces
    genus: int | None = 0
    n_components: int = 1
    boundary_lengths: tuple[int, ...] = ()
    interior: BoolArray | None = None
    normals: FloatArray | None = None
    mean_curvature: FloatArray | None = None
    gaussian_curvature: FloatArray | None = None
    principal_curvatures: FloatArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", as_points(self.vertices, "vertices"))
        corners, sizes = flatten_polygons(self.faces, len(self.vertices))
        object.__setattr__(self, "faces", as_faces(corners, sizes))
        lengths = tuple(sorted((int(length) for length in self.boundary_lengths), reverse=True))
        object.__setattr__(self, "boundary_lengths", lengths)
        if self.interior is None:
            if lengths:
                raise ArrayError("interior is missing; a shape with a boundary needs one flag per vertex")
            object.__setattr__(self, "interior", np.ones(len(self.vertices), dtype=bool))
        for name in _PER_VERTEX:
            values = getattr(self, name)
            if values is not None and len(values) != len(self.vertices):
                raise ArrayError(
                    f"{name} has {len(values)} rows; give one for each of {len(self.vertices)} vertices"
                )

    @property
    def closed(self) -> bool:
        """Whether there is no boundary."""
        return not self.boundary_lengths

    def __iter__(self) -> Iterator[FloatArray | Faces]:
        """Unpack as ``vertices, faces = shape``."""
        yield self.vertices
        yield self.faces

    def __repr__(self) -> str:
        facts = [f"{len(self.vertices)} vertices", f"{len(self.faces)} faces"]
        facts.append("one-sided" if self.genus is None else f"genus {self.genus}")
        if self.n_components != 1:
            facts.append(f"{self.n_components} components")
        if self.boundary_lengths:
            facts.append(f"boundary loops of {', '.join(map(str, self.boundary_lengths))} edges")
        return f"<Shape {self.name}: {', '.join(facts)}>"

    def moved(self, shift: object) -> Shape:
        """Return the shape moved by `shift`, three numbers."""
        return replace(self, vertices=self.vertices + as_points([shift], "shift"))

    def scaled(self, factor: float) -> Shape:
        """Return the shape scaled about the origin; curvatures follow."""
        return self.transformed(positive("factor", factor) * np.eye(3))

    def transformed(self, matrix: object, shift: object = (0.0, 0.0, 0.0)) -> Shape:
        """Return the shape with every vertex x moved to ``matrix @ x + shift``.

        Normals follow the inverse transpose. Curvatures follow a similarity, and become None
        under any other matrix.

        Raises
        ------
        GeometryError
            If the determinant of the (3, 3) matrix is not positive: that would turn the faces inwards.
        """
        A = as_points(matrix, "matrix")
        if A.shape != (3, 3) or not np.linalg.det(A) > 0:
            raise GeometryError(
                "matrix must be (3, 3) with a positive determinant, to keep the faces outward"
            )
        normals = None if self.normals is None else self.normals @ np.linalg.inv(A)
        if normals is not None:
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        moved = replace(self, vertices=self.vertices @ A.T, normals=normals).moved(shift)
        factor = float(np.linalg.norm(A)) / np.sqrt(3)
        if not np.allclose(A.T @ A, factor**2 * np.eye(3), rtol=0, atol=1e-12 * factor**2):
            return replace(moved, mean_curvature=None, gaussian_curvature=None, principal_curvatures=None)
        return moved._with_curvatures_divided_by(factor)

    def _with_curvatures_divided_by(self, factor: float) -> Shape:
        H, K, k = self.mean_curvature, self.gaussian_curvature, self.principal_curvatures
        return replace(
            self,
            mean_curvature=None if H is None else H / factor,
            gaussian_curvature=None if K is None else K / factor**2,
            principal_curvatures=None if k is None else k / factor,
        )


def as_faces(corners: IntArray, sizes: IntArray) -> Faces:
    """Cut corners that are laid end to end into faces: an (m, k) array if all have k corners, else lists."""
    if not len(sizes):
        return np.empty((0, 3), dtype=np.int64)
    if (sizes == sizes[0]).all():
        return corners.reshape(len(sizes), int(sizes[0]))
    flat, ends = corners.tolist(), np.cumsum(sizes).tolist()
    return [flat[start:end] for start, end in zip([0, *ends], ends, strict=False)]


def union(*shapes: Shape) -> Shape:
    """Return one shape made of several, placed side by side along x so that they do not touch.

    Facts that are known of every part (curvatures, genus) are known of the whole.
    """
    if not shapes:
        raise GeometryError("union() of nothing; give at least one shape")
    parts = _side_by_side(shapes)
    corners, sizes = zip(*(flatten_polygons(part.faces, len(part.vertices)) for part in parts), strict=True)
    firsts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    shifted = [index + first for index, first in zip(corners, firsts, strict=False)]
    known = {name: [getattr(part, name) for part in parts] for name in _PER_VERTEX}
    genera = [part.genus for part in parts]
    return Shape(
        name=" and ".join(part.name for part in parts),
        vertices=np.concatenate([part.vertices for part in parts]),
        faces=as_faces(np.concatenate(shifted), np.concatenate(sizes)),
        genus=None if None in genera else sum(g for g in genera if g is not None),
        n_components=sum(part.n_components for part in parts),
        boundary_lengths=tuple(length for part in parts for length in part.boundary_lengths),
        **{
            name: None if any(value is None for value in values) else np.concatenate(values)
            for name, values in known.items()
        },
    )


def _side_by_side(shapes: Sequence[Shape]) -> list[Shape]:
    """Move each shape along x beyond the one before it; the first stays."""
    parts: list[Shape] = []
    for shape in shapes:
        if parts:
            gap = 0.25 * max(float(np.ptp(part.vertices, axis=0).max()) for part in (parts[-1], shape))
            right = parts[-1].vertices[:, 0].max()
            parts.append(shape.moved((right + gap - shape.vertices[:, 0].min(), 0.0, 0.0)))
        else:
            parts.append(shape)
    return parts


def shuffled(shape: Shape, rng: Rng) -> Shape:
    """Return the same surface with vertices and faces in random order, each face from a random corner on."""
    draw = generator(rng)
    old = draw.permutation(len(shape.vertices))
    new = np.empty_like(old)
    new[old] = np.arange(len(old))
    corners, sizes = flatten_polygons(shape.faces, len(shape.vertices))
    starts = np.cumsum(sizes) - sizes
    order = draw.permutation(len(sizes))
    turn = draw.integers(0, sizes[order]) if len(sizes) else order
    sizes = sizes[order]
    first = np.cumsum(sizes) - sizes
    within = np.arange(len(corners)) - np.repeat(first, sizes)
    within = (within + np.repeat(turn, sizes)) % np.repeat(sizes, sizes)
    picked = corners[np.repeat(starts[order], sizes) + within]
    records = {name: getattr(shape, name) for name in _PER_VERTEX}
    known: dict[str, Any] = {
        name: None if values is None else values[old] for name, values in records.items()
    }
    return replace(
        shape,
        vertices=shape.vertices[old],
        faces=as_faces(new[picked], sizes),
        **known,
    )
