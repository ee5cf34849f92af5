"""Register point clouds, and see how long other libraries take for the same.

Five tasks on noisy tori: the motion between known pairs, the nearest neighbours of moved points, normals
from 16 neighbours, five iterations of point-to-point ICP, and point-to-plane ICP until it stands still.
Before anything is timed the answers are compared. Trees are part of each task; conversions are not.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from interleaved import Result, Task, forget_openblas_settings, growth, interleave, table

forget_openblas_settings()
import numpy as np  # noqa: E402

OURS = "gpcourse"
ITERATIONS = 5
#: Point-to-plane ends when the root mean square changes by less, in lengths of a torus 2.8 across.
TOLERANCE = 1e-6
MOST = 40
THREADS = 2


@dataclass(frozen=True)
class Clouds:
    """A target with normals, and its points measured again, in random order, and moved by a small motion."""

    target: np.ndarray
    normals: np.ndarray
    source: np.ndarray
    partners: np.ndarray
    R: np.ndarray
    t: np.ndarray
    noise: float

    @classmethod
    def make(cls, n: int, degrees: float) -> Clouds:
        """Make clouds of n points, the source turned; noise is an eighth of the distance between points."""
        from gpcourse.reference.registration import estimate_normals, rotation_of

        rng = np.random.default_rng(1)
        noise = np.sqrt(0.4 * (2 * np.pi) ** 2 / n) / 8  # normals of 16 neighbours still mean something
        u, v = rng.uniform(0, 2 * np.pi, size=(2, n))
        ring = 1 + 0.4 * np.cos(v) + 0.1 * np.cos(3 * u)  # no symmetry that it could slip along
        torus = np.column_stack([ring * np.cos(u), ring * np.sin(u), 0.4 * np.sin(v) + 0.1 * np.cos(2 * u)])
        target = torus + noise * rng.normal(size=torus.shape)
        axis = np.array([0.3, -0.5, 0.4]) / 0.5**0.5
        R, t = rotation_of(np.radians(degrees) * axis), np.array([0.02, 0.03, -0.01])
        partners = rng.permutation(n)
        source = (torus[partners] + noise * rng.normal(size=torus.shape) - t) @ R
        return cls(target, estimate_normals(target), source, partners, R, t, noise)

    def pose_error(self, pose: np.ndarray) -> float:
        """By how much a 4 × 4 motion misses the true one, at the worst point."""
        apart = self.source @ (pose[:3, :3] - self.R).T + pose[:3, 3] - self.t
        return float(np.linalg.norm(apart, axis=1).max())


@dataclass(frozen=True)
class Contender:
    """A library at one task, and how to read its answer as one array."""

    name: str
    prepare: Callable[[Clouds], Task]
    read: Callable[[Any], np.ndarray]


def matrix(R: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Write a motion as a 4 × 4 matrix."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = R, t
    return pose


def open3d_cloud(points: np.ndarray, normals: np.ndarray | None = None) -> Any:
    """Copy points into an Open3D cloud."""
    import open3d as o3d

    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    if normals is not None:
        cloud.normals = o3d.utility.Vector3dVector(normals)
    return cloud


# The motion between known pairs ------------------------------------------------------------------


def rigid_gpcourse(c: Clouds) -> Task:
    from gpcourse.reference.registration import rigid_transform

    p = c.target[c.partners]
    return lambda: rigid_transform(p, c.source)


def rigid_open3d(c: Clouds) -> Task:
    import open3d as o3d

    source, target = open3d_cloud(c.source), open3d_cloud(c.target)
    pairs = o3d.utility.Vector2iVector(
        np.column_stack([np.arange(len(c.source)), c.partners]).astype(np.int32)
    )
    metric = o3d.pipelines.registration.TransformationEstimationPointToPoint()
    return lambda: metric.compute_transformation(source, target, pairs)


def rigid_trimesh(c: Clouds) -> Task:
    from trimesh.registration import procrustes

    p = c.target[c.partners]
    return lambda: procrustes(c.source, p, reflection=False, scale=False, return_cost=False)


# Nearest neighbours -------------------------------------------------------------------------------


def nearest_gpcourse(c: Clouds) -> Task:
    from gpcourse.reference.registration.nearest import matcher, morton_order

    def task() -> np.ndarray:
        order = morton_order(c.source)
        distances = np.empty(len(order))
        distances[order] = matcher(c.target)(c.source[order])[0]
        return distances

    return task


def nearest_open3d(c: Clouds) -> Task:
    import open3d as o3d

    points, queries = o3d.core.Tensor(c.target), o3d.core.Tensor(c.source)

    def task() -> Any:
        search = o3d.core.nns.NearestNeighborSearch(points)
        search.knn_index()
        return search.knn_search(queries, 1)[1]

    return task


def nearest_small_gicp(c: Clouds) -> Task:
    import small_gicp

    return lambda: small_gicp.KdTree(c.target, THREADS).batch_nearest_neighbor_search(c.source, THREADS)[1]


# Normals ------------------------------------------------------------------------------------------


def normals_gpcourse(c: Clouds) -> Task:
    from gpcourse.reference.registration import estimate_normals

    return lambda: estimate_normals(c.target, 16)


def normals_open3d(c: Clouds) -> Task:
    import open3d as o3d

    def task() -> Any:
        cloud = open3d_cloud(c.target)
        cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(16))
        return cloud

    return task


def normals_small_gicp(c: Clouds) -> Task:
    import small_gicp

    def task() -> Any:
        cloud = small_gicp.PointCloud(c.target)
        small_gicp.estimate_normals(cloud, small_gicp.KdTree(cloud, THREADS), 16, THREADS)
        return cloud

    return task


# ICP ----------------------------------------------------------------------------------------------


def point_gpcourse(c: Clouds) -> Task:
    from gpcourse.reference.registration import icp

    return lambda: icp(c.source, c.target, None, ITERATIONS)


def open3d_icp(c: Clouds, metric: str, change: float, most: int) -> Task:
    import open3d as o3d

    registration = o3d.pipelines.registration
    source, target = open3d_cloud(c.source), open3d_cloud(c.target, c.normals)
    estimation = getattr(registration, f"TransformationEstimation{metric}")()
    # Its changes are in fitness (a part of all points) and in the root mean square; both must be small.
    rule = registration.ICPConvergenceCriteria(change, change, most)
    return lambda: registration.registration_icp(source, target, 10.0, np.eye(4), estimation, rule)


def point_open3d(c: Clouds) -> Task:
    return open3d_icp(c, "PointToPoint", 0.0, ITERATIONS)


def small_gicp_icp(c: Clouds, kind: str, epsilon: float, most: int) -> Task:
    import small_gicp

    source, target = small_gicp.PointCloud(c.source), small_gicp.PointCloud(c.target)
    return lambda: small_gicp.align(
        target,
        source,
        small_gicp.KdTree(target, THREADS),
        registration_type=kind,
        max_correspondence_distance=10.0,
        num_threads=THREADS,
        max_iterations=most,
        rotation_epsilon=epsilon,
        translation_epsilon=epsilon,
    )


def point_small_gicp(c: Clouds) -> Task:
    return small_gicp_icp(c, "ICP", 0.0, ITERATIONS)


def point_trimesh(c: Clouds) -> Task:
    from trimesh.registration import icp

    return lambda: icp(
        c.source, c.target, threshold=0.0, max_iterations=ITERATIONS, reflection=False, scale=False
    )


def plane_gpcourse(c: Clouds) -> Task:
    from gpcourse.reference.registration import icp_coarse_to_fine

    return lambda: icp_coarse_to_fine(c.source, c.target, c.normals, (64, 8, 1), MOST, TOLERANCE)


def plane_gpcourse_all(c: Clouds) -> Task:
    from gpcourse.reference.registration import icp

    return lambda: icp(c.source, c.target, c.normals, MOST, TOLERANCE)


def plane_open3d(c: Clouds) -> Task:
    return open3d_icp(c, "PointToPlane", TOLERANCE, MOST)


def of_ours(answer: Any) -> np.ndarray:
    return matrix(answer[0], answer[1])


def of_open3d(answer: Any) -> np.ndarray:
    return np.asarray(answer.transformation)


TASKS: dict[str, tuple[Contender, ...]] = {
    "rigid transform": (
        Contender(OURS, rigid_gpcourse, of_ours),
        Contender("Open3D", rigid_open3d, np.asarray),
        Contender("trimesh", rigid_trimesh, np.asarray),
    ),
    "nearest neighbours": (
        Contender(OURS, nearest_gpcourse, np.asarray),
        Contender("Open3D", nearest_open3d, lambda a: np.sqrt(a.numpy().ravel())),
        Contender("small_gicp", nearest_small_gicp, lambda a: np.sqrt(np.asarray(a))),
    ),
    "normals": (
        Contender(OURS, normals_gpcourse, np.asarray),
        Contender("Open3D", normals_open3d, lambda a: np.asarray(a.normals)),
        Contender("small_gicp", normals_small_gicp, lambda a: np.asarray(a.normals())[:, :3]),
    ),
    "point-to-point, 5 iterations": (
        Contender(OURS, point_gpcourse, of_ours),
        Contender("Open3D", point_open3d, of_open3d),
        Contender("small_gicp", point_small_gicp, lambda a: np.asarray(a.T_target_source)),
        Contender("trimesh", point_trimesh, lambda a: np.asarray(a[0])),
    ),
    "point-to-plane, to a standstill": (
        Contender(OURS, plane_gpcourse, of_ours),
        Contender("gpcourse, all points", plane_gpcourse_all, of_ours),
        Contender("Open3D", plane_open3d, of_open3d),
    ),
}


def disagreement(task: str, clouds: Clouds, ours: np.ndarray, theirs: np.ndarray) -> str:
    """Say in which way an answer is not as good as ours; empty if it is."""
    if task == "normals":
        angles = np.degrees(np.arccos(np.clip(np.abs((ours * theirs).sum(axis=1)), 0, 1)))
        off = float((angles > 0.1).mean())  # where a 16th and a 17th neighbour are equally far, to rounding
        return f"{off:.2%} of the normals differ" if not off < 1e-3 else ""
    if task.startswith("point-to-plane"):
        mine, its = clouds.pose_error(ours), clouds.pose_error(theirs)
        # The rule stops them at different distances from the minimum: a tenth of the noise is near enough.
        return f"it is off by {its:.2g}, ours by {mine:.2g}" if abs(its - mine) > 0.1 * clouds.noise else ""
    # Distances in 64 bits, motions after as many steps from the same start.
    apart = float(np.abs(ours - theirs).max())
    return f"the answers differ by {apart:.2g}" if not apart < 1e-4 else ""


def available() -> dict[str, list[Contender]]:
    """The contenders that are installed, by task; a note about each library that is not."""
    tiny, missing = Clouds.make(200, 4), {}
    chosen: dict[str, list[Contender]] = {task: [] for task in TASKS}
    for task, contenders in TASKS.items():
        for contender in contenders:
            try:
                contender.prepare(tiny)
                chosen[task].append(contender)
            except ImportError as error:
                missing[contender.name] = error
    for name, error in missing.items():
        print(f"{name} is left out: {error}")
    return chosen


def measure(task: str, contenders: list[Contender], clouds: Clouds, repeat: int) -> list[Result]:
    """Check and time all contenders at one task."""
    tasks = {c.name: c.prepare(clouds) for c in contenders}
    ours = contenders[0].read(tasks[OURS]())
    for contender in contenders[1:]:
        why = disagreement(task, clouds, ours, contender.read(tasks[contender.name]()))
        if why:
            print(f"{contender.name} at {task} is not timed: {why}")
            del tasks[contender.name]
    # Each has run once already. What takes seconds needs no more warming up.
    times = interleave(tasks, repeat, warm_up=0 if len(clouds.source) > 500_000 else 2)
    n = len(clouds.source)
    return [Result(task, n, name, *zip(*times[name], strict=True), peak_memory=None) for name in tasks]


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__,
        epilog="Times depend on the machine and on who else uses it: quote the ratios, not the times.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    sizes = [10**4, 10**5, 10**6]
    parser.add_argument(
        "--sizes", type=int, nargs="+", default=sizes, metavar="POINTS", help="numbers of points"
    )
    parser.add_argument(
        "--repeat", type=int, default=5, metavar="N", help="rounds that are timed (default: 5)"
    )
    parser.add_argument(
        "--turn", type=float, default=4.0, metavar="DEGREES", help="how far the source is turned (default: 4)"
    )
    parser.add_argument("--only", default="", metavar="TEXT", help="only tasks with this text in their names")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all times to FILE as well")
    chosen = parser.parse_args()
    if min(chosen.sizes) < 200 or chosen.repeat < 1:
        parser.error("sizes start at 200 points, and at least one round is needed")
    return chosen


def main() -> None:
    """Run the benchmark as the command line asks."""
    chosen = arguments()
    by_task = {task: libraries for task, libraries in available().items() if chosen.only in task}
    results: list[Result] = []
    for size in chosen.sizes:
        clouds = Clouds.make(size, chosen.turn)
        for task, contenders in by_task.items():
            case = measure(task, contenders, clouds, chosen.repeat)
            results += case
            print(f"\n{size:,} points, {task}; answers agree\n{table(case, OURS)}", flush=True)
            peers = [result for result in case if not result.contender.startswith(OURS)]
            if peers:
                best = min(peers, key=lambda result: result.cpu_least)
                ratio = case[0].cpu_least / best.cpu_least
                print(f"processor time: {ratio:.2f} of that of the best peer, {best.contender}")
    if len(set(chosen.sizes)) > 1:
        print("\nour time grows with points to the power of")
        for task in by_task:
            ours = [r for r in results if (r.case, r.contender) == (task, OURS)]
            print(f"{growth(ours):>8.2f} {task}")
    if chosen.json:
        chosen.json.write_text(json.dumps([asdict(result) for result in results], indent=1))


if __name__ == "__main__":
    main()
