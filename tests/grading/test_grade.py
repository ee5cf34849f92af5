"""Grading as an instructor does it: the sample class gets what its README says, the same each time."""

import csv
import json
import re
import time
from contextlib import nullcontext
from functools import partial
from pathlib import Path

import pytest

from gpcourse.errors import UsageError, WorkerError
from gpcourse.exercises.course import CHAPTERS
from gpcourse.grading import grade as grade_confined
from gpcourse.grading.crews import Here
from gpcourse.sandbox import confine
from gpcourse.sandbox.lockdown import Confinement

CLASS = Path(__file__).parents[2] / "data" / "sample_class"
grade = partial(grade_confined, allow_unconfined=True)  # some machines cannot
POINTS = {exercise.name: exercise.points for exercise in CHAPTERS[1].exercises}


@pytest.fixture(scope="module")
def book(tmp_path_factory):
    return grade(CLASS, tmp_path_factory.mktemp("grades"), seed=7)


def deserved():
    """Read the README's table: the points that each student loses, by exercise."""
    lines = (CLASS / "README.md").read_text("utf-8").splitlines()
    table = [[cell.strip() for cell in line.split("|")[1:4]] for line in lines if line.startswith("|")]
    return {
        student: POINTS if lost == "all" else {name: int(n) for name, n in re.findall(r"(\w+) (\d+)", lost)}
        for student, _, lost in table[2:]
    }


@pytest.mark.parametrize("student", sorted(deserved()))
def test_each_student_gets_what_is_deserved(book, student):
    lost = deserved()[student]
    report = next(r for r in book.reports if r.student == student)
    seen = {j.verdict.exercise.name: j.verdict.points for j in report.judged}
    assert seen == {name: points - lost.get(name, 0) for name, points in POINTS.items()}


@pytest.mark.parametrize(
    ("student", "exercise", "outcome", "mistake"),
    [
        ("dmitri", "vertex_neighbours_ccw", "failed", "the walk went clockwise"),
        ("dmitri", "vertex_neighbours_cw", "failed", "the walk went counter-clockwise"),
        ("esi", "build_halfedges", "failed", "the half-edges along holes are missing"),
        ("farid", "dual_mesh", "failed", "the faces of the dual are clockwise"),
        ("greta", "genus", "not attempted", None),
        ("hamid", "face_centroid", "error", None),
        ("ines", "boundary_loops", "timeout", None),
        ("jonas", "is_flippable", "crashed", None),
        ("kalinda", "face_vertices", "error", None),
        ("mina", "cube", "not attempted", None),
    ],
)
def test_outcomes_and_named_mistakes(book, student, exercise, outcome, mistake):
    report = next(r for r in book.reports if r.student == student)
    verdict = next(j.verdict for j in report.judged if j.verdict.exercise.name == exercise)
    assert verdict.outcome == outcome
    assert [m.name for m in verdict.mistakes] == ([mistake] if mistake else [])


def test_the_table_has_a_row_for_everyone(book):
    rows = {row["student"]: row for row in csv.DictReader(book.table.read_text("utf-8").splitlines())}
    assert set(rows) == set(deserved())
    assert all(int(row["out of"]) == sum(POINTS.values()) for row in rows.values())
    assert all(sum(int(row[name]) for name in POINTS) == int(row["total"]) for row in rows.values())
    statuses = {name: row["status"] for name, row in rows.items() if row["status"] != "graded"}
    assert statuses == {"greta": "not attempted", "lars": "unreadable"}
    assert rows["amara"]["note"] == ""
    times = csv.DictReader((book.out / "times.csv").read_text("utf-8").splitlines())
    seconds = {row["student"]: float(row["total"]) for row in times}
    assert set(seconds) == set(rows)
    assert 0.0 < seconds["amara"] < seconds["ines"]  # an endless loop
    assert "SyntaxError" in rows["hamid"]["note"]
    assert "boundary_loops: timeout" in rows["ines"]["note"]
    assert "my_cube" in rows["mina"]["note"]


def test_every_student_has_a_page_and_results(book):
    for report in book.reports:
        page = (book.out / "students" / f"{report.student}.html").read_text("utf-8")
        assert f"<h1>{report.student}</h1>" in page
        results = json.loads((book.out / "gradescope" / report.student / "results.json").read_text("utf-8"))
        assert results["score"] == report.points


