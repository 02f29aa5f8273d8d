"""Closed-loop navigation with the dynamic window approach, thousands of episodes at once."""

from dataclasses import dataclass, fields
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.batches import Batch, bucket, deal_longest_first, filled
from usvjax.checks import whole_number
from usvjax.devices import COMPILER_OPTIONS, ONE_THREAD, chosen_devices
from usvjax.memory import check_memory
from usvjax.missions.dwa.inputs import PackedEpisodes, pack_episodes
from usvjax.missions.dwa.params import DwaParams, DwaStatic, split
from usvjax.programs import Programs
from usvjax.public import public
from usvkernels import lanes
from usvkernels.dwa import episodes
from usvkernels.dwa.episodes import Jobs, Outcome
from usvkernels.lanes import LEAST_LANES

MOST_LANES = 256  # state of a step stays within the second-level cache
MOST_ROWS = 8192  # episodes per call of a device; memory does not grow past it
JOBS_PER_LANE = 4  # at least, or lanes idle for want of a next job
CHUNK = 8  # steps between two refills
RECORDED = 128  # steps between two looks whether all recorded episodes have ended
_LANE_BYTES = 64  # of a candidate, in a decision
OPTIONS = COMPILER_OPTIONS | ONE_THREAD

_programs = Programs()


@dataclass(frozen=True)
class NavigateResult:
    """How B episodes ended; numpy arrays, in the order of the arguments.

    Attributes:
        status: int32[B], `Status`: REACHED, COLLIDED, STUCK or TIMED_OUT.
        time: float32[B], duration (s) to whatever ended the episode.
        path_length: float32[B], distance sailed (m).
        mean_speed: float32[B], path_length / time (m/s); 0 for an episode of no duration.
        min_clearance: float32[B], least distance to an obstacle's circle at an executed
            position (m), negative on collision; inf where no obstacle was ever sensed.
        steps: int32[B], control periods executed.
        trajectory: float32[B, T, 5] or None: x (m), y (m), psi (rad), v (m/s), w (rad/s) from
            the start on; after its end an episode repeats its last row. float64 on a map whose
            origin is not (0, 0): single precision resolves no step at UTM coordinates.
        occupancy: share of lane-steps that advanced an episode, in (0, 1].
    """

    status: np.ndarray
    time: np.ndarray
    path_length: np.ndarray
    mean_speed: np.ndarray
    min_clearance: np.ndarray
    steps: np.ndarray
    trajectory: np.ndarray | None
    occupancy: float


@public("usvkernels.dwa")
def navigate_dwa(
    obstacles: Any,
    starts: Any,
    goals: Any,
    *,
    params: DwaParams | None = None,
    static: DwaStatic | None = None,
    valid: Any = None,
    record: bool = False,
    sensing_range: float | None = None,
    max_lanes: int = MOST_LANES,
) -> NavigateResult:
    """Sail B episodes from start to goal under the dynamic window approach.

    Source: Tan et al. 2022, Eqs. 1 to 6 and section 3; readings in docs/equations.md. Runs on
    all devices, or on that of an enclosing `jax.default_device`. An episode's result does not
    depend on the others, their number or the devices.

    Args:
        obstacles: float[B, K, 2] centres (m), or float[K, 2] shared; rows that are masked, or
            farther than 500 km, are padding. Or a `GridMap` shared by all: every blocked cell on
            the shoreline is an obstacle, and `params.radius` must cover a cell. The map's edge is
            no obstacle: a vessel may leave, and then senses what is near the edge cell beside it.
        starts: float[B, 3], x (m), y (m), psi (rad), at rest; or float[3].
        goals: float[B, 2] (m); or float[2], shared. Coordinates stay below 200 km (single
            precision): subtract a local origin from UTM coordinates.
        params: defaults to Tan's Table 1. A leaf may be float[B], one value per episode.
        static: choices of method; its n_v and n_w must hold the window of `params`.
        valid: bool[B, K] (or bool[K]), False masks an obstacle.
        record: also return the trajectories; memory grows with B times the longest episode's steps.
        sensing_range: (m) with a `GridMap`, how far off shore is seen; by default as far as the
            prediction reaches, plus braking and the radius; wanted where these differ between
            episodes.
        max_lanes: most episodes under way at once on a device, at least 16, which fill the
            processor's vectors; for measurements.

    Returns:
        The outcomes, in the order of `starts`.

    Raises:
        BadTypeError: an argument of the wrong type or dtype.
        BadInputError: a wrong shape, NaN or infinity, impossible parameters, or a start inside
            an obstacle; the message names the argument and the first bad row.
    """
    params = DwaParams() if params is None else params
    static = DwaStatic() if static is None else static
    max_lanes = whole_number("max_lanes", max_lanes, LEAST_LANES)
    packed = pack_episodes(obstacles, starts, goals, valid, params, static, sensing_range)
    return sail(packed, params, static, record, max_lanes)


