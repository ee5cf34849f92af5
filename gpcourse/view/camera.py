"""From space to the page: the orthographic projection, and the choice of a good direction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.view.scene import Arrows, Camera, Curves, Labels, Layer, Mesh, Points

#: Three quarters from the front and a little from above: a cube shows three unequal faces.
DEFAULT = np.array([0.6, -1.0, 0.65])
#: Up to so many faces a direction is sought that shows most of them.
FEW = 24


@dataclass(frozen=True, eq=False)
class Projection:
    """Maps space to the page.

    Attributes
    ----------
    axes : (3, 3) float array
        Rows: right, up and towards the viewer, orthonormal.
    scale : float
        Points on the page per length unit.
    offset : (2,) float array
        Where the origin of space falls on the page, in points.
    size : float
        The extent of the scene in its own length unit; tolerances are fractions of it.
    """

    axes: FloatArray
    scale: float
    offset: FloatArray
    size: float

    def __call__(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return page coordinates (..., 2) and heights towards the viewer (...), all in points."""
        seen = points @ self.axes.T * self.scale
        return seen[..., :2] + self.offset, seen[..., 2]


def view_axes(camera: Camera) -> FloatArray:
    """Return the rows right, up, towards the viewer; an `up` along the direction is replaced."""
    towards = np.array(camera.direction) / np.linalg.norm(camera.direction)
    up = np.array(camera.up)
    if np.linalg.norm(np.cross(up, towards)) < 1e-6 * np.linalg.norm(up):
        up = np.eye(3)[np.argmin(np.abs(towards))]
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(towards, right), towards])


def extent(layers: Sequence[Layer], camera: Camera) -> tuple[FloatArray, FloatArray]:
    """Return the middle and the half widths of what the camera shows, (2,) arrays in length units."""
    axes = view_axes(camera)
    clouds = [points for points in positions(layers) if len(points)]
    seen = np.concatenate(clouds) @ axes[:2].T if clouds else np.zeros((1, 2))
    low, high = seen.min(axis=0), seen.max(axis=0)
    middle, half = (low + high) / 2, (high - low) / 2
    if camera.focus is not None:
        middle = axes[:2] @ np.array(camera.focus)
        if camera.radius is not None:
            half = np.full(2, camera.radius)
    largest = float(half.max()) or 1.0
    return middle, np.maximum(half, 0.05 * largest)


def positions(layers: Sequence[Layer]) -> Iterator[FloatArray]:
    """Yield the points of every layer that have to be in the frame."""
    for layer in layers:
        if isinstance(layer, Mesh):
            corners, _ = layer.polygons
            yield layer.vertices[np.unique(corners)]
        elif isinstance(layer, Arrows):
            yield layer.tails
            yield layer.heads
        elif isinstance(layer, Curves):
            yield from layer.lines
        elif isinstance(layer, (Points, Labels)):
            yield layer.positions


def area_vectors(vertices: FloatArray, corners: IntArray, sizes: IntArray) -> FloatArray:
    """Return the (m, 3) vector area of each polygon: its normal, as long as its area."""
    face = np.repeat(np.arange(len(sizes)), sizes)
    following = np.arange(1, len(corners) + 1)
    ends = np.cumsum(sizes)
    following[ends - 1] = ends - sizes
    # From the first corner, so that far from the origin nothing is lost to cancellation.
    first = vertices[corners[ends - sizes]][face]
    cross = np.cross(vertices[corners] - first, vertices[corners[following]] - first)
    total = np.zeros((len(sizes), 3))
    np.add.at(total, face, 0.5 * cross)
    return total


def good_camera(points: FloatArray, normals: FloatArray | None = None) -> Camera:
    """Choose a direction: straight down on what is flat, three quarters from above otherwise.

    Parameters
    ----------
    points : (n, 3) float array
    normals : (m, 3) float array or None
        Vector areas of the faces; a flat or shallow surface is shown from its outer side.
    """
    centred = points - points.mean(axis=0) if len(points) else np.zeros((1, 3))
    sample = centred[:: max(1, len(centred) // 2000)]
    _, spread, directions = np.linalg.svd(sample, full_matrices=len(sample) < 3)
    spread = np.append(spread, np.zeros(3))[:3]
    normal = directions[2]
    outwards = np.zeros(3) if normals is None else normals.sum(axis=0)
    if abs(normal @ outwards) < 1e-9 * max(1e-300, float(spread[0])) ** 2:
        outwards = np.array([0.1, -0.2, 1.0])
    normal = normal if normal @ outwards >= 0 else -normal
    up = (0.0, 1.0, 0.0) if abs(normal[2]) > 0.9 else (0.0, 0.0, 1.0)
    if spread[2] <= 1e-6 * spread[0]:
        x, y, z = normal.tolist()
        return Camera((x, y, z), up)
    if (
        spread[2] < 0.15 * spread[0]
        and normals is not None
        and np.linalg.norm(outwards) > 0.3 * _area(normals)
    ):
        x, y, z = (normal + 0.6 * DEFAULT / np.linalg.norm(DEFAULT)).tolist()
        return Camera((x, y, z))
    if normals is not None and 0 < len(normals) <= FEW:
        return telling_camera(points, normals)
    return Camera()


def is_flat(points: FloatArray) -> bool:
    """Tell whether all points lie in one plane."""
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False) if len(points) else np.zeros(3)
    return len(spread) < 3 or bool(spread[2] <= 1e-6 * spread[0])


def telling_camera(points: FloatArray, normals: FloatArray, wanted: FloatArray | None = None) -> Camera:
    """Choose among directions around a solid of few faces one that shows many of them well.

    No face should be seen edge-on and no vertex should cover another. What has the unit normal
    `wanted` is turned to the viewer.
    """
    units = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    size = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    best, found = -np.inf, Camera()
    for camera in _around():
        axes = view_axes(camera)
        tilt = units @ axes[2]
        flat = points @ axes[:2].T
        gaps = np.linalg.norm(flat[:, None] - flat[None], axis=2) + size * np.eye(len(flat))
        # Four faces or more seen well are enough; steep ones disturb.
        score = 0.0 if wanted is None else 2 * min(float(axes[2] @ wanted), 0.5)
        score += np.minimum(np.maximum(tilt, 0), 0.45).sum() / min(len(units), 6)
        score += 1.5 * min(float(gaps.min()) / size, 0.15) - 0.3 * np.mean(np.abs(tilt) < 0.12)
        if score > best + 1e-9:
            best, found = float(score), camera
    return found


def _around() -> Iterator[Camera]:
    yield Camera()
    for height in (0.35, 0.6, 0.9, -0.5, -0.9):
        for angle in np.deg2rad(np.arange(-70, 290, 20)):
            yield Camera((float(np.cos(angle)), float(np.sin(angle)), height))


def facing(direction: FloatArray) -> Camera:
    """Look along `direction` from the front, a little from the side that is usual."""
    length = float(np.linalg.norm(direction))
    if length == 0:
        return Camera()
    towards = direction / length
    usual = DEFAULT / np.linalg.norm(DEFAULT)
    if towards @ usual > 0.75:
        return Camera()
    x, y, z = (towards + 0.45 * usual).tolist()
    return Camera(
        (x, y, z), (0.0, 1.0, 0.0) if abs(z) > 0.95 * np.hypot(x, np.hypot(y, z)) else (0.0, 0.0, 1.0)
    )


def _area(normals: FloatArray) -> float:
    return float(np.linalg.norm(normals, axis=1).sum())
