"""Tables and pages: true to the verdicts, and harmless whatever a student is called or writes."""

import csv
import io
import json
import re
import zlib
from dataclasses import replace
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy as np
import pytest

from gpcourse.exercises import expect, feedback
from gpcourse.exercises.course import Chapter
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.judging import Verdict, ask_here, judge
from gpcourse.grading import gradebook, reports
from gpcourse.grading.judge import Judged, Report
from gpcourse.grading.junit import junit


def twice(x):
    """Return x times two."""
    return 2 * x


@pytest.fixture(scope="module")
def exercise():
    made = Exercise(twice, notes="ch. 0", hints=["Look again."])

    @made.check("zero stays zero")
    def _(f, rng):
        expect.close(expect.number(f(0)), 0.0, 0.0, "Twice 0")

    @made.check("three becomes six", points=2)
    def _(f, rng):
        expect.close(expect.number(f(3)), 6.0, 0.0, "Twice 3")

    @made.mistake("it was squared", hint="What is two times three?")
    def _(x):
        return x**2

    return made


def report(exercise, function, student="ada", **fields):
    verdict = judge(exercise, ask_here(function), 0)
    return Report(student, fields.pop("status", "graded"), (Judged(verdict),), **fields)


CHAPTERS = (Chapter(0, "welcome", "Welcome"),)
NASTY = [
    "=1+1",
    " =1+1",
    "+1",
    "-1",
    "@x",
    'a,"b"',
    "<script>alert(1)</script>",
    "two\nlines",
    "😀",
    "\t=1",
    "x\x1b[31m",
    "＝1+1",
    "x; =1+1",
]


