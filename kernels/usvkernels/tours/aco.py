"""Ants: the ant system, with the parameters of Yu et al. 2022.

Every ant builds a tour from station 0, choosing the next of the stations left with a probability
in proportion to pheromone**alpha / distance**beta. Then the pheromone of every leg loses the share
rho and gains Q / length from each ant that used it, in both directions if these are equally long.
Before the first iteration it is 1 everywhere; that is not printed.

Source: Dorigo, Maniezzo and Colorni 1996, Ant system; parameters, Yu et al. 2022, section 5.1.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels import draws
from usvkernels.swarms.pack import lowest
from usvkernels.tours.lengths import leg, length
from usvkernels.xla.stage import stage

_NEAREST = 1e-3
"""Distances count as this part of the mean at least, so that none gives an infinite weight."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class AcoParams:
    """Each a number or float[R], one per run; defaults of section 5.1.

    Attributes:
        pheromone: alpha, exponent of the pheromone ("information priming factor").
        visibility: beta, exponent of 1 / distance ("expected heuristic factor").
        evaporation: rho, share of the pheromone lost in an iteration ("volatilization factor").
        intensity: Q, pheromone that an ant leaves, times the length of its tour; that length is
            counted in mean distances, so that the result does not depend on the unit.
    """

    pheromone: float | Array = 1.0
    visibility: float | Array = 5.0
    evaporation: float | Array = 0.1
    intensity: float | Array = 1.0


def run(
    distances: Array,
    seed: Array,
    params: AcoParams,
    *,
    iterations: int,
    population: int,
    symmetric: bool,
) -> tuple[Array, Array]:
    """Search; population * iterations tours in each run.

    Args:
        distances: float[d, d] or float[d, d, R], finite.
        seed: uint32[2, R].
        params: leaves numbers or float[R].
        iterations: T.
        population: ants m.
        symmetric: whether a leg's pheromone is the same in both directions.

    Returns:
        int32[d, R], the shortest closed tours; float[T, R], their lengths so far.
    """
    count, runs = distances.shape[0], seed.shape[1]
    go = jnp.sum(distances) >= 0  # always, but a compiler does not know
    table = jnp.broadcast_to(distances.reshape(count, count, -1), (count, count, runs))
    mean = jnp.sum(table, axis=(0, 1)) / (count * (count - 1))
    mean = jnp.where(mean > 0, mean, 1)
    sight = -params.visibility * jnp.log(jnp.maximum(table / mean, _NEAREST))
    sight = jnp.where(jnp.eye(count, dtype=bool)[:, :, None], -jnp.inf, sight)

    def step(carry: tuple, time: Array) -> tuple[tuple, Array]:
        trail, best, best_length = carry
        built = partial(_built, ants=population)
        order = stage(go, built, stage(go, _weights, trail, sight, params), seed, time)
        found = stage(go, partial(length, distances), order)
        least, index = lowest(found, 1)
        shortest = jnp.take_along_axis(order, index[None], axis=1)[:, 0]
        best = jnp.where(least[0] < best_length, shortest, best)
        best_length = jnp.minimum(least[0], best_length)
        left = stage(go, _left, order, params.intensity * mean / found)
        if symmetric:
            left = left + left.transpose(1, 0, 2)
        trail = (1 - params.evaporation) * trail + left
        return (trail, best, best_length), best_length

    nothing = jnp.zeros((count, runs), jnp.int32)
    far = jnp.full(runs, jnp.inf, table.dtype)
    begun = (jnp.ones_like(table), nothing, far)
    (_, best, _), history = lax.scan(step, begun, jnp.arange(1, iterations + 1))
    return best, history


def _weights(trail: Array, sight: Array, params: AcoParams) -> Array:
    """What each leg weighs in a choice, the heaviest from each station 1; float[d, d, R]."""
    least = jnp.finfo(trail.dtype).tiny
    logarithm = params.pheromone * jnp.log(jnp.maximum(trail, least)) + sight
    return jnp.exp(logarithm - jnp.max(logarithm, axis=1, keepdims=True))


def _built(weight: Array, seed: Array, time: Array, ants: int) -> Array:
    """Tours int32[d, m, R] drawn by weights float[d, d, R] of the legs."""
    count, _, runs = weight.shape
    index = jnp.arange(ants)[:, None]
    zero = jnp.zeros((ants, runs), weight.dtype)

    def choose(place: Array, carry: tuple[Array, Array]) -> tuple[Array, Array]:
        order, left = carry  # int32[d, m, R]; float[d, m, R], 1 where not yet visited
        here = order[place - 1]

        def weighed(j: Array, sums: tuple[Array, Array]) -> tuple[Array, Array]:
            shares, total = sums
            share = leg(weight, here, j) * left[j]
            return shares.at[j].set(share), total + share

        shares, total = lax.fori_loop(0, count, weighed, (jnp.zeros_like(left), zero))
        word, *_ = draws.words(seed[:, None], time, place * ants + index)
        target = draws.uniform(word, weight.dtype) * total

        def passed(j: Array, found: tuple[Array, ...]) -> tuple[Array, ...]:
            upto, there, last = found
            upto = upto + shares[j]
            return upto, there + (upto <= target), jnp.where(left[j] > 0, j, last)

        none = jnp.zeros_like(here)
        # The first whose sum passes the target. By rounding, or where all weights vanish, there
        # is none: then the last of those left.
        _, there, last = lax.fori_loop(0, count, passed, (zero, none, none))
        there = jnp.minimum(there, last)
        stations = jnp.arange(count, dtype=jnp.int32)[:, None, None]
        return order.at[place].set(there), jnp.where(stations == there, 0, left)

    left = jnp.ones((count, ants, runs), weight.dtype).at[0].set(0)
    order = jnp.zeros((count, ants, runs), jnp.int32)
    return lax.fori_loop(1, count, choose, (order, left))[0]


def _left(order: Array, amount: Array) -> Array:
    """Pheromone float[d, d, R] that ants leave on the legs they sail, from row to column."""
    count, _, runs = order.shape
    lane = jnp.arange(runs, dtype=jnp.int32)
    table = jnp.zeros((count, count, runs), amount.dtype)
    return table.at[order, jnp.roll(order, -1, axis=0), lane].add(amount)
