"""Several scans in one frame, and where two of them overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from gpcourse.errors import ArrayError, GeometryError
from gpcourse.geometry.arrays import BoolArray, FloatArray
from gpcourse.reference.registration.icp import icp
from gpcourse.reference.registration.inputs import as_cloud, as_distance, as_normals, as_pose
from gpcourse.reference.registration.nearest import Match, matcher, reject_pairs
from gpcourse.reference.registration.rigid import rotation_of

#: A rotation and a translation: x goes to R x + t.
Pose = tuple[FloatArray, FloatArray]

#: Matched points p and q, and the normals at p.
Pairs = tuple[FloatArray, FloatArray, FloatArray]

_MAX_ANGLE = np.pi / 4


def overlap_mask(
    source: FloatArray, target: FloatArray, R: FloatArray, t: FloatArray, max_distance: float
) -> BoolArray:
    """Mark the points of `source` that have a point of `target` nearby, once they are moved.

    Parameters
    ----------
    source, target : (n, 3) and (m, 3) float arrays
    R, t : (3, 3) and (3,) float arrays
        The pose of the source: ``R @ x + t`` is where its point x goes.
    max_distance : float
        What counts as nearby; this distance is included.

    Returns
    -------
    (n,) bool array
        True in the overlap, False where the target has nothing.

    References
    ----------
    Coursework 1, question 2.
    """
    source, target = as_cloud(source, "source"), as_cloud(target, "target")
    R, t = as_pose(R, t)
    distances, _ = matcher(target)(source @ R.T + t)
    return np.asarray(distances <= as_distance(max_distance))


def align_scans(
    scans: Sequence[FloatArray],
    poses: Sequence[Pose],
    normals: Sequence[FloatArray] | None = None,
    max_distance: float = np.inf,
    max_iterations: int = 20,
) -> list[Pose]:
    """Improve the poses of several scans together, so that no pair is left with all the error.

    Match each scan with all others where they are by now, and move all of them, except the first. Repeat:
    what one pair cannot agree on is spread over all of them, and nothing drifts on the way around the object.
    Moving one scan at a time onto all others is right too; with normals, all motions are found at once.

    Parameters
    ----------
    scans : list of (n, 3) float arrays
        At least two, each in its own coordinates.
    poses : list of (R, t)
        Rough poses to start from: ``R @ x + t`` puts a point of the scan into the common frame.
    normals : list of (n, 3) float arrays, optional
        Unit normals of each scan, in its own coordinates, towards the scanner. With them the steps are
        point-to-plane, and pairs that face in directions more than 45° apart are rejected.
    max_distance : float
        Pairs further apart are rejected: scans overlap in part. Best a little more than the poses are
        wrong by; far above it, scans slide over each other until more of them overlaps than should.
    max_iterations : int
        How often to match and move.

    Returns
    -------
    list of (R, t)
        A pose for each scan; the first is the one that was given.

    Raises
    ------
    ValueError
        If the lists differ in length, a pose is not a rotation, or a scan meets no other.

    References
    ----------
    Coursework 1, question 5.
    """
    clouds = [as_cloud(scan, f"scans[{i}]") for i, scan in enumerate(scans)]
    placed = _as_poses(poses, len(clouds))
    directions = _as_directions(normals, clouds)
    as_distance(max_distance)
    if directions is None:
        for _ in range(max_iterations):
            for i in range(1, len(clouds)):
                placed[i] = _in_turn(clouds, placed, i, max_distance)
        return placed
    scanned = [_Cloud(x, n, matcher(x)) for x, n in zip(clouds, directions, strict=True)]
    for _ in range(max_iterations):
        pairs = {
            (i, j): _pairs(scanned[i], placed[i], scanned[j], placed[j], max_distance)
            for i, j in permutations(range(len(clouds)), 2)
        }
        placed = _together(pairs, placed)
    return placed


def _moved(points: FloatArray, pose: Pose) -> FloatArray:
    return np.asarray(points @ pose[0].T + pose[1])


def _in_turn(clouds: Sequence[FloatArray], placed: Sequence[Pose], i: int, max_distance: float) -> Pose:
    """Move scan i one step towards all others."""
    others = [_moved(clouds[j], placed[j]) for j in range(len(clouds)) if j != i]
    mine = _moved(clouds[i], placed[i])
    step, shift, _ = icp(mine, np.vstack(others), max_iterations=1, max_distance=max_distance)
    R, t = placed[i]
    return step @ R, step @ t + shift


@dataclass(frozen=True)
class _Cloud:
    """A scan in its own coordinates; so is its tree, which serves for every pose."""

    points: FloatArray
    normals: FloatArray
    match: Match


def _pairs(mine: _Cloud, pose: Pose, other: _Cloud, at: Pose, max_distance: float) -> Pairs:
    """Match one scan with another: points of the other, of this one, and the other's normals there."""
    q, (R, t) = _moved(mine.points, pose), at
    _, index = other.match((q - t) @ R)
    p, normals = _moved(other.points[index], at), other.normals[index] @ R.T
    # Without the angle the front of one scan is pulled onto the back of another.
    kept = reject_pairs(p, q, normals, mine.normals @ pose[0].T, max_distance, _MAX_ANGLE)
    return p[kept], q[kept], normals[kept]


