"""Opening the course in JupyterLab."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import webbrowser
from importlib.util import find_spec
from pathlib import Path

import click

from gpcourse.errors import UsageError

#: Where an installed package keeps the notebooks, and what the student's copy of them is called.
_PACKAGE = Path(__file__).resolve().parents[1]
_INSTALLED = _PACKAGE / "_course" / "notebooks"
_CHECKOUT = _PACKAGE.parent / "notebooks"
COPY = "gpcourse-notebooks"

_FIRST = "0_welcome.ipynb"


@click.command(context_settings={"ignore_unknown_options": True, "allow_extra_args": True})
@click.argument("options", nargs=-1, type=click.UNPROCESSED)
def lab(options: tuple[str, ...]) -> None:
    """Open the course in JupyterLab. All OPTIONS are passed on to it, as --no-browser or --port=9000.

    The notebooks are those of this folder, or of the checkout; an installed course is copied into
    the folder gpcourse-notebooks first, and nothing that is there already is touched.
    """
    if find_spec("jupyterlab") is None:
        raise UsageError("JupyterLab is not installed; run `python -m pip install jupyterlab`")
    folder = notebooks(Path.cwd())
    click.echo(f"The notebooks are in {folder}")
    raise SystemExit(_run(command(folder, options)))


def notebooks(here: Path) -> Path:
    """Return the folder of notebooks to open; a copy of the installed ones where there is none.

    Raises
    ------
    UsageError
        If this installation has no notebooks.
    """
    for folder in (here, here / "notebooks"):
        if (folder / _FIRST).is_file():
            return folder
    if (_CHECKOUT / _FIRST).is_file():
        return _CHECKOUT
    if not (_INSTALLED / _FIRST).is_file():
        raise UsageError("this installation holds no notebooks; install it anew, or run it in a checkout")
    copy = here / COPY
    copy.mkdir(exist_ok=True)
    for source in sorted(_INSTALLED.glob("*.ipynb")):
        if not (copy / source.name).exists():
            shutil.copyfile(source, copy / source.name)
    return copy


def course_notebooks() -> list[Path]:
    """Return the notebooks of the course as they are given out."""
    folder = _CHECKOUT if (_CHECKOUT / _FIRST).is_file() else _INSTALLED
    return sorted(folder.glob("*.ipynb"))


def command(folder: Path, options: tuple[str, ...]) -> list[str]:
    """Return the command that starts JupyterLab on `folder`."""
    words = [sys.executable, "-m", "jupyterlab", f"--ServerApp.root_dir={folder}"]
    words += [f"--LabApp.default_url=/lab/tree/{_FIRST}"] if (folder / _FIRST).is_file() else []
    if not _has_browser() and "--no-browser" not in options:
        click.echo("There is no browser here: open the address that JupyterLab prints.")
        words.append("--no-browser")
    if getattr(os, "geteuid", lambda: 1)() == 0 and "--allow-root" not in options:
        words.append("--allow-root")  # in a container; JupyterLab refuses otherwise
    return [*words, *options]


def _has_browser() -> bool:
    try:
        webbrowser.get()
    except webbrowser.Error:
        return False
    return True


def _run(words: list[str]) -> int:
    process = subprocess.Popen(words)
    while True:
        try:
            return process.wait()
        except KeyboardInterrupt:
            continue  # JupyterLab got it as well, and asks what to do
