"""What is packed is what was there, to the digits that are shown, and it is small."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from gpcourse import shapes, view
from gpcourse.errors import ArrayError
from gpcourse.view.interactive import page
from gpcourse.view.packing import pack_array, quantised, shortened, unpack_array

SHAPES = arrays.array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=20)


@given(st.sampled_from([np.uint8, np.uint16, np.uint32]).flatmap(lambda kind: arrays.arrays(kind, SHAPES)))
def test_arrays_come_back_exactly(array):
    back = unpack_array(pack_array(array), *array.shape, array.itemsize)
    assert back.dtype == array.dtype
    assert (back == array).all()


@given(arrays.arrays(float, st.tuples(st.integers(1, 20), st.just(3)), elements=st.floats(-1e6, 1e6)))
def test_positions_are_within_half_a_step(points):
    counts, low, step = quantised(points)
    rounding = 1e-9 * np.abs(points).max(axis=0)
    # A box flatter than the smallest normal number has no step.
    assert (
        np.abs(counts * np.array(step) + low - points) <= 0.501 * np.array(step) + rounding + 1e-300
    ).all()


@given(arrays.arrays(float, 10, elements=st.floats(1e-30, 1e30) | st.floats(-1e30, -1e-30)))
def test_values_are_good_to_five_digits(values):
    assert np.abs(shortened(values).view(np.float32) / values - 1).max() < 5e-6


def test_what_is_not_finite_stays_so():
    assert np.isnan(shortened(np.array([np.nan, np.inf, -np.inf, 1e300])).view(np.float32)).all()


@pytest.mark.parametrize(("vertices", "faces", "limit"), [(2600, 5000, 60e3), (50500, 100_000, 1.2e6)])
def test_a_page_is_small(vertices, faces, limit):
    rng = np.random.default_rng(0)
    n = round((faces / 2) ** 0.5)
    i, j = np.divmod(np.arange(n * n), n)
    corner = i * (n + 1) + j
    below = np.column_stack([corner, corner + n + 1, corner + n + 2])
    triangles = np.concatenate([below, np.column_stack([corner, corner + n + 2, corner + 1])])
    points = rng.uniform(size=((n + 1) ** 2, 3)) * 0.3 / n
    points += np.column_stack([*np.divmod(np.arange((n + 1) ** 2), n + 1), np.zeros((n + 1) ** 2)]) / n
    picture = view.mesh((points, triangles), points[:, 2])
    assert len(triangles) >= 0.99 * faces
    assert len(page(picture.frames)) < limit


def test_equal_arrays_of_frames_are_kept_once():
    sphere = shapes.icosphere(3)
    one = view.mesh(sphere)
    assert len(page(view.animation([one] * 10, static=True).frames)) < len(page(one.frames)) + 6000


def test_static_pictures_have_no_page(monkeypatch):
    picture = view.mesh(shapes.tetrahedron())
    assert "<iframe" in picture._repr_html_()
    assert "<iframe" not in view.mesh(shapes.tetrahedron(), static=True)._repr_html_()
    monkeypatch.setenv("GPCOURSE_VIEW", "static")
    assert "<iframe" not in picture._repr_html_()
    monkeypatch.setenv("GPCOURSE_VIEW", "moving")
    with pytest.raises(ArrayError, match="GPCOURSE_VIEW is 'moving'"):
        picture._repr_html_()


def test_an_animation_says_what_does_not_match():
    one = view.mesh(shapes.tetrahedron())
    with pytest.raises(ArrayError, match="at least one frame"):
        view.animation([])
    with pytest.raises(ArrayError, match="1 names for 2 frames"):
        view.animation([one, one], names=["start"])
    with pytest.raises(ArrayError, match="frame 1 has 2 panels"):
        view.animation([one, view.side_by_side(one, one)])
