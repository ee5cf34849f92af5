"""A picture in a notebook: a scene that is drawn when somebody looks."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from functools import cached_property
from html import escape
from pathlib import Path

from gpcourse.errors import ArrayError
from gpcourse.view.interactive import embedded, is_static, page
from gpcourse.view.scene import Scene


class Picture:
    """A drawn scene.

    As text it is its description in words, so that the output of a notebook cell states a fact;
    in a notebook it can be turned, and is an image with that description where scripts may not run, or
    where `static` says so. There is no second copy as ``image/png``.

    Parameters
    ----------
    scene : Scene
        What the image shows, and the page too if there are no frames.
    static : bool or None
        Show the image only; None leaves it to the environment variable ``GPCOURSE_VIEW``.
    frames : list of (name, scene)
        Shown one at a time, with a slider.
    """

    def __init__(
        self, scene: Scene, *, static: bool | None = None, frames: Sequence[tuple[str, Scene]] = ()
    ) -> None:
        if not isinstance(scene, Scene):
            raise ArrayError(f"a {type(scene).__name__} is not a scene; see gpcourse.view.scene")
        self.scene = scene
        self.frames = tuple(frames) or (("", scene),)
        self._static = static

    @cached_property
    def _bytes(self) -> bytes:
        from gpcourse.view.static import render

        return render(self.scene)

    def png(self) -> bytes:
        """Return the picture as the bytes of a PNG file; equal scenes give equal bytes."""
        return self._bytes

    def save(self, path: str | Path) -> None:
        """Write a PNG file, or the page that can be turned as .html; ArrayError for another ending."""
        if Path(path).suffix.lower() == ".html":
            Path(path).write_text(page(self.frames), encoding="utf-8")
            return
        if Path(path).suffix.lower() != ".png":
            raise ArrayError(f"{path} does not end in .png or .html; a picture is saved as one of them")
        Path(path).write_bytes(self.png())

    def html(self) -> str:
        """Return an ``<img>`` element that holds the picture and its description."""
        data = b64encode(self.png()).decode("ascii")
        alt = escape(self.scene.alt, quote=True)
        return f'<img alt="{alt}" src="data:image/png;base64,{data}" style="max-width:100%">'

    def _repr_html_(self) -> str:
        return self.html() if is_static(self._static) else embedded(self.frames, self.html())

    def __repr__(self) -> str:
        return self.scene.alt
