"""Paths on random grids: the batched search, and a textbook program for what ties do."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import partial
from math import sqrt
from time import perf_counter
from typing import Any

import jax
import numpy as np

import usvjax as uj
from experiments import textbook
from experiments.parallel import device_of, on_own_devices
from experiments.textbook import LOWER_FIRST, UPPER_FIRST, Rules
from experiments.zhang2019.published import DIAGONAL, GAMMA
from usvjax.search.astar import astar
from usvkernels.status import Status

SIDE = 25
"""Cells of a side of the maps; see `sizes` for why."""
DENSITIES = (0.1, 0.2, 0.3)
SHOWN_DENSITY = 0.3
"""The density at which the maps come nearest to the paper's."""
SIZES = (20, 25, 28, 31)
"""Sides that are compared; the last three are those that Table 3's lengths allow for."""

BATCHED: dict[str, dict[str, Any]] = {
    "traditional": {"heuristic": "manhattan"},
    "printed": {"heuristic": "manhattan", "turn_cost": GAMMA, "turn_mode": "parent"},
    "accumulated": {"heuristic": "manhattan", "turn_cost": GAMMA, "turn_mode": "accumulated"},
    "exact": {"turn_cost": GAMMA, "turn_mode": "exact"},
}
"""Label of a method to what `astar` is told."""
TIMED = ("traditional", "printed", "accumulated")

_TRADITIONAL = Rules(straight=1000, diagonal=1400)
TEXTBOOK: dict[str, Rules] = {
    "traditional": _TRADITIONAL,
    "traditional, upper first": Rules(1000, 1400, order=UPPER_FIRST),
    "traditional, last in": Rules(1000, 1400, last_in=True),
    "ties only": Rules(1000, 1400, turn=1),
    "printed": Rules(1000, 1400, turn=500),
    "printed, upper first": Rules(1000, 1400, turn=500, order=UPPER_FIRST),
    "printed, last in": Rules(1000, 1400, turn=500, last_in=True),
    "accumulated": Rules(1000, 1400, turn=500, accumulate=True),
}
"""Label to rules; cells with equal values in order of entry, lower neighbours first, unless
the label says otherwise. "ties only": the turning cost is so small that only ties feel it."""
assert TEXTBOOK["traditional"].order == LOWER_FIRST


@dataclass(frozen=True)
class Plan:
    """How many maps, and from which seed.

    Attributes:
        seed: of the maps.
        maps: per density, for the batched search.
        textbook_maps: how many of them the textbook program searches, too.
        size_maps: per side and density, for the table of sizes.
        repeats: of the timed runs.
    """

    seed: int = 2019
    maps: int = 10_000
    textbook_maps: int = 1000
    size_maps: int = 100
    repeats: int = 5


@dataclass(frozen=True)
class Paths:
    """What n paths consist of; arrays in the order of the maps.

    Attributes:
        found: bool[n].
        straight, diagonal: int[n], steps.
        turns: int[n], changes of course added up, in multiples of 45 degrees.
        expanded: int[n], cells.
    """

    found: np.ndarray
    straight: np.ndarray
    diagonal: np.ndarray
    turns: np.ndarray
    expanded: np.ndarray

    def length(self, diagonal: float = DIAGONAL) -> np.ndarray:
        """Length in squares; float[n]."""
        length: np.ndarray = self.straight + diagonal * self.diagonal
        return length

    @property
    def turning(self) -> np.ndarray:
        """Turning cost in squares; float[n]."""
        turning: np.ndarray = GAMMA * self.turns
        return turning

    def total(self, diagonal: float = DIAGONAL) -> np.ndarray:
        """Length and turning cost; float[n]."""
        return self.length(diagonal) + self.turning

    def some(self, chosen: np.ndarray) -> "Paths":
        """Return those that a mask or an index names."""
        return Paths(**{f.name: getattr(self, f.name)[chosen] for f in fields(self)})


EXACT_DIAGONAL = sqrt(2.0)


@dataclass(frozen=True)
class Batch:
    """All paths of one method at one density.

    Attributes:
        paths: what they consist of.
        cells: int[n, P, 2], cells (x, y) of each path, the goal repeated.
    """

    paths: Paths
    cells: np.ndarray


def draw(plan: Plan) -> dict[float, np.ndarray]:
    """Draw the maps of every density, both corners free; bool[maps, SIDE, SIDE] each."""
    grids = {}
    for density in DENSITIES:
        drawn = uj.random_maps(plan.seed, plan.maps, (SIDE, SIDE), density)
        drawn[:, 0, 0] = drawn[:, -1, -1] = False
        grids[density] = drawn
    return grids


