"""Marking one submission: the unit of work, the same in a thread, in another process, on another machine."""

from __future__ import annotations

import atexit
import platform
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

from gpcourse.errors import UsageError, WorkerError
from gpcourse.exercises.course import CHAPTERS, Chapter
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Verdict
from gpcourse.grading import gradebook, reports
from gpcourse.grading.journal import course_digest, without_answers
from gpcourse.grading.judge import Judged, Report, judge_submission
from gpcourse.grading.recall import CAPACITY, Recall
from gpcourse.grading.records import Record, decode, encode
from gpcourse.grading.submission import Notebook, Submission
from gpcourse.sandbox import confine, home
from gpcourse.sandbox.line import Line
from gpcourse.sandbox.proxy import Worker


@dataclass(frozen=True)
class Task:
    """What all submissions of a run have in common. It can be sent to another process.

    Attributes
    ----------
    stems : tuple of str
        The chapters.
    seed : int
    limits : Limits
    fonts : bool
        Whether a notebook uses Matplotlib.
    package : Path, optional
        The folder that workers import gpcourse from, where it is made already (`home.build`).
    course : str
        `course_digest` of who gives the task: whoever does it has the same checks.
    """

    stems: tuple[str, ...]
    seed: int
    limits: confine.Limits
    fonts: bool = False
    package: Path | None = None
    course: str = ""

    @property
    def chapters(self) -> tuple[Chapter, ...]:
        """The chapters, in the order of the course."""
        return tuple(chapter for chapter in CHAPTERS if chapter.stem in self.stems)

    @property
    def exercises(self) -> tuple[Exercise, ...]:
        """What is judged of a submission, in the order of the columns."""
        return tuple(exercise for chapter in self.chapters for exercise in chapter.exercises)


@dataclass(frozen=True)
class Marked:
    """A report without its questions and answers, the student's page, and what Gradescope gets."""

    report: Report
    page: str
    results: str


@contextmanager
def made_home(*, fonts: bool) -> Iterator[Path]:
    """Yield the folder that workers import gpcourse from; it is there until the block ends."""
    with tempfile.TemporaryDirectory(prefix="gpcourse-", ignore_cleanup_errors=True) as root:
        yield home.build(Path(root) / "home", fonts=fonts)


def launcher(package: Path, *, fonts: bool) -> AbstractContextManager[confine.Launch]:
    """Return what starts workers of notebooks, which use Matplotlib or not."""
    return confine.launcher(package, ("matplotlib.pyplot",) if fonts else ())


class Marker:
    """Marks submissions one by one. Use it in a ``with`` block; several threads may share it.

    `at_once` is how many threads do. `start` starts workers, where `task.package` is made already; else both
    are made.
    """

    def __init__(self, task: Task, at_once: int = 1, start: confine.Launch | None = None) -> None:
        self.task = task
        self.at_once = at_once
        self._launch = start
        self._own = threading.local()
        self._drawing = threading.Lock()
        self._stopped = threading.Event()
        self._lines: set[Line] = set()
        self._opened = ExitStack()

    def __enter__(self) -> Self:
        package = self.task.package
        if package is None:
            package = self._opened.enter_context(made_home(fonts=self.task.fonts))
        if self._launch is None:
            self._launch = self._opened.enter_context(launcher(package, fonts=self.task.fonts))
        self._package = package
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End its processes."""
        self._opened.close()

    def mark(self, submission: Submission) -> Marked:
        """Judge a submission and write its page.

        Raises
        ------
        WorkerError
            If no process can be started.
        """
        if not hasattr(self._own, "recall"):  # a memory is not made for two threads at a time
            self._own.recall = Recall(self.task.seed, CAPACITY // self.at_once)
        recall: Recall = self._own.recall
        task = self.task
        report = judge_submission(submission, task.exercises, task.seed, self._open, recall.judge)
        return self._written(replace(report, confinement=task.limits.least), recall.feedback)

    def _written(self, report: Report, feedback: Callable[[Verdict], str]) -> Marked:
        with self._drawing:  # nor is Matplotlib
            page = reports.student_page(report, self.task.chapters, feedback)
        return Marked(without_answers(report), page, gradebook.gradescope(report))

    def stop(self) -> None:
        """End what is being asked in other threads now; it is neither waited for nor asked again."""
        self._stopped.set()
        for line in tuple(self._lines):
            line.kill()

    def _open(self, notebook: Notebook) -> Worker:
        return Worker(list(notebook.cells), self._package, self.task.limits, self._start)

    def _start(self, package: Path, limits: confine.Limits) -> Line:
        self._lines.difference_update([line for line in tuple(self._lines) if line.closed])
        if self._launch is None:
            raise WorkerError("it is used outside its with block")
        line = self._launch(package, limits)
        self._lines.add(line)
        if self._stopped.is_set():  # asked after it is among them, so that no process is overlooked
            line.close()
            raise WorkerError("grading was interrupted")
        return line


def not_marked(submission: Submission, task: Task, fault: str) -> Marked:
    """Return what is written of a submission that could not be judged, through no fault of the student's."""
    judged = tuple(Judged(Verdict(exercise, "grader fault")) for exercise in task.exercises)
    report = Report(submission.student, "grader fault", judged, confinement=task.limits.least, fault=fault)
    return Marked(report, reports.student_page(report, task.chapters), gradebook.gradescope(report))


#: What crosses from another process: a report as plain data, and the texts.
Crossing = tuple[Record, str, str]

#: The markers of a process that tasks are sent to, the one that was used last at the end.
_here: dict[Task, Marker] = {}
_MOST = 4
_choosing = threading.Lock()


def mark_there(task: Task, submission: Submission) -> Crossing:
    """Mark a submission in a process to which the others of its task will be sent too.

    Raises
    ------
    UsageError
        If the course that is installed here is another one.
    WorkerError
        If no process can be started here.
    """
    if task.course != course_digest():
        raise UsageError(
            f"{platform.node()} has another gpcourse, Python, numpy, scipy or matplotlib than this machine; "
            "install the same there, and start the worker anew"
        )
    marked = _marker(task).mark(submission)
    return encode(marked.report), marked.page, marked.results


def _marker(task: Task) -> Marker:
    with _choosing:
        marker = _here.pop(task, None)
        if marker is None:
            marker = Marker(task, _MOST).__enter__()
            atexit.register(marker.close)
        _here[task] = marker
        while len(_here) > _MOST:
            _here.pop(next(iter(_here))).close()
        return marker


def received(crossing: Crossing, task: Task) -> Marked:
    """Read what `mark_there` returned."""
    record, page, results = crossing
    return Marked(decode(record, task.exercises), page, results)
