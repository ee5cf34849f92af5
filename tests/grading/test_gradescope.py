"""The autograder of Gradescope, run in a folder that is laid out as Gradescope's."""

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from click.testing import CliRunner

from gpcourse.cli import main
from gpcourse.exercises.course import CHAPTERS
from gpcourse.grading import gradescope

SEED = 424_243
#: The fields and what they hold, by Gradescope's *Autograder Specifications*.
TOP = {
    "score": (int, float), "execution_time": (int, float), "output": str, "output_format": str,
    "test_output_format": str, "test_name_format": str, "visibility": str, "stdout_visibility": str,
    "extra_data": dict, "tests": list, "leaderboard": list,
}  # fmt: skip
TEST = {
    "score": (int, float), "max_score": (int, float), "status": str, "name": str, "name_format": str,
    "number": str, "output": str, "output_format": str, "tags": list, "visibility": str, "extra_data": dict,
}  # fmt: skip
FORMATS = {"text", "html", "simple_format", "md", "ansi"}
SEEN = {"hidden", "after_due_date", "after_published", "visible"}

pytestmark = pytest.mark.skipif(shutil.which("bash") is None, reason="Gradescope's scripts need bash")


def documented(results):
    """Check a results.json against Gradescope's fields."""
    for content, fields in [(results, TOP), *((test, TEST) for test in results["tests"])]:
        assert set(content) <= set(fields)
        assert all(isinstance(value, fields[name]) for name, value in content.items())
        assert content.get("output_format", "text") in FORMATS
        assert {content.get("visibility", "visible"), content.get("stdout_visibility", "hidden")} <= SEEN
    assert "score" in results
    assert all(test["status"] in ("passed", "failed") for test in results["tests"])


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """The folder /autograder, after Gradescope has unpacked the zip file."""
    folder = tmp_path_factory.mktemp("machine") / "autograder"
    archive = folder.parent / "autograder.zip"
    command = [
        "gradescope",
        "--out",
        str(archive),
        "--chapter",
        "0",
        "--seed",
        str(SEED),
        "--allow-unconfined",
    ]
    done = CliRunner().invoke(main, command)
    assert done.exit_code == 0, done.output
    with zipfile.ZipFile(archive) as file:
        file.extractall(folder / "source")
        modes = {info.filename: info.external_attr >> 16 & 0o777 for info in file.infolist()}
    assert modes["setup.sh"] == modes["run_autograder"] == 0o755
    shutil.copy(folder / "source" / "run_autograder", folder)
    return folder


def graded(root, files):
    """What comes of one submission: results.json, and what is printed for instructors."""
    for name in ("submission", "results"):
        shutil.rmtree(root / name, ignore_errors=True)
        (root / name).mkdir()
    for name, text in files.items():
        (root / "submission" / name).write_text(text, "utf-8")
    setting = {"GPCOURSE_AUTOGRADER": str(root), "GPCOURSE_PYTHON": sys.executable}
    done = subprocess.run(
        ["bash", str(root / "run_autograder")],
        env={**os.environ, **setting}, cwd=root.parent, capture_output=True, text=True, check=True,
    )  # fmt: skip
    results = json.loads((root / "results" / "results.json").read_text("utf-8"))
    documented(results)
    return results, done.stdout + done.stderr


def test_a_submission_gets_a_test_an_exercise_and_no_secret(root):
    exercises = CHAPTERS[0].exercises
    name = exercises[0].name
    wrong = f"def {name}(*args):\n    raise ValueError('not yet')\n"
    results, printed = graded(root, {"hand_in.py": wrong})
    assert [test["name"] for test in results["tests"]] == [exercise.name for exercise in exercises]
    assert [test["max_score"] for test in results["tests"]] == [exercise.points for exercise in exercises]
    assert results["score"] == 0
    assert results["stdout_visibility"] == "hidden"
    assert "ValueError" in results["tests"][0]["output"]
    seen = json.dumps(results)
    assert str(SEED) not in seen
    assert "/autograder" not in seen  # the end of `root` too
    assert "graded, 0 points" in printed


def test_a_folder_without_a_notebook_gets_a_reason(root):
    results, _ = graded(root, {"readme.txt": "later"})
    assert results["score"] == 0
    assert "there is no notebook, but readme.txt" in results["output"]


def test_when_the_autograder_breaks_students_read_a_sentence_and_instructors_the_cause(root):
    settings = root / "source" / "settings.json"
    before = settings.read_text("utf-8")
    settings.write_text("{", "utf-8")
    try:
        results, printed = graded(root, {"hand_in.py": ""})
    finally:
        settings.write_text(before, "utf-8")
    assert "not your fault" in results["output"]
    assert "JSONDecodeError" in printed
    assert "JSONDecodeError" not in json.dumps(results)


def test_the_zip_file_holds_the_course_pinned_packages_and_what_its_exercises_read(root):
    source = root / "source"
    lines = (source / "requirements.txt").read_text("utf-8").split()
    assert {"numpy", "scipy", "jinja2", "click"} <= {line.partition("==")[0] for line in lines}
    assert all(line.partition("==")[2] for line in lines)
    assert (source / "package" / "gpcourse" / "_course" / "scans" / "pebble.conf").is_file()
    with zipfile.ZipFile(root.parent / "autograder.zip") as file:
        assert not [name for name in file.namelist() if "__pycache__" in name]
    subprocess.run(["bash", "-n", str(source / "setup.sh")], check=True)


def test_the_same_course_gives_the_same_zip_file(tmp_path, monkeypatch):
    monkeypatch.setattr(gradescope, "_files", lambda: iter([("errors.py", Path(gradescope.__file__))]))
    for name in ("a.zip", "b.zip"):
        gradescope.build(tmp_path / name, ["1"], seed=3)
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--chapter", "99"], "no chapter '99'"),
        ([], "--chapter"),
        (["--chapter", "1", "--out", "."], "is a folder"),
    ],
)
def test_what_cannot_be_built_is_refused(tmp_path, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(main, ["gradescope", "--out", "a.zip", *options])
    assert done.exit_code == 2
    assert words in done.output
    assert not list(tmp_path.iterdir())
