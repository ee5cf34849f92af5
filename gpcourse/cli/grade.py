"""Grading a class."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from gpcourse.grading import GradeBook
    from gpcourse.grading.roster import Roster, Target


@click.command()
@click.argument("submissions", type=click.Path(exists=True, path_type=Path))
@click.option("--out", required=True, type=click.Path(path_type=Path), help="The folder for the grade book.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Draws the inputs.")
@click.option("--chapter", "chapters", multiple=True, help="Grade this chapter only, as 1 or halfedge.")
@click.option("--jobs", type=click.IntRange(min=1), help="Submissions at a time; by default one a core.")
@click.option("--scheduler", metavar="ADDRESS", help="Mark on a Dask cluster, as tcp://10.0.0.5:8786.")
@click.option("--allow-unconfined", is_flag=True, help="Grade work you trust where it cannot be confined.")
@click.option("--junit", is_flag=True, help="Also write junit.xml, for CI.")
@click.option(
    "--export",
    "target",
    type=click.Choice(["canvas", "moodle", "nbgrader"]),
    help="Also write the grades in its format.",
)
@click.option(
    "--roster",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    help="The list of the class, as it gives it out.",
)
@click.option("--assignment", help="What the assignment is called there; by default the chapters' titles.")
@click.option("--quiet", is_flag=True, help="No progress bar, no summary.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary as JSON.")
def grade(
    *,
    submissions: Path,
    out: Path,
    seed: int,
    chapters: tuple[str, ...],
    jobs: int | None,
    scheduler: str | None,
    allow_unconfined: bool,
    junit: bool,
    target: Target | None,
    roster: Path | None,
    assignment: str | None,
    quiet: bool,
    as_json: bool,
) -> None:
    """Grade the SUBMISSIONS of a class: a folder with a notebook, a folder or a zip file a student.

    Or what Moodle or Canvas give out for grading, the zip file as it is or unpacked; or the folder of a
    course of nbgrader.

    With --export, canvas.csv, moodle.csv or nbgrader.csv is written too, to be imported there; --roster is
    Canvas's exported gradebook, Moodle's grading worksheet, or the students of nbgrader. Who is in one of
    the two only is named, and a name that fits two students is given to neither.

    The same seed gives the same grades, another seed other inputs. Interrupted, the same command goes on
    where it stopped. Exits with 0 when all were graded, whatever the grades, with 1 when a person has to look
    at one, and with 2 when nothing can be graded, as where student code cannot be confined and
    --allow-unconfined is not given.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from gpcourse.grading import grade as grade_folder

    listed = _roster(target, roster)
    columns = (TextColumn("grading"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    try:
        with Progress(*columns, console=Console(stderr=True), disable=quiet or as_json) as bar:
            task = bar.add_task("grading", total=None)
            book = grade_folder(
                submissions,
                out,
                seed=seed,
                chapters=chapters or None,
                jobs=jobs,
                scheduler=scheduler,
                allow_unconfined=allow_unconfined,
                junit=junit,
                progress=lambda done, total, _: bar.update(task, completed=done, total=total),
            )
    except KeyboardInterrupt:
        click.echo("Interrupted. The same command goes on where this one stopped.", err=True)
        raise SystemExit(130) from None
    remarks = _export(target, book, listed, assignment) if target else ()
    faults = sum(report.status == "grader fault" for report in book.reports)
    if as_json:
        summary = _summary(book)
        if target:
            summary["export"] = {"file": str(book.out / f"{target}.csv"), "remarks": list(remarks)}
        click.echo(json.dumps(summary, ensure_ascii=False, indent=1))
    elif not quiet:
        _show(book)
        if target:
            click.echo(f"The grades for {target} are {book.out / f'{target}.csv'}")
    if not as_json:
        for remark in remarks:
            click.echo(remark, err=True)
    raise SystemExit(faults > 0)


def _roster(target: Target | None, path: Path | None) -> Roster | None:
    """Read the roster before anything is graded, so that a wrong file costs no time."""
    from gpcourse.errors import UsageError
    from gpcourse.grading.roster import read_roster

    if path is None:
        return None
    if target is None:
        raise UsageError(f"{path} is a roster of what? Give --export canvas, moodle or nbgrader too")
    return read_roster(path, target)


def _export(
    target: Target, book: GradeBook, roster: Roster | None, assignment: str | None
) -> tuple[str, ...]:
    from gpcourse.grading import exports, gradebook, reports

    name = assignment or reports.title_of(book.chapters)
    out_of = sum(exercise.points for exercise in book.exercises)
    graded = exports.Graded(book.reports, book.owners, book.timestamps, name, out_of)
    made = exports.export(target, graded, roster)
    gradebook.write(book.out / f"{target}.csv", made.text)
    return tuple(gradebook.safe(remark) for remark in made.remarks)


def _summary(book: GradeBook) -> dict[str, object]:
    return {
        "seed": book.seed,
        "resumed": book.resumed,
        "confinement": book.confinement,
        "chapters": [chapter.stem for chapter in book.chapters],
        "out_of": sum(exercise.points for exercise in book.exercises),
        "table": str(book.table),
        "page": str(book.page),
        "students": [
            {"student": r.student, "points": r.points, "status": r.status, "notes": list(r.notes)}
            for r in book.reports
        ],
    }


def _show(book: GradeBook) -> None:
    statuses = Counter(report.status for report in book.reports)
    many = len(book.reports)
    words = ", ".join(f"{count} {status}" for status, count in sorted(statuses.items()))
    click.echo(f"{many} submission{'' if many == 1 else 's'}: {words}")
    if book.resumed:
        click.echo(f"{book.resumed} of them had been graded before, and were not graded again")
    click.echo(f"The table is {book.table}")
    click.echo(f"The report is {book.page}")
    if book.seed == 0:
        hint = "Seed 0 is the one that students check with; --seed NUMBER draws inputs that nobody has seen"
        click.echo(hint, err=True)
