"""Cruises one at a time in plain Python, as such studies are written: dictionaries and a heap.

Replanning either with D* Lite (Koenig and Likhachev 2002, optimised version) or with A* anew when
a change seen blocks the way ahead. The rules are those of `usvjax.cruise`; the random
numbers are Python's own.
"""

import heapq
import math
import random
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

INF = math.inf
DIAGONAL = math.sqrt(2.0)
MOVES = [(x, y) for y in (-1, 0, 1) for x in (-1, 0, 1) if x or y]
REACH = 2  # cells that the vessel sees to each side
MAX_WAIT = 100
MAX_STEPS = 8  # of a leg, times height plus width

Cell = tuple[int, int]


class Water:
    """The map as a set of blocked cells, and the vessel's moves on it."""

    def __init__(self, blocked: np.ndarray) -> None:
        self.height, self.width = blocked.shape
        self.walls = {(int(x), int(y)) for y, x in np.argwhere(blocked)}

    def free(self, cell: Cell) -> bool:
        """Whether a cell is on the map and not blocked."""
        x, y = cell
        return 0 <= x < self.width and 0 <= y < self.height and cell not in self.walls

    def neighbours(self, cell: Cell) -> Iterator[tuple[Cell, float]]:
        """Where one move leads, and its length; corners are not cut."""
        x, y = cell
        for dx, dy in MOVES:
            there = (x + dx, y + dy)
            if not self.free(there):
                continue
            if dx and dy:
                if self.free((x + dx, y)) and self.free((x, y + dy)):
                    yield there, DIAGONAL
            else:
                yield there, 1.0


def octile(a: Cell, b: Cell) -> float:
    """Length of the shortest way on open water."""
    dx, dy = abs(a[0] - b[0]), abs(a[1] - b[1])
    return max(dx, dy) + (DIAGONAL - 1.0) * min(dx, dy)


class DStarLite:
    """One leg: the search from its goal, repaired with each change."""

    def __init__(self, water: Water, start: Cell, goal: Cell) -> None:
        self.water, self.goal, self.last = water, goal, start
        self.lead = 0.0
        self.g: dict[Cell, float] = {}
        self.rhs: dict[Cell, float] = {goal: 0.0}
        self.queued: dict[Cell, tuple[float, float]] = {}
        self.heap: list[tuple[tuple[float, float], Cell]] = []
        self._push(goal, start)

    def changed(self, cells: list[Cell], here: Cell) -> None:
        """Take in cells that have become blocked or free."""
        self.lead += octile(self.last, here)
        self.last = here
        for x, y in cells:
            for dx in (-1, 0, 1):
                for dy in (-1, 0, 1):
                    self._update((x + dx, y + dy), here)

    def next(self, here: Cell) -> Cell | None:
        """The next cell of a shortest way, if there is one."""
        self._search(here)
        if self.rhs.get(here, INF) == INF:
            return None
        ways = self.water.neighbours(here)
        return min(ways, key=lambda way: way[1] + self.g.get(way[0], INF))[0]

    def _key(self, cell: Cell, here: Cell) -> tuple[float, float]:
        least = min(self.g.get(cell, INF), self.rhs.get(cell, INF))
        return least + octile(here, cell) + self.lead, least

    def _push(self, cell: Cell, here: Cell) -> None:
        self.queued[cell] = self._key(cell, here)
        heapq.heappush(self.heap, (self.queued[cell], cell))

    def _update(self, cell: Cell, here: Cell) -> None:
        if cell != self.goal:
            ways = self.water.neighbours(cell) if self.water.free(cell) else ()
            self.rhs[cell] = min((c + self.g.get(n, INF) for n, c in ways), default=INF)
        self.queued.pop(cell, None)
        if self.g.get(cell, INF) != self.rhs[cell]:
            self._push(cell, here)

    def _search(self, here: Cell) -> None:
        while self.heap:
            key, cell = self.heap[0]
            if self.queued.get(cell) != key:
                heapq.heappop(self.heap)
                continue
            settled = self.g.get(here, INF) == self.rhs.get(here, INF)
            if key >= self._key(here, here) and settled:
                return
            heapq.heappop(self.heap)
            del self.queued[cell]
            if key < self._key(cell, here):
                self._push(cell, here)
            elif self.g.get(cell, INF) > self.rhs[cell]:
                self.g[cell] = self.rhs[cell]
                for there, _ in self.water.neighbours(cell):
                    self._update(there, here)
            else:
                self.g[cell] = INF
                self._update(cell, here)
                for there, _ in self.water.neighbours(cell):
                    self._update(there, here)


