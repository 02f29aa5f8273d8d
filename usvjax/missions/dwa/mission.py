"""Studies of kind "dwa": closed-loop episodes of the dynamic window approach.

`[maps]` says where episodes take place (`source = "lattice"`, "random" or "grid"), `[params]`
holds `usvjax.missions.dwa.params.DwaParams` and may start from a `preset`, `[static]` holds
`usvjax.missions.dwa.params.DwaStatic`. The study's `methods` take the place of `static.method`.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from enum import IntEnum
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps.tables import read_map, read_source, saying_where
from usvjax.mission import Metric, Prepared
from usvjax.missions.dwa.inputs import set_scene
from usvjax.missions.dwa.params import DwaParams, DwaStatic, check_dwa, fit_window
from usvjax.missions.dwa.run import navigate_dwa
from usvjax.missions.dwa.scenes import LatticeMaps, RandomMaps, Source
from usvjax.missions.dwa.water import GridMaps, Water
from usvjax.presets import preset
from usvjax.sections import Sections
from usvjax.study.spec import Condition, StudySpec
from usvjax.tables import check_keys, field_names, read_values
from usvkernels.status import EPISODE_ENDINGS, Status

DEFAULT_PRESET = "tan2022"

_SOURCES: dict[str, type[LatticeMaps] | type[RandomMaps] | type[GridMaps]] = {
    "lattice": LatticeMaps,
    "random": RandomMaps,
    "grid": GridMaps,
}


@dataclass(frozen=True)
class DwaCondition:
    """One condition of a DWA study.

    Attributes:
        source: draws the scenarios.
        params, static: of the method; `static.method` is set per run.
    """

    source: Source
    params: DwaParams
    static: DwaStatic


class DwaWorkload:
    """Run DWA episodes for a study; see `usvjax.mission.Workload`."""

    sections: Sections = MappingProxyType(
        {
            "maps": ("source", *field_names(*_SOURCES.values())),
            "params": ("preset", *field_names(DwaParams)),
            # The study's own `methods` take the place of this one.
            "static": tuple(name for name in field_names(DwaStatic) if name != "method"),
        }
    )
    methods: tuple[str, ...] = ("traditional", "improved")
    metrics: tuple[Metric, ...] = (
        Metric("time", "s", "Time"),
        Metric("path_length", "m", "Path length"),
        Metric("mean_speed", "m/s", "Mean speed"),
        Metric("min_clearance", "m", "Min clearance"),
        Metric("steps", "", "Steps", integer=True, summarised=False),
    )
    endings: tuple[IntEnum, ...] = EPISODE_ENDINGS
    success: IntEnum = Status.REACHED

    def prepare(
        self, settings: Mapping[str, Mapping[str, Any]], folder: Path, where: str
    ) -> Prepared:
        """Check one condition; see `Workload.prepare`."""
        params, static = _read_method(settings["params"], settings["static"], where)
        place = f"{where}: [maps]"
        name, options, source, inputs = _read_maps(settings["maps"], folder, place)
        source.check(float(params.radius), place)
        source.check_outside_goal(float(params.goal_tolerance), place)
        with saying_where(place):
            _try_scenarios(source, params, static)
        in_force = {
            "maps": {"source": name, **asdict(options)},
            "params": asdict(params),
            "static": {k: v for k, v in asdict(static).items() if k != "method"},
        }
        return Prepared(in_force, inputs, DwaCondition(source, params, static))

    def run(
        self, spec: StudySpec, condition: Condition, method: str, jobs: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Run episodes; see `Workload.run`."""
        given: DwaCondition = condition.payload
        scenarios = given.source.draw(spec.seed, jobs, float(given.params.radius))
        result = navigate_dwa(
            scenarios.obstacles,
            scenarios.starts,
            scenarios.goals,
            valid=scenarios.valid,
            params=given.params,
            static=replace(given.static, method=method),
        )
        columns = {metric.name: getattr(result, metric.name) for metric in self.metrics}
        return {"status": result.status, **columns}


def _try_scenarios(source: Source, params: DwaParams, static: DwaStatic) -> None:
    """Refuse what `navigate_dwa` would, before a run directory exists."""
    some = source.draw(0, np.arange(2), float(params.radius))
    set_scene(some.obstacles, some.starts, some.goals, some.valid, params, static, None)


def _read_method(
    params_table: Mapping[str, Any], static_table: Mapping[str, Any], where: str
) -> tuple[DwaParams, DwaStatic]:
    """Read `[params]` and `[static]`; candidates are counted to fit unless given."""
    in_params, in_static = f"{where}: [params]", f"{where}: [static]"
    names = [f.name for f in fields(DwaParams)]
    check_keys(params_table, [*names, "preset"], in_params)
    name = params_table.get("preset", DEFAULT_PRESET)
    if not isinstance(name, str):
        raise BadTypeError(f"{in_params}: 'preset' must be a string, got {name!r}")
    numbers = {k: v for k, v in params_table.items() if k != "preset"}
    if "method" in static_table:
        raise BadInputError(f"{in_static}: list methods in 'methods', not in 'method'")
    with saying_where(where):
        base = preset(name)
        params = replace(base.params, **read_values(DwaParams, numbers, in_params))
        static = replace(base.static, **read_values(DwaStatic, static_table, in_static))
        fitted = fit_window(params, static)
        sizes = {k: getattr(fitted, k) for k in ("n_v", "n_w") if k not in static_table}
        static = replace(static, **sizes)
        check_dwa(params, static)
    return params, static


def _read_maps(
    table: Mapping[str, Any], folder: Path, where: str
) -> tuple[str, LatticeMaps | RandomMaps | GridMaps, Source, dict[str, str]]:
    """Read `[maps]`: the source's name, its options, the source, and digests of its inputs."""
    name, options = read_source(table, _SOURCES, "lattice", where)
    if not isinstance(options, GridMaps):
        return name, options, options, {}
    grid, digest = read_map(options.map, options.cell_size, options.refine, folder, where)
    return name, options, Water(grid, options), {options.map: digest}
