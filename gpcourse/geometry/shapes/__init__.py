"""Shapes to learn and to test on, with the facts that are known of them by construction.

Every maker returns a `Shape`, which unpacks as ``vertices, faces = shapes.torus(32)``. Closed shapes
have their faces counter-clockwise seen from outside. Where a maker takes `rng`, it draws everything from
it (a `numpy.random.Generator` or a whole number), and gives the same shape for the same state.
"""

from gpcourse.geometry.shapes.curved import cylinder, icosphere, torus
from gpcourse.geometry.shapes.handles import genus_surface
from gpcourse.geometry.shapes.irregular import (
    irregular_patch,
    random_bounded,
    random_closed,
    random_polygons,
)
from gpcourse.geometry.shapes.shape import Shape, shuffled, union
from gpcourse.geometry.shapes.sheets import annulus, disc, moebius
from gpcourse.geometry.shapes.solids import (
    cube,
    dodecahedron,
    icosahedron,
    octahedron,
    prism,
    pyramid,
    tetrahedron,
)

__all__ = [
    "Shape",
    "annulus",
    "cube",
    "cylinder",
    "disc",
    "dodecahedron",
    "genus_surface",
    "icosahedron",
    "icosphere",
    "irregular_patch",
    "moebius",
    "octahedron",
    "prism",
    "pyramid",
    "random_bounded",
    "random_closed",
    "random_polygons",
    "shuffled",
    "tetrahedron",
    "torus",
    "union",
]
