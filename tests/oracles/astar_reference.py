"""Oracles for grid searches: Dijkstra by scipy, and A* with Python's heapq, cell by cell."""

import heapq
import itertools
import math
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

MOVES = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
STRAIGHT, DIAGONAL = 2378, 3363


@dataclass(frozen=True)
class Scenes:
    """B random queries."""

    blocked: np.ndarray  # bool[B, H, W]
    starts: np.ndarray  # int[B, 2]
    goals: np.ndarray  # int[B, 2]

    def __len__(self) -> int:
        return len(self.starts)


def random_scenes(
    seed: int,
    count: int,
    shape: tuple[int, int],
    density: tuple[float, float] = (0.0, 0.6),
    least: int | None = None,
) -> Scenes:
    """Queries on maps of random density, start and goal free.

    With `least`, each map is a rectangle of random sides from that on in the corner of a
    blocked map of the given shape.
    """
    rng = np.random.default_rng(seed)
    height, width = shape
    low, high = density
    blocked = rng.random((count, height, width)) < rng.uniform(low, high, (count, 1, 1))
    sides = np.tile([width, height], (count, 1))
    if least is not None:
        sides = rng.integers(least, [width + 1, height + 1], (count, 2))
        rows, columns = np.arange(height)[:, None], np.arange(width)
        blocked |= rows >= sides[:, 1, None, None]
        blocked |= columns >= sides[:, 0, None, None]
    starts, goals = rng.integers(0, sides), rng.integers(0, sides)
    for cells in (starts, goals):
        blocked[np.arange(count), cells[:, 1], cells[:, 0]] = False
    return Scenes(blocked, starts, goals)


def may_step(
    blocked: np.ndarray, cell: tuple[int, int], move: tuple[int, int], corner_cutting: bool
) -> bool:
    """Whether a vessel at a cell can make a move."""
    (x, y), (dx, dy) = cell, move
    height, width = blocked.shape
    if not (0 <= x + dx < width and 0 <= y + dy < height) or blocked[y + dy, x + dx]:
        return False
    return corner_cutting or not (dx and dy and (blocked[y, x + dx] or blocked[y + dy, x]))


def shortest(
    blocked: np.ndarray,
    start: np.ndarray,
    goal: np.ndarray,
    corner_cutting: bool = False,
    connectivity: int = 8,
) -> float:
    """Length of the shortest path by scipy; inf where there is none."""
    height, width = blocked.shape
    free = np.pad(~blocked, 1)
    y, x = np.nonzero(~blocked)
    edges = []
    for dx, dy in MOVES:
        ok = free[y + 1 + dy, x + 1 + dx]
        if dx and dy:
            if connectivity == 4:
                continue
            if not corner_cutting:
                ok = ok & free[y + 1, x + 1 + dx] & free[y + 1 + dy, x + 1]
        source = (y * width + x)[ok]
        edges.append((source, source + dy * width + dx, np.full(len(source), math.hypot(dx, dy))))
    source, target, length = (np.concatenate(part) for part in zip(*edges, strict=True))
    graph = coo_matrix((length, (source, target)), shape=(height * width,) * 2).tocsr()
    found = dijkstra(graph, indices=int(start[1]) * width + int(start[0]))
    return float(found[int(goal[1]) * width + int(goal[0])])


def turning(path: list[tuple[int, int]]) -> int:
    """Turning angles of a path of cells added up, in multiples of 45 degrees."""
    moves = [(b[0] - a[0], b[1] - a[1]) for a, b in itertools.pairwise(path)]
    angles = [MOVES.index(move) for move in moves]
    return sum(min((b - a) % 8, (a - b) % 8) for a, b in itertools.pairwise(angles))


