"""Notebooks as files, and the functions in their cells."""

from __future__ import annotations

import ast
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from gpcourse.errors import NotebookError
from gpcourse.sandbox.program import parse

#: A notebook, or one of its cells, as nbformat 4 has it.
Document = dict[str, Any]
Cell = dict[str, Any]


def read(path: Path) -> Document:
    """Read a notebook.

    Raises
    ------
    NotebookError
        If the file cannot be read or is no notebook of nbformat 4; the message says which and why.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise NotebookError(f"{path} cannot be read: {error.strerror or error}") from None
    except (ValueError, RecursionError):
        raise NotebookError(f"{path} is no notebook: it holds no JSON; save it again in JupyterLab") from None
    cells = content.get("cells") if isinstance(content, dict) else None
    if not isinstance(cells, list) or not all(isinstance(cell, dict) for cell in cells):
        raise NotebookError(f"{path} is no notebook of format 4; open and save it in JupyterLab")
    return content  # type: ignore[no-any-return]  # a dict, as seen above


def written(document: Document) -> str:
    """Return the text of a notebook file, as nbformat writes it."""
    cells = [{**cell, "source": source_of(cell).splitlines(keepends=True)} for cell in document["cells"]]
    return json.dumps({**document, "cells": cells}, ensure_ascii=False, indent=1, sort_keys=True) + "\n"


def source_of(cell: Cell) -> str:
    """Return the source of a cell, which files hold as a text or as a list of lines."""
    source = cell.get("source", "")
    return source if isinstance(source, str) else "".join(map(str, source))


def code_cells(document: Document) -> Iterator[tuple[int, Cell]]:
    """Yield the code cells, each with its number among all cells, from 1."""
    return ((i, cell) for i, cell in enumerate(document["cells"], start=1) if cell.get("cell_type") == "code")


def functions_in(cell: Cell, number: int) -> dict[str, ast.FunctionDef]:
    """Map the names of the functions at the top level of a cell to their definitions, the last one each.

    Raises
    ------
    NotebookError
        If the cell cannot be parsed.
    """
    return {node.name: node for node in _tree(cell, number).body if isinstance(node, ast.FunctionDef)}


def imports_in(cell: Cell, number: int) -> Iterator[ast.Import | ast.ImportFrom]:
    """Yield the imports at the top level of a cell; NotebookError if it cannot be parsed."""
    return (node for node in _tree(cell, number).body if isinstance(node, (ast.Import, ast.ImportFrom)))


def _tree(cell: Cell, number: int) -> ast.Module:
    try:
        return parse(source_of(cell), f"cell {number}")
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        line = getattr(error, "lineno", None)
        where = f"cell {number}" + (f", line {line}" if line else "")
        raise NotebookError(f"{where} cannot be read as Python: {getattr(error, 'msg', error)}") from None


def replace_lines(source: str, first: int, last: int, text: str) -> str:
    """Replace the lines `first` to `last`, counted from 1, by `text`."""
    lines = source.split("\n")
    return "\n".join([*lines[: first - 1], *text.split("\n"), *lines[last:]])


def first_line(node: ast.FunctionDef) -> int:
    """Return the line on which a definition begins, its decorators included."""
    return min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
