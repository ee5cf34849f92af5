"""Good notebooks, damaged at random: each gets a row, a true status, and the marks of what can still be read.

GPCOURSE_FUZZ is the number of notebooks, GPCOURSE_FUZZ_SEED where they begin.
"""

import json
import os
import random
import sys

import pytest

from gpcourse.exercises import expect
from gpcourse.exercises.exercise import Exercise
from gpcourse.grading.judge import judge_submission
from gpcourse.grading.submission import read_folder
from gpcourse.sandbox import confine, home
from gpcourse.sandbox.proxy import Worker

if sys.platform == "win32":
    pytest.skip("files with any name", allow_module_level=True)

MANY = int(os.environ.get("GPCOURSE_FUZZ", "80"))
FIRST = int(os.environ.get("GPCOURSE_FUZZ_SEED", "0"))
NAMES = [f"times_{k}" for k in range(2, 7)]
SOURCES = {name: f"def {name}(x):\n    y = x * {name[-1]}\n    return y\n" for name in NAMES}
JUNK = [None, True, -1, 1e400, "", "x\0\ud800", [], {}, [[]], {"cells": []}, "9" * 5000, [None, {}]]


def exercises():
    for name in NAMES:
        namespace = {}
        exec(SOURCES[name], namespace)
        made = Exercise(namespace[name], notes="ch. 0", hints=["Look again."], time_limit=2.0)

        @made.check("numbers", points=2)
        def _(f, rng, function=namespace[name]):
            x = int(rng.integers(10, 1000))
            expect.close(expect.number(f(x)), float(function(x)), 0.0, "The result")

        yield made