def least_with_turning(
    blocked: np.ndarray, start: np.ndarray, goal: np.ndarray, turn_cost: float
) -> float:
    """Least length plus turning cost by scipy, over pairs of cell and heading."""
    height, width = blocked.shape
    nodes = height * width * 8
    source, target, length = [], [], []
    for y, x in zip(*np.nonzero(~blocked), strict=True):
        for d, (dx, dy) in enumerate(MOVES):
            if not may_step(blocked, (x, y), (dx, dy), False):
                continue
            for h in range(8):
                source.append((y * width + x) * 8 + h)
                target.append(((y + dy) * width + x + dx) * 8 + d)
                turned = min((d - h) % 8, (h - d) % 8)
                length.append(math.hypot(dx, dy) + turn_cost * turned)
    graph = coo_matrix((length, (source, target)), shape=(nodes, nodes)).tocsr()
    first, last = (int(c[1]) * width + int(c[0]) for c in (start, goal))
    # The first move turns from nowhere: any heading at the start will do.
    found = dijkstra(graph, indices=range(first * 8, first * 8 + 8), min_only=True)
    return float(found[last * 8 : last * 8 + 8].min())


@dataclass
class Reference:
    """A* with a binary heap, as a book has it, in the whole numbers of the kernel."""

    blocked: np.ndarray
    start: tuple[int, int]
    goal: tuple[int, int]
    heuristic: str = "octile"
    weight: float = 1.0
    connectivity: int = 8
    corner_cutting: bool = False
    reopen: bool = False
    turn_mode: str = "none"
    turn_cost: int = 0
    expansions: list[tuple[int, int]] = field(default_factory=list)
    path: list[tuple[int, int]] | None = None

    def estimate(self, cell: tuple[int, int]) -> int:
        """Weighted heuristic of a cell."""
        dx, dy = abs(cell[0] - self.goal[0]), abs(cell[1] - self.goal[1])
        value = {
            "octile": STRAIGHT * max(dx, dy) + (DIAGONAL - STRAIGHT) * min(dx, dy),
            "euclidean": math.isqrt(STRAIGHT**2 * (dx * dx + dy * dy)),
            "chebyshev": STRAIGHT * max(dx, dy),
            "manhattan": STRAIGHT * (dx + dy),
            "zero": 0,
        }[self.heuristic]
        return math.floor(self.weight * value)

    def key(self, f: int, cell: tuple[int, int], heading: int) -> tuple[int, ...]:
        """Of the open list: f, then h in coarse steps, then the cell row by row."""
        height, width = self.blocked.shape
        bits = 7 if height * width <= 2**14 else 5
        shift = max(0, (DIAGONAL * (height + width)).bit_length() - bits)
        return f, min(self.estimate(cell) >> shift, 2**bits - 1), cell[1], cell[0], heading

    def run(self) -> "Reference":
        """Search; fills `expansions` and `path`."""
        exact = self.turn_mode == "exact"
        first = (self.start, 0)
        best = {first: (self.estimate(self.start), 0)}  # state: F and g
        entered: dict[tuple[tuple[int, int], int], tuple] = {first: (None, None)}
        closed: set = set()
        open_list = [(self.key(best[first][0], self.start, 0), first)]
        while open_list:
            key, state = heapq.heappop(open_list)
            if state in closed or key[0] != best[state][0]:
                continue
            closed.add(state)
            self.expansions.append(state[0])
            if state[0] == self.goal:
                self.path = self._path(state, entered)
                break
            g, heading = best[state][1], entered[state][1]
            for d, move in enumerate(MOVES):
                if self.connectivity == 4 and d % 2:
                    continue
                if not may_step(self.blocked, state[0], move, self.corner_cutting):
                    continue
                cell = (state[0][0] + move[0], state[0][1] + move[1])
                turned = 0 if heading is None else min((d - heading) % 8, (heading - d) % 8)
                e = self.turn_cost * turned
                longer = g + (DIAGONAL if d % 2 else STRAIGHT)
                f = longer + e + self.estimate(cell)
                after = (cell, d if exact else 0)
                if after in closed and not self.reopen:
                    continue
                if after in best and best[after][0] <= f:
                    continue
                closed.discard(after)
                best[after] = (f, longer if self.turn_mode == "parent" else longer + e)
                entered[after] = (state, d)
                heapq.heappush(open_list, (self.key(f, *after), after))
        return self

    def _path(self, state: tuple, entered: dict) -> list[tuple[int, int]]:
        cells = []
        while state is not None:
            cells.append(state[0])
            state = entered[state][0]
        return cells[::-1]
