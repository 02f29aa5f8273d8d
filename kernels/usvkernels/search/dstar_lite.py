"""Episodes of D* Lite on grids whose cells change, from a table of changes.

A step is: change, replan, move, record. The search is that of `dstar_search`; here is what comes
between two searches: which changes are due, which of them the vessel sees, its move.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from usvkernels.search.dstar_layout import INFINITE, TOP, ReplanStatic
from usvkernels.search.dstar_patch import Outcome
from usvkernels.search.dstar_search import (
    GAVE_UP,
    NOWHERE,
    Searches,
    lane_numbers,
    standing,
    worked,
)

_INSIDE = "promise_in_bounds"


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Episodes:
    """What the lanes work on; all cells as `Layout.index`.

    Attributes:
        blocked: bool[M, size], maps with their margin.
        map_of: int32[n], map of each episode.
        start: int32[n].
        goal: int32[n]; differs from the start.
        flips: int32[n * T * C or more], the C cells that change just before each of T moves, -1
            after the last.
        steps: int32, T; an operand, so that programs are compiled for sizes of arrays alone.
        width: int32, C.
        max_expansions: int32, before one record, after which an episode is given up.
    """

    blocked: Array
    map_of: Array
    start: Array
    goal: Array
    flips: Array
    steps: Array
    width: Array
    max_expansions: Array


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Lanes(Searches):
    """Episodes under way. A step is: change, replan, move, record; record 0 is of the start."""

    unseen: Array  # bool[lanes * size], truth differs from what is known; empty without sensing
    job: Array  # int32[lanes], and so are all below
    record: Array  # the record that is being worked on
    cursor: Array  # next of this step's flips
    moved: Array  # bool[lanes], with sensing: this step's move is made, its view not yet digested


def advance(static: ReplanStatic, episodes: Episodes, lanes: Lanes) -> tuple[Lanes, Array, Array]:
    """Do the next thing in every lane: one change, one expansion or one move.

    Args:
        static: choices of method.
        episodes: all episodes.
        lanes: those under way.

    Returns:
        The lanes; the places of their records, int32[lanes] into n * (T + 1), NOWHERE where there
        is none now; and the records int32[lanes, 3]: the vessel's cell, cost-to-go (INFINITE where
        cut off, or GAVE_UP) and expansions since the record before.
    """
    lanes, changing, changed = _next_change(static, episodes, lanes)
    now = standing(static, lanes)
    moving = lanes.live & ~changing & now.settled
    searching = lanes.live & ~changing & ~now.settled
    otherwise = jnp.where(moving, lanes.here, static.layout.void)
    lanes, outcome = worked(
        static, lanes, now, searching=searching, changed=changed, otherwise=otherwise
    )
    return _moved_and_recorded(static, episodes, lanes, moving, now.value, outcome)


def _next_change(
    static: ReplanStatic, episodes: Episodes, lanes: Lanes
) -> tuple[Lanes, Array, Array]:
    """Which lanes have a change to deal with, and the cell that becomes known as changed.

    That cell is void where the change is to be ignored or, for now, out of sight.
    """
    void = static.layout.void
    due = lanes.live & (lanes.record > 0) & (lanes.cursor < episodes.width)
    place = (lanes.job * episodes.steps + lanes.record - 1) * episodes.width + lanes.cursor
    flip = episodes.flips.at[jnp.where(due, place, 0)].get(mode=_INSIDE)
    due &= flip >= 0
    lanes = replace(lanes, cursor=lanes.cursor + due)
    flip = jnp.where(due & (flip != lanes.here) & (flip != lanes.goal), flip, void)
    if static.sensing is not None:
        noticed = jnp.where(lanes.live & ~due, _in_view(static, lanes), void)
        place = lane_numbers(lanes) * static.layout.size + jnp.where(due, flip, noticed)
        unseen = ~lanes.unseen.at[place].get(mode=_INSIDE) & (flip != void)
        unseen = lanes.unseen.at[place].set(unseen, unique_indices=True, mode=_INSIDE)
        lanes = replace(lanes, unseen=unseen)
        flip, due = noticed, due | (noticed != void)
    return lanes, due, flip


def _in_view(static: ReplanStatic, lanes: Lanes) -> Array:
    """The first cell in the vessel's window that is not as it was known, else void."""
    assert static.sensing is not None
    layout = static.layout
    rows, columns = (np.arange(n, dtype=np.int32) - n // 2 for n in static.sensing)
    y = lanes.here // layout.stride + rows[:, None, None]
    x = lanes.here % layout.stride + columns[:, None]
    inside = (y >= TOP) & (y < TOP + layout.height) & (x >= 0) & (x < layout.width)
    cells = jnp.where(inside, y * layout.stride + x, layout.void)
    unseen = lanes.unseen.at[lane_numbers(lanes) * layout.size + cells].get(mode=_INSIDE)
    nearest = jnp.min(jnp.where(unseen, cells, layout.size), axis=(0, 1))
    return jnp.where(nearest < layout.size, nearest, layout.void)


def _moved_and_recorded(
    static: ReplanStatic,
    episodes: Episodes,
    lanes: Lanes,
    moving: Array,
    value: Array,
    outcome: Outcome,
) -> tuple[Lanes, Array, Array]:
    """Move the vessel where its path is settled, and write down what is to be recorded."""
    # Expansions aside, an iteration takes a key up to date or a bound, a change or the move.
    most = 2 * episodes.max_expansions + 16 * static.layout.size + 2 * episodes.width
    gives_up = outcome.overflow | (lanes.expanded > episodes.max_expansions)
    gives_up = lanes.live & (gives_up | (lanes.iterations > most))

    due = (lanes.record > 0) & ~lanes.moved  # a move, before the record
    goes = moving & due & (value < INFINITE)
    here = jnp.where(goes, lanes.here + outcome.ahead, lanes.here)
    value = jnp.where(goes, outcome.value_ahead, value)
    arrived = here == lanes.goal
    records = moving & (arrived | ~due) if static.sensing else moving

    place = lanes.job * (episodes.steps + 1) + lanes.record
    place = jnp.where(records | gives_up, place, NOWHERE)
    written = jnp.stack([here, jnp.where(gives_up, GAVE_UP, value), lanes.expanded], axis=1)
    lanes = replace(
        lanes,
        here=here,
        record=lanes.record + records,
        cursor=jnp.where(records, 0, lanes.cursor),
        moved=jnp.where(moving, ~records, lanes.moved),
        expanded=jnp.where(records, 0, lanes.expanded),
        iterations=jnp.where(records, 0, lanes.iterations),
        live=lanes.live & ~gives_up & ~(records & (arrived | (lanes.record >= episodes.steps))),
    )
    return lanes, place, written
