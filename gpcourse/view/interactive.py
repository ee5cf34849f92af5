"""The interactive page: one HTML text with everything in it, in a sandboxed frame over a still picture."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from html import escape
from importlib.resources import files

from gpcourse.errors import ArrayError
from gpcourse.view.packing import pack
from gpcourse.view.scene import Scene

#: ``GPCOURSE_VIEW=static`` makes still pictures only, as the tests of the notebooks do.
SWITCH = "GPCOURSE_VIEW"

_BUTTONS = {
    "reset": "reset",
    "wire": "wires",
    "flat": "flat / smooth",
    "lines": "isolines",
    "dark": "dark / light",
    "full": "full screen",
}


def is_static(static: bool | None) -> bool:
    """Return `static`, or what the environment says if it is None; ArrayError if that is not known."""
    if static is not None:
        return static
    setting = os.environ.get(SWITCH, "interactive")
    if setting not in ("static", "interactive"):
        raise ArrayError(f"{SWITCH} is {setting!r}; set it to 'static' or 'interactive', or leave it out")
    return setting == "static"


def page(frames: Sequence[tuple[str, Scene]]) -> str:
    """Return a complete HTML document that draws the frames and asks the network for nothing."""
    folder = files("gpcourse.view") / "page_files"
    style, script = ((folder / f"viewer.{end}").read_text(encoding="utf-8") for end in ("css", "js"))
    data = json.dumps(pack(frames), separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    buttons = "".join(f'<button id="{key}">{text}</button>' for key, text in _BUTTONS.items())
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Picture</title><style>{style}</style>'
        '<canvas id="gl" tabindex="0" role="img"></canvas><canvas id="over"></canvas><div id="bar">'
        f"{buttons}"
        '<button id="play" aria-pressed="false" hidden>play</button>'
        '<input id="frame" type="range" min="0" value="0" aria-label="frame" hidden>'
        '<span id="name" hidden></span><output id="said"></output></div>'
        f'<script type="application/json" id="scene">{data}</script><script>{script}</script></html>'
    )


def embedded(frames: Sequence[tuple[str, Scene]], image: str) -> str:
    """Return the page in a sandboxed frame over the ``<img>`` element, which shows where it may not run."""
    inner = escape(page(frames), quote=False).replace('"', "&quot;")
    columns = min(4, max(len(scene.panels) for _, scene in frames))
    rows = -(-max(len(scene.panels) for _, scene in frames) // columns)
    high = 30 + rows * (400, 330, 270, 240)[columns - 1]
    label = escape(frames[0][1].alt, quote=True)
    return (
        f'<div style="position:relative;min-height:{high}px;max-width:960px">{image}'
        f'<iframe title="{label}" sandbox="allow-scripts" allow="fullscreen" loading="lazy" '
        'style="position:absolute;left:0;top:0;width:100%;height:100%;border:0" '
        f'srcdoc="{inner}"></iframe></div>'
    )
