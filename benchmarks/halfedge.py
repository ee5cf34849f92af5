"""Build half-edges, and see how long other libraries take for the same.

Tori and tubes of three sizes: `ordered`, `shuffled` (vertices and faces in random order) and `open`
(with a boundary). Before anything is timed the answers are compared: which faces lie on the two
sides of every edge, and how many boundary loops there are.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
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

OURS = "gpcourse"
KINDS = ("ordered", "shuffled", "open")


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh as every library likes it best, so that no conversion is timed."""

    vertices: np.ndarray
    faces: np.ndarray

    @classmethod
    def make(cls, kind: str, n_faces: int) -> Mesh:
        """Make a mesh of nearly `n_faces` faces."""
        from gpcourse.geometry import shapes

        n = max(3, round((n_faces / 2) ** 0.5))
        shape = shapes.cylinder(n, n) if kind == "open" else shapes.torus(n, n)
        if kind == "shuffled":
            shape = shapes.shuffled(shape, np.random.default_rng(1))
        return cls(np.ascontiguousarray(shape.vertices), np.ascontiguousarray(shape.faces))


@dataclass(frozen=True)
class Contender:
    """A library: how it builds, and how to read the faces beside each edge from what it built.

    `edges` returns rows (smaller vertex, larger vertex, face, other face or -1); a contender whose
    answer leaves the boundary out sets `boundary` to False.
    """

    name: str
    prepare: Callable[[Mesh], Task]
    edges: Callable[[Mesh, Any], np.ndarray]
    boundary: bool = True
    note: str = ""


