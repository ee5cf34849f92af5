"""Areas, angles, normals and volumes against closed forms and identities."""

import numpy as np
import pytest

from gpcourse.errors import ArrayError, DegenerateFaceError, GeometryError, MeshError
from gpcourse.geometry import shapes, triangles

MEASURES = [
    triangles.area_vectors,
    triangles.face_areas,
    triangles.surface_area,
    triangles.face_normals,
    triangles.corner_angles,
    triangles.corner_cotangents,
    triangles.vertex_normals,
    triangles.enclosed_volume,
]


def one_triangle(*angles_in_degrees):
    """Return a triangle with the given angles at corners 0 and 1, somewhere in space."""
    a, b = np.radians(angles_in_degrees)
    # Law of sines with the edge from 0 to 1 of length sin(c).
    side = np.sin(b)
    flat = np.array([[0, 0, 0], [np.sin(a + b), 0, 0], [side * np.cos(a), side * np.sin(a), 0]])
    turn, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    return flat @ (turn * np.sign(np.linalg.det(turn))).T + [5, -3, 2], np.array([[0, 1, 2]])


@pytest.mark.parametrize("angles", [(60, 60), (90, 45), (120, 20), (20, 120), (1, 1), (1, 178), (0.001, 90)])
def test_angles_and_cotangents_are_those_of_the_triangle(angles):
    vertices, faces = one_triangle(*angles)
    truth = np.radians([*angles, 180 - sum(angles)])
    # The coordinates are of order 5 and rounded, the shortest edge is 1.7e-5 long.
    assert triangles.corner_angles(vertices, faces)[0] == pytest.approx(truth, abs=1e-9)
    assert triangles.corner_cotangents(vertices, faces)[0] == pytest.approx(
        1 / np.tan(truth), rel=1e-6, abs=1e-9
    )


@pytest.mark.parametrize("seed", range(5))
def test_identities_of_any_triangle(seed):
    vertices, faces = shapes.random_closed(seed)
    angles = triangles.corner_angles(vertices, faces)
    a, b, c = triangles.corner_cotangents(vertices, faces).T
    assert (angles > np.pi / 2).any()
    # Positions up to ten sizes away from the origin cost one or two of sixteen digits.
    assert angles.sum(axis=1) == pytest.approx(np.pi, abs=1e-12)
    assert a * b + b * c + c * a == pytest.approx(1.0, abs=1e-8)
    normals = triangles.face_normals(vertices, faces)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-14)
    for k in range(3):
        edge = vertices[faces[:, (k + 1) % 3]] - vertices[faces[:, k]]
        edge /= np.linalg.norm(edge, axis=1, keepdims=True)
        assert np.abs((edge * normals).sum(axis=1)).max() < 1e-10


def test_area_and_volume_of_solids():
    # Edge 1 fits the closed forms.
    edge = np.sqrt(8 / 3)
    vertices, faces = shapes.tetrahedron(radius=1 / edge)
    assert triangles.surface_area(vertices, faces) == pytest.approx(np.sqrt(3))
    assert triangles.enclosed_volume(vertices, faces) == pytest.approx(np.sqrt(2) / 12)
    vertices, faces = shapes.octahedron(radius=np.sqrt(0.5))
    assert triangles.face_areas(vertices, faces) == pytest.approx(np.full(8, np.sqrt(3) / 4))
    assert triangles.enclosed_volume(vertices, faces) == pytest.approx(np.sqrt(2) / 3)
    vertices, faces = shapes.icosahedron(radius=np.sin(2 * np.pi / 5))
    assert triangles.enclosed_volume(vertices, faces) == pytest.approx(5 * (3 + np.sqrt(5)) / 12)


@pytest.mark.parametrize(
    ("make", "sizes", "area", "volume"),
    [
        (lambda s: shapes.icosphere(s, radius=2), (2, 3, 4), 16 * np.pi, 32 * np.pi / 3),
        (lambda n: shapes.torus(n, R=2, r=0.5), (24, 48, 96), 4 * np.pi**2, np.pi**2),
    ],
)
def test_area_and_volume_converge_at_second_order(make, sizes, area, volume):
    errors = np.array(
        [
            (area - triangles.surface_area(*make(size)), volume - triangles.enclosed_volume(*make(size)))
            for size in sizes
        ]
    )
    orders = np.log2(errors[:-1] / errors[1:])  # the edge length halves each time
    assert orders == pytest.approx(2.0, abs=0.1)


