"""What shapes say of themselves, against what is counted and measured on them."""

from collections import defaultdict
from itertools import pairwise

import numpy as np
import pytest

from gpcourse.errors import ArrayError, GeometryError
from gpcourse.geometry import shapes, triangles
from gpcourse.geometry.shapes import Shape

CLOSED = {
    "tetrahedron": shapes.tetrahedron,
    "cube": shapes.cube,
    "octahedron": shapes.octahedron,
    "icosahedron": shapes.icosahedron,
    "dodecahedron": shapes.dodecahedron,
    "prism 3": lambda: shapes.prism(3),
    "prism 5": shapes.prism,
    "pyramid 3": lambda: shapes.pyramid(3),
    "pyramid 7": lambda: shapes.pyramid(7),
    "icosphere": lambda: shapes.icosphere(2),
    "smallest torus": lambda: shapes.torus(3, 3),
    "odd torus": lambda: shapes.torus(9, 5),
    "quad torus": lambda: shapes.torus(8, quads=True),
    "smallest quad torus": lambda: shapes.torus(3, 3, quads=True),
    **{
        f"genus {g}, {s} steps": lambda g=g, s=s: shapes.genus_surface(g, subdivisions=s)
        for g in range(4)
        for s in (0, 1)
    },
    **{f"random closed {seed}": lambda seed=seed: shapes.random_closed(seed) for seed in range(6)},
    "smallest random": lambda: shapes.random_closed(1, 8),
    "random genus 3": lambda: shapes.random_closed(1, 300, genus=3),
    "random of any genus": lambda: shapes.random_closed(1, genus=None, n_components=4),
    "random polygons": lambda: shapes.random_polygons(2),
    "smallest random polygons": lambda: shapes.random_polygons(2, 2, 3),
    "union": lambda: shapes.union(shapes.cube(), shapes.torus(5, 4), shapes.prism(5)),
}
BOUNDED = {
    "disc": shapes.disc,
    "smallest disc": lambda: shapes.disc(1),
    "annulus": shapes.annulus,
    "smallest annulus": lambda: shapes.annulus(3, 1),
    "cylinder": shapes.cylinder,
    "smallest cylinder": lambda: shapes.cylinder(3, 1),
    "quad cylinder": lambda: shapes.cylinder(5, 2, quads=True),
    "patch": lambda: shapes.irregular_patch(1),
    "smallest patch": lambda: shapes.irregular_patch(1, 4),
    "stretched patch": lambda: shapes.irregular_patch(1, stretch=4),
    **{f"random bounded {seed}": lambda seed=seed: shapes.random_bounded(seed) for seed in range(6)},
    "random handles and holes": lambda: shapes.random_bounded(3, 200, loops=4, genus=2, n_components=2),
    "union with a closed part": lambda: shapes.union(shapes.disc(2), shapes.cube()),
}
ONE_SIDED = {"Möbius strip": shapes.moebius, "smallest Möbius strip": lambda: shapes.moebius(3, 1)}
ALL = CLOSED | BOUNDED | ONE_SIDED
CURVED = {
    "icosphere": lambda: shapes.icosphere(2, radius=1.5),
    "torus": lambda: shapes.torus(12, R=2, r=0.7),
    "cylinder": lambda: shapes.cylinder(radius=0.6),
}


def ring(face, length=2):
    """Return every run of `length` corners around the face."""
    return zip(*(np.roll(face, -k).tolist() for k in range(length)), strict=True)


def directed_edges(shape):
    return [(a, b) for face in shape.faces for a, b in ring(face)]


def edges(shape):
    return {frozenset(edge) for edge in directed_edges(shape)}


def components(shape):
    """Count the pieces of the vertices that faces use."""
    neighbours = defaultdict(set)
    for a, b in directed_edges(shape):
        neighbours[a].add(b)
        neighbours[b].add(a)
    count, unseen = 0, set(neighbours)
    while unseen:
        count, front = count + 1, [unseen.pop()]
        while front:
            fresh = neighbours[front.pop()] & unseen
            unseen -= fresh
            front += fresh
    return count


def boundary_edges(shape):
    counts = defaultdict(int)
    for edge in directed_edges(shape):
        counts[frozenset(edge)] += 1
    assert max(counts.values()) <= 2
    return {edge for edge, count in counts.items() if count == 1}


