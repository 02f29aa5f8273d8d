"""Cost per episode from a thousand to a hundred thousand episodes."""

from functools import partial
from typing import Any

from benchmarks.markdown import table, verdict
from benchmarks.timing import in_turns, spread
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

    def sail(some: Workload, calls: int) -> None:
        for _ in range(calls):
            results[len(some)] = some.sail()

    # From 10,000 on they share a program, which saves warming up the largest.
    for n in sizes:
        if n <= AT_ONCE:
            sail(work.rows(slice(n)), 1)
    # A single call of the smallest is over before one slow moment of the machine is.
    calls = {n: max(1, AT_ONCE // n) for n in sizes}
    timed = in_turns(
        {str(n): partial(sail, work.rows(slice(n)), calls[n]) for n in sizes}, warm=False
    )
    for n in sizes:
        found = timed[str(n)]
        found["median"] /= calls[n]
        found["seconds"] = [seconds / calls[n] for seconds in found["seconds"]]
        found["occupancy"] = results[n].occupancy
        found["decisions"] = int(results[n].steps.sum())
    return timed


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    return (
        "The improved method through `navigate_dwa`, all cores. Episodes of all lengths: lattice "
        "of 5 m, 12 to 60 s (see `workloads.heavy_tailed`); the last of them run in lanes that "
        "nobody fills again, which a small batch feels. Episodes of one length: 128 decisions "
        "each on Tan's lattice, which leaves the cost of a call.\n\n"
        + "\n\n".join(_of_kind(kind, timed) for kind, timed in found.items())
    )


def _of_kind(kind: str, found: dict[str, Any]) -> str:
    cost = {name: times["median"] / int(name) for name, times in found.items()}
    largest = cost[list(cost)[-1]]
    rows = [
        (
            f"{int(name):,}",
            f"{1e6 * cost[name]:.0f}",
            f"{cost[name] / largest:.2f}",
            f"{times['decisions'] / times['median']:,.0f}",
            f"{times['occupancy']:.0%}",
            spread(times["seconds"]),
        )
        for name, times in found.items()
    ]
    header = (
        f"episodes {kind}",
        "us per episode",
        "of the largest's",
        "decisions/s",
        "occupancy",
        "timings",
    )
    growth = max(cost.values()) / min(cost.values()) - 1
    rise = largest / min(cost.values()) - 1
    return (
        table(header, rows)
        + "\n\n"
        + verdict(f"dearest size {growth:+.0%} against the cheapest, at most +10 %", growth <= BAR)
        + "\n"
        + verdict(f"largest size {rise:+.0%} against the cheapest, at most +10 %", rise <= BAR)
    )
