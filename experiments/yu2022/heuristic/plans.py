"""First plans of D* Lite with each heuristic, and episodes on maps that change."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy import ndimage

import usvjax as uj
from experiments.parallel import on_own_devices
from experiments.yu2022.heuristic.published import HEURISTICS, SENSING
from usvjax.search.replanning import dstar_lite
from usvkernels.status import Status

APART = 0.5
"""Share of the side by which start and goal of a first plan differ at least, in x or in y."""


@dataclass(frozen=True)
class Condition:
    """A kind of map.

    Attributes:
        label: for tables.
        side: cells.
        density: of blocked cells.
        flips: cells that change with every move, anywhere on the map.
        moves: after which an episode ends.
    """

    label: str
    side: int
    density: float
    flips: int
    moves: int


PLANS = (
    Condition("50 x 50, 10 % (ordinary)", 50, 0.10, 0, 150),
    Condition("50 x 50, 20 %", 50, 0.20, 0, 150),
    Condition("50 x 50, 30 %", 50, 0.30, 0, 150),
    Condition("100 x 100, 12 % (complex)", 100, 0.12, 0, 250),
)
EPISODES = (
    Condition("50 x 50, 10 %, 3 cells a move", 50, 0.10, 3, 150),
    Condition("50 x 50, 10 %, 12 cells a move", 50, 0.10, 12, 150),
)
_WIDTH = {50: 12, 100: 1}
"""Columns of the table of flips, by side: as many for every condition share a program."""


@dataclass(frozen=True)
class Scenes:
    """What the episodes of a condition begin with.

    Attributes:
        blocked: bool[n, H, W].
        starts, goals: int[n, 2], cells (x, y), connected with each other.
        flips: int[n, moves, C, 2], cells that change.
    """

    blocked: np.ndarray
    starts: np.ndarray
    goals: np.ndarray
    flips: np.ndarray


@dataclass(frozen=True)
class Replanned:
    """How n episodes went with one heuristic.

    Attributes:
        status: int[n], `Status`.
        first: int[n], cells expanded for the first plan.
        expanded: int[n], cells expanded from start to end.
        length: float[n], cells sailed.
        position: int[n, moves + 1, 2].
    """

    status: np.ndarray
    first: np.ndarray
    expanded: np.ndarray
    length: np.ndarray
    position: np.ndarray

    @property
    def reached(self) -> np.ndarray:
        """Which arrived; bool[n]."""
        reached: np.ndarray = self.status == int(Status.REACHED)
        return reached


Results = dict[str, dict[str, Replanned]]
"""Label of a condition, then heuristic."""


def draw(condition: Condition, count: int, seed: int) -> Scenes:
    """Draw maps, and ends far apart in the largest water of each."""
    side = condition.side
    blocked = uj.random_maps(seed, count, (side, side), condition.density)
    rng = np.random.default_rng([seed, side, round(1000 * condition.density), condition.flips])
    ends = np.array([_ends(grid, rng) for grid in blocked])
    flips = np.full((count, condition.moves, _WIDTH[side], 2), -1)
    wanted = (count, condition.moves, condition.flips, 2)
    flips[:, :, : condition.flips] = rng.integers(0, side, wanted)
    return Scenes(blocked, ends[:, 0], ends[:, 1], flips)


def _ends(blocked: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Start and goal; int[2, 2]. Diagonal steps need both sides free, so four ways connect."""
    water, _ = ndimage.label(~blocked)
    sizes = np.bincount(water.ravel())[1:]
    cells = np.argwhere(water == sizes.argmax() + 1)[:, ::-1]
    extent = (cells.max(axis=0) - cells.min(axis=0)).max()
    least = min(APART * len(blocked), extent)  # the water may be small
    while True:
        ends = cells[rng.integers(0, len(cells), 2)]
        if np.abs(ends[1] - ends[0]).max() >= least:
            return np.asarray(ends)


def sail(
    scenes: dict[str, Scenes], advance: Callable[[int], object] = lambda done: None
) -> Results:
    """Sail all scenes with every heuristic; the changes are seen within the window only."""

    def one(heuristic: str) -> dict[str, Replanned]:
        found = {}
        for label, scene in scenes.items():
            found[label] = _sailed(scene, heuristic)
            advance(1)
        return found

    done = on_own_devices([partial(one, heuristic) for heuristic in HEURISTICS])
    by_heuristic = dict(zip(HEURISTICS, done, strict=True))
    return {label: {h: by_heuristic[h][label] for h in HEURISTICS} for label in scenes}


def _sailed(scene: Scenes, heuristic: str) -> Replanned:
    result = dstar_lite(
        scene.blocked,
        scene.starts,
        scene.goals,
        scene.flips,
        heuristic=heuristic,
        sensing=SENSING,
    )
    moved = np.abs(np.diff(result.position, axis=1)).sum(axis=2)
    straight, diagonal = ((moved == k).sum(axis=1) for k in (1, 2))
    return Replanned(
        status=result.status,
        first=result.expanded[:, 0],
        expanded=result.expanded.sum(axis=1),
        length=straight + np.sqrt(2.0) * diagonal,
        position=result.position,
    )
