"""Chapter 0: a warm-up exercise, to learn how exercises work."""

from __future__ import annotations

import numpy as np

from gpcourse.geometry.arrays import FloatArray, as_points

__all__ = ["triangle_area"]


def triangle_area(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    r"""Return the area of the triangle with corners `a`, `b` and `c`.

    .. math:: A = \tfrac12 \, \lVert (b - a) \times (c - a) \rVert

    Parameters
    ----------
    a, b, c : (3,) float arrays
        The corners, in space, in any order.

    Returns
    -------
    float
        Never negative, in the square of the length unit; 0 if the corners lie on one line.

    References
    ----------
    The cross product of two sides is as long as the parallelogram between them is large.
    """
    a, b, c = as_points((a, b, c), "the corners")
    return 0.5 * float(np.linalg.norm(np.cross(b - a, c - a)))
