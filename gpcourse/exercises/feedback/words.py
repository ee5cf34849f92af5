"""Making text from a student safe to show, and writing calls so that they can be run again."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from gpcourse.geometry.halfedge_mesh import HalfedgeMesh

#: A call is written out with arguments of at most this many characters; longer ones go by their names.
_WRITTEN = 90
_WRITTEN_TEXT = 200

_TERMINAL_CODES = re.compile(
    r"\x1b\[[0-?]*[ -/]*[@-~]"  # colours and cursor moves
    r"|\x1b\][^\x07\x1b]*(?:\x07|\x1b\\)?"  # window titles and links
    r"|\x1b."
)
#: Control characters, and the marks that turn the reading direction of what follows.
_UNPRINTABLE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")

#: A place in the grader's file system: quoted, so that it may hold spaces, or of at least two parts.
_QUOTED_PATH = re.compile(r"""(['"])(?:[A-Za-z]:)?[/\\](?:[^'"\n]*[/\\])?([^'"/\\\n]*)\1""")
_PATH = re.compile(r"(?<![\w.:/\\<~-])(?:[A-Za-z]:)?[/\\](?:[^\s/\\'\"<>:;,()]+[/\\]+)+([^\s/\\'\"<>:;,()]*)")


def without_paths(text: str) -> str:
    """Leave of every absolute path the name of its file: a grader's folders are nobody's business."""
    return _PATH.sub(r"\1", _QUOTED_PATH.sub(r"\1\2\1", text))


def clean(text: object, limit: int = 600) -> str:
    """Return `text` without terminal codes and control characters, and at most `limit` characters long."""
    words = str(text)[: 20 * limit].encode("utf-8", "replace").decode("utf-8")
    words = _UNPRINTABLE.sub("", _TERMINAL_CODES.sub("", words.replace("\r\n", "\n"))).strip()
    return words if len(words) <= limit else words[: limit - 2].rstrip() + " …"


def sentence(text: str) -> str:
    """Begin with a capital letter, unless it is a name, as in "t, worst at …", and end with a full stop."""
    begin = text[:1] if re.match(r"[b-zA-Z]\W", text) else text[:1].upper()
    return begin + text[1:] + ("" if not text or text[-1] in ".?!…:`" else ".")


def written_call(
    name: str, parameters: Sequence[str], arguments: Sequence[Any], options: Mapping[str, Any] | None = None
) -> tuple[str, list[str]]:
    """Write a call, and describe in words each argument that is too large to be written out."""
    parts, legend = [], []
    by_position = [
        (parameters[i] if i < len(parameters) else f"argument_{i + 1}", "", argument)
        for i, argument in enumerate(arguments)
    ]
    by_name = [(option, f"{option}=", value) for option, value in (options or {}).items()]
    for parameter, before, argument in by_position + by_name:
        code = _code(argument)
        if code is None:
            legend.append(f"{parameter}: {_described(argument)}")
            code = parameter
        parts.append(before + code)
    return f"{name}({', '.join(parts)})", legend


def _code(value: Any) -> str | None:
    """Return an expression for `value`, or None where it would be long or is none."""
    plain = _plain(value)
    if isinstance(value, np.ndarray):
        text = f"np.array({plain!r})" if value.size <= 32 and np.isfinite(value).all() else ""
    elif isinstance(plain, (type(None), bool, int, float, str, list, tuple, dict)):
        text = repr(plain)
    else:
        text = ""
    if "Ellipsis" in text and not isinstance(value, str):  # an array in a list, which is too large
        return None
    limit = _WRITTEN_TEXT if isinstance(value, str) else _WRITTEN
    return text if 0 < len(text) <= limit and "<" not in _outside_strings(plain, text) else None


def _outside_strings(plain: Any, text: str) -> str:
    """Where an object is written as ``<...>`` the text is no expression; inside a string it is harmless."""
    return "" if isinstance(plain, str) else text


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist() if value.size <= 32 else ...
    if isinstance(value, (list, tuple)):
        return type(value)(_plain(item) for item in value) if type(value) in (list, tuple) else value
    return value


def _described(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape}, {value.dtype}"
    if isinstance(value, HalfedgeMesh):
        return repr(value).strip("<>").replace("HalfedgeMesh: ", "a HalfedgeMesh of ")
    if isinstance(value, str):
        lines = value.count("\n") + 1
        return f"a text of {lines} lines, beginning with {clean(value, 1000)[:40]!r}"
    if isinstance(value, (list, tuple)):
        kind = "list" if isinstance(value, list) else "tuple"
        if not value:
            return f"an empty {kind}"
        first = _plain(value[0])
        words = _described(value[0]) if first is ... else clean(first, 40)
        return f"a {kind} of {len(value)}, beginning with {words}"
    of = f" of shape {value.shape}" if hasattr(value, "shape") else ""  # as a sparse matrix
    return f"a {type(value).__name__}{of}"
