"""Grading a folder of submissions."""

from __future__ import annotations

import os
import tempfile
import threading
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from pathlib import Path

from gpcourse.errors import UsageError, WorkerError
from gpcourse.exercises.course import CHAPTERS, Chapter
from gpcourse.exercises.exercise import Exercise
from gpcourse.grading import gradebook, reports
from gpcourse.grading.judge import Report, judge_submission
from gpcourse.grading.junit import junit as junit_xml
from gpcourse.grading.submission import Notebook, Owner, Submission, read_class
from gpcourse.sandbox import confine, home
from gpcourse.sandbox.line import Line
from gpcourse.sandbox.lockdown import Level
from gpcourse.sandbox.proxy import Worker

#: ``progress(done, total, student)`` is called after each submission, in no fixed order.
Progress = Callable[[int, int, str], object]


@dataclass(frozen=True)
class GradeBook:
    """What came of grading a folder.

    Attributes
    ----------
    reports : tuple of Report
        One a student, sorted by name; the questions and answers are left out.
    chapters, exercises
        What was graded, in the order of the columns.
    seed : int
    confinement : Level
        The level at which student code was run.
    out, table, page : Path
        The folder that was written, its grades.csv and its index.html.
    owners, timestamps : mapping
        By student: whose the submission is by the names of the files; when nbgrader collected it.
    """

    reports: tuple[Report, ...]
    chapters: tuple[Chapter, ...]
    exercises: tuple[Exercise, ...]
    seed: int
    out: Path
    confinement: Level
    owners: Mapping[str, Owner] = field(default_factory=dict)
    timestamps: Mapping[str, str] = field(default_factory=dict)

    @property
    def table(self) -> Path:
        """The table of grades."""
        return self.out / "grades.csv"

    @property
    def page(self) -> Path:
        """The page of the class."""
        return self.out / "index.html"


def grade(
    folder: str | Path,
    out: str | Path,
    *,
    seed: int = 0,
    chapters: Sequence[str] | None = None,
    jobs: int | None = None,
    limits: confine.Limits | None = None,
    allow_unconfined: bool = False,
    junit: bool = False,
    progress: Progress | None = None,
) -> GradeBook:
    """Grade the submissions in `folder` and write the grade book into `out`.

    Writes ``grades.csv``, ``times.csv``, ``index.html``, ``students/NAME.html`` and
    ``gradescope/NAME/results.json``. The same submissions and seed give the same files, to the byte, but for
    the times. Nothing is written when the input cannot be used.

    Parameters
    ----------
    folder, out : path
        The submissions, as `submission.read_class` takes them; and where the grade book goes, outside
        `folder`.
    seed : int
        Decides the inputs that the checks draw; 0 or more.
    chapters : sequence of str, optional
        Numbers or stems ("1", "halfedge"); by default those of which a submission has a function.
    jobs : int, optional
        Submissions at a time; by default the number of cores.
    limits : Limits, optional
        What a notebook may use.
    allow_unconfined : bool
        Grade also where student code cannot be confined at the level ``restricted``. Only for work
        that you trust.
    junit : bool
        Write ``junit.xml`` too.
    progress : callable, optional
        Called as ``progress(done, total, student)`` after each submission.

    Raises
    ------
    UsageError
        If there are no submissions, another argument cannot be used, or this machine cannot confine.
    WorkerError
        If no process can be started.
    """
    folder, out = Path(folder), Path(out)
    if seed < 0:
        raise UsageError(f"the seed is {seed}; give a whole number that is not negative")
    submissions = read_class(folder)
    _check_out(folder, out)
    chosen = (
        chapters_called(chapters)
        if chapters
        else chapters_in([n for s in submissions for n in s.notebooks]) or CHAPTERS
    )
    exercises = tuple(exercise for chapter in chosen for exercise in chapter.exercises)
    names = gradebook.file_names(s.student for s in submissions)
    limits = _confined(limits or confine.Limits(), allow_unconfined)
    done: dict[str, Report] = {}
    with closing(_judge_all(submissions, exercises, seed, jobs, limits)) as judged:
        for each in judged:
            report = replace(each, confinement=limits.least)
            stem = names[report.student]
            gradebook.write(out / "students" / f"{stem}.html", reports.student_page(report, chosen, seed))
            gradebook.write(out / "gradescope" / stem / "results.json", gradebook.gradescope(report))
            done[report.student] = _slim(report)
            if progress is not None:
                progress(len(done), len(submissions), report.student)
    book = GradeBook(
        tuple(done[s.student] for s in submissions),
        chosen,
        exercises,
        seed,
        out,
        limits.least,
        {s.student: s.owner for s in submissions},
        {s.student: s.timestamp for s in submissions},
    )
    gradebook.write(book.table, gradebook.grades_csv(book.reports, exercises))
    gradebook.write(out / "times.csv", gradebook.times_csv(book.reports, exercises))
    if junit:
        gradebook.write(out / "junit.xml", junit_xml(book.reports))
    gradebook.write(book.page, reports.class_page(book.reports, chosen, exercises, seed, names))
    return book


