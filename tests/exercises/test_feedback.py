"""Feedback says what happened, on which input, in words that are safe to show."""

import ast
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from gpcourse.exercises import expect
from gpcourse.exercises.course import CHAPTERS, find
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.feedback import as_html, as_text, content
from gpcourse.exercises.feedback.content import MARKS
from gpcourse.exercises.feedback.words import clean, written_call
from gpcourse.exercises.judging import CheckResult, Verdict, ask_here, judge
from gpcourse.geometry import shapes
from gpcourse.reference.halfedge import halfedge_mesh
from gpcourse.sandbox.call import Trouble
from gpcourse.sandbox.values import same
from gpcourse.view.scene import Panel, Points, Scene


def total(values):
    """Return the sum of some numbers."""
    return float(np.sum(values))


#: The tags and attributes that the panel may use: all of them pass JupyterLab's sanitizer.
TAGS = {"div", "span", "strong", "code", "br", "table", "tr", "td", "details", "summary", "pre", "img"}
ATTRIBUTES = {"style", "alt", "src"}
STYLE = re.compile(r"[\w\s;:.,()%#-]*")


@pytest.fixture
def exercise():
    made = Exercise(total, notes="none", hints=["Add them up."], time_limit=0.2)
    made.drawn = []

    def picture():
        made.drawn.append(True)
        return Scene((Panel((Points(np.zeros((1, 3))),)),), alt="a dot")

    @made.check("three numbers")
    def _(f, rng):
        values = rng.integers(1, 9, 3).tolist()
        value = expect.number(f(values), on="three numbers")
        expect.that(
            value == sum(values),
            "The sum is wrong.",
            yours=f"{value:g}",
            truth=str(sum(values)),
            picture=picture,
        )

    @made.check("a thousand numbers", points=2)
    def _(f, rng):
        values = rng.normal(size=1000)
        expect.close(expect.number(f(values)), values.sum(), 1e-9, "The sum")

    @made.mistake("the mean was taken", hint="By what did you divide?")
    def _(values):
        return float(np.mean(values))

    return made


class Parsed(HTMLParser):
    def __init__(self, html):
        super().__init__()
        self.tags, self.attributes, self.texts = [], [], []
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs

    def handle_data(self, data):
        self.texts.append(data)

    @property
    def text(self):
        return " ".join("".join(self.texts).split())


def survives_the_sanitizer(html):
    parsed = Parsed(html)
    names = {name for name, _ in parsed.attributes}
    styles = [value for name, value in parsed.attributes if name == "style"]
    sources = [value for name, value in parsed.attributes if name == "src"]
    assert set(parsed.tags) <= TAGS
    assert names <= ATTRIBUTES
    assert all(STYLE.fullmatch(style) and "url" not in style for style in styles)
    assert all(source.startswith("data:image/webp;base64,") for source in sources)
    return True


def said(exercise, function, **options):
    """The text and the words of the HTML for a function, both looked over for what always holds."""
    verdict = judge(exercise, ask_here(function), 0)
    text, html = as_text(verdict), as_html(verdict, **options)
    assert max(map(len, text.splitlines())) <= 100
    assert survives_the_sanitizer(html)
    return " ".join(text.split()), Parsed(html).text


def test_a_right_answer_is_called_right(exercise):
    for words in said(exercise, total):
        assert "Right: all 2 checks pass." in words
        assert "3 of 3 points" in words
        assert "First problem" not in words


def test_a_wrong_answer_is_explained_and_its_mistake_named(exercise):
    for words in said(exercise, lambda values: sum(values) / len(values)):
        assert "0 of 3 points" in words
        assert "The sum is wrong." in words
        assert "It looks as if the mean was taken." in words
        assert "By what did you divide?" in words
        assert re.search(r"yours \d.* true \d+ ", words)


def test_no_mistake_is_named_when_none_fits(exercise):
    for words in said(exercise, lambda values: -1):
        assert "It looks as if" not in words


