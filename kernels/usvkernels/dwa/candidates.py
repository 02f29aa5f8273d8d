"""The dynamic window approach of Tan et al. 2022, traditional and with an obstacle search angle.

Lanes (independent episodes) lie on the LAST axis of every array, as in `window`.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.clearance import (
    FAR,
    Scalar,
    Sector,
    centres,
    fold_blocks,
    in_sector,
    nearest_squared,
    sector_of,
)
from usvkernels.dwa.params import Objective, Sampling, Vessel
from usvkernels.dwa.window import SLACK, Fan, Motion, Window, open_window, unknown_true
from usvkernels.trig import angle_between, sincos
from usvkernels.vessel import Complex, complex_product
from usvkernels.xla.single import single
from usvkernels.xla.stage import stage

Choice = tuple[Array, Array, Array]
"""Row and column of a candidate, int32[lanes], and whether there is one, bool[lanes]."""

Command = tuple[Array, Array]
"""Speed (m/s) and yaw rate (rad/s), float[lanes]."""

_at = partial(jax.lax.dynamic_index_in_dim, keepdims=False, allow_negative_indices=False)


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Candidates:
    """The window opened up: what each candidate command leads to and how it scores."""

    v: Array  # float[n_v, lanes], m/s
    w: Array  # float[n_w, lanes], rad/s
    end_x: Array  # float[n_v, n_w, lanes], m, predicted position
    end_y: Array  # float[n_v, n_w, lanes], m
    heading_error: Array  # float[n_v, n_w, lanes], rad, against the goal, at the end
    clearance: Array  # float[n_v, n_w, lanes], m, capped
    admissible: Array  # bool[n_v, n_w, lanes]
    score: Array  # float[n_v, n_w, lanes], -inf where not admissible


def _nearest_along(
    obstacles: Array,
    v_i: Array,
    fan: Fan,
    counted: list[Array] | None,
    dt: Scalar,
    horizon: int,
    least: Array,
) -> Array:
    """As `nearest_squared`, over all positions of the predicted trajectory after its start."""

    def advance(_: int, carry: tuple[Complex, Complex, Array]) -> tuple[Complex, Complex, Array]:
        chord, direction, least = carry
        chord = (chord[0] + dt * direction[0], chord[1] + dt * direction[1])
        point = (v_i[:, None] * chord[0], v_i[:, None] * chord[1])
        return (
            chord,
            complex_product(direction, fan.turn),
            nearest_squared(obstacles, point, counted, least),
        )

    origin = (jnp.zeros_like(fan.first[0]), jnp.zeros_like(fan.first[1]))
    return jax.lax.fori_loop(0, horizon, advance, (origin, fan.first, least))[2]


def _clearance(
    vessel: Vessel, sampling: Sampling, objective: Objective, sector: Sector, window: Window
) -> Array:
    """dist(v, w): from the predicted trajectory to the nearest circle that counts, capped.

    Returns:
        float[n_v, n_w, lanes] (m), negative inside a circle.
    """
    v_i, fan = window.v, window.fan
    end = (v_i[:, None] * fan.chord[0], v_i[:, None] * fan.chord[1])
    # Standing still is not going astern, whatever rounding makes of 0.
    astern = (v_i < -SLACK * sampling.v_step)[:, None]
    ahead = (
        jnp.where(astern, -fan.heading[0], fan.heading[0]),
        jnp.where(astern, -fan.heading[1], fan.heading[1]),
    )

    def fold(block: Array, least: Array) -> Array:
        counted = None
        if objective.method == "improved":
            counted = [in_sector(centre, end, ahead, sector) for centre in centres(block)]
        if objective.clearance == "endpoint":
            return nearest_squared(block, end, counted, least)
        if objective.clearance == "trajectory_and_start":
            still = jnp.zeros_like(end[0])
            least = nearest_squared(block, (still, still), counted, least)
        return _nearest_along(block, v_i, fan, counted, vessel.dt, sampling.horizon, least)

    nearest = fold_blocks(fold, window.obstacles, jnp.full_like(end[0], jnp.inf))
    dist = jnp.where(nearest < FAR / 2, nearest - sector.radius, objective.clear_distance)
    return jnp.where(dist > objective.clearance_cap, objective.clearance_cap, dist)


def candidates(
    vessel: Vessel,
    sampling: Sampling,
    objective: Objective,
    motion: Motion,
    obstacles: Array,
    radius: Scalar,
    goal: Array,
) -> Candidates:
    """Predict and score every command of the window (Tan et al. 2022, Eqs. 2 to 6).

    Args:
        vessel, sampling, objective: of the method.
        motion: the vessels.
        obstacles: float[2, K, lanes], centres (m); rows at FAR are padding.
        radius: of the circles about them (m).
        goal: float[2, lanes] (m).
    """
    sector = sector_of(objective.search_angle, radius, motion.rows.dtype)
    window = open_window(vessel, sampling, motion, obstacles)
    return _weigh(vessel, sampling, objective, sector, motion, goal, window)


def _weigh(
    vessel: Vessel,
    sampling: Sampling,
    objective: Objective,
    sector: Sector,
    motion: Motion,
    goal: Array,
    window: Window,
) -> Candidates:
    v_i, w_j, fan = window.v, window.w, window.fan
    dist = _clearance(vessel, sampling, objective, sector, window)
    east, north = v_i[:, None] * fan.chord[0], v_i[:, None] * fan.chord[1]
    to_goal = goal - motion.place
    to_east, to_north = to_goal[0] - east, to_goal[1] - north
    error = angle_between(
        fan.heading[0] * to_north - fan.heading[1] * to_east,
        fan.heading[0] * to_east + fan.heading[1] * to_north,
    )
    admissible = window.inside_v[:, None] & window.inside_w & (dist > 0.0)
    if objective.braking:
        v_square, w_square = (v_i * v_i)[:, None], w_j * w_j
        admissible &= (v_square <= 2.0 * dist * vessel.v_dec) & (
            w_square <= 2.0 * dist * vessel.w_dec
        )
    closeness = dist
    if objective.clearance_score == "reciprocal":
        closeness = -1.0 / (dist + sector.radius)
    parts = (jnp.pi - error, closeness, v_i[:, None])
    heading, clearance, velocity = _normalised(objective.normalise, parts, admissible)
    score = (
        objective.heading_weight * heading
        + objective.clearance_weight * clearance
        + objective.velocity_weight * velocity
    )
    return Candidates(
        v=v_i,
        w=w_j,
        end_x=motion.x + east,
        end_y=motion.y + north,
        heading_error=error,
        clearance=dist,
        admissible=admissible,
        score=jnp.where(admissible, score, -jnp.inf),
    )


def _normalised(how: str, parts: tuple[Array, ...], admissible: Array) -> tuple[Array, ...]:
    """Scores [n_v, n_w or 1, lanes] made comparable over the admissible candidates of a lane."""
    if how == "none":
        return parts
    if how == "sum":
        scales = single(_scales, parts, admissible)
        return tuple(part * scale for part, scale in zip(parts, scales, strict=True))
    return tuple(_in_range(part, admissible) for part in parts)


def _in_range(part: Array, admissible: Array) -> Array:
    low = jnp.min(jnp.where(admissible, part, jnp.inf), axis=(0, 1))
    high = jnp.max(jnp.where(admissible, part, -jnp.inf), axis=(0, 1))
    return (part - low) * jnp.where(high > low, 1.0 / (high - low), 0.0)


@jax.jit
def _scales(parts: tuple[Array, ...], admissible: Array) -> list[Array]:
    """One over the sum of each part's magnitudes; the sum is always taken in the same order.

    XLA's reduction picks its order by the number of lanes, and one job in a thousand then ends
    another way in 1,024 lanes than in 256.
    """

    def add(j: Array, totals: tuple[Array, ...]) -> tuple[Array, ...]:
        among = _at(admissible, j, axis=1)
        columns = [_at(part, j if part.shape[1] > 1 else 0, axis=1) for part in parts]
        for i in range(admissible.shape[0]):
            counted = (jnp.where(among[i], jnp.abs(column[i]), 0.0) for column in columns)
            totals = tuple(map(jnp.add, totals, counted))
        return totals

    zero = jnp.zeros_like(parts[0][0, 0])
    totals = jax.lax.fori_loop(0, admissible.shape[1], add, (zero,) * len(parts))
    return [jnp.where(total > 0.0, 1.0 / total, 0.0) for total in totals]


def choose(found: Candidates) -> Choice:
    """Row and column of the best candidate, the first of equals, and whether there is one."""
    return single(_best, found.score)


@jax.jit
def _best(score: Array) -> Choice:
    n_v, n_w, lanes = score.shape

    def better(i: Array, best: tuple[Array, Array]) -> tuple[Array, Array]:
        row = _at(score, i, axis=0)
        for j in range(n_w):
            higher = row[j] > best[0]
            best = jnp.where(higher, row[j], best[0]), jnp.where(higher, i * n_w + j, best[1])
        return best

    first = (jnp.full(lanes, -jnp.inf, score.dtype), jnp.zeros(lanes, jnp.int32))
    best, index = jax.lax.fori_loop(0, n_v, better, first)
    return index // n_w, index % n_w, jnp.isfinite(best)


def decide(
    vessel: Vessel,
    sampling: Sampling,
    objective: Objective,
    motion: Motion,
    obstacles: Array,
    radius: Scalar,
    goal: Array,
) -> Command:
    """Speed and yaw rate to execute next (m/s, rad/s), float[lanes]; arguments as `candidates`."""
    sector = sector_of(objective.search_angle, radius, motion.rows.dtype)
    window = open_window(vessel, sampling, motion, obstacles)
    go = unknown_true(vessel.dt)
    return stage(go, _decide, vessel, sampling, objective, sector, motion, goal, window)


@jax.jit  # traced once for all branches of a stage
def _decide(
    vessel: Vessel,
    sampling: Sampling,
    objective: Objective,
    sector: Sector,
    motion: Motion,
    goal: Array,
    window: Window,
) -> Command:
    found = _weigh(vessel, sampling, objective, sector, motion, goal, window)
    command = partial(_command, objective.when_blocked)
    return single(command, vessel, sampling, motion, goal, found.v, found.w, found.score)


def _command(
    when_blocked: str,
    vessel: Vessel,
    sampling: Sampling,
    motion: Motion,
    goal: Array,
    v_i: Array,
    w_j: Array,
    score: Array,
) -> Command:
    """The best candidate's command, or that of a vessel without an admissible one."""
    row, column, any_admissible = _best(score)
    v = v_i[0] + row.astype(score.dtype) * sampling.v_step
    w = w_j[0] + column.astype(score.dtype) * sampling.w_step
    blocked_v, blocked_w = _blocked(when_blocked, vessel, motion, goal)
    return jnp.where(any_admissible, v, blocked_v), jnp.where(any_admissible, w, blocked_w)


def _blocked(how: str, vessel: Vessel, motion: Motion, goal: Array) -> Command:
    v = _towards_zero(motion.v, vessel.v_dec * vessel.dt)
    if how == "brake":
        return v, _towards_zero(motion.w, vessel.w_dec * vessel.dt)
    sin, cos = sincos(motion.psi)
    side = cos * (goal[1] - motion.y) - sin * (goal[0] - motion.x)
    change = jnp.where(side >= 0.0, vessel.w_acc, -vessel.w_dec) * vessel.dt
    return v, jnp.clip(motion.w + change, vessel.w_min, vessel.w_max)


def _towards_zero(rate: Array, change: Scalar) -> Array:
    return jnp.sign(rate) * jnp.maximum(jnp.abs(rate) - change, 0.0)
