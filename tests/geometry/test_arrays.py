"""Input becomes typed arrays, or is refused with the offender's name."""

import numpy as np
import pytest

from gpcourse.errors import ArrayError, DegenerateFaceError, MeshError
from gpcourse.geometry.arrays import as_points, as_triangles, flatten_polygons


@pytest.mark.parametrize(
    "value", [[[0, 1, 2]], np.zeros((4, 3), dtype=np.float32), np.empty((0, 3)), ((1, 2, 3),)]
)
def test_points_become_floats(value):
    points = as_points(value)
    assert points.dtype == np.float64
    assert np.array_equal(points, np.asarray(value))


def test_points_of_any_dimension():
    assert as_points(np.ones((2, 5)), dimension=None).shape == (2, 5)
    assert as_points(np.ones((2, 2)), dimension=2).shape == (2, 2)


@pytest.mark.parametrize(
    ("value", "says"),
    [
        ([[0, 1, 2], [0, 1]], "cannot be read as numbers"),
        ([["0", "1", "2"]], "cannot be read as numbers"),
        ([[0, 1, 2j]], "cannot be read as numbers"),
        ([[0, 1, 10**400]], "cannot be read as numbers"),
        ([[0, 1, None]], "finite"),
        ([0, 1, 2], r"shape \(3,\); give an \(n, 3\) array"),
        ([[0, 1]], r"shape \(1, 2\); give an \(n, 3\) array"),
        ([[0, 1, 2], [0, np.nan, 1]], r"corner\[1\] is .*nan.*finite"),
        ([[0, np.inf, 1]], r"corner\[0\] is .*inf.*finite"),
    ],
)
def test_bad_points_are_refused(value, says):
    with pytest.raises(ArrayError, match=says):
        as_points(value, "corner")


@pytest.mark.parametrize(
    "faces",
    [[[0, 1, 2], [2, 1, 3, 0]], ((0, 1, 2), (2, 1, 3, 0)), [np.array([0, 1, 2]), np.array([2, 1, 3, 0])]],
)
def test_polygons_are_laid_end_to_end(faces):
    corners, sizes = flatten_polygons(faces, 4)
    assert corners.tolist() == [0, 1, 2, 2, 1, 3, 0]
    assert sizes.tolist() == [3, 4]
    assert corners.dtype == sizes.dtype == np.int64


def test_no_faces_are_no_corners():
    for none in ([], np.empty((0, 3), dtype=int), np.empty((0, 3))):
        corners, sizes = flatten_polygons(none, 0)
        assert len(corners) == len(sizes) == 0


@pytest.mark.parametrize(
    ("faces", "error", "says"),
    [
        ([[0, 1, 2], [0, 1]], MeshError, "face 1 has 2 corners"),
        (np.array([[0, 1]]), MeshError, "face 0 has 2 corners"),
        ([[0, 1, 2], [1, 2, 3, 4]], MeshError, "face 1 names vertex 4; with 4 vertices .* from 0 to 3"),
        ([[0, 1, -1]], MeshError, "face 0 names vertex -1"),
        ([[0, 1, 2], [1, 2, 1]], DegenerateFaceError, r"face 1 is \[1, 2, 1\]"),
        ([[0, 1, 2], [0, 1, 2, 0]], DegenerateFaceError, r"face 1 is \[0, 1, 2, 0\]"),
        ([[0, 1, 2.5]], ArrayError, "float64 values"),
        ([["a", "b", "c"]], ArrayError, "vertex indices are integers"),
        ([[True, False, True]], ArrayError, "bool values"),
        ([[0, 1, 10**30]], ArrayError, "vertex indices are integers"),
        ([0, 1, 2], ArrayError, "list of index lists"),
        (None, ArrayError, "faces is a NoneType"),
        ("abc", ArrayError, "faces is a str"),
    ],
)
def test_bad_polygons_are_refused(faces, error, says):
    with pytest.raises(error, match=says):
        flatten_polygons(faces, 4)


@pytest.mark.parametrize(
    "faces", [[[0, 1, 2, 3]], [0, 1, 2], [[0, 1, 2], [0, 1, 2, 3]], np.zeros((2, 3, 3), int)]
)
def test_what_is_no_list_of_triangles_is_refused(faces):
    with pytest.raises(ArrayError, match="triangles"):
        as_triangles(faces, 4)


def test_triangles_are_checked_like_polygons():
    assert as_triangles([[0, 1, 2], [2, 1, 3]], 4).tolist() == [[0, 1, 2], [2, 1, 3]]
    with pytest.raises(MeshError, match="face 1 names vertex 4"):
        as_triangles([[0, 1, 2], [2, 1, 4]], 4)