def files(folder):
    """All that is the same each time: everything but the times, and the journal with them."""
    found = {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    found.pop("times.csv", None)
    found.pop("journal.jsonl", None)
    return found


def test_the_same_seed_gives_the_same_files_and_another_seed_other_inputs(tmp_path):
    cells = json.loads((CLASS / "dmitri.ipynb").read_text("utf-8"))["cells"]
    wanted = ("import matplotlib", "def vertex_neighbours_ccw", "def vertex_neighbours_cw")
    walk = "\n".join(cell["source"] for cell in cells if cell["source"].startswith(wanted))
    folder = write(tmp_path / "class", "ada", source=walk)
    write(folder, "cy", source="def genus(mesh):\n    return object()")
    write(folder, "di", source="def read_off(text):\n    raise ArithmeticError(text[:99])")
    first = files(grade(folder, tmp_path / "a", seed=3, jobs=2).out)
    assert first == files(grade(folder, tmp_path / "b", seed=3, jobs=1).out)
    other = files(grade(folder, tmp_path / "b", seed=4).out)
    assert other["grades.csv"] == first["grades.csv"]
    assert other["students/di.html"] != first["students/di.html"]


def write(folder, *names, source="def triangle_area(a, b, c): return 1"):
    folder.mkdir(exist_ok=True)
    for name in names:
        cells = [{"cell_type": "code", "source": source}]
        (folder / f"{name}.ipynb").write_text(json.dumps({"cells": cells}), encoding="utf-8")
    return folder


def test_nothing_that_is_handed_out_tells_the_seed_or_another_student(tmp_path):
    seed = 918273645
    folder = write(tmp_path / "class", "adalovelace", source="def genus(mesh):\n    return 1")
    write(folder, "emmynoether", source="def genus(mesh):\n    raise ValueError(mesh)")
    out = grade(folder, tmp_path / "grades", seed=seed, jobs=1, junit=True).out
    given = [*(out / "students").iterdir(), *(out / "gradescope").rglob("results.json")]
    assert len(given) == 4
    for path in given:
        text = path.read_text("utf-8")
        assert str(seed) not in text
        assert ("emmynoether" in text) + ("adalovelace" in text) <= 1
        assert str(tmp_path) not in text
    assert str(seed) not in (out / "junit.xml").read_text("utf-8")


def test_the_chapters_are_those_that_were_handed_in(tmp_path):
    folder = write(tmp_path / "class", "ada")
    assert [c.stem for c in grade(folder, tmp_path / "out").chapters] == ["welcome"]
    both = grade(folder, tmp_path / "out", chapters=["1", "welcome"])
    assert [c.stem for c in both.chapters] == ["welcome", "halfedge"]


def test_progress_is_told_and_other_files_stay(tmp_path):
    folder = write(tmp_path / "class", "ada", "bo")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine.txt").write_text("keep")
    told = []
    grade(folder, tmp_path / "out", progress=lambda *step: told.append(step))
    assert [(done, total) for done, total, _ in told] == [(1, 2), (2, 2)]
    assert {name for _, _, name in told} == {"ada", "bo"}
    assert (tmp_path / "out" / "mine.txt").read_text() == "keep"


def test_a_function_that_is_not_python_code_of_its_own_is_found_too(tmp_path):
    source = "import numpy as np\ntriangle_area = lambda a, b, c: np.linalg.norm(np.cross(b - a, c - a)) / 2"
    folder = write(tmp_path / "class", "ada", source=source)
    assert grade(folder, tmp_path / "out").reports[0].points == CHAPTERS[0].points


def test_of_two_notebooks_the_one_with_the_function_counts(tmp_path):
    folder = tmp_path / "class"
    folder.mkdir()
    write(folder / "ada", "0_welcome")
    write(folder / "ada", "1_halfedge", source="def genus(mesh): return 0")
    report = grade(folder, tmp_path / "out").reports[0]
    outcomes = {j.verdict.exercise.name: j.verdict.outcome for j in report.judged}
    assert outcomes["triangle_area"] == outcomes["genus"] == "failed"
    assert outcomes["cube"] == "not attempted"


def test_a_machine_that_starts_no_process_is_our_fault(tmp_path, monkeypatch):
    def refuse(package, limits):
        raise WorkerError("no process could be started")

    monkeypatch.setattr(Here, "confinement", lambda _: Confinement())
    monkeypatch.setattr(confine, "launcher", lambda *_: nullcontext(refuse))
    report = grade(write(tmp_path / "class", "ada"), tmp_path / "out").reports[0]
    assert report.status == "grader fault"


def test_what_cannot_be_confined_is_not_graded_unless_it_is_trusted(tmp_path, monkeypatch):
    folder = write(tmp_path / "class", "ada")
    monkeypatch.setattr(Here, "confinement", lambda _: Confinement("limits", ("Landlock: none here",)))
    with pytest.raises(UsageError, match=r"Landlock: none here.*--allow-unconfined"):
        grade_confined(folder, tmp_path / "out")
    assert not (tmp_path / "out").exists()
    assert grade(folder, tmp_path / "out").reports[0].confinement == "limits"


def test_a_worker_that_is_less_confined_than_the_others_gets_no_notebook(tmp_path, monkeypatch):
    def fresh(*_):  # which reaches no namespaces
        return nullcontext(confine.launch)

    monkeypatch.setattr(Here, "confinement", lambda _: Confinement("full"))
    monkeypatch.setattr(confine, "launcher", fresh)
    report = grade(write(tmp_path / "class", "ada"), tmp_path / "out").reports[0]
    assert (report.status, report.points) == ("grader fault", 0)


def test_every_result_states_its_level(book):
    level = confine.level_here().level
    rows = list(csv.DictReader(book.table.read_text("utf-8").splitlines()))
    assert {row["confinement"] for row in rows} == {level} == {book.confinement}
    assert f"confinement <b>{level}</b>" in book.page.read_text("utf-8")
    results = json.loads((book.out / "gradescope" / "amara" / "results.json").read_text("utf-8"))
    assert results["extra_data"] == {"confinement": level}


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"chapters": ["9"]}, "chapter '9'"), ({"seed": -1}, "seed"), ({"out": "class/grades"}, "beside"),
        ({"out": "class/ada.ipynb"}, "is a file"), ({"folder": "nowhere"}, "does not exist"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_and_nothing_written(tmp_path, options, word):
    write(tmp_path / "class", "ada")
    before = files(tmp_path)
    options = {"folder": "class", "out": "grades"} | options
    folder, out = tmp_path / options.pop("folder"), tmp_path / options.pop("out")
    with pytest.raises(UsageError, match=word):
        grade(folder, out, **options)
    assert files(tmp_path) == before


def test_an_interruption_does_not_wait_for_who_is_being_graded(tmp_path):
    folder = write(tmp_path / "class", "ada")
    write(folder, *"bcdef", source="while True:\n    x = 1\ndef triangle_area(a, b, c):\n    return x")

    moments = []

    def interrupt(*step):
        moments.append(time.monotonic())
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        grade(folder, tmp_path / "out", jobs=1, progress=interrupt)
    assert time.monotonic() - moments[0] < confine.Limits().load / 2