class AstarAnew:
    """One leg: a shortest way, searched for again when it is blocked."""

    def __init__(self, water: Water, start: Cell, goal: Cell) -> None:
        self.water, self.goal = water, goal
        self.way: list[Cell] = []  # cells still to come, the next one last
        self.hopeless = False

    def changed(self, cells: list[Cell], here: Cell) -> None:
        """Look whether the way is still clear."""
        self.hopeless = False
        before = here
        for there in reversed(self.way):
            sides = ((before[0], there[1]), (there[0], before[1]))
            if not self.water.free(there) or not all(map(self.water.free, sides)):
                self.way = []
                return
            before = there

    def next(self, here: Cell) -> Cell | None:
        """The next cell of the way, if there is one."""
        if not self.way and not self.hopeless:
            self._search(here)
        return self.way.pop() if self.way else None

    def _search(self, here: Cell) -> None:
        came: dict[Cell, Cell] = {}
        length = {here: 0.0}
        heap = [(octile(here, self.goal), here)]
        closed: set[Cell] = set()
        while heap:
            _, cell = heapq.heappop(heap)
            if cell == self.goal:
                while cell != here:
                    self.way.append(cell)
                    cell = came[cell]
                return
            if cell in closed:
                continue
            closed.add(cell)
            for there, cost in self.water.neighbours(cell):
                total = length[cell] + cost
                if total < length.get(there, INF):
                    length[there], came[there] = total, cell
                    heapq.heappush(heap, (total + octile(there, self.goal), there))
        self.hopeless = True


PLANNERS: dict[str, Callable[..., Any]] = {"D* Lite": DStarLite, "A* anew": AstarAnew}


def cruise(planner: str, blocked: np.ndarray, stops: list[Cell], rate: float, seed: int) -> float:
    """Sail one cruise.

    Args:
        planner: of PLANNERS.
        blocked: bool[H, W].
        stops: cells in the order of the cruise, home first and last.
        rate: probability with which a cell in view flips at a step.
        seed: of the flips.

    Returns:
        Length of the track in cells.
    """
    water, draw = Water(blocked), random.Random(seed).random
    here, length, fixed = stops[0], 0.0, set(stops)
    for goal in stops[1:]:
        leg = PLANNERS[planner](water, here, goal)
        waited = steps = 0
        while here != goal and waited <= MAX_WAIT and steps < MAX_STEPS * sum(blocked.shape):
            flips = _flips(water, here, fixed, rate, draw)
            if flips:
                leg.changed(flips, here)
            there = leg.next(here)
            steps += 1
            waited = 0 if there else waited + 1
            if there:
                length += octile(here, there)
                here = there
    return length


def _flips(
    water: Water, here: Cell, fixed: set[Cell], rate: float, draw: Callable[[], float]
) -> list[Cell]:
    """Flip cells in view."""
    flips = []
    for x in range(max(here[0] - REACH, 0), min(here[0] + REACH + 1, water.width)):
        for y in range(max(here[1] - REACH, 0), min(here[1] + REACH + 1, water.height)):
            if draw() < rate and (x, y) != here and (x, y) not in fixed:
                water.walls ^= {(x, y)}
                flips.append((x, y))
    return flips


def sail(planner: str, maps: np.ndarray, stops: np.ndarray, rate: float) -> list[float]:
    """Sail cruises one after the other.

    Args:
        planner: of PLANNERS.
        maps: bool[n, H, W].
        stops: int[n, d + 1, 2].
        rate: of the flips.

    Returns:
        Lengths of their tracks in cells.
    """
    lists = [[(int(x), int(y)) for x, y in row] for row in stops]
    return [cruise(planner, *one, rate, j) for j, one in enumerate(zip(maps, lists, strict=True))]