def _confined(limits: confine.Limits, allow_unconfined: bool) -> confine.Limits:
    """Return limits that ask every worker for the level that this machine reaches, found by trying."""
    here = confine.level_here()
    if not (allow_unconfined or here.reaches("restricted")):
        raise UsageError(
            f"student code cannot be confined here: this machine reaches the level {here.level!r}, below "
            f"'restricted', for want of {'; '.join(here.missing)}. Grade on Linux 5.13 or newer; or, if you "
            "trust whoever wrote the submissions, give --allow-unconfined"
        )
    return replace(limits, least=here.level)


def _check_out(folder: Path, out: Path) -> None:
    if out.exists() and not out.is_dir():
        raise UsageError(f"{out} is a file; give a folder for the grade book")
    if out.resolve().is_relative_to(folder.resolve()):
        raise UsageError(f"{out} lies in the folder of submissions; put the grade book beside it")
    if not os.access(next(p for p in (out, *out.resolve().parents) if p.exists()), os.W_OK):
        raise UsageError(f"{out} cannot be written to; choose another folder")


def chapters_called(chapters: Sequence[str]) -> tuple[Chapter, ...]:
    """Return the chapters with these numbers or stems, in the order of the course."""
    table = {str(chapter.number): chapter for chapter in CHAPTERS} | {c.stem: c for c in CHAPTERS}
    for name in chapters:
        if name not in table:
            raise UsageError(
                f"there is no chapter {name!r}; the chapters are {', '.join(c.stem for c in CHAPTERS)}"
            )
    wanted = {table[name].number for name in chapters}
    return tuple(chapter for chapter in CHAPTERS if chapter.number in wanted)


def chapters_in(notebooks: Sequence[Notebook]) -> tuple[Chapter, ...]:
    """Return the chapters that notebooks hold exercises of; none when nothing can be told.

    A variable may be called like an exercise of another chapter (cube = …): functions decide, if any.
    """
    for names in (
        {name for notebook in notebooks for name in notebook.functions},
        {name for notebook in notebooks for name in notebook.defines},
    ):
        found = tuple(c for c in CHAPTERS if any(exercise.name in names for exercise in c.exercises))
        if found:
            return found
    return ()


def _judge_all(
    submissions: Sequence[Submission],
    exercises: Sequence[Exercise],
    seed: int,
    jobs: int | None,
    limits: confine.Limits,
) -> Generator[Report, None, None]:
    """Yield the reports as they are done. The work is in the workers, so threads are enough here."""
    fonts = any("matplotlib" in text for s in submissions for n in s.notebooks for _, text in n.cells)
    stopped = threading.Event()
    lines: list[Line] = []

    def start(package: Path, limits: confine.Limits) -> Line:
        line = launch(package, limits)
        lines.append(line)
        if stopped.is_set():  # asked after it is in the list, so that no process is overlooked
            line.close()
            raise WorkerError("grading was interrupted")
        return line

    with (
        tempfile.TemporaryDirectory(prefix="gpcourse-", ignore_cleanup_errors=True) as root,
        ExitStack() as opened,
    ):
        package = home.build(Path(root) / "home", fonts=fonts)
        launch = opened.enter_context(confine.launcher(package, ("matplotlib.pyplot",) if fonts else ()))

        def open_worker(notebook: Notebook) -> Worker:
            return Worker(list(notebook.cells), package, limits, start)

        with ThreadPoolExecutor(jobs or os.cpu_count() or 1) as pool:
            futures: list[Future[Report]] = [
                pool.submit(judge_submission, s, exercises, seed, open_worker) for s in submissions
            ]
            try:
                for future in as_completed(futures):
                    yield future.result()
            except BaseException:
                stopped.set()  # Ctrl-C: what is being asked now is not waited for, nor asked again
                for line in lines:
                    line.kill()
                pool.shutdown(wait=False, cancel_futures=True)
                raise


def _slim(report: Report) -> Report:
    """Drop the questions and answers, so that memory stays flat over a large class."""
    judged = []
    for one in report.judged:
        results = tuple(replace(result, questions=()) for result in one.verdict.results)
        judged.append(replace(one, verdict=replace(one.verdict, results=results)))
    return replace(report, judged=tuple(judged))
