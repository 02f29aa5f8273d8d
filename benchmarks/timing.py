"""Timing contestants in turns, and what the timings say."""

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

REPETITIONS = 5

# Ends with its parent, also where that was killed.
_SPIN = """
import os, sys
parent = os.getppid()
os.sched_setaffinity(0, [int(sys.argv[1])])
os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
while os.getppid() == parent:
    for _ in range(100_000):
        pass
"""
_AWAKE_BY = 0.3  # seconds that the spinning processes have to start


def seconds_of(call: Callable[[], Any]) -> float:
    """Wall-clock seconds of one call, which must not return before its result is there."""
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


@contextmanager
def cores_awake() -> Iterator[None]:
    """Keep the cores from sleeping, each by a process that runs only where nothing else would.

    What the boot option idle=poll does. A virtual machine's host takes an idle core away, and
    may give two of them one core of its own for the next 100 ms. Linux only.
    """
    cores = sorted(os.sched_getaffinity(0))
    spinning = [subprocess.Popen([sys.executable, "-S", "-c", _SPIN, str(core)]) for core in cores]
    try:
        time.sleep(_AWAKE_BY)
        yield
    finally:
        for process in spinning:
            process.kill()
        for process in spinning:
            process.wait()


def in_turns(
    contestants: Mapping[str, Callable[[], Any]], repetitions: int = REPETITIONS, warm: bool = True
) -> dict[str, dict[str, Any]]:
    """Time contestants in alternation, so that a slow minute of the machine hits all of them.

    Args:
        contestants: by name; each call must not return before its result is there.
        repetitions: timed calls of each.
        warm: call each once before, to warm up and compile.

    Returns:
        Per name: "seconds" (of each timed call), "median" and "first" (of the warm-up, or None).
    """
    first = {name: seconds_of(call) if warm else None for name, call in contestants.items()}
    seconds: dict[str, list[float]] = {name: [] for name in contestants}
    for _ in range(repetitions):
        for name, call in contestants.items():
            seconds[name].append(seconds_of(call))
    return {
        name: {"first": first[name], "median": statistics.median(taken), "seconds": taken}
        for name, taken in seconds.items()
    }


def spread(seconds: Sequence[float]) -> str:
    """How far the slowest and the fastest of some timings lie from their median."""
    median = statistics.median(seconds)
    return f"{min(seconds) / median - 1:+.0%} .. {max(seconds) / median - 1:+.0%}"
