"""Closed-loop episodes of fleets, as a program for the lanes.

Vessels are an axis before the lanes: arrays of a fleet are [n, lanes], of its pairs [n, n, lanes].
"""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.candidates import Command
from usvkernels.dwa.charted import Charted, near
from usvkernels.dwa.clearance import FAR, Scalar
from usvkernels.fleet import guidance, steering
from usvkernels.fleet.approach import cross, dot, least_square
from usvkernels.fleet.models import MODELS
from usvkernels.fleet.params import Passage, Settings
from usvkernels.fleet.sight import Obstacles, between, minus, nearest_square, others, sums
from usvkernels.fleet.state import ABSENT, BOOKS, Fleet, Jobs, Outcome
from usvkernels.lanes import Program
from usvkernels.status import Status
from usvkernels.trig import angle_between, sincos
from usvkernels.vessel import Complex

AT_REST = 0.01
"""m/s, below which a vessel whose passage has ended has stopped: a hull with a mass never quite
does."""


MOST_AROUND = 6
"""Times that a vessel comes to its goal on another heading, after which it is stuck: a livelock."""


def program(jobs: Jobs, settings: Settings) -> Program:
    """Episodes of `jobs` as a program for `lanes.run`.

    Args:
        jobs: the episodes.
        settings: leaves scalar, or float[rows or 1, n] with one value per vessel.
    """
    leaves, tree = jax.tree.flatten(settings)
    swept = {place: leaf for place, leaf in enumerate(leaves) if jnp.ndim(leaf) == 2}

    def settings_of(own: dict[int, Array]) -> Settings:
        return jax.tree.unflatten(tree, [own.get(place, leaf) for place, leaf in enumerate(leaves)])

    def start(job: Array) -> Fleet:
        def of(leaf: Array) -> Array:
            return leaf[jnp.minimum(job, leaf.shape[0] - 1)].T

        own = {place: of(leaf) for place, leaf in swept.items()}
        return _start(jobs, settings_of(own), own, job)

    def step(fleet: Fleet) -> Fleet:
        return _step(jobs, settings_of(fleet.swept), fleet)

    def result(fleet: Fleet) -> Outcome:
        return _outcome(settings_of(fleet.swept), fleet)

    def taken(fleet: Fleet) -> Array:
        return fleet.steps

    return Program(start=start, step=step, done=_ended, result=result, taken=taken)


def _start(jobs: Jobs, settings: Settings, swept: dict[int, Array], job: Array) -> Fleet:
    x, y, psi, v = jnp.moveaxis(jobs.start[job], 0, -1).swapaxes(0, 1)
    still = jnp.zeros_like(x)
    far = jnp.full_like(x, jnp.inf)
    status = jobs.status[job].T
    obstacles = None
    if jobs.obstacles is not None:
        centre = _of_jobs(jobs.obstacles, job)
        velocity = None if jobs.velocities is None else _of_jobs(jobs.velocities, job)
        obstacles = Obstacles(centre, velocity)
    n = x.shape[0]
    extra = [still] * MODELS[settings.passage.model].extra
    zero = jnp.zeros_like(status)
    fleet = Fleet(
        reals=jnp.stack([x, y, psi, v, still, still, far, far, x, y, *extra]),
        counts=jnp.stack([status, zero, zero, zero, zero, zero, zero, zero, zero]),
        roles=jnp.zeros((n, n, len(job)), jnp.int32),
        present=status != ABSENT,
        obstacles=obstacles,
        job=job,
        steps=jnp.zeros_like(job),
        swept=swept,
    )
    at_rest = _sensed(jobs.chart, settings, fleet)._replace(velocity=None)
    return _judge(jobs, settings, fleet, fleet, at_rest)


def _of_jobs(rows: Array, job: Array) -> Array:
    """Float[rows or 1, 2, K] as float[2, K, 1, lanes]."""
    return jnp.moveaxis(rows[jnp.minimum(job, rows.shape[0] - 1)], 0, -1)[:, :, None]


def _ended(fleet: Fleet) -> Array:
    """Nobody is under way any more, and all have come to rest."""
    return ~jnp.any(fleet.under_way | (fleet.present & (fleet.reals[3] > AT_REST)), axis=0)


