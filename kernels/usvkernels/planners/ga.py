"""A genetic algorithm for paths on a grid, several queries side by side.

Individuals are paths. The first are drawn as random columns, one per row between start and goal,
repaired by inserting cells. In each generation individuals are drawn in proportion to their
fitness; neighbours, with probability `crossover`, exchange their ends behind a cell that they
share, drawn among the rows in which they do; with probability `mutation` the cells between two
drawn rows are cut out and the ends joined by a straight line, repaired again. Fitness is
length_weight / length + smoothness_weight / smoothness.

Yu et al. 2022, section 5.1 print generations, both probabilities and both weights for their
Algorithm 2. Assumed: the operators; population; smoothness = 25 + 25 for each turn by 45 degrees,
50 by 90, 100 by 135 and 200 by 180, the best of five forms tried by length and turns; paths in rows
(`rows`); the best individual so far takes the place of the first; the path that is returned is that
of the best fitness.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax
from jax.typing import DTypeLike

from usvkernels.draws import uniform, words
from usvkernels.planners.rows import (
    Frame,
    RowPlans,
    RowQueries,
    entries,
    frame,
    length_of,
    measure,
    thread,
)

PENALTIES = (25, 50, 100, 200)
"""What turns by 45, 90, 135 and 180 degrees add to the smoothness."""

STRAIGHT_ON = 25
"""Smoothness of a path without a turn, which would be infinitely fit with 0."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class GaParams:
    """Numbers, or arrays of no dimension; of Yu et al. 2022, section 5.1, by default."""

    crossover: Array | float = 0.8  # pc
    mutation: Array | float = 0.2  # pm
    length_weight: Array | float = 1.0  # a
    smoothness_weight: Array | float = 7.0  # b


@dataclass(frozen=True)
class GaStatic:
    """Sizes."""

    rows: int  # of a frame, more than lie between any start and goal
    population: int  # even
    iterations: int  # generations


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Population:
    """Of all queries; lane q * population + i is individual i of query q."""

    exits: Array  # int32[R, L]
    alive: Array  # bool[L], whether it is a path
    fitness: Array  # float[L], 0 of what is none
    length: Array  # float[L]


def plan(static: GaStatic, params: GaParams, queries: RowQueries) -> RowPlans:
    """Plan all queries; start and goal differ and are free."""
    place = frame(queries, static.rows, static.population)
    dtype = jnp.result_type(float)
    count = len(queries.blocked)
    nobody = jnp.zeros((static.rows, place.base.shape[0]), jnp.int32)
    parents = _judged(params, place, nobody, nobody[0] > 0, dtype)
    best = _first_of_each(static, parents)
    history = jnp.zeros((static.iterations, count), dtype)

    def generation(
        time: Array, carry: tuple[_Population, _Population, Array]
    ) -> tuple[_Population, _Population, Array]:
        parents, best, history = carry
        chosen = _selected(static, place, parents, time)
        crossed = _crossed(static, params, place, chosen, time)
        exits, alive = _mutated(static, params, place, crossed, chosen.alive, time)
        judged = _judged(params, place, exits, alive, dtype)
        best = _best(static, best, judged)
        history = lax.dynamic_update_index_in_dim(history, best.length, time, axis=0)
        return _with_elite(static, judged, best), best, history

    carry = (parents, best, history)
    _, best, history = lax.fori_loop(0, static.iterations, generation, carry)
    return _plans(static, place, best, history)


def _plans(static: GaStatic, place: Frame, best: _Population, history: Array) -> RowPlans:
    spread = jnp.repeat(best.exits, static.population, axis=1)
    joins = measure(place, spread).joins[:, :: static.population]
    return RowPlans(best.exits, joins, best.length, history)


def _judged(
    params: GaParams, place: Frame, exits: Array, alive: Array, dtype: DTypeLike
) -> _Population:
    measured = measure(place, exits)
    length = length_of(measured, alive, dtype)
    penalty = jnp.array(PENALTIES, jnp.int32)[:, None]
    smoothness = STRAIGHT_ON + jnp.sum(measured.turns * penalty, axis=0).astype(dtype)
    fitness = params.length_weight / length + params.smoothness_weight / smoothness
    return _Population(exits, alive, jnp.where(alive, fitness, 0.0).astype(dtype), length)


def _grouped(static: GaStatic, lanes: Array) -> Array:
    """Lanes, the last axis, as queries and members."""
    return lanes.reshape(*lanes.shape[:-1], -1, static.population)


def _draws(static: GaStatic, place: Frame, time: Array, stream: int) -> tuple[Array, ...]:
    """Four words for each lane."""
    lane = jnp.arange(place.base.shape[0], dtype=jnp.int32)
    member = lane % static.population
    return words(place.seed, time, member + stream * static.population)


