"""The functions of a notebook, seen from the grader: asked by name, they answer, whatever happens.

A process that crashed or had to be killed is replaced for the next question.
"""

from __future__ import annotations

import os
import re
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import Any

from gpcourse.errors import WireError
from gpcourse.sandbox import wire
from gpcourse.sandbox.call import Answer, Status, Trouble
from gpcourse.sandbox.confine import Limits, launch
from gpcourse.sandbox.line import Gone, Line

#: Seconds beyond its limit that a call gets to end by itself, before its process is killed.
GRACE = 2.0

_STATUSES: tuple[Status, ...] = ("returned", "raised", "timeout", "crashed", "out of memory")
_STATUS_OF: dict[str, Status] = {status: status for status in _STATUSES}


@dataclass(frozen=True)
class Survey:
    """What a notebook holds: the names it binds, those that are stubs, and what is wrong with cells.

    Of those that were asked for, `unsure` are the ones that may need more than what binds their names.
    """

    names: tuple[str, ...] = ()
    stubs: tuple[str, ...] = ()
    broken: tuple[Trouble, ...] = ()
    crash: Trouble | None = None
    unsure: tuple[str, ...] = ()


@dataclass(frozen=True)
class Ready:
    """What came of preparing one function. `status` is ``ready``, ``missing`` or an Answer's."""

    status: str
    trouble: Trouble | None = None
    notes: tuple[Trouble, ...] = ()


class Reply:
    """What came of one question: the frame as it was received, or `said` where none came.

    Nothing of the frame is read before `answer` is asked for.
    """

    def __init__(self, frame: bytes = b"", line: Line | None = None, *, said: Answer | None = None) -> None:
        self.frame = frame
        self._line = line
        self._said = said

    @property
    def digest(self) -> bytes:
        """A digest of all that can be known of the answer; empty where it may be another one next time."""
        if self._said is None:
            return blake2b(self.frame, digest_size=16).digest()
        if self._said.status != "raised":
            return b""
        return blake2b(repr(self._said).encode("utf-8", "replace"), digest_size=16).digest()

    @cached_property
    def answer(self) -> Answer:
        """The answer. Whatever came, it is one of plain values."""
        if self._said is not None:
            return self._said
        try:
            content = wire.unpack(self.frame)
        except WireError as error:
            return _unreadable(f"its answer could not be read: {error}")
        if not isinstance(content, dict):
            return _unreadable("it gave an answer that nobody had asked for")
        return answer_from(content, self._line)


def _unreadable(message: str) -> Answer:
    return Answer("crashed", trouble=Trouble(("Crash",), message))


def question(arguments: tuple[Any, ...], options: dict[str, Any]) -> bytes:
    """Write a question as the frame that is sent, or raise WireError."""
    return wire.pack((arguments, options))


