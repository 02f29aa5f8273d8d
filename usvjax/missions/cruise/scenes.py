"""Where cruises take place: maps with stations, one set per job.

A table of `[maps]` that names no file draws its scenes itself; that of a chart is drawn from by
`ChartSource`, which has read the map. Job j's stations are a pure function of the seed and j (see
`usvjax.maps.draws`). All stations of a job lie on its map's largest body of water; station 0 is
home.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.maps.cells import OnOwnMaps, check_cells, maps_of_jobs
from usvjax.maps.chart import OnChart, cells_where, inflated, off_shore, on_chart
from usvjax.maps.ends import check_only_drawn
from usvjax.maps.stations import check_places, check_stations, draw_stations
from usvjax.maps.tables import Opened, check_length

STATIONS = 20


@dataclass(frozen=True)
class CruiseScenes:
    """Maps and stations of some jobs, in the order of the jobs.

    Attributes:
        blocked: bool[H, W] shared or bool[J, H, W], what vessels keep off.
        stations: int32[J, d, 2], cells (x, y), home first.
    """

    blocked: np.ndarray
    stations: np.ndarray


@dataclass(frozen=True)
class CellTable(OnOwnMaps):
    """Random maps, each cell blocked with the same probability, with random stations.

    Attributes:
        shape: rows and columns, cells; 3 or more each.
        density: probability that a cell is blocked, in [0, 1].
        cell_size: edge of a cell, m; above 0.
        stations: number of stations of a cruise, home included; 2 to 200. One map whose largest
            water has no room for them ends the study.
        min_distance: least straight-line distance between two stations, m; 0 or more.
    """

    shape: tuple[int, int] = (50, 50)
    density: float = 0.1
    cell_size: float = 10.0
    stations: int = STATIONS
    min_distance: float = 0.0

    def check(self, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        check_cells(self.shape, self.density, self.cell_size, where)
        if min(self.shape) < 3:
            raise BadInputError(
                f"{where}: 'shape' must be [rows, columns], 3 or more each, "
                f"got {list(self.shape)!r}"
            )
        check_stations(self.stations, self.min_distance, where)
        some_scenes(self)

    def draw(self, seed: int, jobs: np.ndarray) -> CruiseScenes:
        """Return the maps and stations of int64[J] jobs.

        Raises:
            BadInputError: the water of a job has no room for them.
        """
        grids = maps_of_jobs(seed, jobs, self.shape, self.density)
        cells = [cells_where(GridMap(grid).largest_component()) for grid in grids]
        least = self.min_distance / self.cell_size
        place = f"the largest water of a map of density {self.density:g}"
        lower = "'stations' or 'min_distance'"
        stations = draw_stations(seed, jobs, cells, self.stations, least, place, lower)
        return CruiseScenes(grids, stations)


@dataclass(frozen=True)
class ChartTable:
    """Stations on one map, given or drawn anew for each job.

    Attributes:
        map: a packaged map's name (`usvjax maps list`), or a map file.
        cell_size: edge of a cell, m, above 0; required for a plain image, refused otherwise.
        refine: cells are divided into refine x refine by interpolating the shore; 1 or more.
        inflate: vessels keep off cells whose centre is this near to a blocked one's, m; 0 or more.
        stations: number of stations drawn for each cruise, home included; 2 to 200, 20 when left
            out. Not with `places`.
        min_distance: least straight-line distance between two stations drawn, m; 0 or more.
        shore_distance: least distance from stations drawn to the nearest blocked cell's centre, m;
            0 or more.
        places: x and y of each station in the map's metres, home first, the same for every job; 2
            to 200 of them. When left out, stations are drawn.
    """

    map: str
    cell_size: float | None = None
    refine: int = 1
    inflate: float = 0.0
    stations: int | None = None
    min_distance: float = 0.0
    shore_distance: float = 0.0
    places: tuple[tuple[float, float], ...] | None = None


@dataclass(frozen=True)
class ChartSource(OnChart):
    """Draws the stations of a `ChartTable`.

    Attributes:
        chart: the map.
        table: the `[maps]` table.
    """

    chart: GridMap
    table: ChartTable

    @cached_property
    def water(self) -> GridMap:
        """The map that cruises are sailed on."""
        return inflated(self.chart, self.table.inflate)

    @cached_property
    def cells(self) -> np.ndarray:
        """int64[N, 2]: (x, y) of the cells where a station may be."""
        far = off_shore(self.chart, self.table.shore_distance)
        return cells_where(self.water.largest_component() & far)

    def check(self, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        for name in ("inflate", "shore_distance"):
            check_length(name, getattr(self.table, name), where)
        if self.table.places is not None:
            names = ("stations", "min_distance", "shore_distance")
            drawn = {name: getattr(self.table, name) for name in names}
            check_only_drawn(drawn, "'places'", where)
            check_places(self.table.places, self.water, where)
            return
        check_stations(self._count, self.table.min_distance, where)
        some_scenes(self)

    def draw(self, seed: int, jobs: np.ndarray) -> CruiseScenes:
        """Return the stations of int64[J] jobs.

        Raises:
            BadInputError: the water has no room for them.
        """
        if self.table.places is not None:
            given = self.chart.cells_of(self.table.places).astype(np.int32)
            return CruiseScenes(self.water.blocked, np.repeat(given[None], len(jobs), axis=0))
        least = self.table.min_distance / self.cell_size
        place = f"the largest water of {self.table.map!r}"
        cells = [self.cells] * len(jobs)
        lower = "'stations', 'min_distance', 'shore_distance' or 'inflate'"
        stations = draw_stations(seed, jobs, cells, self._count, least, place, lower)
        return CruiseScenes(self.water.blocked, stations)

    @property
    def _count(self) -> int:
        return STATIONS if self.table.stations is None else self.table.stations


Source = CellTable | ChartSource
"""What draws the maps and stations of a condition."""


@lru_cache(maxsize=1)  # for the checks of [maps] and of [cruise], and the next condition's
def some_scenes(source: Source) -> CruiseScenes:
    """Maps and stations of a few jobs, to try them; errors as `draw`."""
    return source.draw(0, np.arange(8))


def opened(table: CellTable | ChartTable, folder: Path, where: str) -> Opened[Source]:
    """What a `[maps]` table asks for, with its map read; see `usvjax.maps.tables.read_maps`."""
    if isinstance(table, CellTable):
        return Opened(table, table)
    if table.stations is None and table.places is None:
        table = replace(table, stations=STATIONS)
    return on_chart(table, ChartSource, folder, where)
