"""A time limit on code that runs in this process."""

from __future__ import annotations

import ctypes
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

#: After the limit the interruption is repeated this often, for code that swallows it.
_REPEAT = 0.05


class TimeLimit(BaseException):
    """Raised in code that ran past its deadline. No Exception, so that ``except Exception`` lets it through."""


@contextmanager
def deadline(seconds: float) -> Iterator[None]:
    """Interrupt the block with `TimeLimit` once it has run for `seconds` of wall time.

    Works on endless Python loops. A call that stays inside compiled code is interrupted when
    it returns to Python; only another process can end one that never does.
    """
    if hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread():
        with _by_signal(seconds):
            yield
    else:
        with _by_thread(seconds):
            yield


@contextmanager
def _by_signal(seconds: float) -> Iterator[None]:
    running = True

    def interrupt(signum: int, frame: FrameType | None) -> None:
        if running:
            raise TimeLimit

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, seconds, _REPEAT)
        yield
    finally:
        running = False  # from here on a late alarm does nothing
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def _by_thread(seconds: float) -> Iterator[None]:
    """For Windows and for threads: a second thread plants the exception in this one."""
    target = threading.get_ident()
    lock = threading.Lock()
    done = threading.Event()

    def watch() -> None:
        wait = seconds
        while not done.wait(wait):
            with lock:
                if not done.is_set():
                    _plant(target, TimeLimit)
            wait = _REPEAT

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        _undisturbed(lambda: _stop(lock, done, target))
        watcher.join()


def _stop(lock: threading.Lock, done: threading.Event, target: int) -> None:
    with lock:
        done.set()
        _plant(target, None)  # takes back an exception that was planted and not yet raised


def _undisturbed(action: Callable[[], None]) -> None:
    """Run `action` to its end, again if a late interruption falls into it."""
    while True:
        try:
            action()
            return
        except TimeLimit:
            time.sleep(0)


def _plant(thread: int, exception: type[BaseException] | None) -> None:
    kind = None if exception is None else ctypes.py_object(exception)
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), kind)