@dataclass
class Worker:
    """The functions of one notebook, in another process. Use it in a ``with`` block.

    Parameters
    ----------
    cells : list of (int, str)
        The number and the source of each code cell.
    package : Path
        A folder made by `home.build`.
    limits : Limits
    start : callable
        ``start(package, limits)`` starts a process and returns its `Line`.

    Attributes
    ----------
    spent : float
        Seconds that were waited for answers, on the clock of this side: the other may say anything.
    """

    cells: list[tuple[int, str]]
    package: Path
    limits: Limits = field(default_factory=Limits)
    start: Callable[[Path, Limits], Line] = launch
    _line: Line | None = None
    _ready: dict[str, Ready] = field(default_factory=dict)
    _loaded: set[int] = field(default_factory=set)
    _needs: dict[str, set[int]] = field(default_factory=dict)
    _widened: set[str] = field(default_factory=set)
    _kept: dict[str, int] = field(default_factory=dict)
    spent: float = field(default=0.0, init=False)

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the process, if one is running."""
        if self._line is not None:
            self._line.close()
        self._line, self._ready, self._loaded = None, {}, set()

    def survey(self, wanted: Iterable[str] = ()) -> Survey:
        """Read the notebook without running anything of it.

        Of a process that takes the place of this one, the functions `wanted` get the cells that they need
        only. No code of the student's has run when these are found.
        """
        self.close()
        wanted = sorted(wanted)
        try:
            reply = self._load([number for number, _ in self.cells], wanted)
        except Gone as gone:
            self.close()
            return Survey(crash=self._trouble(gone))
        self._needs = _needs(wanted, reply.get("needs"))
        return Survey(
            _words(reply.get("names")),
            _words(reply.get("stubs")),
            _troubles(reply.get("broken"), self._line),
            unsure=_words(reply.get("unsure")),
        )

    def renew(self, name: str, *, most: bool = False) -> None:
        """Forget what the function `name` answered, and ask it in a new process from now on.

        There is run what it needs, or may need at `most`.
        """
        self.close()
        self._kept.pop(name, None)
        if most:
            self._widened.add(name)

    def prepare(self, name: str) -> Ready:
        """Run what the function `name` needs, once in each process."""
        try:
            return self._prepare(name)
        except Gone as gone:
            self.close()
            return Ready(gone.status, self._trouble(gone))

    def ask(self, name: str, arguments: tuple[Any, ...], options: dict[str, Any], limit: float) -> Answer:
        """Call ``name(*arguments, **options)`` for at most `limit` seconds of processor time.

        Raises
        ------
        WireError
            If the arguments cannot be sent: a fault of the caller.
        WorkerError
            If no process can be started.
        """
        (reply,) = self.ask_all(name, [question(arguments, options)], [True], limit)
        return reply.answer

    def ask_all(
        self, name: str, questions: Sequence[bytes], refusals: Sequence[bool], limit: float
    ) -> list[Reply]:
        """Put several questions to the function `name`, each for at most `limit` seconds of processor time.

        After one that it did not answer with a value the others are not asked; where the item of
        `refusals` is True they are, if it raised an exception, but for NotImplementedError. So there may be
        fewer replies than questions, but at least one.

        Parameters
        ----------
        questions : sequence of bytes
            Made by `question`.
        """
        if sys.platform == "win32":  # where a pipe that is full cannot be waited for
            questions, refusals = questions[:1], refusals[:1]
        replies: list[Reply] = []
        full: Reply | None = None
        start = time.monotonic()
        try:
            ready = self._prepare(name)
            if ready.status != "ready" or self._line is None:
                return [Reply(said=_refusal(name, ready))]
            wall, start = self.limits.wall(limit), time.monotonic()
            frames = self._line.replies(
                len(questions),
                limit + GRACE,
                wall + GRACE,
                questions=questions,
                do="call",
                name=name,
                refusals=list(refusals),
                limit=limit,
                wall=wall,
            )
            for frame in frames:
                if self._keeps(name, frame):
                    replies.append(Reply(frame, self._line))
                elif full is None:  # what still comes is read and dropped
                    full = Reply(said=_too_much(name, self.limits.answers))
        except Gone as gone:
            self.close()
            full = full or Reply(said=Answer(gone.status, trouble=self._trouble(gone)))
        finally:
            self.spent += time.monotonic() - start
        return replies if full is None else [*replies, full]

    def _keeps(self, name: str, frame: bytes) -> bool:
        self._kept[name] = self._kept.get(name, 0) + wire.weight(frame[: wire.HEAD.size])
        return self._kept[name] <= self.limits.answers

    def _load(self, numbers: Iterable[int], wanted: Sequence[str] = ()) -> dict[Any, Any]:
        """Let the process read these cells; start one where none is running."""
        if self._line is None:
            self._line = self.start(self.package, self.limits)
        seconds = self.limits.load + GRACE
        chosen = set(numbers) - self._loaded
        self._loaded |= chosen
        # As bytes: a cell may be longer than a string that can cross.
        texts = [(n, source.encode("utf-8", "replace")) for n, source in self.cells if n in chosen]
        cells = {
            "numbers": [n for n, _ in texts],
            "sizes": [len(text) for _, text in texts],
            "text": b"".join(text for _, text in texts),
        }
        return self._line.request("load", seconds, self.limits.wall(seconds), **cells, wanted=list(wanted))

    def _prepare(self, name: str) -> Ready:
        most = name in self._widened
        every = {number for number, _ in self.cells}
        needed = every if most else self._needs.get(name, every)
        if not needed <= self._loaded or self._line is None:
            self._load(needed)
        if name not in self._ready and self._line is not None:
            seconds = self.limits.load
            wall = self.limits.wall(seconds)
            reply = self._line.request(
                "prepare", seconds + GRACE, wall + GRACE, name=name, limit=seconds, wall=wall, most=most
            )
            status = str(reply.get("status"))[:20]
            status = status if status in ("ready", "missing", *_STATUSES) else "raised"
            trouble = _trouble(reply.get("trouble"), self._line)
            self._ready[name] = Ready(status, trouble, _troubles(reply.get("notes"), self._line))
        return self._ready[name]

    def _trouble(self, gone: Gone) -> Trouble:
        """Say where a process crashed, as far as its own last words tell."""
        found = re.search(r'File "<cell (\d{1,5})>", line (\d{1,6}) in (\w{1,100})', gone.place)
        kind = "Timeout" if gone.status == "timeout" else "Crash"
        if found is None:
            return Trouble((kind,), str(gone))
        cell, line = int(found[1]), int(found[2])
        source = dict(self.cells).get(cell, "").splitlines()[line - 1 : line]
        return Trouble((kind,), str(gone), found[3], line, "".join(source).strip(), f"cell {cell}")


def answer_from(reply: dict[Any, Any], line: Line | None = None) -> Answer:
    """Read an answer out of a reply. Whatever is in it, an `Answer` of plain values comes out."""
    status = reply.get("status")
    if status not in _STATUSES:
        return Answer("crashed", trouble=Trouble(("Crash",), "it gave an answer without a status"))
    seconds = reply.get("seconds")
    return Answer(
        status,
        reply.get("value") if status == "returned" else None,
        _trouble(reply.get("trouble"), line),
        _words(reply.get("changed")),
        seconds if isinstance(seconds, float) and seconds >= 0 else 0.0,
    )


def _needs(wanted: Sequence[str], value: object) -> dict[str, set[int]]:
    """Read which cells each name needs; one of which this is not said gets all."""
    lists = value if isinstance(value, list) and len(value) == len(wanted) else []
    return {
        name: {number for number in numbers if isinstance(number, int)}
        for name, numbers in zip(wanted, lists, strict=False)
        if isinstance(numbers, list)
    }


def _too_much(name: str, limit: int) -> Answer:
    """The answer of a function whose answers together would fill the grader's memory."""
    message = f"the results of {name} are too large: together more than {limit // 2**20} MB"
    return Answer("raised", trouble=Trouble(("ResultError",), message))


