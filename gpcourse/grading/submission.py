"""Reading what students hand in.

Files are read leniently: whatever is in one, a `Submission` comes out that says what could be read. JSON is
read directly and not through nbformat, which refuses notebooks that a tool has damaged a little.
"""

from __future__ import annotations

import codecs
import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gpcourse.errors import UsageError

#: Larger files are not read. Stored pictures make notebooks of tens of megabytes.
MAX_BYTES = 100 * 2**20
SUFFIXES = (".ipynb", ".py")

_BOMS = {codecs.BOM_UTF8: "utf-8-sig", codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}
_BETWEEN = re.compile(r"[,\s]*")
_DEFINITION = re.compile(r"^(?:async\s+)?def\s+(\w{1,100})\s*\(|^(\w{1,100})\s*=[^=]", re.MULTILINE)


@dataclass(frozen=True)
class Notebook:
    """The code cells of one file, each with its number among all cells, and what is to be said of them.

    `readable` is False when nothing could be read, `damaged` True when the end is missing; the notes say
    why.
    """

    name: str
    cells: tuple[tuple[int, str], ...] = ()
    notes: tuple[str, ...] = ()
    readable: bool = True
    damaged: bool = False

    @property
    def defines(self) -> frozenset[str]:
        """The names that its text seems to define at the top level."""
        found = (pair for _, source in self.cells for pair in _DEFINITION.findall(source))
        return frozenset(a or b for a, b in found)

    @property
    def functions(self) -> frozenset[str]:
        """Those of the names that are functions."""
        found = (pair for _, source in self.cells for pair in _DEFINITION.findall(source))
        return frozenset(a for a, _ in found if a)


@dataclass(frozen=True)
class Submission:
    """All that one student handed in."""

    student: str
    notebooks: tuple[Notebook, ...]

    @property
    def readable(self) -> bool:
        """Whether at least one file could be read."""
        return any(notebook.readable for notebook in self.notebooks)

    @property
    def damaged(self) -> bool:
        """Whether something of it may be lost."""
        return any(notebook.damaged or not notebook.readable for notebook in self.notebooks)

    @property
    def notes(self) -> tuple[str, ...]:
        """What is to be said of the files; with their names where there are several."""
        many = len(self.notebooks) > 1
        return tuple(f"{n.name}: {note}" if many else note for n in self.notebooks for note in n.notes)

    def holding(self, name: str) -> tuple[Notebook, ...]:
        """Return the notebooks that seem to define `name`."""
        return tuple(n for n in self.notebooks if name in n.defines)


def read_folder(folder: Path) -> list[Submission]:
    """Read the submissions in a folder: a notebook a student, or a folder a student, sorted by name.

    Raises
    ------
    UsageError
        If the folder is not there or holds no notebook.
    """
    if not folder.is_dir():
        seen = "is a file" if folder.exists() else "does not exist"
        raise UsageError(f"{folder} {seen}; give the folder that holds the submissions")
    files: dict[str, list[Path]] = {}
    for entry in sorted(folder.iterdir()):
        if _hidden(entry):
            continue
        if entry.is_dir():
            # A folder without a notebook is a student too: a row says that there is nothing to grade.
            found = [] if entry.is_symlink() else sorted(_notebooks_in(entry))
            files.setdefault(entry.name, []).extend(found)
        elif entry.suffix.lower() in SUFFIXES:
            files.setdefault(entry.stem, []).append(entry)
    if not files:
        raise UsageError(
            f"{folder} holds no submissions; put a notebook a student into it, or a folder a student"
        )
    return [Submission(student, _read_all(paths)) for student, paths in sorted(files.items())]


def _hidden(path: Path) -> bool:
    return path.name.startswith((".", "__"))


def _notebooks_in(folder: Path) -> Iterator[Path]:
    for path in folder.iterdir():
        if _hidden(path) or path.is_symlink():
            continue
        if path.is_dir():
            yield from _notebooks_in(path)
        elif path.suffix.lower() in SUFFIXES:
            yield path


def _read_all(paths: Iterable[Path]) -> tuple[Notebook, ...]:
    notebooks = tuple(read_notebook(path) for path in paths)
    return notebooks or (Notebook("", notes=("the folder holds no notebook",), readable=False),)


class _Unreadable(Exception):
    """Why a file cannot be read."""


