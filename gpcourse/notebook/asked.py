"""Which exercise a student means, and errors without a traceback of ours."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from gpcourse.errors import ExerciseError, UsageError
from gpcourse.exercises.course import find
from gpcourse.exercises.exercise import Exercise


class Misuse(UsageError):
    """One of our functions was called with something that it cannot use. IPython shows the message only."""

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


class Interrupted(KeyboardInterrupt):
    """The student's own interrupt while a check ran. IPython shows the message only."""

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


def exercise_of(function: Callable[..., Any] | str, caller: str) -> Exercise:
    """Return the exercise that a function, or a name, stands for; `caller` is who asks.

    Raises
    ------
    Misuse
        If there is none; the message says what to write instead.
    """
    name = function if isinstance(function, str) else name_of(function, caller)
    try:
        return find(name)
    except ExerciseError as error:
        raise Misuse(f"{caller}: {error}") from None


def name_of(function: object, caller: str) -> str:
    """Return the name of a function; Misuse for what is none."""
    name = getattr(function, "__name__", None)
    if not callable(function) or not isinstance(name, str):
        raise Misuse(
            f"{caller} needs the function itself, and got a value of type {type(function).__name__}. "
            f"Write {caller}(f), with the name of your function and without a call of it."
        )
    if name == "<lambda>":
        raise Misuse(f"{caller} finds the exercise by the function's name, and a lambda has none. Use `def`.")
    return name
