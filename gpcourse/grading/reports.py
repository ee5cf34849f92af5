"""The pages: one of the class for the instructor, one for each student to hand out."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gpcourse.exercises import feedback
from gpcourse.exercises.course import Chapter
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Outcome, Verdict
from gpcourse.grading import gradebook
from gpcourse.grading.judge import Judged, Report

if TYPE_CHECKING:
    from jinja2 import Environment

#: How the outcomes are drawn: a sign, and the name of a colour. The worst comes last.
SIGNS: dict[Outcome, tuple[str, str]] = {
    "passed": ("✓", "passed"),
    "failed": ("✗", "failed"),
    "error": ("!", "error"),
    "timeout": ("∞", "timeout"),
    "crashed": ("✹", "crashed"),
    "out of memory": ("▤", "crashed"),
    "not attempted": ("–", "absent"),
    "grader fault": ("?", "fault"),
}

_BINS = 10
#: Characters of a text on a page.
_LONGEST = 6000
#: Characters of a line of code on a page.
_LINE = 400


@dataclass(frozen=True)
class Cell:
    """One exercise of one student, as the class page shows it."""

    points: int
    out_of: int
    sign: str
    colour: str
    title: str


@cache
def _environment() -> Environment:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    return Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        finalize=_finalize,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def _finalize(value: object) -> object:
    """Take control characters out of what is inserted, and cut it off; markup is ours and stays."""
    return feedback.clean(value, _LONGEST) if type(value) is str else value


def _render(template: str, **content: Any) -> str:
    return _environment().get_template(template).render(**content) + "\n"


def title_of(chapters: Sequence[Chapter]) -> str:
    """Name what was graded."""
    return ", ".join(chapter.title for chapter in chapters)


def student_page(
    report: Report,
    chapters: Sequence[Chapter],
    written: Callable[[Verdict], str] = feedback.handed_out,
) -> str:
    """Write the page of one student, with the feedback on every exercise; `written` writes that.

    It does not say the seed: whoever hands in late, or anew, is graded with the same.
    """
    from markupsafe import Markup

    panels = [
        {
            "cell": _cell(judged),
            "name": judged.verdict.exercise.name,
            "summary": judged.verdict.exercise.summary.replace("`", ""),
            "outcome": judged.verdict.outcome,
            "html": Markup(written(judged.verdict)) if judged.verdict.results else "",
            "notes": [feedback.without_paths(text) for text in judged.notes],
            "missing": judged.missing,
        }
        for judged in report.judged
    ]
    return _render(
        "student.html",
        report=report,
        notes=gradebook.handed_out(report),
        share=_share(report.points, report.out_of),
        title=title_of(chapters),
        panels=panels,
        passed=sum(judged.verdict.outcome == "passed" for judged in report.judged),
    )


def class_page(
    reports: Sequence[Report],
    chapters: Sequence[Chapter],
    exercises: Sequence[Exercise],
    seed: int,
    names: Mapping[str, str],
) -> str:
    """Write the page of the class. `names` are the file names of the students' pages."""
    rows = [
        {
            "report": report,
            "link": f"students/{names[report.student]}.html",
            "cells": [_cell(judged) for judged in report.judged],
            "share": _share(report.points, report.out_of),
        }
        for report in reports
    ]
    looked_at = [report for report in reports if _needs_a_person(report)]
    noted = [report for report in reports if report not in looked_at and _reasons(report)]
    totals = [report.points for report in reports]
    return _render(
        "class.html",
        title=title_of(chapters),
        rows=rows,
        exercises=[_summary(reports, i, exercise) for i, exercise in enumerate(exercises)],
        mistakes=_mistakes(reports, names),
        bins=_histogram(reports),
        out_of=sum(exercise.points for exercise in exercises),
        mean=_number(statistics.fmean(totals)),
        median=_number(statistics.median(totals)),
        confinement=", ".join(sorted({report.confinement for report in reports})),
        full=sum(report.points == report.out_of for report in reports),
        attempted=sum(report.status in ("graded", "grader fault") for report in reports),
        looked_at=[_told(report, names) for report in looked_at],
        noted=[_told(report, names) for report in noted],
        seed=seed,
        legend=[(sign, colour, outcome) for outcome, (sign, colour) in SIGNS.items()],
    )