def test_the_call_can_be_run_again(exercise):
    verdict = judge(exercise, ask_here(lambda values: sum(values) / len(values)), 0)
    facts = dict(content(verdict).problem.facts)
    assert f"{eval(facts['call'], {'total': total}):g}" == facts["true"]


def test_large_arguments_are_described_and_can_be_had(exercise):
    def only_short(values):
        return total(values) if len(values) < 10 else 0.0

    text, _ = said(exercise, only_short)
    assert "total(values) where values: an array of shape (1000,), float64" in text
    html = as_html(judge(exercise, ask_here(only_short), 0), rerun=True)
    assert "total(*check(total).arguments)" in Parsed(html).text


def test_options_are_written_and_can_be_asked_again():
    def power(values, *, exponent=1, weights=None):
        """Sum powers."""
        return float((np.asarray(values) ** exponent).sum())

    made = Exercise(power, notes="none", hints=[])

    @made.check("squares")
    def _(f, rng):
        weights = rng.normal(size=100)
        expect.close(expect.number(f([1.0, 2.0], exponent=2, weights=weights)), 5.0, 0.0, "The sum")

    verdict = judge(made, ask_here(lambda values, *, exponent=1, weights=None: 3.0), 0)
    problem = content(verdict).problem
    assert dict(problem.facts)["call"] == "power([1.0, 2.0], exponent=2, weights=weights)"
    assert problem.legend == ("weights: an array of shape (100,), float64",)
    assert problem.again == "panel = check(power); power(*panel.arguments, **panel.options)"
    assert "**panel.options" in Parsed(as_html(verdict, rerun=True)).text
    for words in said(made, lambda values, weights=None: 5.0):
        assert "an option that it does not take" in words


def test_an_exception_is_quoted_with_the_students_line_and_a_word_of_advice(exercise):
    def total(values):
        return list(values)[9]

    for words in said(exercise, total):
        assert "Your code stopped with IndexError: list index out of range" in words
        assert re.search(r"line \d+ of test_feedback.py, in `?total`? ?: return list\(values\)\[9\]", words)
        assert "An index points past the end." in words


def test_an_endless_loop_is_called_one_and_shown(exercise):
    def total(values):
        while True:
            values = list(values)

    for words in said(exercise, total):
        assert "did not come to an end within 0.2 s" in words
        assert re.search(r"line \d+ of test_feedback.py", words)


def test_a_stub_is_not_attempted_and_shows_no_checks(exercise):
    def total(values):
        raise NotImplementedError

    for words in said(exercise, total):
        assert "Not attempted yet" in words
        assert "three numbers" not in words


def test_the_stub_of_another_exercise_is_named():
    def euler_characteristic(mesh):
        raise NotImplementedError

    def genus(mesh):
        return euler_characteristic(mesh)

    for words in said(find("genus"), genus):
        assert re.search("`?genus`? calls `?euler_characteristic`?, which is still a stub", words)


def test_a_change_in_place_is_noted_though_all_is_right(exercise):
    def sorting(values):
        values.sort()
        return total(values)

    for words in said(exercise, sorting):
        assert "3 of 3 points" in words
        assert re.search("changes its input in place: `?values`?", words)


def test_a_fault_of_ours_is_called_ours():
    made = Exercise(total, notes="none", hints=[])

    @made.check("breaks")
    def _(f, rng):
        f([1])
        raise RuntimeError("<b>our own</b>")

    for words in said(made, total):
        assert "our fault, no point is lost" in words
        assert "RuntimeError: <b>our own</b>" in words
        assert "0/1" not in words


@pytest.mark.parametrize("outcome", ["crashed", "out of memory", "timeout", "error"])
def test_every_outcome_has_words_also_without_details(exercise, outcome):
    result = CheckResult(exercise.checks[0], outcome, trouble=Trouble(("Odd",), ""))
    for verdict in (Verdict(exercise, outcome, (result,)), Verdict(exercise, outcome)):
        assert survives_the_sanitizer(as_html(verdict))
        assert len(as_text(verdict)) > 20


def test_every_outcome_has_a_mark_and_a_word():
    assert all(mark and word for mark, word in MARKS.values())


