"""usvjax: thousands of USV planning and navigation episodes at once, in JAX.

Importing it before the first use of JAX gives JAX one host device per core. What it exports is
loaded on first use, so that the command line starts quickly.
"""

import importlib
from typing import TYPE_CHECKING, Any

from usvjax.devices import use_all_cores
from usvjax.exports import home_of
from usvjax.registry import register_mission, register_own, register_presets
from usvjax.version import __version__

if TYPE_CHECKING:
    from usvjax.errors import BadInputError, BadTypeError
    from usvjax.maps import (
        GridMap,
        expand_obstacles,
        hongze_lake,
        load_map,
        obstacle_table,
        random_maps,
        save_map,
    )
    from usvjax.missions.cruise import CruiseParams, CruiseResult, CruiseStatic, cruise
    from usvjax.missions.dwa.candidates import DwaCandidates, dwa_candidates
    from usvjax.missions.dwa.params import DwaParams, DwaStatic, fit_window
    from usvjax.missions.dwa.run import NavigateResult, navigate_dwa
    from usvjax.paths.metrics import PathMetrics, path_metrics
    from usvjax.paths.smoothing import (
        DensePaths,
        KeyPaths,
        Splines,
        bspline,
        key_points,
        redensify,
        shorten,
    )
    from usvjax.paths.tracking import Tracks, track_paths
    from usvjax.paths.turns import PathPieces, SmoothTurns, smooth_turns
    from usvjax.planners import PlanResult, plan_paths
    from usvjax.presets import Preset, preset, preset_names
    from usvjax.search.astar import AstarResult, astar
    from usvjax.search.distance import distance_field
    from usvjax.search.replanning import DstarLiteResult, dstar_lite
    from usvjax.study import load_run, run_study
    from usvjax.swarms import MinimiseResult, minimise
    from usvjax.tours import TourResult, optimal_tour, solve_tour, tour_length
    from usvkernels.paths.tracking import TrackParams
    from usvkernels.paths.turning import Turn
    from usvkernels.status import Status


__all__ = [
    "AstarResult",
    "BadInputError",
    "BadTypeError",
    "CruiseParams",
    "CruiseResult",
    "CruiseStatic",
    "DensePaths",
    "DstarLiteResult",
    "DwaCandidates",
    "DwaParams",
    "DwaStatic",
    "GridMap",
    "KeyPaths",
    "MinimiseResult",
    "NavigateResult",
    "PathMetrics",
    "PathPieces",
    "PlanResult",
    "Preset",
    "SmoothTurns",
    "Splines",
    "Status",
    "TourResult",
    "TrackParams",
    "Tracks",
    "Turn",
    "__version__",
    "astar",
    "bspline",
    "cruise",
    "distance_field",
    "dstar_lite",
    "dwa_candidates",
    "expand_obstacles",
    "fit_window",
    "hongze_lake",
    "key_points",
    "load_map",
    "load_run",
    "minimise",
    "navigate_dwa",
    "obstacle_table",
    "optimal_tour",
    "path_metrics",
    "plan_paths",
    "preset",
    "preset_names",
    "random_maps",
    "redensify",
    "register_mission",
    "run_study",
    "save_map",
    "shorten",
    "smooth_turns",
    "solve_tour",
    "tour_length",
    "track_paths",
    "use_all_cores",
]

_MISSIONS = {
    "dwa": "usvjax.missions.dwa.mission:MISSION",
    "route": "usvjax.missions.route.mission:MISSION",
    "cruise": "usvjax.missions.cruise.mission:MISSION",
}

use_all_cores()
register_own(_MISSIONS)
register_presets("dwa", "usvjax.missions.dwa.presets:PRESETS")


def __getattr__(name: str) -> Any:
    if not (module := home_of(name)):
        raise AttributeError(f"module 'usvjax' has no attribute {name!r}")
    value = getattr(importlib.import_module(module), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
