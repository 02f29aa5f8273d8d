"""Where DWA episodes take place: obstacles with a start and a goal, one scene per job.

A table of `[maps]` that names no file draws its scenes itself; that of a chart is drawn from by
`ChartSource`, which has read the map. Job j's scene is a pure function of the seed and j (see
`usvjax.maps.draws`). The conditions of a study share the draws: an obstacle at a low rate still is
one at a higher rate, and a change of radius moves nothing, so that differences between conditions
are paired as well.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.maps.cells import OnOwnMaps
from usvjax.maps.chart import OnChart, cells_where, off_shore, on_chart
from usvjax.maps.discs import (
    check_has_area,
    check_number,
    check_square,
    discs_for_share,
    uniform_discs,
)
from usvjax.maps.ends import (
    check_both_ends,
    check_fixed_ends,
    check_jitter,
    check_joined,
    check_on_water,
    check_only_drawn,
    check_outside_goal,
    draw_pairs,
    facing,
    fixed_ends,
    named_points,
    turned,
)
from usvjax.maps.lattice import check_lattice, lattice_obstacles
from usvjax.maps.sensed import MOST_REMOTE
from usvjax.maps.tables import Opened, check_share

DISTANCE = (1000.0, 5000.0)
"""From a start to a goal drawn on a chart, m, unless a study says otherwise."""


@dataclass(frozen=True)
class DwaScenes:
    """Scenes of some jobs, in the order of the jobs.

    Attributes:
        obstacles: float32[J, K, 2], centres (m), or a map that all jobs share.
        valid: bool[J, K], False marks padding; None with a map.
        starts: float64[J, 3], x, y (m) and heading (rad).
        goals: float64[J, 2], m.
    """

    obstacles: np.ndarray | GridMap
    valid: np.ndarray | None
    starts: np.ndarray
    goals: np.ndarray

    @property
    def rows(self) -> int:
        """Obstacles of an episode, padding included; 0 on a map."""
        return 0 if isinstance(self.obstacles, GridMap) else self.obstacles.shape[1]


@dataclass(frozen=True)
class LatticeTable(OnOwnMaps):
    """Obstacles on the integer points of a square (see `usvjax.maps.lattice`).

    Start and goal are never obstacles, and a point whose obstacle circle contains one of them
    is left out. Two things are sharp. Circles of 0.5 m touch: with 0.495 m there are gaps, and at a
    rate of 0.3 and a cap of 2r 56 instead of 44 % of traditional episodes reach the goal. From
    corner to corner the course is a diagonal, where both sides of an obstacle score alike: with
    0.2 m, start turned by 0.001 rad, 95 instead of 81 % do.

    Attributes:
        rate: obstacle rate, a share in [0, 1].
        rate_meaning: what the rate is a share of: "bernoulli" (each point is an obstacle with this
            probability), "count" (exactly this share of the points) or "area" (so many that the
            circles add up to this share of the square).
        lo: lower corner of the square in x and y, m; a whole number below `hi`.
        hi: upper corner of the square in x and y, m; a whole number. The square has at most
            100,000 points.
        start: x and y where episodes start, m.
        start_heading: heading at the start, rad; towards the goal when left out.
        start_jitter: most that the heading of a start is turned to either side, rad, 0 to pi; each
            episode's turn is drawn uniformly from its own key, the same for all methods.
        goal: x and y of the goal, m; farther from the start than `params.goal_tolerance`.
    """

    rate: float = 0.3
    rate_meaning: str = "bernoulli"
    lo: int = 0
    hi: int = 10
    start: tuple[float, float] = (0.0, 0.0)
    start_heading: float | None = None
    start_jitter: float = 0.0
    goal: tuple[float, float] = (10.0, 10.0)

    def check(self, radius: float, where: str) -> None:
        """Raise BadInputError when a value cannot be used with this vessel radius (m)."""
        check_square(self.lo, self.hi, MOST_REMOTE, where)
        check_share("rate", self.rate, where)
        check_fixed_ends(self.start, self.goal, self.start_heading, where)
        check_jitter(self.start_jitter, where)
        check_lattice(self.rate_meaning, self.lo, self.hi, radius, where)

    def check_outside_goal(self, tolerance: float, where: str) -> None:
        """Raise BadInputError where the start counts as the goal."""
        check_outside_goal(self.start, self.goal, tolerance, where)

    def draw(self, seed: int, jobs: np.ndarray, radius: float) -> DwaScenes:
        """Return the scenes of int64[J] jobs for obstacle circles of `radius` (m)."""
        ends = (self.start, self.goal)
        given = (self.rate, self.rate_meaning, self.lo, self.hi, ends, radius)
        obstacles, valid = lattice_obstacles(seed, jobs, *given)
        starts, goals = fixed_ends(self.start, self.goal, self.start_heading, len(jobs))
        starts = turned(starts, seed, jobs, self.start_jitter)
        return DwaScenes(obstacles, valid, starts, goals)


@dataclass(frozen=True)
class DiscTable(OnOwnMaps):
    """Obstacle discs with centres uniform in a square; they may overlap.

    A disc that contains the start or the goal is left out. Either `number` or `density` is given.

    Attributes:
        number: discs per map, 0 to 10,000; not with `density`.
        density: discs whose areas add up to this share of the square, in [0, 1]; not with
            `number`.
        lo: lower corner of the square in x and y, m; below `hi`.
        hi: upper corner of the square in x and y, m.
        start: x and y where episodes start, m.
        start_heading: heading at the start, rad; towards the goal when left out.
        start_jitter: most that the heading of a start is turned to either side, rad, 0 to pi; each
            episode's turn is drawn uniformly from its own key, the same for all methods.
        goal: x and y of the goal, m; farther from the start than `params.goal_tolerance`.
    """

    number: int | None = None
    density: float | None = None
    lo: float = 0.0
    hi: float = 10.0
    start: tuple[float, float] = (0.0, 0.0)
    start_heading: float | None = None
    start_jitter: float = 0.0
    goal: tuple[float, float] = (10.0, 10.0)

    def check(self, radius: float, where: str) -> None:
        """Raise BadInputError when a value cannot be used with this vessel radius (m)."""
        check_square(self.lo, self.hi, MOST_REMOTE, where)
        check_fixed_ends(self.start, self.goal, self.start_heading, where)
        check_jitter(self.start_jitter, where)
        if (self.number is None) == (self.density is None):
            raise BadInputError(f"{where}: give either 'number' or 'density'")
        if self.density is not None:
            check_share("density", self.density, where)
            check_has_area(radius, "density", where)
        check_number(self._count(radius), radius, where)

    def check_outside_goal(self, tolerance: float, where: str) -> None:
        """Raise BadInputError where the start counts as the goal."""
        check_outside_goal(self.start, self.goal, tolerance, where)

    def draw(self, seed: int, jobs: np.ndarray, radius: float) -> DwaScenes:
        """Return the scenes of int64[J] jobs for obstacle circles of `radius` (m)."""
        ends, number = (self.start, self.goal), self._count(radius)
        obstacles, valid = uniform_discs(seed, jobs, number, self.lo, self.hi, ends, radius)
        starts, goals = fixed_ends(self.start, self.goal, self.start_heading, len(jobs))
        starts = turned(starts, seed, jobs, self.start_jitter)
        return DwaScenes(obstacles, valid, starts, goals)

    def _count(self, radius: float) -> int:
        if self.number is not None:
            return self.number
        return discs_for_share(self.density or 0.0, self.lo, self.hi, radius)


@dataclass(frozen=True)
class ChartTable:
    """A start and a goal on one map, drawn for each job or given, in one body of water.

    A start drawn is uniform over the navigable cells, the bow towards the goal; its goal has a
    uniform bearing and a uniform distance from it and is then moved to the centre of its cell.
    Pairs that are ashore, in another body of water or out of the range of distances are drawn
    again. Where both are given, all episodes would be the same: there is one, unless
    `start_jitter` tells them apart.

    Attributes:
        map: a packaged map's name (`usvjax maps list`), or a map file.
        cell_size: edge of a cell, m, above 0; required for a plain image, refused otherwise.
        refine: cells are divided into refine x refine by interpolating the shore; 1 or more.
        shore_distance: least distance from a start and goal drawn to the nearest blocked cell's
            centre, m; above `params.radius`.
        distance: least and greatest straight-line distance from a start to a goal drawn, m; the
            first above `params.goal_tolerance` and below the second; [1000.0, 5000.0] when left
            out.
        start: x and y where the episode starts, in the map's metres, such as [62000.0, 38000.0]
            on Hongze Lake; on water, outside every circle of `params.radius` about the shore;
            with `goal`, for 1 episode where `start_jitter` is 0.
        start_heading: heading at the start given, rad; towards the goal when left out.
        start_jitter: most that the heading of a start is turned to either side, rad, 0 to pi; each
            episode's turn is drawn uniformly from its own key, the same for all methods.
        goal: x and y of the goal, in the map's metres, on the same body of water; farther from
            the start than `params.goal_tolerance`.
    """

    map: str
    cell_size: float | None = None
    refine: int = 1
    shore_distance: float = 0.0
    distance: tuple[float, float] | None = None
    start: tuple[float, float] | None = None
    start_heading: float | None = None
    start_jitter: float = 0.0
    goal: tuple[float, float] | None = None


@dataclass(frozen=True)
class ChartSource(OnChart):
    """Draws the scenes of a `ChartTable`.

    Attributes:
        chart: the map.
        table: the `[maps]` table.
    """

    chart: GridMap
    table: ChartTable

    @property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """The start and the goal that are given, m; None where they are drawn."""
        start, goal = self.table.start, self.table.goal
        return None if start is None or goal is None else (start, goal)

    @property
    def distance(self) -> tuple[float, float]:
        """Least and greatest distance from a start to a goal drawn, m."""
        return DISTANCE if self.table.distance is None else self.table.distance

    @property
    def most_jobs(self) -> int | None:
        """One where start and goal are given and no heading is turned; otherwise any number."""
        return 1 if self.ends and self.table.start_jitter == 0.0 else None

    @cached_property
    def bodies(self) -> np.ndarray:
        """int32[H, W]: the number of the body of water, 0 where no episode may start or end."""
        wet = off_shore(self.chart, self.table.shore_distance) & ~self.chart.blocked
        return np.where(wet, self.chart.components(), 0)

    @cached_property
    def cells(self) -> np.ndarray:
        """int64[N, 2]: (x, y) of the cells where an episode may start."""
        return cells_where(self.bodies > 0)

    def check(self, radius: float, where: str) -> None:
        """Raise BadInputError when a value cannot be used with this vessel radius (m)."""
        covers = self.cell_size * math.sqrt(0.5)
        if not radius >= covers:
            raise BadInputError(
                f"{where}: obstacle circles of {radius:g} m leave gaps between blocked cells of "
                f"{self.cell_size:g} m; the radius must be at least {covers:g} m"
            )
        check_both_ends(self.table.start, self.table.goal, where)
        check_jitter(self.table.start_jitter, where)
        if self.ends:
            self._check_given(*self.ends, where)
        else:
            self._check_drawn(radius, where)

    def _check_given(
        self, start: tuple[float, float], goal: tuple[float, float], where: str
    ) -> None:
        drawn = {name: getattr(self.table, name) for name in ("shore_distance", "distance")}
        check_only_drawn(drawn, "'start'", where)
        check_fixed_ends(start, goal, self.table.start_heading, where)
        points = named_points(start=start, goal=goal)
        check_on_water(points, self.chart, where)
        check_joined(points, self.chart, where)

    def _check_drawn(self, radius: float, where: str) -> None:
        if self.table.start_heading is not None:
            raise BadInputError(f"{where}: 'start_heading' goes with 'start', which is not given")
        near, far = self.distance
        if not 0.0 < near < far < math.inf:
            raise BadInputError(
                f"{where}: 'distance' must be two distances in m, the first above 0 and below "
                f"the second, got {[near, far]!r}"
            )
        if not radius < self.table.shore_distance < math.inf:
            raise BadInputError(
                f"{where}: 'shore_distance' must exceed the radius of the obstacle circle, "
                f"{radius:g} m, got {self.table.shore_distance:g}"
            )
        if not len(self.cells):
            raise BadInputError(
                f"{where}: no water of {self.table.map!r} is {self.table.shore_distance:g} m "
                f"from the shore"
            )
        self.draw(0, np.arange(8), radius)

    def check_outside_goal(self, tolerance: float, where: str) -> None:
        """Raise BadInputError where a start counts as its goal, or one may be drawn that does."""
        if self.ends:
            check_outside_goal(*self.ends, tolerance, where)
            return
        near, far = self.distance
        if np.float32(near) <= np.float32(tolerance):
            raise BadInputError(
                f"{where}: 'distance' must begin above 'goal_tolerance' of {tolerance:g} m, or "
                f"episodes would be over at once, got {[near, far]!r}"
            )

    def draw(self, seed: int, jobs: np.ndarray, radius: float) -> DwaScenes:
        """Return the scenes of int64[J] jobs.

        Args:
            seed: of the study.
            jobs: int64[J], job numbers.
            radius: not used; the map stays what it is.

        Raises:
            BadInputError: no start and goal could be found for a job.
        """
        starts, goals = self._ends(seed, jobs)
        starts = turned(starts, seed, jobs, self.table.start_jitter)
        return DwaScenes(self.chart, None, starts, goals)

    def _ends(self, seed: int, jobs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Starts float64[J, 3], the bow towards the goal or as given, and goals float64[J, 2]."""
        if self.ends:
            return fixed_ends(*self.ends, self.table.start_heading, len(jobs))
        words = repr(self.table.map), f"water {self.table.shore_distance:g} m from the shore"
        where = (self.chart, self.bodies, self.cells, self.distance)
        starts, goals = draw_pairs(seed, jobs, *where, *words)
        return facing(starts, goals), goals


Source = LatticeTable | DiscTable | ChartSource
"""What draws the scenes of a condition."""


def opened(
    table: LatticeTable | DiscTable | ChartTable, folder: Path, where: str
) -> Opened[Source]:
    """What a `[maps]` table asks for, with its map read; see `usvjax.maps.tables.read_maps`."""
    if isinstance(table, ChartTable):
        if table.start is None and table.distance is None:
            table = replace(table, distance=DISTANCE)
        return on_chart(table, ChartSource, folder, where)
    return Opened(table, table)
