"""Cost per episode from a thousand to a hundred thousand episodes."""

import statistics
import time
from collections.abc import Callable
from typing import Any

import jax

from benchmarks.markdown import table, verdict
from benchmarks.timing import spread
from benchmarks.workloads import Workload, fixed_length, heavy_tailed, of_method

TITLE = "cost per episode as episodes grow"
SIZES = (1_000, 3_000, 10_000, 30_000, 100_000)
AT_ONCE = 2  # place of the size from which on a turn is one call; below, as many episodes
TURNS = 10
BAR = 0.10


def _cpu() -> float:
    """CPU time (s) of this process, per core."""
    return time.process_time() / jax.local_device_count()


CLOCKS: dict[str, Callable[[], float]] = {"wall": time.perf_counter, "cpu": _cpu}


def measure(quick: bool) -> dict[str, Any]:
    """Time `navigate_dwa` with a growing number of the same kind of episodes."""
    sizes = tuple(n // 100 for n in SIZES) if quick else SIZES
    works = {
        "of all lengths": heavy_tailed(max(sizes)),
        "of one length": of_method(fixed_length(max(sizes), ("improved",)), "improved"),
    }
    turns = 1 if quick else TURNS
    return {kind: _timed(work, sizes, turns) for kind, work in works.items()}


def _timed(work: Workload, sizes: tuple[int, ...], turns: int) -> dict[str, Any]:
    # Small calls go through the episodes of one of size AT_ONCE: lengths differ between episodes.
    calls = {n: max(1, sizes[AT_ONCE] // n) for n in sizes}
    parts = {n: [work.rows(slice(i * n, i * n + n)) for i in range(calls[n])] for n in sizes}
    results = {n: [part.sail() for part in parts[n]] for n in sizes}
    taken: dict[int, list[dict[str, float]]] = {n: [] for n in sizes}
    for _ in range(turns):
        for n in sizes:
            taken[n] += [_cost(part.sail) for part in parts[n]]
    return {
        str(n): {
            "seconds": {clock: [cost[clock] for cost in taken[n]] for clock in CLOCKS},
            "occupancy": statistics.mean(result.occupancy for result in results[n]),
            "decisions": statistics.mean(int(result.steps.sum()) for result in results[n]),
        }
        for n in sizes
    }


def _cost(call: Callable[[], Any]) -> dict[str, float]:
    began = {name: clock() for name, clock in CLOCKS.items()}
    call()
    return {name: clock() - began[name] for name, clock in CLOCKS.items()}


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    return (
        "The improved method through `navigate_dwa`, all cores. Episodes of all lengths: lattice "
        "of 5 m, 12 to 60 s (see `workloads.heavy_tailed`); the last of them run in lanes that "
        "nobody fills again, which a small batch feels. Episodes of one length: 128 decisions "
        "each on Tan's lattice, which leaves the cost of a call. Medians and means are over single "
        "calls, in turns with those of other sizes; small calls go through the same episodes in "
        "parts. CPU is the time of all cores that the process used, per core and episode; what the "
        "wall clock shows beyond it, cores stood idle: while one core checks, packs and collects, "
        "and where one device ends before the other (episodes are dealt to devices beforehand; a "
        "virtual machine's cores differ in speed by some per cent from moment to moment, which a "
        "long call evens out).\n\n"
        + "\n\n".join(_of_kind(kind, timed) for kind, timed in found.items())
    )


def _of_kind(kind: str, found: dict[str, Any]) -> str:
    def per_episode(of: Callable[[list[float]], float], clock: str) -> dict[str, float]:
        return {n: of(timed["seconds"][clock]) / int(n) for n, timed in found.items()}

    wall, mean = per_episode(statistics.median, "wall"), per_episode(statistics.mean, "wall")
    cpu = per_episode(statistics.median, "cpu")
    rows = [
        (
            f"{int(n):,}",
            len(timed["seconds"]["wall"]),
            *(f"{1e6 * cost[n]:.1f}" for cost in (wall, mean, cpu)),
            f"{1 - cpu[n] / wall[n]:.0%}",
            f"{timed['decisions'] / int(n):.0f}",
            f"{timed['decisions'] / int(n) / wall[n]:,.0f}",
            f"{timed['occupancy']:.0%}",
            spread(timed["seconds"]["wall"]),
        )
        for n, timed in found.items()
    ]
    header = (
        f"episodes {kind}",
        "calls",
        "us per episode",
        "mean",
        "CPU us per core",
        "cores idle",
        "decisions each",
        "decisions/s",
        "occupancy",
        "calls' range",
    )
    costs = {"wall clock": wall, "wall clock, means": mean, "CPU": cpu}
    verdicts = [_growth(name, cost) for name, cost in costs.items()]
    return "\n".join([table(header, rows), "", *verdicts])


def _growth(name: str, cost: dict[str, float]) -> str:
    growth = max(cost.values()) / min(cost.values()) - 1
    what = f"{name}: dearest size {growth:+.1%} against the cheapest, at most +10 %"
    return verdict(what, growth <= BAR)
