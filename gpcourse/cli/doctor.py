"""Saying what this machine has and can do."""

from __future__ import annotations

import os
import platform
import shutil
import sys
from collections.abc import Iterator
from importlib import metadata
from importlib.util import find_spec

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
            click.echo(f"  {'–' if fine is None else '✓' if fine else '✗'} {name:<14} {text}")
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
    """Say what bounds student code while it is graded."""
    yield "process", "student code runs in a process of its own, with a time limit for each call", True
    if hasattr(os, "setsid"):
        yield "ending", "a process that does not answer is ended with its children", True
    else:
        yield "ending", "a process that does not answer is ended; its children may survive it", None
    if find_spec("resource") is not None:
        yield "limits", "memory, processor time, size of files", True
    else:
        yield "limits", "this system has none on memory and processor time", None
    yield "files, network", "open to student code: grade strangers' work in a container", None
