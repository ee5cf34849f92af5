"""Chapter 2: registration.

The motion between matched points, matching, rejecting, iterating, sampling, and several scans. A motion
(R, t) takes x to ``R @ x + t``; for rows of points that is ``points @ R.T + t``.
"""

from gpcourse.reference.registration.icp import icp, icp_coarse_to_fine
from gpcourse.reference.registration.nearest import (
    Leaf,
    Split,
    build_kdtree,
    nearest,
    nearest_neighbours,
    reject_boundary_pairs,
    reject_pairs,
    trim_pairs,
)
from gpcourse.reference.registration.normals import estimate_normals
from gpcourse.reference.registration.rigid import point_to_plane_step, rigid_transform, rotation_of
from gpcourse.reference.registration.sampling import (
    normal_space_sampling,
    random_sampling,
    slippage_analysis,
    stable_sampling,
    uniform_sampling,
)
from gpcourse.reference.registration.several import Pose, align_scans, overlap_mask

__all__ = [
    "Leaf",
    "Pose",
    "Split",
    "align_scans",
    "build_kdtree",
    "estimate_normals",
    "icp",
    "icp_coarse_to_fine",
    "nearest",
    "nearest_neighbours",
    "normal_space_sampling",
    "overlap_mask",
    "point_to_plane_step",
    "random_sampling",
    "reject_boundary_pairs",
    "reject_pairs",
    "rigid_transform",
    "rotation_of",
    "slippage_analysis",
    "stable_sampling",
    "trim_pairs",
    "uniform_sampling",
]
