"""From a submission to its verdicts."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, replace
from functools import partial

from gpcourse.errors import WorkerError
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Verdict
from gpcourse.exercises.judging import judge as judge_here
from gpcourse.grading.recall import Recall
from gpcourse.grading.submission import Notebook, Submission
from gpcourse.sandbox.call import Trouble
from gpcourse.sandbox.lockdown import Level
from gpcourse.sandbox.proxy import Survey, Worker

#: ``open_worker(notebook)`` returns the worker that holds a notebook's functions.
OpenWorker = Callable[[Notebook], Worker]

#: ``judge(exercise, worker)`` gives the verdict on the worker's function of that name.
Judge = Callable[[Exercise, Worker], Verdict]


@dataclass(frozen=True)
class Judged:
    """An exercise's verdict in a submission, and what is to be said besides.

    `missing` says that no function of that name was found. `seconds` is how long its answers were waited for.
    """

    verdict: Verdict
    notes: tuple[str, ...] = ()
    missing: bool = False
    seconds: float = 0.0


@dataclass(frozen=True)
class Report:
    """A submission with its verdicts, in the order of the exercises.

    `status` is ``graded``; ``not attempted`` when no exercise was; ``unreadable`` when no file
    could be read, or what was read of a damaged one holds no work; ``grader fault`` when a person has
    to look, because a check of ours broke.
    `confinement` is the level (see `sandbox.lockdown`) at which its code was run.
    `fault` says what broke where no exercise can be given the blame; it is not handed out.
    """

    student: str
    status: str
    judged: tuple[Judged, ...]
    notes: tuple[str, ...] = ()
    confinement: Level = "limits"
    fault: str = ""

    @property
    def points(self) -> int:
        """The points reached."""
        return sum(judged.verdict.points for judged in self.judged)

    @property
    def out_of(self) -> int:
        """The points that can be reached."""
        return sum(judged.verdict.exercise.points for judged in self.judged)


def afresh(seed: int) -> Judge:
    """Return a judge that remembers nothing and asks one question at a time."""
    return lambda exercise, worker: judge_here(exercise, partial(worker.ask, exercise.name), seed)


def judge_submission(
    submission: Submission,
    exercises: Sequence[Exercise],
    seed: int,
    open_worker: OpenWorker,
    judge: Judge | None = None,
) -> Report:
    """Judge every exercise on what was handed in. One that breaks costs no other its points.

    `judge` is for that seed; by default it is a new `Recall`. What nobody thought of is our fault: such a
    submission gets a row that says so, and the others are graded.
    """
    try:
        return _judge_submission(submission, exercises, judge or Recall(seed).judge, open_worker)
    except WorkerError:
        raise
    except Exception as error:  # noqa: BLE001  # whatever it is, the run goes on
        judged = tuple(Judged(Verdict(exercise, "grader fault")) for exercise in exercises)
        return Report(submission.student, "grader fault", judged, fault=f"{type(error).__name__}: {error}")


def _judge_submission(
    submission: Submission, exercises: Sequence[Exercise], judge: Judge, open_worker: OpenWorker
) -> Report:
    notes = list(submission.notes)
    rooms: dict[int, _Room] = {}
    names = frozenset(exercise.name for exercise in exercises)
    judged: list[Judged] = []
    with ExitStack() as stack:
        for exercise in exercises:
            holding = submission.holding(exercise.name) or submission.notebooks
            notebook = holding[-1]
            room = rooms.get(id(notebook))
            if room is None:
                room = _Room(notebook, stack.enter_context(open_worker(notebook)), names)
                rooms[id(notebook)] = room
            result = room.judge(exercise, judge)
            if len(holding) > 1 and exercise.name in notebook.defines:
                several = f"found in {len(holding)} notebooks; {notebook.name} counts"
                result = replace(result, notes=(*result.notes, several))
            judged.append(result)
    for room in rooms.values():
        notes.extend(room.notes())
    return Report(submission.student, _status(submission, judged), tuple(judged), tuple(notes))


def _status(submission: Submission, judged: Sequence[Judged]) -> str:
    outcomes = {one.verdict.outcome for one in judged}
    if any(r.outcome == "grader fault" for one in judged for r in one.verdict.results):
        return "grader fault"
    if not submission.readable:
        return "unreadable"
    if outcomes <= {"not attempted"}:
        return "unreadable" if submission.damaged else "not attempted"  # the work may be in what is lost
    return "graded"


class _Room:
    """A notebook and its worker while the exercises are judged one after the other."""

    def __init__(self, notebook: Notebook, worker: Worker, names: frozenset[str]) -> None:
        self.notebook = notebook
        self.asked = names
        self.worker = worker
        self.failures: dict[str, None] = {}
        self.survey = self._survey()
        self.used = False

    def _survey(self) -> Survey:
        if not self.notebook.readable:
            return Survey()
        with suppress(WorkerError):
            return self.worker.survey(self.asked)
        return Survey()

    def judge(self, exercise: Exercise, judge: Judge) -> Judged:
        name = exercise.name
        if not self.notebook.readable or name in self.survey.stubs:
            return Judged(Verdict(exercise, "not attempted"))
        judged = self._judge(exercise, judge)
        if self.used and judged.verdict.outcome != "passed":
            # What another exercise did to the process is not this one's fault: ask once more in a new one.
            self.worker.renew(name)
            judged = self._judge(exercise, judge)
        if judged.verdict.outcome != "passed" and name in self.survey.unsure:
            judged = self._with_more(exercise, judge, judged)
        self.used = True
        return judged

    def _with_more(self, exercise: Exercise, judge: Judge, judged: Judged) -> Judged:
        """Ask again where all is run that the function may need; this counts if it brings points."""
        failures = dict(self.failures)
        self.worker.renew(exercise.name, most=True)
        again = self._judge(exercise, judge)
        if again.verdict.points > judged.verdict.points:
            return again
        self.failures = failures
        return judged

    def _judge(self, exercise: Exercise, judge: Judge) -> Judged:
        name = exercise.name
        with suppress(WorkerError):  # said again, as a fault of ours, when the first question is asked
            ready = self.worker.prepare(name)
            if ready.status == "missing":
                return Judged(Verdict(exercise, "not attempted"), self._near(name), missing=True)
            self.failures.update(dict.fromkeys(f"{_where(t)}: {_what(t)}" for t in ready.notes))
        before = self.worker.spent
        verdict = judge(exercise, self.worker)
        answers = (question.answer for result in verdict.results for question in result.questions)
        crash = next((a.trouble for a in answers if a.status == "crashed" and a.trouble), None)
        notes = () if crash is None else (crash.message,)
        return Judged(verdict, notes, seconds=self.worker.spent - before)

    def _near(self, name: str) -> tuple[str, ...]:
        others = set(self.survey.names) - self.asked
        near = difflib.get_close_matches(name, sorted(others), n=1, cutoff=0.7)
        return (f"is {near[0]} meant to be {name}? Only {name} counts",) if near else ()

    def notes(self) -> list[str]:
        """What is to be said of the notebook as a whole."""
        crash = self.survey.crash
        broken = [f"{t.place}, line {t.line}: {_what(t)}" for t in self.survey.broken]
        return [*([] if crash is None else [_what(crash)]), *broken, *self.failures]


def _where(trouble: Trouble) -> str:
    return f"{trouble.place}, line {trouble.line}" if trouble.line else trouble.place or "a cell"


def _what(trouble: Trouble) -> str:
    message = " ".join(trouble.message.split())[:200]
    return f"{trouble.types[0]}: {message}" if message else trouble.types[0]
