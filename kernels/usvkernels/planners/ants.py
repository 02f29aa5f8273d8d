"""The ants of one iteration on their way, in lanes.

Ants of all queries queue for a fixed set of lanes; a lane whose ant has ended takes the next.
Walks are short on average and now and then very long, so that a lane per ant would mostly wait.
An ant's walk depends on its query, the iteration and its own number alone.
"""

from dataclasses import dataclass, fields, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.draws import uniform, words
from usvkernels.planners.moves import MOVES

CHUNK = 8  # steps between two refills; a multiple of the four words of a draw
LEAST_LANES = 16
NARROWING = 8
"""How many times fewer lanes the last ants of an iteration get."""
_BELOW_ONE = 1.0 - 2.0**-22  # keeps a rounded product below the sum that it is drawn from


@dataclass(frozen=True)
class AcoStatic:
    """Sizes."""

    height: int
    width: int
    ants: int
    iterations: int
    max_steps: int  # of an ant, after which it is lost; a multiple of CHUNK
    queries: int  # side by side
    lanes: int  # ants under way at a time

    @property
    def stride(self) -> int:
        """Cells in a row, a blocked margin on either side."""
        return self.width + 2

    @property
    def size(self) -> int:
        """Cells of a map with its margin."""
        return (self.height + 2) * self.stride

    @property
    def rows(self) -> int:
        """Steps of the lanes within which all ants of an iteration end, at the worst."""
        return (-(-self.queries * self.ants // self.lanes) + 1) * self.max_steps

    @property
    def deposit(self) -> float:
        """Parts of 1 / cells in which deposits add up, whole numbers in whatever order."""
        return 2.0 ** (30 - self.ants.bit_length())


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class AcoQueries:
    """What is asked: `AcoStatic.queries` rows, of which the first few may be real."""

    blocked: Array  # bool[queries, H, W]
    start: Array  # int32[queries], cell in the map with its margin
    goal: Array  # int32[queries]
    seed: Array  # uint32[2, queries]


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Walk:
    """The ants of an iteration under way, lanes last."""

    time: Array  # int32, steps that the lanes have made
    next_job: Array  # int32, the first ant that has not begun
    slot: Array  # int32[lanes], whose plane of visits and column of the record it has
    job: Array  # int32[lanes], ant * queries + query
    place: Array  # int32[lanes], query * size + cell
    base: Array  # int32[lanes], from a place to its own plane of visits
    stamp: Array  # uint8[lanes], what marks this ant's visits
    alive: Array  # bool[lanes]
    arrived: Array  # bool[lanes]
    steps: Array  # int32[lanes]
    diagonals: Array  # int32[lanes]
    began: Array  # int32[lanes], row of the record
    visited: Array  # uint8[slots * size]
    record: Array  # int32[rows * slots], edges gone: place * 8 + move
    owner: Array  # int32[rows / CHUNK, slots], whose they are
    ends: Array  # int32[jobs + 1, 4], steps (0: did not arrive), diagonals, row, slot


_BY_LANE = (
    "slot",
    "job",
    "place",
    "base",
    "stamp",
    "alive",
    "arrived",
    "steps",
    "diagonals",
    "began",
)


def walked(
    static: AcoStatic,
    queries: AcoQueries,
    count: Array,
    iteration: Array,
    weight: Array,
    record: Array,
) -> Walk:
    """Let the ants of one iteration walk until all have ended.

    The last of them, in few lanes, move on together: longest walks are long.
    """
    n_jobs = count * static.ants
    few = max(LEAST_LANES, static.lanes // NARROWING)

    def unfinished(least: int, walk: Walk) -> Array:
        left = jnp.sum(walk.alive, dtype=jnp.int32) >= least
        return (left | (walk.next_job < n_jobs)) & (walk.time < static.rows)

    def turn(refill: bool, walk: Walk) -> Walk:
        walk = _refilled(static, queries, count, walk) if refill else walk
        walk = replace(walk, owner=_owned(static, walk))
        ant, query = walk.job // static.queries, walk.job % static.queries
        first = ant * static.max_steps + walk.steps
        index = first // 4 + jnp.arange(CHUNK // 4, dtype=jnp.int32)[:, None]
        drawn = words(queries.seed[:, query][:, None], iteration, index)
        draws = jnp.stack([uniform(word, weight.dtype) for word in drawn], axis=1)
        draws = draws.reshape(CHUNK, -1) * _BELOW_ONE
        goal = query * static.size + queries.goal[query]
        step = partial(_stepped, static, weight, draws, goal)
        return _ended(static, lax.fori_loop(0, CHUNK, step, walk))

    narrows = few < static.lanes
    walk = _idle(static, record)
    walk = lax.while_loop(partial(unfinished, few + 1 if narrows else 1), partial(turn, True), walk)
    if narrows:
        walk = _gathered(walk, few)
        walk = lax.while_loop(partial(unfinished, 1), partial(turn, False), walk)
    return walk


def _gathered(walk: Walk, count: int) -> Walk:
    """The lanes under way, at most `count`, and none of the others."""
    chosen = jnp.argsort(~walk.alive, stable=True)[:count]
    lanes = {f.name: getattr(walk, f.name)[chosen] for f in fields(Walk) if f.name in _BY_LANE}
    return replace(walk, **lanes)


def _owned(static: AcoStatic, walk: Walk) -> Array:
    """Note whose the next rows of the record are."""
    nobody = static.queries * static.ants
    job = jnp.where(walk.alive, walk.job, nobody)
    row = jnp.full(static.lanes, nobody, jnp.int32)
    row = _put(row, walk.slot, job)
    return lax.dynamic_update_index_in_dim(walk.owner, row, walk.time // CHUNK, axis=0)


def _idle(static: AcoStatic, record: Array) -> Walk:
    zero = jnp.zeros(static.lanes, jnp.int32)
    nobody = static.queries * static.ants
    return Walk(
        time=jnp.int32(0),
        next_job=jnp.int32(0),
        slot=jnp.arange(static.lanes, dtype=jnp.int32),
        job=zero + nobody,
        place=zero,
        base=zero,
        stamp=zero.astype(jnp.uint8),
        alive=zero > 0,
        arrived=zero > 0,
        steps=zero,
        diagonals=zero,
        began=zero,
        visited=jnp.zeros(static.lanes * static.size, jnp.uint8),
        record=record,
        owner=jnp.full((static.rows // CHUNK, static.lanes), nobody, jnp.int32),
        ends=jnp.zeros((nobody + 1, 4), jnp.int32),
    )


def _refilled(static: AcoStatic, queries: AcoQueries, count: Array, walk: Walk) -> Walk:
    """Idle lanes take the next ants, one of each query in turn."""
    given = walk.next_job + jnp.cumsum(~walk.alive, dtype=jnp.int32) - 1
    takes = ~walk.alive & (given < count * static.ants)
    query = given % count
    place = jnp.where(takes, query * static.size + queries.start[query], walk.place)
    base = jnp.where(takes, (walk.slot - query) * static.size, walk.base)
    stamp = walk.stamp + takes.astype(jnp.uint8)
    used_up = takes & (stamp == 0)

    def clear(i: Array, visited: Array) -> Array:
        clean = jnp.zeros(static.size, jnp.uint8)
        return lax.dynamic_update_slice(visited, clean, (order[i] * static.size,))

    order = jnp.argsort(~used_up, stable=True).astype(jnp.int32)
    visited = lax.fori_loop(0, jnp.sum(used_up, dtype=jnp.int32), clear, walk.visited)
    stamp = jnp.maximum(stamp, 1)
    job = jnp.where(takes, given // count * static.queries + query, walk.job)
    return replace(
        walk,
        next_job=walk.next_job + jnp.sum(takes, dtype=jnp.int32),
        job=job,
        place=place,
        base=base,
        stamp=stamp,
        alive=walk.alive | takes,
        arrived=walk.arrived & ~takes,
        steps=jnp.where(takes, 0, walk.steps),
        diagonals=jnp.where(takes, 0, walk.diagonals),
        began=jnp.where(takes, walk.time, walk.began),
        visited=_put(visited, base + place, stamp),
    )


def _put(array: Array, index: Array, value: Array) -> Array:
    return array.at[index].set(value, unique_indices=True, mode="promise_in_bounds")


def _stepped(
    static: AcoStatic, weight: Array, draws: Array, goal: Array, i: Array, walk: Walk
) -> Walk:
    """One step of every ant under way."""
    offset = jnp.array([dy * static.stride + dx for dx, dy in MOVES], jnp.int32)
    beside = (walk.base + walk.place) + offset[:, None]
    seen = walk.visited.at[beside].get(mode="promise_in_bounds")
    edges = weight.at[walk.place].get(mode="promise_in_bounds").T
    # Kept apart from what follows, or all of it becomes one loop over ants without vectors.
    edges = lax.optimization_barrier(jnp.where(seen == walk.stamp, 0.0, edges))
    total, sums = edges[0], [edges[0]]
    for k in range(1, 8):
        total = total + edges[k]
        sums.append(total)
    aim = draws[i] * total
    move = sum(((aim >= part).astype(jnp.int32) for part in sums[:7]), jnp.int32(0))
    edge = jnp.where(walk.alive & (total > 0), walk.place * 8 + move, weight.size)
    record, edge = _recorded(static, walk, edge)
    going, move = edge < weight.size, edge & 7
    place = jnp.where(going, (edge >> 3) + offset[move], walk.place)
    there = going & (place == goal)
    return replace(
        walk,
        time=walk.time + 1,
        place=place,
        alive=going & ~there,
        arrived=walk.arrived | there,
        steps=walk.steps + going,
        diagonals=walk.diagonals + (going & (move >= 4)),
        visited=_put(walk.visited, walk.base + place, walk.stamp),
        record=record,
    )


def _recorded(static: AcoStatic, walk: Walk, edge: Array) -> tuple[Array, Array]:
    """The record with the edges gone now, and these read back from it.

    Read back, the choice is computed once and not again in everything that depends on it.
    """
    row = walk.time * static.lanes
    if len(edge) == static.lanes:
        record = lax.dynamic_update_slice(walk.record, edge, (row,))
        return record, lax.dynamic_slice(record, (row,), edge.shape)
    record = _put(walk.record, row + walk.slot, edge)
    return record, record.at[row + walk.slot].get(mode="promise_in_bounds")


def _ended(static: AcoStatic, walk: Walk) -> Walk:
    """Note what has become of the ants whose walk is over."""
    alive = walk.alive & (walk.steps < static.max_steps)
    nobody = static.queries * static.ants
    steps = jnp.where(walk.arrived, walk.steps, 0)
    row = jnp.stack([steps, walk.diagonals, walk.began, walk.slot], axis=1)
    ends = walk.ends.at[jnp.where(alive, nobody, walk.job)].set(row, mode="promise_in_bounds")
    return replace(walk, alive=alive, job=jnp.where(alive, walk.job, nobody), ends=ends)
