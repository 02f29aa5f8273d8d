"""Paths over random maps, and slow exact answers, for the tests of smoothing."""

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

Point = Sequence[int | Fraction]


def touches(start: Point, end: Point, low: Point, high: Point, closed: bool) -> bool:
    """Whether a segment meets a square, in exact arithmetic (Liang and Barsky)."""
    first, last = Fraction(0), Fraction(1)
    for axis in range(2):
        span = Fraction(end[axis]) - Fraction(start[axis])
        if span == 0:
            at = start[axis]
            outside = at < low[axis] or at > high[axis]
            if outside or (not closed and at in (low[axis], high[axis])):
                return False
            continue
        enter, leave = sorted(
            (
                (Fraction(low[axis]) - start[axis]) / span,
                (Fraction(high[axis]) - start[axis]) / span,
            )
        )
        first, last = max(first, enter), min(last, leave)
    return first <= last if closed else first < last


def sees(blocked: np.ndarray, start: Point, end: Point, corner_cutting: bool = False) -> bool:
    """Whether the segment between two points, in half cells, touches no blocked cell."""
    return not any(
        touches(start, end, (2 * x, 2 * y), (2 * x + 2, 2 * y + 2), not corner_cutting)
        for y, x in np.argwhere(blocked).tolist()
    )


def centre(cell: np.ndarray) -> tuple[int, int]:
    """The centre of a cell, in half cells."""
    return 2 * int(cell[0]) + 1, 2 * int(cell[1]) + 1


def shortest_path(blocked: np.ndarray, start: int, goal: int) -> np.ndarray | None:
    """Cells (x, y) of a shortest path between flat indices, no corner cut; None without one."""
    height, width = blocked.shape
    free, index = ~blocked, np.arange(blocked.size).reshape(blocked.shape)
    rows, columns, costs = [], [], []
    for dx, dy in ((1, 0), (0, 1), (1, 1), (1, -1)):
        here = np.s_[max(0, -dy) : height - max(0, dy), 0 : width - dx]
        there = np.s_[max(0, dy) : height - max(0, -dy), dx:width]
        allowed = free[here] & free[there]
        if dx and dy:
            allowed &= free[here[0], there[1]] & free[there[0], here[1]]
        rows.append(index[here][allowed])
        columns.append(index[there][allowed])
        costs.append(np.full(allowed.sum(), np.hypot(dx, dy)))
    links = (np.concatenate(rows), np.concatenate(columns))
    graph = coo_matrix((np.concatenate(costs), links), shape=(blocked.size,) * 2).tocsr()
    found = dijkstra(graph, directed=False, indices=start, return_predecessors=True)
    if not np.isfinite(found[0][goal]):
        return None
    cells = [goal]
    while cells[-1] != start:
        cells.append(int(found[1][cells[-1]]))
    flat = np.array(cells[::-1])
    return np.stack([flat % width, flat // width], axis=1)


def routes(
    seed: int, count: int, size: int, density: float, far: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Random maps [count, size, size] with paths [count, P, 2] and lengths [count] over them."""
    rng = np.random.default_rng(seed)
    maps, paths = [], []
    while len(paths) < count:
        blocked = rng.random((size, size)) < density
        start, goal = rng.choice(np.flatnonzero(~blocked), 2, replace=False)
        if abs(start % size - goal % size) + abs(start // size - goal // size) < far:
            continue
        path = shortest_path(blocked, int(start), int(goal))
        if path is not None:
            maps.append(blocked)
            paths.append(path)
    return np.stack(maps), *packed(paths)


def packed(paths: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Paths of different lengths as one array, the last point repeated; and their lengths."""
    lengths = np.array([len(path) for path in paths])
    slot = np.arange(lengths.max())
    return np.stack([p[np.minimum(slot, len(p) - 1)] for p in paths]), lengths


def islands(seed: int, size: int, cell_size: float, count: int) -> np.ndarray:
    """A scene of round islands of 10 to 45 m radius: bool[size, size]."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:size, :size] + 0.5
    blocked = np.zeros((size, size), bool)
    for _ in range(count):
        east, north = rng.uniform(0, size, 2)
        blocked |= np.hypot(x - east, y - north) <= rng.uniform(10, 45) / cell_size
    return blocked
