"""Guided navigation of fleets: routes, the dynamic window, and encounters by a stated strategy."""

from dataclasses import dataclass, fields
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.angles import wrapped
from usvjax.batches import Batch, bucket, deal_longest_first, filled
from usvjax.checks import one_of
from usvjax.devices import COMPILER_OPTIONS, ONE_THREAD, chosen_devices
from usvjax.memory import check_memory
from usvjax.missions.fleet.environment import Environment
from usvjax.missions.fleet.inputs import Voyage, pack
from usvjax.missions.fleet.params import STRATEGIES, FleetParams, FleetStatic, split
from usvjax.programs import Programs
from usvjax.public import public
from usvkernels import lanes
from usvkernels.fleet import episodes
from usvkernels.fleet.params import Settings
from usvkernels.fleet.state import Jobs, Outcome
from usvkernels.lanes import LEAST_LANES
from usvkernels.status import Status

VESSELS_AT_ONCE = 256  # lanes times vessels: the state of a step stays in the second-level cache
MOST_ROWS = 8192  # episodes per call of a device; memory does not grow past it
JOBS_PER_LANE = 4
CHUNK = 8  # steps between two refills
RECORDED = 128  # steps between two looks whether all recorded episodes have ended
_LANE_BYTES = 64  # of a candidate, in a decision
OPTIONS = COMPILER_OPTIONS | ONE_THREAD

_programs = Programs()


@dataclass(frozen=True)
class FleetResult:
    """How B fleets of n vessels ended; numpy arrays, in the order of the arguments.

    Attributes:
        status: int32[B], `Status`: REACHED where every vessel did, else the worst ending of any:
            COLLIDED, NO_APPROACH, UNREACHABLE, STUCK or TIMED_OUT, in this order.
        vessel_status: int32[B, n], `Status` of each vessel, -1 for one that is masked.
        livelock: bool[B, n], whether a vessel is STUCK since it came no further along its route,
            though it moved (a livelock); else it stayed where it was (a deadlock).
        time: float32[B], duration (s) until the last vessel's passage ended.
        arrival_time: float32[B, n], when a vessel reached its goal (s); inf if it did not.
        path_length: float32[B, n], distance sailed (m), over ground.
        route_length: float32[B, n], of the route that it was to follow (m).
        min_clearance: float32[B, n], least distance from the hull to an obstacle's circle (m),
            along the segments between executed positions; negative on collision, inf without any.
        min_separation: float32[B], least distance between two hulls (m), likewise; inf for one
            vessel.
        heading_error: float32[B, n], of the heading at the goal against the one asked for, to
            either side (rad); NaN where none was asked for, or the goal not reached.
        rest_time: float32[B, n], when a vessel had come to rest (s).
        final: float64[B, n, 3], x (m), y (m), psi (rad) at rest.
        steps: int32[B], control periods executed, until all are at rest.
        trajectory: float32[B, T, n, 5] or None: x (m), y (m), psi (rad), v (m/s, through the
            water), w (rad/s) from the start on; after its end an episode repeats its last row.
    """

    status: np.ndarray
    vessel_status: np.ndarray
    livelock: np.ndarray
    time: np.ndarray
    arrival_time: np.ndarray
    path_length: np.ndarray
    route_length: np.ndarray
    min_clearance: np.ndarray
    min_separation: np.ndarray
    heading_error: np.ndarray
    rest_time: np.ndarray
    final: np.ndarray
    steps: np.ndarray
    trajectory: np.ndarray | None


WORST_FIRST = (
    Status.COLLIDED,
    Status.NO_APPROACH,
    Status.UNREACHABLE,
    Status.STUCK,
    Status.TIMED_OUT,
)
"""Endings of a vessel that are its fleet's, the first of these that any vessel has."""


