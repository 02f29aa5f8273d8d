"""Cruises of the five algorithms of Yu et al. 2022 through the same waters."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any

import numpy as np

import usvjax as uj
from experiments.yu2022.cases import COMPLEX, COMPLEX_SIDE, ORDINARY, ORDINARY_SIDE
from experiments.yu2022.cruises.published import PROPOSED
from usvjax.missions.cruise import CruiseResult
from usvkernels.status import Status

CELL = 10.0
"""Edge of a cell, m."""
SPEED = 10.0
"""Of the vessel, m/s."""


@dataclass(frozen=True)
class Environment:
    """Where cruises go.

    Attributes:
        name: in the paper.
        side: cells.
        density: of blocked cells.
        cases: number of a case to its stations, int[d, 2], cells (x, y), the start first.
    """

    name: str
    side: int
    density: float
    cases: Mapping[int, np.ndarray]


ENVIRONMENTS = (
    Environment("ordinary", ORDINARY_SIDE, 0.10, ORDINARY),
    Environment("complex", COMPLEX_SIDE, 0.12, COMPLEX),
)


@dataclass(frozen=True)
class Algorithm:
    """One of the algorithms compared.

    Attributes:
        label: for tables.
        tour: how the order is found, as `solve_tour` calls it.
        sails: how the legs are sailed, keyword arguments of `cruise`.
        smoothed: whether the track is pulled straight afterwards.
    """

    label: str
    tour: str
    sails: Mapping[str, Any] = field(default_factory=dict)
    smoothed: bool = False


ALGORITHMS = {
    "aco": Algorithm("1: ACO", "aco", {"method": "aco"}),
    "ga": Algorithm("2: GA", "ga", {"method": "ga"}),
    "cmpso": Algorithm("3: CMPSO", "cmpso", {"method": "cmpso"}),
    "gwo": Algorithm("4: GWO, D* Lite", "gwo", {"heuristic": "chebyshev"}),
    PROPOSED: Algorithm(
        "proposed: IGWO, improved D* Lite", "igwo", {"heuristic": "weighted"}, smoothed=True
    ),
    "best": Algorithm(
        "beside: shortest tour, exact D* Lite, smoothed",
        "recommended",
        {"heuristic": "octile"},
        smoothed=True,
    ),
}
"""Those of the paper in the order of its tables, and what can be had."""


@dataclass(frozen=True)
class Cruises:
    """n cruises of one algorithm in one case; maps and flips are those of all algorithms.

    Attributes:
        result: of `cruise`.
        tour_length: float[n], closed, straight from station to station, cells.
        smoothed: whether the paper counts the track as pulled straight.
    """

    result: CruiseResult
    tour_length: np.ndarray
    smoothed: bool

    @property
    def complete(self) -> np.ndarray:
        """Which visited every station and came home; bool[n]."""
        complete: np.ndarray = self.result.status == int(Status.REACHED)
        return complete

    @property
    def length(self) -> np.ndarray:
        """As the paper counts it for this algorithm, m; float[n]."""
        return self.result.smooth_length if self.smoothed else self.result.length

    @property
    def inflections(self) -> np.ndarray:
        """As the paper counts them for this algorithm; int[n]."""
        return self.result.smooth_inflections if self.smoothed else self.result.inflections


Results = dict[tuple[str, int], dict[str, Cruises]]
"""Environment and case, then algorithm."""
Seconds = dict[str, dict[str, list[float]]]
"""Environment, algorithm, and seconds of single cruises."""
Varied = dict[str, dict[str, dict[str, Cruises]]]
"""Environment, kind of flips, algorithm."""


FLIPS: dict[str, tuple[float, str]] = {
    "nothing changes": (0.0, "window"),
    "1 % in the window": (0.01, "window"),
    "3 % in the window": (0.03, "window"),
    "3 % of the whole map": (0.03, "map"),
}
"""What the printed change of 3 % may mean: `flip_rate` and `flip_scope` of a cruise."""
VARIED = ("gwo", PROPOSED, "best")
"""Algorithms that meet all of them, in Case 1."""


@dataclass(frozen=True)
class Plan:
    """How much to run.

    Attributes:
        runs: of the algorithms that sail by D* Lite, in Case 1.
        swarm_runs: of those that plan legs by ants, genes or particles, in Case 1; they are slow.
        case_runs: likewise by D* Lite, in every other case.
        case_swarm_runs: likewise by swarms.
        varied_runs: of those that meet other flips.
        repeats: cruises timed alone.
        seed: of maps, flips and swarms.
        cases: numbers of those that are run.
        environments: names.
    """

    runs: int
    swarm_runs: int
    case_runs: int
    case_swarm_runs: int
    varied_runs: int
    repeats: int
    seed: int = 2022
    cases: tuple[int, ...] = (1, 2, 3, 4)
    environments: tuple[str, ...] = ("ordinary", "complex")

    @property
    def chosen(self) -> list[tuple[Environment, int]]:
        """The environments and cases to run."""
        named = [e for e in ENVIRONMENTS if e.name in self.environments]
        return [(environment, case) for environment in named for case in self.cases]

    @property
    def total(self) -> int:
        """Batches to be sailed."""
        per_environment = len(self.cases) * len(ALGORITHMS) + len(FLIPS) + len(ALGORITHMS)
        return len(self.environments) * per_environment

    def count(self, algorithm: Algorithm, case: int) -> int:
        """Runs of an algorithm in a case."""
        if "method" in algorithm.sails:
            return self.swarm_runs if case == 1 else self.case_swarm_runs
        return self.runs if case == 1 else self.case_runs


def maps_of(environment: Environment, case: int, count: int, seed: int) -> np.ndarray:
    """Maps of a case, bool[n, H, W]; the stations' cells are free."""
    side = environment.side
    key = seed + 10 * case + (environment.name == "complex")
    blocked = uj.random_maps(key, count, shape=(side, side), density=environment.density)
    x, y = environment.cases[case].T
    blocked[:, y, x] = False
    return blocked


