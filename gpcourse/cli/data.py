"""Fetching data that others made."""

from __future__ import annotations

import click


@click.group()
def data() -> None:
    """Scans made by others, for chapter 2. The course works without them, on scans of its own."""


@data.command()
@click.argument("name", type=click.Choice(["bunny"]))
@click.option("--url", default=None, help="Another place to download it from.")
def fetch(name: str, url: str | None) -> None:
    """Download the data set NAME, verify it, and say where it is.

    A download that breaks off goes on from there when the command is run again. The folder is the user's
    cache, or that in the environment variable GPCOURSE_DATA.
    """
    from gpcourse.data_sets import BUNNY_CREDIT, BUNNY_SHA256, BUNNY_URL, fetch_bunny

    click.echo(BUNNY_CREDIT)
    folder = fetch_bunny(url or BUNNY_URL)
    click.echo(f"\n{len(BUNNY_SHA256)} files, all with the right SHA-256, are in {folder}")
