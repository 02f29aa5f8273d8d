"""The ants of one iteration on their way, as a program for the lanes.

Walks are short on average and now and then very long, so that a lane per ant would mostly wait.
An ant's walk depends on its query, the iteration and its own number alone.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.draws import uniform, words
from usvkernels.lanes import LEAST_LANES, InPlace, run, those
from usvkernels.planners.moves import MOVES

CHUNK = 8  # steps of an ant in one of its lane; a multiple of the four words of a draw
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
class Ants:
    """Ants under way, lanes last."""

    slot: Array  # int32[lanes], column of the record that the lane writes to
    job: Array  # int32[lanes], ant * queries + query
    place: Array  # int32[lanes], query * size + cell
    stamp: Array  # uint8[lanes], what marks this ant's visits
    alive: Array  # bool[lanes]
    arrived: Array  # bool[lanes]
    steps: Array  # int32[lanes]
    diagonals: Array  # int32[lanes]
    began: Array  # int32[lanes], row of the record
    visited: Array  # uint8[lanes * size]


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Log:
    """The ways of all ants, in the order of time."""

    time: Array  # int32, steps that the lanes have made
    record: Array  # int32[rows * slots], edges gone: place * 8 + move
    owner: Array  # int32[rows / CHUNK, slots], whose they are: ant * queries + query


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Walk:
    """What the ants of an iteration did."""

    ends: Array  # int32[ants * queries, 4], steps (0: did not arrive), diagonals, row, slot
    log: Log


def walked(
    static: AcoStatic,
    queries: AcoQueries,
    count: Array,
    iteration: Array,
    weight: Array,
    record: Array,
) -> Walk:
    """Let the ants of one iteration walk until all have ended; one of each query in turn begins.

    A step of the lanes is CHUNK of an ant's, since numbers are drawn for so many at a time.

    Args:
        static: sizes.
        queries: what is asked.
        count: int32, how many of the queries are real, 1 or more; may be traced.
        iteration: int32, by which random numbers differ.
        weight: float[queries * size, 8], of each move from each place; 0 where it is closed.
        record: int32[rows * lanes], space for `Log.record`.
    """
    jobs = static.ants * static.queries
    program = InPlace(
        idle=partial(_idle, static),
        refill=partial(_refilled, static, queries, count),
        step=partial(_advanced, static, queries, iteration, weight),
        done=lambda ants: ~ants.alive,
        taken=lambda ants: ants.steps,
        result=_end,
        log=Log(
            time=jnp.int32(0),
            record=record,
            owner=jnp.full((static.rows // CHUNK, static.lanes), jobs, jnp.int32),
        ),
        narrowing=max(1, min(NARROWING, static.lanes // LEAST_LANES)),
    )
    (ends, log), _ = run(program, count * static.ants, capacity=jobs, lanes=static.lanes, chunk=1)
    # From the order in which the ants of the real queries began.
    ant, query = jnp.divmod(jnp.arange(jobs, dtype=jnp.int32), static.queries)
    ends = jnp.where((query < count)[:, None], ends[ant * count + query], 0)
    return Walk(ends, log)


def _idle(static: AcoStatic, lanes: int) -> Ants:
    zero = jnp.zeros(lanes, jnp.int32)
    return Ants(
        slot=jnp.arange(lanes, dtype=jnp.int32),
        job=zero,
        place=zero,
        stamp=zero.astype(jnp.uint8),
        alive=zero > 0,
        arrived=zero > 0,
        steps=zero,
        diagonals=zero,
        began=zero,
        visited=jnp.zeros(lanes * static.size, jnp.uint8),
    )


def _refilled(
    static: AcoStatic, queries: AcoQueries, count: Array, ants: Ants, number: Array, takes: Array
) -> Ants:
    """The lanes that take an ant at its start."""
    ant, query = number // count, number % count
    stamp = ants.stamp + takes.astype(jnp.uint8)
    order, used = those(takes & (stamp == 0))

    def clear(i: Array, visited: Array) -> Array:
        clean = jnp.zeros(static.size, jnp.uint8)
        return lax.dynamic_update_slice(visited, clean, (order[i] * static.size,))

    return replace(
        ants,
        job=jnp.where(takes, ant * static.queries + query, ants.job),
        place=jnp.where(takes, query * static.size + queries.start[query], ants.place),
        stamp=jnp.maximum(stamp, 1),
        alive=ants.alive | takes,
        arrived=ants.arrived & ~takes,
        steps=jnp.where(takes, 0, ants.steps),
        diagonals=jnp.where(takes, 0, ants.diagonals),
        visited=lax.fori_loop(0, used, clear, ants.visited),
    )


def _base(static: AcoStatic, ants: Ants) -> Array:
    """From a place to its own plane of visits: int32[lanes]."""
    lane = jnp.arange(ants.job.shape[0], dtype=jnp.int32)
    return (lane - ants.job % static.queries) * static.size


def _put(array: Array, index: Array, value: Array) -> Array:
    return array.at[index].set(value, unique_indices=True, mode="promise_in_bounds")


def _advanced(
    static: AcoStatic,
    queries: AcoQueries,
    iteration: Array,
    weight: Array,
    ants: Ants,
    log: Log,
) -> tuple[Ants, Log]:
    """CHUNK steps of every ant under way."""
    base = _base(static, ants)
    ants = replace(
        ants,
        began=jnp.where(ants.steps == 0, log.time, ants.began),
        visited=_put(ants.visited, base + ants.place, ants.stamp),  # where they start
    )
    log = replace(log, owner=_owned(static, ants, log))
    ant, query = ants.job // static.queries, ants.job % static.queries
    first = ant * static.max_steps + ants.steps
    index = first // 4 + jnp.arange(CHUNK // 4, dtype=jnp.int32)[:, None]
    drawn = words(queries.seed[:, query][:, None], iteration, index)
    draws = jnp.stack([uniform(word, weight.dtype) for word in drawn], axis=1)
    draws = draws.reshape(CHUNK, -1) * _BELOW_ONE
    goal = query * static.size + queries.goal[query]

    def step(i: Array, carry: tuple[Ants, Log]) -> tuple[Ants, Log]:
        return _stepped(static, weight, draws[i], goal, base, *carry)

    ants, log = lax.fori_loop(0, CHUNK, step, (ants, log))
    return replace(ants, alive=ants.alive & (ants.steps < static.max_steps)), log


def _owned(static: AcoStatic, ants: Ants, log: Log) -> Array:
    """Note whose the next rows of the record are."""
    nobody = static.queries * static.ants
    row = jnp.full(static.lanes, nobody, jnp.int32)
    row = _put(row, ants.slot, jnp.where(ants.alive, ants.job, nobody))
    return lax.dynamic_update_index_in_dim(log.owner, row, log.time // CHUNK, axis=0)


def _stepped(
    static: AcoStatic,
    weight: Array,
    draw: Array,
    goal: Array,
    base: Array,
    ants: Ants,
    log: Log,
) -> tuple[Ants, Log]:
    """One step of every ant under way."""
    offset = jnp.array([dy * static.stride + dx for dx, dy in MOVES], jnp.int32)
    beside = (base + ants.place) + offset[:, None]
    seen = ants.visited.at[beside].get(mode="promise_in_bounds")
    edges = weight.at[ants.place].get(mode="promise_in_bounds").T
    # Kept apart from what follows, or all of it becomes one loop over ants without vectors.
    edges = lax.optimization_barrier(jnp.where(seen == ants.stamp, 0.0, edges))
    total, sums = edges[0], [edges[0]]
    for k in range(1, 8):
        total = total + edges[k]
        sums.append(total)
    aim = draw * total
    move = sum(((aim >= part).astype(jnp.int32) for part in sums[:7]), jnp.int32(0))
    edge = jnp.where(ants.alive & (total > 0), ants.place * 8 + move, weight.size)
    record, edge = _recorded(static, ants.slot, log, edge)
    going, move = edge < weight.size, edge & 7
    place = jnp.where(going, (edge >> 3) + offset[move], ants.place)
    there = going & (place == goal)
    ants = replace(
        ants,
        place=place,
        alive=going & ~there,
        arrived=ants.arrived | there,
        steps=ants.steps + going,
        diagonals=ants.diagonals + (going & (move >= 4)),
        visited=_put(ants.visited, base + place, ants.stamp),
    )
    return ants, Log(log.time + 1, record, log.owner)


def _recorded(static: AcoStatic, slot: Array, log: Log, edge: Array) -> tuple[Array, Array]:
    """The record with the edges gone now, and these read back from it.

    Read back, the choice is computed once and not again in everything that depends on it.
    """
    row = log.time * static.lanes
    if len(edge) == static.lanes:
        record = lax.dynamic_update_slice(log.record, edge, (row,))
        return record, lax.dynamic_slice(record, (row,), edge.shape)
    record = _put(log.record, row + slot, edge)
    return record, record.at[row + slot].get(mode="promise_in_bounds")


def _end(ants: Ants) -> Array:
    """A row of `Walk.ends` per lane."""
    steps = jnp.where(ants.arrived, ants.steps, 0)
    return jnp.stack([steps, ants.diagonals, ants.began, ants.slot], axis=1)
