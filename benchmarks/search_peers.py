"""A* on many maps: maps per second against what users search with today."""

import statistics
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import usvjax as uj
from benchmarks.markdown import table, verdict
from benchmarks.peers.grid_search import SOLVERS, Crew
from benchmarks.timing import seconds_of
from usvjax.devices import usable_cores
from usvjax.maps import load_map

TITLE = "A* against its peers"
MOVINGAI = Path(__file__).resolve().parents[2] / "shared" / "data" / "movingai"
MOST = {"pyastar2d": 2000, "tcod": 500, "scipy": 100, "heapq": 40}
"""Queries per core of each peer: enough for a second or so."""
REPETITIONS = 5
BARS = {"50 x 50, 10 %": 1.0, "100 x 100, 12 %": 0.7}
"""Least ratio to pyastar2d."""

Queries = tuple[np.ndarray, np.ndarray, np.ndarray]


def measure(quick: bool) -> dict[str, Any]:
    """Time all contestants on the same maps, in turns, on all cores."""
    found: dict[str, Any] = {}
    for name, (blocked, starts, goals) in workloads(quick):
        most = {peer: n // 20 if quick else n for peer, n in MOST.items()}
        if blocked.shape[1] > 128:
            most = {peer: max(2, n // 20) for peer, n in most.items()}
        crew = Crew(usable_cores(), blocked, starts, goals)
        try:
            found[name] = _contest(crew, most, (blocked, starts, goals))
        finally:
            crew.close()
    found["growth"] = _growth(quick)
    return found


def workloads(quick: bool) -> Iterator[tuple[str, Queries]]:
    """Random maps with random ends and from corner to corner; two shared maps."""
    for side, density, n in ((50, 0.10, 16_384), (100, 0.12, 8_192)):
        for ends in ("random ends", "corner to corner"):
            name = f"{side} x {side}, {100 * density:.0f} %, {ends}"
            yield name, random_queries(side, density, n // 16 if quick else n, ends)
    for name, folder in (("Shanghai_0_256", "cities"), ("random512-10-0", "random")):
        file = MOVINGAI / folder / f"{name}.map"
        if file.exists():
            yield name, scenarios(file, 64 if quick else 1024)


def random_queries(side: int, density: float, n: int, ends: str) -> Queries:
    """Maps of their own, start and goal free."""
    rng = np.random.default_rng(side)
    blocked = rng.random((n, side, side)) < density
    starts, goals = rng.integers(0, side, (2, n, 2))
    if ends == "corner to corner":
        starts[:], goals[:] = 0, side - 1
    for cells in (starts, goals):
        blocked[np.arange(n), cells[:, 1], cells[:, 0]] = False
    return blocked, starts, goals


def scenarios(file: Path, n: int) -> Queries:
    """One shared map, and queries of its scenario file drawn at random."""
    lines = [
        line.split()
        for line in file.with_suffix(".map.scen").read_text(encoding="utf-8").splitlines()[1:]
    ]
    cells = np.array([[int(word) for word in line[4:8]] for line in lines])
    cells = cells[np.random.default_rng(1).permutation(len(cells))[:n]]
    return load_map(file).blocked[None], cells[:, :2], cells[:, 2:]


def _contest(crew: Crew, most: dict[str, int], queries: Queries) -> dict[str, Any]:
    blocked, starts, goals = queries
    grids = blocked[0] if len(blocked) == 1 else blocked
    first = seconds_of(lambda: uj.astar(grids, starts, goals))
    ours: list[float] = []
    theirs: dict[str, list[float]] = {name: [] for name in SOLVERS}
    for name in SOLVERS:
        crew.run(name, 1)
    for _ in range(REPETITIONS):
        ours.append(len(starts) / seconds_of(lambda: uj.astar(grids, starts, goals)))
        for name in SOLVERS:
            n = min(most[name], len(starts) // len(crew.shares))
            theirs[name].append(len(crew.shares) * n / crew.run(name, n))
    result = uj.astar(grids, starts, goals)
    return {
        "queries": len(starts),
        "found": float((result.status == uj.Status.FOUND).mean()),
        "expanded": float(result.expanded.mean()),
        "compile": first - len(starts) / statistics.median(ours),
        "rates": {"usvjax": ours, **theirs},
    }


def _growth(quick: bool) -> dict[str, float]:
    """Microseconds per map as maps grow in number, 50 x 50."""
    sizes = (100, 300, 1000) if quick else (1_000, 3_000, 10_000, 30_000, 100_000)
    blocked, starts, goals = random_queries(50, 0.10, sizes[-1], "random ends")
    cost = {}
    for n in sizes:
        part = blocked[:n], starts[:n], goals[:n]
        uj.astar(*part)
        seconds = [seconds_of(lambda part=part: uj.astar(*part)) for _ in range(REPETITIONS)]
        cost[str(n)] = 1e6 * statistics.median(seconds) / n
    return cost


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows, verdicts = [], []
    for name, one in found.items():
        if name == "growth":
            continue
        rates = {peer: statistics.median(values) for peer, values in one["rates"].items()}
        ratio = {peer: rates["usvjax"] / rate for peer, rate in rates.items()}
        cells = [f"{rates[p]:,.0f} ({ratio[p]:.1f}x)" for p in SOLVERS]
        effort = (f"{one['expanded']:,.0f}", f"{one['compile']:.1f}")
        rows.append((name, f"{rates['usvjax']:,.0f}", *cells, *effort))
        for start, least in BARS.items():
            if name.startswith(start):
                what = f"{name}: {ratio['pyastar2d']:.2f} times pyastar2d, at least {least:g}"
                verdicts.append(verdict(what, ratio["pyastar2d"] >= least))
        what = f"{name}: {ratio['tcod']:.1f} times tcod, more than 1"
        verdicts.append(verdict(what, ratio["tcod"] > 1))
    growth = found["growth"]
    cost = table(("maps", *growth), [("us per map", *(f"{v:.1f}" for v in growth.values()))])
    linear = growth[max(growth, key=int)] <= 1.1 * growth[min(growth, key=int)]
    header = ("maps/s (ours is so many times as fast)", "usvjax", *SOLVERS)
    return (
        "All contestants on all cores, medians, peers with a process per core and maps in "
        "their own formats beforehand. pyastar2d and tcod cut corners, which makes their search "
        "easier; no length of theirs is checked here.\n\n"
        + table((*header, "expanded", "compile s"), rows)
        + f"\n\nCost against the number of maps, 50 x 50:\n\n{cost}\n\n"
        + "\n".join([*verdicts, verdict("no worse than linear in the number of maps", linear)])
    )
