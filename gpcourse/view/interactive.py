"""The page that lets one turn, zoom and ask: a picture for a browser that needs nothing else.

It is one element of HTML: a page of its own in a sandboxed frame, over the static picture of the same
scene. Where frames are taken away, as in a notebook that is not trusted, the static picture is left. It
asks the network for nothing, and forbids it to itself.
"""

from __future__ import annotations

import json
import zlib
from base64 import b64encode
from functools import cache
from html import escape
from importlib.resources import files

from gpcourse.view.packing import pack
from gpcourse.view.scene import Scene

#: Undoes the deflating of a part of the page, and runs the program.
_LOADER = """const inflated = (id) => new Response(new Blob([Uint8Array.from(
atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0))]).stream().pipeThrough(
new DecompressionStream("deflate"))).arrayBuffer();
inflated("program").then((code) => document.body.append(Object.assign(document.createElement("script"),
{ textContent: new TextDecoder().decode(code) })));"""
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
        f'<script type="application/json" id="header">{_in_script(header)}</script>'
        f'<script type="application/json" id="extra">{_in_script(extra)}</script>'
        f'<script type="text/plain" id="block">{block}</script>'
        f'<script type="text/plain" id="program">{_program()}</script>'
        f"<script>{_LOADER}</script></body></html>"
    )


def framed(document: str, image: str) -> str:
    """Return the page in a sandboxed frame over `image`, an element of HTML that gives the size."""
    return (
        f'<div style="position:relative;display:inline-block;max-width:100%;min-height:260px">{image}'
        '<iframe sandbox="allow-scripts" allow="fullscreen" title="The same picture, to be turned" '
        'style="position:absolute;inset:0;width:100%;height:100%;border:0" '
        f'srcdoc="{escape(document, quote=True)}"></iframe></div>'
    )


def _in_script(text: str) -> str:
    return text.replace("<", "\\u003c")  # a title must not end the element


@cache
def _program() -> str:
    return b64encode(zlib.compress(_part("page.js").encode(), 9)).decode("ascii")


@cache
def _part(name: str) -> str:
    return (files("gpcourse.view") / "page3d" / name).read_text("utf-8")
