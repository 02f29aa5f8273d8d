"""Random grids from corner to corner, and their shortest lengths by scipy."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

AROUND = [(x, y) for y in (-1, 0, 1) for x in (-1, 0, 1) if x or y]


def grids(count, side, density, seed=0):
    """Maps with both corners free, bool[count, side, side]."""
    rng = np.random.default_rng(seed)
    blocked = rng.random((count, side, side)) < density
    blocked[:, 0, 0] = blocked[:, -1, -1] = False
    return blocked


def shortest(blocked, corner_cutting):
    """Length from the first to the last cell by scipy, in thousandths; inf where cut off."""
    height, width = blocked.shape
    rows, columns, costs = [], [], []
    for y in range(height):
        for x in range(width):
            for dx, dy in AROUND:
                to = x + dx, y + dy
                inside = 0 <= to[0] < width and 0 <= to[1] < height
                if not inside or blocked[y, x] or blocked[to[1], to[0]]:
                    continue
                sides = dx and dy and (blocked[y, to[0]] or blocked[to[1], x])
                if sides and not corner_cutting:
                    continue
                rows.append(y * width + x)
                columns.append(to[1] * width + to[0])
                costs.append(1400 if dx and dy else 1000)
    graph = coo_matrix((costs, (rows, columns)), shape=(blocked.size, blocked.size)).tocsr()
    return dijkstra(graph, indices=0)[-1]