HOSTILE = "<script>alert(1)</script>\x1b[31mred\x1b[0m\u202eleft\x00" + "x" * 5000


def test_what_a_student_wrote_is_escaped_clipped_and_without_codes(exercise):
    def total(values):
        raise ValueError(HOSTILE)

    verdict = judge(exercise, ask_here(total), 0)
    for words in (as_text(verdict), as_html(verdict)):
        assert len(words) < 9000
        assert not {"\x1b", "\x00", "\u202e"} & set(words)
    assert "<script" not in as_html(verdict)
    assert survives_the_sanitizer(as_html(verdict))
    assert "redleft" in as_text(verdict)


def test_a_value_that_pretends_to_be_html_is_shown_as_it_is(exercise):
    _, words = said(exercise, lambda values: "<img src=x onerror=alert(1)>")
    assert "<img src=x onerror=alert(1)>" in words


def test_long_texts_are_clipped_and_short_ones_kept():
    assert len(clean("x" * 5000, 100)) == 100
    assert clean("x" * 5000, 100).endswith(" …")
    assert clean("x" * 100, 100) == "x" * 100


def test_a_lone_surrogate_does_no_harm():
    clean("\ud800 and more").encode("utf-8")


def test_a_page_that_is_handed_out_does_not_say_what_is_true(exercise):
    verdict = judge(exercise, ask_here(lambda values: -1.5), 0)
    truth = verdict.results[0].wrong.truth
    kept = dict(content(verdict, answers=False).problem.facts)
    assert dict(content(verdict).problem.facts)["true"] == truth
    assert kept["yours"] == "-1.5"
    assert "true" not in kept
    words = Parsed(as_html(verdict, answers=False, picture=False)).text
    assert "yours" in words
    assert not re.search(r"\btrue\b", words)


def test_a_page_that_is_handed_out_shows_the_picture_made_for_it():
    wrong = expect.Wrong("no", picture=lambda: 1, handout=lambda: 2)
    assert wrong.handout() == 2
    assert expect.Wrong("no", picture=lambda: 1).handout() == 1


def test_the_picture_is_drawn_when_somebody_looks(exercise):
    verdict = judge(exercise, ask_here(lambda values: -1), 0)
    as_text(verdict)
    as_html(verdict, picture=False)
    assert not exercise.drawn
    html = as_html(verdict)
    assert exercise.drawn
    assert 'alt="a dot"' in html


def test_a_picture_that_cannot_be_drawn_costs_the_picture_only():
    made = Exercise(total, notes="none", hints=[])

    @made.check("always wrong")
    def _(f, rng):
        raise expect.Wrong("The sum is wrong.", picture=lambda: 1 / 0)

    _, words = said(made, total)
    assert "The sum is wrong." in words


def test_calls_are_written_as_python_that_gives_the_same_arguments():
    arguments = ([[0, 1, 2]], np.arange(6).reshape(2, 3), np.int64(3), "a\n'b'", None, 0.1, (1, [2.0]), True)
    call, legend = written_call("f", [], arguments)
    back = eval(call, {"f": lambda *given: given, "np": np})
    assert legend == []
    assert same(arguments, back)


def test_what_has_no_expression_goes_by_its_name():
    mesh = halfedge_mesh(*shapes.cube())
    call, legend = written_call("flip_edge", ["mesh", "h"], (mesh, 3))
    assert call == "flip_edge(mesh, 3)"
    assert legend == ["mesh: a HalfedgeMesh of 8 vertices, 6 faces, 24 half-edges, 0 of them along holes"]
    call, legend = written_call("f", ["x", "y"], ([object()], np.array([np.nan])))
    assert call == "f(x, y)"
    assert len(legend) == 2
    ast.parse(call)


@pytest.mark.parametrize("name", [e.name for chapter in CHAPTERS for e in chapter.exercises])
def test_a_mistake_of_every_exercise_makes_a_good_panel(name):
    exercise = find(name)
    text, html = said(exercise, exercise.mistakes[0].function)
    for words in (text, html.replace("`", "")):
        assert exercise.mistakes[0].name.replace("`", "") in words.replace("`", "")