def read_notebook(path: Path) -> Notebook:
    """Read one file. It never raises: what cannot be read is said in the notes."""
    try:
        text, notes = _decode(_bytes_of(path))
        if path.suffix.lower() == ".py":
            return Notebook(path.name, tuple(_split(text)), notes)
        content, damage = _parsed(text)
        cells = _cells_of(content)
    except _Unreadable as error:
        return Notebook(path.name, notes=(f"the file cannot be read: {error}",), readable=False)
    return Notebook(
        path.name, tuple(_code(cells)), (*notes, *damage, *_misplaced(cells)), damaged=bool(damage)
    )


def _bytes_of(path: Path) -> bytes:
    try:
        if path.is_symlink():
            raise _Unreadable("it is a link to another place")
        if path.stat().st_size > MAX_BYTES:
            raise _Unreadable(f"it is larger than {MAX_BYTES // 2**20} MB")
        raw = path.read_bytes()
    except OSError as error:
        raise _Unreadable(error.strerror or "it cannot be opened") from None
    if not raw.strip():
        raise _Unreadable("it is empty")
    return raw


def _parsed(text: str) -> tuple[object, tuple[str, ...]]:
    """Return what a file holds, or the cells before its damage, and what is to be said of it."""
    try:
        return json.loads(text), ()
    except (ValueError, RecursionError) as error:
        cells = list(_whole_cells(text))
        if not cells:
            raise _Unreadable(f"it is not a notebook ({str(error)[:80]})") from None
        word = "one cell" if len(cells) == 1 else f"{len(cells)} cells"
        return {"cells": cells}, (f"the file is damaged; {word} before the damage could be read",)


def _whole_cells(text: str) -> Iterator[object]:
    """Yield the cells of a notebook that can be read one by one, until one cannot."""
    start = re.search(r'"cells"\s*:\s*\[', text)
    at = start.end() if start else len(text)
    decoder = json.JSONDecoder()
    while gap := _BETWEEN.match(text, at):
        try:
            cell, at = decoder.raw_decode(text, gap.end())
        except (ValueError, RecursionError):
            return
        yield cell


def _decode(raw: bytes) -> tuple[str, tuple[str, ...]]:
    encoding = next((name for bom, name in _BOMS.items() if raw.startswith(bom)), "utf-8")
    try:
        return raw.decode(encoding).replace("\r\n", "\n"), ()
    except UnicodeDecodeError:
        return raw.decode("latin-1").replace("\r\n", "\n"), ("the file is not UTF-8; read as Latin-1",)


def _split(text: str) -> Iterator[tuple[int, str]]:
    """Split a script at the marks that editors put between cells."""
    parts = re.split(r"^(?=# ?%%|# In\[)", text, flags=re.MULTILINE)
    return ((i, part) for i, part in enumerate((p for p in parts if p.strip()), start=1))


def _cells_of(content: object) -> list[dict[str, Any]]:
    """Find the cells of a notebook of format 4, or of format 3, which keeps them in worksheets."""
    if not isinstance(content, dict):
        raise _Unreadable("it is JSON, but not a notebook")
    groups = [content]
    if not isinstance(content.get("cells"), list):
        sheets = content.get("worksheets")
        groups = [sheet for sheet in sheets if isinstance(sheet, dict)] if isinstance(sheets, list) else []
    lists = [group["cells"] for group in groups if isinstance(group.get("cells"), list)]
    if not lists:
        raise _Unreadable("it is JSON, but not a notebook")
    return [cell for cells in lists for cell in cells if isinstance(cell, dict)]


def _source(cell: dict[str, Any]) -> str:
    source = cell.get("source", cell.get("input", ""))
    if isinstance(source, list):
        source = "".join(line for line in source if isinstance(line, str))
    return source.replace("\r\n", "\n") if isinstance(source, str) else ""


def _code(cells: list[dict[str, Any]]) -> Iterator[tuple[int, str]]:
    numbered = enumerate(cells, start=1)
    return ((i, _source(cell)) for i, cell in numbered if cell.get("cell_type") == "code")


def _misplaced(cells: list[dict[str, Any]]) -> Iterator[str]:
    """Say where a function stands in a cell that is not code."""
    for i, cell in enumerate(cells, start=1):
        found = re.match(r"def\s+(\w{1,100})\s*\(", _source(cell))
        if found and cell.get("cell_type") != "code":
            yield f"{found[1]} stands in cell {i}, which is not a code cell"
