"""A student's session in a real kernel."""

import re
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

import gpcourse

CELLS = {
    "imports": "import numpy as np\nfrom gpcourse import check, progress, working",
    "stub": "def triangle_area(a, b, c):\n    raise NotImplementedError",
    "check stub": "check(triangle_area)",
    "wrong": "def triangle_area(a, b, c):\n    return np.linalg.norm(np.cross(b - a, c - a))",
    "check wrong": "check(triangle_area)",
    "again": "triangle_area(*check(triangle_area).arguments)",
    "endless": "def triangle_area(a, b, c):\n    while True:\n        a = a + 1",
    "check endless": "check(triangle_area)",
    "error": "def helper(a):\n    return a.nothing\n\ndef triangle_area(a, b, c):\n    return helper(a)",
    "check error": "check(triangle_area)",
    "right": "def triangle_area(a, b, c):\n    return 0.5 * np.linalg.norm(np.cross(b - a, c - a))",
    "check right": "check(triangle_area)",
    "working": "working(triangle_area) is triangle_area",
    "misuse": "check(3)",
    "interrupt": "def triangle_area(a, b, c):\n    raise KeyboardInterrupt\ncheck(triangle_area)",
    "progress": "progress()",
}


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """What each cell put out."""
    cells = [nbformat.v4.new_code_cell(source) for source in CELLS.values()]
    notebook = nbformat.v4.new_notebook(cells=cells)
    folder = str(tmp_path_factory.mktemp("notebook"))
    client = NotebookClient(
        notebook, timeout=120, allow_errors=True, resources={"metadata": {"path": folder}}
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("GPCOURSE_PROGRESS", raising=False)
        patch.setenv("PYTHONPATH", str(Path(gpcourse.__file__).parents[1]))  # also where it is not installed
        client.execute()
    assert Path(folder, ".gpcourse-progress.json").is_file()
    return {name: cell.outputs for name, cell in zip(CELLS, notebook.cells, strict=True)}


def shown(outputs, name):
    return next(o.data for o in outputs[name] if o.output_type == "execute_result")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("check stub", "Not attempted yet"),
        ("check wrong", "It looks as if the ½ is missing."),
        ("check endless", "did not come to an end"),
        ("check error", "AttributeError"),
        ("check right", "Right: all 4 checks pass."),
    ],
)
def test_the_panel_says_what_happened(outputs, name, words):
    data = shown(outputs, name)
    assert words in data["text/plain"]
    assert words in data["text/html"]


def test_the_students_own_line_is_quoted_with_its_cell(outputs):
    assert "line 2 of cell 9, in `helper`: return a.nothing" in shown(outputs, "check error")["text/plain"]
    assert re.search("line [23] of cell 7, in `triangle_area`", shown(outputs, "check endless")["text/plain"])


def test_the_failing_call_can_be_run_again(outputs):
    assert "12" in shown(outputs, "again")["text/plain"]


def test_work_goes_on_with_the_students_own_function(outputs):
    assert shown(outputs, "working")["text/plain"] == "True"


@pytest.mark.parametrize(("name", "words"), [("misuse", "needs the function"), ("interrupt", "interrupted")])
def test_no_traceback_of_ours_is_seen(outputs, name, words):
    (error,) = [output for output in outputs[name] if output.output_type == "error"]
    assert len(error.traceback) == 1
    assert words in error.traceback[0]


def test_progress_is_kept_beside_the_notebook(outputs):
    assert "Chapter 0" in shown(outputs, "progress")["text/plain"]
