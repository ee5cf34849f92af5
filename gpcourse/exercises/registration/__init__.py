"""Chapter 2: the exercises, in the order of the notebook."""

from gpcourse.exercises.registration.icp import ICP
from gpcourse.exercises.registration.nearest import (
    NEAREST_NEIGHBOURS,
    REJECT_BOUNDARY_PAIRS,
    REJECT_PAIRS,
    TRIM_PAIRS,
)
from gpcourse.exercises.registration.rigid import POINT_TO_PLANE_STEP, RIGID_TRANSFORM

EXERCISES = (
    RIGID_TRANSFORM,
    NEAREST_NEIGHBOURS,
    REJECT_PAIRS,
    TRIM_PAIRS,
    REJECT_BOUNDARY_PAIRS,
    POINT_TO_PLANE_STEP,
    ICP,
)
