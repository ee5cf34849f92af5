"""What a student meets: check, hint, solution, progress, working."""

import json
import threading
import time

import numpy as np
import pytest

from gpcourse.errors import UsageError
from gpcourse.exercises.course import CHAPTERS, find
from gpcourse.notebook import check, hint, progress, solution, working
from gpcourse.notebook.asked import Interrupted
from gpcourse.notebook.checking import PRINTED
from gpcourse.notebook.fingerprint import fingerprint
from gpcourse.notebook.store import FILE, Record, Store
from gpcourse.reference.welcome import triangle_area as reference


def right():
    def triangle_area(a, b, c):
        return np.linalg.norm(np.cross(b - a, c - a)) / 2

    return triangle_area


def wrong():
    def triangle_area(a, b, c):
        return np.linalg.norm(np.cross(b - a, c - a))

    return triangle_area


def stub():
    def triangle_area(a, b, c):
        raise NotImplementedError

    return triangle_area


# check ------------------------------------------------------------------------------------------


def test_the_verdict_is_that_of_the_function():
    outcomes = [check(f).verdict.outcome for f in (right(), wrong(), stub())]
    assert outcomes == ["passed", "failed", "not attempted"]


def test_the_panel_is_html_and_text():
    panel = check(wrong())
    assert "the ½ is missing" in repr(panel)
    assert "the ½ is missing" in panel._repr_html_()


def test_the_arguments_are_those_of_the_failing_call():
    panel = check(wrong())
    assert reference(*panel.arguments) == pytest.approx(float(panel.verdict.first_problem.wrong.truth))
    panel.arguments[0][:] = 7.0  # a copy
    assert reference(*panel.arguments) != 7.0
    assert panel.arguments[0].tolist() == [0, 0, 0]
    assert check(right()).arguments == ()


def test_a_check_that_asks_first_and_judges_later_still_gives_the_right_arguments():
    def vertex_neighbours_ccw(mesh, v):
        return find("vertex_neighbours_cw").reference(mesh, v)

    panel = check(vertex_neighbours_ccw)
    problem = panel.verdict.first_problem
    mesh, v = panel.arguments
    assert problem.wrong.on.split()[:2] == ["vertex", str(v)]
    assert str(vertex_neighbours_ccw(mesh, v)) == problem.wrong.yours


def test_the_same_inputs_come_every_time():
    first, second = check(wrong()).arguments, check(wrong()).arguments
    assert all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))


def test_what_the_function_prints_is_shown_up_to_a_limit(capsys):
    def triangle_area(a, b, c):
        print("look:", a)
        print("y" * 3000)
        return 0.0

    check(triangle_area)
    out = capsys.readouterr().out
    assert out.startswith("look: [0. 0. 0.]")
    assert len(out) < PRINTED + 100
    assert "left out" in out


def test_the_students_own_interrupt_passes_through():
    def triangle_area(a, b, c):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match="interrupted") as caught:
        check(triangle_area)
    assert isinstance(caught.value, Interrupted)
    assert len(caught.value._render_traceback_()) == 1


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (3, "needs the function itself, and got a value of type int"),
        (None, "NoneType"),
        ("genus", r"write check\(genus\), without quotation marks"),
        ("not a name", r"write check\(f\)"),
        (lambda x: x, "a lambda has none"),
        (len, "there is no exercise called len"),
    ],
)
def test_bad_input_gets_one_line_without_our_traceback(value, message):
    with pytest.raises(UsageError, match=message) as caught:
        check(value)
    assert caught.value._render_traceback_() == [str(caught.value)]


def test_a_near_name_is_offered():
    def triangle_areas(a, b, c):
        return 0

    with pytest.raises(UsageError, match="did you mean triangle_area"):
        check(triangle_areas)


def test_checking_also_works_in_a_thread_and_ends_endless_loops_there():
    def triangle_area(a, b, c):
        while True:
            pass

    panels = []
    thread = threading.Thread(target=lambda: panels.append(check(triangle_area)))
    thread.start()
    thread.join(30)
    assert panels[0].verdict.outcome == "timeout"


def test_a_check_costs_little_beyond_the_function():
    exercise = find("genus")
    check(exercise.reference)
    start = time.process_time()
    panel = check(exercise.reference)
    cost = time.process_time() - start
    own = sum(q.answer.seconds for r in panel.verdict.results for q in r.questions)
    assert cost - own < 0.3


# hint and solution ------------------------------------------------------------------------------


def test_hints_come_one_at_a_time_and_say_how_many_there_are():
    hints = find("genus").hints
    given = [repr(hint("genus")) for _ in hints]
    assert all(f"{i} of {len(hints)}" in text for i, text in enumerate(given, start=1))
    assert all(words in text for words, text in zip(hints, given, strict=True))
    assert "solution(genus)" in given[-1]
    assert hints[0] in repr(hint("genus"))


def test_the_solution_comes_when_asked_twice_and_without_those_of_others():
    first, second = repr(solution("genus")), solution("genus")
    assert "def genus" not in first
    assert "hint(genus)" in first
    assert "def genus" in second.code
    assert "def _n_components" in second.code  # its private helper
    assert "def euler_characteristic" not in second.code  # another exercise
    assert "<pre" in second._repr_html_()


