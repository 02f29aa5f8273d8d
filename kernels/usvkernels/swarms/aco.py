"""Ant colony optimisation of real numbers (ACO_R): ants sample around an archive of the best.

Yu et al. 2022 minimise functions with an ant colony and do not say how a colony for tours does
that; this is the field's own extension. Of their parameters the number of ants has a meaning here;
alpha, beta, rho and Q have none. Source: Socha and Dorigo 2008, European Journal of Operational
Research 185, Eqs. 5 to 10.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax
from jax.scipy.special import ndtri
from jax.typing import DTypeLike

from usvkernels import draws
from usvkernels.swarms.pack import (
    Box,
    Found,
    Objective,
    evaluate,
    numbers,
    pick,
    pick_value,
    scattered,
)

_Colony = tuple[Array, Array, Array]  # archive, its values, NaN so far


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class AcoParams:
    """Each a number or float[R], one per run.

    Attributes:
        locality: q, above 0: the smaller, the more the best of the archive leads.
        evaporation: xi, above 0: the larger, the wider ants search and the slower they converge.
    """

    locality: float | Array = 0.01  # theirs, 1e-4, goes with two ants and stalls with 200
    evaporation: float | Array = 0.85  # Socha and Dorigo 2008


@dataclass(frozen=True)
class AcoStatic:
    """Choices of method.

    Attributes:
        archive: solutions kept, 2 or more.
    """

    archive: int = 50  # Socha and Dorigo 2008


def run(
    fn: Objective,
    box: Box,
    seed: Array,
    params: AcoParams,
    static: AcoStatic,
    *,
    population: int,
    iterations: int,
) -> Found:
    """Minimise fn in R runs; archive + population * iterations evaluations each.

    Args:
        fn: the function.
        box: its bounds; positions are clipped to them.
        seed: uint32[2, R].
        params: leaves float or float[R].
        static: choices of method.
        population: ants.
        iterations: T.

    Returns:
        What was found.
    """
    dtype = box.low.dtype
    chances = rank_chances(static.archive, jnp.asarray(params.locality, dtype))

    def step(carry: _Colony, time: Array) -> tuple[_Colony, Array]:
        archive, value, nans = carry
        x = _ants(archive, chances, params, seed, time, population)
        x = jnp.clip(x, box.low, box.high)
        new_value, new_nans = evaluate(fn, x)
        archive, value = _sorted(
            jnp.concatenate([archive, x]), jnp.concatenate([value, new_value]), static.archive
        )
        return (archive, value, nans + new_nans), value[0]

    x = scattered(seed, box, static.archive)
    value, nans = evaluate(fn, x)
    archive, value = _sorted(x, value, static.archive)
    (archive, value, nans), history = lax.scan(
        step, (archive, value, nans), jnp.arange(1, iterations + 1)
    )
    return Found(value[0], archive[0], history, nans)


def rank_chances(archive: int, locality: Array) -> Array:
    """Chance that an ant samples around one of ranks 0 .. l, float[archive, 1 or R].

    A Gaussian of the rank with standard deviation q k, normalised (Eq. 6) and summed up.
    """
    rank = jnp.arange(archive, dtype=locality.dtype)[:, None]
    weight = jnp.exp(-0.5 * (rank / (locality * archive)) ** 2)
    return jnp.cumsum(weight, axis=0) / jnp.sum(weight, axis=0)


def _ants(
    archive: Array, chances: Array, params: AcoParams, seed: Array, time: Array, ants: int
) -> Array:
    """Positions float[ants, dim, R] sampled around the archive float[k, dim, R]."""
    size, dim, _ = archive.shape
    dtype = archive.dtype
    guide = draws.uniform(numbers(seed, time, (ants,), 0)[0], dtype)
    rank = jnp.sum(guide[:, None] >= chances, axis=1, dtype=jnp.int32)
    rank = jnp.minimum(rank, size - 1)
    centre = pick(archive, rank)
    spread = pick(_spread(archive, archive), rank) if ants > size else _spread(archive, centre)
    sigma = jnp.asarray(params.evaporation, dtype) * spread / (size - 1)
    return centre + sigma * _normal(numbers(seed, time, (ants, dim), 1)[0], dtype)


def _spread(archive: Array, centre: Array) -> Array:
    """Sum of the distances of the archive from each centre, coordinate by coordinate."""

    def add(total: Array, other: Array) -> tuple[Array, None]:
        return total + jnp.abs(other - centre), None

    return lax.scan(add, jnp.zeros_like(centre), archive)[0]


def _normal(word: Array, dtype: DTypeLike) -> Array:
    """Standard normal numbers from words; the middle of each of 2**23 equal shares."""
    share = (word >> 9).astype(jnp.int32).astype(dtype) + jnp.asarray(0.5, dtype)
    return ndtri(share * jnp.asarray(2.0**-23, dtype))


def _sorted(x: Array, value: Array, count: int) -> tuple[Array, Array]:
    """The `count` lowest and their values, the lowest first."""
    order = jnp.argsort(value, axis=0, stable=True)[:count]
    return pick(x, order), pick_value(value, order)
