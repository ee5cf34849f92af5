"""Keeping the stubs of a notebook in step with the references.

``python -m gpcourse.notebook.stubs NOTEBOOK…`` writes the stubs anew; with ``--check`` it only says
which notebooks are out of step.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path

from gpcourse.errors import NotebookError
from gpcourse.exercises.course import by_name
from gpcourse.exercises.exercise import Exercise
from gpcourse.notebook.document import (
    Cell,
    Document,
    code_cells,
    first_line,
    functions_in,
    read,
    replace_lines,
    source_of,
    written,
)

#: The last line of every stub.
TO_DO = "    raise NotImplementedError"


def stub_source(exercise: Exercise) -> str:
    """Return the stub of an exercise: signature and docstring of the reference, and nothing done."""
    source = inspect.getsource(inspect.unwrap(exercise.reference))
    node = ast.parse(source).body[0]
    if not isinstance(node, ast.FunctionDef):
        raise NotebookError(f"the reference of {exercise.name} is no function; write it with `def`")
    body = node.body[0]
    documented = isinstance(body, ast.Expr) and isinstance(body.value, ast.Constant)
    end = body.end_lineno if documented else body.lineno - 1
    # A remark to our own linter is nothing for a student.
    lines = [line.partition("  # noqa")[0] for line in source.splitlines()[node.lineno - 1 : end]]
    return "\n".join([*lines, TO_DO])


def exercises_in(document: Document) -> list[Exercise]:
    """Return the exercises that a notebook defines, in its order; one that is defined twice comes twice.

    Raises
    ------
    NotebookError
        If a cell that may define an exercise cannot be parsed.
    """
    known = by_name()
    return [
        known[name][1]
        for number, cell in code_cells(document)
        if _may_define(cell)
        for name in functions_in(cell, number)
        if name in known
    ]


def _may_define(cell: Cell) -> bool:
    """Tell whether a cell holds the beginning of an exercise; the others need not be readable."""
    source = source_of(cell)
    return "def " in source and any(f"def {name}" in source for name in by_name())


def replaced(document: Document, make: Callable[[Exercise, int], str | None]) -> Document:
    """Return the notebook with the function of every exercise replaced.

    ``make(exercise, number)`` gives the new source for the function in cell `number`, or None to
    leave it. Everything else stays as it is.

    Raises
    ------
    NotebookError
        If a cell that may define an exercise cannot be parsed.
    """
    known, result = by_name(), deepcopy(document)
    for number, cell in code_cells(result):
        if not _may_define(cell):
            continue
        functions = sorted(functions_in(cell, number).items(), key=lambda item: -item[1].lineno)
        for name, node in functions:
            new = make(known[name][1], number) if name in known else None
            if new is not None:
                end = node.end_lineno or node.lineno
                cell["source"] = replace_lines(source_of(cell), first_line(node), end, new)
    return result


def sync(path: Path, *, check: bool = False) -> bool:
    """Write the stubs of a notebook anew; return whether anything had to change.

    With `check` the file is left as it is.

    Raises
    ------
    NotebookError
        If the file is no notebook.
    """
    before = path.read_text(encoding="utf-8") if path.is_file() else ""
    after = written(replaced(read(path), lambda exercise, _: stub_source(exercise)))
    if after != before and not check:
        path.write_text(after, encoding="utf-8", newline="\n")
    return after != before


def main() -> None:
    """Run the command for maintainers."""
    import argparse

    parser = argparse.ArgumentParser(prog="python -m gpcourse.notebook.stubs", description=__doc__)
    parser.add_argument("notebooks", nargs="+", type=Path, metavar="NOTEBOOK")
    parser.add_argument(
        "--check", action="store_true", help="write nothing; exit with 1 if a notebook differs"
    )
    options = parser.parse_args()
    try:
        differing = [path for path in options.notebooks if sync(path, check=options.check)]
    except NotebookError as error:
        parser.error(str(error))
    for path in differing:
        print(f"{path}: {'out of step' if options.check else 'stubs written anew'}")
    raise SystemExit(bool(options.check and differing))


if __name__ == "__main__":
    main()
