"""Distance fields: the exact way from every cell to the nearest of a set of goals."""

from functools import partial
from typing import Any

import jax
import numpy as np

from usvjax.batches import sized
from usvjax.checks import any_array, one_of
from usvjax.devices import COMPILER_OPTIONS, chosen_devices
from usvjax.errors import BadInputError, BadTypeError
from usvjax.memory import check_memory
from usvjax.public import public
from usvjax.search.inputs import check_connectivity, search_maps
from usvjax.search.sweeping import (
    MOST_LANES,
    greatest_h,
    grouped_batch,
    lanes_for,
    pack_maps,
    take_rows,
)
from usvkernels.search.steps import SMALL_UNITS, UNITS, Units, cells
from usvkernels.search.sweep import Sweep, choose_block
from usvkernels.search.sweep_field import Fields, field

MOST_CELLS = 1 << 22  # per call of a device; memory does not grow past it
_GOALS = "int [B, G, 2], int [B, 2] or [2], cells as (x, y), rows of -1 as padding"


@public("usvkernels.search")
def distance_field(
    blocked: Any,
    goals: Any,
    *,
    corner_cutting: bool = False,
    connectivity: int = 8,
    on_blocked: str = "raise",
) -> np.ndarray:
    """Find how far every cell is from the nearest goal, along shortest paths on the grid.

    For many agents with common goals, for tours, and as a perfect heuristic. Exact: lengths are
    whole units until the last (`usvkernels.search.steps`). Time grows with the number of turns that
    paths take: sea charts and scattered obstacles take some ten passes over the map, mazes
    hundreds.

    Args:
        blocked: bool[H, W] shared by all fields, bool[B, H, W], or a `GridMap` (shared).
        goals: int[B, G, 2], a set of goal cells (x, y) per field, rows of -1 as padding; or
            int[B, 2] or int[2], one goal each.
        corner_cutting: whether a diagonal step may pass a blocked side cell.
        connectivity: 8, or 4 for straight steps only.
        on_blocked: "raise" refuses a goal on a blocked cell; "ignore" leaves it out.

    Returns:
        float32[B, H, W], in cells; inf where no goal can be reached, and in blocked cells.

    Raises:
        BadTypeError: a map that is not boolean, goals or a connectivity that are not whole numbers,
            a corner_cutting that is not a bool.
        BadInputError: an empty or ragged argument, unequal batches, a goal outside the map or
            (by default) blocked, a field without a goal, another option than those above, more
            memory than there is, or a cell farther away than 26,582 cells.
    """
    one_of("on_blocked", on_blocked, ("raise", "ignore"))
    check_connectivity(connectivity)
    grids = search_maps(blocked)
    sets = _goal_sets(goals)
    count = _count(grids, sets)
    sets = np.broadcast_to(sets, (count, *sets.shape[1:]))
    _check_goals(grids, sets, on_blocked)
    height, width = grids.shape[1:]
    check_memory(8 * count * height * width, f"{count} distance fields of {width} x {height} cells")
    out = np.empty((count, height, width), np.float32)
    rows = np.arange(count)
    for units in (SMALL_UNITS, UNITS):
        if greatest_h(width, height, units, connectivity) > units.cap:
            continue
        lanes = lanes_for(width, height, units, len(rows), MOST_LANES)
        block = choose_block(width, lanes)
        sweep = Sweep(width, height, lanes, block, units, connectivity, bool(corner_cutting))
        rows = rows[_fill(grids, sets, sweep, rows, out)]
        if not len(rows):
            return out
    raise BadInputError(
        f"blocked: the field in row {rows[0]} has cells farther than 26,582 cells from its "
        "goals; wanted a map with shorter ways"
    )


def _goal_sets(goals: Any) -> np.ndarray:
    """Goals as int[B, G, 2]."""
    sets = any_array("goals", goals, _GOALS)
    if sets.size == 0 or sets.ndim not in (1, 2, 3) or sets.shape[-1] != 2:
        raise BadInputError(f"goals: got shape {sets.shape}; wanted {_GOALS}")
    if sets.dtype.kind not in "iu":
        raise BadTypeError(f"goals: got dtype {sets.dtype}; wanted {_GOALS}")
    return sets if sets.ndim == 3 else sets.reshape(-1, 1, 2)


