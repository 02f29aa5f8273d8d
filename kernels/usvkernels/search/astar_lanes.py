"""A* for many queries as a program for the lanes.

A lane's plane is written in place, and on a map that all queries share only the rows that its
search has changed.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.lanes import InPlace, those
from usvkernels.search import pqueue
from usvkernels.search.astar import (
    BLOCKED,
    NO_HEADING,
    AstarQueries,
    Lanes,
    base_of,
    expand,
    first_key,
)
from usvkernels.search.astar_costs import AstarStatic, estimate, place
from usvkernels.search.pqueue import ABSENT, Layout, Queues
from usvkernels.status import Status

_SLAB = 2**13  # places that are reset at a time on a shared map


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Found:
    """How the queries ended; leaves [B]."""

    status: Array  # int32, `Status`
    expanded: Array  # int32, cells taken off the open list, the goal included
    end: Array  # int32, state expanded last: the goal's, where it was FOUND


def program(static: AstarStatic, queries: AstarQueries) -> InPlace:
    """AstarQueries as a program for `lanes.run`; the budget ends every one.

    Args:
        static: what is searched for.
        queries: B of them, at least one.

    Returns:
        The program, with results `Found`. Its log is uint8[B * size], how each state was entered:
        direction, 8 times the turn.
    """

    def step(lanes: Lanes, steps: Array) -> tuple[Lanes, Array]:
        return expand(static, _sizes(static, lanes), queries, lanes, steps)

    return InPlace(
        idle=partial(_idle, static, queries),
        refill=partial(_refilled, static, queries),
        step=step,
        done=lambda lanes: lanes.status != Status.RUNNING,
        taken=lambda lanes: lanes.expanded,
        result=lambda lanes: Found(lanes.status, lanes.expanded, lanes.end),
        log=_steps(static, queries),
        narrowing=8,
    )


def _sizes(static: AstarStatic, lanes: Lanes) -> Layout:
    return pqueue.layout(lanes.job.shape[0], static.states)


def _codes(maps: Array) -> Array:
    """The plane before a search: what is blocked, and what nobody has seen."""
    return jnp.where(maps, BLOCKED, ABSENT)


def _first_states(static: AstarStatic, starts: Array) -> Array:
    return place(static, starts[:, 0], starts[:, 1]) * static.headings


def _steps(static: AstarStatic, queries: AstarQueries) -> Array:
    """How states were entered, before any search: the starts from nowhere."""
    count, size = queries.starts.shape[0], pqueue.layout(1, static.states).size
    starts = jnp.arange(count, dtype=jnp.int32) * size + _first_states(static, queries.starts)
    return jnp.zeros(count * size, jnp.uint8).at[starts].set(jnp.uint8(NO_HEADING))


def _idle(static: AstarStatic, queries: AstarQueries, lanes: int) -> Lanes:
    queues = pqueue.empty(pqueue.layout(lanes, static.states))
    if static.shared:
        queues = replace(queues, keys=jnp.tile(_codes(queries.maps[0]), lanes))
    zero = jnp.zeros(lanes, jnp.int32)
    return Lanes(
        queues=queues,
        job=zero,
        status=zero + int(Status.UNREACHABLE),
        expanded=zero,
        end=zero,
        lowest=zero + static.places,  # above the highest: nothing to reset
        highest=zero,
        cut=jnp.zeros(lanes, bool),
        goal_x=zero,
        goal_y=zero,
        base=zero,
    )


def _refilled(
    static: AstarStatic, queries: AstarQueries, lanes: Lanes, job: Array, takes: Array
) -> Lanes:
    """The lanes that take a query at its start."""
    lanes = replace(lanes, job=jnp.where(takes, job, lanes.job))
    lanes = replace(lanes, queues=_cleared(static, queries, lanes, takes))
    return _started(static, queries, lanes, takes)


def _cleared(static: AstarStatic, queries: AstarQueries, lanes: Lanes, takes: Array) -> Queues:
    """The queues, those of the lanes that take a query emptied, on their new maps."""
    sizes = _sizes(static, lanes)
    size = sizes.size
    slab = min(size, _SLAB) if static.shared else size
    reach = static.stride + 1
    empty_minima = jnp.full(sizes.blocks, ABSENT)
    plane = _codes(queries.maps[0])

    def clear(i: Array, arrays: tuple[Array, Array]) -> tuple[Array, Array]:
        keys, minima = arrays
        lane = order[i]
        if sizes.levels == 3:
            minima = lax.dynamic_update_slice(minima, empty_minima, (lane * sizes.blocks,))
        if not static.shared:
            own = lax.dynamic_index_in_dim(queries.maps, lanes.job[lane], 0, keepdims=False)
            return lax.dynamic_update_slice(keys, _codes(own), (lane * size,)), minima
        low = jnp.maximum(lanes.lowest[lane] - reach, 0) * static.headings
        high = (lanes.highest[lane] + reach + 1) * static.headings

        def wipe(j: Array, keys: Array) -> Array:
            at = jnp.minimum(low + j * slab, size - slab)
            old = lax.dynamic_slice(plane, (at,), (slab,))
            return lax.dynamic_update_slice(keys, old, (lane * size + at,))

        slabs = jnp.maximum(-(-(high - low) // slab), 0)
        return lax.fori_loop(0, slabs, wipe, keys), minima

    order, number = those(takes)
    queues = lanes.queues
    keys, minima = lax.fori_loop(0, number, clear, (queues.keys, queues.minima))
    return replace(queues, keys=keys, minima=minima)


def _started(static: AstarStatic, queries: AstarQueries, lanes: Lanes, fresh: Array) -> Lanes:
    """The lanes, those that are `fresh` at the start of their query."""
    sizes = _sizes(static, lanes)
    starts, goals = queries.starts[lanes.job], queries.goals[lanes.job]
    h = estimate(static, queries.table, starts[:, 0] - goals[:, 0], starts[:, 1] - goals[:, 1])
    base = base_of(static, h)
    fits = h - base <= static.longest
    key = jnp.where(fits, first_key(static, h, base), ABSENT)
    start = _first_states(static, starts)
    queues = lanes.queues
    column = jnp.where(fresh, ABSENT, queues.column)
    key_before = jnp.where(fresh, ABSENT, queues.key)
    queues = replace(queues, column=column, key=key_before)
    lane = jnp.arange(sizes.lanes, dtype=jnp.int32)
    at = jnp.where(fresh, start, 0)
    kept = queues.keys.at[lane * sizes.size + at].get(mode="promise_in_bounds")
    queues = pqueue.lower(sizes, queues, queries.go, at[None], jnp.where(fresh, key, kept)[None])

    def new(fresh_value: Array | int, old: Array) -> Array:
        return jnp.where(fresh, fresh_value, old)

    return replace(
        lanes,
        queues=queues,
        status=new(int(Status.RUNNING), lanes.status),
        expanded=new(0, lanes.expanded),
        end=new(start, lanes.end),
        lowest=new(start // static.headings, lanes.lowest),
        highest=new(start // static.headings, lanes.highest),
        cut=new(~fits, lanes.cut),
        goal_x=new(goals[:, 0], lanes.goal_x),
        goal_y=new(goals[:, 1], lanes.goal_y),
        base=new(base, lanes.base),
    )
