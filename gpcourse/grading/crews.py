"""Who marks a class: threads of this process, or processes of this machine (`cluster` has the third crew)."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    as_completed,
    wait,
)
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from multiprocessing.connection import wait as wait_for
from typing import Self

from gpcourse.errors import WorkerError
from gpcourse.grading.marking import (
    Crossing,
    Marked,
    Marker,
    Task,
    launcher,
    made_home,
    mark_there,
    not_marked,
    received,
)
from gpcourse.grading.submission import Submission
from gpcourse.sandbox.confine import Launch, Limits
from gpcourse.sandbox.lockdown import Confinement

#: Up to so many submissions at a time threads are enough: most of the work is in the workers.
THREADS = 4
#: A process of its own is worth its start for so many submissions.
WORTH = 8

Marks = Generator[Marked, None, None]


class Here:
    """This machine as a crew. Use it in a ``with`` block.

    Parameters
    ----------
    jobs : int
        How many submissions are marked at a time.
    fonts : bool
        Whether a notebook uses Matplotlib.
    """

    def __init__(self, jobs: int, *, fonts: bool) -> None:
        self.jobs = jobs
        self.fonts = fonts
        self._opened = ExitStack()

    def __enter__(self) -> Self:
        self._package = self._opened.enter_context(made_home(fonts=self.fonts))
        self._start = self._opened.enter_context(launcher(self._package, fonts=self.fonts))
        return self

    def __exit__(self, *_: object) -> None:
        self._opened.close()

    def confinement(self) -> Confinement:
        """Start a worker, and return the confinement that it reached.

        Raises
        ------
        WorkerError
            If none can be started.
        """
        line = self._start(self._package, Limits())
        line.close()
        return line.confinement

    def mark(self, task: Task, left: Sequence[Submission]) -> Marks:
        """Mark submissions; yield them as they are done."""
        task = replace(task, package=self._package)
        if self.jobs > THREADS and len(left) >= WORTH * self.jobs:
            return in_processes(task, left, self.jobs)
        return in_threads(task, left, self.jobs, self._start)


def in_threads(task: Task, left: Sequence[Submission], jobs: int, start: Launch | None = None) -> Marks:
    """Mark submissions in threads of this process, with workers from `start`."""
    with Marker(task, jobs, start) as marker, ThreadPoolExecutor(jobs) as pool:
        try:
            # No list of them is kept: one that was read is let go, and so is what it holds.
            for future in as_completed([pool.submit(marker.mark, s) for s in left]):
                yield future.result()
        except BaseException:
            marker.stop()  # Ctrl-C
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def in_processes(task: Task, left: Sequence[Submission], jobs: int) -> Marks:
    """Mark submissions in processes, each with a memory of its own.

    Should one end, what was being marked is marked again, one after the other: the submission that ends a
    process once more gets a row that says so, and costs no other its points.
    """
    waiting = deque(left)
    while waiting:
        with _processes(jobs) as pool:
            lost = yield from through(pool, task, waiting, 2 * jobs)
        doubtful = deque(lost)
        while doubtful:
            with _processes(1) as pool:
                guilty = yield from through(pool, task, doubtful, 1)
            for submission in guilty:
                yield not_marked(submission, task, "the process that judged it has ended, twice")


def through(
    pool: Executor,
    task: Task,
    waiting: deque[Submission],
    most: int,
    ended: tuple[type[BaseException], ...] = (),
) -> Generator[Marked, None, list[Submission]]:
    """Hand out submissions, `most` at a time, until none is waiting or the pool is broken.

    Returns those that were in work when their process ended; `ended` are the exceptions that say so.
    """
    at_work: dict[Future[Crossing], Submission] = {}
    lost: list[Submission] = []
    while waiting or at_work:
        try:
            while waiting and len(at_work) < most:
                future = pool.submit(mark_there, task, waiting[0])
                at_work[future] = waiting.popleft()
            for future in wait(at_work, return_when=FIRST_COMPLETED).done:
                if isinstance(future.exception(), ended):
                    lost.append(at_work.pop(future))
                    continue
                marked = received(future.result(), task)
                del at_work[future]
                yield marked
        except BrokenExecutor:
            return [*lost, *at_work.values()]
    return lost


@contextmanager
def _processes(jobs: int) -> Iterator[Executor]:
    """Yield a pool of processes, which end with the block, and with this process however it ends."""
    before = set(multiprocessing.active_children())
    # Not forked: this process may have threads.
    pool = ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _begin)
    try:
        try:
            pool.submit(os.getpid).result()
        except BrokenExecutor:
            raise WorkerError(
                "no process can be started to judge in; a script that calls grade() has to do so below "
                'if __name__ == "__main__":, or with jobs=1'
            ) from None
        yield pool
    except BaseException:
        for process in set(multiprocessing.active_children()) - before:
            process.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _begin() -> None:
    """Prepare a process of the pool: Ctrl-C is for the one that hands out the work, and ends with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def follow() -> None:
        wait_for([parent.sentinel] if parent else [])
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()
