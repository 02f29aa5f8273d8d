"""Shortest lengths on grids by scipy's Dijkstra, to compare searches with."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1))


def open_steps(
    blocked: np.ndarray, step: tuple[int, int], corner_cutting: bool = False
) -> np.ndarray:
    """Cells from which a step is allowed; bool[H, W]."""
    dx, dy = step
    height, width = blocked.shape
    free = np.pad(~blocked, 1)

    def beside(x: int, y: int) -> np.ndarray:
        return free[1 + y : 1 + y + height, 1 + x : 1 + x + width]

    allowed = ~blocked & beside(dx, dy)
    return allowed if corner_cutting else allowed & beside(dx, 0) & beside(0, dy)


def lengths(
    blocked: np.ndarray, sources: np.ndarray, corner_cutting: bool = False, connectivity: int = 8
) -> np.ndarray:
    """Cells to the nearest of sources int[K, 2], float64[H, W]; inf where cut off or blocked."""
    height, width = blocked.shape
    cell = np.arange(height * width).reshape(height, width)
    starts, ends, costs = [], [], []
    for dx, dy in STEPS[:connectivity]:
        allowed = open_steps(blocked, (dx, dy), corner_cutting)
        starts.append(cell[allowed])
        ends.append(cell[allowed] + dy * width + dx)
        costs.append(np.full(allowed.sum(), np.hypot(dx, dy)))
    edges = (np.concatenate(costs), (np.concatenate(starts), np.concatenate(ends)))
    graph = coo_matrix(edges, shape=(cell.size, cell.size)).tocsr()
    found = dijkstra(graph, indices=sources[:, 1] * width + sources[:, 0], min_only=True)
    return np.where(blocked, np.inf, found.reshape(height, width))


def check_path(
    blocked: np.ndarray, path: np.ndarray, corner_cutting: bool = False, connectivity: int = 8
) -> float:
    """The length of a path int[n, 2] in cells; fails unless every step of it is allowed."""
    total = 0.0
    assert not blocked[path[0, 1], path[0, 0]]
    for (x, y), step in zip(path[:-1], np.diff(path, axis=0).tolist(), strict=True):
        assert tuple(step) in STEPS[:connectivity]
        assert open_steps(blocked, tuple(step), corner_cutting)[y, x]
        total += float(np.hypot(*step))
    return total
