"""Global paths by A*, and what key points make of them."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial
from typing import Any

import numpy as np

from experiments import textbook
from experiments.parallel import on_own_devices
from experiments.textbook import STRAIGHTS_FIRST, Rules
from experiments.wei2023.published import UNIT
from experiments.wei2023.scenes import SHOWN, Scenes, centre_of, clearance
from usvjax.paths.metrics import path_metrics
from usvjax.paths.smoothing import key_points, shorten
from usvjax.search.astar import astar

SEARCHES = ("euclidean", "octile")
"""Heuristics of the batched search."""
TEXTBOOK = {
    "textbook": Rules(10_000, 14_142, heuristic="euclidean", order=STRAIGHTS_FIRST),
    "textbook, octile": Rules(10_000, 14_142, heuristic="octile", order=STRAIGHTS_FIRST),
}
"""A* as Python programs have it: straight moves first, and of equal f the first one in."""
STAGES = ("before", "key points", "shortened")
"""The path found, Wei & Zhang's smoothing, and one pass of it (Yu et al. 2022)."""


@dataclass(frozen=True)
class Measured:
    """Measures of n paths.

    Attributes:
        points: int[n], points of the path between its ends.
        turns: int[n], points where the course changes.
        turning: float[n], changes of course added up, rad.
        length: float[n], nm.
        clearance: float[n], least distance to an obstacle (not inflated), nm.
        cells: int[n, P, 2], the points, the last one repeated.
    """

    points: np.ndarray
    turns: np.ndarray
    turning: np.ndarray
    length: np.ndarray
    clearance: np.ndarray
    cells: np.ndarray

    def some(self, chosen: Any) -> "Measured":
        """Return those that a mask or an index names."""
        return Measured(**{f.name: getattr(self, f.name)[chosen] for f in fields(self)})


Stages = dict[str, Measured]


def plan(
    scenes: dict[str, Scenes],
    textbook_scenes: int,
    advance: Callable[[int], object] = lambda done: None,
) -> dict[str, dict[str, Stages]]:
    """Plan and smooth on all scenes; kind, then search, then stage.

    Args:
        scenes: by label of their kind.
        textbook_scenes: how many of the first kind the textbook program searches, too.
        advance: told after each batch.
    """

    def one(heuristic: str, label: str) -> Stages:
        scene = scenes[label]
        found = astar(scene.blocked, scene.starts, scene.goals, heuristic=heuristic, engine="queue")
        stages = smoothed(scene, found.path, found.path_cells)
        advance(1)
        return stages

    pairs = [(heuristic, label) for label in scenes for heuristic in SEARCHES]
    done = on_own_devices([partial(one, *pair) for pair in pairs])
    table: dict[str, dict[str, Stages]] = {label: {} for label in scenes}
    for (heuristic, label), stages in zip(pairs, done, strict=True):
        table[label][heuristic] = stages
    if SHOWN.label in scenes and textbook_scenes:
        for label, rules in TEXTBOOK.items():
            found = by_textbook(scenes[SHOWN.label], textbook_scenes, rules)
            table[SHOWN.label][label] = found
            advance(1)
    return table


def by_textbook(scene: Scenes, count: int, rules: Rules) -> Stages:
    """Plan on the first scenes by the textbook program, and smooth."""
    ends = [
        [tuple(map(int, cell)) for cell in pair]
        for pair in zip(scene.starts[:count], scene.goals[:count], strict=True)
    ]
    paths = [
        textbook.search(grid, start, goal, rules)[0]  # type: ignore[arg-type]
        for grid, (start, goal) in zip(scene.blocked, ends, strict=False)
    ]
    counts = np.array([len(path) for path in paths], np.int32)
    cells = np.zeros((len(paths), int(counts.max()), 2), np.int32)
    for row, path in zip(cells, paths, strict=True):
        row[:] = path[-1]
        row[: len(path)] = path
    few = Scenes(**{f.name: getattr(scene, f.name)[:count] for f in fields(Scenes)})
    return smoothed(few, cells, counts)


def smoothed(scene: Scenes, cells: np.ndarray, counts: np.ndarray) -> Stages:
    """Smooth paths and measure every stage.

    Args:
        scene: that they are on.
        cells: int32[n, P, 2], paths as `astar` returns them.
        counts: int32[n], their points.
    """
    keys = key_points(cells, counts, scene.blocked)
    short = shorten(cells, counts, scene.blocked)
    stages = {
        "before": (cells, counts),
        "key points": (keys.path, keys.path_cells),
        "shortened": (short.path, short.path_cells),
    }
    return {stage: _measured(scene, *found) for stage, found in stages.items()}


def _measured(scene: Scenes, cells: np.ndarray, counts: np.ndarray) -> Measured:
    measures = path_metrics(cells, counts, cell_size=UNIT)  # in nm, as UNIT is
    return Measured(
        points=counts - 2,
        turns=measures.inflections,
        turning=measures.turning,
        length=measures.length,
        clearance=clearance(centre_of(cells), scene.circles),
        cells=cells,
    )
