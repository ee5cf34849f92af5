"""An autograder to upload to Gradescope."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="The zip file to write.")
@click.option(
    "--chapter", "chapters", multiple=True, required=True, help="What the assignment is of, as 1 or halfedge."
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Draws the inputs.")
@click.option("--allow-unconfined", is_flag=True, help="Grade even if Gradescope's machine cannot confine.")
def gradescope(*, out: Path, chapters: tuple[str, ...], seed: int, allow_unconfined: bool) -> None:
    """Write the zip file to upload as the autograder of an assignment on Gradescope.

    It holds this version of the course and the versions of its packages that are installed here. Each
    exercise becomes a test; what students see holds no expected answer, no path and no seed.
    """
    from gpcourse.grading.gradescope import build

    build(out, chapters, seed=seed, allow_unconfined=allow_unconfined)
    click.echo(f"The autograder is {out}")
    click.echo("Upload it to Gradescope: Configure Autograder, Upload Autograder (Zip).")
