"""D* Lite in plain Python, after the paper's pseudocode, and Dijkstra, to compare with.

Costs are integers, a straight step STRAIGHT and a diagonal one DIAGONAL, as in the kernel. The
planner is written apart from it: explicit rhs, a heap, cells as (x, y).
"""

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

STRAIGHT, DIAGONAL = 80782, 114243
INF = 2**30
Cell = tuple[int, int]
AROUND = [(x, y) for y in (-1, 0, 1) for x in (-1, 0, 1) if x or y]


def steps_from(blocked: np.ndarray, cell: Cell, corner_cutting: bool) -> Iterator[tuple[Cell, int]]:
    """Where one step leads from a free cell, and what it costs."""
    height, width = blocked.shape

    def free(x: int, y: int) -> bool:
        return 0 <= x < width and 0 <= y < height and not blocked[y, x]

    x, y = cell
    for dx, dy in AROUND:
        diagonal = dx != 0 and dy != 0
        sides_free = corner_cutting or (free(x + dx, y) and free(x, y + dy))
        if free(x + dx, y + dy) and (sides_free or not diagonal):
            yield (x + dx, y + dy), DIAGONAL if diagonal else STRAIGHT


def distances(blocked: np.ndarray, goal: Cell, corner_cutting: bool) -> np.ndarray:
    """Exact cost-to-go of every cell by scipy's Dijkstra, float64[H, W]; inf where cut off."""
    height, width = blocked.shape
    edge = np.pad(~blocked, 1)
    rows, columns, costs = [], [], []
    here = np.arange(height * width).reshape(height, width)
    for dx, dy in AROUND:
        target = edge[1 + dy : 1 + dy + height, 1 + dx : 1 + dx + width]
        open_step = ~blocked & target
        if dx and dy and not corner_cutting:
            open_step &= edge[1 : 1 + height, 1 + dx : 1 + dx + width]
            open_step &= edge[1 + dy : 1 + dy + height, 1 : 1 + width]
        rows.append(here[open_step])
        columns.append(here[open_step] + dx + dy * width)
        costs.append(np.full(open_step.sum(), DIAGONAL if dx and dy else STRAIGHT, float))
    joined = (np.concatenate(costs), (np.concatenate(rows), np.concatenate(columns)))
    graph = coo_matrix(joined, shape=(here.size, here.size)).tocsr()
    return dijkstra(graph, indices=goal[0] + goal[1] * width).reshape(height, width)


