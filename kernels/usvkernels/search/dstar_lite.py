"""D* Lite on grids whose cells change, one cell touched per lane and iteration.

Koenig and Likhachev, "D* Lite" (2002), searching from the goal to the vessel, with km and with
updates of only what a change affects. Everything that alters values is one operation
(`dstar_patch`): a cell is expanded, becomes blocked or becomes free, and the 3 x 3 cells about it
get their new rhs and key. So a lane that expands and one that learns of a change do the same
work, and the vessel's move reads the same patch.

State per lane is two planes: g (BLOCKED where not navigable) and the key (NONE where locally
consistent, that is, not queued); rhs follows from g. The queue is the plane of keys with a lower
bound for each block of cells: the least bound names the block to read. Where the block's least
key turns out larger, as its holder was updated away, the bound is put right and the lane tries
again.

Keys have one part where the paper has two; see `replan_heuristics`. A cell whose value got worse
is keyed by the consistent bound, one that got better by the guide (as in Likhachev et al.,
"Anytime D*", 2005). So even with a guide that overestimates, no search builds on a value that has
lost its support, and the path that it leaves can be sailed. A search ends when the vessel's cell
is itself consistent and no key is below its own.
"""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from usvkernels.search.dstar_layout import INFINITE, NONE, TOP, ReplanStatic
from usvkernels.search.dstar_patch import Outcome, Touch, offsets, separation, touch_patch
from usvkernels.search.replan_heuristics import bound, guide
from usvkernels.xla.stage import stage

GAVE_UP = -1
"""Recorded as cost-to-go by a lane that met a bound on its work or on lengths."""

NOWHERE = 2**30
"""Place of a record that is not due, past the end of any array of records."""

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
class Lanes:
    """Episodes under way. A step is: change, replan, move, record; record 0 is of the start."""

    g: Array  # int32[lanes * size]
    key: Array  # int32[lanes * size]
    unseen: Array  # bool[lanes * size], truth differs from what is known; empty without sensing
    bounds: Array  # int32[blocks, lanes], at most the least key of each block
    job: Array  # int32[lanes], and so are all below
    live: Array  # bool[lanes]
    record: Array  # the record that is being worked on
    cursor: Array  # next of this step's flips
    moved: Array  # bool[lanes], with sensing: this step's move is made, its view not yet digested
    here: Array  # the vessel's cell
    goal: Array
    origin: Array  # the vessel's cell when it last searched: keys are relative to it
    lead: Array  # km: by how much keys of then exceed those of the start
    expanded: Array  # since the last record
    iterations: Array  # since the last record


def first_key(static: ReplanStatic, start: Array, goal: Array) -> Array:
    """Key of the goal, the first cell of any queue; int32[lanes], as `start` and `goal`."""
    to_goal = separation(static.layout, start, goal)
    return guide(static.heuristic, static.weight, *to_goal, *to_goal)


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
    least = jnp.min(lanes.bounds, axis=0)
    value, ahead, settled = _standing(static, lanes, least)
    moving = lanes.live & ~changing & settled
    searching = lanes.live & ~changing & ~settled
    flip = changing & (changed != static.layout.void)
    lanes = replace(
        lanes,
        lead=lanes.lead + jnp.where(searching | flip, ahead, 0),
        origin=jnp.where(searching | flip, lanes.here, lanes.origin),
    )
    otherwise = jnp.where(moving, lanes.here, changed)
    lanes, touch = _popped(static, lanes, searching, least, otherwise, flip)
    lanes, outcome = _touched(static, lanes, touch)
    return _moved_and_recorded(static, episodes, lanes, moving, value, outcome)


def _lane(lanes: Lanes) -> Array:
    return jnp.arange(lanes.job.shape[0], dtype=jnp.int32)


def _first(mask: Array) -> Array:
    """Index of the first True along the first axis; the last index where there is none."""
    n = mask.shape[0]
    index = jnp.arange(n, dtype=jnp.int32)[:, None]
    return jnp.min(jnp.where(mask, index, n - 1), axis=0)


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
        place = _lane(lanes) * static.layout.size + jnp.where(due, flip, noticed)
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
    unseen = lanes.unseen.at[_lane(lanes) * layout.size + cells].get(mode=_INSIDE)
    nearest = jnp.min(jnp.where(unseen, cells, layout.size), axis=(0, 1))
    return jnp.where(nearest < layout.size, nearest, layout.void)


def _standing(static: ReplanStatic, lanes: Lanes, least: Array) -> tuple[Array, Array, Array]:
    """The vessel's cost-to-go, how far it is from the origin of the keys, whether both hold."""
    place = _lane(lanes) * static.layout.size + lanes.here
    value = lanes.g.at[place].get(mode=_INSIDE)
    consistent = lanes.key.at[place].get(mode=_INSIDE) == NONE
    ahead = bound(static.heuristic, *separation(static.layout, lanes.origin, lanes.here))
    own_key = jnp.where(value < INFINITE, value + ahead + lanes.lead, NONE)
    return value, ahead, consistent & (least >= own_key)


def _popped(
    static: ReplanStatic,
    lanes: Lanes,
    searching: Array,
    least: Array,
    otherwise: Array,
    flip: Array,
) -> tuple[Lanes, Touch]:
    """Take the first cell off the queue where a lane is searching, else touch another cell.

    Of cells with equal keys the one in the lowest row comes first, then that in the lowest column.
    """
    layout = static.layout
    block = _first(lanes.bounds == least)
    within = jnp.arange(layout.block, dtype=jnp.int32)[:, None]
    places = _lane(lanes) * layout.size + block * layout.block + within
    keys = lanes.key.at[places].get(mode=_INSIDE)
    key = jnp.min(keys, axis=0)
    slot = _first(keys == key)
    popped = searching & (key == least)
    left = jnp.min(jnp.where(popped & (within == slot), NONE, keys), axis=0)
    bounds = lanes.bounds.at[block, _lane(lanes)].set(left, unique_indices=True, mode=_INSIDE)
    touch = Touch(
        cell=jnp.where(popped, block * layout.block + slot, otherwise),
        flip=flip,
        popped=popped,
        key=key,
        goal=lanes.goal,
        origin=lanes.origin,
        lead=lanes.lead,
    )
    return replace(lanes, bounds=bounds), touch


def _touched(static: ReplanStatic, lanes: Lanes, touch: Touch) -> tuple[Lanes, Outcome]:
    """The lanes after their touches, and what came of these."""
    layout, first = static.layout, _lane(lanes) * static.layout.size
    patch = lanes.g.at[first + touch.cell + offsets(layout, 2)].get(mode=_INSIDE)
    outcome = stage(jnp.any(lanes.live), partial(touch_patch, static), touch, patch)
    cells = touch.cell + offsets(layout, 1)
    keys = lanes.key.at[first + cells].set(outcome.keys, unique_indices=True, mode=_INSIDE)
    bounds = lanes.bounds.at[cells // layout.block, _lane(lanes)].min(outcome.keys, mode=_INSIDE)
    g = lanes.g.at[first + touch.cell].set(outcome.g, unique_indices=True, mode=_INSIDE)
    lanes = replace(
        lanes,
        g=g,
        key=keys,
        bounds=bounds,
        expanded=lanes.expanded + outcome.expanded,
        iterations=lanes.iterations + lanes.live,
    )
    return lanes, outcome


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
