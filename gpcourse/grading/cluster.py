"""A crew beyond this machine: the workers of a Dask cluster."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from typing import Any, Self

from gpcourse.errors import UsageError
from gpcourse.grading.crews import Marks, through
from gpcourse.grading.marking import Task, not_marked
from gpcourse.grading.submission import Submission
from gpcourse.sandbox.confine import level_here
from gpcourse.sandbox.lockdown import LEVELS, Confinement

#: Seconds that a scheduler gets to answer.
PATIENCE = 10


class Cluster:
    """A cluster of Dask, found by its scheduler's address. Use it in a ``with`` block.

    Raises
    ------
    UsageError
        If it cannot be used, or is gone while it is.
    """

    def __init__(self, address: str) -> None:
        self.address = address

    def __enter__(self) -> Self:
        try:
            from distributed import Client
        except ImportError:
            raise UsageError(
                "--scheduler needs the package distributed: pip install 'gpcourse[cluster]'"
            ) from None
        try:
            client: Any = Client  # it has no types
            self._client = client(self.address, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            raise UsageError(
                f"no scheduler answers at {self.address}: {error}. Start one with: dask scheduler; it prints "
                "its address, as tcp://10.0.0.5:8786"
            ) from None
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close()

    def confinement(self) -> Confinement:
        """Return the least confinement that a worker reaches, with its address."""
        with self._staying():
            here = self._client.run(level_here)
        if not here:
            raise UsageError(
                f"the scheduler at {self.address} has no workers; start some with: dask worker {self.address}"
            )
        address, least = min(here.items(), key=lambda item: LEVELS.index(item[1].level))
        missing = tuple(f"{reason} (on {address})" for reason in least.missing)
        return Confinement(least.level, missing)

    def mark(self, task: Task, left: Sequence[Submission]) -> Marks:
        """Mark submissions on the workers; one of which each ends is marked once more, alone."""
        from distributed import KilledWorker

        with self._staying():
            pool = self._client.get_executor(pure=False)
            most = 2 * sum(self._client.nthreads().values())
            lost = yield from through(pool, task, deque(left), most, (KilledWorker,))
            guilty = yield from through(pool, task, deque(lost), 1, (KilledWorker,))
            for submission in guilty:
                yield not_marked(submission, task, "every process that judged it has ended")

    @contextmanager
    def _staying(self) -> Iterator[None]:
        try:
            yield
        except (CancelledError, OSError) as error:
            raise UsageError(
                f"the scheduler at {self.address} is gone: {error or 'it was stopped'}; start it again and "
                "give the same command: it goes on where this one stopped"
            ) from error
        except ImportError as error:
            raise UsageError(f"a worker of {self.address} has no gpcourse: {error}") from error
