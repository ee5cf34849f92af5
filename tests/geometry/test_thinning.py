"""A thinned scan is a part of the scan, evenly spread, and still a surface."""

import numpy as np
import pytest

from gpcourse.errors import GeometryError
from gpcourse.geometry import scans
from gpcourse.geometry.thinning import thinned


@pytest.fixture(scope="module")
def scan():
    return scans.scan(scans.pebble(4), (1, 2, 0.5), pixels=60)


@pytest.mark.parametrize("most", [50, 200, 500])
def test_a_thinned_scan_has_about_as_many_points_as_asked_for(scan, most):
    assert 0.85 * most <= len(thinned(scan, most).points) <= most


def test_its_points_and_normals_are_those_of_the_scan(scan):
    few = thinned(scan, 200)
    [row] = np.nonzero((scan.points == few.points[:, None]).all(axis=2).any(axis=0))
    assert len(row) == len(few.points)
    assert {*map(bytes, few.normals)} == {*map(bytes, scan.normals[row])}
    assert few.pose is not scan.pose
    assert np.array_equal(few.R, scan.R)


def test_its_triangles_look_at_the_scanner_and_cover_what_the_scan_covers(scan):
    def covered(scan):
        a, b, c = scan.points[scan.faces][:, :, :2].transpose(1, 0, 2)
        return ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2

    assert covered(thinned(scan, 500)).min() >= 0
    # What is missing lies along the boundary, a cell wide.
    assert covered(thinned(scan, 500)).sum() > 0.85 * covered(scan).sum()


def test_a_small_scan_comes_back_as_it_is(scan):
    assert thinned(scan, len(scan.points)) is scan


@pytest.mark.parametrize("most", [3, 2.5, True])
def test_what_is_no_number_of_points_is_refused(scan, most):
    with pytest.raises(GeometryError, match="most"):
        thinned(scan, most)
