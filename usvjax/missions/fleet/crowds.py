"""Crowds: fleets with random starts and goals in a square, among circles or on a map."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.maps.chart import OnChart, cells_where
from usvjax.maps.discs import check_number
from usvjax.maps.draws import in_rounds, uniform_points
from usvjax.maps.ends import end_groups
from usvjax.maps.sensed import MOST_REMOTE
from usvjax.maps.tables import check_length
from usvjax.missions.fleet.params import FleetParams
from usvjax.missions.fleet.scenes import FleetScenes, at_rest, check_vessels, uniforms

# Pairs of start and goal that a vessel tries in each round, and rounds of a whole fleet.
_TRIES, _ROUNDS = 8, 200

_DENSEST = 0.2
"""Share of the square that the circles about vessels may fill: beyond, a fleet seldom has room."""

Seen = tuple[np.ndarray, np.ndarray]
"""Ends, moved to where they may be, and whether all those of a try serve; bool[R, n, tries]."""

Look = Callable[[np.ndarray, np.ndarray, np.ndarray], Seen]
"""Of rows int64[R], two uniform numbers each, and ends float64[R, n, tries, E, 2] (m) in their
squares."""


@dataclass(frozen=True)
class CrowdTable:
    """Vessels at rest with random starts and goals in a square with random circles.

    Attributes:
        vessels: of a fleet; 2 to 256.
        size: edge of the square, m, above 0.
        least_distance: least distance from a start to its goal, m; above `params.goal_tolerance`.
        circles: obstacles of `params.obstacle_radius`, centres uniform; 0 to 10,000.
    """

    vessels: int = 6
    size: float = 8000.0
    least_distance: float = 3000.0
    circles: int = 8

    most_jobs = None

    def check(self, params: FleetParams, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        check_number(self.circles, float(params.obstacle_radius), where)
        check_crowd(self, params, where)

    def draw(self, seed: int, jobs: np.ndarray, params: FleetParams) -> FleetScenes:
        """Return the scenes of int64[J] jobs.

        Raises:
            BadInputError: a job's fleet has no room.
        """
        centres = self.size * uniform_points(seed, jobs, self.circles).astype(np.float64)

        def look(rows: np.ndarray, corner: np.ndarray, ends: np.ndarray) -> Seen:
            clear = clear_of(centres[rows], ends, params).all(axis=-1)
            return ends, clear & far_enough(ends, self.least_distance)

        ends = crowd(seed, jobs, self, gap(params), look)
        water = centres.astype(np.float32) if self.circles else None
        return at_rest(ends[:, :, 0], ends[:, :, 1], water)


def clear_of(circles: np.ndarray, ends: np.ndarray, params: FleetParams) -> np.ndarray:
    """Whether float64[R, ..., 2] keep clear of circles float64[R, K, 2] (m); bool[R, ...]."""
    keep = berth(params)
    clear = np.ones(ends.shape[:-1], bool)
    for k in range(circles.shape[1]):
        centre = circles[:, k].reshape(-1, *[1] * (ends.ndim - 2), 2)
        clear &= np.hypot(*np.moveaxis(ends - centre, -1, 0)) >= keep
    return clear


def far_enough(ends: np.ndarray, least: float) -> np.ndarray:
    """Whether starts and goals float64[..., 2, 2] lie so far (m) from each other."""
    way: np.ndarray = np.hypot(*np.moveaxis(ends[..., 1, :] - ends[..., 0, :], -1, 0))
    return way >= least


@dataclass(frozen=True)
class ChartTable:
    """Vessels at rest in a square about a random place on one map, whose water joins all ends.

    Starts and goals lie in the middle of cells.

    Attributes:
        map: a packaged map's name (`usvjax maps list`), or a map file.
        cell_size: edge of a cell, m, above 0; required for a plain image, refused otherwise.
        refine: cells are divided into refine x refine by interpolating the shore; 1 or more.
        vessels: of a fleet; 2 to 256.
        size: edge of the square, m, above 0.
        least_distance: least distance from a start to its goal, m; above `params.goal_tolerance`.
        shore_distance: least distance from starts and goals to the nearest blocked cell's centre,
            m; a hull radius and a cell's diagonal when left out, and no less.
    """

    map: str
    cell_size: float | None = None
    refine: int = 1
    vessels: int = 6
    size: float = 8000.0
    least_distance: float = 3000.0
    shore_distance: float | None = None


@dataclass(frozen=True)
class ChartSource(OnChart):
    """Draws the scenes of a `ChartTable`.

    Attributes:
        chart: the map.
        table: the `[scenes]` table.
    """

    chart: GridMap
    table: ChartTable

    most_jobs = None

    def check(self, params: FleetParams, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        least = float(params.hull_radius) + self.cell_size * math.sqrt(2)
        given = self.table.shore_distance
        if given is not None and not least <= given < math.inf:
            raise BadInputError(
                f"{where}: 'shore_distance' must be at least a hull radius and the diagonal of a "
                f"cell, {least:g} m, got {given:g}"
            )
        check_crowd(self.table, params, where)
        if not self.waters(params).bodies.any():
            raise BadInputError(f"{where}: no water of {self.table.map!r} is that far off shore")

    def draw(self, seed: int, jobs: np.ndarray, params: FleetParams) -> FleetScenes:
        """Return the scenes of int64[J] jobs.

        Raises:
            BadInputError: a job's fleet has no room.
        """
        waters = self.waters(params)

        def look(rows: np.ndarray, corner: np.ndarray, ends: np.ndarray) -> Seen:
            corners = waters.middles(corner) - self.table.size / 2
            there, water = waters.seen(ends + corners.reshape(-1, *[1] * (ends.ndim - 2), 2))
            fits = (water[..., 0] > 0) & (water[..., 0] == water[..., 1])
            return there, fits & far_enough(there, self.table.least_distance)

        ends = crowd(seed, jobs, self.table, gap(params), look)
        return at_rest(ends[:, :, 0], ends[:, :, 1], self.chart)

    def waters(self, params: FleetParams) -> "Waters":
        """Where vessels of this hull start and end."""
        hull = float(params.hull_radius)
        reach = hull + self.cell_size * math.sqrt(0.5)
        given = self.table.shore_distance
        far = hull + self.cell_size * math.sqrt(2) if given is None else given
        return Waters(self.chart, _bodies(self.chart, reach, far))


@dataclass(frozen=True)
class Waters:
    """Where vessels may start and end on a map.

    Attributes:
        chart: the map.
        bodies: int32[H, W], number of the body of water; 0 where no vessel starts or ends.
    """

    chart: GridMap
    bodies: np.ndarray

    def middles(self, unit: np.ndarray) -> np.ndarray:
        """Places float64[R, 2] (m) anywhere on the water, from two uniform numbers each."""
        return self.chart.points_of(self._cells[(unit[:, 0] * len(self._cells)).astype(np.int64)])

    @cached_property
    def _cells(self) -> np.ndarray:
        return cells_where(self.bodies > 0)

    def seen(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Middles of the cells of places float64[..., 2] (m), and their bodies; 0 off the map."""
        limit = np.asarray(self.bodies.shape[::-1])
        cells = self.chart.cells_of(places)
        inside = np.all((cells >= 0) & (cells < limit), axis=-1)
        x, y = np.moveaxis(np.clip(cells, 0, limit - 1), -1, 0)
        return self.chart.points_of(cells), np.where(inside, self.bodies[y, x], 0)


