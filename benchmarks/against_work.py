"""The workloads of `against`, by the public interface alone: runs in whatever checkout is imported.

A program of its own: reads names from stdin, a line each, and answers with seconds.
"""

import sys
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import usvjax as uj


def workloads() -> dict[str, Callable[[], Any]]:
    """What is timed, by name; all work is done when a call returns."""
    rng = np.random.default_rng(0)
    calls: dict[str, Callable[[], Any]] = {}
    obstacles = rng.uniform(1.0, 9.0, (10_000, 40, 2))
    starts, goals = np.array([0.0, 0.0, np.pi / 4]), np.array([10.0, 10.0])
    params = uj.DwaParams(radius=0.2, clearance_cap=0.4)
    for method in ("traditional", "improved"):
        static = uj.DwaStatic(method=method)
        sail = partial(uj.navigate_dwa, starts=starts, goals=goals, params=params, static=static)
        calls[f"DWA, {method}, 1,000 episodes"] = partial(sail, obstacles[:1000])
        calls[f"DWA, {method}, 10,000 episodes"] = partial(sail, obstacles)
    for side, count in ((50, 8192), (100, 2048)):
        maps = rng.random((count, side, side)) < 0.1
        maps[:, 0, 0] = maps[:, -1, -1] = False
        search = partial(uj.astar, maps, [0, 0], [side - 1, side - 1])
        calls[f"A*, sweeps, {count:,} maps of {side} x {side}"] = search
        calls[f"A*, queue, {count:,} maps of {side} x {side}"] = partial(search, engine="queue")
    one = maps[0]
    calls["A*, queue, one query on 100 x 100"] = partial(
        uj.astar, one, [0, 0], [99, 99], engine="queue"
    )
    maps = rng.random((512, 50, 50)) < 0.1
    maps[:, 0, 0] = maps[:, -1, -1] = False
    flips = rng.integers(0, 50, (512, 100, 5, 2))
    calls["D* Lite, 512 maps of 50 x 50"] = partial(
        uj.dstar_lite, maps, [0, 0], [49, 49], flips, sensing=(5, 5)
    )
    stations = np.array([[4, 46], [8, 28], [17, 22], [26, 29], [29, 11], [39, 26]])
    maps[:, stations[:, 1], stations[:, 0]] = False
    order = np.arange(len(stations))
    for heuristic in ("octile", "weighted"):
        calls[f"cruises, {heuristic}, 512 of 6 stations"] = partial(
            uj.cruise, maps, stations, 0, order=order, heuristic=heuristic
        )
    points = rng.uniform(0.0, 1.0, (1000, 20, 2))
    calls["tours, 1,000 of 20 points"] = partial(uj.solve_tour, points, 0)
    calls["legs by ants, 20 on 30 x 30"] = partial(
        uj.plan_paths, maps[:20, :30, :30] & False, [0, 0], [29, 29], 0, algorithm="aco"
    )
    return calls


def serve() -> None:
    """Answer on what was stdout; whatever else is printed goes to stderr."""
    calls = workloads()
    print("\t".join(calls), flush=True)
    for line in sys.stdin:
        began = time.perf_counter()
        calls[line.rstrip("\n")]()
        print(time.perf_counter() - began, flush=True)


if __name__ == "__main__":
    serve()
