"""What it costs to grade a notebook: `gpcourse grade` beside a bare Python process and beside nbclient.

The notebook is a chapter's, solved; the class has it many times, each with another comment. Times are of the
processor, all child processes included, so that other programs on the machine matter little. Every round runs
each contender once.

    python benchmarks/grading.py --students 20 --repeat 3
    python benchmarks/grading.py --memory 100 1000
"""

from __future__ import annotations

import argparse
import ast
import copy
import json
import os
import pickle
import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from interleaved import forget_openblas_settings

forget_openblas_settings()

ROOT = Path(__file__).parents[1]
SEED = 7
NBCLIENT = "from nbclient.cli import main; main()"

BARE = """
import pickle, numpy as np
with open({calls!r}, "rb") as file:
    calls = pickle.load(file)
for source, name, questions in calls:
    space = {{}}
    exec(source, space)
    for arguments, options in questions:
        try:
            space[name](*arguments, **options)
        except Exception:
            pass
"""


def processor_seconds(*command: object) -> float:
    """Run a command, and return the processor time of it and of all its children."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(list(map(str, command)), check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def solved(chapter: str) -> dict[str, Any]:
    """Return the notebook of a chapter with every exercise solved."""
    (path,) = (ROOT / "notebooks").glob(f"*_{chapter}.ipynb")
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "gpcourse", "solve", path, "--out", folder], check=True)
        content: dict[str, Any] = json.loads((Path(folder) / path.name).read_text("utf-8"))
    return content


def write_class(folder: Path, notebook: dict[str, Any], students: int) -> Path:
    """Write the notebook so many times, each with a comment of its own."""
    folder.mkdir()
    for i in range(students):
        own = copy.deepcopy(notebook)
        code = next(cell for cell in own["cells"] if cell["cell_type"] == "code")
        code["source"] = f"# by student {i}\n" + "".join(code["source"])
        (folder / f"student{i:04}.ipynb").write_text(json.dumps(own), "utf-8")
    return folder


def write_bare(folder: Path, notebook: dict[str, Any], chapter: str) -> Path:
    """Write a program that defines each function of the notebook and makes the calls that the checks make."""
    from gpcourse.exercises.course import CHAPTERS
    from gpcourse.exercises.judging import Asked, Ours, run_check
    from gpcourse.sandbox.program import Program

    sources = enumerate("".join(c["source"]) for c in notebook["cells"] if c["cell_type"] == "code")
    program = Program(sources)
    calls = []
    for exercise in next(c for c in CHAPTERS if c.stem == chapter).exercises:
        source = "\n".join(ast.unparse(statement.node) for statement in program.needed(exercise.name))
        ours, questions = Ours(exercise, SEED), []
        for check in exercise.checks:
            asked = Asked(exercise, lambda a, o, limit, e=ours: e._call(0, a, o, limit), exercise.time_limit)
            run_check(check, asked, SEED)
            questions += [(question.arguments, question.options) for question in asked.questions]
        calls.append((source, exercise.name, questions))
    (folder / "calls.pickle").write_bytes(pickle.dumps(calls))
    (folder / "bare.py").write_text(BARE.format(calls=str(folder / "calls.pickle")), "utf-8")
    return folder / "bare.py"


def grade(folder: Path) -> float:
    """Grade a class, and return the seconds."""
    with tempfile.TemporaryDirectory() as out:
        return processor_seconds(
            sys.executable, "-m", "gpcourse", "grade", folder, "--out", out, "--seed", SEED, "--quiet",
            "--allow-unconfined",
        )  # fmt: skip


def throughput(chapter: str, students: int, repeat: int) -> None:
    """Print the seconds of each contender, and the ratios."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        notebook = solved(chapter)
        (folder / "one.ipynb").write_text(json.dumps(notebook), "utf-8")
        many, one = write_class(folder / "many", notebook, students), write_class(folder / "1", notebook, 1)
        bare = write_bare(folder, notebook, chapter)
        contenders: dict[str, Callable[[], float]] = {
            f"a class of {students}": lambda: grade(many),
            "a class of 1": lambda: grade(one),
            "a bare process": lambda: processor_seconds(sys.executable, bare),
            "nbclient": lambda: processor_seconds(
                sys.executable, "-c", NBCLIENT, "--allow-errors", folder / "one.ipynb"
            ),
        }
        times: dict[str, list[float]] = {contender: [] for contender in contenders}
        for _ in range(repeat):
            for contender, run in contenders.items():
                times[contender].append(run())
    medians = {contender: statistics.median(seconds) for contender, seconds in times.items()}
    for contender, seconds in medians.items():
        print(f"{contender:<20}{seconds:8.2f} s")
    each = medians[f"a class of {students}"] / students
    further = (medians[f"a class of {students}"] - medians["a class of 1"]) / (students - 1)
    for words, cost in (("a notebook, all costs shared", each), ("one notebook more", further)):
        ratios = (cost / medians["a bare process"], medians["nbclient"] / cost)
        print(
            f"{words:<30}{cost:7.3f} s, {ratios[0]:.2f} of a bare process; nbclient: {ratios[1]:.1f} times it"
        )


def memory(counts: list[int]) -> None:
    """Print the most memory that the grader held while it graded classes of small notebooks."""
    cell = {"cell_type": "code", "source": "def triangle_area(a, b, c):\n    return abs(a).sum()"}
    for count in counts:
        with tempfile.TemporaryDirectory() as name:
            folder = write_class(Path(name) / "class", {"cells": [cell]}, count)
            command = [sys.executable, "-m", "gpcourse", "grade", folder, "--out", Path(name) / "out"]
            process = subprocess.Popen([*map(str, command), "--quiet", "--allow-unconfined"])
            _, _, usage = os.wait4(process.pid, 0)
            print(f"{count:>6} submissions: {usage.ru_maxrss / 1024:.0f} MB")


def main() -> None:
    """Read the command line and run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--chapter", default="halfedge")
    parser.add_argument("--students", type=int, default=20)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--memory", type=int, nargs="+", metavar="COUNT")
    options = parser.parse_args()
    if options.memory:
        memory(options.memory)
    else:
        throughput(options.chapter, options.students, options.repeat)


if __name__ == "__main__":
    main()
