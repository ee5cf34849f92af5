"""What a worker gives up before it runs a student's code, and the level of confinement it then has.

The levels, from the weakest:

- ``limits``: a process of its own with limits of time, memory and file size. Without Linux there is no more.
- ``restricted``: it can read Python, its packages without this course, and the system's libraries; it
  can write into its own folder; it can start no process, open no socket and reach no other process.
- ``full``: namespaces too. Reserved: nothing reaches it yet.
"""

from __future__ import annotations

import ctypes
import os
import site
import sys
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from gpcourse.sandbox import landlock, seccomp

Level = Literal["limits", "restricted", "full"]
LEVELS: tuple[Level, ...] = get_args(Level)

#: The user and group "nobody", the same number on all Linux systems.
_NOBODY = 65534

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


def lock(scratch: Path, package: Path, course: Path) -> Confinement:
    """Confine this process, as far as the system lets it. There is no way back.

    Parameters
    ----------
    scratch : Path
        The one folder that may be written to.
    package : Path
        The reduced package, which may be read.
    course : Path
        The installed package with the solutions, which must not be.
    """
    if not sys.platform.startswith("linux"):
        return Confinement("limits", (f"Landlock and seccomp: {sys.platform} has none",))
    missing = [] if _alone() else ["one thread: a thread runs already that would stay free"]
    _drop_root(scratch, package)
    libraries = [*_libraries(), package]
    try:
        landlock.confine(libraries, [scratch, Path(os.devnull)], [course, *_ours()])
    except OSError as error:
        missing.append(f"Landlock: {error.strerror}")
    try:
        seccomp.confine()
    except OSError as error:
        missing.append(f"seccomp: {error.strerror}")
    return Confinement("limits" if missing else "restricted", tuple(missing))


def _alone() -> bool:
    """Tell whether this is the only thread: each thread is confined by itself, and hands it on."""
    return len(os.listdir("/proc/self/task")) == 1  # noqa: PTH208


def _libraries() -> Iterator[Path]:
    for prefix in {sys.prefix, sys.base_prefix, sys.exec_prefix, sys.base_exec_prefix}:
        yield from (Path(prefix, "lib"), Path(prefix, "lib64"))
    yield from _sites()
    yield from map(Path, _SYSTEM)


def _sites() -> set[Path]:
    """Return the folders of packages that this Python may import from, however they came there."""
    roots = [Path(p, name) for p in (sys.prefix, sys.base_prefix, "/usr") for name in ("lib", "lib64")]
    found = {path for root in roots for pattern in _SITES for path in root.glob(pattern)}
    return found | {Path(path) for path in site.getsitepackages() if Path(path).is_dir()}


def _ours() -> Iterator[Path]:
    for folder in _sites():
        for pattern in _OURS:
            yield from folder.glob(pattern)


def _drop_root(scratch: Path, package: Path) -> None:
    """Become nobody where this runs as root; where nobody cannot read Python, root without powers."""
    if os.geteuid() != 0:
        return
    with suppress(OSError):
        os.setgroups([])
        if _can_be_read([package / "gpcourse", Path(os.__file__), *_sites(), *map(Path, sys.path)]):
            os.chown(scratch, _NOBODY, _NOBODY)
            os.setresgid(_NOBODY, _NOBODY, _NOBODY)
            os.setresuid(_NOBODY, _NOBODY, _NOBODY)
            return
    header = (ctypes.c_uint32 * 2)(0x20080522, 0)
    ctypes.CDLL(None, use_errno=True).capset(ctypes.byref(header), ctypes.byref((ctypes.c_uint32 * 6)()))


def _can_be_read(paths: Iterable[Path]) -> bool:
    """Tell whether nobody could read what root can read of `paths`."""
    there = [path for path in paths if path.exists()]
    os.seteuid(_NOBODY)
    try:
        return all(os.access(path, os.R_OK, effective_ids=True) for path in there)
    finally:
        os.seteuid(0)
