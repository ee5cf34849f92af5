"""The scans of chapter 2: what is here, and how to get those of Stanford."""

from __future__ import annotations

import click


@click.group()
def data() -> None:
    """Range scans for chapter 2: those that come with the course, and those that others made."""


@data.command("list")
def list_() -> None:
    """Say which scans there are, where they lie, and which ones the notebook opens."""
    from gpcourse.data_sets import BUNNY_CREDIT, bunny_folder, pebble_folder

    bunny, pebble = bunny_folder(), pebble_folder()
    in_use = "pebble" if bunny is None else "bunny"
    click.echo(f"pebble  five scans of a made object, part of the course, in {pebble}")
    where = f"in {bunny}" if bunny else "not here; `gpcourse data fetch bunny` brings it"
    click.echo(f"bunny   five scans of the Stanford bunny, {where}")
    click.echo(f"\nChapter 2 opens the {in_use}.")
    if bunny:
        click.echo(BUNNY_CREDIT)


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
