"""Planning time: every stage from grid to path, many at once and one alone."""

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from experiments.chen2023.published import ENDS
from experiments.chen2023.routes import PROPOSED, SPLINE, Search, end_cells, make_route
from usvjax.paths.smoothing import shorten
from usvjax.search.astar import astar

STAGES = ("search", "shorten", "bspline", "arcs")
WHOLE = {"a_bspline": ("search", "bspline"), "a_proposed": ("search", "shorten", "arcs")}
"""Stages of the two algorithms of Tables 2 and 3."""


@dataclass(frozen=True)
class Stages:
    """The stages of planning, for some rows of a search."""

    searched: Search
    starts: np.ndarray
    goals: np.ndarray

    def calls(self) -> dict[str, Callable[[], object]]:
        """Stage to what runs it."""
        found = self.searched.found
        return {
            "search": lambda: astar(self.searched.maps, self.starts, self.goals),
            "shorten": lambda: shorten(found.path, found.path_cells, self.searched.maps),
            "bspline": lambda: make_route(self.searched, SPLINE),
            "arcs": lambda: make_route(self.searched, PROPOSED),
        }


def time_stages(searched: Search, repeats: int) -> dict[str, float]:
    """Seconds of every stage and of both algorithms, medians, compilation left out.

    Args:
        searched: all pairs of ends in some scenes; all rows are done in one call.
        repeats: timed calls of every stage, after one that is not.
    """
    scenes = len(searched.straight) // len(ENDS)
    starts, goals = (np.tile(cells, (scenes, 1)) for cells in end_cells())
    return _timed(Stages(searched, starts, goals), repeats)


def time_pairs(alone: Search, repeats: int) -> list[dict[str, float]]:
    """The same for each pair of ends alone, a call for one path.

    Args:
        alone: the pairs in one scene.
        repeats: as `time_stages`.
    """
    starts, goals = end_cells()
    return [
        _timed(Stages(alone.row(i), starts[i : i + 1], goals[i : i + 1]), repeats)
        for i in range(len(ENDS))
    ]


def _timed(stages: Stages, repeats: int) -> dict[str, float]:
    seconds: dict[str, list[float]] = {}
    calls = stages.calls()
    for call in calls.values():
        call()
    # In turn, so that whatever else the machine does falls on all of them alike.
    for _ in range(repeats):
        for stage, call in calls.items():
            begun = perf_counter()
            call()
            seconds.setdefault(stage, []).append(perf_counter() - begun)
    found = {stage: median(times) for stage, times in seconds.items()}
    return found | {name: sum(found[s] for s in parts) for name, parts in WHOLE.items()}


def timings(searched: Search, alone: Search, repeats: int) -> dict[str, Any]:
    """All timings, for results.json; seconds.

    Args:
        searched: a block of scenes.
        alone: a single one.
        repeats: timed calls of each.
    """
    together = time_stages(searched, repeats)
    rows = len(searched.straight)
    return {
        "paths": rows,
        "batch": {name: value / rows for name, value in together.items()},
        "single": time_pairs(alone, repeats),
    }
