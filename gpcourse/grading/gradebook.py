"""The grade book as tables: grades.csv for the instructor, a results.json a student for Gradescope."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import tempfile
import zlib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from gpcourse.exercises import feedback
from gpcourse.exercises.exercise import Exercise
from gpcourse.grading.judge import Judged, Report


def grades_csv(reports: Sequence[Report], exercises: Sequence[Exercise]) -> str:
    """Write one row a student: points by exercise, total, status, level of confinement and a note.

    A cell that a spreadsheet would take for a formula gets an apostrophe in front.
    """
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(
        ["student", *(e.name for e in exercises), "total", "out of", "status", "confinement", "note"]
    )
    for report in reports:
        points = [judged.verdict.points for judged in report.judged]
        row = [report.student, *points, report.points, report.out_of]
        row += [report.status, report.confinement, note(report)]
        writer.writerow([_safe(cell) if isinstance(cell, str) else cell for cell in row])
    return buffer.getvalue()


def _safe(text: str) -> str:
    line = "".join(c if c.isprintable() else " " for c in text)
    return f"'{line}" if line.lstrip().startswith(("=", "+", "-", "@")) else line


def note(report: Report) -> str:
    """Say in one line what a person should know of a submission besides its points."""
    parts = list(report.notes)
    for judged in report.judged:
        name, outcome = judged.verdict.exercise.name, judged.verdict.outcome
        parts.extend(f"{name}: {text}" for text in judged.notes)
        if outcome in ("error", "timeout", "out of memory", "grader fault"):
            parts.append(f"{name}: {outcome}")
    missing = [judged.verdict.exercise.name for judged in report.judged if judged.missing]
    if report.status == "graded" and missing:
        # Last, since it may be long: what went wrong in the work that is there comes first.
        parts.append(f"no function {', '.join(missing)}")
    return "; ".join(parts)


def gradescope(report: Report) -> str:
    """Write a submission in the format of Gradescope's results.json."""
    output = note(report) if report.notes or report.status != "graded" else ""
    content: dict[str, Any] = {
        "score": report.points,
        "output": output,
        "output_format": "text",
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "extra_data": {"confinement": report.confinement},
        "tests": [_test(judged) for judged in report.judged],
    }
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def _test(judged: Judged) -> dict[str, Any]:
    verdict = judged.verdict
    return {
        "name": verdict.exercise.name,
        "score": verdict.points,
        "max_score": verdict.exercise.points,
        "status": "passed" if verdict.outcome == "passed" else "failed",
        "output": "\n".join([feedback.as_text(verdict, answers=False), *judged.notes]),
        "output_format": "text",
    }


def file_names(students: Iterable[str]) -> dict[str, str]:
    """Give each student a file name: plain characters, and no two alike even where case is ignored."""
    names: dict[str, str] = {}
    taken: set[str] = set()
    for student in students:
        name = re.sub(r"[^A-Za-z0-9_-]+", "-", student).strip("-")[:60]
        if not name or name != student or name.lower() in taken:
            name = f"{name or 'student'}-{zlib.crc32(student.encode('utf-8', 'replace')):08x}"
        taken.add(name.lower())
        names[student] = name
    return names


def write(path: Path, text: str) -> None:
    """Write a file as a whole: whoever looks sees the old one or the new one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}-")
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="") as file:
            file.write(text)
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
