"""What a panel says, as plain data: one source for its HTML and its text."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from gpcourse.exercises.feedback.advice import advice
from gpcourse.exercises.feedback.words import clean, sentence, without_paths, written_call
from gpcourse.exercises.judging import CheckResult, Outcome, Question, Verdict
from gpcourse.sandbox.call import Trouble

if TYPE_CHECKING:
    from gpcourse.view.scene import Scene

#: A mark and a word for each outcome of a check.
MARKS: dict[Outcome, tuple[str, str]] = {
    "passed": ("✓", "passed"),
    "failed": ("✗", "failed"),
    "error": ("✗", "error"),
    "timeout": ("✗", "no end"),
    "crashed": ("✗", "crashed"),
    "out of memory": ("✗", "memory"),
    "not attempted": ("–", "open"),
    "grader fault": ("?", "our fault"),
}

_HAPPENED: dict[Outcome, str] = {
    "timeout": "The function did not come to an end within {limit:g} s: a loop in it does not end, "
    "or takes far too long.",
    "crashed": "The function ended the Python process that it ran in.",
    "out of memory": "The function asked for more memory than there is. How large are its arrays?",
    "grader fault": "This check broke while it looked at your answer. This is our fault, no point is lost. "
    "Please report it with the details below.",
}
#: What to do about it on one's own machine, and on a page that is handed out.
_FOR_US = ("Please report it with the details below.", "A person will look at it.")


@dataclass(frozen=True)
class Row:
    """One check: mark, word, claim, points reached, points to reach."""

    outcome: Outcome
    mark: str
    word: str
    claim: str
    points: int
    of: int


@dataclass(frozen=True)
class Problem:
    """The first check that did not pass, explained.

    `facts` are pairs of a label and a value in code; `legend` describes the arguments of the call
    that are too large to be written; `again` runs the call again in a notebook; `where` and `source` are
    the student's own line.
    """

    claim: str
    message: str
    facts: tuple[tuple[str, str], ...] = ()
    legend: tuple[str, ...] = ()
    again: str = ""
    where: str = ""
    source: str = ""
    advice: str = ""
    mistake: str = ""
    hint: str = ""
    fault: str = ""
    picture: Callable[[], Scene] | None = None


@dataclass(frozen=True)
class Content:
    """All that a panel says."""

    name: str
    summary: str
    outcome: Outcome
    headline: str
    points: int
    of: int
    rows: tuple[Row, ...] = ()
    problem: Problem | None = None
    notes: tuple[str, ...] = ()


def content(verdict: Verdict, *, answers: bool = True) -> Content:
    """Put a verdict into words; without `answers`, what is true is neither written nor drawn, nor a path."""
    exercise = verdict.exercise
    shown = () if verdict.outcome == "not attempted" else verdict.results
    problem = verdict.first_problem if shown else None
    return Content(
        name=exercise.name,
        summary=exercise.summary,
        outcome=verdict.outcome,
        headline=_headline(verdict) if answers else _headline(verdict).replace(*_FOR_US),
        points=verdict.points,
        of=exercise.points,
        rows=tuple(_row(result) for result in shown),
        problem=None if problem is None else _problem(verdict, problem, answers),
        notes=tuple(_notes(verdict, problem)),
    )


def _headline(verdict: Verdict) -> str:
    total, passed = len(verdict.results), sum(r.outcome == "passed" for r in verdict.results)
    if verdict.outcome == "not attempted":
        return "Not attempted yet: replace `raise NotImplementedError` by your own code, then check again."
    if verdict.outcome == "passed":
        return "Right: the check passes." if total == 1 else f"Right: all {total} checks pass."
    if not total:
        return sentence(
            _HAPPENED.get(verdict.outcome, "Your code could not be run.").format(
                limit=verdict.exercise.time_limit
            )
        )
    if all(r.outcome in ("passed", "grader fault") for r in verdict.results):
        return f"{passed} of {total} checks pass; the rest could not be decided, by our fault."
    return f"Not yet: {passed} of {total} checks pass." if passed else "Not yet: no check passes so far."


def _row(result: CheckResult) -> Row:
    mark, word = MARKS[result.outcome]
    return Row(result.outcome, mark, word, result.check.claim, result.points, result.check.points)


def _problem(verdict: Verdict, result: CheckResult, answers: bool) -> Problem:
    exercise, wrong, trouble = verdict.exercise, result.wrong, result.trouble
    facts, legend = _facts(verdict, result, answers)
    message = _HAPPENED.get(result.outcome, "").format(limit=exercise.time_limit)
    if wrong is not None:
        message = sentence(clean(wrong.told if answers else wrong.message))
    elif result.outcome == "error" and trouble is not None:
        text = clean(trouble.message, 300)
        message = f"Your code stopped with {trouble.types[0]}" + (f": {text}" if text else ".")
    known = result.mistake
    problem = Problem(
        claim=result.check.claim,
        message=message,
        facts=facts,
        legend=legend,
        again=_again(exercise.name, result.question) if legend else "",
        where=_where(trouble),
        source=clean(trouble.source, 160) if trouble else "",
        advice=advice(exercise, trouble) if trouble and result.outcome == "error" and not known else "",
        mistake=f"It looks as if {known.name}." if known else "",
        hint=known.hint if known else "",
        fault=clean(result.fault, 6000),
        picture=None if wrong is None else wrong.picture if answers else wrong.handout,
    )
    return problem if answers else _handed_out(problem)


def _handed_out(problem: Problem) -> Problem:
    """Leave out what is the grader's: its paths, and where a check of ours broke."""
    return replace(
        problem,
        message=without_paths(problem.message).replace(*_FOR_US),
        facts=tuple((k, without_paths(v) if k == "yours" else v) for k, v in problem.facts),
        where=without_paths(problem.where),
        advice=without_paths(problem.advice),
        fault="",
    )


