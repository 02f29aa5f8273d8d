"""Cruises as a program for the lanes; a lane goes on to its next leg, or to the next cruise."""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.cruise.sailing import STAY, Cruises, SailingStatic, Vessels, advance
from usvkernels.lanes import InPlace, those
from usvkernels.search.dstar_layout import BLOCKED
from usvkernels.search.dstar_search import begin_planes, first_key, idle_searches


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Log:
    """What came of the cruises.

    Attributes:
        moves: uint8[capacity], codes of the moves of cruise j from j * d * max_steps on; STAY where
            none was made.
        legs: int32[n * d, 4], of leg i of cruise j in row j * d + i: `Status` (REACHED, UNREACHABLE
            where its stop was given up, TIMED_OUT, OUT_OF_BUDGET; 0 where it did not begin), step
            of the cruise at its end, cells expanded in it, steps in which cells were.
    """

    moves: Array
    legs: Array


def program(static: SailingStatic, cruises: Cruises, capacity: int) -> InPlace:
    """Cruises as a program for `lanes.run`.

    Every iteration counts towards a bound on its lane's step, and steps towards one on its leg,
    so a cruise ends.

    Args:
        static: choices of method.
        cruises: n of them.
        capacity: of moves, static; n * d * max_steps at least, less than `dstar_search.NOWHERE`.

    Returns:
        The program, without results; what comes of the cruises is its `Log`.
    """
    stops, n = cruises.stops.shape

    def step(vessels: Vessels, log: Log) -> tuple[Vessels, Log]:
        vessels, now = advance(static, cruises, vessels)
        moves = log.moves.at[now.move_place].set(now.move, mode="drop", unique_indices=True)
        legs = log.legs.at[now.leg_place].set(now.leg, mode="drop", unique_indices=True)
        return vessels, Log(moves, legs)

    return InPlace(
        idle=partial(_idle, static, stops),
        refill=partial(_refilled, static, cruises),
        step=step,
        done=lambda vessels: vessels.over,
        taken=lambda vessels: vessels.taken,
        log=Log(
            moves=jnp.full(capacity, STAY, jnp.uint8),
            legs=jnp.zeros((n * (stops - 1), 4), jnp.int32),
        ),
    )


def _idle(static: SailingStatic, stops: int, lanes: int) -> Vessels:
    zero = jnp.zeros(lanes, jnp.int32)
    counters = ("rate", "job", "leg", "step", "first", "waited", "spent", "plans")
    return Vessels(
        **idle_searches(static.search, lanes),
        **dict.fromkeys(counters, zero),
        unseen=jnp.zeros(lanes * static.search.layout.size if static.scope == "map" else 0, bool),
        changes=jnp.zeros((static.words, lanes), jnp.uint32),
        drawn=jnp.zeros(lanes, bool),
        over=jnp.ones(lanes, bool),
        stops=jnp.zeros((stops, lanes), jnp.int32),
        seed=jnp.zeros((2, lanes), jnp.uint32),
    )


def _refilled(
    static: SailingStatic, cruises: Cruises, vessels: Vessels, job: Array, takes: Array
) -> Vessels:
    """Lanes whose leg has ended begin the next; those that take a cruise, its first."""
    job = jnp.where(takes, job, vessels.job)
    onward = ~vessels.live & ~vessels.over

    def fresh(new: Array | int, old: Array) -> Array:
        return jnp.where(takes, new, old)

    stops = fresh(cruises.stops[:, job], vessels.stops)
    leg = fresh(1, vessels.leg + onward)
    here = fresh(stops[0], vessels.here)
    begins = takes | onward
    goal = jnp.where(begins, jnp.take_along_axis(stops, leg[None], axis=0)[0], vessels.goal)
    vessels = replace(
        vessels,
        live=vessels.live | begins,
        here=here,
        goal=goal,
        origin=jnp.where(begins, here, vessels.origin),
        lead=jnp.where(begins, 0, vessels.lead),
        expanded=jnp.where(begins, 0, vessels.expanded),
        iterations=jnp.where(begins, 0, vessels.iterations),
        drawn=vessels.drawn & ~takes,
        over=vessels.over & ~takes,
        stops=stops,
        seed=fresh(cruises.seed[:, job], vessels.seed),
        rate=fresh(cruises.rate[job], vessels.rate),
        job=job,
        leg=leg,
        step=fresh(0, vessels.step),
        first=jnp.where(begins, fresh(0, vessels.step), vessels.first),
        waited=jnp.where(begins, 0, vessels.waited),
        spent=jnp.where(begins, 0, vessels.spent),
        plans=jnp.where(begins, 0, vessels.plans),
    )
    return _begun(static, cruises, vessels, takes, begins)


def _begun(
    static: SailingStatic, cruises: Cruises, vessels: Vessels, takes: Array, begins: Array
) -> Vessels:
    """The planes of the lanes that begin a leg: on the cruise's map, or on that known so far."""
    size = static.search.layout.size
    key = first_key(static.search, vessels.here, vessels.goal)

    def begin(i: Array, planes: tuple[Array, ...]) -> tuple[Array, ...]:
        lane = order[i]
        g, keys, bounds, unseen = planes
        which = cruises.map_of[vessels.job[lane]]
        first = lax.dynamic_index_in_dim(cruises.blocked, which, 0, False)
        known = lax.dynamic_slice(g, (lane * size,), (size,)) == BLOCKED
        blocked = jnp.where(takes[lane], first, known)
        g, keys, bounds = begin_planes(
            static.search, (g, keys, bounds), lane, blocked, vessels.goal[lane], key[lane]
        )
        if static.scope == "map":
            plane = lax.dynamic_slice(unseen, (lane * size,), (size,)) & ~takes[lane]
            unseen = lax.dynamic_update_slice(unseen, plane, (lane * size,))
        return g, keys, bounds, unseen

    order, number = those(begins)
    planes = (vessels.g, vessels.key, vessels.bounds, vessels.unseen)
    g, keys, bounds, unseen = lax.fori_loop(0, number, begin, planes)
    return replace(vessels, g=g, key=keys, bounds=bounds, unseen=unseen)
