"""Encounters as a mariner expects them: roles by the collision regulations, and what follows.

A pair has roles from when it sees that it would pass too close until it is past and clear: head-on,
both give way; overtaking, who overtakes does; crossing, who has the other to starboard does (Rules
13 to 15). Giving way is an alteration of course to starboard that others can see, or of speed,
after which the other passes at the distance wanted, in crossing and head-on to port (Rules 8, 16).
A stand-on vessel keeps course and speed until contact is so near that the other plainly does not
act (Rule 17). Roles are of pairs, so a ring of three gives way all round, each to starboard.
"""

from math import cos, radians, sin
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.fleet.approach import contact_time, cross, dot, least_square
from usvkernels.fleet.params import Encounters
from usvkernels.fleet.sight import (
    Obstacles,
    Orders,
    Vessels,
    between,
    nearest_square,
    others,
    over_ground,
    sums,
)
from usvkernels.vessel import Complex, complex_product
from usvkernels.xla.single import single

NONE, HEAD_ON, GIVE_WAY, STAND_ON, OVERTAKING, OVERTAKEN = range(6)
"""What vessel i is in a pair with j; int32[n, n, lanes]."""

HEAD_ON_COSINE = cos(radians(6.0))
"""Courses are reciprocal, and the other is ahead, within 6 degrees."""

ABAFT_COSINE = cos(radians(112.5))
"""A vessel at a larger bearing is more than 22.5 degrees abaft the beam (Rule 13)."""

RELEASE = 1.25
"""A pair that would pass at this multiple of the distance wanted has no roles any more."""

AHEAD = 2.0
"""A vessel that gives way may cross ahead at this multiple of the distance wanted."""

DEGREES = (0, 30, 40, 50, 60, 70, 80, 90)
"""Alterations to starboard; none is so small that it would not be seen (Rule 8 b)."""

SHARES = (1.0, 0.5, 0.0)
"""Of the speed."""

CANDIDATES = tuple((degrees, share) for share in SHARES for degrees in DEGREES)
"""What a vessel chooses from; the first is to go on."""

VIOLATION, SLOWER, CHANGE = 30.0, 2.0, 0.1
"""What a distance short by all of it, a loss of all speed and a change of mind cost, in right
angles of alteration."""


class Seen(NamedTuple):
    """Vessels [n, lanes], and pairs [n, n, lanes] as i sees j."""

    velocity: Complex  # m/s
    intent: Complex  # the velocity that a vessel had if it sailed alone, m/s
    role: Array  # int32, of i
    must: Array  # bool, whether i has to keep clear of j
    other: Array  # bool, whether there is such a pair
    wanted: Array  # m, distance between centres


def meet(
    how: Encounters,
    vessels: Vessels,
    circles: Obstacles,
    reach: Array,
    roles: Array,
    altered: Array,
) -> tuple[Orders, Array, Array]:
    """What vessels do that keep the rules.

    Args:
        how: the strategy's numbers.
        vessels: the fleet.
        circles: obstacles.
        reach: float[n, lanes], distance from their centres to keep (m).
        roles: int32[n, n, lanes], so far.
        altered: int32[n, lanes], which of `CANDIDATES` the vessel was on.

    Returns:
        Orders, roles and alterations from now on.
    """
    seen = _look(how, vessels, roles)
    altered = _choose(how, vessels, seen, circles, reach, altered)
    course, share = _rotated(vessels.course, altered)
    stands_on = (seen.role == STAND_ON) | (seen.role == OVERTAKEN)
    keep = seen.other & (seen.must | ~stands_on)
    still = jnp.zeros_like(vessels.present)
    return Orders(course, share * vessels.speed, keep, still), seen.role, altered


