"""What is sailed: the algorithms of Yu et al. 2022 through the same waters, under every reading."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from experiments.runs import Call, Columns, Found, Run, Study
from experiments.yu2022.cases import COMPLEX, COMPLEX_SIDE, ORDINARY, ORDINARY_SIDE
from experiments.yu2022.cruises.published import ALGORITHMS, CASES, RUNS
from experiments.yu2022.options import SEED, YuOptions
from usvjax.mission import Case, Mission
from usvkernels.status import Status

CELL = 10.0
"""Edge of a cell, m."""


@dataclass(frozen=True)
class Environment:
    """Where cruises go.

    Attributes:
        side: cells.
        density: of blocked cells.
        cases: number of a case to its stations, int[d, 2], cells (x, y), the start first.
        tables: number of the table of Case 1, and of that of all cases.
    """

    side: int
    density: float
    cases: Mapping[int, np.ndarray]
    tables: tuple[str, str]


ENVIRONMENTS = {
    "ordinary": Environment(ORDINARY_SIDE, 0.10, ORDINARY, ("3", "4")),
    "complex": Environment(COMPLEX_SIDE, 0.12, COMPLEX, ("6", "7")),
}

ENCODINGS: dict[str, dict[str, str]] = {
    "random keys": {name: name for name in ALGORITHMS},
    "swap sequences": {name: name for name in ALGORITHMS}
    | {"gwo": "gwo_swap", "proposed": "proposed_swap"},
}
"""How wolves stand for tours: of each algorithm of the paper the method of `kind = "cruise"`. Ants,
genes and particles stand for tours in one way only."""
BESIDE = {"shortest tour": {**ENCODINGS["swap sequences"], "proposed": "recommended"}}
"""A reading that does not count: the proposed one as it could be."""

LABELS = {
    "aco": "1: ACO",
    "ga": "2: GA",
    "cmpso": "3: CMPSO",
    "gwo": "4: GWO, random keys",
    "gwo_swap": "4: GWO, swap sequences",
    "proposed": "proposed, random keys",
    "proposed_swap": "proposed, swap sequences",
    "recommended": "beside: shortest tour",
}
"""Methods in the order of tables; the last is what can be had."""
SMOOTHED = ("proposed", "proposed_swap", "recommended")
"""Methods whose track counts as pulled straight, as in the paper that of the proposed one alone."""
SWARMS = ("aco", "ga", "cmpso")
WOLVES = tuple(name for name in LABELS if name not in SWARMS)
TIMED = tuple(name for name in LABELS if name != "recommended")


class Flips(NamedTuple):
    """What the printed change of 3 % may mean.

    Attributes:
        rate: with which a cell changes at a step.
        scope: "window" of what the vessel sees, or "map".
    """

    rate: float
    scope: str


USUAL, CALM, FLOOD = "3 % in the window", "nothing changes", "3 % of the map"
FLIPS = {
    USUAL: Flips(0.03, "window"),
    "1 % in the window": Flips(0.01, "window"),
    CALM: Flips(0.0, "window"),
    FLOOD: Flips(0.03, "map"),
}

FULL, QUICK = 200, 24
"""Cruises of each case by D* Lite."""
FEW = 5
"""Cruises of Cases 2 to 4 by Algorithms 1 to 3."""
LEAST_RUNS = 20
"""Runs that are made of what is slow or comes to nothing: Algorithms 1 to 3 where less changes, and
all where the whole map does."""
LEAST_COMPLETE = LEAST_RUNS // 2
"""Complete cruises of an algorithm from which on its mean counts; some may not come home."""


SHARD = 10
"""Cruises by Algorithms 1 to 3 between two savings; of the others as many as the paper has."""


class Plan(NamedTuple):
    """What is run.

    Attributes:
        environments: names.
        cases: numbers.
        flips: what changes, keys of `FLIPS`; other than the usual in Case 1 only.
        slow: cruises of Case 1, and of each other, by Algorithms 1 to 3 that are timed.
        fast: likewise by the others, in every case.
    """

    environments: tuple[str, ...]
    cases: tuple[int, ...]
    flips: tuple[str, ...]
    slow: tuple[int, int]
    fast: int

    def repeats(self, method: str, case: int) -> int:
        """Cruises that are timed."""
        return self.fast if method in WOLVES else self.slow[case != 1]


ALL = Plan(tuple(ENVIRONMENTS), tuple(CASES["ordinary"]), tuple(FLIPS), (2, 1), 8)
LOOK = Plan(("ordinary",), (1,), (USUAL, CALM), (1, 0), 3)


def runs(options: YuOptions) -> dict[str, Run]:
    """Everything to run.

    Raises:
        BadInputError: fewer than one run.
    """
    plan = LOOK if options.quick else ALL
    sailed, few = options.size("runs", FULL, QUICK), options.size("swarm_runs", RUNS, 1)
    calmer = [kind for kind in plan.flips if kind not in (USUAL, FLOOD)]
    studies = {
        "cases": (WOLVES, plan.cases, [USUAL], sailed),
        "other changes": (WOLVES, (1,), calmer, min(sailed, RUNS)),
        "changes everywhere": (WOLVES, (1,), [FLOOD], min(sailed, LEAST_RUNS)),
        "Case 1, Algorithms 1 to 3": (SWARMS, (1,), [USUAL], min(sailed, few)),
        "other changes, Algorithms 1 to 3": (SWARMS, (1,), calmer, min(sailed, few, LEAST_RUNS)),
        "Cases 2 to 4, Algorithms 1 to 3": (SWARMS, plan.cases[1:], [USUAL], min(few, FEW)),
    }
    found: dict[str, Run] = {}
    for name, (methods, cases, kinds, episodes) in studies.items():
        conditions = [
            _condition(environment, case, kind)
            for environment in plan.environments
            for case in cases
            for kind in kinds
            if kind in plan.flips
        ]
        if conditions:
            found[name] = _study(methods, episodes, conditions)
    usual = found["cases"]
    assert isinstance(usual, Study)
    found["times"] = Call(lambda advance: timed(usual, plan, advance), timings(plan))
    return found


def label_of(environment: str, case: int, flips: str) -> str:
    """Label of a condition."""
    return f"{environment}, Case {case}, {flips}"


def _condition(environment: str, case: int, flips: str) -> dict[str, Any]:
    where = ENVIRONMENTS[environment]
    places = CELL * (where.cases[case] + 0.5)
    return {
        "label": label_of(environment, case, flips),
        "maps": {
            "shape": [where.side, where.side],
            "density": where.density,
            "cell_size": CELL,
            "places": places.tolist(),
        },
        "cruise": {"flip_rate": FLIPS[flips].rate, "flip_scope": FLIPS[flips].scope},
    }


def _study(methods: tuple[str, ...], episodes: int, conditions: list[dict[str, Any]]) -> Study:
    """One seed for all studies: job k of each meets map k and its changes."""
    return Study(
        {
            "name": "cruises",
            "kind": "cruise",
            "seed": SEED,
            "episodes": episodes,
            "shard": SHARD if methods == SWARMS else RUNS,
            "methods": list(methods),
            "conditions": conditions,
        }
    )


@dataclass(frozen=True)
class Sailed:
    """Cruises of one method under one condition.

    Attributes:
        columns: of the study, in the order of the jobs.
        smoothed: whether the track counts as pulled straight.
    """

    columns: Columns
    smoothed: bool

    @property
    def complete(self) -> np.ndarray:
        """Whether all stations were visited, bool[n]."""
        complete: np.ndarray = self.columns["status"] == int(Status.REACHED)
        return complete

    @property
    def length(self) -> np.ndarray:
        """As the paper counts it for this algorithm, m; float64[n]."""
        return self._counted("length")

    @property
    def inflections(self) -> np.ndarray:
        """As the paper counts them for this algorithm; float64[n]."""
        return self._counted("inflections")

    def _counted(self, name: str) -> np.ndarray:
        return self.columns[f"smooth_{name}" if self.smoothed else name].astype(np.float64)


def sailed_by(found: Found, environment: str, case: int, flips: str, method: str) -> Sailed | None:
    """The cruises of a method; None where there are none."""
    label = label_of(environment, case, flips)
    for ran in found.studies.values():
        known = any(condition.label == label for condition in ran.spec.conditions)
        if known and method in ran.spec.methods:
            return Sailed(ran.columns(label, method), method in SMOOTHED)
    return None


def timings(plan: Plan) -> int:
    """Cruises that are timed."""
    times = sum(plan.repeats(name, case) for name in TIMED for case in plan.cases)
    return times * len(plan.environments)


def timed(study: Study, plan: Plan, advance: Callable[[int], object]) -> dict[str, Any]:
    """Seconds of single cruises, one by one: environment, case, algorithm.

    Each is compiled before: the slow ones by the first cruise of an environment, the others by
    every cruise that is timed, as their programs come in several sizes.
    """
    seconds: dict[str, Any] = {}
    by_label = {condition.label: condition.case for condition in study.spec.conditions}
    mission = study.spec.mission
    for environment in plan.environments:
        for case in plan.cases:
            given = by_label[label_of(environment, case, USUAL)]
            rows = seconds.setdefault(environment, {}).setdefault(str(case), {})
            for name in TIMED:
                repeats = plan.repeats(name, case)
                for job in range(repeats if name in WOLVES else case == plan.cases[0]):
                    _seconds(mission, given, name, job)
                rows[name] = []
                for job in range(repeats):
                    rows[name].append(_seconds(mission, given, name, job))
                    advance(1)
    return seconds


def _seconds(mission: Mission, case: Case, method: str, job: int) -> float:
    """Time of one cruise, its tour included."""
    scene = mission.pose(case, SEED, np.array([job]))
    begun = perf_counter()
    mission.run(scene, method)
    return perf_counter() - begun
