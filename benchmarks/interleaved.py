"""Time several libraries at one task, side by side.

Machines are noisy and shared. Every round runs each contender once (A B C, A B C, …), so that a slow
minute slows all of them, and the ratio of the medians keeps its meaning when the times do not.
"""

from __future__ import annotations

import gc
import json
import math
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

#: A task that is ready to run: its input is prepared, and its library imported.
Task = Callable[[], object]

#: OpenBLAS settings for one kind of processor. One without the other misleads it, so both go.
_OPENBLAS_SETTINGS = ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE")


@dataclass(frozen=True)
class Result:
    """What one contender took for one case. Times in seconds, memory in bytes (None where unknown)."""

    case: str
    faces: int
    contender: str
    seconds: tuple[float, ...]
    cpu_seconds: tuple[float, ...]
    peak_memory: int | None

    @property
    def median(self) -> float:
        """The median time on the clock, in seconds."""
        return statistics.median(self.seconds)

    @property
    def cpu_least(self) -> float:
        """The least time of the processor, in seconds: others can only add to it, by emptying its caches."""
        return min(self.cpu_seconds)


def forget_openblas_settings() -> None:
    """Remove OpenBLAS settings from the environment; call it before numpy is imported."""
    for name in _OPENBLAS_SETTINGS:
        os.environ.pop(name, None)


def interleave(tasks: dict[str, Task], repeat: int, warm_up: int = 2) -> dict[str, list[tuple[float, float]]]:
    """Run every task `warm_up` times, then `repeat` rounds of all tasks.

    Returns the times of each task by name: pairs of seconds on the clock and of the processor.
    """
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in tasks}
    for task in warm_up * list(tasks.values()):
        task()
    for _ in range(repeat):
        for name, task in tasks.items():
            gc.collect()
            start, cpu_start = time.perf_counter(), time.process_time()
            outcome = task()
            times[name].append((time.perf_counter() - start, time.process_time() - cpu_start))
            del outcome
    return times


def peak_memory_of(task: Task) -> int | None:
    """Return by how many bytes the memory of this process rises above what it holds now, at most.

    Exact on Linux, where the high-water mark can be reset. None on other systems.
    """
    status, reset = Path("/proc/self/status"), Path("/proc/self/clear_refs")
    if not reset.exists():
        return None

    def read(field: str) -> int:
        (line,) = [line for line in status.read_text().splitlines() if line.startswith(field + ":")]
        return int(line.split()[1]) * 1024

    gc.collect()
    reset.write_text("5")
    before = read("VmRSS")
    outcome = task()
    peak = read("VmHWM") - before
    del outcome
    return peak


def peak_memory_in_a_fresh_process(script: str, *arguments: str) -> int | None:
    """Run ``script --memory-of …``, which prints `peak_memory_of` as JSON, in a process of its own."""
    command = [sys.executable, script, "--memory-of", *arguments]
    seen = subprocess.run(command, capture_output=True, text=True, check=True)
    value = json.loads(seen.stdout)
    return None if value is None else int(value)


def table(results: Sequence[Result], ours: str) -> str:
    """Lay out the results of one case."""
    own = next(result for result in results if result.contender == ours)
    lines = [f"{'':<26}{'median':>10}{'ours / it':>11}{'least cpu':>12}{'ours / it':>11}{'memory':>9}"]
    for result in results:
        ratio, cpu_ratio = own.median / result.median, own.cpu_least / result.cpu_least
        ratios = ("", "") if result is own else (f"{ratio:.2f}", f"{cpu_ratio:.2f}")
        memory = "–" if result.peak_memory is None else f"{result.peak_memory / 1e6:.0f} MB"
        lines.append(
            f"{result.contender:<26}{1e3 * result.median:>7.1f} ms{ratios[0]:>11}"
            f"{1e3 * result.cpu_least:>9.1f} ms{ratios[1]:>11}{memory:>9}"
        )
    return "\n".join(lines)


def growth(results: Sequence[Result]) -> float:
    """Return the exponent p of processor time ~ faces**p between the smallest and the largest case."""
    small, large = min(results, key=lambda r: r.faces), max(results, key=lambda r: r.faces)
    return math.log(large.cpu_least / small.cpu_least) / math.log(large.faces / small.faces)
