"""Filling the stubs of a notebook, so that it runs to its end without `gpcourse.reference`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Any

from gpcourse.errors import NotebookError
from gpcourse.exercises.exercise import Exercise
from gpcourse.notebook.closure import Import, closure, imports_of
from gpcourse.notebook.document import Document, code_cells, imports_in, source_of
from gpcourse.notebook.stubs import exercises_in, replaced

#: Gives the function that fills the stub of an exercise, or None to leave the stub.
Choose = Callable[[Exercise], Callable[..., Any] | None]

_WIDTH = 110


def reference_of(exercise: Exercise) -> Callable[..., Any]:
    """Choose the reference for every exercise."""
    return exercise.reference


def solve(document: Document, choose: Choose = reference_of) -> Document:
    """Return a copy of the notebook in which the function of every exercise is filled in.

    Each function comes with the imports and the private helpers that it needs, unless an earlier
    cell has the import. A function of another exercise of the same notebook is called, not copied.

    Parameters
    ----------
    document : dict
        A notebook of nbformat 4.
    choose : callable, optional
        ``choose(exercise)`` gives the function to fill in: the reference by default, or a
        variant or a mistake; None leaves the stub.

    Raises
    ------
    NotebookError
        If a cell that defines an exercise cannot be parsed.
    """
    given = frozenset(exercise.name for exercise in exercises_in(document))

    def filled(exercise: Exercise, number: int) -> str | None:
        function = choose(exercise)
        if function is None:
            return None
        needs = closure(function, exercise.name, given)
        parts = [definition.source for definition in needs.definitions]
        there = _imported_before(document, number)
        imports = _import_lines(each for each in needs.imports if not _is_there(each, there))
        return "\n\n\n".join(filter(None, ["\n".join(imports), *parts]))

    return replaced(document, filled)


def _imported_before(document: Document, number: int) -> set[Import]:
    found: set[Import] = set()
    for i, cell in code_cells(document):
        if i < number and "import" in source_of(cell):
            with suppress(NotebookError):  # a cell that cannot be read imports nothing
                found.update(each for node in imports_in(cell, i) for each in imports_of(node))
    return found


def _is_there(wanted: Import, there: set[Import]) -> bool:
    """Tell whether an import is there already; `gpcourse` itself offers some names of its modules."""
    return wanted in there or (
        wanted.module.startswith("gpcourse.") and Import("gpcourse", wanted.name, wanted.alias) in there
    )


def _import_lines(imports: Iterable[Import]) -> list[str]:
    """Write imports, those of one module in one statement."""
    plain, members = [], dict[str, list[str]]()
    for each in sorted(imports, key=lambda i: (i.module, i.name)):
        if each.name:
            part = each.name if each.alias == each.name else f"{each.name} as {each.alias}"
            members.setdefault(each.module, []).append(part)
        else:
            plain.append(f"import {each.module}" + ("" if each.alias == each.module else f" as {each.alias}"))
    return plain + [_from(module, names) for module, names in members.items()]


def _from(module: str, names: list[str]) -> str:
    line = f"from {module} import {', '.join(names)}"
    if len(line) <= _WIDTH:
        return line
    return "\n".join([f"from {module} import (", *(f"    {name}," for name in names), ")"])