@pytest.mark.parametrize("ask", [hint, solution, working])
def test_names_and_functions_are_both_understood_and_others_refused(ask):
    ask("triangle_area")
    ask(right())
    with pytest.raises(UsageError, match="no exercise"):
        ask("nothing_of_ours")
    with pytest.raises(UsageError, match="needs the function itself"):
        ask(3)


# progress ---------------------------------------------------------------------------------------


def test_progress_shows_the_last_check():
    assert progress().points == 0
    check(right())
    assert progress().points == find("triangle_area").points
    check(wrong())
    assert progress().points < find("triangle_area").points


def test_progress_shows_the_chapters_that_were_begun_or_the_one_asked_for():
    assert len(progress().sections) == len(CHAPTERS)
    check(wrong())
    (section,) = progress().sections
    assert section.title.endswith("Welcome")
    for name in ("halfedge", 1, "1_halfedge.ipynb"):
        (section,) = progress(name).sections
        assert section.of == CHAPTERS[1].points
    assert "triangle_area" in progress()._repr_html_()
    assert "failed" in repr(progress())


@pytest.mark.parametrize("name", ["nothing", 99, True])
def test_a_chapter_that_is_not_there_is_refused(name):
    with pytest.raises(UsageError, match="no chapter"):
        progress(name)


# working ----------------------------------------------------------------------------------------


def test_working_goes_on_with_the_students_function_once_it_passed(capsys):
    mine = right()
    assert working(mine) is reference
    check(mine)
    assert working(mine) is mine
    assert working(right()) is not reference  # the same code, run again
    assert working(stub()) is reference
    check(wrong())
    assert working(mine) is reference
    lines = capsys.readouterr().out.splitlines()
    assert [("your" in line.split()) for line in lines] == [False, True, True, False, False]


def test_working_notices_a_change_in_a_function_that_is_used():
    namespace = {"__name__": "cells"}
    exec("def half(x):\n    return x / 2", namespace)
    exec("def twice(x):\n    return 4 * half(x)", namespace)
    before = fingerprint(namespace["twice"])
    exec("def half(x):\n    # the same\n    return x / 2", namespace)
    assert fingerprint(namespace["twice"]) == before
    exec("def half(x):\n    return x / 3", namespace)
    assert fingerprint(namespace["twice"]) != before


def test_a_docstring_is_no_change_and_a_default_is_one():
    space = {}
    exec('def a(x=1):\n    "one"\n    return x\nb = a', space)
    exec('def a(x=1):\n    "two"\n    return x\nc = a', space)
    exec('def a(x=2):\n    "two"\n    return x\nd = a', space)
    assert fingerprint(space["b"]) == fingerprint(space["c"]) != fingerprint(space["d"])


# The file ---------------------------------------------------------------------------------------

RECORD = Record("passed", 4, 4, "code")


def test_records_survive_a_restart(tmp_path):
    Store(tmp_path / FILE).put("genus", RECORD)
    Store(tmp_path / FILE).put("cube", RECORD)
    assert Store(tmp_path / FILE).records() == {"genus": RECORD, "cube": RECORD}
    assert [path.name for path in tmp_path.iterdir()] == [FILE]


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[]",
        "3",
        "\x00\xff",
        '{"format": "another"}',
        '{"format": "gpcourse progress 1"}',
        '{"format": "gpcourse progress 1", "exercises": {"genus": 3}}',
        '{"format": "gpcourse progress 1", "exercises": {"genus": {"outcome": 1}}}',
        json.dumps({"format": "gpcourse progress 1", "exercises": {"g": {**RECORD.__dict__, "points": "4"}}}),
        "[" * 100_000,
        " " * (2**20 + 1),
    ],
    ids=range(12),
)
def test_a_damaged_or_foreign_file_is_set_aside_and_never_overwritten(own_progress, capsys, text):
    own_progress.write_text(text, encoding="latin-1")
    own_progress.with_name("progress.json.bak").write_text("older")
    check(right())
    assert progress().points == find("triangle_area").points
    assert own_progress.with_name("progress.json.bak").read_text() == "older"
    assert own_progress.with_name("progress.json.bak2").read_text(encoding="latin-1") == text
    assert capsys.readouterr().out.count("Note:") == 1


def test_a_folder_that_cannot_be_written_costs_nothing_until_the_restart(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("GPCOURSE_PROGRESS", str(tmp_path / "missing" / "progress.json"))
    for _ in range(2):
        check(right())
    assert progress().points == find("triangle_area").points
    assert capsys.readouterr().out.count("Note:") == 1


def test_a_folder_in_the_place_of_the_file_does_no_harm(own_progress):
    own_progress.mkdir()
    check(right())
    assert progress().points == find("triangle_area").points


def test_points_of_an_older_course_are_never_more_than_there_are(own_progress):
    Store(own_progress).put("triangle_area", Record("passed", 99, 99, ""))
    assert progress().points == find("triangle_area").points
