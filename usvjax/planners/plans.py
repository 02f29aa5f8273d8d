"""Paths between two cells by ants, genes and particles, many queries at once."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from usvjax.checks import one_of
from usvjax.planners import aco, rows
from usvjax.planners.inputs import Request, planner_request
from usvjax.planners.tracks import Tracks
from usvjax.public import public
from usvjax.search.inputs import SearchScene, search_scene
from usvkernels.status import Status

_PLANNERS = {
    "aco": (aco.DEFAULTS, aco.plan_rows),
    "ga": (rows.GA_DEFAULTS, rows.plan_rows_ga),
    "cmpso": (rows.CMPSO_DEFAULTS, rows.plan_rows_cmpso),
}
ALGORITHMS = tuple(_PLANNERS)


@dataclass(frozen=True)
class PlanResult:
    """How B queries ended; numpy arrays, in the order of the arguments.

    Attributes:
        status: int32[B], `Status`: FOUND, UNREACHABLE (proven, by the connected water),
            OUT_OF_BUDGET (the planner found none) or BLOCKED.
        path: int32[B, P, 2], cells (x, y) from start to goal, the goal repeated up to the longest
            path; -1 throughout without a path.
        path_cells: int32[B], cells of the path, start and goal included; 0 without a path.
        cost: float64[B], length of the path in cells; inf without one.
        history: float64[B, iterations], length of the best path so far (of "ga", the one of best
            fitness so far, which may be longer than one before); inf as long as there was none.
    """

    status: np.ndarray
    path: np.ndarray
    path_cells: np.ndarray
    cost: np.ndarray
    history: np.ndarray


@public("usvkernels.planners")
def plan_paths(
    blocked: Any,
    starts: Any,
    goals: Any,
    key: Any,
    *,
    algorithm: str = "aco",
    iterations: int | None = None,
    population: int | None = None,
    params: Any = None,
    on_blocked: str = "raise",
) -> PlanResult:
    """Plan paths with a metaheuristic, as the baselines of Yu et al. 2022 do.

    These planners are published baselines. They are slower than `astar`, by orders of magnitude,
    and their paths are longer. A path has 8 neighbours per cell and cuts no corners: a diagonal
    step needs both cells beside it free. What a planner does, and what was assumed where the
    paper prints only parameters, is in `usvkernels.planners` (aco, ga, cmpso, rows). Paths of "ga"
    and "cmpso" never turn back along one axis of the map, tried first along that on which start
    and goal are farther apart; where there is no such path, they are OUT_OF_BUDGET.

    Runs on all devices, or on that of an enclosing `jax.default_device`. Query j's result depends
    on its own map, ends and key alone.

    Args:
        blocked: bool[H, W] shared by all, bool[B, H, W], or a `GridMap` (shared).
        starts: int[B, 2], cells (x, y); or int[2], shared.
        goals: int[B, 2], cells (x, y); or int[2], shared.
        key: a seed or a JAX key, of which query j takes the j-th part; or keys [B], one each, such
            as a mission has that plans now for these and now for those vessels.
        algorithm: "aco" (ants), "ga" (genes) or "cmpso" (particles).
        iterations: by default 100, of "ga" 50 (the paper's, of "cmpso" ours).
        population: ants, individuals or particles; by default 200 (the paper's), 200 and 60 (ours).
        params: `AcoParams`, `GaParams` or `CmpsoParams` of `usvjax.planners`, of numbers; by
            default the paper's.
        on_blocked: "raise" refuses a start or goal on a blocked cell, "status" marks such rows.

    Raises:
        BadTypeError: an argument of the wrong type or dtype.
        BadInputError: an unknown algorithm, a number out of range, cells outside the map or (by
            default) blocked, wrong or unequal shapes, more memory wanted than there is.
    """
    one_of("algorithm", algorithm, ALGORITHMS)
    defaults, plan_rows = _PLANNERS[algorithm]
    scene = search_scene(blocked, starts, goals, on_blocked)
    request = planner_request(defaults, scene, key, iterations, population, params)
    here = np.all(scene.starts == scene.goals, axis=1)
    joined = scene.open_ends & _connected(scene)
    wanted = np.flatnonzero(joined & ~here)
    tracks = plan_rows(request, wanted)
    return _collected(scene, request, joined, here, wanted, tracks)


def _connected(scene: SearchScene) -> np.ndarray:
    """Whether a path exists: bool[B].

    A diagonal step with both cells beside it free can be made in two straight ones, so that
    connection by straight steps decides.
    """
    within_layer = np.zeros((3, 3, 3), bool)
    within_layer[1] = scipy.ndimage.generate_binary_structure(2, 1)
    label, _ = scipy.ndimage.label(~scene.blocked, within_layer)
    layer = np.zeros(len(scene), np.int64) if scene.shared else np.arange(len(scene))
    ends = [label[layer, cells[:, 1], cells[:, 0]] for cells in (scene.starts, scene.goals)]
    return ends[0] == ends[1]


def _collected(
    scene: SearchScene,
    request: Request,
    joined: np.ndarray,
    here: np.ndarray,
    wanted: np.ndarray,
    tracks: Tracks,
) -> PlanResult:
    """Put the planned rows among those that needed no plan."""
    found = np.isfinite(tracks.length)
    status = np.where(joined, int(Status.OUT_OF_BUDGET), int(Status.UNREACHABLE))
    status[~scene.open_ends] = Status.BLOCKED
    status[joined & here] = status[wanted[found]] = Status.FOUND
    cost = np.where(joined & here, 0.0, np.inf)
    cost[wanted] = tracks.length
    count = np.where(joined & here, 1, 0)
    count[wanted] = np.where(found, tracks.count, 0)
    path = np.repeat(scene.goals[:, None], max(1, count.max(initial=1)), axis=1)
    place = np.arange(path.shape[1])
    row, column = np.nonzero(place < count[wanted][:, None])
    path[wanted[row], column] = tracks.cells[row, column]
    path[status != Status.FOUND] = -1
    history = np.full((len(scene), request.iterations), np.inf)
    history[wanted] = tracks.history
    history[joined & here] = 0.0
    return PlanResult(
        status=status.astype(np.int32),
        path=path.astype(np.int32),
        path_cells=count.astype(np.int32),
        cost=cost,
        history=history,
    )
