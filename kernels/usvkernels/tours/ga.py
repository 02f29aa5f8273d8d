"""A genetic algorithm of tours: tournaments, order crossover, a turned stretch as mutation.

Yu et al. 2022, section 5.1, print the number of generations and both probabilities; the rest is
not printed and is as customary: the population (80, so that there are as many evaluations as the
wolves make), tournaments of three, and that the best individual lives on unchanged.

Source of the crossover: Davis 1985, Applying adaptive algorithms to epistatic domains.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels import draws
from usvkernels.swarms.pack import lowest
from usvkernels.tours.lengths import inverse, length, rank_of
from usvkernels.xla.stage import stage

TOURNAMENT = 3


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class GaParams:
    """Probabilities, each a number or float[R], one per run.

    Attributes:
        crossing: that a child has two parents, not one.
        mutation: that a stretch of it turns round.
    """

    crossing: float | Array = 0.8  # section 5.1
    mutation: float | Array = 0.2  # section 5.1


def run(
    distances: Array, seed: Array, params: GaParams, *, iterations: int, population: int
) -> tuple[Array, Array]:
    """Search; population * iterations tours in each run, the first generation included.

    Args:
        distances: float[d, d] or float[d, d, R], finite.
        seed: uint32[2, R].
        params: leaves numbers or float[R].
        iterations: generations, T.
        population: individuals n, 2 or more.

    Returns:
        int32[d, R], the shortest closed tours; float[T, R], their lengths so far.
    """
    go = jnp.sum(distances) >= 0  # always, but a compiler does not know
    count = distances.shape[0]
    measured = partial(stage, go, partial(length, distances))

    def step(carry: tuple[Array, Array], time: Array) -> tuple[tuple, Array]:
        tours, value = carry
        _, best = lowest(value, 1)
        children = _children(go, tours, value, seed, time, params)
        # The best lives on in the place of the first child.
        elite = jnp.take_along_axis(tours, best[None], axis=1)
        children = jnp.concatenate([elite, children[:, 1:]], axis=1)
        value = measured(children)
        return (children, value), jnp.min(value, axis=0)

    index = jnp.arange(count * population).reshape(count, population, 1)
    tours = stage(go, lambda seed: rank_of(draws.words(seed[:, None, None], 0, index)[0]), seed)
    value = measured(tours)
    carry, history = lax.scan(step, (tours, value), jnp.arange(1, iterations))
    history = jnp.concatenate([jnp.min(value, axis=0)[None], history])
    tours, value = carry
    _, best = lowest(value, 1)
    return jnp.take_along_axis(tours, best[None], axis=1)[:, 0], history


def _children(
    go: Array, tours: Array, value: Array, seed: Array, time: Array, params: GaParams
) -> Array:
    count, members, _ = tours.shape
    drawn = [
        word
        for part in range(3)
        for word in draws.words(
            seed[:, None], time, jnp.arange(part * members, (part + 1) * members)[:, None]
        )
    ]
    mother, father = (
        stage(go, _winner, tours, value, [_below(word, members) for word in words])
        for words in (drawn[:TOURNAMENT], drawn[TOURNAMENT : 2 * TOURNAMENT])
    )
    rest = drawn[2 * TOURNAMENT :]
    ends = stage(go, partial(_stretch, count=count), rest[0], rest[1])
    child = _order_crossover(go, mother, father, *ends)
    child = jnp.where(draws.uniform(rest[2]) < params.crossing, child, mother)
    low, high = stage(go, partial(_stretch, count=count), rest[3], rest[4])
    place = jnp.arange(count, dtype=jnp.int32)[:, None, None]
    turns = (draws.uniform(rest[5]) < params.mutation) & (place >= low) & (place <= high)
    source = jnp.where(turns, low + high - place, place)
    return stage(go, lambda child, source: jnp.take_along_axis(child, source, 0), child, source)


def _winner(tours: Array, value: Array, drawn: list[Array]) -> Array:
    """The shortest of the tours drawn, int32[d, n, R]; of equal ones the first drawn."""
    best, best_value = drawn[0], jnp.take_along_axis(value, drawn[0], axis=0)
    for other in drawn[1:]:
        other_value = jnp.take_along_axis(value, other, axis=0)
        better = other_value < best_value
        best = jnp.where(better, other, best)
        best_value = jnp.where(better, other_value, best_value)
    return jnp.take_along_axis(tours, best[None], axis=1)


def _order_crossover(go: Array, mother: Array, father: Array, low: Array, high: Array) -> Array:
    """A stretch as in the mother; the other stations behind it in the order of the father.

    That order begins behind the stretch as well, and goes round.
    """
    count = mother.shape[0]
    place = jnp.arange(count, dtype=jnp.int32)
    where_mother, where_father = (stage(go, inverse, tour, place) for tour in (mother, father))
    kept = (where_mother >= low) & (where_mother <= high)
    behind = where_father - high - 1
    behind = jnp.where(behind < 0, behind + count, behind)
    rank = stage(go, rank_of, jnp.where(kept, count, behind))  # those to be filled in come first
    target = high + 1 + rank
    target = jnp.where(target >= count, target - count, target)
    return stage(go, inverse, jnp.where(kept, where_mother, target), place)


def _stretch(one: Array, other: Array, count: int) -> tuple[Array, Array]:
    first, second = _below(one, count), _below(other, count)
    return jnp.minimum(first, second), jnp.maximum(first, second)


def _below(word: Array, bound: int) -> Array:
    return (word % jnp.uint32(bound)).astype(jnp.int32)
