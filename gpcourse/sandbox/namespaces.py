"""Namespaces: processes that see no files of this machine but what they need, no network, nobody else.

The parent of the workers enters them once: mounts of its own, in which it moves into an empty root that
holds nothing but the libraries, to be read; no network; no channels to other processes. Each child then gets
a numbering of processes of its own, in which it is alone, and a working folder of limited size.

Root may do this; anybody else needs a user namespace, which some systems (Ubuntu 24.04) refuse. Such a one
may not come back to the numbering of processes that it started in, as it has to between two children: so it
goes on as a child of its own, the first in a new numbering.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import sys
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from gpcourse.sandbox import lockdown

_NEW_MOUNTS, _NEW_NAMES, _NEW_CHANNELS, _NEW_USERS, _NEW_PROCESSES, _NEW_NETWORK = (
    0x00020000, 0x04000000, 0x08000000, 0x10000000, 0x20000000, 0x40000000,
)  # fmt: skip
_READ_ONLY, _NO_SET_ID, _NO_DEVICES, _REMOUNT, _BIND, _WITH_BELOW, _PRIVATE = (
    1, 2, 4, 32, 4096, 16384, 1 << 18,
)  # fmt: skip
#: What a mount that others have limited keeps, as `statvfs` and as `mount` say it: no set-user-id, no
#: devices, no programs, times of access.
_KEPT = ((2, 2), (4, 4), (8, 8), (1024, 1024), (2048, 2048), (4096, 1 << 21))
_DETACH = 2
_PIVOT_ROOT = {"x86_64": 155, "aarch64": 41}


@dataclass(frozen=True)
class View:
    """What this process and its children see. `missing` says why that is all there is, where it is."""

    missing: tuple[str, ...] = ()
    own_processes: int = -1

    def make_scratch(self, folder: Path, size: int, files: int) -> None:
        """Make a working folder for `size` bytes in at most `files` files; it needs memory, no disk."""
        if not self.missing:
            folder.mkdir(parents=True)
            options = f"mode=700,size={size},nr_inodes={files}"
            _mount("tmpfs", folder, "tmpfs", _NO_SET_ID | _NO_DEVICES, options)

    def remove_scratch(self, folder: Path) -> None:
        """Give back the memory of a working folder."""
        if not self.missing:
            _check(_libc().umount2(os.fsencode(folder), _DETACH))
            folder.rmdir()

    def before_fork(self) -> None:
        """Let the next child be alone in a numbering of processes of its own."""
        if not self.missing:
            _check(_libc().setns(self.own_processes, _NEW_PROCESSES))  # back, or a second one is refused
            _check(_libc().unshare(_NEW_PROCESSES))


def enter(package: Path, course: Path) -> View:
    """Move this process into namespaces of its own, where the system lets it. There is no way back.

    Parameters
    ----------
    package : Path
        The reduced package; a folder beside it becomes the new root.
    course : Path
        The installed package with the solutions, which will be empty.
    """
    if not sys.platform.startswith("linux") or platform.machine() not in _PIVOT_ROOT:
        return View((f"namespaces: {sys.platform} on {platform.machine()} has none that are used here",))
    try:
        _unshare(_NEW_MOUNTS | _NEW_NAMES | _NEW_CHANNELS | _NEW_NETWORK)
        processes = os.open("/proc/self/ns/pid", os.O_RDONLY | os.O_CLOEXEC)
        _check(_libc().setns(processes, _NEW_PROCESSES))
        _check(_libc().unshare(_NEW_PROCESSES))
        _mount(None, Path("/"), None, _PRIVATE | _WITH_BELOW)
        root = Path(tempfile.mkdtemp(prefix="root-", dir=package.parent))
        _mount("tmpfs", root, "tmpfs", _NO_SET_ID | _NO_DEVICES, "mode=755,size=4m")
        for path in (*lockdown.libraries(), package, Path(os.devnull)):
            _show(root, path)
        for path in (course, *lockdown.ours()):
            _hide(root / path.relative_to("/"))
        _move_into(root)
    except OSError as error:
        return View((f"namespaces: {error.strerror}",))
    return View((), processes)


def _unshare(kinds: int) -> None:
    if _libc().unshare(kinds) == 0:
        return
    if ctypes.get_errno() != errno.EPERM:
        _check(-1)
    user, group = os.geteuid(), os.getegid()
    _check(_libc().unshare(_NEW_USERS | _NEW_PROCESSES | kinds))
    Path("/proc/self/setgroups").write_text("deny")
    Path("/proc/self/uid_map").write_text(f"{user} {user} 1")
    Path("/proc/self/gid_map").write_text(f"{group} {group} 1")
    _go_on_as_a_child()


def _go_on_as_a_child() -> None:
    """Return in a child, which ends with this process; here, wait for it, and end as it does."""
    pid = os.fork()
    if pid == 0:
        lockdown.die_with_parent()
        return
    os.closerange(3, 2**16)  # the socket above all: the child has to see when the grader is gone
    _, status = os.waitpid(pid, 0)
    os._exit(os.waitstatus_to_exitcode(status) & 0xFF)


def _show(root: Path, path: Path) -> None:
    """Let `path` be seen below `root` where it is seen now; links on the way stay links."""
    here = Path("/")
    for i, part in enumerate(path.parts[1:], start=2):
        here = here / part
        there = root / here.relative_to("/")
        if here.is_symlink():
            target = here.parent / here.readlink()
            if not there.is_symlink():
                with suppress(FileExistsError):
                    there.symlink_to(here.readlink())
            return _show(root, Path(os.path.normpath(target), *path.parts[i:]))
        if not here.exists():
            return None
        if i == len(path.parts):
            _bind(here, there)
        elif not there.is_dir():
            there.mkdir()
    return None


def _bind(path: Path, place: Path) -> None:
    if place.exists() and place.samefile(path):  # in a folder that is shown already
        return
    if path.is_dir():
        place.mkdir(exist_ok=True)
    else:
        place.touch()
    _mount(str(path), place, None, _BIND | _WITH_BELOW)
    held = os.statvfs(place).f_flag
    kept = sum(flag for seen, flag in _KEPT if held & seen)
    _mount(None, place, None, _BIND | _REMOUNT | _READ_ONLY | _NO_SET_ID | kept)


def _hide(place: Path) -> None:
    if place.is_dir():
        _mount("tmpfs", place, "tmpfs", _READ_ONLY, "size=4k,mode=755")
    elif place.exists():
        _mount(os.devnull, place, None, _BIND)


def _move_into(root: Path) -> None:
    """Make `root` the root of all paths, and let go of the one before."""
    os.chdir(root)
    number = ctypes.c_long(_PIVOT_ROOT[platform.machine()])
    _check(_libc().syscall(number, b".", b"."))
    _check(_libc().umount2(b".", _DETACH))
    os.chdir("/")


def _mount(source: str | None, place: Path, kind: str | None, flags: int, options: str = "") -> None:
    texts = [None if text is None else os.fsencode(text) for text in (source, place, kind)]
    _check(_libc().mount(*texts, ctypes.c_ulong(flags), options.encode() or None))


def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


def _check(result: int) -> None:
    if result != 0:
        code = ctypes.get_errno()
        raise OSError(code, os.strerror(code))
