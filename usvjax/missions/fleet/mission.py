"""The mission "fleet": strategies by which vessels on routes of their own meet each other.

`[scenes]` says where fleets meet, `[params]` holds `FleetParams` and `[static]` `FleetStatic`.
Methods are the strategies of `usvjax.missions.fleet.params.STRATEGIES`.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

from usvjax.errors import BadInputError, saying_where
from usvjax.maps.chart import on_chart
from usvjax.maps.tables import Opened, read_maps
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
from usvjax.missions.fleet.crowds import ChartSource, ChartTable, CrowdTable
from usvjax.missions.fleet.inputs import Voyage, pack
from usvjax.missions.fleet.params import FleetParams, FleetStatic, check_params
from usvjax.missions.fleet.run import FleetResult, sail
from usvjax.missions.fleet.scenes import EncounterTable, FleetScenes, SwapTable
from usvjax.missions.fleet.situations import ImazuTable
from usvjax.sections import Table
from usvjax.tables import read_table
from usvkernels.status import FLEET_ENDINGS, Status

_SOURCES = {
    "encounters": EncounterTable,
    "imazu": ImazuTable,
    "swap": SwapTable,
    "crowd": CrowdTable,
    "grid": ChartTable,
}

Source = EncounterTable | ImazuTable | SwapTable | CrowdTable | ChartSource
"""What draws the scenes of a condition."""

ROUTES_AT_ONCE = 8192
"""Whose routes are laid in one go: each may need a grid of its own."""


@dataclass(frozen=True)
class FleetCase:
    """One condition.

    Attributes:
        source: draws the scenes.
        params, static: of the fleets.
    """

    source: Source
    params: FleetParams
    static: FleetStatic


@dataclass(frozen=True)
class Posed:
    """Fleets that every strategy meets, wherever they are to go.

    Attributes:
        scenes: where they meet.
        params: with what the scenes draw of them, float64[J, n].
        static: choices of method.
    """

    scenes: FleetScenes
    params: FleetParams
    static: FleetStatic

    @property
    def hulls(self) -> np.ndarray:
        """Radii of the vessels, float64[J, n], m."""
        hulls = np.asarray(self.params.hull_radius, np.float64)
        return np.broadcast_to(hulls, self.scenes.speeds.shape)

    @property
    def parts(self) -> list[slice]:
        """Rows whose routes are laid in one go."""
        count, n = self.scenes.speeds.shape
        each = max(1, ROUTES_AT_ONCE // n)
        return [slice(k, k + each) for k in range(0, count, each)]


class FleetPosed(Posed):
    """Fleets on routes of their own."""

    @cached_property
    def voyages(self) -> tuple[Voyage, ...]:
        """The fleets with their routes, some at a time; all strategies sail the same ones."""
        return tuple(self._packed(rows) for rows in self.parts)

    def _packed(self, rows: slice) -> Voyage:
        scenes = self.scenes
        own = {
            name: value[rows]
            for name, value in vars(self.params).items()
            if isinstance(value, np.ndarray)
        }
        return pack(
            scenes.water_of(rows),
            scenes.starts[rows],
            scenes.goals[rows],
            None,
            None,
            scenes.speeds[rows],
            None,
            None,
            replace(self.params, **own),
            self.static,
        )


class FleetMission:
    """Sail fleets; see `usvjax.mission.Mission`."""

    tables = MappingProxyType(
        {
            "scenes": Table(
                "where fleets meet",
                _SOURCES,
                choice="source",
                default="encounters",
                examples={"map": "hongze-250"},
            ),
            "params": Table("numbers of vessels, method and strategies", {"": FleetParams}),
            "static": Table("sizes and choices of method", {"": FleetStatic}),
        }
    )
    methods = MappingProxyType(
        {
            "none": "each vessel sails as if alone",
            "rules": "the collision regulations, pair by pair",
            "wei2023": "the larger outboard angle goes first (Wei & Zhang 2023)",
            "orca": "reciprocal velocities (van den Berg et al. 2011)",
        }
    )
    metrics = (
        Metric("time", "s", "Time"),
        Metric("path_length", "m", "Path length"),
        Metric("extra_distance", "%", "Extra distance"),
        Metric("delay", "s", "Delay"),
        Metric("min_separation", "m", "Min separation"),
        Metric("min_clearance", "m", "Min clearance"),
        Metric("arrived", "", "Vessels arrived (share)", summarised=False, counted=True),
        Metric("steps", "", "Steps", integer=True, summarised=False),
    )
    endings: tuple[Status, ...] = FLEET_ENDINGS

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Check one condition; see `Mission.case`."""
        place = files.table("scenes")
        scenes, source, inputs = read_maps(
            tables["scenes"], self.tables["scenes"], opened, files.folder, place, files.kept
        )
        params, static = read_numbers(FleetParams, FleetStatic, tables, files)
        source.check(params, place)
        given = FleetCase(source, params, static)
        with saying_where(place):
            _try_scenes(given)
        in_force = {"scenes": scenes, "params": asdict(params), "static": asdict(static)}
        return Case(in_force, inputs, given, source.most_jobs)

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> Posed:
        """Draw fleets; see `Mission.pose`."""
        return _posed(case.given, seed, jobs)

    def run(self, scene: Any, method: str, record: bool = False) -> Outcome:
        """Sail fleets; see `Mission.run`."""
        parts = [(v, sail(v, scene.static, method, record)) for v in scene.voyages]
        columns = [_columns(found, voyage) for voyage, found in parts]
        whole = {name: np.concatenate([part[name] for part in columns]) for name in columns[0]}
        results = [found for _, found in parts]
        recording = recorded(scene, results, {"goal": scene.scenes.goals}) if record else None
        return Outcome(whole, recording)

    def example(self, rows: Any, methods: list[str]) -> tuple[int, str]:
        """The fleet to show; see `Mission.example`."""
        from usvjax.missions.fleet.figures import telling_job

        return telling_job(rows, methods)

    def figures(self, run: Any, replay: Replay) -> Iterator[tuple[str, Any]]:
        """Draw a run; see `Mission.figures`."""
        from usvjax.missions.fleet.figures import fleet_figures

        return fleet_figures(run, replay)

    def film(self, replayed: Replayed, row: int) -> Any:
        """Vessels with their hulls to scale; see `Mission.film`."""
        from usvjax.missions.fleet.figures import fleet_film

        return fleet_film(replayed, row)


