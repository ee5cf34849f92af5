"""The page that lets one turn, zoom and ask: a picture for a browser that needs nothing else.

It is one element of HTML: a page of its own in a sandboxed frame, over the static picture of the same
scene. Where frames are taken away, as in a notebook that is not trusted, the static picture is left. It
asks the network for nothing, and forbids it to itself. A short script beside the frame tells it whether the
page around is dark, since a sandboxed frame cannot look.
"""

from __future__ import annotations

import json
import re
from functools import cache
from html import escape
from importlib.resources import files

from gpcourse.view.packing import deflated, pack
from gpcourse.view.scene import Scene

#: Undoes the deflating of a part of the page, and runs the program.
_LOADER = """const inflated = (id) => new Response(new Blob([Uint8Array.from(
atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0))]).stream().pipeThrough(
new DecompressionStream("deflate"))).arrayBuffer();
inflated("program").then((code) => document.body.append(Object.assign(document.createElement("script"),
{ textContent: new TextDecoder().decode(code) })));"""
_COMMENT = re.compile(r"//.*|/\*((?!\*/).)*\*/|")
_POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'"


def page(frames: tuple[Scene, ...], names: tuple[str, ...] = (), chooser: str = "") -> str:
    """Return a whole page that shows the first of the scenes, and the others where one asks for them.

    Parameters
    ----------
    frames : tuple of Scene
        Scenes with equally many panels.
    names : tuple of str
        What to call each.
    chooser : str
        ``slider`` for frames of a motion, ``menu`` for fields on one shape, or nothing.
    """
    header, block = pack(frames)
    extra = json.dumps({"names": names, "chooser": chooser})
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        f"<title>{escape(frames[0].alt)}</title><style>{_part('page.css')}</style></head><body>"
        f'<script type="text/plain" id="header">{deflated(header.encode())}</script>'
        f'<script type="text/plain" id="extra">{deflated(extra.encode())}</script>'
        f'<script type="text/plain" id="block">{block}</script>'
        f'<script type="text/plain" id="program">{_program()}</script>'
        f"<script>{_LOADER}</script></body></html>"
    )


def framed(document: str, image: str, least_height: int = 260) -> str:
    """Return the page in a sandboxed frame over `image`, an element of HTML that gives the size.

    `least_height` is in pixels.
    """
    style = f"position:relative;display:inline-block;max-width:100%;min-height:{least_height}px"
    return (
        f'<div style="{style}">{image}'
        '<iframe sandbox="allow-scripts" allow="fullscreen" title="The same picture, to be turned" '
        'style="position:absolute;inset:0;width:100%;height:100%;border:0" '
        f'srcdoc="{escape(document, quote=True)}"></iframe></div><script>{_part("around.js")}</script>'
    )


@cache
def _program() -> str:
    text = "".join(map(_part, ("shaders.js", "labels.js", "page.js", "start.js")))
    lines = (line.strip() for line in text.splitlines())
    return deflated("\n".join(line for line in lines if not _COMMENT.fullmatch(line)).encode())


@cache
def _part(name: str) -> str:
    return (files("gpcourse.view") / "page3d" / name).read_text("utf-8")
