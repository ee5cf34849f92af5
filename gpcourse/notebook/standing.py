"""Where a student stands, and going on from there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from gpcourse.exercises.course import CHAPTERS, Chapter
from gpcourse.exercises.feedback.content import MARKS
from gpcourse.exercises.feedback.panel import template, tint
from gpcourse.exercises.judging import Outcome
from gpcourse.notebook.asked import Misuse, exercise_of
from gpcourse.notebook.fingerprint import fingerprint
from gpcourse.notebook.store import Record, store


@dataclass(frozen=True)
class Line:
    """One exercise in the table."""

    name: str
    outcome: Outcome
    mark: str
    word: str
    points: int
    of: int


@dataclass(frozen=True)
class Section:
    """One chapter in the table."""

    title: str
    lines: tuple[Line, ...]

    @property
    def points(self) -> int:
        """The points reached in the chapter."""
        return sum(line.points for line in self.lines)

    @property
    def of(self) -> int:
        """The points of the chapter."""
        return sum(line.of for line in self.lines)


class Standing:
    """The table that `progress` shows."""

    def __init__(self, sections: Sequence[Section]) -> None:
        self.sections = tuple(sections)

    @property
    def points(self) -> int:
        """The points reached in all chapters shown."""
        return sum(section.points for section in self.sections)

    @property
    def of(self) -> int:
        """The points of all chapters shown."""
        return sum(section.of for section in self.sections)

    def _repr_html_(self) -> str:
        return template("standing.html").render(standing=self, tint_of=tint)  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        lines: list[str] = []
        for section in self.sections:
            lines.append(f"{section.title}: {section.points} of {section.of} points")
            lines += [f"  {x.mark} {x.word:<9} {x.points:>2}/{x.of:<2}  {x.name}" for x in section.lines]
        if len(self.sections) != 1:
            lines.append(f"Together: {self.points} of {self.of} points")
        return "\n".join(lines)


def progress(chapter: str | int | None = None) -> Standing:
    """Show the points of each exercise, as of its last check.

    Parameters
    ----------
    chapter : str or int, optional
        A chapter's name or number, as ``"halfedge"`` or 1; without it, the chapters that you have begun.

    Raises
    ------
    Misuse
        If there is no such chapter.
    """
    records = store().records()
    chosen = CHAPTERS if chapter is None else (_chapter(chapter),)
    sections = [_section(each, records) for each in chosen]
    if chapter is None:
        begun = [section for section in sections if any(x.outcome != "not attempted" for x in section.lines)]
        sections = begun or sections
    return Standing(sections)


def _chapter(name: str | int) -> Chapter:
    for chapter in CHAPTERS:
        if name in (chapter.stem, chapter.title, chapter.notebook, str(chapter.number)) or (
            name == chapter.number and not isinstance(name, bool)
        ):
            return chapter
    stems = ", ".join(f'"{chapter.stem}"' for chapter in CHAPTERS)
    raise Misuse(f"progress: there is no chapter {name!r}; the chapters are {stems}")


def _section(chapter: Chapter, records: dict[str, Record]) -> Section:
    lines = []
    for exercise in chapter.exercises:
        record = records.get(exercise.name)
        reached = record.outcome if record is not None else ""
        outcome: Outcome = next((known for known in MARKS if known == reached), "not attempted")
        mark, word = MARKS[outcome]
        points = min(max(record.points, 0), exercise.points) if record is not None else 0
        lines.append(Line(exercise.name, outcome, mark, word, points, exercise.points))
    return Section(f"Chapter {chapter.number}, {chapter.title}", tuple(lines))


def working(function: Callable[..., Any] | str) -> Callable[..., Any]:
    """Return your function if its last check passed, and ours if not, so that you can always go on.

    Your function counts only with the code that was checked: after a change, run `check` again.

    Parameters
    ----------
    function : callable or str
        Your function. For a name, ours is returned.

    Raises
    ------
    Misuse
        If there is no such exercise.
    """
    exercise = exercise_of(function, "working")
    record = store().records().get(exercise.name)
    if callable(function) and record is not None and record.outcome == "passed":
        if record.code == fingerprint(function):
            print(f"Going on with your {exercise.name}.")
            return function
        print(f"Going on with our {exercise.name}: yours has changed since its check.")
    else:
        print(f"Going on with our {exercise.name}: yours has not passed its check.")
    return exercise.reference
