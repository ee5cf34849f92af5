"""Which submissions share code."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("submissions", type=click.Path(exists=True, path_type=Path))
@click.option("--out", required=True, type=click.Path(path_type=Path), help="The folder for the report.")
@click.option(
    "--threshold", type=click.FloatRange(0, 1, min_open=True), default=0.5, show_default=True,
    help="Show pairs that share at least this part of one of them.",
)  # fmt: skip
def similarity(*, submissions: Path, out: Path, threshold: float) -> None:
    """Compare the SUBMISSIONS of a class with each other and with the reference solutions.

    Nothing of theirs is run. Writes similarity.csv and similarity.html, with the code that is shared side by
    side. Needs copydetect: pip install "gpcourse[similarity]".
    """
    from gpcourse.cli.lab import course_notebooks
    from gpcourse.grading.similarity import compare

    pairs = compare(
        submissions,
        course_notebooks(),
        out,
        threshold=threshold,
        tell=lambda words: click.echo(words, err=True),
    )
    alike = sum(pair.with_reference for pair in pairs)
    click.echo(f"{len(pairs)} pairs to look at, {alike} of them with the reference solutions")
    click.echo(f"The report is {out / 'similarity.html'}")