MISSION = FleetMission()


def opened(
    table: EncounterTable | ImazuTable | SwapTable | CrowdTable | ChartTable,
    folder: Path,
    where: str,
) -> Opened[Source]:
    """What a `[scenes]` table asks for, with its map read; see `usvjax.maps.tables.read_maps`."""
    if isinstance(table, ChartTable):
        return on_chart(table, ChartSource, folder, where)
    return Opened(table, table)


P = TypeVar("P", bound=FleetParams)
S = TypeVar("S", bound=FleetStatic)


def read_numbers(
    params: type[P], static: type[S], tables: Mapping[str, Mapping[str, Any]], files: Files
) -> tuple[P, S]:
    """Read and check `[params]` and `[static]` of a condition, as of these classes."""
    numbers = read_table(params, tables["params"], files.table("params"))
    choices = read_table(static, tables["static"], files.table("static"))
    with saying_where(files.where):
        check_params(numbers, choices, (1, 1))
    return numbers, choices


def _posed(given: FleetCase, seed: int, jobs: np.ndarray) -> FleetPosed:
    scenes = given.source.draw(seed, jobs, given.params)
    drawn = {"hull_radius": scenes.hulls, "v_max": scenes.limits}
    own = {name: value for name, value in drawn.items() if value is not None}
    return FleetPosed(scenes, replace(given.params, **own), given.static)


def _try_scenes(given: FleetCase) -> None:
    """Refuse what `navigate` would, and fleets that have arrived before they start."""
    posed = _posed(given, 0, np.arange(2))
    ways = posed.scenes.goals - posed.scenes.starts[..., :2]
    shortest = float(np.hypot(*np.moveaxis(ways, -1, 0)).min())
    if shortest <= float(given.params.goal_tolerance):
        raise BadInputError(
            f"a goal lies {shortest:g} m from its start, within 'goal_tolerance' of "
            f"{given.params.goal_tolerance:g} m; wanted it farther away"
        )
    assert posed.voyages


def _columns(found: FleetResult, voyage: Voyage) -> dict[str, np.ndarray]:
    """Status and metrics, array[J] each."""
    # A passage ends within the goal's tolerance.
    tolerance = np.asarray(voyage.params.goal_tolerance)
    ways = np.maximum(found.route_length.astype(np.float64) - tolerance, 0.0)
    sailed, way = found.path_length.astype(np.float64).sum(axis=1), ways.sum(axis=1)
    over = np.divide(sailed, way, out=np.ones_like(way), where=way > 0.0)
    # Of a vessel that does not arrive it is infinite, and so is that of its fleet.
    late = found.arrival_time - ways / np.asarray(voyage.params.v_max)
    return {
        "status": found.status,
        "time": found.time,
        "path_length": sailed / found.path_length.shape[1],
        "extra_distance": 100.0 * (over - 1.0),
        "delay": late.mean(axis=1),
        "min_separation": found.min_separation,
        "min_clearance": found.min_clearance.min(axis=1),
        "arrived": (found.vessel_status == int(Status.REACHED)).mean(axis=1),
        "steps": found.steps,
    }


def recorded(
    scene: Posed, results: Sequence[FleetResult], ends: Mapping[str, np.ndarray]
) -> Recording:
    """The tracks; the detail is float64[T, n, 5] of each fleet, as `FleetResult.trajectory`.

    Args:
        scene: what was posed.
        results: of its parts.
        ends: where vessels were to go, float64[J, n, 2] (m), by what that is called.
    """
    grounds: list[Ground] = []
    tracks: list[Track] = []
    states: list[np.ndarray] = []
    radius, dt = float(scene.params.obstacle_radius), float(scene.params.dt)
    for found in results:
        assert found.trajectory is not None
        for steps, track in zip(found.steps, found.trajectory, strict=True):
            row = len(tracks)
            marks = {"start": scene.scenes.starts[row, :, :2]}
            marks |= {name: places[row] for name, places in ends.items()}
            circles = scene.scenes.circles(row)
            grounds.append(Ground(scene.scenes.grid_map, circles, radius, marks))
            states.append(track[: steps + 1].astype(np.float64))
            tracks.append(Track(dt * np.arange(steps + 1), "s", states[-1][..., :2]))
    return Recording(tuple(grounds), tuple(tracks), tuple(states))
