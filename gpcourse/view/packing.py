"""A scene in few bytes: positions in 16 bits, values good to five digits, all of it deflated.

`pack` gives a description that JSON can hold and one block of bytes to which it refers. `pack_array` and
`unpack_array` are the code of one array; the page in ``page_files/viewer.js`` decodes what they encode.
"""

from __future__ import annotations

import zlib
from base64 import b64encode
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gpcourse.geometry.arrays import FloatArray
from gpcourse.view.camera import extent, positions, view_axes
from gpcourse.view.scene import Arrows, ColourScale, Curves, Labels, Layer, Mesh, Points, Scene
from gpcourse.view.shading import many_rgb, value_colours

STEPS = 65535
#: Bits of a single-precision number that are dropped: what is left is good to 4e-6 of the value.
DROPPED = 6


def pack_array(array: NDArray[Any]) -> bytes:
    """Return differences down each column of an (n, k) array of unsigned numbers, low bytes first."""
    steps = np.diff(array, axis=0, prepend=np.zeros((1, array.shape[1]), array.dtype))
    little = np.ascontiguousarray(steps.T).astype(array.dtype.newbyteorder("<"))
    return little.view(np.uint8).reshape(-1, array.itemsize).T.tobytes()


def unpack_array(data: bytes, rows: int, columns: int, item: int) -> NDArray[Any]:
    """Return what `pack_array` was given; `item` is the number of bytes of an entry."""
    planes = np.frombuffer(data, np.uint8).reshape(item, -1).T.copy()
    steps = planes.view(f"<u{item}").reshape(columns, rows).T
    return np.asarray(np.cumsum(steps, axis=0, dtype=steps.dtype))


def quantised(points: FloatArray) -> tuple[NDArray[np.uint16], list[float], list[float]]:
    """Return (n, 3) points as multiples of a step from a corner of their box: counts, corner, step."""
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))
    step = high / STEPS - low / STEPS
    with np.errstate(divide="ignore", invalid="ignore"):
        counts = np.where(step > 0, np.rint((points - low) / step), 0).clip(0, STEPS)
    return counts.astype(np.uint16), low.tolist(), step.tolist()


def shortened(values: FloatArray) -> NDArray[np.uint32]:
    """Return the bits of values in single precision, rounded to 17 bits of mantissa."""
    with np.errstate(over="ignore"):
        single = values.astype(np.float32)
    bits = single.view(np.uint32)
    rounded = (bits + (1 << (DROPPED - 1))) >> DROPPED << DROPPED
    return np.where(np.isfinite(single), rounded, np.uint32(0x7FC00000)).astype(np.uint32)


class _Block:
    """Arrays one after the other; equal ones are kept once."""

    def __init__(self) -> None:
        self.data = bytearray()
        self._known: dict[tuple[bytes, str], list[int]] = {}

    def add(self, array: NDArray[Any]) -> list[int]:
        """Return where the array lies: offset, rows, columns, bytes of an entry."""
        rows = array if array.ndim == 2 else array[:, None]
        packed = pack_array(rows)
        key = (packed, f"{rows.shape}{rows.dtype}")
        if key not in self._known:
            self._known[key] = [len(self.data), *rows.shape, rows.itemsize]
            self.data += packed
        return self._known[key]

    def points(self, points: FloatArray) -> dict[str, Any]:
        counts, low, step = quantised(points)
        return {"at": self.add(counts), "low": low, "step": step}

    def colours(self, colours: FloatArray) -> list[int]:
        return self.add(np.rint(255 * colours).astype(np.uint8))


def pack(frames: Sequence[tuple[str, Scene]]) -> dict[str, Any]:
    """Return the frames, each a name and a scene, as what ``page_files/viewer.js`` draws."""
    block = _Block()
    described = [{"name": name, "panels": _panels(scene, block)} for name, scene in frames]
    data = b64encode(zlib.compress(bytes(block.data), 9)).decode("ascii")
    return {"frames": described, "alt": frames[0][1].alt, "data": data}


