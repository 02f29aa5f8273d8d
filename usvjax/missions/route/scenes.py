"""Where routes are sought: maps with a start and a goal cell, one query per job.

A table of `[maps]` that names no file draws its scenes itself; those of files are drawn from by
`ChartSource` and `ScenSource`, which have read them. Job j's query is a pure function of the seed
and j (see `usvjax.maps.draws`). Random maps of several densities share their uniform field: a
denser one only has more blocked cells.
"""

import hashlib
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from usvjax.errors import BadInputError, saying_where
from usvjax.maps import GridMap
from usvjax.maps.cells import OnOwnMaps, check_cells, maps_of_jobs
from usvjax.maps.chart import OnChart, inflated, map_digest, on_chart
from usvjax.maps.disk import read_bytes
from usvjax.maps.ends import (
    ENDS,
    check_both_ends,
    check_ends,
    check_on_water,
    check_only_drawn,
    draw_ends,
    end_groups,
    named_points,
)
from usvjax.maps.scen import Scen, read_scen
from usvjax.maps.tables import Opened, check_length

ENDS_DRAWN = "harbours"
"""Where routes on a chart start and end, unless a study says otherwise."""


@dataclass(frozen=True)
class RouteScenes:
    """Queries of some jobs, in the order of the jobs.

    Attributes:
        blocked: bool[H, W] shared or bool[J, H, W], what routes keep off.
        land: likewise, what clearance is measured from; the map before it was inflated.
        starts, goals: int32[J, 2], cells (x, y).
        published: float64[J], published lengths of the shortest routes, cells, 0 where none was;
            or None.
    """

    blocked: np.ndarray
    land: np.ndarray
    starts: np.ndarray
    goals: np.ndarray
    published: np.ndarray | None = None


