"""What the dynamic window chooses among traffic.

Candidates score as those of Tan et al. 2022 in `usvkernels.dwa.candidates`; how clear they are,
`traffic` says. All of a decision is one piece, a yaw rate after the other, so that what its
candidates take on the way stays in the cache.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.dwa.candidates import Command
from usvkernels.dwa.params import Sampling, Vessel
from usvkernels.dwa.window import Motion, Window, open_window
from usvkernels.fleet.params import Objective
from usvkernels.fleet.traffic import (
    Legs,
    Times,
    Traffic,
    bulge,
    least_distance,
    less,
    room_while_stopping,
    step_is_clear,
)
from usvkernels.trig import angle_between
from usvkernels.vessel import Complex
from usvkernels.xla.single import single


class Asked(NamedTuple):
    """What a decision is about, apart from the traffic; leaves scalar or [.., lanes]."""

    vessel: Vessel
    sampling: Sampling
    objective: Objective
    motion: Array  # float[5, lanes], x, y, psi, v, w
    goal: Array  # float[2, lanes], m


def decide(asked: Asked, traffic: Traffic) -> Command:
    """Speed and yaw rate to execute next (m/s, rad/s), float[lanes]."""
    vessel, sampling = asked.vessel, asked.sampling
    motion = Motion(asked.motion)
    nothing = jnp.zeros((2, 0, asked.motion.shape[1]), asked.motion.dtype)
    window = open_window(vessel, sampling, motion, nothing)
    turning = jnp.broadcast_to(jnp.asarray(vessel.dt * sampling.horizon), traffic.course.shape)
    fan = window.fan
    legs = Legs(
        (fan.chord[0] / turning, fan.chord[1] / turning),
        fan.heading,
        turning * bulge(window.w * turning),
    )
    times = Times(turning, traffic.course, jnp.abs(window.v) / vessel.v_dec)
    to_goal = asked.goal - motion.place
    dt = jnp.asarray(vessel.dt)
    best, index, evading = single(_best, window, legs, times, dt, to_goal, traffic, asked.objective)
    row, column = index // sampling.n_w, index % sampling.n_w
    some = best > -jnp.inf
    row, column = jnp.where(some, row, 0), jnp.where(some, column, evading)
    v = window.v[0] + row.astype(best.dtype) * sampling.v_step
    w = window.w[0] + column.astype(best.dtype) * sampling.w_step
    return v, w


class _Parts(NamedTuple):
    """Of all candidates, [n_w, n_v, lanes]."""

    gap: Array  # rad, pi less the angle to the goal at the end of the turn; NaN where not admitted
    dist: Array  # m, capped


def _best(
    window: Window,
    legs: Legs,
    times: Times,
    dt: Array,
    to_goal: Array,
    traffic: Traffic,
    objective: Objective,
) -> tuple[Array, Array, Array]:
    """The best candidate, and what a vessel without one does.

    Returns:
        float[lanes], its score, -inf where none is admitted; int32[lanes], its number, row by row;
        and int32[lanes], the yaw rate of `_evading`.
    """
    v, n_w = window.v, window.w.shape[0]
    bow = window.fan.first[0][0], window.fan.first[1][0]
    serves = window.inside_v & step_is_clear(traffic, bow, dt, v)

    def column(j: Array, carry: tuple[_Parts, Array]) -> tuple[_Parts, Array]:
        parts, totals = carry
        least = least_distance(traffic, jax.tree.map(lambda leaf: leaf[j], legs), times, v)
        dist = less(least, objective.clearance_cap)
        chord = window.fan.chord[0][j], window.fan.chord[1][j]
        heading = window.fan.heading[0][j], window.fan.heading[1][j]
        admitted = serves & window.inside_w[j] & (least > -jnp.inf)
        gap = jnp.where(admitted, jnp.pi - _error(v, chord, heading, to_goal), jnp.nan)
        parts = _Parts(parts.gap.at[j].set(gap), parts.dist.at[j].set(dist))
        return parts, _added(totals, gap, dist, v)

    plane = jnp.zeros((n_w, *v.shape), v.dtype)
    none = jnp.zeros((3, v.shape[1]), v.dtype)
    parts, totals = lax.fori_loop(0, n_w, column, (_Parts(plane, plane), none))
    scale = jnp.where(totals > 0.0, 1.0 / totals, 0.0)
    best, index = _first_of_best(parts, v, scale, objective)
    return best, index, _evading(window, legs, times, traffic)


def _evading(window: Window, legs: Legs, times: Times, traffic: Traffic) -> Array:
    """The yaw rate, int32[lanes], on which a vessel brakes where nothing is clear.

    It keeps clearest until the vessel has stopped; of equals, as of one at rest, the least.
    """
    stopping = times._replace(stopping=times.stopping[0])
    room = room_while_stopping(traffic, legs, stopping, window.v[0])

    def clearer(j: Array, best: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        rate = jnp.abs(window.w[j])
        better = (room[j] > best[0]) | ((room[j] == best[0]) & (rate < best[1]))
        better &= window.inside_w[j]
        return (
            jnp.where(better, room[j], best[0]),
            jnp.where(better, rate, best[1]),
            jnp.where(better, j, best[2]),
        )

    none = jnp.full_like(window.w[0], -jnp.inf)
    first = none, jnp.full_like(none, jnp.inf), jnp.zeros(none.shape, jnp.int32)
    return lax.fori_loop(0, window.w.shape[0], clearer, first)[2]


def _error(v: Array, chord: Complex, heading: Complex, to_goal: Array) -> Array:
    """Angle (rad) to the goal at the end of a turn."""
    east, north = to_goal[0] - v * chord[0], to_goal[1] - v * chord[1]
    across = heading[0] * north - heading[1] * east
    return angle_between(across, heading[0] * east + heading[1] * north)


def _added(totals: Array, gap: Array, dist: Array, v: Array) -> Array:
    """Totals [3, lanes] of the parts' magnitudes, with those of a yaw rate that are admitted."""

    def add(i: Array, totals: Array) -> Array:
        magnitudes = jnp.stack([gap[i], jnp.abs(dist[i]), jnp.abs(v[i])])
        return totals + jnp.where(gap[i] == gap[i], magnitudes, 0.0)

    return lax.fori_loop(0, v.shape[0], add, totals)


def _first_of_best(
    parts: _Parts, v: Array, scale: Array, objective: Objective
) -> tuple[Array, Array]:
    n_w, n_v, lanes = parts.gap.shape

    def row(i: Array, best: tuple[Array, Array]) -> tuple[Array, Array]:
        speed = objective.velocity_weight * (v[i] * scale[2])
        for j in range(n_w):
            score = objective.heading_weight * (parts.gap[j, i] * scale[0])
            score += objective.clearance_weight * (parts.dist[j, i] * scale[1])
            score += speed
            higher = score > best[0]
            best = jnp.where(higher, score, best[0]), jnp.where(higher, i * n_w + j, best[1])
        return best

    first = jnp.full(lanes, -jnp.inf, v.dtype), jnp.zeros(lanes, jnp.int32)
    return lax.fori_loop(0, n_v, row, first)
