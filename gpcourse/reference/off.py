"""Reading and writing OFF, the file format of the course."""

from __future__ import annotations

import contextlib
import math
import re
from itertools import islice
from typing import TypeVar

import numpy as np

from gpcourse.errors import OffFormatError
from gpcourse.geometry.arrays import FloatArray, IntArray, Polygons, as_points, flatten_polygons

Number = TypeVar("Number", int, float)
#: The number of a line, from 1, and what stands in it.
Line = tuple[int, str]

# Letters in front of OFF announce columns behind the coordinates: texture, colour, normal.
_HEADER = re.compile(r"(ST)?C?N?(4?n?)OFF(.*)", re.DOTALL)


def read_off(text: str) -> tuple[FloatArray, IntArray | list[list[int]]]:
    """Read a mesh from the text of an OFF file.

    The first line is ``OFF``; the numbers of vertices, faces and edges follow, in the same line or in
    the next. Then comes a line for each vertex, with its coordinates, and a line for each face, with
    the number of its corners and their indices. ``#`` starts a comment anywhere. The number of edges is not
    used. What stands behind the coordinates (``COFF``, ``NOFF``, ``STOFF``), behind the indices (a
    colour), or after the last face is left out.

    Parameters
    ----------
    text : str
        The whole file.

    Returns
    -------
    vertices : (n, 3) float array
        Positions, any length unit.
    faces : (m, k) int array, or list of m index lists
        An array where all faces have k corners, else a list. Indices count from 0.

    Raises
    ------
    ValueError
        If the text is no OFF file of points in space; the message begins with the number of the line.

    References
    ----------
    Notes, appendix, *OFF*.
    """
    lines, end = _lines(text)
    counts, body = _header(lines, end)
    n, m = _counts(counts)
    if n + m > len(body):
        raise OffFormatError(
            end,
            f"the file ends after {len(body)} of {n} vertex and {m} face lines; "
            "add the missing lines or correct the counts",
        )
    return _vertices(body[:n]), _faces(body[n : n + m], n)


def _lines(text: object) -> tuple[list[Line], int]:
    """Return the lines that hold more than a comment, with their numbers, and the number of the last line."""
    if not isinstance(text, str):
        raise OffFormatError(1, f"this is a {type(text).__name__}; give the text of the file, a str")
    raw = text.split("\n")
    lines = [(number, line.partition("#")[0].strip()) for number, line in enumerate(raw, start=1)]
    return [(number, line) for number, line in lines if line], len(raw)


def _header(lines: list[Line], end: int) -> tuple[Line, list[Line]]:
    """Check the first line; return the counts, from this line or the next, and the lines that follow."""
    if not lines:
        raise OffFormatError(end, "the file is empty; it should begin with OFF")
    number, line = lines[0]
    match = _HEADER.fullmatch(line)
    if match is None:
        raise OffFormatError(
            number, f"the header {_short(line.split()[0])} is not OFF; the first line should be OFF"
        )
    rest = match[3].strip()
    if match[2] or rest.startswith("BINARY"):
        raise OffFormatError(
            number, "only text files of points in space can be read; save the mesh as plain OFF"
        )
    if rest:
        return (number, rest), lines[1:]
    if len(lines) < 2:
        raise OffFormatError(
            end, "the file ends before the counts; the numbers of vertices and faces should follow"
        )
    return lines[1], lines[2:]


def _counts(line: Line) -> tuple[int, int]:
    number, content = line
    tokens = content.split()[:2]
    if len(tokens) < 2:
        raise OffFormatError(number, "give the number of vertices and the number of faces")
    n, m = _numbers(int, tokens, [number, number])
    if n < 0 or m < 0:
        raise OffFormatError(number, f"there cannot be {min(n, m)} of anything; counts start at 0")
    return n, m


def _vertices(lines: list[Line]) -> FloatArray:
    tokens: list[str] = []
    for number, line in lines:
        row = line.split()[:3]
        if len(row) < 3:
            raise OffFormatError(
                number, f"a vertex needs three coordinates; this line has {len(row)} numbers"
            )
        tokens += row
    coordinates = _numbers(float, tokens, [number for number, _ in lines for _ in range(3)])
    return np.array(coordinates, dtype=np.float64).reshape(len(lines), 3)


def _faces(lines: list[Line], n_vertices: int) -> IntArray | list[list[int]]:
    sizes = _numbers(int, [line.split(maxsplit=1)[0] for _, line in lines], [number for number, _ in lines])
    tokens: list[str] = []
    where: list[int] = []
    for (number, line), size in zip(lines, sizes, strict=True):
        row = line.split()[1:]
        if size < 3 or len(row) < size:
            raise OffFormatError(
                number, f"the face announces {size} corners and lists {len(row)}; it needs three or more"
            )
        tokens += row[:size]
        where += [number] * size
    indices = _numbers(int, tokens, where)
    for v, number in zip(indices, where, strict=True):
        if not 0 <= v < n_vertices:
            raise OffFormatError(
                number, f"there is no vertex {v}; the indices run from 0 to {n_vertices - 1}"
            )
    if len(set(sizes)) <= 1:
        return np.array(indices, dtype=np.int64).reshape(len(lines), *(sizes[:1] or [3]))
    ahead = iter(indices)
    return [list(islice(ahead, size)) for size in sizes]


def _numbers(kind: type[Number], tokens: list[str], where: list[int]) -> list[Number]:
    """Convert all tokens; `where` holds the number of the line of each, to name it in an error."""
    # All at once, as asking for every token by itself takes three times as long.
    if _plain("".join(tokens)):
        with contextlib.suppress(ValueError):
            values = list(map(kind, tokens))
            if kind is int or all(map(math.isfinite, values)):
                return values
    token, line = next(
        (token, line) for token, line in zip(tokens, where, strict=True) if not _is_number(kind, token)
    )
    wanted = "a whole number" if kind is int else "a finite number"
    raise OffFormatError(line, f"{_short(token)} is not {wanted}")


def _is_number(kind: type[Number], token: str) -> bool:
    try:
        value = kind(token)
    except ValueError:
        return False
    return _plain(token) and (kind is int or math.isfinite(value))


def _plain(token: str) -> bool:
    # Python also reads 1_000 and the digits of other scripts; a file that has them is damaged.
    return token.isascii() and "_" not in token


def _short(token: str) -> str:
    return repr(token if len(token) <= 20 else token[:19] + "…")


def write_off(vertices: FloatArray, faces: Polygons) -> str:
    """Write a mesh as the text of an OFF file.

    Parameters
    ----------
    vertices : (n, 3) float array
        Positions. Each number is written with as many digits as it takes to read the same number back.
    faces : (m, k) int array, or list of m index lists
        Indices from 0.

    Returns
    -------
    str
        The file, with a line for the header, the counts, each vertex and each face.

    Raises
    ------
    ValueError
        If a position is not finite, or a face has fewer than three corners, names a vertex
        twice or one that is not there.

    References
    ----------
    Notes, appendix, *OFF*.
    """
    positions = as_points(vertices, "vertices")
    corners, sizes = flatten_polygons(faces, len(positions))
    lines = ["OFF", f"{len(positions)} {len(sizes)} 0"]
    # tolist() gives Python's own floats, whose repr is the shortest text that reads back the same.
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in positions.tolist()]
    ahead = iter(corners.tolist())
    lines += [" ".join(map(str, [size, *islice(ahead, size)])) for size in sizes.tolist()]
    return "\n".join(lines) + "\n"
