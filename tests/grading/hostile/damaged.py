"""Notebooks that something has damaged, and what can still be read of them."""

import json
from collections.abc import Callable
from dataclasses import dataclass

TWICE = "def twice(x):\n    ran()\n    return 2 * x\n"
WRONG = "def twice(x):\n    ran()\n    return 3 * x\n"
PLUS_ONE = "def plus_one(x):\n    return x + 1\n"

PASSED, LOST = ("passed", "passed"), ("not attempted", "not attempted")


@dataclass(frozen=True)
class Damage:
    """What happened to a file; the outcomes of `twice` and `plus_one`, the status, and a word of the notes."""

    what: str
    make: Callable[[str], bytes]
    outcomes: tuple[str, str] = PASSED
    status: str = "graded"
    note: str = ""
    file: str = "ada.ipynb"

    @property
    def id(self):
        return self.what.replace(" ", "-")


def code(source, **fields):
    return {
        "cell_type": "code",
        "source": source,
        "metadata": {},
        "outputs": [],
        "execution_count": None,
    } | fields


def text(source):
    return {"cell_type": "markdown", "source": source, "metadata": {}}


def document(*cells, **fields):
    return {"cells": list(cells), "metadata": {}, "nbformat": 4, "nbformat_minor": 5} | fields


def cells(*made, **fields):
    """Return what makes a file of these cells, after one with the tools."""
    return lambda tools: json.dumps(document(code(tools), *made, **fields), ensure_ascii=False).encode()


def changed(change, *made):
    """Return what makes a file whose bytes `change` has changed."""
    whole = cells(*(made or (code(TWICE), code(PLUS_ONE))))
    return lambda tools: change(whole(tools))


def without(*keys):
    return lambda tools: json.dumps(
        {
            "cells": [
                {k: v for k, v in c.items() if k not in keys} for c in map(code, (tools, TWICE, PLUS_ONE))
            ]
        }
    ).encode()


def format_3(tools):
    sheet = [
        {"cell_type": "code", "input": s, "language": "python", "outputs": []}
        for s in (tools, TWICE, PLUS_ONE)
    ]
    return json.dumps({"nbformat": 3, "nbformat_minor": 0, "worksheets": [{"cells": sheet}]}).encode()


def script(tools):
    return f"# %%\n{tools}\n# %%\n{TWICE}\n# In[3]:\n{PLUS_ONE}".encode()


PASS = {"output_type": "stream", "name": "stdout", "text": ["passed: 2 of 2 points\n"]}
STALE = {
    "output_type": "display_data",
    "metadata": {"gpcourse": {"points": 2}},
    "data": {"text/html": "<b>passed</b>"},
}

