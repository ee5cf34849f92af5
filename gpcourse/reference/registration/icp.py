"""Iterative closest points: match, reject, minimise, move, again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gpcourse.errors import GeometryError
from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.reference.registration.inputs import as_cloud, as_count, as_distance, as_fraction, as_normals
from gpcourse.reference.registration.nearest import follower, matcher, morton_order, trim_pairs
from gpcourse.reference.registration.rigid import point_to_plane_step, rigid_transform

#: Below this many points a round costs its fixed part only.
_FEWEST = 1000


def icp(  # noqa: PLR0917
    source: FloatArray,
    target: FloatArray,
    normals: FloatArray | None = None,
    max_iterations: int = 50,
    tolerance: float = 0.0,
    keep: float = 1.0,
    max_distance: float = np.inf,
) -> tuple[FloatArray, FloatArray, list[float]]:
    """Move the points `source` onto the points `target`, whose partners are not known.

    Match each moved source point with the nearest target point, reject bad pairs, find the motion
    that is best for the others, and make it. Repeat.

    Parameters
    ----------
    source : (n, 3) float array
        The points to move.
    target : (m, 3) float array
        The points that stay.
    normals : (m, 3) float array, optional
        Unit normals at `target`. With them each step is point-to-plane, without them point-to-point.
    max_iterations : int
        The most iterations.
    tolerance : float
        Stop earlier, after the iteration whose loss is below this, or differs from the loss before
        by less. In the length unit of the points; 0 makes exactly `max_iterations` iterations.
    keep : float
        The part of the pairs that is kept, the closest ones; above 0, at most 1.
    max_distance : float
        Pairs further apart are rejected as well.

    Returns
    -------
    R : (3, 3) float array
        The whole motion, not its last step: ``source @ R.T + t`` lies on `target`.
    t : (3,) float array
    history : list of float
        The loss of each iteration: the root mean square distance of the pairs that were kept, as they
        were matched, before the step.

    Raises
    ------
    ValueError
        If fewer than three pairs are left.

    References
    ----------
    Notes ch. 2, *Iterative Closest Points*.
    """
    source, target, normals = _as_clouds(source, target, normals)
    rules = _Rules(max_iterations, tolerance, keep, max_distance)
    # The sums do not care about the order of the points, the time does.
    return _iterate(source.take(morton_order(source), axis=0), target, normals, rules)


def icp_coarse_to_fine(  # noqa: PLR0917
    source: FloatArray,
    target: FloatArray,
    normals: FloatArray | None = None,
    strides: Sequence[int] = (64, 8, 1),
    max_iterations: int = 50,
    tolerance: float = 0.0,
    keep: float = 1.0,
    max_distance: float = np.inf,
) -> tuple[FloatArray, FloatArray, list[float]]:
    """Move `source` onto `target` with few points first, then with more: most of the way costs little.

    Parameters
    ----------
    strides : sequence of int
        Use every 64th point of both clouds, then every 8th, then all of them; each is an `icp` of its own,
        from where the one before it ended, with the tolerance times the stride. A round
        with fewer than a thousand points would save nothing, and is left out.

    All other parameters, and what is returned, are those of `icp`; the history is that of all rounds.
    """
    source, target, normals = _as_clouds(source, target, normals)
    order = morton_order(target)
    source, target = source.take(morton_order(source), axis=0), target.take(order, axis=0)
    normals = None if normals is None else normals.take(order, axis=0)
    R, t = np.eye(3), np.zeros(3)
    history: list[float] = []
    for stride in strides:
        fewest = min(len(source), len(target)) // as_count(stride, 2**31, "a stride")
        if stride > 1 and fewest < _FEWEST:
            continue
        # A sample moves with the choice of its points; to follow it more exactly than that is of no use.
        rules = _Rules(max_iterations, tolerance * stride, keep, max_distance)
        every = slice(None, None, stride)
        facing = None if normals is None else normals[every]
        step, shift, losses = _iterate(source[every] @ R.T + t, target[every], facing, rules)
        R, t = step @ R, step @ t + shift
        history += losses
    return R, t, history


@dataclass(frozen=True)
class _Rules:
    """When to stop, and which pairs to keep."""

    max_iterations: int
    tolerance: float
    keep: float
    max_distance: float

    def __post_init__(self) -> None:
        as_count(self.max_iterations, 10**9, "max_iterations")
        as_distance(self.tolerance, "tolerance")
        as_fraction(self.keep)
        as_distance(self.max_distance)

    def good_pairs(self, distances: FloatArray) -> IntArray | None:
        """Return the pairs to keep; None stands for all of them."""
        if self.keep == 1 and self.max_distance == np.inf:
            return None
        good = np.flatnonzero(trim_pairs(distances, self.keep) & (distances <= self.max_distance))
        if len(good) < 3:
            raise GeometryError(
                f"{len(good)} of {len(distances)} pairs are kept, and a motion needs 3; "
                f"give a max_distance above {self.max_distance:.4g}, a larger keep, or a better start"
            )
        return good

    def done(self, history: list[float]) -> bool:
        """Tell whether the loss is small, or no longer changes."""
        still = len(history) > 1 and abs(history[-2] - history[-1]) < self.tolerance
        return history[-1] < self.tolerance or still


def _iterate(
    source: FloatArray, target: FloatArray, normals: FloatArray | None, rules: _Rules
) -> tuple[FloatArray, FloatArray, list[float]]:
    # The tree is built once: the target does not move. With normals the source soon hardly does, either.
    match = matcher(target) if normals is None else follower(target, len(source))
    R, t = np.eye(3), np.zeros(3)
    history: list[float] = []
    for _ in range(rules.max_iterations):
        q = source @ R.T
        q += t
        distances, index = match(q)
        good = rules.good_pairs(distances)
        if good is not None:
            distances, index, q = distances[good], index[good], q.take(good, axis=0)
        p = target.take(index, axis=0)
        if normals is None:
            step, shift = rigid_transform(p, q)
        else:
            step, shift = point_to_plane_step(p, q, normals.take(index, axis=0))
        R, t = step @ R, step @ t + shift  # the new step comes after all earlier ones
        history.append(float(np.sqrt((distances**2).mean())))
        if rules.done(history):
            break
    return R, t, history


def _as_clouds(
    source: object, target: object, normals: object
) -> tuple[FloatArray, FloatArray, FloatArray | None]:
    clouds = as_cloud(source, "source"), as_cloud(target, "target")
    facing = None if normals is None else as_normals(normals, "normals", "target", len(clouds[1]))
    return *clouds, facing
