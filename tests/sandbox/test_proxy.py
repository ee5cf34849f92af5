"""A notebook's functions in another process: they answer, whatever they do, and find nothing of ours."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest

from gpcourse.errors import WireError
from gpcourse.geometry import functions
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh
from gpcourse.sandbox import home, proxy
from gpcourse.sandbox.confine import Limits, launch, launcher
from gpcourse.sandbox.folder import read_start, remove
from gpcourse.sandbox.line import Gone
from gpcourse.sandbox.proxy import Worker, answer_from

posix = pytest.mark.skipif(sys.platform == "win32", reason="signals and limits are those of POSIX")


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    return home.build(tmp_path_factory.mktemp("run") / "home")


@pytest.fixture(scope="module")
def quickest(package):
    """What the grader starts workers with here: where it can, it forks them."""
    with launcher(package) as start:
        yield start


@pytest.fixture
def worker(package, quickest, monkeypatch):
    monkeypatch.setattr(proxy, "GRACE", 0.3)

    def make(*cells, fresh=False, **limits):
        start = launch if fresh else quickest
        workers.append(Worker(list(enumerate(cells, start=1)), package, Limits(**limits), start))
        return workers[-1]

    workers = []
    yield make
    for each in workers:
        each.close()


either = pytest.mark.parametrize("fresh", [False, True], ids=["quickest", "fresh"])


def ask(worker, name, *arguments, limit=1.0, **options):
    return worker.ask(name, arguments, options, limit)


@either
def test_arrays_and_meshes_go_there_and_back(worker, fresh):
    mesh = HalfedgeMesh([1, 0], [0, 1], [0, 1], [0, 1], [0, -1], [0, 1], [0], vertices=np.eye(3)[:2])
    w = worker(
        "import numpy as np\ndef f(x, k): return np.asarray(x) * k\ndef g(mesh): return mesh.twin, mesh",
        fresh=fresh,
    )
    assert ask(w, "f", [1.5, 2.5], 2).value.tolist() == [3, 5]
    twin, back = ask(w, "g", mesh).value
    assert twin.tolist() == [1, 0]
    assert np.array_equal(back.vertices, mesh.vertices)


def test_prints_warnings_and_input_disturb_nothing(worker):
    w = worker(
        "import os, sys, warnings\n"
        "def f():\n"
        "    print('gpc1' * 10_000); sys.stderr.write('x' * 100_000)\n"
        "    os.write(1, b'gpc1'); warnings.warn('w')\n"
        "    try:\n        input()\n    except EOFError:\n        return 'no input'\n"
    )
    assert ask(w, "f").value == "no input"


def test_changed_inputs_are_named(worker):
    assert ask(worker("def f(x, y):\n    y.sort()"), "f", [1], [2, 1]).changed == ("y",)


def test_options_go_by_name(worker):
    w = worker("def f(x, *, weights, solver='cg'):\n    weights *= x\n    return weights, solver")
    answer = ask(w, "f", 2.0, weights=np.array([1.0, 3.0]), solver="cholesky")
    weights, solver = answer.value
    assert (weights.tolist(), solver, answer.changed) == ([2, 6], "cholesky", ("weights",))
    assert "'weight'" in ask(w, "f", 2.0, weights=1.0, weight=1.0).trouble.message


def test_an_exception_comes_with_the_line_of_the_student(worker):
    answer = ask(worker("x = 1", "def f(n):\n    rows = []\n    return rows[n]"), "f", 3)
    assert answer.status == "raised"
    trouble = answer.trouble
    assert (trouble.types[0], trouble.place, trouble.line, trouble.source, trouble.function) == (
        "IndexError", "cell 2", 3, "return rows[n]", "f",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("body", "status"),
    [
        ("while True: pass", "timeout"),
        ("while 1:\n        try:\n            while 1: pass\n        except BaseException: pass", "timeout"),
        ("import os; os._exit(0)", "crashed"),
        pytest.param("import os; os.kill(os.getpid(), 9)", "crashed", marks=posix),
        pytest.param("import ctypes; ctypes.string_at(0)", "crashed", marks=posix),
        ("import os; os.closerange(3, 100)", "crashed"),
        ("import sys; sys.exit()", "raised"),
        ("raise KeyboardInterrupt", "raised"),
        ("return f()", "raised"),
        ("return range(10**12)", "raised"),
        ("class Endless(list):\n        def __len__(self): return 2\n        def __iter__(self):\n"
         "            while True: pass\n    return Endless()", "timeout"),
        pytest.param("return bytearray(10**11)", "out of memory", marks=posix),
    ],
)  # fmt: skip
def test_whatever_a_function_does_the_next_question_is_answered(worker, body, status):
    alone = "getpid" in body  # in namespaces it could not signal itself
    w = worker(f"def f():\n    {body}\ndef g(): return 7", fresh=alone)
    assert ask(w, "f", limit=0.2).status == status
    assert ask(w, "g").value == 7


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere limits are of time on the clock")
@either
def test_code_that_never_comes_back_to_python_is_killed(worker, fresh):
    """Its processor time decides, however slowly that passes: on the clock it would have 110 s."""
    w = worker("def f(): return sum(range(10**11))", fresh=fresh, patience=100.0)
    start = time.monotonic()
    assert ask(w, "f", limit=0.1).status == "timeout"
    assert time.monotonic() - start < w.limits.wall(0.1) / 2


@posix
@either
def test_a_crash_names_its_line_and_signal(worker, fresh):
    cells = "x = 1", "import ctypes\n\ndef f():\n    return ctypes.string_at(0)"
    trouble = ask(worker(*cells, fresh=fresh), "f").trouble
    assert "SIGSEGV" in trouble.message
    assert (trouble.place, trouble.line, trouble.source) == ("cell 2", 4, "return ctypes.string_at(0)")


def test_a_process_that_left_somebody_behind_with_its_pipes_is_not_waited_for(worker):
    if sys.platform == "win32":
        pytest.skip("there is no fork")
    w = worker(
        "import os, time\n"
        "def f():\n"
        "    if os.fork() == 0:\n        os.setsid(); time.sleep(6); os._exit(0)\n"
        "    os._exit(1)\n"
    )
    forks = w.prepare("f") and w._line.confinement.level == "limits"  # elsewhere it is refused
    assert ask(w, "f", limit=0.1).status == ("crashed" if forks else "raised")


@either
def test_solutions_checks_and_environment_are_out_of_reach(worker, fresh, monkeypatch):
    monkeypatch.setenv("SECRET", "1")
    w = worker(
        "import importlib, os, sys\n"
        "from gpcourse.reference import halfedge as reference\n"
        "def has(name):\n"
        "    try:\n        importlib.import_module(name)\n    except ImportError:\n        return False\n"
        "    return True\n"
        "def cheat(mesh): return reference.genus(mesh)\n"
        "def environment(): return [k for k in os.environ if 'SECRET' in k or 'PYTEST' in k], sys.argv\n"
        "def loaded(): return sorted(m for m in sys.modules if m.startswith('gpcourse'))\n",
        fresh=fresh,
    )
    assert ask(w, "has", "gpcourse.geometry").value is True
    for name in (
        "gpcourse.exercises",
        "gpcourse.grading",
        "gpcourse.sandbox.confine",
        "gpcourse.exercises.halfedge",
    ):
        assert ask(w, "has", name).value is False
    trouble = ask(w, "cheat", 1).trouble
    assert trouble.types[0] == "ReferenceIsAbsent"
    assert "reference.genus is not there" in trouble.message
    assert ask(w, "environment").value == ([], [""])
    assert not any("exercises" in m or "grading" in m for m in ask(w, "loaded").value)


def test_the_names_of_the_notebook_are_there_and_do_nothing(worker):
    w = worker(
        "from gpcourse import check, hint, solution, progress, working, view, shapes, HalfedgeMesh\n"
        "def g(): return 3\n"
        "def f():\n"
        "    check(f); hint(f); view.side_by_side(view.mesh(1), title='x')\n"
        "    return working(g)(), len(shapes.tetrahedron().faces)\n"
    )
    assert ask(w, "f").value == (3, 4)


def test_random_numbers_and_the_order_of_sets_are_the_same_in_each_process(package, quickest):
    cell = (
        "import random\nimport numpy as np\n"
        "def f(): return [random.random(), np.random.rand(), list({'a', 'b', 'c', 'd'})]"
    )
    answers = []
    for start in (launch, quickest):
        with Worker([(1, cell)], package, Limits(), start) as w:
            answers += [ask(w, "f").value, ask(w, "f").value]
    assert answers[0] == answers[1] == answers[2] == answers[3]


def test_each_function_has_a_namespace_of_its_own(worker):
    w = worker("state = []\ndef f():\n    state.append(1)\n    return len(state)\ndef g(): return len(state)")
    assert ask(w, "f").value == 1
    assert ask(w, "g").value == 0


def test_a_statement_that_fails_costs_what_depends_on_it(worker):
    w = worker(
        "import not_installed\nx = 1 / 0",
        "def f(): return x",
        "def g(): return not_installed",
        "def h(): return 1",
    )
    assert ask(w, "h").value == 1
    assert ask(w, "f").trouble.types[0] == "NameError"
    assert w.prepare("f").notes[0].types[0] == "ZeroDivisionError"
    assert w.prepare("g").notes[0].place == "cell 1"


@pytest.mark.parametrize("later", ["area = len('abcd')", "f = f()", "area, f = 5, 6"])
def test_a_function_whose_name_a_demonstration_took_is_called_all_the_same(worker, later):
    w = worker("def area():\n    return 3", "def f():\n    return area()", later)
    assert w.ask("f", (), {}, 5.0).value == 3
    assert w.ask("area", (), {}, 5.0).value == 3


def test_a_name_that_is_read_has_its_last_value(worker):
    w = worker("def area():\n    return 3", "area = len('abcd')", "def f():\n    return area")
    assert w.ask("f", (), {}, 5.0).value == 4


def test_an_error_of_a_cell_is_no_refusal_of_an_input(worker):
    w = worker("def decorate(f): raise ValueError('0 1 2 3')", "@decorate\ndef f(x): pass")
    answer = ask(w, "f", 1)
    assert answer.status == "raised"
    assert "ValueError" not in answer.trouble.types


def test_an_endless_loop_in_a_needed_cell_costs_its_function_only(worker):
    w = worker("while True:\n    x = 1", "def f(): return x", "def g(): return 1", load=0.3)
    assert ask(w, "f").status == "timeout"
    assert ask(w, "g").value == 1


def test_the_survey_runs_nothing(worker):
    survey = worker(
        "import os\nx = os._exit(1)", "def f(: pass", "def g():\n    raise NotImplementedError"
    ).survey()
    assert survey.names == ("g", "os", "x")
    assert survey.stubs == ("g",)
    assert [t.place for t in survey.broken] == ["cell 2"]


def test_a_process_that_takes_the_place_of_another_reads_what_is_needed_only(worker):
    w = worker("A = 2", "def f(): return A", "B = 3", "def g(): return A * B")
    assert w.survey(["f", "g", "h"]).names == ("A", "B", "f", "g")
    w.close()
    assert ask(w, "f").value == 2
    assert w._loaded == {1, 2}
    assert ask(w, "g").value == 6
    assert w._loaded == {1, 2, 3, 4}
    w.close()
    assert w.prepare("h").status == "missing"
    assert w._loaded == set()


def test_what_cannot_be_sent_is_our_fault_and_hurts_no_process(worker):
    w = worker("def f(x): return x")
    with pytest.raises(WireError):
        ask(w, "f", object())
    assert ask(w, "f", 1).value == 1


def test_a_forged_reply_is_an_answer_at_most(worker):
    w = worker(
        "import os\nfrom gpcourse.sandbox import wire\n"
        "def f():\n    for fd in range(3, 30):\n        try:\n"
        "            os.write(fd, wire.pack({'number': 99, 'status': 'returned', 'value': 'forged'}))\n"
        "        except OSError:\n            pass\n"
        "def g(): return 'honest'\n"
    )
    assert ask(w, "f").status == "crashed"
    assert ask(w, "g").value == "honest"


@pytest.mark.parametrize(
    "reply",
    [
        {}, {"status": "passed"}, {"status": ["returned"]}, {"status": "raised", "trouble": 3},
        {"status": "raised", "trouble": (1, 2, 3, 4, 5, 6)}, {"status": "returned", "seconds": "long"},
        {"status": "returned", "changed": [3, ("a",)]},
    ],
)  # fmt: skip
def test_a_reply_of_any_content_is_read_as_an_answer(reply):
    answer = answer_from(reply)
    assert answer.status in ("returned", "raised", "crashed")
    assert isinstance(answer.seconds, float)


def test_text_of_a_student_is_short_printable_and_the_same_each_time(worker):
    w = worker(
        "def f(): raise RuntimeError('\\x1b[31m' + repr(object()) + __import__('os').getcwd() + 'x' * 9999)"
    )
    first, second = ask(w, "f").trouble.message, ask(w, "f").trouble.message
    w.close()
    assert first == second == ask(w, "f").trouble.message
    assert first.startswith("<object object>.x")
    assert len(first) <= 2000


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere limits are of time on the clock")
def test_a_busy_machine_takes_nothing_from_a_limit(worker):
    """The call needs 0.6 s of a processor, with a limit of 1 s, while it gets less than half of one."""
    burners = [
        subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2 * (os.cpu_count() or 1))
    ]
    try:
        w = worker(
            "import time\n"
            "def f():\n"
            "    start, clock = time.process_time(), time.perf_counter()\n"
            "    while time.process_time() < start + 0.6: pass\n"
            "    return time.perf_counter() - clock\n"
        )
        answer = ask(w, "f", limit=1.0)
    finally:
        for burner in burners:
            burner.kill()
            burner.wait()
    assert answer.status == "returned"
    assert answer.value > 0.6


def test_a_process_that_dies_while_it_reads_is_replaced(worker):
    w = worker("def f(): return 1")
    start, w.start = w.start, lambda package, limits: dying(start(package, limits))

    def dying(line):
        line.kill()
        return line

    assert "SIGKILL" in w.survey().crash.message
    w.start = start
    assert ask(w, "f").value == 1


def test_a_line_that_is_closed_writes_to_nobody(worker):
    w = worker("def f(): return 1")
    assert ask(w, "f").value == 1
    line = w._line
    line.close()
    with pytest.raises(Gone):
        line.request("call", 1.0, 1.0)


def test_answers_that_are_kept_do_not_fill_our_memory(worker):
    w = worker("import numpy as np\ndef f(n): return np.zeros(n)\ndef g(): return 1", answers=2**20)
    statuses = [ask(w, "f", 10**5).status for _ in range(3)]  # 0.8 MB each
    assert statuses == ["returned", "raised", "raised"]
    assert "too large: together" in ask(w, "f", 1).trouble.message
    assert ask(w, "g").value == 1


def test_what_is_asked_again_may_answer_as_much_again(worker):
    w = worker("import numpy as np\ndef f(): return np.zeros(10**5)", answers=2**20)
    for _ in range(3):
        assert ask(w, "f").status == "returned"
        w.renew("f")


def test_a_function_may_be_asked_with_all_that_it_may_need(worker):
    w = worker("T = []\ndef fill(t): t.append(2)", "fill(T)", "def f(): return T[0]\ndef g(): return 1")
    assert w.survey(["f", "g"]).unsure == ("f",)
    assert ask(w, "f").status == "raised"
    w.renew("f", most=True)
    assert ask(w, "f").value == 2


def test_a_message_may_be_long_and_stays_what_it_is(worker):
    w = worker("def f(): raise ValueError('3 ' + 'x' * 3 * 10**6)\ny = [1] + 'x'\ndef g(): return y")
    trouble = ask(w, "f").trouble
    assert trouble.types[:1] == ("ValueError",)
    assert trouble.message.startswith("3 xxx")


def test_a_cell_may_be_longer_than_a_text_that_crosses(worker):
    w = worker("data = '" + "ü" * 2_000_000 + "'", "def f(): return len(data)", "z = '" + "x" * 2_000_000)
    assert ask(w, "f").value == 2_000_000
    assert [t.place for t in w.survey().broken] == ["cell 3"]


@posix
def test_what_a_folder_holds_is_not_trusted(tmp_path):
    folder = tmp_path / "scratch"
    (folder / "a" / "b").mkdir(parents=True)
    (tmp_path / "theirs").write_text("x")
    (folder / "link").symlink_to(tmp_path / "theirs")
    (folder / "a" / "up").symlink_to(tmp_path)
    os.mkfifo(folder / "fifo")
    for name in ("link", "fifo", "a", "nothing"):
        with pytest.raises(OSError):  # noqa: PT011  # a link, a pipe, a folder, nothing: each has its number
            read_start(folder / name, 10)
    assert read_start(tmp_path / "theirs", 10) == b"x"
    top = os.open(folder, os.O_RDONLY)
    for _ in range(1100):  # deeper than a function may call itself
        os.mkdir("d", dir_fd=top)
        inner = os.open("d", os.O_RDONLY, dir_fd=top)
        os.close(top)
        top = inner
    os.close(top)
    (folder / "a" / "b").chmod(0)
    remove(folder)
    assert [p.name for p in tmp_path.iterdir()] == ["theirs"]


def test_a_function_of_space_is_called_where_the_student_is(worker):
    w = worker(
        "import numpy as np\n"
        "def slope(F, points, h):\n"
        "    differences = [F(points + h * e) - F(points - h * e) for e in np.eye(3)]\n"
        "    return np.stack(differences, axis=-1) / (2 * h)\n"
        "def keep(F): return F\n"
    )
    points = np.linspace(-1, 1, 12).reshape(4, 3)
    answer = ask(w, "slope", functions.sphere([0, 0, 1], 2.0), points, 1e-3)
    assert answer.value == pytest.approx(2 * (points - [0, 0, 1]))  # exact: the polynomial is quadratic
    assert answer.changed == ()
    assert type(ask(w, "keep", functions.helix(1.0, 1.0)).value).__name__ == "TrigonometricCurve"
