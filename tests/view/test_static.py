"""What is drawn: depth, colour, frame, and the same bytes every time."""

from io import BytesIO

import numpy as np
import pytest
from matplotlib import colormaps
from PIL import Image

from gpcourse import view
from gpcourse.reference.halfedge import halfedge_mesh
from gpcourse.view import scene
from gpcourse.view.camera import good_camera, view_axes
from gpcourse.view.depth import painting_order

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
CUBE = (
    np.array([[x, y, z] for z in (0.0, 1) for y in (0.0, 1) for x in (0.0, 1)]),
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]],
)
TOWARDS_CAMERA = (0, 0, 1)


def pixels(picture):
    return np.asarray(Image.open(BytesIO(picture.png())).convert("RGB")).astype(int)


def share(picture, colour, tolerance=40):
    """The share of the picture that has nearly this colour."""
    rgb = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    return (np.abs(pixels(picture) - rgb).max(axis=2) <= tolerance).mean()


def triangles_at(*heights):
    """Equal triangles over one another."""
    base = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    vertices = np.concatenate([np.add(base, [0, 0, h]) for h in heights])
    return vertices, np.arange(3 * len(heights)).reshape(-1, 3)


@pytest.mark.parametrize("heights", [(0, 1), (1, 0)])
@pytest.mark.parametrize("smooth", [False, True])
def test_the_nearer_triangle_covers_the_farther(heights, smooth):
    colours = ["#ff0000" if h == 1 else "#0000ff" for h in heights]
    picture = view.mesh(
        triangles_at(*heights), face_colours=colours, direction=TOWARDS_CAMERA, smooth=smooth, edges=False
    )
    assert share(picture, "#ff0000") > 0.25
    assert share(picture, "#0000ff") < 0.005


def test_order_holds_where_mean_heights_mislead():
    # A long ramp whose middle is higher than the small tile that lies on its low end.
    page = np.array([[0, 0], [100, 0], [100, 10], [0, 10], [2, 2], [8, 2], [8, 8], [2, 8]], dtype=float)
    height = np.array([0, 100, 100, 0, 12, 12, 12, 12], dtype=float)
    for corners, last in ((np.arange(8), 1), (np.r_[4:8, 0:4], 0)):
        order = painting_order(page, height, corners, np.array([4, 4]))
        assert order[-1] == last


def test_order_of_random_disjoint_triangles_agrees_with_rays():
    rng = np.random.default_rng(3)
    # Small triangles at heights of their own never cut each other.
    count = 60
    centre = rng.uniform(0, 40, size=(count, 1, 2))
    page = (centre + rng.uniform(-15, 15, size=(count, 3, 2))).reshape(-1, 2)
    height = (10.0 * rng.permutation(count)[:, None] + rng.uniform(-4, 4, size=(count, 3))).ravel()
    order = painting_order(page, height, np.arange(3 * count), np.full(count, 3))
    rank = np.empty(count, dtype=int)
    rank[order] = np.arange(count)
    seen = 0
    for point in rng.uniform(0, 40, size=(200, 2)):
        on = [k for k in range(count) if inside(point, page[3 * k : 3 * k + 3])]
        by_height = sorted(
            on, key=lambda k: height_at(point, page[3 * k : 3 * k + 3], height[3 * k : 3 * k + 3])
        )
        assert by_height == sorted(on, key=lambda k: rank[k])
        seen += len(on)
    assert seen > 400


def barycentric(point, corners):
    return np.linalg.solve(np.vstack([corners.T, np.ones(3)]), [*point, 1.0])


def inside(point, corners):
    return (barycentric(point, corners) > 0).all()


def height_at(point, corners, heights):
    return barycentric(point, corners) @ heights


def test_surfaces_that_cut_each_other_are_cut_where_they_meet():
    flat = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    steep = flat + np.outer(flat[:, 0], [0, 0, 1.0])  # above the other for x > 0
    meshes = [
        scene.Mesh(x, [[0, 1, 2, 3]], colour=c, edges=False)
        for x, c in ((flat, "#ff0000"), (steep, "#0000ff"))
    ]
    seen = pixels(
        view.Picture(scene.Scene((scene.Panel(meshes, camera=scene.Camera((0, 0, 1), (0, 1, 0))),)))
    )
    drawn = (seen < 250).any(axis=2)
    columns = np.flatnonzero(drawn.any(axis=0))
    middle = int(columns.mean())
    red, blue = seen[..., 0] > seen[..., 2], seen[..., 2] > seen[..., 0]
    assert red[drawn & (np.arange(seen.shape[1]) < middle - 3)].mean() > 0.99
    assert blue[drawn & (np.arange(seen.shape[1]) > middle + 3)].mean() > 0.99