def sail(
    packed: PackedEpisodes,
    params: DwaParams,
    static: DwaStatic,
    record: bool = False,
    max_lanes: int = MOST_LANES,
    room: int = LEAST_LANES,
) -> NavigateResult:
    """Sail episodes that were checked.

    Args:
        packed, params, static: what `pack_episodes` was given, and made of it.
        record, max_lanes: as of `navigate_dwa`.
        room: episodes that the program has room for, at least: calls of any fewer are of one
            program.
    """
    devices = chosen_devices()
    most = MOST_LANES if record else MOST_ROWS
    blocks = deal_longest_first(packed.expected_steps(params), most, len(devices))
    capacity = bucket(max(room, len(blocks[0])))
    width = min(max_lanes, max(LEAST_LANES, capacity // JOBS_PER_LANE))

    check_memory(
        _LANE_BYTES * static.n_v * static.n_w * width * len(devices),
        f"static: {static.n_v} x {static.n_w} candidates of {width} episodes at once",
    )

    swept = tuple(name for name, value in vars(params).items() if np.ndim(value))
    charted = packed.chart is not None
    program = (record, static, swept, charted, packed.sensed_shape, capacity, width)

    def begin(rows: np.ndarray, count: int, device: jax.Device) -> Any:
        jobs, own = packed.rows(rows), _params_of(params, rows)
        if record:
            return _record(program, device, jobs, own, static)
        arrays = (jobs, own, np.int32(count))
        return _programs.run(program, device, _run, *arrays, static=static, width=width)

    batch = Batch(blocks, capacity, devices)
    ready = not record and _programs.ready(program, devices[: len(blocks)])
    results = batch.run(begin, at_once=ready)
    return _collect(results, batch, packed, params, static)


def _params_of(params: DwaParams, rows: np.ndarray) -> DwaParams:
    values = {f.name: np.asarray(getattr(params, f.name), np.float32) for f in fields(params)}
    chosen: dict[str, Any] = {name: v[rows] if v.ndim else v for name, v in values.items()}
    return DwaParams(**chosen)


@partial(jax.jit, static_argnames=("static", "width"), compiler_options=OPTIONS)
def _run(
    jobs: Jobs, params: DwaParams, count: jax.Array, *, static: DwaStatic, width: int
) -> tuple[Outcome, lanes.Usage]:
    return lanes.run(
        episodes.program(jobs, split(params, static)),
        count,
        capacity=jobs.start.shape[0],
        lanes=width,
        chunk=CHUNK,
        max_steps=static.max_steps,
    )


def _record(
    program: Any, device: jax.Device, jobs: Jobs, params: DwaParams, static: DwaStatic
) -> tuple[Outcome, lanes.Usage, np.ndarray]:
    """Sail a block some steps at a time until all of it has ended; trajectory [n, T, 5]."""
    arrays = jobs, params
    state, seen = _programs.run((program, "first"), device, _first, *arrays, static=static)
    parts, ended, rows = [np.asarray(seen)[None]], False, len(jobs.start)
    while not ended:
        most = len(parts) * RECORDED
        check_memory(
            2 * seen.nbytes * most, f"record: {rows} episodes under way after {most:,} steps"
        )
        state, outcome, seen_since, over = _programs.run(
            program, device, _recorded, *arrays, state, static=static
        )
        parts.append(np.asarray(seen_since))
        ended = bool(over)
    seen = np.concatenate(parts)
    busy: Any = outcome.steps.sum(dtype=np.float32)
    total: Any = np.float32(rows * (len(seen) - 1))
    return outcome, lanes.Usage(busy=busy, total=total), np.moveaxis(seen, 2, 0)


@partial(jax.jit, static_argnames="static", compiler_options=OPTIONS)
def _first(jobs: Jobs, params: DwaParams, *, static: DwaStatic) -> tuple[Any, jax.Array]:
    """The first state of one lane per episode, and what is seen of it."""
    rows = jnp.arange(jobs.start.shape[0], dtype=jnp.int32)
    state = episodes.program(jobs, split(params, static)).start(rows)
    return state, episodes.observe(state)


@partial(jax.jit, static_argnames="static", compiler_options=OPTIONS)
def _recorded(
    jobs: Jobs, params: DwaParams, state: Any, *, static: DwaStatic
) -> tuple[Any, Outcome, jax.Array, jax.Array]:
    """RECORDED steps more, what is seen after each, and whether all episodes have ended."""
    program = episodes.program(jobs, split(params, static))
    state, seen = lanes.record(program, state, RECORDED, episodes.observe)
    return state, program.result(state), seen, jnp.all(program.done(state))


def _collect(
    results: list[tuple[Any, ...]],
    batch: Batch,
    packed: PackedEpisodes,
    params: DwaParams,
    static: DwaStatic,
) -> NavigateResult:
    ends: list[Outcome] = [found[0] for found in results]
    usage: list[lanes.Usage] = [found[1] for found in results]
    steps = batch.join([end.steps for end in ends])
    length = batch.join([end.path_length for end in ends])
    time = (steps * np.asarray(params.dt, np.float64)).astype(np.float32)
    speed = np.divide(length, time, out=np.zeros_like(length), where=time > 0)
    trajectory = None
    if len(results[0]) > 2:
        most = int(steps.max()) + 1
        trajectory = batch.join([filled(found[2], most, axis=1)[:, :most] for found in results])
        if packed.origin.any():
            trajectory = trajectory.astype(np.float64)
            trajectory[..., :2] += packed.origin
    return NavigateResult(
        status=batch.join([end.status for end in ends]),
        time=time,
        path_length=length,
        mean_speed=speed,
        min_clearance=batch.join([end.min_clearance for end in ends]),
        steps=steps,
        trajectory=trajectory,
        occupancy=sum(float(u.busy) for u in usage) / sum(float(u.total) for u in usage),
    )
