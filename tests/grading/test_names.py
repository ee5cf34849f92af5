"""Whatever a student is called, every file that is written holds the name as text and nothing else."""

import csv
import io
import json
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest

from gpcourse.exercises.course import CHAPTERS
from gpcourse.exercises.judging import Verdict
from gpcourse.grading import exports, gradebook, reports
from gpcourse.grading.judge import Judged, Report
from gpcourse.grading.junit import junit
from gpcourse.grading.naming import Owner
from gpcourse.grading.roster import read_roster

CHAPTER = CHAPTERS[0]
NAMES = {
    "formula": "=cmd|' /C calc'!A0",
    "formula after a blank": "\t=HYPERLINK(1)",
    "sign": "@SUM(1)",
    "path": "../../etc/passwd",
    "windows path": "..\\x",
    "drive": "C:con",
    "script": "<script>alert(1)</script>",
    "attribute": '" onload="alert(1)',
    "long": "x" * 5000,
    "right to left": "\u202eadA\u202c محمد",
    "newline": "ada\r\n=1+1",
    "separators": "a;b,c\td",
    "quotes": "\"a\" 'b'",
    "ansi": "\x1b[31mred",
    "nul": "a\0b",
    "half a surrogate": "a\ud800",
    "template": "{{ 7*7 }}{% raw %}",
}


class Page(HTMLParser):
    """What a browser would make of a page: its tags, and the handlers of events."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.handlers = [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.handlers += [name for name, _ in attrs if name.startswith("on")]


@pytest.fixture(params=NAMES.values(), ids=NAMES.keys())
def name(request):
    return request.param


def report(name):
    judged = tuple(Judged(Verdict(exercise, "not attempted")) for exercise in CHAPTER.exercises)
    return Report(name, "graded", judged, notes=(name,))


def same_page(one, other):
    """Two pages with the same tags and no handler of events differ in text only."""
    one, other = Page(one), Page(other)
    assert one.tags == other.tags
    assert one.handlers == other.handlers == []


def harmless(text, rows):
    """A table of so many rows, none with a formula or a control character, also without the quotes."""
    table = list(csv.reader(io.StringIO(text, newline="")))
    assert len(table) == rows == len(text.splitlines())
    assert len({len(row) for row in table}) == 1
    cells = [cell for row in table for cell in row]
    assert not any(cell.lstrip().startswith(("=", "+", "-", "@")) for cell in cells)
    assert all(char.isprintable() for cell in cells for char in cell)
    text.encode()


def test_tables_hold_no_formula_and_no_row_breaks(name):
    harmless(gradebook.grades_csv([report(name)], CHAPTER.exercises), 2)
    harmless(gradebook.times_csv([report(name)], CHAPTER.exercises), 2)


def test_pages_hold_the_name_as_text(name):
    files = {"ada": "ada", name: gradebook.file_names([name])[name]}
    pages = [reports.class_page([report(n)], [CHAPTER], CHAPTER.exercises, 1, files) for n in files]
    same_page(*pages)
    same_page(*(reports.student_page(report(n), [CHAPTER]) for n in files))


def test_gradescope_and_junit_can_be_read_back(name):
    assert json.loads(gradebook.gradescope(report(name)).encode("utf-8", "replace"))["score"] == 0
    suites = ElementTree.fromstring(junit([report(name)]).encode())
    assert [suite.tag for suite in suites] == ["testsuite"]


def test_files_are_written_in_the_folder_and_nowhere_else(name, tmp_path):
    (tmp_path / "out").mkdir()
    stem = gradebook.file_names([name])[name]
    gradebook.write(tmp_path / "out" / f"{stem}.html", "text")
    assert [path.parent for path in tmp_path.rglob("*.html")] == [tmp_path / "out"]


@pytest.mark.parametrize("target", ["canvas", "moodle", "nbgrader"])
def test_exports_hold_no_formula_and_no_row_breaks(name, target):
    owners = {name: Owner(name, "7", target if target != "nbgrader" else "")}
    graded = exports.Graded([report(name)], owners, {}, name, 1)
    made = exports.export(target, graded, None)
    harmless(made.text, 3 if target == "canvas" else 2)


@pytest.mark.parametrize(
    ("target", "header"),
    [
        ("canvas", ["Student", "ID", "Section"]),
        ("moodle", ["Full name", "Identifier", "Grade", "Maximum Grade", "Last modified (grade)"]),
        ("nbgrader", ["first_name", "id"]),
    ],
)
def test_a_roster_with_such_a_name_is_read_and_given_back_harmless(name, target, header, tmp_path):
    written = name.encode("utf-8", "replace").decode().replace("\0", "")
    buffer = io.StringIO()
    csv.writer(buffer).writerows([header, [written, *["7"] * (len(header) - 1)]])
    path = tmp_path / "roster.csv"
    path.write_bytes(buffer.getvalue().encode())
    graded = exports.Graded([report("7")], {"7": Owner("7")}, {}, "Half-edges", 7)
    made = exports.export(target, graded, read_roster(path, target))
    harmless(made.text, 3 if target == "canvas" else 2)
    assert "7: handed in, but is not in the roster" not in made.remarks
