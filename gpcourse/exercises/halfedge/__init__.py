"""Chapter 1: the exercises, in the order of the notebook."""

from gpcourse.exercises.halfedge.building import BUILD_HALFEDGES, CUBE
from gpcourse.exercises.halfedge.counting import (
    DUAL_MESH,
    ELEMENT_STATISTICS,
    EULER_CHARACTERISTIC,
    GENUS,
)
from gpcourse.exercises.halfedge.files import READ_OFF, WRITE_OFF
from gpcourse.exercises.halfedge.flipping import FLIP_EDGE, IS_FLIPPABLE
from gpcourse.exercises.halfedge.walking import (
    BOUNDARY_LOOPS,
    FACE_CENTROID,
    FACE_VERTICES,
    VERTEX_NEIGHBOURS_CCW,
    VERTEX_NEIGHBOURS_CW,
)

EXERCISES = (
    READ_OFF,
    WRITE_OFF,
    BUILD_HALFEDGES,
    CUBE,
    FACE_VERTICES,
    VERTEX_NEIGHBOURS_CCW,
    VERTEX_NEIGHBOURS_CW,
    BOUNDARY_LOOPS,
    FACE_CENTROID,
    IS_FLIPPABLE,
    FLIP_EDGE,
    DUAL_MESH,
    EULER_CHARACTERISTIC,
    GENUS,
    ELEMENT_STATISTICS,
)
