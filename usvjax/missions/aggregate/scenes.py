"""Where fleets gather: starts, formations and what lies about them, one scene per job.

Job j's scene is a pure function of the seed and j, and all strategies meet it.
"""

import math
from dataclasses import dataclass

import numpy as np

from usvjax.checks import not_negative, one_of
from usvjax.errors import BadInputError, saying_where
from usvjax.maps import GridMap
from usvjax.maps.draws import Stream, in_rounds, uniform_points
from usvjax.missions.aggregate.formations import ASSIGNMENTS, FORMATIONS, check_spacing, placed
from usvjax.missions.aggregate.run import local_slots
from usvjax.missions.fleet.chart import Chart
from usvjax.missions.fleet.crowds import (
    ChartSource,
    ChartTable,
    CrowdTable,
    Seen,
    berth,
    clear_of,
    crowd,
    gap,
)
from usvjax.missions.fleet.ground import Circles
from usvjax.missions.fleet.params import FleetParams
from usvjax.missions.fleet.scenes import FleetScenes, uniforms

_ROUNDS = 200
"""In which circles that are in the way are drawn anew."""


@dataclass(frozen=True)
class Gatherings(FleetScenes):
    """Scenes of J jobs with fleets of n vessels that gather; goals are the slots of formations.

    Attributes:
        centres: float64[J, 2], of the formations, m.
        headings: float64[J], rad.
    """

    centres: np.ndarray
    headings: np.ndarray


