"""The notebooks as files: stubs that match the reference, facts with their output, and nothing stale."""

import ast
import inspect
import json
import re
import textwrap
from itertools import pairwise
from pathlib import Path

import nbformat
import pytest

from gpcourse.exercises.course import CHAPTERS

NOTEBOOKS = Path(__file__).resolve().parents[2] / "notebooks"
FACT = "nbval-check-output"

chapters = pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda chapter: chapter.stem)


def cells_of(chapter):
    return json.loads((NOTEBOOKS / chapter.notebook).read_text("utf-8"))["cells"]


def code_cells(chapter):
    return [cell for cell in cells_of(chapter) if cell["cell_type"] == "code"]


def source(cell):
    return "".join(cell["source"])


def exercise_name(cell):
    return cell["metadata"].get("gpcourse", {}).get("exercise")


def stubs(chapter):
    return {exercise_name(cell): source(cell) for cell in code_cells(chapter) if exercise_name(cell)}


def test_each_chapter_has_its_notebook_and_there_is_no_other():
    assert sorted(path.name for path in NOTEBOOKS.glob("*.ipynb")) == [c.notebook for c in CHAPTERS]


@chapters
def test_a_notebook_follows_the_format(chapter):
    notebook = nbformat.read(NOTEBOOKS / chapter.notebook, as_version=nbformat.NO_CONVERT)
    nbformat.validate(notebook)
    assert (notebook.nbformat, notebook.nbformat_minor) == (4, 5)
    assert notebook.metadata.kernelspec.name == "python3"
    assert notebook.metadata.language_info == {"name": "python"}


@chapters
def test_cell_ids_are_readable_words(chapter):
    ids = [cell["id"] for cell in cells_of(chapter)]
    assert len(set(ids)) == len(ids)
    assert all(re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name) for name in ids)


@chapters
def test_only_facts_carry_output_and_all_of_it_is_text(chapter):
    for cell in code_cells(chapter):
        fact = FACT in cell["metadata"].get("tags", [])
        assert [output["output_type"] for output in cell["outputs"]] == ["stream"] * fact, cell["id"]
        assert all(output["name"] == "stdout" and output["text"] for output in cell["outputs"])
        # nbval takes output without a count for a mistake. Elsewhere a count would change with each run.
        assert cell["execution_count"] == (1 if fact else None), cell["id"]


@chapters
def test_the_stubs_are_the_exercises_in_their_order(chapter):
    names = [exercise_name(cell) for cell in code_cells(chapter) if exercise_name(cell)]
    assert names == [exercise.name for exercise in chapter.exercises]


@chapters
def test_a_stub_has_the_signature_and_docstring_of_the_reference_and_does_nothing(chapter):
    given = stubs(chapter)
    for exercise in chapter.exercises:
        [stub] = ast.parse(given[exercise.name]).body
        [reference] = ast.parse(textwrap.dedent(inspect.getsource(exercise.reference))).body
        assert isinstance(stub, ast.FunctionDef)
        assert (stub.name, ast.dump(stub.args)) == (reference.name, ast.dump(reference.args))
        assert ast.dump(stub.returns) == ast.dump(reference.returns)
        assert ast.get_docstring(stub) == inspect.getdoc(exercise.reference)
        assert [ast.unparse(statement) for statement in stub.body[1:]] == ["raise NotImplementedError"]


@chapters
def test_the_check_of_an_exercise_follows_its_stub(chapter):
    cells = code_cells(chapter)
    for cell, following in pairwise(cells):
        if exercise_name(cell):
            assert source(following) == f"check({exercise_name(cell)})"


@chapters
def test_only_a_stub_defines_the_name_of_an_exercise(chapter):
    """The grader takes the last definition of a name: one further down would replace the student's."""
    names = {exercise.name for exercise in chapter.exercises}
    for cell in code_cells(chapter):
        if exercise_name(cell):
            continue
        nodes = list(ast.walk(ast.parse(source(cell))))
        stored = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        defined = {n.name for n in nodes if isinstance(n, (ast.FunctionDef, ast.ClassDef))}
        assert not names & (stored | defined), cell["id"]


@chapters
def test_a_folded_answer_is_set_off_so_that_its_formulas_are_drawn(chapter):
    """Markdown inside <details> is read only after a blank line."""
    for cell in cells_of(chapter):
        text = source(cell)
        assert text.count("<details>") == text.count("</details>"), cell["id"]
        for answer in re.findall(r"</summary>(.*?)</details>", text, re.DOTALL):
            assert answer.startswith("\n\n"), cell["id"]
            assert answer.endswith("\n\n"), cell["id"]
