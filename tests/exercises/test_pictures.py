"""What feedback shows of values: the numbers are true, the pictures small, what is handed out does not tell.

Two mistakes of every exercise are tried; `GPCOURSE_ALL_MISTAKES=1` tries all, and draws every picture.
"""

import os
import re
import time

import numpy as np
import pytest

from gpcourse.exercises import expect, pictures
from gpcourse.exercises.course import CHAPTERS
from gpcourse.exercises.feedback import as_html, as_text, content, panel
from gpcourse.exercises.judging import CheckResult, Verdict, _alike, ask_here, judge
from gpcourse.geometry import shapes
from gpcourse.sandbox.call import call
from gpcourse.view.picture import Picture
from gpcourse.view.scene import Panel, Points, Scene

ALL = bool(os.environ.get("GPCOURSE_ALL_MISTAKES"))
EXERCISES = [exercise for chapter in CHAPTERS for exercise in chapter.exercises]
MISTAKES = [
    pytest.param(e, m, id=f"{e.name}-{m.name}") for e in EXERCISES for m in e.mistakes[: None if ALL else 2]
]

#: Exercises whose answers are numbers, texts, indices without points, or values per mode.
NO_PLACE = {
    *("triangle_area", "read_off", "write_off", "euler_characteristic", "genus", "element_statistics"),
    *("trim_pairs", "reject_boundary_pairs", "random_sampling", "normal_space_sampling", "stable_step"),
    *("discrete_principal_curvatures", "dirichlet_energy", "membrane_energy", "thin_plate_energy"),
    "spectral_coefficients",
}

#: Checks that compare the answers to several questions; none of them is wrong by itself.
ABOUT_SEVERAL = {
    "every index is equally likely, whichever others are chosen",
    "the same seed gives the same sample, another seed another",
}

NUMBER = r"−?[\d.]+(?:e[+−]\d+)?"
SENTENCE = re.compile(
    rf"worst at (?:(?P<item>[a-z]+) (?P<row>\d+)|index \[(?P<index>[\d, ]+)\]): "
    rf"yours (?P<mine>\([^)]*\)|{NUMBER}), expected (?P<true>\([^)]*\)|{NUMBER}); "
    r"(?P<many>[\d,]+) of (?P<all>[\d,]+) differs?\.$"
)


@pytest.fixture
def compared(monkeypatch):
    """What each `Wrong` of `expect.close` compared: {id of the Wrong: (value, truth, tolerance)}."""
    close, seen = expect.close, {}

    def watched(value, truth, tolerance, what, **details):
        try:
            close(value, truth, tolerance, what, **details)
        except expect.Wrong as wrong:
            arrays = (np.array(x) for x in np.broadcast_arrays(value, truth))
            seen[id(wrong)] = (*arrays, tolerance)
            raise

    monkeypatch.setattr(expect, "close", watched)
    return seen


def wrongs(exercise, mistake):
    """The failures of a mistake, the verdict of each on its own, and the question that went wrong."""
    for result in judge(exercise, ask_here(mistake.function), 0).results:
        if result.wrong is not None:
            yield result.wrong, Verdict(exercise, "failed", (result,)), result.question


def as_numbers(text):
    return [float(x.replace("−", "-")) for x in re.findall(NUMBER, text)]


@pytest.mark.parametrize(("exercise", "mistake"), MISTAKES)
def test_the_sentence_is_true_and_what_is_handed_out_does_not_tell(exercise, mistake, compared):
    for wrong, verdict, question in wrongs(exercise, mistake):
        if id(wrong) in compared:
            is_true(wrong, *compared[id(wrong)])
        truth = call(exercise.reference, question.arguments, 9.0, options=question.options, ours=True)
        if verdict.results[0].check.claim not in ABOUT_SEVERAL:
            assert not _alike(
                exercise, question.arguments, question.answer, truth
            )  # it is the call that is shown
        says_no_truth(wrong, verdict, question, truth)
        if id(wrong) in compared and wrong.picture is not None:
            shows_no_truth(wrong.handout(), *compared[id(wrong)][:2], question.arguments)
        if ALL:
            is_small(wrong)


def is_true(wrong, have, want, tolerance):
    """Recount, number by number, what the sentence says."""
    if have.ndim == 0:
        return
    said = SENTENCE.search(wrong.told)
    assert said, wrong.told
    rows = [(np.atleast_1d(a), np.atleast_1d(b)) for a, b in zip(have, want, strict=True)]
    if said["index"]:
        rows = [(np.array([a]), np.array([b])) for a, b in zip(have.ravel(), want.ravel(), strict=True)]
    off = [float(np.sqrt(((a - b) ** 2).sum())) for a, b in rows]
    differ = sum(any(not abs(x - y) <= tolerance for x, y in zip(a, b, strict=True)) for a, b in rows)
    where = (
        int(np.ravel_multi_index(eval(f"({said['index']},)"), have.shape))
        if said["index"]
        else int(said["row"])
    )
    assert off[where] == pytest.approx(max(off), rel=1e-9)
    rounding = 1e-13 * np.abs(rows[where]).max()  # of it zero is said
    assert as_numbers(said["mine"]) == pytest.approx(rows[where][0], rel=6e-4, abs=rounding)
    assert as_numbers(said["true"]) == pytest.approx(rows[where][1], rel=6e-4, abs=rounding)
    assert said["mine"] != said["true"]
    assert (said["many"], said["all"]) == (f"{differ:,}", f"{len(rows):,}")


