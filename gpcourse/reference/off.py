"""Reading and writing OFF, the file format of the course."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Callable
from typing import TypeVar

import numpy as np

from gpcourse.errors import OffFormatError
from gpcourse.geometry.arrays import FloatArray, IntArray, Polygons, as_points, flatten_polygons

Number = TypeVar("Number", int, float)
Line = tuple[int, list[str]]

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
    lines = [
        (i, content) for i, raw in enumerate(text.split("\n"), 1) if (content := raw.split("#")[0].split())
    ]
    end = text.count("\n") + 1
    counts, body = _header(lines, end)
    n, m = _counts(counts)
    if n + m > len(body):
        raise OffFormatError(
            end,
            f"the file ends after {len(body)} of {n} vertex and {m} face lines; "
            "add the missing lines or correct the counts",
        )
    vertices = [_vertex(line) for line in body[:n]]
    faces = [_face(line, n) for line in body[n : n + m]]
    positions = np.array(vertices, dtype=np.float64).reshape(n, 3)
    sizes = {len(face) for face in faces} or {3}
    if len(sizes) == 1:
        return positions, np.array(faces, dtype=np.int64).reshape(m, *sizes)
    return positions, faces


def _header(lines: list[Line], end: int) -> tuple[Line, list[Line]]:
    """Check the first line; return the counts, from this line or the next, and the lines that follow."""
    if not lines:
        raise OffFormatError(end, "the file is empty; it should begin with OFF")
    number, tokens = lines[0]
    match = _HEADER.fullmatch(" ".join(tokens))
    if match is None:
        raise OffFormatError(
            number, f"the header {_short(tokens[0])} is not OFF; the first line should be OFF"
        )
    rest = match[3].split()
    if match[2] or rest[:1] == ["BINARY"]:
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
    number, tokens = line
    if len(tokens) < 2:
        raise OffFormatError(number, "give the number of vertices and the number of faces")
    n, m = (_number(int, token, number) for token in tokens[:2])
    if n < 0 or m < 0:
        raise OffFormatError(number, f"there cannot be {min(n, m)} of anything; counts start at 0")
    return n, m


def _vertex(line: Line) -> list[float]:
    number, tokens = line
    if len(tokens) < 3:
        raise OffFormatError(number, f"a vertex needs three coordinates; this line has {len(tokens)} numbers")
    return [_number(float, token, number) for token in tokens[:3]]


def _face(line: Line, n_vertices: int) -> list[int]:
    number, tokens = line
    size = _number(int, tokens[0], number)
    if size < 3 or len(tokens) <= size:
        raise OffFormatError(
            number, f"the face announces {size} corners and lists {len(tokens) - 1}; it needs three or more"
        )
    face = [_number(int, token, number) for token in tokens[1 : 1 + size]]
    for v in face:
        if not 0 <= v < n_vertices:
            raise OffFormatError(
                number, f"there is no vertex {v}; the indices run from 0 to {n_vertices - 1}"
            )
    return face


def _number(kind: Callable[[str], Number], token: str, line: int) -> Number:
    # Python also reads 1_000 and digits of other scripts; a file that has them is damaged.
    if token.isascii() and "_" not in token:
        with contextlib.suppress(ValueError):
            value = kind(token)
            if math.isfinite(value):
                return value
    wanted = "a whole number" if kind is int else "a finite number"
    raise OffFormatError(line, f"{_short(token)} is not {wanted}")


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
    for face in np.split(corners, np.cumsum(sizes)[:-1]) if len(sizes) else []:
        lines.append(" ".join(map(str, [len(face), *face.tolist()])))
    return "\n".join(lines) + "\n"
