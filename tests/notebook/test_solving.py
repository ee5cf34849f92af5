"""Stubs come from the references, and solved notebooks from stubs."""

import ast
import inspect
import os
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

from gpcourse.errors import NotebookError
from gpcourse.exercises.course import CHAPTERS, find
from gpcourse.exercises.judging import ask_here, judge
from gpcourse.notebook.closure import _Collector, closure
from gpcourse.notebook.document import read, source_of, written
from gpcourse.notebook.solving import solve
from gpcourse.notebook.stubs import exercises_in, replaced, stub_source, sync

ROOT = Path(__file__).parents[2]
EXERCISES = [exercise for chapter in CHAPTERS for exercise in chapter.exercises]
IMPORTS = """\
from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
from scipy import sparse

from gpcourse import HalfedgeMesh
from gpcourse.geometry.arrays import BoolArray, FloatArray, IntArray, Polygons

Pose = tuple[FloatArray, FloatArray]
"""


def code(source, **metadata):
    return {
        "cell_type": "code",
        "metadata": metadata,
        "outputs": [],
        "execution_count": None,
        "source": source,
    }


def notebook(*sources):
    cells = [code(source) for source in sources]
    return {"cells": cells, "metadata": {"kept": 1}, "nbformat": 4, "nbformat_minor": 5}


def stubs(*names):
    return notebook(IMPORTS, *(stub_source(find(name)) for name in names))


def run(document):
    """The names that the code cells of a notebook leave behind."""
    names = {"__name__": "__main__"}  # as in a kernel
    for cell in document["cells"]:
        if cell["cell_type"] == "code":
            exec(compile(source_of(cell), "<cell>", "exec"), names)
    return names


# Stubs ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda e: e.name)
def test_a_stub_has_the_signature_and_the_docstring_of_the_reference_and_does_nothing(exercise):
    made = run(notebook(IMPORTS, stub_source(exercise)))[exercise.name]
    assert inspect.getdoc(made) == inspect.getdoc(exercise.reference)
    assert list(inspect.signature(made).parameters) == list(exercise.signature.parameters)
    body = ast.parse(stub_source(exercise)).body[0].body
    assert [type(node) for node in body] == [ast.Expr, ast.Raise]
    assert judge(exercise, ask_here(made), 0).outcome == "not attempted"


def test_a_stub_is_replaced_and_the_rest_of_its_cell_kept():
    around = "# before\nx = '½'\ndef genus(mesh):\n    return 0\n# after\ny = 2"
    made = replaced(notebook(around), lambda exercise, number: f"# {exercise.name} in cell {number}")
    assert source_of(made["cells"][0]) == "# before\nx = '½'\n# genus in cell 1\n# after\ny = 2"
    assert made["metadata"] == {"kept": 1}


def test_two_stubs_in_one_cell_are_both_replaced():
    both = "def cube():\n    pass\n\n\ndef genus(mesh):\n    pass"
    made = replaced(notebook(both), lambda exercise, number: f"{exercise.name} = {number}")
    assert source_of(made["cells"][0]) == "cube = 1\n\n\ngenus = 1"


def test_magics_and_broken_cells_elsewhere_do_no_harm():
    made = notebook("%matplotlib inline\n!ls", "def broken(:", "%time 1\ndef genus(mesh):\n    pass")
    result = replaced(made, lambda exercise, number: "genus = 1")
    assert source_of(result["cells"][2]) == "%time 1\ngenus = 1"
    assert result["cells"][:2] == made["cells"][:2]


def test_a_broken_cell_of_an_exercise_is_named():
    with pytest.raises(NotebookError, match="cell 2, line 2"):
        replaced(notebook("x = 1", "def genus(mesh):\n    return ("), lambda exercise, number: "")


def test_sync_writes_the_stub_anew_and_then_rests(tmp_path):
    path = tmp_path / "a.ipynb"
    path.write_text(written(notebook(IMPORTS, "def genus():\n    'old'")), encoding="utf-8")
    assert sync(path, check=True)
    assert "'old'" in path.read_text(encoding="utf-8")
    assert sync(path)
    assert not sync(path)
    assert source_of(read(path)["cells"][1]) == stub_source(find("genus"))


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", '{"cells": 3}', '{"cells": [3]}', '{"worksheets": []}', "[" * 100_000],
    ids=range(7),
)
def test_what_is_no_notebook_is_refused_by_name(tmp_path, text):
    path = tmp_path / "a.ipynb"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(NotebookError, match=r"a\.ipynb"):
        read(path)


def test_notebooks_are_written_as_nbformat_writes_them(tmp_path):
    document = stubs("genus")
    document["cells"] = [{**cell, "id": f"c{i}"} for i, cell in enumerate(document["cells"])]
    assert written(document) == nbformat.writes(nbformat.from_dict(document)) + "\n"


@pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda c: c.stem)
def test_the_notebooks_of_the_course_are_in_step(chapter):
    path = Path(__file__).parents[2] / "notebooks" / chapter.notebook
    assert not sync(path, check=True), "run python -m gpcourse.notebook.stubs notebooks/*.ipynb"
    assert exercises_in(read(path)) == list(chapter.exercises)


# Solving ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda c: c.stem)
def test_solved_stubs_pass_all_their_checks(chapter):
    names = run(solve(stubs(*(e.name for e in chapter.exercises))))
    outcomes = {e.name: judge(e, ask_here(names[e.name]), 1).outcome for e in chapter.exercises}
    assert set(outcomes.values()) == {"passed"}, outcomes


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda e: e.name)
def test_a_notebook_with_one_exercise_only_is_solved_too(exercise):
    names = run(solve(stubs(exercise.name)))
    assert judge(exercise, ask_here(names[exercise.name]), 1).outcome == "passed"


def test_a_solved_notebook_runs_without_the_reference(tmp_path):
    document = solve(stubs(*(e.name for e in EXERCISES)))
    source = "\n\n".join(source_of(cell) for cell in document["cells"])
    used = "import sys\nassert not [m for m in sys.modules if m.startswith('gpcourse.reference')]"
    script = tmp_path / "solved.py"
    script.write_text(f"{source}\n\n{used}", encoding="utf-8")
    subprocess.run([sys.executable, script], check=True, env=os.environ | {"PYTHONPATH": str(ROOT)})


def test_a_function_of_the_same_notebook_is_called_and_not_copied():
    both = solve(stubs("genus", "euler_characteristic", "boundary_loops"))
    assert "def euler_characteristic" not in source_of(both["cells"][1])
    assert "def euler_characteristic" in source_of(solve(stubs("genus"))["cells"][1])


def test_imports_that_are_there_are_not_repeated():
    needed = "from gpcourse.geometry.halfedge_mesh import HalfedgeMesh"
    assert needed not in source_of(solve(stubs("face_vertices"))["cells"][1])
    assert needed in source_of(solve(notebook(stub_source(find("face_vertices"))))["cells"][0])
    later = notebook(stub_source(find("face_vertices")), needed)
    assert needed in source_of(solve(later)["cells"][0])


def test_a_broken_cell_elsewhere_does_not_keep_a_notebook_from_being_solved():
    document = stubs("genus")
    document["cells"].insert(0, code("import (\ndef other(:"))
    assert source_of(solve(document)["cells"][2]).count("def genus") == 1


def test_choosing_nothing_leaves_the_stub():
    document = stubs("genus", "cube")
    solved = solve(document, lambda e: e.reference if e.name == "cube" else None)
    assert solved["cells"][1] == document["cells"][1]
    assert solved["cells"][2] != document["cells"][2]


# The sample class is made of chapter 1, whose solutions stand alone or beside their helpers.
@pytest.mark.parametrize("exercise", CHAPTERS[0].exercises + CHAPTERS[1].exercises, ids=lambda e: e.name)
def test_variants_and_mistakes_can_be_filled_in(exercise):
    wanted = {id(v): "passed" for v in exercise.variants} | {id(m): "not passed" for m in exercise.mistakes}
    for each in (*exercise.variants, *exercise.mistakes):
        try:
            names = run(solve(stubs(exercise.name), lambda e, chosen=each.function: chosen))
        except NotebookError:
            continue  # made by another function, it has no source of its own
        verdict = judge(exercise, ask_here(names[exercise.name]), 0)
        assert (verdict.outcome == "passed") == (wanted[id(each)] == "passed"), each.name
        if wanted[id(each)] != "passed":
            assert each.name in [m.name for m in verdict.mistakes]


def test_a_function_made_by_another_is_refused_with_the_repair():
    def inner():
        pass

    inner.__module__ = "gpcourse.reference.halfedge"
    with pytest.raises(NotebookError, match="move it there"):
        closure(inner)


def test_a_local_variable_that_is_called_like_a_global_brings_in_nothing():
    variant = next(v for v in find("face_vertices").variants if "for _ in" in inspect.getsource(v.function))
    assert [d.name for d in closure(variant.function, "face_vertices").definitions] == ["face_vertices"]


def test_helpers_of_two_modules_with_one_name_are_kept_apart():
    collector = _Collector(frozenset(), taken={"genus", "_flip"})
    assert collector._free("_flip") != "_flip"
    assert collector._free("genus") == "_genus"
    assert collector._free("genus") == "_genus_"


def test_the_source_is_not_changed_by_collecting():
    reference = find("genus").reference
    assert closure(reference) == closure(reference)


def test_exercises_are_found_by_name_without_metadata():
    assert [e.name for e in exercises_in(stubs("genus", "cube"))] == ["genus", "cube"]
