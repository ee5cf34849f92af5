"""Grade a class, and see what that costs beside what it cannot do without, and beside other graders.

Two studies, each in one run, the contenders in turn. Times are processor time of all processes, a submission.

**A chapter.** Two classes with all exercises of a chapter: one in which all is right, and a mixed one, in
which of each student's functions some are the reference, some other right ones, and a quarter wrong ones,
with pictures in the feedback. `gpcourse grade` on a class; one bare Python process that
imports numpy, holds the functions of a solved notebook and makes the calls that the checks make; and the same
solved notebook executed with nbclient.

**Other graders.** Twenty submissions of one assignment, three exercises of chapter 2, graded by gpcourse,
nbgrader (all in one call) and otter-grader (``otter run``, one call each). The cells with their tests make
the calls that our checks make with plain arrays, and compare with what the reference returns. Each grader has
an environment of its own, in `--peers`.
"""

from __future__ import annotations

import argparse
import base64
import csv
import json
import os
import pickle
import random
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from interleaved import forget_openblas_settings

forget_openblas_settings()
import numpy as np  # noqa: E402

from gpcourse.errors import NotebookError  # noqa: E402
from gpcourse.exercises.course import CHAPTERS, Chapter, find  # noqa: E402
from gpcourse.exercises.exercise import Exercise, Mistake, Variant  # noqa: E402
from gpcourse.exercises.judging import ask_here, judge  # noqa: E402
from gpcourse.notebook.closure import closure  # noqa: E402
from gpcourse.notebook.document import read, written  # noqa: E402
from gpcourse.notebook.solving import solve  # noqa: E402
from gpcourse.sandbox.call import Answer  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
SEED = 7
ASSIGNMENT = "ps1"
SMALL = ("rigid_transform", "reject_pairs", "trim_pairs")
PEERS = {"nbgrader": "nbgrader==0.9.6", "otter": "otter-grader==7.0.0"}

Call = tuple[str, tuple[Any, ...], dict[str, Any]]


@dataclass
class Times:
    """Seconds on the clock and of the processor for each contender, a submission, one pair a round."""

    wall: dict[str, list[float]] = field(default_factory=dict)
    processor: dict[str, list[float]] = field(default_factory=dict)

    def run(self, name: str, task: Callable[[], object], submissions: int) -> None:
        """Run a task that works on so many submissions in other processes, and note its times."""
        start, before = time.perf_counter(), _children()
        task()
        self.wall.setdefault(name, []).append((time.perf_counter() - start) / submissions)
        self.processor.setdefault(name, []).append((_children() - before) / submissions)

    def show(self, unit: str) -> None:
        """Print the least times, and the ratio to the contender `unit`."""
        least = {name: min(times) for name, times in self.processor.items()}
        print(f"{'':36}{'processor':>11}{'clock':>10}{'times ' + unit:>24}")
        for name, seconds in least.items():
            clock = statistics.median(self.wall[name])
            print(f"{name:36}{seconds:9.3f} s{clock:8.3f} s{seconds / least[unit]:24.2f}")


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(*command: str | Path, cwd: Path | None = None, good: Collection[int] = (0,)) -> None:
    """Run a command quietly, with the programs beside it in reach; what it says is shown if it fails."""
    path = f"{Path(command[0]).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        list(map(str, command)), cwd=cwd, env={**os.environ, "PATH": path}, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    if done.returncode not in good:
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")


def calls_of(exercises: Sequence[Exercise]) -> list[Call]:
    """Return the calls that the checks make, as the reference is asked them."""
    calls: list[Call] = []
    for exercise in exercises:
        here = ask_here(exercise.reference)

        def ask(
            arguments: tuple[Any, ...],
            options: dict[str, Any],
            limit: float,
            here: Any = here,
            name: str = exercise.name,
        ) -> Answer:
            calls.append((name, arguments, options))
            answer: Answer = here(arguments, options, limit)
            return answer

        judge(exercise, ask, SEED)
    return calls


