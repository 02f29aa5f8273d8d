"""Exact shortest paths on many grids at once, by sweeps over whole maps.

Label correcting in Gauss-Seidel order. A forward pass goes over the cells row by row and
relaxes each from its W, NW, N and NE neighbours, a backward pass in the opposite order from E,
SE, S and SW. On maps with scattered obstacles one forward pass finds nearly all lengths and a
few more prove them, with no open list, no branches and contiguous vectors.

**Layout.** Maps side by side in lanes; a plane is stored flat as [slots * lanes], lanes last.
Cell (x, y) lies in slot margin + x * block + y * stride, with stride >= 2 * block + 1, so that
the four neighbours that a pass relaxes from lie at least ``block`` slots back and ``block``
consecutive slots are updated together. With stride > width and prime to ``block`` no two cells
share a slot, and the neighbours of the cells at the map's edge fall into slots that belong to no
cell: they are blocked, and nothing else needs to know of the edge.

**Values** are lengths in `steps.Units`. The top bit marks a blocked cell; so a diagonal step is
closed by or-ing it with the top bits of the two side cells.

**When to stop.** Let C be the goal's length before a pass and h the octile distance to the
goal. If a pass changes no cell with g + h <= C, every such cell is exact, and so are C and all
shortest paths: on a shortest path to such a cell let p be the first cell that is not exact. Its
predecessor q is exact and did not change, and p was relaxed from q either in this pass or, after
q had got its value, in the one before. Cells farther off are left as they are, so that results
depend on nothing but the query.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.search.steps import UNITS, Units
from usvkernels.xla.stage import stage

Out = TypeVar("Out")


@dataclass(frozen=True)
class Sweep:
    """What is compiled into a sweep (static).

    Attributes:
        width, height: of the maps, cells.
        lanes: maps side by side.
        block: slots updated together.
        units: of lengths.
        connectivity: 4 or 8.
        corner_cutting: whether a diagonal step may pass a blocked side cell.
    """

    width: int
    height: int
    lanes: int
    block: int
    units: Units = UNITS
    connectivity: int = 8
    corner_cutting: bool = False

    @property
    def stride(self) -> int:
        """Slots from a cell to the one below it."""
        stride = max(self.width + 1, 2 * self.block + 1)
        while math.gcd(stride, self.block) != 1:
            stride += 1
        return stride

    @property
    def margin(self) -> int:
        """Blocked slots before the first cell, and at least as many after the last."""
        return self.stride + self.block

    @property
    def blocks(self) -> int:
        """Steps of a pass."""
        last = (self.width - 1) * self.block + (self.height - 1) * self.stride
        return last // self.block + 1

    @property
    def size(self) -> int:
        """Elements of a plane."""
        return (self.blocks * self.block + 2 * self.margin) * self.lanes

    @property
    def words(self) -> int:
        """Bytes to a packed map."""
        return -(-self.width * self.height // 8)

    @property
    def most_passes(self) -> int:
        """No search needs more: two passes fix at least one cell for good."""
        return 2 * self.width * self.height + 2


def choose_block(width: int, lanes: int) -> int:
    """Slots to update together so that a step is worth its overhead, not more."""
    return max(1, min(-(-width // 2), STEP_ELEMENTS // lanes))


STEP_ELEMENTS = 512
"""Cells updated together: less does not cover the cost of a step, more wastes slots."""


def first_element(sweep: Sweep, x: Array | int, y: Array | int) -> Array:
    """Where cell (x, y) lies in a plane, int32; add the lane."""
    slot = sweep.margin + jnp.asarray(x) * sweep.block + jnp.asarray(y) * sweep.stride
    return slot.astype(jnp.int32) * sweep.lanes


def at(plane: Array, element: Array) -> Array:
    """Elements of a plane; they exist."""
    return plane.at[element].get(mode="promise_in_bounds")


def cut(plane: Array, start: Array, size: int) -> Array:
    """Consecutive elements of a plane."""
    return lax.dynamic_slice(plane, (start.astype(jnp.uint32),), (size,))


def put(plane: Array, piece: Array, start: Array) -> Array:
    """The plane with consecutive elements replaced."""
    return lax.dynamic_update_slice(plane, piece, (start.astype(jnp.uint32),))


def relax(
    sweep: Sweep, plane: Array, to_goal: Array | None, bound: Array, backward: Array
) -> tuple[Array, Array]:
    """One pass.

    Args:
        sweep: static.
        plane: of lengths.
        to_goal: plane of h; None where all cells matter.
        bound: [lanes] C.
        backward: bool[], the direction.

    Returns:
        The plane, and bool[lanes], whether a cell with g + h <= C changed.
    """
    lanes, block = sweep.lanes, sweep.block
    size, dtype = block * lanes, sweep.units.dtype
    sign = jnp.where(backward, -lanes, lanes)
    first = jnp.where(backward, sweep.margin + (sweep.blocks - 1) * block, sweep.margin) * lanes
    limit = jnp.tile(bound, block)

    def update(plane: Array, seen: Array, start: Array) -> tuple[Array, Array]:
        new = relaxed(sweep, plane, start, sign)
        change = new ^ cut(plane, start, size)
        if to_goal is not None:
            near = new + cut(to_goal, start, size) <= limit
            change = jnp.where(near, change, jnp.zeros((), dtype))
        return new, seen | change

    def step(i: Array, state: tuple[Array, Array]) -> tuple[Array, Array]:
        start = first + i * (block * sign)
        # Staged, or XLA would compute the new values anew, and copy the plane, for each use.
        new, seen = stage(i >= 0, update, *state, start)
        return put(state[0], new, start), seen

    plane, seen = lax.fori_loop(0, sweep.blocks, step, (plane, jnp.zeros(size, dtype)))
    return plane, jnp.any(seen.reshape(block, lanes) != 0, axis=0)


def relaxed(sweep: Sweep, plane: Array, start: Array, sign: Array) -> Array:
    """New values of a block; `sign` is the lanes, negative in a backward pass."""
    block, stride, units = sweep.block, sweep.stride, sweep.units
    size = block * sweep.lanes
    flag = jnp.asarray(units.flag, units.dtype)

    def back(slots: int) -> Array:
        return cut(plane, start - slots * sign, size)

    own, west, north = back(0), back(block), back(stride)
    best = jnp.minimum(west, north) + jnp.asarray(units.straight, units.dtype)
    if sweep.connectivity == 8:
        northwest, northeast = back(stride + block), back(stride - block)
        if not sweep.corner_cutting:
            northwest |= (north | west) & flag
            northeast |= (north | back(-block)) & flag
        diagonal = jnp.minimum(northwest, northeast)
        best = jnp.minimum(best, diagonal + jnp.asarray(units.diagonal, units.dtype))
    # A blocked cell is above all others and its flag keeps it there.
    return jnp.maximum(jnp.minimum(own, best), own & flag)


def fold(sweep: Sweep, piece: Callable[[Array, Array], Array], start: Array) -> Array:
    """Go over a plane block by block: value = piece(first element, value).

    Args:
        sweep: static.
        piece: sees the first element of a block of ``sweep.block * sweep.lanes``.
        start: value to begin with.
    """
    size = sweep.block * sweep.lanes

    def step(i: Array, value: Array) -> Array:
        return piece(sweep.margin * sweep.lanes + i * size, value)

    return lax.fori_loop(0, sweep.blocks, step, start)


def farthest(sweep: Sweep, plane: Array) -> Array:
    """Per lane the greatest length."""
    size, dtype = sweep.block * sweep.lanes, sweep.units.dtype

    def top(start: Array, greatest: Array) -> Array:
        own = cut(plane, start, size)
        known = jnp.where(own < sweep.units.cap, own, jnp.zeros((), dtype))
        return jnp.maximum(greatest, known)

    greatest = fold(sweep, top, jnp.zeros(size, dtype))
    return jnp.max(greatest.reshape(sweep.block, sweep.lanes), axis=0)


def turned(sweep: Sweep, packed: Array, which: Array) -> Array:
    """Packed maps, in some lanes turned by half a circle (the cells in opposite order).

    Args:
        sweep: static.
        packed: uint8[..., words, lanes or 1], `numpy.packbits` of the maps' cells with the low bit
            first.
        which: bool[..., lanes].

    Returns:
        uint8[..., words, lanes].
    """
    back = packed[..., ::-1, :]
    for shift, mask in ((4, 0x0F), (2, 0x33), (1, 0x55)):
        low = jnp.uint8(mask)
        back = ((back >> shift) & low) | ((back & low) << shift)
    spare = 8 * sweep.words - sweep.width * sweep.height  # bits past the end, in front now
    if spare:
        after = jnp.concatenate([back[..., 1:, :], jnp.zeros_like(back[..., :1, :])], axis=-2)
        back = (back >> spare) | (after << (8 - spare))
    return jnp.where(which[..., None, :], back, packed)


def lay_out(sweep: Sweep, packed: Array, mirror_y: Array) -> Array:
    """The plane of lengths with nothing reached yet.

    Args:
        sweep: static.
        packed: uint8[words, lanes], maps.
        mirror_y: bool[lanes], where to take the rows from the last to the first.
    """
    units = sweep.units
    free, flag = jnp.asarray(units.cap, units.dtype), jnp.asarray(units.flag, units.dtype)

    def bit(index: Array) -> Array:
        byte = lax.dynamic_index_in_dim(packed, (index // 8).astype(jnp.uint32), 0, keepdims=False)
        return byte & (jnp.uint8(1) << (index % 8).astype(jnp.uint8))

    def cell(i: Array, plane: Array) -> Array:
        y, x = i // sweep.width, i % sweep.width
        there = (sweep.height - 1 - y) * sweep.width + x
        hit = jnp.where(mirror_y, bit(there), bit(i)) != 0
        return put(plane, jnp.where(hit, flag, free), first_element(sweep, x, y))

    return lax.fori_loop(0, sweep.width * sweep.height, cell, jnp.full(sweep.size, flag))


def lay_out_distances(sweep: Sweep, goal: tuple[Array, Array]) -> Array:
    """The plane of h, the distances to goals (x, y) of int[lanes] each on a free map."""

    def cell(i: Array, plane: Array) -> Array:
        y, x = i // sweep.width, i % sweep.width
        return put(plane, distance(sweep, x, y, goal), first_element(sweep, x, y))

    plane = jnp.zeros(sweep.size, sweep.units.dtype)
    return lax.fori_loop(0, sweep.width * sweep.height, cell, plane)


def distance(sweep: Sweep, x: Array, y: Array, goal: tuple[Array, Array]) -> Array:
    """H of cell (x, y) in all lanes, in the planes' own dtype."""
    units = sweep.units
    x, y = x.astype(units.dtype), y.astype(units.dtype)
    to_x, to_y = goal[0].astype(units.dtype), goal[1].astype(units.dtype)
    dx = jnp.maximum(to_x, x) - jnp.minimum(to_x, x)
    dy = jnp.maximum(to_y, y) - jnp.minimum(to_y, y)
    straight = jnp.asarray(units.straight, units.dtype)
    if sweep.connectivity == 4:
        return (dx + dy) * straight
    rise = jnp.asarray(units.diagonal - units.straight, units.dtype)
    return jnp.maximum(dx, dy) * straight + jnp.minimum(dx, dy) * rise


def each_group(solve_group: Callable[[Array], Out], capacity: int, groups: Array) -> Out:
    """Stack what comes of groups 0 .. groups - 1; the rows up to `capacity` are zero."""
    row = jax.eval_shape(solve_group, jnp.int32(0))
    table = jax.tree.map(lambda a: jnp.zeros((capacity, *a.shape), a.dtype), row)

    def one(i: Array, table: Out) -> Out:
        return jax.tree.map(
            lambda all_rows, new: lax.dynamic_update_index_in_dim(all_rows, new, i, 0),
            table,
            solve_group(i),
        )

    return lax.fori_loop(0, groups, one, table)
