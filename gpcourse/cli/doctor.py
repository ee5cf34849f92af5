"""Saying what this machine has and can do."""

from __future__ import annotations

import platform
import shutil
import sys
from collections.abc import Iterator
from importlib import metadata

import click

from gpcourse import __version__

_NEEDED = [
    "numpy",
    "scipy",
    "matplotlib",
    "scikit-image",
    "jupyterlab",
    "ipykernel",
    "nbformat",
    "jsonschema",
    "jinja2",
    "click",
    "rich",
    "pooch",
]
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "firefox")

#: A name, what was found, and whether that is well; None where it is only to be known.
Finding = tuple[str, str, bool | None]


@click.command()
def doctor() -> None:
    """Report versions, and what this machine can confine. Exits with 1 if a package is missing."""
    well = True
    parts = {"Packages": _packages(), "Programs": _programs(), "Grading": _confinement()}
    for title, findings in parts.items():
        click.secho(title, bold=True)
        for name, text, fine in findings:
            well = well and fine is not False
            click.echo(f"  {'–' if fine is None else '✓' if fine else '✗'} {name:<16} {text}")
    raise SystemExit(not well)


def _packages() -> Iterator[Finding]:
    yield "gpcourse", __version__, True
    yield "python", f"{platform.python_version()}, {sys.executable}", sys.version_info >= (3, 11)
    yield "system", platform.platform(), True
    for name in _NEEDED:
        try:
            yield name, metadata.version(name), True
        except metadata.PackageNotFoundError:
            yield name, f"missing: python -m pip install {name}", False


def _programs() -> Iterator[Finding]:
    for name in ("git", "make"):
        path = shutil.which(name)
        yield name, path or "not there; needed only to work on the course itself", path is not None or None
    browser = next(filter(None, map(shutil.which, _BROWSERS)), None)
    yield "browser", browser or "none found; `gpcourse lab` prints the address", browser is not None or None


def _confinement() -> Iterator[Finding]:
    """Say what bounds student code while it is graded, and what more this machine could do."""
    from gpcourse.errors import WorkerError
    from gpcourse.sandbox.confine import level_here
    from gpcourse.sandbox.probe import probe

    needed = ("own process", "resource limits")
    for layer in probe():
        yield layer.name, layer.words, layer.works if layer.name in needed else layer.works or None
    try:
        here = level_here()
    except WorkerError as error:
        yield "level", str(error), False
        return
    words = f"{here.level}, reached by a process that was started just now"
    if not here.reaches("restricted"):
        words += f"; missing: {'; '.join(here.missing)}. Grading needs --allow-unconfined"
    yield "level", words, here.reaches("restricted") or None