def _look(how: Encounters, vessels: Vessels, roles: Array) -> Seen:
    """Roles, and whom each vessel has to keep clear of."""
    other = others(vessels.present)
    place = between(vessels.place)
    speed = jnp.where(vessels.under_way, vessels.speed, 0.0)
    intent = over_ground(vessels, (vessels.course[0] * speed, vessels.course[1] * speed))
    wanted = _wanted(how, vessels, place)
    until = jnp.minimum(how.sight_time, jnp.minimum(vessels.arrival[:, None], vessels.arrival))
    closing = between(intent)
    least = least_square(place, closing, until)
    meets = dot(place, closing) < 0.0
    under_way = vessels.under_way[:, None] | vessels.under_way
    risk = other & under_way & meets & (least < wanted * wanted)
    stays = other & meets & (least < (RELEASE * wanted) * (RELEASE * wanted))
    new = jnp.where(risk, _roles(vessels, place), NONE)
    roles = jnp.where(roles == NONE, new, jnp.where(stays, roles, NONE))
    actual = between(vessels.velocity)
    contact = contact_time(place, actual, sums(vessels.hull))
    gives = (roles == HEAD_ON) | (roles == GIVE_WAY) | (roles == OVERTAKING)
    must = other & (gives | (contact < how.act_time))
    return Seen(vessels.velocity, intent, roles, must, other, wanted)


def _wanted(how: Encounters, vessels: Vessels, place: Complex) -> Array:
    """Distance that i wants from j: at a vessel that has arrived, what i's own goal leaves."""
    hulls = sums(vessels.hull)
    wanted = hulls + how.passing
    (goal_x, goal_y), (x, y) = vessels.goal, vessels.place
    goal = goal_x[:, None] - x[None], goal_y[:, None] - y[None]
    room = jnp.clip(0.9 * jnp.sqrt(dot(goal, goal)), hulls, wanted)
    return jnp.where(vessels.under_way[None], wanted, room)


def _roles(vessels: Vessels, place: Complex) -> Array:
    """What i would be to j by relative bearings, int32[n, n, lanes]."""
    course = vessels.course[0][:, None], vessels.course[1][:, None]
    distance = jnp.sqrt(dot(place, place))
    along, across = dot(course, place), cross(course, place)
    abaft = along < ABAFT_COSINE * distance
    ahead = along >= HEAD_ON_COSINE * distance
    reciprocal = _with_other(course) <= -HEAD_ON_COSINE
    starboard = across < 0.0
    seen_abaft, seen_ahead = abaft.swapaxes(0, 1), ahead.swapaxes(0, 1)
    same = starboard == starboard.swapaxes(0, 1)  # nobody, or both, would have to give way
    head_on = (reciprocal & ahead & seen_ahead) | same
    role = jnp.where(starboard, GIVE_WAY, STAND_ON)
    role = jnp.where(head_on, HEAD_ON, role)
    role = jnp.where(abaft, OVERTAKEN, jnp.where(seen_abaft, OVERTAKING, role))
    rests = ~vessels.under_way[None] & vessels.under_way[:, None]
    return jnp.where(rests, OVERTAKING, jnp.where(rests.swapaxes(0, 1), OVERTAKEN, role))


def _with_other(course: Complex) -> Array:
    """Cosine between the courses of i and j."""
    return dot(course, (course[0].swapaxes(0, 1), course[1].swapaxes(0, 1)))


def _choose(
    how: Encounters, vessels: Vessels, seen: Seen, circles: Obstacles, reach: Array, altered: Array
) -> Array:
    """The cheapest of `CANDIDATES` for each vessel, the first of equals; int32[n, lanes]."""
    until = jnp.minimum(vessels.arrival, how.sight_time)
    # In whole arrays, of which a single piece may take rows.
    drift = () if vessels.drift is None else vessels.drift
    own = jnp.stack([*vessels.place, *vessels.course, vessels.speed, until, reach, *drift])
    theirs = jnp.stack([*vessels.place, *seen.velocity, *seen.intent])
    port = (seen.role == HEAD_ON) | (seen.role == GIVE_WAY)
    pairs = _Pairs(theirs, seen.wanted, seen.must, seen.other, port)
    return single(_cheapest, _table(own.dtype), own, pairs, circles, how.act_time, altered)


