"""Functions that cross to a student's process: what they are, and that they say no more than they need to."""

import numpy as np
import pytest

from gpcourse.errors import ArrayError
from gpcourse.geometry import functions
from gpcourse.geometry.functions import FUNCTIONS, Quadric, Sampled, TrigonometricCurve, Waves

RNG = np.random.default_rng(3)
POINTS = RNG.normal(size=(4, 5, 3))


def test_a_plane_is_its_distance_and_a_sphere_vanishes_where_it_is():
    normal = np.array([1.0, 2.0, 2.0]) / 3
    assert functions.plane(normal, 0.5)(POINTS + normal) - functions.plane(normal, 0.5)(
        POINTS
    ) == pytest.approx(1.0)
    centre = np.array([1.0, -2.0, 0.5])
    ball = functions.sphere(centre, 1.5)
    on = centre + 1.5 * POINTS / np.linalg.norm(POINTS, axis=-1, keepdims=True)
    assert ball(on) == pytest.approx(0.0, abs=1e-12)
    assert ball(centre) == pytest.approx(-(1.5**2))


def test_waves_are_harmonic_up_to_their_square():
    """The Laplacian of a wave is -|w|² times it: by differences of second order, error h² |w|⁴ / 12."""
    w, h = np.array([[0.3, -1.0, 0.7]]), 1e-3
    wave = Waves([2.0], w, [0.4])
    steps = h * np.concatenate([np.eye(3), -np.eye(3)])
    laplacian = (wave(POINTS[..., None, :] + steps) - wave(POINTS)[..., None]).sum(axis=-1) / h**2
    assert laplacian == pytest.approx(-(w**2).sum() * wave(POINTS), abs=1e-6)


def test_a_table_converges_at_second_order_and_holds_a_linear_function():
    def distance(x):
        return np.linalg.norm(x - [0.1, 0.2, 5.0], axis=-1)

    points = RNG.uniform(-1, 1, (500, 3))
    errors = [
        abs(functions.sampled(distance, [-1] * 3, [1] * 3, n)(points) - distance(points)).max()
        for n in (8, 16, 32)
    ]
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2.0, abs=0.25)
    flat = functions.sampled(lambda x: x @ [1.0, 2.0, 3.0], [-1, -1, 0], [1, 2, 1], 5)
    inside = RNG.uniform([-1, -1, 0], [1, 2, 1], (50, 3))
    assert flat(inside) == pytest.approx(inside @ [1.0, 2.0, 3.0])
    assert flat([9.0, 9.0, 9.0]) == flat.values[-1, -1, -1]


def test_a_helix_has_its_radius_and_climb_and_a_circle_closes():
    t = np.linspace(0, 7, 20)
    c = functions.helix(2.0, 0.5)(t)
    assert np.hypot(c[:, 0], c[:, 1]) == pytest.approx(2.0)
    assert c[:, 2] == pytest.approx(0.5 * t)
    circle = functions.helix(1.0, 0.0)
    assert circle(2 * np.pi) == pytest.approx(circle(0.0))


@pytest.mark.parametrize(
    "make",
    [
        lambda: Quadric(np.eye(2), np.zeros(3), 0.0), lambda: Quadric(np.eye(3), np.zeros(3), np.nan),
        lambda: Quadric(np.eye(3), "abc", 0.0), lambda: Waves([1.0], np.zeros((2, 3)), [0.0]),
        lambda: Sampled(np.zeros((1, 2, 2)), np.zeros(3), 1.0),
        lambda: Sampled(np.zeros((2, 2, 2)), np.zeros(3), 0.0),
        lambda: TrigonometricCurve(np.zeros((2, 3)), np.zeros((3, 3)), np.zeros(3)),
        lambda: functions.plane([0, 0, 1], 0.0)([1.0, 2.0]),
    ],
)  # fmt: skip
def test_parameters_that_do_not_fit_are_refused(make):
    with pytest.raises(ArrayError):
        make()


def test_they_are_known_by_their_names():
    assert all(kind.__name__ == name for name, kind in FUNCTIONS.items())
