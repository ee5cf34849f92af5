"""Whoever marks a class, threads, processes or a cluster: the same grades, whatever ends in the middle."""

import json
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from gpcourse.errors import UsageError
from gpcourse.grading import crews, grade
from gpcourse.grading.journal import course_digest
from gpcourse.grading.marking import Task, mark_there
from gpcourse.grading.submission import Submission, read_class
from gpcourse.sandbox.confine import Limits

BODIES = ("np.linalg.norm(np.cross(b - a, c - a)) / 2", "float(abs(a).sum())", "no_such_name")
COUNT = 12


def write_class(folder, count=COUNT, seconds=0.0):
    folder.mkdir()
    for i in range(count):
        source = f"import time\nimport numpy as np\nslept = time.sleep({seconds})\n"
        source += f"def triangle_area(a, b, c):\n    slept\n    return {BODIES[i % 3]}"
        text = json.dumps({"cells": [{"cell_type": "code", "source": source}]})
        (folder / f"student{i:02}.ipynb").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def submissions(tmp_path_factory):
    return read_class(write_class(tmp_path_factory.mktemp("crews") / "class"))


@pytest.fixture(scope="module")
def task():
    return Task(("halfedge",), 3, Limits(), course=course_digest())


@pytest.fixture(scope="module")
def alone(task, submissions):
    """What comes of it in one thread: by student."""
    return told(crews.in_threads(task, submissions, 1))


def told(marks):
    return {m.report.student: (m.report.points, m.page, m.results) for m in marks}


def test_processes_write_what_threads_write_even_if_one_is_killed(task, submissions, alone):
    marks = crews.in_processes(task, submissions, 2)
    first = next(marks)
    assert len(multiprocessing.active_children()) == 2
    multiprocessing.active_children()[0].kill()
    assert alone == told([first, *marks])
    assert multiprocessing.active_children() == []


class Poison(Submission):
    """Ends the process that it is sent to."""

    def __reduce__(self):
        return os._exit, (1,)


def test_a_submission_that_ends_its_process_costs_no_other_its_points(task, submissions, alone):
    poison = Poison("mallory", submissions[0].notebooks)
    marks = {m.report.student: m for m in crews.in_processes(task, [*submissions[:2], poison], 2)}
    report = marks.pop("mallory").report
    assert report.status == "grader fault"
    assert (report.points, len(report.judged)) == (0, len(task.exercises))
    assert "the process that judged it has ended, twice" in report.fault
    assert told(marks.values()) == {name: alone[name] for name in marks}
    assert len(marks) == 2


@pytest.mark.parametrize(
    ("jobs", "count", "chosen"), [(1, 100, "in_threads"), (8, 63, "in_threads"), (8, 64, "in_processes")]
)
def test_processes_are_started_where_they_are_worth_it(monkeypatch, task, jobs, count, chosen):
    for name in ("in_threads", "in_processes"):
        monkeypatch.setattr(crews, name, lambda *_, name=name: name)
    with crews.Here(jobs, fonts=False) as here:
        assert here.mark(task, [None] * count) == chosen


def test_who_has_another_course_marks_nothing(task, submissions):
    other = Task(task.stems, task.seed, task.limits, course="another")
    with pytest.raises(UsageError, match="has another gpcourse, Python, numpy"):
        mark_there(other, submissions[0])


def test_a_script_that_is_not_guarded_is_told_so(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "from gpcourse.grading import crews\nfrom gpcourse.grading.marking import Task\n"
        "from gpcourse.sandbox.confine import Limits\n"
        "list(crews.in_processes(Task(('halfedge',), 0, Limits()), [1], 1))\n"
    )
    said = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=60, check=False)
    assert 'below if __name__ == "__main__":' in said.stderr.splitlines()[-1]


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
@pytest.mark.parametrize("kind", [signal.SIGKILL, signal.SIGINT])
def test_processes_end_with_the_run(interruptible, tmp_path, kind):
    folder = write_class(tmp_path / "class", seconds=0.5)
    script = tmp_path / "script.py"
    script.write_text(
        "import sys\nfrom gpcourse.grading import crews, grade\n"
        "if __name__ == '__main__':\n    crews.THREADS, crews.WORTH = 0, 1\n"
        "    grade(sys.argv[1], sys.argv[2], jobs=2, allow_unconfined=True)\n"
    )
    out = tmp_path / "out"
    run = psutil.Popen(
        [sys.executable, script, folder, out], stderr=subprocess.DEVNULL, start_new_session=True
    )
    until(lambda: journal(out))
    family = run.children(recursive=True)
    assert len(family) >= 4  # two that judge, each with the parent of its workers
    os.killpg(run.pid, kind) if kind == signal.SIGINT else run.kill()
    assert run.wait(20) != 0
    until(lambda: not any(map(alive, family)), 20)
    assert 0 < len(journal(out)) < COUNT


