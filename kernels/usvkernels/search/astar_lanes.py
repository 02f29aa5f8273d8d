"""A* for many queries: lanes that take the next query when theirs has ended.

Not `lanes.run`: that selects between old and new state, and planes of a cell each are too large
to be touched for a lane that goes on. Here a lane's plane is written in place, and on a map that
all queries share only the rows that its search has changed.
"""

from dataclasses import dataclass, fields, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.lanes import LEAST_LANES
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

NARROWING = 8
"""How many times fewer lanes the last queries get."""

_SLAB = 2**13  # places that are reset at a time on a shared map


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Found:
    """How the queries ended."""

    status: Array  # int32[B], `Status`
    expanded: Array  # int32[B], cells taken off the open list, the goal included
    end: Array  # int32[B], state expanded last: the goal's, where it was FOUND
    steps: Array  # uint8[B * size], how each state was entered; see `Lanes.steps`
    busy: Array  # int32, expansions by all lanes together
    total: Array  # int32, times a lane could have expanded one


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Work:
    lanes: Lanes
    next_job: Array  # int32, first query not yet given out
    found: Found  # without its steps, which the lanes hold


def search(static: AstarStatic, queries: AstarQueries, lanes: int, chunk: int) -> Found:
    """Answer queries 0 .. count - 1, in the order of the arguments.

    Args:
      static: what is searched for.
      queries: at least one.
      lanes: searches under way at a time, static.
      chunk: expansions between two refills, static.
    """
    sizes = pqueue.layout(lanes, static.states)
    work = _idle(static, sizes, queries)
    narrow = lanes // NARROWING if lanes // NARROWING >= LEAST_LANES else 0
    work = _worked(static, sizes, queries, work, chunk, narrow)
    if narrow:
        few = replace(sizes, lanes=narrow)
        work = replace(work, lanes=_gathered(sizes, work.lanes, narrow))
        work = _worked(static, few, queries, work, chunk, 0)
    return replace(work.found, steps=work.lanes.steps)


def _codes(maps: Array) -> Array:
    """The plane before a search: what is blocked, and what nobody has seen."""
    return jnp.where(maps, BLOCKED, ABSENT)


def _idle(static: AstarStatic, sizes: Layout, queries: AstarQueries) -> _Work:
    count, size = queries.starts.shape[0], sizes.size
    queues = pqueue.empty(sizes)
    if static.shared:
        queues = replace(queues, keys=jnp.tile(_codes(queries.maps[0]), sizes.lanes))
    zero = jnp.zeros(sizes.lanes, jnp.int32)
    steps = jnp.zeros(count * size, jnp.uint8)
    lanes = Lanes(
        queues=queues,
        steps=steps,
        job=zero + count,
        status=zero + int(Status.UNREACHABLE),
        expanded=zero,
        end=zero,
        lowest=zero + static.places,  # above the highest: nothing to reset
        highest=zero,
        cut=jnp.zeros(sizes.lanes, bool),
        goal_x=zero,
        goal_y=zero,
        base=zero,
    )
    row = jnp.zeros(count, jnp.int32)
    none = jnp.int32(0)
    found = Found(row, row, row, jnp.zeros(0, jnp.uint8), none, none)
    return _Work(lanes, jnp.int32(0), found)


def _worked(
    static: AstarStatic, sizes: Layout, queries: AstarQueries, work: _Work, chunk: int, fewer: int
) -> _Work:
    """Work until all is done and written down, or until what is left fits into `fewer` lanes."""
    capacity = queries.starts.shape[0]

    def unfinished(work: _Work) -> Array:
        left = jnp.sum(work.lanes.job < capacity, dtype=jnp.int32)
        return (left > fewer) | (work.next_job < queries.count)

    def turn(work: _Work) -> _Work:
        work = _refilled(static, sizes, queries, work)
        before = jnp.sum(work.lanes.expanded, dtype=jnp.int32)
        steps = jnp.where(jnp.any(work.lanes.status == Status.RUNNING), chunk, 0)
        lanes = lax.fori_loop(
            0, steps, lambda _, lanes: expand(static, sizes, queries, lanes), work.lanes
        )
        busy = jnp.sum(lanes.expanded, dtype=jnp.int32) - before
        found = replace(
            work.found,
            busy=work.found.busy + busy,
            total=work.found.total + steps * sizes.lanes,
        )
        return replace(work, lanes=lanes, found=found)

    return lax.while_loop(unfinished, turn, work)


