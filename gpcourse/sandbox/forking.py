"""A parent that is started once and forks a worker for each notebook, seen from the grader."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gpcourse.errors import WorkerError
from gpcourse.sandbox import confine, home
from gpcourse.sandbox.line import Line

#: Seconds that the parent gets to fork, or to end a child.
PATIENCE = 30.0

_BOOT = """
import sys
sys.path[:] = [{home!r}] + [p for p in sys.path if p != {course!r}]
from gpcourse.sandbox import parent
parent.main({modules!r}, {home!r}, {package!r})
"""


class Parent:
    """Starts workers by forking them. Use it in a ``with`` block; threads may share it.

    A parent that has ended is replaced; its workers ended with it.

    Parameters
    ----------
    package : Path
        A folder made by `home.build`.
    modules : sequence of str
        What is loaded beforehand besides `parent.PRELOADED`.
    """

    def __init__(self, package: Path, modules: tuple[str, ...] = ()) -> None:
        self.package = package
        self.modules = modules
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None
        self._namespaced = False

    def __enter__(self) -> Parent:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def launch(self, package: Path, limits: confine.Limits) -> Line:
        """Fork a worker, and return the line to it; `package` is the one of this parent.

        Raises
        ------
        WorkerError
            If no process can be started.
        """
        scratch = Path(tempfile.mkdtemp(prefix="scratch-", dir=package.parent))
        theirs_in, ours_out = os.pipe()
        ours_in, theirs_out = os.pipe()
        last_words = tempfile.TemporaryFile()  # noqa: SIM115  # the line closes it
        request = {
            "do": "fork", "scratch": str(scratch), "limits": limits.resources,
            "size": limits.scratch, "files": limits.files,
        }  # fmt: skip
        try:
            answer, parent = self._fork(request, [theirs_in, theirs_out, last_words.fileno()])
        except WorkerError:
            for handle in (ours_in, ours_out):
                os.close(handle)
            last_words.close()
            raise
        finally:
            os.close(theirs_in)
            os.close(theirs_out)
        process = Forked(self, parent, answer.get("seen", answer["pid"]), answer["pid"], str(scratch))
        folder = Path(f"/proc/{parent}/root{scratch}") if self._namespaced else scratch
        return confine.greeted(
            Line(process, ours_out, ours_in, scratch, folder=folder, last_words=last_words), limits
        )

    def _fork(self, request: dict[str, Any], handles: list[int]) -> tuple[dict[str, Any], int]:
        for _ in range(2):  # a parent that something has ended is replaced once
            with self._lock:
                try:
                    process = self._started()
                    return self._exchange(request, handles), process.pid
                except OSError as error:
                    reason = error
                    self._forget()
        raise WorkerError(f"no process could be forked for a notebook: {reason}")

    def ask(self, parent: int, **request: object) -> int | None:
        """Ask the parent `parent` for the exit code of a child; -9 if that parent is gone."""
        with self._lock:
            if self._process is None or self._process.pid != parent:
                return -9
            try:
                code: int | None = self._exchange(request, [])["code"]
            except OSError:
                self._forget()
                return -9
            return code

    def close(self) -> None:
        """End the parent, and its workers with it."""
        with self._lock:
            self._forget()

    def _started(self) -> subprocess.Popen[bytes]:
        if self._process is not None:
            return self._process
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        boot = _BOOT.format(
            home=str(self.package),
            course=str(home.PACKAGE.parent),
            package=str(home.PACKAGE),
            modules=self.modules,
        )
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, *confine.OPTIONS, "-c", boot],
                stdin=theirs.fileno(),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd=self.package,
                env=confine.environment(self.package, self.package),
                start_new_session=True,
            )
        self._control = ours
        ours.settimeout(confine.START)
        self._namespaced = not self._received()["missing"]
        ours.settimeout(PATIENCE)
        return self._process

    def _exchange(self, request: dict[str, Any], handles: list[int]) -> dict[str, Any]:
        if self._control is None:
            raise ConnectionError("it is not running")
        socket.send_fds(self._control, [json.dumps(request).encode()], handles)
        return self._received()

    def _received(self) -> dict[str, Any]:
        if self._control is None:
            raise ConnectionError("it is not running")
        data, handles, _, _ = socket.recv_fds(self._control, 2**16, 1)
        seen = [_number(handle) for handle in handles]
        if not data:
            raise ConnectionError("its process has ended")
        answer: dict[str, Any] = json.loads(data)
        return answer | {"seen": seen[0]} if seen else answer

    def _forget(self) -> None:
        if self._control is not None:
            self._control.close()
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._process = self._control = None


@dataclass
class Forked:
    """A child of a parent. Its number is `pid` here, and `number` where the parent is."""

    family: Parent
    parent: int
    pid: int
    number: int
    scratch: str
    _code: int | None = field(default=None, init=False)

    def code(self) -> int | None:
        """Return its exit code, negative for the number of a signal; None while it runs."""
        if self._code is not None:
            return self._code
        return self.family.ask(self.parent, do="code", pid=self.number)

    def end(self) -> int:
        """End it, wait for that, and return its exit code."""
        if self._code is None:
            self._code = self.family.ask(self.parent, do="end", pid=self.number, scratch=self.scratch)
        return -9 if self._code is None else self._code


def _number(handle: int) -> int:
    """Return the number that a process has here, and close its descriptor."""
    try:
        text = Path(f"/proc/self/fdinfo/{handle}").read_text("ascii")
    finally:
        os.close(handle)
    return int(text.split("Pid:")[1].split()[0])


def can_fork() -> bool:
    """Tell whether this system has what a parent needs."""
    return sys.platform.startswith("linux")
