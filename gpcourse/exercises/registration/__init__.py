"""Chapter 2: the exercises, in the order of the notebook."""

from gpcourse.exercises.registration.icp import ICP
from gpcourse.exercises.registration.nearest import (
    NEAREST_NEIGHBOURS,
    REJECT_BOUNDARY_PAIRS,
    REJECT_PAIRS,
    TRIM_PAIRS,
)
from gpcourse.exercises.registration.rigid import POINT_TO_PLANE_STEP, RIGID_TRANSFORM
from gpcourse.exercises.registration.sampling import (
    NORMAL_SPACE_SAMPLING,
    RANDOM_SAMPLING,
    SLIPPAGE_ANALYSIS,
    STABLE_SAMPLING,
    UNIFORM_SAMPLING,
)
from gpcourse.exercises.registration.several import ALIGN_SCANS, OVERLAP_MASK

EXERCISES = (
    RIGID_TRANSFORM,
    NEAREST_NEIGHBOURS,
    REJECT_PAIRS,
    TRIM_PAIRS,
    REJECT_BOUNDARY_PAIRS,
    POINT_TO_PLANE_STEP,
    ICP,
    OVERLAP_MASK,
    RANDOM_SAMPLING,
    UNIFORM_SAMPLING,
    NORMAL_SPACE_SAMPLING,
    SLIPPAGE_ANALYSIS,
    STABLE_SAMPLING,
    ALIGN_SCANS,
)
