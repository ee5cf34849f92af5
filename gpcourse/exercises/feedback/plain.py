"""The panel as plain text, for a terminal, a log, or a notebook without HTML."""

from __future__ import annotations

import textwrap

from gpcourse.exercises.feedback.content import Content, Problem, content
from gpcourse.exercises.judging import Verdict

_WIDTH = 100


def as_text(verdict: Verdict, *, answers: bool = True) -> str:
    """Return the feedback on one exercise as plain text, at most 100 columns wide.

    Without `answers` it leaves out what is true, as on pages that are handed out.
    """
    said = content(verdict, answers=answers)
    blocks = [
        "\n".join([*_wrapped(f"{said.name}: {_points(said.points, said.of)}. {said.headline}"), *_rows(said)])
    ]
    if said.problem is not None:
        blocks.append("\n".join(_problem(said.problem)))
    blocks.extend("\n".join(_wrapped(f"Note: {note}")) for note in said.notes)
    return "\n\n".join(blocks)


def _points(points: int, of: int) -> str:
    return f"{points} of {of} point{'' if of == 1 else 's'}"


def _rows(said: Content) -> list[str]:
    lines = []
    for row in said.rows:
        head = f"  {row.mark} {row.word:<9} {row.points if row.word != 'our fault' else '-'}/{row.of}  "
        lines += textwrap.wrap(
            row.claim, _WIDTH, initial_indent=head, subsequent_indent=" " * len(head), break_on_hyphens=False
        )
    return lines


def _problem(problem: Problem) -> list[str]:
    lines = [*_wrapped(f"First problem: {problem.claim}"), *_wrapped(problem.message, "  ")]
    if problem.where:
        lines += _wrapped(f"{problem.where}: {problem.source}", "  ")
    for label, value in problem.facts:
        lines += textwrap.wrap(
            value, _WIDTH, initial_indent=f"  {label:<6} ", subsequent_indent=" " * 9, break_on_hyphens=False
        )
    for line in problem.legend:
        lines += _wrapped(f"where {line}", " " * 9)
    for words in (problem.advice, problem.mistake, problem.hint):
        lines += _wrapped(words, "  ")
    if problem.fault:
        lines += [
            "  Details:",
            *(f"    {line}" for line in problem.fault.splitlines() for line in _cut(line)),
        ]
    return lines


def _cut(line: str) -> list[str]:
    return textwrap.wrap(line, _WIDTH - 4, replace_whitespace=False, drop_whitespace=False) or [""]


def _wrapped(text: str, indent: str = "") -> list[str]:
    return [
        line
        for part in text.splitlines()
        for line in textwrap.wrap(
            part, _WIDTH, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False
        )
    ]