def sail_all(plan: Plan, advance: Callable[[int], None]) -> Results:
    """Sail every case with every algorithm.

    Args:
        plan: how much.
        advance: called with 1 after each batch.
    """
    results: Results = {}
    for environment, case in plan.chosen:
        for name, algorithm in ALGORITHMS.items():
            maps = maps_of(environment, case, plan.count(algorithm, case), plan.seed)
            found = _once(algorithm, maps, environment.cases[case], plan.seed)
            results.setdefault((environment.name, case), {})[name] = found
            advance(1)
    return results


def sail_varied(plan: Plan, advance: Callable[[int], None]) -> Varied:
    """Sail Case 1 with other flips; arguments as `sail_all`."""
    results: Varied = {}
    for environment in (e for e in ENVIRONMENTS if e.name in plan.environments):
        maps = maps_of(environment, 1, plan.varied_runs, plan.seed)
        for label, flips in FLIPS.items():
            for name in VARIED:
                found = _once(ALGORITHMS[name], maps, environment.cases[1], plan.seed, flips)
                results.setdefault(environment.name, {}).setdefault(label, {})[name] = found
            advance(1)
    return results


def time_alone(plan: Plan, advance: Callable[[int], None]) -> Seconds:
    """Time cruises of Case 1 one by one, compiled before; arguments as `sail_all`."""
    seconds: Seconds = {}
    for environment in (e for e in ENVIRONMENTS if e.name in plan.environments):
        maps = maps_of(environment, 1, plan.repeats + 1, plan.seed)
        for name, algorithm in ALGORITHMS.items():
            took = []
            for row in range(len(maps)):
                begun = perf_counter()
                _once(algorithm, maps[row : row + 1], environment.cases[1], plan.seed)
                took.append(perf_counter() - begun)
            # The first of them compiles.
            seconds.setdefault(environment.name, {})[name] = took[1:]
            advance(1)
    return seconds


def _once(
    algorithm: Algorithm,
    maps: np.ndarray,
    stations: np.ndarray,
    seed: int,
    flips: tuple[float, str] = FLIPS["3 % in the window"],
) -> Cruises:
    rate, scope = flips
    tour = uj.solve_tour(stations, seed, algorithm=algorithm.tour, runs=len(maps))
    result = uj.cruise(
        maps,
        stations,
        seed,
        order=tour.order,
        params=uj.CruiseParams(flip_rate=rate, speed=SPEED),
        static=uj.CruiseStatic(flip_scope=scope),
        cell_size=CELL,
        **algorithm.sails,
    )
    return Cruises(result, tour.length, algorithm.smoothed)
