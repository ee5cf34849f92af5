"""A run that was ended at any moment is gone on with: nothing is lost, nothing is graded twice."""

import errno
import json
import os
import random
import signal
import subprocess
import sys
import time
from functools import partial

import pytest

from gpcourse.errors import UsageError
from gpcourse.exercises.course import CHAPTERS
from gpcourse.grading import grade as grade_confined
from gpcourse.grading import gradebook, journal

grade = partial(grade_confined, allow_unconfined=True)
STUDENTS = ("ada", "bo", "cy", "dee", "eli", "fay")


@pytest.fixture
def folder(tmp_path):
    """Six small notebooks: right, wrong, and such as raise an exception."""
    (tmp_path / "class").mkdir()
    for i, name in enumerate(STUDENTS):
        result = ("np.linalg.norm(np.cross(b - a, c - a)) / 2", "float(abs(a).sum())", "no_such_name")[i % 3]
        source = (
            "import time\nimport numpy as np\nslept = time.sleep(0.5)\n"  # run, since the function reads it
            f"def triangle_area(a, b, c):\n    slept\n    return {result}"
        )
        text = json.dumps({"cells": [{"cell_type": "code", "source": source}]})
        (tmp_path / "class" / f"{name}.ipynb").write_text(text, encoding="utf-8")
    return tmp_path / "class"


def files(out):
    """All that is the same however often a run was interrupted."""
    found = {str(p.relative_to(out)): p.read_bytes() for p in out.rglob("*") if p.is_file()}
    return {name: data for name, data in found.items() if name not in ("journal.jsonl", "times.csv")}


def lines(out):
    path = out / "journal.jsonl"
    return path.read_bytes().splitlines()[1:] if path.exists() else []


def begin(folder, out):
    command = [sys.executable, "-m", "gpcourse", "grade", folder, "--out", out, "--jobs", "1"]
    command += ["--allow-unconfined", "--junit", "--quiet"]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def begin_and_wait(folder, out, done):
    process = begin(folder, out)
    late = time.monotonic() + 60
    while len(lines(out)) < done and process.poll() is None and time.monotonic() < late:
        time.sleep(0.02)
    return process


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
def test_a_run_that_was_killed_twice_is_gone_on_with(interruptible, folder, tmp_path):
    whole = files(grade(folder, tmp_path / "whole", junit=True).out)
    out = tmp_path / "out"
    rng = random.Random(os.getpid())
    for done, kind in ((1, signal.SIGKILL), (3, signal.SIGINT)):
        process = begin_and_wait(folder, out, done)
        time.sleep(rng.uniform(0.0, 0.3))
        process.send_signal(kind)
        _, said = process.communicate(timeout=60)
        assert process.returncode != 0
        assert "Traceback" not in said
        assert ("The same command goes on" in said) is (kind == signal.SIGINT)
    kept = lines(out)
    assert 3 <= len(kept) < len(STUDENTS)
    book = grade(folder, out, junit=True)
    assert book.resumed == len(kept)
    assert lines(out)[: len(kept)] == kept
    assert len(lines(out)) == len({json.loads(line)["digest"] for line in lines(out)}) == len(STUDENTS)
    assert files(out).keys() - whole.keys() <= {".lock"}
    assert {name: data for name, data in files(out).items() if name != ".lock"} == {
        name: data for name, data in whole.items() if name != ".lock"
    }


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
def test_of_two_runs_on_one_folder_the_second_says_so(folder, tmp_path):
    process = begin_and_wait(folder, tmp_path / "out", 1)
    process.send_signal(signal.SIGSTOP)
    try:
        with pytest.raises(UsageError, match="another run is grading into"):
            grade(folder, tmp_path / "out")
        assert process.poll() is None
    finally:
        process.kill()
        process.communicate()


def students(told):
    return [student for _, _, student in told]


