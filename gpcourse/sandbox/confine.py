"""Starting the process that student code runs in.

`launcher` is the seam: it yields a function that starts the same `worker.main` and returns a `Line`. On
Linux the process is forked from a parent that has numpy loaded already and lives in namespaces
(`forking`); elsewhere it is started afresh (`launch`).

What both give: a process in a session and a working folder of its own, with a clean environment,
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
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from gpcourse.errors import WorkerError
from gpcourse.sandbox import home
from gpcourse.sandbox.line import Gone, Line
from gpcourse.sandbox.lockdown import Confinement, Level
from gpcourse.sandbox.process import Fresh

_THREADS = ("OPENBLAS", "OMP", "MKL", "NUMEXPR", "VECLIB_MAXIMUM")
_KEPT = ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE", "SYSTEMROOT", "WINDIR")
#: Options of Python: like -I, but with the fixed hash seed of the environment, so that sets of strings have
#: one order.
OPTIONS = ("-s", "-P", "-B", "-W", "ignore")
#: Seconds until a process is ready.
START = 120.0

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
        Seconds of processor time to read the notebook, and to run what one function needs.
    memory, file : int
        Bytes of address space, and of one file that it writes.
    scratch, files : int
        Bytes and number of all files that it writes; only namespaces can limit that.
    processor : int
        Seconds of processor time in all.
    start : float
        Seconds until it is ready for a notebook.
    patience : float
        What takes so many times its limit, and a second more, on the clock is taken to hang.
    threads : int
        Threads of all workers together, and of whoever else runs as the same user.
    answers : int
        Bytes of memory that the answers of one function may take together here: they are kept for the report.
    least : Level
        The confinement that it must reach; it gets no notebook otherwise.
    """

    load: float = 20.0
    memory: int = 3 * 2**30
    processor: int = 600
    file: int = 64 * 2**20
    scratch: int = 128 * 2**20
    files: int = 2000
    start: float = START
    patience: float = 10.0
    threads: int = 4096
    answers: int = 64 * 2**20
    least: Level = "limits"

    def wall(self, seconds: float) -> float:
        """Return after how many seconds on the clock a call of so many `seconds` of processor time hangs."""
        return self.patience * (seconds + 1.0)

    @property
    def resources(self) -> dict[str, int]:
        """The limits by their names in `resource`."""
        return {
            "RLIMIT_AS": self.memory,
            "RLIMIT_CPU": self.processor,
            "RLIMIT_FSIZE": self.file,
            "RLIMIT_NOFILE": 256,
            "RLIMIT_CORE": 0,
            "RLIMIT_NPROC": self.threads,
        }


#: ``launch(package, limits)`` starts a worker and returns the line to it.
Launch = Callable[[Path, Limits], Line]


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
            [sys.executable, *OPTIONS, "-c", boot],
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
    if process.stdin is None or process.stdout is None:
        raise WorkerError("a process for a notebook has no pipes")
    sink, source = (os.dup(pipe.fileno()) for pipe in (process.stdin, process.stdout))
    process.stdin.close()
    process.stdout.close()
    return greeted(Line(Fresh(process), sink, source, scratch), limits)


@contextmanager
def launcher(package: Path, modules: tuple[str, ...] = ()) -> Iterator[Launch]:
    """Yield the quickest and strongest way to start workers here; all end with the block.

    Parameters
    ----------
    package : Path
        A folder made by `home.build`.
    modules : tuple of str
        What is worth loading once for all workers, besides numpy and SciPy.
    """
    from gpcourse.sandbox.forking import Parent, can_fork

    if not can_fork():
        yield launch
        return
    with Parent(package, modules) as parent:
        yield parent.launch


def greeted(line: Line, limits: Limits) -> Line:
    """Wait until the worker says how far it is confined; it has run nothing of a student's until then."""
    try:
        line.greet(limits.start)
    except Gone as gone:
        raise WorkerError(f"a process for a notebook did not start: {gone} {gone.place}") from None
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
        package = home.build(Path(root) / "home")
        with launcher(package) as start:
            line = start(package, Limits())
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
