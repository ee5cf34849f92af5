"""The commands: what they print, what they write, and how they refuse."""

import json
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from click.testing import CliRunner

import gpcourse
from gpcourse.cli import main
from gpcourse.exercises.course import CHAPTERS
from gpcourse.notebook.document import code_cells, read, source_of

lab = import_module("gpcourse.cli.lab")  # `gpcourse.cli.lab` is the command

ROOT = Path(gpcourse.__file__).parents[1]
NOTEBOOKS = [ROOT / "notebooks" / chapter.notebook for chapter in CHAPTERS]
WELCOME = NOTEBOOKS[0]


def run(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


def everything_in(folder):
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def write(path, *sources):
    cells = [{"cell_type": "code", "metadata": {}, "outputs": [], "source": source} for source in sources]
    path.write_text(json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 4}))
    return path


RIGHT = (
    "import numpy as np\ndef triangle_area(a, b, c):\n    return np.linalg.norm(np.cross(b - a, c - a)) / 2"
)
WRONG = RIGHT.replace(" / 2", "")


# Refusing ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["check", "missing.ipynb"], "does not exist"),
        (["check", "."], "is a directory"),
        (["check", "text.ipynb"], "cannot be read"),
        (["check", "other.ipynb"], "defines no function of an exercise"),
        (["solve", "right.ipynb"], "--out"),
        (["solve", "--out", "new"], "NOTEBOOK"),
        (["solve", "text.ipynb", "--out", "new"], "text.ipynb"),
        (["solve", "right.ipynb", "text.ipynb", "--out", "new"], "text.ipynb"),
        (["solve", "broken.ipynb", "--out", "new"], "broken.ipynb: cell 1, line 1"),
        (["solve", "right.ipynb", "--out", "text.ipynb"], "is a file"),
        (["solve", "right.ipynb", "--out", "."], "is one of the notebooks to solve"),
        (["solve", "right.ipynb", "--out", ".", "--force"], "is one of the notebooks to solve"),
        (["solve", "right.ipynb", "--out", "full"], "is there already"),
        (["solve", "right.ipynb", "full/right.ipynb", "--out", "new"], "two notebooks are called"),
        (["exercises", "nothing"], "no chapter 'nothing'"),
        (["grade", "missing", "--out", "new"], "does not exist"),
        (["grade", "empty", "--out", "new"], "holds no submissions"),
        (["grade", "full"], "--out"),
        (["grade", "full", "--out", "new", "--seed", "-1"], "--seed"),
        (["grade", "full", "--out", "new", "--chapter", "nothing"], "no chapter 'nothing'"),
        (["grade", "full", "--out", "new", "--jobs", "0"], "--jobs"),
        (["nothing"], "No such command"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_bad_input_gets_a_clear_line_and_writes_nothing(tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    write(Path("right.ipynb"), RIGHT)
    write(Path("other.ipynb"), "x = 1")
    write(Path("broken.ipynb"), "def genus(:")
    Path("text.ipynb").write_text("no notebook")
    for folder in ("full", "empty"):
        Path(folder).mkdir()
    write(Path("full/right.ipynb"), RIGHT)
    before = everything_in(tmp_path)
    result = run(*words)
    assert result.exit_code == 2
    assert message in result.output
    assert "Traceback" not in result.output
    assert everything_in(tmp_path) == before
    assert not Path("new").exists()


# check ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("source", "options", "code", "words"),
    [
        (RIGHT, [], 0, "4 of 4 points"),
        (WRONG, [], 1, "the ½ is missing"),
        (WRONG, ["-v"], 1, "First problem: a right triangle"),
        ("def triangle_area(a, b, c):\n    raise NotImplementedError", [], 0, "not attempted"),
        ("def triangle_area(a, b, c):\n    raise NotImplementedError", ["--all"], 1, "not attempted"),
        ("def triangle_area(a, b, c):\n    import os\n    os._exit(0)", [], 1, "crashed"),
        ("def triangle_area(a, b, c):\n    raise ValueError('\\x1b[31m[red]<b>')", [], 1, "error"),
    ],
    ids=["right", "wrong", "verbose", "stub", "all", "crash", "error"],
)
def test_check_says_how_each_exercise_went(tmp_path, source, options, code, words):
    result = run("check", write(tmp_path / "a.ipynb", "1 / 0", source), *options)
    assert result.exit_code == code, result.output
    assert words in result.output
    assert "\x1b" not in result.output


# solve ------------------------------------------------------------------------------------------


def test_solved_notebooks_get_all_points_and_nothing_else_changes(tmp_path):
    before = everything_in(ROOT / "notebooks")
    assert run("solve", *NOTEBOOKS, "--out", tmp_path / "new" / "folder").exit_code == 0
    assert everything_in(ROOT / "notebooks") == before
    for chapter in CHAPTERS:
        solved = tmp_path / "new" / "folder" / chapter.notebook
        assert len(read(solved)["cells"]) == len(read(ROOT / "notebooks" / chapter.notebook)["cells"])
        assert "gpcourse.reference.halfedge import" not in solved.read_text(encoding="utf-8")
        result = run("check", "--all", solved)
        assert f"{chapter.points} of {chapter.points} points" in result.output
        assert result.exit_code == 0


def test_solve_writes_over_other_files_only_when_told_to(tmp_path):
    (tmp_path / WELCOME.name).write_text("precious")
    assert run("solve", WELCOME, "--out", tmp_path).exit_code == 2
    assert (tmp_path / WELCOME.name).read_text() == "precious"
    assert run("solve", WELCOME, "--out", tmp_path, "--force").exit_code == 0
    assert any("np.cross" in source_of(c) for _, c in code_cells(read(tmp_path / WELCOME.name)))


# exercises, doctor, version ---------------------------------------------------------------------


def test_exercises_are_listed_with_their_points():
    text = run("exercises").output
    assert all(e.name in text for chapter in CHAPTERS for e in chapter.exercises)
    listed = json.loads(run("exercises", "--json").output)
    assert [e["name"] for e in listed] == [e.name for chapter in CHAPTERS for e in chapter.exercises]
    assert all(sum(c["points"] for c in e["checks"]) == e["points"] for e in listed)


@pytest.mark.parametrize("name", ["1", "halfedge"])
def test_the_exercises_of_one_chapter(name):
    listed = json.loads(run("exercises", name, "--json").output)
    assert {e["chapter"] for e in listed} == {"halfedge"}


def test_the_doctor_finds_what_the_course_needs(monkeypatch):
    result = run("doctor")
    assert result.exit_code == 0, result.output
    assert "numpy" in result.output
    monkeypatch.setattr(import_module("gpcourse.cli.doctor"), "_NEEDED", ("no-such-package",))
    result = run("doctor")
    assert result.exit_code == 1
    assert "pip install no-such-package" in result.output


def test_the_version_and_the_module():
    code = [sys.executable, "-m", "gpcourse", "--version"]
    seen = subprocess.run(code, capture_output=True, text=True, cwd=ROOT, check=True)
    assert gpcourse.__version__ in seen.stdout


def test_the_command_line_starts_without_heavy_packages():
    code = (
        "import sys, gpcourse.cli; print([m for m in ('numpy', 'scipy', 'matplotlib', 'nbformat', 'jinja2',"
        " 'IPython', 'rich') if m in sys.modules])"
    )
    seen = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert seen.stdout.strip() == "[]"


# grade ------------------------------------------------------------------------------------------


@pytest.fixture
def submissions(tmp_path):
    folder = tmp_path / "submissions"
    folder.mkdir()
    write(folder / "right.ipynb", RIGHT)
    write(folder / "wrong.ipynb", WRONG)
    return folder


def test_grade_writes_a_grade_book_and_says_where(submissions, tmp_path):
    result = run("grade", submissions, "--out", tmp_path / "grades", "--seed", 7, "--allow-unconfined")
    assert result.exit_code == 0, result.output
    assert "2 submissions: 2 graded" in result.output
    assert str(tmp_path / "grades" / "index.html") in result.output
    assert (tmp_path / "grades" / "grades.csv").is_file()
    assert "--seed" not in result.stderr
    assert "Seed 0" in run("grade", submissions, "--out", tmp_path / "0", "--allow-unconfined").stderr


def test_grade_as_json_and_quietly(submissions, tmp_path):
    result = run("grade", submissions, "--out", tmp_path / "grades", "--json", "--allow-unconfined")
    summary = json.loads(result.stdout)
    assert {s["student"]: s["points"] for s in summary["students"]} == {"right": 4, "wrong": 1}
    quiet = run("grade", submissions, "--out", tmp_path / "again", "--quiet", "--allow-unconfined")
    assert quiet.exit_code == 0
    assert quiet.output == ""


def test_grade_refuses_where_it_cannot_confine(submissions, tmp_path, monkeypatch):
    confine = import_module("gpcourse.sandbox.confine")
    unconfined = import_module("gpcourse.sandbox.lockdown").Confinement("limits", ("seccomp: none here",))
    monkeypatch.setattr(confine, "level_here", lambda: unconfined)
    monkeypatch.setattr(import_module("gpcourse.grading.crews").Here, "confinement", lambda _: unconfined)
    result = run("grade", submissions, "--out", tmp_path / "grades")
    assert result.exit_code == 2
    assert "seccomp: none here" in result.output
    assert not (tmp_path / "grades").exists()
    assert "limits" in run("doctor").output
    assert run("check", submissions / "right.ipynb").exit_code == 0


# lab --------------------------------------------------------------------------------------------


def test_lab_opens_the_notebooks_of_this_folder_or_of_the_checkout(tmp_path):
    assert lab.notebooks(tmp_path) == ROOT / "notebooks"
    (tmp_path / "notebooks").mkdir()
    (tmp_path / "notebooks" / "0_welcome.ipynb").write_text("mine")
    assert lab.notebooks(tmp_path) == tmp_path / "notebooks"
    assert lab.notebooks(tmp_path / "notebooks") == tmp_path / "notebooks"


def test_installed_notebooks_are_copied_once_and_never_over_the_students_own(tmp_path, monkeypatch):
    monkeypatch.setattr(lab, "_CHECKOUT", tmp_path / "nowhere")
    monkeypatch.setattr(lab, "_INSTALLED", ROOT / "notebooks")
    copy = lab.notebooks(tmp_path)
    assert copy == tmp_path / lab.COPY
    assert {path.name for path in copy.iterdir()} >= {path.name for path in NOTEBOOKS}
    (copy / WELCOME.name).write_text("my own work")
    (copy / NOTEBOOKS[1].name).unlink()
    assert lab.notebooks(tmp_path) == copy
    assert (copy / WELCOME.name).read_text() == "my own work"
    assert (copy / NOTEBOOKS[1].name).is_file()
    assert lab.notebooks(copy) == copy


def test_an_installation_without_notebooks_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(lab, "_CHECKOUT", tmp_path / "nowhere")
    monkeypatch.setattr(lab, "_INSTALLED", tmp_path / "nowhere")
    monkeypatch.chdir(tmp_path)
    result = run("lab")
    assert result.exit_code == 2
    assert "holds no notebooks" in result.output


@pytest.mark.parametrize("browser", [True, False])
def test_lab_passes_its_options_on_and_knows_when_there_is_no_browser(tmp_path, monkeypatch, browser):
    started = []
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(lab, "_has_browser", lambda: browser)
    monkeypatch.setattr(lab, "_run", lambda words: started.extend(words) or 0)
    result = run("lab", "--port=9000", "--ServerApp.token=x")
    assert result.exit_code == 0
    assert started[-2:] == ["--port=9000", "--ServerApp.token=x"]
    assert f"--ServerApp.root_dir={ROOT / 'notebooks'}" in started
    assert ("--no-browser" in started) is not browser
    assert ("no browser here" in result.output) is not browser
