"""The colour maps can be read by the colour-blind, and those for signed values show their zero."""

import numpy as np
import pytest
from matplotlib import colormaps
from skimage.color import rgb2lab

from gpcourse.view.colours import DIVERGING_MAPS, PALETTE, SEQUENTIAL_MAPS
from gpcourse.view.shading import many_rgb

#: Dichromats' linear red, green and blue, after Machado, Oliveira and Fernandes 2009; rows sum to 1.
DICHROMATS = {
    "protanope": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranope": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.01182, 0.04294, 0.968881],
    ],
    "tritanope": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.3039],
    ],
}


def seen_by(matrix, rgb):
    """Return the CIELAB colours that somebody sees in place of sRGB."""
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    seen = np.clip(linear @ np.transpose(matrix), 0, 1)
    return rgb2lab(np.where(seen <= 0.0031308, 12.92 * seen, 1.055 * seen ** (1 / 2.4) - 0.055))


def least_difference(name, matrix, apart):
    """Return the least distance of two colours whose values lie so far apart on the scale."""
    lab = seen_by(matrix, colormaps[name](np.linspace(0, 1, 101))[:, :3])
    return min(np.linalg.norm(lab[k:] - lab[: 101 - k], axis=1).min() for k in range(apart, 101 - apart))


@pytest.mark.parametrize("who", DICHROMATS)
@pytest.mark.parametrize("name", SEQUENTIAL_MAPS + DIVERGING_MAPS)
def test_values_that_differ_by_a_fifth_of_the_scale_differ_in_colour(name, who):
    np.testing.assert_allclose(np.sum(DICHROMATS[who], axis=1), 1, atol=2e-6)
    if name == "twilight":  # runs round: its ends are one colour
        lab = seen_by(DICHROMATS[who], colormaps[name](np.linspace(0, 1, 101))[:, :3])
        assert np.linalg.norm(lab[20:] - lab[:-20], axis=1).min() > 12
    else:
        assert least_difference(name, DICHROMATS[who], 20) > 12


def test_a_map_that_is_not_safe_is_found_out():
    assert (
        least_difference("RdYlGn", DICHROMATS["deuteranope"], 20)
        < 3
        < 20
        < least_difference("RdYlGn", np.eye(3), 20)
    )


@pytest.mark.parametrize("name", DIVERGING_MAPS)
def test_zero_is_the_lightest_of_a_diverging_map(name):
    lightness = rgb2lab(colormaps[name](np.linspace(0, 1, 101))[:, :3])[:, 0]
    assert lightness.argmax() == 50
    assert (np.diff(lightness[:51]) > 0).all()
    assert (np.diff(lightness[50:]) < 0).all()


@pytest.mark.parametrize("who", DICHROMATS)
def test_the_colours_of_the_palette_differ_from_each_other(who):
    lab = seen_by(DICHROMATS[who], many_rgb(tuple(PALETTE.values())))
    distance = np.linalg.norm(lab[:, None] - lab, axis=2)
    assert distance[~np.eye(len(lab), dtype=bool)].min() > 12
