"""Reading PLY, the format of many scanners: ASCII, and binary of either byte order.

A header names the elements (``vertex``, ``face``, …), and for each its number of rows and its properties:
numbers, or lists that begin with their length. Elements and properties of any name are read, and those that
nobody asks for do no harm.

Why not a library: plyfile took 9.4 s for one Stanford scan, whose grid is 200,000 lists of different lengths,
and warned about each empty one; this takes 0.3 s.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gpcourse.errors import GeometryError, PlyFormatError
from gpcourse.geometry.arrays import FloatArray, IntArray, flatten_polygons

_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
_BYTE_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}

#: The list of a face's corners goes by either name.
_CORNERS = ("vertex_indices", "vertex_index")


@dataclass(frozen=True, eq=False)
class Lists:
    """A property whose rows are lists: all of them end to end, and the length of each."""

    flat: FloatArray
    sizes: IntArray


#: The properties of an element by name.
Columns = dict[str, FloatArray | Lists]


@dataclass(frozen=True)
class _Property:
    name: str
    kind: str
    #: The type of the length, for a list; empty for a number.
    length: str = ""


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    properties: list[_Property]


def read_ply(path: str | Path) -> tuple[FloatArray, IntArray | list[list[int]]]:
    """Read the vertices and faces of a PLY file.

    Returns
    -------
    vertices : (n, 3) float array
    faces : (m, k) int array, or list of m index lists
        An array where all faces have k corners; (0, 3) where the file has none.

    Raises
    ------
    PlyFormatError
        If the file is damaged, or has no vertices with x, y and z.
    """
    data = Path(path).read_bytes()
    try:
        elements = read_ply_elements(data)
        return ply_vertices(elements), _faces(elements)
    except PlyFormatError as error:
        raise PlyFormatError(f"{Path(path).name}: {error}") from None


def read_ply_elements(data: bytes) -> dict[str, Columns]:
    """Read all elements of a PLY file, given as bytes: ``elements["vertex"]["x"]`` is an array.

    All numbers become float64, which holds every type of the format exactly.

    Raises
    ------
    PlyFormatError
        If the file is damaged; the message says where.
    """
    byte_order, elements, body = _header(data)
    columns: dict[str, Columns] = {}
    if byte_order:
        rest, place = body, 0
        for element in elements:
            columns[element.name], place = _binary(element, rest, place, byte_order)
        left, unit = len(rest) - place, "bytes"
    else:
        numbers, place = _numbers(body), 0
        for element in elements:
            columns[element.name], place = _text(element, numbers, place)
        left, unit = len(numbers) - place, "numbers"
    if left:
        raise PlyFormatError(f"{left} {unit} follow the last element; correct the counts in the header")
    return columns


def ply_vertices(elements: dict[str, Columns]) -> FloatArray:
    """Return the (n, 3) positions among the elements of a PLY file."""
    vertex = elements.get("vertex", {})
    axes = [vertex.get(axis) for axis in "xyz"]
    columns = [column for column in axes if isinstance(column, np.ndarray)]
    if len(columns) < 3:
        raise PlyFormatError("there is no element vertex with the properties x, y and z")
    points = np.column_stack(columns)
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise PlyFormatError(f"vertex {bad[0]} is at {points[bad[0]]}; every coordinate must be finite")
    return points


def _faces(elements: dict[str, Columns]) -> IntArray | list[list[int]]:
    face = elements.get("face", {})
    corners = next((face[name] for name in _CORNERS if name in face), None)
    if corners is None or (isinstance(corners, Lists) and not len(corners.sizes)):
        return np.empty((0, 3), dtype=np.int64)
    if not isinstance(corners, Lists) or (corners.flat != np.floor(corners.flat)).any():
        raise PlyFormatError("the corners of the faces are not lists of whole numbers")
    ends = np.cumsum(corners.sizes).tolist()
    flat = corners.flat.astype(np.int64)
    same = (corners.sizes == corners.sizes[0]).all()
    starts = zip([0, *ends], ends, strict=False)
    faces = flat.reshape(len(ends), -1) if same else [flat[a:b].tolist() for a, b in starts]
    try:
        flatten_polygons(faces, len(ply_vertices(elements)))
    except GeometryError as error:
        raise PlyFormatError(str(error)) from None
    return faces


def _header(data: bytes) -> tuple[str, list[_Element], bytes]:
    """Read the header; return the byte order, the elements, and what follows."""
    lines, body = _header_lines(data)
    byte_order: str | None = None
    elements: list[_Element] = []
    for number, line in enumerate(lines, 2):
        words = line.split()
        match words:
            case [] | ["comment", *_] | ["obj_info", *_]:
                pass
            case ["format", name, "1.0"] if name in _BYTE_ORDERS and byte_order is None:
                byte_order = _BYTE_ORDERS[name]
            case ["element", name, count] if count.isascii() and count.isdigit() and len(count) < 16:
                if any(e.name == name for e in elements):
                    raise PlyFormatError(f"line {number}: there are two elements called {name}")
                elements.append(_Element(name, int(count), []))
            case ["property", *words] if elements:
                elements[-1].properties.append(_property(words, number, elements[-1]))
            case _:
                raise PlyFormatError(f"line {number}: {_short(line)} is no line of a PLY header")
    if byte_order is None:
        raise PlyFormatError("the header has no line such as: format ascii 1.0")
    return byte_order, elements, body


def _header_lines(data: bytes) -> tuple[list[str], bytes]:
    """Cut the file in two after the line end_header; return the lines after the first, and the rest."""
    if not data.startswith((b"ply\n", b"ply\r")):
        raise PlyFormatError("the first line is not ply; this is another kind of file, or it is damaged")
    newline = next(end for end in (b"\r\n", b"\n", b"\r") if data[3:].startswith(end))
    end = data.find(newline + b"end_header")
    after = data.find(newline, end + 1)
    if end < 0 or (after < 0 and data[end:].strip() != b"end_header"):
        raise PlyFormatError("there is no line end_header; the file ends early, or it is damaged")
    after = len(data) if after < 0 else after
    if data[end + len(newline) : after].strip() != b"end_header":
        raise PlyFormatError("the line end_header holds something else too")
    lines = data[:end].decode("latin-1").split(newline.decode())[1:]
    return lines, data[after + len(newline) :]


def _property(words: list[str], line: int, element: _Element) -> _Property:
    match words:
        case ["list", length, kind, name] if kind in _TYPES and _TYPES.get(length, "f")[0] in "iu":
            found = _Property(name, _TYPES[kind], _TYPES[length])
        case [kind, name] if kind in _TYPES:
            found = _Property(name, _TYPES[kind])
        case _:
            raise PlyFormatError(f"line {line}: {_short(' '.join(words))} is not a type and a name")
    if any(p.name == found.name for p in element.properties):
        raise PlyFormatError(f"line {line}: {element.name} has two properties called {found.name}")
    return found


def _numbers(body: bytes) -> FloatArray:
    try:
        # "_" and "1_000" are numbers to Python, and not in this format.
        if b"_" in body:
            raise ValueError(f"could not convert {body[max(0, body.find(b'_') - 8) :][:16]!r}")
        return np.array(body.split(), dtype=np.float64)
    except ValueError as error:
        raise PlyFormatError(
            f"after the header: {_short(str(error))}; only numbers can stand there"
        ) from None


def _text(element: _Element, numbers: FloatArray, place: int) -> tuple[Columns, int]:
    """Read an element from numbers in a row; return its columns, and where the next one starts."""
    width = len(element.properties)
    _refuse_short(element, (len(numbers) - place) // max(width, 1))
    if not any(p.length for p in element.properties):
        end = place + element.count * width
        table = numbers[place:end].reshape(element.count, width)
        return {p.name: table[:, k].copy() for k, p in enumerate(element.properties)}, end

    if width == 1:
        return _lists_of_text(element, numbers, place)

    def take(at: int, kind: str, count: int) -> tuple[FloatArray, int]:
        return numbers[at : at + count], at + count

    return _row_by_row(element, take, place)


def _lists_of_text(element: _Element, numbers: FloatArray, place: int) -> tuple[Columns, int]:
    """Read an element of one list property: its lengths are found in a walk from each to the next."""
    values = numbers[place:].tolist()
    lengths, at = [], 0
    for row in range(element.count):
        lengths.append(at)
        at += 1 + _list_length(element, row, values[at : at + 1])
    if at > len(values):
        raise _ends_in(element, element.count - 1)
    flat = np.delete(numbers[place : place + at], lengths)
    sizes = numbers[place:][lengths].astype(np.int64)
    return {element.properties[0].name: Lists(flat, sizes)}, place + at


def _binary(element: _Element, body: bytes, place: int, order: str) -> tuple[Columns, int]:
    """Read an element from bytes; return its columns, and where the next one starts."""
    least = sum(np.dtype(p.length or p.kind).itemsize for p in element.properties)
    _refuse_short(element, (len(body) - place) // max(least, 1))
    if not any(p.length for p in element.properties):
        row = np.dtype([(p.name, order + p.kind) for p in element.properties])
        table = np.frombuffer(body, row, element.count if least else 0, place)
        columns: Columns = {p.name: table[p.name].astype(np.float64) for p in element.properties}
        return columns, place + least * element.count

    alike = _equal_lists(element, body, place, order)
    if alike is not None:
        return alike

    def take(at: int, kind: str, count: int) -> tuple[FloatArray, int]:
        end = at + count * np.dtype(kind).itemsize
        if end > len(body):
            return np.empty(0), end
        return np.frombuffer(body, order + kind, count, at).astype(np.float64), end

    return _row_by_row(element, take, place)


def _equal_lists(element: _Element, body: bytes, place: int, order: str) -> tuple[Columns, int] | None:
    """Read an element of one list property at once where all its lists are equally long, as triangles are."""
    if len(element.properties) > 1 or not element.count:
        return None
    (p,) = element.properties
    size = int(np.frombuffer(body, order + p.length, 1, place)[0])
    if not 0 < size <= 16:
        return None
    row = np.dtype([("size", order + p.length), ("items", order + p.kind, (size,))])
    end = place + row.itemsize * element.count
    if end > len(body):
        return None
    table = np.frombuffer(body, row, element.count, place)
    if (table["size"] != size).any():
        return None
    sizes = np.full(element.count, size)
    return {p.name: Lists(table["items"].astype(np.float64).ravel(), sizes)}, end


def _row_by_row(
    element: _Element, take: Callable[[int, str, int], tuple[FloatArray, int]], place: int
) -> tuple[Columns, int]:
    """Read rows whose length is not known in advance."""
    parts: dict[str, list[FloatArray]] = {p.name: [] for p in element.properties}
    for row in range(element.count):
        for p in element.properties:
            count = 1
            if p.length:
                length, place = take(place, p.length, 1)
                count = _list_length(element, row, length)
            part, place = take(place, p.kind, count)
            if len(part) < count:
                raise _ends_in(element, row)
            parts[p.name].append(part)
    columns: Columns = {}
    for p in element.properties:
        flat = np.concatenate([np.empty(0), *parts[p.name]])
        sizes = np.array([len(part) for part in parts[p.name]], dtype=np.int64)
        columns[p.name] = Lists(flat, sizes) if p.length else flat
    return columns, place


def _list_length(element: _Element, row: int, length: Sequence[float] | FloatArray) -> int:
    if not len(length):
        raise _ends_in(element, row)
    value = float(length[0])
    if not (value >= 0 and value.is_integer() and value < 2**31):
        raise PlyFormatError(f"row {row} of {element.name} has a list of {value:g} items")
    return int(value)


def _ends_in(element: _Element, row: int) -> PlyFormatError:
    return PlyFormatError(f"the file ends in row {row} of {element.count} of {element.name}")


def _refuse_short(element: _Element, most: int) -> None:
    """Stop before anything is allocated for rows that cannot be there."""
    if element.properties and element.count > most:
        raise PlyFormatError(
            f"the header announces {element.count} rows of {element.name}, and there is room for {most}; "
            "the file ends early, or the count is wrong"
        )


def _short(text: str) -> str:
    return repr(text if len(text) <= 60 else text[:59] + "…")
