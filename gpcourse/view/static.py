"""Draw a scene as a PNG with matplotlib, without pyplot and its global state.

The same scene gives the same bytes: fonts, colours and sizes are set here and not taken from the
user's settings, and the file carries no date.
"""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from gpcourse.view.camera import Projection, extent, view_axes
from gpcourse.view.lettering import placed, width, wrapped
from gpcourse.view.page import Page
from gpcourse.view.painting import Painter
from gpcourse.view.scene import ColourScale, Panel, Scene
from gpcourse.view.shading import value_colours

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Everything below is in points.
MARGIN = 15.0
GAP = 12.0
TITLE = 10.0
TICK = 7.5
BAR = 9.0
BAR_ROOM = 58.0
#: The width of a panel when there are 1, 2, 3, or more in a row.
WIDTHS = (330.0, 250.0, 205.0, 170.0)
INK = (0.11, 0.13, 0.16, 1.0)
#: Everything is drawn so many times larger and averaged, which also smooths shaded triangles.
OVERSAMPLING = 2
_OWN_SETTINGS: Any = {
    "path.simplify": True, "agg.path.chunksize": 0, "path.sketch": None, "path.effects": [],
}  # fmt: skip


@dataclass(frozen=True)
class Cell:
    """The place of a panel: its content in a box, its title above `top`, its colour bar to the right.

    Titles in a row stand on one line, however high their panels are.
    """

    left: float
    bottom: float
    width: float
    height: float
    top: float
    bar: bool


def render(scene: Scene, dpi: int = 120, kind: str = "png") -> bytes:
    """Return the picture of `scene` as a file.

    Parameters
    ----------
    scene : Scene
    dpi : int
        Pixels per inch; a single panel is about 5 inches wide.
    kind : str
        ``png`` is exact; ``webp`` looks the same at a tenth of the size.
    """
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    with rc_context(_OWN_SETTINGS):
        canvas = FigureCanvasAgg(_figure(scene, dpi * OVERSAMPLING))
        canvas.draw()  # type: ignore[no-untyped-call]
        pixels = np.asarray(canvas.buffer_rgba())[..., :3]  # type: ignore[no-untyped-call]
    high, wide = (n - n % OVERSAMPLING for n in pixels.shape[:2])
    image = Image.fromarray(np.ascontiguousarray(pixels[:high, :wide])).reduce(OVERSAMPLING)
    file = BytesIO()
    if kind == "png":
        image.save(file, "PNG", dpi=(dpi, dpi), compress_level=7)
    else:
        image.save(file, "WEBP", quality=70, method=4)
    return file.getvalue()


def render_pdf(scene: Scene) -> bytes:
    """Return the picture of `scene` as a PDF file of lines and outlined letters.

    Blended surfaces are pixels, 300 per inch.
    """
    from matplotlib import rc_context

    file = BytesIO()
    with rc_context(_OWN_SETTINGS):
        figure = _figure(scene, 300)
        figure.savefig(file, format="pdf", dpi=300, metadata={"CreationDate": None})
    return file.getvalue()


def _figure(scene: Scene, dpi: int) -> Figure:
    from matplotlib.figure import Figure

    scales = scene.scales()
    cells, (wide, high) = _layout(scene, scales)
    figure = Figure((wide / 72, high / 72), dpi=dpi, facecolor="white", edgecolor="white")
    page = Page(figure)
    for panel, cell, scale in zip(scene.panels, cells, scales, strict=True):
        projection = _projection(panel, cell)
        room = MARGIN - 2
        page.clip((cell.left - room, cell.bottom - room, cell.width + 2 * room, cell.height + 2 * room))
        Painter(page, projection, scale, panel.layers).paint(panel.layers)
        page.clip(None)
        _title(page, panel.title, cell)
        if cell.bar and scale is not None:
            _colour_bar(page, scale, cell)
    return figure


