"""A*: best-first search on grids, many queries side by side in lanes.

One plane of keys serves as open list, closed list and map (see `pqueue`): below `ABSENT` a cell
is open, at `ABSENT` it was never seen, above it is closed (and keeps its key, for reopening),
and `BLOCKED` is what the map blocks. A key holds f and, for ties, h; g follows as f - h.

Of open cells the one with the least f is expanded, then that with the least h (in steps of
2**tie_shift / STRAIGHT cells, 0.4 to 1.8 of them on maps of 25 to 500 cells a side), then that
which comes first row by row (and with the least heading). A parent is replaced by a strictly
better one only. So results are the same in any lanes.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from usvkernels.search import pqueue
from usvkernels.search.astar_costs import (
    DIAGONAL,
    DIRECTIONS,
    STRAIGHT,
    AstarStatic,
    estimate,
    turn,
)
from usvkernels.search.pqueue import ABSENT, LEAST_KEY, Layout, Least, Queues
from usvkernels.status import Status
from usvkernels.xla.stage import stage

BLOCKED = np.int32(2**31 - 1)

NO_HEADING = 64
"""How a state was entered: the start, from nowhere."""

_INSIDE = "promise_in_bounds"


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class AstarQueries:
    """What to search; the operands of a compiled search."""

    maps: Array  # bool[1 or B, size] of `walled`
    starts: Array  # int32[B, 2], x and y
    goals: Array  # int32[B, 2], x and y
    table: Array  # int32[(H + 2) * (W + 2)] of `distance_table`, or int32[1]
    turn_cost: Array  # int32[], for 45 degrees, in 1/STRAIGHT cells
    budget: Array  # int32[], most expansions of a query
    count: Array  # int32[], queries; rows from there on are padding
    go: Array  # bool[], True; see `stage`


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Lanes:
    """The searches under way."""

    queues: Queues
    job: Array  # int32[lanes], the query in each lane
    status: Array  # int32[lanes], `Status`, RUNNING while a lane searches
    expanded: Array  # int32[lanes]
    end: Array  # int32[lanes], the state expanded last
    lowest: Array  # int32[lanes], least place expanded
    highest: Array  # int32[lanes], greatest place expanded
    cut: Array  # bool[lanes], whether a path was dropped for its length
    goal_x: Array  # int32[lanes]
    goal_y: Array  # int32[lanes]
    base: Array  # int32[lanes], what keys leave out of f


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class _Node:
    """The state that each lane expands."""

    live: Array  # bool[lanes], False where the lane has ended
    some: Array  # bool[lanes], whether there is a state to expand
    state: Array  # int32[lanes]
    x: Array  # int32[lanes], from the goal
    y: Array  # int32[lanes], from the goal
    around: Array  # int32[moves + 1, lanes], states a move away, then its own


def first_key(static: AstarStatic, h: Array, base: Array) -> Array:
    """Key of a start whose heuristic is h, int32[lanes]."""
    return pqueue.pair(h - base, h >> static.tie_shift, static.tie_bits)


def base_of(static: AstarStatic, h: Array) -> Array:
    """What keys leave out of f: that of the start, where f never falls below it."""
    return h if static.consistent else jnp.zeros_like(h)


def expand(
    static: AstarStatic, sizes: Layout, queries: AstarQueries, lanes: Lanes, steps: Array
) -> tuple[Lanes, Array]:
    """Expand one cell in every lane that searches.

    Args:
        static: what is searched for.
        sizes: of the lanes' queues.
        queries: all queries.
        lanes: the searches under way.
        steps: uint8[B * size], how each state was entered: direction, 8 times the turn.

    Returns:
        The lanes, and the steps with those entered now.
    """
    go, queues = queries.go, lanes.queues
    least = pqueue.least(sizes, queues, go)
    node = stage(go, lambda: _node(static, lanes, least))
    lane = jnp.arange(sizes.lanes, dtype=jnp.int32)
    index = stage(go, lambda: lane * sizes.size + node.around)
    seen = queues.keys.at[index].get(mode=_INSIDE)
    g, heading = _entered(static, sizes, queries, lanes, steps, node, least)
    values, better, turned, cut = stage(
        go, lambda: _offered(static, queries, lanes, node, seen, least.key, g, heading)
    )
    steps = _noted(static, sizes, go, lanes, steps, node, better, turned)
    queues = pqueue.replace(sizes, queues, go, least, node.some, node.around, values)

    def progress() -> tuple[Array, ...]:
        status, expanded = _status(static, queries, lanes, node)
        at = node.state // static.headings
        lowest = jnp.where(node.some, jnp.minimum(lanes.lowest, at), lanes.lowest)
        highest = jnp.where(node.some, jnp.maximum(lanes.highest, at), lanes.highest)
        end = jnp.where(node.some, node.state, lanes.end)
        return status, expanded, end, lowest, highest, lanes.cut | cut

    status, expanded, end, lowest, highest, was_cut = stage(go, progress)
    lanes = replace(
        lanes,
        queues=queues,
        status=status,
        expanded=expanded,
        end=end,
        lowest=lowest,
        highest=highest,
        cut=was_cut,
    )
    return lanes, steps


def _node(static: AstarStatic, lanes: Lanes, least: Least) -> _Node:
    live = lanes.status == Status.RUNNING
    some = live & least.found
    # A lane without one looks at a corner of the map and writes back what it read.
    state = jnp.where(some, least.cell, (static.stride + 1) * static.headings)
    at = state // static.headings
    row = at // static.stride
    moves = jnp.array(static.moves, jnp.int32)
    offset = jnp.array([DIRECTIONS[i][1] * static.stride + DIRECTIONS[i][0] for i in static.moves])
    next_to = (at + offset.astype(jnp.int32)[:, None]) * static.headings
    if static.headings > 1:
        next_to = next_to + moves[:, None]
    return _Node(
        live=live,
        some=some,
        state=state,
        x=at - row * static.stride - 1 - lanes.goal_x,
        y=row - 1 - lanes.goal_y,
        around=jnp.concatenate([next_to, state[None]]),
    )


def _entered(
    static: AstarStatic,
    sizes: Layout,
    queries: AstarQueries,
    lanes: Lanes,
    steps: Array,
    node: _Node,
    least: Least,
) -> tuple[Array, Array]:
    """Length to each lane's node, and the direction in which it was entered (or NO_HEADING)."""
    step = jnp.zeros_like(node.state)
    if static.turning:
        at = lanes.job * sizes.size + node.state
        inside = jnp.where(node.some, at, 0)
        step = steps.at[inside].get(mode=_INSIDE).astype(jnp.int32)

    def look() -> tuple[Array, Array]:
        h = estimate(static, queries.table, node.x, node.y)
        g = pqueue.first_of(least.key, static.tie_bits) + lanes.base - h
        if static.turn_mode == "parent":
            g = g - (step >> 3 & 7) * queries.turn_cost
        if static.headings > 1:
            return g, jnp.where(step == NO_HEADING, NO_HEADING, node.state % 8)
        return g, jnp.where(step == NO_HEADING, NO_HEADING, step & 7)

    return stage(queries.go, look)


