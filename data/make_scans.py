"""Write the range scans of data/scans: ``python data/make_scans.py``.

A turntable carries a made object, a pebble, past the virtual scanner of `gpcourse.geometry.scans`. The
files are laid out as those of the Stanford bunny are, so that one reader serves both: points and a grid of
pixels as ASCII PLY, and the poses in a list of their own.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from gpcourse.data_sets import PEBBLE
from gpcourse.geometry.scans import Scan, pebble, turntable

SCANS = Path(__file__).resolve().parent / "scans"
ANGLES = (0, 45, 90, 180, 270)
NOISE = 0.0005  # of the diagonal
SEED = 1


def ply_of(scan: Scan, pitch: float) -> str:
    """Lay out a scan as a range grid: the points row by row, and for each pixel its point, if it has one."""
    rows, columns = PEBBLE.grid
    place = np.round(scan.points[:, :2] / pitch + (columns - 1) / 2).astype(int)
    index = np.full((rows, columns), -1)
    index[place[:, 1], place[:, 0]] = np.arange(len(scan.points))
    header = f"""ply
format ascii 1.0
comment made by data/make_scans.py, noise {NOISE} of the diagonal, seed {SEED}
obj_info num_cols {columns}
obj_info num_rows {rows}
element vertex {len(scan.points)}
property float x
property float y
property float z
element range_grid {rows * columns}
property list uchar int vertex_indices
end_header
"""
    points = "".join(f"{x:.4f} {y:.4f} {z:.4f}\n" for x, y, z in scan.points)
    return header + points + "".join("0\n" if i < 0 else f"1 {i}\n" for i in index.ravel())


def pose_of(scan: Scan, name: str) -> str:
    """Write the line of a pose: its translation, and the quaternion of the inverse rotation."""
    numbers = (*scan.t, *Rotation.from_matrix(scan.R.T).as_quat())
    return f"bmesh {name} " + " ".join(f"{number:.9g}" for number in numbers) + "\n"


def main() -> None:
    """Write the five scans and their poses."""
    SCANS.mkdir(exist_ok=True)
    shape, (_, columns) = pebble(6), PEBBLE.grid
    pitch = float(np.linalg.norm(np.ptp(shape.vertices, axis=0))) / (columns - 1)
    made = turntable(shape, ANGLES, pixels=columns, noise=NOISE, rng=SEED)
    for scan, name in zip(made, PEBBLE.scans, strict=True):
        (SCANS / name).write_text(ply_of(scan, pitch), encoding="ascii", newline="\n")
    poses = "".join(pose_of(scan, name) for scan, name in zip(made, PEBBLE.scans, strict=True))
    (SCANS / PEBBLE.poses).write_text(poses, encoding="ascii", newline="\n")


if __name__ == "__main__":
    main()
