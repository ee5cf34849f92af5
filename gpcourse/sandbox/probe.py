"""What this machine could confine student code with, found by trying."""

from __future__ import annotations

import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from gpcourse.sandbox.home import PACKAGE

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
_FORBIDDEN_FILE = """
from gpcourse.sandbox.landlock import confine
def forbidden():
    open(sys.executable, "rb")
"""
_FORBIDDEN_CALL = """
import socket
from gpcourse.sandbox.seccomp import confine
def forbidden():
    socket.socket()
"""
_TRY = """
import sys
sys.path.insert(0, {package!r})
{means}
forbidden()
try:
    confine({arguments})
    forbidden()
    print("it is there and forbids nothing")
except PermissionError:
    print("works")
except OSError as error:
    print(f"the kernel says: {{error.strerror}}")
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
    yield _layer("Landlock", _tried(_FORBIDDEN_FILE), "nothing is read and written but what is granted")
    yield _layer("seccomp", _tried(_FORBIDDEN_CALL), "system calls are refused")


def _layer(name: str, seen: str, words: str) -> Layer:
    return Layer(name, seen == "works", words if seen == "works" else seen)


def _tried(means: str) -> str:
    """Confine a process and let it do what is forbidden then, having done it before."""
    arguments = "[], []" if means is _FORBIDDEN_FILE else ""
    return _in_child(_TRY.format(package=str(PACKAGE.parent), means=means, arguments=arguments))


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