def similarity_page(
    pairs: Sequence[Any],
    sides: Sequence[list[list[tuple[str, bool]]]],
    count: int,
    threshold: float,
    more: int = 0,
) -> str:
    """Write the page on shared code: `sides` are the lines of both texts, and which of them are shared."""
    from markupsafe import escape

    # Escaped here, where a line keeps its indentation.
    escaped = [[[(escape(line[:_LINE]), mark) for line, mark in side] for side in two] for two in sides]
    rows = [{"pair": pair, "sides": two} for pair, two in zip(pairs, escaped, strict=True)]
    return _render("similarity.html", pairs=rows, count=count, threshold=threshold, more=more)


def _needs_a_person(report: Report) -> bool:
    """Tell whether something of ours broke, nothing could be read, or a function may have the wrong name."""
    near = any(judged.missing and judged.notes for judged in report.judged)
    return report.status in ("grader fault", "unreadable") or near


def _told(report: Report, names: Mapping[str, str]) -> dict[str, Any]:
    faults = [
        (judged.verdict.exercise.name, result.check.claim, result.fault)
        for judged in report.judged
        for result in judged.verdict.results
        if result.outcome == "grader fault"
    ]
    link = f"students/{names[report.student]}.html"
    return {"report": report, "link": link, "reasons": _reasons(report), "faults": faults}


def _reasons(report: Report) -> list[str]:
    """Say what a person should know of a submission, but what the table of students shows."""
    of_exercises = [
        f"{judged.verdict.exercise.name}: {text}" for judged in report.judged for text in judged.notes
    ]
    return [*report.notes, *filter(None, [report.fault]), *of_exercises]


def _cell(judged: Judged) -> Cell:
    verdict = judged.verdict
    sign, colour = SIGNS[verdict.outcome]
    if colour == "failed" and verdict.points:
        colour = "part"
    words = [
        f"{verdict.exercise.name}: {verdict.outcome}",
        *(m.name for m in verdict.mistakes),
        *judged.notes,
    ]
    return Cell(verdict.points, verdict.exercise.points, sign, colour, " · ".join(words))


def _share(points: float, out_of: int) -> float:
    """Return the percentage, with a decimal."""
    return round(100 * points / out_of, 1) if out_of else 0.0


def _number(value: float) -> str:
    return f"{value:.1f}".removesuffix(".0")


def _summary(reports: Sequence[Report], i: int, exercise: Exercise) -> dict[str, Any]:
    """How the class did in one exercise: mean points, and how often each outcome came."""
    verdicts = [report.judged[i].verdict for report in reports]
    counts = Counter(verdict.outcome for verdict in verdicts)
    mean = statistics.fmean(verdict.points for verdict in verdicts)
    return {
        "name": exercise.name,
        "points": exercise.points,
        "mean": _number(mean),
        "share": round(_share(mean, exercise.points)),
        "parts": [
            {
                "outcome": outcome,
                "sign": sign,
                "colour": colour,
                "count": counts[outcome],
            }
            for outcome, (sign, colour) in SIGNS.items()
            if counts[outcome]
        ],
    }


def _mistakes(reports: Sequence[Report], names: Mapping[str, str]) -> list[dict[str, Any]]:
    """The named mistakes, the commonest first, with the students who made them."""
    made: dict[tuple[str, str], list[str]] = {}
    for report in reports:
        for judged in report.judged:
            for mistake in judged.verdict.mistakes:
                made.setdefault((judged.verdict.exercise.name, mistake.name), []).append(report.student)
    ranked = sorted(made.items(), key=lambda item: (-len(item[1]), item[0]))
    return [
        {
            "exercise": exercise,
            "name": name,
            "common": len(students) > 1,
            "students": [{"name": s, "link": f"students/{names[s]}.html"} for s in students],
        }
        for (exercise, name), students in ranked
    ]


def _histogram(reports: Sequence[Report]) -> list[dict[str, Any]]:
    """How many students reached how many tenths of the points; the last tenth has full marks in it."""
    tenths = Counter(min(_BINS * r.points // max(r.out_of, 1), _BINS - 1) for r in reports)
    most = max(tenths.values())
    return [
        {"label": f"{10 * i}", "count": tenths[i], "height": round(100 * tenths[i] / most, 1)}
        for i in range(_BINS)
    ]
