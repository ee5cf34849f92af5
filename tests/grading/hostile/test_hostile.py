"""Hostile notebooks: no undeserved point, no lost one, a true outcome, and nothing changed outside."""

import importlib.util
import json
import sys
from pathlib import Path

import pytest

import gpcourse
from gpcourse.exercises import expect
from gpcourse.exercises.exercise import Exercise
from gpcourse.grading.judge import judge_submission
from gpcourse.grading.submission import read_folder
from gpcourse.sandbox import confine, home
from gpcourse.sandbox.forking import can_fork
from gpcourse.sandbox.proxy import Worker

if sys.platform == "win32":
    pytest.skip("signals and limits are those of POSIX", allow_module_level=True)


def load(name):
    """Import a neighbour of this file: the tests are no package."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


table = load("table")

HONEST = "def plus_one(x):\n    return x + 1"
LIMITS = confine.Limits(load=4.0, memory=2 * 2**30, patience=1.0)


def twice(x):
    """Return x times two."""
    return 2 * x


def plus_one(x):
    """Return x plus one."""
    return x + 1


def exercise(function, limit):
    made = Exercise(function, notes="ch. 0", hints=["Look again."], time_limit=limit)

    @made.check("numbers", points=2)
    def _(f, rng):
        for x in (3, 5):
            expect.close(expect.number(f(x)), float(function(x)), 0.0, "The result")

    return made


EXERCISES = [exercise(twice, 1.0), exercise(plus_one, 5.0)]


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    return home.build(tmp_path_factory.mktemp("run") / "home")


@pytest.fixture(scope="module", params=["forked", "fresh"])
def launch(package, request):
    """Yield each way to start a worker that this machine has: forked it reaches the highest level."""
    if request.param == "fresh":
        yield confine.launch
    elif not can_fork():
        pytest.skip("this system does not fork workers")
    else:
        with confine.launcher(package) as launch:
            yield launch


@pytest.fixture(scope="module")
def level(launch, package):
    line = launch(package, LIMITS)
    line.close()
    return line.confinement


@pytest.fixture
def outside(tmp_path):
    folder = tmp_path / "outside"
    folder.mkdir()
    (folder / "bob.ipynb").write_text("the work of somebody else")
    (folder / "grades.csv").write_text("bob,4\n")
    return folder


def state(folder):
    return {
        str(p): (p.stat().st_mode, p.stat().st_mtime_ns, p.read_bytes() if p.is_file() else b"")
        for p in (folder, *folder.rglob("*"))
    }


def judged(attack, package, outside, launch):
    """Judge a real notebook of the attack; return the report and what was written into scratch folders."""
    texts = []

    def start(package, limits):
        line = launch(package, limits)
        close = line.close

        def read_and_close():
            path = line.folder / "ran.txt"
            texts.append(path.read_text("utf-8", "replace") if path.is_file() else "")
            close()

        line.close = read_and_close
        return line

    code = attack.cell.replace("OUTSIDE", str(outside)).replace("COURSE", str(home.PACKAGE))
    cells = [{"cell_type": "code", "source": source} for source in (table.TOOLS, code, HONEST)]
    folder = outside.parent / "class"
    folder.mkdir()
    (folder / "ada.ipynb").write_text(json.dumps({"cells": cells}), encoding="utf-8")
    submission = read_folder(folder)[0]
    report = judge_submission(
        submission, EXERCISES, 0, lambda n: Worker(list(n.cells), package, LIMITS, start)
    )
    return report, "".join(texts)


@pytest.mark.parametrize("attack", table.ATTACKS, ids=lambda attack: attack.name)
def test_a_hostile_function_gets_what_it_deserves(attack, package, outside, launch, level, monkeypatch):
    if attack.confined and not level.reaches("restricted"):
        pytest.skip(f"this machine reaches the level {level.level!r}: {'; '.join(level.missing)}")
    monkeypatch.setenv("SECRET", "1")
    before = state(outside)
    report, said = judged(attack, package, outside, launch)
    hostile, honest = (one.verdict for one in report.judged)
    # What namespaces hide cannot even be refused.
    signs = {attack.says, "FileNotFoundError"} if level.reaches("full") and attack.confined else {attack.says}
    assert any(sign in said for sign in signs), "its body did not run"
    assert "did it" not in said
    assert hostile.outcome in attack.deserves
    assert hostile.points == (2 if hostile.outcome == "passed" else 0)
    assert (honest.outcome, honest.points) == ("passed", 2)
    assert report.status == "graded"
    assert state(outside) == before


def test_there_are_attacks_of_every_kind():
    assert len({attack.name for attack in table.ATTACKS}) == len(table.ATTACKS) >= 40
    assert Path(gpcourse.__file__).parent == home.PACKAGE