def _facts(
    verdict: Verdict, result: CheckResult, answers: bool
) -> tuple[tuple[tuple[str, str], ...], tuple[str, ...]]:
    facts: list[tuple[str, str]] = []
    legend: list[str] = []
    if result.wrong is not None:
        wrong = result.wrong
        truth = wrong.truth if answers else ""
        facts = [("yours", wrong.yours), ("true", truth), ("input", wrong.on)]
        facts = [(label, clean(value, 400)) for label, value in facts if value]
    if result.question is not None:
        parameters = list(verdict.exercise.signature.parameters)
        question = result.question
        call, legend = written_call(verdict.exercise.name, parameters, question.arguments, question.options)
        facts.append(("call", clean(call, 600)))
    return tuple(facts), tuple(clean(line, 200) for line in legend)


def _again(name: str, question: Question | None) -> str:
    """Write a call of the function with what it was asked in its first failing check."""
    if question is not None and question.options:
        return f"panel = check({name}); {name}(*panel.arguments, **panel.options)"
    return f"{name}(*check({name}).arguments)"


def _where(trouble: Trouble | None) -> str:
    """Say where it happened, as "line 3 of cell 7"."""
    if trouble is None or not trouble.line:
        return ""
    line = f"line {trouble.line}" + (f" of {clean(trouble.place, 80)}" if trouble.place else "")
    return line + (f", in `{clean(trouble.function, 60)}`" if trouble.function.isidentifier() else "")


def _notes(verdict: Verdict, problem: CheckResult | None) -> list[str]:
    notes = []
    if verdict.changed:
        names = ", ".join(f"`{clean(name, 40)}`" for name in verdict.changed)
        notes.append(
            f"Your function changes its input in place: {names}. Whoever calls it loses the original. "
            "Work on a copy."
        )
    shown = problem.mistake if problem else None
    others = [m for m in verdict.mistakes if shown is None or m.name != shown.name]
    notes.extend(f"In another check, it looks as if {m.name}. {m.hint}" for m in others[:2])
    return notes