DRIFT = 7
"""Row of what a vessel knows of itself, from which its drift stands, where there is any."""


class _Pairs(NamedTuple):
    """Whom the candidates may come near; of pairs [n, n, lanes] the first is who chooses."""

    theirs: Array  # float[6, n, lanes], place, velocity and intent of each vessel
    wanted: Array  # m
    must: Array  # bool
    other: Array  # bool
    port: Array  # bool, whether j is to be passed to port


def _table(dtype: jnp.dtype) -> Array:
    """Of each candidate, the turn's cosine and sine, the share of the speed, and what it costs."""
    angles = [-radians(degrees) for degrees, _ in CANDIDATES]
    costs = [degrees / 90.0 + SLOWER * (1.0 - share) for degrees, share in CANDIDATES]
    rows = zip(angles, CANDIDATES, costs, strict=True)
    return jnp.array([[cos(a), sin(a), share, cost] for a, (_, share), cost in rows], dtype)


def _cheapest(
    table: Array,
    own: Array,
    pairs: _Pairs,
    circles: Obstacles,
    act_time: Array | float,
    altered: Array,
) -> Array:
    place, course, speed = (own[0], own[1]), (own[2], own[3]), own[4]

    def better(k: Array, best: tuple[Array, Array]) -> tuple[Array, Array]:
        turn_cos, turn_sin, share, fixed = (table[k, part] for part in range(4))
        turned = complex_product(course, (turn_cos, turn_sin))
        velocity = turned[0] * (share * speed), turned[1] * (share * speed)
        if len(own) > DRIFT:
            velocity = velocity[0] + own[DRIFT], velocity[1] + own[DRIFT + 1]
        short = _shortfall(place, velocity, own[5], pairs, k == 0)
        aground = _aground(place, velocity, circles, own[6], act_time)
        short = jnp.where(k > 0, jnp.maximum(short, aground), short)
        cost = VIOLATION * short + jnp.where(altered == k, fixed, fixed + CHANGE)
        return jnp.minimum(cost, best[0]), jnp.where(cost < best[0], k, best[1])

    best = jnp.full_like(speed, jnp.inf), jnp.zeros_like(altered)
    return jax.lax.fori_loop(0, len(CANDIDATES), better, best)[1]


def _shortfall(
    place: Complex, velocity: Complex, until: Array, pairs: _Pairs, alone: Array
) -> Array:
    """By which share of the distance wanted a velocity passes too near; [n, lanes], 0 to 1."""

    def worst(j: Array, short: Array) -> Array:
        east, north, *moves = (pairs.theirs[part, j] for part in range(6))
        off = east - place[0], north - place[1]
        counts = jnp.where(alone, pairs.must[:, j], pairs.other[:, j])
        wanted, port = pairs.wanted[:, j], pairs.port[:, j]
        for theirs in (moves[:2], moves[2:]):
            closing = theirs[0] - velocity[0], theirs[1] - velocity[1]
            distance = jnp.sqrt(least_square(off, closing, until))
            to_starboard = (cross(off, closing) < 0.0) & (dot(off, closing) < 0.0)
            asked = jnp.where(port & to_starboard, AHEAD * wanted, wanted)
            short = jnp.maximum(short, jnp.where(counts, 1.0 - distance / asked, 0.0))
        return short

    return jax.lax.fori_loop(0, pairs.wanted.shape[0], worst, jnp.zeros_like(place[0]))


def _aground(
    place: Complex, velocity: Complex, circles: Obstacles, reach: Array, until: Array | float
) -> Array:
    """As `_shortfall`, of obstacles."""
    least = nearest_square(circles, place, velocity, until)
    return jnp.maximum(1.0 - jnp.sqrt(least) / reach, 0.0)


def _rotated(course: Complex, altered: Array) -> tuple[Complex, Array]:
    """The course after an alteration, and the share of the speed."""
    chosen = _table(course[0].dtype)[altered]
    return complex_product(course, (chosen[..., 0], chosen[..., 1])), chosen[..., 2]
