"""Closed-loop episodes under the dynamic window approach, as a program for the lanes."""

from dataclasses import dataclass, fields, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.candidates import decide
from usvkernels.dwa.clearance import FAR, nearest_distance
from usvkernels.dwa.params import DwaParams, DwaStatic
from usvkernels.dwa.window import Motion, unknown_true
from usvkernels.lanes import Program
from usvkernels.status import Status
from usvkernels.vessel import unicycle_step
from usvkernels.xla.single import single
from usvkernels.xla.stage import stage

Pose = tuple[Array, Array, Array]
"""x, y (m), psi (rad), each float[lanes]."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Charted:
    """A shared map: for each of its cells, the blocked cells that a vessel there can sense."""

    table: Array  # int32[height * width, K], flat numbers of blocked cells, -1 pads
    width: Array  # int32, cells in a row
    cell_size: Array  # m; the corner of cell (0, 0) is the origin of the episodes


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Jobs:
    """Episodes to run, one per row.

    Exactly one of `obstacles` and `chart` is given.
    """

    start: Array  # float[n, 3], x, y (m), psi (rad)
    goal: Array  # float[n, 2], m
    obstacles: Array | None = None  # float[n, 2, K], centres (m), FAR pads
    chart: Charted | None = None


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Episode:
    """Episodes under way; lanes are the last axis.

    What changes lies in two arrays: each more would be kept, and copied, by operations of its own
    in every step.
    """

    reals: Array  # float[9, lanes]: `motion`, `length`, `nearest` and `anchor`
    counts: Array  # int32[3, lanes]: `status`, `steps` and `anchor_step`
    goal: Array  # float[2, lanes], m
    obstacles: Array | None  # float[2, K, lanes], m; None where a chart is sensed
    swept: dict[str, Array]  # float[lanes], the parameters that differ between episodes

    @property
    def motion(self) -> Motion:
        """Pose and rates."""
        return Motion(self.reals)

    @property
    def length(self) -> Array:
        """Distance sailed (m)."""
        return self.reals[5]

    @property
    def nearest(self) -> Array:
        """Least distance to an obstacle's centre so far (m)."""
        return self.reals[6]

    @property
    def anchor(self) -> Array:
        """Where the vessel last made progress, float[2, lanes] (m)."""
        return self.reals[7:]

    @property
    def status(self) -> Array:
        """`Status`, RUNNING until the episode ends."""
        return self.counts[0]

    @property
    def steps(self) -> Array:
        """Control periods so far."""
        return self.counts[1]

    @property
    def anchor_step(self) -> Array:
        """The step at `anchor`."""
        return self.counts[2]


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Outcome:
    """How episodes ended; leaves [episodes]."""

    status: Array  # int32, `Status`
    steps: Array  # int32, control periods executed
    path_length: Array  # float, m
    min_clearance: Array  # float, m; inf where no obstacle was ever near


def program(jobs: Jobs, params: DwaParams, static: DwaStatic) -> Program:
    """Episodes of `jobs` as a program for `lanes.run`.

    Args:
      jobs: the episodes.
      params: leaves scalar, or float[n] with one value per episode.
      static: choices of method.
    """
    swept = {f.name: getattr(params, f.name) for f in fields(params)}
    swept = {name: value for name, value in swept.items() if jnp.ndim(value) == 1}

    def start(job: Array) -> Episode:
        per_lane = {name: value[job] for name, value in swept.items()}
        return _start(jobs, replace(params, **per_lane), per_lane, job)

    def step(episode: Episode) -> Episode:
        return _step(jobs.chart, replace(params, **episode.swept), static, episode)

    def result(episode: Episode) -> Outcome:
        return _outcome(replace(params, **episode.swept), episode)

    def taken(episode: Episode) -> Array:
        return episode.steps

    return Program(start=start, step=step, done=_ended, result=result, taken=taken)


def _start(jobs: Jobs, params: DwaParams, swept: dict[str, Array], job: Array) -> Episode:
    x, y, psi = jobs.start[job].T
    goal = jobs.goal[job].T
    still = jnp.zeros_like(x)
    obstacles = None if jobs.obstacles is None else jnp.moveaxis(jobs.obstacles[job], 0, -1)
    episode = Episode(
        reals=jnp.stack([x, y, psi, still, still, still, still, x, y]),
        counts=jnp.zeros((3, *job.shape), jnp.int32),
        goal=goal,
        obstacles=obstacles,
        swept=swept,
    )
    nearest = nearest_distance(sensed(jobs.chart, episode), x, y)
    there = _within(x - goal[0], y - goal[1], params.goal_tolerance)
    status = jnp.where(there, int(Status.REACHED), episode.status)
    return replace(
        episode,
        reals=episode.reals.at[6].set(nearest),
        counts=episode.counts.at[0].set(status),
    )


