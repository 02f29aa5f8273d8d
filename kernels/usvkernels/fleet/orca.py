"""Optimal reciprocal collision avoidance (van den Berg et al. 2011), for vessels that must turn.

Each vessel takes, of the velocities that no neighbour's half-plane forbids, the one nearest to the
velocity that it wants; vessels share the change of a pair evenly, an obstacle shares none. Where
the half-planes leave nothing, the velocity that violates the worst of them least is taken. The
vessel then turns towards the velocity and sails at its component ahead.

Lines lie on the first axis, [m, lanes]; a line's left is allowed.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.dwa.clearance import FAR
from usvkernels.fleet.approach import cross, dot
from usvkernels.fleet.params import Encounters
from usvkernels.fleet.sight import Obstacles, Vessels, between, less_drift, minus, others, sums
from usvkernels.vessel import Complex
from usvkernels.xla.single import single

PARALLEL = 1e-6
"""Sine below which two lines do not meet."""

NEIGHBOURS = 10
"""Most that a vessel, or obstacles that it, heeds: the nearest."""


class Near(NamedTuple):
    """The nearest neighbours, [m, n, lanes], nearest first."""

    place: Complex  # relative, m
    velocity: Complex  # m/s
    reach: Array  # m
    share: Array
    valid: Array


class Lines(NamedTuple):
    """Half-planes of velocities, [m, lanes] each."""

    point: Complex  # m/s, on the line
    along: Complex  # unit vector; what is to its left is allowed
    valid: Array  # bool


def meet(
    how: Encounters, vessels: Vessels, circles: Obstacles, reach: Array, dt: Array | float
) -> Complex:
    """The velocities through the water that the vessels take, [n, lanes] (m/s).

    Args:
        how: the strategy's numbers.
        vessels: the fleet.
        circles: obstacles.
        reach: float[n, lanes], distance from their centres that is contact (m).
        dt: control period (s).
    """
    near = [_vessels_near(vessels), _circles_near(vessels, circles, reach)]
    joined = jax.tree.map(lambda a, b: jnp.concatenate([a, b]), *near)
    n, lanes = vessels.speed.shape

    def flat(leaf: Any) -> Any:
        return leaf.reshape(*leaf.shape[:-2], n * lanes) if jnp.ndim(leaf) else leaf

    # In the water about each vessel, where its speed has its limits.
    joined = joined._replace(velocity=less_drift(vessels, joined.velocity))
    sides = jax.tree.map(flat, joined)
    own = tuple(map(flat, less_drift(vessels, vessels.velocity)))
    # In a single piece, rounded in the same way in any number of lanes.
    horizon, step = flat(how.act_time), flat(dt)
    allowed = single(
        lines,
        sides.place,
        sides.velocity,
        own,
        sides.reach,
        horizon,
        step,
        sides.share,
        sides.valid,
    )
    speed = flat(vessels.speed)
    wanted = flat(vessels.course[0]) * speed, flat(vessels.course[1]) * speed
    east, north = best_velocity(allowed, wanted, speed)
    return east.reshape(n, lanes), north.reshape(n, lanes)


def _vessels_near(vessels: Vessels) -> Near:
    place = between(vessels.place)
    valid = others(vessels.present)
    square = jnp.where(valid, dot(place, place), jnp.inf)
    count = min(NEIGHBOURS, vessels.speed.shape[0] - 1)
    theirs = tuple(jnp.broadcast_to(v[None], square.shape) for v in vessels.velocity)
    # Who has arrived does not give way any more.
    share = jnp.broadcast_to(jnp.where(vessels.under_way, 0.5, 1.0)[None], square.shape)
    found = Near(place, (theirs[0], theirs[1]), sums(vessels.hull), share, valid)
    order = _nearest_first(square.swapaxes(0, 1), count)

    def pick(leaf: Array) -> Array:
        return jnp.take_along_axis(leaf.swapaxes(0, 1), order, axis=0)

    return jax.tree.map(pick, found)


def _circles_near(vessels: Vessels, circles: Obstacles, reach: Array) -> Near:
    place = circles.centre - jnp.stack(vessels.place)[:, None]
    square = place[0] * place[0] + place[1] * place[1]
    order = _nearest_first(square, min(NEIGHBOURS, square.shape[0]))
    east, north = (jnp.take_along_axis(part, order, axis=0) for part in place)
    velocity = jnp.zeros_like(east), jnp.zeros_like(east)
    if circles.velocity is not None:
        east_of, north_of = jnp.broadcast_to(circles.velocity, place.shape)
        velocity = (
            jnp.take_along_axis(east_of, order, axis=0),
            jnp.take_along_axis(north_of, order, axis=0),
        )
    own = jnp.broadcast_to(reach, east.shape)
    there = jnp.abs(east) + jnp.abs(north) < FAR / 2
    return Near((east, north), velocity, own, jnp.ones_like(east), there)


def _nearest_first(square: Array, count: int) -> Array:
    """Which of square [k, n, lanes] are least, first of equals first; int32[count, n, lanes]."""
    size = square.shape[0]
    earlier = (jnp.arange(size)[:, None] < jnp.arange(size))[:, :, None, None]
    before = (square[:, None] < square[None]) | ((square[:, None] == square[None]) & earlier)
    rank = jnp.sum(before, axis=0, dtype=jnp.int32)
    at = rank[None] == jnp.arange(count, dtype=jnp.int32)[:, None, None, None]
    return jnp.sum(jnp.where(at, jnp.arange(size)[None, :, None, None], 0), axis=1, dtype=jnp.int32)


def lines(
    place: Complex,
    velocity: Complex,
    own: Complex,
    reach: Array,
    horizon: Array | float,
    dt: Array | float,
    share: Array,
    valid: Array,
) -> Lines:
    """What velocities neighbours leave to a vessel.

    Args:
        place: of the neighbours relative to the vessel, [m, lanes] (m).
        velocity: theirs, [m, lanes] (m/s).
        own: the vessel's, [lanes] (m/s).
        reach: distance that is contact, [m, lanes] (m).
        horizon: how far ahead contact is to be avoided (s).
        dt: in which a contact that there is is to be resolved (s).
        share: of the change, which the vessel takes on; [m, lanes].
        valid: bool[m, lanes].
    """
    relative = own[0] - velocity[0], own[1] - velocity[1]
    square, apart = dot(place, place), reach * reach
    touching = square <= apart
    per = jnp.where(touching, 1.0 / dt, 1.0 / horizon)
    rest = relative[0] - per * place[0], relative[1] - per * place[1]
    length = jnp.sqrt(jnp.maximum(dot(rest, rest), 1e-20))
    unit = rest[0] / length, rest[1] / length
    ahead = dot(rest, place)
    on_cap = touching | ((ahead < 0.0) & (ahead * ahead > apart * length * length))
    leg = jnp.sqrt(jnp.maximum(square - apart, 0.0))
    over = 1.0 / jnp.maximum(square, 1e-20)
    left = cross(place, rest) > 0.0
    side = jnp.where(left, 1.0, -1.0)
    leg_along = (
        side * (place[0] * leg - side * place[1] * reach) * over,
        side * (side * place[0] * reach + place[1] * leg) * over,
    )
    along = (
        jnp.where(on_cap, unit[1], leg_along[0]),
        jnp.where(on_cap, -unit[0], leg_along[1]),
    )
    on_leg = dot(relative, leg_along)
    out = reach * per - length
    change = tuple(
        jnp.where(on_cap, out * cap, on_leg * other - now)
        for cap, other, now in zip(unit, leg_along, relative, strict=True)
    )
    point = own[0] + share * change[0], own[1] + share * change[1]
    return Lines(point, (along[0], along[1]), valid)


def best_velocity(allowed: Lines, wanted: Complex, most: Array) -> Complex:
    """The allowed velocity nearest to the wanted one, of at most `most` m/s, [lanes].

    Where there is none, the one that violates the worst line least.
    """
    found, failed = _nearest(allowed, wanted, most, aim=None)
    count = allowed.valid.shape[0]
    broken = jnp.where(jnp.any(failed, axis=0), jnp.argmax(failed, axis=0), count)
    return lax.cond(
        jnp.any(failed),
        lambda: _least_violation(allowed, found, broken, most),
        lambda: found,
    )


def _nearest(
    allowed: Lines, wanted: Complex, most: Array, aim: Complex | None
) -> tuple[Complex, Array]:
    """Lines taken in one by one: the best velocity so far, and at which line there was none left.

    Args:
        allowed: the lines.
        wanted: where to begin, [lanes].
        most: speed, [lanes].
        aim: a direction in which to go as far as can be, instead of near to `wanted`.

    Returns:
        The velocity before the first line that left nothing; bool[m, lanes], which line that was.
    """
    count = allowed.valid.shape[0]
    speed = jnp.sqrt(dot(wanted, wanted))
    if aim is None:
        shrink = jnp.where(speed > most, most / jnp.maximum(speed, 1e-20), 1.0)
        start = wanted[0] * shrink, wanted[1] * shrink
    else:
        start = aim[0] * most, aim[1] * most
    goal = wanted if aim is None else aim

    def take(i: Array, carry: tuple[Complex, Array]) -> tuple[Complex, Array]:
        found, failed = carry
        line = jax.tree.map(lambda leaf: leaf[i], allowed)
        off = line.point[0] - found[0], line.point[1] - found[1]
        violated = line.valid & (cross(line.along, off) > 0.0) & ~jnp.any(failed, axis=0)
        new, possible = _on_line(allowed, line, i, goal, most, aim is not None)
        moved = violated & possible
        found = jnp.where(moved, new[0], found[0]), jnp.where(moved, new[1], found[1])
        return found, failed.at[i].set(violated & ~possible)

    nothing = jnp.zeros(allowed.valid.shape, bool)
    return lax.fori_loop(0, count, take, (start, nothing))


def _on_line(
    allowed: Lines, line: Lines, i: Array, goal: Complex, most: Array, direct: bool
) -> tuple[Complex, Array]:
    """The best velocity on line i that the lines before it and the speed leave."""
    middle = dot(line.point, line.along)
    root = middle * middle + most * most - dot(line.point, line.point)
    half = jnp.sqrt(jnp.maximum(root, 0.0))
    before = allowed.valid & (jnp.arange(allowed.valid.shape[0]) < i)[:, None]
    below = cross((line.along[0][None], line.along[1][None]), allowed.along)
    off = line.point[0] - allowed.point[0], line.point[1] - allowed.point[1]
    above = cross(allowed.along, off)
    parallel = jnp.abs(below) <= PARALLEL
    at = above / jnp.where(parallel, 1.0, below)
    shut = jnp.any(before & parallel & (above < 0.0), axis=0)
    meets = before & ~parallel
    high = jnp.min(jnp.where(meets & (below >= 0.0), at, jnp.inf), axis=0)
    low = jnp.max(jnp.where(meets & (below < 0.0), at, -jnp.inf), axis=0)
    high, low = jnp.minimum(high, half - middle), jnp.maximum(low, -half - middle)
    if direct:
        best = jnp.where(dot(goal, line.along) > 0.0, high, low)
    else:
        best = dot(line.along, (goal[0] - line.point[0], goal[1] - line.point[1]))
    best = jnp.clip(best, low, high)
    found = line.point[0] + best * line.along[0], line.point[1] + best * line.along[1]
    return found, (root >= 0.0) & ~shut & (low <= high)


def _least_violation(allowed: Lines, found: Complex, first: Array, most: Array) -> Complex:
    """From the line where nothing was left on: the least violation of the worst line."""
    count = allowed.valid.shape[0]
    each = jnp.arange(count)[:, None]

    def take(i: Array, carry: tuple[Complex, Array]) -> tuple[Complex, Array]:
        found, worst = carry
        line = jax.tree.map(lambda leaf: leaf[i], allowed)
        off = line.point[0] - found[0], line.point[1] - found[1]
        violation = cross(line.along, off)
        worse = line.valid & (i >= first) & (violation > worst)
        between = _bisectors(allowed, line, allowed.valid & (each < i))
        inwards = -line.along[1], line.along[0]
        new, failed = _nearest(between, inwards, most, aim=inwards)
        moved = worse & ~jnp.any(failed, axis=0)
        found = jnp.where(moved, new[0], found[0]), jnp.where(moved, new[1], found[1])
        off = line.point[0] - found[0], line.point[1] - found[1]
        return found, jnp.where(worse, cross(line.along, off), worst)

    return lax.fori_loop(0, count, take, (found, jnp.zeros_like(found[0])))[0]


def _bisectors(allowed: Lines, line: Lines, valid: Array) -> Lines:
    """Where the lines before are violated as much as this one."""
    below = cross((line.along[0][None], line.along[1][None]), allowed.along)
    parallel = jnp.abs(below) <= PARALLEL
    same = parallel & (dot((line.along[0][None], line.along[1][None]), allowed.along) > 0.0)
    off = line.point[0] - allowed.point[0], line.point[1] - allowed.point[1]
    at = cross(allowed.along, off) / jnp.where(parallel, 1.0, below)
    point = tuple(
        jnp.where(parallel, 0.5 * (p + q), p + at * d)
        for p, q, d in zip(line.point, allowed.point, line.along, strict=True)
    )
    turn = minus(allowed.along, line.along)
    over = jnp.sqrt(jnp.maximum(dot(turn, turn), 1e-20))
    return Lines((point[0], point[1]), (turn[0] / over, turn[1] / over), valid & ~same)
