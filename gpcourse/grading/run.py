"""Grading a folder of submissions."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path

from gpcourse.errors import UsageError
from gpcourse.exercises.course import CHAPTERS, Chapter
from gpcourse.exercises.exercise import Exercise
from gpcourse.grading import gradebook, reports
from gpcourse.grading.cluster import Cluster
from gpcourse.grading.crews import Here, Marks
from gpcourse.grading.journal import Journal, conditions, course_digest, files_of, locked, writing
from gpcourse.grading.judge import Report
from gpcourse.grading.junit import junit as junit_xml
from gpcourse.grading.marking import Task
from gpcourse.grading.submission import Notebook, Owner, Submission, read_class
from gpcourse.sandbox import confine
from gpcourse.sandbox.lockdown import Confinement, Level

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
    resumed : int
        How many submissions an earlier run had graded, which this one went on with.
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
    resumed: int = 0
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
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> GradeBook:
    """Grade the submissions in `folder` and write the grade book into `out`.

    Writes ``grades.csv``, ``times.csv``, ``index.html``, ``students/NAME.html`` and
    ``gradescope/NAME/results.json``. The same submissions and seed give the same files, to the byte, but for
    the times. Nothing is written when the input cannot be used.

    ``journal.jsonl`` notes each submission that is done. Interrupted at any moment, the same call goes on
    where it stopped; so it does when some were handed in anew. Where the course, the seed or a limit is
    another one, all are graded again.

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
        Submissions at a time on this machine; by default the number of cores. For more than
        `crews.THREADS` of a large class processes are started: a script then needs the usual guard,
        ``if __name__ == "__main__":``.
    limits : Limits, optional
        What a notebook may use.
    allow_unconfined : bool
        Grade also where student code cannot be confined at the level ``restricted``. Only for work
        that you trust.
    junit : bool
        Write ``junit.xml`` too.
    scheduler : str, optional
        The address of a Dask scheduler whose workers do the marking, as ``tcp://10.0.0.5:8786``.
    progress : callable, optional
        Called as ``progress(done, total, student)`` after each submission, and first with no student if an
        earlier run had graded some.

    Raises
    ------
    UsageError
        If there are no submissions, another argument cannot be used, this machine cannot confine, another
        run is grading into `out`, the disk is full, or the scheduler is gone.
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
    limits = limits or confine.Limits()
    fonts = any("matplotlib" in text for s in submissions for n in s.notebooks for _, text in n.cells)
    with Cluster(scheduler) if scheduler else Here(jobs or os.cpu_count() or 1, fonts=fonts) as crew:
        limits = _confined(limits, crew.confinement(), allow_unconfined)
        task = Task(tuple(c.stem for c in chosen), seed, limits, fonts, course=course_digest())
        with locked(out):
            return _Run(submissions, task, out, crew.mark, progress or (lambda *_: None)).finish(junit=junit)


@dataclass
class _Run:
    """One run over a class, within the lock on its folder."""

    submissions: Sequence[Submission]
    task: Task
    out: Path
    mark: Callable[[Task, Sequence[Submission]], Marks]
    progress: Progress

    def __post_init__(self) -> None:
        self.stems = gradebook.file_names(s.student for s in self.submissions)
        self.exercises = self.task.exercises
        self.done: dict[str, Report] = {}

    def finish(self, *, junit: bool) -> GradeBook:
        """Grade what is not done yet, and write the grade book."""
        with Journal(self.out, conditions(self.exercises, self.task.seed, self.task.limits)) as journal:
            for submission in self.submissions:
                if report := journal.recall(submission, self.stems[submission.student], self.exercises):
                    self.done[submission.student] = report
            resumed = len(self.done)
            if resumed:
                self.progress(resumed, len(self.submissions), "")
            if left := [s for s in self.submissions if s.student not in self.done]:
                self._grade(left, journal)
        with writing(self.out):
            return self._write_book(resumed, junit=junit)

    def _grade(self, left: Sequence[Submission], journal: Journal) -> None:
        by_name = {submission.student: submission for submission in left}
        with closing(self.mark(self.task, left)) as marked:
            for each in marked:
                stem = self.stems[each.report.student]
                with writing(self.out):
                    for path, text in zip(files_of(self.out, stem), (each.page, each.results), strict=True):
                        gradebook.write(path, text)
                journal.write(by_name[each.report.student], stem, each.report)
                self.done[each.report.student] = each.report
                self.progress(len(self.done), len(self.submissions), each.report.student)

    def _write_book(self, resumed: int, *, junit: bool) -> GradeBook:
        everyone = tuple(self.done[s.student] for s in self.submissions)
        book = GradeBook(
            everyone,
            self.task.chapters,
            self.exercises,
            self.task.seed,
            self.out,
            self.task.limits.least,
            resumed,
            {s.student: s.owner for s in self.submissions},
            {s.student: s.timestamp for s in self.submissions},
        )
        gradebook.write(book.table, gradebook.grades_csv(everyone, self.exercises))
        gradebook.write(self.out / "times.csv", gradebook.times_csv(everyone, self.exercises))
        if junit:
            gradebook.write(self.out / "junit.xml", junit_xml(everyone))
        page = reports.class_page(everyone, self.task.chapters, self.exercises, self.task.seed, self.stems)
        gradebook.write(book.page, page)
        return book


def _confined(limits: confine.Limits, reached: Confinement, allow_unconfined: bool) -> confine.Limits:
    """Return limits that ask every worker for the level that was reached, found by trying."""
    if not (allow_unconfined or reached.reaches("restricted")):
        raise UsageError(
            f"student code cannot be confined here: this machine reaches the level {reached.level!r}, below "
            f"'restricted', for want of {'; '.join(reached.missing)}. Grade on Linux 5.13 or newer; or, if "
            "you trust whoever wrote the submissions, give --allow-unconfined"
        )
    return replace(limits, least=reached.level)


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