def _offered(
    static: AstarStatic,
    queries: AstarQueries,
    lanes: Lanes,
    node: _Node,
    seen: Array,
    key: Array,
    g: Array,
    heading: Array,
) -> tuple[Array, Array, Array, Array]:
    """New values around the nodes, which are better, the turns, and lanes that met a limit."""
    column = (-1, 1)
    step = jnp.array([DIAGONAL if i % 2 else STRAIGHT for i in static.moves], jnp.int32)
    dx = jnp.array([DIRECTIONS[i][0] for i in static.moves], jnp.int32).reshape(column)
    dy = jnp.array([DIRECTIONS[i][1] for i in static.moves], jnp.int32).reshape(column)
    old = seen[:-1]
    h = estimate(static, queries.table, node.x + dx, node.y + dy)
    f = g + step.reshape(column) + h
    turned = jnp.zeros_like(f)
    if static.turning:
        moves = jnp.array(static.moves, jnp.int32).reshape(column)
        turned = jnp.where(heading == NO_HEADING, 0, turn(moves, heading))
        f = f + turned * queries.turn_cost
    excess = f - lanes.base
    fits = excess <= static.longest
    new = pqueue.pair(excess, h >> static.tie_shift, static.tie_bits)
    # A closed cell's value is its key with the sign turned.
    better = new < ((old | LEAST_KEY) if static.reopen else old)
    reached = node.some & _passable(static, old)
    better &= reached & fits & (old < (BLOCKED if static.reopen else 0))
    cut = jnp.any(reached & ~fits & (old == ABSENT), axis=0)
    closed = jnp.where(node.some, key ^ LEAST_KEY, seen[-1])
    values = jnp.concatenate([jnp.where(better, new, old), closed[None]])
    return values, better, turned, cut


def _passable(static: AstarStatic, seen: Array) -> Array:
    """Which moves the map allows; bool[moves, lanes]."""
    free = seen != BLOCKED
    if static.connectivity == 4 or static.corner_cutting:
        return free
    rows = [free[i] & free[i - 1] & free[(i + 1) % 8] if i % 2 else free[i] for i in range(8)]
    return jnp.stack(rows)


def _noted(
    static: AstarStatic,
    sizes: Layout,
    go: Array,
    lanes: Lanes,
    steps: Array,
    node: _Node,
    better: Array,
    turned: Array,
) -> Array:
    """Note for each state that was reached anew how it was entered."""
    nowhere = steps.shape[0]

    def notes() -> tuple[Array, Array]:
        moves = jnp.array(static.moves, jnp.int32)[:, None]
        entered = jnp.broadcast_to(moves, better.shape)
        if static.headings > 1:  # the state has the direction; the heading before is missing
            entered = jnp.broadcast_to(node.state % static.headings, better.shape)
        elif static.turning:
            entered = entered | turned << 3
        at = lanes.job * sizes.size + node.around[:-1]
        return jnp.where(better, at, nowhere), entered.astype(jnp.uint8)

    index, entered = stage(go, notes)
    return steps.at[index].set(entered, mode="drop")


def _status(
    static: AstarStatic, queries: AstarQueries, lanes: Lanes, node: _Node
) -> tuple[Array, Array]:
    expanded = lanes.expanded + node.some
    arrived = node.some & (node.x == 0) & (node.y == 0)
    nothing = jnp.where(lanes.cut, int(Status.OUT_OF_BUDGET), int(Status.UNREACHABLE))
    status = jnp.where(expanded >= queries.budget, int(Status.OUT_OF_BUDGET), lanes.status)
    status = jnp.where(arrived, int(Status.FOUND), status)
    status = jnp.where(node.some, status, nothing)
    return jnp.where(node.live, status, lanes.status), expanded
