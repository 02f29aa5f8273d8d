"""The first plan of D* Lite in plain Python: which cells it expands, and where it leads.

The batched planner reports how many; this is the same search from the goal to the vessel, with
the planner's own heuristic, and with the cost of a diagonal step open, which the planner's is not.
"""

import heapq
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from usvkernels.search.replan_heuristics import guide
from usvkernels.search.steps import DIAGONAL, STRAIGHT

Cell = tuple[int, int]

_MOVES = tuple((dx, dy) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if dx or dy)


class Expansion(NamedTuple):
    """A first plan.

    Attributes:
        cells: expanded, in their order; some more than once if the heuristic overestimates.
        path: from the vessel to the goal.
    """

    cells: list[Cell]
    path: list[Cell]


def expand(
    blocked: np.ndarray, start: Cell, goal: Cell, heuristic: str, diagonal: int = DIAGONAL
) -> Expansion:
    """Expand cells from the goal until the vessel's cell is settled.

    Args:
        blocked: bool[H, W].
        start: the vessel's cell (x, y).
        goal: cell (x, y), connected with it.
        heuristic: as `dstar_lite` names it; diagonal steps need both cells beside them free.
        diagonal: cost of a diagonal step, in units of which a straight one costs `STRAIGHT`.
    """
    height, width = blocked.shape
    ahead = _guides(blocked.shape, start, goal, heuristic).tolist()
    free = np.zeros((height + 2, width + 2), bool)
    free[1:-1, 1:-1] = ~blocked
    open_cells = free.tolist()
    steps = [(dx, dy, diagonal if dx and dy else STRAIGHT) for dx, dy in _MOVES]

    def neighbours(x: int, y: int) -> list[tuple[Cell, int]]:
        return [
            ((x + dx, y + dy), cost)
            for dx, dy, cost in steps
            if open_cells[y + dy + 1][x + dx + 1]
            and open_cells[y + 1][x + dx + 1]
            and open_cells[y + dy + 1][x + 1]
        ]

    value, order = {goal: 0}, []
    settled: dict[Cell, int] = {}
    queue = [(ahead[goal[1]][goal[0]], goal[1], goal[0])]
    while queue:
        key, y, x = heapq.heappop(queue)
        if start in settled and key >= settled[start]:
            break
        g = value[x, y]
        if settled.get((x, y)) == g or key != g + ahead[y][x]:
            continue
        settled[x, y] = g
        order.append((x, y))
        for to, cost in neighbours(x, y):
            if g + cost < value.get(to, g + cost + 1):
                value[to] = g + cost
                heapq.heappush(queue, (g + cost + ahead[to[1]][to[0]], to[1], to[0]))
    path = [start]
    while path[-1] != goal:
        # Every settled cell has a settled neighbour that is nearer to the goal.
        near = [(settled[to] + cost, to) for to, cost in neighbours(*path[-1]) if to in settled]
        path.append(min(near, key=lambda one: one[0])[1])
    return Expansion(order, path)


def _guides(shape: tuple[int, int], start: Cell, goal: Cell, heuristic: str) -> np.ndarray:
    """The planner's heuristic of every cell; int64[H, W]."""
    y, x = jnp.indices(shape, dtype=jnp.int32)
    to_goal = jnp.int32(goal[0] - start[0]), jnp.int32(goal[1] - start[1])
    found = guide(heuristic, None, x - start[0], y - start[1], *to_goal)
    return np.asarray(found, np.int64)
