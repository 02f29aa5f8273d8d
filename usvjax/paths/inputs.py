"""Checks that everything done to paths shares, and their form on the host."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np

from usvjax.checks import pair, positive
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap
from usvjax.paths.blocks import MOST_ROWS, SIZES, bucket
from usvjax.search.inputs import search_maps
from usvkernels.paths.charts import Charts

_PATHS = "int [B, P, 2] (cells) or float [B, P, 2] (m), P >= 2, padded to one length"
_TOUCHING = 1e-9  # cells; what rounding to double precision may move a crossing by
_MOST_CELLS = 1 << 26  # of maps on a device at a time, if there are that many paths
_LEAST_CELLS = 1 << 16  # of the maps in one call: few sizes to compile
_AT_ONCE = 1 << 18  # segments or columns in one array of a check


@dataclass(frozen=True)
class Frame:
    """Maps in the world.

    Attributes:
      blocked: bool[1, H, W] shared by all paths, or bool[B, H, W].
      cell_size: m.
      origin: float64[2], corner of cell (0, 0), m.
    """

    blocked: np.ndarray
    cell_size: float
    origin: np.ndarray

    def in_cells(self, paths: "Paths") -> np.ndarray:
        """Points in cells from the map's corner, float64[B, P, 2]; of cells the centres."""
        if paths.are_cells:
            return paths.points + 0.5
        return (paths.points - self.origin) / self.cell_size

    @property
    def longer_side(self) -> float:
        """Of the map, m."""
        return self.cell_size * max(self.blocked.shape[1:])

    @property
    def most_rows(self) -> int:
        """Paths that one device should work on at once, their maps counted."""
        if len(self.blocked) == 1:
            return MOST_ROWS
        cells = self.blocked[0].size
        return max((n for n in SIZES if n * cells <= _MOST_CELLS), default=1)

    def charts(self, rows: np.ndarray) -> Charts:
        """The maps of some rows, for the kernels."""
        which, maps = np.unique(self.layers(rows), return_inverse=True)
        cells = self.blocked[which].reshape(-1)
        padded = np.ones(bucket(max(cells.size, _LEAST_CELLS), 4), bool)
        padded[: cells.size] = cells
        height, width = self.blocked.shape[1:]
        return Charts(
            cells=jnp.asarray(padded),
            first=jnp.asarray(maps * (height * width), jnp.int32),
            height=jnp.int32(height),
            width=jnp.int32(width),
        )

    def layers(self, rows: np.ndarray) -> np.ndarray:
        """int32, the map of each of these rows."""
        return np.zeros(len(rows), np.int32) if len(self.blocked) == 1 else rows.astype(np.int32)


@dataclass(frozen=True)
class Paths:
    """B checked paths.

    Attributes:
      points: int32[B, P, 2] (cells) or float64[B, P, 2] (m); the last point pads.
      counts: int32[B], points of each, 0 where there is no path.
      are_cells: which of the two.
    """

    points: np.ndarray
    counts: np.ndarray
    are_cells: bool

    def __len__(self) -> int:
        return len(self.points)

    def metres(self, cell_size: float, origin: np.ndarray) -> np.ndarray:
        """The points in the world, float64[B, P, 2]; of cells the centres."""
        return origin + cell_size * (self.points + 0.5) if self.are_cells else self.points


def path_frame(blocked: Any, cell_size: float | None, origin: Any) -> Frame:
    """The maps and where they lie; a `GridMap` brings its own cell size and origin.

    Raises:
      BadTypeError, BadInputError: of another type or shape, or both ways at once.
    """
    if isinstance(blocked, GridMap):
        for name, value in (("cell_size", cell_size), ("origin", origin)):
            if value is not None:
                raise BadInputError(f"{name}: got {value!r} with a GridMap, which has its own")
        cell_size, origin = blocked.cell_size, blocked.origin
    size, corner = scale(cell_size, origin)
    return Frame(search_maps(blocked), size, corner)


def scale(cell_size: float | None, origin: Any) -> tuple[float, np.ndarray]:
    """Cell size (m; default 1) and origin (default (0, 0)), checked."""
    size = positive("cell_size", 1.0 if cell_size is None else cell_size)
    corner = pair("origin", (0.0, 0.0) if origin is None else origin)
    return size, np.array(corner, np.float64)