@lru_cache(maxsize=4)
def _bodies(chart: GridMap, reach: float, far: float) -> np.ndarray:
    """Water where cells are `reach` off shore, by body; 0 where they are not `far` off as well."""
    clearance = chart.clearance()
    groups = end_groups((clearance < reach)[None], "connected")[0]
    return np.where(clearance >= far, groups, 0)


def berth(params: FleetParams) -> float:
    """Least distance from a circle's centre to a start or goal that is drawn (m)."""
    return float(params.hull_radius) + float(params.obstacle_radius) + float(params.passing)


def gap(params: FleetParams) -> float:
    """Least distance between two starts, or two goals, that are drawn (m)."""
    return 2.0 * float(params.hull_radius) + float(params.passing)


def check_crowd(table: CrowdTable | ChartTable, params: FleetParams, where: str) -> None:
    """Refuse what leaves no room for the fleet, or is over at once."""
    check_vessels(table.vessels, where)
    check_length("least_distance", table.least_distance, where)
    if not 0.0 < table.size <= MOST_REMOTE:
        raise BadInputError(f"{where}: 'size' must be above 0 and at most {MOST_REMOTE:g} m")
    if table.least_distance <= float(params.goal_tolerance):
        raise BadInputError(
            f"{where}: 'least_distance' must exceed 'goal_tolerance' of "
            f"{params.goal_tolerance:g} m, or a passage would be over at once, "
            f"got {table.least_distance:g}"
        )
    if table.least_distance >= table.size:
        raise BadInputError(
            f"{where}: 'least_distance' of {table.least_distance:g} m must be below 'size', "
            f"{table.size:g} m"
        )
    room = _DENSEST * (table.size + gap(params)) ** 2
    if table.vessels * math.pi * (gap(params) / 2) ** 2 > room:
        raise BadInputError(
            f"{where}: {table.vessels} vessels that keep {gap(params):g} m from one another do "
            f"not fit into a square of {table.size:g} m"
        )


def crowd(
    seed: int,
    jobs: np.ndarray,
    table: CrowdTable | ChartTable,
    keep: float,
    look: Look,
    count: int = 2,
) -> np.ndarray:
    """Draw ends in a square, vessel by vessel; a fleet without room begins anew.

    Args:
        seed, jobs: of the study.
        table: vessels, edge of the square, and least distance, for messages.
        keep: least distance between the same ends of two vessels, m.
        look: where ends may be.
        count: E, ends of a vessel: a start and a goal, or a start alone.

    Returns:
        float64[J, n, E, 2], m.

    Raises:
        BadInputError: a job's fleet found no room.
    """
    n = table.vessels
    placed = np.zeros((len(jobs), n, count, 2))

    def attempt(rows: np.ndarray, number: int) -> np.ndarray:
        unit = uniforms(seed, jobs[rows], number, 2 + 2 * count * n * _TRIES, len(jobs))
        inside = table.size * unit[:, 2:].reshape(-1, n, _TRIES, count, 2)
        ends, fits = look(rows, unit[:, :2], inside)
        chosen, found = np.zeros((len(rows), n, count, 2)), np.ones(len(rows), bool)
        for i in range(n):
            apart = ends[:, i, :, None] - chosen[:, None, :i]
            free = np.hypot(*np.moveaxis(apart, -1, 0)) >= keep
            serves = fits[:, i] & free.all(axis=(2, 3))
            chosen[:, i] = ends[np.arange(len(rows)), i, serves.argmax(axis=1)]
            found &= serves.any(axis=1)
        placed[rows[found]] = chosen[found]
        return found

    left = in_rounds(len(jobs), _ROUNDS, attempt)
    if len(left):
        raise BadInputError(
            f"no room for {n} vessels that keep {keep:g} m from one another and sail "
            f"{table.least_distance:g} m in {table.size:g} m of water (job {jobs[left[0]]} found "
            f"none in {_ROUNDS} rounds)"
        )
    return placed
