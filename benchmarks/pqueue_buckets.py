"""A batch of bucket queues, a contestant of pqueue_designs: fast and inexact, not in the product.

Keys are sorted into buckets of equal width, in a ring that moves on with the least key; within a
bucket, entries leave last in, first out. So order is exact to the width of a bucket only. What
does not fit into its bucket, or into the ring, is dropped and said to be.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Buckets:
    """The state of a batch of bucket queues."""

    key: Array  # int32[ring * depth, lanes]
    item: Array  # int32[ring * depth, lanes]
    count: Array  # int32[ring, lanes], entries of each bucket
    now: Array  # int32[lanes], bucket of the least key, not reduced to the ring
    overflow: Array  # bool[lanes]


def empty(lanes: int, ring: int, depth: int) -> Buckets:
    """Queues that hold nothing."""
    plane = jnp.zeros((ring * depth, lanes), jnp.int32)
    count, none = jnp.zeros((ring, lanes), jnp.int32), jnp.zeros(lanes, jnp.int32)
    return Buckets(plane, plane, count, none, jnp.zeros(lanes, bool))


def push(queues: Buckets, width: int, key: Array, item: Array) -> Buckets:
    """Add an entry, int32[lanes] each, to every queue."""
    ring, lanes = queues.count.shape
    depth = queues.key.shape[0] // ring
    lane = jnp.arange(lanes)
    bucket = key // width
    slot = bucket % ring
    at = queues.count[slot, lane]
    fits = (at < depth) & (bucket >= queues.now) & (bucket < queues.now + ring)
    row = jnp.where(fits, slot * depth + at, ring * depth)
    return replace(
        queues,
        key=queues.key.at[row, lane].set(key, mode="drop"),
        item=queues.item.at[row, lane].set(item, mode="drop"),
        count=queues.count.at[slot, lane].add(fits.astype(jnp.int32)),
        overflow=queues.overflow | ~fits,
    )


def pop(queues: Buckets) -> tuple[Buckets, Array, Array]:
    """Take an entry off the first bucket of every queue that has any; also its key and item."""
    ring, lanes = queues.count.shape
    depth = queues.key.shape[0] // ring
    lane = jnp.arange(lanes)
    number = jnp.arange(ring, dtype=jnp.int32)[:, None]
    ahead = jnp.where(queues.count > 0, (number - queues.now) % ring, ring)
    now = queues.now + jnp.min(ahead, 0) % ring
    slot = now % ring
    left = jnp.maximum(queues.count[slot, lane] - 1, 0)
    row = slot * depth + left
    key, item = queues.key[row, lane], queues.item[row, lane]
    return replace(queues, count=queues.count.at[slot, lane].set(left), now=now), key, item
