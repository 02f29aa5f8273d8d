"""The mission "cruise": methods of visiting several stations in water that changes.

`[maps]` says where cruises take place, `[cruise]` holds what happens under way. Methods are the
keys of `usvjax.missions.cruise.methods.METHODS`.
"""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from usvjax.errors import saying_where
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
from usvjax.missions.cruise.methods import (
    METHODS,
    OPTION_KEYS,
    CruiseCase,
    CruisePosed,
    check_options,
    first_map,
    pose,
    read_options,
    sail,
    tour_lengths,
)
from usvjax.missions.cruise.params import CruiseParams, CruiseStatic
from usvjax.missions.cruise.result import CruiseResult
from usvjax.missions.cruise.scenes import CellTable, ChartTable, opened
from usvjax.sections import Table
from usvjax.tables import field_names
from usvkernels.status import CRUISE_ENDINGS, Status

_SOURCES = {"random": CellTable, "grid": ChartTable}


class CruiseMission:
    """Sail cruises; see `usvjax.mission.Mission`."""

    tables = MappingProxyType(
        {
            "maps": Table(
                "where cruises take place",
                _SOURCES,
                choice="source",
                default="random",
                examples={"map": "hongze-250"},
            ),
            "cruise": Table(
                "what happens under way",
                {"": (CruiseParams, CruiseStatic)},
                without=tuple(set(field_names(CruiseParams, CruiseStatic)) - set(OPTION_KEYS)),
            ),
        }
    )
    methods = MappingProxyType({name: method.words for name, method in METHODS.items()})
    metrics = (
        Metric("tour_length", "m", "Tour length"),
        Metric("length", "m", "Track length"),
        Metric("smooth_length", "m", "Smoothed length"),
        Metric("time", "s", "Time"),
        Metric("smooth_time", "s", "Smoothed time"),
        Metric("inflections", "", "Inflections", integer=True),
        Metric("smooth_inflections", "", "Smoothed inflections", integer=True),
        Metric("waits", "", "Waits", integer=True),
        Metric("skipped", "", "Stations skipped", integer=True, summarised=False, counted=True),
        Metric("expanded", "", "Expanded"),
        Metric("replanned", "", "Replanned", integer=True),
    )
    endings = CRUISE_ENDINGS

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Check one condition; see `Mission.case`."""
        place = files.table("maps")
        maps, source, inputs = read_maps(
            tables["maps"], self.tables["maps"], opened, files.folder, place, files.kept
        )
        with saying_where(place):
            source.check(place)
        options = read_options(tables["cruise"], files.table("cruise"))
        with saying_where(files.table("cruise")):
            refusals = check_options(source, options)
        in_force = {"maps": maps, "cruise": options.table()}
        return Case(in_force, inputs, CruiseCase(source, options), refusals=refusals)

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> list[CruisePosed]:
        """Draw maps and stations, in parts whose jobs follow one another; see `Mission.pose`."""
        given: CruiseCase = case.given
        parts = np.split(jobs, np.flatnonzero(np.diff(jobs) != 1) + 1)
        return [pose(given.source, given.options, seed, part) for part in parts]

    def run(self, scene: list[CruisePosed], method: str, record: bool = False) -> Outcome:
        """Sail cruises; see `Mission.run`."""
        sailed = [sail(posed, method) for posed in scene]
        parts = [
            _columns(posed, cruises, method, self.metrics)
            for posed, cruises in zip(scene, sailed, strict=True)
        ]
        columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        return Outcome(columns, _recorded(scene, sailed) if record else None)

    def example(self, rows: Any, methods: list[str]) -> tuple[int, str]:
        """The cruise to show; see `Mission.example`."""
        from usvjax.plots.examples import median_job

        what = "cruise that every method completed"
        return median_job(rows, methods[0], "smooth_length", Status.REACHED, what)

    def figures(self, run: Any, replay: Replay) -> Iterator[tuple[str, Any]]:
        """Draw a run; see `Mission.figures`."""
        from usvjax.missions.cruise.figures import cruise_figures

        return cruise_figures(run, replay)

    def film(self, replayed: Replayed, row: int) -> Any:
        """A vessel on its cruise; see `Mission.film`."""
        from usvjax.plots.tracks import film_of

        return film_of(replayed, row)


MISSION = CruiseMission()


def _columns(
    posed: CruisePosed, sailed: CruiseResult, method: str, metrics: tuple[Metric, ...]
) -> dict[str, np.ndarray]:
    """Status and metrics, array[J] each."""
    columns = {
        "status": sailed.status,
        "tour_length": tour_lengths(posed.legs, posed.order(method)),
        "skipped": np.count_nonzero(~sailed.visited, axis=1),
    }
    others = {m.name: getattr(sailed, m.name) for m in metrics if m.name not in columns}
    return {**columns, **others}


def _recorded(scene: list[CruisePosed], sailed: list[CruiseResult]) -> Recording:
    """The tracks from cell to cell; the detail is the cruises of each part."""
    grounds, tracks = [], []
    for posed, cruises in zip(scene, sailed, strict=True):
        for row, steps in enumerate(cruises.steps):
            grid = first_map(posed, row)
            stations = grid.points_of(posed.scenes.stations[row])
            marks = {"home": stations[:1], "station": stations[1:]}
            grounds.append(Ground(grid, np.empty((0, 2)), 0.0, marks))
            places = grid.points_of(cruises.track[row, : steps + 1])
            step = np.hypot(*np.diff(places, axis=0).T)
            time = np.where(step > 0, step, grid.cell_size) / float(posed.options.params.speed)
            tracks.append(Track(np.append(0.0, np.cumsum(time)), "s", places[:, None]))
    return Recording(tuple(grounds), tuple(tracks), sailed)