def write_class(chapter: Chapter, folder: Path, students: int) -> Path:
    """Write a mixed class and one that is right; return the solved notebook."""
    document = read(ROOT / "notebooks" / chapter.notebook)
    rng = random.Random(SEED)

    def choose(exercise: Exercise) -> Callable[..., Any]:
        which = rng.random()
        others = _copied(exercise.mistakes if which < 0.25 else exercise.variants)
        return rng.choice(others) if which < 0.4 and others else exercise.reference

    solved = folder / "solved.ipynb"
    right = solve(document)
    solved.write_text(written(right), "utf-8")
    (folder / "mixed").mkdir(parents=True)
    (folder / "right").mkdir()
    code = next(cell for cell in right["cells"] if cell["cell_type"] == "code")
    start = "".join(code["source"])
    for i in range(students):
        (folder / "mixed" / f"student{i:04}.ipynb").write_text(written(solve(document, choose)), "utf-8")
        code["source"] = f"# by student {i}\n{start}"
        (folder / "right" / f"student{i:04}.ipynb").write_text(written(right), "utf-8")
    return solved


def grade(submissions: Path, out: Path) -> None:
    """Grade a class as its instructor does."""
    options = ("--out", out, "--quiet", "--allow-unconfined")
    run(sys.executable, "-m", "gpcourse", "grade", submissions, *options, good=(0, 1))  # 1: see the page


def chapter_study(chapter: Chapter, students: int, rounds: int) -> Times:
    """Run the first study for one chapter."""
    times = Times()
    with tempfile.TemporaryDirectory(prefix="grading-") as name:
        folder = Path(name)
        solved = write_class(chapter, folder, students)
        script = bare_script(solved, chapter, folder)
        nbclient = (
            "import nbformat, nbclient, sys; nbclient.NotebookClient(nbformat.read(sys.argv[1], 4)).execute()"
        )
        for i in range(rounds):
            for kind in ("right", "mixed"):
                out = folder / f"out-{kind}{i}"
                times.run(f"gpcourse grade, {kind}", partial(grade, folder / kind, out), students)
            times.run("bare python", partial(run, sys.executable, script), 1)
            times.run("nbclient", partial(run, sys.executable, "-c", nbclient, solved), 1)
    return times


def _copied(solutions: Sequence[Mistake | Variant]) -> list[Callable[..., Any]]:
    """Return the solutions that can be copied into a notebook: those at the top level of a module."""
    found = []
    for each in solutions:
        with suppress(NotebookError):
            closure(each.function)
            found.append(each.function)
    return found


def bare_script(solved: Path, chapter: Chapter, folder: Path) -> Path:
    """Write a program that imports numpy, defines the functions of a solved notebook and makes the calls."""
    data = folder / "calls.pickle"
    data.write_bytes(pickle.dumps(calls_of(chapter.exercises)))
    script = folder / "bare.py"
    names = {exercise.name for exercise in chapter.exercises}
    script.write_text("\n\n".join([*functions(solved, names), _CALLS.format(data=str(data))]), "utf-8")
    return script


_CALLS = """
import pickle
for name, arguments, options in pickle.load(open({data!r}, "rb")):
    try:
        globals()[name](*arguments, **options)
    except Exception:
        pass
"""
#: What the functions of exercises do not need.
_SPARE = (
    "matplotlib",
    "import check",
    "gpcourse.notebook",
    "gpcourse.view",
    "gpcourse.data_sets",
    "gpcourse.reference",
)


def functions(notebook: Path, names: Collection[str]) -> list[str]:
    """Return the imports of a notebook, and the cells that define these functions."""
    cells = [cell for cell in read(notebook)["cells"] if cell["cell_type"] == "code"]
    lines = "".join(cells[0]["source"]).splitlines()
    imports = "\n".join(line for line in lines if not any(word in line for word in _SPARE))
    tagged = [c for c in cells if c["metadata"].get("gpcourse", {}).get("exercise") in names]
    return [imports, *("".join(cell["source"]) for cell in tagged)]


TEST = """
import base64, pickle
import numpy as np

def agree(a, b):
    if isinstance(b, (tuple, list)):
        return all(agree(x, y) for x, y in zip(a, b, strict=True))
    np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-9)
    return True

calls = pickle.loads(base64.b64decode({data!r}))
assert all(agree({name}(*arguments, **options), expected) for arguments, options, expected in calls)
"""


