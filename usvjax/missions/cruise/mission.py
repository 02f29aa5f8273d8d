"""Studies of kind "cruise": methods of visiting several stations in water that changes.

`[maps]` says where cruises take place (`source = "random"` or "grid"), `[cruise]` holds what
happens under way. Methods are the keys of `usvjax.missions.cruise.methods.METHODS`.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from enum import IntEnum
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from usvjax.errors import saying_where
from usvjax.maps.chart import read_chart
from usvjax.maps.tables import read_source
from usvjax.mission import LastShard, Metric, Prepared
from usvjax.missions.cruise.methods import (
    METHODS,
    CruiseOptions,
    Posed,
    check_options,
    pose,
    sail,
    tour_lengths,
)
from usvjax.missions.cruise.scenes import STATIONS, CellTable, ChartSource, ChartTable, Source
from usvjax.sections import Sections
from usvjax.study.spec import Condition, StudySpec
from usvjax.tables import field_names, read_table
from usvkernels.status import CRUISE_ENDINGS, Status

Table = CellTable | ChartTable

_SOURCES: dict[str, type[Table]] = {"random": CellTable, "grid": ChartTable}


@dataclass(frozen=True)
class CruiseCondition:
    """One condition of a study of cruises.

    Attributes:
        source: draws the maps and stations.
        options: of the cruises.
    """

    source: Source
    options: CruiseOptions


class CruiseWorkload:
    """Sail cruises for a study; see `usvjax.mission.Workload`."""

    sections: Sections = MappingProxyType(
        {
            "maps": ("source", *field_names(*_SOURCES.values())),
            "cruise": field_names(CruiseOptions),
        }
    )
    methods: tuple[str, ...] = tuple(METHODS)
    metrics: tuple[Metric, ...] = (
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
    endings: tuple[IntEnum, ...] = CRUISE_ENDINGS
    success: IntEnum = Status.REACHED

    def __init__(self) -> None:
        self._last: LastShard[list[Posed]] = LastShard()

    def prepare(
        self, settings: Mapping[str, Mapping[str, Any]], folder: Path, where: str
    ) -> Prepared:
        """Check one condition; see `Workload.prepare`."""
        place = f"{where}: [maps]"
        name, table, source, inputs = _read_maps(settings["maps"], folder, place)
        with saying_where(place):
            source.check(place)
        options = read_table(CruiseOptions, settings["cruise"], f"{where}: [cruise]")
        with saying_where(f"{where}: [cruise]"):
            refusals = check_options(source, options)
        in_force = {"maps": {"source": name, **asdict(table)}, "cruise": asdict(options)}
        payload = CruiseCondition(source, options)
        return Prepared(in_force, inputs, payload, refusals=refusals)

    def run(
        self, spec: StudySpec, condition: Condition, method: str, jobs: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Sail cruises; see `Workload.run`."""
        parts = [
            _columns(posed, method, self.metrics)
            for posed in self._posed(condition.payload, spec.seed, jobs)
        ]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def _posed(self, given: CruiseCondition, seed: int, jobs: np.ndarray) -> list[Posed]:
        """The cruises of jobs, in parts whose jobs follow one another."""

        def drawn() -> list[Posed]:
            parts = np.split(jobs, np.flatnonzero(np.diff(jobs) != 1) + 1)
            return [pose(given.source, given.options, seed, part) for part in parts]

        return self._last.get(given, seed, jobs, drawn)


def _columns(posed: Posed, method: str, metrics: tuple[Metric, ...]) -> dict[str, np.ndarray]:
    """Status and metrics, array[J] each."""
    sailed = sail(posed, method)
    columns = {
        "status": sailed.status,
        "tour_length": tour_lengths(posed.legs, posed.order(method)),
        "skipped": np.count_nonzero(~sailed.visited, axis=1),
    }
    others = {m.name: getattr(sailed, m.name) for m in metrics if m.name not in columns}
    return {**columns, **others}


def _read_maps(
    table: Mapping[str, Any], folder: Path, where: str
) -> tuple[str, Table, Source, dict[str, str]]:
    """Read `[maps]`: the source's name, its options, the source, and digests of its inputs."""
    name, options = read_source(table, _SOURCES, "random", where)
    if isinstance(options, CellTable):
        return name, options, options, {}
    if options.stations is None and options.places is None:
        options = replace(options, stations=STATIONS)
    grid, digest = read_chart(options.map, options.cell_size, options.refine, folder, where)
    return name, options, ChartSource(grid, options), {options.map: digest}