def _sensed(chart: Charted | None, settings: Settings, fleet: Fleet) -> Obstacles:
    """The obstacles that vessels see now."""
    if chart is not None:
        return Obstacles(near(chart, *fleet.place), None)
    assert fleet.obstacles is not None
    centre, velocity = fleet.obstacles
    if velocity is None:
        return fleet.obstacles
    time = fleet.steps.astype(centre.dtype) * settings.vessel.dt
    return Obstacles(centre + velocity * time, velocity)


def _step(jobs: Jobs, settings: Settings, fleet: Fleet) -> Fleet:
    """Decide, execute one control period, and see what came of it."""
    obstacles = _sensed(jobs.chart, settings, fleet)
    vessels = steering.sight(jobs.routes, settings, fleet)
    orders, held, roles, altered = steering.meet(settings, fleet, vessels, obstacles)
    beside = obstacles
    if jobs.chart is not None:
        beside = Obstacles(near(jobs.chart, *vessels.guide), None)
    command = steering.command(settings, fleet, vessels, orders, obstacles, beside)
    moved = _moved(settings, fleet, command, vessels.drift)
    held = held | fleet.returns
    index = guidance.advanced(
        jobs.routes, fleet.job, moved.place, fleet.index, held, settings.passage
    )
    steps = fleet.steps + 1
    index_step = jnp.where(index > fleet.index, steps, fleet.index_step)
    counts = moved.counts.at[3].set(index).at[4].set(index_step).at[5].set(altered)
    moved = replace(moved, counts=counts, roles=roles, steps=steps)
    return _judge(jobs, settings, fleet, moved, obstacles)


def _moved(settings: Settings, fleet: Fleet, command: Command, drift: Complex | None) -> Fleet:
    """The fleet after one control period under the commands; the drift is that of its start."""
    model, dt = MODELS[settings.passage.model], settings.vessel.dt
    wind = None
    if settings.environment is not None:
        # Whose passage has ended lies at anchor.
        blows = jnp.where(fleet.under_way, 1.0, 0.0)
        wind = blows * settings.environment.wind[0], blows * settings.environment.wind[1]
    motion = model.advance(model.hull, fleet.motion, command, drift, wind, dt)
    made = jnp.abs(command[0]) * dt
    if drift is not None or model.extra:
        made = jnp.hypot(motion[0] - fleet.place[0], motion[1] - fleet.place[1])
    kept = [fleet.length + made, *fleet.reals[6:BOOKS]]
    return replace(fleet, reals=jnp.stack([*motion[:5], *kept, *motion[5:]]))


def _judge(
    jobs: Jobs, settings: Settings, before: Fleet, after: Fleet, obstacles: Obstacles
) -> Fleet:
    """What came of a step, along the segments between executed positions."""
    passage = settings.passage
    dt = settings.vessel.dt
    went = minus(after.place, before.place)
    apart = _separation(passage, before, went)
    clear = _clearance(passage, dt, before, went, obstacles)
    under_way, steps = before.under_way, after.steps
    x, y = after.place
    made = minus(after.place, after.anchor)
    way = dot(made, made) > passage.stuck_distance * passage.stuck_distance
    way &= under_way
    anchor_step = jnp.where(way, steps, after.anchor_step)
    idle = _idle(settings, steps, anchor_step)
    nowhere = (steps - after.index_step).astype(x.dtype) * dt >= passage.livelock_time
    nowhere |= after.around >= MOST_AROUND
    arrives, missed, returns = _approach(jobs, passage, after)
    index = jnp.where(missed, jobs.routes.gate[after.job].T, after.index)
    around = after.around + missed.astype(after.around.dtype)
    late = steps >= passage.max_steps
    status = jnp.where(late, int(Status.TIMED_OUT), int(Status.RUNNING))
    status = jnp.where(idle | nowhere, int(Status.STUCK), status)
    status = jnp.where(arrives, int(Status.REACHED), status)
    status = jnp.where(under_way, status, before.status)
    hit = (apart < 0.0) | (clear < 0.0)
    status = jnp.where(hit & before.present, int(Status.COLLIDED), status)
    ended_step = jnp.where(under_way, steps, before.ended_step)
    separation = jnp.where(before.present, jnp.minimum(after.separation, apart), jnp.inf)
    clearance = jnp.minimum(after.clearance, jnp.where(clear < FAR / 2, clear, jnp.inf))
    anchor = (jnp.where(way, x, after.anchor[0]), jnp.where(way, y, after.anchor[1]))
    reals = jnp.stack([*after.reals[:6], clearance, separation, *anchor, *after.reals[BOOKS:]])
    moving_step = jnp.where(after.reals[3] > AT_REST, steps, after.moving_step)
    kept = [index, *after.counts[4:6], moving_step, around, returns.astype(index.dtype)]
    counts = jnp.stack([status, ended_step, anchor_step, *kept])
    return replace(after, reals=reals, counts=counts)


