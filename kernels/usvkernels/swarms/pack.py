"""What all swarms share: positions [members, dim, runs], their evaluation and their best.

Runs lie on the last axis, along the vectors of a processor. Run r depends on its own seed,
schedule and parameters alone.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels import draws

Objective = Callable[[Array], Array]
"""A function of float[dim] that returns one number, traceable by JAX."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Box:
    """Bounds of the search.

    Attributes:
        low: float[dim, 1].
        high: float[dim, 1], above `low`.
    """

    low: Array
    high: Array


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Found:
    """What R runs of T iterations found.

    Attributes:
        best: float[R], least value evaluated; inf where none was a number.
        x: float[dim, R], where.
        history: float[T, R], least value up to the end of each iteration.
        nans: int32[R], evaluations that gave NaN.
    """

    best: Array
    x: Array
    history: Array
    nans: Array


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Record:
    """The best so far.

    Attributes:
        best: float[R].
        x: float[dim, R].
        nans: int32[R].
    """

    best: Array
    x: Array
    nans: Array


def evaluate(fn: Objective, x: Array) -> tuple[Array, Array]:
    """Values float[n, R] of positions float[n, dim, R], and int32[R] how many were NaN.

    A NaN counts as inf, so that it ranks last and never wins.
    """
    value = jax.vmap(jax.vmap(fn, in_axes=-1), in_axes=0)(x).astype(x.dtype)
    bad = jnp.isnan(value)
    return jnp.where(bad, jnp.inf, value), jnp.sum(bad, axis=0, dtype=jnp.int32)


def lowest(value: Array, count: int) -> tuple[Array, Array]:
    """The `count` lowest of values float[n, R] in their order, float and int32[count, R].

    The first of equal ones comes first. By repeated minima: for a few, much cheaper than a sort.
    """
    place = jax.lax.broadcasted_iota(jnp.int32, value.shape, 0)
    left = jnp.ones(value.shape, bool)
    values, indices = [], []
    for _ in range(count):
        least = jnp.min(jnp.where(left, value, jnp.inf), axis=0)
        candidates = left & (value == least)
        index = jnp.min(jnp.where(candidates, place, value.shape[0] - 1), axis=0)
        left = left & (place != index)
        values.append(least)
        indices.append(index)
    return jnp.stack(values), jnp.stack(indices)


def pick(x: Array, index: Array) -> Array:
    """Positions float[m, dim, R] of members index int[m, R], of float[n, dim, R]."""
    return jnp.take_along_axis(x, index[:, None], axis=0)


def pick_value(value: Array, index: Array) -> Array:
    """Values float[m, R] of members index int[m, R], of float[n, R]."""
    return jnp.take_along_axis(value, index, axis=0)


def better(record: Record, value: Array, x: Array, nans: Array) -> Record:
    """Take the best of the values float[n, R] at x float[n, dim, R] where it is lower."""
    least, index = lowest(value, 1)
    new = least[0] < record.best
    return Record(
        best=jnp.where(new, least[0], record.best),
        x=jnp.where(new, pick(x, index)[0], record.x),
        nans=record.nans + nans,
    )


def first_record(value: Array, x: Array, nans: Array) -> Record:
    """The best of a first evaluation."""
    least, index = lowest(value, 1)
    return Record(best=least[0], x=pick(x, index)[0], nans=nans)


def numbers(
    seed: Array, time: Array | int, shape: tuple[int, ...], stream: int = 0
) -> tuple[Array, Array, Array, Array]:
    """Four words uint32[*shape, R] each, for runs of seeds uint32[2, R].

    Args:
        seed: of `draws.seeds`.
        time: iteration; 0 is the start.
        shape: of what is drawn, such as (members, dim).
        stream: draws of one shape at one time differ in their stream.
    """
    size = 1
    for axis in shape:
        size *= axis
    index = jnp.arange(stream * size, (stream + 1) * size, dtype=jnp.uint32)
    ones = (1,) * len(shape)
    return draws.words(seed.reshape(2, *ones, -1), time, index.reshape(*shape, 1))


def scattered(seed: Array, box: Box, members: int) -> Array:
    """Members drawn uniformly in the box; float[members, dim, R]."""
    word, *_ = numbers(seed, 0, (members, box.low.shape[0]))
    return box.low + (box.high - box.low) * draws.uniform(word, box.low.dtype)
