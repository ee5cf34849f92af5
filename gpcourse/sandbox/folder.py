"""Reading and removing folders that student code has filled: not even their depth can be trusted."""

from __future__ import annotations

import os
import secrets
import shutil
import stat
from contextlib import suppress
from pathlib import Path


def read_start(path: Path, length: int) -> bytes:
    """Return the first bytes of a regular file; OSError where `path` is a link, a pipe or anything else."""
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    handle = os.open(path, flags)
    try:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            raise OSError(f"{path} is no regular file")
        return os.read(handle, length)
    finally:
        os.close(handle)


def remove(folder: Path) -> None:
    """Remove a folder with all that is in it, as far as that can be done; links are not followed.

    What lies in a folder is moved up before that is removed, so that no chain of folders is too deep.
    (`shutil.rmtree` calls itself for each level, and a thousand of them end it with a RecursionError.)
    """
    if os.rename not in os.supports_dir_fd:  # Windows
        with suppress(RecursionError):
            shutil.rmtree(folder, ignore_errors=True)
        return
    with suppress(OSError):
        top = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        try:
            _empty(top)
        finally:
            os.close(top)
        folder.rmdir()


def _empty(top: int) -> None:
    waiting = os.listdir(top)
    while waiting:
        name = waiting.pop()
        with suppress(OSError):  # what is somebody else's stays
            waiting += _dissolve(name, top)


def _dissolve(name: str, top: int) -> list[str]:
    """Remove one entry of the folder `top`; return the names that folders in it have in `top` now."""
    if _unlinked(name, top):
        return []
    inner = os.open(name, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW, dir_fd=top)
    try:
        moved = []
        for child in os.listdir(inner):  # noqa: PTH208
            if not _unlinked(child, inner):
                moved.append(secrets.token_hex(8))
                os.rename(child, moved[-1], src_dir_fd=inner, dst_dir_fd=top)
    finally:
        os.close(inner)
    os.rmdir(name, dir_fd=top)
    return moved


def _unlinked(name: str, folder: int) -> bool:
    """Remove anything but a folder; make a folder ours to read and change."""
    try:
        os.unlink(name, dir_fd=folder)
    except OSError:
        with suppress(OSError):
            os.chmod(name, 0o700, dir_fd=folder)
        return False
    return True
