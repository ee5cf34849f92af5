"""Hostile notebooks: no undeserved point, no lost one, a true outcome, and nothing changed outside."""

import csv
import importlib.util
import io
import json
import platform
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path
from xml.etree import ElementTree

import pytest

import gpcourse
from gpcourse.exercises import expect, feedback
from gpcourse.exercises.course import CHAPTERS
from gpcourse.exercises.exercise import Exercise
from gpcourse.grading import gradebook, reports
from gpcourse.grading.judge import judge_submission
from gpcourse.grading.junit import junit
from gpcourse.grading.recall import Recall
from gpcourse.grading.submission import read_folder
from gpcourse.sandbox import confine, home, proxy
from gpcourse.sandbox.forking import can_fork
from gpcourse.sandbox.lockdown import LEVELS
from gpcourse.sandbox.proxy import Worker

if sys.platform == "win32":
    pytest.skip("signals and limits are those of POSIX", allow_module_level=True)


def load(name):
    """Import a neighbour of this file: the tests are no package."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


attack, ending, resources, tampering, honest, damaged, threats = map(
    load, ("attack", "ending", "resources", "tampering", "honest", "damaged", "threats")
)
ATTACKS = [*ending.ENDING, *resources.RESOURCES, *tampering.TAMPERING]

PLUS_ONE = "def plus_one(x):\n    return x + 1"
LIMITS = confine.Limits(load=5.0, memory=2 * 2**30, threads=500)
#: For what does not end by itself: the less it gets, the sooner the test is over.
SHORT = replace(LIMITS, load=0.1, patience=0.2)

#: Lines of the package that, replaced in a copy of it, leave out a part of the confinement.
NO_NAMESPACES = (
    "namespaces.py",
    "def enter(",
    "def enter(*_):\n    return View(('left out',))\n\n\ndef _enter(",
)
NO_LOCK = ("lockdown.py", "def lock(", "def lock(*_):\n    return Confinement()\n\n\ndef _lock(")
LEFT_OUT = {"full": [], "restricted": [NO_NAMESPACES], "limits": [NO_NAMESPACES, NO_LOCK]}


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
        for x in (3, 5, int(rng.integers(100, 10**6))):
            expect.close(expect.number(f(x)), float(function(x)), 0.0, "The result")

    return made


def scaled(v):
    """Return an array times two."""
    return 2 * v


def arrays_exercise():
    made = Exercise(scaled, notes="ch. 0", hints=["Look again."], time_limit=2.0)

    @made.check("arrays", points=2)
    def _(f, rng):
        v = rng.normal(size=(5, 3))
        before = v.copy()
        expect.close(expect.array(f(v), (5, 3)), 2 * before, 1e-5, "The result")
        assert (v == before).all()

    return made


EXERCISES = [exercise(twice, 2.0), exercise(plus_one, 20.0)]
ENDLESS = [exercise(twice, 0.1), EXERCISES[1]]
ARRAYS = [arrays_exercise(), EXERCISES[1]]
#: As in a class, what was found out about one submission serves the next, be it hostile or honest.
MEMORIES: dict[int, Recall] = {}


@pytest.fixture(scope="module", params=LEVELS[::-1])
def start(tmp_path_factory, request):
    """Yield what forks workers at one of the levels, by leaving out what a machine of that level lacks."""
    if not can_fork():
        pytest.skip("this system does not fork workers")
    package = home.build(tmp_path_factory.mktemp("run") / "home", fonts=True)
    for name, old, new in LEFT_OUT[request.param]:
        path = package / "gpcourse" / "sandbox" / name
        text = path.read_text("utf-8")
        assert text.count(old) == 1
        path.write_text(text.replace(old, new), "utf-8")
    with confine.launcher(package) as launch:
        line = launch(package, LIMITS)
        line.close()
        if line.confinement.level != request.param:
            pytest.skip(f"this machine reaches {line.confinement.level}: {line.confinement.missing}")
        yield partial(launch, package)
        assert not list(package.parent.glob("scratch-*")), "a working folder is left"


@pytest.fixture
def level(start, request):
    return request.node.callspec.params["start"]


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


def notebook(*cells):
    return json.dumps({"cells": [{"cell_type": "code", "source": source} for source in cells]})


def judged(text, outside, start, exercises=EXERCISES, limits=LIMITS, file="ada.ipynb"):
    """Judge a real notebook; return the report and what was written into scratch folders."""
    texts = []

    def start_and_watch(package, limits):
        line = start(limits)
        close = line.close

        def read_and_close():
            path = line.folder / "ran.txt"
            texts.append(path.read_text("utf-8", "replace") if path.is_file() else "")
            close()

        line.close = read_and_close
        return line

    folder = outside.parent / "class"
    folder.mkdir()
    (folder / file).write_bytes(text if isinstance(text, bytes) else text.encode())
    submission = read_folder(folder)[0]
    recall = MEMORIES.setdefault(id(exercises), Recall(0))
    report = judge_submission(
        submission,
        exercises,
        0,
        lambda n: Worker(list(n.cells), Path(), limits, start_and_watch),
        recall.judge,
    )
    return report, "".join(texts)


@pytest.mark.parametrize("case", ATTACKS, ids=lambda case: case.name)
def test_a_hostile_function_gets_what_it_deserves(case, outside, start, level, monkeypatch):
    least = max(case.least, "restricted" if case.confined else "limits", key=LEVELS.index)
    if LEVELS.index(level) < LEVELS.index(least):
        pytest.skip(f"the level {least} stops it")
    if "syscall" in case.cell and platform.machine() != "x86_64":
        pytest.skip("the numbers of calls are those of x86_64")
    monkeypatch.setenv("SECRET", "1")
    monkeypatch.setattr(proxy, "GRACE", 0.1)
    before = state(outside)
    code = case.cell.replace("OUTSIDE", str(outside)).replace("COURSE", str(home.PACKAGE))
    endless = case.deserves[0] == "timeout"
    how = (ENDLESS, SHORT) if endless else (EXERCISES, LIMITS)
    report, said = judged(notebook(attack.TOOLS, code, PLUS_ONE), outside, start, *how)
    hostile, honest = (one.verdict for one in report.judged)
    # What namespaces hide cannot even be refused.
    signs = {*case.says.split("|"), *(["FileNotFoundError"] if level == "full" and case.confined else [])}
    assert any(sign in said for sign in signs), f"its body did not run: {said[:500]}"
    assert "did it" not in said
    assert hostile.outcome in case.deserves
    assert hostile.points == (2 if hostile.outcome == "passed" else 0)
    assert (honest.outcome, honest.points) == ("passed", 2)
    assert report.status == "graded"
    assert all(len(t) <= 2000 and t.isprintable() for t in texts_of(report))
    assert state(outside) == before
    if "raise" in case.cell:
        outputs_are_harmless(report)


@pytest.mark.parametrize("work", honest.HONEST, ids=lambda work: work.id)
def test_honest_work_gets_all_its_points(work, outside, start, level):
    if level == "limits":
        pytest.skip("what passes confined passes free")
    exercises = EXERCISES if work.name == "twice" else ARRAYS
    report, said = judged(notebook(attack.TOOLS, work.cell, PLUS_ONE), outside, start, exercises)
    assert "ran" in said or "a" in said
    assert [(one.verdict.outcome, one.verdict.points) for one in report.judged] == [("passed", 2)] * 2
    assert report.status == "graded"


@pytest.mark.parametrize("damage", damaged.DAMAGED, ids=lambda damage: damage.id)
def test_of_a_damaged_notebook_what_can_be_read_counts(damage, outside, start, level):
    if level != "full":
        pytest.skip("files are read before any worker is started")
    report, said = judged(damage.make(attack.TOOLS), outside, start, file=damage.file)
    assert tuple(one.verdict.outcome for one in report.judged) == damage.outcomes, report.notes
    assert report.points == 2 * damage.outcomes.count("passed")
    assert report.status == damage.status
    assert damage.note in " ".join(report.notes)
    assert ("ran" in said) == (damage.outcomes[0] in ("passed", "failed"))


def outputs_are_harmless(report):
    """What a student's exception says does nothing, wherever it is written: it is short, and text."""
    exercises = [one.verdict.exercise for one in report.judged]
    table = gradebook.grades_csv([report], exercises)
    pages = [
        reports.student_page(report, CHAPTERS[:1]),
        reports.class_page([report], CHAPTERS[:1], exercises, 0, {report.student: "ada"}),
    ]
    console = [
        feedback.as_text(one.verdict, answers=answers) for one in report.judged for answers in (True, False)
    ]
    texts = [table, *pages, *console, gradebook.gradescope(report), junit([report])]
    plain = reports.student_page(replace(report, judged=()), CHAPTERS[:1])
    assert max(map(len, texts)) < 100_000
    assert not any(c in text for text in texts for c in "\x1b\0")
    assert pages[0].count("<script") == plain.count("<script")
    assert not any(cell.startswith("=") for row in csv.reader(io.StringIO(table)) for cell in row)
    assert json.loads(gradebook.gradescope(report))["score"] == report.points
    assert len(ElementTree.fromstring(junit([report]))) == 1


def texts_of(report):
    """Return all that the report quotes of an exception."""
    results = [result for one in report.judged for result in one.verdict.results]
    troubles = [result.trouble for result in results if result.trouble is not None]
    return [text for t in troubles for text in (t.message, t.function, t.source, t.place, *t.types)]


@pytest.mark.parametrize("threat", threats.THREATS)
def test_each_threat_has_cases_and_they_are_there(threat):
    names = {a.what for a in ATTACKS} | {w.what for w in honest.HONEST} | {d.what for d in damaged.DAMAGED}
    cases = threats.THREATS[threat]
    assert cases
    for case in cases:
        if "::" not in case:
            assert case in names
            continue
        file, name = case.split("::")
        assert f"\ndef {name}(" in (Path(__file__).parents[2] / file).read_text("utf-8")


def test_there_are_attacks_of_every_kind():
    assert len({attack.name for attack in ATTACKS}) == len(ATTACKS) >= 100
    assert Path(gpcourse.__file__).parent == home.PACKAGE
