"""Every exercise of the course keeps the same promises."""

import os

import pytest

from gpcourse.exercises.course import CHAPTERS, by_name, chapter_of, find
from gpcourse.exercises.judging import ask_here, judge

#: Half-edges, the pattern for all, are tried on 20 seeds; the longer chapters on fewer, which keeps a run
#: under ten minutes. `GPCOURSE_SEEDS=20` tries all on 20.
SEEDS = {"welcome": 20, "halfedge": 20}
FEWER = 3


def seeds(exercise):
    """Return the seeds that an exercise is tried on."""
    wanted = os.environ.get("GPCOURSE_SEEDS")
    return range(int(wanted) if wanted else SEEDS.get(chapter_of(exercise).stem, FEWER))


EXERCISES = [exercise for chapter in CHAPTERS for exercise in chapter.exercises]
SOLUTIONS = [
    pytest.param(exercise, function, id=f"{exercise.name}-{name}")
    for exercise in EXERCISES
    for name, function in [
        ("reference", exercise.reference),
        *((v.name, v.function) for v in exercise.variants),
    ]
]


def options(exercise):
    """Return the parameters that may be left out, with their defaults."""
    parameters = exercise.signature.parameters.values()
    return {p.name: p.default for p in parameters if p.default is not p.empty}


JUNK = [None, -1.5, "text", [], {}, slice(3), float("nan"), [[None]], {1, 2}]
MISTAKES = [pytest.param(e, m, id=f"{e.name}-{m.name}") for e in EXERCISES for m in e.mistakes]


def explain(verdict):
    return [
        (r.check.claim, r.outcome, str(r.wrong), r.trouble, r.fault)
        for r in verdict.results
        if r.outcome != "passed"
    ]


def messages(verdict):
    """Return the texts of all exceptions that a function raised."""
    troubles = [q.answer.trouble for r in verdict.results for q in r.questions]
    return [trouble.message for trouble in troubles if trouble is not None]


@pytest.mark.parametrize(("exercise", "function"), SOLUTIONS)
def test_every_right_solution_passes_on_every_seed(exercise, function):
    for seed in seeds(exercise):
        verdict = judge(exercise, ask_here(function), seed)
        assert verdict.outcome == "passed", (seed, explain(verdict))
        assert verdict.points == exercise.points


@pytest.mark.parametrize(("exercise", "mistake"), MISTAKES)
def test_every_mistake_fails_and_is_named_on_every_seed(exercise, mistake):
    for seed in seeds(exercise):
        verdict = judge(exercise, ask_here(mistake.function), seed)
        assert verdict.outcome in ("failed", "error", "timeout"), (seed, verdict.outcome, explain(verdict))
        assert [m.name for m in verdict.mistakes] == [mistake.name], (seed, explain(verdict))
        assert not any("keyword argument" in said for said in messages(verdict)), (seed, explain(verdict))
        assert verdict.points < exercise.points


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda e: e.name)
def test_a_stub_is_not_attempted(exercise):
    def stub(*arguments, **options):
        raise NotImplementedError

    stub.__name__ = exercise.name
    stub.__code__ = stub.__code__.replace(co_name=exercise.name)
    verdict = judge(exercise, ask_here(stub), 0)
    assert (verdict.outcome, verdict.points) == ("not attempted", 0)


@pytest.mark.parametrize("junk", JUNK)
@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda e: e.name)
def test_no_answer_makes_a_check_fail_on_our_side(exercise, junk):
    verdict = judge(exercise, ask_here(lambda *arguments, **options: junk), 0)
    faults = [r.fault for r in verdict.results if r.outcome == "grader fault"]
    assert not faults, faults[0]
    assert verdict.points < exercise.points


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda e: e.name)
def test_an_exercise_is_declared_in_full(exercise):
    assert exercise.checks
    assert exercise.points > 0
    assert len(exercise.hints) >= 2
    assert len(exercise.mistakes) >= 3
    assert len(exercise.variants) >= 2
    assert exercise.summary.endswith(".")
    assert exercise.notes
    for mistake in exercise.mistakes:
        assert mistake.hint
        assert not mistake.name.endswith(".")


@pytest.mark.parametrize("exercise", [e for e in EXERCISES if options(e)], ids=lambda e: e.name)
def test_every_option_is_asked_by_a_check(exercise):
    verdict = judge(exercise, ask_here(exercise.reference), 0)
    asked = set()
    for question in (q for r in verdict.results for q in r.questions):
        given = exercise.signature.bind(*question.arguments, **question.options).arguments
        asked |= {name for name, value in options(exercise).items() if given.get(name, value) is not value}
    assert asked == set(options(exercise))


def test_another_seed_gives_other_inputs_and_the_same_seed_the_same():
    def inputs(exercise, seed):
        asked = []

        def ask(arguments, options, limit):
            # A sparse matrix prints no numbers.
            shown = [a.toarray() if hasattr(a, "toarray") else getattr(a, "vertices", a) for a in arguments]
            asked.append(repr((shown, options)))
            return ask_here(exercise.reference)(arguments, options, limit)

        judge(exercise, ask, seed)
        return asked

    changing = [e for e in EXERCISES if e.signature.parameters]
    for exercise in changing:
        assert inputs(exercise, 1) == inputs(exercise, 1)
        assert inputs(exercise, 1) != inputs(exercise, 2), exercise.name


def test_names_are_unique_and_found():
    assert len(by_name()) == len(EXERCISES)
    for exercise in EXERCISES:
        assert find(exercise.name) is exercise
