"""What a run has done so far, kept in the folder of the grade book, so that another run can go on with it.

``journal.jsonl`` holds a line that says what the grades depend on besides the notebooks, and then a line for
each submission that is done, under a digest of what was handed in. A line is written at once and as a whole;
of a run that was ended while it wrote, the last line may be torn, and is not read. Nor is a line that is
not as it was written: each has a digest of itself.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from functools import cache
from hashlib import blake2b
from importlib.metadata import version
from pathlib import Path
from typing import Any, Self

from filelock import FileLock, Timeout

from gpcourse.errors import UsageError
from gpcourse.exercises.exercise import Exercise
from gpcourse.grading import gradebook
from gpcourse.grading.judge import Report
from gpcourse.grading.records import decode, encode
from gpcourse.grading.submission import Submission
from gpcourse.sandbox.confine import Limits

_PACKAGE = Path(__file__).parents[1]


def digest(*parts: object) -> str:
    """Return a digest of plain values."""
    return blake2b(repr(parts).encode(), digest_size=20).hexdigest()


def digest_of(submission: Submission) -> str:
    """Return a digest of all that decides a submission's row and page."""
    files = [(n.name, n.cells, n.notes, n.readable, n.damaged) for n in submission.notebooks]
    return digest(submission.student, submission.notes, files)


def conditions(exercises: Sequence[Exercise], seed: int, limits: Limits) -> dict[str, Any]:
    """Return all that decides the grades besides the notebooks."""
    names = [exercise.name for exercise in exercises]
    return {"course": course_digest(), "exercises": names, "seed": seed, "limits": asdict(limits)}


@cache
def course_digest() -> str:
    """Return a digest of this installation: every file of gpcourse, Python, and what checks compute with."""
    files = (p for p in sorted(_PACKAGE.rglob("*")) if p.suffix in (".py", ".html", ".css", ".js"))
    texts = [(str(p.relative_to(_PACKAGE)), blake2b(p.read_bytes()).digest()) for p in files]
    return digest(texts, platform.python_version(), version("numpy"), version("scipy"), version("matplotlib"))


@contextlib.contextmanager
def locked(out: Path) -> Iterator[None]:
    """Hold the folder `out` for one run. The lock ends with the process, however that ends.

    Raises
    ------
    UsageError
        If another run holds it.
    """
    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
    lock = FileLock(out / ".lock", blocking=False)
    try:
        with lock:
            yield
    except Timeout:
        raise UsageError(
            f"another run is grading into {out}; wait until it is done, or choose another folder"
        ) from None


@contextlib.contextmanager
def writing(out: Path) -> Iterator[None]:
    """Turn what can happen while a file is written into a `UsageError` that says what to do."""
    try:
        yield
    except OSError as error:
        full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
        what = "make room" if full else "make it writable"
        raise UsageError(
            f"{out} cannot be written to: {error.strerror or error}; {what} and give the same command "
            "again: it goes on where this one stopped"
        ) from error


class Journal:
    """The journal of one folder. Use it in a ``with`` block, within `locked`.

    `done` are the lines by digest, if the run that wrote them had the same conditions; else it begins anew.
    """

    def __init__(self, out: Path, known: Mapping[str, Any]) -> None:
        self.out = out
        self.path = out / "journal.jsonl"
        self.head = json.loads(json.dumps(known))
        self.done: dict[str, dict[str, Any]] = {}

    def __enter__(self) -> Self:
        if self.path.is_symlink() or (self.path.exists() and not self.path.is_file()):
            raise UsageError(f"{self.path} is no file, or a link to one; remove it, or choose another folder")
        kept = self._read() if self.path.exists() else 0
        with writing(self.out):
            self._file = self.path.open("r+b" if kept else "wb")
            self._file.seek(kept)
            self._file.truncate()
            if not kept:
                self._append(self.head)
        _sweep(self.out)
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(OSError):  # what could not be written was said by then
            self._file.close()

    def _read(self) -> int:
        """Read the lines that are whole, and return where they end; 0 if they are of other conditions."""
        end = 0
        with self.path.open("rb") as file:
            for line in file:
                content = _content(line)
                if content is None or (end == 0 and content != self.head):
                    break
                if end:
                    self.done[str(content.get("digest"))] = content
                end += len(line)
        return end

    def recall(self, submission: Submission, stem: str, exercises: Sequence[Exercise]) -> Report | None:
        """Return the report on a submission that is done, if its files are still as they were written."""
        line = self.done.get(digest_of(submission))
        if line is None or line.get("files") != _digests(self.out, stem):
            return None
        try:
            report = decode(line["report"], exercises)
        except (KeyError, IndexError, TypeError, ValueError):
            return None
        return report if report.student == submission.student else None

    def write(self, submission: Submission, stem: str, report: Report) -> None:
        """Note that a submission is done, and its files written. One with a fault of ours is tried again."""
        if report.status == "grader fault":
            return
        files = _digests(self.out, stem)
        with writing(self.out):
            self._append({"digest": digest_of(submission), "files": files, "report": encode(report)})

    def _append(self, content: Mapping[str, Any]) -> None:
        self._file.write(json.dumps({**content, "sum": _sum(content)}).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())


def _content(line: bytes) -> dict[str, Any] | None:
    """Read a line; None if it is not as it was written."""
    try:
        content = json.loads(line) if line.endswith(b"\n") else None
    except (ValueError, RecursionError):
        return None
    if not isinstance(content, dict) or content.pop("sum", None) != _sum(content):
        return None
    return content


def _sum(content: Mapping[str, Any]) -> str:
    return blake2b(json.dumps(content).encode(), digest_size=8).hexdigest()


def files_of(out: Path, stem: str) -> tuple[Path, Path]:
    """Return the page of a student, and what Gradescope gets."""
    return out / "students" / f"{stem}.html", out / "gradescope" / stem / "results.json"


def _digests(out: Path, stem: str) -> list[str] | None:
    try:
        return [blake2b(path.read_bytes(), digest_size=20).hexdigest() for path in files_of(out, stem)]
    except OSError:
        return None


def _sweep(out: Path) -> None:
    """Remove the files that a run was writing when it was ended."""
    for folder in (out, out / "students", *(out / "gradescope").glob("*")):
        for path in folder.glob(f".*{gradebook.UNFINISHED}"):
            path.unlink(missing_ok=True)


def without_answers(report: Report) -> Report:
    """Drop the questions and answers, so that memory stays flat over a large class."""
    judged = []
    for one in report.judged:
        results = tuple(replace(result, questions=()) for result in one.verdict.results)
        judged.append(replace(one, verdict=replace(one.verdict, results=results)))
    return replace(report, judged=tuple(judged))
