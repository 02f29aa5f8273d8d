"""A* against published optima and against scipy's Dijkstra."""

from typing import Any

import numpy as np
from scipy.sparse.csgraph import dijkstra

import usvjax as uj
from benchmarks.markdown import table, verdict
from benchmarks.peers.grid_search import grid_graph
from benchmarks.search_peers import MOVINGAI
from usvjax.maps import load_map

TITLE = "A* is exact"
GRIDS = 20_000
SIDES = (5, 12, 23, 34, 47, 60)
"""Sizes are drawn between 5 and 60 and stand in the corner of the next of these."""
PRECISION = {"cities": 1e-5, "mazes": 5e-3}
"""Of the published optima: relative for cities, else absolute; 1e-3 where not listed, for these are
printed with three decimals, the others cut off."""


def measure(quick: bool) -> dict[str, Any]:
    """Search every scenario of every map, and random grids under both corner rules."""
    return {"movingai": _movingai(quick), "random": _random(400 if quick else GRIDS)}


def _movingai(quick: bool) -> dict[str, Any]:
    found = {}
    for file in sorted(MOVINGAI.glob("*/*.scen")):
        lines = [
            line.split()
            for line in file.read_text(encoding="utf-8").splitlines()[1:]
            if line.strip()
        ]
        lines = lines[:: max(1, len(lines) // 100)] if quick else lines
        cells = np.array([[int(word) for word in line[4:8]] for line in lines])
        optimum = np.array([float(line[8]) for line in lines])
        grid = load_map(file.with_suffix("")).blocked
        result = uj.astar(grid, cells[:, :2], cells[:, 2:])
        off = np.abs(result.cost - optimum)
        kind = file.parent.name
        within = PRECISION.get(kind, 1e-3) * (np.maximum(optimum, 1) if kind == "cities" else 1)
        found[file.stem.removesuffix(".map")] = {
            "scenarios": len(lines),
            "wrong": int((~(off <= within)).sum()),
            "largest": float(off.max()),
            "invalid": _invalid(grid, result, False),
        }
    return found


def _random(count: int) -> dict[str, Any]:
    rng = np.random.default_rng(3)
    told = {"grids": 0, "unreachable": 0, "wrong": 0, "invalid": 0, "largest": 0.0}
    sides = rng.integers(5, 61, (count, 2))
    frame = np.array(SIDES)[np.searchsorted(SIDES, sides.max(axis=1))]
    for cutting in (False, True):
        for side in SIDES:
            rows = np.flatnonzero((frame == side) & (np.arange(count) % 2 == cutting))
            if len(rows) == 0:
                continue
            grids, starts, goals = _drawn(rng, side, sides[rows])
            result = uj.astar(grids, starts, goals, corner_cutting=cutting)
            for i, (grid, start, goal) in enumerate(zip(grids, starts, goals, strict=True)):
                field = dijkstra(grid_graph(grid, cutting), indices=start[1] * side + start[0])
                best = field[goal[1] * side + goal[0]]
                off = 0.0 if result.cost[i] == best else abs(result.cost[i] - best)
                told["unreachable"] += bool(np.isinf(best))
                told["wrong"] += not off <= 1e-4
                told["largest"] = max(told["largest"], float(off))
            told["grids"] += len(rows)
            told["invalid"] += _invalid(grids, result, cutting)
    return told


def _drawn(
    rng: np.random.Generator, side: int, sides: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    n = len(sides)
    density = rng.uniform(0, 0.6, (n, 1, 1))
    grids = rng.random((n, side, side)) < density
    x, y = np.arange(side), np.arange(side)[:, None]
    grids |= (x >= sides[:, :1, None]) | (y >= sides[:, 1:, None])
    starts, goals = (np.floor(rng.random((n, 2)) * sides).astype(int) for _ in range(2))
    for cells in (starts, goals):
        grids[np.arange(n), cells[:, 1], cells[:, 0]] = False
    return grids, starts, goals


def _invalid(blocked: np.ndarray, result: Any, cutting: bool) -> int:
    """How many paths are not valid step by step, or are not as long as their cost."""
    grids = blocked if blocked.ndim == 3 else blocked[None]
    rows = np.flatnonzero(result.status == uj.Status.FOUND)
    here, there = result.path[rows, :-1], result.path[rows, 1:]
    step = there - here
    which = rows[:, None] if len(grids) > 1 else np.zeros((len(rows), 1), int)
    bad = np.abs(step).max(axis=2) > 1
    bad |= grids[which, there[..., 1], there[..., 0]]
    if not cutting:
        bad |= grids[which, here[..., 1], there[..., 0]] | grids[which, there[..., 1], here[..., 0]]
    length = np.hypot(step[..., 0], step[..., 1]).sum(axis=1)
    return int((bad.any(axis=1) | (np.abs(length - result.cost[rows]) > 1e-6)).sum())


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows = [
        (name, f"{one['scenarios']:,}", one["wrong"], f"{one['largest']:.1e}", one["invalid"])
        for name, one in found["movingai"].items()
    ]
    random = found["random"]
    wrong = sum(one["wrong"] + one["invalid"] for one in (*found["movingai"].values(), random))
    header = ("MovingAI map", "scenarios", "wrong", "largest difference", "invalid paths")
    return (
        "Every scenario against its published optimum (cells), every path replayed step by "
        "step.\n\n"
        + table(header, rows)
        + f"\n\n{random['grids']:,} random grids of 5 to 60 cells a side, 0 to 60 % blocked, half "
        f"of them with corners cut, {random['unreachable']:,} without a path, against scipy's "
        f"Dijkstra: {random['wrong']} lengths off by more than 1e-4 (largest "
        f"{random['largest']:.1e}), {random['invalid']} paths invalid.\n\n"
        + verdict("nothing wrong", wrong == 0)
    )
