"""One worker process and the two pipes to it."""

from __future__ import annotations

import contextlib
import math
import os
import select
import signal
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from gpcourse.errors import WireError
from gpcourse.sandbox import folder as folders
from gpcourse.sandbox import wire
from gpcourse.sandbox.call import Status
from gpcourse.sandbox.lockdown import LEVELS, Confinement
from gpcourse.sandbox.process import Process, processor_seconds
from gpcourse.sandbox.worker import CRASH_FILE, REPLY

#: Seconds between two looks at the processor time that a process has used.
_SHORTEST = 0.02
_CORES = os.cpu_count() or 1


class Gone(Exception):
    """The process did not answer. `status` is that of the `Answer` that says so."""

    def __init__(self, status: Status, message: str, place: str = "") -> None:
        super().__init__(message)
        self.status = status
        self.place = place


@dataclass(frozen=True)
class Until:
    """When a wait ends: at a time on the clock, or when the process `pid` has used so much processor time."""

    wall: float
    pid: int = 0
    processor: float = math.inf

    def reached(self) -> bool:
        """Tell whether it is time."""
        return time.monotonic() >= self.wall or self._left() <= 0.0

    def next_look(self) -> float:
        """Return how many seconds from now it may be time at the earliest."""
        # All its threads together may use several seconds in one.
        soonest = max(self._left() / _CORES, _SHORTEST)
        return max(min(self.wall - time.monotonic(), soonest), 0.0)

    def _left(self) -> float:
        used = processor_seconds(self.pid) if self.pid else None
        return math.inf if used is None else self.processor - used