@dataclass(frozen=True)
class CellTable(OnOwnMaps):
    """Random maps, each cell blocked with the same probability, with random free cells as ends.

    Attributes:
        shape: rows and columns, cells; 1 or more each, two cells at least.
        density: probability that a cell is blocked, in [0, 1].
        cell_size: edge of a cell, m; above 0.
        ends: "free" (start and goal are any two free cells, so that some have no route between
            them) or "connected" (two cells with a route).
        min_distance: least straight-line distance from start to goal, m; 0 or more.
    """

    shape: tuple[int, int] = (50, 50)
    density: float = 0.1
    cell_size: float = 1.0
    ends: str = "free"
    min_distance: float = 0.0

    def check(self, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        check_cells(self.shape, self.density, self.cell_size, where)
        if min(self.shape) < 1 or max(self.shape) < 2:
            raise BadInputError(
                f"{where}: 'shape' must be [rows, columns] with two cells at least, "
                f"got {list(self.shape)!r}"
            )
        check_ends(self.ends, ("free", "connected"), self.min_distance, where)
        self.draw(0, np.arange(8))

    def draw(self, seed: int, jobs: np.ndarray) -> RouteScenes:
        """Return the queries of int64[J] jobs.

        Raises:
            BadInputError: a job has no two cells that serve.
        """
        grids = maps_of_jobs(seed, jobs, self.shape, self.density)
        least = self.min_distance / self.cell_size
        place = f"a map of density {self.density:g}"
        starts, goals = draw_ends(seed, jobs, end_groups(grids, self.ends), least, place)
        return RouteScenes(grids, grids, starts, goals)


@dataclass(frozen=True)
class ChartTable:
    """Routes on one map, between two cells that are drawn for each job or given.

    Where both are given, all queries would be the same: there is one episode.

    Attributes:
        map: a packaged map's name (`usvjax maps list`), or a map file.
        cell_size: edge of a cell, m, above 0; required for a plain image, refused otherwise.
        refine: cells are divided into refine x refine by interpolating the shore; 1 or more.
        inflate: routes keep off cells whose centre is this near to a blocked one's, m; 0 or more.
        ends: where start and goal are drawn: "harbours" (cells at the shore of the largest body
            of water; when left out), "connected" (any two cells of one body of water) or "free"
            (any two free cells).
        min_distance: least straight-line distance from start to goal drawn, m; 0 or more.
        start: x and y where the route starts, in the map's metres, such as [62000.0, 38000.0] on
            Hongze Lake; on water that `inflate` leaves; with `goal`, for 1 episode.
        goal: x and y where it ends, likewise, in another cell.
    """

    map: str
    cell_size: float | None = None
    refine: int = 1
    inflate: float = 0.0
    ends: str | None = None
    min_distance: float = 0.0
    start: tuple[float, float] | None = None
    goal: tuple[float, float] | None = None


@dataclass(frozen=True)
class ChartSource(OnChart):
    """Draws the queries of a `ChartTable`.

    Attributes:
        chart: the map.
        table: the `[maps]` table.
    """

    chart: GridMap
    table: ChartTable

    @cached_property
    def water(self) -> GridMap:
        """The map that routes are sought on."""
        return inflated(self.chart, self.table.inflate)

    @cached_property
    def groups(self) -> np.ndarray:
        """int32[1, H, W]: 0 where no route ends; cells of one number may be joined."""
        return end_groups(self.water.blocked[None], self.ends)

    @property
    def ends(self) -> str:
        """Where start and goal are drawn."""
        return ENDS_DRAWN if self.table.ends is None else self.table.ends

    @property
    def most_jobs(self) -> int | None:
        """One where start and goal are given; any number can be drawn."""
        return None if self._given is None else 1

    @property
    def _given(self) -> np.ndarray | None:
        """Cells of the start and the goal that are given, int32[2, 2]; None where they are not."""
        start, goal = self.table.start, self.table.goal
        if start is None or goal is None:
            return None
        return self.chart.cells_of([start, goal]).astype(np.int32)

    def check(self, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        check_length("inflate", self.table.inflate, where)
        check_both_ends(self.table.start, self.table.goal, where)
        if self.table.start is not None and self.table.goal is not None:
            self._check_given(self.table.start, self.table.goal, where)
            return
        check_ends(self.ends, ENDS, self.table.min_distance, where)
        self.draw(0, np.arange(8))

    def _check_given(
        self, start: tuple[float, float], goal: tuple[float, float], where: str
    ) -> None:
        drawn = {"ends": self.table.ends, "min_distance": self.table.min_distance}
        check_only_drawn(drawn, "'start'", where)
        check_on_water(named_points(start=start, goal=goal), self.water, where)
        if (self.chart.cells_of(start) == self.chart.cells_of(goal)).all():
            raise BadInputError(
                f"{where}: 'start' {list(start)!r} and 'goal' {list(goal)!r} lie in one cell"
            )

    def draw(self, seed: int, jobs: np.ndarray) -> RouteScenes:
        """Return the queries of int64[J] jobs.

        Raises:
            BadInputError: a job has no two cells that serve.
        """
        if self._given is not None:
            starts, goals = (np.repeat(cell[None], len(jobs), axis=0) for cell in self._given)
        else:
            least = self.table.min_distance / self.cell_size
            starts, goals = draw_ends(seed, jobs, self.groups, least, repr(self.table.map))
        return RouteScenes(self.water.blocked, self.chart.blocked, starts, goals)


@dataclass(frozen=True)
class ScenTable:
    """The queries of a MovingAI scenario file, in an order drawn from the seed.

    The file sorts them by length, so a study of its first hundred lines would be one of the
    shortest; job j of a study is the j-th of a random order of all lines instead.

    Attributes:
        scen: the scenario file. The lengths that it gives are checked: a study ends where ours
            differs under the same rules; 0 between two cells says that it is not known.
        map: the map file; the one that the scenario file names, beside it, when left out.
        cell_size: edge of a cell, m; above 0.
    """

    scen: str
    map: str | None = None
    cell_size: float = 1.0


@dataclass(frozen=True)
class ScenSource(OnChart):
    """Draws the queries of a `ScenTable`.

    Attributes:
        chart: the map.
        table: the `[maps]` table.
        scen: the scenario file, read.
    """

    chart: GridMap
    table: ScenTable
    scen: Scen

    @property
    def most_jobs(self) -> int:
        """How many queries the file has."""
        return len(self.scen)

    def check(self, where: str) -> None:
        """Nothing is left to check: the file was when it was read."""

    def draw(self, seed: int, jobs: np.ndarray) -> RouteScenes:
        """Return the queries of int64[J] jobs."""
        scen, grid = self.scen, self.chart.blocked
        rows = scen.rows_of(seed, jobs)
        return RouteScenes(grid, grid, scen.starts[rows], scen.goals[rows], scen.lengths[rows])


Source = CellTable | ChartSource | ScenSource
"""What draws the queries of a condition."""


def opened(table: CellTable | ChartTable | ScenTable, folder: Path, where: str) -> Opened[Source]:
    """What a `[maps]` table asks for, with its files read; see `usvjax.maps.tables.read_maps`."""
    if isinstance(table, CellTable):
        return Opened(table, table)
    if isinstance(table, ChartTable):
        if table.start is None and table.ends is None:
            table = replace(table, ends=ENDS_DRAWN)
        return on_chart(table, ChartSource, folder, where)
    with saying_where(where):
        scen = read_scen(table.scen, table.map, table.cell_size, folder, where)
        lines = hashlib.sha256(read_bytes(folder / table.scen)).hexdigest()
    inputs = {table.scen: lines, scen.chart.name: map_digest(scen.chart)}
    return Opened(table, ScenSource(scen.chart, table, scen), inputs)
