"""Encounters as a mariner expects them: roles by the collision regulations, and what follows.

A pair has roles from when it sees that it would pass too close until it is past and clear: head-on,
both give way; overtaking, who overtakes does; crossing, who has the other to starboard does (Rules
13 to 15). Giving way is an alteration of course to starboard that others can see, or of speed,
after which the other passes at the distance wanted, in crossing and head-on to port (Rules 8, 16).
It is held until a course parallel to the route serves as well, and that until the route does, to
the goal: a vessel that came back for its next guidance point alone would have to alter again.
A stand-on vessel keeps course and speed until contact is so near that the other plainly does not
act (Rule 17). Roles are of pairs, so a ring of three gives way all round, each to starboard.
"""

from math import cos, radians, sin
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.fleet.approach import contact_time, cross, dot, least_square
from usvkernels.fleet.legs import Legs, beside, legs_of, pieces
from usvkernels.fleet.params import Encounters
from usvkernels.fleet.sight import (
    Obstacles,
    Orders,
    Vessels,
    between,
    nearest_square,
    of_looker,
    others,
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

BESIDE_GOAL = 3.0
"""Distances wanted from one's goal, within which others, or their goals, lie beside it: there they
pass each other as close as they may."""

AHEAD = 2.0
"""A vessel that gives way may cross ahead at this multiple of the distance wanted."""

SPARE = 0.5
"""Of the distance wanted between hulls, what the dynamic window keeps in any case: the other may
turn, or gain speed, before the next decision."""

DEGREES = (0, 30, 40, 50, 60, 70, 80, 90)
"""Alterations to starboard; none is so small that it would not be seen (Rule 8 b)."""

SHARES = (1.0, 0.5)
"""Of the speed."""

OTHERWISE = (135, 180, -135, -90, -60, -30)
"""Further alterations, of which those below 0 are to port: for who has waited so long that nobody
else will act, to part from a vessel that waits for it (Rules 2 b and 17 b)."""

PATIENCE = 30.0
"""s that a vessel waits before."""

CANDIDATES = (
    (0, 1.0),
    *((degrees, share) for share in SHARES for degrees in DEGREES),
    (0, 0.0),
    *((degrees, 1.0) for degrees in OTHERWISE),
)
"""What a vessel chooses from: to go on by its route, to sail parallel to it, the alterations of its
course to the guidance point, to stop, and what it does otherwise; the second comes in place of that
course itself."""

FIRST_OTHERWISE = len(CANDIDATES) - len(OTHERWISE)
"""Place of what is done otherwise among them."""

PARALLEL = 1
"""Place of the second among them."""

VIOLATION, SLOWER, CHANGE, BESIDE = 30.0, 2.0, 0.1, 0.15
"""What a distance short by all of it, a loss of all speed, a change of mind, and sailing beside the
route cost, in right angles of alteration."""


class Seen(NamedTuple):
    """Vessels [n, lanes], and pairs [n, n, lanes] as i sees j."""

    legs: Legs
    role: Array  # int32, of i
    must: Array  # bool, whether i has to keep clear of j
    other: Array  # bool, whether there is such a pair
    wanted: Array  # m, distance between centres
    held: Array  # m, that at which who has altered may go on


def meet(
    how: Encounters,
    vessels: Vessels,
    circles: Obstacles,
    reach: Array,
    roles: Array,
    altered: Array,
    idle: Array,
) -> tuple[Orders, Array, Array]:
    """What vessels do that keep the rules.

    Args:
        how: the strategy's numbers.
        vessels: the fleet.
        circles: obstacles.
        reach: float[n, lanes], distance from their centres to keep (m).
        roles: int32[n, n, lanes], so far.
        altered: int32[n, lanes], which of `CANDIDATES` the vessel was on.
        idle: float[n, lanes], for how long it has made no way (s).

    Returns:
        Orders, roles and alterations from now on.
    """
    seen = _look(how, vessels, roles)
    onward = beside(vessels)
    waits = (idle > PATIENCE) | (altered >= FIRST_OTHERWISE)
    altered = _choose(how, vessels, seen, onward, circles, reach, altered, waits)
    course, share = _rotated(vessels.course, onward, altered)
    stands_on = (seen.role == STAND_ON) | (seen.role == OVERTAKEN)
    keep = seen.other & (seen.must | ~stands_on)
    still = jnp.zeros_like(vessels.present)
    apart = _apart(vessels, seen.wanted)
    return Orders(course, share * vessels.speed, keep, still, apart), seen.role, altered


def _apart(vessels: Vessels, wanted: Array) -> Array:
    """Distance between centres that the dynamic window keeps in any case (m)."""
    hulls = sums(vessels.hull)
    return hulls + SPARE * (wanted - hulls)


def _look(how: Encounters, vessels: Vessels, roles: Array) -> Seen:
    """Roles, and whom each vessel has to keep clear of."""
    other = others(vessels.present)
    place = between(vessels.place)
    legs = legs_of(vessels)
    wanted = _wanted(how, vessels)
    # Who has arrived stays there; what others do beyond their goals is not foreseen.
    theirs = jnp.where(_in_the_way(vessels, wanted), jnp.inf, vessels.arrival)
    until = jnp.minimum(of_looker(how.sight_time), jnp.minimum(vessels.arrival[:, None], theirs))
    each: Legs = jax.tree.map(lambda leaf: leaf[:, None], legs)
    other_legs: Legs = jax.tree.map(lambda leaf: leaf[None], legs)
    least = jnp.full_like(wanted, jnp.inf)
    for off, closing, lasts in pieces(place, each, other_legs, until):
        nears = (dot(off, closing) < 0.0) & (lasts > 0.0)
        least = jnp.where(nears, jnp.minimum(least, least_square(off, closing, lasts)), least)
    under_way = vessels.under_way[:, None] | vessels.under_way
    risk = other & under_way & (least < wanted * wanted)
    stays = other & (least < (RELEASE * wanted) * (RELEASE * wanted))
    new = jnp.where(risk, _roles(vessels, place), NONE)
    roles = jnp.where(roles == NONE, new, jnp.where(stays, roles, NONE))
    actual = between(vessels.velocity)
    contact = contact_time(place, actual, sums(vessels.hull))
    gives = (roles == HEAD_ON) | (roles == GIVE_WAY) | (roles == OVERTAKING)
    near = dot(place, place) < jnp.square(_apart(vessels, wanted))
    must = other & (gives | near | (contact < of_looker(how.act_time)))
    apart = _from(vessels.goal, vessels.goal) > BESIDE_GOAL * wanted
    held = jnp.where(vessels.under_way[None] & apart, RELEASE * wanted, wanted)
    return Seen(legs, roles, must, other, wanted, held)


def _wanted(how: Encounters, vessels: Vessels) -> Array:
    """Distance that i wants from j: at a vessel that has arrived, what i's own goal leaves."""
    hulls = sums(vessels.hull)
    wanted = hulls + of_looker(how.passing)
    room = jnp.clip(0.9 * _from(vessels.goal, vessels.place), hulls, wanted)
    return jnp.where(vessels.under_way[None], wanted, room)


def _in_the_way(vessels: Vessels, wanted: Array) -> Array:
    """Whether j has arrived, and not beside the goal of i."""
    return ~vessels.under_way[None] & (_from(vessels.goal, vessels.place) > BESIDE_GOAL * wanted)


def _from(goal: Complex, other: Complex) -> Array:
    """Distance of the other's point from one's goal, [n, n, lanes] (m)."""
    east, north = (theirs[None] - own[:, None] for own, theirs in zip(goal, other, strict=True))
    return jnp.sqrt(east * east + north * north)


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
    how: Encounters,
    vessels: Vessels,
    seen: Seen,
    onward: Complex,
    circles: Obstacles,
    reach: Array,
    altered: Array,
    waits: Array,
) -> Array:
    """The cheapest of `CANDIDATES` for each vessel, the first of equals; int32[n, lanes]."""
    until = jnp.minimum(vessels.arrival, how.sight_time)
    # In whole arrays, of which a single piece may take rows.
    drift = () if vessels.drift is None else vessels.drift
    own = jnp.stack([*vessels.place, *vessels.course, vessels.speed, until, reach, *onward, *drift])
    legs = seen.legs
    theirs = jnp.stack([*vessels.place, *vessels.velocity, *legs.first, *legs.then, legs.turn])
    port = (seen.role == HEAD_ON) | (seen.role == GIVE_WAY)
    pairs = _Pairs(theirs, seen.wanted, seen.held, seen.must, seen.other, port)
    return single(_cheapest, _table(own.dtype), own, pairs, circles, how.act_time, altered, waits)