class Tags(HTMLParser):
    """The names of all tags, and the text of the page."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.words, self.attributes = [], [], []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [name for name, _ in attrs]

    def handle_data(self, data):
        self.words.append(data)


def test_a_row_has_the_points_the_total_and_the_status(exercise):
    rows = list(
        csv.DictReader(io.StringIO(gradebook.grades_csv([report(exercise, lambda x: x**2)], [exercise])))
    )
    assert rows[0]["twice"] == rows[0]["total"] == "1"
    assert (rows[0]["out of"], rows[0]["status"], rows[0]["note"]) == ("3", "graded", "")


@pytest.mark.parametrize("name", NASTY)
def test_no_cell_is_a_formula_and_no_row_breaks(exercise, name):
    text = gradebook.grades_csv([report(exercise, twice, name, notes=(name,))], [exercise])
    rows = list(csv.reader(io.StringIO(text)))
    assert len(text.splitlines()) == len(rows) == 2
    cells = [part for cell in rows[1] for part in cell.split(";")]  # where that parts cells
    assert not any(cell.strip().startswith(tuple("=+-@＝＋－＠")) for cell in cells)


def test_a_crash_or_an_error_is_in_the_note(exercise):
    assert gradebook.note(report(exercise, lambda x: 1 / 0)) == "twice: error"


def test_missing_functions_come_last_in_the_note(exercise):
    broken = Judged(judge(exercise, ask_here(lambda x: 1 / 0), 0))
    absent = Judged(judge(exercise, ask_here(lambda x: 1 / 0), 0), missing=True)
    text = gradebook.note(Report("ada", "graded", (absent, broken)))
    assert text.endswith("; no function twice")


def test_gradescope_gets_a_test_for_each_exercise(exercise):
    content = json.loads(gradebook.gradescope(report(exercise, lambda x: x**2)))
    assert content["score"] == sum(test["score"] for test in content["tests"]) == 1
    test = content["tests"][0]
    assert (test["name"], test["max_score"], test["status"]) == ("twice", 3, "failed")
    assert "it was squared" in test["output"]


def test_file_names_are_plain_and_differ():
    students = ["ada", "Ada", "a da", "a/da", "../ada", "", "x" * 300, "李" * 300, "\ud800", "con", *NASTY]
    names = gradebook.file_names(students)
    assert names["ada"] == "ada"
    assert all(re.fullmatch(r"[\w-]+", name) for name in names.values())
    assert all(len(name.encode()) < 200 for name in names.values())
    assert len({name.casefold() for name in names.values()}) == len(names) == len(students)
    assert names["con"] != "con"


def test_file_names_keep_the_letters_of_every_script():
    students = ["李明", "王芳", "Žofie", "محمد", "अनु"]
    names = gradebook.file_names(students)
    assert [names[s] for s in students[:4]] == students[:4]
    assert len(set(names.values())) == len(students)


def test_names_made_to_have_one_checksum_get_two_files():
    pair = ["eve!;=@=@", "eve$#.,&."]
    assert len({zlib.crc32(name.encode()) for name in pair}) == 1
    assert len(set(gradebook.file_names(pair).values())) == 2


def test_the_class_page_counts_named_mistakes(exercise):
    students = {"ada": twice, "bo": lambda x: x**2, "cy": lambda x: x * x}
    all_reports = [report(exercise, f, name) for name, f in students.items()]
    page = reports.class_page(all_reports, CHAPTERS, [exercise], 7, {name: name for name in students})
    table = page[page.index("<h2>Named mistakes") : page.index("<h2>Students")]
    row = table[table.rindex("<tr>", 0, table.index("it was squared")) :]
    assert '<td class="many count num">2</td>' in row
    assert "students/bo.html" in row
    assert "students/cy.html" in row
    assert "seed <b>7</b>" in page


def test_a_student_page_quotes_the_feedback(exercise):
    words = " ".join(Tags(reports.student_page(report(exercise, lambda x: x**2), CHAPTERS)).words)
    for text in ("zero stays zero", "three becomes six", "it was squared", "What is two times three?"):
        assert text in words


@pytest.mark.parametrize("name", NASTY)
def test_what_a_student_writes_is_text_on_a_page(exercise, name):
    def nasty(x):
        raise RuntimeError("<script>alert(1)</script><img src=x onerror=alert(1)>")

    one = report(exercise, nasty, name, notes=("<b onclick=alert(1)>",))
    for page in (
        reports.student_page(one, CHAPTERS),
        reports.class_page([one], CHAPTERS, [exercise], 0, gradebook.file_names([name])),
    ):
        tags = Tags(page)
        assert not {"script", "img", "iframe", "object"} & set(tags.tags)
        assert not any(attribute.startswith("on") for attribute in tags.attributes)
    assert "<script>alert" in " ".join(Tags(reports.student_page(one, CHAPTERS)).words)


def test_no_path_and_no_fault_of_ours_is_handed_out(exercise):
    message = "[Errno 2] no file '/srv/grade/my class/mesh.off' in /srv/grade/class"

    def asks_for_a_file(x):
        raise FileNotFoundError(message)

    def broken(arguments, options, limit):
        raise RuntimeError("ours, in /srv/grade")

    notes = ("cut off; was read from /srv/grade/ada.ipynb",)
    one = report(exercise, asks_for_a_file, notes=notes)
    ours = Report("ada", "grader fault", (Judged(judge(exercise, broken, 0)),), fault="OSError: /srv/grade")
    names = {"ada": "ada"}
    for each in (one, ours):
        page = reports.student_page(each, CHAPTERS)
        for text in (page, gradebook.gradescope(each), junit([each])):
            assert "/srv" not in text
            assert "Traceback" not in text
        assert "/srv" in reports.class_page([each], CHAPTERS, [exercise], 0, names)
    assert "no file 'mesh.off' in class" in gradebook.gradescope(one)
    assert "Please report it" not in gradebook.gradescope(ours)


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("no such file: '/tmp/My Files/a.off'", "no such file: 'a.off'"),
        ("numpy (/usr/lib/numpy/__init__.py), line 3", "numpy (__init__.py), line 3"),
        (r"C:\Users\ada\f.py, line 3", "f.py, line 3"),
        (
            "see https://a.b/c/d, 1/2, a / b / c, data/a.off",
            "see https://a.b/c/d, 1/2, a / b / c, data/a.off",
        ),
    ],
)
def test_of_a_path_the_name_of_the_file_is_left(text, left):
    assert feedback.without_paths(text) == left


def test_who_needs_a_person_comes_first(exercise):
    near = Judged(Verdict(exercise, "not attempted"), ("is my_twice meant to be twice?",), missing=True)
    everybody = [
        report(exercise, twice),
        report(exercise, twice, "bo", notes=("cell 3: SyntaxError",)),
        Report("cy", "graded", (near,)),
        Report("di", "unreadable", (near,), ("not JSON",)),
        Report("ed", "grader fault", (Judged(Verdict(exercise, "grader fault")),), fault="OSError: 28"),
    ]
    names = {one.student: one.student for one in everybody}
    page = reports.class_page(everybody, CHAPTERS, [exercise], 7, names)
    section = page[page.index('id="person"') : page.index("<h2>Exercises")]
    first, _, others = section.partition("Notes on 1 other")
    assert re.findall(r"students/(\w+)\.html", first) == ["cy", "di", "ed"]
    assert re.findall(r"students/(\w+)\.html", others) == ["bo"]
    assert 'id="person"' not in reports.class_page(everybody[:1], CHAPTERS, [exercise], 7, names)


def test_the_times_are_those_of_the_answers(exercise):
    one = report(exercise, twice)
    timed = Report("=ada", "graded", (replace(one.judged[0], seconds=1.25),))
    rows = list(csv.reader(io.StringIO(gradebook.times_csv([timed], [exercise]))))
    assert rows == [["student", "twice", "total"], ["'=ada", "1.250", "1.250"]]


def test_pages_load_nothing_from_elsewhere(exercise):
    page = reports.student_page(report(exercise, np.sqrt), CHAPTERS)
    assert "http://" not in page
    assert "https://" not in page


def test_a_file_is_written_as_a_whole(tmp_path, monkeypatch):
    path = tmp_path / "new" / "grades.csv"
    gradebook.write(path, "old\n")
    with pytest.raises(UnicodeEncodeError):
        gradebook.write(path, "half" * 10_000 + "\ud800")
    assert path.read_bytes() == b"old\n"
    assert [p.name for p in path.parent.iterdir()] == ["grades.csv"]


def test_junit_tells_wrong_from_our_fault_and_from_nothing(exercise):
    def report(student, *verdicts):
        return Report(student, "graded", tuple(Judged(verdict) for verdict in verdicts))

    def broken(arguments, limit):
        raise RuntimeError("ours \x00")

    xml = junit(
        [
            report("right", judge(exercise, ask_here(twice), 0)),
            report("<wrong> \x1b & \ud800", judge(exercise, ask_here(lambda x: x**2), 0)),
            report("ours", judge(exercise, broken, 0)),
            report("none", Verdict(exercise, "not attempted")),
        ]
    )
    root = ElementTree.fromstring(xml)
    seen = {
        suite.get("name"): [case[0].tag if len(case) else "passed" for case in suite]
        for suite in root.findall("testsuite")
    }
    assert seen == {
        "right": ["passed", "passed"],
        "<wrong> \ufffd & \ufffd": ["passed", "failure"],
        "ours": ["error", "error"],
        "none": ["skipped", "skipped"],
    }
    assert (root.get("tests"), root.get("failures"), root.get("errors"), root.get("skipped")) == (
        "8", "1", "2", "2",
    )  # fmt: skip
    assert [case.get("name") for case in root[0]] == ["zero stays zero", "three becomes six"]
    failure = root.find(".//failure")
    assert "Twice 3" in failure.get("message")
    assert "true " not in failure.text