def _layout(scene: Scene, scales: list[ColourScale | None]) -> tuple[list[Cell], tuple[float, float]]:
    """Place the panels in rows of at most four; return their cells and the size of the page."""
    columns = min(4, len(scene.panels))
    room = WIDTHS[columns - 1]
    shapes = [_shape(panel, room) for panel in scene.panels]
    last = max((i for i, scale in enumerate(scales) if scale is not None), default=-1)
    bars = [scale is not None and (not scene.shared_scale or i == last) for i, scale in enumerate(scales)]
    rows = [range(i, min(i + columns, len(shapes))) for i in range(0, len(shapes), columns)]
    cells: list[Cell] = []
    bottom, wide = 0.0, 0.0
    for row in reversed(rows):
        high = max(shapes[i][1] for i in row)
        left, placed_row = 0.0, []
        for i in row:
            w, h = shapes[i]
            low = bottom + MARGIN + (high - h) / 2
            placed_row.append(Cell(left + MARGIN, low, w, h, bottom + MARGIN + high, bars[i]))
            left += w + 2 * MARGIN + (_bar_room(scales[i]) if bars[i] else 0.0)
        cells = placed_row + cells
        titles = max(_title_height(scene.panels[i].title, shapes[i][0]) for i in row)
        bottom += high + 2 * MARGIN + titles
        wide = max(wide, left)
    return cells, (wide, bottom)


def _shape(panel: Panel, room: float) -> tuple[float, float]:
    """Return the width and height of a panel that fits its content."""
    _, half = extent(panel.layers, panel.camera)
    aspect = float(half[1] / half[0])
    high = min(room * aspect, 0.95 * room)
    wide = min(room, max(high / aspect, 0.5 * room))
    return wide, max(high, 0.25 * room)


def _projection(panel: Panel, cell: Cell) -> Projection:
    middle, half = extent(panel.layers, panel.camera)
    scale = min(cell.width / (2 * half[0]), cell.height / (2 * half[1]))
    centre = np.array([cell.left + cell.width / 2, cell.bottom + cell.height / 2])
    size = 2 * float(np.hypot(*half))
    return Projection(view_axes(panel.camera), float(scale), centre - scale * middle, size)


def _title_height(title: str, room: float) -> float:
    return len(wrapped(title, TITLE, room + MARGIN)) * 1.3 * TITLE


def _title(page: Page, title: str, cell: Cell) -> None:
    lines = wrapped(title, TITLE, cell.width + MARGIN)
    top = cell.top + MARGIN + (len(lines) - 0.5) * 1.3 * TITLE - 4
    x = cell.left + cell.width / 2
    paths = [placed(line, np.array([x, top - 1.3 * TITLE * i]), TITLE) for i, line in enumerate(lines)]
    page.texts(paths, [INK])


def _bar_room(scale: ColourScale | None) -> float:
    """Return the room for a bar with its numbers, and for its name."""
    return BAR_ROOM if scale is None else max(BAR_ROOM, width(scale.name, TICK) + 8)


def _colour_bar(page: Page, scale: ColourScale, cell: Cell) -> None:
    """Draw the scale beside a panel, with round numbers."""
    high = float(np.clip(cell.height, 60.0, 190.0))
    left = cell.left + cell.width + MARGIN + 2
    bottom = cell.bottom + (cell.height - high) / 2
    steps = np.linspace(0, 1, 129)
    colours = value_colours(scale.low + (scale.high - scale.low) * (steps[:-1] + steps[1:]) / 2, scale)
    stripes = [
        np.array(
            [
                [left, bottom + a * high],
                [left + BAR, bottom + a * high],
                [left + BAR, bottom + b * high],
                [left, bottom + b * high],
            ]
        )
        for a, b in pairwise(steps)
    ]
    page.polygons(stripes, colours, colours, 0.3)
    ticks = _ticks(scale)
    heights = [bottom + high * (tick - scale.low) / (scale.high - scale.low) for tick in ticks]
    page.lines([np.array([[left + BAR, y], [left + BAR + 2.5, y]]) for y in heights], [INK], 0.6)
    texts = [f"{0.0 if tick == 0 else tick:.4g}".replace("-", "−") for tick in ticks]
    starts = [left + BAR + 4.5 + width(text, TICK) / 2 for text in texts]
    page.texts(
        [placed(text, np.array(at), TICK) for text, *at in zip(texts, starts, heights, strict=True)], [INK]
    )
    if scale.name:
        x = left + max(BAR / 2, width(scale.name, TICK) / 2)
        page.texts([placed(scale.name, np.array([x, bottom + high + 10]), TICK)], [INK])


def _ticks(scale: ColourScale) -> list[float]:
    from matplotlib.ticker import MaxNLocator

    ticks = MaxNLocator(nbins=5, steps=[1, 2, 2.5, 5, 10]).tick_values(scale.low, scale.high)
    slack = 1e-9 * (scale.high - scale.low)
    return [float(tick) for tick in ticks if scale.low - slack <= tick <= scale.high + slack]
