"""The list of a class as a learning platform gives it out, and whose row a submission belongs to.

References
----------
Canvas writes the gradebook in *lib/gradebook_exporter.rb* of canvas-lms, and reads it in
*lib/gradebook_importer.rb*. Moodle writes the grading worksheet in *mod/assign/gradingtable.php*, and reads
it in *mod/assign/feedback/offline/importgradeslib.php*. nbgrader reads students from a CSV file with the
columns that ``nbgrader db student import`` documents.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from gpcourse.errors import UsageError
from gpcourse.grading.naming import Owner

Target = Literal["canvas", "moodle", "nbgrader"]

#: The columns that a roster must have.
NEEDED: dict[Target, tuple[str, ...]] = {
    "canvas": ("ID", "Section"),
    "moodle": ("Identifier", "Grade", "Maximum Grade", "Last modified (grade)"),
    "nbgrader": ("id",),
}
_REPAIR: dict[Target, str] = {
    "canvas": "in Canvas, open Grades, choose Export, and give that file as it is",
    "moodle": "in Moodle, set your language to English, choose Download grading worksheet in the assignment "
    "(it needs the feedback type Offline grading worksheet), and give that file as it is",
    "nbgrader": "give the CSV file of `nbgrader db student import`: id, first_name, last_name, email",
}
#: Columns whose content is one student's alone, to compare a submission's name with.
_UNIQUE: dict[Target, tuple[str, ...]] = {
    "canvas": ("ID", "SIS User ID", "SIS Login ID", "Integration ID"),
    "moodle": ("Identifier", "Email address", "ID number", "Username"),
    "nbgrader": ("id", "email"),
}


@dataclass(frozen=True)
class Row:
    """One student of a roster: the cells by column, and what the student is called."""

    cells: Mapping[str, str]
    name: str
    number: str
    unique: frozenset[str]
    names: frozenset[str]


@dataclass(frozen=True)
class Roster:
    """A roster: the columns in their order, the students, and whether the file had a byte-order mark."""

    target: Target
    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    marked: bool = False


def read_roster(path: Path, target: Target) -> Roster:
    """Read a roster, with commas, semicolons or tabs between the cells.

    Raises
    ------
    UsageError
        If the file cannot be read, or is not what `target` gives out: a column is missing.
    """
    raw = path.read_bytes()
    marked = raw.startswith((codecs.BOM_UTF8, codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    wide = marked and not raw.startswith(codecs.BOM_UTF8)
    try:
        text = raw.decode("utf-16" if wide else "utf-8-sig")
        header, *lines = _table(text, target, path)
    except UnicodeDecodeError:
        raise UsageError(f"{path} is not UTF-8; save it as CSV UTF-8, or {_REPAIR[target]}") from None
    except csv.Error as error:
        raise UsageError(f"{path} is not a CSV file: {error}; {_REPAIR[target]}") from None
    twice = sorted({name for name in header if name and header.count(name) > 1})
    if twice:
        raise UsageError(
            f"{path} has the column {', '.join(map(repr, twice))} more than once; {_REPAIR[target]}"
        )
    width = len(header)
    cells = [dict(zip(header, [*line, *[""] * width][:width], strict=True)) for line in lines]
    rows = tuple(row for each in cells if (row := _row(each, target)))
    if not rows:
        raise UsageError(f"{path} lists no students; {_REPAIR[target]}")
    return Roster(target, tuple(header), rows, marked)


def _table(text: str, target: Target, path: Path) -> list[list[str]]:
    """Split the text at the separator that gives the columns that are needed."""
    fewest: list[str] | None = None
    for separator in ",;\t":
        table = [line for line in csv.reader(io.StringIO(text), delimiter=separator) if any(line)]
        header = [name.strip() for name in table[0]] if table else []
        if target == "nbgrader":
            header = ["id" if name in ("student_id", "id") else name for name in header]
        missing = [name for name in NEEDED[target] if name not in header]
        if target == "canvas" and not (
            {"Student"} <= set(header) or {"LastName", "FirstName"} <= set(header)
        ):
            missing.insert(0, "Student")
        if not missing:
            return [header, *table[1:]]
        if fewest is None or len(missing) < len(fewest):
            fewest = missing
    words = ", ".join(map(repr, fewest or ()))
    raise UsageError(f"{path} is no roster of {target}: it has no column {words}; {_REPAIR[target]}")


def _row(cells: dict[str, str], target: Target) -> Row | None:
    """Read a line; None for those that are about the columns and not about a student."""
    full = next((cells[c] for c in ("Student", "Full name") if cells.get(c)), "")
    parts = [cells.get(c, "") for c in ("FirstName", "LastName", "first_name", "last_name")]
    full = full.strip() or " ".join(filter(None, map(str.strip, parts)))
    number = cells.get({"canvas": "ID", "moodle": "Identifier", "nbgrader": "id"}[target], "").strip()
    if target == "canvas" and ("Points Possible" in full or not (number or full)):
        return None
    if target == "moodle":
        number = re.sub(r".*?(\d+)", r"\1", number)
    if not (number or full):
        return None
    own = {plain(cells.get(c, "")) for c in _UNIQUE[target]} | {plain(number)}
    return Row(cells, full or number, number, frozenset(own - {""}), spellings(full))


def plain(text: str) -> str:
    """Return a text in the form in which names are compared."""
    return " ".join(unicodedata.normalize("NFKC", text).casefold().replace("_", " ").split())


def spellings(full: str) -> frozenset[str]:
    """Return a name as it may be written: Ada Lovelace; Lovelace, Ada; Lovelace Ada."""
    last, comma, first = full.partition(",")
    ways = {full, f"{first} {last}", f"{last} {first}"} if comma else {full}
    return frozenset(plain(way) for way in ways) - {""}


@dataclass(frozen=True)
class Match:
    """Which row is whose, and what could not be told, in words."""

    rows: Mapping[str, Row]
    remarks: tuple[str, ...]


def match(roster: Roster, owners: Mapping[str, Owner]) -> Match:
    """Find the row of each submission; what fits two rows, or two submissions that fit one, gets none.

    `owners` maps the name of a submission to whose it is. The platform's number decides where there is
    one; else what only one student can have (login, e-mail); else the name, if it is the only one.
    """
    found: dict[str, Row] = {}
    remarks: list[str] = []
    for student, owner in owners.items():
        rows = _candidates(roster, owner)
        if len(rows) == 1:
            found[student] = rows[0]
        elif rows:
            several = ", ".join(f"{row.name} ({row.number})" for row in rows)
            remarks.append(f"{student}: fits several rows of the roster, and is in none: {several}")
        else:
            remarks.append(f"{student}: handed in, but is not in the roster")
    claimed: dict[int, list[str]] = {}
    for student, row in found.items():
        claimed.setdefault(id(row), []).append(student)
    for students in claimed.values():
        if len(students) > 1:
            row = found[students[0]]
            remarks.append(
                f"{', '.join(students)}: all fit the row of {row.name} ({row.number}), which gets none"
            )
            for student in students:
                del found[student]
    taken = {id(row) for row in found.values()}
    absent = [row.name for row in roster.rows if id(row) not in taken and row.name != "Student, Test"]
    remarks += [f"{name}: in the roster, but no submission is his or hers" for name in absent]
    return Match(found, tuple(remarks))


def _candidates(roster: Roster, owner: Owner) -> Sequence[Row]:
    if owner.id and owner.platform == roster.target:
        return [row for row in roster.rows if row.number == owner.id]
    name = plain(owner.name)
    return [row for row in roster.rows if name in row.unique] or [
        row for row in roster.rows if name in row.names
    ]
