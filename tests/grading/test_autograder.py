"""`pytest tests/autograder`: a test an exercise, and nothing without a notebook."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
NOTEBOOK = """
import numpy as np
def triangle_area(a, b, c):
    return -1.0
"""


def run(*options):
    command = [sys.executable, "-m", "pytest", "tests/autograder", "-p", "no:cacheprovider", "-p", "no:xdist"]
    return subprocess.run([*command, *options], cwd=ROOT, capture_output=True, text=True, check=False)


def test_a_wrong_exercise_is_a_failure_with_the_students_words(tmp_path):
    (tmp_path / "ada.py").write_text(NOTEBOOK, "utf-8")
    done = run("--submission", str(tmp_path / "ada.py"), "--seed", "424243", "--allow-unconfined")
    assert done.returncode == 1, done.stderr
    assert "FAILED tests/autograder/test_submission.py::test_exercise[triangle_area]" in done.stdout
    assert "1 failed" in done.stdout
    assert "triangle_area: 0 of" in done.stdout
    assert "Traceback" not in done.stdout
    assert "424243" not in done.stdout


def test_without_a_notebook_one_test_is_skipped_and_says_why():
    done = run()
    assert done.returncode == 0
    assert "1 skipped" in done.stdout
    assert "give --submission NOTEBOOK" in done.stdout


def test_a_notebook_that_is_not_there_is_named():
    done = run("--submission", "nowhere.ipynb")
    assert done.returncode not in (0, 1)
    assert "--submission nowhere.ipynb: there is no such file" in done.stdout + done.stderr
