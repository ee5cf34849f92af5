"""The grades in the formats that learning platforms take in: Canvas, Moodle, nbgrader.

A submission that needs a person (unreadable, or a check of ours broke) gets no grade here: its cell stays
as it was, and a remark names it.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from gpcourse.grading.gradebook import safe
from gpcourse.grading.judge import Report
from gpcourse.grading.naming import Owner
from gpcourse.grading.roster import Roster, Row, Target, match

_CANVAS = ("Student", "ID", "SIS User ID", "SIS Login ID", "Section")
_MOODLE = (
    "Identifier", "Full name", "Email address", "Status", "Grade", "Maximum Grade", "Grade can be changed",
    "Last modified (submission)", "Last modified (grade)", "Feedback comments",
)  # fmt: skip
_NBGRADER = (
    "assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email", "raw_score",
    "late_submission_penalty", "score", "max_score",
)  # fmt: skip
_NUMBER = re.compile(r"-|[-+]?\d+(?:[.,]\d+)?%?")

Cells = dict[str, str]


@dataclass(frozen=True)
class Graded:
    """What an export needs of a class; `timestamps` are nbgrader's, by submission."""

    reports: Sequence[Report]
    owners: Mapping[str, Owner]
    timestamps: Mapping[str, str]
    assignment: str
    out_of: int


@dataclass(frozen=True)
class Export:
    """The text of a file, and what the instructor has to know of it."""

    text: str
    remarks: tuple[str, ...]


def export(target: Target, graded: Graded, roster: Roster | None) -> Export:
    """Write the grades for `target`, in the rows and columns of the roster where one is given."""
    rows: dict[str, Row] = {}
    remarks: list[str] = []
    if roster is not None:
        matched = match(roster, graded.owners)
        rows.update(matched.rows)
        remarks += matched.remarks
    points: dict[str, int] = {}
    for report in graded.reports:
        if report.status in ("unreadable", "grader fault"):
            remarks.append(f"{report.student}: {report.status}; a person has to look, so there is no grade")
        else:
            points[report.student] = report.points
    writer = {"canvas": _canvas, "moodle": _moodle, "nbgrader": _nbgrader}[target]
    columns, table = writer(graded, roster, rows, points, remarks)
    mark = "\ufeff" if roster is not None and roster.marked else ""
    return Export(mark + _csv(columns, table), tuple(remarks))


def _csv(columns: Sequence[str], table: Sequence[Cells]) -> str:
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\r\n")
    writer.writerow([_cell(column, column) for column in columns])
    for row in table:
        writer.writerow([_cell(column, row.get(column, "")) for column in columns])
    return buffer.getvalue()


def _cell(column: str, text: str) -> str:
    """Take the sting out of a cell, but for numbers and the instructor's own words."""
    if column == "Feedback comments" or _NUMBER.fullmatch(text):
        return text
    return text if text.startswith("    Points Possible") else safe(text)


def _by_row(rows: Mapping[str, Row]) -> dict[int, str]:
    return {id(row): student for student, row in rows.items()}


def _canvas(
    graded: Graded,
    roster: Roster | None,
    rows: Mapping[str, Row],
    points: Mapping[str, int],
    remarks: list[str],
) -> tuple[Sequence[str], list[Cells]]:
    """Columns about the student as in the roster, then the assignment's, which keeps its number."""
    about = _CANVAS if roster is None else roster.columns[: roster.columns.index("Section") + 1]
    column = graded.assignment
    if roster is None:
        table = [
            {"Student": owner.name, "ID": owner.id if owner.platform == "canvas" else "", column: grade}
            for student, owner in graded.owners.items()
            if (grade := str(points.get(student, "")))
        ]
    else:
        rest = roster.columns[len(about) :]
        fitting = [c for c in rest if c == column or re.sub(r" \(\d+\)$", "", c) == column]
        if len(fitting) > 1:
            remarks.append(f"the roster has several columns {column!r}; a new one is written: choose by hand")
        column = fitting[0] if len(fitting) == 1 else column
        if not fitting:
            remarks.append(f"the roster has no column {column!r}, so Canvas will make a new assignment")
        whose = _by_row(rows)
        table = [
            {**row.cells, column: str(points.get(whose.get(id(row), ""), row.cells.get(column, "")))}
            for row in roster.rows
        ]
    possible = {about[0]: "    Points Possible", column: str(graded.out_of)}
    return (*about, column), [possible, *table]


def _moodle(
    graded: Graded,
    roster: Roster | None,
    rows: Mapping[str, Row],
    points: Mapping[str, int],
    remarks: list[str],
) -> tuple[Sequence[str], list[Cells]]:
    """The worksheet with its grades filled in; Moodle takes no grade above the worksheet's maximum."""
    if roster is not None:
        whose = _by_row(rows)
        for seen in sorted({row.cells["Maximum Grade"] for row in roster.rows}):
            if _value(seen) != graded.out_of:
                remarks.append(
                    f"the worksheet's Maximum Grade is {seen}, but {graded.out_of} points can be reached; "
                    "set the assignment's maximum grade in Moodle and download the worksheet again"
                )
        locked = [
            row.name
            for row in roster.rows
            if id(row) in whose and row.cells.get("Grade can be changed", "Yes").strip().casefold() == "no"
        ]
        remarks += [f"{name}: the worksheet says that the grade cannot be changed" for name in locked]
        return roster.columns, [
            {**row.cells, "Grade": str(points.get(whose.get(id(row), ""), row.cells["Grade"]))}
            for row in roster.rows
        ]
    table = []
    for student, grade in points.items():
        owner = graded.owners[student]
        if owner.platform != "moodle" or not owner.id:
            remarks.append(f"{student}: Moodle's number is not known; give the worksheet with --roster")
            continue
        known = {"Identifier": f"Participant {owner.id}", "Full name": owner.name, "Grade": str(grade)}
        table.append({**known, "Maximum Grade": str(graded.out_of)})
    return _MOODLE, table


def _value(text: str) -> float | None:
    try:
        return float(text.strip().replace(",", "."))
    except ValueError:
        return None


def _nbgrader(
    graded: Graded,
    roster: Roster | None,
    rows: Mapping[str, Row],
    points: Mapping[str, int],
    remarks: list[str],
) -> tuple[Sequence[str], list[Cells]]:
    """What ``nbgrader export`` writes: who handed nothing in has a score of 0.0 and no timestamp."""

    def line(student: str | None, about: Mapping[str, str]) -> Cells:
        score = "0.0" if student is None else str(float(points[student])) if student in points else ""
        name = about.get("id", student or "")
        return {
            "assignment": graded.assignment,
            "timestamp": graded.timestamps.get(student or "", ""),
            **{key: about.get(key, "") for key in ("last_name", "first_name", "email")},
            **{"student_id": name, "raw_score": score, "late_submission_penalty": "0.0", "score": score},
            "max_score": str(float(graded.out_of)),
        }

    if roster is None:
        return _NBGRADER, [line(student, {}) for student in graded.owners]
    whose = _by_row(rows)
    return _NBGRADER, [line(whose.get(id(row)), row.cells) for row in roster.rows]
