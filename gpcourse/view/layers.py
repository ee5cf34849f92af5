"""What can lie in a picture: surfaces, arrows, curves, points and labels, as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from gpcourse.errors import ArrayError
from gpcourse.geometry.arrays import FloatArray, IntArray, flatten_polygons
from gpcourse.view.checks import (
    as_colours,
    as_flag,
    as_positions,
    as_positive,
    as_text,
    as_texts,
    check_hidden,
    check_same_length,
    set_fields,
    set_values,
)
from gpcourse.view.colours import FRONT, INK, as_colour


@dataclass(frozen=True, eq=False)
class Mesh:
    """A surface of polygons, in one colour, a colour per face or vertex, or coloured by values.

    Attributes
    ----------
    vertices : (n, 3) float array
    faces : list of index lists or (m, k) int array
        Corners counter-clockwise seen from outside; the other side is drawn in another colour.
    colour : str
        Of the outer side, where there are no values.
    face_colours, vertex_colours : m or n strings or None
        At most one of them; the colours of vertices are blended over the faces.
    values : (n,) or (m,) float array or None
        Shown in colour; NaN and infinity are shown in grey.
    values_on : "vertices" or "faces"
    colour_map, limits : str, (low, high), or None
        None leaves the choice to `colour_scale`.
    value_name : str
        Written at the colour bar.
    edges, hidden_edges, smooth : bool
        Draw edges; draw those behind the surface too, dashed; shade with vertex normals.
    """

    kind: ClassVar[str] = "mesh"
    vertices: FloatArray
    faces: Any
    colour: str = FRONT
    face_colours: tuple[str, ...] | None = None
    values: FloatArray | None = None
    values_on: str = "vertices"
    colour_map: str | None = None
    limits: tuple[float, float] | None = None
    value_name: str = ""
    edges: bool = True
    hidden_edges: bool = False
    smooth: bool = False
    vertex_colours: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        vertices = as_positions(self.vertices, "vertices")
        _, sizes = flatten_polygons(self.faces, len(vertices))
        if self.values_on not in ("vertices", "faces"):
            raise ArrayError(f"values_on is {self.values_on!r}; it must be 'vertices' or 'faces'")
        for name in ("edges", "hidden_edges", "smooth"):
            set_fields(self, **{name: as_flag(getattr(self, name), name)})
        count = len(vertices) if self.values_on == "vertices" else len(sizes)
        set_fields(
            self, vertices=vertices, colour=as_colour(self.colour), value_name=as_text(self.value_name)
        )
        if self.face_colours is not None:
            set_fields(self, face_colours=as_colours(self.face_colours, len(sizes), "face_colours"))
        if self.vertex_colours is not None:
            if self.face_colours is not None:
                raise ArrayError("there are face_colours and vertex_colours; give one of them")
            colours = as_colours(self.vertex_colours, len(vertices), "vertex_colours")
            set_fields(self, vertex_colours=colours)
        set_values(self, count)

    @property
    def polygons(self) -> tuple[IntArray, IntArray]:
        """All corners, face after face, and the size of each face."""
        return flatten_polygons(self.faces, len(self.vertices))


@dataclass(frozen=True, eq=False)
class Arrows:
    """Straight arrows, each with its colour and, if wanted, a label beside its middle.

    Attributes
    ----------
    tails, heads : (k, 3) float arrays
    colours : k strings, or one for all
    labels : k strings, or none
    label_sides : (k, 3) float array or None
        The direction in which the label lies from the middle of the arrow.
    width : float
        Of the line, in points.
    hidden : "hide", "fade" or "show"
        What becomes of the parts that lie behind a surface.
    """

    kind: ClassVar[str] = "arrows"
    tails: FloatArray
    heads: FloatArray
    colours: tuple[str, ...] = (INK,)
    labels: tuple[str, ...] = ()
    label_sides: FloatArray | None = None
    width: float = 1.1
    hidden: str = "hide"

    def __post_init__(self) -> None:
        tails, heads = as_positions(self.tails, "tails"), as_positions(self.heads, "heads")
        check_same_length(heads, "heads", len(tails), "tails")
        set_fields(self, tails=tails, heads=heads, colours=as_colours(self.colours, len(tails), "colours"))
        set_fields(self, labels=as_texts(self.labels, len(tails)), width=as_positive(self.width, "width"))
        if self.label_sides is not None:
            sides = as_positions(self.label_sides, "label_sides")
            check_same_length(sides, "label_sides", len(tails), "tails")
            set_fields(self, label_sides=sides)
        check_hidden(self.hidden)


@dataclass(frozen=True, eq=False)
class Curves:
    """Polylines: `lines` is a list of (k, 3) arrays. `width` is in points; `closed` joins the ends."""

    kind: ClassVar[str] = "curves"
    lines: tuple[FloatArray, ...]
    colours: tuple[str, ...] = (INK,)
    width: float = 1.4
    closed: bool = False
    hidden: str = "fade"

    def __post_init__(self) -> None:
        lines = tuple(as_positions(line, f"lines[{i}]") for i, line in enumerate(self.lines))
        for i, line in enumerate(lines):
            if len(line) < 2:
                raise ArrayError(f"lines[{i}] has {len(line)} points; a curve needs at least 2")
        set_fields(self, lines=lines, colours=as_colours(self.colours, len(lines), "colours"))
        set_fields(self, width=as_positive(self.width, "width"), closed=as_flag(self.closed, "closed"))
        check_hidden(self.hidden)


@dataclass(frozen=True, eq=False)
class Points:
    """Dots of `size` points across, in one colour, a colour each, or coloured by values like a `Mesh`."""

    kind: ClassVar[str] = "points"
    positions: FloatArray
    colours: tuple[str, ...] = (INK,)
    values: FloatArray | None = None
    colour_map: str | None = None
    limits: tuple[float, float] | None = None
    value_name: str = ""
    size: float = 4.0
    hidden: str = "hide"

    def __post_init__(self) -> None:
        positions = as_positions(self.positions, "positions")
        set_fields(self, positions=positions, colours=as_colours(self.colours, len(positions), "colours"))
        set_fields(self, size=as_positive(self.size, "size"), value_name=as_text(self.value_name))
        set_values(self, len(positions))
        check_hidden(self.hidden)


@dataclass(frozen=True, eq=False)
class Labels:
    """Texts at positions.

    Attributes
    ----------
    positions : (k, 3) float array
    texts : k strings
    colours : k strings, or one for all
    place : "on", "beside" or "badge"
        Centred on the position; next to it; or centred, in a white disc.
    size : float or None
        Of the letters, in points; None lets the renderer choose by the room there is.
    hidden : "hide", "fade" or "show"
    """

    kind: ClassVar[str] = "labels"
    positions: FloatArray
    texts: tuple[str, ...]
    colours: tuple[str, ...] = (INK,)
    place: str = "on"
    size: float | None = None
    hidden: str = "fade"

    def __post_init__(self) -> None:
        positions = as_positions(self.positions, "positions")
        if self.place not in ("on", "beside", "badge"):
            raise ArrayError(f"place is {self.place!r}; it must be 'on', 'beside' or 'badge'")
        texts = as_texts(self.texts, len(positions))
        set_fields(self, positions=positions, texts=texts or ("",) * len(positions))
        set_fields(self, colours=as_colours(self.colours, len(positions), "colours"))
        if self.size is not None:
            set_fields(self, size=as_positive(self.size, "size"))
        check_hidden(self.hidden)


Layer = Mesh | Arrows | Curves | Points | Labels
