"""Genes and particles: queries in groups of like length, shared out over the devices."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import numpy as np

from usvjax.batches import Batch, bucket, split
from usvjax.devices import COMPILER_OPTIONS, QUICKLY_COMPILED, chosen_devices
from usvjax.errors import BadInputError
from usvjax.memory import check_memory
from usvjax.planners.inputs import Defaults, Request
from usvjax.planners.tracks import Tracks, tracks_of_moves
from usvjax.swarms.ranges import RANGES
from usvkernels.planners import cmpso, ga
from usvkernels.planners.moves import MOVES
from usvkernels.planners.rows import MOST_SIDE, RowPlans, RowQueries
from usvkernels.swarms.cmpso import CmpsoParams as SwarmParams

GA_DEFAULTS = Defaults(
    params=ga.GaParams(),
    iterations=50,
    population=200,
    least=2,
    most=2048,  # the wheel compares all with all
    multiple=2,
    ranges={
        "crossover": (0.0, 1.0),
        "mutation": (0.0, 1.0),
        "length_weight": (0.0, 1e6),
        "smoothness_weight": (0.0, 1e6),
    },
    weights=("length_weight", "smoothness_weight"),
)
CMPSO_DEFAULTS = Defaults(
    params=cmpso.CmpsoParams(),
    iterations=100,
    population=60,
    least=cmpso.SWARMS,
    most=1 << 14,
    multiple=cmpso.SWARMS,
    ranges=RANGES[SwarmParams],  # those of a swarm that minimises
)
GROUP = 8  # queries side by side
LEAST_ROWS = 16  # of a frame
_OPTIONS = COMPILER_OPTIONS | QUICKLY_COMPILED


@dataclass(frozen=True)
class _Kernel:
    static: Callable[[int, int, int], Any]
    run: Callable[[Any, Any, RowQueries], RowPlans]


def plan_rows_ga(request: Request, rows: np.ndarray) -> Tracks:
    """Plan some of the queries, whose start and goal are apart and connected, by genes."""
    return _plan(_Kernel(ga.GaStatic, _run_ga), request, rows)


def plan_rows_cmpso(request: Request, rows: np.ndarray) -> Tracks:
    """As `plan_rows_ga`, by particles."""
    return _plan(_Kernel(cmpso.CmpsoStatic, _run_cmpso), request, rows)


@partial(jax.jit, static_argnames="static", compiler_options=_OPTIONS)
def _run_ga(static: ga.GaStatic, params: ga.GaParams, queries: RowQueries) -> RowPlans:
    return ga.plan(static, params, queries)


@partial(jax.jit, static_argnames="static", compiler_options=_OPTIONS)
def _run_cmpso(
    static: cmpso.CmpsoStatic, params: cmpso.CmpsoParams, queries: RowQueries
) -> RowPlans:
    return cmpso.plan(static, params, queries)


def _plan(kernel: _Kernel, request: Request, rows: np.ndarray) -> Tracks:
    """Plan along the axis on which start and goal are farther apart.

    Where no path is found that way, because all of them turn back, once more along the other.
    """
    scene = request.scene
    _check_side(scene.shape)
    apart = np.abs(scene.goals - scene.starts)[rows]
    across = apart[:, 0] > apart[:, 1]
    moves, history = _planned(kernel, request, rows, across)
    failed = np.array([not len(made) for made in moves], bool) & (apart.min(axis=1) > 0)
    if failed.any():
        more, history[failed] = _planned(kernel, request, rows[failed], ~across[failed])
        for row, made in zip(np.flatnonzero(failed), more, strict=True):
            moves[row] = made
    steps = np.array([len(made) for made in moves], np.int64)
    padded = np.zeros((len(rows), steps.max(initial=1)), np.int64)
    for i, made in enumerate(moves):
        padded[i, : len(made)] = made
    return tracks_of_moves(scene.starts[rows], padded, steps, history)


def _planned(
    kernel: _Kernel, request: Request, rows: np.ndarray, across: np.ndarray
) -> tuple[list[np.ndarray], np.ndarray]:
    """Moves and histories of the queries, planned in groups of like length.

    Args:
        kernel: of the algorithm.
        request: checked.
        rows: int[n], of the request.
        across: bool[n], rows of the path are columns of the map.
    """
    scene, devices = request.scene, chosen_devices()
    group = GROUP if len(rows) > len(devices) else 1
    apart = np.abs(scene.goals - scene.starts)[rows]
    order = np.argsort(np.where(across, apart[:, 0], apart[:, 1]), kind="stable")
    batch = Batch(split(order, group), group, devices)

    def work(
        part: np.ndarray, count: int, device: jax.Device
    ) -> tuple[list[np.ndarray], np.ndarray]:
        return _group(kernel, request, rows[part], across[part], count, device)

    history = np.zeros((len(rows), request.iterations))
    moves = [np.zeros(0, np.int64)] * len(rows)
    for part, (made, lengths) in zip(batch.blocks, batch.each(work), strict=True):
        history[part] = lengths
        for row, one in zip(part, made, strict=True):
            moves[row] = one
    return moves, history


def _check_side(shape: tuple[int, int]) -> None:
    if max(shape) > MOST_SIDE:
        height, width = shape
        raise BadInputError(
            f"blocked: got {width} x {height} cells; wanted at most {MOST_SIDE} on a side"
        )


def _group(
    kernel: _Kernel,
    request: Request,
    rows: np.ndarray,
    across: np.ndarray,
    count: int,
    device: jax.Device,
) -> tuple[list[np.ndarray], np.ndarray]:
    """Moves and histories of the first `count` of a group of queries, on one device."""
    scene, group = request.scene, len(rows)
    start, goal = scene.starts[rows], scene.goals[rows]
    apart = np.abs(goal - start)
    side = max(scene.shape)
    most = max(LEAST_ROWS, int(np.where(across, apart[:, 0], apart[:, 1]).max()) + 1)
    static = kernel.static(min(bucket(most, 4), side), request.population, request.iterations)
    needed = group * (8 * static.rows * side + 64 * static.rows * request.population)
    height, width = scene.shape
    check_memory(needed, f"blocked: {group} plans at once on {width} x {height} cells")
    arrays = {
        "blocked": scene.blocked[np.zeros_like(rows) if scene.shared else rows],
        "start": start,
        "goal": goal,
        "across": across,
        "seed": request.seeds[:, rows],
    }
    params, arrays = jax.device_put((request.params, arrays), device)
    found = kernel.run(static, params, RowQueries(**arrays))
    exits, joins, length, history = jax.device_get(
        (found.exits, found.joins, found.length, found.history)
    )
    made = [
        _moves(start[i], goal[i], bool(across[i]), exits[:, i], joins[:, i])
        if np.isfinite(length[i])
        else np.zeros(0, np.int64)
        for i in range(count)
    ]
    return made, history.T[:count]


def _moves(
    start: np.ndarray, goal: np.ndarray, across: bool, exits: np.ndarray, joins: np.ndarray
) -> np.ndarray:
    """Indices into MOVES of a path in rows."""
    apart = goal - start
    along = 0 if across else 1  # the axis of the rows
    n = abs(apart[along])
    leaves = np.append(exits[:n], goal[1 - along])
    enters = np.append(start[1 - along], exits[:n])
    join = np.append(joins[:n], False)
    side = np.sign(leaves - enters)
    run = np.abs(leaves - enters) - join
    # Of each row: so many steps to the side, then one on, which is diagonal where they join.
    number = np.stack([run, np.append(np.ones(n, int), 0)], axis=1).reshape(-1)
    sideways = np.stack([side, np.where(join, side, 0)], axis=1).reshape(-1)
    onwards = np.tile([0, np.sign(apart[along])], n + 1)
    code = _CODE[(onwards if along else sideways) + 1, (sideways if along else onwards) + 1]
    return np.repeat(code, number)


_CODE = np.full((3, 3), -1)
"""Index of a move by dy + 1 and dx + 1."""
for _index, (_dx, _dy) in enumerate(MOVES):
    _CODE[_dy + 1, _dx + 1] = _index
