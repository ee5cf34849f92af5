"""Facts about the area of a triangle."""

import numpy as np
import pytest

from gpcourse.errors import ArrayError
from gpcourse.reference.welcome import triangle_area


@pytest.fixture
def rng():
    return np.random.default_rng(0)


def test_a_right_triangle_is_half_a_rectangle():
    assert triangle_area((0, 0, 0), (3, 0, 0), (0, 4, 0)) == 6.0


def test_an_equilateral_triangle_in_space_has_the_area_of_the_formula():
    # The three unit points span sides of length √2.
    assert triangle_area(*np.eye(3)) == pytest.approx(np.sqrt(3) / 4 * 2, rel=1e-15)


def test_a_shear_along_one_side_keeps_the_area(rng):
    a, b, c = rng.normal(size=(3, 3))
    assert triangle_area(a, b, c + 5 * (b - a)) == pytest.approx(triangle_area(a, b, c), rel=1e-12)


def test_a_point_cuts_a_triangle_into_three_that_sum_to_it(rng):
    a, b, c = rng.normal(size=(3, 3))
    p = rng.dirichlet((1, 1, 1)) @ (a, b, c)
    parts = triangle_area(a, b, p) + triangle_area(b, c, p) + triangle_area(c, a, p)
    assert parts == pytest.approx(triangle_area(a, b, c), rel=1e-13)


def test_the_squares_of_the_three_shadows_sum_to_the_square_of_the_area(rng):
    """Pythagoras for areas, by de Gua: the shadows on the coordinate planes."""
    corners = rng.normal(size=(3, 3))
    shadows = [triangle_area(*(corners * (np.arange(3) != axis))) for axis in range(3)]
    assert np.linalg.norm(shadows) == pytest.approx(triangle_area(*corners), rel=1e-13)


def test_corners_on_one_line_enclose_nothing():
    assert triangle_area((1, 2, 3), (2, 4, 6), (-1, -2, -3)) == 0.0


@pytest.mark.parametrize(
    "corners",
    [
        ((0, 0), (1, 0), (0, 1)),
        ((0, 0, 0), (1, 0), (0, 1, 0)),
        ((0, 0, 0), (1, 0, np.nan), (0, 1, 0)),
        ("a", "b", "c"),
    ],
)
def test_what_is_not_three_points_in_space_is_refused(corners):
    with pytest.raises(ArrayError, match="corners"):
        triangle_area(*corners)
