"""Obstacles that move or differ in size, as the window's candidates meet them.

A candidate is held for the prediction's horizon, a few control periods of turning, and its course
then kept: two straight legs in the frame of an obstacle, along which the least distance has a
closed form. So nothing passes between two samples, however long the course.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.clearance import Scalar
from usvkernels.fleet.approach import dot
from usvkernels.vessel import Complex

TINY = 1e-12
"""Keeps the time to the closest point finite where nothing closes; (m/s)^2."""

ESCAPE = 0.999999
"""Of the present distance: within `reach` already, a candidate must come no closer than this."""


class Circles(NamedTuple):
    """What moves on straight courses; lanes last."""

    rows: Array  # float[6, K, lanes], ROWS of each, FAR pads
    number: Array | int  # int32[], how many of K, the first, any lane has to look at


ROWS = ("east", "north", "velocity_east", "velocity_north", "reach", "touch")
"""Place relative to the vessel (m), velocity less the vessel's drift (m/s), and distances from the
centre: that is too close, and that is a collision (m)."""


class Traffic(NamedTuple):
    """What a vessel keeps clear of."""

    weighing: Circles  # whose distance scores as well
    others: Circles
    course: Array  # float[lanes], how long the course is looked along after the turn (s)


class Legs(NamedTuple):
    """What candidates do, less the vessel's place and drift; [n_w, lanes], or of one yaw rate."""

    turn: Complex  # mean velocity while turning, at 1 m/s
    course: Complex  # velocity after it, at 1 m/s
    bulge: Array  # m by which the turn may leave its chord, at 1 m/s


class Times(NamedTuple):
    """How long they do it."""

    turning: Array  # s, [lanes]
    course: Array  # s, [lanes]
    stopping: Array  # s, [n_v, lanes]


def least_distance(traffic: Traffic, legs: Legs, times: Times, v: Array) -> Array:
    """How clear of the traffic the candidates of one yaw rate stay.

    Args:
        traffic: what there is.
        legs, times: of the candidates.
        v: their speeds, float[n_v, lanes] (m/s).

    Returns:
        float[n_v, lanes], least distance (m) to what is too close, along turn and course, inf
        where there is nothing; -inf for candidates that are not clear, which come nearer than too
        close before the vessel could have stopped.
    """

    def nearer(circle: Array, weighs: bool, least: Array) -> Array:
        return _nearer(circle, legs, times, v, weighs, least)

    return _folded(traffic, nearer, jnp.full(v.shape, jnp.inf, v.dtype))


def _folded(traffic: Traffic, fold: Callable[[Array, bool, Array], Array], found: Array) -> Array:
    """Every circle, ROWS of it, and whether it weighs, folded into what was found."""
    for circles, weighs in ((traffic.weighing, True), (traffic.others, False)):
        if not circles.rows.shape[1]:
            continue

        def one(k: Array, found: Array, rows: Array, weighs: bool) -> Array:
            return fold(rows[:, k], weighs, found)

        each = partial(one, rows=circles.rows, weighs=weighs)
        found = jax.lax.fori_loop(0, circles.number, each, found)
    return found


def step_is_clear(traffic: Traffic, bow: Complex, dt: Scalar, v: Array) -> Array:
    """Whether the next step, which is along the heading whatever the yaw rate, touches nothing.

    Beside what is close, the chord of a turn may lead away while its first step comes nearer.

    Args:
        traffic: what there is.
        bow: unit vector of the heading.
        dt: control period (s).
        v: speeds, float[n_v, lanes] (m/s).

    Returns:
        bool[n_v, lanes].
    """

    def also(circle: Array, _: bool, clear: Array) -> Array:
        east, north, *moves, reach, _touch = circle
        place = east, north
        closing = moves[0] - v * bow[0], moves[1] - v * bow[1]
        near = _square(_at(place, closing, _closest(place, closing, dt)))
        allowed = less(reach, ESCAPE * jnp.sqrt(_square(place)))
        return clear & (near > allowed * allowed)

    return _folded(traffic, also, jnp.ones(v.shape, bool))


def bulge(angle: Scalar) -> Array:
    """Height of an arc over its chord, for one of length 1 that turns by up to pi; an upper bound.

    That is half the tangent of a quarter of the angle, over a chord no longer than the arc.
    """
    quarter = jnp.abs(angle) / 4.0
    return 0.5 * (quarter + 0.45 * quarter * quarter * quarter)


def room_while_stopping(traffic: Traffic, legs: Legs, times: Times, v: Array) -> Array:
    """Least distance to a collision until candidates of one speed have stopped (m).

    Args:
        traffic: what there is.
        legs, times: of the candidates; the stopping time is [lanes].
        v: their speed, float[lanes] (m/s).

    Returns:
        float[n_w, lanes], inf where there is nothing.
    """
    bulge = jnp.abs(v) * legs.bulge

    def nearer(circle: Array, _: bool, least: Array) -> Array:
        on_turn, soon, _all = _squares(circle, legs, times, v)
        return less(less(jnp.sqrt(on_turn) - bulge, jnp.sqrt(soon)) - circle[5], least)

    return _folded(traffic, nearer, jnp.full(legs.bulge.shape, jnp.inf, v.dtype))


def _nearer(circle: Array, legs: Legs, times: Times, v: Array, weighs: bool, least: Array) -> Array:
    """Fold a circle, ROWS of it, into the least distance, -inf for a candidate that is not clear.

    One array holds both: of two, XLA would compute the approach anew for each.
    """
    reach, bulge = circle[4], jnp.abs(v) * legs.bulge
    on_turn, soon, far = _squares(circle, legs, times, v)
    escape = ESCAPE * jnp.sqrt(_square((circle[0], circle[1])))
    on_turn_allowed, allowed = less(reach + bulge, escape), less(reach, escape - bulge)
    clear = on_turn > on_turn_allowed * on_turn_allowed
    clear &= soon > allowed * jnp.abs(allowed)
    if weighs:
        least = less(less(jnp.sqrt(on_turn) - bulge, jnp.sqrt(far)) - reach, least)
    return jnp.where(clear, least, -jnp.inf)


def _squares(circle: Array, legs: Legs, times: Times, v: Array) -> tuple[Array, Array, Array]:
    """Least squared distances (m^2) to a circle's centre.

    On the turn's chord, on the course until the vessel could have stopped, and on all of it.
    """
    place, velocity = (circle[0], circle[1]), (circle[2], circle[3])
    turn = velocity[0] - v * legs.turn[0], velocity[1] - v * legs.turn[1]
    course = velocity[0] - v * legs.course[0], velocity[1] - v * legs.course[1]
    at_end = _at(place, turn, times.turning)
    on_turn = _square(_at(place, turn, _closest(place, turn, times.turning)))
    time = _closest(at_end, course, times.course)
    soon = _square(_at(at_end, course, less(time, times.stopping)))
    return on_turn, soon, _square(_at(at_end, course, time))


def _closest(place: Complex, closing: Complex, lasts: Scalar) -> Array:
    square = _square(closing)
    square = jnp.where(square > TINY, square, TINY)
    time = -dot(place, closing) / square
    return less(jnp.where(time > 0.0, time, 0.0), lasts)


def less(a: Array, b: Scalar) -> Array:
    """The lesser; jnp.minimum spends three more operations on NaN."""
    return jnp.where(a < b, a, b)


def _at(place: Complex, closing: Complex, time: Scalar) -> Complex:
    return place[0] + closing[0] * time, place[1] + closing[1] * time


def _square(vector: Complex) -> Array:
    return dot(vector, vector)
