"""A picture in a notebook: a scene that is drawn when somebody looks."""

from __future__ import annotations

from base64 import b64encode
from functools import cached_property
from html import escape
from pathlib import Path

from gpcourse.errors import ArrayError
from gpcourse.view.scene import Scene


class Picture:
    """A drawn scene.

    As text it is its description in words, so that the output of a notebook cell states a fact;
    as HTML it is an image with that description. There is no second copy as ``image/png``.
    """

    def __init__(self, scene: Scene) -> None:
        if not isinstance(scene, Scene):
            raise ArrayError(f"a {type(scene).__name__} is not a scene; see gpcourse.view.scene")
        self.scene = scene

    @cached_property
    def _bytes(self) -> bytes:
        from gpcourse.view.static import render

        return render(self.scene)

    def png(self) -> bytes:
        """Return the picture as the bytes of a PNG file; equal scenes give equal bytes."""
        return self._bytes

    def save(self, path: str | Path) -> None:
        """Write the picture to a PNG file; ArrayError if `path` has another ending."""
        if Path(path).suffix.lower() != ".png":
            raise ArrayError(f"{path} does not end in .png; pictures are saved as PNG files")
        Path(path).write_bytes(self.png())

    def html(self) -> str:
        """Return an ``<img>`` element that holds the picture and its description."""
        data = b64encode(self.png()).decode("ascii")
        alt = escape(self.scene.alt, quote=True)
        return f'<img alt="{alt}" src="data:image/png;base64,{data}" style="max-width:100%">'

    def _repr_html_(self) -> str:
        return self.html()

    def __repr__(self) -> str:
        return self.scene.alt