DRIFT = 9
"""Row of what a vessel knows of itself, from which its drift stands, where there is any."""


class _Pairs(NamedTuple):
    """Whom the candidates may come near; of pairs [n, n, lanes] the first is who chooses."""

    theirs: Array  # float[9, n, lanes], place, velocity and legs of each vessel
    wanted: Array  # m
    held: Array  # m
    must: Array  # bool
    other: Array  # bool
    port: Array  # bool, whether j is to be passed to port


def _table(dtype: jnp.dtype) -> Array:
    """Of each candidate, the turn's cosine and sine, the share of the speed, and what it costs."""
    angles = [-radians(degrees) for degrees, _ in CANDIDATES]
    costs = [abs(degrees) / 90.0 + SLOWER * (1.0 - share) for degrees, share in CANDIDATES]
    costs[PARALLEL] = BESIDE
    rows = zip(angles, CANDIDATES, costs, strict=True)
    return jnp.array([[cos(a), sin(a), share, cost] for a, (_, share), cost in rows], dtype)


def _cheapest(
    table: Array,
    own: Array,
    pairs: _Pairs,
    circles: Obstacles,
    act_time: Array | float,
    altered: Array,
    waits: Array,
) -> Array:
    place, course, speed = (own[0], own[1]), (own[2], own[3]), own[4]
    going_on = VIOLATION * _on_routes(place, own[5], pairs, altered > 0)
    going_on += jnp.where(altered == 0, 0.0, CHANGE)

    def better(k: Array, best: tuple[Array, Array]) -> tuple[Array, Array]:
        turn_cos, turn_sin, share, fixed = (table[k, part] for part in range(4))
        turn = (
            jnp.where(k == PARALLEL, own[7], turn_cos),
            jnp.where(k == PARALLEL, own[8], turn_sin),
        )
        turned = complex_product(course, turn)
        velocity = turned[0] * (share * speed), turned[1] * (share * speed)
        if len(own) > DRIFT:
            velocity = velocity[0] + own[DRIFT], velocity[1] + own[DRIFT + 1]
        short = _shortfall(place, velocity, own[5], pairs)
        aground = _aground(place, velocity, circles, own[6], act_time)
        cost = VIOLATION * jnp.maximum(short, aground)
        cost += jnp.where(altered == k, fixed, fixed + CHANGE)
        cost = jnp.where((k < FIRST_OTHERWISE) | waits, cost, jnp.inf)
        return jnp.minimum(cost, best[0]), jnp.where(cost < best[0], k, best[1])

    best = going_on, jnp.zeros_like(altered)
    return jax.lax.fori_loop(1, len(CANDIDATES), better, best)[1]