@dataclass(frozen=True)
class FormationTable:
    """The formation in which fleets gather.

    Attributes:
        formation: "wedge", "line" (abreast), "column" or "circle".
        spacing: between neighbouring slots, m; one and a half times the distance at which hulls
            pass each other when left out.
        heading_deg: of all vessels, degrees from east to north; any, each job's own, when left
            out.
        assignment: who takes which slot: "hungarian" (the least sum of distances), "nearest" (pair
            by pair) or "given" (in their order).
        hold_time: that every vessel is to hold its slot for, s.
    """

    formation: str = "wedge"
    spacing: float | None = None
    heading_deg: float | None = None
    assignment: str = "hungarian"
    hold_time: float = 10.0

    def check(self, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        one_of(f"{where}: 'formation'", self.formation, FORMATIONS)
        one_of(f"{where}: 'assignment'", self.assignment, ASSIGNMENTS)
        with saying_where(where):
            not_negative("hold_time", self.hold_time)
            if self.spacing is not None:
                check_spacing(self.spacing)
        if self.heading_deg is not None and not abs(self.heading_deg) <= 360.0:
            raise BadInputError(
                f"{where}: 'heading_deg' must lie in [-360, 360], got {self.heading_deg:g}"
            )

    def headings(self, seed: int, jobs: np.ndarray, vessels: int) -> np.ndarray:
        """Headings of the formations of int64[J] jobs, float64[J], rad."""
        if self.heading_deg is not None:
            return np.full(len(jobs), math.radians(self.heading_deg))
        return _any_headings(seed, jobs, vessels)[:, 0]


@dataclass(frozen=True)
class Lanes:
    """Formations about the origin, and the guide segments by which their slots are come to.

    Attributes:
        slots: float64[J, n, 2], m.
        headings: float64[J], rad.
        length: of the guide segments, m.
    """

    slots: np.ndarray
    headings: np.ndarray
    length: float

    @property
    def begins(self) -> np.ndarray:
        """Where the guide segments begin, float64[J, n, 2], m."""
        bow = np.stack([np.cos(self.headings), np.sin(self.headings)], axis=-1)
        return self.slots - self.length * bow[:, None]

    def clear_of(self, rows: np.ndarray, circles: np.ndarray, keep: float) -> np.ndarray:
        """Whether no guide segment of some formations comes so near (m) to each of their circles.

        Args:
            rows: int64[R], of the formations.
            circles: float64[R, K, 2], m.
            keep: m.
        """
        # Each circle for itself, as ground that has no other.
        count = circles.shape[1]
        ground = Circles(circles.reshape(-1, 1, 2), 1.0)
        every, reach = np.arange(circles[..., 0].size), np.full(circles[..., 0].size, keep)
        clear = np.ones(circles.shape[:2], bool)
        for i in range(self.slots.shape[1]):
            start, end = (np.repeat(p[rows, i], count, axis=0) for p in (self.begins, self.slots))
            clear &= ground.clear(every, start, end, reach).reshape(clear.shape)
        return clear


def lanes_of(
    table: FormationTable,
    vessels: int,
    seed: int,
    jobs: np.ndarray,
    params: FleetParams,
    guide_length: float,
) -> Lanes:
    """The formations of int64[J] jobs.

    Raises:
        BadInputError: slots that hulls do not fit into.
    """
    headings = table.headings(seed, jobs, vessels)
    slots, _ = local_slots(table.formation, table.spacing, params, (1, vessels))
    shared = np.broadcast_to(slots, (len(jobs), *slots.shape[1:]))
    return Lanes(placed(shared, np.zeros((len(jobs), 2)), headings), headings, guide_length)


@dataclass(frozen=True)
class SquareTable(CrowdTable):
    """Vessels at rest anywhere in a square, on any heading, that gather in the middle of it.

    Circles keep clear of slots, of the guide segments that lead to them, and of the starts.

    Attributes:
        least_distance: least distance from a start to the middle of the formation, m.
        circles: obstacles of `params.obstacle_radius`, centres uniform where they are not in the
            way; 0 to 10,000.
    """

    vessels: int = 3
    size: float = 14000.0
    least_distance: float = 3500.0
    circles: int = 6

    def check(self, params: FleetParams, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        super().check(params, where)
        _check_distance(self, where)

    def gather(self, seed: int, jobs: np.ndarray, params: FleetParams, lanes: Lanes) -> Gatherings:
        """Return the scenes of int64[J] jobs.

        Raises:
            BadInputError: a job's fleet or its circles have no room.
        """
        circles = self._circles(seed, jobs, params, lanes)

        def look(rows: np.ndarray, corner: np.ndarray, ends: np.ndarray) -> Seen:
            away = ends - self.size / 2
            fits = clear_of(circles[rows], away, params) & (_length(away) >= self.least_distance)
            return away, fits[..., 0]

        places = crowd(seed, jobs, self, gap(params), look, 1)[:, :, 0]
        water = circles.astype(np.float32) if self.circles else None
        return _gatherings(seed, jobs, places, lanes, np.zeros((len(jobs), 2)), water)

    def _circles(
        self, seed: int, jobs: np.ndarray, params: FleetParams, lanes: Lanes
    ) -> np.ndarray:
        """Centres float64[J, K, 2], m, about the middle of the square."""
        drawn = uniform_points(seed, jobs, self.circles).astype(np.float64)
        circles = self.size * (drawn - 0.5)
        clear = np.zeros(circles.shape[:2], bool)

        def attempt(rows: np.ndarray, number: int) -> np.ndarray:
            if number:
                shape = len(rows), self.circles, 2
                unit = uniforms(
                    seed, jobs[rows], number, 2 * self.circles, len(jobs), Stream.CIRCLES
                )
                anew = self.size * (unit.reshape(shape) - 0.5)
                circles[rows] = np.where(clear[rows, :, None], circles[rows], anew)
            clear[rows] = lanes.clear_of(rows, circles[rows], berth(params))
            return clear[rows].all(axis=1)

        left = in_rounds(len(jobs), _ROUNDS, attempt)
        if len(left):
            raise BadInputError(
                f"no room for {self.circles} circles beside the formation and its guide segments "
                f"in {self.size:g} m of water (job {jobs[left[0]]} found none in {_ROUNDS} rounds)"
            )
        return circles


@dataclass(frozen=True)
class LakeTable(ChartTable):
    """Vessels at rest anywhere in a square about a random formation on one map, on any heading.

    Starts lie in the middle of cells, on the formation's water; slots and the guide segments that
    lead to them are clear of the shore.

    Attributes:
        size: edge of the square, m, above 0.
        least_distance: least distance from a start to the middle of the formation, m.
        shore_distance: least distance from starts and slots to the nearest blocked cell's centre,
            m; a hull radius and a cell's diagonal when left out, and no less.
    """

    vessels: int = 3
    size: float = 10000.0
    least_distance: float = 3000.0


@dataclass(frozen=True)
class LakeSource(ChartSource):
    """Draws the scenes of a `LakeTable`."""

    @property
    def vessels(self) -> int:
        """Of a fleet."""
        return self.table.vessels

    def check(self, params: FleetParams, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        super().check(params, where)
        _check_distance(self.table, where)

    def gather(self, seed: int, jobs: np.ndarray, params: FleetParams, lanes: Lanes) -> Gatherings:
        """Return the scenes of int64[J] jobs.

        Raises:
            BadInputError: a job's fleet has no room.
        """
        waters, ground = self.waters(params), Chart(self.chart.blocked[None], self.cell_size)
        reach = float(params.hull_radius) + self.cell_size * math.sqrt(0.5)
        n, origin = self.table.vessels, np.asarray(self.origin)
        centres = np.zeros((len(jobs), 2))

        def look(rows: np.ndarray, corner: np.ndarray, ends: np.ndarray) -> Seen:
            middle = waters.middles(corner)
            centres[rows] = middle
            slots, begins = (p[rows] + middle[:, None] for p in (lanes.slots, lanes.begins))
            first, last = (p.reshape(-1, 2) - origin for p in (begins, slots))
            open_ = ground.clear(np.zeros(len(last), int), first, last, np.full(len(last), reach))
            body = waters.seen(slots)[1]
            own = np.where(open_.reshape(-1, n).all(axis=1), body[:, 0], 0)
            own = np.where(np.all(body == body[:, :1], axis=1), own, 0)
            corners = (middle - self.table.size / 2)[:, None, None, None]
            there, water = waters.seen(ends + corners)
            fits = (water > 0) & (water == own[:, None, None, None])
            away = _length(there - middle[:, None, None, None])
            return there, (fits & (away >= self.table.least_distance))[..., 0]

        places = crowd(seed, jobs, self.table, gap(params), look, 1)[:, :, 0]
        return _gatherings(seed, jobs, places, lanes, centres, self.chart)


def _gatherings(
    seed: int,
    jobs: np.ndarray,
    places: np.ndarray,
    lanes: Lanes,
    centres: np.ndarray,
    water: np.ndarray | GridMap | None,
) -> Gatherings:
    """Vessels at rest on any heading, and their formations about centres float64[J, 2], m."""
    courses = _any_headings(seed, jobs, places.shape[1])[:, 1:]
    return Gatherings(
        starts=np.concatenate([places, courses[..., None]], axis=2),
        goals=lanes.slots + centres[:, None],
        speeds=np.zeros(places.shape[:2]),
        hulls=None,
        limits=None,
        water=water,
        centres=centres,
        headings=lanes.headings,
    )


def _any_headings(seed: int, jobs: np.ndarray, vessels: int) -> np.ndarray:
    """Headings of formations, and of their vessels at the start; float64[J, 1 + n], rad."""
    unit = uniforms(seed, jobs, 0, 1 + vessels, stream=Stream.HEADINGS)
    return np.pi * (2.0 * unit - 1.0)


def _check_distance(table: CrowdTable | ChartTable, where: str) -> None:
    farthest = table.size / math.sqrt(2)
    if table.least_distance >= farthest:
        raise BadInputError(
            f"{where}: 'least_distance' of {table.least_distance:g} m from the middle must be "
            f"below that of a corner of the square, {farthest:g} m"
        )


def _length(vectors: np.ndarray) -> np.ndarray:
    found: np.ndarray = np.hypot(*np.moveaxis(vectors, -1, 0))
    return found