def _panels(scene: Scene, block: _Block) -> list[dict[str, Any]]:
    return [
        {
            "title": panel.title,
            "axes": view_axes(panel.camera).tolist(),
            **_framing(panel.layers, panel.camera),
            "scale": _scale(scale),
            "layers": [_layer(layer, scale, block) for layer in panel.layers],
        }
        for panel, scale in zip(scene.panels, scene.scales(), strict=True)
    ]


def _framing(layers: Sequence[Layer], camera: Any) -> dict[str, Any]:
    axes = view_axes(camera)
    middle, half = extent(layers, camera)
    clouds = [points for points in positions(layers) if len(points)]
    everything = np.concatenate(clouds) if clouds else np.zeros((1, 3))
    depth = everything @ axes[2]
    centre = np.append(middle, (depth.min() + depth.max()) / 2) @ axes
    reach = float(np.linalg.norm(everything - centre, axis=1).max())
    return {"centre": centre.tolist(), "half": half.tolist(), "reach": reach or 1.0}


def _scale(scale: ColourScale | None) -> dict[str, Any] | None:
    if scale is None:
        return None
    steps = np.linspace(scale.low, scale.high, 64)
    colours = np.rint(255 * value_colours(steps, scale)).astype(int).ravel().tolist()
    return {"low": scale.low, "high": scale.high, "name": scale.name, "colours": colours}


def _layer(layer: Layer, scale: ColourScale | None, block: _Block) -> dict[str, Any]:
    if isinstance(layer, Mesh):
        return _mesh(layer, block)
    if isinstance(layer, Points):
        return {
            "kind": "points",
            **block.points(layer.positions),
            "values": None if layer.values is None else block.add(shortened(layer.values)),
            "colours": block.colours(many_rgb(layer.colours)),
            "size": layer.size,
            "hidden": layer.hidden,
        }
    if isinstance(layer, Labels):
        words = {"texts": layer.texts, "inks": layer.colours, "place": layer.place, "hidden": layer.hidden}
        return {"kind": "labels", **block.points(layer.positions), **words}
    return _lines(layer, block)


def _mesh(mesh: Mesh, block: _Block) -> dict[str, Any]:
    corners, sizes = mesh.polygons
    one_size = len(set(sizes.tolist())) == 1
    index = np.uint16 if len(mesh.vertices) <= STEPS + 1 else np.uint32
    faces = corners.reshape(-1, int(sizes[0])) if one_size else corners[:, None]
    return {
        "kind": "mesh",
        **block.points(mesh.vertices),
        "corners": block.add(faces.astype(index)),
        "sizes": int(sizes[0]) if one_size else block.add(sizes.astype(np.uint16)),
        "values": None if mesh.values is None else block.add(shortened(mesh.values)),
        "on": mesh.values_on,
        "colour": block.colours(many_rgb(mesh.face_colours or (mesh.colour,))),
        "edges": mesh.edges,
        "smooth": mesh.smooth,
    }


def _lines(layer: Arrows | Curves, block: _Block) -> dict[str, Any]:
    if isinstance(layer, Arrows):
        ends = np.stack([layer.tails, layer.heads], axis=1).reshape(-1, 3)
        colours = many_rgb(layer.colours)
    else:
        closed = [np.vstack([line, line[:1]]) if layer.closed else line for line in layer.lines]
        ends = np.concatenate([np.stack([x[:-1], x[1:]], axis=1).reshape(-1, 3) for x in closed])
        colours = np.repeat(many_rgb(layer.colours), [len(x) - 1 for x in closed], axis=0)
    return {
        "kind": "lines",
        **block.points(ends),
        "colours": block.colours(colours),
        "width": layer.width,
        "arrow": isinstance(layer, Arrows),
        "hidden": layer.hidden,
        "texts": list(layer.labels) if isinstance(layer, Arrows) else [],
    }
