"""From the tree and the buffers of a frame to values (see `wire`). Trusts nothing that it reads."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from gpcourse.errors import GeometryError, WireError
from gpcourse.geometry.functions import FUNCTIONS
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh
from gpcourse.sandbox.encoding import (
    DTYPES,
    MAX_BITS,
    MAX_DENSE,
    MAX_DEPTH,
    MAX_ITEMS,
    MAX_KEY,
    MAX_OPAQUE,
    MAX_TEXT,
    MESH_RECORDS,
)

#: The most characters that the strings of a list may have when each gets the length of the longest, as numpy
#: gives it: a long one among many short ones would fill the memory.
MAX_TABLE = 2**26


class Opaque:
    """Stands for a value that cannot cross. Its class carries the name of the value's own class."""

    def __repr__(self) -> str:
        return f"<{type(self).__name__}>"


def decode(tree: object, buffers: list[memoryview], *, functions: bool = False) -> Any:
    """Build the value of a tree, or raise WireError; `functions` are refused unless they are asked for."""
    decoder = Decoder(buffers, functions=functions)
    value = decoder.decode(tree)
    if decoder.unused:
        raise WireError(f"{len(decoder.unused)} buffers that no array uses")
    return value


class Decoder:
    """Builds one value. Each buffer is used once, so that a short frame cannot stand for a long value."""

    def __init__(self, buffers: list[memoryview], *, functions: bool = False) -> None:
        self.functions = functions
        self.buffers = buffers
        self.unused = set(range(len(buffers)))
        self.items = 0
        self.leaves = 0
        self.longest = 0
        self.opaque = 0

    def decode(self, tree: object, depth: int = 0) -> Any:
        """Return the value of `tree`."""
        if depth > 2 * MAX_DEPTH + 4:
            raise WireError(f"a value nested more than {MAX_DEPTH} levels deep")
        self.leaves += 1
        if tree is None or isinstance(tree, (bool, float)):
            return tree
        if isinstance(tree, int):
            return _checked(tree, tree.bit_length() <= 64, "a whole number that is too long")
        if isinstance(tree, str):
            self.longest = max(self.longest, len(tree))
            return _text(tree)
        kind = tree[0] if isinstance(tree, list) and tree else None
        build = _BUILDERS.get(kind) if isinstance(kind, str) else None
        if build is None:
            raise WireError(f"a value of an unknown kind, {str(kind)[:40]!r}")
        parts: list[Any] = tree  # type: ignore[assignment]  # a kind was found in it
        self.items += len(parts)
        if self.items > 4 * MAX_ITEMS:
            raise WireError(f"more than {4 * MAX_ITEMS:,} items")
        return build(self, parts[1:], depth)

    def _sequence(self, body: list[Any], depth: int) -> list[Any]:
        """A list of values."""
        longest, self.longest, leaves = self.longest, 0, self.leaves
        values = [self.decode(item, depth + 1) for item in body]
        if self.longest * (self.leaves - leaves) > MAX_TABLE:
            raise WireError(f"a list of {len(values):,} items with a string of {self.longest:,} characters")
        self.longest = max(longest, self.longest)
        return values

    def _tuple(self, body: list[Any], depth: int) -> tuple[Any, ...]:
        """A tuple of values."""
        return tuple(self._sequence(body, depth))

    def _set(self, body: list[Any], depth: int) -> set[Any]:
        """A set of strings and whole numbers."""
        return _distinct([_key(item) for item in body])

    def _dict(self, body: list[Any], depth: int) -> dict[Any, Any]:
        """A dict with strings and whole numbers as keys."""
        pairs = [_fields(item, 2) for item in body]
        keys = [_key(key) for key, _ in pairs]
        _distinct(keys)
        return {key: self.decode(value, depth + 1) for key, (_, value) in zip(keys, pairs, strict=True)}

    def _array(self, body: list[Any], depth: int = 0) -> np.ndarray[Any, Any]:
        """An array with memory of its own."""
        name, shape, number = _fields(body, 3)
        if not isinstance(name, str) or name not in DTYPES:
            raise WireError(f"an array of type {str(name)[:20]!r}")
        dtype = np.dtype(name)
        sizes = _shape(shape)
        buffer = self._buffer(number)
        if math.prod(sizes) * dtype.itemsize != len(buffer):
            raise WireError(f"an array of shape {sizes} and type {name} in {len(buffer)} bytes")
        if name == "|b1" and bytes(buffer).strip(b"\0\1"):
            raise WireError("an array of booleans that are neither 0 nor 1")
        try:
            return np.ndarray(sizes, dtype, buffer).copy().astype(dtype.newbyteorder("="), copy=False)
        except (ValueError, OverflowError) as error:
            raise WireError(f"an array of shape {sizes}: {error}") from None

    def _buffer(self, number: object) -> memoryview:
        """Take a buffer by its number."""
        if type(number) is not int or number not in self.unused:
            raise WireError(f"buffer {str(number)[:20]}, which is not there or used already")
        self.unused.remove(number)
        return self.buffers[number]

    def _scalar(self, body: list[Any], depth: int) -> Any:
        """A numpy scalar."""
        value = self._array(body)
        return _checked(value[()], value.ndim == 0, "a scalar with a shape")

    def _objects(self, body: list[Any], depth: int) -> np.ndarray[Any, Any]:
        """An array of Python objects, such as faces of different sizes."""
        shape, tree = _fields(body, 2)
        sizes = _shape(shape)
        values = self.decode(tree, depth + 1)
        if not isinstance(values, list) or math.prod(sizes) != len(values):
            raise WireError(f"an array of objects of shape {sizes} that does not hold as many")
        flat = np.empty(len(values), dtype=object)
        for i, value in enumerate(values):
            flat[i] = value
        try:
            return flat.reshape(sizes)
        except ValueError as error:
            raise WireError(f"an array of objects of shape {sizes}: {error}") from None

    def _sparse(self, body: list[Any], depth: int) -> Any:
        """A sparse matrix in CSR format, checked in full: one index out of range can crash a product."""
        from scipy.sparse import csr_array

        shape, *trees = _fields(body, 4)
        rows, columns = _fields(list(_shape(shape)), 2)
        if rows * columns > MAX_DENSE:
            raise WireError(f"a sparse matrix of {rows:,} × {columns:,}, which is too large")
        data, indices, indptr = (self._plain_array(tree) for tree in trees)
        if indices.dtype.kind != "i" or indptr.dtype.kind != "i" or len(indptr) != rows + 1:
            raise WireError("a sparse matrix whose index arrays do not fit its shape")
        try:
            matrix = csr_array((data, indices, indptr), shape=(rows, columns))
            matrix.check_format(full_check=True)
        except (ValueError, TypeError, IndexError, OverflowError) as error:
            raise WireError(f"a sparse matrix that is broken: {error}") from None
        return matrix

    def _plain_array(self, tree: object) -> np.ndarray[Any, Any]:
        kind, *body = _fields(tree, 4)
        value = self._array(body)
        if kind != "array" or value.ndim != 1:
            raise WireError("a sparse matrix whose parts are no arrays")
        return value

    def _mesh(self, body: list[Any], depth: int) -> HalfedgeMesh:
        """A half-edge mesh, rebuilt through its constructor. Its records may still contradict each other."""
        values = self._sequence(_fields(body, len(MESH_RECORDS) + 1), depth)
        names = (*MESH_RECORDS, "vertices")
        for name, value in zip(names, values, strict=True):
            if not (isinstance(value, np.ndarray) or (name == "vertices" and value is None)):
                raise WireError(f"a mesh whose {name} is no array")
        try:
            return HalfedgeMesh(**dict(zip(names, values, strict=True)))
        except GeometryError as error:
            raise WireError(f"a mesh that is broken: {error}") from None

    def _function(self, body: list[Any], depth: int) -> Any:
        """A function of the geometry layer, by its name and parameters: it goes there, never comes back."""
        kind = FUNCTIONS.get(body[0]) if self.functions and body and isinstance(body[0], str) else None
        if kind is None:
            raise WireError("a function where only values may come")
        try:
            return kind(*self._sequence(body[1:], depth))
        except (GeometryError, TypeError) as error:  # TypeError: too many parameters, or too few
            raise WireError(f"a function that is broken: {error}") from None

    def _integer(self, body: list[Any], depth: int) -> int:
        """A whole number beyond 64 bits."""
        (text,) = _fields(body, 1)
        if not isinstance(text, str) or len(text) > MAX_BITS // 4 + 4:
            raise WireError("a whole number that is too long")
        try:
            return int(text, 16)
        except ValueError:
            raise WireError("a whole number with other characters than digits") from None

    def _complex(self, body: list[Any], depth: int) -> complex:
        """A complex number."""
        real, imaginary = _fields(body, 2)
        if not isinstance(real, float) or not isinstance(imaginary, float):
            raise WireError("a complex number whose parts are no numbers")
        return complex(real, imaginary)

    def _bytes(self, body: list[Any], depth: int) -> bytes:
        """A string of bytes."""
        (number,) = _fields(body, 1)
        value = bytes(self._buffer(number))
        self.longest = max(self.longest, len(value))
        return value

    def _opaque(self, body: list[Any], depth: int) -> Opaque:
        """Something that cannot cross: only the name of its type is known."""
        (name,) = _fields(body, 1)
        if not isinstance(name, str) or not name.isidentifier() or len(name) > 100:
            raise WireError("a type whose name is no name")
        self.opaque += 1
        if self.opaque > MAX_OPAQUE:  # each is a class, of a thousand bytes
            raise WireError(f"more than {MAX_OPAQUE:,} values of other kinds")
        stand_in: Opaque = type(_text(name), (Opaque,), {})()
        return stand_in


