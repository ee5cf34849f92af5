"""A scene as a few bytes for the page that draws it: one header of JSON, one block of numbers.

Positions are quantised to 16 bits in the box of their panel, an error of at most 1/131,070 of its longest
side; values to 16 bits between their least and greatest; indices are differences, in 16 bits where they fit.
All is then deflated. The page undoes this with what every browser has.
"""

from __future__ import annotations

import json
import zlib
from base64 import b64encode
from typing import Any

import numpy as np

from gpcourse.geometry.arrays import FloatArray, IntArray
from gpcourse.view.camera import extent, positions, view_axes
from gpcourse.view.scene import Arrows, ColourScale, Curves, Labels, Layer, Mesh, Panel, Points, Scene
from gpcourse.view.shading import many_rgb, value_colours

#: The code of a value that is not finite.
MISSING = 65535
_STEPS = 65535
_LOOKUP = 64


class Block:
    """Numbers one after the other; `add` says where each array lies."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.length = 0
        self.known: dict[tuple[bytes, int], dict[str, Any]] = {}

    def add(self, array: Any, kind: str) -> dict[str, Any]:
        """Append an array as little-endian `kind` (``u1, u2, u4``); bytes of one weight lie together."""
        flat = np.ascontiguousarray(array).ravel().astype(f"<{kind}")
        width = flat.dtype.itemsize
        planes = flat.view(np.uint8).reshape(-1, width).T.tobytes()  # deflates better so
        if (planes, width) in self.known:  # frames of a motion have their faces in common
            return self.known[planes, width]
        entry = self.known[planes, width] = {"at": self.length, "n": len(flat), "w": width}
        self.parts.append(planes)
        self.length += len(planes)
        return entry

    def base64(self) -> str:
        """Return all of it, deflated."""
        return deflated(b"".join(self.parts))


def deflated(data: bytes) -> str:
    """Return `data` deflated, in the letters of base64."""
    return b64encode(zlib.compress(data, 9)).decode("ascii")


def pack(frames: tuple[Scene, ...]) -> tuple[str, str]:
    """Return the header and the block of scenes with equally many panels, which are shown one at a time.

    Panels at the same place have one box and one camera, so that what moves from frame to frame can be seen.
    """
    block = Block()
    columns = [[scene.panels[i] for scene in frames] for i in range(len(frames[0].panels))]
    boxes = [_box(column) for column in columns]
    header = {
        "cameras": [_camera(column, *box) for column, box in zip(columns, boxes, strict=True)],
        "boxes": [{"low": low.tolist(), "size": size} for low, size in boxes],
        "frames": [_frame(scene, boxes, block) for scene in frames],
        "alt": frames[0].alt,
    }
    return json.dumps(header, allow_nan=False, separators=(",", ":")), block.base64()


def quantised(points: FloatArray, low: FloatArray, size: float) -> FloatArray:
    """Return whole numbers 0 … 65,535 for points in the cube of side `size` at `low`."""
    return np.rint(np.clip((points - low) / size, 0, 1) * _STEPS)


def value_codes(values: FloatArray) -> tuple[FloatArray, float, float]:
    """Return codes 0 … 65,534 of values, and what the first and the last of them mean."""
    known = np.isfinite(values)
    low, high = (float(values[known].min()), float(values[known].max())) if known.any() else (0.0, 0.0)
    span = high - low
    share = np.zeros(len(values)) if span == 0 else (np.where(known, values, low) - low) / span
    return np.where(known, np.rint(share * (MISSING - 1)), MISSING), low, high


def _box(panels: list[Panel]) -> tuple[FloatArray, float]:
    clouds = [cloud for panel in panels for cloud in positions(panel.layers) if len(cloud)]
    everything = np.concatenate(clouds) if clouds else np.zeros((1, 3))
    low = everything.min(axis=0)
    return low, float(np.ptp(everything, axis=0).max()) or 1.0


def _camera(panels: list[Panel], low: FloatArray, size: float) -> dict[str, Any]:
    """Return the camera in the coordinates of the page, where the box is the unit cube."""
    camera = panels[0].camera
    axes = view_axes(camera)
    layers = [layer for panel in panels for layer in panel.layers]
    middle, half = extent(layers, camera)
    clouds = [cloud for cloud in positions(layers) if len(cloud)] or [np.zeros((1, 3))]
    depth = np.concatenate(clouds) @ axes[2]
    focus = middle @ axes[:2] + 0.5 * float(depth.min() + depth.max()) * axes[2]
    reach = float(np.hypot(np.ptp(depth), 2 * half.max()))
    return {
        "axes": axes.ravel().tolist(),
        "focus": ((focus - low) / size).tolist(),
        "half": (half / size).tolist(),
        "reach": reach / size,
    }


def _frame(scene: Scene, boxes: list[tuple[FloatArray, float]], block: Block) -> list[dict[str, Any]]:
    scales = scene.scales()
    last = max((i for i, scale in enumerate(scales) if scale is not None), default=-1)
    found = zip(scene.panels, boxes, scales, strict=True)
    return [
        {
            "title": panel.title,
            "scale": None if scale is None else _scale(scale),
            "bar": scale is not None and (not scene.shared_scale or i == last),
            "layers": [_layer(layer, box, block) for layer in panel.layers],
        }
        for i, (panel, box, scale) in enumerate(found)
    ]


def _scale(scale: ColourScale) -> dict[str, Any]:
    steps = np.linspace(scale.low, scale.high, _LOOKUP)
    colours = np.rint(255 * value_colours(steps, scale)).astype(int)
    return {
        "low": scale.low,
        "high": scale.high,
        "name": scale.name,
        "colours": ["#" + "".join(f"{c:02x}" for c in colour) for colour in colours.tolist()],
    }


def _layer(layer: Layer, box: tuple[FloatArray, float], block: Block) -> dict[str, Any]:
    def places(points: FloatArray) -> dict[str, Any]:
        return block.add(quantised(points, *box), "u2")

    match layer:
        case Mesh():
            return _mesh(layer, places(layer.vertices), block)
        case Points():
            valued = {} if layer.values is None else {"values": _values(layer.values, block)}
            return {
                "kind": "points", "at": places(layer.positions), "colours": _few(layer.colours),
                "size": layer.size, "hidden": layer.hidden,
            } | valued  # fmt: skip
        case Arrows():
            sides = layer.label_sides
            return {
                "kind": "arrows", "tails": places(layer.tails), "heads": places(layer.heads),
                "colours": _few(layer.colours), "width": layer.width, "texts": layer.labels,
                "sides": None if sides is None else block.add(_directions(sides), "u1"),
                "hidden": layer.hidden,
            }  # fmt: skip
        case Curves():
            lines = [np.concatenate([x, x[:1]]) if layer.closed and len(x) else x for x in layer.lines]
            points = np.concatenate([np.zeros((0, 3)), *lines])
            return {
                "kind": "curves", "at": places(points), "lengths": [len(line) for line in lines],
                "colours": _few(layer.colours), "width": layer.width, "hidden": layer.hidden,
            }  # fmt: skip
        case Labels():
            return {
                "kind": "labels", "at": places(layer.positions), "texts": layer.texts,
                "colours": _few(layer.colours), "place": layer.place, "hidden": layer.hidden,
            }  # fmt: skip


def _mesh(mesh: Mesh, vertices: dict[str, Any], block: Block) -> dict[str, Any]:
    corners, sizes = mesh.polygons
    found: dict[str, Any] = {
        "kind": "mesh", "at": vertices, "corners": block.add(*_differences(corners, len(mesh.vertices))),
        "smooth": mesh.smooth, "edges": mesh.edges, "behind": mesh.hidden_edges, "colour": mesh.colour,
    }  # fmt: skip
    uniform = len(sizes) > 0 and bool((sizes == sizes[0]).all())
    found["sizes"] = int(sizes[0]) if uniform else block.add(sizes, "u2")
    if mesh.values is not None:
        found |= {"values": _values(mesh.values, block), "on": mesh.values_on, "unit": mesh.value_name}
    elif mesh.face_colours is not None:
        names = sorted(set(mesh.face_colours))
        found |= {"palette": names, "painted": block.add([names.index(c) for c in mesh.face_colours], "u2")}
    elif mesh.vertex_colours is not None:
        found["blended"] = block.add(np.rint(255 * many_rgb(mesh.vertex_colours)), "u1")
    return found


def _differences(corners: IntArray, count: int) -> tuple[IntArray, str]:
    """Return each index less the one three before it, modulo the width."""
    kind, width = ("u2", 2**16) if count < 2**16 else ("u4", 2**32)
    earlier = np.concatenate([np.zeros(3, dtype=np.int64), corners])[: len(corners)]
    return (corners - earlier) % width, kind


def _few(colours: tuple[str, ...]) -> tuple[str, ...]:
    """Return one colour where all are equal; the page repeats it."""
    return colours[:1] if len(set(colours)) == 1 else colours


def _directions(vectors: FloatArray) -> FloatArray:
    """Return directions of space as whole numbers 0 … 254, 127 for nothing."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.rint(127 * (1 + vectors / np.where(length > 0, length, 1.0)))


def _values(values: FloatArray, block: Block) -> dict[str, Any]:
    codes, low, high = value_codes(values)
    return {"codes": block.add(codes, "u2"), "low": low, "high": high}
