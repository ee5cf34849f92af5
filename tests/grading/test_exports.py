"""Canvas, Moodle and nbgrader get the columns that they take in; nobody gets another's grade."""

import csv
import io
import json

import pytest
from click.testing import CliRunner

from gpcourse.cli import main
from gpcourse.errors import UsageError
from gpcourse.exercises import course
from gpcourse.exercises.judging import Verdict
from gpcourse.grading import exports
from gpcourse.grading.judge import Judged, Report
from gpcourse.grading.naming import Owner
from gpcourse.grading.roster import read_roster

EXERCISE = course.CHAPTERS[0].exercises[0]
CANVAS = (
    "Student,ID,SIS User ID,SIS Login ID,Section,Half-edges (77),Half-edges Final Score\n"
    "    Points Possible,,,,,5,(read only)\n"
    '"Lovelace, Ada",11,s11,ada,A,,\n"Noether, Emmy",12,s12,emmy,A,3,\n'
    '"Zhang, Wei",13,s13,wz1,A,,\n"Zhang, Wei",14,s14,wz2,B,,\n"Student, Test",15,,t,A,,\n'
)
MOODLE = (
    'Identifier,"Full name","Email address",Status,Grade,"Maximum Grade","Grade can be changed",'
    '"Last modified (submission)","Last modified (grade)","Feedback comments"\n'
    'Participant 11,"Ada Lovelace",ada@x.org,Submitted,,1.00,Yes,-,-,- see me\n'
    'Participant 12,"Žofie Nováková",z@x.org,"No submission",0.50,1.00,Yes,-,-,\n'
)


def graded(*names, platform="", status="graded", out_of=1):
    """A class of submissions: a name, or a name and the platform's number."""
    pairs = [name if isinstance(name, tuple) else (name, "") for name in names]
    owners = {
        f"{name} ({number})" if number else name: Owner(name, number, platform if number else "")
        for name, number in pairs
    }
    judged = (Judged(Verdict(EXERCISE, "not attempted")),)
    reports = [Report(student, status, judged) for student in owners]
    return exports.Graded(reports, owners, dict.fromkeys(owners, "2026-01-02 03:04:05"), "Half-edges", out_of)


def table(text):
    return list(csv.reader(io.StringIO(text, newline="")))


@pytest.fixture
def roster(tmp_path):
    def read(target, text, encoding="utf-8"):
        path = tmp_path / "list.csv"
        path.write_bytes(text.encode(encoding))
        return read_roster(path, target)

    return read


@pytest.mark.parametrize(
    "text",
    [
        CANVAS,
        "\ufeff" + CANVAS,
        CANVAS.replace(", ", "\0").replace(",", ";").replace("\0", ", "),
        CANVAS.replace(",", "\t").replace('"Lovelace\t Ada"', "Ada Lovelace").replace("\t ", ", "),
    ],
    ids=["commas", "BOM", "semicolons", "tabs"],
)
def test_canvas_gets_its_own_columns_and_the_assignments_number(roster, text):
    made = exports.export(
        "canvas", graded("ada", ("emmy", "12"), platform="canvas", out_of=8), roster("canvas", text)
    )
    assert made.text.startswith("\ufeff") is text.startswith("\ufeff")
    header, possible, ada, emmy, *_ = table(made.text.removeprefix("\ufeff"))
    assert header == ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", "Half-edges (77)"]
    assert possible == ["    Points Possible", "", "", "", "", "8"]
    assert ada[1:] == ["11", "s11", "ada", "A", "0"]
    assert emmy == ["Noether, Emmy", "12", "s12", "emmy", "A", "0"]


def test_a_name_that_fits_two_is_given_to_neither_and_who_is_missing_is_named(roster):
    names = ("Wei Zhang", "lovelace ADA", "Sofja")
    made = exports.export("canvas", graded(*names), roster("canvas", CANVAS))
    grades = {row[1]: row[5] for row in table(made.text)[2:]}
    assert grades == {"11": "0", "12": "3", "13": "", "14": "", "15": ""}
    words = "\n".join(made.remarks)
    assert (
        "Wei Zhang: fits several rows of the roster, and is in none: Zhang, Wei (13), Zhang, Wei (14)"
        in words
    )
    assert "Sofja: handed in, but is not in the roster" in words
    assert "Noether, Emmy: in the roster, but no submission" in words
    assert "Student, Test" not in words


def test_two_submissions_that_fit_one_row_are_both_left_out(roster):
    made = exports.export("canvas", graded("ada", "Ada Lovelace"), roster("canvas", CANVAS))
    assert {row[1]: row[5] for row in table(made.text)[2:]}["11"] == ""
    assert any("ada, Ada Lovelace: all fit the row of Lovelace, Ada (11)" in r for r in made.remarks)


def test_the_platforms_number_decides_and_a_wrong_one_is_not_mended_by_the_name(roster):
    class_ = graded(("Ada Lovelace", "99"), platform="moodle")
    made = exports.export("moodle", class_, roster("moodle", MOODLE))
    assert [row[4] for row in table(made.text)[1:]] == ["", "0.50"]
    assert "Ada Lovelace (99): handed in, but is not in the roster" in made.remarks