def loop_lengths(shape):
    """Walk the boundary; every vertex on it must have two boundary edges."""
    at = defaultdict(set)
    for edge in boundary_edges(shape):
        for v in edge:
            at[v] |= edge - {v}
    assert all(len(ends) == 2 for ends in at.values())
    lengths, unseen = [], set(at)
    while unseen:
        front, length = [unseen.pop()], 0
        while front:
            length += 1
            fresh = at[front.pop()] & unseen
            unseen -= fresh
            front += fresh
        lengths.append(length)
    return tuple(sorted(lengths, reverse=True))


@pytest.mark.parametrize("make", ALL.values(), ids=ALL)
def test_stated_facts_are_the_counted_ones(make):
    shape = make()
    loops = loop_lengths(shape)
    assert shape.boundary_lengths == loops
    assert shape.closed == (not loops)
    on_boundary = sorted({v for edge in boundary_edges(shape) for v in edge})
    assert np.flatnonzero(~shape.interior).tolist() == on_boundary
    assert shape.n_components == components(shape)
    used = {v for edge in edges(shape) for v in edge}
    assert used == set(range(len(shape.vertices)))  # no vertex without a face
    chi = len(shape.vertices) - len(edges(shape)) + len(shape.faces)
    if shape.genus is not None:
        assert chi == 2 * shape.n_components - 2 * shape.genus - len(loops)


@pytest.mark.parametrize("make", (CLOSED | BOUNDED).values(), ids=CLOSED | BOUNDED)
def test_neighbours_run_along_their_edge_in_opposite_directions(make):
    directed = directed_edges(make())
    assert len(set(directed)) == len(directed)


@pytest.mark.parametrize("make", ALL.values(), ids=ALL)
def test_the_faces_around_a_vertex_form_one_fan(make):
    shape = make()
    spokes = defaultdict(list)  # for each vertex, what each face there spans: the corners before and after
    for face in shape.faces:
        for before, v, after in ring(face, 3):
            spokes[v].append({before, after})
    for fan in spokes.values():
        joined = [fan.pop()]
        for span in joined:
            joined += [other for other in fan if other & span]
            fan[:] = [other for other in fan if not other & span]
        assert not fan


@pytest.mark.parametrize("make", CLOSED.values(), ids=CLOSED)
def test_closed_shapes_are_outward(make):
    shape = make()
    fans = [[f[0], f[k], f[k + 1]] for f in shape.faces for k in range(1, len(f) - 1)]
    assert triangles.enclosed_volume(shape.vertices, fans) > 0


@pytest.mark.parametrize("make", ONE_SIDED.values(), ids=ONE_SIDED)
def test_a_moebius_strip_cannot_be_oriented(make):
    shape = make()
    assert shape.genus is None
    faces_at = defaultdict(list)
    for f, face in enumerate(shape.faces.tolist()):
        for a, b in ring(face):
            faces_at[frozenset((a, b))].append((f, a < b))
    pairs = [pair for pair in faces_at.values() if len(pair) == 2]
    # Turn faces until neighbours agree, from face 0 on; somewhere the two ways round contradict each other.
    turned = {0: False}
    for _ in shape.faces:
        for (f, along_f), (g, along_g) in pairs:
            for one, other in ((f, g), (g, f)):
                if one in turned:
                    turned.setdefault(other, turned[one] ^ (along_f == along_g))
    assert any(turned[f] ^ turned[g] ^ (along_f == along_g) for (f, along_f), (g, along_g) in pairs)


# Curvature ---------------------------------------------------------------------------------------


def unit_gradient(name, x):
    """The outward normal of the level surfaces of the distance to a point, a circle or an axis."""
    if name == "icosphere":
        gradient = x
    else:
        axial = x * [1, 1, 0]
        distance = np.linalg.norm(axial, axis=1, keepdims=True)
        gradient = axial if name == "cylinder" else x - 2 * axial / distance
    return gradient / np.linalg.norm(gradient, axis=1, keepdims=True)


