"""A time limit on code that runs in this process."""

from __future__ import annotations

import ctypes
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

#: After the limit the interruption is repeated this often, for code that swallows it.
_REPEAT = 0.05


class TimeLimit(BaseException):
    """Raised in code that ran past its deadline. No Exception: ``except Exception`` lets it through."""


@contextmanager
def deadline(seconds: float, wall: float | None = None) -> Iterator[None]:
    """Interrupt the block with `TimeLimit` once it has run for `seconds`.

    That is time on the clock. Where `wall` is given, and this is the main thread of a POSIX system, it is
    processor time, which does not grow while others keep the machine busy; and the block is also
    interrupted after `wall` seconds on the clock, since what waits uses none.

    Works on endless Python loops. A call that stays inside compiled code is interrupted when
    it returns to Python; only another process can end one that never does.
    """
    if hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread():
        with _by_signal(seconds, wall):
            yield
    else:
        with _by_thread(seconds):
            yield


@contextmanager
def _by_signal(seconds: float, wall: float | None) -> Iterator[None]:
    running = True

    def interrupt(signum: int, frame: FrameType | None) -> None:
        if running:
            raise TimeLimit

    timers = [(signal.SIGALRM, signal.ITIMER_REAL, seconds if wall is None else wall)]
    if wall is not None:
        timers.append((signal.SIGPROF, signal.ITIMER_PROF, seconds))
    before = [signal.signal(number, interrupt) for number, _, _ in timers]
    try:
        for _, timer, after in timers:
            signal.setitimer(timer, after, _REPEAT)
        yield
    finally:
        running = False  # from here on a late alarm does nothing
        for (number, timer, _), handler in zip(timers, before, strict=True):
            signal.setitimer(timer, 0)
            signal.signal(number, handler)


@contextmanager
def _by_thread(seconds: float) -> Iterator[None]:
    """For Windows and for threads: a second thread plants the exception in this one."""
    target = threading.get_ident()
    lock = threading.Lock()
    done = threading.Event()
    planted = threading.Event()

    def watch() -> None:
        wait = seconds
        while not done.wait(wait):
            with lock:
                if not done.is_set():
                    planted.set()
                    _plant(target)
            wait = _REPEAT

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        _stop(lock, done, planted, target)
        watcher.join()


def _stop(lock: threading.Lock, done: threading.Event, planted: threading.Event, target: int) -> None:
    """End the watch, and leave no exception behind that was planted and not yet raised.

    It is raised here and not taken back: the interpreter would go on looking for it in every loop of every
    thread (and, in 3.11 under a profiler, do nothing else).
    """
    while True:
        try:
            with lock:
                done.set()
            if planted.is_set():
                _plant(target)
                while True:
                    time.sleep(0)
            return
        except TimeLimit:
            if done.is_set():
                return


def _plant(thread: int) -> None:
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(TimeLimit))
