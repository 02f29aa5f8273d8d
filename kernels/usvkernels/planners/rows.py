"""Paths that run from start to goal row by row: what the genes and the particles encode.

Rows lie across one axis of the map, that on which start and goal are farther apart: row 0 through
the start, row n through the goal. A path enters a row in one column, runs along the row, and
leaves it for the next in its exit column; so the exits of rows 0 .. n - 1 are the path, and its
runs are the cells inserted between them. Where the last cell of a run and the step to the next row
can be made as one diagonal step without cutting a corner, they are. Such a path never turns back
towards the start's row; what lies behind a wall that needs that is not found.

`thread` turns any wished-for columns into a path over free cells: in each row the exit is the one
nearest to the wish among those that a run can get to and from which the goal can be reached. It is
both the repair of Yu et al. 2022's genetic algorithm and the way in which a line through way
points is followed around blocked cells. It fails only where there is no path in rows.
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array, lax
from jax.typing import DTypeLike

_BITS = 15  # of a column
_MASK = (1 << _BITS) - 1
MOST_SIDE = _MASK - 2


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class RowQueries:
    """What is asked, Q rows.

    Attributes:
        blocked: bool[Q, H, W].
        start: int32[Q, 2], cells (x, y).
        goal: int32[Q, 2], another cell.
        across: bool[Q], rows of the path are columns of the map.
        seed: uint32[2, Q].
    """

    blocked: Array
    start: Array
    goal: Array
    across: Array
    seed: Array


@dataclass(frozen=True)
class Frame:
    """Queries in rows, and what is looked up in them; L = Q * members lanes.

    Attributes:
        span: int32[Q * R * S], of cell (row, column): the first and the last column of the free
            run that holds it, and whether it is free.
        exit: int32[Q * R * S], the nearest exit columns at or before and at or after a cell, of
            those from which the goal can be reached.
        base: int32[L], where a lane's tables begin.
        rows: int32[L], n, the goal's row.
        first: int32[L], the start's column.
        last: int32[L], the goal's.
        width: int32[L], columns.
        seed: uint32[2, L].
        side: S, columns of the tables.
    """

    span: Array
    exit: Array
    base: Array
    rows: Array
    first: Array
    last: Array
    width: Array
    seed: Array
    side: int


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Measured:
    """Paths of exits int32[R, L].

    Attributes:
        straight: int32[L], straight steps.
        diagonal: int32[L], diagonal ones.
        turns: int32[4, L], turns by 45, 90, 135 and 180 degrees.
        joins: bool[R, L], whether the step from each row to the next is diagonal.
    """

    straight: Array
    diagonal: Array
    turns: Array
    joins: Array


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class RowPlans:
    """The best path of each query.

    Attributes:
        exits: int32[R, Q]; undefined where there is no path.
        joins: bool[R, Q].
        length: float[Q], cells; inf where there is no path.
        history: float[iterations, Q].
    """

    exits: Array
    joins: Array
    length: Array
    history: Array


def frame(queries: RowQueries, rows: int, members: int) -> Frame:
    """Lay out the queries in rows.

    Args:
        queries: checked.
        rows: R, static; more than the rows between start and goal.
        members: of a population, static; lane q * members + i is member i of query q.
    """
    height, width = queries.blocked.shape[1:]
    side = max(height, width)

    def of_query(blocked: Array, start: Array, goal: Array, across: Array) -> tuple[Array, ...]:
        swap = across.astype(jnp.int32)
        begin, end = start[1 - swap], goal[1 - swap]
        row = begin + jnp.sign(end - begin) * jnp.arange(rows + 1, dtype=jnp.int32)[:, None]
        column = jnp.arange(side, dtype=jnp.int32)
        y, x = jnp.where(across, column, row), jnp.where(across, row, column)
        inside = (y >= 0) & (y < height) & (x >= 0) & (x < width)
        free = inside & ~blocked[jnp.clip(y, 0, height - 1), jnp.clip(x, 0, width - 1)]
        lateral = (start[swap], goal[swap], jnp.where(across, height, width))
        n = jnp.abs(end - begin)
        return (*_tables(free, n, goal[swap]), n, *lateral)

    span, leave, *lateral = jax.vmap(of_query)(
        queries.blocked, queries.start, queries.goal, queries.across
    )
    count, per_map = len(queries.blocked), rows * side
    per_query = (jnp.arange(count, dtype=jnp.int32) * per_map, *lateral)
    base, n, first, last, columns = (jnp.repeat(a, members) for a in per_query)
    seed = jnp.repeat(queries.seed, members, axis=1)
    flat = (span.reshape(-1), leave.reshape(-1))
    return Frame(*flat, base, n, first, last, columns, seed, side)


def _tables(free: Array, n: Array, last: Array) -> tuple[Array, Array]:
    """`Frame.span` and `Frame.exit` of cells bool[R + 1, S], without the last row."""
    side = free.shape[1]
    column = jnp.arange(side, dtype=jnp.int32)
    here = free[:-1]
    begin = lax.cummax(jnp.where(here, 0, column + 1), axis=1)
    end = lax.cummin(jnp.where(here, side - 1, column - 1), axis=1, reverse=True)

    def up(useful: Array, row: tuple[Array, ...]) -> tuple[Array, Array]:
        """From the row after, cells from which the goal can be reached, to this one."""
        index, here, begin, end = row
        through = here & useful & (index < n)
        before = lax.cummax(jnp.where(through, column + 1, 0))
        after = lax.cummin(jnp.where(through, column + 1, side + 1), reverse=True)
        goes = (before > begin) | (after <= end + 1)
        arrives = (index == n) & (begin <= last) & (last <= end)
        return here & (goes | arrives), before | after << _BITS

    index = jnp.arange(len(here), dtype=jnp.int32)
    _, leave = lax.scan(up, free[-1], (index, here, begin, end), reverse=True)
    # In a blocked cell the run ends before it begins, at -1 at the least.
    span = begin | (end + 1) << _BITS | here.astype(jnp.int32) << 2 * _BITS
    return span, leave


def thread(place: Frame, wish: Array) -> tuple[Array, Array]:
    """The path that follows wished-for columns as well as a path over free cells can.

    A path's own exits give that path.

    Args:
        place: of the queries.
        wish: int32[R, L], column in which to leave each row.

    Returns:
        int32[R, L] exits (0 from the goal's row on), and bool[L] whether it is a path.
    """

    def leave(row: Array, carry: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        exits, column, alive = carry
        wanted = lax.dynamic_index_in_dim(wish, row, keepdims=False)
        at = place.base + row * place.side
        begin, end = _span(place, at + column)
        wanted = jnp.clip(wanted, begin, end)
        packed = place.exit.at[at + wanted].get(mode="promise_in_bounds")
        before, after = (packed & _MASK) - 1, (packed >> _BITS) - 1
        left, right = before >= begin, after <= end
        nearer = jnp.where(left & (~right | (wanted - before <= after - wanted)), before, after)
        going = row < place.rows
        alive = alive & (~going | left | right)
        column = jnp.where(going & alive, nearer, column)
        exits = lax.dynamic_update_index_in_dim(exits, jnp.where(going, column, 0), row, axis=0)
        return exits, column, alive

    begun = (jnp.zeros_like(wish), place.first, jnp.ones(wish.shape[1], bool))
    exits, column, alive = lax.fori_loop(0, jnp.max(place.rows), leave, begun)
    begin, end = _span(place, place.base + place.rows * place.side + column)
    return exits, alive & (begin <= place.last) & (place.last <= end)


def _span(place: Frame, cell: Array) -> tuple[Array, Array]:
    """First and last column of the free runs that hold the cells."""
    packed = place.span.at[cell].get(mode="promise_in_bounds")
    return packed & _MASK, ((packed >> _BITS) & _MASK) - 1


def entries(place: Frame, exits: Array) -> Array:
    """Columns int32[R, L] in which paths enter their rows."""
    return jnp.concatenate([place.first[None], exits[:-1]])


def measure(place: Frame, exits: Array) -> Measured:
    """Count the steps and the turns of paths int32[R, L], of which each is one of `thread`."""
    row = jnp.arange(exits.shape[0], dtype=jnp.int32)[:, None]
    enters = entries(place, exits)
    going = row < place.rows
    leaves = jnp.where(going, exits, jnp.where(row == place.rows, place.last, enters))
    side = jnp.sign(leaves - enters)
    run = jnp.abs(leaves - enters)
    corner = place.base + (row + 1) * place.side + leaves - side
    corner = jnp.where(going, corner, place.base)
    free = place.span.at[corner].get(mode="promise_in_bounds") >> 2 * _BITS
    joins = going & (run > 0) & (free == 1)
    run = run - joins
    # Courses in units of 45 degrees from straight on to the next row.
    on = jnp.where(joins, side, 0)
    begins = jnp.where(run > 0, 2 * side, on)
    before = jnp.concatenate([begins[:1], on[:-1]])
    into = jnp.where(going | (run > 0), jnp.abs(begins - before), 0)
    out_of = jnp.where(going, jnp.abs(on - begins), 0)
    turns = [jnp.sum((into == k).astype(jnp.int32) + (out_of == k), axis=0) for k in range(1, 5)]
    return Measured(
        straight=jnp.sum(run + (going & ~joins), axis=0, dtype=jnp.int32),
        diagonal=jnp.sum(joins, axis=0, dtype=jnp.int32),
        turns=jnp.stack(turns),
        joins=joins,
    )


def length_of(measured: Measured, alive: Array, dtype: DTypeLike) -> Array:
    """Lengths in cells float[L], inf of what is no path."""
    cells = measured.straight.astype(dtype) + measured.diagonal.astype(dtype) * 2**0.5
    return jnp.where(alive, cells, jnp.inf).astype(dtype)