def good():
    def cell(kind, source):
        outputs = [{"output_type": "stream", "name": "stdout", "text": ["passed: 2 of 2 points"]}]
        extra = {"outputs": outputs, "execution_count": 1} if kind == "code" else {}
        return {"cell_type": kind, "id": f"c{len(cells)}", "metadata": {}, "source": source} | extra

    cells = []
    for name in NAMES:
        cells.append(cell("markdown", f"## {name}\nWrite a *function*."))
        cells.append(cell("code", SOURCES[name]))
        cells.append(cell("code", f"print({name}(3))"))
    return {
        "cells": cells,
        "metadata": {"language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def damage_cells(rng, document):
    """Delete, copy, move, retype, split or change cells."""
    cells = document["cells"]
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(cells)) if cells else 0
        match rng.randrange(8) if cells else 8:
            case 0:
                del cells[at]
            case 1:
                cells.insert(rng.randrange(len(cells)), json.loads(json.dumps(cells[at])))
            case 2:
                rng.shuffle(cells)
            case 3:
                cells[at]["cell_type"] = rng.choice(["markdown", "raw", "code", "heading"])
            case 4:
                cells[at]["source"] = text_of(cells[at]).splitlines(keepends=True)
            case 5:
                cells[at]["source"] = text_of(cells[at]).replace("\n", "\r\n")
            case 6:
                text = text_of(cells[at])
                cut = rng.randrange(len(text) + 1)
                cells[at]["source"] = (
                    text[:cut] + rng.choice(["", "(", "\0", "'''", "\t", "π", "%%bash\n"]) + text[cut:]
                )
            case _:
                cells.insert(
                    at,
                    {
                        "cell_type": "code",
                        "source": rng.choice(["def f(:", "!ls", "%%html\n<b>", "1 / 0", "while True: pass"]),
                    },
                )
    return json.dumps(document).encode()


def damage_json(rng, document):
    """Remove keys, or replace values by others of any kind."""
    for _ in range(rng.randint(1, 5)):
        place = rng.choice(
            [document, document["metadata"], *document["cells"]]
            if isinstance(document.get("cells"), list)
            else [document]
        )
        if not isinstance(place, dict) or not place:
            continue
        key = rng.choice(list(place))
        if key == "cells" and rng.random() < 0.8:
            continue
        if rng.random() < 0.4:
            del place[key]
        else:
            place[key] = rng.choice(JUNK)
        document.setdefault("metadata", {})
    return json.dumps(document).encode()


def damage_bytes(rng, raw):
    """Change, remove or insert bytes; return the result and where the first damage is."""
    at = rng.randrange(len(raw))
    length = rng.choice([1, 1, 2, 10, 200])
    match rng.randrange(4):
        case 0:
            return raw[:at] + rng.randbytes(length) + raw[at + length :], at
        case 1:
            return raw[:at] + raw[at + length :], at
        case 2:
            return raw[:at] + rng.choice(
                [b"\xff", b"{", b"]", b'"', b"\n<<<<<<< HEAD\n", b"\\"]
            ) * length + raw[at:], at
        case _:
            return raw[:at], at


def text_of(cell):
    source = cell.get("source", "")
    return (
        "".join(source)
        if isinstance(source, list) and all(isinstance(s, str) for s in source)
        else str(source)
    )


def certain(raw):
    """Say what a file that is JSON deserves: True where a function is whole, False where there is none."""
    document = json.loads(raw)
    cells = document.get("cells") if isinstance(document, dict) else None
    codes = (
        [c for c in cells if isinstance(c, dict) and c.get("cell_type") == "code"]
        if isinstance(cells, list)
        else []
    )
    outcome = {}
    for name in NAMES:
        holding = [
            text_of(c).replace("\r\n", "\n")
            for c in codes
            if name in text_of(c) and "print" not in text_of(c)
        ]
        if not holding:
            outcome[name] = False
        elif holding[-1] == SOURCES[name]:
            outcome[name] = True
    return outcome


def whole_before(raw, at):
    """The functions whose cells end before the byte `at`."""
    ends = {name: raw.index(json.dumps(SOURCES[name]).encode()) for name in NAMES}
    return {name: True for name in NAMES if 0 <= raw.find(b"1}, {", ends[name]) < at - 4}


def damaged(number):
    """Return a damaged notebook, and for the exercises where that is certain whether the work is still there."""
    rng = random.Random(number)
    document = good()
    kind = number % 4
    if kind == 0:
        raw = damage_cells(rng, document)
        return raw, certain(raw)
    if kind == 1:
        raw = damage_json(rng, document)
        return raw, certain(raw)
    before = json.dumps(document).encode()
    raw, at = damage_bytes(rng, before)
    try:
        return raw, certain(raw)
    except (ValueError, RecursionError):
        return raw, whole_before(before, at)


@pytest.fixture(scope="module")
def launch(tmp_path_factory):
    package = home.build(tmp_path_factory.mktemp("run") / "home")
    with confine.launcher(package) as launch:
        yield lambda cells: Worker(list(cells), package, confine.Limits(load=1.0, patience=1.0), launch)


def test_every_damaged_notebook_gets_a_row_and_the_marks_of_what_is_whole(launch, tmp_path):
    asked = list(exercises())
    folder = tmp_path / "class"
    folder.mkdir()
    deserved = {}
    for number in range(FIRST, FIRST + MANY):
        raw, deserved[f"s{number}"] = damaged(number)
        (folder / f"s{number}.ipynb").write_bytes(raw)
    submissions = read_folder(folder)
    assert {s.student for s in submissions} == set(deserved)
    kept = lost = 0
    for submission in submissions:
        report = judge_submission(submission, asked, 0, lambda n: launch(n.cells))
        outcomes = {one.verdict.exercise.name: one.verdict.outcome for one in report.judged}
        assert set(outcomes) == set(NAMES)
        assert "grader fault" not in {report.status, *outcomes.values()}, (submission.student, report.notes)
        for name, whole in deserved[submission.student].items():
            assert (outcomes[name] == "passed") == whole, (submission.student, name, outcomes, report.notes)
        found = {"graded"} if set(outcomes.values()) != {"not attempted"} else {"not attempted", "unreadable"}
        assert report.status in found, submission.student
        kept += sum(deserved[submission.student].values())
        lost += len(deserved[submission.student]) < len(NAMES)
    assert kept > 2 * len(submissions), "the damage leaves too little to mean anything"
    assert lost, "the damage does nothing"
