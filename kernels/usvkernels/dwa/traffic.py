"""Obstacles that move or differ in size, as the window's candidates meet them.

A candidate is held for the prediction's horizon, a few control periods of turning, and its course
then kept: two straight legs in the frame of an obstacle, along which the least distance has a
closed form. So nothing passes between two samples, however long the course.
"""

from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.clearance import FAR, Scalar
from usvkernels.dwa.params import STATIC, Objective, Sampling, Vessel
from usvkernels.dwa.window import Window
from usvkernels.vessel import Complex
from usvkernels.xla.single import single

TINY = 1e-12
"""Keeps the time to the closest point finite where nothing closes; (m/s)^2."""

ESCAPE = 0.999999
"""Of the present distance: within `reach` already, a candidate must come no closer than this."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Traffic:
    """What a vessel keeps clear of; lanes last."""

    place: Array  # float[2, K, lanes], relative to the vessel (m), FAR pads
    velocity: Array  # float[2, K, lanes], less the vessel's drift (m/s)
    reach: Array  # float[K, lanes], distance from the centre that is too close (m)
    course: Array  # float[lanes], how long the course is looked along after the turn (s)
    weighs: int = field(metadata=STATIC)  # rows, the first, whose distance scores as well


class _Legs(NamedTuple):
    """What the candidates of one yaw rate do, relative to the vessel's place and drift."""

    turn: Complex  # [lanes], mean velocity while turning, at 1 m/s
    course: Complex  # [lanes], velocity after it, at 1 m/s
    bulge: Array  # [lanes], m by which the turn may leave its chord, at 1 m/s


class _Times(NamedTuple):
    """How long they do it."""

    turning: Array  # s, [lanes]
    course: Array  # s, [lanes]
    stopping: Array  # s, [n_v, lanes]


def clear_of(
    traffic: Traffic, vessel: Vessel, sampling: Sampling, objective: Objective, window: Window
) -> tuple[Array, Array]:
    """How clear of the traffic the candidates stay.

    Returns:
        float[n_v, n_w, lanes], least distance (m) to what is too close, along turn and course,
        capped, for candidates that are clear; and bool[n_v, n_w, lanes], whether they are: no
        nearer than too close until the vessel could have stopped.
    """
    fan = window.fan
    turning = vessel.dt * sampling.horizon
    mean = fan.chord[0] / turning, fan.chord[1] / turning
    legs = _Legs(mean, fan.heading, turning * _bulge(window.w * turning))
    lasts = jnp.broadcast_to(jnp.asarray(turning, window.v.dtype), traffic.course.shape)
    times = _Times(lasts, traffic.course, jnp.abs(window.v) / vessel.v_dec)
    folded = partial(_folded, traffic.weighs)
    given = traffic.place, traffic.velocity, traffic.reach, legs, times, window.v
    least = single(folded, *given).swapaxes(0, 1)
    clear = least > -jnp.inf
    least = jnp.where(least < FAR / 2, least, objective.clear_distance)
    return _less(least, objective.clearance_cap), clear


def _folded(
    weighs: int, place: Array, velocity: Array, reach: Array, legs: _Legs, times: _Times, v: Array
) -> Array:
    """All rows folded into the least distances [n_w, n_v, lanes], -inf where not clear.

    A yaw rate after the other: what its candidates take on the way stays in the cache.
    """
    rows, n_w = reach.shape[0], legs.bulge.shape[0]

    def column(j: Array, found: Array) -> Array:
        own = jax.tree.map(lambda leaf: leaf[j], legs)

        def nearer(k: Array, least: Array, weighing: bool) -> Array:
            at, moves = (place[0, k], place[1, k]), (velocity[0, k], velocity[1, k])
            return _nearer(at, moves, reach[k], own, times, v, weighing, least)

        least = jnp.full(v.shape, jnp.inf, v.dtype)
        least = jax.lax.fori_loop(0, weighs, partial(nearer, weighing=True), least)
        least = jax.lax.fori_loop(weighs, rows, partial(nearer, weighing=False), least)
        return found.at[j].set(least)

    return jax.lax.fori_loop(0, n_w, column, jnp.zeros((n_w, *v.shape), v.dtype))


def _bulge(angle: Array) -> Array:
    """Height of an arc over its chord, for one of length 1 that turns by up to pi; an upper bound.

    That is half the tangent of a quarter of the angle, over a chord no longer than the arc.
    """
    quarter = jnp.abs(angle) / 4.0
    return 0.5 * (quarter + 0.45 * quarter * quarter * quarter)


def _nearer(
    place: Complex,
    velocity: Complex,
    reach: Array,
    legs: _Legs,
    times: _Times,
    v: Array,
    weighs: bool,
    least: Array,
) -> Array:
    """Fold a row into the least distance, -inf for a candidate that is not clear.

    One array holds both: of two, XLA would compute the approach anew for each.
    """
    bulge = jnp.abs(v) * legs.bulge
    turn = velocity[0] - v * legs.turn[0], velocity[1] - v * legs.turn[1]
    course = velocity[0] - v * legs.course[0], velocity[1] - v * legs.course[1]
    at_end = _at(place, turn, times.turning)
    on_turn = _square(_at(place, turn, _closest(place, turn, times.turning)))
    time = _closest(at_end, course, times.course)
    soon = _square(_at(at_end, course, _less(time, times.stopping)))
    escape = ESCAPE * jnp.sqrt(_square(place))
    on_turn_allowed, allowed = _less(reach + bulge, escape), _less(reach, escape - bulge)
    clear = on_turn > on_turn_allowed * on_turn_allowed
    clear &= soon > allowed * jnp.abs(allowed)
    if weighs:
        far = jnp.sqrt(_square(_at(at_end, course, time)))
        least = _less(_less(jnp.sqrt(on_turn) - bulge, far) - reach, least)
    return jnp.where(clear, least, -jnp.inf)


def _closest(place: Complex, closing: Complex, lasts: Scalar) -> Array:
    square = _square(closing)
    square = jnp.where(square > TINY, square, TINY)
    time = -_dot(place, closing) / square
    return _less(jnp.where(time > 0.0, time, 0.0), lasts)


def _less(a: Array, b: Scalar) -> Array:
    """The lesser; jnp.minimum spends three more operations on NaN."""
    return jnp.where(a < b, a, b)


def _at(place: Complex, closing: Complex, time: Scalar) -> Complex:
    return place[0] + closing[0] * time, place[1] + closing[1] * time


def _square(vector: Complex) -> Array:
    return vector[0] * vector[0] + vector[1] * vector[1]


def _dot(a: Complex, b: Complex) -> Array:
    return a[0] * b[0] + a[1] * b[1]
