"""The mission "route": methods of path planning on the same queries.

`[maps]` says where routes are sought, `[search]` holds the settings of the searches, `[smoothing]`
those of what is done to their paths. Methods are the keys of `usvjax.missions.route.run.METHODS`.
"""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from usvjax.errors import BadInputError
from usvjax.maps.scen import ROUNDING
from usvjax.maps.tables import read_maps
from usvjax.mission import (
    Case,
    Files,
    Ground,
    Metric,
    Outcome,
    Recording,
    Replay,
    Replayed,
    Track,
)
from usvjax.missions.route.posed import RouteCase, RoutePosed
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
    ChartTable,
    RouteScenes,
    ScenTable,
    opened,
)
from usvjax.sections import Table
from usvjax.tables import read_table
from usvkernels.status import Status

_SOURCES = {"random": CellTable, "grid": ChartTable, "movingai": ScenTable}


class RouteMission:
    """Find routes; see `usvjax.mission.Mission`."""

    tables = MappingProxyType(
        {
            "maps": Table(
                "where routes are sought",
                _SOURCES,
                choice="source",
                default="random",
                examples={"map": "hongze-250", "scen": "my.scen"},
            ),
            "search": Table("settings of the searches", {"": SearchOptions}),
            "smoothing": Table("what is done to their paths", {"": SmoothingOptions}),
        }
    )
    methods = MappingProxyType({name: method.words for name, method in METHODS.items()})
    metrics = (
        Metric("path_length", "m", "Path length"),
        Metric("ratio", "", "Length / shortest"),
        Metric("cost", "m", "With turn cost"),
        Metric("turns", "", "Turns", integer=True),
        Metric("sharp_turns", "", "Sharp turns", integer=True),
        Metric("sailable", "", "Sailable (share)", integer=True, share=True),
        Metric("turning", "rad", "Turning"),
        Metric("min_clearance", "m", "Min clearance"),
        Metric("expanded", "", "Expanded", integer=True),
    )
    endings = ENDINGS

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Check one condition; see `Mission.case`."""
        place = files.table("maps")
        maps, source, inputs = read_maps(
            tables["maps"], self.tables["maps"], opened, files.folder, place, files.kept
        )
        source.check(place)
        search = read_table(SearchOptions, tables["search"], files.table("search"))
        smoothing = read_table(SmoothingOptions, tables["smoothing"], files.table("smoothing"))
        longest = source.cell_size * max(source.shape)
        check_options(
            search, smoothing, longest, lambda table, key: f"{files.table(table)}: {key!r}"
        )
        if smoothing.turning_radius is None:
            smoothing = replace(smoothing, turning_radius=source.cell_size)
        in_force = {
            "maps": maps,
            "search": asdict(search),
            "smoothing": asdict(smoothing),
        }
        given = RouteCase(source, search, smoothing)
        return Case(in_force, inputs, given, source.most_jobs)

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> RoutePosed:
        """Draw queries and find their shortest routes; see `Mission.pose`."""
        given: RouteCase = case.given
        scenes = given.source.draw(seed, jobs)
        shortest = find_paths(scenes, replace(given.search, max_expansions=None), "astar")
        same_rules = given.search.connectivity == 8 and not given.search.corner_cutting
        if scenes.published is not None and same_rules:
            _check_published(scenes.published, scenes, shortest.cost)
        area = Area(scenes, given.source.cell_size, given.source.origin)
        return RoutePosed(given, area, shortest, shortest.cost * given.source.cell_size)

    def run(self, scene: RoutePosed, method: str, record: bool = False) -> Outcome:
        """Find routes; see `Mission.run`."""
        routes, optimum = _routes(scene, method), scene.optimum
        columns = {m.name: getattr(routes, m.name) for m in self.metrics if m.name != "ratio"}
        # A route from a cell to itself is as short as can be.
        one = np.ones(len(optimum))
        ratio = np.divide(routes.path_length, optimum, out=one, where=optimum != 0.0)
        recording = _recorded(scene, routes) if record else None
        return Outcome({"status": routes.status, "ratio": ratio, **columns}, recording)

    def example(self, rows: Any, methods: list[str]) -> tuple[int, str]:
        """The query to show; see `Mission.example`."""
        from usvjax.plots.examples import median_job

        what = "query that every method solved"
        return median_job(rows, methods[0], "path_length", Status.FOUND, what)

    def figures(self, run: Any, replay: Replay) -> Iterator[tuple[str, Any]]:
        """Draw a run; see `Mission.figures`."""
        from usvjax.missions.route.figures import route_figures

        return route_figures(run, replay)

    def film(self, replayed: Replayed, row: int) -> Any:
        """A vessel along a route; see `Mission.film`."""
        from usvjax.plots.tracks import film_of

        return film_of(replayed, row)


MISSION = RouteMission()


def _check_published(lengths: np.ndarray, scenes: RouteScenes, found: np.ndarray) -> None:
    """Refuse published lengths of shortest routes, float64[J], cells, that are none; 0 is unknown.

    Raises:
        BadInputError: a shortest route has another length.
    """
    wrong = (lengths > 0.0) & ~(np.abs(lengths - found) <= ROUNDING * found)
    wrong |= (lengths > 0.0) & np.isinf(found)
    if wrong.any():
        row = int(np.argmax(wrong))
        start, goal = scenes.starts[row].tolist(), scenes.goals[row].tolist()
        raise BadInputError(
            f"the scenario file says that the shortest route from {start} to {goal} is "
            f"{lengths[row]:.9g} cells long, but on this map it is {found[row]:.9g}; wanted the "
            f"same, or 0 where it is not known"
        )


def _routes(scene: RoutePosed, method: str) -> Routes:
    """Find the routes; the plain search has been done."""
    search, smoothing = scene.case.search, scene.case.smoothing
    found = scene.shortest
    if not METHODS[method].is_plain or search.max_expansions is not None:
        found = find_paths(scene.area.scenes, search, method)
    return finish_routes(found, scene.area, method, search, smoothing)


def _recorded(scene: RoutePosed, routes: Routes) -> Recording:
    grounds, tracks = [], []
    scenes = scene.area.scenes
    for row, count in enumerate(routes.counts):
        grid = scene.land(row)
        ends = {"start": scenes.starts, "goal": scenes.goals}
        marks = {name: grid.points_of(cells[row, None]) for name, cells in ends.items()}
        grounds.append(Ground(grid, np.empty((0, 2)), 0.0, marks))
        # Where there is no route, the vessel stays at the start.
        places = routes.points[row, :count] if count else marks["start"]
        steps = np.hypot(*np.diff(places, axis=0).T)
        tracks.append(Track(np.append(0.0, np.cumsum(steps)), "m", places[:, None]))
    return Recording(tuple(grounds), tuple(tracks), routes)