@pytest.mark.parametrize(("name", "make"), CURVED.items(), ids=CURVED)
def test_normals_and_curvatures_are_those_of_the_smooth_surface(name, make):
    shape = make()
    n = unit_gradient(name, shape.vertices)
    assert shape.normals == pytest.approx(n, abs=1e-12)
    # The derivative of the normal field is the shape operator; central differences, h = 1e-5.
    step = 1e-5 * np.eye(3)
    shape_operator = np.stack(
        [
            (unit_gradient(name, shape.vertices + h) - unit_gradient(name, shape.vertices - h)) / 2e-5
            for h in step
        ],
        axis=2,
    )
    # Along the normal the field does not change, so that the third eigenvalue is zero.
    trace = np.trace(shape_operator, axis1=1, axis2=2)
    minors = (trace**2 - np.einsum("nij,nji->n", shape_operator, shape_operator)) / 2
    assert shape.mean_curvature == pytest.approx(trace / 2, abs=1e-8)
    assert shape.gaussian_curvature == pytest.approx(minors, abs=1e-8)
    k1, k2 = shape.principal_curvatures.T
    assert (k1 >= k2).all()
    assert (k1 + k2) / 2 == pytest.approx(shape.mean_curvature)
    assert k1 * k2 == pytest.approx(shape.gaussian_curvature, abs=1e-15)


def test_a_sphere_has_mean_curvature_plus_one_over_R():
    assert shapes.icosphere(1, radius=4).mean_curvature == pytest.approx(0.25)


def test_total_curvature_of_the_torus_is_zero():
    # The trapezoidal rule on a periodic function: exact up to rounding.
    torus = shapes.torus(64, 64, R=1, r=0.3, quads=True)
    area = 0.3 * np.hypot(*torus.vertices[:, :2].T)  # |x_u × x_v| = r (R + r cos v)
    assert abs((torus.gaussian_curvature * area).sum()) < 1e-10 * area.sum()
    assert area.sum() * (2 * np.pi / 64) ** 2 == pytest.approx(4 * np.pi**2 * 0.3)


def test_flat_shapes_are_flat():
    for shape in (shapes.disc(), shapes.annulus(), shapes.irregular_patch(3)):
        assert not shape.vertices[:, 2].any()
        assert triangles.face_normals(*shape) == pytest.approx(np.tile([0, 0, 1], (len(shape.faces), 1)))
        assert not shape.mean_curvature.any()
        assert not shape.gaussian_curvature.any()


# Single shapes -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "faces", "corners", "valence"),
    [
        (shapes.tetrahedron, 4, 3, 3),
        (shapes.cube, 6, 4, 3),
        (shapes.octahedron, 8, 3, 4),
        (shapes.icosahedron, 20, 3, 5),
        (shapes.dodecahedron, 12, 5, 3),
    ],
)
def test_platonic_solids_are_regular(make, faces, corners, valence):
    solid = make()
    assert solid.faces.shape == (faces, corners)
    assert set(np.bincount(solid.faces.ravel())) == {valence}
    lengths = [np.ptp(solid.vertices[list(edge)], axis=0) for edge in edges(solid)]
    assert np.linalg.norm(lengths, axis=1) == pytest.approx(np.linalg.norm(lengths[0]))


def test_sizes_are_those_asked_for():
    for make in (shapes.tetrahedron, shapes.octahedron, shapes.icosahedron, shapes.dodecahedron):
        assert np.linalg.norm(make(radius=2.5).vertices, axis=1) == pytest.approx(2.5)
    assert np.abs(shapes.cube(side=3).vertices) == pytest.approx(1.5)
    x, y, z = shapes.torus(12, R=2, r=0.25).vertices.T
    assert np.hypot(np.hypot(x, y) - 2, z) == pytest.approx(0.25)
    tube = shapes.cylinder(radius=2, height=3).vertices
    assert np.hypot(tube[:, 0], tube[:, 1]) == pytest.approx(2)
    assert np.ptp(tube[:, 2]) == pytest.approx(3)
    ring = np.linalg.norm(shapes.annulus(inner=0.2, outer=3).vertices, axis=1)
    assert (ring.min(), ring.max()) == pytest.approx((0.2, 3))
    assert np.linalg.norm(shapes.disc(3, radius=2).vertices, axis=1).max() == pytest.approx(2)
    assert len(shapes.icosphere(3).faces) == 20 * 4**3


def test_a_cylinder_faces_outward():
    tube = shapes.cylinder(40, 9)
    middle = tube.vertices[tube.faces].mean(axis=1) * [1, 1, 0]
    assert ((triangles.face_normals(*tube) * middle).sum(axis=1) > 0).all()


