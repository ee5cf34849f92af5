"""Pixels belong to the nearest triangle, and to one of two neighbours."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gpcourse.view import raster
from gpcourse.view.raster import shaded

SIZE = 40


def shares(corners, points):
    """Return the barycentric coordinates of points, by a linear system a point."""
    matrix = np.vstack([corners.T, np.ones(3)])
    return np.linalg.solve(matrix, np.column_stack([points, np.ones(len(points))]).T).T


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**32 - 1))
def test_every_pixel_shows_the_triangle_that_is_highest_there(seed):
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-10, SIZE + 10, size=(12, 3, 2))  # they cut each other, and leave the picture
    heights, colours = rng.normal(size=(12, 3)), rng.uniform(size=(12, 3, 3))
    y, x = np.mgrid[:SIZE, :SIZE] + 0.5
    middles = np.column_stack([x.ravel(), y.ravel()])
    within = np.array([shares(corner, middles) for corner in corners])
    level = np.where((within > 0).all(axis=2), np.einsum("tpk,tk->tp", within, heights), -np.inf)
    sure = (np.abs(within).min(axis=2) > 1e-9).all(axis=0)
    seen = shaded(corners, heights, colours, SIZE, SIZE).reshape(-1, 4)
    top = level.argmax(axis=0)
    covered = level.max(axis=0) > -np.inf
    expected = 255 * np.einsum("pk,pkc->pc", within[top, np.arange(SIZE**2)], colours[top])
    assert ((seen[:, 3] == 255) == covered)[sure].all()
    assert np.abs(seen[:, :3] - expected)[sure & covered].max(initial=0) <= 0.5001
    assert not seen[~covered & sure].any()


@pytest.mark.parametrize("whole", [False, True])
def test_neighbours_share_no_pixel_and_leave_none_out(whole):
    rng = np.random.default_rng(5)
    n = 9
    grid = np.stack(np.meshgrid(np.linspace(0, SIZE, n), np.linspace(0, SIZE, n)), axis=-1)
    grid[1:-1, 1:-1] += rng.uniform(-0.8, 0.8, size=(n - 2, n - 2, 2))
    grid = np.round(grid) + 0.5 * (np.round(grid) % SIZE > 0) if whole else grid  # on middles of pixels
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    corners = np.concatenate([np.stack(t, axis=2).reshape(-1, 3, 2) for t in ((a, b, c), (a, c, d))])
    one_each = [
        shaded(corner[None], np.zeros((1, 3)), np.ones((1, 3, 3)), SIZE, SIZE)[..., 3] > 0
        for corner in corners
    ]
    assert (np.sum(one_each, axis=0) == 1).all()


def test_chunks_make_no_difference(monkeypatch):
    rng = np.random.default_rng(1)
    given = (rng.uniform(0, SIZE, size=(50, 3, 2)), rng.normal(size=(50, 3)), rng.uniform(size=(50, 3, 3)))
    whole = shaded(*given, SIZE, SIZE)
    monkeypatch.setattr(raster, "CHUNK", 100)
    assert (shaded(*given, SIZE, SIZE) == whole).all()


def test_triangles_without_area_and_outside_are_not_seen():
    corners = np.array([[[1.0, 1], [5, 5], [9, 9]], [[100, 100], [120, 100], [100, 120]], [[3, 3]] * 3])
    assert not shaded(corners, np.zeros((3, 3)), np.ones((3, 3, 3)), SIZE, SIZE).any()
