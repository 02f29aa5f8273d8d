"""A* as programs of the time have it, one query at a time, with every choice of its ties open.

For questions that the batched search does not pose: what a diagonal cost of 1.4 changes, and what
the order in which cells enter the open list does. Costs are whole numbers, so ties are true ties.
"""

import heapq
from dataclasses import dataclass
from math import ceil

import numpy as np

Cell = tuple[int, int]

CLOCKWISE = ((0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1))
"""Moves (dx, dy) 45 degrees apart, north (row 0 is the uppermost) first."""
UPPER_FIRST = (7, 0, 1, 6, 2, 5, 4, 3)
"""Places in `CLOCKWISE`, row by row from the uppermost."""
LOWER_FIRST = (5, 4, 3, 6, 2, 7, 0, 1)
"""The same from the lowest row."""
STRAIGHTS_FIRST = (2, 4, 6, 0, 7, 5, 1, 3)
"""The four straight moves, then the diagonal ones."""


@dataclass(frozen=True)
class Rules:
    """How the search goes about it.

    Attributes:
        straight, diagonal: cost of a step, whole numbers.
        heuristic: "manhattan", "euclidean" (rounded up) or "octile", in the same units.
        turn: cost of 45 degrees in the evaluation of a cell, given its parent (Zhang et al.
            2019, Eq. 7).
        accumulate: whether that cost counts in the way to what follows, too.
        corner_cutting: whether a diagonal step may pass a blocked cell beside it.
        order: places in `CLOCKWISE`, in the order in which neighbours are looked at.
        last_in: of cells with equal values take the one that entered the open list last, not
            first.
    """

    straight: int = 10
    diagonal: int = 14
    heuristic: str = "manhattan"
    turn: int = 0
    accumulate: bool = False
    corner_cutting: bool = False
    order: tuple[int, ...] = LOWER_FIRST
    last_in: bool = False

    def estimate(self, dx: int, dy: int) -> int:
        """Heuristic of a cell that lies dx columns and dy rows from the goal, both >= 0."""
        if self.heuristic == "manhattan":
            return self.straight * (dx + dy)
        if self.heuristic == "euclidean":
            return ceil(self.straight * (dx * dx + dy * dy) ** 0.5)
        return self.straight * max(dx, dy) + (self.diagonal - self.straight) * min(dx, dy)


def search(
    blocked: np.ndarray, start: Cell, goal: Cell, rules: Rules
) -> tuple[list[Cell], list[Cell]]:
    """Search a path; closed cells stay closed.

    Args:
        blocked: bool[H, W].
        start, goal: free cells (x, y).
        rules: of the search.

    Returns:
        The path, empty where there is none, and the cells expanded, in their order.
    """
    height, width = blocked.shape
    stride = width + 2
    free = (~np.pad(blocked, 1, constant_values=True)).ravel().tolist()
    goal_at = (goal[1] + 1) * stride + goal[0] + 1
    start_at = (start[1] + 1) * stride + start[0] + 1
    columns = [abs(x - 1 - goal[0]) for x in range(stride)]
    rows = [abs(y - 1 - goal[1]) for y in range(height + 2)]
    steps = [
        (
            place,
            dy * stride + dx,
            (dx, dy * stride) if dx and dy and not rules.corner_cutting else None,
            rules.diagonal if dx and dy else rules.straight,
        )
        for place in rules.order
        for dx, dy in (CLOCKWISE[place],)
    ]
    cost, value = {start_at: 0}, {start_at: 0}
    heading, parent = {start_at: -1}, {start_at: 0}
    entered = {start_at: 0}
    queue, closed, expanded = [(0, 0, start_at)], set(), []
    sign = -1 if rules.last_in else 1
    while queue:
        _, _, at = heapq.heappop(queue)
        if at in closed:
            continue
        closed.add(at)
        expanded.append(at)
        if at == goal_at:
            break
        g, course = cost[at], heading[at]
        for place, offset, sides, length in steps:
            to = at + offset
            if not free[to] or to in closed:
                continue
            if sides and not (free[at + sides[0]] and free[at + sides[1]]):
                continue
            turned = 0
            if rules.turn and course >= 0:
                apart = (place - course) % 8
                turned = rules.turn * min(apart, 8 - apart)
            f = g + length + turned + rules.estimate(columns[to % stride], rows[to // stride])
            if to in value and f >= value[to]:
                continue
            value[to], cost[to] = f, g + length + (turned if rules.accumulate else 0)
            parent[to], heading[to] = at, place
            turn_in = entered.setdefault(to, sign * len(entered))
            heapq.heappush(queue, (f, turn_in, to))
    path = []
    if goal_at in closed:
        path = [goal_at]
        while path[-1] != start_at:
            path.append(parent[path[-1]])
    return _cells(path[::-1], stride), _cells(expanded, stride)


def _cells(places: list[int], stride: int) -> list[Cell]:
    return [(at % stride - 1, at // stride - 1) for at in places]
