"""Grading one notebook as pytest tests, for the CI of a course::

    pytest tests/autograder --submission ada.ipynb --seed 7

Without --submission there is nothing to grade: one test that is skipped.
"""

import json
import shutil
from pathlib import Path

import pytest

from gpcourse.grading import grade
from gpcourse.grading.run import chapters_in
from gpcourse.grading.submission import read_notebook


def pytest_addoption(parser):
    group = parser.getgroup("gpcourse")
    group.addoption("--submission", type=Path, metavar="NOTEBOOK", help="The notebook to grade.")
    group.addoption("--seed", type=int, default=0, help="Draws the inputs, as for gpcourse grade.")
    group.addoption("--allow-unconfined", action="store_true", help="Grade also where nothing confines it.")


def chapters_of(config):
    """The chapters of the notebook that is given; None without one."""
    path = config.getoption("--submission", default=None)
    if path is None:
        return None
    if not path.is_file():
        raise pytest.UsageError(f"--submission {path}: there is no such file")
    read = read_notebook(path)
    found = chapters_in([read])
    if not found:
        raise pytest.UsageError(
            f"--submission {path}: {'; '.join(read.notes) or 'it has no function of an exercise'}"
        )
    return found


def pytest_generate_tests(metafunc):
    if "exercise" not in metafunc.fixturenames:
        return
    chapters = chapters_of(metafunc.config)
    if chapters is None:
        nothing = pytest.mark.skip(reason="give --submission NOTEBOOK to grade one")
        metafunc.parametrize("exercise", [pytest.param(None, marks=nothing)], ids=["none"])
    else:
        metafunc.parametrize("exercise", [e.name for chapter in chapters for e in chapter.exercises])


@pytest.fixture(scope="session")
def outcomes(pytestconfig, tmp_path_factory):
    """By exercise: the outcome, and the words that a student may read."""
    folder = tmp_path_factory.mktemp("autograder")
    path = pytestconfig.getoption("--submission")
    (folder / "in" / "notebook").mkdir(parents=True)
    shutil.copyfile(path, folder / "in" / "notebook" / path.name)
    book = grade(
        folder / "in",
        folder / "out",
        seed=pytestconfig.getoption("--seed"),
        chapters=[chapter.stem for chapter in chapters_of(pytestconfig)],
        allow_unconfined=pytestconfig.getoption("--allow-unconfined"),
    )
    results = json.loads((folder / "out/gradescope/notebook/results.json").read_text("utf-8"))
    words = {test["name"]: test["output"] for test in results["tests"]}
    verdicts = [judged.verdict for judged in book.reports[0].judged]
    return {v.exercise.name: (v.outcome, words[v.exercise.name]) for v in verdicts}
