"""Asking a student's function the questions of an exercise, and the verdict on its answers.

A check sees a callable. Here it is `Asked`, which puts every question to `ask`: in a notebook that
calls the student's function, in grading it sends the question to another process. The verdict is
the same.
"""

from __future__ import annotations

import builtins
import traceback
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Any, Literal, TypeVar

import numpy as np

from gpcourse.exercises.exercise import Check, Exercise, Mistake
from gpcourse.exercises.expect import Wrong
from gpcourse.sandbox.call import Answer, Trouble, call
from gpcourse.sandbox.values import same

Outcome = Literal[
    "passed", "failed", "error", "timeout", "crashed", "out of memory", "not attempted", "grader fault"
]

Value = TypeVar("Value")

#: ``ask(arguments, options, limit)`` puts one question to the student's function.
Ask = Callable[[tuple[Any, ...], dict[str, Any], float], Answer]

#: Once a call has run into its time limit, the later ones get this many seconds.
IMPATIENT = 0.5

#: Numbers of a student and of a mistake agree within this, relative to the largest.
#: Two ways to sum the same terms differ by about 1e-15 a term; a wrong factor by far more than 1e-8.
AGREE = 1e-8

_OUTCOMES: dict[str, Outcome] = {
    "raised": "error", "timeout": "timeout", "crashed": "crashed", "out of memory": "out of memory",
}  # fmt: skip


class NoAnswer(Exception):
    """Raised inside a check when a call did not return."""

    def __init__(self, answer: Answer) -> None:
        super().__init__(answer.status)
        self.answer = answer


@dataclass(frozen=True)
class Question:
    """One call, with its arguments by position and its options by name, and what came of it."""

    arguments: tuple[Any, ...]
    options: dict[str, Any]
    answer: Answer


@dataclass
class Asked:
    """The callable that a check sees. Calling it returns the student's value, or raises `NoAnswer`.

    A check that asks several questions before it judges looks at their answers with `each`, or sets `about`
    to the number of the one that it looks at; otherwise the last question is the one that went wrong.
    """

    exercise: Exercise
    ask: Ask
    limit: float
    questions: list[Question] = field(default_factory=list)
    about: int = -1

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        answer = self.answer(*arguments, **options)
        if answer.status != "returned":
            raise NoAnswer(answer)
        return answer.value

    def each(self, answers: Sequence[Value]) -> Iterator[Value]:
        """Yield the answers to the last questions, one after the other, to be looked at."""
        first = len(self.questions) - len(answers)
        for self.about, value in enumerate(answers, first):
            yield value
        self.about = -1

    def answer(self, *arguments: Any, **options: Any) -> Answer:
        """Ask, and return all that came of it: for checks that expect an exception."""
        answer = self.ask(arguments, options, self.limit)
        self.questions.append(Question(arguments, options, answer))
        if answer.status == "timeout":
            self.limit = min(self.limit, IMPATIENT)
        if answer.status not in ("returned", "raised") or stub(self.exercise, answer):
            raise NoAnswer(answer)
        return answer


@dataclass(frozen=True)
class CheckResult:
    """How one check went.

    `wrong` is set when the outcome is ``failed``, `trouble` when student code did not return, `fault`
    (our traceback) when the check itself broke. `questions` are those of this check, and the one with
    the number `about` is the one that went wrong.
    """

    check: Check
    outcome: Outcome
    wrong: Wrong | None = None
    trouble: Trouble | None = None
    fault: str = ""
    mistake: Mistake | None = None
    questions: tuple[Question, ...] = ()
    about: int = -1

    @property
    def question(self) -> Question | None:
        """The question that went wrong."""
        return self.questions[self.about] if self.questions else None

    @property
    def points(self) -> int:
        """The points of the check where it passed, else 0."""
        return self.check.points if self.outcome == "passed" else 0


@dataclass(frozen=True, eq=False)
class Verdict:
    """How one exercise went. Two are the same only if they are one object."""

    exercise: Exercise
    outcome: Outcome
    results: tuple[CheckResult, ...] = ()
    changed: tuple[str, ...] = ()

    @property
    def points(self) -> int:
        """The points reached."""
        return sum(result.points for result in self.results)

    @property
    def mistakes(self) -> tuple[Mistake, ...]:
        """The mistakes that were recognised, each once, in the order in which the checks met them."""
        named = {r.mistake.name: r.mistake for r in self.results if r.mistake is not None}
        return tuple(named.values())

    @property
    def first_problem(self) -> CheckResult | None:
        """The first check that did not pass."""
        return next((r for r in self.results if r.outcome != "passed"), None)


def judge(exercise: Exercise, ask: Ask, seed: int) -> Verdict:
    """Run every check of `exercise` and say how it went.

    The inputs of a check depend on the seed, the exercise and the claim only, not on the other
    checks. A stub is recognised at its first answer, and the other checks are then not run.
    """
    results: list[CheckResult] = []
    limit = exercise.time_limit
    for check in exercise.checks:
        asked = Asked(exercise, ask, limit)
        result = run_check(check, asked, seed)
        limit = asked.limit
        if result.outcome == "not attempted":
            return Verdict(exercise, "not attempted")
        results.append(result)
    return conclude(exercise, results, Ours(exercise, seed))


def conclude(exercise: Exercise, results: list[CheckResult], ours: Ours) -> Verdict:
    """Put the results of all checks of an exercise together, and name the mistakes."""
    results = name_mistakes(exercise, results, ours)
    first: Outcome = next((r.outcome for r in results if r.outcome != "passed"), "passed")
    changed = {name: None for r in results for q in r.questions for name in q.answer.changed}
    return Verdict(exercise, first, tuple(results), tuple(changed))


