"""Cost per episode from a thousand to a hundred thousand episodes."""

import statistics
from functools import partial
from typing import Any

from benchmarks.markdown import table, verdict
from benchmarks.timing import REPETITIONS, seconds_of, spread
from benchmarks.workloads import Workload, fixed_length, heavy_tailed, of_method
from usvjax.navigate import NavigateResult

TITLE = "cost per episode as episodes grow"
SIZES = (1_000, 3_000, 10_000, 30_000, 100_000)
AT_ONCE = 10_000  # episodes of one timing, at least
BAR = 0.10


def measure(quick: bool) -> dict[str, Any]:
    """Time `navigate_dwa` with a growing number of the same kind of episodes."""
    sizes = tuple(n // 100 for n in SIZES) if quick else SIZES
    works = {
        "of all lengths": heavy_tailed(max(sizes)),
        "of one length": of_method(fixed_length(max(sizes), ("improved",)), "improved"),
    }
    return {kind: _timed(work, sizes) for kind, work in works.items()}


def _timed(work: Workload, sizes: tuple[int, ...]) -> dict[str, Any]:
    results: dict[int, NavigateResult] = {}
    seconds: dict[int, list[float]] = {n: [] for n in sizes}

    def sail(some: Workload) -> None:
        results[len(some)] = some.sail()

    # From 10,000 on they share a program, which saves warming up the largest.
    for n in sizes:
        if n <= AT_ONCE:
            sail(work.rows(slice(n)))
    for _ in range(REPETITIONS):
        for n in sizes:
            call = partial(sail, work.rows(slice(n)))
            seconds[n] += [seconds_of(call) for _ in range(max(1, AT_ONCE // n))]
    return {
        str(n): {
            "median": statistics.median(seconds[n]),
            "mean": statistics.mean(seconds[n]),
            "seconds": seconds[n],
            "occupancy": results[n].occupancy,
            "decisions": int(results[n].steps.sum()),
        }
        for n in sizes
    }


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    return (
        "The improved method through `navigate_dwa`, all cores. Episodes of all lengths: lattice "
        "of 5 m, 12 to 60 s (see `workloads.heavy_tailed`); the last of them run in lanes that "
        "nobody fills again, which a small batch feels. Episodes of one length: 128 decisions "
        "each on Tan's lattice, which leaves the cost of a call. The median is over single calls: "
        "on a virtual machine some short calls take up to 1.75 times as long in the computing "
        "threads of all devices at once, without any of them waiting, and hardly any do while "
        "threads of idle priority keep the cores awake: after a pause the host may have put two "
        "virtual cores on one. The mean counts them.\n\n"
        + "\n\n".join(_of_kind(kind, timed) for kind, timed in found.items())
    )


def _of_kind(kind: str, found: dict[str, Any]) -> str:
    def per_episode(of: str) -> dict[str, float]:
        return {name: times[of] / int(name) for name, times in found.items()}

    median, mean = per_episode("median"), per_episode("mean")
    largest = list(found)[-1]
    rows = [
        (
            f"{int(name):,}",
            len(times["seconds"]),
            f"{1e6 * median[name]:.0f}",
            f"{1e6 * mean[name]:.0f}",
            f"{median[name] / median[largest]:.2f}",
            f"{times['decisions'] / times['median']:,.0f}",
            f"{times['occupancy']:.0%}",
            spread(times["seconds"]),
        )
        for name, times in found.items()
    ]
    header = (
        f"episodes {kind}",
        "calls",
        "us per episode",
        "mean",
        "of the largest's",
        "decisions/s",
        "occupancy",
        "calls' range",
    )
    growth, by_means = (max(cost.values()) / min(cost.values()) - 1 for cost in (median, mean))
    rise = median[largest] / min(median.values()) - 1
    return (
        table(header, rows)
        + "\n\n"
        + verdict(
            f"dearest size {growth:+.0%} against the cheapest ({by_means:+.0%} by means), "
            "at most +10 %",
            growth <= BAR,
        )
        + "\n"
        + verdict(f"largest size {rise:+.0%} against the cheapest, at most +10 %", rise <= BAR)
    )
