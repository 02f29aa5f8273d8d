"""Where cruises take place: maps with stations, one set per job.

Job j draws from `fold_in(key(seed), j)` and from nothing else, so its stations depend neither on
the shard it is computed in, nor on how many jobs there are, nor on the method. All stations of a
job lie on its map's largest body of water; station 0 is home.
"""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.maps.tables import MapSource, OnChart
from usvjax.missions.dwa.scenes import check_share
from usvjax.missions.route.scenes import random_grids

STATIONS = 20
MOST_STATIONS = 200

# A set that left no room for its last stations is drawn again, so often at most.
_ROUNDS = 50

# Random maps draw from fold_in(key, job); stations must not see the same numbers.
_STREAM = 2

_BLOCK = 64  # jobs that draw at once
_FARTHEST = 1e12  # m; whatever lies farther off overflows the number of a cell


@dataclass(frozen=True)
class Sites:
    """Maps and stations of some jobs, in the order of the jobs.

    Attributes:
        blocked: bool[H, W] shared or bool[J, H, W], what vessels keep off.
        stations: int32[J, d, 2], cells (x, y), home first.
    """

    blocked: np.ndarray
    stations: np.ndarray


class Waters(MapSource, Protocol):
    """A generator of maps and stations: the `[maps]` table of a study."""

    def draw(self, seed: int, jobs: np.ndarray) -> Sites:
        """Return the maps and stations of int64[J] jobs."""
        ...


