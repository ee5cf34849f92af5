"""The grade book as tables: grades.csv for the instructor, a results.json a student for Gradescope."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import tempfile
import unicodedata
import zlib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from gpcourse.exercises import feedback
from gpcourse.exercises.exercise import Exercise
from gpcourse.grading.judge import Judged, Report

#: Bytes of a file name that come from a student's. File systems allow 255, the ending included.
_LONGEST = 180
#: Where a spreadsheet may begin a formula, in letters of either width: in some countries it parts cells at
#: semicolons.
_FORMULA = re.compile(r"((?:^|[;|])\s*)([=+\-@＝＋－＠])")
#: How the name ends of a file that is being written.
UNFINISHED = ".part"
#: What Windows takes for a device.
_RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)", re.IGNORECASE)


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
        writer.writerow([safe(cell) if isinstance(cell, str) else cell for cell in row])
    return buffer.getvalue()


def times_csv(reports: Sequence[Report], exercises: Sequence[Exercise]) -> str:
    """Write one row a student: the seconds that the answers of each exercise took, and their sum."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(["student", *(e.name for e in exercises), "total"])
    for report in reports:
        seconds = [judged.seconds for judged in report.judged]
        writer.writerow([safe(report.student), *(f"{s:.3f}" for s in [*seconds, sum(seconds)])])
    return buffer.getvalue()


def safe(text: str) -> str:
    """Return a cell on one line that no spreadsheet takes for a formula."""
    line = "".join(c if c.isprintable() else " " for c in text)
    return _FORMULA.sub(r"\1'\2", line)


def note(report: Report) -> str:
    """Say in one line what a person should know of a submission besides its points."""
    parts = [*report.notes, *filter(None, [report.fault])]
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


def handed_out(report: Report) -> list[str]:
    """Say what a student should know of the submission as a whole: no path, and no fault of ours in full."""
    words = [feedback.without_paths(text) for text in report.notes]
    if report.status == "grader fault":
        words.append(
            "The grader broke while it looked at this. It is our fault, and a person will look at it."
        )
    return words


def gradescope(report: Report) -> str:
    """Write a submission in the format of Gradescope's results.json."""
    content: dict[str, Any] = {
        "score": report.points,
        "output": "\n".join(handed_out(report)),
        "output_format": "text",
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "extra_data": {"confinement": report.confinement},
        "tests": [_test(judged) for judged in report.judged],
    }
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def _test(judged: Judged) -> dict[str, Any]:
    verdict = judged.verdict
    words = feedback.as_text(verdict, answers=False)
    if judged.missing:
        words = f"There is no function called {verdict.exercise.name} in what was handed in."
    return {
        "name": verdict.exercise.name,
        "score": verdict.points,
        "max_score": verdict.exercise.points,
        "status": "passed" if verdict.outcome == "passed" else "failed",
        "output": "\n".join([words, *map(feedback.without_paths, judged.notes)]),
        "output_format": "text",
    }


def file_names(students: Iterable[str]) -> dict[str, str]:
    """Give each student a file name: letters of any script, digits, - and _, and no two alike.

    Names that differ in case only, or in the way an accent is written, are alike on some systems.
    """
    names: dict[str, str] = {}
    taken: set[str] = set()
    for student in students:
        plain = unicodedata.normalize("NFC", student.encode("utf-8", "replace").decode())
        stem = re.sub(r"[^\w-]+", "-", plain).strip("-").encode()[:_LONGEST].decode(errors="ignore")
        sure = stem and stem == student and not _RESERVED.fullmatch(stem)
        name = stem if sure else _marked(stem, student)
        while name.casefold() in taken:
            plain += "*"
            name = _marked(stem, plain)
        taken.add(name.casefold())
        names[student] = name
    return names


def _marked(stem: str, salt: str) -> str:
    return f"{stem or 'student'}-{zlib.crc32(salt.encode('utf-8', 'replace')):08x}"


def write(path: Path, text: str) -> None:
    """Write a file as a whole: whoever looks sees the old one or the new one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name[:60]}-", suffix=UNFINISHED)
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="") as file:
            file.write(text)
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