def _on_routes(place: Complex, until: Array, pairs: _Pairs, acts: Array) -> Array:
    """By which share of the distance wanted the route passes too near whom a vessel keeps clear of.

    Who acts already holds on until the route is clear by far, or it would act again soon. Of others
    both what they do and what they would do alone counts; [n, lanes], 0 to 1.
    """
    own = _unpacked(pairs.theirs)

    def worst(j: Array, short: Array) -> Array:
        theirs = pairs.theirs[:, j]
        off, velocity = (theirs[0] - place[0], theirs[1] - place[1]), (theirs[2], theirs[3])
        keeps_on = Legs(velocity, velocity, jnp.full_like(theirs[0], jnp.inf))
        wanted = jnp.where(acts, pairs.held[:, j], pairs.wanted[:, j])
        for legs in (keeps_on, _unpacked(theirs)):
            for at, closing, lasts in pieces(off, own, legs, until):
                near = _short(at, closing, lasts, wanted, pairs.port[:, j])
                short = jnp.maximum(short, jnp.where(pairs.must[:, j], near, 0.0))
        return short

    return jax.lax.fori_loop(0, pairs.wanted.shape[0], worst, jnp.zeros_like(place[0]))


def _unpacked(theirs: Array) -> Legs:
    return Legs((theirs[4], theirs[5]), (theirs[6], theirs[7]), theirs[8])


def _shortfall(place: Complex, velocity: Complex, until: Array, pairs: _Pairs) -> Array:
    """By which share of the distance wanted a velocity passes too near; [n, lanes], 0 to 1."""

    def worst(j: Array, short: Array) -> Array:
        east, north, *moves = (pairs.theirs[part, j] for part in range(6))
        off = east - place[0], north - place[1]
        for theirs in (moves[:2], moves[2:]):
            closing = theirs[0] - velocity[0], theirs[1] - velocity[1]
            near = _short(off, closing, until, pairs.wanted[:, j], pairs.port[:, j])
            short = jnp.maximum(short, jnp.where(pairs.other[:, j], near, 0.0))
        return short

    return jax.lax.fori_loop(0, pairs.wanted.shape[0], worst, jnp.zeros_like(place[0]))


def _short(place: Complex, closing: Complex, until: Array, wanted: Array, port: Array) -> Array:
    """By which share of the distance wanted another passes too near."""
    distance = jnp.sqrt(least_square(place, closing, until))
    to_starboard = (cross(place, closing) < 0.0) & (dot(place, closing) < 0.0)
    return 1.0 - distance / jnp.where(port & to_starboard, AHEAD * wanted, wanted)


def _aground(
    place: Complex, velocity: Complex, circles: Obstacles, reach: Array, until: Array | float
) -> Array:
    """As `_shortfall`, of obstacles."""
    least = nearest_square(circles, place, velocity, until)
    return jnp.maximum(1.0 - jnp.sqrt(least) / reach, 0.0)


def _rotated(course: Complex, onward: Complex, altered: Array) -> tuple[Complex, Array]:
    """The course after an alteration, and the share of the speed."""
    chosen = _table(course[0].dtype)[altered]
    parallel = altered == PARALLEL
    turn_cos, turn_sin = (jnp.where(parallel, onward[k], chosen[..., k]) for k in (0, 1))
    return complex_product(course, (turn_cos, turn_sin)), chosen[..., 2]
