"""What this machine could confine student code with, found by trying."""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from gpcourse.sandbox.home import PACKAGE

_SYS_LANDLOCK_CREATE_RULESET = 444  # the same on every architecture
_PR_SET_SECCOMP, _SECCOMP_MODE_FILTER = 22, 2

_MEMORY_LIMIT = """
import resource
resource.setrlimit(resource.RLIMIT_AS, (2**28, 2**28))
try:
    bytearray(2**30)
except MemoryError:
    print("works")
"""
_NAMESPACE = """
import sys
sys.path.insert(0, {package!r})
from pathlib import Path
from gpcourse.sandbox.namespaces import enter
print(*(enter(Path({scratch!r}), Path({scratch!r})).missing or ["works"]))
"""
_SECONDS = 20.0


@dataclass(frozen=True)
class Layer:
    """One means of confinement: whether it works here, and what it does or why it does not work."""

    name: str
    works: bool
    words: str


def probe() -> tuple[Layer, ...]:
    """Try each layer and say how it went. Takes about a second; changes nothing in this process."""
    return tuple(_layers())


def _layers() -> Iterator[Layer]:
    yield Layer("own process", _in_child("print('works')") == "works", "crashes and endless loops stay apart")
    memory = _in_child(_MEMORY_LIMIT) if sys.platform != "win32" else "this system has none"
    yield _layer("resource limits", memory, "memory, processor time and file size are limited")
    if not sys.platform.startswith("linux"):
        for name in ("namespaces", "Landlock", "seccomp"):
            yield Layer(name, False, f"{platform.system()} has none")
        return
    yield _layer("namespaces", _namespaces(), "files, network and other processes are not there at all")
    yield _landlock()
    yield _seccomp()


def _layer(name: str, seen: str, words: str) -> Layer:
    return Layer(name, seen == "works", words if seen == "works" else seen)


def _in_child(code: str) -> str:
    return _output([sys.executable, "-I", "-c", code])


def _output(command: list[str]) -> str:
    """Return the last line that a command prints, or the word for what went wrong."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_SECONDS, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"could not be tried: {error}"
    lines = (done.stdout or done.stderr).strip().splitlines()
    return lines[-1] if lines else f"it ended with exit code {done.returncode}"


def _namespaces() -> str:
    with tempfile.TemporaryDirectory(prefix="gpcourse-") as folder:
        scratch = Path(folder) / "package"
        scratch.mkdir()
        code = _NAMESPACE.format(package=str(PACKAGE.parent), scratch=str(scratch))
        return _in_child(code).removeprefix("namespaces: ")


def _libc() -> Callable[..., int]:
    call: Callable[..., int] = ctypes.CDLL(None, use_errno=True).syscall
    return call


def _landlock() -> Layer:
    version = _libc()(_SYS_LANDLOCK_CREATE_RULESET, None, ctypes.c_size_t(0), ctypes.c_uint32(1))
    if version > 0:
        return Layer(
            "Landlock", True, f"version {version} of its interface: what may be read and written is limited"
        )
    return Layer("Landlock", False, f"the kernel says: {os.strerror(ctypes.get_errno())}")


def _seccomp() -> Layer:
    """Offer a filter at address 0: a kernel that has filters complains about the address."""
    ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_SECCOMP, _SECCOMP_MODE_FILTER, None, 0, 0)
    seen = ctypes.get_errno()
    if seen in (errno.EFAULT, errno.EACCES):
        return Layer("seccomp", True, "system calls can be refused")
    return Layer("seccomp", False, f"the kernel says: {os.strerror(seen)}")