def test_the_near_side_of_a_spike_is_seen_among_many_faces():
    n = 16  # 450 triangles: too many to be ordered one by one
    x, y = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(n * n)]).astype(float)
    a = (n * np.arange(n - 1)[:, None] + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.column_stack([a, a + n, a + n + 1]), np.column_stack([a, a + n + 1, a + 1])])
    tip = n * (n // 2) + n // 2
    vertices[[tip, tip - 1], 2] = 9, -3  # before the spike there is a pit
    seen = pixels(view.mesh((vertices, faces), direction=(0.3, -1, 0.9), edges=False))
    assert ((seen[..., 0] - seen[..., 2]) > 40).mean() < 0.0005  # nothing of the orange inner side


def test_a_cycle_is_broken_and_all_are_painted():
    # Three long tiles, each over the next: no order is right, but every tile must be painted once.
    turn = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in np.deg2rad([0, 120, 240])]
    tile = np.array([[-30.0, -16], [30, -16], [30, -6], [-30, -6]])
    page = np.concatenate([tile @ t.T for t in turn])
    height = np.tile([-5.0, 5.0, 5.0, -5.0], 3)
    order = painting_order(page, height, np.arange(12), np.full(3, 4))
    assert sorted(order.tolist()) == [0, 1, 2]


@pytest.mark.parametrize("direction", [(1, -1, 1), (0, 0, 1), (0, -1, 0.2), (-2, 3, -1)])
def test_the_mesh_fills_the_frame(direction):
    picture = view.mesh(CUBE, direction=direction)
    drawn = (pixels(picture) < 250).any(axis=2)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    high, wide = drawn.shape
    assert drawn.mean() > 0.4
    assert max(len(rows) / high, len(columns) / wide) > 0.85
    # Centred to a pixel or two, and nothing is cut off.
    assert abs(rows[0] - (high - 1 - rows[-1])) <= 3
    assert abs(columns[0] - (wide - 1 - columns[-1])) <= 3
    assert rows[0] > 5


def test_position_and_scale_of_a_mesh_do_not_matter():
    vertices, faces = CUBE
    usual = pixels(view.mesh(CUBE))
    for changed in (
        0.01 * vertices,
        100 * vertices,
        np.add(vertices, [3000, -2000, 1000]),
        1e-80 * vertices,
        1e180 * vertices,
    ):
        assert np.abs(pixels(view.mesh((changed, faces))) - usual).mean() < 0.05


