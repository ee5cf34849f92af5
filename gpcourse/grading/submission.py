"""What a class handed in: a `Submission` for each student, whatever the files are and wherever they lie."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from gpcourse.errors import UsageError
from gpcourse.grading.archives import (
    ARCHIVES,
    MAX_DEPTH,
    Budget,
    Entry,
    Unreadable,
    folder_entries,
    unzip,
    zip_file,
)
from gpcourse.grading.naming import Claim, Owner, claims
from gpcourse.grading.reading import SUFFIXES, Notebook, notebook, read_notebook, unreadable

__all__ = ["Notebook", "Owner", "Submission", "read_class", "read_folder", "read_notebook"]

#: What lies beside ``submitted`` in the folder of a course of nbgrader.
_NBGRADER = ("nbgrader_config.py", "gradebook.db", "source", "release", "autograded")
#: hw.ipynb, hw-1.ipynb (Canvas, when handed in anew), hw (2).ipynb (a browser).
_COUNTED = re.compile(r"(.*?)(?:-(\d{1,6})| ?\((\d{1,6})\))?", re.DOTALL)
_GIVE = "give the folder or the zip file that holds the submissions"
_TIMESTAMP = re.compile(r"\d{4}-\d\d-\d\d[ T][\w:.+/ -]{0,60}")


#: Whose a submission is that did not come with a class.
UNKNOWN = Owner("")


@dataclass(frozen=True)
class Submission:
    """All that one student handed in.

    `owner` is whose it is by the names of the files; `student` is the same name, with the platform's number
    where two have one name. `remarks` are about the hand-in as a whole. `timestamp` is nbgrader's.
    """

    student: str
    notebooks: tuple[Notebook, ...]
    owner: Owner = UNKNOWN
    remarks: tuple[str, ...] = ()
    timestamp: str = ""

    @property
    def readable(self) -> bool:
        """Whether at least one file could be read."""
        return any(notebook.readable for notebook in self.notebooks)

    @property
    def damaged(self) -> bool:
        """Whether something of it may be lost."""
        return any(notebook.damaged or not notebook.readable for notebook in self.notebooks)

    @property
    def notes(self) -> tuple[str, ...]:
        """What is to be said of the files; with their names where there are several."""
        many = len(self.notebooks) > 1
        about = (f"{n.name}: {note}" if many else note for n in self.notebooks for note in n.notes)
        return (*self.remarks, *about)

    def holding(self, name: str) -> tuple[Notebook, ...]:
        """Return the notebooks that seem to define `name`."""
        return tuple(n for n in self.notebooks if name in n.defines)


def read_class(place: Path) -> list[Submission]:
    """Read the submissions of a class, sorted by student.

    Parameters
    ----------
    place : path
        A folder with a notebook, a folder or a zip file a student; what Moodle or Canvas give out for
        grading, unpacked or the zip file as it is; nbgrader's folder ``submitted``, or the course's.

    Raises
    ------
    UsageError
        If there is nothing there, or nothing that was handed in.
    """
    if not place.exists():
        raise UsageError(
            f"{place} does not exist; give the folder or the zip file that holds the submissions"
        )
    if place.is_dir():
        return read_folder(place)
    try:
        with zip_file(place) as entries:
            return _submissions(_unwrapped(entries, place.stem), place)
    except Unreadable as error:
        raise UsageError(f"{place} is a file, but no zip file: {error}; {_GIVE}") from None


def read_folder(folder: Path) -> list[Submission]:
    """Read the submissions in a folder, as `read_class` does."""
    if not folder.is_dir():
        seen = "is a file" if folder.exists() else "does not exist"
        raise UsageError(f"{folder} {seen}; {_GIVE}")
    submitted = folder / "submitted"
    if submitted.is_dir() and any((folder / name).exists() for name in _NBGRADER):
        folder = submitted
    return _submissions(list(folder_entries(folder)), folder)


def _unwrapped(entries: list[Entry], stem: str) -> list[Entry]:
    """Take away the folder that a class was packed in, if it is called like the zip file."""
    tops = {entry.parts[0] for entry in entries}
    files = any(len(entry.parts) == 1 and not entry.folder for entry in entries)
    if len(tops) != 1 or files or not tops <= {stem, "submitted"}:
        return entries
    return [replace(entry, parts=entry.parts[1:]) for entry in entries if len(entry.parts) > 1]


def _submissions(entries: list[Entry], place: Path) -> list[Submission]:
    owned: dict[Owner, list[Claim]] = {}
    for claim in claims(entries):
        owned.setdefault(claim.owner, []).append(claim)
    if not owned:
        raise UsageError(
            f"{place} holds no submissions; put a notebook a student into it, or a folder a student"
        )
    names = _names(list(owned))
    found = [_submission(names[owner], owner, own) for owner, own in owned.items()]
    return sorted(found, key=lambda submission: submission.student)


def _names(owners: list[Owner]) -> dict[Owner, str]:
    """Give each student a name of his or her own: with the platform's number where two have one name."""
    often = Counter(owner.name for owner in owners)
    names: dict[str, Owner] = {}
    for owner in owners:
        name = owner.name
        if often[name] > 1:
            name += f" ({owner.id or owner.platform or 'folder'})"
        while name in names:
            name += "*"
        names[name] = owner
    return {owner: name for name, owner in names.items()}