def test_moodle_gets_its_worksheet_with_the_grades_and_all_else_as_it_was(roster):
    class_ = graded(("Ada L.", "11"), platform="moodle")
    made = exports.export("moodle", class_, roster("moodle", MOODLE))
    before, after = table(MOODLE), table(made.text)
    assert after[1][4] == "0"
    after[1][4] = ""
    assert after == before
    assert made.remarks == ("Žofie Nováková: in the roster, but no submission is his or hers",)


def test_a_maximum_that_differs_and_a_locked_grade_are_said(roster):
    text = MOODLE.replace("1.00,Yes", "100.00,No")
    words = " ".join(exports.export("moodle", graded("ada@x.org"), roster("moodle", text)).remarks)
    assert "Maximum Grade is 100.00, but 1 points" in words
    assert "Ada Lovelace: the worksheet says that the grade cannot be changed" in words


def test_without_a_roster_moodle_gets_those_whose_number_is_known():
    made = exports.export("moodle", graded(("Ada", "11"), "bob", platform="moodle"), None)
    assert table(made.text)[0] == table(MOODLE)[0]
    assert table(made.text)[1:] == [["Participant 11", "Ada", "", "", "0", "1", "", "", "", ""]]
    assert made.remarks == ("bob: Moodle's number is not known; give the worksheet with --roster",)


def test_nbgrader_gets_the_columns_of_its_own_export(roster):
    text = "id,first_name,last_name,email\nada,Ada,Lovelace,a@x\nbob,,,\n"
    made = exports.export("nbgrader", graded("ada"), roster("nbgrader", text))
    header, ada, bob = table(made.text)
    assert ",".join(header) == (
        "assignment,duedate,timestamp,student_id,last_name,first_name,email,raw_score,"
        "late_submission_penalty,score,max_score"
    )
    assert ada == [
        "Half-edges",
        "",
        "2026-01-02 03:04:05",
        "ada",
        "Lovelace",
        "Ada",
        "a@x",
        "0.0",
        "0.0",
        "0.0",
        "1.0",
    ]
    assert bob[2:4] == ["", "bob"]
    assert bob[7:] == ["0.0", "0.0", "0.0", "1.0"]


@pytest.mark.parametrize("target", ["canvas", "moodle", "nbgrader"])
@pytest.mark.parametrize("status", ["unreadable", "grader fault"])
def test_who_needs_a_person_gets_no_grade_but_is_named(target, status):
    made = exports.export(target, graded(("ada", "11"), platform=target, status=status), None)
    assert not any(cell in ("0", "0.0") for row in table(made.text)[1:] for cell in row[4:8])
    assert any(f"{status}; a person has to look" in remark for remark in made.remarks)


@pytest.mark.parametrize(
    ("target", "text", "words"),
    [
        ("canvas", "Student,Section\nada,A\n", "no column 'ID'; in Canvas, open Grades, choose Export"),
        ("canvas", "ID,Section\n1,A\n", "no column 'Student'"),
        ("moodle", CANVAS, "no column 'Identifier', 'Grade', 'Maximum Grade'"),
        ("moodle", MOODLE.replace("Grade,", "Bewertung,", 1), "'Grade'; in Moodle, set your language"),
        ("nbgrader", "name\nada\n", "no column 'id'"),
        ("nbgrader", "id,student_id\na,b\n", "the column 'id' more than once"),
        ("canvas", "", "no column 'Student', 'ID', 'Section'"),
        ("moodle", MOODLE.splitlines()[0], "lists no students"),
    ],
)  # fmt: skip
def test_a_wrong_roster_is_named_with_the_column_and_the_repair(roster, target, text, words):
    with pytest.raises(UsageError, match=r"list\.csv") as seen:
        roster(target, text)
    assert words in str(seen.value)


def test_a_roster_in_another_encoding_is_refused_or_read(roster):
    with pytest.raises(UsageError, match="not UTF-8; save it as CSV UTF-8"):
        roster("moodle", MOODLE, "cp1250")
    assert roster("moodle", MOODLE, "utf-16").rows[1].name == "Žofie Nováková"


def test_the_command_writes_the_export_and_names_who_is_missing(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "Žofie Nováková.py").write_text("def cube():\n    return 1\n", "utf-8")
    worksheet = tmp_path / "worksheet.csv"
    worksheet.write_text(MOODLE, "utf-8-sig")
    out = tmp_path / "out"
    command = ["grade", str(tmp_path / "in"), "--out", str(out), "--chapter", "0", "--allow-unconfined"]
    refused = CliRunner().invoke(main, [*command, "--roster", str(worksheet)])
    assert refused.exit_code == 2
    assert "--export" in refused.stderr
    wrong = CliRunner().invoke(main, [*command, "--roster", str(worksheet), "--export", "canvas"])
    assert wrong.exit_code == 2
    assert not out.exists()
    done = CliRunner().invoke(main, [*command, "--roster", str(worksheet), "--export", "moodle", "--json"])
    assert done.exit_code == 0, done.output
    assert any("Ada Lovelace" in remark for remark in json.loads(done.stdout)["export"]["remarks"])
    assert table((out / "moodle.csv").read_text("utf-8-sig"))[2][4] == "0"
