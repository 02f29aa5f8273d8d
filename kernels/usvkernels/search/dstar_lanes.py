"""D* Lite episodes as a program for the lanes."""

from functools import partial

import jax.numpy as jnp
from jax import Array, lax

from usvkernels.lanes import InPlace, those
from usvkernels.search.dstar_layout import ReplanStatic
from usvkernels.search.dstar_lite import Episodes, Lanes, advance
from usvkernels.search.dstar_search import begin_planes, first_key, idle_searches


def program(static: ReplanStatic, episodes: Episodes, capacity: int) -> InPlace:
    """Episodes as a program for `lanes.run`.

    Every iteration counts towards its lane's bound between two records, so an episode ends.

    Args:
        static: choices of method.
        episodes: n of them.
        capacity: of records, static; n * (T + 1) at least, less than `dstar_search.NOWHERE`.

    Returns:
        The program, without results. Its log are the records, int32[capacity, 3], in rows
        j * (T + 1) + i: the vessel's cell, cost-to-go (as `dstar_lite.advance` has it) and
        expansions; cell -1 where the episode had ended before.
    """

    def step(lanes: Lanes, records: Array) -> tuple[Lanes, Array]:
        lanes, place, written = advance(static, episodes, lanes)
        return lanes, records.at[place].set(written, mode="drop", unique_indices=True)

    return InPlace(
        idle=partial(_idle, static),
        refill=partial(_refilled, static, episodes),
        step=step,
        done=lambda lanes: ~lanes.live,
        taken=lambda lanes: lanes.taken,
        log=jnp.full((capacity, 3), -1, jnp.int32),
    )


def _idle(static: ReplanStatic, lanes: int) -> Lanes:
    zero = jnp.zeros(lanes, jnp.int32)
    return Lanes(
        **idle_searches(static, lanes),
        unseen=jnp.zeros(lanes * static.layout.size if static.sensing else 0, bool),
        job=zero,
        record=zero,
        cursor=zero,
        moved=jnp.zeros(lanes, bool),
    )


def _refilled(
    static: ReplanStatic, episodes: Episodes, lanes: Lanes, job: Array, takes: Array
) -> Lanes:
    """The lanes that take an episode at its start."""
    size = static.layout.size
    job = jnp.where(takes, job, lanes.job)
    start, goal = episodes.start[job], episodes.goal[job]
    key = first_key(static, start, goal)

    def begin(i: Array, planes: tuple[Array, ...]) -> tuple[Array, ...]:
        lane = order[i]
        unseen = planes[3]
        blocked = lax.dynamic_index_in_dim(episodes.blocked, episodes.map_of[job[lane]], 0, False)
        g, keys, bounds = begin_planes(
            static, (planes[0], planes[1], planes[2]), lane, blocked, goal[lane], key[lane]
        )
        if static.sensing:
            unseen = lax.dynamic_update_slice(unseen, jnp.zeros(size, bool), (lane * size,))
        return g, keys, bounds, unseen

    order, number = those(takes)
    planes = (lanes.g, lanes.key, lanes.bounds, lanes.unseen)
    g, keys, bounds, unseen = lax.fori_loop(0, number, begin, planes)

    def fresh(new: Array | int, old: Array) -> Array:
        return jnp.where(takes, new, old)

    return Lanes(
        g=g,
        key=keys,
        bounds=bounds,
        unseen=unseen,
        job=job,
        live=lanes.live | takes,
        record=fresh(0, lanes.record),
        cursor=fresh(0, lanes.cursor),
        moved=lanes.moved & ~takes,
        here=fresh(start, lanes.here),
        goal=fresh(goal, lanes.goal),
        origin=fresh(start, lanes.origin),
        lead=fresh(0, lanes.lead),
        expanded=fresh(0, lanes.expanded),
        iterations=fresh(0, lanes.iterations),
        taken=lanes.taken,
    )
