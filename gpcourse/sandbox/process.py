"""Worker processes as the grader holds them: one started afresh, or one forked by a parent."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from typing import Protocol


class Process(Protocol):
    """A process that can be ended, and asked whether it has ended."""

    pid: int

    def code(self) -> int | None:
        """Return its exit code, negative for the number of a signal; None while it runs."""

    def end(self) -> int:
        """End it, wait for that, and return its exit code."""


class Fresh:
    """A Python process of its own, in a session of its own."""

    def __init__(self, popen: subprocess.Popen[bytes]) -> None:
        self._popen = popen
        self.pid = popen.pid
        self._ended = False

    def code(self) -> int | None:
        """Return its exit code, negative for the number of a signal; None while it runs."""
        return self._popen.poll()

    def end(self) -> int:
        """End it and those it started, unless they went into a session of their own."""
        if not self._ended:  # its number may be another process's afterwards
            with contextlib.suppress(OSError):
                if sys.platform != "win32":
                    os.killpg(self.pid, signal.SIGKILL)
            self._popen.kill()
            self._ended = True
        return self._popen.wait()


def processor_seconds(pid: int) -> float | None:
    """Return the processor time that a process has used, in s; None where it cannot be read."""
    if not sys.platform.startswith("linux"):
        return None
    try:
        return time.clock_gettime(~pid << 3 | 2)  # how Linux names the clock of another process
    except OSError:  # it has ended
        return None