@public("usvkernels.fleet")
def navigate(
    scene: Any,
    starts: Any,
    goals: Any,
    *,
    headings: Any = None,
    valid: Any = None,
    speeds: Any = None,
    velocities: Any = None,
    encounters: str = "rules",
    environment: Environment | None = None,
    params: FleetParams | None = None,
    static: FleetStatic | None = None,
    record: bool = False,
) -> FleetResult:
    """Sail B fleets of n vessels, each along a route of its own, meeting by a stated strategy.

    A route is the shortest on a grid (`astar`), pulled straight to its key points and laid at the
    unit length; the vessel steers by the dynamic window for a guidance point a look-ahead along it.
    Source: Wei & Zhang 2023, sections 2.1.3 to 2.4; readings in docs/equations.md. Collisions are
    judged along the segments between executed positions, of every pair and with every obstacle;
    who has arrived brakes, drops anchor and is collided with. Runs on all devices, or on that of an
    enclosing `jax.default_device`; a fleet's result does not depend on the others.

    Args:
        scene: None for open water; circles float[K, 2] or float[B, K, 2], centres (m), those
            farther than 500 km being padding; or a map whose blocked cells count as circles about
            their centres that cover them: a `GridMap`, or bool[H, W] or bool[B, H, W] with cells
            of 1 m.
        starts: float[B, n, 3], x (m), y (m), psi (rad).
        goals: float[B, n, 2] (m). Starts and goals lie within 200 km of the origin, or of the
            corner of a `GridMap` (single precision).
        headings: float[B, n] (rad), on which vessels are to arrive; by way of a point at the guide
            length before the goal, or a half of it at least. None: any.
        valid: bool[B, n], False for a place in the fleet that nobody takes. None: all are taken.
        speeds: float[B, n] at the start (m/s); None: at rest.
        velocities: float[K, 2], or float[B or 1, K, 2], of a scene's circles (m/s): each keeps its
            own, whatever it meets. Routes heed those at rest only. None: all are at rest.
        encounters: "rules" (the collision regulations), "wei2023" (the paper's coordination),
            "orca" (reciprocal velocities), or "none" (each as if alone).
        environment: current and wind; None for neither. Speeds, commands and limits are through
            the water, places and distances over ground; vessels steer for a course over ground.
        params: numbers; defaults to Wei & Zhang 2023, Tables 1 and 2, at a period of 1 s.
        static: choices of method.
        record: also return the trajectories; memory grows with the longest episode's steps.

    Returns:
        The outcomes, in the order of `starts`.

    Raises:
        BadTypeError: an argument of the wrong type or dtype.
        BadInputError: a wrong shape, NaN or infinity, impossible parameters, starts that overlap
            or lie in an obstacle, a uniform drift that a vessel cannot stem; the message names the
            argument and the first bad row.
    """
    params = FleetParams() if params is None else params
    static = FleetStatic() if static is None else static
    one_of("encounters", encounters, STRATEGIES)
    voyage = pack(
        scene,
        starts,
        goals,
        headings,
        valid,
        speeds,
        velocities,
        environment,
        params,
        static,
    )
    return sail(voyage, static, encounters, record)


