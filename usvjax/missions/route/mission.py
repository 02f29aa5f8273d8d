"""Studies of kind "route": methods of path planning on the same queries.

`[maps]` says where routes are sought (`source = "random"`, "grid" or "movingai"), `[search]` holds
the settings of the searches, `[smoothing]` those of what is done to their paths. Methods are the
keys of `usvjax.missions.route.run.METHODS`.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from enum import IntEnum
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from usvjax.errors import saying_where
from usvjax.maps.chart import map_digest, read_chart
from usvjax.maps.disk import read_bytes
from usvjax.maps.tables import read_source
from usvjax.mission import LastShard, Metric, Prepared
from usvjax.missions.route.run import (
    ENDINGS,
    METHODS,
    Area,
    Routes,
    SearchOptions,
    SmoothingOptions,
    check_options,
    find_paths,
    finish_routes,
)
from usvjax.missions.route.scenes import (
    CellTable,
    ChartSource,
    ChartTable,
    ScenTable,
    Source,
    scen_source,
)
from usvjax.search.astar import AstarResult
from usvjax.sections import Sections
from usvjax.study.spec import Condition, StudySpec
from usvjax.tables import field_names, read_table
from usvkernels.status import Status

Table = CellTable | ChartTable | ScenTable

_SOURCES: dict[str, type[Table]] = {
    "random": CellTable,
    "grid": ChartTable,
    "movingai": ScenTable,
}


@dataclass(frozen=True)
class RouteCondition:
    """One condition of a route study.

    Attributes:
        source: draws the queries.
        search: settings of the searches.
        smoothing: settings of what is done to their paths.
    """

    source: Source
    search: SearchOptions
    smoothing: SmoothingOptions

    @property
    def turning_radius(self) -> float:
        """R, m; the edge of a cell where none was given."""
        return self.smoothing.turning_radius or self.source.cell_size


@dataclass(frozen=True)
class _Posed:
    """What all methods of a shard share.

    Attributes:
        area: the queries.
        shortest: the search for the shortest routes.
        optimum: float64[J], their lengths, m; inf where there is none.
    """

    area: Area
    shortest: AstarResult
    optimum: np.ndarray


class RouteWorkload:
    """Find routes for a study; see `usvjax.mission.Workload`."""

    sections: Sections = MappingProxyType(
        {
            "maps": ("source", *field_names(*_SOURCES.values())),
            "search": field_names(SearchOptions),
            "smoothing": field_names(SmoothingOptions),
        }
    )
    methods: tuple[str, ...] = tuple(METHODS)
    metrics: tuple[Metric, ...] = (
        Metric("path_length", "m", "Path length"),
        Metric("ratio", "", "Length / shortest"),
        Metric("cost", "m", "With turn cost"),
        Metric("turns", "", "Turns", integer=True),
        Metric("sharp_turns", "", "Sharp turns", integer=True),
        Metric("sailable", "", "Sailable (share)", integer=True),
        Metric("turning", "rad", "Turning"),
        Metric("min_clearance", "m", "Min clearance"),
        Metric("expanded", "", "Expanded", integer=True),
    )
    endings: tuple[IntEnum, ...] = ENDINGS
    success: IntEnum = Status.FOUND

    def __init__(self) -> None:
        self._last: LastShard[_Posed] = LastShard()

    def prepare(
        self, settings: Mapping[str, Mapping[str, Any]], folder: Path, where: str
    ) -> Prepared:
        """Check one condition; see `Workload.prepare`."""
        place = f"{where}: [maps]"
        name, options, source, inputs = _read_maps(settings["maps"], folder, place)
        source.check(place)
        search = read_table(SearchOptions, settings["search"], f"{where}: [search]")
        smoothing = read_table(SmoothingOptions, settings["smoothing"], f"{where}: [smoothing]")
        longest = source.cell_size * max(source.shape)
        check_options(search, smoothing, longest, lambda table, key: f"{where}: [{table}]: {key!r}")
        if smoothing.turning_radius is None:
            smoothing = replace(smoothing, turning_radius=source.cell_size)
        in_force = {
            "maps": {"source": name, **asdict(options)},
            "search": asdict(search),
            "smoothing": asdict(smoothing),
        }
        payload = RouteCondition(source, search, smoothing)
        return Prepared(in_force, inputs, payload, source.most_jobs)

    def run(
        self, spec: StudySpec, condition: Condition, method: str, jobs: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Find routes; see `Workload.run`."""
        routes, optimum = self.routes(condition.payload, spec.seed, method, jobs)
        columns = {m.name: getattr(routes, m.name) for m in self.metrics if m.name != "ratio"}
        # A route from a cell to itself is as short as can be.
        ratio = np.divide(routes.path_length, optimum, out=np.ones(len(jobs)), where=optimum != 0.0)
        return {"status": routes.status, "ratio": ratio, **columns}

    def routes(
        self, given: RouteCondition, seed: int, method: str, jobs: np.ndarray
    ) -> tuple[Routes, np.ndarray]:
        """Find the routes of some jobs with one method.

        Args:
            given: the payload of a condition.
            seed: of the study.
            method: a key of `METHODS`.
            jobs: int64[J].

        Returns:
            The routes, and float64[J], the lengths of the shortest ones, m.
        """
        posed = self._last.get(given, seed, jobs, lambda: _pose(given, seed, jobs))
        found = posed.shortest
        if not METHODS[method].is_plain or given.search.max_expansions is not None:
            found = find_paths(posed.area.scenes, given.search, method)
        routes = finish_routes(found, posed.area, method, given.search, given.smoothing)
        return routes, posed.optimum


def _pose(given: RouteCondition, seed: int, jobs: np.ndarray) -> _Posed:
    source = given.source
    scenes = source.draw(seed, jobs)
    without_bound = replace(given.search, max_expansions=None)
    shortest = find_paths(scenes, without_bound, "astar")
    lengths = shortest.cost
    same_rules = given.search.connectivity == 8 and not given.search.corner_cutting
    if scenes.published is not None and same_rules:
        lengths = scenes.published
    area = Area(scenes, source.cell_size, source.origin)
    return _Posed(area, shortest, lengths * source.cell_size)


def _read_maps(
    table: Mapping[str, Any], folder: Path, where: str
) -> tuple[str, Table, Source, dict[str, str]]:
    """Read `[maps]`: the source's name, its options, the source, and digests of its inputs."""
    name, options = read_source(table, _SOURCES, "random", where)
    if isinstance(options, CellTable):
        return name, options, options, {}
    if isinstance(options, ChartTable):
        grid, digest = read_chart(options.map, options.cell_size, options.refine, folder, where)
        return name, options, ChartSource(grid, options), {options.map: digest}
    with saying_where(where):
        source = scen_source(options, folder, where)
        lines = hashlib.sha256(read_bytes(folder / options.scen)).hexdigest()
    inputs = {options.scen: lines, source.chart.name: map_digest(source.chart)}
    return name, options, source, inputs
