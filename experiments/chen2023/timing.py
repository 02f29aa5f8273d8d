"""Planning time: every stage from grid to path, many at once and one alone."""

from collections.abc import Callable
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from experiments.chen2023.published import ENDS
from experiments.chen2023.routes import (
    ARCS,
    ARCS_3,
    PAIRS,
    SHORT_ARCS,
    SPLINE,
    Search,
    a_star,
    make_route,
    search,
)
from experiments.chen2023.scenes import SEED, Waters, to_cells
from usvjax.paths.smoothing import shorten

WHOLE = {
    "bspline": ("search", "spline"),
    "arcs": ("search", "arcs"),
    "arcs_3": ("search", "arcs_3"),
    "short_arcs": ("search", "shortening", "arcs_shortened"),
}
"""Stages of the algorithms of Tables 2 and 3, under every reading of the proposed one."""


def timings(
    waters: Waters, scenes: int, repeats: int, advance: Callable[[int], object]
) -> dict[str, Any]:
    """All timings, s, for results.json.

    Args:
        waters: how scenes are drawn, and the grid.
        scenes: whose routes are planned in one call.
        repeats: timed calls of each stage, after one that is not timed.
        advance: told how many calls are done.
    """
    together = search(waters, SEED, np.arange(scenes * PAIRS))
    alone = [search(waters, SEED, np.array([job])) for job in range(PAIRS)]
    batch, *single = (_timed(searched, repeats, advance) for searched in (together, *alone))
    return {"paths": scenes * PAIRS, "batch": batch, "single": single}


def work(repeats: int) -> int:
    """How many rounds of calls `timings` makes."""
    return (1 + PAIRS) * (1 + repeats)


def _calls(searched: Search) -> dict[str, Callable[[], object]]:
    """Stage to what runs it, whatever the search has kept."""
    found, waters = searched.found, searched.waters
    ends = to_cells(np.array(ENDS), waters.cell)[searched.pair]
    return {
        "search": lambda: a_star(searched.maps, ends, waters.turns),
        "shortening": lambda: shorten(found.path, found.path_cells, searched.maps),
        "spline": lambda: make_route(searched, SPLINE),
        "arcs": lambda: make_route(searched, ARCS),
        "arcs_3": lambda: make_route(searched, ARCS_3),
        "arcs_shortened": lambda: make_route(searched, SHORT_ARCS),
    }


def _timed(searched: Search, repeats: int, advance: Callable[[int], object]) -> dict[str, Any]:
    """Medians of stages and algorithms, and how often each algorithm took less than the B-spline.

    Compilation is left out: every stage is called once before it is timed.
    """
    seconds: dict[str, list[float]] = {}
    calls = _calls(searched)
    for call in calls.values():
        call()
    advance(1)
    # In turn, so that whatever else the machine does falls on all of them alike.
    for _ in range(repeats):
        for stage, call in calls.items():
            begun = perf_counter()
            call()
            seconds.setdefault(stage, []).append(perf_counter() - begun)
        advance(1)
    whole = {
        name: [sum(times) for times in zip(*(seconds[s] for s in stages), strict=True)]
        for name, stages in WHOLE.items()
    }
    ratios = {
        name: [own / spline for own, spline in zip(times, whole["bspline"], strict=True)]
        for name, times in whole.items()
    }
    return {
        "stages": {stage: median(times) for stage, times in seconds.items()},
        "whole": {name: median(times) for name, times in whole.items()},
        "ratio": {name: median(values) for name, values in ratios.items()},
        "less": {name: sum(value < 1 for value in values) for name, values in ratios.items()},
        "repeats": repeats,
    }
