"""usvjax: thousands of USV planning and navigation episodes at once, in JAX.

Importing it before the first use of JAX gives JAX one host device per core. What it exports is
loaded on first use, so that the command line starts quickly.
"""

import importlib
from typing import TYPE_CHECKING, Any

from usvjax.devices import use_all_cores as use_all_cores
from usvjax.exports import EXPORTED, home_of
from usvjax.registry import register_mission as register_mission
from usvjax.registry import register_own, register_presets
from usvjax.version import __version__ as __version__

if TYPE_CHECKING:  # "as" tells type checkers that a name is exported
    from usvjax.errors import BadInputError as BadInputError
    from usvjax.errors import BadTypeError as BadTypeError
    from usvjax.maps import GridMap as GridMap
    from usvjax.maps import expand_obstacles as expand_obstacles
    from usvjax.maps import hongze_lake as hongze_lake
    from usvjax.maps import load_map as load_map
    from usvjax.maps import obstacle_table as obstacle_table
    from usvjax.maps import random_maps as random_maps
    from usvjax.maps import save_map as save_map
    from usvjax.missions.aggregate.run import AggregateResult as AggregateResult
    from usvjax.missions.aggregate.run import aggregate as aggregate
    from usvjax.missions.cruise import CruiseParams as CruiseParams
    from usvjax.missions.cruise import CruiseResult as CruiseResult
    from usvjax.missions.cruise import CruiseStatic as CruiseStatic
    from usvjax.missions.cruise import cruise as cruise
    from usvjax.missions.dwa.candidates import DwaCandidates as DwaCandidates
    from usvjax.missions.dwa.candidates import dwa_candidates as dwa_candidates
    from usvjax.missions.dwa.params import DwaParams as DwaParams
    from usvjax.missions.dwa.params import DwaStatic as DwaStatic
    from usvjax.missions.dwa.params import fit_window as fit_window
    from usvjax.missions.dwa.run import NavigateResult as NavigateResult
    from usvjax.missions.dwa.run import navigate_dwa as navigate_dwa
    from usvjax.missions.fleet.environment import Environment as Environment
    from usvjax.missions.fleet.environment import FieldCurrent as FieldCurrent
    from usvjax.missions.fleet.environment import ShearCurrent as ShearCurrent
    from usvjax.missions.fleet.environment import UniformCurrent as UniformCurrent
    from usvjax.missions.fleet.environment import VortexCurrent as VortexCurrent
    from usvjax.missions.fleet.measures import MeetingKind as MeetingKind
    from usvjax.missions.fleet.measures import Meetings as Meetings
    from usvjax.missions.fleet.measures import meetings as meetings
    from usvjax.missions.fleet.params import FleetParams as FleetParams
    from usvjax.missions.fleet.params import FleetStatic as FleetStatic
    from usvjax.missions.fleet.run import FleetResult as FleetResult
    from usvjax.missions.fleet.run import navigate as navigate
    from usvjax.paths.metrics import PathMetrics as PathMetrics
    from usvjax.paths.metrics import path_metrics as path_metrics
    from usvjax.paths.smoothing import DensePaths as DensePaths
    from usvjax.paths.smoothing import KeyPaths as KeyPaths
    from usvjax.paths.smoothing import Splines as Splines
    from usvjax.paths.smoothing import bspline as bspline
    from usvjax.paths.smoothing import key_points as key_points
    from usvjax.paths.smoothing import redensify as redensify
    from usvjax.paths.smoothing import shorten as shorten
    from usvjax.paths.tracking import Tracks as Tracks
    from usvjax.paths.tracking import track_paths as track_paths
    from usvjax.paths.turns import PathPieces as PathPieces
    from usvjax.paths.turns import SmoothTurns as SmoothTurns
    from usvjax.paths.turns import smooth_turns as smooth_turns
    from usvjax.planners import PlanResult as PlanResult
    from usvjax.planners import plan_paths as plan_paths
    from usvjax.presets import Preset as Preset
    from usvjax.presets import preset as preset
    from usvjax.presets import preset_names as preset_names
    from usvjax.search.astar import AstarResult as AstarResult
    from usvjax.search.astar import astar as astar
    from usvjax.search.distance import distance_field as distance_field
    from usvjax.search.replanning import DstarLiteResult as DstarLiteResult
    from usvjax.search.replanning import dstar_lite as dstar_lite
    from usvjax.study import load_run as load_run
    from usvjax.study import run_study as run_study
    from usvjax.swarms import MinimiseResult as MinimiseResult
    from usvjax.swarms import minimise as minimise
    from usvjax.tours import TourResult as TourResult
    from usvjax.tours import optimal_tour as optimal_tour
    from usvjax.tours import solve_tour as solve_tour
    from usvjax.tours import tour_length as tour_length
    from usvkernels.paths.tracking import TrackParams as TrackParams
    from usvkernels.paths.turning import Turn as Turn
    from usvkernels.status import Status as Status

__all__ = sorted((*EXPORTED, "__version__", "register_mission", "use_all_cores"))

_MISSIONS = {
    "dwa": "usvjax.missions.dwa.mission:MISSION",
    "route": "usvjax.missions.route.mission:MISSION",
    "cruise": "usvjax.missions.cruise.mission:MISSION",
    "fleet": "usvjax.missions.fleet.mission:MISSION",
    "aggregate": "usvjax.missions.aggregate.mission:MISSION",
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
