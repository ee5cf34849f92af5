"""What the page unpacks is the scene: positions, indices and values, to the error that is promised."""

import base64
import json
import os
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from gpcourse import view
from gpcourse.errors import ArrayError, PictureError
from gpcourse.geometry import shapes
from gpcourse.view.packing import MISSING, pack, quantised, value_codes

numbers = st.integers(-(10**6), 10**6).map(lambda k: k / 1000)
clouds = arrays.arrays(np.float64, st.tuples(st.integers(1, 40), st.just(3)), elements=numbers)


def unpacked(entry, block):
    """Undo `Block.add`, as the page does."""
    planes = np.frombuffer(block, np.uint8)[entry["at"] :][: entry["n"] * entry["w"]].reshape(entry["w"], -1)
    return planes.T.copy().view(f"<u{entry['w']}").ravel().astype(np.int64)


def parts(picture):
    header, block = pack(picture.frames)
    return json.loads(header), zlib.decompress(base64.b64decode(block))


@settings(deadline=None, max_examples=40)
@given(clouds)
def test_positions_come_back_to_half_a_step(points):
    header, block = parts(view.points(points))
    box = header["boxes"][0]
    seen = unpacked(header["frames"][0][0]["layers"][0]["at"], block).reshape(-1, 3)
    back = seen * box["size"] / 65535 + box["low"]
    assert np.abs(back - points).max() <= box["size"] / 65535 * 0.5001 + 1e-9


@settings(deadline=None, max_examples=40)
@given(st.integers(3, 200), st.integers(1, 60), st.randoms(use_true_random=False))
def test_polygons_come_back_exactly(n, count, random):
    faces = [random.sample(range(n), min(n, random.choice([3, 3, 3, 4, 5]))) for _ in range(count)]
    vertices = np.random.default_rng(n).normal(size=(n, 3))
    header, block = parts(view.mesh((vertices, faces)))
    layer = header["frames"][0][0]["layers"][0]
    corners = unpacked(layer["corners"], block)
    for i in range(3, len(corners)):
        corners[i] = (corners[i] + corners[i - 3]) % 2**16
    uniform = isinstance(layer["sizes"], int)
    sizes = [layer["sizes"]] * count if uniform else unpacked(layer["sizes"], block).tolist()
    assert [part.tolist() for part in np.split(corners, np.cumsum(sizes)[:-1])] == faces


@settings(deadline=None, max_examples=60)
@given(arrays.arrays(np.float64, st.integers(1, 50)))
def test_values_come_back_and_what_is_not_finite_is_known(values):
    with np.errstate(over="ignore", invalid="ignore"):
        values = np.where(np.abs(values) > 1e300, np.nan, values)
    codes, low, high = value_codes(values)
    known = np.isfinite(values)
    assert ((codes == MISSING) == ~known).all()
    back = low + (high - low) * codes / (MISSING - 1)
    assert np.abs(back - values)[known].max(initial=0) <= (high - low) / MISSING * 0.51


@settings(deadline=None, max_examples=30)
@given(arrays.arrays(np.uint8, st.tuples(st.integers(3, 40), st.just(3))))
def test_colours_of_vertices_come_back_exactly(colours):
    vertices = np.random.default_rng(0).normal(size=(len(colours), 3))
    header, block = parts(view.mesh((vertices, [[0, 1, 2]]), vertex_colours=colours / 255))
    seen = unpacked(header["frames"][0][0]["layers"][0]["blended"], block)
    assert (seen.reshape(-1, 3) == colours).all()


@settings(deadline=None, max_examples=30)
@given(st.lists(clouds, min_size=1, max_size=4), st.booleans())
def test_curves_come_back_to_half_a_step_closed_or_not(lines, closed):
    lines = [np.concatenate([line, line]) for line in lines]  # a curve has two points at least
    header, block = parts(view.curves(lines, closed=closed))
    box, layer = header["boxes"][0], header["frames"][0][0]["layers"][0]
    back = unpacked(layer["at"], block).reshape(-1, 3) * box["size"] / 65535 + box["low"]
    assert layer["lengths"] == [len(line) + closed for line in lines]
    expected = np.concatenate([np.concatenate([line, line[:closed]]) for line in lines])
    assert np.abs(back - expected).max() <= box["size"] / 65535 * 0.5001 + 1e-9


def test_indices_get_32_bits_where_16_are_too_few():
    n = 70_000
    vertices = np.random.default_rng(0).normal(size=(n, 3))
    header, block = parts(view.mesh((vertices, [[0, 1, n - 1], [2, n - 2, 3]])))
    corners = unpacked(header["frames"][0][0]["layers"][0]["corners"], block)
    assert (corners.reshape(-1, 3).cumsum(axis=0) % 2**32).tolist() == [[0, 1, n - 1], [2, n - 2, 3]]


