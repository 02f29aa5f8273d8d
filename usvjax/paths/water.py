"""Whether paths are clear of blocked cells, exactly."""

from collections.abc import Iterator

import numpy as np

from usvjax.errors import BadInputError
from usvjax.paths.inputs import Frame, Paths, check_on_map, place_of

_TOUCHING = 1e-9  # cells; what rounding to double precision may move a crossing by
_AT_ONCE = 1 << 18  # segments or columns in one array of a check


def check_on_water(paths: Paths, frame: Frame, corner_cutting: bool = False) -> None:
    """Refuse paths that leave the map or touch a blocked cell.

    Raises:
        BadInputError: naming the first row and place; or maps and paths of unequal number.
    """
    check_on_map(paths, frame)
    in_cells = paths.points if paths.are_cells else frame.in_cells(paths)
    valid = np.arange(paths.points.shape[1]) < paths.counts[:, None]
    check = _cells_clear if paths.are_cells else segments_clear
    all_rows, all_points = np.nonzero(valid)
    for part in range(0, len(all_rows), _AT_ONCE):
        rows, points = all_rows[part : part + _AT_ONCE], all_points[part : part + _AT_ONCE]
        following = np.minimum(points + 1, paths.counts[rows] - 1)
        clear = check(
            in_cells[rows, points], in_cells[rows, following], rows, frame, corner_cutting
        )
        if not clear.all():
            bad = int(np.argmin(clear))
            raise BadInputError(
                f"paths: row {rows[bad]} meets a blocked cell between point {points[bad]}, "
                f"{place_of(paths, rows[bad], points[bad])}, and the next; wanted a clear path"
                + ("" if corner_cutting else " (corner_cutting=True lets it touch corners)")
            )


def _cells_clear(
    starts: np.ndarray, ends: np.ndarray, rows: np.ndarray, frame: Frame, corner_cutting: bool
) -> np.ndarray:
    """Whether segments between cells, int32[n, 2], are clear."""
    clear = np.ones(len(rows), bool)
    layers = frame.layers(rows)
    steps = np.abs(ends - starts).max(axis=1) <= 1  # of a search: four cells say it all
    touched = [starts, ends]
    if not corner_cutting:
        touched += [
            np.stack([starts[:, 0], ends[:, 1]], 1),
            np.stack([ends[:, 0], starts[:, 1]], 1),
        ]
    for cells in touched:
        clear[steps] &= ~_blocked(frame.blocked, layers[steps], cells[steps])
    far = ~steps
    if far.any():
        # Exact: a line between centres that misses a corner does so by far more than rounding.
        clear[far] = segments_clear(
            starts[far] + 0.5, ends[far] + 0.5, rows[far], frame, corner_cutting
        )
    return clear


def segments_clear(
    starts: np.ndarray, ends: np.ndarray, rows: np.ndarray, frame: Frame, corner_cutting: bool
) -> np.ndarray:
    """Whether segments touch no blocked cell and stay on the map; bool[n].

    Args:
        starts, ends: float64[n, 2], in cells from the map's corner.
        rows: int[n], the row whose map counts.
        frame: the maps.
        corner_cutting: cells are open squares instead of closed ones.
    """
    shape = np.array(frame.blocked.shape[:0:-1])
    on_map = (starts >= 0) & (starts <= shape) & (ends >= 0) & (ends <= shape)
    clear: np.ndarray = np.all(on_map, axis=1)
    layers = frame.layers(rows)
    slack = -_TOUCHING if corner_cutting else _TOUCHING
    inside = np.flatnonzero(clear)  # the others may cross any number of columns
    for part in _even_parts(starts[inside], ends[inside]):
        own = inside[part]
        clear[own] = _columns_clear(starts[own], ends[own], layers[own], frame.blocked, slack)
    return clear


def _columns_clear(
    start: np.ndarray, end: np.ndarray, layers: np.ndarray, grids: np.ndarray, slack: float
) -> np.ndarray:
    """As `segments_clear`, all columns of all segments in one array each."""
    across = np.abs(end - start).argmax(axis=1)  # the axis along which columns are counted
    start, end = _swapped(start, across), _swapped(end, across)
    forward = (start[:, 0] <= end[:, 0])[:, None]
    start, end = np.where(forward, start, end), np.where(forward, end, start)
    first = np.floor(start[:, 0] - slack).astype(int)
    # At least one: a segment of no length that lies on an edge is in neither column.
    count = np.maximum(np.floor(end[:, 0] + slack).astype(int) - first + 1, 1)
    begin = np.cumsum(count) - count
    which = np.repeat(np.arange(len(start)), count)
    column = first[which] + np.arange(len(which)) - begin[which]
    span = end - start
    slope = span[:, 1] / np.maximum(span[:, 0], 1e-300)
    edges = np.clip(np.stack([column, column + 1]), start[which, 0], end[which, 0])
    heights = start[which, 1] + slope[which] * (edges - start[which, 0])
    low = np.floor(heights.min(axis=0) - slack).astype(int)
    high = np.floor(heights.max(axis=0) + slack).astype(int)
    hit = np.zeros(len(which), bool)
    for more in range(3):  # no column of a segment no steeper than 1 meets more rows
        cell = _swapped(np.stack([column, low + more], axis=1), across[which])
        hit |= (low + more <= high) & _blocked(grids, layers[which], cell)
    return ~np.logical_or.reduceat(hit, begin)


def _even_parts(starts: np.ndarray, ends: np.ndarray) -> Iterator[np.ndarray]:
    """Places of the segments, in parts that cross about _AT_ONCE columns at most."""
    work = np.cumsum(np.abs(ends - starts).max(axis=1) + 2) // _AT_ONCE
    yield from np.split(np.arange(len(starts)), np.flatnonzero(np.diff(work)) + 1)


def _swapped(points: np.ndarray, across: np.ndarray) -> np.ndarray:
    return np.where(across[:, None] == 1, points[:, ::-1], points)


def _blocked(grids: np.ndarray, layers: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Whether cells are blocked; those off the map, touched from inside, are not."""
    height, width = grids.shape[1:]
    x, y = cells[:, 0], cells[:, 1]
    inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
    return inside & grids[layers, np.where(inside, y, 0), np.where(inside, x, 0)]