DAMAGED = [
    Damage("a cell copied", cells(code(TWICE), code(PLUS_ONE), code(TWICE), code(PLUS_ONE))),
    Damage("a cell deleted", cells(code(TWICE)), ("passed", "not attempted")),
    Damage("cells in reverse order", cells(code("y = twice(3)"), code(PLUS_ONE), code(TWICE))),
    Damage("a cell made text", cells(text(TWICE), code(PLUS_ONE)), ("not attempted", "passed"), note="twice stands in cell 2"),
    Damage("a cell made raw", cells(code(TWICE, cell_type="raw"), code(PLUS_ONE)), ("not attempted", "passed"), note="twice"),
    Damage("metadata stripped", without("metadata")),
    Damage("all but type and source stripped", without("metadata", "outputs", "execution_count")),
    Damage("ids missing from new cells", cells(code(TWICE, id="a"), code(PLUS_ONE))),
    Damage("ids repeated", cells(code(TWICE, id="a"), code(PLUS_ONE, id="a"))),
    Damage("ids of the wrong kind", cells(code(TWICE, id=[]), code(PLUS_ONE, id=None))),
    Damage("format 3", format_3),
    Damage("format 4 point 0", cells(code(TWICE), code(PLUS_ONE), nbformat_minor=0)),
    Damage("a format of the future", cells(code(TWICE), code(PLUS_ONE), nbformat=9, nbformat_minor="x")),
    Damage("an unknown kernel", cells(code(TWICE), code(PLUS_ONE), metadata={"kernelspec": {"name": "julia-1.9"}})),
    Damage("a byte-order mark", changed(lambda raw: b"\xef\xbb\xbf" + raw)),
    Damage("Latin-1", changed(lambda raw: raw.decode().encode("latin-1"), code(TWICE + "# Größe"), code(PLUS_ONE)), note="Latin-1"),
    Damage("UTF-16", changed(lambda raw: raw.decode().encode("utf-16"))),
    Damage("Windows line ends", changed(lambda raw: json.dumps(json.loads(raw), indent=1).replace("\n", "\r\n").encode())),
    Damage("sources as lines", cells(code(TWICE.splitlines(keepends=True)), code(PLUS_ONE.splitlines(keepends=True)))),
    Damage("cells that are none", cells(None, 3, "x", [], {}, code(TWICE), {"cell_type": "code"}, code(PLUS_ONE))),
    Damage("a file cut off", changed(lambda raw: raw[: raw.rindex(b"def plus_one") + 10]), ("passed", "not attempted"), note="damaged"),
    Damage("brackets missing at the end", changed(lambda raw: raw[: raw.rindex(b"]")]), note="damaged"),
    Damage("a conflict of git", changed(lambda raw: raw.replace(b'{"cell_type": "code", "source": "def plus', b'<<<<<<< HEAD\n{"cell_type": "code", "source": "def plus')), ("passed", "not attempted"), note="damaged"),
    Damage("an empty file", lambda tools: b"", LOST, "unreadable", "empty"),
    Damage("invalid JSON", lambda tools: b"{'cells': [}", LOST, "unreadable", "not a notebook"),
    Damage("JSON of another kind", lambda tools: b'{"name": "ada"}', LOST, "unreadable", "not a notebook"),
    Damage("a web page", lambda tools: b"<!doctype html><title>Sign in</title>", LOST, "unreadable", "not a notebook"),
    Damage("millions of lists", lambda tools: b'{"cells": [' + b"[]," * 3_000_000 + b"[]]}", LOST, "unreadable", "millions"),
    Damage("only stubs", cells(code("def twice(x):\n    raise NotImplementedError"), code("def plus_one(x):\n    ...")), LOST, "not attempted"),
    Damage("magics and shell lines", cells(code("%matplotlib inline\n!ls\n%%time"), code("%load_ext x\n" + TWICE), code("!pip install x\n" + PLUS_ONE))),
    Damage("a cell of another language", cells(code("%%bash\nexit 1"), code(TWICE), code(PLUS_ONE))),
    Damage("a syntax error in a cell", cells(code("def broken(:\n  pass"), code(TWICE), code(PLUS_ONE)), note="SyntaxError"),
    Damage("a syntax error in an exercise", cells(code(TWICE), code("def plus_one(x):\nreturn x + 1")), ("passed", "error"), note="cell 3"),
    Damage("a line of two million characters", cells(code(TWICE), code("data = '" + "x" * 2_000_000), code(PLUS_ONE)), note="SyntaxError"),
    Damage("data of three million characters", cells(code("data = '" + "ü" * 3_000_000 + "'"), code(TWICE + "assert data"), code(PLUS_ONE))),
    Damage("cells by the ten thousand", cells(*[code("x = 1")] * 10_000, code("def broken(:"), code(TWICE), code(PLUS_ONE)), note="SyntaxError"),
    Damage("expressions that are too deep", cells(code("x = " + "-" * 10**5 + "1"), code("x = a" + ".b" * 10**5), code("x = " + "lambda: " * 5000 + "1"), code(TWICE), code(PLUS_ONE)), note="cell 4"),
    Damage("definitions by the thousand", cells(*[code(WRONG)] * 2000, code(TWICE), code(PLUS_ONE))),
    Damage("a number of a million digits", cells(code("x = " + "9" * 10**6), code(TWICE), code(PLUS_ONE)), note="4300 digits"),
    Damage("a null byte", cells(code("x = 1\0"), code(TWICE), code(PLUS_ONE))),
    Damage("half a character", changed(lambda raw: raw.replace(b"HALF", b"\\ud83d"), code("x = 'HALF'"), code(TWICE + "'HALF'"), code(PLUS_ONE))),
    Damage("an exercise defined twice", cells(code(WRONG), code(TWICE), code(PLUS_ONE))),
    Damage("an exercise defined twice, wrong at last", cells(code(TWICE), code(WRONG), code(PLUS_ONE)), ("failed", "passed")),
    Damage("saved outputs that claim a pass", cells(code(WRONG, outputs=[PASS, STALE]), code(PLUS_ONE, outputs=[STALE])), ("failed", "passed")),
    Damage("metadata that claims a pass", cells(code(WRONG, metadata={"points": 2, "nbgrader": {"points": 2}}), code(PLUS_ONE), metadata={"score": 99}), ("failed", "passed")),
    Damage("helpers in cells of their own", cells(code("import numpy as np"), code("def half(x): return x / 2"), code(TWICE.replace("2 * x", "4 * half(x)")), code(PLUS_ONE.replace("x + 1", "np.add(x, 1)")))),
    Damage("a function renamed", cells(code(TWICE.replace("twice", "twice_")), code(PLUS_ONE)), ("not attempted", "passed")),
    Damage("a function in a class", cells(code("class A:\n    def twice(self, x): return 2 * x"), code(PLUS_ONE)), ("not attempted", "passed")),
    Damage("a script instead", script, file="ada.py"),
    Damage("a renamed file", cells(code(TWICE), code(PLUS_ONE)), file="Final (2) – Kopie.ipynb"),
    Damage("an ending in capitals", cells(code(TWICE), code(PLUS_ONE)), file="ada.IPYNB"),
]  # fmt: skip
