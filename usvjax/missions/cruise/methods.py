"""Ways to sail a cruise, by name: an order of the stations, and a planner under way.

Studies and figures share these names, and `sail`, which runs one.
"""

from dataclasses import asdict, dataclass, field
from typing import Any

import jax
import numpy as np

from usvjax.checks import one_of
from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.missions.cruise import CruiseResult, cruise
from usvjax.missions.cruise.inputs import Mission, check_heuristic, check_mission
from usvjax.missions.cruise.orders import DISTANCES, water_distances
from usvjax.missions.cruise.scenes import CruiseScenes, Source
from usvjax.tours import solve_tour

# Parts of the study's key; job j's own part is j, and jobs are fewer than 2^31.
_TOURS, _FLIPS = 2**32 - 1, 2**32 - 2


@dataclass(frozen=True)
class Method:
    """A way to sail a cruise.

    Attributes:
        words: what it is, for tables and help.
        tour: algorithm of `solve_tour`.
        planner: method of `cruise`.
        heuristic: of planner "dstar_lite".
    """

    words: str
    tour: str
    planner: str = "dstar_lite"
    heuristic: str = "octile"


METHODS: dict[str, Method] = {
    "recommended": Method("the shortest tour found, D* Lite along shortest paths", "recommended"),
    "astar": Method("the same tour, A* anew where the way is blocked", "recommended", "astar"),
    "proposed": Method(
        "tour by improved grey wolves, D* Lite with the weighted heuristic (Yu et al. 2022)",
        "igwo",
        heuristic="weighted",
    ),
    "gwo": Method(
        "tour by grey wolves, D* Lite with the chess-board distance (Yu et al. 2022, Algorithm 4)",
        "gwo",
        heuristic="chebyshev",
    ),
    "aco": Method("tour and paths by ants (Yu et al. 2022, Algorithm 1)", "aco", "aco"),
    "ga": Method("tour and paths by genes (Yu et al. 2022, Algorithm 2)", "ga", "ga"),
    "cmpso": Method("tour and paths by particles (Yu et al. 2022, Algorithm 3)", "cmpso", "cmpso"),
}


@dataclass(frozen=True)
class CruiseOptions:
    """The `[cruise]` table; see `usvjax.missions.cruise.cruise`.

    Attributes:
        distances: what tours add up: "straight" or "water".
        flip_rate: probability with which a cell flips at a step.
        flip_scope: where cells flip: "window" or "map".
        sensing: (h, w), rows and columns of the window about the vessel.
        walled_in: what to do while no way is known: "wait", "skip" or "fail".
        max_wait: steps.
        max_steps: of a leg; None for 8 times height plus width of the map, or what the keys of
            D* Lite can count on it.
        speed: m/s.
    """

    distances: str = "straight"
    flip_rate: float = 0.03
    flip_scope: str = "window"
    sensing: tuple[int, int] = (5, 5)
    walled_in: str = "wait"
    max_wait: int = 100
    max_steps: int | None = None
    speed: float = 10.0


@dataclass(frozen=True)
class Posed:
    """Cruises of jobs that follow one another, before they are sailed.

    Attributes:
        source: what drew them.
        options: of the cruises.
        seed: of the study.
        jobs: int64[J].
        scenes: maps and stations, in the order of the jobs.
        legs: float64[J, d, d], distances between stations, m, as tours add them up.
        orders: int32[J, d], by algorithm of `solve_tour`, as far as they have been wanted.
    """

    source: Source
    options: CruiseOptions
    seed: int
    jobs: np.ndarray
    scenes: CruiseScenes
    legs: np.ndarray
    orders: dict[str, np.ndarray] = field(default_factory=dict)

    def order(self, method: str) -> np.ndarray:
        """Order of the stations that a method takes, int32[J, d], home first."""
        algorithm = METHODS[method].tour
        if algorithm not in self.orders:
            self.orders[algorithm] = shortest_tours(self.seed, self.jobs, self.legs, algorithm)
        return self.orders[algorithm]


