"""Replanning incrementally against searching anew, by map size and rate of change."""

from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from benchmarks.markdown import table, verdict
from benchmarks.peers import dstar_pmp
from benchmarks.timing import in_turns, spread
from usvjax.search.astar import AstarResult, astar
from usvjax.search.replanning import DstarLiteResult, dstar_lite

TITLE = "D* Lite pays"
SIZES = {50: 0.10, 100: 0.12}  # cells along an edge: share of blocked cells
RATES = (1, 5, 20)  # cells that change per step
EPISODES = {50: 512, 100: 128}
PEER_EPISODES, PEER_STEPS = 4, 12


@dataclass(frozen=True)
class Voyages:
    """Episodes from one side of a map to the other while cells change."""

    blocked: np.ndarray  # bool[B, H, W]
    starts: np.ndarray  # int[B, 2]
    goals: np.ndarray  # int[B, 2]
    flips: np.ndarray  # int[B, T, C, 2]

    def sail(self) -> DstarLiteResult:
        """Replan with D* Lite."""
        return dstar_lite(self.blocked, self.starts, self.goals, self.flips)


def measure(quick: bool) -> dict[str, Any]:
    """Sail the same episodes each way."""
    found = []
    for size, density in SIZES.items():
        for rate in RATES:
            episodes = 16 if quick else EPISODES[size]
            found.append(_compare(drawn(size, density, rate, episodes), size, rate, quick))
    return {"cases": found}


def drawn(size: int, density: float, rate: int, episodes: int) -> Voyages:
    """Random maps, and changes that leave the share of blocked cells about as it is.

    A change blocks or frees a cell wherever it is drawn; half of them are drawn among the cells
    that are blocked at first.
    """
    rng = np.random.default_rng([size, rate])
    blocked = rng.random((episodes, size, size)) < density
    starts = np.stack([np.zeros(episodes, int), rng.integers(0, size, episodes)], axis=1)
    goals = np.stack([np.full(episodes, size - 1), rng.integers(0, size, episodes)], axis=1)
    row = np.arange(episodes)
    for ends in (starts, goals):
        blocked[row, ends[:, 1], ends[:, 0]] = False
    steps = size + size // 5
    flips = rng.integers(0, size, (episodes, steps, rate, 2))
    for b in row:
        walls = np.argwhere(blocked[b])[:, ::-1]
        chosen = rng.random((steps, rate)) < 0.5
        flips[b][chosen] = walls[rng.integers(0, len(walls), chosen.sum())]
    return Voyages(blocked, starts, goals, flips)


def _compare(voyages: Voyages, size: int, rate: int, quick: bool) -> dict[str, Any]:
    sailed = voyages.sail()
    maps, starts, goals, expanded, cost = _queries(voyages, sailed)
    anew: dict[str, AstarResult] = {}

    def search() -> None:
        anew["last"] = astar(maps, starts, goals)

    calls = {"D* Lite": voyages.sail, "A* anew": search}
    timed = in_turns(calls, repetitions=1 if quick else 5)
    if not np.allclose(anew["last"].cost, cost, rtol=1e-6):
        raise RuntimeError(f"{size} cells, {rate} changes: A* and D* Lite disagree")
    steps = len(cost) + len(voyages.blocked)  # replannings, and the first plans
    return {
        "size": size,
        "rate": rate,
        "replannings": len(cost),
        "dstar_expanded": float(expanded.mean()),
        "astar_expanded": float(anew["last"].expanded.mean()),
        "first_expanded": float(sailed.expanded[:, 0].mean()),
        "dstar_us": timed["D* Lite"]["median"] / steps * 1e6,
        "astar_us": timed["A* anew"]["median"] / len(cost) * 1e6,
        "timed": timed,
        "peer": _peer(voyages, sailed, 1 if quick else PEER_EPISODES),
    }


