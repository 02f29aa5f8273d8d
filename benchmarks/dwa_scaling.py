"""Cost per episode from a thousand to a hundred thousand episodes."""

import statistics
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

from benchmarks.markdown import table, verdict
from benchmarks.timing import REPETITIONS, cores_awake, seconds_of, spread
from benchmarks.workloads import Workload, fixed_length, heavy_tailed, of_method

TITLE = "cost per episode as episodes grow"
SIZES = (1_000, 3_000, 10_000, 30_000, 100_000)
AT_ONCE = 2  # place of the size from which on a turn is one call; below, as many episodes
BAR = 0.10
CONDITIONS: dict[str, Callable[[], AbstractContextManager[None]]] = {
    "as the machine is": nullcontext,
    "cores kept awake": cores_awake,
}


def measure(quick: bool) -> dict[str, Any]:
    """Time `navigate_dwa` with a growing number of the same kind of episodes."""
    sizes = tuple(n // 100 for n in SIZES) if quick else SIZES
    works = {
        "of all lengths": heavy_tailed(max(sizes)),
        "of one length": of_method(fixed_length(max(sizes), ("improved",)), "improved"),
    }
    return {kind: _timed(work, sizes) for kind, work in works.items()}


def _timed(work: Workload, sizes: tuple[int, ...]) -> dict[str, Any]:
    parts = {n: work.rows(slice(n)) for n in sizes}
    results = {n: part.sail() for n, part in parts.items()}
    seconds: dict[str, dict[int, list[float]]] = {c: {n: [] for n in sizes} for c in CONDITIONS}
    for _ in range(REPETITIONS):
        for name, condition in CONDITIONS.items():
            with condition():
                for n, part in parts.items():
                    calls = max(1, sizes[AT_ONCE] // n)
                    seconds[name][n] += [seconds_of(part.sail) for _ in range(calls)]
    return {
        str(n): {
            "seconds": {name: seconds[name][n] for name in CONDITIONS},
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
        "each on Tan's lattice, which leaves the cost of a call. Medians and means are over single "
        "calls. On a virtual machine some short calls take up to 1.75 times as long in the "
        "computing threads of all devices at once, without any of them waiting: other work on the "
        "host's cores, or two virtual cores that it put on one after a pause. Hence all is timed "
        "as the machine is, and, in turns with that, while processes of idle priority keep its "
        "cores awake.\n\n" + "\n\n".join(_of_kind(kind, timed) for kind, timed in found.items())
    )


def _of_kind(kind: str, found: dict[str, Any]) -> str:
    def per_episode(of: Callable[[list[float]], float], condition: str) -> dict[str, float]:
        return {n: of(timed["seconds"][condition]) / int(n) for n, timed in found.items()}

    median = {name: per_episode(statistics.median, name) for name in CONDITIONS}
    mean = {name: per_episode(statistics.mean, name) for name in CONDITIONS}
    as_is = next(iter(CONDITIONS))
    rows = [
        (
            f"{int(n):,}",
            len(timed["seconds"][as_is]),
            *(f"{1e6 * cost[name][n]:.1f}" for name in CONDITIONS for cost in (median, mean)),
            f"{timed['decisions'] / int(n) / median[as_is][n]:,.0f}",
            f"{timed['occupancy']:.0%}",
            *(spread(timed["seconds"][name]) for name in CONDITIONS),
        )
        for n, timed in found.items()
    ]
    header = (
        f"episodes {kind}",
        "calls",
        "us per episode",
        "mean",
        "cores awake: us",
        "mean",
        "decisions/s",
        "occupancy",
        "calls' range",
        "cores awake: range",
    )
    verdicts = [_growth(name, median[name], mean[name]) for name in CONDITIONS]
    return "\n".join([table(header, rows), "", *verdicts])


def _growth(condition: str, median: dict[str, float], mean: dict[str, float]) -> str:
    growth, by_means = (max(cost.values()) / min(cost.values()) - 1 for cost in (median, mean))
    return verdict(
        f"{condition}: dearest size {growth:+.1%} against the cheapest ({by_means:+.1%} by "
        "means), at most +10 %",
        growth <= BAR,
    )
