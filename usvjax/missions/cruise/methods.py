"""Ways to sail a cruise, by name: an order of the stations, and a planner under way.

Studies and figures share these names, and `sail`, which runs one.
"""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from typing import Any

import jax
import numpy as np

from usvjax.errors import BadInputError, BadTypeError
from usvjax.keys import seed_key
from usvjax.maps import GridMap
from usvjax.missions.cruise import CruiseResult, cruise
from usvjax.missions.cruise.inputs import check_expedition, check_heuristic
from usvjax.missions.cruise.orders import water_distances
from usvjax.missions.cruise.params import CruiseParams, CruiseStatic
from usvjax.missions.cruise.scenes import CruiseScenes, Source, some_scenes
from usvjax.tables import check_keys, field_names, read_table
from usvjax.tours import solve_tour

# Parts of the study's key; job j's own part is j, and jobs are fewer than 2^31.
_TOURS, _FLIPS = 2**32 - 1, 2**32 - 2


@dataclass(frozen=True)
class CruiseMethod:
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


OPTION_KEYS = tuple(
    name
    for name in field_names(CruiseParams, CruiseStatic)
    if name not in ("corner_cutting", "max_expansions")
)
"""Keys of the `[cruise]` table: what a study may choose of a cruise."""

METHODS: dict[str, CruiseMethod] = {
    "recommended": CruiseMethod(
        "the shortest tour found, D* Lite along shortest paths", "recommended"
    ),
    "astar": CruiseMethod(
        "the same tour, A* anew where the way is blocked", "recommended", "astar"
    ),
    "proposed": CruiseMethod(
        "tour by improved grey wolves, D* Lite with the weighted heuristic (Yu et al. 2022)",
        "igwo",
        heuristic="weighted",
    ),
    "gwo": CruiseMethod(
        "tour by grey wolves, D* Lite with the chess-board distance (Yu et al. 2022, Algorithm 4)",
        "gwo",
        heuristic="chebyshev",
    ),
    "aco": CruiseMethod("tour and paths by ants (Yu et al. 2022, Algorithm 1)", "aco", "aco"),
    "ga": CruiseMethod("tour and paths by genes (Yu et al. 2022, Algorithm 2)", "ga", "ga"),
    "cmpso": CruiseMethod(
        "tour and paths by particles (Yu et al. 2022, Algorithm 3)", "cmpso", "cmpso"
    ),
}


@dataclass(frozen=True)
class CruiseOptions:
    """The `[cruise]` table: `OPTION_KEYS`, the fields of both.

    Attributes:
        params: numbers.
        static: choices.
    """

    params: CruiseParams
    static: CruiseStatic

    def table(self) -> dict[str, Any]:
        """The keys of the table and their values."""
        values = {**asdict(self.params), **asdict(self.static)}
        return {name: values[name] for name in OPTION_KEYS}


def read_options(table: Mapping[str, Any], where: str) -> CruiseOptions:
    """Read the `[cruise]` table of a study.

    Raises:
        BadInputError, BadTypeError: as `usvjax.tables.read_table`.
    """
    check_keys(table, OPTION_KEYS, where)
    numbers = field_names(CruiseParams)
    params = {key: value for key, value in table.items() if key in numbers}
    static = {key: value for key, value in table.items() if key not in numbers}
    return CruiseOptions(
        read_table(CruiseParams, params, where), read_table(CruiseStatic, static, where)
    )


@dataclass(frozen=True)
class CruiseCase:
    """One condition.

    Attributes:
        source: draws the maps and stations.
        options: of the cruises.
    """

    source: Source
    options: CruiseOptions


@dataclass(frozen=True)
class CruisePosed:
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
    some = some_scenes(source)
    with _naming_keys():
        expedition = check_expedition(
            some.blocked, some.stations, options.params, options.static, cell_size=source.cell_size
        )
    refusals = {}
    for name, method in METHODS.items():
        try:
            if method.planner == "dstar_lite":
                with _naming_keys():
                    check_heuristic(expedition, method.heuristic, None)
        except BadInputError as error:
            refusals[name] = str(error)
    return refusals


@contextmanager
def _naming_keys() -> Iterator[None]:
    """Name keys of the `[cruise]` table, where `cruise` names fields of its arguments."""
    try:
        yield
    except (BadInputError, BadTypeError) as error:
        named = rf"\b(?:params|static)\.(?=(?:{'|'.join(OPTION_KEYS)})\b)"
        raise type(error)(re.sub(named, "", str(error))) from error


def pose(source: Source, options: CruiseOptions, seed: int, jobs: np.ndarray) -> CruisePosed:
    """Draw the maps and stations of int64[J] jobs that follow one another."""
    scenes = source.draw(seed, jobs)
    legs = leg_lengths(scenes, source.cell_size, options.static.distances)
    return CruisePosed(source, options, seed, jobs, scenes, legs)


def first_map(posed: CruisePosed, row: int = 0) -> GridMap:
    """The first map of a cruise; a shared one as it was before it was inflated."""
    source = posed.source
    return source.chart or GridMap(posed.scenes.blocked[row], source.cell_size, source.origin)


def leg_lengths(scenes: CruiseScenes, cell_size: float, distances: str) -> np.ndarray:
    """Distances between stations, float64[J, d, d], m, "straight" or by "water"."""
    if distances == "water":
        expedition = check_expedition(
            scenes.blocked, scenes.stations, CruiseParams(), CruiseStatic(), cell_size=cell_size
        )
        return cell_size * water_distances(expedition).astype(np.float64)
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
    key = jax.random.fold_in(seed_key(seed), _TOURS)
    return solve_tour(None, key, algorithm=algorithm, distances=legs, first=int(jobs[0])).order


def tour_lengths(legs: np.ndarray, orders: np.ndarray) -> np.ndarray:
    """Lengths of closed tours int32[J, d], float64[J], in the unit of float64[J, d, d]."""
    row = np.arange(len(orders))[:, None]
    lengths: np.ndarray = legs[row, orders, np.roll(orders, -1, axis=1)].sum(axis=1)
    return lengths


def sail(posed: CruisePosed, method: str) -> CruiseResult:
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
        jax.random.fold_in(seed_key(posed.seed), _FLIPS),
        method=chosen.planner,
        heuristic=chosen.heuristic,
        order=posed.order(method),
        first=int(posed.jobs[0]),
        cell_size=posed.source.cell_size,
        params=posed.options.params,
        static=posed.options.static,
    )
