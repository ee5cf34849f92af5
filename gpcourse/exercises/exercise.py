"""An exercise is one object that holds all that is known of it.

The reference gives the name, the signature and the docstring of the stub. The checks say
what is true of a right answer. The variants are other right solutions. The mistakes are wrong
solutions that students write: they show that the checks have teeth, and feedback compares a
student's answers with theirs to name what went wrong.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gpcourse.errors import ExerciseError
from gpcourse.sandbox.deadline import TimeLimit

if TYPE_CHECKING:
    import numpy as np

    from gpcourse.exercises.judging import Asked

CheckFunction = Callable[["Asked", "np.random.Generator"], None]
Solution = Callable[..., Any]


@dataclass(frozen=True)
class Check:
    """One claim about a right solution, and the points it is worth.

    ``run(f, rng)`` asks the function questions and raises `expect.Wrong` where an answer is not right.
    """

    claim: str
    points: int
    run: CheckFunction


@dataclass(frozen=True)
class Mistake:
    """A wrong solution that students write, its name, and a hint that does not give the answer."""

    name: str
    hint: str
    function: Solution


@dataclass(frozen=True)
class Variant:
    """Another right solution."""

    name: str
    function: Solution


class DoesNotEnd(TimeLimit):
    """Raised by a mistake in the place where the student's loop would never end; counts as a timeout."""


class Exercise:
    """What is asked of a student, and how it is judged.

    Parameters
    ----------
    reference : callable
        The solution. Its name is the exercise's name, its signature and docstring are the stub's.
    notes : str
        The place in the course notes.
    hints : sequence of str
        From vague to pointed; `hint(f)` gives one at a time. None gives the answer.
    canonical : callable, optional
        ``canonical(arguments, value)`` brings equally right answers into one form, so that
        a student's answer can be compared with a mistake's.
    time_limit : float
        Seconds that one call may take.
    """

    def __init__(
        self,
        reference: Solution,
        *,
        notes: str,
        hints: Sequence[str],
        canonical: Callable[[tuple[Any, ...], Any], Any] | None = None,
        time_limit: float = 2.0,
    ) -> None:
        self.reference = reference
        self.name = reference.__name__
        self.notes = notes
        self.hints = tuple(hints)
        self.canonical = canonical or (lambda arguments, value: value)
        self.time_limit = time_limit
        self.checks: list[Check] = []
        self.mistakes: list[Mistake] = []
        self.variants: list[Variant] = []

    def __repr__(self) -> str:
        return f"<Exercise {self.name}: {self.points} points, {len(self.checks)} checks>"

    @property
    def points(self) -> int:
        """The sum of the points of the checks."""
        return sum(check.points for check in self.checks)

    @property
    def signature(self) -> inspect.Signature:
        """The signature that the stub has too."""
        return inspect.signature(self.reference)

    @property
    def summary(self) -> str:
        """The first line of the reference's docstring."""
        return (inspect.getdoc(self.reference) or "").partition("\n")[0]

    def check(self, claim: str, *, points: int = 1) -> Callable[[CheckFunction], CheckFunction]:
        """Declare a check. `claim` says what is true of a right solution."""

        def declare(run: CheckFunction) -> CheckFunction:
            self._refuse_twice(claim, [c.claim for c in self.checks])
            self.checks.append(Check(claim, points, run))
            return run

        return declare

    def mistake(self, name: str, *, hint: str) -> Callable[[Solution], Solution]:
        """Declare a wrong solution. `name` completes the sentence "it looks as if …"."""

        def declare(function: Solution) -> Solution:
            self._refuse_twice(name, [m.name for m in self.mistakes])
            self.mistakes.append(Mistake(name, hint, function))
            return function

        return declare

    def variant(self, name: str) -> Callable[[Solution], Solution]:
        """Declare another right solution."""

        def declare(function: Solution) -> Solution:
            self._refuse_twice(name, [v.name for v in self.variants])
            self.variants.append(Variant(name, function))
            return function

        return declare

    def _refuse_twice(self, name: str, names: list[str]) -> None:
        if name in names:
            raise ExerciseError(f"{self.name}: {name!r} is declared twice; give the second another name")