def test_of(exercise: Exercise) -> str:
    """Return the code of a test: the calls with plain arrays that the reference answers, and its answers."""
    asked = []
    for _, arguments, options in calls_of([exercise]):
        answer = ask_here(exercise.reference)(arguments, options, exercise.time_limit)
        if answer.status == "returned" and all(map(_is_plain, arguments)):
            asked.append((arguments, options, answer.value))
    data = base64.b64encode(pickle.dumps(asked)).decode()
    return TEST.format(data=data, name=exercise.name)


def _is_plain(value: object) -> bool:
    return isinstance(value, (np.ndarray, float, int, np.number))


def submission(chapter: Chapter, rng: random.Random) -> list[tuple[str, str]]:
    """Return the name and the source of each function of one student."""

    def choose(exercise: Exercise) -> Callable[..., Any]:
        mistakes = _copied(exercise.mistakes)
        return rng.choice(mistakes) if mistakes and rng.random() < 0.25 else exercise.reference

    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "solved.ipynb"
        document = solve(read(ROOT / "notebooks" / chapter.notebook), choose)
        path.write_text(written(document), "utf-8")
        return [("imports", functions(path, ())[0]), *((each, functions(path, {each})[1]) for each in SMALL)]


def notebook(parts: Sequence[tuple[str, str]]) -> str:
    """Write the notebook of the assignment as nbgrader has it; `parts` are its solution cells."""
    marks = {"schema_version": 3, "cell_type": "code", "task": False}
    cells = []
    for name, source in parts:
        own = marks | {"grade_id": name, "grade": False, "locked": False, "solution": True}
        cells.append(_cell(source, name, own))
        if name in SMALL:
            test = marks | {
                "grade_id": f"test-{name}",
                "grade": True,
                "locked": True,
                "solution": False,
                "points": 1,
            }
            cells.append(_cell(test_of(find(name)), f"test-{name}", test))
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return json.dumps({"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5})


def _cell(source: str, name: str, marks: dict[str, Any]) -> dict[str, Any]:
    return {
        "cell_type": "code", "id": name.replace("_", "-"), "metadata": {"nbgrader": marks},
        "source": source, "outputs": [], "execution_count": None,
    }  # fmt: skip


def environment(folder: Path, name: str) -> Path | None:
    """Return the folder of a peer's programs, installed where it is not; None where it cannot be."""
    programs = folder / name / ("Scripts" if os.name == "nt" else "bin")
    if (programs / name).exists():
        return programs
    subprocess.run([sys.executable, "-m", "venv", str(folder / name)], check=True)
    pip = [programs / "python", "-m", "pip", "install", "--quiet"]
    wanted = ([PEERS[name], "numpy", "scipy", "ipykernel"], ["--no-deps", ROOT])  # students import gpcourse
    if any(subprocess.run(list(map(str, [*pip, *each])), check=False).returncode for each in wanted):
        print(f"{PEERS[name]} cannot be installed here: its row is missing", file=sys.stderr)
        return None
    return programs


def peer_study(peers: Path, students: int, rounds: int) -> Times:
    """Run the second study."""
    times = Times()
    programs = {name: environment(peers.absolute(), name) for name in PEERS}
    chapter = next(c for c in CHAPTERS if find(SMALL[0]) in c.exercises)
    with tempfile.TemporaryDirectory(prefix="grading-") as name:
        course = Path(name)
        prepare(course, chapter, students)
        if programs["nbgrader"]:
            run(programs["nbgrader"] / "nbgrader", "generate_assignment", ASSIGNMENT, cwd=course)
        if programs["otter"]:
            run(programs["otter"] / "otter", "generate", "-t", "tests", "-o", "autograder.zip", cwd=course)
        for i in range(rounds):
            ours = partial(grade, course / "submitted", course / f"ours{i}")
            times.run("gpcourse grade", ours, students)
            if programs["nbgrader"]:
                autograde = ("autograde", ASSIGNMENT, "--force")
                times.run(
                    "nbgrader autograde",
                    partial(run, programs["nbgrader"] / "nbgrader", *autograde, cwd=course),
                    students,
                )
            if programs["otter"]:
                times.run("otter run", partial(otter, programs["otter"], course), students)
        print("exercises with full points:", full_points(course, programs["nbgrader"]))
    return times


def full_points(course: Path, nbgrader: Path | None) -> dict[str, int]:
    """Count the exercises that each grader gave full points, to see that all graded the same work."""
    with (course / "ours0" / "grades.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    found = {"gpcourse": sum(int(row[name]) == find(name).points for row in rows for name in SMALL)}
    if nbgrader:
        run(nbgrader / "nbgrader", "export", cwd=course)
        with (course / "grades.csv").open(newline="", encoding="utf-8") as file:
            found["nbgrader"] = sum(int(float(row["score"])) for row in csv.DictReader(file))
    results = [json.loads(path.read_text("utf-8")) for path in course.glob("otter/*/results.json")]
    if results:
        tests = [test for result in results for test in result["tests"]]
        found["otter"] = sum(test.get("score") == 1 for test in tests)
    return found


def prepare(course: Path, chapter: Chapter, students: int) -> None:
    """Write an assignment and its submissions as nbgrader has them, and the tests as otter has them."""
    rng = random.Random(SEED)
    source = course / "source" / ASSIGNMENT
    source.mkdir(parents=True)
    (course / "nbgrader_config.py").write_text("c = get_config()\nc.CourseDirectory.course_id = 'course'\n")
    (source / f"{ASSIGNMENT}.ipynb").write_text(notebook(submission(chapter, random.Random(-1))), "utf-8")
    for i in range(students):
        folder = course / "submitted" / f"student{i:02}" / ASSIGNMENT
        folder.mkdir(parents=True)
        (folder / f"{ASSIGNMENT}.ipynb").write_text(notebook(submission(chapter, rng)), "utf-8")
    (course / "tests").mkdir()
    for name in SMALL:
        code = f">>> exec({test_of(find(name))!r}, globals())"
        suite = {"cases": [{"code": code}], "scored": True, "setup": "", "teardown": "", "type": "doctest"}
        test = {"name": name, "points": 1, "suites": [suite]}
        (course / "tests" / f"{name}.py").write_text(f"OK_FORMAT = True\ntest = {test!r}\n", "utf-8")


def otter(programs: Path, course: Path) -> None:
    """Grade all submissions with otter, one after the other."""
    for path in sorted(course.glob("submitted/*/*/*.ipynb")):
        out = course / "otter" / path.parts[-3]
        out.mkdir(parents=True, exist_ok=True)
        run(programs / "otter", "run", "--no-logo", "-a", course / "autograder.zip", "-o", out, path)


def memory(counts: list[int]) -> None:
    """Print the most memory that the grader held while it graded classes of small notebooks."""
    for count in counts:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name) / "class"
            folder.mkdir()
            for i in range(count):
                cell = {
                    "cell_type": "code",
                    "source": f"# {i}\ndef triangle_area(a, b, c):\n    return abs(a).sum()",
                }
                (folder / f"student{i:04}.ipynb").write_text(json.dumps({"cells": [cell]}), "utf-8")
            command = [sys.executable, "-m", "gpcourse", "grade", folder, "--out", Path(name) / "out"]
            process = subprocess.Popen([*map(str, command), "--quiet", "--allow-unconfined"])
            _, _, usage = os.wait4(process.pid, 0)
            print(f"{count:>6} submissions: {usage.ru_maxrss / 1024:.0f} MB")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--chapters", nargs="*", default=["halfedge", "registration", "smoothing"])
    parser.add_argument("--students", type=int, default=100, help="in the class of a chapter")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument(
        "--peers", type=Path, default=ROOT / "build" / "peers", help="where peers are installed"
    )
    parser.add_argument("--no-peers", action="store_true", help="leave the second study out")
    parser.add_argument("--memory", type=int, nargs="+", metavar="COUNT", help="only: memory for so many")
    options = parser.parse_args()
    if options.memory:
        memory(options.memory)
        return
    for chapter in (c for c in CHAPTERS if c.stem in options.chapters):
        print(f"\n{chapter.title}: {len(chapter.exercises)} exercises, {options.students} students")
        chapter_study(chapter, options.students, options.rounds).show("bare python")
    if not options.no_peers:
        print("\nTwenty submissions of three exercises")
        peer_study(options.peers, 20, options.rounds).show("gpcourse grade")


if __name__ == "__main__":
    main()