@pytest.mark.parametrize(("rings", "sides", "most"), [(50, 50, 60_000), (250, 200, 1_200_000)])
def test_pages_are_small(rings, sides, most):
    torus = shapes.torus(rings, sides)
    assert len(torus.faces) == 2 * rings * sides
    picture = view.mesh(torus, torus.vertices[:, 2])
    assert len(picture.page()) < most
    assert len(picture.html()) < most  # with the still image beneath


@pytest.mark.parametrize(("rings", "sides", "most"), [(50, 50, 60_000), (250, 200, 1_200_000)])
def test_the_buffers_of_a_mesh_without_any_order_are_small(rings, sides, most):
    """Noise, and vertices and faces in random order: nothing of it can be predicted."""
    torus, rng = shapes.torus(rings, sides), np.random.default_rng(0)
    order = rng.permutation(len(torus.vertices))
    vertices = (torus.vertices + rng.normal(scale=0.01, size=torus.vertices.shape))[order]
    faces = rng.permutation(np.argsort(order)[torus.faces])
    header, block = pack((view.mesh_scene((vertices, faces)),))
    assert len(header) + len(block) < most


def test_quantising_stays_in_its_range():
    assert quantised(np.array([[-1.0, 0, 2]]), np.zeros(3), 1.0).tolist() == [[0, 0, 65535]]


def test_a_title_cannot_leave_its_place():
    words = "</script><script>alert(1)</script>"
    assert "<script>alert" not in view.mesh(shapes.cube(), title=words).page()
    assert "<script>alert" not in view.mesh(shapes.cube(), {words: np.arange(8.0)}).page()
    assert "<script>alert" not in view.mesh(shapes.cube(), alt="<script>alert(1)</script>").html()


def test_static_pictures_hold_no_page(monkeypatch):
    monkeypatch.delenv("GPCOURSE_STATIC", raising=False)
    assert "<iframe" in view.mesh(shapes.cube()).html()
    assert "<iframe" not in view.mesh(shapes.cube(), static=True).html()
    monkeypatch.setenv("GPCOURSE_STATIC", "1")
    assert "<iframe" not in view.mesh(shapes.cube()).html()
    assert "<img" in view.mesh(shapes.cube()).html()
    assert "<iframe" in view.mesh(shapes.cube(), static=False).html()


def test_under_nbval_pictures_are_static(monkeypatch):
    import IPython

    monkeypatch.delenv("GPCOURSE_STATIC", raising=False)
    assert "PYTEST_VERSION" in os.environ
    assert "<iframe" in view.mesh(shapes.cube()).html()  # this is no kernel
    monkeypatch.setattr(IPython, "get_ipython", object)
    assert "<iframe" not in view.mesh(shapes.cube()).html()
    monkeypatch.setenv("GPCOURSE_STATIC", "0")
    assert "<iframe" in view.mesh(shapes.cube()).html()


def test_pages_hold_no_address():
    page = view.mesh(shapes.cube()).page()
    assert "http" not in page.replace("http-equiv", "")
    assert "default-src 'none'" in page


def test_a_picture_is_saved_as_a_page(tmp_path):
    view.mesh(shapes.cube()).save(tmp_path / "cube.html")
    assert (tmp_path / "cube.html").read_text("utf-8").startswith("<!doctype html>")
    with pytest.raises(PictureError, match=r"\.png, \.pdf or \.html"):
        view.mesh(shapes.cube()).save(tmp_path / "cube.jpg")


def test_frames_of_an_animation_share_scale_and_box():
    cube = shapes.cube()
    frames = [view.mesh((k * cube.vertices, cube.faces), k * np.arange(8.0), title="cube") for k in (1, 2, 3)]
    film = view.animation(frames, ["a", "b", "c"])
    header, _ = parts(film)
    assert {(f[0]["scale"]["low"], f[0]["scale"]["high"]) for f in header["frames"]} == {(0.0, 21.0)}
    assert header["boxes"][0]["size"] == pytest.approx(3 * np.ptp(cube.vertices, axis=0).max())
    assert [panel.title for panel in film.scene.panels] == ["cube, a", "cube, b", "cube, c"]
    with pytest.raises(ArrayError, match="no pictures"):
        view.animation([])
    with pytest.raises(ArrayError, match="2 names for 3 frames"):
        view.animation(frames, ["a", "b"])
    with pytest.raises(ArrayError, match="frame 1 has 2 panels"):
        view.animation([frames[0], view.side_by_side(*frames[:2])])


def test_several_fields_keep_their_own_scales():
    cube = shapes.cube()
    picture = view.mesh(cube, {"up": cube.vertices[:, 2], "index": np.arange(8.0)})
    header, _ = parts(picture)
    assert [f[0]["scale"]["name"] for f in header["frames"]] == ["up", "index"] == list(picture.names)
    assert header["frames"][1][0]["scale"]["high"] == 7.0
    with pytest.raises(ArrayError, match="no values"):
        view.mesh(cube, {})
