"""The chapters, and finding an exercise by name."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from functools import cache
from importlib import import_module

from gpcourse.errors import ExerciseError
from gpcourse.exercises.exercise import Exercise


@dataclass(frozen=True)
class Chapter:
    """A chapter of the course. `stem` names its modules, its tests and, with the number, its notebook."""

    number: int
    stem: str
    title: str

    @property
    def notebook(self) -> str:
        """The file name of the chapter's notebook."""
        return f"{self.number}_{self.stem}.ipynb"

    @property
    def exercises(self) -> tuple[Exercise, ...]:
        """The chapter's exercises, in the order of its notebook."""
        module = import_module(f"gpcourse.exercises.{self.stem}")
        exercises: tuple[Exercise, ...] = module.EXERCISES
        return exercises

    @property
    def points(self) -> int:
        """The points of all exercises."""
        return sum(exercise.points for exercise in self.exercises)


CHAPTERS = (
    Chapter(0, "welcome", "Welcome"),
    Chapter(1, "halfedge", "Half-edge meshes"),
    Chapter(2, "registration", "Registration"),
    Chapter(6, "smoothing", "Smoothing"),
)


@cache
def by_name() -> dict[str, tuple[Chapter, Exercise]]:
    """Map the name of every exercise to its chapter and itself. Names are unique in the course."""
    table: dict[str, tuple[Chapter, Exercise]] = {}
    for chapter in CHAPTERS:
        for exercise in chapter.exercises:
            if exercise.name in table:
                raise ExerciseError(f"two exercises are called {exercise.name}; rename one")
            table[exercise.name] = (chapter, exercise)
    return table


def find(name: str) -> Exercise:
    """Return the exercise called `name`.

    Raises
    ------
    ExerciseError
        If there is none; the message offers the nearest name.
    """
    table = by_name()
    if name in table:
        return table[name][1]
    near = difflib.get_close_matches(name, table, n=1)
    advice = f"did you mean {near[0]}?" if near else "`gpcourse exercises` lists them all"
    raise ExerciseError(f"there is no exercise called {name}; {advice}")


def chapter_of(exercise: Exercise) -> Chapter:
    """Return the chapter that `exercise` belongs to."""
    return by_name()[exercise.name][0]
