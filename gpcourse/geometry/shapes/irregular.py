"""Random meshes that tell right from wrong: obtuse angles, valence 3, handles, holes, any place and size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gpcourse.errors import GeometryError
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.geometry.shapes.curved import torus
from gpcourse.geometry.shapes.handles import genus_surface
from gpcourse.geometry.shapes.parameters import Rng, generator, positive, whole
from gpcourse.geometry.shapes.shape import Shape, shuffled, union
from gpcourse.geometry.shapes.sheets import flat


def irregular_patch(rng: Rng, n: int = 100, *, stretch: float = 1.0) -> Shape:
    """Return a flat irregular triangulation of the unit square in the plane z = 0, obtuse triangles included.

    Parameters
    ----------
    n : int
        Number of vertices, about; a grid of this many points is shaken.
    stretch : float
        The triangulation is Delaunay in the square stretched by this factor along x: with 1 it
        is Delaunay, with more it is not.
    """
    from scipy.spatial import Delaunay

    draw = generator(rng)
    k = max(2, round(np.sqrt(whole("n", n, 4, 10**7))) - 1)
    stretch = positive("stretch", stretch)
    column, row = (index.ravel() for index in np.meshgrid(np.arange(k + 1), np.arange(k + 1)))
    free = np.column_stack([(column > 0) & (column < k), (row > 0) & (row < k)])
    shake = draw.uniform(-0.42, 0.42, size=free.shape)
    plane = (np.column_stack([column, row]) + np.where(free, shake, 0.0)) / k
    # In the plane scipy gives triangles counter-clockwise.
    faces = Delaunay(plane * [stretch, 1.0]).simplices.astype(np.int64)
    vertices = np.pad(plane, ((0, 0), (0, 1)))
    return flat("irregular patch", vertices, faces, loops=(4 * k,), interior=free[:, 0] & free[:, 1])


def random_closed(rng: Rng, n_vertices: int = 60, *, genus: int | None = 0, n_components: int = 1) -> Shape:
    """Return a closed triangle mesh of random shape, size and place, numbered at random.

    It has vertices of valence 3, obtuse triangles, a size between about 0.01 and 100, and lies up to ten
    sizes away from the origin.

    Parameters
    ----------
    n_vertices : int
        Number of vertices of a component, about; a surface with handles takes more if it needs them.
    genus : int or None
        Number of handles of a component; None draws 0, 1 or 2 for each one.
    n_components : int
        Number of pieces.
    """
    draw = generator(rng)
    n_vertices = whole("n_vertices", n_vertices, 8, 10**6)
    n_components = whole("n_components", n_components, 1, 1000)
    genus = None if genus is None else whole("genus", genus, 0, 100)
    parts = []
    for _ in range(n_components):
        handles = int(draw.integers(3)) if genus is None else genus
        vertices, faces = _smooth_base(draw, n_vertices * 3 // 4, handles)
        vertices, faces = _with_valence_3(draw, vertices, faces)
        parts.append(Shape("random closed mesh", _bent(draw, vertices), faces, genus=handles))
    # `replace`, as the name of a union lists its parts.
    return replace(shuffled(_placed(draw, union(*parts)), draw), name="random closed mesh")


def random_bounded(
    rng: Rng,
    n_vertices: int = 60,
    *,
    loops: int | None = None,
    genus: int | None = 0,
    n_components: int = 1,
) -> Shape:
    """Return a mesh like `random_closed` with holes cut into it, no two of which share a vertex.

    Parameters
    ----------
    loops : int or None
        Number of boundary loops in all; None draws 1, 2 or 3.

    Raises
    ------
    GeometryError
        If so many holes do not fit.
    """
    draw = generator(rng)
    loops = int(draw.integers(1, 4)) if loops is None else whole("loops", loops, 1, 10**6)
    closed = random_closed(draw, n_vertices, genus=genus, n_components=n_components)
    faces = np.asarray(closed.faces)
    kept = np.ones(len(faces), dtype=bool)
    touched = np.zeros(len(closed.vertices), dtype=bool)
    lengths: list[int] = []
    for v in draw.permutation(len(touched)):
        if len(lengths) == loops:
            break
        hole = _hole_at(draw, faces, int(v))
        if not touched[faces[hole]].any():
            touched[faces[hole]] = True
            kept[hole] = False
            # A single face leaves three edges; the faces around a vertex leave one each.
            lengths.append(max(3, len(hole)))
    if len(lengths) < loops:
        raise GeometryError(
            f"only {len(lengths)} of {loops} holes fit into {len(touched)} vertices; "
            "ask for fewer loops or more vertices"
        )
    used, index = np.unique(faces[kept], return_inverse=True)
    return replace(
        closed,
        name="random mesh with holes",
        vertices=closed.vertices[used],
        faces=index.reshape(-1, 3),
        boundary_lengths=tuple(lengths),
        interior=~touched[used],
    )


def random_polygons(rng: Rng, n: int = 6, m: int = 5) -> Shape:
    """Return a torus of triangles, quads, pentagons and hexagons, numbered at random.

    Two quads side by side, ``n * m`` times, are kept, cut or merged at random.
    """
    draw = generator(rng)
    n, m = whole("n", n, 2), whole("m", m, 3)
    faces: list[list[int]] = []
    for pair in range(n * m):
        row, column = divmod(pair, n)
        low, high = (
            [k * 2 * n + (2 * column + step) % (2 * n) for step in range(3)] for k in (row, (row + 1) % m)
        )
        a, b, c, d, e, f = *low, *reversed(high)
        ways = (
            [[a, b, e, f], [b, c, d, e]],
            [[a, b, f], [b, e, f], [b, c, d, e]],
            [[a, b, f], [b, c, d, e, f]],
            [[a, b, d, e, f], [b, c, d]],
            [[a, b, c, d, e, f]],
        )
        faces += ways[int(draw.integers(len(ways)))]
    vertices = torus(2 * n, m, quads=True).vertices
    return shuffled(Shape("torus of polygons", vertices, faces, genus=1), draw)


def _smooth_base(draw: np.random.Generator, n: int, genus: int) -> tuple[FloatArray, IntArray]:
    """Return a smooth triangle mesh of about `n` vertices with `genus` handles."""
    if genus > 1:
        cells = 16 * genus + 20  # about as many as the plate of genus_surface has vertices
        surface = genus_surface(genus, subdivisions=int(n > 4 * cells) + int(n > 16 * cells))
        return surface.vertices, np.asarray(surface.faces)
    if genus == 1:
        m = max(4, round(np.sqrt(n / 2)))
        ring = torus(max(5, n // m), m, r=float(draw.uniform(0.25, 0.6)))
        return ring.vertices, np.asarray(ring.faces)
    return _random_sphere(draw, n)


def _random_sphere(draw: np.random.Generator, n: int) -> tuple[FloatArray, IntArray]:
    from scipy.spatial import ConvexHull

    # A spiral with equal steps in height covers the sphere evenly; shaken by a part of the spacing, no two
    # points come so close that slivers arise.
    height = 1 - (2 * np.arange(n) + 1) / n
    turn = np.pi * (3 - np.sqrt(5)) * np.arange(n)
    radius = np.sqrt(1 - height**2)
    points = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])
    points += draw.uniform(-1, 1, size=(n, 3)) / np.sqrt(n)
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    hull = ConvexHull(points)
    faces = hull.simplices.astype(np.int64)
    a, b, c = (points[faces[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    return points, np.where(inward[:, None], faces[:, ::-1], faces)


def _with_valence_3(
    draw: np.random.Generator, vertices: FloatArray, faces: IntArray
) -> tuple[FloatArray, IntArray]:
    """Put a vertex into one of every six faces: it has valence 3 and at least one obtuse angle."""
    split = draw.permutation(len(faces))[: max(1, len(faces) // 6)]
    weights = draw.dirichlet((3.0, 3.0, 3.0), size=len(split))
    # Well inside the face, so that no sliver arises.
    weights = 0.15 + 0.55 * weights
    new = np.einsum("ik,ikj->ij", weights, vertices[faces[split]])
    a, b, c = faces[split].T
    d = len(vertices) + np.arange(len(split))
    around = np.column_stack([a, b, d, b, c, d, c, a, d]).reshape(-1, 3)
    return np.vstack([vertices, new]), np.vstack([np.delete(faces, split, axis=0), around])


def _bent(draw: np.random.Generator, vertices: FloatArray) -> FloatArray:
    """Bend space by a wave, stretch it and turn it.

    The wave's derivative has norm 0.5, so that no two points meet and nothing is turned inside out.
    """
    wave = draw.normal(size=(3, 3))
    wave /= np.linalg.norm(wave)
    size = float(np.ptp(vertices, axis=0).max())
    turns = 4.0 / size
    bent = vertices + 0.5 / turns * np.sin(turns * vertices @ wave + draw.uniform(0, 2 * np.pi, size=3))
    stretch = np.exp(draw.uniform(-0.8, 0.8, size=3))
    return np.asarray((bent * stretch) @ _rotation(draw).T)


def _placed(draw: np.random.Generator, shape: Shape) -> Shape:
    """Give the shape another size and place, up to ten sizes away from the origin."""
    size = float(np.linalg.norm(np.ptp(shape.vertices, axis=0)))
    wanted = 10 ** float(draw.uniform(-2, 2))
    return shape.scaled(wanted / size).moved(wanted * draw.uniform(-10, 10, size=3))


def _rotation(draw: np.random.Generator) -> FloatArray:
    Q, _ = np.linalg.qr(draw.normal(size=(3, 3)))
    return np.asarray(Q * np.sign(np.linalg.det(Q)))


def _hole_at(draw: np.random.Generator, faces: IntArray, v: int) -> IntArray:
    """Choose what to cut out at vertex v: a disc of all faces around it, or one of them."""
    around = np.flatnonzero((faces == v).any(axis=1))
    return around if draw.random() < 0.7 else around[:1]