def ask_here(function: Callable[..., Any]) -> Ask:
    """Return an `Ask` that calls `function` in this process."""
    return lambda arguments, options, limit: call(function, arguments, limit, options=options)


def stub(exercise: Exercise, answer: Answer) -> bool:
    """Tell whether the answer is that of an exercise's own stub, not of one that it calls."""
    trouble = answer.trouble
    return (
        trouble is not None
        and "NotImplementedError" in trouble.types
        and trouble.function in ("", exercise.name)
    )


def generator(exercise: Exercise, check: Check, seed: int) -> np.random.Generator:
    """Return the generator that draws the inputs of a check."""
    return np.random.default_rng([seed, zlib.crc32(f"{exercise.name}: {check.claim}".encode())])


def run_check(check: Check, asked: Asked, seed: int) -> CheckResult:
    """Run one check on a function, and say how it went."""
    try:
        check.run(asked, generator(asked.exercise, check, seed))
    except Wrong as wrong:
        return CheckResult(check, "failed", wrong=wrong, questions=tuple(asked.questions), about=asked.about)
    except NoAnswer as no_answer:
        answer = no_answer.answer
        outcome: Outcome = "not attempted" if stub(asked.exercise, answer) else _OUTCOMES[answer.status]
        return CheckResult(check, outcome, trouble=answer.trouble, questions=tuple(asked.questions))
    except Exception:  # noqa: BLE001  # whatever else goes wrong here is our fault, and must cost nobody a grade book
        return CheckResult(
            check, "grader fault", fault=traceback.format_exc(), questions=tuple(asked.questions)
        )
    return CheckResult(check, "passed", questions=tuple(asked.questions))


class Ours:
    """What the reference of an exercise, which has the number 0, and its mistakes, from 1 on, answer."""

    def __init__(self, exercise: Exercise, seed: int) -> None:
        self.exercise = exercise
        self.seed = seed
        self.functions = [exercise.reference, *(mistake.function for mistake in exercise.mistakes)]

    def answer(self, m: int, question: Question) -> Answer:
        """Return what solution `m` answers to a question."""
        return self._call(m, question.arguments, question.options, self.exercise.time_limit)

    def passes(self, m: int, check: Check) -> bool:
        """Tell whether solution `m` passes a check."""
        asked = Asked(self.exercise, partial(self._call, m), self.exercise.time_limit)
        return run_check(check, asked, self.seed).outcome == "passed"

    def _call(self, m: int, arguments: tuple[Any, ...], options: dict[str, Any], limit: float) -> Answer:
        # Processor time where that can be had: a loaded machine must not change which mistake is named.
        wall = 10 * (limit + 1)
        with np.errstate(all="ignore" if m else None):  # a wrong formula may well divide by zero
            return call(self.functions[m], arguments, limit, wall, options=options, ours=True)


def name_mistakes(exercise: Exercise, results: list[CheckResult], ours: Ours) -> list[CheckResult]:
    """Give each failed check the known mistake that explains it, where there is one.

    A mistake explains a check when it answers every question of that check as the student did, one of
    them otherwise than the reference, and would pass the checks that the student passed. If several do, the
    one that explains most of the other checks too is named.
    """

    @cache
    def answer(m: int, r: int, q: int) -> Answer:
        return ours.answer(m, results[r].questions[q])

    def alike(a: Answer, b: Answer, r: int, q: int) -> bool:
        return _alike(exercise, results[r].questions[q].arguments, a, b)

    @cache
    def agrees(m: int, r: int) -> bool:
        # Bad input that was not refused: what is returned for it means nothing.
        return all(
            alike(theirs := question.answer, mine := answer(m, r, q), r, q)
            or (theirs.status == mine.status == "returned" and answer(0, r, q).status == "raised")
            for q, question in enumerate(results[r].questions)
        )

    def errs(m: int, r: int) -> bool:
        return any(
            not alike(answer(m, r, q), answer(0, r, q), r, q) for q in range(len(results[r].questions))
        )

    @cache
    def spoils(m: int, r: int) -> bool:
        # Two right answers may differ, as those for points on a line: the check decides.
        return not agrees(m, r) and not ours.passes(m, results[r].check)

    passed = [r for r, result in enumerate(results) if result.outcome == "passed"]
    named = list(results)
    for i, result in enumerate(results):
        if result.outcome in ("passed", "grader fault") or not result.questions:
            continue
        found = [
            m
            for m in range(1, len(ours.functions))
            if agrees(m, i) and errs(m, i) and not any(spoils(m, r) for r in passed)
        ]
        if len(found) > 1:
            found.sort(key=lambda m: -sum(agrees(m, r) for r in range(len(results))))
        if found:
            named[i] = replace(result, mistake=exercise.mistakes[found[0] - 1])
    return named


def _alike(exercise: Exercise, arguments: tuple[Any, ...], a: Answer, b: Answer) -> bool:
    """Tell whether two answers to one question are the same."""
    if a.status != b.status:
        return False
    if a.status == "raised":
        return _builtin(a.trouble) == _builtin(b.trouble)
    if a.status != "returned":
        return True
    try:
        return same(exercise.canonical(arguments, a.value), exercise.canonical(arguments, b.value), AGREE)
    except Exception:  # noqa: BLE001  # a student's value of any kind may not fit the canonical form
        return False


def _builtin(trouble: Trouble | None) -> str:
    """Return the nearest builtin class of an exception: a class of one's own is as good as its base."""
    types = trouble.types if trouble is not None else ()
    return next((name for name in types if hasattr(builtins, name)), "")
