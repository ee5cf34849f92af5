"""Hints one at a time, and the solution for those who ask twice."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from gpcourse.exercises.course import by_name
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.feedback.panel import template
from gpcourse.notebook.asked import exercise_of

#: How many hints of an exercise were given, and which solutions were asked for once, since the start.
_given: dict[str, int] = {}
_offered: set[str] = set()


class Message:
    """A short text, and perhaps some code, for the student."""

    def __init__(self, title: str, text: str = "", code: str = "") -> None:
        self.title = title
        self.text = text
        self.code = code

    def _repr_html_(self) -> str:
        return template("message.html").render(message=self)  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        return "\n".join(filter(None, [f"{self.title} {self.text}".strip(), self.code]))


def hint(function: Callable[..., Any] | str) -> Message:
    """Give the next hint for an exercise; after the last one, the first again.

    Parameters
    ----------
    function : callable or str
        Your function, or its name.

    Raises
    ------
    Misuse
        If there is no such exercise.
    """
    exercise = exercise_of(function, "hint")
    total, given = len(exercise.hints), _given.get(exercise.name, 0)
    if not total:
        return Message(f"{exercise.name} has no hints.", f"`solution({exercise.name})` shows ours.")
    _given[exercise.name] = given + 1
    i = given % total
    last = f" This was the last one. `solution({exercise.name})` shows ours." if i == total - 1 else ""
    return Message(f"Hint {i + 1} of {total} for {exercise.name}:", exercise.hints[i] + last)


def solution(function: Callable[..., Any] | str) -> Message:
    """Show our solution of an exercise on the second call; the first offers a hint instead.

    Parameters
    ----------
    function : callable or str
        Your function, or its name.

    Raises
    ------
    Misuse
        If there is no such exercise.
    """
    exercise = exercise_of(function, "solution")
    name = exercise.name
    if name not in _offered:
        _offered.add(name)
        return Message(f"Sure? {_offer(exercise)}", f"`solution({name})` once more shows our solution.")
    from gpcourse.notebook.closure import closure

    parts = closure(exercise.reference, given=frozenset(by_name())).definitions
    code = "\n\n\n".join(part.source for part in reversed(parts))
    return Message(f"Our solution of {name}.", "Yours may well be different, and just as right.", code)


def _offer(exercise: Exercise) -> str:
    given, total = _given.get(exercise.name, 0), len(exercise.hints)
    left = total - given
    if left <= 0:
        return "You have seen all the hints." if total else "You learn more if you find it yourself."
    return f"{left} hint{' is' if left == 1 else 's are'} left: `hint({exercise.name})` gives the next one."