def _queries(
    voyages: Voyages, sailed: DstarLiteResult
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """What each replanning was asked: map, start, goal; its expansions and its answer."""
    maps, starts, goals, expanded, cost = [], [], [], [], []
    for b, goal in enumerate(voyages.goals):
        grid = voyages.blocked[b].copy()
        for t, step in enumerate(voyages.flips[b]):
            here, there = sailed.position[b, t : t + 2]
            if np.array_equal(here, goal):
                break
            for cell in step:
                if not np.array_equal(cell, here) and not np.array_equal(cell, goal):
                    grid[cell[1], cell[0]] ^= True
            maps.append(grid.copy())
            starts.append(here)
            goals.append(goal)
            expanded.append(sailed.expanded[b, t + 1])
            cost.append(sailed.cost_to_go[b, t + 1] + np.hypot(*(there - here)))
    return tuple(np.array(part) for part in (maps, starts, goals, expanded, cost))  # type: ignore


def _peer(voyages: Voyages, sailed: DstarLiteResult, episodes: int) -> dict[str, Any] | None:
    """The first steps of some episodes with python-motion-planning, along our positions."""
    if find_spec("python_motion_planning") is None or find_spec("osqp") is None:
        return None
    seconds, expanded, wrong, raised, count = 0.0, 0, 0, 0, 0
    for b in range(episodes):
        position = sailed.position[b]
        followed = dstar_pmp.follow(
            voyages.blocked[b], voyages.goals[b], position, voyages.flips[b, :PEER_STEPS]
        )
        seconds += sum(followed.seconds[1:])
        expanded += sum(followed.expanded[1:])
        count += len(followed.seconds) - 1
        raised += bool(followed.error)
        for t, cost in enumerate(followed.cost[1:]):
            ours = sailed.cost_to_go[b, t + 1] + np.hypot(*(position[t + 1] - position[t]))
            wrong += bool(np.isfinite(cost) and not np.isclose(cost, ours))
    return {
        "replannings": count,
        "ms": seconds / max(count, 1) * 1e3,
        "expanded": expanded / max(count, 1),
        "wrong": wrong,
        "raised": raised,
    }


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows, peers, fewest, fastest = [], [], True, True
    for case in found["cases"]:
        fewer = case["astar_expanded"] / case["dstar_expanded"]
        faster = case["astar_us"] / case["dstar_us"]
        fewest &= fewer > 1
        fastest &= faster > 1
        rows.append(
            (
                f"{case['size']} x {case['size']}, {case['rate']} per step",
                f"{case['replannings']:,}",
                f"{case['astar_expanded']:.0f}",
                f"{case['dstar_expanded']:.1f}",
                f"{fewer:.1f}",
                f"{case['astar_us']:.1f}",
                f"{case['dstar_us']:.1f}",
                f"{faster:.1f}",
                "; ".join(spread(t["seconds"]) for t in case["timed"].values()),
            )
        )
        peer = case["peer"]
        if peer:
            gain = peer["ms"] * 1e3 / case["dstar_us"]
            figures = (
                f"{peer['ms']:.0f}",
                f"{peer['expanded']:.0f}",
                peer["wrong"],
                peer["raised"],
            )
            peers.append((rows[-1][0], peer["replannings"], *figures, f"{gain:,.0f}"))
    text = (
        "Episodes across random maps (10 and 12 % blocked) in which cells change before each move. "
        "A* anew: `uj.astar` on each map and position that D* Lite had to replan for; both give "
        "the same lengths. D* Lite's time includes its first plans and the moves; all devices.\n\n"
    )
    header = ("changes", "replannings", "cells expanded, A*", "D* Lite", "fewer by")
    header += ("us each, A*", "D* Lite", "faster by", "timings")
    text += table(header, rows) + "\n\n"
    if peers:
        header = ("python-motion-planning 1.1.1", "replannings", "ms each", "cells expanded")
        header += ("wrong lengths", "episodes ended by an exception", "faster by")
        text += table(header, peers) + "\n\n"
    text += verdict("fewer expansions than A* anew in every case", fewest) + "\n"
    return text + verdict("less time than A* anew in every case", fastest)