def _ended(episode: Episode) -> Array:
    return episode.status != int(Status.RUNNING)


def sensed(chart: Charted | None, episode: Episode) -> Array:
    """Centres of the obstacles that each vessel sees, float[2, K, lanes] (m), FAR pads."""
    if chart is None:
        assert episode.obstacles is not None
        return episode.obstacles
    width, cell = chart.width, chart.cell_size
    column = jnp.clip(jnp.floor(episode.motion.x / cell).astype(jnp.int32), 0, width - 1)
    last = chart.table.shape[0] // width - 1
    row = jnp.clip(jnp.floor(episode.motion.y / cell).astype(jnp.int32), 0, last)
    blocked = chart.table[row * width + column].T
    east = ((blocked % width).astype(cell.dtype) + 0.5) * cell
    north = ((blocked // width).astype(cell.dtype) + 0.5) * cell
    return jnp.where(blocked < 0, FAR, jnp.stack([east, north]))


def _step(chart: Charted | None, params: DwaParams, static: DwaStatic, episode: Episode) -> Episode:
    """Decide, execute one control period, and see what came of it."""
    obstacles = sensed(chart, episode)
    command = decide(params, static, episode.motion, obstacles, episode.goal)
    sail = partial(_sail, static)
    reals, counts = stage(unknown_true(params), sail, params, episode, obstacles, command)
    return replace(episode, reals=reals, counts=counts)


@partial(jax.jit, static_argnums=0)  # traced once for all branches of a stage
def _sail(
    static: DwaStatic,
    params: DwaParams,
    episode: Episode,
    obstacles: Array,
    command: tuple[Array, Array],
) -> tuple[Array, Array]:
    """`reals` and `counts` after one control period under the command (m/s, rad/s)."""
    pose = single(partial(_move, static), params, episode, command)
    here = nearest_distance(obstacles, pose[0], pose[1])
    return single(partial(_judge, static), params, episode, command, pose, here)


def _move(
    static: DwaStatic, params: DwaParams, episode: Episode, command: tuple[Array, Array]
) -> Pose:
    move = _turn_first if static.heading_first else unicycle_step
    motion = episode.motion
    return move(motion.x, motion.y, motion.psi, *command, params.dt)


def _judge(
    static: DwaStatic,
    params: DwaParams,
    episode: Episode,
    command: tuple[Array, Array],
    pose: Pose,
    here: Array,
) -> tuple[Array, Array]:
    """What came of a step to `pose`, whose nearest obstacle's centre is `here` metres away."""
    (v, w), (x, y, psi), goal = command, pose, episode.goal
    steps = episode.steps + 1
    progress = ~_within(x - episode.anchor[0], y - episode.anchor[1], params.stuck_distance)
    anchor_step = jnp.where(progress, steps, episode.anchor_step)
    anchor = jnp.where(progress, jnp.stack([x, y]), episode.anchor)
    status = jnp.where(steps >= static.max_steps, int(Status.TIMED_OUT), int(Status.RUNNING))
    idle = (steps - anchor_step).astype(x.dtype) * params.dt
    status = jnp.where(idle >= params.stuck_time, int(Status.STUCK), status)
    there = _within(x - goal[0], y - goal[1], params.goal_tolerance)
    status = jnp.where(there, int(Status.REACHED), status)
    status = jnp.where(here < params.radius, int(Status.COLLIDED), status)
    length = episode.length + jnp.abs(v) * params.dt
    nearest = jnp.minimum(episode.nearest, here)
    return (
        jnp.stack([x, y, psi, v, w, length, nearest, *anchor]),
        jnp.stack([status, steps, anchor_step]),
    )


def _turn_first(x: Array, y: Array, psi: Array, v: Array, w: Array, dt: Array | float) -> Pose:
    x, y, turned = unicycle_step(x, y, psi + w * dt, v, jnp.zeros_like(w), dt)
    return x, y, turned


def _within(east: Array, north: Array, distance: Array | float) -> Array:
    return east * east + north * north <= distance * distance


def _outcome(params: DwaParams, episode: Episode) -> Outcome:
    clear = episode.nearest >= FAR / 2
    return Outcome(
        status=episode.status,
        steps=episode.steps,
        path_length=episode.length,
        min_clearance=jnp.where(clear, jnp.inf, episode.nearest - params.radius),
    )


def observe(episode: Episode) -> Array:
    """What a recorded trajectory keeps: x, y, psi, v, w; float[5, lanes]."""
    return episode.reals[:5]