def path_rows(paths: Any, lengths: Any, cells_only: bool = False) -> Paths:
    """Check paths and their lengths.

    Args:
      paths: int[B, P, 2], cells (x, y), or float[B, P, 2], m.
      lengths: int[B], points of each path, 0 where there is none; None: all P.
      cells_only: refuse metres.

    Raises:
      BadTypeError: not numbers of the right kind.
      BadInputError: ragged, of another shape, NaN or infinite before the end of a path, or a
        length outside 0 .. P.
    """
    wanted = "int [B, P, 2] (cells), P >= 2, padded to one length" if cells_only else _PATHS
    try:
        points = np.asarray(paths)
    except ValueError:
        raise BadInputError(f"paths: rows of unequal length; wanted {wanted}") from None
    if points.dtype.kind not in ("iu" if cells_only else "iuf"):
        raise BadTypeError(f"paths: got dtype {points.dtype}; wanted {wanted}")
    if points.ndim != 3 or points.shape[2] != 2 or points.shape[1] < 2 or not len(points):
        raise BadInputError(f"paths: got shape {points.shape}; wanted {wanted}")
    counts = _counts(lengths, *points.shape[:2])
    slot = np.minimum(np.arange(points.shape[1]), np.maximum(counts - 1, 0)[:, None])
    valid = np.arange(points.shape[1]) < counts[:, None]
    if points.dtype.kind == "f":
        wrong = valid[..., None] & ~np.isfinite(points)
        if wrong.any():
            first = tuple(int(i) for i in np.argwhere(wrong)[0])
            raise BadInputError(
                f"paths: {points[first]} at index {list(first)}; wanted finite numbers"
            )
    are_cells = points.dtype.kind != "f"
    points = np.take_along_axis(points, slot[..., None], axis=1)
    points = np.where((counts > 0)[:, None, None], points, 0)
    return Paths(points.astype(np.int32 if are_cells else np.float64), counts, are_cells)


def _counts(lengths: Any, rows: int, capacity: int) -> np.ndarray:
    wanted = f"int [{rows}], the points of each path, 0 to {capacity}"
    if lengths is None:
        return np.full(rows, capacity, np.int32)
    try:
        counts = np.asarray(lengths)
    except ValueError:
        raise BadInputError(f"lengths: rows of unequal length; wanted {wanted}") from None
    if counts.dtype.kind not in "iu":
        raise BadTypeError(f"lengths: got dtype {counts.dtype}; wanted {wanted}")
    if counts.shape != (rows,):
        raise BadInputError(f"lengths: got shape {counts.shape}; wanted {wanted}")
    wrong = (counts < 0) | (counts > capacity)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise BadInputError(f"lengths: got {counts[row]} in row {row}; wanted {wanted}")
    return counts.astype(np.int32)


def check_number(paths: Paths, frame: Frame) -> None:
    """Refuse maps and paths of unequal number."""
    if len(frame.blocked) not in (1, len(paths)):
        raise BadInputError(
            f"blocked: got {len(frame.blocked)} maps for {len(paths)} paths; wanted as many, or one"
        )


def check_on_map(paths: Paths, frame: Frame) -> None:
    """Refuse paths that leave the map.

    Raises:
      BadInputError: naming the first row and place; or maps and paths of unequal number.
    """
    check_number(paths, frame)
    shape = np.array(frame.blocked.shape[:0:-1])
    in_cells = frame.in_cells(paths)
    valid = np.arange(paths.points.shape[1]) < paths.counts[:, None]
    off = valid & ((in_cells < 0) | (in_cells > shape)).any(axis=-1)
    if off.any():
        row, i = (int(v) for v in np.argwhere(off)[0])
        raise BadInputError(
            f"paths: point {i} of row {row}, {_place(paths, row, i)}, lies outside the map of "
            f"{shape[0]} x {shape[1]} cells"
        )


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
                f"{_place(paths, rows[bad], points[bad])}, and the next; wanted a clear path"
                + ("" if corner_cutting else " (corner_cutting=True lets it touch corners)")
            )


def _place(paths: Paths, row: int, i: int) -> str:
    x, y = paths.points[row, i]
    return f"cell ({x}, {y})" if paths.are_cells else f"({x:g}, {y:g}) m"


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
    for part in _even_parts(starts, ends):
        clear[part] &= _columns_clear(starts[part], ends[part], layers[part], frame.blocked, slack)
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
    count = np.floor(end[:, 0] + slack).astype(int) - first + 1
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