def _together(pairs: dict[tuple[int, int], Pairs], placed: Sequence[Pose]) -> list[Pose]:
    """Make one point-to-plane step of all scans at once: six unknowns for each, the first stays."""
    n = len(placed)
    _refuse_lonely(pairs, n)
    centre = np.vstack([q for _, q, _ in pairs.values()]).mean(axis=0)
    H, b = np.zeros((n, 6, n, 6)), np.zeros((n, 6))
    for (i, j), (p, q, normals) in pairs.items():
        # A motion of scan i moves q, one of scan j moves p; both change the distance along the normal.
        of_i = np.column_stack([np.cross(q - centre, normals), normals])
        of_j = np.column_stack([np.cross(p - centre, normals), normals])
        apart = np.einsum("ij,ij->i", p - q, normals)
        H[i, :, i] += of_i.T @ of_i
        H[j, :, j] += of_j.T @ of_j
        H[i, :, j] -= of_i.T @ of_j
        H[j, :, i] -= of_j.T @ of_i
        b[i] += of_i.T @ apart
        b[j] -= of_j.T @ apart
    motions = np.zeros((n, 6))
    motions[1:] = _least_squares(H[1:, :, 1:].reshape(6 * n - 6, -1), b[1:].ravel()).reshape(-1, 6)
    steps = [(rotation_of(motion[:3]), motion[3:]) for motion in motions]
    return [
        (step @ R, step @ (t - centre) + centre + shift)
        for (step, shift), (R, t) in zip(steps, placed, strict=True)
    ]


def _refuse_lonely(pairs: dict[tuple[int, int], Pairs], n: int) -> None:
    for i in range(n):
        if sum(len(p) for between, (p, _, _) in pairs.items() if i in between) < 3:
            raise GeometryError(
                f"scan {i} meets no other; give a larger max_distance, or better poses to start from"
            )


def _least_squares(H: FloatArray, b: FloatArray) -> FloatArray:
    # In units in which every unknown has the same weight; motions that no pair decides are not made.
    scale = 1 / np.sqrt(np.maximum(H.diagonal(), H.diagonal().max() * 1e-30))
    return np.asarray(scale * np.linalg.lstsq(H * np.outer(scale, scale), scale * b, rcond=1e-10)[0])


def _as_poses(poses: Sequence[Pose], count: int) -> list[Pose]:
    if count < 2:
        raise GeometryError(f"there are {count} scans; give at least two")
    if len(poses) != count:
        raise ArrayError(f"there are {len(poses)} poses for {count} scans; give one for each")
    return [as_pose(R, t, f"poses[{i}]") for i, (R, t) in enumerate(poses)]


def _as_directions(
    normals: Sequence[FloatArray] | None, clouds: Sequence[FloatArray]
) -> list[FloatArray] | None:
    if normals is None:
        return None
    if len(normals) != len(clouds):
        raise ArrayError(
            f"there are normals of {len(normals)} scans and {len(clouds)} scans; give normals of each"
        )
    return [
        as_normals(n, f"normals[{i}]", f"scans[{i}]", len(cloud))
        for i, (n, cloud) in enumerate(zip(normals, clouds, strict=True))
    ]
