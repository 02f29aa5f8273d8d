"""What is run: scenes under one way of drawing them and one expansion, by several methods."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from experiments.chen2023.published import ENDS, EXPANSION
from experiments.chen2023.routes import (
    ASTAR,
    METHODS,
    PROPOSED,
    SPLINE,
    SWEPT,
    Measures,
    Method,
    joined,
    measure,
    search,
)
from experiments.chen2023.scenes import SEED, Waters, draw_scenes

BLOCK, SMALL_BLOCK = 200, 12  # scenes searched and sailed at once
EXPANSIONS = (0.0, 0.1, 0.25, 0.5, 1.0)  # besides the printed one
MAIN_WATERS = Waters()
LARGE = (20.0, 60.0)  # m, semi-axes
OTHER_WATERS = (
    Waters(20),
    Waters(40),
    Waters(80),
    Waters(100),
    Waters(10, LARGE),
    Waters(15, LARGE),
)


@dataclass(frozen=True)
class Plan:
    """Scenes and what is done with them.

    Attributes:
        scenes: how many, the first of the sequence.
        waters: how they are drawn.
        expansion: E of Eq. 4, that islands are searched with.
        methods: that make the routes.
        sailed: whether vessels sail them.
    """

    scenes: int
    waters: Waters = MAIN_WATERS
    expansion: float = EXPANSION
    methods: tuple[Method, ...] = METHODS
    sailed: bool = True

    @property
    def routes(self) -> int:
        """How many the plan makes."""
        return self.scenes * len(ENDS) * len(self.methods)

    def described(self) -> dict[str, Any]:
        """For results.json."""
        return {
            "scenes": self.scenes,
            "waters": asdict(self.waters),
            "expansion": self.expansion,
            "methods": [method.name for method in self.methods],
            "sailed": self.sailed,
            "seed": SEED,
        }


@dataclass(frozen=True)
class Job:
    """All plans.

    Attributes:
        main: the printed expansion, every method.
        expansions: other expansions, in rising order.
        waters: other waters.
        repeats: of the timings.
        block: scenes searched and sailed at once.
    """

    main: Plan
    expansions: tuple[Plan, ...]
    waters: tuple[Plan, ...]
    repeats: int
    block: int = BLOCK

    @property
    def plans(self) -> list[Plan]:
        """All of them."""
        return [self.main, *self.expansions, *self.waters]


Results = dict[Plan, dict[str, Measures]]
"""Plan and name of a method to what was measured, pairs of ends running fastest."""


def make_job(scenes: int, few: int, repeats: int, quick: bool) -> Job:
    """Lay out a job.

    Args:
        scenes: of the main plan.
        few: scenes of every other plan.
        repeats: of the timings.
        quick: leave out other waters, and other expansions but none at all.
    """
    expansions = (0.0,) if quick else EXPANSIONS
    waters = () if quick else OTHER_WATERS
    return Job(
        main=Plan(scenes),
        expansions=tuple(Plan(few, expansion=e, methods=SWEPT) for e in expansions),
        waters=tuple(Plan(few, w, methods=(ASTAR, SPLINE, PROPOSED), sailed=False) for w in waters),
        repeats=repeats,
        # Blocks of up to 64 routes keep to one device, and compile for it alone.
        block=SMALL_BLOCK if quick else BLOCK,
    )


def run(job: Job, advance: Callable[[int], None]) -> Results:
    """Run all plans.

    Args:
        job: the plans.
        advance: told how many routes are done, now and then.
    """
    return {plan: _run(plan, job.block, advance) for plan in job.plans}


def _run(plan: Plan, block: int, advance: Callable[[int], None]) -> dict[str, Measures]:
    parts: dict[str, list[Measures]] = {method.name: [] for method in plan.methods}
    for first in range(0, plan.scenes, block):
        count = min(block, plan.scenes - first)
        searched = search(draw_scenes(count, plan.waters, first=first), plan.expansion)
        for method in plan.methods:
            parts[method.name].append(measure(searched, method, plan.sailed))
            advance(count * len(ENDS))
    return {name: joined(measures) for name, measures in parts.items()}
