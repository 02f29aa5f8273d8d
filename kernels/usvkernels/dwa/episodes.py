"""Closed-loop episodes under the dynamic window approach, as a program for the lanes."""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.candidates import Command, decide
from usvkernels.dwa.charted import Charted, near
from usvkernels.dwa.clearance import FAR, Scalar, nearest_distance
from usvkernels.dwa.params import Rules, Settings, Vessel
from usvkernels.dwa.window import Motion, unknown_true
from usvkernels.lanes import Program
from usvkernels.status import Status
from usvkernels.trig import wrap_angle
from usvkernels.vessel import PLANTS, Plant, Pose
from usvkernels.xla.single import single
from usvkernels.xla.stage import stage


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
    swept: dict[int, Array]  # float[lanes], the settings that differ, by place among the leaves

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


def program(jobs: Jobs, settings: Settings) -> Program:
    """Episodes of `jobs` as a program for `lanes.run`.

    Args:
        jobs: the episodes.
        settings: leaves scalar, or float[n] with one value per episode.
    """
    leaves, tree = jax.tree.flatten(settings)
    swept = {place: leaf for place, leaf in enumerate(leaves) if jnp.ndim(leaf) == 1}

    def settings_of(own: dict[int, Array]) -> Settings:
        return jax.tree.unflatten(tree, [own.get(place, leaf) for place, leaf in enumerate(leaves)])

    def start(job: Array) -> Episode:
        per_lane = {place: leaf[job] for place, leaf in swept.items()}
        return _start(jobs, settings_of(per_lane).rules, per_lane, job)

    def step(episode: Episode) -> Episode:
        return _step(jobs.chart, settings_of(episode.swept), episode)

    def result(episode: Episode) -> Outcome:
        return _outcome(settings_of(episode.swept).rules, episode)

    def taken(episode: Episode) -> Array:
        return episode.steps

    return Program(start=start, step=step, done=_ended, result=result, taken=taken)


def _start(jobs: Jobs, rules: Rules, swept: dict[int, Array], job: Array) -> Episode:
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
    there = _within(x - goal[0], y - goal[1], rules.goal_tolerance)
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
    return near(chart, episode.motion.x, episode.motion.y)


def _step(chart: Charted | None, settings: Settings, episode: Episode) -> Episode:
    """Decide, execute one control period, and see what came of it."""
    vessel, sampling, objective, rules = settings
    obstacles = sensed(chart, episode)
    motion, goal = episode.motion, episode.goal
    command = decide(vessel, sampling, objective, motion, obstacles, rules.radius, goal)
    go = unknown_true(vessel.dt)
    reals, counts = stage(go, _sail, vessel, rules, episode, obstacles, command)
    return replace(episode, reals=reals, counts=counts)


@jax.jit  # traced once for all branches of a stage
def _sail(
    vessel: Vessel,
    rules: Rules,
    episode: Episode,
    obstacles: Array,
    command: Command,
) -> tuple[Array, Array]:
    """`reals` and `counts` after one control period under the command (m/s, rad/s)."""
    pose = _move(vessel, episode.motion, command)
    here = nearest_distance(obstacles, pose[0], pose[1])
    return single(_judge, vessel.dt, rules, episode, command, pose, here)


def _move(vessel: Vessel, motion: Motion, command: Command) -> Pose:
    """The pose after one control period under the command: here the plant is chosen."""
    if isinstance(vessel.plant, str):
        return single(partial(_moved, PLANTS[vessel.plant]), vessel.dt, motion, command)
    # Nobody knows what a user's function does, and not all of XLA compiles as a single piece.
    own = partial(_moved_freely, vessel.plant)
    return stage(unknown_true(vessel.dt), own, vessel.dt, motion, command)


def _moved(plant: Plant, dt: Scalar, motion: Motion, command: Command) -> Pose:
    return plant(motion.x, motion.y, motion.psi, *command, dt)


def _moved_freely(plant: Plant, dt: Scalar, motion: Motion, command: Command) -> Pose:
    """As `_moved`, whatever the heading's turn and the precision that come back."""
    real = motion.rows.dtype
    x, y, psi = (jnp.asarray(part, real) for part in _moved(plant, dt, motion, command))
    return x, y, wrap_angle(psi)


def _judge(
    dt: Scalar, rules: Rules, episode: Episode, command: Command, pose: Pose, here: Array
) -> tuple[Array, Array]:
    """What came of a step to `pose`, whose nearest obstacle's centre is `here` metres away."""
    (v, w), (x, y, psi), goal = command, pose, episode.goal
    steps = episode.steps + 1
    progress = ~_within(x - episode.anchor[0], y - episode.anchor[1], rules.stuck_distance)
    anchor_step = jnp.where(progress, steps, episode.anchor_step)
    anchor = jnp.where(progress, jnp.stack([x, y]), episode.anchor)
    status = jnp.where(steps >= rules.max_steps, int(Status.TIMED_OUT), int(Status.RUNNING))
    idle = (steps - anchor_step).astype(x.dtype) * dt
    status = jnp.where(idle >= rules.stuck_time, int(Status.STUCK), status)
    there = _within(x - goal[0], y - goal[1], rules.goal_tolerance)
    status = jnp.where(there, int(Status.REACHED), status)
    status = jnp.where(here < rules.radius, int(Status.COLLIDED), status)
    length = episode.length + jnp.abs(v) * dt
    nearest = jnp.minimum(episode.nearest, here)
    return (
        jnp.stack([x, y, psi, v, w, length, nearest, *anchor]),
        jnp.stack([status, steps, anchor_step]),
    )


def _within(east: Array, north: Array, distance: Array | float) -> Array:
    return east * east + north * north <= distance * distance


def _outcome(rules: Rules, episode: Episode) -> Outcome:
    clear = episode.nearest >= FAR / 2
    return Outcome(
        status=episode.status,
        steps=episode.steps,
        path_length=episode.length,
        min_clearance=jnp.where(clear, jnp.inf, episode.nearest - rules.radius),
    )


def observe(episode: Episode) -> Array:
    """What a recorded trajectory keeps: x, y, psi, v, w; float[5, lanes]."""
    return episode.reals[:5]
