"""One call of a student's function."""

import threading
import time

import numpy as np
import pytest

from gpcourse.geometry import shapes
from gpcourse.reference.halfedge import halfedge_mesh
from gpcourse.sandbox.call import call
from gpcourse.sandbox.deadline import TimeLimit, deadline
from gpcourse.sandbox.values import same


def endless():
    while True:
        pass


def stubborn():
    start = time.monotonic()
    while time.monotonic() - start < 0.4:  # swallows the first interruptions, then gives in
        try:
            while time.monotonic() - start < 0.4:
                pass
        except BaseException:  # noqa: BLE001  # as a careless student would
            continue
    endless()


@pytest.mark.parametrize("function", [endless, stubborn, lambda: time.sleep(60)])
def test_a_loop_that_does_not_end_is_interrupted(function):
    start = time.monotonic()
    answer = call(function, (), 0.1)
    assert answer.status == "timeout"
    assert time.monotonic() - start < 30  # a busy machine is slow, yet it does not wait for the end


def test_a_deadline_works_in_a_thread_and_leaves_nothing_behind():
    seen = []

    def work():
        for _ in range(5):
            seen.append(call(endless, (), 0.05).status)
            sum(range(100_000))  # a late interruption would strike here

    thread = threading.Thread(target=work)
    thread.start()
    thread.join(10)
    assert seen == ["timeout"] * 5


def test_a_deadline_that_is_met_does_nothing():
    for _ in range(200):
        with deadline(5):
            pass
    time.sleep(0.01)


def test_time_limit_passes_through_a_broad_except():
    def careless():
        try:
            endless()
        except Exception:  # noqa: BLE001  # as a careless student would
            return 1

    with pytest.raises(TimeLimit), deadline(0.05):
        careless()


def test_the_students_line_is_found_below_library_code():
    def broken():
        return np.linalg.inv(np.zeros((2, 3)))

    trouble = call(broken, (), 1).trouble
    assert trouble.types[0] == "LinAlgError"
    assert trouble.function == "broken"
    assert trouble.source == "return np.linalg.inv(np.zeros((2, 3)))"


@pytest.mark.parametrize("error", [SystemExit(3), GeneratorExit(), RecursionError("deep")])
def test_whatever_is_raised_becomes_an_answer(error):
    def raising():
        raise error

    answer = call(raising, (), 1)
    assert (answer.status, answer.trouble.types[0]) == ("raised", type(error).__name__)


def test_an_exception_whose_text_fails_becomes_an_answer():
    class Nasty(Exception):
        def __str__(self):
            raise RuntimeError

    def raising():
        raise Nasty

    assert "cannot be printed" in call(raising, (), 1).trouble.message


def test_keyboard_interrupt_is_the_users_own():
    def interrupted():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        call(interrupted, (), 1)


def test_memory_errors_have_a_status_of_their_own():
    def greedy():
        raise MemoryError

    assert call(greedy, (), 1).status == "out of memory"


def test_inputs_are_copied_and_changes_named():
    mesh = halfedge_mesh(*shapes.tetrahedron())
    numbers = [1, 2, 3]

    def meddling(mesh, numbers):
        mesh.next[0] = 7
        numbers.append(4)

    answer = call(meddling, (mesh, numbers), 1)
    assert answer.changed == ("mesh", "numbers")
    mesh.validate()
    assert numbers == [1, 2, 3]


def test_options_go_by_name_and_are_copied_too():
    numbers = [1, 2, 3]

    def meddling(x, *, order, reverse=False):
        order.sort(reverse=reverse)
        return order

    answer = call(meddling, (0,), 1, options={"order": numbers, "reverse": True})
    assert (answer.value, answer.changed) == ([3, 2, 1], ("order",))
    assert numbers == [1, 2, 3]


def test_sameness_is_of_structure_and_numbers():
    assert same([1, 2], (1.0, 2.0))
    assert same({"a": np.eye(2)}, {"a": [[1, 0], [0, 1]]})
    assert same([[1, 2], [3]], [(1, 2), np.array([3])])
    assert not same([1, 2], [1, 2, 3])
    assert not same([1, 2], [[1, 2]])
    assert not same("a", None)
    assert same(np.array([np.nan, 1]), np.array([np.nan, 1 + 1e-12]), 1e-9)
    assert not same(np.array([1.0, 1e-3]), np.array([1.0, 2e-3]), 1e-9)
    assert not same(np.array([1.0]), np.array([np.inf]), 1e-9)
