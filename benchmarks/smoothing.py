"""Assemble Laplacians, measure curvature, smooth and compute modes, beside other libraries.

Noisy tori of three sizes, `ordered` and `shuffled` (vertices and faces in random order). Before anything is
timed the answers are compared with ours. Only libraries that are installed take part.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cached_property
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from interleaved import (
    Result,
    Task,
    forget_openblas_settings,
    growth,
    interleave,
    peak_memory_in_a_fresh_process,
    peak_memory_of,
    table,
)

forget_openblas_settings()
import numpy as np  # noqa: E402
from scipy import sparse  # noqa: E402

OURS = "gpcourse"
KINDS = ("ordered", "shuffled")

#: The extra ``gpcourse[cholmod]``, hidden but from the contender that is named after it.
CHOLESPY = import_module("cholespy") if find_spec("cholespy") else None
sys.modules["cholespy"] = None  # type: ignore[assignment]


class Mesh:
    """A triangle mesh as every library likes it best, so that no conversion is timed."""

    def __init__(self, kind: str, n_faces: int) -> None:
        from gpcourse.geometry import shapes

        n = round(n_faces**0.5)
        torus, rng = shapes.torus(n), np.random.default_rng(1)
        # So little that the mesh stays Delaunay: one of the libraries makes it so.
        noise = rng.normal(scale=0.02 * 2 * np.pi * 0.4 / n, size=torus.vertices.shape)
        mesh = shapes.Shape("noisy torus", torus.vertices + noise, torus.faces, genus=1)
        if kind == "shuffled":
            mesh = shapes.shuffled(mesh, rng)
        self.vertices = np.ascontiguousarray(mesh.vertices)
        self.faces = np.ascontiguousarray(mesh.faces)

    @cached_property
    def stiffness(self) -> sparse.csr_array:
        from gpcourse.reference.smoothing import cotangent_matrix

        return cotangent_matrix(self.vertices, self.faces)

    @cached_property
    def mass(self) -> sparse.csr_array:
        from gpcourse.reference.smoothing import mass_matrix

        return mass_matrix(self.vertices, self.faces)

    @property
    def step(self) -> float:
        """The area of a cell: the squared length of an edge, about."""
        return float(self.mass.diagonal().mean())


@dataclass(frozen=True)
class Contender:
    """A library: how it does the work, and how to read from its answer what is to be compared with ours."""

    name: str
    prepare: Callable[[Mesh], Task]
    read: Callable[[Any], Any] = lambda answer: answer
    most: int = 10**9  # faces; beyond, it would take minutes


@dataclass(frozen=True)
class Case:
    """Something to compute; ours first. `tolerance` is relative to the largest number of our answer."""

    name: str
    contenders: tuple[Contender, ...]
    tolerance: float = 1e-9
    most: int = 10**9  # faces
    warm_up: int = 2


def negative(answer: Any) -> Any:
    return -answer


def diagonal(answer: Any) -> np.ndarray:
    return np.asarray(answer.diagonal())


# Matrices


def our_cotangents(m: Mesh) -> Task:
    from gpcourse.reference.smoothing import cotangent_matrix

    return lambda: cotangent_matrix(m.vertices, m.faces)


def igl_cotangents(m: Mesh) -> Task:
    import igl

    return lambda: igl.cotmatrix(m.vertices, m.faces)


def gpytoolbox_cotangents(m: Mesh) -> Task:
    import gpytoolbox

    return lambda: gpytoolbox.cotangent_laplacian(m.vertices, m.faces)


def potpourri3d_cotangents(m: Mesh) -> Task:
    import potpourri3d

    return lambda: potpourri3d.cotan_laplacian(m.vertices, m.faces)


def robust_laplacian_both(m: Mesh) -> Task:
    import robust_laplacian

    return lambda: robust_laplacian.mesh_laplacian(m.vertices, m.faces, mollify_factor=0)


def our_mass(cells: Any) -> Callable[[Mesh], Task]:
    def prepare(m: Mesh) -> Task:
        from gpcourse.reference.smoothing import mass_matrix

        return lambda: mass_matrix(m.vertices, m.faces, cells=cells)

    return prepare


def igl_mass(kind: str) -> Callable[[Mesh], Task]:
    def prepare(m: Mesh) -> Task:
        import igl

        chosen = getattr(igl, f"MASSMATRIX_TYPE_{kind.upper()}")
        return lambda: igl.massmatrix(m.vertices, m.faces, chosen)

    return prepare


def gpytoolbox_mass(kind: str) -> Callable[[Mesh], Task]:
    def prepare(m: Mesh) -> Task:
        import gpytoolbox

        return lambda: gpytoolbox.massmatrix(m.vertices, m.faces, kind)

    return prepare


def potpourri3d_mass(m: Mesh) -> Task:
    import potpourri3d

    return lambda: potpourri3d.vertex_areas(m.vertices, m.faces)


# Curvature


def our_defect(m: Mesh) -> Task:
    from gpcourse.reference.smoothing import angle_defect

    return lambda: angle_defect(m.vertices, m.faces)


def igl_defect(m: Mesh) -> Task:
    import igl

    return lambda: igl.gaussian_curvature(m.vertices, m.faces)


def gpytoolbox_defect(m: Mesh) -> Task:
    import gpytoolbox

    return lambda: gpytoolbox.angle_defect(m.vertices, m.faces)


def trimesh_defect(m: Mesh) -> Task:
    import trimesh

    def task() -> object:  # a fresh one: it would remember its angles
        return trimesh.Trimesh(m.vertices, m.faces, process=False, validate=False).vertex_defects

    return task


def our_normal(m: Mesh) -> Task:
    from gpcourse.reference.smoothing import mean_curvature_normal

    return lambda: mean_curvature_normal(m.vertices, m.faces)


def igl_normal(m: Mesh) -> Task:
    import igl

    def task() -> object:
        areas = igl.massmatrix(m.vertices, m.faces, igl.MASSMATRIX_TYPE_VORONOI).diagonal()
        return -0.5 * (igl.cotmatrix(m.vertices, m.faces) @ m.vertices) / areas[:, None]

    return task


def our_mean_curvature(m: Mesh) -> Task:
    from gpcourse.reference.smoothing import discrete_mean_curvature

    return lambda: discrete_mean_curvature(m.vertices, m.faces)


def pymeshlab_mean_curvature(m: Mesh) -> Task:
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(m.vertices, m.faces))

    def task() -> object:
        meshes.compute_scalar_by_discrete_curvature_per_vertex(curvaturetype=0)
        return np.abs(meshes.current_mesh().vertex_scalar_array())

    return task


# Smoothing


def our_step(solver: Any) -> Callable[[Mesh], Task]:
    def prepare(m: Mesh) -> Task:
        from gpcourse.reference.smoothing import implicit_step

        C, M, step = m.stiffness, m.mass, m.step
        return lambda: implicit_step(m.vertices, C, M, step, solver=solver)

    return prepare


def our_ten_steps(m: Mesh) -> Task:
    from gpcourse.reference.smoothing import linear_diffusion

    step = m.step
    return lambda: linear_diffusion(m.vertices, m.faces, step, 10)


def with_cholmod(prepare: Callable[[Mesh], Task]) -> Callable[[Mesh], Task]:
    """Let ours factor by CHOLMOD, the extra; elsewhere it is hidden from ours."""

    def prepared(m: Mesh) -> Task:
        if CHOLESPY is None:
            raise ImportError("No module named 'cholespy'")
        inner = prepare(m)

        def task() -> object:
            sys.modules["cholespy"] = CHOLESPY
            try:
                return inner()
            finally:
                sys.modules["cholespy"] = None  # type: ignore[assignment]

        return task

    return prepared


def scipy_step(m: Mesh) -> Task:
    from scipy.sparse.linalg import spsolve

    C, M, step = m.stiffness, m.mass, m.step
    return lambda: spsolve(sparse.csc_array(M - step * C), M @ m.vertices)


def igl_step(m: Mesh) -> Task:
    import igl

    C, M, step = sparse.csc_matrix(m.stiffness), sparse.csc_matrix(m.mass), m.step
    none, nothing = np.empty(0, dtype=np.int64), np.empty((0, 3))
    no_rows, no_right = sparse.csc_matrix((0, len(m.vertices))), np.empty((0, 3))
    return lambda: igl.min_quad_with_fixed(
        M - step * C, -(M @ m.vertices), none, nothing, no_rows, no_right, True
    )


def gpytoolbox_step(m: Mesh) -> Task:
    import gpytoolbox

    C, M, step = sparse.csc_matrix(m.stiffness), sparse.csc_matrix(m.mass), m.step
    return lambda: gpytoolbox.min_quad_with_fixed(M - step * C, -(M @ m.vertices))


def scipy_ten_steps(m: Mesh) -> Task:
    from scipy.sparse.linalg import splu

    from gpcourse.reference.smoothing import cotangent_matrix, mass_matrix

    step = m.step

    def task() -> object:
        M = mass_matrix(m.vertices, m.faces)
        solve = splu(sparse.csc_array(M - step * cotangent_matrix(m.vertices, m.faces))).solve
        x = m.vertices
        for _ in range(10):
            x = solve(M @ x)
        return x

    return task


def igl_ten_steps(m: Mesh) -> Task:
    import igl

    step = m.step
    none, nothing = np.empty(0, dtype=np.int64), np.empty((0, 3))

    def task() -> object:
        M = igl.massmatrix(m.vertices, m.faces, igl.MASSMATRIX_TYPE_VORONOI)
        system = sparse.csc_matrix(M - step * igl.cotmatrix(m.vertices, m.faces))
        no_rows = sparse.csc_matrix((0, len(m.vertices)))
        data = igl.min_quad_with_fixed_data()
        igl.min_quad_with_fixed_precompute(system, none, no_rows, True, data)
        x = m.vertices
        for _ in range(10):
            x = igl.min_quad_with_fixed_solve(data, -(M @ x), nothing, nothing)
        return x

    return task


def gpytoolbox_ten_steps(m: Mesh) -> Task:
    import gpytoolbox

    step = m.step

    def task() -> object:
        M = gpytoolbox.massmatrix(m.vertices, m.faces, "voronoi")
        L = gpytoolbox.cotangent_laplacian(m.vertices, m.faces)
        precomputed = gpytoolbox.min_quad_with_fixed_precompute(sparse.csc_matrix(M + step * L))
        x = m.vertices
        for _ in range(10):
            x = precomputed.solve(c=-(M @ x))
        return x

    return task


# Modes


def our_modes(m: Mesh) -> Task:
    from gpcourse.reference.smoothing import eigenmodes

    C, M = m.stiffness, m.mass
    return lambda: eigenmodes(C, M, 100)


def robust_laplacian_modes(m: Mesh) -> Task:
    import robust_laplacian
    from scipy.sparse.linalg import eigsh

    robust_laplacian.mesh_laplacian(m.vertices, m.faces, mollify_factor=0)
    L, M = sparse.csc_matrix(-m.stiffness), sparse.csc_matrix(m.mass)
    return lambda: eigsh(L, 100, M, sigma=1e-8)  # as in its README


def frequencies(answer: Any) -> np.ndarray:
    return np.sort(answer[0])[1:]  # the first is rounding


#: The most faces for what takes minutes beyond.
MODERATE = 3 * 10**5

CASES = (
    Case(
        "cotangent matrix",
        (
            Contender(OURS, our_cotangents),
            Contender("libigl", igl_cotangents),
            Contender("gpytoolbox", gpytoolbox_cotangents, negative),
            Contender("potpourri3d", potpourri3d_cotangents, negative),
            Contender("robust_laplacian", robust_laplacian_both, lambda answer: -answer[0]),
        ),
    ),
    Case(
        "mass matrix, mixed",
        (
            Contender(OURS, our_mass("mixed"), diagonal),
            Contender("libigl", igl_mass("voronoi"), diagonal),
            Contender("gpytoolbox", gpytoolbox_mass("voronoi"), diagonal),
        ),
    ),
    Case(
        "mass matrix, barycentric",
        (
            Contender(OURS, our_mass("barycentric"), diagonal),
            Contender("libigl", igl_mass("barycentric"), diagonal),
            Contender("gpytoolbox", gpytoolbox_mass("barycentric"), diagonal),
            Contender("potpourri3d", potpourri3d_mass),
        ),
    ),
    Case(
        "angle defect",
        (
            Contender(OURS, our_defect),
            Contender("libigl", igl_defect),
            Contender("gpytoolbox", gpytoolbox_defect),
            Contender("trimesh", trimesh_defect),
        ),
    ),
    Case(
        "mean curvature normal", (Contender(OURS, our_normal), Contender("libigl, two matrices", igl_normal))
    ),
    Case(
        # It has cells and a formula of its own: only that both measure the same surface is asked.
        "mean curvature",
        (Contender(OURS, our_mean_curvature), Contender("pymeshlab", pymeshlab_mean_curvature)),
        tolerance=0.5,
    ),
    Case(
        "one implicit step",
        (
            Contender(OURS, our_step("cg")),
            Contender("gpcourse, cholesky", our_step("cholesky")),
            Contender("gpcourse[cholmod]", with_cholmod(our_step("cholesky"))),
            Contender("libigl min_quad", igl_step),
            Contender("gpytoolbox min_quad", gpytoolbox_step, most=MODERATE),
            Contender("SciPy spsolve", scipy_step, most=MODERATE),
        ),
        tolerance=1e-8,
    ),
    Case(
        "ten implicit steps",
        (
            Contender(OURS, our_ten_steps),
            Contender("gpcourse[cholmod]", with_cholmod(our_ten_steps)),
            Contender("libigl min_quad", igl_ten_steps),
            Contender("gpytoolbox min_quad", gpytoolbox_ten_steps, most=MODERATE),
            Contender("SciPy splu", scipy_ten_steps, most=MODERATE),
        ),
        tolerance=1e-8,
    ),
    Case(
        "100 eigenmodes",
        (
            Contender(OURS, our_modes, frequencies),
            Contender("gpcourse[cholmod]", with_cholmod(our_modes), frequencies),
            Contender("robust_laplacian's recipe", robust_laplacian_modes, frequencies),
        ),
        tolerance=1e-7,
        warm_up=0,
    ),
)
BY_NAME = {case.name: case for case in CASES}


def distance(ours: Any, theirs: Any) -> float:
    """Return the largest difference of two answers, relative to the largest number of ours."""
    if sparse.issparse(ours):
        return float(abs(sparse.csr_array(ours) - sparse.csr_array(theirs)).max() / abs(ours).max())
    return float(np.abs(np.asarray(ours) - np.asarray(theirs)).max() / np.abs(ours).max())


def available(case: Case) -> list[Contender]:
    """The contenders that are installed; a note about each one that is not."""
    tiny, found = Mesh("ordered", 800), []
    for contender in case.contenders:
        try:
            contender.prepare(tiny)()
        except ImportError as missing:
            print(f"{contender.name} is left out: {missing}")
        else:
            found.append(contender)
    return found


def refuse_disagreement(case: Case, mesh: Mesh, contenders: list[Contender]) -> None:
    """Stop if the answer of a contender is not ours."""
    ours = contenders[0].read(contenders[0].prepare(mesh)())
    for contender in contenders[1:]:
        gap = distance(ours, contender.read(contender.prepare(mesh)()))
        if not gap <= case.tolerance:
            raise SystemExit(
                f"{case.name}: {contender.name} differs from {OURS} by {gap:.1e} of the largest number"
            )


def measure(case: Case, kind: str, size: int, repeat: int) -> list[Result]:
    """Check and time all contenders on one mesh."""
    mesh = Mesh(kind, size)
    contenders = [contender for contender in available(case) if size <= contender.most]
    refuse_disagreement(case, mesh, contenders)
    times = interleave({c.name: c.prepare(mesh) for c in contenders}, repeat, case.warm_up)
    return [
        Result(
            f"{case.name}, {kind}",
            len(mesh.faces),
            c.name,
            *zip(*times[c.name], strict=True),
            peak_memory_in_a_fresh_process(__file__, case.name, c.name, kind, str(size)),
        )
        for c in contenders
    ]


def print_memory_of(case: str, name: str, kind: str, size: str) -> None:
    """Run a task once in this process, and print the rise in memory as JSON."""
    (contender,) = [c for c in BY_NAME[case].contenders if c.name == name]
    contender.prepare(Mesh(kind, 800))()
    print(json.dumps(peak_memory_of(contender.prepare(Mesh(kind, int(size))))))


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__,
        epilog="Times depend on the machine and on who else uses it: quote the ratios, not the times.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--sizes",
        type=int,
        nargs="+",
        default=[10**4, 10**5, 10**6],
        metavar="FACES",
        help="numbers of faces (default: 10000 100000 1000000)",
    )
    parser.add_argument(
        "--repeat", type=int, default=5, metavar="N", help="rounds that are timed (default: 5)"
    )
    parser.add_argument("--cases", nargs="+", choices=list(BY_NAME), default=list(BY_NAME), metavar="CASE")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS), metavar="KIND")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all times to FILE as well")
    parser.add_argument("--memory-of", nargs=4, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if min(chosen.sizes) < 800 or chosen.repeat < 1:
        parser.error("sizes start at 800 faces, and at least one round is needed")
    return chosen


def main() -> None:
    """Run the benchmark as the command line asks."""
    chosen = arguments()
    if chosen.memory_of:
        print_memory_of(*chosen.memory_of)
        return
    results: list[Result] = []
    for name in chosen.cases:
        for kind in chosen.kinds:
            for size in [size for size in chosen.sizes if size <= BY_NAME[name].most]:
                part = measure(BY_NAME[name], kind, size, chosen.repeat)
                results += part
                print(
                    f"\n{name}, {part[0].faces:,} faces, {kind}; answers agree\n{table(part, OURS)}",
                    flush=True,
                )
    print("\nour time grows with faces to the power of")
    for label in dict.fromkeys(result.case for result in results):
        ours = [result for result in results if (result.case, result.contender) == (label, OURS)]
        if len({result.faces for result in ours}) > 1:
            print(f"{growth(ours):>6.2f} {label}")
    if chosen.json:
        chosen.json.write_text(json.dumps([asdict(result) for result in results], indent=1))


if __name__ == "__main__":
    main()