@dataclass
class Planner:
    """D* Lite; `two_part` takes the paper's pair of keys, otherwise one number as the kernel's."""

    blocked: np.ndarray
    start: Cell
    goal: Cell
    corner_cutting: bool = False
    heuristic: str = "octile"
    weight: float | None = None
    two_part: bool = False
    lead: int = 0
    expanded: int = 0
    g: dict[Cell, int] = field(default_factory=dict)
    rhs: dict[Cell, int] = field(default_factory=dict)
    keys: dict[Cell, tuple[int, ...]] = field(default_factory=dict)
    heap: list[tuple[tuple[int, ...], int, int]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.blocked = self.blocked.copy()
        self.origin = self.start
        self.rhs[self.goal] = 0
        self._queue(self.goal)

    def bound(self, a: Cell, b: Cell) -> int:
        """The consistent distance between two cells."""
        short = 0 if self.two_part else 1
        dx, dy = abs(a[0] - b[0]), abs(a[1] - b[1])
        if self.heuristic == "chebyshev":
            return max(dx, dy) * (STRAIGHT - short)
        return max(dx, dy) * (STRAIGHT - short) + min(dx, dy) * (DIAGONAL - STRAIGHT)

    def guide(self, cell: Cell) -> int:
        """The distance of a cell from the origin that guides the search."""
        base = self.bound(self.origin, cell)
        if self.heuristic in ("octile", "chebyshev"):
            return base
        dx, dy = abs(cell[0] - self.origin[0]), abs(cell[1] - self.origin[1])
        if self.heuristic == "weighted":
            base = min(dx, dy) * DIAGONAL + (dx + dy) * STRAIGHT
        if self.weight is not None:
            return base + base // 1024 * round((self.weight - 1) * 1024)
        near = math.isqrt(256 * (dx * dx + dy * dy))
        far = (self.goal[0] - self.origin[0]) ** 2 + (self.goal[1] - self.origin[1]) ** 2
        far = math.isqrt(256 * far)
        return base + base // 1024 * (1024 * min(near, far) // max(far, 1))

    def key(self, cell: Cell) -> tuple[int, ...]:
        """Priority of an inconsistent cell."""
        g, rhs = self.g.get(cell, INF), self.rhs.get(cell, INF)
        reach = self.bound(self.origin, cell) if g < rhs else self.guide(cell)
        first = min(g, rhs) + reach + self.lead
        return (first, min(g, rhs)) if self.two_part else (first,)

    def flip(self, cell: Cell) -> None:
        """A cell becomes blocked, or free."""
        self._follow()
        x, y = cell
        self.blocked[y, x] ^= True
        self.g[cell] = INF
        self._refresh(cell)

    def search(self) -> int:
        """Compute the shortest path; the vessel's cost-to-go, INF where it is cut off."""
        while self._unsettled():
            self._follow()
            key, y, x = heapq.heappop(self.heap)
            cell = (x, y)
            if key < self.key(cell):
                self._refresh(cell)
                continue
            g, rhs = self.g.get(cell, INF), self.rhs.get(cell, INF)
            self.g[cell] = rhs if g > rhs else INF
            self.expanded += 1
            self._refresh(cell)
        return self.g.get(self.start, INF)

    def move(self) -> None:
        """Go one step along the path, if there is one."""
        self._refresh(self.start)  # keys of now where they had fallen behind
        if self.g.get(self.start, INF) < INF:
            steps = steps_from(self.blocked, self.start, self.corner_cutting)
            self.start = min(steps, key=lambda step: step[1] + self.g.get(step[0], INF))[0]

    def _follow(self) -> None:
        self.lead += self.bound(self.origin, self.start)
        self.origin = self.start

    def _unsettled(self) -> bool:
        while self.heap and self.keys.get(self.heap[0][2:0:-1]) != self.heap[0][0]:
            heapq.heappop(self.heap)
        if self.start in self.keys:
            return True
        if not self.heap:
            return False
        if self.g.get(self.start, INF) >= INF:
            return True
        # The vessel's own key, seen from the cell that the keys in the queue refer to.
        own = self.g[self.start] + self.lead + self.bound(self.origin, self.start)
        return self.heap[0][0] < ((own, self.g[self.start]) if self.two_part else (own,))

    def _refresh(self, centre: Cell) -> None:
        height, width = self.blocked.shape
        for y in range(max(centre[1] - 1, 0), min(centre[1] + 2, height)):
            for x in range(max(centre[0] - 1, 0), min(centre[0] + 2, width)):
                cell = (x, y)
                self.keys.pop(cell, None)
                if self.blocked[y, x]:
                    self.rhs[cell] = INF
                    continue
                if cell != self.goal:
                    steps = steps_from(self.blocked, cell, self.corner_cutting)
                    ways = [cost + self.g.get(to, INF) for to, cost in steps]
                    self.rhs[cell] = min([*ways, INF])
                if self.g.get(cell, INF) != self.rhs.get(cell, INF):
                    self._queue(cell)

    def _queue(self, cell: Cell) -> None:
        self.keys[cell] = self.key(cell)
        heapq.heappush(self.heap, (self.keys[cell], cell[1], cell[0]))


@dataclass
class Sailed:
    """One episode: position [T + 1], cost [T + 1] (integers, INF), expanded [T + 1]."""

    position: list[Cell]
    cost: list[int]
    expanded: list[int]


def sail(
    blocked: np.ndarray,
    start: Cell,
    goal: Cell,
    flips: np.ndarray,
    sensing: tuple[int, int] | None = None,
    **method: Any,
) -> Sailed:
    """Sail an episode with the plain planner; flips int[T, C, 2]."""
    planner = Planner(blocked, start, goal, **method)
    truth = blocked.copy()
    sailed = Sailed([], [], [])

    def replan() -> None:
        for x, y in _noticed(truth, planner.blocked, planner.start, sensing):
            planner.flip((x, y))
        planner.search()

    def record() -> None:
        sailed.position.append(planner.start)
        sailed.cost.append(0 if planner.start == goal else planner.g.get(planner.start, INF))
        sailed.expanded.append(planner.expanded)
        planner.expanded = 0

    if start != goal:
        planner.search()
    record()
    for step in flips:
        _change(truth, step, planner.start, goal)
        if planner.start != goal:
            replan()
            planner.move()
        if sensing and planner.start != goal:
            replan()
        record()
    return sailed


@dataclass
class Replay:
    """The maps of an episode: `true` and `planned` [T] at each move, `known` [T + 1] afterwards."""

    true: list[np.ndarray]
    planned: list[np.ndarray]
    known: list[np.ndarray]


def replay(
    blocked: np.ndarray,
    position: np.ndarray,
    goal: Cell,
    flips: np.ndarray,
    sensing: tuple[int, int] | None = None,
) -> Replay:
    """What is there and what is known of it, given where the vessel was; position int[T + 1, 2]."""
    truth, known = blocked.copy(), blocked.copy()
    maps = Replay([], [], [known.copy()])
    for step, (here, there) in enumerate(pairwise(map(tuple, position.tolist()))):
        _change(truth, flips[step], here, goal)
        for at, kept in ((here, maps.planned), (there, maps.known)):
            for x, y in _noticed(truth, known, at, sensing):
                known[y, x] ^= True
            kept.append(known.copy())
        maps.true.append(truth.copy())
    return maps


def _change(truth: np.ndarray, step: np.ndarray, here: Cell, goal: Cell) -> None:
    for x, y in step.tolist():
        if x >= 0 and (x, y) not in (here, goal):
            truth[y, x] ^= True


def _noticed(
    truth: np.ndarray, known: np.ndarray, here: Cell, sensing: tuple[int, int] | None
) -> list[Cell]:
    """Cells that are not as they are known to be, and in sight."""
    differs = truth != known
    if sensing is not None:
        (x, y), (tall, wide) = here, sensing
        window = np.zeros_like(truth)
        top, left = max(y - tall // 2, 0), max(x - wide // 2, 0)
        window[top : y + tall // 2 + 1, left : x + wide // 2 + 1] = True
        differs &= window
    return [(int(x), int(y)) for y, x in np.argwhere(differs)]
