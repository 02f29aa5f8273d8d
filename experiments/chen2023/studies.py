"""What is run: scenes under ways of drawing, expanding and searching them, by several methods."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from experiments.chen2023.mission import KIND
from experiments.chen2023.published import EXPANSION
from experiments.chen2023.routes import (
    ARCS,
    ARCS_3,
    ASTAR,
    METHODS,
    PAIRS,
    PROPOSED,
    SHORT_ARCS,
    SPLINE,
    SPLINES,
    Method,
)
from experiments.chen2023.scenes import SEED, Waters
from experiments.chen2023.timing import timings, work
from experiments.paper import Options
from experiments.runs import Call, Run, Study
from usvjax.errors import BadInputError

MAIN, EXPANSIONS, WATERS, GRIDS = "scenes", "expansions", "waters", "grids"
PRINTED = Waters()
BY_EXPANSION = {e: replace(PRINTED, expansion=e) for e in (0.0, 0.1, 0.25, 0.5, 1.0)}
OTHER_WATERS = tuple(
    replace(PRINTED, islands=islands, least_axis=least, greatest_axis=greatest)
    for islands, least, greatest in (
        (20, 8.0, 24.0),
        (40, 8.0, 24.0),
        (80, 8.0, 24.0),
        (100, 8.0, 24.0),
        (10, 20.0, 60.0),
        (15, 20.0, 60.0),
    )
)
OTHER_GRIDS = {
    "10 m cells": replace(PRINTED, cell=10.0),
    "fewest turns": replace(PRINTED, turns="fewest"),
}
"""Choices of the search that the paper leaves open: cell size, and which of the shortest paths."""

SWEPT = (ASTAR, SPLINE, *PROPOSED)
LENGTHS = (ASTAR, ARCS, ARCS_3, SHORT_ARCS)
COMPARED = (ASTAR, *SPLINES, *PROPOSED)
_SHARD = 125  # routes, of 25 scenes


@dataclass(frozen=True)
class Chen(Options):
    """Regenerate the path planning of Chen et al. 2023 beside the published values.

    Attributes:
        scenes: Scenes with the printed expansion; 1,000, or 36 with --quick.
    """

    scenes: int | None = None


@dataclass(frozen=True)
class Sizes:
    """How much is run.

    Attributes:
        scenes: of the printed expansion.
        few: under every other expansion, and on every other grid.
        waters: under every other way of drawing islands; of the densest, too, as many must have
            a path as a rank needs to exclude anything.
        repeats: of the timings.
        timed: scenes whose routes are timed together.
        whole: whether every condition is run, and not just the printed one and E = 0.
    """

    scenes: int
    few: int
    waters: int
    repeats: int
    timed: int
    whole: bool


FULL, QUICK = Sizes(1000, 200, 300, 15, 200, True), Sizes(36, 24, 24, 3, 12, False)


def runs(options: Chen) -> dict[str, Run]:
    """What to run at the sizes asked for.

    Raises:
        BadInputError: fewer than one scene.
    """
    scenes = options.scenes
    if scenes is not None and scenes < 1:
        raise BadInputError(f"--scenes: got {scenes}; wanted at least 1")
    sizes = QUICK if options.quick else FULL
    return planned(sizes if scenes is None else replace(sizes, scenes=scenes))


def planned(sizes: Sizes) -> dict[str, Run]:
    """What to run at some sizes."""
    by_words = {waters.words: waters for waters in OTHER_WATERS}
    by_expansion = {f"E = {e:g}": waters for e, waters in BY_EXPANSION.items()}
    if not sizes.whole:
        by_expansion = dict(list(by_expansion.items())[:1])
    found: dict[str, Run] = {
        MAIN: _study(MAIN, sizes.scenes, METHODS.values(), {MAIN: PRINTED}),
        EXPANSIONS: _study(EXPANSIONS, sizes.few, SWEPT, by_expansion),
    }
    if sizes.whole:
        found[WATERS] = _study(WATERS, sizes.waters, LENGTHS, by_words)
        found[GRIDS] = _study(GRIDS, sizes.few, COMPARED, OTHER_GRIDS)
    timed = partial(timings, PRINTED, sizes.timed, sizes.repeats)
    return found | {"times": Call(timed, work(sizes.repeats))}


def _study(
    name: str, scenes: int, methods: Iterable[Method], by_label: Mapping[str, Waters]
) -> Study:
    tables: dict[str, Any] = {
        "name": name,
        "kind": KIND,
        "seed": SEED,
        "episodes": scenes * PAIRS,
        "shard": _SHARD,
        "methods": [method.name for method in methods],
        "conditions": [
            {"label": label, "waters": vars(waters)} for label, waters in by_label.items()
        ],
    }
    return Study(tables)


def expansion_of(label: str) -> float:
    """E of a condition of the study of expansions."""
    return EXPANSION if label == MAIN else float(label.removeprefix("E = "))