def _idle(settings: Settings, steps: Array, anchor_step: Array) -> Array:
    """Whether vessels had made no way for so long by a step that they are stuck: a deadlock."""
    return (steps - anchor_step) * settings.vessel.dt >= settings.passage.stuck_time


def _approach(jobs: Jobs, passage: Passage, fleet: Fleet) -> tuple[Array, Array, Array]:
    """Who arrives, who comes to its goal on another heading, and who is on its way around.

    Who passes its goal on the way to the guide segment has not arrived. Who was off the heading, or
    passed by, goes around: back to where the segment begins, and along it once more.
    """
    gate = jobs.routes.gate[fleet.job].T
    approaches = (fleet.index >= gate) & ~fleet.returns
    bow = guidance.bow(jobs.routes, fleet.job)
    sin, cos = sincos(fleet.reals[2])
    off = angle_between(cross(bow, (cos, sin)), dot(bow, (cos, sin)))
    free = (bow[0] == 0.0) & (bow[1] == 0.0)
    fits = free | (off <= passage.heading_tolerance)
    left = minus(guidance.point(jobs.routes, fleet.job, jobs.routes.last[fleet.job].T), fleet.place)
    there = dot(left, left) <= passage.goal_tolerance * passage.goal_tolerance
    past = dot(bow, left) < -passage.goal_tolerance
    missed = approaches & ((there & ~fits) | past)
    begins = minus(guidance.point(jobs.routes, fleet.job, gate), fleet.place)
    back = fleet.returns & (dot(begins, begins) > passage.unit_length * passage.unit_length)
    return there & approaches & fits, missed, missed | back


def _separation(passage: Passage, before: Fleet, went: Complex) -> Array:
    """Least distance between hulls in a step, of each vessel to any other; m, [n, lanes]."""
    hull = jnp.broadcast_to(passage.hull_radius, before.present.shape)
    least = jnp.sqrt(least_square(between(before.place), between(went), 1.0)) - sums(hull)
    return jnp.min(jnp.where(others(before.present), least, jnp.inf), axis=1)


def _clearance(
    passage: Passage, dt: Scalar, before: Fleet, went: Complex, obstacles: Obstacles
) -> Array:
    """Least distance to an obstacle's circle in a step; m, [n, lanes]."""
    velocity = None if obstacles.velocity is None else obstacles.velocity * dt
    in_a_step = Obstacles(obstacles.centre, velocity)
    least = nearest_square(in_a_step, before.place, went, 1.0)
    return jnp.sqrt(least) - (passage.hull_radius + passage.obstacle_radius)


def _outcome(settings: Settings, fleet: Fleet) -> Outcome:
    stuck = fleet.status == int(Status.STUCK)
    deadlock = _idle(settings, fleet.ended_step, fleet.anchor_step)
    return Outcome(
        status=fleet.status.T,
        ended_step=fleet.ended_step.T,
        moving_step=fleet.moving_step.T,
        livelock=(stuck & ~deadlock).T,
        path_length=fleet.length.T,
        clearance=fleet.clearance.T,
        separation=fleet.separation.T,
        place=jnp.moveaxis(fleet.reals[:3], -1, 0).swapaxes(1, 2),
        steps=fleet.steps,
    )


def observe(fleet: Fleet) -> Array:
    """What a recorded trajectory keeps: x, y, psi, v, w; float[5, n, lanes]."""
    return fleet.reals[:5]
