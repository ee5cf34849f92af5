"""The child: holds a notebook's functions and answers calls with values.

It knows of no exercise, check, seed or solution. Its requests and replies are the frames of `wire`, on pipes
that were its standard input and output; student code finds nothing but the null device there. The requests:

- ``load`` (numbers, sizes, text, wanted): read cells; which functions there are, which are stubs, which cells
  are broken, which cells each of the `wanted` names needs, and which of them may need more than that;
- ``prepare`` (name, limit, wall, most): run what that function needs, or may need at most (see `effects`), in
  a namespace of its own;
- ``call`` (name, refusals, limit, wall), and after it a frame (arguments, options) for each of `refusals`:
  call it so many times, one reply a call. After a call that did not return, the others are skipped; where the
  item of `refusals` is True they are not, if the call raised an exception.

`limit` is in seconds of processor time for a call, `wall` in seconds on the clock. Before a reply's frame
stand the number of the request, that of the call, and whether another reply follows (`REPLY`).
"""

from __future__ import annotations

import builtins
import contextlib
import faulthandler
import itertools
import os
import random
import struct
import sys
from collections.abc import Callable
from dataclasses import asdict, astuple, dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any, BinaryIO

import numpy as np

from gpcourse.errors import WireError
from gpcourse.sandbox import wire
from gpcourse.sandbox.call import LONGEST_NAME, Answer, Trouble, call, describe
from gpcourse.sandbox.deadline import TimeLimit, deadline
from gpcourse.sandbox.effects import Effects
from gpcourse.sandbox.landlock import Grant
from gpcourse.sandbox.lockdown import lock, readings
from gpcourse.sandbox.program import Program, Statement

#: Where the place of a crash is written, in the working folder.
CRASH_FILE = "crash.txt"

#: What stands before the frame of a reply.
REPLY = struct.Struct("<QI?")
#: The most names and notes that are handed over.
_MOST_NAMES, _MOST_NOTES = 10_000, 50

Message = dict[str, Any]


@dataclass
class Room:
    """A namespace with what one function needs, and what went wrong while it was filled."""

    module: ModuleType
    status: str = "ready"
    trouble: Trouble | None = None
    notes: list[tuple[Any, ...]] = field(default_factory=list)


