"""A report as plain data, for the journal. Questions, answers and pictures are left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.expect import Wrong
from gpcourse.exercises.judging import CheckResult, Verdict
from gpcourse.grading.judge import Judged, Report
from gpcourse.sandbox.call import Trouble

_WORDS = ("message", "told", "yours", "truth", "on")

Record = dict[str, Any]


def encode(report: Report) -> Record:
    """Write a report as what JSON can hold."""
    return {
        "student": report.student,
        "status": report.status,
        "notes": report.notes,
        "fault": report.fault,
        "confinement": report.confinement,
        "judged": [_judged(one) for one in report.judged],
    }


def _judged(one: Judged) -> Record:
    verdict = one.verdict
    return {
        "exercise": verdict.exercise.name,
        "outcome": verdict.outcome,
        "changed": verdict.changed,
        "notes": one.notes,
        "missing": one.missing,
        "seconds": one.seconds,
        "results": [_result(verdict.exercise, result) for result in verdict.results],
    }


def _result(exercise: Exercise, result: CheckResult) -> Record:
    return {
        "check": [check.claim for check in exercise.checks].index(result.check.claim),
        "outcome": result.outcome,
        "wrong": result.wrong and {word: getattr(result.wrong, word) for word in _WORDS},
        "trouble": result.trouble and asdict(result.trouble),
        "fault": result.fault,
        "mistake": result.mistake and [m.name for m in exercise.mistakes].index(result.mistake.name),
        "about": result.about,
    }


def decode(record: Record, exercises: Sequence[Exercise]) -> Report:
    """Read what `encode` wrote. Raises KeyError, IndexError, TypeError or ValueError if it is not that."""
    named = {exercise.name: exercise for exercise in exercises}
    judged = tuple(_read_judged(one, named[one["exercise"]]) for one in record["judged"])
    if tuple(one.verdict.exercise.name for one in judged) != tuple(named):
        raise ValueError("the exercises are others")
    return Report(
        record["student"],
        record["status"],
        judged,
        tuple(record["notes"]),
        confinement=record["confinement"],
        fault=record["fault"],
    )


def _read_judged(record: Record, exercise: Exercise) -> Judged:
    results = tuple(_read_result(each, exercise) for each in record["results"])
    verdict = Verdict(exercise, record["outcome"], results, tuple(record["changed"]))
    return Judged(verdict, tuple(record["notes"]), record["missing"], record["seconds"])


def _read_result(record: Record, exercise: Exercise) -> CheckResult:
    wrong, trouble, mistake = record["wrong"], record["trouble"], record["mistake"]
    return CheckResult(
        exercise.checks[record["check"]],
        record["outcome"],
        wrong=None if wrong is None else _read_wrong(wrong),
        trouble=None if trouble is None else Trouble(**{**trouble, "types": tuple(trouble["types"])}),
        fault=record["fault"],
        mistake=None if mistake is None else exercise.mistakes[mistake],
        about=record["about"],
    )


def _read_wrong(record: Record) -> Wrong:
    return Wrong(record.pop("message"), **record)
