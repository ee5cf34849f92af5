"""The process that workers are forked from: it has numpy, SciPy and the geometry layer loaded already.

It runs no student's code and reads no student's notebook: its children do. It answers three requests on
a socket that was its standard input, each a JSON object in one packet:

- ``fork`` (scratch, limits), with three file descriptors: the child's source of requests, its sink for
  replies, and the file for its last words. The answer has its process id, and a descriptor of the process:
  its number may be another one for whoever asked;
- ``code`` (pid): its exit code as `subprocess` gives it, or null while it is alive;
- ``end`` (pid, scratch): end it, remove its folder, and say its exit code.

When the socket closes, it ends, and its children with it.
"""

from __future__ import annotations

import gc
import json
import os
import signal
import socket
import traceback
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from gpcourse.sandbox import namespaces, worker
from gpcourse.sandbox.landlock import Grant
from gpcourse.sandbox.lockdown import readings

#: What most notebooks import. The rest is imported in the child, where it is needed.
PRELOADED = (
    "gpcourse.geometry.halfedge_mesh",
    "gpcourse.geometry.shapes",
    "gpcourse.geometry.triangles",
    "collections.abc", "dataclasses", "functools", "heapq", "itertools", "math", "typing",
    "scipy.linalg", "scipy.sparse", "scipy.sparse.csgraph", "scipy.sparse.linalg", "scipy.spatial",
)  # fmt: skip

_LARGEST_PACKET = 2**16


def main(modules: Sequence[str], package: str, course: str) -> None:
    """Load `PRELOADED` and `modules`, enter namespaces where that can be done, and serve.

    `package` is the folder that gpcourse is imported from here, `course` the one with the solutions.
    """
    control = socket.socket(fileno=os.dup(0))
    null = os.open(os.devnull, os.O_RDWR)
    os.dup2(null, 0)
    os.close(null)
    for name in (*PRELOADED, *modules):
        # What is not installed fails in the child too, where the student sees it.
        with suppress(ImportError):
            import_module(name)
    view = namespaces.enter(Path(package), Path(course))
    # In namespaces the course is not there; else it has to be left out, folder by folder.
    readable = readings(Path(package), Path(course) if view.missing else None)
    gc.collect()
    gc.freeze()  # so that a collection in a child does not copy our pages
    control.send(json.dumps({"missing": view.missing}).encode())
    Nursery(control, view, readable, package, course).serve()


@dataclass
class Nursery:
    """The socket to the grader, and what all children get."""

    control: socket.socket
    view: namespaces.View
    readable: list[Grant]
    package: str
    course: str

    def serve(self) -> None:
        """Answer requests until the other side is gone."""
        while True:
            data, handles, _, _ = socket.recv_fds(self.control, _LARGEST_PACKET, 3)
            if not data:
                return
            answer = self._answer(json.loads(data), handles)
            process = []
            with suppress(
                KeyError, OSError
            ):  # no new process, or Linux before 5.3, where the number is the same
                process.append(os.pidfd_open(answer["pid"] or 0))
            socket.send_fds(self.control, [json.dumps(answer).encode()], process)
            for handle in process:
                os.close(handle)

    def _answer(self, request: dict[str, Any], handles: Sequence[int]) -> dict[str, int | None]:
        match request["do"]:
            case "fork":
                return {"pid": self._fork(request, handles)}
            case "end":
                return self._end(request["pid"], Path(request["scratch"]))
            case _:
                return self._code(request["pid"])

    def _fork(self, request: dict[str, Any], handles: Sequence[int]) -> int:
        scratch = Path(request["scratch"])
        self.view.make_scratch(scratch, request["size"], request["files"])
        self.view.before_fork()
        pid = os.fork()
        if pid == 0:
            try:
                self._work(scratch, handles, request["limits"])
            except BaseException:  # noqa: BLE001  # who waits for the greeting is told
                os.write(handles[2], traceback.format_exc().encode())
            finally:
                os._exit(70)  # a child must never return into the parent's loop
        for handle in handles:
            os.close(handle)
        return pid

    def _work(self, scratch: Path, handles: Sequence[int], limits: dict[str, int]) -> None:
        self.control.close()
        os.setsid()
        for place, handle in enumerate(handles[:2]):
            os.dup2(handle, place)
            os.close(handle)
        os.chdir(scratch)
        os.environ |= dict.fromkeys(("HOME", "TMPDIR", "TEMP"), str(scratch))
        birth = worker.Birth(handles[2], self.readable, self.view.missing)
        worker.main(limits, self.package, self.course, birth)

    def _code(self, pid: int) -> dict[str, int | None]:
        seen = os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT | os.WNOHANG)
        if seen is None:
            return {"code": None}
        return {"code": seen.si_status if seen.si_code == os.CLD_EXITED else -seen.si_status}

    def _end(self, pid: int, scratch: Path) -> dict[str, int | None]:
        os.kill(pid, signal.SIGKILL)  # until we have waited for it, the number is its own
        os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)
        with suppress(ProcessLookupError, PermissionError):  # what it started, where nothing forbids that
            os.killpg(pid, signal.SIGKILL)
        _, status = os.waitpid(pid, 0)
        self.view.remove_scratch(scratch)
        return {"code": os.waitstatus_to_exitcode(status)}
