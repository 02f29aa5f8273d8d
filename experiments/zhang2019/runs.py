"""What Zhang et al. 2019 needs computed: searches on random maps, and their times."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product
from time import process_time
from typing import Annotated, Any, NamedTuple

import jax
import numpy as np
import tyro

from experiments.paper import Options
from experiments.runs import Call, Run, Study
from experiments.zhang2019.mission import BATCHED, MISSION, TEXTBOOK, Maps, Scene, named
from usvjax.errors import BadInputError
from usvjax.mission import Case
from usvjax.registry import register_mission

KIND = "zhang2019_searches"
register_mission(KIND, "experiments.zhang2019.mission:MISSION")

SEED = 2019
SIDES = (20, 25, 28, 31)
"""Cells; the last three are those that Table 3's lengths allow for."""
DENSITIES = (0.1, 0.2, 0.3)
SHARD = 500
"""Maps."""


class Size(NamedTuple):
    """A choice of the map, which the paper does not print.

    Attributes:
        side: cells.
        density: of blocked cells.
        corner_cutting: whether a diagonal step may pass a blocked cell beside it.
    """

    side: int
    density: float
    corner_cutting: bool

    @property
    def label(self) -> str:
        """In words."""
        return f"{self.side} cells, {self.density:g}{', corners cut' * self.corner_cutting}"


SIZES = {
    size.label: size
    for cutting, side, density in product((False, True), SIDES, DENSITIES)
    for size in (Size(side, density, cutting),)
}
FITTED = Size(25, 0.3, False)
"""Chosen after the fact: the traditional path costs about as much as the paper's. Shown, and in
no verdict on Table 3."""
TIMED = {
    size.label: size
    for side, density in product((SIDES[0], SIDES[-1]), (DENSITIES[0], DENSITIES[-1]))
    for size in (Size(side, density, False),)
}
TIMED_RULES = ("traditional", "printed", "accumulated")


@dataclass(frozen=True)
class ZhangOptions(Options):
    """Regenerate the tables and figures of Zhang et al. 2019 beside the published values.

    Attributes:
        maps: Random maps of each side and density; 4,000, or 60 with --quick. The textbook's
            program, which is slower, searches up to 1,000 of them, or 20 with --quick.
    """

    maps: Annotated[int | None, tyro.conf.arg(metavar="N")] = None


def runs(options: ZhangOptions) -> Mapping[str, Run]:
    """Everything to run.

    Raises:
        BadInputError: fewer than one map.
    """
    maps, most, repeats = (60, 20, 3) if options.quick else (4_000, 1000, 15)
    if options.maps is not None:
        if options.maps < 1:
            raise BadInputError(f"--maps: got {options.maps}; wanted at least 1 map per density")
        maps = options.maps
    # As many as in a shard of the study, so that it is the same program.
    timed = {"batched": min(maps, SHARD), "textbook": 20 if options.quick else 100}
    return {
        "batched": _study("batched", maps, SHARD, [named(rule, "batched") for rule in BATCHED]),
        "textbook": _study("textbook", min(maps, most), 50, list(TEXTBOOK)),
        "timed": Call(
            lambda advance: times(repeats, timed, advance),
            len(TIMED) * (1 + repeats) * 2 * len(TIMED_RULES),
        ),
    }


def _study(name: str, maps: int, shard: int, methods: list[str]) -> Study:
    return Study(
        {
            "name": name,
            "kind": KIND,
            "episodes": maps,
            "seed": SEED,
            "shard": shard,
            "methods": methods,
            "conditions": [
                {"label": label, "maps": size._asdict()} for label, size in SIZES.items()
            ],
        }
    )


Times = dict[str, dict[str, dict[str, list[float]]]]


def times(repeats: int, maps: Mapping[str, int], advance: Callable[[int], object]) -> Times:
    """Time the searches, the rules taking turns; each once before it counts.

    Processor time: what else the machine does counts for less.

    Args:
        repeats: how often.
        maps: for each program.
        advance: told how many batches are done.

    Returns:
        Label of a size, program, rule: s of processor time per query, a value for each repeat.
    """
    found: Times = {}
    for label, size in TIMED.items():
        case = Case({}, {}, Maps(**size._asdict()))
        found[label] = {
            program: _timed(program, MISSION.pose(case, SEED, np.arange(count)), repeats, advance)
            for program, count in maps.items()
        }
    return found


def _timed(
    program: str, scene: Scene, repeats: int, advance: Callable[[int], object]
) -> dict[str, list[float]]:
    taken: dict[str, list[float]] = {rule: [] for rule in TIMED_RULES}
    with jax.default_device(jax.local_devices()[0]):
        for _ in range(1 + repeats):
            for rule, seconds in taken.items():
                begun = process_time()
                MISSION.run(scene, named(rule, program))
                seconds.append((process_time() - begun) / len(scene.blocked))
                advance(1)
    return {rule: seconds[1:] for rule, seconds in taken.items()}


def settings(found: Any) -> dict[str, int]:
    """How many maps of each size the programs searched."""
    return {name: ran.spec.episodes for name, ran in found.studies.items()}
