"""A genetic algorithm of real numbers.

Yu et al. 2022 print the chances of crossing and mutation and the number of generations. The rest
is assumed: tournaments of two, blend crossing (BLX-alpha, Eshelman and Schaffer 1993), a mutation
that draws one coordinate anew, and the best one passed on as it is.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels import draws
from usvkernels.swarms.pack import (
    Box,
    Found,
    Objective,
    Record,
    better,
    evaluate,
    first_record,
    numbers,
    pick,
    pick_value,
    scattered,
)


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class GaParams:
    """Each a number or float[R], one per run.

    Attributes:
        crossing: chance that a child is a blend of two parents, not a copy of one.
        mutation: chance that one coordinate of a child is drawn anew.
        blend: how far a child may lie outside its parents, as a share of their distance.
    """

    crossing: float | Array = 0.8  # section 5.1
    mutation: float | Array = 0.2  # section 5.1
    blend: float | Array = 0.366  # not printed; widens what blending narrows


@dataclass(frozen=True)
class GaStatic:
    """Choices of method.

    Attributes:
        elitism: the best one so far takes the place of the first child.
    """

    elitism: bool = True


def run(
    fn: Objective,
    box: Box,
    seed: Array,
    params: GaParams,
    static: GaStatic,
    *,
    population: int,
    iterations: int,
) -> Found:
    """Minimise fn in R runs; population * iterations evaluations each.

    Args:
        fn: the function.
        box: its bounds; positions are clipped to them.
        seed: uint32[2, R].
        params: leaves float or float[R].
        static: choices of method.
        population: individuals.
        iterations: T, generations, the random first one included.

    Returns:
        What was found.
    """

    def step(carry: tuple[Array, Array, Record], time: Array) -> tuple[tuple, Array]:
        x, value, record = carry
        x = _children(x, value, params, seed, time)
        x = jnp.clip(_mutated(x, box, params, seed, time), box.low, box.high)
        if static.elitism:
            x = x.at[0].set(record.x)
        value, nans = evaluate(fn, x)
        record = better(record, value, x, nans)
        return (x, value, record), record.best

    x = scattered(seed, box, population)
    value, nans = evaluate(fn, x)
    record = first_record(value, x, nans)
    begun = (x, value, record)
    (_, _, last), history = lax.scan(step, begun, jnp.arange(1, iterations))
    history = jnp.concatenate([record.best[None], history])
    return Found(last.best, last.x, history, last.nans)


def _children(x: Array, value: Array, params: GaParams, seed: Array, time: Array) -> Array:
    """Children float[n, dim, R] of parents that won tournaments."""
    members, dim, _ = x.shape
    dtype = x.dtype
    entrants = jnp.stack(numbers(seed, time, (members,), 0))
    entrants = _index(entrants, members)
    scores = jnp.stack([pick_value(value, one) for one in entrants])
    mother = jnp.where(scores[0] <= scores[1], entrants[0], entrants[1])
    father = jnp.where(scores[2] <= scores[3], entrants[2], entrants[3])
    a, b = pick(x, mother), pick(x, father)
    crossed = draws.uniform(numbers(seed, time, (members,), 1)[0], dtype)
    share = draws.uniform(numbers(seed, time, (members, dim), 2)[0], dtype)
    blend = jnp.asarray(params.blend, dtype)
    child = a + (share * (1 + 2 * blend) - blend) * (b - a)
    return jnp.where((crossed < jnp.asarray(params.crossing, dtype))[:, None], child, a)


def _mutated(x: Array, box: Box, params: GaParams, seed: Array, time: Array) -> Array:
    members, dim, _ = x.shape
    dtype = x.dtype
    chance, gene, place, _ = numbers(seed, time, (members,), 3)
    hit = draws.uniform(chance, dtype) < jnp.asarray(params.mutation, dtype)
    here = jnp.arange(dim)[:, None] == _index(gene, dim)[:, None]
    new = box.low + (box.high - box.low) * draws.uniform(place, dtype)[:, None]
    return jnp.where(hit[:, None] & here, new, x)


def _index(word: Array, count: int) -> Array:
    """Indices int32 below `count`, which is small, from words."""
    return jnp.minimum((draws.uniform(word) * count).astype(jnp.int32), count - 1)