class Notebook:
    """The functions of a notebook. Each has a namespace of its own, so that none can spoil another's."""

    def __init__(self) -> None:
        self.program = Program()
        self.effects = Effects(self.program)
        self.rooms: dict[str, Room] = {}

    def load(self, numbers: list[int], sizes: list[int], text: bytes, wanted: list[str]) -> Message:
        """Read cells too, whose texts follow each other in UTF-8; nothing of them is run."""
        ends = itertools.accumulate(sizes)
        cells = (
            (n, text[end - size : end].decode()) for n, size, end in zip(numbers, sizes, ends, strict=True)
        )
        self.program.add(cells)
        self.effects = Effects(self.program)
        names = sorted(name for name in self.program.binders if len(name) <= LONGEST_NAME)[:_MOST_NAMES]
        return {
            "names": names,
            "stubs": [name for name in names if self.program.is_stub(name)],
            "broken": [astuple(trouble) for _, trouble, _ in self.program.broken[:_MOST_NOTES]],
            "needs": [self.program.cells_for(name) for name in wanted],
            "unsure": [name for name in wanted if self._may_need_more(name)],
        }

    def _may_need_more(self, name: str) -> bool:
        return len(self.effects.needed_at_most(name)) > len(self.program.needed(name))

    def prepare(self, name: str, limit: float, wall: float, *, most: bool = False) -> Message:
        """Run what `name` needs, or may need at `most`.

        The status is ``ready``, ``missing`` or that of an `Answer`.
        """
        room = self.rooms[name] = Room(_module())
        try:
            with deadline(limit, wall):
                self._run_all(name, room, most=most)
        except TimeLimit as error:
            room.status, room.trouble = "timeout", describe(error)
        if room.status == "ready" and not callable(vars(room.module).get(name)):
            room.trouble = room.trouble or self.program.loss(name)
            room.status = "missing" if room.trouble is None else "raised"
        notes = room.notes[:_MOST_NOTES]
        return {"status": room.status, "trouble": _plain(room.trouble), "notes": notes}

    def _run_all(self, name: str, room: Room, *, most: bool) -> None:
        """Run what `name` needs, in order. A name that is only called keeps its last function.

        Where the student tried it, right below the definition, no demonstration had taken the name yet.
        """
        functions: dict[str, Any] = {}
        namespace = vars(room.module)
        for statement in self.effects.needed_at_most(name) if most else self.program.needed(name):
            self._run(statement, room, name)
            functions |= {n: namespace[n] for n in statement.binds if callable(namespace.get(n))}
        for each in self.program.called(name) & functions.keys():
            if not callable(namespace.get(each)):
                namespace[each] = functions[each]

    def _run(self, statement: Statement, room: Room, name: str) -> None:
        try:
            exec(statement.compile(self.program.flags), vars(room.module))
        except TimeLimit:
            raise
        except BaseException as error:  # noqa: BLE001  # a student's statement may raise anything
            trouble = describe(error)
            place = trouble.place or f"cell {statement.cell}"
            line = trouble.line or statement.node.lineno
            trouble = Trouble(trouble.types, trouble.message, trouble.function, line, trouble.source, place)
            room.notes.append(astuple(trouble))
            if name in statement.binds:
                room.trouble = trouble

    def call(
        self, name: str, arguments: tuple[Any, ...], options: dict[str, Any], limit: float, wall: float
    ) -> Answer:
        """Call the function `name`; random generators start from the same state at each call."""
        if name not in self.rooms:
            self.prepare(name, limit, wall)
        room = self.rooms[name]
        if room.status != "ready":
            return Answer("raised", trouble=room.trouble or Trouble(("NameError",), f"there is no {name}"))
        sys.modules["__main__"] = room.module
        random.seed(0)
        np.random.seed(0)  # noqa: NPY002  # it is the legacy generator that a student may use unseeded
        try:
            return call(vars(room.module)[name], arguments, limit, wall, options=options)
        except KeyboardInterrupt as error:  # raised by the student's code: no terminal reaches this process
            return Answer("raised", trouble=describe(error))


def _module() -> ModuleType:
    module = ModuleType("__main__")
    vars(module).update(__builtins__=builtins, display=lambda *objects, **options: None)
    sys.modules["__main__"] = module  # where dataclasses look for their annotations
    return module


def reply(answer: Answer, limit: float, wall: float) -> bytes:
    """Write an answer as a frame. A value that cannot be written becomes an exception of the student's."""
    try:
        with deadline(max(limit, 1.0), wall):  # writing runs code of theirs: __array__, __len__, __getitem__
            return wire.pack(_message(answer), lenient=True)
    except WireError as error:
        trouble = Trouble(("ResultError",), f"the result cannot be read: {error}")
        answer = Answer("raised", trouble=trouble, seconds=answer.seconds)
    except TimeLimit as error:
        answer = Answer("timeout", trouble=describe(error))
    except MemoryError as error:
        answer = Answer("out of memory", trouble=describe(error))
    except BaseException as error:  # noqa: BLE001  # see above
        answer = Answer("raised", trouble=describe(error))
    return wire.pack(_message(answer), lenient=True)


def _message(answer: Answer) -> Message:
    # Without the time it took: two that answer the same send the same bytes.
    return {
        "status": answer.status,
        "value": answer.value,
        "trouble": _plain(answer.trouble),
        "changed": answer.changed,
    }


def _plain(trouble: Trouble | None) -> tuple[Any, ...] | None:
    return None if trouble is None else astuple(trouble)


