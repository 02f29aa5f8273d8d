"""Shorter and plainer paths over a grid: exact line of sight, key points, points at a spacing.

Line of sight between the centres of two cells is decided in whole numbers. The walk visits
the supercover: every cell that the segment touches. Cells are closed squares, so a segment
through a corner of the lattice touches all four cells there; with `corner_cutting` it touches
only the two that it passes through. This is the rule for a diagonal step of the searches.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.paths.charts import Charts

WALK = 8
"""Columns of a segment that are walked between two decisions."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Walk:
    """A segment under inspection, one per lane; int32[lanes] unless said otherwise.

    With m = |major| and n = |minor| extent of the segment, m >= n, the walk leaves column i at
    the height n (2 i + 1) / (2 m) over the first centre. `height` is m times twice that height
    over the upper edge of the cell: above 0 the segment enters the next row within the column,
    at 0 it leaves through the corner.
    """

    cell: Array  # flat index of the cell where the segment enters the column
    height: Array
    left: Array  # columns still to leave
    rise: Array  # 2 n
    run: Array  # 2 m
    step_major: Array  # flat index of the next column minus this
    step_minor: Array  # of the next row


def _begin(start: Array, end: Array, charts: Charts) -> _Walk:
    """Walk from the centre of `start` int32[lanes, 2] to that of `end`."""
    width = charts.width
    span = end - start
    size = jnp.abs(span)
    across = size[:, 0] < size[:, 1]  # the longer extent is along y
    east, north = span[:, 0] >= 0, span[:, 1] >= 0
    step_x, step_y = jnp.where(east, 1, -1), jnp.where(north, width, -width)
    long, short = jnp.max(size, axis=-1), jnp.min(size, axis=-1)
    return _Walk(
        cell=charts.first + start[:, 1] * width + start[:, 0],
        height=short - long,
        left=long,
        rise=2 * short,
        run=2 * long,
        step_major=jnp.where(across, step_y, step_x),
        step_minor=jnp.where(across, step_x, step_y),
    )


def _advance(blocked: Array, walk: _Walk, corner_cutting: bool) -> tuple[_Walk, Array]:
    """Walk WALK columns on; also bool[lanes], whether a blocked cell was touched."""
    cell, height, left = walk.cell, walk.height, walk.left
    touched = jnp.zeros(cell.shape, bool)

    def at(place: Array) -> Array:
        return blocked.at[place].get(mode="promise_in_bounds")

    for _ in range(WALK):
        under_way = left > 0
        rises = under_way & ((height > 0) if corner_cutting else (height >= 0))
        hit = at(cell) | at(jnp.where(rises, cell + walk.step_minor, cell))
        if not corner_cutting:
            hit |= at(jnp.where(under_way & (height == 0), cell + walk.step_major, cell))
        touched |= under_way & hit
        up = height >= 0
        step = walk.step_major + jnp.where(up, walk.step_minor, 0)
        cell = jnp.where(under_way, cell + step, cell)
        height = height + walk.rise - jnp.where(up, walk.run, 0)
        left = left - 1
    return replace(walk, cell=cell, height=height, left=left), touched


def line_of_sight(
    charts: Charts, starts: Array, ends: Array, *, corner_cutting: bool = False
) -> Array:
    """Whether the segments between the centres of cells touch no blocked cell.

    Args:
        charts: each segment's map.
        starts, ends: int32[n, 2], cells (x, y) of the map; ends count as touched.
        corner_cutting: through a corner of the lattice, do not count the two cells beside it.

    Returns:
        bool[n].
    """
    touched = charts.at(starts[:, 0], starts[:, 1]) | charts.at(ends[:, 0], ends[:, 1])

    def unfinished(carry: tuple[_Walk, Array]) -> Array:
        walk, touched = carry
        return jnp.any((walk.left > 0) & ~touched)

    def on(carry: tuple[_Walk, Array]) -> tuple[_Walk, Array]:
        walk, touched = carry
        walk, hit = _advance(charts.cells, walk, corner_cutting)
        return walk, touched | hit

    _, touched = jax.lax.while_loop(unfinished, on, (_begin(starts, ends, charts), touched))
    return ~touched


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Pruning:
    """Paths being thinned, one per lane."""

    index: Array  # int32[lanes, P], kept points up to `write`, then the pass's own list
    count: Array  # int32[lanes], points in the list of this pass
    write: Array  # int32[lanes], points kept in this pass
    read: Array  # int32[lanes], place in the list of the point on trial
    live: Array  # bool[lanes]
    walk: _Walk  # from the last point kept to the one after that on trial


