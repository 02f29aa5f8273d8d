"""Which cells the first plan of D* Lite expands, for a figure.

The batched planner reports how many; this is the same search from the goal to the vessel in plain
Python, with the planner's own heuristic. The counts agree, which the report checks.
"""

import heapq

import jax.numpy as jnp
import numpy as np

from usvkernels.search.replan_heuristics import guide
from usvkernels.search.steps import DIAGONAL, STRAIGHT

Cell = tuple[int, int]

_MOVES = tuple((dx, dy) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if dx or dy)


def expanded_cells(blocked: np.ndarray, start: Cell, goal: Cell, heuristic: str) -> list[Cell]:
    """Expand cells from the goal until the vessel's cell is settled.

    Args:
        blocked: bool[H, W].
        start: the vessel's cell (x, y).
        goal: cell (x, y).
        heuristic: as `dstar_lite` names it; diagonal steps need both cells beside them free.

    Returns:
        The cells in their order, some of them more than once if the heuristic overestimates.
    """
    height, width = blocked.shape
    ahead = _guides(blocked.shape, start, goal, heuristic)
    free = np.zeros((height + 2, width + 2), bool)
    free[1:-1, 1:-1] = ~blocked
    value, order = {goal: 0}, []
    settled: dict[Cell, int] = {}
    queue = [(int(ahead[goal[1], goal[0]]), goal[1], goal[0])]
    while queue:
        key, y, x = heapq.heappop(queue)
        if settled.get(start) is not None and key >= settled[start]:
            break
        g = value[x, y]
        if settled.get((x, y)) == g or key != g + ahead[y, x]:
            continue
        settled[x, y] = g
        order.append((x, y))
        for dx, dy in _MOVES:
            to = (x + dx, y + dy)
            if not free[to[1] + 1, to[0] + 1]:
                continue
            if dx and dy and not (free[y + 1, to[0] + 1] and free[to[1] + 1, x + 1]):
                continue
            new = g + (DIAGONAL if dx and dy else STRAIGHT)
            if new < value.get(to, new + 1):
                value[to] = new
                heapq.heappush(queue, (new + int(ahead[to[1], to[0]]), to[1], to[0]))
    return order


def _guides(shape: tuple[int, int], start: Cell, goal: Cell, heuristic: str) -> np.ndarray:
    """The planner's heuristic of every cell; int64[H, W]."""
    y, x = jnp.indices(shape, dtype=jnp.int32)
    to_goal = jnp.int32(goal[0] - start[0]), jnp.int32(goal[1] - start[1])
    found = guide(heuristic, None, x - start[0], y - start[1], *to_goal)
    return np.asarray(found, np.int64)
