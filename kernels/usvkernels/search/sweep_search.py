"""Queries from start to goal by sweeps over whole maps (see `sweep`)."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.search.steps import moves
from usvkernels.search.sweep import (
    Sweep,
    at,
    cut,
    distance,
    each_group,
    farthest,
    first_element,
    fold,
    lay_out,
    lay_out_distances,
    put,
    relax,
    turned,
)
from usvkernels.status import Status
from usvkernels.xla.single import single
from usvkernels.xla.stage import stage


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class SweepQueries:
    """Groups of queries; G groups of as many as `Sweep.lanes`.

    Attributes:
        packed: uint8[G or 1, words, lanes or 1], `numpy.packbits` of the maps' cells, low bit
            first; ones for shared maps.
        start, goal: int32[G, lanes, 2], free cells (x, y).
        live: bool[G, lanes], False for lanes without a query.
    """

    packed: Array
    start: Array
    goal: Array
    live: Array


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Routes:
    """What came of the queries; leaves [G, lanes, ...].

    Attributes:
        status: int32, FOUND, UNREACHABLE, OUT_OF_BUDGET (longer than the units can tell), or
            RUNNING (left over, or no query).
        length: uint32, in units.
        passes: int32, passes until the length was proven.
        expanded: int32, cells with g + h < C, and those on the path with g + h = C.
        path: int32[..., cells, 2], (x, y) from start to goal, then the goal again; cut short at
            the goal's end where the path has more cells.
    """

    status: Array
    length: Array
    passes: Array
    expanded: Array
    path: Array


def solve(sweep: Sweep, cells: int, queries: SweepQueries, groups: Array, leave: Array) -> Routes:
    """Find shortest paths.

    The result of a query does not depend on its lane, its group or on `leave`, unless it is
    left over.

    Args:
        sweep: static.
        cells: of a path, static.
        queries: G groups.
        groups: int32[], how many of them to solve; the rows of the others are zero.
        leave: int32[], when no more than this many lanes of a group are not done, the group
            stops, and their status is RUNNING.

    Returns:
        The routes.
    """
    # Mirrored so that the goal lies ahead of a forward pass: half the passes.
    flip = queries.start > queries.goal
    rows = (*(a.mT for a in (queries.start, queries.goal, flip)), queries.live)

    def group(i: Array) -> Routes:
        packed = queries.packed[jnp.minimum(i, queries.packed.shape[0] - 1)]
        start, goal, flips, live = (lax.dynamic_index_in_dim(a, i, 0, False) for a in rows)
        packed = turned(sweep, packed, flips[0])
        search = partial(_solve_group, sweep, cells)
        return single(search, packed, start, goal, flips, live, leave)

    return each_group(group, queries.live.shape[0], groups)


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Search:
    plane: Array
    passes: Array  # int32[]
    done_after: Array  # int32[lanes], 0 while not done


def _solve_group(
    sweep: Sweep,
    cells: int,
    packed: Array,
    start: Array,
    goal: Array,
    flip: Array,
    live: Array,
    leave: Array,
) -> Routes:
    start, goal = _mirrored(sweep, start, flip), _mirrored(sweep, goal, flip)
    lane = jnp.arange(sweep.lanes, dtype=jnp.int32)
    source = first_element(sweep, start[0], start[1]) + lane
    target = first_element(sweep, goal[0], goal[1]) + lane
    to_goal = lay_out_distances(sweep, (goal[0], goal[1]))

    def unfinished(search: _Search) -> Array:
        left = jnp.sum(live & (search.done_after == 0), dtype=jnp.int32)
        return (left > leave) & (search.passes < sweep.most_passes)

    def run_pass(search: _Search) -> _Search:
        bound, passes = _limit(sweep, at(search.plane, target)), search.passes + 1
        plane, moved = relax(sweep, search.plane, to_goal, bound, passes % 2 == 0)
        now = (search.done_after == 0) & ~moved & (passes > 1)
        return _Search(plane, passes, jnp.where(now, passes, search.done_after))

    plane = _rooted(sweep, lay_out(sweep, packed, flip[0] ^ flip[1]), source)
    none = jnp.zeros(sweep.lanes, jnp.int32)
    search = lax.while_loop(unfinished, run_pass, _Search(plane, jnp.int32(0), none))
    plane, done = search.plane, live & (search.done_after > 0)
    length = at(plane, target)
    found = done & (length < sweep.units.cap)
    expanded = _inside(sweep, plane, to_goal, length)
    path, on_bound = _trace(sweep, cells, plane, found, start, goal, flip, length)
    return Routes(
        status=_status(sweep, done, found, farthest(sweep, plane).astype(jnp.uint32)),
        length=length.astype(jnp.uint32),
        passes=search.done_after,
        expanded=jnp.where(found, expanded + on_bound, expanded),
        path=path,
    )


def _rooted(sweep: Sweep, plane: Array, source: Array) -> Array:
    """The plane with zeros at elements int32[n]; a loop, for a `single` cannot scatter."""
    zero = jnp.zeros(1, sweep.units.dtype)
    return lax.fori_loop(0, source.shape[0], lambda i, plane: put(plane, zero, source[i]), plane)


def _mirrored(sweep: Sweep, cell: Array, flip: Array) -> Array:
    """Cells int32[2, lanes] in the mirrored maps, and back."""
    x = jnp.where(flip[0], sweep.width - 1 - cell[0], cell[0])
    y = jnp.where(flip[1], sweep.height - 1 - cell[1], cell[1])
    return jnp.stack([x, y])


def _limit(sweep: Sweep, length: Array) -> Array:
    """C; without one yet, all cells matter, or a goal might seem to be unreachable."""
    units = sweep.units
    return jnp.where(length < units.cap, length, jnp.asarray((1 << units.bits) - 1, units.dtype))


def _status(sweep: Sweep, done: Array, found: Array, top: Array) -> Array:
    """Not reached is unreachable only where no length came near the greatest that there is."""
    near_cap = top + sweep.units.diagonal >= sweep.units.cap
    missed = jnp.where(near_cap, Status.OUT_OF_BUDGET, Status.UNREACHABLE)
    status = jnp.where(found, Status.FOUND, jnp.where(done, missed, Status.RUNNING))
    return status.astype(jnp.int32)


def _inside(sweep: Sweep, plane: Array, to_goal: Array, length: Array) -> Array:
    """Per lane the number of cells with g + h < C."""
    size, dtype = sweep.block * sweep.lanes, sweep.units.dtype
    limit = jnp.tile(_limit(sweep, length), sweep.block)

    def add(start: Array, count: Array) -> Array:
        own = cut(plane, start, size)
        inside = (own < sweep.units.cap) & (own + cut(to_goal, start, size) < limit)
        return count + inside.astype(dtype)

    count = fold(sweep, add, jnp.zeros(size, dtype)).reshape(sweep.block, sweep.lanes)
    return jnp.sum(count, axis=0, dtype=jnp.int32)


def _trace(
    sweep: Sweep,
    cells: int,
    plane: Array,
    found: Array,
    start: Array,
    goal: Array,
    flip: Array,
    length: Array,
) -> tuple[Array, Array]:
    """Walk back from the goal over cells that explain their successor's length.

    Of several predecessors the walk takes the first whose step is first in `steps.moves`,
    as seen in a map mirrored so that the goal is to the east and south of the start.

    Returns:
        int32[lanes, cells, 2], and per lane the number of path cells with g + h = C.
    """
    lane = jnp.arange(sweep.lanes, dtype=jnp.int32)
    end = goal[0], goal[1]
    source = _pair(start[0], start[1])

    def bound_met(cell: Array, here: Array) -> Array:
        ahead = distance(sweep, *_apart(cell), end)
        return (found & (here + ahead == length)).astype(jnp.int32)

    def walking(state: tuple[Array, ...]) -> Array:
        i, cell = state[0], state[1]
        return (i < cells) & jnp.any(found & (cell != source))

    def walk(state: tuple[Array, ...]) -> tuple[Array, ...]:
        i, cell, hops, count, trail = state
        going = found & (cell != source)
        step = stage(i > 0, partial(_last_step, sweep), plane, cell, lane)
        cell = jnp.where(going, cell - step, cell)
        here = at(plane, first_element(sweep, *_apart(cell)) + lane)
        count += jnp.where(going, bound_met(cell, here), 0)
        trail = lax.dynamic_update_index_in_dim(trail, cell, i, 0)
        return i + 1, cell, hops + going, count, trail

    cell = _pair(goal[0], goal[1])
    trail = jnp.zeros((cells, sweep.lanes), jnp.int32)
    trail = lax.dynamic_update_index_in_dim(trail, cell, 0, 0)
    none = jnp.zeros(sweep.lanes, jnp.int32)
    state: tuple[Array, ...] = (jnp.int32(1), cell, none, bound_met(cell, length), trail)
    _, _, hops, count, trail = lax.while_loop(walking, walk, state)
    # Row k of a path is row hops - k of the trail, and the goal from there on.
    row = jnp.maximum(hops[:, None] - jnp.arange(cells, dtype=jnp.int32), 0)
    x, y = _apart(at(trail.reshape(-1), row * sweep.lanes + lane[:, None]))
    x = jnp.where(flip[0][:, None], sweep.width - 1 - x, x)
    y = jnp.where(flip[1][:, None], sweep.height - 1 - y, y)
    return jnp.stack([x, y], axis=-1), count


def _pair(x: Array | int, y: Array | int) -> Array:
    """(x, y) in one int32; pairs add and subtract as cells and steps do."""
    return jnp.asarray(x + (y << 16), jnp.int32)


def _apart(pair: Array) -> tuple[Array, Array]:
    """(x, y) of a cell's pair."""
    return pair & 0xFFFF, pair >> 16


def _last_step(sweep: Sweep, plane: Array, cell: Array, lane: Array) -> Array:
    """The step into cells of a shortest path; pairs of int32[lanes]."""
    units = sweep.units
    flag = jnp.asarray(units.flag, units.dtype)
    here = first_element(sweep, *_apart(cell)) + lane
    goes = at(plane, here)

    def neighbour(dx: int, dy: int) -> Array:
        slots = dx * sweep.block + dy * sweep.stride
        return at(plane, here + slots * sweep.lanes)

    step = jnp.zeros_like(cell)
    for dx, dy, cost in reversed(moves(sweep.connectivity, units)):
        came = neighbour(-dx, -dy) + jnp.asarray(cost, units.dtype)
        if dx and dy and not sweep.corner_cutting:
            came |= (neighbour(-dx, 0) | neighbour(0, -dy)) & flag
        step = jnp.where(came == goes, jnp.int32(dx + dy * 65536), step)
    return step
