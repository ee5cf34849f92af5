"""From values to the tree and the buffers of a frame (see `wire`)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import fields
from types import NoneType
from typing import Any

import numpy as np

from gpcourse.errors import GeometryError, WireError
from gpcourse.geometry.functions import FUNCTIONS
from gpcourse.geometry.halfedge_mesh import HalfedgeMesh

#: Levels of nesting, and items of lists, tuples, sets and dicts in one frame.
MAX_DEPTH = 24
MAX_ITEMS = 500_000
#: Longest string, in characters, and largest whole number, in bits.
MAX_TEXT = 2**20
#: The most numbers that a sparse matrix may have when it is written out densely, as checks do.
MAX_DENSE = 2**27
#: Values of which only the name of the type crosses.
MAX_OPAQUE = 1000
MAX_BITS = 4096
#: Whole numbers below this hash to themselves, so that no two keys of a dict can be made to collide.
MAX_KEY = 2**60

#: The types of array that cross, always with the low byte first.
DTYPES = ("|b1", "|i1", "<i2", "<i4", "<i8", "|u1", "<u2", "<u4", "<u8", "<f2", "<f4", "<f8", "<c8", "<c16")

MESH_RECORDS = ("twin", "next", "prev", "origin", "face", "vertex_halfedge", "face_halfedge")


class Encoder:
    """Turns one value into a tree of JSON and a list of buffers."""

    def __init__(self, *, lenient: bool, max_bytes: int) -> None:
        self.lenient = lenient
        self.free = max_bytes
        self.items = 0
        self.opaque = 0
        self.buffers: list[bytes] = []

    def encode(self, value: Any, depth: int = 0) -> Any:
        """Return the tree of `value`; its arrays are appended to `buffers`."""
        if depth > MAX_DEPTH:
            raise WireError(f"a value nested more than {MAX_DEPTH} levels deep")
        write = _WRITER_OF.get(type(value))
        if write is None:
            write = next((w for kinds, w in _WRITERS if isinstance(value, kinds)), Encoder._other)
        return write(self, value, depth)

    def _same(self, value: object, depth: int) -> Any:
        return value

    def _text(self, value: str, depth: int) -> str:
        if len(value) > MAX_TEXT:
            raise WireError(f"a string of {len(value):,} characters is too long to hand over")
        return str(value).encode("utf-8", "replace").decode("utf-8")

    def _integer(self, value: int, depth: int) -> Any:
        number = int(value)  # an IntEnum and the like
        if number.bit_length() < 64:
            return number
        if number.bit_length() > MAX_BITS:
            raise WireError(f"a whole number of {number.bit_length():,} bits is too long to hand over")
        return ["int", hex(number)]

    def _float(self, value: float, depth: int) -> float:
        return float(value)

    def _complex(self, value: complex, depth: int) -> Any:
        return ["complex", value.real, value.imag]

    def _bytes(self, value: bytes, depth: int) -> Any:
        return ["bytes", self._buffer(np.frombuffer(bytes(value), dtype=np.uint8))]

    def _scalar(self, value: np.generic, depth: int) -> Any:
        tree = self._array(np.asarray(value), depth)
        return ["scalar", *tree[1:]] if tree[0] == "array" else tree

    def _array(self, value: np.ndarray[Any, Any], depth: int) -> Any:
        value = np.asarray(value)  # drops a matrix or a mask
        if value.dtype.kind in "OUS":
            return ["objects", list(value.shape), self._list(value.ravel().tolist(), depth)]
        if value.dtype.kind not in "biufc":
            return self._opaque(type(value).__name__)
        if value.dtype.itemsize > (16 if value.dtype.kind == "c" else 8):  # long double
            value = value.astype(np.complex128 if value.dtype.kind == "c" else np.float64)
        return ["array", little(value.dtype), list(value.shape), self._buffer(value)]

    def _buffer(self, value: np.ndarray[Any, Any]) -> int:
        self.free -= value.nbytes
        if self.free < 0:
            raise WireError(
                f"an array of shape {value.shape}, {value.nbytes:,} bytes, is too large to hand over"
            )
        self.buffers.append(value.astype(little(value.dtype), copy=False).tobytes())
        return len(self.buffers) - 1

    def _list(self, values: Sequence[object], depth: int) -> Any:
        return ["list", *self._items(values, depth)]

    def _tuple(self, values: Sequence[object], depth: int) -> Any:
        return ["tuple", *self._items(values, depth)]

    def _items(self, values: Sequence[object], depth: int) -> list[Any]:
        self._count(len(values))
        return [self.encode(item, depth + 1) for item in values]

    def _count(self, more: int) -> None:
        self.items += more
        if self.items > MAX_ITEMS:
            raise WireError(f"{self.items:,} items in lists are too many to hand over; return an array")

    def _set(self, value: Iterable[object], depth: int) -> Any:
        keys = [_key(item) for item in value]
        if None in keys:
            return self._opaque(type(value).__name__)
        self._count(len(keys))
        return ["set", *sorted(keys, key=lambda k: (isinstance(k, str), k))]

    def _dict(self, value: dict[Any, Any], depth: int) -> Any:
        if hasattr(value, "tocsr"):  # a dok_array is a dict
            return self._sparse(value, depth)
        keys = [_key(key) for key in value]
        if None in keys or len(set(keys)) < len(keys):
            return self._opaque(type(value).__name__)
        self._count(2 * len(keys))
        return ["dict", *([k, self.encode(v, depth + 1)] for k, v in zip(keys, value.values(), strict=True))]

    def _mesh(self, value: HalfedgeMesh, depth: int) -> Any:
        records = {name: getattr(value, name) for name in (*MESH_RECORDS, "vertices")}
        try:
            whole = HalfedgeMesh(**records)  # somebody may have planted something else in it
        except GeometryError as error:
            raise WireError(f"a HalfedgeMesh that is broken: {error}") from None
        return ["mesh", *(self.encode(getattr(whole, name), depth + 1) for name in records)]

    def _function(self, value: Any, depth: int) -> Any:
        name = type(value).__name__
        if self.lenient or FUNCTIONS.get(name) is not type(
            value
        ):  # students are asked for values, not given names
            return self._opaque(name)
        return ["function", name, *(self.encode(getattr(value, f.name), depth + 1) for f in fields(value))]

    def _other(self, value: Any, depth: int) -> Any:
        if hasattr(value, "tocsr") and hasattr(value, "nnz"):
            return self._sparse(value, depth)
        if hasattr(value, "__array__"):
            return self._array(np.asarray(value), depth)
        if isinstance(value, Sequence):  # a deque, a range, a list of one's own
            self._count(len(value))
            self.items -= len(value)
            return self._list(list(value), depth)
        return self._opaque(type(value).__name__)

    def _sparse(self, value: Any, depth: int) -> Any:
        if len(value.shape) != 2:
            return self._array(value.toarray(), depth)
        rows, columns = map(int, value.shape)
        if rows * columns > MAX_DENSE:
            raise WireError(f"a sparse matrix of {rows:,} × {columns:,} is too large to hand over")
        csr = value.tocsr()
        if csr.dtype.kind not in "biufc":
            return self._opaque(type(value).__name__)
        return [
            "sparse",
            [int(n) for n in csr.shape],
            *(self._array(a, 0) for a in (csr.data, csr.indices, csr.indptr)),
        ]

    def _opaque(self, name: str) -> Any:
        if not self.lenient:
            raise WireError(f"a {name} cannot be handed to another process")
        self.opaque += 1
        if self.opaque > MAX_OPAQUE:
            raise WireError(f"more than {MAX_OPAQUE:,} values like a {name} are too many to hand over")
        return ["opaque", name[:100] if name.isidentifier() else "object"]


#: How each type is written. The order matters: numpy's float64 is a float, a bool is an int.
_WRITERS: tuple[tuple[Any, Callable[..., Any]], ...] = (
    ((NoneType, bool), Encoder._same),
    (str, Encoder._text),
    ((bytes, bytearray), Encoder._bytes),
    (np.generic, Encoder._scalar),
    (int, Encoder._integer),
    (float, Encoder._float),
    (complex, Encoder._complex),
    (np.ndarray, Encoder._array),
    (list, Encoder._list),
    (tuple, Encoder._tuple),
    ((set, frozenset), Encoder._set),
    (dict, Encoder._dict),
    (HalfedgeMesh, Encoder._mesh),
    (tuple(FUNCTIONS.values()), Encoder._function),
)

_COMMON = (
    NoneType,
    bool,
    str,
    int,
    float,
    np.float64,
    np.int64,
    np.bool_,
    np.ndarray,
    list,
    tuple,
    dict,
    HalfedgeMesh,
)
#: The first of `_WRITERS` that fits, for the types that come most often.
_WRITER_OF = {kind: next(w for kinds, w in _WRITERS if issubclass(kind, kinds)) for kind in _COMMON}


def little(dtype: np.dtype[Any]) -> str:
    """Return the name of `dtype` with the low byte first, as in `DTYPES`."""
    return dtype.newbyteorder("<").str


def _key(item: object) -> str | int | None:
    """Return a key that can cross, or None."""
    if isinstance(item, str):
        return str(item).encode("utf-8", "replace").decode("utf-8")
    if isinstance(item, (int, np.integer)) and abs(int(item)) < MAX_KEY:
        return int(item)
    return None
