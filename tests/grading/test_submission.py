"""Files are read leniently, and what cannot be read is said."""

import json
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gpcourse.errors import UsageError
from gpcourse.grading.submission import read_folder, read_notebook

SOURCE = "def genus(mesh):\n    return 0\n"


def notebook(*sources, **fields):
    cells = [{"cell_type": "code", "source": source} for source in sources]
    return json.dumps({"cells": cells, "nbformat": 4, "nbformat_minor": 5, "metadata": {}} | fields)


def read(tmp_path, content, name="ada.ipynb"):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_notebook(path)


@pytest.mark.parametrize(
    "content",
    [
        notebook(SOURCE),
        notebook(SOURCE.splitlines(keepends=True)),
        notebook(SOURCE.replace("\n", "\r\n")),
        notebook(SOURCE).encode("utf-8-sig"),
        notebook(SOURCE).encode("utf-16"),
        json.dumps({"cells": [{"cell_type": "code", "source": SOURCE}]}),
        json.dumps({"nbformat": 3, "worksheets": [{"cells": [{"cell_type": "code", "input": SOURCE}]}]}),
        notebook(SOURCE, metadata={"kernelspec": {"name": "julia"}}, nbformat="four"),
        notebook(SOURCE, 3, None, ["x", 5]),
        json.dumps({"cells": [{"cell_type": "code", "source": SOURCE}, "not a cell", None]}),
    ],
    ids=["4.5", "lines", "windows", "bom", "utf-16", "4.0", "3", "metadata", "no text", "no cells"],
)
def test_notebooks_of_every_make_are_read(tmp_path, content):
    one = read(tmp_path, content)
    assert one.readable
    assert one.cells[0] == (1, SOURCE)
    assert "genus" in one.defines


def test_latin_1_is_read_and_said(tmp_path):
    one = read(
        tmp_path, notebook("x = 1  # Größe").replace("\\u00f6", "ö").replace("\\u00df", "ß").encode("latin-1")
    )
    assert "Größe" in one.cells[0][1]
    assert "Latin-1" in one.notes[0]


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ("", "empty"), (" \n", "empty"), ("{", "not a notebook"), ("[]", "not a notebook"),
        ("3", "not a notebook"), ("{}", "not a notebook"), ('{"cells": [{"cell_type"', "not a notebook"),
        (b"\0\xff" * 50, "not a notebook"), ("[" * 100_000, "not a notebook"),
        ('{"cells": 3}', "not a notebook"), ("PK\x03\x04", "not a notebook"),
    ],
)  # fmt: skip
def test_what_is_no_notebook_is_said_to_be_none(tmp_path, content, why):
    one = read(tmp_path, content)
    assert not one.readable
    assert why in one.notes[0]


@given(st.binary(max_size=300) | st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(
        st.sampled_from(["cells", "worksheets", "cell_type", "source", "input", "code"]), inner, max_size=4),
    max_leaves=12,
).map(lambda value: json.dumps(value).encode()))  # fmt: skip
@settings(max_examples=150, deadline=None)
def test_no_content_raises(tmp_path_factory, content):
    folder = tmp_path_factory.getbasetemp() / "fuzz"
    folder.mkdir(exist_ok=True)
    one = read(folder, content)
    assert one.readable or one.notes


def test_a_function_in_a_cell_of_text_is_pointed_out(tmp_path):
    content = json.dumps({"cells": [{"cell_type": "markdown", "source": SOURCE}]})
    assert "genus stands in cell 1" in read(tmp_path, content).notes[0]


def test_a_script_is_split_at_its_marks(tmp_path):
    one = read(tmp_path, "import math\n# %%\ndef f(:\n# In[3]:\ndef genus(m): pass\n", "ada.py")
    assert [number for number, _ in one.cells] == [1, 2, 3]
    assert "genus" in one.defines