def _refilled(static: AstarStatic, sizes: Layout, queries: AstarQueries, work: _Work) -> _Work:
    """Write down the lanes that have ended, and give them the next queries."""
    lanes, found = work.lanes, work.found
    capacity = queries.starts.shape[0]
    ended = lanes.status != Status.RUNNING
    row = jnp.where(ended, lanes.job, capacity)
    found = replace(
        found,
        status=found.status.at[row].set(lanes.status, mode="drop"),
        expanded=found.expanded.at[row].set(lanes.expanded, mode="drop"),
        end=found.end.at[row].set(lanes.end, mode="drop"),
    )
    given = work.next_job + jnp.cumsum(ended, dtype=jnp.int32) - 1
    fresh = ended & (given < queries.count)
    job = jnp.where(fresh, given, jnp.where(ended, capacity, lanes.job))
    number = jnp.sum(fresh, dtype=jnp.int32)
    order = (
        jnp.zeros(sizes.lanes, jnp.int32)
        .at[jnp.where(fresh, given - work.next_job, sizes.lanes)]
        .set(jnp.arange(sizes.lanes, dtype=jnp.int32), mode="drop")
    )
    queues = _cleared(static, sizes, queries, lanes, order, number, job)
    lanes = _started(static, sizes, queries, replace(lanes, queues=queues, job=job), fresh)
    return _Work(lanes, work.next_job + number, found)


def _cleared(
    static: AstarStatic,
    sizes: Layout,
    queries: AstarQueries,
    lanes: Lanes,
    order: Array,
    number: Array,
    job: Array,
) -> Queues:
    """The queues, those of the first `number` lanes in `order` emptied, on their new maps."""
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
            own = lax.dynamic_index_in_dim(queries.maps, job[lane], 0, keepdims=False)
            return lax.dynamic_update_slice(keys, _codes(own), (lane * size,)), minima
        low = jnp.maximum(lanes.lowest[lane] - reach, 0) * static.headings
        high = (lanes.highest[lane] + reach + 1) * static.headings

        def wipe(j: Array, keys: Array) -> Array:
            at = jnp.minimum(low + j * slab, size - slab)
            old = lax.dynamic_slice(plane, (at,), (slab,))
            return lax.dynamic_update_slice(keys, old, (lane * size + at,))

        slabs = jnp.maximum(-(-(high - low) // slab), 0)
        return lax.fori_loop(0, slabs, wipe, keys), minima

    queues = lanes.queues
    keys, minima = lax.fori_loop(0, number, clear, (queues.keys, queues.minima))
    return replace(queues, keys=keys, minima=minima)


def _started(
    static: AstarStatic, sizes: Layout, queries: AstarQueries, lanes: Lanes, fresh: Array
) -> Lanes:
    """The lanes, those that are `fresh` at the start of their query."""
    job = jnp.minimum(lanes.job, queries.starts.shape[0] - 1)
    x, y = queries.starts[job, 0], queries.starts[job, 1]
    goal_x, goal_y = queries.goals[job, 0], queries.goals[job, 1]
    h = estimate(static, queries.table, x - goal_x, y - goal_y)
    base = base_of(static, h)
    fits = h - base <= static.longest
    key = jnp.where(fits, first_key(static, h, base), ABSENT)
    start = place(static, x, y) * static.headings
    queues = lanes.queues
    column = jnp.where(fresh, ABSENT, queues.column)
    key_before = jnp.where(fresh, ABSENT, queues.key)
    queues = replace(queues, column=column, key=key_before)
    lane = jnp.arange(sizes.lanes, dtype=jnp.int32)
    at = jnp.where(fresh, start, 0)
    kept = queues.keys.at[lane * sizes.size + at].get(mode="promise_in_bounds")
    queues = pqueue.lower(sizes, queues, queries.go, at[None], jnp.where(fresh, key, kept)[None])
    steps = lanes.steps.at[jnp.where(fresh, lanes.job * sizes.size + start, lanes.steps.size)].set(
        jnp.uint8(NO_HEADING), mode="drop"
    )

    def new(fresh_value: Array | int, old: Array) -> Array:
        return jnp.where(fresh, fresh_value, old)

    return replace(
        lanes,
        queues=queues,
        steps=steps,
        status=new(int(Status.RUNNING), lanes.status),
        expanded=new(0, lanes.expanded),
        end=new(start, lanes.end),
        lowest=new(start // static.headings, lanes.lowest),
        highest=new(start // static.headings, lanes.highest),
        cut=new(~fits, lanes.cut),
        goal_x=new(goal_x, lanes.goal_x),
        goal_y=new(goal_y, lanes.goal_y),
        base=new(base, lanes.base),
    )


def _gathered(sizes: Layout, lanes: Lanes, count: int) -> Lanes:
    """The first `count` lanes, those that have a query before the others."""
    lane = jnp.argsort(lanes.job, stable=True)[:count]

    def rows(flat: Array) -> Array:
        return flat.reshape(sizes.lanes, -1)[lane].reshape(-1)

    old = lanes.queues
    queues = Queues(
        keys=rows(old.keys),
        minima=rows(old.minima) if sizes.levels == 3 else old.minima,
        column=old.column[:, lane],
        key=old.key[lane],
        group=old.group[lane],
    )
    own = {f.name: getattr(lanes, f.name) for f in fields(lanes)}
    picked = {k: v[lane] for k, v in own.items() if k not in ("queues", "steps")}
    return replace(lanes, queues=queues, **picked)