def test_triangles_of_regular_shapes_are_acute():
    for shape in (shapes.icosphere(2), shapes.torus(32), shapes.disc(), shapes.cylinder()):
        assert triangles.corner_angles(*shape).max() < np.pi / 2
    assert triangles.corner_angles(*shapes.annulus()).min() > np.radians(25)


def test_a_surface_with_handles_gets_smoother_with_every_step_and_stays_inside_its_cubes():
    bends = []
    for steps in range(4):
        shape = shapes.genus_surface(2, subdivisions=steps)
        assert (np.abs(shape.vertices).max(axis=0) <= np.array([2.5, 1.5, 0.5]) + 1e-12).all()
        normals, faces_at = triangles.face_normals(*shape), defaultdict(list)
        for f, face in enumerate(shape.faces):
            for edge in ring(face):
                faces_at[frozenset(edge)].append(f)
        left, right = np.array(list(faces_at.values())).T
        bends.append(np.degrees(np.arccos(np.einsum("ij,ij->i", normals[left], normals[right]).min())))
    # The sharpest edges are the cubes' right angles; measured ratios 0.66, 0.60, 0.59.
    assert bends[0] == pytest.approx(90)
    assert (np.divide(bends[1:], bends[:-1]) < 0.7).all()


@pytest.mark.parametrize("seed", range(40))
def test_irregular_patches_cover_the_square_with_obtuse_triangles(seed):
    patch = shapes.irregular_patch(seed, 4 + 7 * seed, stretch=(1.0, 3.0)[seed % 2])
    assert triangles.surface_area(*patch) == pytest.approx(1.0, abs=1e-12)
    assert (triangles.face_areas(*patch) > 1e-6).all()
    if len(patch.vertices) > 16:
        assert (triangles.corner_angles(*patch) > np.radians(95)).any()


def angle_sums_across_edges(patch):
    opposite, boundary = defaultdict(float), boundary_edges(patch)
    for face, angles in zip(patch.faces.tolist(), triangles.corner_angles(*patch), strict=True):
        for k in range(3):
            opposite[frozenset((face[k - 1], face[k - 2]))] += angles[k]
    return np.array([total for edge, total in opposite.items() if edge not in boundary])


def test_irregular_patches_are_delaunay_unless_stretched():
    assert angle_sums_across_edges(shapes.irregular_patch(5)).max() <= np.pi + 1e-12
    assert (angle_sums_across_edges(shapes.irregular_patch(5, stretch=3)) > np.pi + 0.1).sum() > 10


@pytest.mark.parametrize("seed", range(20))
def test_random_meshes_have_valence_3_and_obtuse_triangles_and_no_slivers(seed):
    shape = shapes.random_closed(seed, genus=None)
    assert np.bincount(shape.faces.ravel()).min() == 3
    angles = triangles.corner_angles(*shape)
    assert angles.max() > np.radians(110)
    # Over 300 seeds the smallest angle was 1.4 degrees.
    assert angles.min() > np.radians(0.5)


def test_random_meshes_come_in_all_sizes_and_places():
    meshes = [shapes.random_closed(seed).vertices for seed in range(40)]
    sizes = np.array([np.linalg.norm(np.ptp(vertices, axis=0)) for vertices in meshes])
    away = np.array([np.linalg.norm(vertices.mean(axis=0)) for vertices in meshes]) / sizes
    assert sizes.min() < 0.05
    assert sizes.max() > 20
    assert away.max() > 5


def test_random_meshes_have_about_the_number_of_vertices_asked_for():
    for n in (20, 60, 500, 2000):
        assert 0.7 * n < len(shapes.random_closed(1, n).vertices) < 1.4 * n
        assert 0.6 * n < len(shapes.random_closed(1, n, genus=1).vertices) < 1.4 * n


def test_random_bounded_makes_the_loops_asked_for_of_many_lengths():
    lengths = set()
    for seed in range(12):
        shape = shapes.random_bounded(seed, 80, loops=1 + seed % 4, genus=seed % 2)
        assert len(shape.boundary_lengths) == 1 + seed % 4
        assert shape.genus == seed % 2
        lengths |= set(shape.boundary_lengths)
    assert {3, 5, 6, 7} <= lengths


def test_random_polygons_mix_sizes():
    sizes = {len(face) for face in shapes.random_polygons(1, 8, 8).faces}
    assert sizes == {3, 4, 5, 6}


