"""Several scans in one frame, and where two of them overlap."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gpcourse.errors import ArrayError, GeometryError
from gpcourse.geometry.arrays import BoolArray, FloatArray
from gpcourse.reference.registration.icp import icp
from gpcourse.reference.registration.inputs import as_cloud, as_distance, as_normals, as_pose
from gpcourse.reference.registration.nearest import matcher

#: A rotation and a translation: x goes to R x + t.
Pose = tuple[FloatArray, FloatArray]


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

    Align each scan in turn, except the first, with all others where they are by then. Repeat: what one
    pair cannot agree on is spread over all of them, and nothing drifts on the way around the object.

    Parameters
    ----------
    scans : list of (n, 3) float arrays
        At least two, each in its own coordinates.
    poses : list of (R, t)
        Rough poses to start from: ``R @ x + t`` puts a point of the scan into the common frame.
    normals : list of (n, 3) float arrays, optional
        Unit normals of each scan, in its own coordinates. With them the steps are point-to-plane.
    max_distance : float
        Pairs further apart are rejected: scans overlap in part.
    max_iterations : int
        How often to go through all scans.

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
    for _ in range(max_iterations):
        for i in range(1, len(clouds)):
            others = [j for j in range(len(clouds)) if j != i]
            fixed = np.vstack([clouds[j] @ placed[j][0].T + placed[j][1] for j in others])
            facing = (
                None if directions is None else np.vstack([directions[j] @ placed[j][0].T for j in others])
            )
            R, t = placed[i]
            step, shift, _ = icp(
                clouds[i] @ R.T + t, fixed, normals=facing, max_iterations=1, max_distance=max_distance
            )
            placed[i] = (step @ R, step @ t + shift)
    return placed


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