def _submission(student: str, owner: Owner, own: list[Claim]) -> Submission:
    remarks = ["handed in late, says the platform"] if any(claim.late for claim in own) else []
    roots = sorted({claim.root for claim in own})
    if len(roots) > 1:
        remarks.append(f"taken for one student's, and graded together: {', '.join(roots)}")
    files = [claim for claim in own if not claim.entry.folder]
    files.sort(key=lambda claim: (claim.order, _order(claim.entry)))
    budget = Budget()
    read = [n for claim in files for n in _notebooks(claim.entry, budget, 0)]
    if not read:
        others = ", ".join(sorted({claim.entry.name for claim in files})[:5])
        note = f"there is no notebook, but {others}" if others else "the folder holds no notebook"
        read = [unreadable("", note)]
    return Submission(student, tuple(_once(read)), owner, tuple(remarks), _timestamp(files))


def _order(entry: Entry) -> tuple[object, ...]:
    """Sort by place; of files that differ in a number at the end only, the highest comes last."""
    path = Path(entry.name)
    match = _COUNTED.fullmatch(path.stem)
    base, count = (match[1], int(match[2] or match[3] or 0)) if match else (path.stem, 0)
    return entry.parts[:-1], base, count, path.suffix


def _notebooks(entry: Entry, budget: Budget, depth: int) -> Iterator[Notebook]:
    """Read a file, or the files in a zip file."""
    name = "/".join(entry.parts)
    if entry.suffix in SUFFIXES:
        yield notebook(name, entry.read)
    elif entry.suffix == ".zip":
        try:
            if depth > MAX_DEPTH:
                raise Unreadable("it lies in too many other zip files")
            inner = unzip(entry.read(), budget)
        except Unreadable as error:
            yield unreadable(name, f"the zip file cannot be read: {error}")
            return
        if sum(claim.owner.platform != "" for claim in claims(inner)) > 1:
            yield unreadable(
                name, "it looks like the zip file of a whole class: give that file itself, alone"
            )
        inner = [replace(each, parts=(*entry.parts, *each.parts)) for each in inner if not each.folder]
        found = [n for each in sorted(inner, key=_order) for n in _notebooks(each, budget, depth + 1)]
        yield from found or [unreadable(name, "the zip file holds no notebook")]
    elif entry.suffix in ARCHIVES:
        yield unreadable(name, "it is not opened; ask for the notebook itself, or a zip file")


def _once(read: Sequence[Notebook]) -> Iterator[Notebook]:
    """Of files of one name and place keep the last, as unpacking would; show short names if they differ."""
    last = {each.name: each for each in read}
    places = Counter(each.name for each in read)
    short = Counter(name.rsplit("/", 1)[-1] for name in last)
    for name, each in last.items():
        notes = (
            (f"there are {places[name]} files of this name; the last one counts",) if places[name] > 1 else ()
        )
        plain = name.rsplit("/", 1)[-1]
        yield replace(each, name=plain if short[plain] == 1 else name, notes=(*notes, *each.notes))


def _timestamp(files: Sequence[Claim]) -> str:
    """Return what nbgrader wrote into timestamp.txt when it collected the work."""
    stamps = [claim.entry for claim in files if claim.entry.name == "timestamp.txt"]
    try:
        text = stamps[-1].read().decode("ascii", "replace").strip() if stamps else ""
    except Unreadable:
        return ""
    return text if _TIMESTAMP.fullmatch(text) else ""