RANDOM = [
    shapes.irregular_patch,
    shapes.random_closed,
    shapes.random_bounded,
    shapes.random_polygons,
    lambda rng: shapes.shuffled(shapes.prism(5), rng),
]


@pytest.mark.parametrize("make", RANDOM)
def test_the_same_seed_makes_the_same_shape(make):
    one, again = make(3), make(np.random.default_rng(3))
    assert np.array_equal(one.vertices, again.vertices)
    assert [list(face) for face in one.faces] == [list(face) for face in again.faces]
    assert not np.array_equal(one.vertices, make(4).vertices)


# Changing shapes ---------------------------------------------------------------------------------


def cycles(shape):
    """The faces as cycles of positions, from the smallest corner on."""
    found = set()
    for face in shape.faces:
        corners = [tuple(shape.vertices[v]) for v in face]
        first = corners.index(min(corners))
        found.add(tuple(corners[first:] + corners[:first]))
    return found


@pytest.mark.parametrize("make", [shapes.torus, shapes.prism, shapes.disc, shapes.moebius])
def test_shuffling_keeps_the_surface(make):
    shape = make()
    mixed = shapes.shuffled(shape, 5)
    assert cycles(mixed) == cycles(shape)
    assert len(mixed.faces) == len(shape.faces)
    assert loop_lengths(mixed) == mixed.boundary_lengths == shape.boundary_lengths
    assert not np.array_equal(mixed.vertices, shape.vertices)
    where = {tuple(x): i for i, x in enumerate(shape.vertices)}
    old = [where[tuple(x)] for x in mixed.vertices]
    assert np.array_equal(mixed.interior, shape.interior[old])
    if shape.normals is not None:
        assert np.array_equal(mixed.normals, shape.normals[old])
        assert np.array_equal(mixed.principal_curvatures, shape.principal_curvatures[old])
    # Faces start at a random corner.
    assert {list(face).index(min(face)) for face in mixed.faces} >= {0, 1, 2}


def test_union_keeps_what_is_known_of_all_parts():
    both = shapes.union(shapes.torus(8), shapes.icosphere(1, radius=3))
    assert (both.genus, both.n_components, both.boundary_lengths) == (1, 2, ())
    assert both.mean_curvature[-1] == pytest.approx(1 / 3)
    assert len(both.normals) == len(both.vertices)
    assert both.faces.shape == (64 + 80, 3)
    mixed = shapes.union(shapes.torus(8), shapes.cube())
    assert mixed.normals is None
    assert {len(face) for face in mixed.faces} == {3, 4}
    assert shapes.union(shapes.moebius(), shapes.disc()).genus is None


def test_parts_of_a_union_do_not_touch():
    parts = shapes.union(*(shapes.random_closed(seed) for seed in range(4)))
    count = np.cumsum([0] + [len(shapes.random_closed(seed).vertices) for seed in range(4)])
    x = [parts.vertices[a:b, 0] for a, b in pairwise(count)]
    assert all(left.max() < right.min() for left, right in pairwise(x))


def test_curvatures_follow_a_similarity():
    torus = shapes.torus(12)
    turn, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    moved = torus.transformed(2.5 * turn, (1, 2, 3))
    assert moved.vertices == pytest.approx(2.5 * torus.vertices @ turn.T + [1, 2, 3])
    assert moved.normals == pytest.approx(torus.normals @ turn.T)
    assert moved.mean_curvature == pytest.approx(torus.mean_curvature / 2.5)
    assert moved.gaussian_curvature == pytest.approx(torus.gaussian_curvature / 6.25)
    assert moved.principal_curvatures == pytest.approx(torus.principal_curvatures / 2.5)
    assert torus.scaled(0.5).mean_curvature == pytest.approx(2 * torus.mean_curvature)
    assert torus.moved((0, 0, 5)).gaussian_curvature is torus.gaussian_curvature
    assert (moved.genus, moved.closed) == (1, True)


def test_normals_follow_any_map_and_curvatures_none_but_a_similarity():
    axes = np.array([1.0, 2.0, 3.0])
    ellipsoid = shapes.icosphere(2).transformed(np.diag(axes))
    gradient = ellipsoid.vertices / axes**2
    assert ellipsoid.normals == pytest.approx(gradient / np.linalg.norm(gradient, axis=1, keepdims=True))
    assert ellipsoid.mean_curvature is ellipsoid.gaussian_curvature is ellipsoid.principal_curvatures is None