def prune(
    charts: Charts,
    cells: Array,
    counts: Array,
    *,
    repeat: bool,
    corner_cutting: bool = False,
) -> tuple[Array, Array]:
    """Drop every point of a path that lies between two points in sight of one another.

    One pass goes along the path and drops a point when the last point kept sees the one after
    it: exactly Yu et al. 2022, section 4.2.2, steps 1 to 5. Repeated until no point can go, it
    is Wei & Zhang 2023, Fig. 4: no point is left whose neighbours see each other.

    Args:
        charts: each path's map.
        cells: int32[B, P, 2], paths whose consecutive points see each other.
        counts: int32[B], points of each path, at most P.
        repeat: pass after pass, until one drops nothing (at most P).
        corner_cutting: as `line_of_sight`.

    Returns:
        int32[B, P], the places of the points kept, the last repeated; int32[B], their number.
    """
    rows, capacity = cells.shape[:2]
    lane = jnp.arange(rows)

    def next_walk(index: Array, write: Array, read: Array) -> _Walk:
        first = index[lane, write - 1]
        last = index[lane, jnp.minimum(read + 1, capacity - 1)]
        return _begin(cells[lane, first], cells[lane, last], charts)

    def on(state: _Pruning) -> _Pruning:
        walk, hit = _advance(charts.cells, state.walk, corner_cutting)
        decided = state.live & (hit | (walk.left <= 0))
        keeps = decided & hit
        place = jnp.where(keeps, state.write, capacity)
        index = state.index.at[lane, place].set(state.index[lane, state.read], mode="drop")
        write = state.write + keeps
        read = state.read + decided
        ended = decided & (read == state.count - 1)
        place = jnp.where(ended, write, capacity)
        index = index.at[lane, place].set(state.index[lane, state.count - 1], mode="drop")
        again = ended & (write + 1 < state.count) & (write + 1 > 2) & repeat
        count = jnp.where(ended, write + 1, state.count)
        write, read = jnp.where(ended, 1, write), jnp.where(ended, 1, read)
        fresh = next_walk(index, write, read)
        walk = jax.tree.map(lambda old, new: jnp.where(decided, new, old), walk, fresh)
        live = state.live & (~ended | again)
        return _Pruning(index=index, count=count, write=write, read=read, live=live, walk=walk)

    index = jnp.broadcast_to(jnp.arange(capacity, dtype=jnp.int32), (rows, capacity))
    one = jnp.ones(rows, jnp.int32)
    # Each decision moves on by one point and each pass but the last drops one: the loop ends.
    final = jax.lax.while_loop(
        lambda state: jnp.any(state.live),
        on,
        _Pruning(
            index=index,
            count=counts,
            write=one,
            read=one,
            live=counts > 2,
            walk=next_walk(index, one, one),
        ),
    )
    slot = jnp.arange(capacity, dtype=jnp.int32)
    last = jnp.maximum(final.count - 1, 0)[:, None]
    return jnp.take_along_axis(final.index, jnp.minimum(slot, last), axis=1), final.count


def redensify(
    points: Array, counts: Array, unit: Array | float, capacity: int
) -> tuple[Array, Array]:
    """Points along paths: every key point, and from each on one every `unit` of length.

    Args:
        points: float[B, P, 2].
        counts: int32[B], points of each path, at most P.
        unit: spacing, in the unit of `points`.
        capacity: most points of a result, static; further ones are cut off.

    Returns:
        float[B, capacity, 2], the last point repeated; int32[B], points of each.
    """
    slot = jnp.arange(points.shape[1], dtype=jnp.int32)
    step = points[:, 1:] - points[:, :-1]
    length = jnp.where(slot[:-1] < counts[:, None] - 1, jnp.linalg.norm(step, axis=-1), 0.0)
    # A segment of a whole number of units must not gain a point through rounding.
    pieces = jnp.ceil(length / unit - 1e-4).astype(jnp.int32)
    pieces = jnp.where(length > 0.0, jnp.maximum(pieces, 1), 0)
    before = jnp.concatenate(
        [jnp.zeros_like(counts)[:, None], jnp.cumsum(pieces, axis=1, dtype=jnp.int32)], axis=1
    )
    total = before[:, -1]
    place = jnp.arange(capacity, dtype=jnp.int32)

    def fill(before: Array, points: Array, step: Array, length: Array, count: Array) -> Array:
        piece = jnp.searchsorted(before, place, side="right") - 1
        piece = jnp.minimum(piece, step.shape[0] - 1)
        along = (place - before[piece]) * unit / jnp.where(length > 0.0, length, 1.0)[piece]
        inside = points[piece] + along[:, None] * step[piece]
        end = points[jnp.maximum(count - 1, 0)]
        return jnp.where((place < before[-1])[:, None], inside, end)

    dense = jax.vmap(fill)(before, points, step, length, counts)
    return dense, jnp.where(counts > 0, jnp.minimum(total + 1, capacity), 0)
