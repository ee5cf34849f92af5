"""Starting the process that student code runs in.

`launch` is the seam: a stronger confinement is another function of the same form, which starts the same
`worker.main` in namespaces, or forks it from a process that has numpy loaded already, and returns a `Line`.

What this one gives: a process in a session and a working folder of its own, with a clean environment,
limits of memory, processor time, file size and open files where the system has them; `Line` gives
each question a limit of time; and before it gets a notebook the worker locks itself in (`lockdown`) and says
what level it reached.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from gpcourse.errors import WorkerError
from gpcourse.sandbox import home
from gpcourse.sandbox.line import Gone, Line
from gpcourse.sandbox.lockdown import Confinement, Level

_THREADS = ("OPENBLAS", "OMP", "MKL", "NUMEXPR", "VECLIB_MAXIMUM")
_KEPT = ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE", "SYSTEMROOT", "WINDIR")
_BOOT = """
import sys
sys.path[:] = [{home!r}] + [p for p in sys.path if p != {course!r}]
from gpcourse.sandbox.worker import main
main({limits!r}, {home!r}, {package!r})
"""


@dataclass(frozen=True)
class Limits:
    """What a worker may use.

    Attributes
    ----------
    load : float
        Seconds to read the notebook, and to run what one function needs.
    memory, file : int
        Bytes of address space, and of one file that it writes.
    processor : int
        Seconds of processor time in all.
    start : float
        Seconds until it is ready for a notebook.
    least : Level
        The confinement that it must reach; it gets no notebook otherwise.
    """

    load: float = 20.0
    memory: int = 3 * 2**30
    processor: int = 600
    file: int = 64 * 2**20
    start: float = 120.0
    least: Level = "limits"

    @property
    def resources(self) -> dict[str, int]:
        """The limits by their names in `resource`."""
        return {
            "RLIMIT_AS": self.memory,
            "RLIMIT_CPU": self.processor,
            "RLIMIT_FSIZE": self.file,
            "RLIMIT_NOFILE": 256,
            "RLIMIT_CORE": 0,
        }


def launch(package: Path, limits: Limits) -> Line:
    """Start a worker process that imports gpcourse from `package` (see `home.build`).

    Its working folder is made beside `package`.

    Raises
    ------
    WorkerError
        If the process cannot be started.
    """
    scratch = Path(tempfile.mkdtemp(prefix="scratch-", dir=package.parent))
    boot = _BOOT.format(
        home=str(package),
        course=str(home.PACKAGE.parent),
        package=str(home.PACKAGE),
        limits=limits.resources,
    )
    try:
        process = subprocess.Popen(
            # Like -I, but with the fixed hash seed of the environment below: sets of strings have one order.
            [sys.executable, "-s", "-P", "-B", "-W", "ignore", "-c", boot],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            bufsize=0,
            cwd=scratch,
            env=environment(scratch, package),
            start_new_session=sys.platform != "win32",
        )
    except OSError as error:
        shutil.rmtree(scratch, ignore_errors=True)
        raise WorkerError(f"no process could be started for a notebook: {error}") from error
    return _greeted(Line(process, scratch), limits)


def _greeted(line: Line, limits: Limits) -> Line:
    """Wait until the worker says how far it is confined; it has run nothing of a student's until then."""
    try:
        line.greet(limits.start)
    except Gone as gone:
        raise WorkerError(f"a process for a notebook did not start: {gone}") from None
    except BaseException:
        line.close()
        raise
    if not line.confinement.reaches(limits.least):
        line.close()
        raise WorkerError(
            f"a process for a notebook reached the level {line.confinement.level!r}, not {limits.least!r}: "
            + "; ".join(line.confinement.missing)
        )
    return line


def level_here() -> Confinement:
    """Start a worker, and return the confinement that it reached.

    Raises
    ------
    WorkerError
        If none can be started.
    """
    with tempfile.TemporaryDirectory(prefix="gpcourse-", ignore_cleanup_errors=True) as root:
        line = launch(home.build(Path(root) / "home"), Limits())
        line.close()
        return line.confinement


def environment(scratch: Path, package: Path) -> dict[str, str]:
    """Return the environment of a worker: nothing of ours but what the numerics of this machine need."""
    fixed = {
        "HOME": str(scratch),
        "TMPDIR": str(scratch),
        "TEMP": str(scratch),
        "PATH": os.defpath,
        "LANG": "C.UTF-8",
        "PYTHONUTF8": "1",
        "PYTHONHASHSEED": "0",
        "MPLBACKEND": "Agg",
        "MPLCONFIGDIR": str(package / home.FONTS),
    }
    threads = {f"{name}_NUM_THREADS": "1" for name in _THREADS}
    return fixed | threads | {name: os.environ[name] for name in _KEPT if name in os.environ}
