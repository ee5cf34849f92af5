"""Checking a student's function where it was written."""

from __future__ import annotations

import copy
import io
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from typing import Any, TextIO

from gpcourse.exercises.feedback import as_html, as_text
from gpcourse.exercises.judging import Question, Verdict, ask_here, judge
from gpcourse.notebook.asked import Interrupted, Misuse, exercise_of, name_of
from gpcourse.notebook.fingerprint import fingerprint
from gpcourse.notebook.store import Record, store

#: The inputs of a notebook's checks are the same each time, so that a failure can be looked into.
SEED = 0

#: A function is called many times in a check. This many characters of what it prints are shown.
PRINTED = 4000


class Panel:
    """What `check` says. A notebook shows it as a panel, ``print`` as text.

    Attributes
    ----------
    verdict : Verdict
        The outcome, check by check.
    arguments, options : tuple, dict
        What the function was called with where the first check went wrong, by position and by name:
        ``f(*panel.arguments, **panel.options)`` runs that call again. Empty if all checks pass.
    """

    def __init__(self, verdict: Verdict) -> None:
        self.verdict = verdict

    @property
    def arguments(self) -> tuple[Any, ...]:
        return () if self._question is None else copy.deepcopy(self._question.arguments)

    @property
    def options(self) -> dict[str, Any]:
        return {} if self._question is None else copy.deepcopy(self._question.options)

    @property
    def _question(self) -> Question | None:
        problem = self.verdict.first_problem
        return None if problem is None else problem.question

    def _repr_html_(self) -> str:
        return as_html(self.verdict, rerun=True)

    def __repr__(self) -> str:
        return as_text(self.verdict)


def check(function: Callable[..., Any]) -> Panel:
    """Check your solution of an exercise, and say what is right and what is not yet.

    Parameters
    ----------
    function : callable
        Your function, as ``check(genus)``. Its name says which exercise it solves.

    Returns
    -------
    Panel
        Shown by the notebook if it is the last line of a cell.

    Raises
    ------
    Misuse
        If `function` is no function, or no exercise has its name.
    """
    name_of(function, "check") if not isinstance(function, str) else _refuse_text(function)
    exercise = exercise_of(function, "check")
    try:
        with _capped_output():
            verdict = judge(exercise, ask_here(function), SEED)
    except KeyboardInterrupt:
        raise Interrupted(f"check({exercise.name}) was interrupted.") from None
    if verdict.outcome != "not attempted":
        record = Record(verdict.outcome, verdict.points, exercise.points, fingerprint(function))
        store().put(exercise.name, record)
    return Panel(verdict)


def _refuse_text(text: str) -> None:
    name = text if text.isidentifier() else "f"
    raise Misuse(f"check needs the function itself: write check({name}), without quotation marks.")


class _Capped(io.TextIOBase):
    """Passes text on until the budget is spent."""

    def __init__(self, target: TextIO, budget: int) -> None:
        self.target = target
        self.budget = budget

    def write(self, text: str) -> int:
        if self.budget > 0:
            self.target.write(text[: self.budget])
            self.budget -= len(text)
            if self.budget <= 0:
                self.target.write("\n… what your function printed after this is left out.\n")
        return len(text)

    def flush(self) -> None:
        self.target.flush()


@contextmanager
def _capped_output() -> Iterator[None]:
    out, err = _Capped(sys.stdout, PRINTED), _Capped(sys.stderr, PRINTED)
    with redirect_stdout(out), redirect_stderr(err):
        yield
