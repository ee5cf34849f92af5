"""Exercises on OFF files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from gpcourse.errors import OffFormatError
from gpcourse.exercises import expect
from gpcourse.exercises.exercise import Exercise
from gpcourse.exercises.halfedge.inputs import FaceLists, Rng, face_lists
from gpcourse.exercises.judging import Asked
from gpcourse.geometry import shapes
from gpcourse.geometry.arrays import FloatArray
from gpcourse.reference import halfedge as reference

MeshData = tuple[FloatArray, FaceLists]


def _as_lists(arguments: tuple[Any, ...], value: Any) -> list[Any]:
    vertices, faces = value
    return [np.asarray(vertices, dtype=float), [[int(v) for v in face] for face in faces]]


READ_OFF = Exercise(
    reference.read_off,
    notes="appendix, OFF",
    hints=[
        "Which lines of the file say something, once comments and blank lines are gone? Number them first.",
        "The header may carry the counts in its own line. What is left of that line after the word OFF?",
        "A face line says how many indices follow. What may stand after them?",
        "Reading past the end of a list raises IndexError. Ask before each line whether there is one.",
    ],
    canonical=_as_lists,
)


def _mesh(rng: Rng) -> MeshData:
    """Draw a small mesh of polygons of several sizes, with numbers that no short decimal can write."""
    shape = shapes.shuffled(shapes.prism(int(rng.integers(5, 8))), rng)
    scale = 10.0 ** rng.integers(-3, 4)
    return shape.vertices * scale + rng.normal(size=3), face_lists(shape)


def _write(
    data: MeshData, header: str = "OFF\n{n} {m} 0\n", vertex: str = "{xyz}", face: str = "{size} {indices}"
) -> str:
    """Write OFF with templates for the header, each vertex line and each face line."""
    vertices, faces = data
    lines = [vertex.format(xyz=" ".join(map(repr, row))) for row in vertices.tolist()]
    lines += [face.format(size=len(f), indices=" ".join(map(str, f))) for f in faces]
    return header.format(n=len(vertices), m=len(faces)) + "\n".join(lines) + "\n"


def _expect_read(f: Asked, questions: Sequence[tuple[str, MeshData, str]]) -> None:
    answers = [f(text) for text, _, _ in questions]
    for answer, (_, data, on) in zip(f.each(answers), questions, strict=True):
        _judge_read(answer, data, on)


def _judge_read(value: Any, data: MeshData, on: str) -> None:
    expect.that(value is not None, "The result is None: is a `return` missing?", on=on)
    pair = isinstance(value, (tuple, list)) and len(value) == 2
    expect.that(pair, "The result should be a pair (vertices, faces).", yours=expect.brief(value), on=on)
    vertices = expect.array(value[0], (len(data[0]), 3), "The vertex array", on=on)
    faces = expect.polygons(value[1], len(vertices), on=on)
    # Reading text gives the nearest double, the very number that was written: no tolerance.
    expect.close(vertices, data[0], 0.0, "The vertex positions", on=on)
    for i, (mine, want) in enumerate(zip(faces, data[1], strict=False)):
        message = f"Face {i} is not the one in the file."
        expect.that(mine == want, message, yours=str(mine), truth=str(want), on=on)
    message = f"There are {len(faces)} faces, not as many as in the file."
    told = f"There are {len(faces)} faces; the file has {len(data[1])}."
    expect.that(len(faces) == len(data[1]), message, told=told, on=on)


@READ_OFF.check("reads a plain file of triangles, to the last bit")
def _(f: Asked, rng: Rng) -> None:
    shape = shapes.random_closed(rng, 12, genus=1)
    data = shape.vertices * rng.uniform(0.01, 100.0), face_lists(shape)
    _expect_read(f, [(_write(data), data, "a closed mesh of triangles")])


@READ_OFF.check("keeps polygons of any size")
def _(f: Asked, rng: Rng) -> None:
    data = _mesh(rng)
    _expect_read(f, [(_write(data), data, f"a prism over a polygon of {len(data[1][0])} sides or so")])


@READ_OFF.check("finds the counts on the first line too")
def _(f: Asked, rng: Rng) -> None:
    questions = []
    for header in ("OFF {n} {m} 0\n", "OFF{n} {m} 0\n"):
        data = _mesh(rng)
        text = _write(data, header)
        questions.append((text, data, f"a file that begins {text.splitlines()[0]!r}"))
    _expect_read(f, questions)


@READ_OFF.check("skips comments and blank lines anywhere")
def _(f: Asked, rng: Rng) -> None:
    data = _mesh(rng)
    header = "# 3 4 5\n\nOFF # a prism\n\n{n} {m} 0  # V F E\n\n"
    text = _write(data, header, "{xyz} # 7", "{size} {indices}\n# next\n")
    on = "a file with comments and blank lines between and behind the numbers"
    _expect_read(f, [(text, data, on)])


@READ_OFF.check("leaves out colours and the extra columns of COFF, NOFF and STOFF")
def _(f: Asked, rng: Rng) -> None:
    data = _mesh(rng)
    on = "a file with a colour behind each face"
    colours = ("255 0 0", "0.1 0.2 0.3 1")
    questions = [(_write(data, face="{size} {indices} " + colour), data, on) for colour in colours]
    for word, extra in (("COFF", " 255 128 0 255"), ("NOFF", " 0 0.6 0.8"), ("STOFF", " 0.25 0.75")):
        text = _write(data, word + "\n{n} {m} 0\n", "{xyz}" + extra)
        questions.append((text, data, f"a {word} file"))
    _expect_read(f, questions)


@READ_OFF.check("refuses a damaged file with a ValueError that has the line number", points=2)
def _(f: Asked, rng: Rng) -> None:
    lines = _write((rng.normal(size=(3, 3)), [[0, 1, 2]])).splitlines()
    damaged = [
        (4, "2.5 x 1", "line 4 holds a coordinate that is no number"),
        (5, "1 2", "line 5 gives two coordinates instead of three"),
        (6, "3 0 1 3", "line 6 names vertex 3 of a mesh with 3 vertices"),
        (6, "4 0 1 2", "line 6 announces four indices and gives three"),
        (6, "3 0 1 -1", "line 6 names vertex -1"),
        (2, "3 x 0", "line 2 holds a count that is no number"),
    ]
    for number, line, because in damaged:
        text = "\n".join([*lines[: number - 1], line, *lines[number:]]) + "\n"
        expect.refusal(f, text, because=because, naming=[[number]], on=expect.brief(text))
    short = "\n".join(lines[:4]) + "\n"
    because = "the file ends after line 4, two lines too early"
    expect.refusal(f, short, because=because, naming=[[4], [5]], on=expect.brief(short))


def _read_line_by_line(
    text: str,
    *,
    words: tuple[str, ...] = ("STOFF", "COFF", "NOFF", "OFF"),
    comments: bool = True,
    joined_header: bool = True,
    to_end_of_line: bool = False,
    corners: Callable[[int], int] = lambda size: size,
    first_index: int = 0,
) -> MeshData:
    """Read OFF one line after the other; the options switch a habit of students on or off."""
    lines = []
    for number, raw in enumerate(text.split("\n"), start=1):
        content = raw.split("#")[0] if comments else raw
        if content.strip():
            lines.append((number, content.split()))
    number, tokens = _take(lines, 0)
    word = next((w for w in words if tokens[0].startswith(w)), None)
    if word is None:
        raise OffFormatError(number, "the header is missing")
    rest = [tokens[0][len(word) :], *tokens[1:]]
    counts = [token for token in rest if token] if joined_header else []
    at = 1
    if not counts:
        number, counts = _take(lines, 1)
        at = 2
    n, m = (_number(int, token, number) for token in counts[:2])
    vertices = []
    for i in range(n):
        number, tokens = _take(lines, at + i)
        if len(tokens) < 3:
            raise OffFormatError(number, "three coordinates are needed")
        vertices.append([_number(float, token, number) for token in tokens[:3]])
    faces = []
    for i in range(m):
        number, tokens = _take(lines, at + n + i)
        size = corners(_number(int, tokens[0], number))
        chosen = tokens[1:] if to_end_of_line else tokens[1 : 1 + size]
        face = [_number(int, token, number) - first_index for token in chosen]
        if len(face) < size or not all(0 <= v < n for v in face):
            raise OffFormatError(number, "the face does not fit")
        faces.append(face)
    return np.array(vertices).reshape(n, 3), faces


def _take(lines: list[tuple[int, list[str]]], i: int) -> tuple[int, list[str]]:
    if i >= len(lines):
        raise OffFormatError(lines[-1][0] + 1 if lines else 1, "the file ends too early")
    return lines[i]


def _number(kind: Callable[[str], Any], token: str, line: int) -> Any:
    try:
        return kind(token)
    except ValueError:
        raise OffFormatError(line, f"{token} is no number") from None


@READ_OFF.variant("line by line, with lists")
def _(text: str) -> MeshData:
    return _read_line_by_line(text)


@READ_OFF.variant("the vertices as a list of lists")
def _(text: str) -> Any:
    vertices, faces = reference.read_off(text)
    return [vertices.tolist(), [tuple(face) for face in faces]]


@READ_OFF.mistake(
    "the counts were looked for on the second line only",
    hint="Some files run the counts on in the line of the header: `OFF 8 6 0`, even `OFF8 6 0`.",
)
def _(text: str) -> MeshData:
    return _read_line_by_line(text, joined_header=False)


@READ_OFF.mistake(
    "comments were read as data",
    hint="A `#` starts a comment anywhere, also behind numbers. What is left of a line that is all comment?",
)
def _(text: str) -> MeshData:
    return _read_line_by_line(text, comments=False)


@READ_OFF.mistake(
    "everything behind the size of a face was read as an index",
    hint="The first number of a face line says how many indices follow; a colour may stand behind them.",
)
def _(text: str) -> MeshData:
    return _read_line_by_line(text, to_end_of_line=True)


@READ_OFF.mistake(
    "every face was taken for a triangle",
    hint="The first number of a face line is the number of its corners. It need not be 3.",
)
def _(text: str) -> MeshData:
    return _read_line_by_line(text, corners=lambda size: 3)


@READ_OFF.mistake(
    "indices were counted from 1",
    hint="Which vertex does index 0 name in an OFF file?",
)
def _(text: str) -> MeshData:
    return _read_line_by_line(text, first_index=1)


@READ_OFF.mistake(
    "only the header OFF was expected",
    hint="COFF, NOFF and STOFF are OFF too, with more columns behind the coordinates.",
)
def _(text: str) -> MeshData:
    return _read_line_by_line(text, words=("OFF",))


@READ_OFF.mistake(
    "a damaged file was not refused",
    hint="What does your reader do when a line is missing, or names a vertex that is not there?",
)
def _(text: str) -> MeshData:
    try:
        return _as_pair(reference.read_off(text))
    except ValueError:
        return np.empty((0, 3)), []


def _as_pair(data: tuple[FloatArray, Any]) -> MeshData:
    return data[0], [[int(v) for v in face] for face in data[1]]


WRITE_OFF = Exercise(
    reference.write_off,
    notes="appendix, OFF",
    hints=[
        "Write down by hand the file of one triangle. What stands in each line?",
        "How many digits does a double need so that reading it back gives the same number?",
        "What does `repr` print for a Python float, and what for a numpy number? Try both.",
    ],
)


def _expect_written(f: Asked, data: MeshData, on: str) -> None:
    text = f(*data)
    expect.that(text is not None, "The result is None: is a `return` missing?", on=on)
    expect.that(isinstance(text, str), f"The result should be a text; it is a {type(text).__name__}.", on=on)
    try:
        vertices, faces = reference.read_off(text)
    except OffFormatError as error:
        raise expect.Wrong(
            f"The text is not an OFF file: {error}.", yours=expect.brief(text), on=on
        ) from None
    expect.that(
        len(vertices) == len(data[0]), f"The file has {len(vertices)} vertices, not {len(data[0])}.", on=on
    )
    expect.close(vertices, data[0], 0.0, "The positions that are read back", on=on)
    mine = [[int(v) for v in face] for face in faces]
    expect.that(len(mine) == len(data[1]), f"The file has {len(mine)} faces, not {len(data[1])}.", on=on)
    for i, (have, want) in enumerate(zip(mine, data[1], strict=True)):
        expect.that(have == want, f"Face {i} comes back changed.", yours=str(have), truth=str(want), on=on)


@WRITE_OFF.check("what is written can be read back: a mesh of triangles")
def _(f: Asked, rng: Rng) -> None:
    shape = shapes.random_closed(rng, 12, genus=1)
    # Whole numbers survive any format: this check is about the structure of the file.
    _expect_written(f, (np.round(10 * shape.vertices), face_lists(shape)), "triangles with whole coordinates")


@WRITE_OFF.check("polygons are kept")
def _(f: Asked, rng: Rng) -> None:
    vertices, faces = _mesh(rng)
    _expect_written(f, (np.round(vertices), faces), "a prism with whole coordinates")


@WRITE_OFF.check("positions come back to the last bit")
def _(f: Asked, rng: Rng) -> None:
    faces = [[0, 1, 2], [2, 1, 3]]
    for scale in (1.0, 1e-7, 1e9):
        _expect_written(f, (scale * rng.normal(size=(4, 3)), faces), f"two triangles of size {scale:g}")


def _write_with(
    number: Callable[[float], str], first_index: int = 0, sizes: bool = True
) -> Callable[..., str]:
    def write(vertices: FloatArray, faces: Any) -> str:
        lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
        lines += [" ".join(number(x) for x in row) for row in np.asarray(vertices)]
        for face in faces:
            indices = [str(int(v) + first_index) for v in face]
            lines.append(" ".join([str(len(indices)), *indices] if sizes else indices))
        return "\n".join(lines) + "\n"

    return write


WRITE_OFF.variant("17 digits")(_write_with(lambda x: f"{x:.17g}"))


@WRITE_OFF.variant("counts on the first line, comments, no newline at the end")
def _(vertices: FloatArray, faces: Any) -> str:
    text = _write(
        (np.asarray(vertices), [[int(v) for v in face] for face in faces]), "OFF {n} {m} 0 # V F E\n"
    )
    return text.rstrip("\n")


WRITE_OFF.mistake(
    "the coordinates were rounded",
    hint="A double has about 16 digits. Which of Python's formats keeps as many as are needed, and no more?",
)(_write_with(lambda x: f"{x:.6f}"))

WRITE_OFF.mistake(
    "numpy's own way of printing a number got into the file",
    hint="Print `repr` of one number of the array. Would a reader in C++ understand that?",
)(_write_with(lambda x: f"np.float64({float(x)!r})"))

WRITE_OFF.mistake(
    "indices were written from 1",
    hint="Which index does the first vertex have in an OFF file?",
)(_write_with(lambda x: repr(float(x)), first_index=1))

WRITE_OFF.mistake(
    "the number of corners is missing in front of each face",
    hint="How could a reader know where the indices of a face end, when a colour may follow?",
)(_write_with(lambda x: repr(float(x)), sizes=False))


@WRITE_OFF.mistake(
    "the two counts were swapped", hint="Which comes first in the second line, vertices or faces?"
)
def _(vertices: FloatArray, faces: Any) -> str:
    return _write((np.asarray(vertices), [[int(v) for v in face] for face in faces]), "OFF\n{m} {n} 0\n")
