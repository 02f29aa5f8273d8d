"""What users search grids with today: heapq, scipy, tcod and pyastar2d.

Each takes maps as its `FORMATS` has them, one that all share or one for each query, and starts and
goals int[n, 2] as (x, y), and returns the lengths that it found, inf without a path. Only heapq and
scipy obey the rule that a diagonal step wants both side cells free; tcod and pyastar2d cut corners,
and are no oracles.
"""

import heapq
import math
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

Maps = list[Any]
Solver = Callable[[Maps, np.ndarray, np.ndarray], np.ndarray]
MOVES = [(x, y) for y in (-1, 0, 1) for x in (-1, 0, 1) if x or y]


def rows_of(maps: Maps, n: int) -> Iterator[Any]:
    """The map of each query."""
    return (maps[i if len(maps) > 1 else 0] for i in range(n))


def with_heapq(maps: Maps, starts: np.ndarray, goals: np.ndarray) -> np.ndarray:
    """A* with a binary heap in plain Python, as written in tutorials."""
    return np.array(
        [
            _astar(grid, tuple(s.tolist()), tuple(g.tolist()))
            for grid, s, g in zip(rows_of(maps, len(starts)), starts, goals, strict=True)
        ]
    )


def _astar(blocked: list[list[bool]], start: tuple[int, int], goal: tuple[int, int]) -> float:
    height, width = len(blocked), len(blocked[0])

    def estimate(x: int, y: int) -> float:
        dx, dy = abs(x - goal[0]), abs(y - goal[1])
        return max(dx, dy) + (math.sqrt(2.0) - 1.0) * min(dx, dy)

    length = {start: 0.0}
    heap, closed = [(estimate(*start), start)], set()
    while heap:
        _, here = heapq.heappop(heap)
        if here == goal:
            return length[here]
        if here in closed:
            continue
        closed.add(here)
        x, y = here
        for dx, dy in MOVES:
            i, j = x + dx, y + dy
            if not (0 <= i < width and 0 <= j < height) or blocked[j][i]:
                continue
            if dx and dy and (blocked[y][i] or blocked[j][x]):
                continue
            further = length[here] + (math.sqrt(2.0) if dx and dy else 1.0)
            if further < length.get((i, j), math.inf):
                length[i, j] = further
                heapq.heappush(heap, (further + estimate(i, j), (i, j)))
    return math.inf


def with_scipy(maps: Maps, starts: np.ndarray, goals: np.ndarray) -> np.ndarray:
    """Dijkstra of scipy's graph routines; building a map's graph counts, once where shared."""
    width = maps[0].shape[1]
    graph, found = None, []
    for grid, start, goal in zip(rows_of(maps, len(starts)), starts, goals, strict=True):
        if graph is None or len(maps) > 1:
            graph = grid_graph(grid)
        field = dijkstra(graph, indices=start[1] * width + start[0])
        found.append(field[goal[1] * width + goal[0]])
    return np.array(found)


def grid_graph(blocked: np.ndarray, corner_cutting: bool = False) -> csr_matrix:
    """The moves on a grid as a sparse matrix of lengths, cells row by row."""
    height, width = blocked.shape
    free = np.pad(~blocked, 1)
    y, x = np.nonzero(~blocked)
    sources, targets, lengths = [], [], []
    for dx, dy in MOVES:
        able = free[y + 1 + dy, x + 1 + dx]
        if dx and dy and not corner_cutting:
            able &= free[y + 1, x + 1 + dx] & free[y + 1 + dy, x + 1]
        sources.append((y * width + x)[able])
        targets.append(((y + dy) * width + x + dx)[able])
        lengths.append(np.full(able.sum(), math.hypot(dx, dy)))
    pairs = (np.concatenate(sources), np.concatenate(targets))
    return csr_matrix((np.concatenate(lengths), pairs), shape=(height * width,) * 2)


def with_tcod(maps: Maps, starts: np.ndarray, goals: np.ndarray) -> np.ndarray:
    """A* of libtcod (C)."""
    import tcod.path

    searcher, found = None, []
    for costs, start, goal in zip(rows_of(maps, len(starts)), starts, goals, strict=True):
        if searcher is None or len(maps) > 1:
            searcher = tcod.path.AStar(costs, diagonal=math.sqrt(2.0))
        path = searcher.get_path(*start[::-1].tolist(), *goal[::-1].tolist())
        found.append(_length(np.array([start[::-1].tolist(), *path])))
    return np.array(found)


def with_pyastar2d(maps: Maps, starts: np.ndarray, goals: np.ndarray) -> np.ndarray:
    """A* of pyastar2d (C++)."""
    import pyastar2d

    found = []
    for weights, start, goal in zip(rows_of(maps, len(starts)), starts, goals, strict=True):
        ends = (tuple(start[::-1].tolist()), tuple(goal[::-1].tolist()))
        path = pyastar2d.astar_path(weights, *ends, allow_diagonal=True)
        found.append(math.inf if path is None else _length(path))
    return np.array(found)


def _length(path: np.ndarray) -> float:
    if len(path) < 2:
        return math.inf
    return float(np.hypot(*np.diff(path, axis=0).T).sum())


SOLVERS: dict[str, Solver] = {
    "pyastar2d": with_pyastar2d,
    "tcod": with_tcod,
    "scipy": with_scipy,
    "heapq": with_heapq,
}

FORMATS: dict[str, Callable[[np.ndarray], Any]] = {
    "pyastar2d": lambda grid: np.where(grid, np.float32(np.inf), np.float32(1)),
    "tcod": lambda grid: (~grid).astype(np.int8),
    "scipy": lambda grid: grid,
    "heapq": lambda grid: grid.tolist(),
}
"""A map bool[H, W] as each wants it; made before the time is taken."""


class Crew:
    """Processes that search for the peers, one per core; each holds its share of the queries."""

    def __init__(self, cores: int, blocked: np.ndarray, starts: np.ndarray, goals: np.ndarray):
        self.shares = []
        for rows in np.array_split(np.arange(len(starts)), cores):
            own = blocked if len(blocked) == 1 else blocked[rows]
            pool = ProcessPoolExecutor(
                1, get_context("spawn"), _hold, (own, starts[rows], goals[rows])
            )
            self.shares.append(pool)

    def run(self, name: str, most: int) -> float:
        """Search the first `most` queries of every share; the seconds of the slowest."""
        return max(done.result() for done in [p.submit(_work, name, most) for p in self.shares])

    def close(self) -> None:
        """End the processes."""
        for pool in self.shares:
            pool.shutdown()


_held: list[Any] = []


def _hold(*share: np.ndarray) -> None:
    _held[:] = share


def _work(name: str, most: int) -> float:
    blocked, starts, goals = _held
    maps = [FORMATS[name](grid) for grid in (blocked if len(blocked) == 1 else blocked[:most])]
    began = time.perf_counter()
    SOLVERS[name](maps, starts[:most], goals[:most])
    return time.perf_counter() - began