_BUILDERS: dict[str, Callable[[Decoder, list[Any], int], Any]] = {
    "list": Decoder._sequence, "tuple": Decoder._tuple, "set": Decoder._set, "dict": Decoder._dict,
    "array": Decoder._array, "scalar": Decoder._scalar, "objects": Decoder._objects,
    "sparse": Decoder._sparse, "mesh": Decoder._mesh, "int": Decoder._integer,
    "function": Decoder._function, "complex": Decoder._complex, "bytes": Decoder._bytes,
    "opaque": Decoder._opaque,
}  # fmt: skip


def _checked(value: Any, holds: bool, message: str) -> Any:
    if not holds:
        raise WireError(message)
    return value


def _fields(value: object, count: int) -> list[Any]:
    if not isinstance(value, list) or len(value) != count:
        raise WireError(f"a value that does not have the {count} parts of its kind")
    return value


def _shape(value: object) -> tuple[int, ...]:
    if not isinstance(value, list) or len(value) > 32:
        raise WireError("an array without a shape")
    for size in value:
        if type(size) is not int or not 0 <= size < 2**40:
            raise WireError(f"an array with a side of {str(size)[:20]}")
    return tuple(value)


def _text(value: str) -> str:
    if len(value) > MAX_TEXT:
        raise WireError(f"a string of {len(value):,} characters")
    return value.encode("utf-8", "replace").decode("utf-8")  # a lone surrogate cannot be written to a file


def _key(value: object) -> str | int:
    if isinstance(value, str):
        return _text(value)
    if type(value) is int and abs(value) < MAX_KEY:
        return value
    raise WireError("a key that is neither a string nor a whole number of at most 60 bits")


def _distinct(keys: list[str | int]) -> set[str | int]:
    distinct = set(keys)
    return _checked(distinct, len(distinct) == len(keys), "a key that occurs twice")  # type: ignore[no-any-return]
