"""Landlock: this process, and whatever it starts, opens no file but those that were granted.

The kernel refuses everything of the kinds that it handles (reading, writing, listing, making, running files;
from version 4 on TCP too, from 6 on signals to other processes), and then allows what rules name. A rule
names a folder and holds for all that is in it: Landlock cannot subtract. So a folder that holds something
hidden is granted child by child, and of itself only its list of names.

What it does not govern, `seccomp` refuses: changing modes, owners and times, sockets of other kinds. Asking
whether a path exists, and how large it is, stays possible.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Collection, Iterable, Iterator
from functools import cache
from pathlib import Path

#: The system calls have these numbers on every architecture.
_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446
_VERSION_FLAG, _PATH_BENEATH = 1, 1
_PR_SET_NO_NEW_PRIVS = 38

_WRITE_FILE, _READ_FILE, _READ_DIR, _TRUNCATE = 1 << 1, 1 << 2, 1 << 3, 1 << 14
_EXECUTE, _MAKE_CHAR, _MAKE_SOCK, _MAKE_FIFO, _MAKE_BLOCK = 1 << 0, 1 << 6, 1 << 9, 1 << 10, 1 << 11
_FOR_FILES = _EXECUTE | _WRITE_FILE | _READ_FILE | _TRUNCATE | 1 << 15

#: How many kinds of access to files each version handles: 2 adds moving between folders, 3 truncating,
#: 5 device controls.
_KINDS = {1: 13, 2: 14, 3: 15, 4: 15}
_KINDS_NOW = 16
_TCP = 0b11  # bind, connect; since version 4
_SCOPES = 0b11  # abstract sockets and signals; since version 6

Grant = tuple[Path, int]


class _Ruleset(ctypes.Structure):
    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scopes", ctypes.c_uint64))


class _Beneath(ctypes.Structure):
    _pack_ = 1
    _layout_ = "ms"
    _fields_ = (("allowed", ctypes.c_uint64), ("parent", ctypes.c_int32))


def version() -> int:
    """Return the version of the kernel's Landlock.

    Raises OSError if there is none.
    """
    if not sys.platform.startswith("linux"):
        raise OSError(0, f"{sys.platform} has none")
    return _call(_CREATE_RULESET, None, ctypes.c_size_t(0), ctypes.c_uint32(_VERSION_FLAG))


def confine(readable: Iterable[Grant], writable: Iterable[Path]) -> None:
    """Let this process open nothing but `readable` and `writable`, from now on and for good.

    Parameters
    ----------
    readable : Grants
        Files and folders that may be read, from `readings`; those that do not exist are passed over.
    writable : paths
        Folders in which regular files, folders and links may be made, changed and removed.

    Raises
    ------
    OSError
        If the kernel has no Landlock, or refuses.
    """
    number = version()
    kinds = (1 << _KINDS.get(number, _KINDS_NOW)) - 1
    special = _EXECUTE | _MAKE_CHAR | _MAKE_SOCK | _MAKE_FIFO | _MAKE_BLOCK
    grants = [*readable, *((path, kinds & ~special) for path in writable)]
    attributes = _Ruleset(kinds, _TCP if number >= 4 else 0, _SCOPES if number >= 6 else 0)
    size = ctypes.c_size_t(8 if number < 4 else 16 if number < 6 else 24)
    ruleset = _call(_CREATE_RULESET, ctypes.byref(attributes), size, ctypes.c_uint32(0))
    try:
        for path, allowed in grants:
            _grant(ruleset, path, allowed & kinds)
        no_new_privileges()
        _call(_RESTRICT_SELF, ctypes.c_int(ruleset), ctypes.c_uint32(0))
    finally:
        os.close(ruleset)


def no_new_privileges() -> None:
    """Give up what a program could gain by being run: the kernel asks for it before it lets us confine."""
    if _libc().prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0):
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def readings(roots: Iterable[Path], hidden: Collection[Path]) -> Iterator[Grant]:
    """Yield what is to be granted so that all of `roots` can be read but for what is `hidden`.

    A folder on the way to something hidden may be listed, because imports list folders: its names, and the
    names below it, are not secret.
    """
    secret = [path.resolve() for path in hidden]
    for root in {path.resolve() for path in roots}:
        yield from _around(root, secret)


def _around(path: Path, secret: Collection[Path]) -> Iterator[Grant]:
    if any(path.is_relative_to(one) for one in secret):
        return
    if not any(one.is_relative_to(path) for one in secret):
        yield path, _READ_FILE | _READ_DIR
        return
    yield path, _READ_DIR
    for child in path.iterdir():
        if child.is_symlink():  # a rule would follow it: what it leads to has to be granted by its own name
            continue
        yield from _around(child, secret)


def _grant(ruleset: int, path: Path, allowed: int) -> None:
    try:
        handle = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:  # not on this machine
        return
    try:
        if not path.is_dir():
            allowed &= _FOR_FILES
        rule = _Beneath(allowed, handle)
        kind = ctypes.c_int(_PATH_BENEATH)
        _call(_ADD_RULE, ctypes.c_int(ruleset), kind, ctypes.byref(rule), ctypes.c_uint32(0))
    finally:
        os.close(handle)


@cache
def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


def _call(number: int, *arguments: object) -> int:
    result: int = _libc().syscall(ctypes.c_long(number), *arguments)
    if result < 0:
        code = ctypes.get_errno()
        raise OSError(code, os.strerror(code))
    return result