@dataclass(frozen=True)
class RandomWaters:
    """Random maps, each cell blocked with the same probability, with random stations.

    Attributes:
        shape: rows and columns.
        density: probability that a cell is blocked, in [0, 1].
        cell_size: edge of a cell, m.
        stations: of a cruise, home included; one map whose largest water has no room for them
            ends the study.
        min_distance: least straight-line distance between two stations, m.
    """

    shape: tuple[int, int] = (50, 50)
    density: float = 0.1
    cell_size: float = 10.0
    stations: int = STATIONS
    min_distance: float = 0.0

    @property
    def origin(self) -> tuple[float, float]:
        """South-west corner of cell (0, 0), m."""
        return 0.0, 0.0

    @property
    def chart(self) -> None:
        """Every job has a map of its own."""
        return None

    def check(self, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        check_share("density", self.density, where)
        if not 0.0 < self.cell_size < math.inf:
            raise BadInputError(f"{where}: 'cell_size' must be above 0, got {self.cell_size:g}")
        if min(self.shape) < 3:
            raise BadInputError(
                f"{where}: 'shape' must be [rows, columns], 3 or more each, "
                f"got {list(self.shape)!r}"
            )
        _check_stations(self.stations, self.min_distance, where)
        self.draw(0, np.arange(8))

    def draw(self, seed: int, jobs: np.ndarray) -> Sites:
        """Return the maps and stations of int64[J] jobs.

        Raises:
            BadInputError: the water of a job has no room for them.
        """
        grids = random_grids(seed, jobs, self.shape, self.density)
        cells = [_cells(GridMap(grid).largest_component()) for grid in grids]
        least = self.min_distance / self.cell_size
        place = f"the largest water of a map of density {self.density:g}"
        lower = "'stations' or 'min_distance'"
        return Sites(grids, _draw_stations(seed, jobs, cells, self.stations, least, place, lower))


@dataclass(frozen=True)
class GridWaters:
    """Stations on one map, given or drawn anew for each job.

    Attributes:
        map: a packaged map's name, or a map file.
        cell_size: m; required for a plain image, refused otherwise.
        refine: cells are divided into refine x refine by interpolating the shore.
        inflate: m; vessels keep off cells whose centre is this near to a blocked one's.
        stations: drawn for each cruise, home included; 20 when None. Not with `places`.
        min_distance: least straight-line distance between two stations drawn, m.
        min_clearance: m, from stations drawn to the nearest blocked cell's centre.
        places: (x, y) of each station in the map's metres, home first, the same for every job;
            when None, stations are drawn.
    """

    map: str
    cell_size: float | None = None
    refine: int = 1
    inflate: float = 0.0
    stations: int | None = None
    min_distance: float = 0.0
    min_clearance: float = 0.0
    places: tuple[tuple[float, float], ...] | None = None


@dataclass(frozen=True)
class Lake(OnChart):
    """The stations of a `GridWaters`.

    Attributes:
        chart: the map.
        spec: the `[maps]` table.
    """

    chart: GridMap
    spec: GridWaters = field(compare=False)

    @cached_property
    def water(self) -> GridMap:
        """The map that cruises are sailed on."""
        return self.chart.inflated(self.spec.inflate) if self.spec.inflate else self.chart

    @cached_property
    def cells(self) -> np.ndarray:
        """int32[N, 2]: (x, y) of the cells where a station may be."""
        far = self.chart.clearance() >= self.spec.min_clearance
        return _cells(self.water.largest_component() & far)

    def check(self, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        for name in ("inflate", "min_clearance"):
            value = getattr(self.spec, name)
            if not 0.0 <= value < math.inf:
                raise BadInputError(f"{where}: {name!r} must be 0 or more, got {value:g}")
        if self.spec.places is not None:
            self._check_places(self.spec.places, where)
            return
        _check_stations(self._count, self.spec.min_distance, where)
        self.draw(0, np.arange(8))

    def draw(self, seed: int, jobs: np.ndarray) -> Sites:
        """Return the stations of int64[J] jobs.

        Raises:
            BadInputError: the water has no room for them.
        """
        if self.spec.places is not None:
            given = self.chart.cells_of(self.spec.places).astype(np.int32)
            return Sites(self.water.blocked, np.repeat(given[None], len(jobs), axis=0))
        least = self.spec.min_distance / self.cell_size
        place = f"the largest water of {self.spec.map!r}"
        cells = [self.cells] * len(jobs)
        lower = "'stations', 'min_distance', 'min_clearance' or 'inflate'"
        stations = _draw_stations(seed, jobs, cells, self._count, least, place, lower)
        return Sites(self.water.blocked, stations)

    @property
    def _count(self) -> int:
        return STATIONS if self.spec.stations is None else self.spec.stations

    def _check_places(self, places: tuple[tuple[float, float], ...], where: str) -> None:
        """Refuse places that are no stations of one body of water, or that settings contradict."""
        for name in ("stations", "min_distance", "min_clearance"):
            if getattr(self.spec, name):
                raise BadInputError(
                    f"{where}: {name!r} is of stations drawn, but 'places' is given"
                )
        _check_stations(len(places), 0.0, where)
        if not (np.abs(places) < _FARTHEST).all():
            raise BadInputError(f"{where}: 'places' has a number that is no place in metres")
        cells = self.chart.cells_of(places)
        wet = ~self.water.is_blocked(self.chart.points_of(cells))
        if not wet.all():
            x, y = places[int(np.argmin(wet))]
            raise BadInputError(f"{where}: 'places': ({x:g}, {y:g}) is not on the map's water")
        bodies = self.water.components()[cells[:, 1], cells[:, 0]]
        if (bodies != bodies[0]).any():
            x, y = places[int(np.argmax(bodies != bodies[0]))]
            raise BadInputError(f"{where}: 'places': no water joins ({x:g}, {y:g}) to the first")
        if len(np.unique(cells, axis=0)) < len(cells):
            raise BadInputError(f"{where}: 'places' has two stations in one cell")


def _check_stations(stations: int, min_distance: float, where: str) -> None:
    if not 2 <= stations <= MOST_STATIONS:
        raise BadInputError(
            f"{where}: a cruise must have 2 to {MOST_STATIONS} stations, home included, "
            f"got {stations}"
        )
    if not 0.0 <= min_distance < math.inf:
        raise BadInputError(f"{where}: 'min_distance' must be 0 or more, got {min_distance:g}")


def _cells(allowed: np.ndarray) -> np.ndarray:
    """(x, y) of the cells that bool[H, W] allows, int32[N, 2]."""
    return np.argwhere(allowed)[:, ::-1].astype(np.int32)


def _draw_stations(
    seed: int,
    jobs: np.ndarray,
    cells: list[np.ndarray],
    count: int,
    least: float,
    place: str,
    lower: str,
) -> np.ndarray:
    """Draw stations for each job, one after another, each uniform over the cells still allowed.

    Args:
        seed: of the study.
        jobs: int64[J].
        cells: int32[N, 2] for each job, where a station may be.
        count: d, stations.
        least: cells, between any two.
        place: what the water is, and
        lower: which settings make room, for the message.

    Returns:
        int32[J, d, 2], cells (x, y).

    Raises:
        BadInputError: there is no room for them.
    """
    stations = np.zeros((len(jobs), count, 2), np.int32)
    open_rows = list(range(len(jobs)))
    for number in range(_ROUNDS):
        if not open_rows:
            return stations
        drawn = _bits(seed, jobs[open_rows], number, count)
        missing = []
        for row, numbers in zip(open_rows, drawn, strict=True):
            found = _scattered(cells[row], numbers, least)
            if found is None:
                missing.append(row)
            else:
                stations[row] = found
        open_rows = missing
    raise BadInputError(
        f"{place}, {len(cells[open_rows[0]])} cells where a station may be, has no room for "
        f"{count} stations {least:.4g} cells apart (job {jobs[open_rows[0]]}); lower {lower}"
    )


def _scattered(cells: np.ndarray, numbers: list[int], least: float) -> np.ndarray | None:
    """One station for each random number below 2**32; None where no cell is left."""
    # A distance of a whole number of cells must survive the rounding of metres.
    apart = max(least * least * (1.0 - 1e-9), 0.5)
    left = cells.astype(np.int64)
    found = []
    for number in numbers:
        if not len(left):
            return None
        found.append(left[number * len(left) >> 32])
        left = left[((left - found[-1]) ** 2).sum(axis=1) >= apart]
    return np.array(found)


def _bits(seed: int, jobs: np.ndarray, number: int, count: int) -> list[list[int]]:
    """Random whole numbers below 2**32, `count` per job, of one round of draws."""
    key = jax.random.key(seed)
    numbers: list[list[int]] = []
    for first in range(0, len(jobs), _BLOCK):
        some = jobs[first : first + _BLOCK]
        padded = np.zeros(_BLOCK, np.uint32)
        padded[: len(some)] = some
        drawn = np.asarray(_round(key, jnp.asarray(padded), number))
        numbers += drawn[: len(some), :count].tolist()
    return numbers


@jax.jit
def _round(key: jax.Array, jobs: jax.Array, number: int) -> jax.Array:
    """uint32[jobs, MOST_STATIONS]: always so many, so that only one program is compiled."""

    def one(job: jax.Array) -> jax.Array:
        own = jax.random.fold_in(jax.random.fold_in(key, job), _STREAM)
        return jax.random.bits(jax.random.fold_in(own, number), (MOST_STATIONS,), jnp.uint32)

    return jax.vmap(one)(jobs)
