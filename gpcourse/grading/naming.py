"""Whose a file is: the names that learning platforms give to what they hand out for grading.

References
----------
Moodle, one folder a student or, if so chosen, one file each: *mod/assign/classes/downloader.php*; and
https://docs.moodle.org/en/Assignment_FAQ. Canvas, one file each: *lib/content_zipper.rb* of canvas-lms.
"""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Literal

from gpcourse.grading.archives import ARCHIVES, Entry, plain

Platform = Literal["", "moodle", "canvas"]

_MOODLE = re.compile(r"(?P<name>.+?)(?:_(?P<id>\d+))?_assignsubmission_[a-z]+(?:_(?P<rest>.*))?", re.DOTALL)
_CANVAS = re.compile(
    r"(?:(?P<name>.+?)_)??(?P<late>LATE_)?(?P<id>\d+|anon_[A-Za-z0-9]+)_"
    r"(?:(?P<file>\d+)_(?P<rest>.+)|(?P<page>(?:text|link)\.html))",
    re.DOTALL,
)


@dataclass(frozen=True)
class Owner:
    """A student, as a file's name tells: with the number that the platform has for him or her, if any."""

    name: str
    id: str = ""
    platform: Platform = ""


@dataclass(frozen=True)
class Claim:
    """A file with its owner, its place among the owner's files, and the `root` that says whose it is."""

    owner: Owner
    entry: Entry
    root: str
    late: bool = False
    #: Canvas counts its files up, so that of two of one name the later one has the larger number.
    order: int = field(default=0, compare=False)


def claims(entries: Sequence[Entry]) -> list[Claim]:
    """Tell whose each file of a class is. Files beside the students' that are no work have no owner."""
    canvas = _canvas(entries)
    found = []
    for entry in entries:
        claim = _by_moodle(entry) or canvas.get(entry.parts) or _plain(entry)
        if claim is not None:
            found.append(claim)
    return found


def named(name: str) -> str:
    """Return a name in the form in which names are compared and shown."""
    return unicodedata.normalize("NFC", name).strip() or "(no name)"


def _by_moodle(entry: Entry) -> Claim | None:
    match = _MOODLE.fullmatch(entry.parts[0])
    if match is None:
        return None
    owner = Owner(named(match["name"]), match["id"] or "", "moodle")
    inner = entry.parts[1:] or (match["rest"] or entry.parts[0],)
    return Claim(owner, Entry(inner, entry.read, entry.folder), "moodle")


def _canvas(entries: Sequence[Entry]) -> dict[tuple[str, ...], Claim]:
    """Return the files that Canvas named, if there are any.

    Two numbers in a name can be chance (hw_1_2_ada.ipynb). In what Canvas made no number of a file comes
    twice, and most files have such names.
    """
    tops = [entry for entry in entries if len(entry.parts) == 1 and not entry.folder]
    matches = {entry: match for entry in tops if (match := _CANVAS.fullmatch(entry.name))}
    numbers = Counter(match["file"] for match in matches.values() if match["file"])
    if 2 * len(matches) < len(tops) or max(numbers.values(), default=1) > 1:
        return {}
    return {entry.parts: _by_canvas(entry, match) for entry, match in matches.items()}


def _by_canvas(entry: Entry, match: re.Match[str]) -> Claim:
    owner = Owner(named(match["name"] or match["id"]), match["id"], "canvas")
    inner = Entry((match["rest"] or match["page"],), entry.read)
    return Claim(owner, inner, "canvas", bool(match["late"]), int(match["file"] or 0))


def _plain(entry: Entry) -> Claim | None:
    """A folder a student, or a file a student that can be graded."""
    top, inner = entry.parts[0], entry.parts[1:]
    if entry.folder or inner:
        return Claim(Owner(named(top)), Entry(inner or (".",), entry.read, entry.folder), f"the folder {top}")
    if entry.suffix in (".ipynb", ".py", *ARCHIVES):
        return Claim(Owner(named(PurePath(plain(top)).stem.removesuffix(".tar"))), entry, top)
    return None