def check_options(source: Source, options: CruiseOptions) -> dict[str, str]:
    """Refuse what `cruise` would, before a run directory exists.

    Returns:
        Why a method refuses these options or maps, by its name; methods that do not are absent.

    Raises:
        BadTypeError, BadInputError: as `usvjax.missions.cruise.cruise`.
    """
    one_of("distances", options.distances, DISTANCES)
    mission = _mission(source.draw(0, np.arange(8)), source.cell_size, options)
    refusals = {}
    for name, method in METHODS.items():
        try:
            if method.planner == "dstar_lite":
                check_heuristic(mission, method.heuristic, None)
        except BadInputError as error:
            refusals[name] = str(error)
    return refusals


def pose(source: Source, options: CruiseOptions, seed: int, jobs: np.ndarray) -> Posed:
    """Draw the maps and stations of int64[J] jobs that follow one another."""
    scenes = source.draw(seed, jobs)
    legs = leg_lengths(scenes, source.cell_size, options)
    return Posed(source, options, seed, jobs, scenes, legs)


def first_map(posed: Posed) -> GridMap:
    """The map of the first cruise; a shared one as it was before it was inflated."""
    source = posed.source
    return source.chart or GridMap(posed.scenes.blocked[0], source.cell_size, source.origin)


def leg_lengths(scenes: CruiseScenes, cell_size: float, options: CruiseOptions) -> np.ndarray:
    """Distances between stations, float64[J, d, d], m: straight or by water, as is wanted."""
    if options.distances == "water":
        return cell_size * water_distances(_mission(scenes, cell_size, options)).astype(np.float64)
    apart = scenes.stations[:, :, None] - scenes.stations[:, None]
    return cell_size * np.hypot(apart[..., 0], apart[..., 1])


def shortest_tours(seed: int, jobs: np.ndarray, legs: np.ndarray, algorithm: str) -> np.ndarray:
    """Orders of the stations, int32[J, d], home first.

    Args:
        seed: of the study.
        jobs: int64[J], that follow one another.
        legs: float64[J, d, d], distances between stations.
        algorithm: of `solve_tour`.
    """
    key = jax.random.fold_in(jax.random.key(seed), _TOURS)
    return solve_tour(None, key, algorithm=algorithm, distances=legs, first=int(jobs[0])).order


def tour_lengths(legs: np.ndarray, orders: np.ndarray) -> np.ndarray:
    """Lengths of closed tours int32[J, d], float64[J], in the unit of float64[J, d, d]."""
    row = np.arange(len(orders))[:, None]
    lengths: np.ndarray = legs[row, orders, np.roll(orders, -1, axis=1)].sum(axis=1)
    return lengths


def sail(posed: Posed, method: str) -> CruiseResult:
    """Sail cruises with one method.

    Args:
        posed: the cruises.
        method: a key of `METHODS`.

    Raises:
        BadInputError: the map is too large for the method's heuristic.
    """
    chosen = METHODS[method]
    return cruise(
        posed.scenes.blocked,
        posed.scenes.stations,
        jax.random.fold_in(jax.random.key(posed.seed), _FLIPS),
        method=chosen.planner,
        heuristic=chosen.heuristic,
        order=posed.order(method),
        first=int(posed.jobs[0]),
        cell_size=posed.source.cell_size,
        **_under_way(posed.options),
    )


def _mission(scenes: CruiseScenes, cell_size: float, options: CruiseOptions) -> Mission:
    return check_mission(
        scenes.blocked,
        scenes.stations,
        runs=None,
        corner_cutting=False,
        cell_size=cell_size,
        **_under_way(options),
    )


def _under_way(options: CruiseOptions) -> dict[str, Any]:
    """Keyword arguments that `cruise` and its check share."""
    return {name: value for name, value in asdict(options).items() if name != "distances"}
