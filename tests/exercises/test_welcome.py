"""The warm-up exercise: right solutions pass, and each mistake is named."""

import numpy as np
import pytest

from gpcourse.exercises.judging import ask_here, judge
from gpcourse.exercises.welcome import TRIANGLE_AREA
from gpcourse.reference.welcome import triangle_area

SEEDS = range(20)


def verdict_on(function, seed=0):
    return judge(TRIANGLE_AREA, ask_here(function), seed)


@pytest.mark.parametrize("variant", TRIANGLE_AREA.variants, ids=lambda v: v.name)
def test_other_right_solutions_pass(variant):
    for seed in SEEDS:
        assert verdict_on(variant.function, seed).outcome == "passed"


@pytest.mark.parametrize("mistake", TRIANGLE_AREA.mistakes, ids=lambda m: m.name)
def test_each_mistake_fails_under_its_own_name(mistake):
    for seed in SEEDS:
        verdict = verdict_on(mistake.function, seed)
        assert verdict.outcome == "failed"
        assert [m.name for m in verdict.mistakes] == [mistake.name]


def test_every_check_is_failed_by_something():
    wrong = [m.function for m in TRIANGLE_AREA.mistakes] + [lambda a, b, c: 6.0]
    failed = {r.check.claim for f in wrong for r in verdict_on(f).results if r.outcome == "failed"}
    assert failed == {check.claim for check in TRIANGLE_AREA.checks}


def test_the_reference_gets_all_points():
    assert verdict_on(triangle_area).points == TRIANGLE_AREA.points == 4


def test_a_vector_of_any_length_and_sign_is_recognised_as_a_vector():
    verdict = verdict_on(lambda a, b, c: np.cross(c - a, b - a))
    assert [m.name for m in verdict.mistakes] == ["a vector is returned where its length was meant"]


@pytest.mark.parametrize("value", [None, "6", [1, 2], np.nan, {}, object(), len])
def test_a_value_that_is_no_number_is_a_failure_not_a_fault(value):
    assert {r.outcome for r in verdict_on(lambda a, b, c: value).results} == {"failed"}