def test_a_class_of_files_and_folders(tmp_path):
    (tmp_path / "bo.ipynb").write_text(notebook(SOURCE))
    (tmp_path / "ada" / "deep").mkdir(parents=True)
    (tmp_path / "ada" / "deep" / "my work.ipynb").write_text(notebook(SOURCE))
    (tmp_path / "ada" / ".ipynb_checkpoints").mkdir()
    (tmp_path / "ada" / ".ipynb_checkpoints" / "old.ipynb").write_text(notebook("x"))
    (tmp_path / "cy").mkdir()
    (tmp_path / "__MACOSX").mkdir()
    (tmp_path / "README.md").write_text("no submission")
    submissions = read_folder(tmp_path)
    assert [s.student for s in submissions] == ["ada", "bo", "cy"]
    assert [n.name for n in submissions[0].notebooks] == ["my work.ipynb"]
    assert not submissions[2].readable
    assert "holds no notebook" in submissions[2].notes[0]


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_links_out_of_the_folder_are_not_followed(tmp_path):
    (tmp_path / "secret.ipynb").write_text(notebook(SOURCE))
    (tmp_path / "class" / "eve").mkdir(parents=True)
    (tmp_path / "class" / "ada.ipynb").symlink_to(tmp_path / "secret.ipynb")
    (tmp_path / "class" / "mal").symlink_to(tmp_path)
    (tmp_path / "class" / "eve" / "a.ipynb").symlink_to(tmp_path / "secret.ipynb")
    submissions = read_folder(tmp_path / "class")
    assert [s.student for s in submissions] == ["ada", "eve", "mal"]
    assert not any(s.readable for s in submissions)
    assert "link" in submissions[0].notes[0]


def test_a_folder_without_a_notebook_has_a_row(tmp_path):
    for name in ("essay.pdf", "notes.txt"):
        (tmp_path / "ida").mkdir(exist_ok=True)
        (tmp_path / "ida" / name).write_text("no notebook")
    (tmp_path / "jo" / ".ipynb_checkpoints").mkdir(parents=True)
    (tmp_path / "jo" / ".ipynb_checkpoints" / "1-checkpoint.ipynb").write_text(notebook(SOURCE))
    submissions = read_folder(tmp_path)
    assert [(s.student, s.readable) for s in submissions] == [("ida", False), ("jo", False)]


def test_a_folder_without_submissions_is_refused(tmp_path):
    (tmp_path / "file.ipynb").write_text(notebook(SOURCE))
    (tmp_path / "empty").mkdir()
    for folder in ("nowhere", "empty", "file.ipynb"):
        with pytest.raises(UsageError, match="submissions"):
            read_folder(tmp_path / folder)


def test_a_variable_that_is_called_like_an_exercise_brings_in_no_chapter(tmp_path):
    from gpcourse.grading.run import chapters_in

    (tmp_path / "ada.ipynb").write_text(notebook("def triangle_area(a, b, c):\n    return 0\ncube = 3"))
    assert [chapter.stem for chapter in chapters_in(read_folder(tmp_path)[0].notebooks)] == ["welcome"]


@pytest.mark.parametrize("lost", [1, 9, 40])
def test_of_a_file_that_is_cut_off_the_whole_cells_count(tmp_path, lost):
    cells = [{"cell_type": "code", "source": f"def f{i}(): return {i}", "outputs": []} for i in range(5)]
    text = json.dumps({"cells": cells})
    path = tmp_path / "ada.ipynb"
    path.write_text(text[:-lost])
    read = read_notebook(path)
    whole = 5 if lost == 1 else 4
    assert read.readable
    assert [source for _, source in read.cells] == [cell["source"] for cell in cells[:whole]]
    assert read.notes == (f"the file is damaged; {whole} cells before the damage could be read",)


def test_what_comes_after_damage_is_not_guessed(tmp_path):
    text = json.dumps({"cells": [{"cell_type": "code", "source": f"x = {i}"} for i in range(4)]})
    path = tmp_path / "ada.ipynb"
    path.write_text(text.replace('"x = 2"', '"x = 2'))
    assert [source for _, source in read_notebook(path).cells] == ["x = 0", "x = 1"]


def test_no_one_who_handed_something_in_is_passed_over(tmp_path, monkeypatch):
    folder = tmp_path / "class"
    (folder / "shut").mkdir(parents=True)
    (folder / "ada.ipynb.txt").write_text(notebook(SOURCE))
    (folder / "bo.rar").write_bytes(b"Rar!")
    (folder / "cy.tar.gz").write_bytes(b"\x1f\x8b")
    iterdir = Path.iterdir

    def refuse(path):
        if path.name == "shut":
            raise PermissionError(13, "Permission denied")
        return iterdir(path)

    monkeypatch.setattr(Path, "iterdir", refuse)
    found = {s.student: s for s in read_folder(folder)}
    assert sorted(found) == ["ada", "bo", "cy", "shut"]
    assert found["ada"].readable
    assert "it is not opened" in found["bo"].notes[0]
    assert "Permission denied" in found["shut"].notes[0]
