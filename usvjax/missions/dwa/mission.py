"""The mission "dwa": closed-loop episodes of the dynamic window approach.

`[maps]` says where episodes take place, `[params]` holds `DwaParams` and may start from a preset,
`[static]` holds `DwaStatic`. The study's `methods` take the place of `static.method`.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from usvjax.checks import shown
from usvjax.errors import BadInputError, BadTypeError, saying_where
from usvjax.maps.tables import read_maps
from usvjax.mission import (
    Case,
    Files,
    Ground,
    Kin,
    Metric,
    Outcome,
    Recording,
    Replay,
    Replayed,
    Track,
)
from usvjax.missions.dwa.params import DwaParams, DwaStatic, check_dwa, fit_window
from usvjax.missions.dwa.posed import DwaCase, DwaPosed, joined, kin_of, pack_scenes
from usvjax.missions.dwa.run import NavigateResult, sail
from usvjax.missions.dwa.scenes import ChartTable, DiscTable, LatticeTable, Source, opened
from usvjax.presets import preset, preset_names
from usvjax.sections import Table
from usvjax.tables import check_keys, field_names, read_values
from usvkernels.status import EPISODE_ENDINGS

DEFAULT_PRESET = "tan2022"
_PRESET_WORDS = f"the set to start from: {', '.join(preset_names())}; {DEFAULT_PRESET} if left out."

_SOURCES = {"lattice": LatticeTable, "random": DiscTable, "grid": ChartTable}


class DwaMission:
    """Navigate under DWA; see `usvjax.mission.Mission`."""

    tables = MappingProxyType(
        {
            "maps": Table(
                "where episodes take place",
                _SOURCES,
                choice="source",
                default="lattice",
                examples={"map": "hongze-125"},
            ),
            "params": Table(
                "numbers of the method and of the vessel",
                {"": DwaParams},
                extra={"preset": _PRESET_WORDS},
            ),
            "static": Table("sizes and choices of method", {"": DwaStatic}, without=("method",)),
        }
    )
    methods = MappingProxyType(
        {
            "traditional": "every obstacle counts (Fox et al. 1997)",
            "improved": "only obstacles in a search sector count (Tan et al. 2022)",
        }
    )
    metrics = (
        Metric("time", "s", "Time"),
        Metric("path_length", "m", "Path length"),
        Metric("mean_speed", "m/s", "Mean speed"),
        Metric("min_clearance", "m", "Min clearance"),
        Metric("steps", "", "Steps", integer=True, summarised=False),
    )
    endings = EPISODE_ENDINGS

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Check one condition; see `Mission.case`."""
        params, static = _read_method(tables["params"], tables["static"], files)
        place = files.table("maps")
        maps, source, inputs = read_maps(
            tables["maps"], self.tables["maps"], opened, files.folder, place, files.kept
        )
        source.check(float(params.radius), place)
        source.check_outside_goal(float(params.goal_tolerance), place)
        with saying_where(place):
            rows = _try_scenes(source, params, static)
        in_force = {
            "maps": maps,
            "params": asdict(params),
            "static": {k: v for k, v in asdict(static).items() if k != "method"},
        }
        return Case(in_force, inputs, DwaCase(source, params, static, rows), source.most_jobs)

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> DwaPosed:
        """Draw maps, starts and goals; see `Mission.pose`."""
        given: DwaCase = case.given
        scenes = given.source.draw(seed, jobs, float(given.params.radius))
        return DwaPosed(scenes, given.params, given.static)

    def run(self, scene: DwaPosed, method: str, record: bool = False) -> Outcome:
        """Run episodes; see `Mission.run`."""
        static = replace(scene.static, method=method)
        packed = pack_scenes(scene.scenes, scene.params, static)
        result = sail(packed, scene.params, static, record, room=scene.room)
        columns = {metric.name: getattr(result, metric.name) for metric in self.metrics}
        recording = _recorded(scene, result) if record else None
        return Outcome({"status": result.status, **columns}, recording)

    def kin(self, case: Case) -> Kin:
        """Cases that differ in numbers only; see `usvjax.mission.Joining`."""
        given: DwaCase = case.given
        return kin_of(given)

    def join(self, scenes: Sequence[DwaPosed], cases: Sequence[Case]) -> DwaPosed:
        """Scenes with one value per episode of each parameter that differs; see `kin`."""
        return joined(scenes, [case.given for case in cases])

    def example(self, rows: Any, methods: list[str]) -> tuple[int, str]:
        """The episode to show; see `Mission.example`."""
        from usvjax.missions.dwa.figures import typical_job

        return typical_job(rows, methods)

    def figures(self, run: Any, replay: Replay) -> Iterator[tuple[str, Any]]:
        """Draw a run; see `Mission.figures`."""
        from usvjax.missions.dwa.figures import dwa_figures

        return dwa_figures(run, replay)

    def film(self, replayed: Replayed, row: int) -> Any:
        """An episode with its dynamic window; see `Mission.film`."""
        from usvjax.missions.dwa.figures import episode_film

        return episode_film(replayed, row)


MISSION = DwaMission()


def _recorded(scene: DwaPosed, result: NavigateResult) -> Recording:
    assert result.trajectory is not None
    dt = float(scene.params.dt)
    grounds, tracks = [], []
    for row, steps in enumerate(result.steps):
        start, goal = scene.scenes.starts[row, None, :2], scene.scenes.goals[row, None]
        marks = {"start": np.asarray(start), "goal": np.asarray(goal)}
        radius = float(scene.params.radius)
        grounds.append(Ground(scene.grid_map, scene.circles(row), radius, marks))
        places = result.trajectory[row, : steps + 1, None, :2].astype(np.float64)
        tracks.append(Track(dt * np.arange(steps + 1), "s", places))
    return Recording(tuple(grounds), tuple(tracks), result)


def _try_scenes(source: Source, params: DwaParams, static: DwaStatic) -> int:
    """Refuse what `navigate_dwa` would, before a run directory exists; obstacle rows of a map."""
    some = source.draw(0, np.arange(2), float(params.radius))
    pack_scenes(some, params, static)
    return some.rows


def _read_method(
    params_table: Mapping[str, Any], static_table: Mapping[str, Any], files: Files
) -> tuple[DwaParams, DwaStatic]:
    """Read `[params]` and `[static]`; candidates are counted to fit unless given."""
    in_params, in_static = files.table("params"), files.table("static")
    names = [f.name for f in fields(DwaParams)]
    check_keys(params_table, [*names, "preset"], in_params)
    name = params_table.get("preset", DEFAULT_PRESET)
    if not isinstance(name, str):
        raise BadTypeError(f"{in_params}: 'preset' must be a string, got {shown(name)}")
    numbers = {k: v for k, v in params_table.items() if k != "preset"}
    if "method" in static_table:
        raise BadInputError(f"{in_static}: list methods in 'methods', not in 'method'")
    check_keys(static_table, [n for n in field_names(DwaStatic) if n != "method"], in_static)
    with saying_where(files.where):
        base = preset(name)
        params = replace(base.params, **read_values(DwaParams, numbers, in_params))
        static = replace(base.static, **read_values(DwaStatic, static_table, in_static))
        fitted = fit_window(params, static)
        sizes = {k: getattr(fitted, k) for k in ("n_v", "n_w") if k not in static_table}
        static = replace(static, **sizes)
        check_dwa(params, static)
    return params, static
