"""One worker process and the two pipes to it."""

from __future__ import annotations

import contextlib
import os
import selectors
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

from gpcourse.errors import WireError
from gpcourse.sandbox import wire
from gpcourse.sandbox.call import Status
from gpcourse.sandbox.lockdown import LEVELS, Confinement
from gpcourse.sandbox.worker import CRASH_FILE


class Gone(Exception):
    """The process did not answer. `status` is that of the `Answer` that says so."""

    def __init__(self, status: Status, message: str, place: str = "") -> None:
        super().__init__(message)
        self.status = status
        self.place = place


class Line:
    """One worker process, and the two pipes to it."""

    def __init__(self, process: subprocess.Popen[bytes], scratch: Path) -> None:
        self.process = process
        self.scratch = scratch
        self.number = 0
        self.closed = False
        self.confinement = Confinement()
        pipes = process.stdin, process.stdout
        self.sink, self.source = (pipe.fileno() for pipe in pipes if pipe is not None)

    def greet(self, seconds: float) -> None:
        """Read the first frame, which says how far the worker is confined, or raise `Gone`."""
        try:
            said = wire.unpack(self._exchange(b"", time.monotonic() + seconds))
            level = said["level"]
            self.confinement = Confinement(LEVELS[LEVELS.index(level)], tuple(map(str, said["missing"])))
        except TimeoutError:
            raise self._gone("timeout", f"it was not ready after {seconds:g} s") from None
        except (OSError, EOFError):
            raise self._gone("crashed") from None
        except (WireError, TypeError, KeyError, ValueError) as error:
            raise self._gone("crashed", f"its greeting could not be read: {error}") from None

    def request(self, do: str, seconds: float, **content: Any) -> dict[Any, Any]:
        """Send a request and return the reply, or raise `Gone` after `seconds`, with the process ended.

        Raises WireError if the request cannot be sent as a frame: nothing happens to the process then.
        """
        self.number += 1
        frame = wire.pack({"number": self.number, "do": do, **content})
        try:
            answer = wire.unpack(self._exchange(frame, time.monotonic() + seconds))
        except TimeoutError:
            dead = self.process.poll() is not None  # somebody else holds its pipe open
            raise self._gone("crashed" if dead else "timeout") from None
        except (OSError, EOFError):
            raise self._gone("crashed") from None
        except WireError as error:
            raise self._gone("crashed", f"its answer could not be read: {error}") from None
        if not isinstance(answer, dict) or answer.get("number") != self.number:
            raise self._gone("crashed", "it gave an answer that nobody had asked for")
        return answer

    def _gone(self, status: Status, message: str = "") -> Gone:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(0 if status == "timeout" else 1.0)
        code = self.process.poll()
        place = self._crash_place()
        self.close()
        if not message:
            message = "the call did not come back" if status == "timeout" else _ending(code)
        return Gone(status, message, place)

    def _crash_place(self) -> str:
        with contextlib.suppress(OSError), (self.scratch / CRASH_FILE).open("rb") as file:
            return file.read(4096).decode("ascii", "replace")
        return ""

    def _exchange(self, frame: bytes, until: float) -> bytes:
        if sys.platform == "win32":
            return self._exchange_blocking(frame, until)
        self._send(memoryview(frame), until)
        head = self._read(wire.HEAD.size, until)
        return head + self._read(sum(wire.lengths(head)), until)

    def _send(self, rest: memoryview, until: float) -> None:
        os.set_blocking(self.sink, False)
        while rest:
            _wait([], [self.sink], until)
            with contextlib.suppress(BlockingIOError):
                rest = rest[os.write(self.sink, rest) :]

    def _read(self, length: int, until: float) -> bytes:
        os.set_blocking(self.source, False)
        parts, missing = [], length
        while missing:
            _wait([self.source], [], until)
            with contextlib.suppress(BlockingIOError):
                part = os.read(self.source, min(missing, 2**20))
                if not part:
                    raise EOFError
                parts.append(part)
                missing -= len(part)
        return b"".join(parts)

    def _exchange_blocking(self, frame: bytes, until: float) -> bytes:
        """For Windows, where one cannot wait for a pipe: the process is killed from a second thread."""
        late = threading.Event()

        def kill() -> None:
            late.set()
            self.kill()

        timer = threading.Timer(max(until - time.monotonic(), 0.0), kill)
        timer.start()
        try:
            rest = memoryview(frame)
            while rest:
                rest = rest[os.write(self.sink, rest) :]
            head = _read_blocking(self.source, wire.HEAD.size)
            return head + _read_blocking(self.source, sum(wire.lengths(head)))
        except (OSError, EOFError):
            if late.is_set():
                raise TimeoutError from None
            raise
        finally:
            timer.cancel()

    def kill(self) -> None:
        """End the process and those it started, unless they went into a session of their own."""
        if self.closed:  # its number may be another process's by now
            return
        with contextlib.suppress(OSError):
            if sys.platform == "win32":
                self.process.kill()
            else:
                os.killpg(self.process.pid, signal.SIGKILL)
        self.process.kill()

    def close(self) -> None:
        """End the process, close the pipes and remove its folder."""
        self.kill()
        self.closed = True
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            with contextlib.suppress(OSError):
                if pipe is not None:
                    pipe.close()
        shutil.rmtree(self.scratch, ignore_errors=True)


def _ending(code: int | None) -> str:
    if code is not None and code < 0:
        with contextlib.suppress(ValueError):
            return f"the Python process was ended by {signal.Signals(-code).name}"
    return f"the Python process ended itself with exit code {code}"


def _wait(read: list[int], write: list[int], until: float) -> None:
    with selectors.DefaultSelector() as selector:
        for fd in read:
            selector.register(fd, selectors.EVENT_READ)
        for fd in write:
            selector.register(fd, selectors.EVENT_WRITE)
        if not selector.select(max(until - time.monotonic(), 0.0)):
            raise TimeoutError


def _read_blocking(fd: int, length: int) -> bytes:
    parts, missing = [], length
    while missing:
        part = os.read(fd, min(missing, 2**20))
        if not part:
            raise EOFError
        parts.append(part)
        missing -= len(part)
    return b"".join(parts)