def sail(voyage: Voyage, static: FleetStatic, encounters: str, record: bool = False) -> FleetResult:
    """Sail fleets that were checked.

    Args:
        voyage, static: what `pack` was given, and made of it.
        encounters, record: as of `navigate`.
    """
    devices = chosen_devices()
    n = voyage.start.shape[1]
    most = max(LEAST_LANES, VESSELS_AT_ONCE // n)
    rows = most if record else MOST_ROWS
    blocks = deal_longest_first(voyage.expected_time(), rows, len(devices))
    capacity = bucket(max(LEAST_LANES, len(blocks[0])))
    width = min(bucket(most), max(LEAST_LANES, capacity // JOBS_PER_LANE))
    check_memory(
        _LANE_BYTES * static.n_v * static.n_w * width * n * len(devices),
        f"static: {static.n_v} x {static.n_w} candidates of {width} fleets of {n} at once",
    )
    settings = split(voyage.params, static, encounters, voyage.environment)
    leaves, tree = jax.tree.flatten(settings)
    program = (record, tree, tuple(map(np.shape, leaves)), voyage.shape, capacity, width)

    def begin(rows: np.ndarray, count: int, device: jax.Device) -> Any:
        own = jax.tree.map(partial(_own, rows=rows), settings)
        jobs = voyage.rows(rows)
        if record:
            return _record(program, device, jobs, own)
        return _programs.run(program, device, _run, jobs, own, np.int32(count), width=width)

    batch = Batch(blocks, capacity, devices)
    ready = not record and _programs.ready(program, devices[: len(blocks)])
    return _collect(batch.run(begin, at_once=ready), batch, voyage)


def _own(leaf: Any, rows: np.ndarray) -> np.ndarray:
    """A setting of the given episodes, in single precision."""
    values = np.asarray(leaf, np.float32)
    return values[rows] if values.ndim == 2 and len(values) > 1 else values


@partial(jax.jit, static_argnames="width", compiler_options=OPTIONS)
def _run(
    jobs: Jobs, settings: Settings, count: jax.Array, *, width: int
) -> tuple[Outcome, lanes.Usage]:
    return lanes.run(
        episodes.program(jobs, settings),
        count,
        capacity=jobs.start.shape[0],
        lanes=width,
        chunk=CHUNK,
        max_steps=2 * settings.passage.max_steps,  # and to come to rest
        narrow=False,  # on a CPU who has arrived costs no decision; less to compile
    )


def _record(
    program: Any, device: jax.Device, jobs: Jobs, settings: Settings
) -> tuple[Outcome, np.ndarray]:
    """Sail a block some steps at a time until all of it has ended; trajectory [B, T, n, 5]."""
    state, seen = _programs.run((program, "first"), device, _first, jobs, settings)
    parts, ended, rows = [np.asarray(seen)[None]], False, len(jobs.start)
    while not ended:
        most = len(parts) * RECORDED
        check_memory(
            2 * seen.nbytes * most, f"record: {rows} fleets under way after {most:,} steps"
        )
        state, outcome, since, over = _programs.run(
            program, device, _recorded, jobs, settings, state
        )
        parts.append(np.asarray(since))
        ended = bool(over)
    return outcome, np.moveaxis(np.concatenate(parts), (3, 0, 2, 1), (0, 1, 2, 3))


@partial(jax.jit, compiler_options=OPTIONS)
def _first(jobs: Jobs, settings: Settings) -> tuple[Any, jax.Array]:
    """The first state of one lane per episode, and what is seen of it."""
    rows = jnp.arange(jobs.start.shape[0], dtype=jnp.int32)
    state = episodes.program(jobs, settings).start(rows)
    return state, episodes.observe(state)


@partial(jax.jit, compiler_options=OPTIONS)
def _recorded(
    jobs: Jobs, settings: Settings, state: Any
) -> tuple[Any, Outcome, jax.Array, jax.Array]:
    """RECORDED steps more, what is seen after each, and whether all episodes have ended."""
    program = episodes.program(jobs, settings)
    state, seen = lanes.record(program, state, RECORDED, episodes.observe)
    return state, program.result(state), seen, jnp.all(program.done(state))


def _collect(results: list[tuple[Any, ...]], batch: Batch, voyage: Voyage) -> FleetResult:
    ends: list[Outcome] = [found[0] for found in results]
    joined = {f.name: batch.join([getattr(end, f.name) for end in ends]) for f in fields(Outcome)}
    dt = np.asarray(voyage.params.dt, np.float64)
    status = joined["status"]
    reached = status == int(Status.REACHED)
    ended = joined["ended_step"] * dt
    trajectory = None
    if len(results[0]) > 1 and isinstance(results[0][1], np.ndarray):
        most = int(joined["steps"].max()) + 1
        trajectory = batch.join([filled(found[1], most, axis=1)[:, :most] for found in results])
        if voyage.origin.any():
            trajectory = trajectory.astype(np.float64)
            trajectory[..., :2] += voyage.origin
    return FleetResult(
        status=fleet_status(status),
        vessel_status=status,
        livelock=joined["livelock"],
        time=np.max(ended, axis=1).astype(np.float32),
        arrival_time=np.where(reached, ended, np.inf).astype(np.float32),
        path_length=joined["path_length"],
        route_length=voyage.plan.length.astype(np.float32),
        min_clearance=joined["clearance"],
        min_separation=joined["separation"].min(axis=1),
        heading_error=_heading_error(joined["place"][..., 2], voyage.heading, reached),
        rest_time=(joined["moving_step"] * dt).astype(np.float32),
        final=joined["place"] + np.append(voyage.origin, 0.0),
        steps=joined["steps"],
        trajectory=trajectory,
    )


def fleet_status(vessels: np.ndarray) -> np.ndarray:
    """Status of fleets by those of their vessels, int32[B, n]."""
    found = np.full(len(vessels), int(Status.REACHED), np.int32)
    for status in reversed(WORST_FIRST):
        found[np.any(vessels == int(status), axis=1)] = int(status)
    return found


def _heading_error(psi: np.ndarray, wanted: np.ndarray | None, reached: np.ndarray) -> np.ndarray:
    if wanted is None:
        return np.full(psi.shape, np.nan, np.float32)
    off = np.abs(wrapped(psi - wanted))
    return np.where(reached, off, np.nan).astype(np.float32)