def test_volume_is_the_same_anywhere_and_changes_sign_with_the_faces():
    vertices, faces = shapes.random_closed(4, genus=1)
    volume = triangles.enclosed_volume(vertices, faces)
    assert volume > 0
    size = np.ptp(vertices)
    # 1e6 sizes away, positions have ten digits left.
    assert triangles.enclosed_volume(vertices + 1e6 * size, faces) == pytest.approx(volume, rel=1e-6)
    assert triangles.enclosed_volume(vertices, faces[:, ::-1]) == pytest.approx(-volume)
    assert triangles.enclosed_volume(3 * vertices, faces) == pytest.approx(27 * volume)


def test_vector_areas_of_a_closed_surface_cancel():
    vertices, faces = shapes.random_closed(7)
    vectors = triangles.area_vectors(vertices, faces)
    assert np.abs(vectors.sum(axis=0)).max() < 1e-12 * np.abs(vectors).sum()


@pytest.mark.parametrize("weight", ["area", "angle"])
def test_vertex_normals_converge_on_the_torus(weight):
    errors = []
    for n in (16, 32, 64):
        torus = shapes.torus(n)
        errors.append(
            np.linalg.norm(triangles.vertex_normals(*torus, weight=weight) - torus.normals, axis=1).max()
        )
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2.0, abs=0.2)


def test_angle_weights_do_not_depend_on_how_a_cube_is_cut():
    cube = shapes.cube()
    for corner in range(2):
        turned = np.roll(cube.faces, corner, axis=1)
        faces = turned[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
        by_angle = triangles.vertex_normals(cube.vertices, faces, weight="angle")
        assert by_angle == pytest.approx(cube.vertices / np.sqrt(0.75), abs=1e-14)
        # The corner of a cube meets one or two triangles of a side, so areas tip the normal.
        by_area = triangles.vertex_normals(cube.vertices, faces, weight="area")
        assert np.abs(by_area - by_angle).max() > 0.1


def test_a_face_without_area_is_named():
    flat = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.1, 0.1, 0.1], [0.3, 0.3, 0.3]])
    faces = [[0, 1, 2], [0, 3, 4]]
    for measure in (
        triangles.face_normals,
        triangles.corner_angles,
        triangles.corner_cotangents,
        triangles.vertex_normals,
    ):
        with pytest.raises(DegenerateFaceError, match=r"face 1 has no area.*0\.1"):
            measure(flat, faces)
    assert triangles.face_areas(flat, faces) == pytest.approx([0.5, 0], abs=1e-16)


@pytest.mark.parametrize("scale", [1e-30, 1e-8, 1.0, 1e30])
def test_small_and_large_triangles_are_not_taken_for_flat(scale):
    vertices = scale * np.array([[0, 0, 0], [1, 0, 0], [0.5, 1e-9, 0]])
    assert triangles.face_normals(vertices, [[0, 1, 2]])[0] == pytest.approx([0, 0, 1])


def test_an_open_mesh_has_no_volume():
    for shape in (shapes.disc(), shapes.cylinder(), shapes.moebius(), shapes.random_bounded(2)):
        with pytest.raises(MeshError, match=r"edge \d+ - \d+ does not have faces on both sides"):
            triangles.enclosed_volume(*shape)
    sphere = shapes.icosphere(1)
    one_turned = np.vstack([sphere.faces[:1, ::-1], sphere.faces[1:]])
    with pytest.raises(MeshError, match="edge"):
        triangles.enclosed_volume(sphere.vertices, one_turned)


def test_a_vertex_without_a_normal_is_named():
    vertices = np.vstack([np.eye(3), [[5, 5, 5]]])
    with pytest.raises(GeometryError, match="vertex 3 has no normal"):
        triangles.vertex_normals(vertices, [[0, 1, 2]])
    # Two sides of one sheet cancel.
    with pytest.raises(GeometryError, match="vertex 0 has no normal"):
        triangles.vertex_normals(np.eye(3), [[0, 1, 2], [2, 1, 0]])


@pytest.mark.parametrize("measure", MEASURES)
def test_every_measure_checks_its_input(measure):
    with pytest.raises(ArrayError, match="vertices has shape"):
        measure(np.zeros((3, 2)), [[0, 1, 2]])
    with pytest.raises(ArrayError, match="faces has shape"):
        measure(np.eye(3), [[0, 1, 2, 0]])
    with pytest.raises(MeshError, match="face 0 names vertex 3"):
        measure(np.eye(3), [[0, 1, 3]])


def test_no_faces_are_no_trouble():
    none = np.empty((0, 3), dtype=int)
    assert triangles.face_normals(np.eye(3), none).shape == (0, 3)
    assert triangles.corner_angles(np.eye(3), none).shape == (0, 3)
    assert triangles.surface_area(np.eye(3), none) == triangles.enclosed_volume(np.eye(3), none) == 0


def test_an_unknown_weight_is_refused():
    with pytest.raises(GeometryError, match="weight is 'edges'; give 'area' or 'angle'"):
        triangles.vertex_normals(*shapes.icosphere(0), weight="edges")
