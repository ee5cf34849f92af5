"""Which submissions share code: pairs to look at, found by the fingerprints of copydetect.

What the notebooks of the course hold themselves is not counted. Names and comments do not matter to a
fingerprint, so code whose variables were renamed is found too. Two who share code have not always copied:
short functions of the book look alike. A person reads both before anything is said.

References
----------
Schleimer, Wilkerson, Aiken, *Winnowing: Local Algorithms for Document Fingerprinting*, SIGMOD 2003.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

from gpcourse.errors import UsageError
from gpcourse.exercises.course import CHAPTERS, Chapter
from gpcourse.grading import gradebook, reports
from gpcourse.grading.reading import Notebook, read_notebook
from gpcourse.grading.run import chapters_in
from gpcourse.grading.submission import read_class
from gpcourse.sandbox.home import PACKAGE

#: The most pairs that the page shows.
MOST = 100
#: The name of the reference solutions among the documents. No student has it: it is no name of a file.
REFERENCE = "the reference solutions"
#: Characters of filtered code that are compared at a time, and how many are looked at to choose one: what
#: is shared and longer than both together is found. A loop head is shorter.
LENGTH, WINDOW = 30, 10
#: Characters of filtered code, a third of what was written, that a pair shares at least.
LEAST = 100

#: Characters of code that one may hand in. A whole chapter, solved, takes a quarter of that; the time that a
#: text takes grows with its length.
LONGEST = 600_000

#: Starts and ends of the places that two texts share.
Spans = list[tuple[int, int]]


@dataclass(frozen=True)
class Pair:
    """Two documents that share code. `shares` are the parts of each that the other has, from 0 to 1.

    `spans` are the places in their texts.
    """

    names: tuple[str, str]
    shares: tuple[float, float]
    texts: tuple[str, str]
    spans: tuple[Spans, Spans]

    @property
    def share(self) -> float:
        """The larger of the shares: a short one may lie within a long one."""
        return max(self.shares)

    @property
    def with_reference(self) -> bool:
        """Whether one of the two is the reference."""
        return REFERENCE in self.names


def compare(
    folder: Path,
    templates: Sequence[Path],
    out: Path,
    *,
    threshold: float = 0.5,
    tell: Callable[[str], object] = lambda _: None,
) -> tuple[Pair, ...]:
    """Compare the submissions in `folder` with each other and with the reference; write what they share.

    Writes ``similarity.csv``, all pairs that share something, and ``similarity.html``, which shows those
    that share at least `threshold`, up to `MOST`; these pairs are returned, the most alike first.

    Parameters
    ----------
    folder, out : path
        The submissions, as `submission.read_class` takes them, and a folder.
    templates : sequence of path
        The notebooks as they were given out.
    threshold : float
        From 0 to 1.
    tell : callable, optional
        Called with a sentence on each submission that cannot be compared; the page has them too.

    Raises
    ------
    UsageError
        If copydetect is not installed, or an argument cannot be used.
    """
    if not 0 < threshold <= 1:
        raise UsageError(f"the threshold is {threshold:g}; give a share above 0, up to 1")
    submissions = read_class(folder)
    if out.exists() and not out.is_dir():
        raise UsageError(f"{out} is a file; give a folder for the report")
    notebooks = [notebook for submission in submissions for notebook in submission.notebooks]
    texts = {submission.student: _code(submission.notebooks) for submission in submissions}
    left_out = [name for name, text in texts.items() if len(text) > LONGEST]
    for name in left_out:
        tell(f"{gradebook.safe(name)}: {len(texts.pop(name))} characters of code are too many to compare")
    pairs = _pairs(texts, templates, chapters_in(notebooks) or CHAPTERS)
    shown = tuple(pair for pair in pairs if pair.share >= threshold)
    gradebook.write(out / "similarity.csv", _table(pairs))
    first = shown[:MOST]
    sides = [_parts(pair) for pair in first]
    more = len(shown) - len(first)
    page = reports.similarity_page(first, sides, len(texts), threshold, more=more, left_out=left_out)
    gradebook.write(out / "similarity.html", page)
    return shown


def _pairs(students: Mapping[str, str], templates: Sequence[Path], chapters: Sequence[Chapter]) -> list[Pair]:
    given = _fingerprint("the notebooks of the course", _code(list(map(read_notebook, templates))), [])
    reference = "\n\n".join(_reference(chapter) for chapter in chapters)
    texts = {**students, REFERENCE: reference}
    boilerplate = sorted(given.hashes)
    prints = [_fingerprint(name, text, boilerplate) for name, text in texts.items()]
    pairs = [_pair(a, b) for a, b in combinations((p for p in prints if len(p.hashes)), 2)]
    return sorted((p for p in pairs if p.share > 0), key=lambda p: (-p.share, p.names))


def _code(notebooks: Sequence[Notebook]) -> str:
    return "\n\n".join(source for notebook in notebooks for _, source in notebook.cells)


def _reference(chapter: Chapter) -> str:
    place = PACKAGE / "reference" / chapter.stem
    files = sorted(place.glob("*.py")) if place.is_dir() else [place.with_suffix(".py")]
    return "\n\n".join(path.read_text("utf-8") for path in files)


def _fingerprint(name: str, text: str, boilerplate: Sequence[int]) -> Any:
    try:
        from copydetect import CodeFingerprint
    except ImportError:
        raise UsageError(
            'the comparison needs copydetect; install it by pip install "gpcourse[similarity]"'
        ) from None
    plain = "".join(c if c.isprintable() or c in "\n\t" else "�" for c in text)
    print_ = CodeFingerprint(
        "student.py", LENGTH, WINDOW, boilerplate, True, language="python", fp=io.StringIO(plain)
    )
    print_.filename = name
    return print_


def _pair(a: Any, b: Any) -> Pair:
    from copydetect import compare_files

    shared, shares, spans = compare_files(a, b)
    if shared < LEAST:
        shares = (0.0, 0.0)
    return Pair(
        (a.filename, b.filename),
        (min(float(shares[0]), 1.0), min(float(shares[1]), 1.0)),
        (a.raw_code, b.raw_code),
        (_spans(spans[0]), _spans(spans[1])),
    )


def _spans(found: Any) -> Spans:
    return [(int(start), int(end)) for start, end in zip(*found, strict=True)] if len(found) else []


def _parts(pair: Pair) -> list[list[tuple[str, bool]]]:
    """Cut both texts into the lines around what is shared: each piece, and whether it is shared."""
    return [_cut(text, spans) for text, spans in zip(pair.texts, pair.spans, strict=True)]


def _cut(text: str, spans: Spans) -> list[tuple[str, bool]]:
    """Return the shared places, widened to whole lines, and a mark for what lies between them."""
    lines = text.splitlines()
    starts, place = [], 0
    for line in lines:
        starts.append(place)
        place += len(line) + 1
    shared = [
        any(a < s + len(line) and s < b for a, b in spans) for s, line in zip(starts, lines, strict=True)
    ]
    near = [any(shared[max(i - 1, 0) : i + 2]) for i in range(len(lines))]
    pieces: list[tuple[str, bool]] = []
    for i, line in enumerate(lines):
        if near[i]:
            pieces.append((line, shared[i]))
        elif pieces and pieces[-1] != ("…", False):
            pieces.append(("…", False))
    return pieces


def _table(pairs: Sequence[Pair]) -> str:
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(["one", "other", "share of one", "share of other"])
    for pair in pairs:
        writer.writerow([*map(gradebook.safe, pair.names), *(f"{share:.3f}" for share in pair.shares)])
    return buffer.getvalue()
