"""Timing contestants in turns, and what the timings say."""

import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

REPETITIONS = 5


def seconds_of(call: Callable[[], Any]) -> float:
    """Wall-clock seconds of one call, which must not return before its result is there."""
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


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
