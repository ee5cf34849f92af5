"""A picture as plain data: what is to be seen, and from where, but not how it is drawn.

A `Scene` is a row of panels. A `Panel` has layers (meshes, arrows, curves, points, labels), a title
and a camera. All of it is arrays, numbers and strings, so that a scene can be stored, sent to
another process as JSON, and drawn by any renderer. Nothing here imports a drawing library.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar

import numpy as np

from gpcourse.errors import ArrayError
from gpcourse.view.checks import as_flag, as_positive, as_text, as_vector, set_fields
from gpcourse.view.colours import DIVERGING_MAPS
from gpcourse.view.layers import Arrows, Curves, Labels, Layer, Mesh, Points

__all__ = [
    "Arrows",
    "Camera",
    "ColourScale",
    "Curves",
    "Labels",
    "Layer",
    "Mesh",
    "Panel",
    "Points",
    "Scene",
    "colour_scale",
    "side_by_side",
    "with_camera",
    "with_one_scale",
]


@dataclass(frozen=True)
class Camera:
    """Where the scene is seen from; the projection is orthographic.

    Attributes
    ----------
    direction : 3 floats
        From the scene towards the viewer, any length.
    up : 3 floats
        What points upwards in the picture.
    focus : 3 floats or None
        The middle of the picture; None frames all that there is.
    radius : float or None
        With a focus: how far the picture reaches from its middle, in length units.
    """

    kind: ClassVar[str] = "camera"
    direction: tuple[float, float, float] = (0.6, -1.0, 0.65)
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)
    focus: tuple[float, float, float] | None = None
    radius: float | None = None

    def __post_init__(self) -> None:
        for name in ("direction", "up", "focus"):
            value = getattr(self, name)
            if value is not None:
                set_fields(self, **{name: as_vector(value, name, allow_zero=name == "focus")})
        if self.radius is not None:
            set_fields(self, radius=as_positive(self.radius, "radius"))


@dataclass(frozen=True, eq=False)
class Panel:
    """Layers seen by one camera, under one title."""

    kind: ClassVar[str] = "panel"
    layers: tuple[Layer, ...]
    title: str = ""
    camera: Camera = Camera()

    def __post_init__(self) -> None:
        set_fields(self, layers=tuple(self.layers), title=as_text(self.title))
        if not isinstance(self.camera, Camera):
            raise ArrayError(f"camera is a {type(self.camera).__name__}; give a Camera")
        for i, layer in enumerate(self.layers):
            if not isinstance(layer, (Mesh, Arrows, Curves, Points, Labels)):
                raise ArrayError(
                    f"layers[{i}] is a {type(layer).__name__}; give a layer of gpcourse.view.scene"
                )


@dataclass(frozen=True, eq=False)
class Scene:
    """Panels side by side; `alt` says in words what is to be seen.

    With `shared_scale`, all panels colour their values by one scale, and one colour bar serves all.
    """

    kind: ClassVar[str] = "scene"
    panels: tuple[Panel, ...]
    alt: str = ""
    shared_scale: bool = False

    def __post_init__(self) -> None:
        set_fields(self, panels=tuple(self.panels), alt=str(self.alt))
        set_fields(self, shared_scale=as_flag(self.shared_scale, "shared_scale"))
        if not self.panels:
            raise ArrayError("a scene needs at least one panel")
        for i, panel in enumerate(self.panels):
            if not isinstance(panel, Panel):
                raise ArrayError(f"panels[{i}] is a {type(panel).__name__}; give a Panel")

    def scales(self) -> list[ColourScale | None]:
        """Return the colour scale of each panel; None where nothing has values."""
        if self.shared_scale:
            shared = colour_scale([layer for panel in self.panels for layer in panel.layers])
            return [shared if colour_scale(panel.layers) else None for panel in self.panels]
        return [colour_scale(panel.layers) for panel in self.panels]

    def to_json(self) -> dict[str, Any]:
        """Return nested dicts, lists, numbers and strings that ``json.dumps`` takes as they are."""
        data: dict[str, Any] = _plain(self)
        return data

    @staticmethod
    def from_json(data: object) -> Scene:
        """Rebuild the scene that `to_json` described.

        Raises
        ------
        ArrayError
            If the data does not describe a scene.
        """
        scene = _rebuilt(data)
        if not isinstance(scene, Scene):
            raise ArrayError(f"the data describes a {type(scene).__name__}, not a scene")
        return scene


@dataclass(frozen=True)
class ColourScale:
    """Values from `low` to `high` run through `colour_map`."""

    colour_map: str
    low: float
    high: float
    name: str = ""


def colour_scale(layers: Iterable[Layer]) -> ColourScale | None:
    """Choose one colour scale for all values of these layers, or None if there are none.

    Values of both signs get a diverging map centred on zero, others a sequential one. A map or
    limits named by a layer win. Values that differ by rounding only are shown as equal.
    """
    valued = [layer for layer in layers if isinstance(layer, (Mesh, Points)) and layer.values is not None]
    if not valued:
        return None
    values = np.concatenate([layer.values for layer in valued if layer.values is not None])
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    named = next((layer.colour_map for layer in valued if layer.colour_map), None)
    colour_map = named or ("RdBu_r" if low < 0 < high else "viridis")
    limits = [layer.limits for layer in valued if layer.limits is not None]
    if limits:
        low, high = min(a for a, _ in limits), max(b for _, b in limits)
    elif colour_map in DIVERGING_MAPS:
        reach = max(abs(low), abs(high)) or 1.0
        low, high = -reach, reach
    elif high - low <= 1e-9 * max(abs(low), abs(high)):
        half = 0.5 * abs(low) or 0.5
        low, high = low - half, high + half
    name = next((layer.value_name for layer in valued if layer.value_name), "")
    return ColourScale(colour_map, low, high, name)


def side_by_side(scenes: Sequence[Scene], *, shared_scale: bool = True, alt: str | None = None) -> Scene:
    """Put the panels of several scenes in one row, by default with one colour scale."""
    for i, scene in enumerate(scenes):
        if not isinstance(scene, Scene):
            raise ArrayError(f"picture {i} is a {type(scene).__name__}; give pictures of gpcourse.view")
    panels = tuple(panel for scene in scenes for panel in scene.panels)
    words = " ".join(f"{_ordinal(i)}: {scene.alt}" for i, scene in enumerate(scenes))
    text = words if alt is None else alt
    return Scene(panels, alt=text, shared_scale=shared_scale)


def with_one_scale(scenes: Sequence[Scene]) -> tuple[Scene, ...]:
    """Return the scenes with values in all of them coloured by one scale."""
    shared = colour_scale([layer for scene in scenes for panel in scene.panels for layer in panel.layers])
    if shared is None:
        return tuple(scenes)
    limits = (shared.low, shared.high)

    def scaled(layer: Layer) -> Layer:
        if isinstance(layer, (Mesh, Points)) and layer.values is not None:
            return replace(layer, limits=limits, colour_map=shared.colour_map)
        return layer

    return tuple(
        replace(s, panels=tuple(replace(p, layers=tuple(map(scaled, p.layers))) for p in s.panels))
        for s in scenes
    )


def with_camera(panel: Panel, **changes: Any) -> Panel:
    """Return the panel seen by a camera with some settings changed."""
    return replace(panel, camera=replace(panel.camera, **changes))


_KINDS: dict[str, type] = {
    cls.kind: cls for cls in (Mesh, Arrows, Curves, Points, Labels, Camera, Panel, Scene)
}


def _ordinal(i: int) -> str:
    return ("First", "Second", "Third", "Fourth", "Fifth", "Sixth")[i] if i < 6 else f"Number {i + 1}"


def _plain(value: Any) -> Any:
    if hasattr(value, "kind") and hasattr(value, "__dataclass_fields__"):
        return {"kind": value.kind} | {
            field.name: _plain(getattr(value, field.name)) for field in fields(value)
        }
    if isinstance(value, np.ndarray):
        if value.dtype.kind == "f" and not np.isfinite(value).all():
            return [x if np.isfinite(x) else None for x in value.tolist()]
        return value.tolist()
    if isinstance(value, (tuple, list)):
        return [_plain(item) for item in value]
    return value.item() if isinstance(value, np.generic) else value


def _rebuilt(data: object) -> Any:
    if isinstance(data, Mapping):
        kind = data.get("kind")
        if not isinstance(kind, str) or kind not in _KINDS:
            raise ArrayError(f"kind is {kind!r}; a scene knows {', '.join(_KINDS)}")
        parts = {str(key): _rebuilt(value) for key, value in data.items() if key != "kind"}
        try:
            return _KINDS[kind](**parts)
        except (TypeError, AttributeError) as error:
            raise ArrayError(f"the data of a {kind} cannot be read: {error}") from None
    if isinstance(data, list) and any(isinstance(item, Mapping) for item in data):
        return [_rebuilt(item) for item in data]
    return data
