"""What a worker gives up before it runs a student's code, and the level of confinement it then has.

The levels, from the weakest:

- ``limits``: a process of its own with limits of time, memory and file size. Without Linux there is no more.
- ``restricted``: it can read Python, its packages without this course, and the system's libraries; it
  can write into its own folder; it can start no process, open no socket and reach no other process.
- ``full``: it is also in namespaces of its own (`namespaces`), which the process that it was forked from
  has made: what it may not read is not there, it is alone, and its folder is limited in size.
"""

from __future__ import annotations

import ctypes
import os
import signal
import site
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from gpcourse.sandbox import landlock, seccomp

Level = Literal["limits", "restricted", "full"]
LEVELS: tuple[Level, ...] = get_args(Level)

#: The user and group "nobody", the same number on all Linux systems.
_NOBODY = 65534
_PR_SET_PDEATHSIG = 1

#: Files of the system that Python and its packages read.
_SYSTEM = (
    "/lib", "/lib64", "/usr/lib", "/usr/lib64", "/etc/ld.so.cache", "/etc/localtime", "/usr/share/zoneinfo",
    "/usr/share/locale", "/usr/share/fonts", "/dev/urandom", "/dev/random", "/dev/zero",
    "/sys/devices/system/cpu",
)  # fmt: skip
_SITES = ("python*/site-packages", "python*/dist-packages")
#: What in a folder of packages is the course itself, or leads to it.
_OURS = ("gpcourse*", "*editable*gpcourse*", "*.pth", "*.egg-link")


@dataclass(frozen=True)
class Confinement:
    """The level that a worker reached, and what kept it from a higher one."""

    level: Level = "limits"
    missing: tuple[str, ...] = ()

    def reaches(self, level: Level) -> bool:
        """Tell whether this is at least `level`."""
        return LEVELS.index(self.level) >= LEVELS.index(level)


def readings(package: Path, course: Path | None) -> list[landlock.Grant]:
    """Return what student code may read.

    Parameters
    ----------
    package : Path
        The reduced package.
    course : Path, optional
        The installed package with the solutions, which is left out; None where it cannot be seen.
    """
    hidden = [] if course is None else [course, *ours()]
    return list(landlock.readings([*libraries(), package], hidden))


def lock(
    scratch: Path,
    package: Path,
    readable: Sequence[landlock.Grant],
    namespaces: tuple[str, ...] | None = None,
) -> Confinement:
    """Confine this process, as far as the system lets it. There is no way back.

    Parameters
    ----------
    scratch : Path
        The one folder that may be written to.
    package : Path
        The reduced package.
    readable : sequence of Grant
        What may be read, from `readings`.
    namespaces : tuple of str, optional
        Given in a process that was forked by `parent`: what kept that from entering namespaces, if anything.
    """
    if not sys.platform.startswith("linux"):
        return Confinement("limits", (f"Landlock and seccomp: {sys.platform} has none",))
    forked = namespaces is not None  # which leaves one thread
    missing = [] if forked or _alone() else ["one thread: a thread runs already that would stay free"]
    _drop_rights(scratch, package)
    if forked:
        die_with_parent()  # after the change of user, which forgets it
    try:
        landlock.confine(readable, [scratch, Path(os.devnull)])
    except OSError as error:
        missing.append(f"Landlock: {error.strerror}")
    try:
        seccomp.confine()
    except OSError as error:
        missing.append(f"seccomp: {error.strerror}")
    if missing:
        return Confinement("limits", tuple(missing))
    absent = ("namespaces: not in a process of its own",) if namespaces is None else namespaces
    return Confinement("restricted" if absent else "full", absent)


def _alone() -> bool:
    """Tell whether this is the only thread: each thread is confined by itself, and hands it on."""
    return len(os.listdir("/proc/self/task")) == 1  # noqa: PTH208


def libraries() -> Iterator[Path]:
    """Yield the files and folders that Python and its packages are read from."""
    for prefix in {sys.prefix, sys.base_prefix, sys.exec_prefix, sys.base_exec_prefix}:
        yield from (Path(prefix, "lib"), Path(prefix, "lib64"))
    yield from _sites()
    yield from map(Path, _SYSTEM)


def _sites() -> set[Path]:
    """Return the folders of packages that this Python may import from, however they came there."""
    roots = [Path(p, name) for p in (sys.prefix, sys.base_prefix, "/usr") for name in ("lib", "lib64")]
    found = {path for root in roots for pattern in _SITES for path in root.glob(pattern)}
    return found | {Path(path) for path in site.getsitepackages() if Path(path).is_dir()}


def ours() -> Iterator[Path]:
    """Yield what, in folders of packages, is the course itself or leads to it."""
    for folder in _sites():
        for pattern in _OURS:
            yield from folder.glob(pattern)


def _drop_rights(scratch: Path, package: Path) -> None:
    """Become nobody where this runs as root, and keep no powers, such as those in a user namespace."""
    if os.geteuid() == 0:
        with suppress(OSError):  # where nobody cannot be had, or cannot read Python: root without powers
            os.setgroups([])
            if _can_be_read([package / "gpcourse", Path(os.__file__), *_sites(), *map(Path, sys.path)]):
                os.chown(scratch, _NOBODY, _NOBODY)
                os.setresgid(_NOBODY, _NOBODY, _NOBODY)
                os.setresuid(_NOBODY, _NOBODY, _NOBODY)
    header = (ctypes.c_uint32 * 2)(0x20080522, 0)
    ctypes.CDLL(None, use_errno=True).capset(ctypes.byref(header), ctypes.byref((ctypes.c_uint32 * 6)()))


def die_with_parent() -> None:
    """Let the kernel end this process when the one that forked it is gone."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)


def _can_be_read(paths: Iterable[Path]) -> bool:
    """Tell whether nobody could read what root can read of `paths`."""
    there = [path for path in paths if path.exists()]
    os.seteuid(_NOBODY)
    try:
        return all(os.access(path, os.R_OK, effective_ids=True) for path in there)
    finally:
        os.seteuid(0)
