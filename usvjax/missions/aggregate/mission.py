"""The mission "aggregate": strategies by which vessels meet each other as they form up.

`[scenes]` says where fleets begin, `[formation]` how they are to lie, `[params]` holds
`AggregateParams` and `[static]` `AggregateStatic`. Methods are those of the mission "fleet". Who
has arrived, but does not hold slots and heading at rest, ends as STUCK.
"""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from usvjax.errors import saying_where
from usvjax.maps.chart import on_chart
from usvjax.maps.tables import Opened, read_maps
from usvjax.mission import Case, Files, Metric, Outcome, Replay, Replayed
from usvjax.missions.aggregate.params import AggregateParams, AggregateStatic
from usvjax.missions.aggregate.run import AggregateResult, Muster, gather, muster
from usvjax.missions.aggregate.scenes import (
    FormationTable,
    Gatherings,
    LakeSource,
    LakeTable,
    SquareTable,
    lanes_of,
)
from usvjax.missions.fleet.mission import FleetMission, Posed, read_numbers, recorded
from usvjax.sections import Table
from usvjax.tables import read_table
from usvkernels.status import AGGREGATE_ENDINGS, Status

_SOURCES = {"square": SquareTable, "grid": LakeTable}

Source = SquareTable | LakeSource
"""What draws the scenes of a condition."""


@dataclass(frozen=True)
class AggregateCase:
    """One condition.

    Attributes:
        source: draws the scenes.
        formation: in which fleets gather.
        params, static: of the fleets.
    """

    source: Source
    formation: FormationTable
    params: AggregateParams
    static: AggregateStatic


@dataclass(frozen=True)
class AggregatePosed(Posed):
    """Fleets that every strategy lets gather.

    Attributes:
        formation: in which.
    """

    scenes: Gatherings
    formation: FormationTable

    @cached_property
    def musters(self) -> tuple[Muster, ...]:
        """The fleets with their slots and ways, some at a time, the same for all strategies."""
        return tuple(self._mustered(rows) for rows in self.parts)

    def _mustered(self, rows: slice) -> Muster:
        scenes, table = self.scenes, self.formation
        return muster(
            scenes.water_of(rows),
            scenes.starts[rows],
            scenes.centres[rows],
            scenes.headings[rows],
            table.formation,
            table.spacing,
            table.assignment,
            table.hold_time,
            None,
            None,
            self.params,
            self.static,
        )


class AggregateMission(FleetMission):
    """Let fleets gather; see `usvjax.mission.Mission`."""

    tables = MappingProxyType(
        {
            "scenes": Table(
                "where fleets begin, and what is in their way",
                _SOURCES,
                choice="source",
                default="square",
                examples={"map": "hongze-250"},
            ),
            "formation": Table("how fleets are to lie", {"": FormationTable}),
            "params": Table("numbers of vessels, method and strategies", {"": AggregateParams}),
            "static": Table("sizes and choices of method", {"": AggregateStatic}),
        }
    )
    metrics = (
        Metric("formed", "", "Formed (share)", summarised=False, counted=True),
        Metric("formed_time", "s", "Formed after"),
        Metric("heading_error", "deg", "Heading error"),
        Metric("formation_error", "m", "Formation error"),
        Metric("min_separation", "m", "Min separation"),
        Metric("min_clearance", "m", "Min clearance"),
        Metric("time", "s", "Time"),
        Metric("path_length", "m", "Path length"),
    )
    endings = AGGREGATE_ENDINGS

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Check one condition; see `Mission.case`."""
        place, where = files.table("scenes"), files.table("formation")
        scenes, source, inputs = read_maps(
            tables["scenes"], self.tables["scenes"], opened, files.folder, place, files.kept
        )
        formation = read_table(FormationTable, tables["formation"], where)
        params, static = read_numbers(AggregateParams, AggregateStatic, tables, files)
        formation.check(where)
        source.check(params, place)
        given = AggregateCase(source, formation, params, static)
        with saying_where(files.where):
            assert _posed(given, 0, np.arange(2)).musters
        in_force = {"scenes": scenes} | {
            name: asdict(table)
            for name, table in (("formation", formation), ("params", params), ("static", static))
        }
        return Case(in_force, inputs, given, source.most_jobs)

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> AggregatePosed:
        """Draw fleets; see `Mission.pose`."""
        return _posed(case.given, seed, jobs)

    def run(self, scene: Any, method: str, record: bool = False) -> Outcome:
        """Let fleets gather; see `Mission.run`."""
        found = [gather(each, scene.static, method, record) for each in scene.musters]
        columns = [_columns(part) for part in found]
        whole = {name: np.concatenate([part[name] for part in columns]) for name in columns[0]}
        slots = {"slot": np.concatenate([part.slots for part in found])}
        return Outcome(whole, recorded(scene, found, slots) if record else None)

    def figures(self, run: Any, replay: Replay) -> Iterator[tuple[str, Any]]:
        """Draw a run; see `Mission.figures`."""
        from usvjax.missions.aggregate.figures import aggregate_figures

        return aggregate_figures(run, replay)

    def film(self, replayed: Replayed, row: int) -> Any:
        """Vessels with their hulls to scale, and their slots; see `Mission.film`."""
        from usvjax.missions.aggregate.figures import aggregate_film

        return aggregate_film(replayed, row)


MISSION = AggregateMission()


def opened(table: SquareTable | LakeTable, folder: Path, where: str) -> Opened[Source]:
    """What a `[scenes]` table asks for, with its map read; see `usvjax.maps.tables.read_maps`."""
    if isinstance(table, LakeTable):
        return on_chart(table, LakeSource, folder, where)
    return Opened(table, table)


def _posed(given: AggregateCase, seed: int, jobs: np.ndarray) -> AggregatePosed:
    vessels = given.source.vessels
    length = given.static.guide_length
    lanes = lanes_of(given.formation, vessels, seed, jobs, given.params, length)
    scenes = given.source.gather(seed, jobs, given.params, lanes)
    return AggregatePosed(scenes, given.params, given.static, given.formation)


def _columns(found: AggregateResult) -> dict[str, np.ndarray]:
    """Status and metrics, array[J] each."""
    # Who arrived, and then swung off its heading or place as it stopped, has not formed up.
    loose = (found.status == int(Status.REACHED)) & ~found.formed
    return {
        "status": np.where(loose, int(Status.STUCK), found.status).astype(found.status.dtype),
        "formed": found.formed.astype(np.float32),
        "formed_time": found.formed_time,
        # NaN where a vessel did not come to its slot.
        "heading_error": np.degrees(found.heading_error.max(axis=1)),
        "formation_error": found.formation_error,
        "min_separation": found.min_separation,
        "min_clearance": found.min_clearance.min(axis=1),
        "time": found.time,
        "path_length": found.path_length.astype(np.float64).mean(axis=1),
    }
