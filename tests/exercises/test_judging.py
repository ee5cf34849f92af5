"""How answers become a verdict."""

import numpy as np
import pytest

from gpcourse.errors import ExerciseError
from gpcourse.exercises import expect
from gpcourse.exercises.exercise import DoesNotEnd, Exercise
from gpcourse.exercises.judging import ask_here, judge


def double(x: float) -> float:
    """Return twice a number."""
    if x < 0:
        raise ValueError(f"{x} is negative")
    return 2 * x


@pytest.fixture
def exercise():
    made = Exercise(double, notes="here", hints=["think", "think again"], time_limit=0.2)

    @made.check("small numbers")
    def _(f, rng):
        x = float(rng.integers(1, 9))
        expect.close(expect.number(f(x)), 2 * x, 1e-12, "The double", on=f"{x}")

    @made.check("large numbers", points=2)
    def _(f, rng):
        expect.close(expect.number(f(1e6)), 2e6, 1e-6, "The double")

    @made.check("refuses negative numbers")
    def _(f, rng):
        expect.refusal(f, -3.0, because="-3 is negative", naming=[[3]])

    @made.mistake("the number was squared", hint="What is twice 3?")
    def _(x):
        return double(x) * x / 2

    @made.mistake("one was added", hint="What is twice 3?")
    def _(x):
        return double(x) + 1

    @made.mistake("negative numbers were not refused", hint="What does the docstring say?")
    def _(x):
        return 2 * x

    @made.mistake("large numbers never end", hint="Count.")
    def _(x):
        if x > 10:
            raise DoesNotEnd
        return double(x)

    return made


def test_points_are_those_of_the_checks_that_pass(exercise):
    assert exercise.points == 4
    assert judge(exercise, ask_here(double), 0).points == 4
    verdict = judge(exercise, ask_here(lambda x: 2 * x), 0)
    assert (verdict.points, verdict.outcome) == (3, "failed")
    assert [m.name for m in verdict.mistakes] == ["negative numbers were not refused"]


def test_two_mistakes_at_once_are_both_named(exercise):
    verdict = judge(exercise, ask_here(lambda x: 2 * x + (x > 0)), 0)
    assert [r.mistake.name for r in verdict.results if r.mistake] == [
        "one was added",
        "one was added",
        "negative numbers were not refused",
    ]


def test_a_wrong_answer_of_another_kind_has_no_name(exercise):
    verdict = judge(exercise, ask_here(lambda x: 2.3 * x if x > 0 else double(x)), 0)
    assert verdict.outcome == "failed"
    assert verdict.mistakes == ()
    assert verdict.first_problem.wrong.truth


def test_nan_fails(exercise):
    verdict = judge(exercise, ask_here(lambda x: float("nan")), 0)
    assert verdict.outcome == "failed"
    assert "not a finite number" in verdict.first_problem.wrong.message


def test_an_endless_loop_is_a_timeout_and_costs_its_checks_only(exercise):
    def endless(x):
        while x > 10:
            pass
        return double(x)

    verdict = judge(exercise, ask_here(endless), 0)
    assert [r.outcome for r in verdict.results] == ["passed", "timeout", "passed"]
    assert verdict.results[1].trouble.source in ("while x > 10:", "pass")
    assert [m.name for m in verdict.mistakes] == ["large numbers never end"]


def test_an_exception_is_reported_with_the_students_line(exercise):
    def broken(x):
        empty = []
        return empty[3]

    verdict = judge(exercise, ask_here(broken), 0)
    trouble = verdict.first_problem.trouble
    assert (verdict.outcome, trouble.types[0], trouble.source) == ("error", "IndexError", "return empty[3]")


def test_a_stub_that_another_exercise_calls_is_an_error_not_a_stub(exercise):
    def halve():
        raise NotImplementedError

    def double(x):
        return halve()

    assert judge(exercise, ask_here(double), 0).outcome == "error"


def test_a_check_that_breaks_is_our_fault():
    made = Exercise(double, notes="here", hints=["think"])

    @made.check("broken")
    def _(f, rng):
        raise KeyError("ours")

    verdict = judge(made, ask_here(double), 0)
    assert verdict.outcome == "grader fault"
    assert "KeyError" in verdict.first_problem.fault


def test_inputs_changed_in_place_are_reported_and_do_no_harm():
    made = Exercise(np.sort, notes="here", hints=["think"])

    @made.check("sorts")
    def _(f, rng):
        x = rng.normal(size=5)
        before = x.copy()
        expect.close(expect.array(f(x), (5,)), np.sort(before), 0.0, "The numbers")
        np.testing.assert_array_equal(x, before)

    def in_place(numbers):
        numbers.sort()
        return numbers

    verdict = judge(made, ask_here(in_place), 0)
    assert verdict.outcome == "passed"
    assert verdict.changed == ("numbers",)


