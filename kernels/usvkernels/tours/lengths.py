"""Distances looked up and added up along tours.

Everywhere in this package runs lie on the last axis, along the vectors of a processor. Distances
are float[d, d], shared by all runs, or float[d, d, R]; entry [a, b] is from a to b. A tour is
closed; an open one is a closed one whose legs back to the start cost nothing (`open_ended`).
"""

import jax
import jax.numpy as jnp
from jax import Array


def leg(distances: Array, start: Array, end: Array) -> Array:
    """Distances between stations.

    Args:
        distances: float[d, d] or float[d, d, R].
        start: int32[..., R], stations 0 .. d - 1.
        end: int32[..., R].

    Returns:
        float[..., R], of the shape that start and end broadcast to.
    """
    count = distances.shape[0]
    place = start * count + end
    if distances.ndim == 3:
        runs = distances.shape[2]
        place = place * runs + jnp.arange(runs, dtype=place.dtype)
    return distances.reshape(-1).at[place].get(mode="promise_in_bounds")


def length(distances: Array, order: Array) -> Array:
    """Lengths of closed tours.

    Args:
        distances: float[d, d] or float[d, d, R].
        order: int32[d, R] or int32[d, n, R], stations in the order of the visits.

    Returns:
        float[R] or float[n, R]. Source: Yu et al. 2022, Eq. 8.
    """
    return jnp.sum(leg(distances, order, jnp.roll(order, -1, axis=0)), axis=0)


def open_ended(distances: Array) -> Array:
    """Distances with which a closed tour from station 0 costs what the open one does."""
    return distances.at[:, 0].set(0)


def from_start(order: Array) -> Array:
    """The same closed tours int32[d, R], turned so that station 0 comes first."""
    count = order.shape[0]
    place = jnp.arange(count, dtype=order.dtype)[:, None]
    first = jnp.sum(jnp.where(order == 0, place, 0), axis=0)
    turned = first + place
    return jnp.take_along_axis(order, jnp.where(turned < count, turned, turned - count), axis=0)


@jax.named_scope("order_of")
def order_of(keys: Array) -> Array:
    """The stations in the order of their keys: a stable argsort along the first axis.

    By counting, which for the tens of stations of a tour is far cheaper than a sort.

    Args:
        keys: float[d, ...], none of them NaN.

    Returns:
        int32[d, ...].
    """
    rank = rank_of(keys)
    place = jnp.arange(keys.shape[0], dtype=jnp.int32)
    return inverse(rank, place)


def rank_of(keys: Array) -> Array:
    """Where each key stands in the order, equal ones as they come; int32[d, ...]."""
    count = keys.shape[0]
    place = jnp.arange(count, dtype=jnp.int32).reshape(-1, *[1] * (keys.ndim - 1))

    def compared(j: int, rank: Array) -> Array:
        other = keys[j]
        return rank + ((other < keys) | ((other == keys) & (place > j)))

    rank = jnp.zeros(keys.shape, jnp.int32)
    for j in range(count):
        rank = compared(j, rank)
    return rank


def inverse(rank: Array, values: Array) -> Array:
    """What has each rank; int32[d, ...] of ranks int32[d, ...] and values int32[d] or alike."""
    count = rank.shape[0]
    place = jnp.arange(count, dtype=jnp.int32).reshape(-1, *[1] * (rank.ndim - 1))
    order = jnp.zeros(rank.shape, jnp.int32)
    for j in range(count):
        order = jnp.where(rank[j] == place, values[j], order)
    return order