def edge_rows(tail: np.ndarray, head: np.ndarray, face: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Sort rows (smaller vertex, larger vertex, face, other face); each edge once, -1 goes last."""
    first = np.where((other >= 0) & (other < face), other, face)
    second = np.where(first == face, other, face)
    return np.unique(
        np.stack([np.minimum(tail, head), np.maximum(tail, head), first, second], axis=1), axis=0
    )


def prepare_gpcourse(mesh: Mesh) -> Task:
    from gpcourse.reference.halfedge import build_halfedges

    return lambda: build_halfedges(mesh.faces, len(mesh.vertices))


def gpcourse_edges(mesh: Mesh, built: Any) -> np.ndarray:
    inside = np.flatnonzero(built.face >= 0)
    head = built.origin[built.twin[inside]]
    return edge_rows(built.origin[inside], head, built.face[inside], built.face[built.twin[inside]])


def prepare_openmesh(mesh: Mesh) -> Task:
    import openmesh

    faces = mesh.faces.astype(np.int32)
    return lambda: openmesh.TriMesh(mesh.vertices, faces)


def openmesh_edges(mesh: Mesh, built: Any) -> np.ndarray:
    # OpenMesh numbers the two half-edges of edge e 2e and 2e + 1.
    face = built.halfedge_face_indices()
    inside = np.flatnonzero(face >= 0)
    tail, head = built.halfedge_from_vertex_indices(), built.halfedge_to_vertex_indices()
    return edge_rows(tail[inside], head[inside], face[inside], face[inside ^ 1])


def prepare_edge_flaps(mesh: Mesh) -> Task:
    import igl

    return lambda: igl.edge_flaps(mesh.faces)


def edge_flaps_edges(mesh: Mesh, built: Any) -> np.ndarray:
    edges, _, beside, _ = built
    return edge_rows(edges[:, 0], edges[:, 1], beside.max(axis=1), beside.min(axis=1))


def prepare_triangle_triangle_adjacency(mesh: Mesh) -> Task:
    import igl

    return lambda: igl.triangle_triangle_adjacency(mesh.faces)


def triangle_triangle_adjacency_edges(mesh: Mesh, built: Any) -> np.ndarray:
    face = np.repeat(np.arange(len(mesh.faces)), 3)
    heads = np.roll(mesh.faces, -1, axis=1)
    return edge_rows(mesh.faces.ravel(), heads.ravel(), face, built[0].ravel())


def prepare_trimesh(mesh: Mesh) -> Task:
    from trimesh.graph import face_adjacency

    return lambda: face_adjacency(mesh.faces, return_edges=True)


def trimesh_edges(mesh: Mesh, built: Any) -> np.ndarray:
    beside, edges = built
    return edge_rows(edges[:, 0], edges[:, 1], beside[:, 0], beside[:, 1])


CONTENDERS = (
    Contender(OURS, prepare_gpcourse, gpcourse_edges),
    Contender("OpenMesh TriMesh", prepare_openmesh, openmesh_edges),
    Contender("libigl edge_flaps", prepare_edge_flaps, edge_flaps_edges),
    Contender("trimesh face_adjacency", prepare_trimesh, trimesh_edges, boundary=False),
    Contender(
        "libigl tri-tri adjacency",
        prepare_triangle_triangle_adjacency,
        triangle_triangle_adjacency_edges,
        note="finds twins only: no vertex, no edge, no boundary records",
    ),
)


def count_loops(edges: np.ndarray) -> int:
    """Count the boundary loops: the connected pieces of the edges with one face."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ends, labels = np.unique(edges[edges[:, 3] < 0, :2], return_inverse=True)
    tail, head = labels.reshape(-1, 2).T
    graph = coo_array((np.ones(len(tail), dtype=np.int8), (tail, head)), shape=(len(ends), len(ends)))
    return int(connected_components(graph, directed=False)[0])


def loops_of_records(built: Any) -> int:
    """Count the boundary loops as our records have them: the cycles of `next` along holes."""
    from gpcourse.geometry.halfedge_mesh import orbit_labels

    return len(np.unique(orbit_labels(built.next)[built.face < 0]))


def refuse_disagreement(kind: str, mesh: Mesh, contenders: list[Contender]) -> None:
    """Stop if a contender finds other faces beside an edge than we do, or other boundary loops."""
    built = contenders[0].prepare(mesh)()
    truth = contenders[0].edges(mesh, built)
    loops = 2 if kind == "open" else 0
    if loops_of_records(built) != loops:
        raise SystemExit(
            f"{OURS} finds {loops_of_records(built)} boundary loops on {kind}; there are {loops}"
        )
    for contender in contenders[1:]:
        edges = contender.edges(mesh, contender.prepare(mesh)())
        expected = truth if contender.boundary else truth[truth[:, 3] >= 0]
        if not np.array_equal(edges, expected):
            raise SystemExit(
                f"{contender.name} and {OURS} do not find the same faces beside the edges of {kind}"
            )
        if contender.boundary and count_loops(edges) != loops:
            raise SystemExit(f"{contender.name} finds {count_loops(edges)} boundary loops; there are {loops}")


def available() -> Iterator[Contender]:
    """The contenders that are installed; a note about each one that is not."""
    tiny = Mesh.make("ordered", 18)
    for contender in CONTENDERS:
        try:
            contender.prepare(tiny)
        except ImportError as missing:
            print(f"{contender.name} is left out: {missing}")
        else:
            yield contender


def measure(contenders: list[Contender], kind: str, size: int, repeat: int) -> list[Result]:
    """Check and time all contenders on one mesh, then ask each one's need of memory in a new process."""
    mesh = Mesh.make(kind, size)
    refuse_disagreement(kind, mesh, contenders)
    times = interleave({c.name: c.prepare(mesh) for c in contenders}, repeat)
    with tempfile.TemporaryDirectory() as folder:
        file = str(Path(folder) / "mesh.npz")
        np.savez(file, vertices=mesh.vertices, faces=mesh.faces)
        memory = {c.name: peak_memory_in_a_fresh_process(__file__, c.name, file) for c in contenders}
    return [
        Result(kind, len(mesh.faces), c.name, *zip(*times[c.name], strict=True), peak_memory=memory[c.name])
        for c in contenders
    ]


def print_memory_of(name: str, file: str) -> None:
    """Build once in this process, and print the rise in memory as JSON."""
    (contender,) = [c for c in CONTENDERS if c.name == name]
    contender.prepare(Mesh(np.eye(3), np.array([[0, 1, 2]])))()  # imports what is imported late
    with np.load(file) as stored:
        mesh = Mesh(stored["vertices"], stored["faces"])
    print(json.dumps(peak_memory_of(contender.prepare(mesh))))


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__,
        epilog="Times depend on the machine and on who else uses it: on a noisy one only the ratios count, "
        "and among them those of processor time most.",
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
        "--repeat", type=int, default=9, metavar="N", help="rounds that are timed (default: 9)"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all times to FILE as well")
    parser.add_argument("--memory-of", nargs=2, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if min(chosen.sizes) < 18 or chosen.repeat < 1:
        parser.error("sizes start at 18 faces, and at least one round is needed")
    return chosen


def main() -> None:
    """Run the benchmark as the command line asks."""
    chosen = arguments()
    if chosen.memory_of:
        print_memory_of(*chosen.memory_of)
        return
    contenders = list(available())
    complete = {c.name for c in contenders if not c.note} - {OURS}
    results: list[Result] = []
    for size in chosen.sizes:
        for kind in KINDS:
            case = measure(contenders, kind, size, chosen.repeat)
            results += case
            print(f"\n{case[0].faces:,} faces, {kind}; answers agree\n{table(case, OURS)}", flush=True)
            peers = [result for result in case if result.contender in complete]
            if peers:
                best = min(peers, key=lambda result: result.median)
                cpu_best = min(peers, key=lambda result: result.cpu_least)
                print(
                    f"ratio to the best peer: {case[0].median / best.median:.2f} ({best.contender}); ",
                    f"of the processor {case[0].cpu_least / cpu_best.cpu_least:.2f} ({cpu_best.contender})",
                    sep="",
                )
    for contender in contenders:
        if contender.note:
            print(f"\n{contender.name} {contender.note}; it is not counted among the peers.")
    if len(set(chosen.sizes)) > 1:
        print("\ntime grows with faces to the power of")
        for c in contenders:
            powers = [
                growth([r for r in results if (r.contender, r.case) == (c.name, kind)]) for kind in KINDS
            ]
            print(
                f"{c.name:<26}" + "".join(f"{p:>8.2f} {kind}" for p, kind in zip(powers, KINDS, strict=True))
            )
    if chosen.json:
        chosen.json.write_text(json.dumps([asdict(result) for result in results], indent=1))


if __name__ == "__main__":
    main()