def _count(grids: np.ndarray, sets: np.ndarray) -> int:
    if len(grids) > 1 and len(sets) not in (1, len(grids)):
        raise BadInputError(
            f"goals: got {len(sets)} rows; wanted {len(grids)}, one per map, or one for all"
        )
    return max(len(grids), len(sets))


def _check_goals(grids: np.ndarray, sets: np.ndarray, on_blocked: str) -> None:
    padding = (sets == -1).all(axis=2)
    empty = padding.all(axis=1)
    if empty.any():
        raise BadInputError(
            f"goals: row {int(np.argmax(empty))} is all padding; wanted at least one goal"
        )
    height, width = grids.shape[1:]
    outside = ((sets < 0) | (sets >= [width, height])).any(axis=2) & ~padding
    wanted = f"wanted 0 <= x < {width} and 0 <= y < {height}"
    _refuse(sets, outside, f"lies outside the map; {wanted}")
    if on_blocked == "raise":
        layer = np.arange(len(sets))[:, None] if len(grids) > 1 else 0
        inside = np.where(padding[..., None], 0, sets)
        hit = grids[layer, inside[..., 1], inside[..., 0]] & ~padding
        wanted = 'wanted a free one, or on_blocked="ignore" to leave such goals out'
        _refuse(sets, hit, f"is a blocked cell; {wanted}")


def _refuse(sets: np.ndarray, bad: np.ndarray, why: str) -> None:
    """Name the first bad goal, bool[B, G]."""
    if bad.any():
        row, column = np.argwhere(bad)[0].tolist()
        x, y = sets[row, column].tolist()
        raise BadInputError(f"goals: ({x}, {y}) in row {row} {why}")


def _fill(
    grids: np.ndarray, sets: np.ndarray, sweep: Sweep, rows: np.ndarray, out: np.ndarray
) -> np.ndarray:
    """Write the fields of these rows; bool[rows], where lengths passed what the units hold."""
    most = max(1, MOST_CELLS // (sweep.width * sweep.height * sweep.lanes))
    batch = grouped_batch(rows, sweep.lanes, most, chosen_devices())
    return np.concatenate(batch.run(partial(_fill_block, grids, sets, sweep, out)))


def _fill_block(
    grids: np.ndarray,
    sets: np.ndarray,
    sweep: Sweep,
    out: np.ndarray,
    padded: np.ndarray,
    count: int,
    device: jax.Device,
) -> np.ndarray:
    lanes, rows = sweep.lanes, padded[:count]
    groups, capacity = -(-count // lanes), len(padded) // lanes
    goals = (
        sized(sets[rows].astype(np.int32), len(padded), fill=-1)
        .reshape(capacity, lanes, *sets.shape[1:])
        .swapaxes(1, 2)
    )
    maps = grids if len(grids) == 1 else take_rows(grids, rows)
    packed, goals = jax.device_put((pack_maps(maps, lanes, capacity), goals), device)
    found = jax.device_get(_field(sweep, packed, goals, np.int32(groups)))
    for group in range(groups):
        chosen = rows[group * lanes : (group + 1) * lanes]
        layers = found.length[group, :, : len(chosen)].T
        out[chosen] = _in_cells(layers, sweep.units).reshape(-1, sweep.height, sweep.width)
    return found.capped.reshape(-1)[:count]


def _in_cells(length: np.ndarray, units: Units) -> np.ndarray:
    """Lengths in cells, float32: the rounded exact value."""
    if units is SMALL_UNITS:
        return _SMALL_CELLS[length]
    # DIAGONAL / STRAIGHT is sqrt(2) to 5e-11, a thousandth of what float32 tells apart.
    return np.where(length < units.cap, length / units.straight, np.inf).astype(np.float32)


_SMALL_CELLS = cells(np.arange(SMALL_UNITS.cap + 1), SMALL_UNITS).astype(np.float32)


@partial(jax.jit, static_argnames="sweep", compiler_options=COMPILER_OPTIONS)
def _field(sweep: Sweep, packed: jax.Array, sources: jax.Array, groups: jax.Array) -> Fields:
    return field(sweep, packed, sources, groups)