def batched(
    grids: dict[float, np.ndarray], advance: Callable[[int], object] = lambda done: None
) -> dict[str, dict[float, Batch]]:
    """Search all maps with every method; method to density to paths."""

    def search(method: str) -> dict[float, Batch]:
        found = {}
        for density, blocked in grids.items():
            found[density] = _searched(method, blocked)
            advance(1)
        return found

    done = on_own_devices([partial(search, method) for method in BATCHED])
    return dict(zip(BATCHED, done, strict=True))


def _searched(method: str, blocked: np.ndarray) -> Batch:
    corner = blocked.shape[-1] - 1
    result = astar(blocked, (0, 0), (corner, corner), engine="queue", **BATCHED[method])
    measured = measure(result.path)
    found = result.status == Status.FOUND
    return Batch(Paths(found, *measured, result.expanded), result.path)


def measure(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Count straight steps, diagonal steps and turns by 45 degrees; int[n] each.

    Args:
        cells: int[n, P, 2], cells of each path, the last one repeated.
    """
    step = np.diff(cells, axis=1)
    moved = np.abs(step).sum(axis=2)
    direction = np.round(np.arctan2(step[..., 1], step[..., 0]) / (np.pi / 4)).astype(int)
    apart = np.abs(np.diff(direction, axis=1)) % 8
    turns = np.where(moved[:, 1:] > 0, np.minimum(apart, 8 - apart), 0)
    return (moved == 1).sum(axis=1), (moved == 2).sum(axis=1), turns.sum(axis=1)


def timed(blocked: np.ndarray, repeats: int) -> dict[str, list[float]]:
    """Time the batched search again, all compiled; method to s per query, a value per repeat.

    Each method runs on one device, and the methods take turns. Call it after `batched`.
    """
    places = {method: list(BATCHED).index(method) for method in TIMED}
    taken: dict[str, list[float]] = {method: [] for method in TIMED}
    for _ in range(repeats):
        for method, place in places.items():
            with jax.default_device(device_of(place)):
                begun = perf_counter()
                _searched(method, blocked)
                taken[method].append((perf_counter() - begun) / len(blocked))
    return taken


@dataclass(frozen=True)
class Textbook:
    """What the textbook program found at one density.

    Attributes:
        paths: label of `TEXTBOOK` to its paths.
        seconds: label to s, all queries together.
    """

    paths: dict[str, Paths]
    seconds: dict[str, float]


def textbook_runs(
    grids: dict[float, np.ndarray], count: int, advance: Callable[[int], object] = lambda done: None
) -> dict[float, Textbook]:
    """Search the first `count` maps of every density, rule by rule on each map."""
    found = {}
    for density, blocked in grids.items():
        found[density] = _textbook(blocked[:count], TEXTBOOK)
        advance(1)
    return found


def _textbook(blocked: np.ndarray, rules: dict[str, Rules]) -> Textbook:
    corner = blocked.shape[-1] - 1
    rows: dict[str, list[tuple[int, ...]]] = {label: [] for label in rules}
    seconds = dict.fromkeys(rules, 0.0)
    for grid in blocked:
        for label, rule in rules.items():
            begun = perf_counter()
            path, expanded = textbook.search(grid, (0, 0), (corner, corner), rule)
            seconds[label] += perf_counter() - begun
            rows[label].append((*_measured(path), len(expanded)))
    return Textbook({label: _paths(table) for label, table in rows.items()}, seconds)


def _measured(path: Sequence[textbook.Cell]) -> tuple[int, ...]:
    if not path:
        return 0, 0, 0, 0
    straight, diagonal, turns = measure(np.array([path]))
    return 1, int(straight[0]), int(diagonal[0]), int(turns[0])


def _paths(table: list[tuple[int, ...]]) -> Paths:
    found, *rest = np.array(table).T
    return Paths(found.astype(bool), *rest)


@dataclass(frozen=True)
class Size:
    """What the traditional search gives on maps of one side and density.

    Attributes:
        side: cells.
        density: of blocked cells.
        reached: share of maps with a path.
        length, turning: means over these, in squares.
    """

    side: int
    density: float
    reached: float
    length: float
    turning: float


def sizes(plan: Plan) -> list[Size]:
    """Search maps of several sides by the textbook's traditional rule."""
    found = []
    for side in SIZES:
        for density in DENSITIES:
            rng = np.random.default_rng([plan.seed, side])
            blocked = rng.random((plan.size_maps, side, side)) < density
            blocked[:, 0, 0] = blocked[:, -1, -1] = False
            paths = _textbook(blocked, {"traditional": _TRADITIONAL}).paths["traditional"]
            some = paths.some(paths.found)
            share = float(paths.found.mean())
            if not len(some.found):
                continue
            length, turning = float(some.length().mean()), float(some.turning.mean())
            found.append(Size(side, density, share, length, turning))
    return found