def _selected(static: GaStatic, place: Frame, parents: _Population, time: Array) -> _Population:
    """Draw as many individuals by roulette wheel."""
    wheel = jnp.cumsum(_grouped(static, parents.fitness), axis=-1)
    draw = _uniform(_draws(static, place, time, 0)[0])
    aim = _grouped(static, draw) * wheel[:, -1:]
    index = jnp.sum(aim[:, :, None] >= wheel[:, None], axis=-1, dtype=jnp.int32)
    index = jnp.minimum(index, static.population - 1)
    start = jnp.arange(index.shape[0], dtype=jnp.int32)[:, None] * static.population
    lane = (start + index).reshape(-1)
    return jax.tree.map(lambda leaf: jnp.take(leaf, lane, axis=-1), parents)


def _crossed(
    static: GaStatic, params: GaParams, place: Frame, chosen: _Population, time: Array
) -> Array:
    """Exchange the ends of neighbours behind a shared cell; exits int32[R, L]."""
    exits = chosen.exits
    enters = entries(place, exits)
    low, high = jnp.minimum(enters, exits), jnp.maximum(enters, exits)
    row = jnp.arange(static.rows, dtype=jnp.int32)[:, None]
    between = (row > 0) & (row < place.rows[::2])
    shared = jnp.maximum(low[:, ::2], low[:, 1::2]) <= jnp.minimum(high[:, ::2], high[:, 1::2])
    shared = shared & between & chosen.alive[::2] & chosen.alive[1::2]
    rank = jnp.cumsum(shared, axis=0, dtype=jnp.int32)
    crosses, where, *_ = (word[::2] for word in _draws(static, place, time, 1))
    wanted = (_uniform(where) * rank[-1]).astype(jnp.int32)
    cut = jnp.sum(rank <= wanted, axis=0, dtype=jnp.int32)
    does = (rank[-1] > 0) & (_uniform(crosses) < params.crossover)
    swaps = does & (row >= cut)
    even = jnp.where(swaps, exits[:, 1::2], exits[:, ::2])
    odd = jnp.where(swaps, exits[:, ::2], exits[:, 1::2])
    return jnp.stack([even, odd], axis=-1).reshape(exits.shape)


def _uniform(word: Array) -> Array:
    return uniform(word, jnp.result_type(float))


def _mutated(
    static: GaStatic, params: GaParams, place: Frame, exits: Array, alive: Array, time: Array
) -> tuple[Array, Array]:
    """Join two rows of some by a straight line, and draw anew what is no path."""
    mutates, one, other, _ = (_uniform(word) for word in _draws(static, place, time, 2))
    one, other = ((draw * place.rows).astype(jnp.int32) for draw in (one, other))
    begin, end = jnp.minimum(one, other), jnp.maximum(one, other)
    row = jnp.arange(static.rows, dtype=jnp.int32)[:, None]
    lane = jnp.arange(exits.shape[1], dtype=jnp.int32)
    here, there = entries(place, exits)[begin, lane], exits[end, lane]
    steps = end - begin + 1
    line = here + ((there - here) * (row - begin + 1) + steps // 2) // steps
    cuts = (row >= begin) & (row <= end) & (mutates < params.mutation)
    member = lane % static.population
    index = row * static.population + member
    word, *_ = words(place.seed, -1 - time, index)
    anywhere = (_uniform(word) * place.width).astype(jnp.int32)
    wish = jnp.where(alive, jnp.where(cuts, line, exits), anywhere)
    threaded, arrives = thread(place, wish)
    return jnp.where(arrives, threaded, exits), arrives | alive


def _best(static: GaStatic, best: _Population, judged: _Population) -> _Population:
    """The fittest of each query so far, fields [..., Q]."""
    fitness = _grouped(static, judged.fitness)
    index = jnp.argmax(fitness, axis=-1).astype(jnp.int32)
    lane = jnp.arange(index.shape[0], dtype=jnp.int32) * static.population + index
    found = jax.tree.map(lambda leaf: jnp.take(leaf, lane, axis=-1), judged)
    better = found.fitness > best.fitness
    return jax.tree.map(lambda new, old: jnp.where(better, new, old), found, best)


def _first_of_each(static: GaStatic, population: _Population) -> _Population:
    return jax.tree.map(lambda leaf: leaf[..., :: static.population], population)


def _with_elite(static: GaStatic, judged: _Population, best: _Population) -> _Population:
    lane = jnp.arange(judged.alive.shape[0], dtype=jnp.int32)
    first = lane % static.population == 0

    def keep(best_leaf: Array, leaf: Array) -> Array:
        spread = jnp.repeat(best_leaf, static.population, axis=-1)
        return jnp.where(first, spread, leaf)

    return jax.tree.map(keep, best, judged)