def journal(out):
    """Its lines below the head."""
    path = out / "journal.jsonl"
    return path.read_bytes().splitlines()[1:] if path.exists() else []


def alive(process):
    return process.is_running() and process.status() != psutil.STATUS_ZOMBIE


def until(true, seconds=60):
    late = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < late, "waited in vain"
        time.sleep(0.02)


# A Dask cluster, started as an instructor starts it.

DASK = [sys.executable, "-W", "ignore", "-m", "dask"]


def started(folder, name, *words):
    with (folder / f"{name}.log").open("w") as log:
        return psutil.Popen([*DASK, *words], stdout=log, stderr=log, cwd=folder)


def end(process):
    for each in [*process.children(recursive=True), process]:
        each.kill()
    process.wait()


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory):
    """The address of a scheduler without workers, and a function that starts one."""
    folder = tmp_path_factory.mktemp("cluster")
    running = [
        started(folder, "scheduler", "scheduler", "--port", "0", "--no-dashboard", "--host", "127.0.0.1")
    ]
    said = folder / "scheduler.log"
    until(lambda: re.search(r"Scheduler at: +(tcp://\S+)", said.read_text()))
    address = re.search(r"Scheduler at: +(tcp://\S+)", said.read_text())[1]

    def start_worker(name):
        words = ("--nthreads", "1", "--no-dashboard", "--name", name)
        running.append(started(folder, name, "worker", address, *words))
        until(lambda: "Registered to" in (folder / f"{name}.log").read_text())
        return running[-1]

    yield address, start_worker
    for process in running:
        end(process)


def test_a_class_is_marked_although_a_worker_is_killed(scheduler, tmp_path):
    address, start_worker = scheduler
    folder = write_class(tmp_path / "class", COUNT, seconds=0.2)
    with pytest.raises(UsageError, match=f"{address} has no workers; start some with: dask worker {address}"):
        grade(folder, tmp_path / "out", scheduler=address)
    first, _ = start_worker("first"), start_worker("second")
    here = grade(folder, tmp_path / "here", allow_unconfined=True)

    def kill(done, total, student):
        if done == 2:
            for process in first.children(recursive=True):  # the nanny starts another one
                process.kill()

    there = grade(folder, tmp_path / "there", allow_unconfined=True, scheduler=address, progress=kill)
    assert there.table.read_bytes() == here.table.read_bytes()
    assert there.page.read_bytes() == here.page.read_bytes()
    assert [r.points for r in there.reports] == [4 if i % 3 == 0 else 0 for i in range(COUNT)]
    assert "exited" in log_of(first) or "died" in log_of(first) or "Restarting" in log_of(first)


def log_of(process):
    return (Path(process.cwd()) / "first.log").read_text()


def test_where_no_scheduler_answers_it_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr("gpcourse.grading.cluster.PATIENCE", 0.5)
    folder = write_class(tmp_path / "class", 1)
    for address in ("tcp://127.0.0.1:9", "nonsense://x"):
        with pytest.raises(UsageError, match=f"no scheduler answers at {address}: .*dask scheduler"):
            grade(folder, tmp_path / "out", scheduler=address)
    assert not (tmp_path / "out").exists()


def test_without_the_extra_it_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"pip install 'gpcourse\[cluster\]'"):
        grade(write_class(tmp_path / "class", 1), tmp_path / "out", scheduler="tcp://127.0.0.1:9")