def serve(read: Callable[[int], bytes], write: Callable[[bytes], Any]) -> None:
    """Answer requests until there are no more."""
    notebook = Notebook()
    while True:
        try:
            request = wire.receive(read)
        except EOFError:
            return
        number = request.pop("number")
        match request.pop("do"):
            case "call":
                _call_all(notebook, read, write, number, **request)
            case "prepare":
                write(REPLY.pack(number, 0, False) + wire.pack(notebook.prepare(**request)))
            case "load":
                write(REPLY.pack(number, 0, False) + wire.pack(notebook.load(**request)))


def _call_all(
    notebook: Notebook,
    read: Callable[[int], bytes],
    write: Callable[[bytes], Any],
    number: int,
    *,
    name: str,
    refusals: list[bool],
    limit: float,
    wall: float,
) -> None:
    more = True
    for i, may_raise in enumerate(refusals):
        arguments, options = wire.receive(read, functions=True)
        if not more:
            continue
        answer = notebook.call(name, arguments, options, limit, wall)
        frame = reply(answer, limit, wall)
        more = i + 1 < len(refusals) and _goes_on(answer, may_raise)
        write(REPLY.pack(number, i, more) + frame)


def _goes_on(answer: Answer, may_raise: bool) -> bool:
    if answer.status == "raised" and may_raise:  # a stub is asked nothing more
        return answer.trouble is not None and "NotImplementedError" not in answer.trouble.types
    return answer.status == "returned"


def limit_resources(limits: dict[str, int]) -> None:
    """Set the limits that the system has: `resource` names to values."""
    try:
        import resource
    except ImportError:  # Windows has none
        return
    for name, value in limits.items():
        kind = getattr(resource, name, None)
        if kind is not None:
            hard = resource.getrlimit(kind)[1]
            most = value if hard == resource.RLIM_INFINITY else min(value, hard)
            with contextlib.suppress(ValueError, OSError):  # macOS refuses some of them
                resource.setrlimit(kind, (most, most))


def private_pipes() -> tuple[BinaryIO, BinaryIO]:
    """Move standard input and output to pipes that only this module knows, and put the null device there."""
    source, sink = os.dup(0), os.dup(1)
    null = os.open(os.devnull, os.O_RDWR)
    for standard in (0, 1, 2):
        os.dup2(null, standard)
    os.close(null)
    if sys.platform == "win32":
        import msvcrt

        for pipe in (source, sink):
            msvcrt.setmode(pipe, os.O_BINARY)
    return os.fdopen(source, "rb"), os.fdopen(sink, "wb", buffering=0)


@dataclass(frozen=True)
class Birth:
    """What a process knows that `parent` has forked.

    `last_words` is the descriptor of a file for them; `readable` what may be read; `namespaces` what kept the
    parent from entering them, if anything.
    """

    last_words: int
    readable: list[Grant]
    namespaces: tuple[str, ...]


def main(limits: dict[str, int], package: str, course: str, birth: Birth | None = None) -> None:
    """Serve on the standard pipes, within `limits`, confined; the first frame says how far.

    `package` is the folder that gpcourse is imported from here, `course` the one with the solutions.
    """
    source, sink = private_pipes()
    sys.argv[:] = [""]
    # Open until the end, which may come any time.
    last = Path(CRASH_FILE).open("w") if birth is None else os.fdopen(birth.last_words, "w")  # noqa: SIM115
    faulthandler.enable(last)
    limit_resources(limits)
    readable = readings(Path(package), Path(course)) if birth is None else birth.readable
    namespaces = None if birth is None else birth.namespaces
    confinement = lock(Path.cwd(), Path(package), readable, namespaces)

    def write(frame: bytes) -> None:
        rest = memoryview(frame)
        while rest:
            rest = rest[sink.write(rest) :]

    write(wire.pack(asdict(confinement)))
    serve(source.read, write)
    os._exit(0)  # threads and exit handlers of the student's do not keep it