def says_no_truth(wrong, verdict, question, truth):
    said = content(verdict, answers=False).problem
    assert "expected" not in said.message
    assert "true" not in dict(said.facts)
    # Numbers of a right answer that are neither the student's nor in the question.
    claim = verdict.results[0].check.claim
    answer = question.answer.value
    given = (
        answer,
        *question.arguments,
        claim,
        wrong.yours,
        wrong.on,
        len(answer) if hasattr(answer, "__len__") else "",
    )
    known = set(re.findall(r"\d+", " ".join(map(written, given))))
    secret = set(re.findall(r"\d+", written(short(truth.value)))) - known
    assert not secret & set(re.findall(r"\d+", said.message)), said.message
    # What the notebook tells besides is in no part of the text.
    told = set(re.findall(NUMBER, f"{wrong.told} {wrong.truth}"))
    handed = re.findall(NUMBER, f"{wrong.message} {wrong.yours} {wrong.on} {claim}")
    rare = {number for number in told - set(handed) if len(number.strip("−0.")) > 3}
    assert not rare & set(re.findall(NUMBER, as_text(verdict, answers=False)))


def written(value):
    return str(value.tolist()) if isinstance(value, np.ndarray) else str(value)


def short(value):
    """The right answer where it is a number or a short list, else nothing."""
    return value if isinstance(value, (int, float)) or (isinstance(value, list) and len(value) < 9) else ""


def shows_no_truth(scene, have, want, arguments):
    assert not any("expected" in part.title for part in scene.panels)
    if have.ndim == 0 or np.isin(want, (0, 1)).all():
        return  # a property that is stated, or marks
    error = have - want
    secrets = [want, error, np.abs(error), *(np.linalg.norm(x, axis=1) for x in (want, error) if x.ndim > 1)]
    given = [have, np.abs(have), *(x for x in arguments if isinstance(x, np.ndarray))]
    given += [np.linalg.norm(have, axis=1)] if have.ndim > 1 else []
    secrets = [s for s in secrets if not np.isin(s, (-1, 0, 1)).all() and not any(alike(s, x) for x in given)]
    for layer in (layer for part in scene.panels for layer in part.layers):
        arrays = [getattr(layer, name, None) for name in ("values", "vertices", "positions")]
        for array in (x for x in arrays if x is not None and x.size > 3):
            assert not any(alike(array, secret) for secret in secrets)


def alike(a, b):
    return a.shape == b.shape and np.allclose(a, b, rtol=1e-4, atol=0)


def is_small(wrong):
    for draw in (wrong.picture, wrong.handout):
        if draw is not None:
            start = time.process_time()
            image = panel.drawn(draw)
            assert time.process_time() - start < 1.0
            assert 0 < len(image) < 200_000


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda e: e.name)
def test_values_on_a_place_come_with_a_picture(exercise):
    drawn = (wrong.picture is not None for m in exercise.mistakes for wrong, *_ in wrongs(exercise, m))
    assert any(drawn) == (exercise.name not in NO_PLACE)


def test_noise_on_a_sphere_makes_a_small_picture():
    ball = shapes.icosphere(3)
    rng = np.random.default_rng(0)
    yours, truth = rng.normal(size=(2, len(ball.vertices)))
    shown = pictures.Field(ball.vertices, ball.faces, "H")
    start = time.process_time()
    image = panel.drawn(lambda: shown.scene(yours, truth, (0,), True))
    assert len(image) < 200_000
    assert time.process_time() - start < 1.5  # the first time, matplotlib is imported
    assert Picture(shown.scene(yours, truth, (0,), True)).scene.panels[2].title.endswith("vertex 0")


def test_a_page_has_the_picture_that_is_made_for_it():
    result = CheckResult(
        EXERCISES[0].checks[0], "failed", wrong=expect.Wrong("no", picture=dot("mine"), handout=dot("theirs"))
    )
    verdict = Verdict(EXERCISES[0], "failed", (result,))
    assert 'alt="mine"' in as_html(verdict)
    assert 'alt="theirs"' in as_html(verdict, answers=False)


def dot(alt):
    return lambda: Scene((Panel((Points(np.zeros((1, 3))),)),), alt=alt)
