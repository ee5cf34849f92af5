"""What a class's judge remembers changes no verdict: it is compared with one that remembers nothing."""

import pytest

from gpcourse.exercises.course import CHAPTERS
from gpcourse.grading import gradebook, reports
from gpcourse.grading.judge import afresh, judge_submission
from gpcourse.grading.reading import Notebook
from gpcourse.grading.recall import Memory, Recall
from gpcourse.grading.records import encode
from gpcourse.grading.submission import Submission
from gpcourse.sandbox import confine, home
from gpcourse.sandbox.proxy import Worker

RIGHT = "np.linalg.norm(np.cross(np.subtract(b, a), np.subtract(c, a))) / 2"
CHI = "len(np.unique(mesh.origin)) - mesh.n_halfedges // 2 + mesh.n_faces"

#: The body of triangle_area(a, b, c) and what stands before it, then the body of euler_characteristic(mesh).
CLASS = {
    "right": ("", f"return {RIGHT}", f"return {CHI}"),
    "right too": ("", f"area = {RIGHT}\n    return area", f"return {CHI}"),
    "wrong": ("", f"return 2 * {RIGHT}", "return 0"),
    "wrong too": ("", f"return {RIGHT} * 2", "return 0"),
    "raises": ("", "return no_such_name", "return mesh.no_such_name"),
    "raises elsewhere": ("", "\n    return no_such_name", "\n    return mesh.no_such_name"),
    "stub": ("", "raise NotImplementedError", "raise NotImplementedError"),
    "right once": ("n = []", f"n.append(1)\n    return {RIGHT} * len(n)", f"return {CHI}"),
    "wrong once": ("n = []", f"n.append(1)\n    return {RIGHT} if len(n) > 1 else -1.0", f"return {CHI}"),
    "right at last": ("n = []", f"n.append(1)\n    return {RIGHT} if len(n) > 4 else -1.0", "return 1"),
    "crashes late": (
        "import os\nn = []",
        f"n.append(1)\n    if len(n) == 3: os._exit(3)\n    return {RIGHT}",
        "return 0",
    ),
    "says nonsense": ("", "return object()", "return {1: [mesh] * 2, 'a': b'x'}"),
    "nan": ("", "return float('nan')", "return float('nan')"),
    "changes its input": ("", "a *= 0\n    return 0.0", "mesh.twin[:] = 0\n    return 0"),
    "forges": (
        "import os, struct",
        "for fd in range(3, 30):\n"
        "        try: os.write(fd, struct.pack('<QI?', 3, 0, False) * 3)\n"
        "        except OSError: pass\n"
        f"    return {RIGHT}",
        f"return {CHI}",
    ),
}  # fmt: skip
EXERCISES = [
    e for c in CHAPTERS[:2] for e in c.exercises if e.name in ("triangle_area", "euler_characteristic")
]


@pytest.fixture(scope="module")
def open_worker(tmp_path_factory):
    package = home.build(tmp_path_factory.mktemp("run") / "home")
    limits = confine.Limits(load=2.0)
    with confine.launcher(package) as launch:
        yield lambda notebook: Worker(list(notebook.cells), package, limits, launch)


def submission(name):
    before, area, chi = CLASS[name]
    cells = (
        f"import numpy as np\n{before}",
        f"def triangle_area(a, b, c):\n    {area}",
        f"def euler_characteristic(mesh):\n    {chi}",
    )
    return Submission("somebody", (Notebook("hw.ipynb", tuple(enumerate(cells, start=1))),))


def test_a_remembered_verdict_is_the_one_that_would_be_found(open_worker):
    def judged(name, judge):
        report = judge_submission(submission(name), EXERCISES, 5, open_worker, judge)
        record = encode(report)
        for one in record["judged"]:
            del one["seconds"]
        # Pages have pictures, which take their time: these two are of a wrong value and of an exception.
        page = reports.student_page(report, CHAPTERS[:2]) if name in ("wrong", "raises") else ""
        return report.points, record, gradebook.gradescope(report), page

    recall = Recall(5)
    alone = {name: judged(name, afresh(5)) for name in CLASS}
    assert {name: judged(name, recall.judge) for name in CLASS} == alone
    assert {name: judged(name, recall.judge) for name in reversed(CLASS)} == alone
    points = {name: got for name, (got, *_) in alone.items()}
    most = sum(exercise.points for exercise in EXERCISES)
    assert points["right"] == points["right too"] == most
    assert points["right once"] < most
    assert points["raises"] == points["stub"] == points["says nonsense"] == 0


def test_a_check_is_run_once_for_all_who_answer_alike(open_worker, monkeypatch):
    from gpcourse.grading import recall as module

    runs = []
    real = module.run_check
    monkeypatch.setattr(module, "run_check", lambda check, *rest: runs.append(check) or real(check, *rest))
    judge = Recall(5).judge
    judge_submission(submission("right"), EXERCISES, 5, open_worker, judge)
    once = len(runs)
    judge_submission(submission("right too"), EXERCISES, 5, open_worker, judge)
    assert once == len(runs) == sum(len(exercise.checks) for exercise in EXERCISES)


def test_a_memory_forgets_what_was_not_used_for_longest():
    memory = Memory(3000)
    for i in range(4):
        memory.put(i, str(i), 400)
        memory.get(0)
    assert [memory.get(i) for i in range(4)] == ["0", None, "2", "3"]
    assert memory.size <= memory.capacity