class Line:
    """One worker process, and the two pipes to it."""

    def __init__(
        self,
        process: Process,
        sink: int,
        source: int,
        scratch: Path,
        *,
        folder: Path | None = None,
        last_words: IO[bytes] | None = None,
    ) -> None:
        """Hold a process: what is written to `sink` it reads, what it writes comes from `source`.

        `scratch` is its working folder as it sees it, `folder` the same as it is seen from here. What it says
        of a crash stands in `last_words`, or in a file in its folder.
        """
        self.process = process
        self.sink, self.source = sink, source
        self.scratch = scratch
        self.folder = folder or scratch
        self.last_words = last_words
        self.number = 0
        self.closed = False
        self._inbox = bytearray()
        self._unsent = memoryview(b"")
        if sys.platform != "win32":
            self._poll = select.poll()
            os.set_blocking(sink, False)
            os.set_blocking(source, False)
        self.confinement = Confinement()

    def greet(self, seconds: float) -> None:
        """Read the first frame, which says how far the worker is confined, or raise `Gone`."""
        try:
            until = Until(time.monotonic() + seconds)
            head = self._take(wire.HEAD.size, until)
            said = wire.unpack(head + self._take(sum(wire.lengths(head)), until))
            level = said["level"]
            self.confinement = Confinement(LEVELS[LEVELS.index(level)], tuple(map(str, said["missing"])))
        except TimeoutError:
            raise self._gone("timeout", f"it was not ready after {seconds:g} s") from None
        except (OSError, EOFError):
            raise self._gone("crashed") from None
        except (WireError, TypeError, KeyError, ValueError) as error:
            raise self._gone("crashed", f"its greeting could not be read: {error}") from None

    def request(self, do: str, seconds: float, wall: float, /, **content: Any) -> dict[Any, Any]:
        """Send a request and return the reply, or raise `Gone`, with the process ended.

        It may take `seconds` of processor time, where that can be read, and `wall` seconds on the clock.

        Raises WireError if the request cannot be sent as a frame: nothing happens to the process then.
        """
        if self.closed:  # the numbers of its pipes may be another file's by now
            raise Gone("crashed", "the Python process has ended")
        (frame,) = self.replies(1, seconds, wall, do=do, **content)
        try:
            answer = wire.unpack(frame)
        except WireError as error:
            raise self._gone("crashed", f"its answer could not be read: {error}") from None
        if not isinstance(answer, dict):
            raise self._gone("crashed", "it gave an answer that nobody had asked for")
        return answer

    def replies(
        self, most: int, seconds: float, wall: float, /, *, questions: Sequence[bytes] = (), **content: Any
    ) -> Iterator[bytes]:
        """Send a request, and `questions` after it; yield the frames of up to `most` replies as they come.

        Each may take `seconds` of processor time and `wall` seconds on the clock. If one does not come, raise
        `Gone`, with the process ended. Frames are yielded as they were received: nothing is known of them.
        """
        self.number += 1
        head = wire.pack({"number": self.number, **content})
        self._unsent = memoryview(b"".join([head, *questions]))
        for i in range(most):
            number, place, more, frame = self._reply(self._until(seconds, wall))
            if (number, place) != (self.number, i):
                raise self._gone("crashed", "it gave an answer that nobody had asked for")
            yield frame
            if not more:
                break
        self._finish(self._until(seconds, wall))

    def _reply(self, until: Until) -> tuple[int, int, bool, bytes]:
        with self._seen_to():
            head = self._take(REPLY.size + wire.HEAD.size, until)
            number, place, more = REPLY.unpack(head[: REPLY.size])
            start = head[REPLY.size :]
            return number, place, more, start + self._take(sum(wire.lengths(start)), until)

    def _finish(self, until: Until) -> None:
        """Send what is left of a request after its last reply: the process skips it."""
        with self._seen_to():
            while self._unsent:
                self._turn(until)

    @contextlib.contextmanager
    def _seen_to(self) -> Iterator[None]:
        """Turn what can happen to a pipe into `Gone`."""
        try:
            yield
        except TimeoutError:
            dead = self.process.code() is not None  # somebody else holds its pipe open
            raise self._gone("crashed" if dead else "timeout") from None
        except (OSError, EOFError):
            raise self._gone("crashed") from None
        except WireError as error:
            raise self._gone("crashed", f"its answer could not be read: {error}") from None

    def _gone(self, status: Status, message: str = "") -> Gone:
        # What has closed its pipes is about to end, and then says why.
        late = time.monotonic() + (0.0 if message or status == "timeout" else 1.0)
        while (code := self.process.code()) is None and time.monotonic() < late:
            time.sleep(0.005)
        place = self._crash_place()
        self.close()
        if not message:
            message = "the call did not come back" if status == "timeout" else _ending(code)
        return Gone(status, message, place)

    def _crash_place(self) -> str:
        with contextlib.suppress(OSError):
            if self.last_words is not None:
                return os.pread(self.last_words.fileno(), 4096, 0).decode("ascii", "replace")
            return folders.read_start(self.folder / CRASH_FILE, 4096).decode("ascii", "replace")
        return ""

    def _until(self, seconds: float, wall: float) -> Until:
        used = processor_seconds(self.process.pid)
        now = time.monotonic()
        if used is None:
            return Until(now + wall)
        return Until(now + wall, self.process.pid, used + seconds)

    def _take(self, length: int, until: Until) -> bytes:
        """Return the next so many bytes from the process, while what is unsent is sent."""
        if sys.platform == "win32":
            return self._take_blocking(length, until)
        while len(self._inbox) < length:
            self._turn(until)
        taken = bytes(memoryview(self._inbox)[:length])
        del self._inbox[:length]
        return taken

    def _turn(self, until: Until) -> None:
        """Wait until something can be sent or received, and do that."""
        if sys.platform == "win32":
            self._send_blocking(until)
            return
        self._poll.register(self.source, select.POLLIN)
        if self._unsent:
            self._poll.register(self.sink, select.POLLOUT)
        while not (ready := self._poll.poll(1000 * until.next_look())):
            if until.reached():
                raise TimeoutError
        for handle, _ in ready:
            with contextlib.suppress(BlockingIOError):
                if handle == self.source:
                    part = os.read(self.source, 2**20)
                    if not part:
                        raise EOFError
                    self._inbox += part
                else:
                    self._send()

    def _send(self) -> None:
        try:
            self._unsent = self._unsent[os.write(self.sink, self._unsent) :]
        except BrokenPipeError:  # it has ended: what it said before is still to be read, until its end
            self._unsent = memoryview(b"")
        if not self._unsent:
            self._poll.unregister(self.sink)

    def _take_blocking(self, length: int, until: Until) -> bytes:
        self._send_blocking(until)
        with self._killed_late(until):
            return _read_blocking(self.source, length)

    def _send_blocking(self, until: Until) -> None:
        with self._killed_late(until):
            while self._unsent:
                self._unsent = self._unsent[os.write(self.sink, self._unsent) :]

    @contextlib.contextmanager
    def _killed_late(self, until: Until) -> Iterator[None]:
        """For Windows, where one cannot wait for a pipe: the process is killed from a second thread."""
        late = threading.Event()

        def kill() -> None:
            late.set()
            self.kill()

        timer = threading.Timer(max(until.wall - time.monotonic(), 0.0), kill)
        timer.start()
        try:
            yield
        except (OSError, EOFError):
            if late.is_set():
                raise TimeoutError from None
            raise
        finally:
            timer.cancel()

    def kill(self) -> None:
        """End the process."""
        self.process.end()

    def close(self) -> None:
        """End the process, close the pipes and remove its folder."""
        self.kill()
        if self.closed:
            return
        self.closed = True
        for pipe in (self.sink, self.source):
            os.close(pipe)
        if self.last_words is not None:
            self.last_words.close()
        folders.remove(self.scratch)


def _ending(code: int | None) -> str:
    if code is not None and code < 0:
        with contextlib.suppress(ValueError):
            return f"the Python process was ended by {signal.Signals(-code).name}"
    return f"the Python process ended itself with exit code {code}"


def _read_blocking(fd: int, length: int) -> bytes:
    parts, missing = [], length
    while missing:
        part = os.read(fd, min(missing, 2**20))
        if not part:
            raise EOFError
        parts.append(part)
        missing -= len(part)
    return b"".join(parts)
