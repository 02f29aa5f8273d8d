"""Obstacles of a grid: whole ones scaled about their centres, and the nearest of each cell."""

from typing import Any

import jax
import numpy as np
import scipy

from usvjax import checks
from usvjax.checks import byte_size, whole_number
from usvjax.errors import BadInputError
from usvjax.public import public
from usvkernels import grids

_EIGHT_NEIGHBOURS = np.ones((3, 3), dtype=bool)
# Distances between cell centres are square roots of whole numbers; this keeps "exactly at
# reach" inside without ever admitting the next distance.
_AT_REACH = 1e-6
_AT_ONCE = 2**24  # entries of the table that are looked up at a time
MOST_BYTES = 2**31
"""Largest table of obstacles."""

_shoreline = jax.jit(grids.shoreline)


@public()
def expand_obstacles(blocked: Any, expansion: float) -> np.ndarray:
    """Scale each connected obstacle by (1 + E) about its centre (Chen 2023, Eq. 4).

    An obstacle is an 8-connected group of blocked cells, its centre the mean of their centres.
    A cell becomes blocked when its centre lies in the scaled obstacle or on its boundary. No
    cell is ever freed: Eq. 4 moves the inner side of a hollow obstacle (the shore around a
    lake) outwards, so for shores use an inflation by a radius.

    Args:
        blocked: bool[H, W].
        expansion: the obstacle expansion coefficient E, >= 0.

    Returns:
        bool[H, W].

    Raises:
        BadTypeError: ``blocked`` is not bool or ``expansion`` not a number.
        BadInputError: ``expansion`` is negative or not finite, or ``blocked`` not [H, W].
    """
    cells = checks.grid("blocked", blocked)
    scale = 1.0 + checks.not_negative("expansion", expansion)
    labels, count = scipy.ndimage.label(cells, structure=_EIGHT_NEIGHBOURS)
    result = cells.copy()
    for label, box in enumerate(scipy.ndimage.find_objects(labels, count), start=1):
        _stamp_scaled(result, labels[box] == label, (box[0].start, box[1].start), scale)
    return result


def _stamp_scaled(
    result: np.ndarray, obstacle: np.ndarray, corner: tuple[int, int], scale: float
) -> None:
    """Block in ``result`` the cells of one obstacle (its bounding box) scaled by ``scale``."""
    inside = []
    spans = []
    for axis, indices in enumerate(np.nonzero(obstacle)):
        size, start = obstacle.shape[axis], corner[axis]
        centre = start + indices.mean() + 0.5
        low = centre + scale * (start - centre)
        high = centre + scale * (start + size - centre)
        span = np.arange(max(int(low), 0), min(int(np.ceil(high)), result.shape[axis]))
        # Where the centre of each new cell came from, in cells of the obstacle's box.
        inside.append(centre + (span + 0.5 - centre) / scale - start)
        spans.append(slice(span[0], span[-1] + 1))
    window = result[spans[0], spans[1]]
    padded = np.pad(obstacle, 1)
    # A point on an edge between two cells belongs to both: look just to either side of it.
    for below_y in (False, True):
        for below_x in (False, True):
            y = _cell_beside(inside[0], below_y, obstacle.shape[0])
            x = _cell_beside(inside[1], below_x, obstacle.shape[1])
            window |= padded[np.ix_(y, x)]


def _cell_beside(position: np.ndarray, below: bool, size: int) -> np.ndarray:
    nudge = -1e-9 if below else 1e-9
    return np.clip(np.floor(position + nudge).astype(int) + 1, 0, size + 1)


@public()
def obstacle_table(blocked: Any, k: int | None, reach_cells: float) -> np.ndarray:
    """List for each free cell the shoreline cells nearest to it.

    The shoreline is ``usvkernels.grids.shoreline``: blocked cells with a free one among their
    eight neighbours. Distances run between cell centres, so a vessel anywhere in the cell is
    at most 0.71 cells off them. Nothing lies outside the map.

    Args:
        blocked: bool[H, W].
        k: how many obstacles per cell, >= 1; None: as many as the fullest cell has within
            reach, rounded up to a multiple of 8, so that none is left out.
        reach_cells: obstacles beyond this distance are left out, cells, > 0.

    Returns:
        int32[H, W, k]: flat indices y * W + x, nearest first, padded with -1; blocked cells
        have -1 throughout.

    Raises:
        BadTypeError: an argument has the wrong type.
        BadInputError: ``k`` is below 1, ``reach_cells`` not above 0, ``blocked`` not [H, W], or
            the table larger than MOST_BYTES.
    """
    cells = checks.grid("blocked", blocked)
    reach = checks.positive("reach_cells", reach_cells) * (1.0 + _AT_REACH)
    shore = np.flatnonzero(np.asarray(_shoreline(cells)))
    tree = scipy.spatial.cKDTree(np.stack(np.divmod(shore, cells.shape[1]), axis=-1))
    free = np.argwhere(~cells)
    if k is None:
        within = tree.query_ball_point(free, reach, return_length=True, workers=-1)
        k = max(8, -(-int(np.max(within, initial=0)) // 8) * 8)
    k = whole_number("k", k, 1)
    if (size := 4 * k * cells.size) > MOST_BYTES:
        raise BadInputError(
            f"map: the obstacles within {reach:g} cells of each of {cells.size:,} cells take "
            f"{byte_size(size)}; wanted at most {byte_size(MOST_BYTES)}, by a shorter "
            "sensing_range or larger cells"
        )
    table = np.full((*cells.shape, k), -1, np.int32)
    ranks = np.arange(1, min(k, shore.size) + 1)
    if len(ranks) == 0:
        return table
    # The tree marks "none within reach" by the number of its points: the -1 appended here.
    number = np.append(shore, -1)
    rows = max(1, _AT_ONCE // len(ranks))  # the tree's answer takes four times the table's room
    for some in np.split(free, range(rows, len(free), rows)):
        _, found = tree.query(some, k=ranks, distance_upper_bound=reach, workers=-1)
        table[some[:, 0], some[:, 1], : len(ranks)] = number[found]
    return table
