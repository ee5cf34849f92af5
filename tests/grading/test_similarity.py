"""Shared code: what a copy, a renamed copy, a copy of the reference, and work of one's own come to."""

import csv
import json
import re
import sys
import time

import pytest
from click.testing import CliRunner

from gpcourse.cli import main
from gpcourse.cli.lab import course_notebooks
from gpcourse.errors import UsageError
from gpcourse.grading.similarity import REFERENCE, compare
from gpcourse.notebook.document import read, written
from gpcourse.notebook.solving import solve

pytest.importorskip("copydetect", reason="the extra gpcourse[similarity] is not installed")

OWN = """
def genus(mesh):
    rims = boundary_loops(mesh)
    corners, sides, patches = len(mesh.positions), len(mesh.halfedges) // 2, len(mesh.faces)
    handles = 2 * count_pieces(mesh) - len(rims) - corners + sides - patches
    return handles // 2

def count_pieces(mesh):
    todo, pieces = set(range(len(mesh.positions))), 0
    while todo:
        pieces += 1
        heap = [todo.pop()]
        while heap:
            for other in ring(mesh, heap.pop()):
                if other in todo:
                    todo.remove(other)
                    heap.append(other)
    return pieces
"""


def notebook(source):
    return json.dumps({"cells": [{"cell_type": "code", "source": source}], "nbformat": 4})


@pytest.fixture
def folder(tmp_path):
    chapter = next(path for path in course_notebooks() if "halfedge" in path.name)
    given = read(chapter)
    texts = {
        "ann": notebook(OWN),
        "bob": notebook(re.sub("todo", "left_over", OWN).replace("heap", "# mine\n        stack", 0)),
        "cat": written(solve(given)),
        "dan": written(given),
        "<b>eve</b>": notebook(OWN.replace("pieces += 1", "pieces += 1  # </pre><script>alert(1)</script>")),
    }
    (tmp_path / "class").mkdir()
    for name, text in texts.items():
        (tmp_path / "class" / f"{name.replace('/', '_')}.ipynb").write_text(text, "utf-8")
    return tmp_path / "class"


def rows(out):
    return list(csv.DictReader((out / "similarity.csv").read_text("utf-8").splitlines()))


def test_copies_are_found_and_the_notebook_itself_is_not_counted(folder, tmp_path):
    pairs = compare(folder, course_notebooks(), tmp_path / "out")
    found = {frozenset(pair.names): pair for pair in pairs}
    copied = found[frozenset(("ann", "bob"))]
    assert copied.share == 1.0  # with a variable renamed
    assert found[frozenset(("cat", REFERENCE))].with_reference
    assert not any("dan" in names for names in found)  # the notebook as it was given out
    assert frozenset(("ann", "cat")) not in found
    assert {(row["one"], row["other"]) for row in rows(tmp_path / "out")} >= {copied.names}
    shared = "".join(copied.texts[0][a:b] for a, b in copied.spans[0])
    assert "heap.append" in shared


def test_the_page_shows_both_as_text(folder, tmp_path):
    done = CliRunner().invoke(main, ["similarity", str(folder), "--out", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    assert "with the reference solutions" in done.output
    page = (tmp_path / "out" / "similarity.html").read_text("utf-8")
    assert "<mark>" in page
    assert "like the reference" in page
    assert "<script" not in page
    assert "<b>eve" not in page
    assert "&lt;script&gt;" in page


def test_a_few_lines_in_common_are_no_pair(tmp_path):
    (tmp_path / "class").mkdir()
    for name in ("ann", "bob"):
        text = notebook("def triangle_area(a, b, c):\n    return norm(cross(b - a, c - a)) / 2")
        (tmp_path / "class" / f"{name}.ipynb").write_text(text, "utf-8")
    assert compare(tmp_path / "class", [], tmp_path / "out") == ()
    assert rows(tmp_path / "out") == []


def test_what_cannot_be_used_is_said(folder, tmp_path):
    with pytest.raises(UsageError, match="give a share above 0, up to 1"):
        compare(folder, [], tmp_path / "out", threshold=50)
    (tmp_path / "file").write_text("", "utf-8")
    with pytest.raises(UsageError, match="is a file; give a folder"):
        compare(folder, [], tmp_path / "file")


def test_the_code_keeps_its_indentation(folder, tmp_path):
    compare(folder, course_notebooks(), tmp_path / "out")
    assert "\n<mark>                if other in todo:</mark>" in (tmp_path / "out/similarity.html").read_text(
        "utf-8"
    )


def test_without_the_extra_it_is_named(folder, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "copydetect", None)
    with pytest.raises(UsageError, match=r"gpcourse\[similarity\]"):
        compare(folder, course_notebooks(), tmp_path / "out")


def test_the_page_shows_the_most_alike_and_counts_the_others(folder, tmp_path, monkeypatch):
    monkeypatch.setattr("gpcourse.grading.similarity.MOST", 1)
    pairs = compare(folder, course_notebooks(), tmp_path / "out", threshold=0.1)
    page = (tmp_path / "out/similarity.html").read_text("utf-8")
    assert len(pairs) > 2
    assert page.count('<details class="pair') == 1
    assert f"the other {len(pairs) - 1} are in similarity.csv" in page


def test_what_is_too_long_to_compare_holds_nobody_up_and_is_named(folder, tmp_path):
    (folder / "mal.ipynb").write_text(notebook("x = 1\n" * 10**6), "utf-8")
    told = []
    start = time.process_time()
    pairs = compare(folder, course_notebooks(), tmp_path / "out", tell=told.append)
    assert time.process_time() - start < 30
    assert frozenset(("ann", "bob")) in {frozenset(pair.names) for pair in pairs}
    assert [words.split(":")[0] for words in told] == ["mal"]
    assert "<b>mal</b>" in (tmp_path / "out" / "similarity.html").read_text("utf-8")