def test_only_what_is_new_or_changed_is_graded(folder, tmp_path):
    out = tmp_path / "out"
    first = files(grade(folder, out).out)

    def again(**options):
        told = []
        grade(folder, out, progress=lambda *step: told.append(step), **options)
        return told

    assert again() == [(6, 6, "")]
    whole = (out / "journal.jsonl").read_bytes()
    (out / "journal.jsonl").write_bytes(whole[:-40])
    assert len(again()) == 2
    assert files(out) == first
    path = folder / "bo.ipynb"
    path.write_text(path.read_text("utf-8").replace("abs(a)", "abs(b)"), "utf-8")
    (out / "students" / "cy.html").write_text("torn", "utf-8")
    assert sorted(students(again())) == ["", "bo", "cy"]
    assert len(again(seed=1)) == 6
    assert again(seed=1) == [(6, 6, "")]


def test_a_full_disk_is_said_and_loses_nothing(folder, tmp_path, monkeypatch):
    out, write, count = tmp_path / "out", gradebook.write, 0

    def full(path, text):
        nonlocal count
        count += 1
        if count > 5:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        write(path, text)

    with monkeypatch.context() as patch:
        patch.setattr(gradebook, "write", full)
        with pytest.raises(UsageError, match="make room and give the same command again"):
            grade(folder, out, jobs=1)
    assert len(lines(out)) == 2
    assert grade(folder, out).resumed == 2


def test_the_course_itself_is_a_condition(tmp_path, monkeypatch):
    with journal.Journal(tmp_path, {"course": "a"}) as first:
        first._append({"digest": "x"})
    with journal.Journal(tmp_path, {"course": "a"}) as same:
        assert set(same.done) == {"x"}
    with journal.Journal(tmp_path, {"course": "b"}) as other:
        assert other.done == {}


@pytest.mark.parametrize(
    "damage",
    [
        lambda line: line.replace(b'"points": 0', b'"points": 9'),
        lambda line: b"[" * 10**5 + b"\n",
        lambda line: b"{}\n",
        lambda line: b"\xff\xfe\n",
        lambda line: line.replace(b": 0", b": " + b"9" * 6000),
    ],
)
def test_a_line_that_was_changed_is_not_believed(tmp_path, damage):
    path, known = tmp_path / "journal.jsonl", {"course": "a"}
    with journal.Journal(tmp_path, known) as first:
        first._append({"digest": "x", "points": 0})
        first._append({"digest": "y", "points": 0})
    head, one, other = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(head + one + damage(other))
    with journal.Journal(tmp_path, known) as again:
        assert set(again.done) == {"x"}
        again._append({"digest": "z", "points": 1})
    with journal.Journal(tmp_path, known) as last:
        assert set(last.done) == {"x", "z"}


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_a_journal_that_is_a_link_is_not_written_through(tmp_path):
    precious = tmp_path / "precious"
    precious.write_text("all of it", "utf-8")
    out = tmp_path / "out"
    out.mkdir()
    (out / "journal.jsonl").symlink_to(precious)
    with pytest.raises(UsageError, match=r"journal\.jsonl is no file"), journal.Journal(out, {}):
        pass
    assert precious.read_text("utf-8") == "all of it"


def test_a_busy_machine_changes_no_grade(folder, tmp_path):
    slow = (
        "import time\nimport numpy as np\nbusy = [{seconds}]\ndef triangle_area(a, b, c):\n"
        "    start, most = time.process_time(), busy.pop() if busy else 0.0\n"
        "    while time.process_time() - start < most: pass\n"
        "    return np.linalg.norm(np.cross(b - a, c - a)) / 2"
    )
    limit = CHAPTERS[0].exercises[0].time_limit
    for name, share in (("within", 0.5), ("beyond", 5.0)):
        cell = {"cell_type": "code", "source": slow.format(seconds=share * limit)}
        (folder / f"{name}.ipynb").write_text(json.dumps({"cells": [cell]}), encoding="utf-8")
    quiet = grade(folder, tmp_path / "quiet")
    # Twice as many as there are cores: what is graded gets a third of one.
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2 * os.cpu_count())]
    try:
        loaded = grade(folder, tmp_path / "loaded")
    finally:
        for process in busy:
            process.kill()
            process.wait()
    points = {report.student: report.points for report in loaded.reports}
    assert points["within"] == points["ada"] > points["beyond"]
    assert files(loaded.out) == files(quiet.out)