@pytest.mark.parametrize("value", [-1.0, -0.4, 0.0, 0.7, 1.0])
@pytest.mark.parametrize("values_on", ["faces", "vertices"])
def test_a_value_has_the_colour_of_its_place_on_the_scale(value, values_on):
    # Two squares that face the camera; the light leaves the colour as it is.
    vertices = np.vstack([SQUARE, np.add(SQUARE, [2, 0, 0])])
    values = [value, 1.0] if values_on == "faces" else [value] * 4 + [1.0] * 4
    picture = view.mesh(
        (vertices, [[0, 1, 2, 3], [4, 5, 6, 7]]),
        values,
        values_on=values_on,
        limits=(-1, 1),
        colour_map="RdBu_r",
        edges=False,
    )
    drawn = (pixels(picture) < 255).any(axis=2)
    left = np.flatnonzero(drawn.any(axis=0))[0] + 30
    seen = pixels(picture)[drawn.shape[0] // 2, left]
    expected = np.round(255 * np.array(colormaps["RdBu_r"]((value + 1) / 2)[:3]))
    assert np.abs(seen - expected).max() <= 3


def test_zero_is_white_when_values_have_both_signs():
    picture = view.mesh((SQUARE, [[0, 1, 2], [0, 2, 3]]), [0.0, 5.0], values_on="faces", edges=False)
    assert picture.scene.scales()[0].low == 0  # one sign: sequential
    picture = view.mesh(
        (np.vstack([SQUARE, [[2, 0, 0]]]), [[0, 1, 2], [0, 2, 3], [1, 4, 2]]), [0.0, 5.0, -0.1], edges=False
    )
    assert share(picture, "#f7f7f7", tolerance=3) > 0.1


def test_values_that_are_not_finite_are_grey():
    picture = view.mesh((SQUARE, [[0, 1, 2], [0, 2, 3]]), [np.nan, 1.0], values_on="faces", edges=False)
    assert share(picture, "#b9bcc0", tolerance=3) > 0.2


def test_colours_of_vertices_are_blended_over_the_faces():
    square = (np.array(SQUARE, dtype=float), [[0, 1, 2], [0, 2, 3]])
    colours = [[1, 0, 0], [0, 0, 1], [0, 0, 1], [1, 0, 0]]  # red on the left, blue on the right
    seen = pixels(view.mesh(square, vertex_colours=colours, edges=False, direction=TOWARDS_CAMERA))
    drawn = np.flatnonzero((seen[len(seen) // 2] < 250).any(axis=1))
    left, middle, right = (seen[len(seen) // 2, drawn[0] + k * len(drawn) // 10] for k in (1, 5, 9))
    assert left[0] > 200 > 60 > left[2]
    assert right[2] > 200 > 60 > right[0]
    assert abs(middle[0] - middle[2]) < 30


def test_the_back_of_an_open_mesh_has_another_colour():
    front = view.mesh((SQUARE, [[0, 1, 2, 3]]), direction=(0, 0, 1), edges=False)
    back = view.mesh((SQUARE, [[0, 1, 2, 3]]), direction=(0, 0, -1), edges=False)
    blueness = [
        np.median((p[..., 2] - p[..., 0])[(p < 250).any(axis=2)]) for p in (pixels(front), pixels(back))
    ]
    assert blueness[0] > 20
    assert blueness[1] < -40


def test_a_closed_mesh_shows_no_back():
    for direction in np.random.default_rng(0).normal(size=(5, 3)):
        seen = pixels(view.mesh(CUBE, direction=direction))
        assert ((seen[..., 0] - seen[..., 2]) > 20).mean() < 0.001


def test_half_edges_along_a_hole_are_red_and_outside():
    mesh = halfedge_mesh(np.array(SQUARE, dtype=float), [[0, 1, 2, 3]])
    arrows = [
        layer for layer in view.halfedges(mesh).scene.panels[0].layers if isinstance(layer, scene.Arrows)
    ]
    (drawn,) = arrows
    assert len(drawn.tails) == 8
    for h, (tail, head, colour) in enumerate(zip(drawn.tails, drawn.heads, drawn.colours, strict=True)):
        middle = (tail + head)[:2] / 2
        within = (middle > 0).all() and (middle < 1).all()
        assert within == (mesh.face[h] >= 0)
        assert (colour == view.connectivity.HOLE_HALFEDGE) == (mesh.face[h] < 0)
        # Every arrow lies to the left of its edge and runs along it.
        start, end = mesh.vertices[mesh.origin[h]], mesh.vertices[mesh.origin[mesh.next[h]]]
        edge = end - start
        assert np.cross(edge, tail - start)[2] > 0.01
        assert (head - tail) @ edge > 0.5
    assert share(view.halfedges(mesh), view.connectivity.HOLE_HALFEDGE) > 0.003
    closed = halfedge_mesh(*CUBE)
    assert share(view.halfedges(closed), view.connectivity.HOLE_HALFEDGE) == 0


def test_highlighted_half_edges_are_turned_to_the_viewer():
    mesh = halfedge_mesh(*CUBE)
    for h in mesh.face_halfedge.tolist():
        picture = view.halfedges(mesh, highlight={h: "#ff00ff"})
        assert share(picture, "#ff00ff", tolerance=20) > 0.001, f"half-edge {h} is not seen"


def test_what_lies_behind_a_surface_is_not_drawn_over_it():
    vertices, faces = CUBE
    surface = scene.Mesh(vertices, faces)
    camera = scene.Camera((1, 1, 1))
    for corner, seen in ((7, True), (0, False)):
        points = scene.Points(vertices[[corner]], ("#ff00ff",), size=12)
        picture = view.Picture(scene.Scene((scene.Panel((surface, points), camera=camera),)))
        assert (share(picture, "#ff00ff", tolerance=5) > 0.0005) == seen


def test_a_flat_mesh_is_seen_from_straight_above_its_outer_side():
    square = np.array(SQUARE, dtype=float)
    for normal, faces in ((1, [[0, 1, 2, 3]]), (-1, [[3, 2, 1, 0]])):
        camera = view.mesh((square, faces)).scene.panels[0].camera
        np.testing.assert_allclose(view_axes(camera)[2], [0, 0, normal], atol=1e-12)


def test_view_axes_are_a_right_handed_frame_even_when_up_is_useless():
    rng = np.random.default_rng(1)
    for direction, up in [(d, u) for d, u in rng.normal(size=(20, 2, 3))] + [((0, 0, 2), (0, 0, 1))]:
        axes = view_axes(scene.Camera(tuple(direction), tuple(up)))
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(axes) == pytest.approx(1)
        np.testing.assert_allclose(axes[2], np.divide(direction, np.linalg.norm(direction)), atol=1e-12)


def test_the_tetrahedron_shows_more_than_one_face():
    vertices = np.array([[1.0, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]])
    faces = [[0, 1, 3], [0, 2, 1], [0, 3, 2], [1, 2, 3]]
    normals = np.array([np.cross(vertices[b] - vertices[a], vertices[c] - vertices[a]) for a, b, c in faces])
    assert (normals @ view_axes(good_camera(vertices, normals))[2] > 0.1).sum() >= 2


EMPTY = (np.zeros((0, 3)), [])


@pytest.mark.parametrize(
    "make",
    [
        lambda: view.mesh(
            CUBE, labels="vertices", title="A title that needs several lines, for it is very long"
        ),
        lambda: view.mesh(CUBE, labels="faces", smooth=True, edges=True),
        lambda: view.mesh(EMPTY),
        lambda: view.mesh(([[0, 0, 0]] * 3, [[0, 1, 2]]), [1, 2, 3]),
        lambda: view.mesh(([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])),
        lambda: view.neighbours(CUBE, 0, [1, 4, 2, 7, 0, 1]),
        lambda: view.neighbours(CUBE, 0, []),
        lambda: view.points(np.random.default_rng(0).normal(size=(50, 3)), np.arange(50)),
        lambda: view.points([[1.0, 2.0]]),
        lambda: view.points(np.zeros((0, 3))),
        lambda: view.curves([[0, 0], [1, 1], [2, 0]], closed=True),
        lambda: view.curves([CUBE[0]], on=CUBE, colours=["red"]),
        lambda: view.vectors(CUBE[0], CUBE[0] - 0.5, on=CUBE),
        lambda: view.together(view.mesh(CUBE), view.points(CUBE[0]), view.curves(CUBE[0])),
        lambda: view.side_by_side(*[view.mesh(CUBE, title=str(i)) for i in range(6)]),
    ],
)
def test_pictures_of_all_kinds_are_drawn(make):
    picture = make()
    image = Image.open(BytesIO(picture.png()))
    assert image.format == "PNG"
    assert max(image.size) <= 1600
    assert len(picture.png()) < 200_000
    assert repr(picture)


def test_the_same_scene_gives_the_same_bytes_whatever_the_users_settings():
    import matplotlib as mpl

    before = view.halfedges(halfedge_mesh(*CUBE), [0]).png()
    with mpl.rc_context(
        {"figure.facecolor": "black", "lines.linewidth": 9, "font.size": 30, "patch.linewidth": 5}
    ):
        after = view.halfedges(halfedge_mesh(*CUBE), [0]).png()
    assert before == after


def test_no_figure_is_left_behind():
    from matplotlib import pyplot

    view.mesh(CUBE).png()
    assert pyplot.get_fignums() == []


def test_a_number_that_the_frame_would_cut_is_left_out():
    mesh = scene.Mesh(*CUBE)
    camera = scene.Camera((0, 0, 1), (0, 1, 0), focus=(0, 0, 0), radius=1)
    drawn = []
    for y in (0.5, 1.08, 1.5):
        words = scene.Labels([[0, y, 0]], ("8",), ("#ff00ff",), size=9, hidden="show")
        drawn.append(
            share(view.Picture(scene.Scene((scene.Panel((mesh, words), camera=camera),))), "#ff00ff")
        )
    assert drawn[0] > 5e-5
    assert drawn[1:] == [0, 0]


def test_a_pdf_of_a_scene_is_the_same_bytes_every_time(tmp_path):
    for name in ("a.pdf", "b.pdf"):
        view.mesh(CUBE, range(8), value_name="a long name of values").save(tmp_path / name)
    first, second = (tmp_path / "a.pdf").read_bytes(), (tmp_path / "b.pdf").read_bytes()
    assert first.startswith(b"%PDF")
    assert first == second


def test_the_name_at_a_colour_bar_is_not_cut_off():
    name = "a name that is wider than the bar"
    short, long = (pixels(view.mesh(CUBE, range(8), value_name=text)) for text in ("u", name))
    assert long.shape[1] > short.shape[1]
    assert (long[:, -6:] == 255).all()


def test_titles_in_a_row_stand_on_one_line():
    flat = (CUBE[0] * [1, 1, 0.2], CUBE[1])
    row = pixels(view.side_by_side(*(view.mesh(mesh, title="E") for mesh in (CUBE, flat))))
    tops = [np.flatnonzero((half < 128).any(axis=(1, 2)))[0] for half in np.array_split(row, 2, axis=1)]
    assert tops[0] == tops[1]


def test_save_writes_a_png_and_nothing_else(tmp_path):
    path = tmp_path / "cube.png"
    picture = view.mesh(CUBE)
    picture.save(path)
    assert path.read_bytes() == picture.png()
    with pytest.raises(ValueError, match=r"does not end in \.png"):
        picture.save(tmp_path / "cube.jpg")
    assert [entry.name for entry in tmp_path.iterdir()] == ["cube.png"]
