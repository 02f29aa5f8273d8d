"""Ants: queries in groups, shared out over the devices."""

from functools import partial

import jax
import numpy as np

from usvjax.batches import Batch, split
from usvjax.devices import COMPILER_OPTIONS, QUICKLY_COMPILED, chosen_devices
from usvjax.errors import BadInputError
from usvjax.memory import check_memory
from usvjax.planners.inputs import Defaults, Request
from usvjax.planners.tracks import Tracks, tracks_of_moves
from usvkernels.planners.aco import AcoParams, AcoPlans, plan
from usvkernels.planners.ants import CHUNK, AcoQueries, AcoStatic

DEFAULTS = Defaults(
    params=AcoParams(),
    iterations=100,
    population=200,
    least=1,
    most=1 << 14,
    multiple=1,
    ranges={"rho": (0.0, 1.0), "alpha": (0.0, 20.0), "beta": (0.0, 20.0), "q": (0.0, 1e6)},
)
GROUP = 8  # queries side by side, so that the last ants of one do not wait alone
LANES = 256
STEPS_PER_SIDE = 8  # of an ant, per cell of height and width together, after which it is lost


def plan_rows(request: Request, rows: np.ndarray) -> Tracks:
    """Plan some of the queries, whose start and goal are apart and connected."""
    devices = chosen_devices()
    group = GROUP if len(rows) > len(devices) else 1
    static = _static(request, group, len(devices))
    if not len(rows):
        return Tracks(
            np.zeros((0, 1, 2), np.int32),
            np.zeros(0, np.int64),
            np.zeros(0),
            np.zeros((0, request.iterations)),
        )
    batch = Batch(split(rows, group), group, devices)
    move, steps, history = batch.arrays(partial(_planned, request, static))
    return tracks_of_moves(request.scene.starts[rows], move, steps.astype(np.int64), history)


def _static(request: Request, group: int, devices: int) -> AcoStatic:
    height, width = request.scene.shape
    steps = min(height * width, STEPS_PER_SIDE * (height + width))
    static = AcoStatic(
        height=height,
        width=width,
        ants=request.population,
        iterations=request.iterations,
        max_steps=-(-steps // CHUNK) * CHUNK,
        queries=group,
        lanes=min(LANES, -(-group * request.population // 16) * 16),
    )
    what = f"blocked: {static.lanes} ants at once on {width} x {height} cells"
    edges, record = 8 * group * static.size, static.rows * static.lanes
    check_memory(devices * (20 * edges + 5 * record + static.lanes * static.size), what)
    if max(edges, record, static.lanes * static.size) >= 2**31:
        raise BadInputError(
            f"{what} need more than 2^31 places; wanted a smaller map or population"
        )
    return static


def _planned(
    request: Request, static: AcoStatic, rows: np.ndarray, count: int, device: jax.Device
) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Moves, steps and history of some of the queries, on one device."""
    scene = request.scene
    maps = np.zeros_like(rows) if scene.shared else rows
    arrays = {
        "blocked": scene.blocked[maps],
        "start": _cell(static, scene.starts[rows]),
        "goal": _cell(static, scene.goals[rows]),
        "seed": request.seeds[:, rows],
    }
    params, arrays = jax.device_put((request.params, arrays), device)
    found = _run(static, params, AcoQueries(**arrays), np.int32(count))
    return found.move, found.steps, found.history


def _cell(static: AcoStatic, cells: np.ndarray) -> np.ndarray:
    return ((cells[:, 1] + 1) * static.stride + cells[:, 0] + 1).astype(np.int32)


@partial(jax.jit, static_argnames="static", compiler_options=COMPILER_OPTIONS | QUICKLY_COMPILED)
def _run(static: AcoStatic, params: AcoParams, queries: AcoQueries, count: jax.Array) -> AcoPlans:
    return plan(static, params, queries, count)
