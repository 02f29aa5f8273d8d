"""A batch of priority queues with one place per cell: push, decrease-key, pop-min.

A queue is a plane of keys, one per cell of a grid (or state of a search), with the minima of
blocks of cells above it. There is no heap to keep in order: a key is lowered where it lies, a
cell is queued once, nothing overflows, and pop-min reads one column of block minima and one
block. With many cells a second level of minima keeps that column short.

Keys are int32 and queued below `ABSENT`; a place may hold any value from `ABSENT` on to mark
cells that are not queued (never seen, closed, blocked), which leaves a search with one plane.
Two-part keys go in by `pair`. Among equal keys the lowest cell comes first.

Lanes are the last axis of all arrays but the planes, which are flat: lane by lane, so that the
cells of a block lie side by side. The binary heap in `pqueue_heap` is the reference; the
comparison of designs is in benchmarks/pqueue_designs.py.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from usvkernels.xla.stage import stage

ABSENT = np.int32(-1)
"""Keys are below this; places that hold it, or more, are not queued."""

LEAST_KEY = np.int32(-(2**31))
"""As `pair(0, 0, ...)`."""

_LEAF = 32  # cells of a block
_COLUMN = 176  # rows of minima that are read faster than another level of them
_INSIDE = "promise_in_bounds"
_UNROLLED = 128  # rows up to which a comparison tree is written out; compile time grows


@dataclass(frozen=True)
class Layout:
    """Sizes of a batch of queues (static).

    Attributes:
        lanes: queues in the batch.
        leaf: places in a block.
        group: blocks in a group; 1 with two levels, keys and block minima.
        groups: groups in a queue.
    """

    lanes: int
    leaf: int
    group: int
    groups: int

    @property
    def blocks(self) -> int:
        """Blocks in a queue."""
        return self.group * self.groups

    @property
    def size(self) -> int:
        """Places in a queue."""
        return self.leaf * self.blocks

    @property
    def levels(self) -> int:
        """2 or 3."""
        return 2 if self.group == 1 else 3


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Queues:
    """The state of a batch of queues."""

    keys: Array  # int32[lanes * size]
    minima: Array  # int32[lanes * blocks] of blocks with three levels, else int32[0]
    column: Array  # int32[groups, lanes], minima of groups (of blocks with two levels)
    key: Array  # int32[lanes], least key; ABSENT where a queue is empty
    group: Array  # int32[lanes], a group that has it


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Least:
    """The first cell of each queue, and the minima that remain without it."""

    key: Array  # int32[lanes]; ABSENT where a queue is empty
    cell: Array  # int32[lanes]; some cell where a queue is empty
    found: Array  # bool[lanes], False where a queue is empty
    block: Array  # int32[lanes], its block
    block_rest: Array  # int32[lanes], least other key of its block
    group_rest: Array  # int32[lanes], least other key of its group


def layout(lanes: int, cells: int, leaf: int = _LEAF, levels: int = 0) -> Layout:
    """Choose the sizes of queues of at least `cells` places.

    Args:
        lanes: queues in the batch.
        cells: places wanted.
        leaf: places in a block.
        levels: 2, 3, or 0 for what measures best at this size.
    """
    blocks = -(-cells // leaf)
    if levels == 2 or (levels == 0 and blocks <= _COLUMN):
        return Layout(lanes, leaf, 1, blocks)
    group = 8
    while group < leaf and group * group < blocks:
        group *= 2
    return Layout(lanes, leaf, group, -(-blocks // group))


def empty(sizes: Layout) -> Queues:
    """Queues that hold nothing."""
    minima = sizes.lanes * sizes.blocks if sizes.levels == 3 else 0
    return Queues(
        keys=jnp.full(sizes.lanes * sizes.size, ABSENT),
        minima=jnp.full(minima, ABSENT),
        column=jnp.full((sizes.groups, sizes.lanes), ABSENT),
        key=jnp.full(sizes.lanes, ABSENT),
        group=jnp.zeros(sizes.lanes, jnp.int32),
    )


def pair(first: Array, second: Array, bits: int) -> Array:
    """One int32 key of two parts, in the order of the first, then of the second.

    Args:
        first: int32[...], 0 or more, below 2**(31 - bits) - 1.
        second: int32[...], 0 or more; from 2**bits - 1 on, all are alike.
        bits: of the second part, static.
    """
    return (first << bits | jnp.minimum(second, (1 << bits) - 1)) ^ LEAST_KEY


def first_of(key: Array, bits: int) -> Array:
    """The first part of a key of `pair`."""
    return (key ^ LEAST_KEY) >> bits


def least(sizes: Layout, queues: Queues, go: Array) -> Least:
    """Look at the first cell of each queue, which stays where it is.

    Args:
        sizes: of the batch.
        queues: the batch.
        go: bool[], True and traced; see `stage`.
    """
    lane = jnp.arange(sizes.lanes, dtype=jnp.int32)
    group_rest = jnp.full(sizes.lanes, ABSENT)
    block = queues.group
    if sizes.levels == 3:
        block, group_rest = _first_and_rest(
            queues.minima, lane * sizes.blocks, queues.group, sizes.group, queues.key, go
        )
    cell, block_rest = _first_and_rest(
        queues.keys, lane * sizes.size, block, sizes.leaf, queues.key, go
    )
    return Least(queues.key, cell, queues.key < ABSENT, block, block_rest, group_rest)


def lower(sizes: Layout, queues: Queues, go: Array, cells: Array, values: Array) -> Queues:
    """Push cells, decrease their keys, or mark cells that are not queued.

    Args:
        sizes: of the batch.
        queues: the batch.
        go: see `stage`.
        cells: int32[n, lanes], distinct within a lane.
        values: int32[n, lanes], the keys from now on: none above that which a queued cell has.
    """
    nothing = Least(*(jnp.zeros(sizes.lanes, jnp.int32),) * 6)
    return replace(sizes, queues, go, nothing, jnp.zeros(sizes.lanes, bool), cells, values)


def replace(
    sizes: Layout,
    queues: Queues,
    go: Array,
    popped: Least,
    take: Array,
    cells: Array,
    values: Array,
) -> Queues:
    """Pop the first cell of some queues, and push or lower others, in one go.

    Args:
        sizes: of the batch.
        queues: the batch.
        go: see `stage`.
        popped: as `least` gave it; no other change in between.
        take: bool[lanes], where to pop.
        cells: int32[n, lanes], distinct within a lane. Where `take`, the popped cell is among
            them, with a value from `ABSENT` on.
        values: int32[n, lanes], for the others as in `lower`; the value that a cell has already
            leaves it as it is.
    """
    lane = jnp.arange(sizes.lanes, dtype=jnp.int32)

    def places() -> tuple[Array, ...]:
        low = jnp.minimum(values, ABSENT)
        block = cells // sizes.leaf
        at, group = lane * sizes.blocks + block, block // sizes.group
        popped_at, popped_group = lane * sizes.blocks + popped.block, popped.block // sizes.group
        return lane * sizes.size + cells, low, at, group, popped_at, popped_group

    index, low, at, group, popped_at, popped_group = stage(go, places)
    keys = queues.keys.at[index].set(values, unique_indices=True, mode=_INSIDE)
    minima, rest = queues.minima, popped.block_rest
    if sizes.levels == 3:
        rest = jnp.minimum(rest, popped.group_rest)
        old = minima.at[popped_at].get(mode=_INSIDE)
        left = jnp.where(take, popped.block_rest, old)
        minima = minima.at[popped_at].set(left, unique_indices=True, mode=_INSIDE)
        minima = minima.at[at].min(low, mode=_INSIDE)
    # Where nothing is popped, row `queues.group` is written as it was.
    row = jnp.where(take, popped_group, queues.group)
    rest = jnp.where(take, rest, queues.key)
    column = queues.column.at[row, lane].set(rest, unique_indices=True, mode=_INSIDE)
    column = column.at[group, lane].min(low, mode=_INSIDE)
    key, first = stage(go, first_row, column)
    return Queues(keys, minima, column, key, first)


def first_row(column: Array) -> tuple[Array, Array]:
    """Least value of each lane and the first row that has it; of int32[rows, lanes]."""
    rows = column.shape[0]
    if rows > _UNROLLED:
        value = jnp.min(column, 0)
        number = jnp.arange(rows, dtype=jnp.int32)[:, None]
        return value, jnp.min(jnp.where(column == value, number, rows - 1), 0)
    found = [(column[i], jnp.full(column.shape[1], i, jnp.int32)) for i in range(rows)]
    while len(found) > 1:
        odd = found[len(found) & ~1 :]
        found = [_lesser(*two) for two in zip(found[::2], found[1::2], strict=False)] + odd
    return found[0]


def _lesser(a: tuple[Array, Array], b: tuple[Array, Array]) -> tuple[Array, Array]:
    second = b[0] < a[0]
    return jnp.where(second, b[0], a[0]), jnp.where(second, b[1], a[1])


def _first_and_rest(
    plane: Array, lane_at: Array, part: Array, width: int, key: Array, go: Array
) -> tuple[Array, Array]:
    """In one part of a plane: the place of a key, and the least of the other keys.

    Args:
        plane: int32[lanes * places].
        lane_at: int32[lanes], where each lane's places begin.
        part: int32[lanes], number of the part.
        width: places in a part.
        key: int32[lanes].
        go: see `stage`.
    """
    offset = jnp.arange(width, dtype=jnp.int32)[:, None]
    index = stage(go, lambda: lane_at + part * width + offset)
    values = plane.at[index].get(mode=_INSIDE)

    def look(values: Array) -> tuple[Array, Array]:
        place = jnp.min(jnp.where(values == key, offset, width - 1), 0)
        rest = jnp.where(offset == place, ABSENT, jnp.minimum(values, ABSENT))
        return part * width + place, jnp.min(rest, 0)

    return stage(go, look, values)
