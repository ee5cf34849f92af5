"""Making a range scan coarser: fewer points, and triangles between those that are left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.geometry.scans import Scan, grid_triangles
from gpcourse.geometry.shapes.parameters import whole

#: Points of neighbouring cells further apart than this many cells lie on different sheets, as in a scan.
_JUMP = 4.0


def thinned(scan: Scan, most: int) -> Scan:
    """Keep at most `most` points of a scan, one in each square of a coarser grid of the scanner.

    The points that stay are points of the scan, with their normals. A scan that is small enough comes back as
    it is.

    Parameters
    ----------
    scan : Scan
    most : int
        At least 4.

    Raises
    ------
    GeometryError
        If `most` is not a whole number of at least 4.
    """
    most = whole("most", most, 4)
    if len(scan.points) <= most:
        return scan
    wide, high = np.ptp(scan.points[:, :2], axis=0)
    pitch = max(float(np.sqrt(wide * high / most)) / 2, float(max(wide, high)) / most)
    cells, kept = _nearest_to_centre(scan.points, pitch)
    while len(kept) > most:
        pitch *= max(1.02, 0.95 * float(np.sqrt(len(kept) / most)))
        cells, kept = _nearest_to_centre(scan.points, pitch)
    index = np.full(cells.max(axis=0) + 1, -1)
    index[cells[:, 0], cells[:, 1]] = np.arange(len(kept))
    points = scan.points[kept]
    normals = None if scan.normals is None else scan.normals[kept]
    faces = grid_triangles(index, points, _JUMP * pitch)
    return replace(scan, points=points, faces=faces, normals=normals, outlier=scan.outlier[kept])


def _nearest_to_centre(points: FloatArray, pitch: float) -> tuple[IntArray, IntArray]:
    """Return the row and column of each occupied cell, and the point nearest to its middle."""
    place = (points[:, 1::-1] - points[:, 1::-1].min(axis=0)) / pitch
    cells = np.floor(place).astype(np.int64)
    off = ((place - cells - 0.5) ** 2).sum(axis=1)
    order = np.argsort(off, kind="stable")
    columns = cells[:, 1].max() + 1
    occupied, first = np.unique((cells[:, 0] * columns + cells[:, 1])[order], return_index=True)
    return np.column_stack(np.divmod(occupied, columns)), order[first]
