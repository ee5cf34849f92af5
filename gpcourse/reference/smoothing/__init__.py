"""Chapter 6: smoothing.

From the discrete Laplacian to fair surfaces, in five parts: operators, discrete curvature, equations,
flows and fairing. In all of them ``Δ = M⁻¹C``, where `C` holds the cotangent weights and is negative
semi-definite, and `M` holds the areas of the cells around the vertices. Many libraries return ``-C``.
"""

from gpcourse.reference.smoothing.curvature import (
    angle_defect,
    discrete_gaussian_curvature,
    discrete_mean_curvature,
    discrete_principal_curvatures,
    mean_curvature_normal,
    mesh_quality,
)
from gpcourse.reference.smoothing.equations import (
    eigenmodes,
    heat_step,
    solve_laplace,
    solve_poisson,
    spectral_coefficients,
    spectral_filter,
    spectral_reconstruction,
)
from gpcourse.reference.smoothing.fairing import (
    dirichlet_energy,
    euler_lagrange_1d,
    fair,
    membrane_energy,
    thin_plate_energy,
)
from gpcourse.reference.smoothing.flows import (
    explicit_step,
    implicit_step,
    linear_diffusion,
    mean_curvature_flow,
    stable_step,
)
from gpcourse.reference.smoothing.operators import (
    barycentric_areas,
    boundary_vertices,
    cotangent_matrix,
    laplacian,
    mass_matrix,
    mixed_areas,
    uniform_laplacian,
    voronoi_areas,
)

__all__ = [
    "angle_defect",
    "barycentric_areas",
    "boundary_vertices",
    "cotangent_matrix",
    "dirichlet_energy",
    "discrete_gaussian_curvature",
    "discrete_mean_curvature",
    "discrete_principal_curvatures",
    "eigenmodes",
    "euler_lagrange_1d",
    "explicit_step",
    "fair",
    "heat_step",
    "implicit_step",
    "laplacian",
    "linear_diffusion",
    "mass_matrix",
    "mean_curvature_flow",
    "mean_curvature_normal",
    "membrane_energy",
    "mesh_quality",
    "mixed_areas",
    "solve_laplace",
    "solve_poisson",
    "spectral_coefficients",
    "spectral_filter",
    "spectral_reconstruction",
    "stable_step",
    "thin_plate_energy",
    "uniform_laplacian",
    "voronoi_areas",
]