def test_a_claim_cannot_be_declared_twice(exercise):
    with pytest.raises(ExerciseError, match="declared twice"):
        exercise.check("small numbers")(lambda f, rng: None)


def test_a_mistake_that_errs_nowhere_in_a_check_does_not_explain_it(exercise):
    def vague(x):
        if x < 0:
            raise ValueError("no")  # right to refuse, but it does not say where
        # Wrong on large numbers, so that no passed check speaks against mistakes that are wrong there.
        return 7.0 if x > 10 else 2 * x

    verdict = judge(exercise, ask_here(vague), 0)
    assert verdict.outcome == "failed"
    assert verdict.mistakes == ()


def test_a_mistake_that_would_spoil_a_passed_check_is_not_named():
    made = Exercise(double, notes="here", hints=["think"])

    @made.check("one")
    def _(f, rng):
        expect.close(expect.number(f(1.0)), 2.0, 0.0, "The double")

    @made.check("two")
    def _(f, rng):
        expect.close(expect.number(f(3.0)), 6.0, 0.0, "The double")

    @made.mistake("nine was returned", hint="Is it always nine?")
    def _(x):
        return 9.0

    assert judge(made, ask_here(lambda x: 9.0), 0).mistakes
    assert judge(made, ask_here(lambda x: 9.0 if x == 3 else 2 * x), 0).mistakes == ()


def test_a_mistake_that_divides_by_zero_is_named_without_a_warning():
    made = Exercise(double, notes="here", hints=["think"])

    @made.check("small")
    def _(f, rng):
        expect.close(expect.number(f(1.0)), 2.0, 0.0, "The double")

    @made.mistake("it was divided by what is left", hint="What is left?")
    def _(x):
        return np.float64(2.0) / (x - 1.0)

    verdict = judge(made, ask_here(lambda x: float("inf")), 0)
    assert [m.name for m in verdict.mistakes] == ["it was divided by what is left"]


def test_right_answers_that_differ_do_not_hide_a_mistake():
    made = Exercise(double, notes="here", hints=["think"])

    @made.check("of any sign")
    def _(f, rng):
        expect.close(abs(expect.number(f(1.0))), 2.0, 0.0, "The double")

    @made.check("large")
    def _(f, rng):
        expect.close(expect.number(f(50.0)), 100.0, 0.0, "The double")

    @made.mistake("large numbers give nothing", hint="What is twice 50?")
    def _(x):
        return 2 * x if x < 10 else 0.0

    verdict = judge(made, ask_here(lambda x: -2 * x if x < 10 else 0.0), 0)
    assert [m.name for m in verdict.mistakes] == ["large numbers give nothing"]


def scaled(x: float, *, by: float = 2.0) -> float:
    """Return a multiple of a number."""
    if by == 0:
        raise ValueError("by is 0")
    return by * x


@pytest.fixture
def with_option():
    made = Exercise(scaled, notes="here", hints=["think"])

    @made.check("twice")
    def _(f, rng):
        expect.close(expect.number(f(3.0)), 6.0, 0.0, "The number")

    @made.check("five times")
    def _(f, rng):
        expect.close(expect.number(f(3.0, by=5.0)), 15.0, 0.0, "The number")

    @made.check("refuses zero")
    def _(f, rng):
        expect.refusal(f, 3.0, by=0.0, because="by is 0", naming=[[0]])

    @made.mistake("`by` is not used", hint="What does the call say?")
    def _(x, *, by=2.0):
        return scaled(x)

    return made


def test_options_are_asked_by_name(with_option):
    assert judge(with_option, ask_here(scaled), 0).outcome == "passed"
    assert judge(with_option, ask_here(lambda x, by=2.0: scaled(x, by=by)), 0).outcome == "passed"
    verdict = judge(with_option, ask_here(lambda x, *, by=2.0: 2 * x), 0)
    assert [r.outcome for r in verdict.results] == ["passed", "failed", "failed"]
    assert [m.name for m in verdict.mistakes] == ["`by` is not used"]
    assert verdict.first_problem.question.options == {"by": 5.0}


def test_a_function_without_the_option_is_an_error_that_has_no_name(with_option):
    verdict = judge(with_option, ask_here(lambda x: 2 * x), 0)
    assert [r.outcome for r in verdict.results] == ["passed", "error", "failed"]
    assert verdict.mistakes == ()
    assert "keyword argument 'by'" in verdict.first_problem.trouble.message
