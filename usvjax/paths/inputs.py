"""Checks that everything done to paths shares, and their form on the host."""

from dataclasses import dataclass
from typing import Any

import jax
import numpy as np

from usvjax.batches import SIZES, bucket, filled, most_rows
from usvjax.checks import any_array, pair, positive, shown
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap
from usvjax.search.inputs import search_maps
from usvkernels.paths.charts import Charts

_PATHS = "int [B, P, 2] (cells) or float [B, P, 2] (m), padded to one length"
MOST_COORDINATE = 10**9
"""Of points and origins, m or cells: beyond it, double precision is coarser than paths are."""

_CELL_SIZES = (1e-6, 1e6)  # m; sums of squares of points stay within single precision
_MOST_CELLS = 1 << 26  # of maps on a device at a time, if there are that many paths
_LEAST_CELLS = 1 << 16  # of the maps in one call: few sizes to compile
EDGE = 1e-3
"""Cells by which a sample of a path along the map's edge may lie beyond it, through rounding."""


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
            return SIZES[-1]
        return most_rows(self.blocked[0].size, _MOST_CELLS)

    def charts(self, rows: np.ndarray, device: jax.Device) -> Charts:
        """The maps of some rows, for the kernels, on a device."""
        which, maps = np.unique(self.layers(rows), return_inverse=True)
        cells = self.blocked[which].reshape(-1)
        padded = np.ones(bucket(max(cells.size, _LEAST_CELLS), 4), bool)
        padded[: cells.size] = cells
        height, width = self.blocked.shape[1:]
        arrays = {
            "cells": padded,
            "first": (maps * (height * width)).astype(np.int32),
            "height": np.int32(height),
            "width": np.int32(width),
        }
        return Charts(**jax.device_put(arrays, device))

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
                raise BadInputError(f"{name}: got {shown(value)} with a GridMap, which has its own")
        cell_size, origin = blocked.cell_size, blocked.origin
    size, corner = scale(cell_size, origin)
    return Frame(search_maps(blocked), size, corner)


def scale(cell_size: float | None, origin: Any) -> tuple[float, np.ndarray]:
    """Cell size (m; default 1) and origin (default (0, 0)), checked."""
    size = positive("cell_size", 1.0 if cell_size is None else cell_size)
    if not _CELL_SIZES[0] <= size <= _CELL_SIZES[1]:
        least, most = _CELL_SIZES
        raise BadInputError(f"cell_size: got {size:g} m; wanted {least:g} to {most:g} m")
    corner = pair("origin", (0.0, 0.0) if origin is None else origin)
    if max(abs(v) for v in corner) > MOST_COORDINATE:
        raise BadInputError(
            f"origin: got {shown(origin)}; wanted coordinates of at most {MOST_COORDINATE:,} m"
        )
    return size, np.array(corner, np.float64)


def path_rows(paths: Any, lengths: Any, cells_only: bool = False) -> Paths:
    """Check paths and their lengths.

    Args:
        paths: int[B, P, 2], cells (x, y), or float[B, P, 2], m.
        lengths: int[B], points of each path, 0 where there is none; None: all P.
        cells_only: refuse metres.

    Raises:
        BadTypeError: not numbers of the right kind.
        BadInputError: ragged, of another shape, NaN, infinite or beyond MOST_COORDINATE before the
            end of a path, or a length outside 0 .. P.
    """
    wanted = "int [B, P, 2] (cells), padded to one length" if cells_only else _PATHS
    points = any_array("paths", paths, wanted)
    if points.dtype.kind not in ("iu" if cells_only else "iuf"):
        raise BadTypeError(f"paths: got dtype {points.dtype}; wanted {wanted}")
    if points.dtype == np.float16:
        points = points.astype(np.float64)
    if points.ndim != 3 or points.shape[2] != 2 or not points.size:
        raise BadInputError(f"paths: got shape {points.shape}; wanted {wanted}")
    counts = _counts(lengths, *points.shape[:2])
    points = filled(points, 2, axis=1)  # of searches that found nothing, or were there already
    slot = np.minimum(np.arange(points.shape[1]), np.maximum(counts - 1, 0)[:, None])
    valid = np.arange(points.shape[1]) < counts[:, None]
    if points.dtype.kind == "f":
        wrong = valid[..., None] & ~np.isfinite(points)
        if wrong.any():
            first = tuple(int(i) for i in np.argwhere(wrong)[0])
            raise BadInputError(
                f"paths: {points[first]} at index {list(first)}; wanted finite numbers"
            )
    _check_size(points, valid)
    are_cells = points.dtype.kind != "f"
    points = np.take_along_axis(points, slot[..., None], axis=1)
    points = np.where((counts > 0)[:, None, None], points, 0)
    return Paths(points.astype(np.int32 if are_cells else np.float64), counts, are_cells)


def _check_size(points: np.ndarray, valid: np.ndarray) -> None:
    """Refuse points of paths too far away for the numbers they are computed in."""
    far = valid & ((points > MOST_COORDINATE) | (points < -MOST_COORDINATE)).any(axis=-1)
    if far.any():
        row, i = (int(v) for v in np.argwhere(far)[0])
        x, y = points[row, i].tolist()
        raise BadInputError(
            f"paths: point {i} of row {row} is ({x:g}, {y:g}); wanted coordinates between "
            f"-{MOST_COORDINATE:,} and {MOST_COORDINATE:,}"
        )


def _counts(lengths: Any, rows: int, capacity: int) -> np.ndarray:
    wanted = f"int [{rows}], the points of each path, 0 to {capacity}"
    if lengths is None:
        return np.full(rows, capacity, np.int32)
    counts = any_array("lengths", lengths, wanted)
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


def check_on_map(paths: Paths, frame: Frame, slack: float = 0.0) -> None:
    """Refuse paths that leave the map.

    Args:
        paths, frame: the paths and their maps.
        slack: cells, how far a point may be off, for what single precision did to a sample.

    Raises:
        BadInputError: naming the first row and place; or maps and paths of unequal number.
    """
    check_number(paths, frame)
    shape = np.array(frame.blocked.shape[:0:-1])
    in_cells = frame.in_cells(paths)
    valid = np.arange(paths.points.shape[1]) < paths.counts[:, None]
    off = valid & ((in_cells < -slack) | (in_cells > shape + slack)).any(axis=-1)
    if off.any():
        row, i = (int(v) for v in np.argwhere(off)[0])
        raise BadInputError(
            f"paths: point {i} of row {row}, {place_of(paths, row, i)}, lies outside the map of "
            f"{shape[0]} x {shape[1]} cells"
        )


def place_of(paths: Paths, row: int, i: int) -> str:
    """A point of a path, for messages."""
    x, y = paths.points[row, i]
    return f"cell ({x}, {y})" if paths.are_cells else f"({x:g}, {y:g}) m"
