"""Cost of an expansion against the size of the grid, and of a map by either engine."""

import statistics
from typing import Any

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt

import usvjax as uj
from benchmarks.markdown import table
from benchmarks.record import HERE
from benchmarks.search_peers import random_queries
from benchmarks.timing import seconds_of

TITLE = "A*: cost against the size of the grid"
SIDES = {25: 8192, 50: 4096, 100: 2048, 200: 512, 400: 128}
"""Maps by cells a side; 10 % blocked, random ends."""
SWEPT = 200  # cells a side, up to which the sweeps are measured too
REPETITIONS = 3


def measure(quick: bool) -> dict[str, Any]:
    """Time both engines on maps of growing size."""
    found = {}
    for side, n in list(SIDES.items())[: 2 if quick else None]:
        queries = random_queries(side, 0.10, n // 32 if quick else n, "random ends")
        found[str(side)] = {"maps": len(queries[1])}
        for engine in ("queue", "sweep") if side <= SWEPT else ("queue",):
            result = uj.astar(*queries, engine=engine)
            seconds = statistics.median(
                seconds_of(lambda e=engine, q=queries: uj.astar(*q, engine=e))
                for _ in range(REPETITIONS)
            )
            found[str(side)][engine] = {
                "seconds": seconds,
                "us_per_map": 1e6 * seconds / len(queries[1]),
                "expanded": float(result.expanded.mean()),
                "ns_per_expansion": 1e9 * seconds / float(result.expanded.sum()),
            }
    if not quick:
        _draw(found)
    return found


def _draw(found: dict[str, Any]) -> None:
    figure, axes = plt.subplots(figsize=(5.0, 3.4), layout="constrained")
    for engine, colour, marker in (("queue", "#0072B2", "o"), ("sweep", "#D55E00", "s")):
        cost = {int(s): v[engine]["ns_per_expansion"] for s, v in found.items() if engine in v}
        axes.plot(cost.keys(), cost.values(), color=colour, marker=marker, label=engine)
    axes.set(xscale="log", xlabel="cells a side", ylabel="time per expansion (ns)")
    axes.set_ylim(bottom=0)
    axes.set_xticks(list(SIDES), [str(side) for side in SIDES])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.legend(title="engine")
    figure.savefig(HERE / "results" / "search_growth.png", dpi=150)
    plt.close(figure)


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows = []
    for side, own in found.items():
        queue, sweep = own["queue"], own.get("sweep")
        cells = [f"{queue['us_per_map']:.1f}", f"{sweep['us_per_map']:.1f}" if sweep else "-"]
        cost = [f"{queue['ns_per_expansion']:.0f}"]
        cost.append(f"{sweep['ns_per_expansion']:.0f}" if sweep else "-")
        rows.append(
            (f"{side} x {side}", f"{own['maps']:,}", f"{queue['expanded']:,.0f}", *cells, *cost)
        )
    header = ("maps, 10 % blocked", "number", "expanded", "us per map, queue", "sweep")
    return (
        "Random ends, all cores. For sweeps an expansion is one that A* could not do without.\n\n"
        + table((*header, "ns per expansion, queue", "sweep"), rows)
        + "\n\n![cost per expansion](results/search_growth.png)"
    )
