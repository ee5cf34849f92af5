"""Commands on notebooks and exercises."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gpcourse.errors import UsageError

if TYPE_CHECKING:
    from gpcourse.exercises.course import Chapter
    from gpcourse.grading.judge import Report
    from gpcourse.notebook.document import Document

_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


@click.command()
@click.argument("notebook", type=_FILE)
@click.option("--all", "every", is_flag=True, help="An exercise that is not attempted is not right, either.")
@click.option("--verbose", "-v", is_flag=True, help="Explain every exercise that is not right.")
def check(notebook: Path, every: bool, verbose: bool) -> None:
    """Check the exercises of a NOTEBOOK, with the inputs that `check` uses in it.

    Its functions run in a process of their own; its demonstrations do not run. Exits with 1 if an
    exercise is not right. One that is not attempted does not count, unless --all is given.
    """
    report = _judged(notebook)
    _show(report, verbose)
    wrong = [j for j in report.judged if j.verdict.outcome not in ("passed", "not attempted")]
    left = [j for j in report.judged if j.verdict.outcome == "not attempted"]
    raise SystemExit(bool(wrong or (every and left)))


def _judged(notebook: Path) -> Report:
    from gpcourse.grading.judge import judge_submission
    from gpcourse.grading.run import chapters_in
    from gpcourse.grading.submission import Notebook, Submission, read_notebook
    from gpcourse.notebook.checking import SEED
    from gpcourse.sandbox import confine, home
    from gpcourse.sandbox.proxy import Worker

    read = read_notebook(notebook)
    if not read.readable:
        raise UsageError(f"{notebook}: {'; '.join(read.notes)}")
    chosen = [exercise for chapter in chapters_in([read]) for exercise in chapter.exercises]
    if not chosen:
        raise UsageError(f"{notebook} defines no function of an exercise; give a notebook of the course")
    fonts = any("matplotlib" in source for _, source in read.cells)
    with tempfile.TemporaryDirectory(prefix="gpcourse-", ignore_cleanup_errors=True) as root:
        package = home.build(Path(root) / "home", fonts=fonts)

        def open_worker(each: Notebook) -> Worker:
            return Worker(list(each.cells), package, confine.Limits())

        return judge_submission(Submission(notebook.stem, (read,)), chosen, SEED, open_worker)


def _show(report: Report, verbose: bool) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from gpcourse.exercises.feedback import as_text
    from gpcourse.exercises.feedback.content import MARKS
    from gpcourse.exercises.feedback.words import clean

    table = Table(title=None, show_edge=False, pad_edge=False, header_style="bold")
    for heading in ("exercise", "points", "outcome", "mistake"):
        table.add_column(heading, justify="right" if heading == "points" else "left", overflow="fold")
    colours = {"passed": "green", "not attempted": "dim"}
    for judged in report.judged:
        verdict = judged.verdict
        outcome = Text(f"{MARKS[verdict.outcome][0]} {verdict.outcome}", colours.get(verdict.outcome, "red"))
        said = "; ".join([*(m.name for m in verdict.mistakes), *map(clean, judged.notes)])
        points = f"{verdict.points}/{verdict.exercise.points}"
        table.add_row(Text(verdict.exercise.name), points, outcome, Text(said))
    console = Console(highlight=False)
    console.print(table)
    console.print(f"\n{report.points} of {report.out_of} points")
    for note in report.notes:
        console.print(Text(clean(note)))
    for judged in report.judged:
        if verbose and judged.verdict.outcome not in ("passed", "not attempted"):
            click.echo("\n" + as_text(judged.verdict))


@click.command()
@click.argument("notebooks", nargs=-1, required=True, type=_FILE, metavar="NOTEBOOK...")
@click.option("--out", required=True, type=click.Path(path_type=Path), help="The folder to write into.")
@click.option("--force", is_flag=True, help="Write over files that are there; never over a NOTEBOOK itself.")
def solve(notebooks: tuple[Path, ...], out: Path, force: bool) -> None:
    """Write solved copies of notebooks: the stubs are filled from the reference."""
    from gpcourse.notebook.document import read, written
    from gpcourse.notebook.solving import solve as solved

    targets = _targets(notebooks, out, force)
    texts = [written(_solved(path, read(path), solved)) for path in notebooks]
    out.mkdir(parents=True, exist_ok=True)
    for target, text in zip(targets, texts, strict=True):
        target.write_text(text, encoding="utf-8", newline="\n")
        click.echo(target)


def _solved(path: Path, document: Document, solved: Any) -> Document:
    from gpcourse.errors import NotebookError

    try:
        return solved(document)  # type: ignore[no-any-return]
    except NotebookError as error:
        raise NotebookError(f"{path}: {error}") from None


def _targets(notebooks: Sequence[Path], out: Path, force: bool) -> list[Path]:
    """Return where the copies go, after making sure that they overwrite nothing."""
    if out.exists() and not out.is_dir():
        raise UsageError(f"{out} is a file; give a folder with --out")
    targets = [out / path.name for path in notebooks]
    inputs = {path.resolve() for path in notebooks}
    for target in targets:
        if target.resolve() in inputs:
            raise UsageError(f"{target} is one of the notebooks to solve; give another folder with --out")
        if targets.count(target) > 1:
            raise UsageError(f"two notebooks are called {target.name}; solve them into different folders")
        if target.exists() and not force:
            raise UsageError(f"{target} is there already; give another folder, or --force to write over it")
    return targets


@click.command()
@click.argument("chapter", required=False)
@click.option("--json", "as_json", is_flag=True, help="Print JSON, with the checks of each exercise.")
def exercises(chapter: str | None, as_json: bool) -> None:
    """List the exercises of the course, or of one CHAPTER (a number or a name, as 1 or halfedge)."""
    from gpcourse.exercises.course import CHAPTERS

    chosen = [c for c in CHAPTERS if chapter is None or chapter in (c.stem, str(c.number))]
    if not chosen:
        stems = ", ".join(c.stem for c in CHAPTERS)
        raise UsageError(f"there is no chapter {chapter!r}; the chapters are {stems}")
    if as_json:
        listed = [_described(c, e) for c in chosen for e in c.exercises]
        click.echo(json.dumps(listed, ensure_ascii=False, indent=1))
        return
    for each in chosen:
        click.echo(f"Chapter {each.number}, {each.title}: {each.points} points")
        width = max(len(exercise.name) for exercise in each.exercises)
        for e in each.exercises:
            click.echo(f"  {e.name:<{width}}  {e.points:>2}  {e.summary}")


def _described(chapter: Chapter, exercise: Any) -> dict[str, Any]:
    return {
        "chapter": chapter.stem,
        "name": exercise.name,
        "signature": f"{exercise.name}{exercise.signature}",
        "summary": exercise.summary,
        "notes": exercise.notes,
        "points": exercise.points,
        "hints": len(exercise.hints),
        "checks": [{"claim": c.claim, "points": c.points} for c in exercise.checks],
        "mistakes": [m.name for m in exercise.mistakes],
        "variants": [v.name for v in exercise.variants],
    }