def _refusal(name: str, ready: Ready) -> Answer:
    """The answer for a function that is not there. Its error happened before anything was asked."""
    trouble = ready.trouble or Trouble(("NameError",), f"there is no function {name}")
    # Without its bases: an error of the cell must not pass for one that the function raised on its input.
    first = "NotDefined" if "ValueError" in trouble.types[:1] else trouble.types[0]
    trouble = Trouble(
        (first,), trouble.message, trouble.function, trouble.line, trouble.source, trouble.place
    )
    return Answer(_STATUS_OF.get(ready.status, "raised"), trouble=trouble)


def _trouble(value: object, line: Line | None) -> Trouble | None:
    if not isinstance(value, tuple) or len(value) != 6:
        return None
    types, message, function, number, source, place = value
    return Trouble(
        _words(types) or ("Exception",),
        _clean(message, line, 2000),
        _clean(function, line, 100),
        number if isinstance(number, int) and 0 <= number < 10**7 else 0,
        _clean(source, line, 200),
        _clean(place, line, 100),
    )


def _troubles(value: object, line: Line | None) -> tuple[Trouble, ...]:
    items = value[:50] if isinstance(value, (list, tuple)) else ()
    return tuple(trouble for item in items if (trouble := _trouble(item, line)) is not None)


def _words(value: object) -> tuple[str, ...]:
    items: Iterable[object] = value[:2000] if isinstance(value, (list, tuple)) else ()
    return tuple(_clean(item, None, 100) for item in items if isinstance(item, str))


def _clean(value: object, line: Line | None, limit: int) -> str:
    """Make text of a student's fit for a report: short, printable, the same in each run."""
    text = value if isinstance(value, str) else ""
    if line is not None:
        text = text.replace(f"{line.scratch}{os.sep}", "").replace(str(line.scratch), ".")
    text = re.sub(r" at 0x[0-9a-fA-F]+", "", text[: 4 * limit])
    text = re.sub(r"\x1b\[[0-9;]*[A-Za-z]", "", text)
    text = "".join(c if c.isprintable() or c in "\n\t" else "�" for c in text)
    return text if len(text) <= limit else text[: limit - 2] + " …"
