"""The motion between points whose partners are known."""

from __future__ import annotations

import numpy as np

from gpcourse.errors import ArrayError, GeometryError
from gpcourse.geometry.arrays import FloatArray
from gpcourse.reference.registration.inputs import as_cloud, as_normals, as_rows

#: A motion that was not asked for by any pair is left at zero: below this part of the largest eigenvalue.
_UNDECIDED = 1e-10

#: So many points at a time stay in the processor's cache.
_BLOCK = 2048


def rigid_transform(
    p: FloatArray, q: FloatArray, weights: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    r"""Find the rotation and translation that move the points `q` onto their partners `p`.

    .. math:: \min_{R,\,t} \sum_i w_i \, \lVert p_i - R q_i - t \rVert^2,
              \qquad R^\top R = I,\quad \det R = +1

    Parameters
    ----------
    p, q : (n, 3) float arrays
        Row i of `q` belongs to row i of `p`. Any length unit.
    weights : (n,) float array, optional
        How much each pair counts, not negative, not all zero. All the same if not given.

    Returns
    -------
    R : (3, 3) float array
        A rotation, never a reflection: ``R @ q[i] + t`` is near ``p[i]``.
    t : (3,) float array
        In the length unit of the points.

    Raises
    ------
    ValueError
        If `p` and `q` do not have the same number of rows, or a weight is negative.

    References
    ----------
    Notes ch. 2, step 4, *Point-to-Point*.
    """
    p = as_cloud(p, "p")
    q = as_rows(q, "q", "p", len(p))
    w = _normalised(weights, len(p))
    p_mean, q_mean = w @ p, w @ q
    S = np.zeros((3, 3))
    for start in range(0, len(p), _BLOCK):
        some = slice(start, start + _BLOCK)
        x, y = _by_axis(p[some]), _by_axis(q[some])
        x -= p_mean[:, None]
        y -= q_mean[:, None]
        y *= w[some]
        S += y @ x.T
    U, _, Vt = np.linalg.svd(S)
    # Without this sign the best orthogonal matrix may be a mirror, as for noisy points near a plane.
    sign = np.sign(np.linalg.det(Vt.T @ U.T))
    R = Vt.T @ np.diag([1.0, 1.0, sign]) @ U.T
    return R, p_mean - R @ q_mean


def _by_axis(points: FloatArray) -> FloatArray:
    # A row for each axis: NumPy is slow where rows are as short as those of points.
    return np.array(points.T, order="C")


def _normalised(weights: FloatArray | None, n: int) -> FloatArray:
    if weights is None:
        return np.full(n, 1 / n)
    w = np.asarray(weights, dtype=np.float64)
    if w.shape != (n,):
        raise ArrayError(f"weights has shape {w.shape}; give one number for each of {n} pairs")
    if not ((w >= 0).all() and 0 < w.sum() < np.inf):
        raise GeometryError("weights must be finite and not negative, and one of them positive")
    return np.asarray(w / w.sum())


def rotation_of(vector: FloatArray) -> FloatArray:
    r"""Turn a rotation vector into its matrix, by the exponential map.

    .. math:: \exp([r]_\times) = I + \frac{\sin\theta}{\theta} [r]_\times
              + \frac{1 - \cos\theta}{\theta^2} [r]_\times^2, \qquad \theta = \lVert r \rVert

    Parameters
    ----------
    vector : (3,) float array
        The direction of the axis times the angle in radians, counter-clockwise seen against the axis.

    Returns
    -------
    (3, 3) float array
        A rotation: orthogonal with determinant +1, however large the angle is.
    """
    x, y, z = np.asarray(vector, dtype=np.float64)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.sqrt(x * x + y * y + z * z)
    # numpy's sinc(a) is sin(πa) / (πa) and has its limit 1 at 0; 1 − cos θ = 2 sin²(θ/2).
    first, second = np.sinc(angle / np.pi), np.sinc(angle / (2 * np.pi)) ** 2 / 2
    return np.asarray(np.eye(3) + first * cross + second * cross @ cross)


def point_to_plane_step(p: FloatArray, q: FloatArray, normals: FloatArray) -> tuple[FloatArray, FloatArray]:
    r"""Move the points `q` towards the planes through their partners `p`: one linearised step.

    .. math:: \min_{R,\,t} \sum_i \bigl[(p_i - R q_i - t) \cdot n_i\bigr]^2

    There is no closed form. For a small rotation vector r, :math:`R q \approx q + r \times q`, and the sum
    becomes a linear least-squares problem in six unknowns, r and t. The exponential map turns r into a
    rotation, which :math:`I + [r]_\times` is not. Repeated, the steps converge quickly.

    Parameters
    ----------
    p, q : (n, 3) float arrays
        Row i of `q` belongs to row i of `p`. Any length unit.
    normals : (n, 3) float array
        Unit normals at `p`; their sign does not matter.

    Returns
    -------
    R : (3, 3) float array
        A rotation: ``R @ q[i] + t`` is nearer to the plane of ``p[i]``.
    t : (3,) float array
        In the length unit of the points. Where the planes leave a motion open (all points on one plane,
        say), no such motion is made.

    Raises
    ------
    ValueError
        If the arrays do not have the same number of rows, or a normal is not of unit length.

    References
    ----------
    Notes ch. 2, step 4, *Point-to-Plane*.
    """
    p = as_cloud(p, "p")
    q = as_rows(q, "q", "p", len(p))
    normals = as_normals(normals, "normals", "p", len(p))
    # Turning about the centroid, in its own length unit, keeps the six equations well conditioned.
    centre = np.full(len(q), 1 / len(q)) @ q
    H, g, square = np.zeros((6, 6)), np.zeros(6), 0.0
    for start in range(0, len(q), _BLOCK):
        some = slice(start, start + _BLOCK)
        x, n = _by_axis(q[some] - centre), _by_axis(normals[some])
        # (r × x)·n = r·(x × n): the column of a pair is [x × n, n].
        turning = [x[j] * n[k] - x[k] * n[j] for j, k in ((1, 2), (2, 0), (0, 1))]
        A = np.array([*turning, *n])
        H += A @ A.T
        g += A @ (_by_axis(p[some] - q[some]) * n).sum(axis=0)
        square += (x * x).sum()
    size = float(np.sqrt(square / len(q))) or 1.0
    unit = np.array(3 * [1 / size] + 3 * [1.0])
    motion = np.linalg.lstsq(unit[:, None] * H * unit, unit * g / size, rcond=_UNDECIDED)[0]
    R = rotation_of(motion[:3])
    return R, centre + size * motion[3:] - R @ centre
