"""One call of a student's function, and all that can come of it."""

from __future__ import annotations

import contextlib
import copy
import inspect
import linecache
import sys
import sysconfig
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

from gpcourse.sandbox.deadline import TimeLimit, deadline
from gpcourse.sandbox.values import same

Status = Literal["returned", "raised", "timeout", "crashed", "out of memory"]

#: The most characters that are kept of a student's text, and of a name. A message may hold a whole array.
LONGEST, LONGEST_NAME = 10_000, 200


@dataclass(frozen=True)
class Trouble:
    """An exception in student code, as text: no object of theirs is kept.

    Attributes
    ----------
    types : tuple of str
        The names of the exception's class and its bases, nearest first.
    message : str
        Its text.
    function, line, source : str, int, str
        Where in the *student's* code it happened: the function, the line within its
        cell or file (0 where unknown), and the text of that line.
    place : str
        The cell or file, in words; empty where unknown.
    """

    types: tuple[str, ...]
    message: str
    function: str = ""
    line: int = 0
    source: str = ""
    place: str = ""


@dataclass(frozen=True)
class Answer:
    """What came of one call.

    `value` is set when `status` is ``returned``; `trouble` when it is not, and known.
    `changed` names the inputs that the function changed in place.
    """

    status: Status
    value: Any = None
    trouble: Trouble | None = None
    changed: tuple[str, ...] = ()
    seconds: float = 0.0


def call(
    function: Callable[..., Any],
    arguments: Sequence[Any],
    limit: float,
    wall: float | None = None,
    *,
    options: Mapping[str, Any] | None = None,
    ours: bool = False,
) -> Answer:
    """Call `function` on copies of `arguments` and `options`, for at most `limit` seconds (see `deadline`).

    Whatever the function does, short of ending the process, becomes an `Answer`; only the
    user's own KeyboardInterrupt passes through. A function of `ours` leaves its arguments alone,
    which saves copying and comparing them.
    """
    asked = tuple(arguments), dict(options or {})
    given, named = asked if ours else copy.deepcopy(asked)
    status: Status = "returned"
    value, trouble = None, None
    start = time.perf_counter()
    try:
        with deadline(limit, wall):
            value = function(*given, **named)
    except KeyboardInterrupt:
        raise
    except TimeLimit as error:
        status, trouble = "timeout", describe(error)
    except MemoryError as error:
        status, trouble = "out of memory", describe(error)
    except BaseException as error:  # noqa: BLE001  # a student may raise anything, SystemExit included
        status, trouble = "raised", describe(error)
    seconds = time.perf_counter() - start
    changed = () if ours or status == "timeout" else _changed(function, asked, (given, named))
    return Answer(status, value, trouble, changed, seconds)


def describe(error: BaseException) -> Trouble:
    """Turn an exception into text, with the innermost line that is the student's own."""
    types = tuple(kind.__name__[:LONGEST_NAME] for kind in type(error).__mro__[:50] if kind is not object)
    try:
        message = str(error)[:LONGEST]
    except Exception:  # noqa: BLE001  # a student's __str__ may itself fail
        message = "(its text cannot be printed)"
    if isinstance(error, SyntaxError):
        text, place = (error.text or "").strip()[:LONGEST], (error.filename or "")[:LONGEST_NAME]
        return Trouble(types, message, "", error.lineno or 0, text, place)
    own = [f for f in traceback.extract_tb(error.__traceback__) if not _is_library(f.filename)]
    if not own:
        return Trouble(types, message)
    frame = own[-1]
    source = frame.line or linecache.getline(frame.filename, frame.lineno or 0).strip()
    name, place = frame.name[:LONGEST_NAME], _place(frame.filename)[:LONGEST_NAME]
    return Trouble(types, message, name, frame.lineno or 0, source[:LONGEST], place)


def _place(filename: str) -> str:
    number = _cell_number(filename)
    if number:
        return f"cell {number}"
    if filename.startswith("<"):
        return filename.strip("<>")
    return "" if "ipykernel" in filename else Path(filename).name


def _cell_number(filename: str) -> str:
    """Ask IPython, where it runs, which of a notebook's cells goes by this file name."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    label = shell.compile.format_code_name(filename) if shell is not None else None  # ("Cell", "In[7]")
    return "".join(filter(str.isdigit, label[1])) if label else ""


@cache
def _is_library(filename: str) -> bool:
    here = Path(__file__).resolve().parent.parent
    paths = sysconfig.get_paths()
    homes = [here, *(Path(paths[name]) for name in ("stdlib", "platstdlib", "purelib", "platlib"))]
    return any(filename.startswith(f"{home}/") or filename.startswith(f"{home}\\") for home in homes)


_Given = tuple[tuple[Any, ...], dict[str, Any]]


def _changed(function: Callable[..., Any], before: _Given, after: _Given) -> tuple[str, ...]:
    odd = [i for i, (old, new) in enumerate(zip(before[0], after[0], strict=True)) if not same(old, new)]
    names: list[str] = []
    if odd:
        with contextlib.suppress(TypeError, ValueError):  # a builtin, or a callable that hides its signature
            names = list(inspect.signature(function).parameters)
    by_position = (names[i] if i < len(names) else f"argument {i + 1}" for i in odd)
    return *by_position, *(name for name, old in before[1].items() if not same(old, after[1][name]))
