"""D* Lite of python-motion-planning 1.1.1, driven along an episode of ours.

Its class plans; its interactive part moves the vessel and changes cells, one per mouse click. Here
that part is written out for many changes and moves, with km summed as the algorithm wants it.
"""

import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass
class Followed:
    """What came of an episode, per replanning."""

    seconds: list[float] = field(default_factory=list)
    expanded: list[int] = field(default_factory=list)
    cost: list[float] = field(default_factory=list)  # nan where it raised an exception
    error: str = ""


class _TooManyError(Exception):
    pass


class _Limited(list[Any]):
    """The list of expanded cells, which refuses to grow without end."""

    def __init__(self, most: int) -> None:
        super().__init__()
        self.most = most

    def append(self, cell: Any) -> None:
        if len(self) >= self.most:
            raise _TooManyError("does not end")
        super().append(cell)


def follow(
    blocked: np.ndarray, goal: np.ndarray, position: np.ndarray, flips: np.ndarray
) -> Followed:
    """Replan at each position after each change.

    Args:
        blocked: bool[H, W].
        goal: int[2], cell (x, y).
        position: int[T + 1, 2], where the vessel is, whoever chose it.
        flips: int[T, C, 2].

    Returns:
        The first plan, and one for each step until the goal or an exception.
    """
    from python_motion_planning.global_planner.graph_search.d_star_lite import DStarLite
    from python_motion_planning.utils import Grid

    height, width = blocked.shape
    grid = Grid(width + 2, height + 2)  # its outermost cells are blocked
    inside = {(int(x) + 1, int(y) + 1) for y, x in np.argwhere(blocked)}
    grid.update(grid.obstacles | inside)
    end = tuple((goal + 1).tolist())
    planner = DStarLite(tuple((position[0] + 1).tolist()), end, grid)
    followed, last = Followed(), planner.start
    for t in range(len(flips) + 1):
        here = tuple((position[max(t - 1, 0)] + 1).tolist())
        if here == end:
            break
        planner.EXPAND = _Limited(20 * blocked.size)
        began = time.perf_counter()
        try:
            if t > 0:
                planner.start = planner.map[here]
                planner.km += planner.h(last, planner.start)
                last = planner.start
                _change(planner, flips[t - 1], here, end)
            planner.computeShortestPath()
            cost = planner.start.g
        except (_TooManyError, ValueError) as error:
            cost, followed.error = float("nan"), str(error)
        followed.seconds.append(time.perf_counter() - began)
        followed.expanded.append(len(planner.EXPAND))
        followed.cost.append(cost)
        if followed.error:
            break
    return followed


def _change(planner: Any, step: np.ndarray, here: tuple[int, ...], goal: tuple[int, ...]) -> None:
    """As its handler of mouse clicks does it, but for its plots and a search tree of obstacles."""
    for cell in map(tuple, (step + 1).tolist()):
        if cell in (here, goal, (0, 0)):
            continue
        node = planner.map[cell]
        if cell in planner.obstacles:
            planner.obstacles.remove(cell)
            planner.updateVertex(node)
        else:
            planner.obstacles.add(cell)
        for neighbour in planner.getNeighbor(node):
            planner.updateVertex(neighbour)
