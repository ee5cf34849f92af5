"""Reading a notebook that a student handed in.

It is read leniently: whatever is in the file, a `Notebook` comes out that says what could be read. JSON is
read directly and not through nbformat, which refuses notebooks that a tool has damaged a little.
"""

from __future__ import annotations

import codecs
import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePath
from typing import Any

from gpcourse.grading.archives import Unreadable, read_file

SUFFIXES = (".ipynb", ".py")
#: The most lists, objects and items of a file: each takes Python a hundred bytes, and 100 MB hold 50 million.
MAX_VALUES = 4_000_000

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

    @cached_property
    def defines(self) -> frozenset[str]:
        """The names that its text seems to define at the top level."""
        found = (pair for _, source in self.cells for pair in _DEFINITION.findall(source))
        return frozenset(a or b for a, b in found)

    @cached_property
    def functions(self) -> frozenset[str]:
        """Those of the names that are functions."""
        found = (pair for _, source in self.cells for pair in _DEFINITION.findall(source))
        return frozenset(a for a, _ in found if a)


def read_notebook(path: Path) -> Notebook:
    """Read one file. It never raises: what cannot be read is said in the notes."""
    return notebook(path.name, lambda: read_file(path))


def notebook(name: str, content: Callable[[], bytes]) -> Notebook:
    """Read the file `name` with this content, which may raise `Unreadable`. Nothing else is raised."""
    try:
        raw = content()
        if not raw.strip():
            raise Unreadable("it is empty")
        text, notes = _decode(raw)
        if PurePath(name).suffix.lower() == ".py":
            return Notebook(name, tuple(_split(text)), notes)
        if sum(map(text.count, ",[{")) > MAX_VALUES:
            raise Unreadable("it holds millions of values; clear its outputs and hand it in again")
        document, damage = _parsed(text)
        cells = _cells_of(document)
    except Unreadable as error:
        return unreadable(name, f"the file cannot be read: {error}")
    return Notebook(name, tuple(_code(cells)), (*notes, *damage, *_misplaced(cells)), damaged=bool(damage))


def unreadable(name: str, note: str) -> Notebook:
    """Stand for a file that cannot be read."""
    return Notebook(name, notes=(note,), readable=False)


def _parsed(text: str) -> tuple[object, tuple[str, ...]]:
    """Return what a file holds, or the cells before its damage, and what is to be said of it."""
    try:
        return json.loads(text), ()
    except (ValueError, RecursionError) as error:
        cells = list(_whole_cells(text))
        if not cells:
            raise Unreadable(f"it is not a notebook ({str(error)[:80]})") from None
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
        raise Unreadable("it is JSON, but not a notebook")
    groups = [content]
    if not isinstance(content.get("cells"), list):
        sheets = content.get("worksheets")
        groups = [sheet for sheet in sheets if isinstance(sheet, dict)] if isinstance(sheets, list) else []
    lists = [group["cells"] for group in groups if isinstance(group.get("cells"), list)]
    if not lists:
        raise Unreadable("it is JSON, but not a notebook")
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
