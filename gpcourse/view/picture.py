"""A picture in a notebook: a scene that is drawn when somebody looks."""

from __future__ import annotations

import os
import sys
from base64 import b64encode
from collections.abc import Callable
from functools import cached_property
from html import escape
from os import PathLike
from pathlib import Path
from reprlib import repr as short

from gpcourse.errors import ArrayError, PictureError
from gpcourse.view.checks import as_flag
from gpcourse.view.scene import Scene

#: Where this is set in the environment, and not to 0, notebooks show static pictures only: quicker, for CI.
STATIC = "GPCOURSE_STATIC"


def _static_only() -> bool:
    """Tell what the environment wants; without a word, kernels that pytest runs (nbval) want still images."""
    said = os.environ.get(STATIC)
    if said is not None:
        return said not in ("", "0")
    ipython = sys.modules.get("IPython")
    return "PYTEST_VERSION" in os.environ and ipython is not None and ipython.get_ipython() is not None


class Picture:
    """A scene to look at: static as PNG, to be turned and asked in a notebook.

    As text it is its description in words, so that the output of a notebook cell states a fact; as HTML it
    is a page in a frame over an image with that description. There is no second copy as ``image/png``.

    Parameters
    ----------
    scene : Scene
        What the static picture shows.
    static : bool or None
        Show the static picture only; None: if the environment has GPCOURSE_STATIC, or under nbval.
    dpi : int
        Pixels per inch of the static picture; see `static.render`.
    frames : tuple of Scene
        What the page shows, if not `scene`: one at a time, each with as many panels as the first.
    names : tuple of str
        What to call the frames.
    chooser : str
        How they are chosen: ``slider`` or ``menu``.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        static: bool | None = None,
        dpi: int = 120,
        frames: tuple[Scene, ...] = (),
        names: tuple[str, ...] = (),
        chooser: str = "",
    ) -> None:
        if not isinstance(scene, Scene):
            raise ArrayError(f"a {type(scene).__name__} is not a scene; see gpcourse.view.scene")
        if isinstance(dpi, bool) or not isinstance(dpi, (int, float)) or not 10 <= dpi <= 1200:
            raise PictureError(f"dpi is {short(dpi)}; give a number from 10 to 1200")
        self.scene = scene
        self.static = None if static is None else as_flag(static, "static")
        self.dpi = dpi
        self.frames = frames or (scene,)
        self.names = names
        self.chooser = chooser

    @cached_property
    def _bytes(self) -> bytes:
        from gpcourse.view.static import render

        return render(self.scene, self.dpi)

    def png(self) -> bytes:
        """Return the picture as the bytes of a PNG file; equal scenes give equal bytes."""
        return self._bytes

    def page(self) -> str:
        """Return the interactive picture as a whole page of HTML that needs no other file."""
        from gpcourse.view.interactive import page

        return page(self.frames, self.names, self.chooser)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the picture to a PNG or PDF file, or to an HTML file that can be turned.

        Raises
        ------
        PictureError
            If `path` has another ending, its folder is missing, or the file cannot be written.
        """
        if not isinstance(path, (str, PathLike)):
            raise PictureError(f"path is {short(path)}; give a file name that ends in .png, .pdf or .html")
        file = Path(path)
        makers: dict[str, Callable[[], bytes]] = {
            ".png": self.png,
            ".pdf": self._pdf,
            ".html": lambda: self.page().encode(),
        }
        if file.suffix.lower() not in makers:
            raise PictureError(f"{file} does not end in .png, .pdf or .html; save it as one of these")
        if not file.parent.is_dir():
            raise PictureError(f"{file} cannot be written: there is no folder {file.parent}; make it first")
        data = makers[file.suffix.lower()]()
        try:
            file.write_bytes(data)
        except OSError as error:
            raise PictureError(f"{file} cannot be written: {error.strerror}; choose another place") from None

    def _pdf(self) -> bytes:
        from gpcourse.view.static import render_pdf

        return render_pdf(self.scene)

    def image(self, kind: str = "png") -> str:
        """Return an ``<img>`` element that holds the static picture and its description.

        As ``png`` it is exact; as ``webp`` it looks the same at a tenth of the size.
        """
        from gpcourse.view.static import render

        data = b64encode(self.png() if kind == "png" else render(self.scene, self.dpi, kind)).decode("ascii")
        alt = escape(self.scene.alt, quote=True)
        return f'<img alt="{alt}" src="data:image/{kind};base64,{data}" style="max-width:100%">'

    def html(self) -> str:
        """Return what a notebook shows."""
        if _static_only() if self.static is None else self.static:
            return self.image()
        from gpcourse.view.interactive import framed

        # The still of a motion is a low strip of three frames; the page shows one.
        return framed(self.page(), self.image("webp"), 400 if self.chooser == "slider" else 260)

    def _repr_html_(self) -> str:
        return self.html()

    def __repr__(self) -> str:
        return self.scene.alt