def test_a_shape_unpacks_and_prints():
    vertices, faces = shapes.annulus(6, 1)
    assert (len(vertices), len(faces)) == (12, 12)
    assert (
        repr(shapes.annulus(6, 1))
        == "<Shape annulus: 12 vertices, 12 faces, genus 0, boundary loops of 6, 6 edges>"
    )
    assert "one-sided" in repr(shapes.moebius())
    assert "2 components" in repr(shapes.union(shapes.cube(), shapes.cube()))


# Refusals ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: shapes.torus(2), "n is 2; it must be at least 3"),
        (lambda: shapes.torus(2.5), "n is 2.5; give a whole number"),
        (lambda: shapes.torus("8"), "n is '8'; give a whole number"),
        (lambda: shapes.torus(8, 2), "m is 2"),
        (lambda: shapes.torus(8, R=1, r=1), "r is 1.0 and R is 1.0; the tube meets itself"),
        (lambda: shapes.torus(8, r=-1), "r is -1.0; it must be positive"),
        (lambda: shapes.torus(8, r=np.nan), "r is nan; it must be positive and finite"),
        (lambda: shapes.icosphere(10), "subdivisions is 10; it must be from 0 to 9"),
        (lambda: shapes.icosphere(-1), "subdivisions is -1"),
        (lambda: shapes.icosphere(1, radius=np.inf), "radius is inf"),
        (lambda: shapes.tetrahedron("big"), "radius is 'big'; give a positive number"),
        (lambda: shapes.cube(0), "side is 0.0"),
        (lambda: shapes.prism(2), "k is 2"),
        (lambda: shapes.pyramid(5, height=-1), "height is -1.0"),
        (lambda: shapes.genus_surface(-1), "genus is -1; it must be from 0"),
        (lambda: shapes.genus_surface(2, subdivisions=7), "subdivisions is 7"),
        (lambda: shapes.disc(0), "rings is 0"),
        (lambda: shapes.annulus(2), "n is 2"),
        (lambda: shapes.annulus(inner=2, outer=1), "inner is 2.0 and outer is 1.0"),
        (lambda: shapes.cylinder(5, 0), "rows is 0"),
        (lambda: shapes.moebius(2), "n is 2"),
        (lambda: shapes.moebius(width=2), "width is 2.0 and radius is 1.0"),
        (lambda: shapes.irregular_patch(1, 3), "n is 3"),
        (lambda: shapes.irregular_patch(1, stretch=0), "stretch is 0.0"),
        (lambda: shapes.irregular_patch(None), "rng is None; give numpy.random.default_rng"),
        (lambda: shapes.random_closed(-1), "rng is -1"),
        (lambda: shapes.random_closed(1, 7), "n_vertices is 7"),
        (lambda: shapes.random_closed(1, n_components=0), "n_components is 0"),
        (lambda: shapes.random_closed(1, genus=-1), "genus is -1"),
        (lambda: shapes.random_bounded(1, loops=0), "loops is 0"),
        (lambda: shapes.random_bounded(1, 20, loops=50), r"only \d+ of 50 holes fit into \d+ vertices"),
        (lambda: shapes.random_polygons(1, 1), "n is 1"),
        (shapes.union, "nothing"),
        (lambda: shapes.cube().scaled(-1), "factor is -1.0"),
        (lambda: shapes.cube().moved((1, 2)), "shift has shape"),
        (lambda: shapes.cube().transformed(np.diag([1, 1, -1])), "positive determinant"),
        (lambda: shapes.cube().transformed(np.eye(2)), r"matrix has shape \(2, 2\)"),
        (lambda: shapes.cube().transformed(np.ones((2, 3))), r"matrix must be \(3, 3\)"),
        (lambda: Shape("no flags", np.eye(3), [[0, 1, 2]], boundary_lengths=(3,)), "interior is missing"),
        (lambda: Shape("bad", np.eye(3), [[0, 1, 3]]), "face 0 names vertex 3"),
    ],
)
def test_bad_parameters_are_refused(make, says):
    with pytest.raises(GeometryError, match=says):
        make()


def test_values_per_vertex_must_fit():
    with pytest.raises(ArrayError, match="normals has 2 rows; give one for each of 3 vertices"):
        Shape("bad", np.eye(3), [[0, 1, 2]], interior=np.zeros(3, bool), normals=np.eye(3)[:2])
