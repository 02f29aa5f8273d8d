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
    """Random maps, each cell blocked with the same probability, with random or given stations.

    Attributes:
        shape: rows and columns, cells; 3 or more each.
        density: probability that a cell is blocked, in [0, 1].
        cell_size: edge of a cell, m; above 0.
        stations: number of stations drawn for each cruise, home included; 2 to 200, 20 when left
            out. One map whose largest water has no room for them ends the study. Not with `places`.
        min_distance: least straight-line distance between two stations drawn, m; 0 or more.
        places: x and y of each station in metres from the map's corner, home first, the same for
            every job; 2 to 200 of them. Their cells are free on every map, which may still part
            them. When left out, stations are drawn.
    """

    shape: tuple[int, int] = (50, 50)
    density: float = 0.1
    cell_size: float = 10.0
    stations: int | None = None
    min_distance: float = 0.0
    places: tuple[tuple[float, float], ...] | None = None

    def check(self, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        check_cells(self.shape, self.density, self.cell_size, where)
        if min(self.shape) < 3:
            raise BadInputError(
                f"{where}: 'shape' must be [rows, columns], 3 or more each, "
                f"got {list(self.shape)!r}"
            )
        if self.places is not None:
            drawn = {"stations": self.stations, "min_distance": self.min_distance}
            check_only_drawn(drawn, "'places'", where)
            check_places(self.places, self._open_water, where)
            return
        check_stations(_count(self), self.min_distance, where)
        some_scenes(self)

    @property
    def _open_water(self) -> GridMap:
        """A map without a blocked cell."""
        return GridMap(np.zeros(self.shape, bool), self.cell_size, self.origin)

    def draw(self, seed: int, jobs: np.ndarray) -> CruiseScenes:
        """Return the maps and stations of int64[J] jobs.

        Raises:
            BadInputError: the water of a job has no room for them.
        """
        grids = maps_of_jobs(seed, jobs, self.shape, self.density)
        if self.places is not None:
            given = self._open_water.cells_of(self.places).astype(np.int32)
            grids[:, given[:, 1], given[:, 0]] = False
            return CruiseScenes(grids, _repeated(given, jobs))
        cells = [cells_where(GridMap(grid).largest_component()) for grid in grids]
        least = self.min_distance / self.cell_size
        place = f"the largest water of a map of density {self.density:g}"
        lower = "'stations' or 'min_distance'"
        stations = draw_stations(seed, jobs, cells, _count(self), least, place, lower)
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
        check_stations(_count(self.table), self.table.min_distance, where)
        some_scenes(self)

    def draw(self, seed: int, jobs: np.ndarray) -> CruiseScenes:
        """Return the stations of int64[J] jobs.

        Raises:
            BadInputError: the water has no room for them.
        """
        if self.table.places is not None:
            given = self.chart.cells_of(self.table.places).astype(np.int32)
            return CruiseScenes(self.water.blocked, _repeated(given, jobs))
        least = self.table.min_distance / self.cell_size
        place = f"the largest water of {self.table.map!r}"
        cells = [self.cells] * len(jobs)
        lower = "'stations', 'min_distance', 'shore_distance' or 'inflate'"
        stations = draw_stations(seed, jobs, cells, _count(self.table), least, place, lower)
        return CruiseScenes(self.water.blocked, stations)


def _count(table: CellTable | ChartTable) -> int:
    """How many stations are drawn."""
    return STATIONS if table.stations is None else table.stations


def _repeated(stations: np.ndarray, jobs: np.ndarray) -> np.ndarray:
    """The same stations int32[d, 2] for every job, int32[J, d, 2]."""
    return np.repeat(stations[None], len(jobs), axis=0)


Source = CellTable | ChartSource
"""What draws the maps and stations of a condition."""


@lru_cache(maxsize=1)  # for the checks of [maps] and of [cruise], and the next condition's
def some_scenes(source: Source) -> CruiseScenes:
    """Maps and stations of a few jobs, to try them; errors as `draw`."""
    return source.draw(0, np.arange(8))


def opened(table: CellTable | ChartTable, folder: Path, where: str) -> Opened[Source]:
    """What a `[maps]` table asks for, with its map read; see `usvjax.maps.tables.read_maps`."""
    if table.places is None:
        table = replace(table, stations=_count(table))
    if isinstance(table, CellTable):
        return Opened(table, table)
    return on_chart(table, ChartSource, folder, where)
