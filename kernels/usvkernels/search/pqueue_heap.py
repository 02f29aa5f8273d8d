"""A batch of padded binary heaps: the reference that `pqueue` is compared with.

Keys have two parts, int32 each, in lexicographic order; equal keys leave in the order of their
items. There is no decrease-key: push the item again and skip what comes later. A heap that is
full drops what is pushed and says so.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

NOTHING = np.int32(2**31 - 1)
"""Key parts and item of an empty heap's top."""

Entry = tuple[Array, Array, Array]
"""First and second part of the key, item; int32[lanes] each."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Heaps:
    """The state of a batch of heaps; node i has the children 2 i + 1 and 2 i + 2."""

    first: Array  # int32[capacity, lanes]
    second: Array  # int32[capacity, lanes]
    item: Array  # int32[capacity, lanes]
    count: Array  # int32[lanes], entries
    overflow: Array  # bool[lanes], whether an entry was ever dropped


def empty(lanes: int, capacity: int) -> Heaps:
    """Heaps that hold nothing and have room for `capacity` entries each."""
    plane = jnp.full((capacity, lanes), NOTHING)
    none = jnp.zeros(lanes, jnp.int32)
    return Heaps(plane, plane, plane, none, jnp.zeros(lanes, bool))


def top(heaps: Heaps) -> Entry:
    """The least entry of each heap; `NOTHING` throughout where it is empty."""
    return heaps.first[0], heaps.second[0], heaps.item[0]


def push(heaps: Heaps, mask: Array, entry: Entry) -> Heaps:
    """Add an entry to the heaps of `mask` bool[lanes] that have room."""
    capacity = heaps.first.shape[0]
    room = mask & (heaps.count < capacity)
    overflow = heaps.overflow | (mask & ~room)

    def rise(_: int, carry: tuple[Heaps, Array]) -> tuple[Heaps, Array]:
        heaps, at = carry
        parent = jnp.maximum(at - 1, 0) >> 1
        above = _entry(heaps, parent)
        up = room & (at > 0) & _before(entry, above)
        return _put(heaps, at, up, above), jnp.where(up, parent, at)

    heaps, at = lax.fori_loop(0, _depth(capacity), rise, (heaps, heaps.count))
    heaps = _put(heaps, at, room, entry)
    return replace(heaps, count=heaps.count + room, overflow=overflow)


def pop(heaps: Heaps, mask: Array) -> Heaps:
    """Remove the least entry of the heaps of `mask` bool[lanes] that have one."""
    capacity, lanes = heaps.first.shape
    some = mask & (heaps.count > 0)
    last = jnp.maximum(heaps.count - 1, 0)
    entry = _entry(heaps, last)
    gone = (jnp.full(lanes, NOTHING),) * 3
    heaps = _put(heaps, last, some, gone)
    filled = some & (last > 0)

    def sink(_: int, carry: tuple[Heaps, Array]) -> tuple[Heaps, Array]:
        heaps, at = carry
        left = jnp.minimum(2 * at + 1, capacity - 1)
        right = jnp.minimum(2 * at + 2, capacity - 1)
        a, b = _entry(heaps, left), _entry(heaps, right)
        child = jnp.where(_before(b, a), right, left)
        least = tuple(jnp.where(_before(b, a), y, x) for x, y in zip(a, b, strict=True))
        down = filled & (2 * at + 1 < last) & _before((least[0], least[1], least[2]), entry)
        moved = _put(heaps, at, down, (least[0], least[1], least[2]))
        return moved, jnp.where(down, child, at)

    heaps, at = lax.fori_loop(0, _depth(capacity), sink, (heaps, jnp.zeros(lanes, jnp.int32)))
    heaps = _put(heaps, at, filled, entry)
    return replace(heaps, count=heaps.count - some)


def _depth(capacity: int) -> int:
    return max(1, capacity.bit_length())


def _before(a: Entry, b: Entry) -> Array:
    by_item = (a[1] == b[1]) & (a[2] < b[2])
    return (a[0] < b[0]) | ((a[0] == b[0]) & ((a[1] < b[1]) | by_item))


def _entry(heaps: Heaps, at: Array) -> Entry:
    lane = jnp.arange(heaps.count.shape[0])
    return heaps.first[at, lane], heaps.second[at, lane], heaps.item[at, lane]


def _put(heaps: Heaps, at: Array, mask: Array, entry: Entry) -> Heaps:
    lane = jnp.arange(heaps.count.shape[0])
    row = jnp.where(mask, at, heaps.first.shape[0])
    first, second, item = (
        plane.at[row, lane].set(new, mode="drop")
        for plane, new in zip((heaps.first, heaps.second, heaps.item), entry, strict=True)
    )
    return replace(heaps, first=first, second=second, item=item)
