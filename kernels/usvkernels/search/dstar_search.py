"""The search of D* Lite, one cell touched per lane and iteration, whatever the vessel does.

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
from typing import NamedTuple, TypeVar

import jax
import jax.numpy as jnp
from jax import Array, lax

from usvkernels.search.dstar_layout import BLOCKED, INFINITE, NONE, ReplanStatic
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
class Searches:
    """Searches under way, one per lane; planes flat, lanes one after the other."""

    g: Array  # int32[lanes * size]
    key: Array  # int32[lanes * size]
    bounds: Array  # int32[blocks, lanes], at most the least key of each block
    live: Array  # bool[lanes]
    here: Array  # int32[lanes], and so are all below: the vessel's cell
    goal: Array
    origin: Array  # the vessel's cell when it last searched: keys are relative to it
    lead: Array  # km: by how much keys of then exceed those of the start
    expanded: Array  # since the last record
    iterations: Array  # since the last record
    taken: Array  # iterations that advanced a job, of all jobs so far


Lanes = TypeVar("Lanes", bound=Searches)


class Standing(NamedTuple):
    """Where a lane's search stands."""

    value: Array  # int32[lanes], the vessel's cost-to-go
    settled: Array  # bool[lanes], whether that is final
    least: Array  # int32[lanes], the least bound on a key
    ahead: Array  # int32[lanes], how far the vessel is from the origin of the keys


def idle_searches(static: ReplanStatic, lanes: int) -> dict[str, Array]:
    """The fields of `Searches` for lanes that have nothing to do."""
    size, blocks = static.layout.size, static.layout.blocks
    zero = jnp.zeros(lanes, jnp.int32)
    return {
        "g": jnp.full(lanes * size, BLOCKED, jnp.int32),
        "key": jnp.full(lanes * size, NONE, jnp.int32),
        "bounds": jnp.full((blocks, lanes), NONE, jnp.int32),
        "live": jnp.zeros(lanes, bool),
        "here": zero + static.layout.void,
        **dict.fromkeys(("goal", "origin", "lead", "expanded", "iterations", "taken"), zero),
    }


def first_key(static: ReplanStatic, start: Array, goal: Array) -> Array:
    """Key of the goal, the first cell of any queue; int32[lanes], as `start` and `goal`."""
    to_goal = separation(static.layout, start, goal)
    return guide(static.heuristic, static.weight, *to_goal, *to_goal)


def begin_planes(
    static: ReplanStatic,
    planes: tuple[Array, Array, Array],
    lane: Array,
    blocked: Array,
    goal: Array,
    key: Array,
) -> tuple[Array, Array, Array]:
    """Planes g, key and bounds of all lanes with those of one lane begun anew.

    Args:
        static: choices of method.
        planes: g, key, bounds as in `Searches`.
        lane: int32, which.
        blocked: bool[size], its map.
        goal, key: int32, its goal, and the goal's `first_key`.
    """
    g, keys, bounds = planes
    size = static.layout.size
    fresh = jnp.where(blocked, jnp.int32(BLOCKED), jnp.int32(INFINITE))
    g = lax.dynamic_update_slice(g, fresh, (lane * size,))
    queued = jnp.full(size, NONE, jnp.int32).at[goal].set(key)
    keys = lax.dynamic_update_slice(keys, queued, (lane * size,))
    least = jnp.min(queued.reshape(-1, static.layout.block), axis=1)
    bounds = lax.dynamic_update_slice(bounds, least[:, None], (jnp.int32(0), lane))
    return g, keys, bounds


def lane_numbers(lanes: Searches) -> Array:
    """0, 1, 2, ... int32[lanes]."""
    return jnp.arange(lanes.here.shape[0], dtype=jnp.int32)


def standing(static: ReplanStatic, lanes: Searches) -> Standing:
    """Look where each search stands."""
    least = jnp.min(lanes.bounds, axis=0)
    place = lane_numbers(lanes) * static.layout.size + lanes.here
    value = lanes.g.at[place].get(mode=_INSIDE)
    consistent = lanes.key.at[place].get(mode=_INSIDE) == NONE
    ahead = bound(static.heuristic, *separation(static.layout, lanes.origin, lanes.here))
    own_key = jnp.where(value < INFINITE, value + ahead + lanes.lead, NONE)
    return Standing(value, consistent & (least >= own_key), least, ahead)


def worked(
    static: ReplanStatic,
    lanes: Lanes,
    now: Standing,
    *,
    searching: Array,
    changed: Array,
    otherwise: Array,
) -> tuple[Lanes, Outcome]:
    """Touch one cell in every lane.

    Args:
        static: choices of method.
        lanes: the searches.
        now: where they stand.
        searching: bool[lanes], which take the first cell off their queue.
        changed: int32[lanes], the cell that becomes blocked or free; void where none does.
        otherwise: int32[lanes], the cell about which a lane that does neither is to look.

    Returns:
        The lanes after it, and what came of it.
    """
    flip = changed != static.layout.void
    lanes = replace(
        lanes,
        lead=lanes.lead + jnp.where(searching | flip, now.ahead, 0),
        origin=jnp.where(searching | flip, lanes.here, lanes.origin),
    )
    otherwise = jnp.where(flip, changed, otherwise)
    lanes, touch = _popped(static, lanes, searching, now.least, otherwise, flip)
    return _touched(static, lanes, touch)


def _first(mask: Array) -> Array:
    """Index of the first True along the first axis; the last index where there is none."""
    n = mask.shape[0]
    index = jnp.arange(n, dtype=jnp.int32)[:, None]
    return jnp.min(jnp.where(mask, index, n - 1), axis=0)


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
    layout, lane = static.layout, lane_numbers(lanes)
    block = _first(lanes.bounds == least)
    within = jnp.arange(layout.block, dtype=jnp.int32)[:, None]
    places = lane * layout.size + block * layout.block + within
    keys = lanes.key.at[places].get(mode=_INSIDE)
    key = jnp.min(keys, axis=0)
    slot = _first(keys == key)
    popped = searching & (key == least)
    left = jnp.min(jnp.where(popped & (within == slot), NONE, keys), axis=0)
    bounds = lanes.bounds.at[block, lane].set(left, unique_indices=True, mode=_INSIDE)
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
    layout, lane = static.layout, lane_numbers(lanes)
    first = lane * layout.size
    patch = lanes.g.at[first + touch.cell + offsets(layout, 2)].get(mode=_INSIDE)
    outcome = stage(jnp.any(lanes.live), partial(touch_patch, static), touch, patch)
    cells = touch.cell + offsets(layout, 1)
    keys = lanes.key.at[first + cells].set(outcome.keys, unique_indices=True, mode=_INSIDE)
    bounds = lanes.bounds.at[cells // layout.block, lane].min(outcome.keys, mode=_INSIDE)
    g = lanes.g.at[first + touch.cell].set(outcome.g, unique_indices=True, mode=_INSIDE)
    lanes = replace(
        lanes,
        g=g,
        key=keys,
        bounds=bounds,
        expanded=lanes.expanded + outcome.expanded,
        iterations=lanes.iterations + lanes.live,
        taken=lanes.taken + lanes.live,
    )
    return lanes, outcome
