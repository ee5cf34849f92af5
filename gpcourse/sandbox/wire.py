"""Values as bytes: how questions and answers cross between two processes.

A frame is a fixed head (magic, length of the header, length of the buffers), a JSON header, and raw
buffers. The header holds None, booleans, numbers and strings as JSON has them, and everything else as a
list whose first item is its kind::

    ["array", "<f8", [3, 2], 0]     a numpy array: type, shape, number of its buffer
    ["list", 1, 2.5, ["tuple", "a"]]

Nothing is pickled, and no class is looked up by a name from the outside. Reading a frame raises `WireError`
or returns a value; it allocates a small multiple of the frame's own length, which is capped.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from typing import Any

from gpcourse.errors import WireError
from gpcourse.sandbox.decoding import decode
from gpcourse.sandbox.encoding import Encoder

MAGIC = b"gpc1"
HEAD = struct.Struct("<4sIQ")

#: The most that a frame may hold: bytes of JSON, and bytes of raw buffers.
MAX_HEADER = 8 * 2**20
MAX_BUFFERS = 256 * 2**20
#: Bytes of Python's objects for a byte of JSON: ``["set"],`` becomes a list and a set of 216 bytes.
_OBJECTS = 48


def pack(value: object, *, lenient: bool = False) -> bytes:
    """Write one value as a frame.

    Parameters
    ----------
    value : object
        None, bool, int, float, complex, str, bytes; numpy scalars and arrays of numbers; SciPy sparse
        matrices; lists, tuples, sets, and dicts with str or int keys, of such; HalfedgeMesh; and, unless
        `lenient`, functions of `geometry.functions`.
    lenient : bool
        Whether a value of another kind is sent as its type's name (an `Opaque` on the other side).

    Raises
    ------
    WireError
        If the value is too large, too deep, or of another kind and `lenient` is False.
    """
    encoder = Encoder(lenient=lenient, max_bytes=MAX_BUFFERS)
    tree = encoder.encode(value)
    header = json.dumps([tree, [len(b) for b in encoder.buffers]], separators=(",", ":")).encode("ascii")
    if len(header) > MAX_HEADER:
        raise WireError(
            f"a value of {len(header):,} bytes of text; at most {MAX_HEADER:,} can be handed over"
        )
    total = sum(len(b) for b in encoder.buffers)
    return b"".join([HEAD.pack(MAGIC, len(header), total), header, *encoder.buffers])


def unpack(frame: bytes, *, functions: bool = False) -> Any:
    """Read the value of one whole frame, or raise WireError. It may hold `functions` if that is said."""
    header, buffers = lengths(frame[: HEAD.size])
    if len(frame) != HEAD.size + header + buffers:
        raise WireError(f"a frame of {len(frame)} bytes that announces {HEAD.size + header + buffers}")
    return _parse(memoryview(frame), header, functions)


def receive(read: Callable[[int], bytes], *, functions: bool = False) -> Any:
    """Read one frame by calling ``read(n)``, which returns exactly n bytes, or fewer at the end.

    It may hold `functions` only where that is said.

    Raises
    ------
    EOFError
        If nothing is left where a frame would begin.
    WireError
        If what is there is not a frame. What follows it cannot be trusted to begin a new one.
    """
    head = read(HEAD.size)
    if not head:
        raise EOFError
    length = sum(lengths(head))
    body = read(length)
    if len(body) != length:
        raise WireError(f"a frame that ends after {len(body)} of {length} bytes")
    return unpack(head + body, functions=functions)


def lengths(head: bytes) -> tuple[int, int]:
    """Return the bytes of header and of buffers that a frame's head announces, or raise WireError."""
    if len(head) != HEAD.size:
        raise WireError(f"a frame that ends after {len(head)} bytes")
    magic, header, buffers = HEAD.unpack(head)
    if magic != MAGIC:
        raise WireError(f"a frame that begins with {magic!r}, not {MAGIC!r}")
    if header > MAX_HEADER or buffers > MAX_BUFFERS:
        raise WireError(f"a frame that announces {header:,} + {buffers:,} bytes, more than is allowed")
    return header, buffers


def weight(head: bytes) -> int:
    """Return about how many bytes of memory the value of a frame takes at most, or raise WireError."""
    header, buffers = lengths(head)
    return _OBJECTS * header + buffers


def _parse(frame: memoryview, header: int, functions: bool) -> Any:
    start = HEAD.size + header
    try:
        content = json.loads(bytes(frame[HEAD.size : start]))
    except (ValueError, RecursionError) as error:  # bad UTF-8 is a ValueError too
        raise WireError(f"a header that is not JSON: {str(error)[:80]}") from None
    if not isinstance(content, list) or len(content) != 2 or not isinstance(content[1], list):
        raise WireError("a header that is not a pair of a value and a list of lengths")
    tree, sizes = content
    buffers: list[memoryview] = []
    for size in sizes:
        if type(size) is not int or not 0 <= size <= len(frame) - start:
            raise WireError(f"a buffer of length {str(size)[:20]} that the frame does not hold")
        buffers.append(frame[start : start + size])
        start += size
    if start != len(frame):
        raise WireError(f"{len(frame) - start} bytes that belong to no buffer")
    return decode(tree, buffers, functions=functions)
