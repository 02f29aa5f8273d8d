"""Where fleets sail: open water, circles, or a map; what is clear there, and the ways round."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from usvjax.batches import filled
from usvjax.errors import saying_where
from usvjax.maps.grid_map import check_size
from usvjax.paths.smoothing import key_points
from usvjax.search.astar import astar
from usvkernels.dwa.clearance import FAR
from usvkernels.status import Status

AT_ONCE = 1 << 22
"""Numbers in one array of a check."""

MOST_CELLS = 1 << 24
"""Of the grids on which ways are searched at a time."""

BYTES = 20
"""Of memory that a cell of such a grid takes while distances to circles are measured."""


class Ground(Protocol):
    """Where fleets sail; rows are vessels, each of a fleet."""

    def clear(
        self, fleet: np.ndarray, start: np.ndarray, end: np.ndarray, reach: np.ndarray
    ) -> np.ndarray:
        """Whether segments keep their distance from everything; bool[R].

        Args:
            fleet: int[R].
            start, end: float64[R, 2] (m).
            reach: float64[R] (m).
        """
        ...

    def path(
        self, fleet: np.ndarray, start: np.ndarray, end: np.ndarray, reach: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Shortest ways, as corners.

        Args: as of `clear`.

        Returns:
            float64[R, P, 2] (m), the last repeated; int32[R], how many there are; bool[R], whether
            there is a way.
        """
        ...


class _Grids(NamedTuple):
    """On which ways are searched, one for each vessel.

    Their sizes are few, and each vessel's own: ties between ways of equal length hang on them, and
    no way is to depend on who else looks for one.
    """

    low: np.ndarray  # float64[R, 2], corners (m)
    cell: np.ndarray  # float64[R], sizes of their cells (m)
    sides: np.ndarray  # int[R, 2], columns and rows, powers of 2


@dataclass(frozen=True)
class Circles:
    """Round obstacles; without any, open water.

    Attributes:
        centres: float64[B or 1, K, 2] (m), FAR pads.
        cell_size: of the grid on which a way is searched (m); None: a quarter of the reach.
        coarsest: cell size at most, where it is None (m).
    """

    centres: np.ndarray
    cell_size: float | None
    coarsest: float = np.inf

    def clear(
        self, fleet: np.ndarray, start: np.ndarray, end: np.ndarray, reach: np.ndarray
    ) -> np.ndarray:
        """See `Ground`."""
        found = np.ones(len(fleet), bool)
        each = max(1, AT_ONCE // max(1, self.centres.shape[1]))
        for first in range(0, len(fleet), each):
            part = slice(first, first + each)
            least = _distance(start[part], end[part], self._of(fleet[part]))
            found[part] = np.all(least >= reach[part, None] * (1 - 1e-9), axis=1)
        return found

    def path(
        self, fleet: np.ndarray, start: np.ndarray, end: np.ndarray, reach: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """See `Ground`."""
        found = np.ones(len(fleet), bool)
        corners, counts = np.stack([start, end], axis=1), np.full(len(fleet), 2, np.int32)
        around = np.flatnonzero(~self.clear(fleet, start, end, reach))
        if not len(around):
            return corners, counts, found
        grids = self._grids_for(fleet[around], start[around], end[around], reach[around])
        for sides in np.unique(grids.sides, axis=0):
            same = np.flatnonzero(np.all(grids.sides == sides, axis=1))
            each = max(1, MOST_CELLS // int(sides.prod()))
            for first in range(0, len(same), each):
                own = _Grids(*(part[same[first : first + each]] for part in grids))
                rows = around[same[first : first + each]]
                blocked = self._blocked(fleet[rows], reach[rows], own)
                points, count, reached = _ways(blocked, own, start[rows], end[rows])
                corners = filled(corners, points.shape[1], axis=1)
                corners[rows, : points.shape[1]] = points
                counts[rows], found[rows] = count, reached
        return corners, counts, found

    def _of(self, fleet: np.ndarray) -> np.ndarray:
        return self.centres[fleet if len(self.centres) > 1 else np.zeros_like(fleet)]

    def _grids_for(
        self, fleet: np.ndarray, start: np.ndarray, end: np.ndarray, reach: np.ndarray
    ) -> _Grids:
        """Grids about vessels' passages and all circles."""
        cell = np.full(len(fleet), self.cell_size or 0.0)
        if self.cell_size is None:
            cell = np.minimum(self.coarsest, reach / 4)
        centres = self._of(fleet)
        there = np.all(np.abs(centres) < FAR / 2, axis=2)[..., None]
        room = (reach + 3 * cell)[:, None]
        ends = np.stack([start, end], axis=1)
        low = np.minimum(ends.min(axis=1), np.where(there, centres, np.inf).min(axis=1) - room)
        high = np.maximum(ends.max(axis=1), np.where(there, centres, -np.inf).max(axis=1) + room)
        low, high = low - 2 * cell[:, None], high + 2 * cell[:, None]
        sides = 2 ** np.ceil(np.log2((high - low) / cell[:, None])).astype(np.int64)
        largest = int(np.argmax(sides.prod(axis=1)))
        columns, rows = map(int, sides[largest])
        with saying_where(f"static.cell_size: of {cell[largest]:g} m"):
            check_size(rows, columns, "the grid of a route", each=BYTES)
        return _Grids(low, cell, sides)

    def _blocked(self, fleet: np.ndarray, reach: np.ndarray, grids: _Grids) -> np.ndarray:
        """Cells that are blocked, bool[R, H, W], of grids of one size."""
        centres, cell = self._of(fleet), grids.cell[:, None]
        columns, rows = grids.sides[0]
        # A cell is shut if any of it is too near: the way found is clear, whatever the cells.
        keep = reach + grids.cell * np.sqrt(0.5)
        blocked = np.zeros((len(fleet), rows, columns), bool)
        x = grids.low[:, :1] + cell * (np.arange(columns) + 0.5)
        y = grids.low[:, 1:] + cell * (np.arange(rows) + 0.5)
        for k in range(centres.shape[1]):
            east, north = x - centres[:, k, :1], y - centres[:, k, 1:]
            square = north[:, :, None] ** 2 + east[:, None, :] ** 2
            blocked |= square < keep[:, None, None] ** 2
        return blocked


def _ways(
    blocked: np.ndarray, grids: _Grids, start: np.ndarray, end: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `Ground.path`, on the cells bool[R, H, W] of grids."""
    first, last = (_cells(p, grids) for p in (start, end))
    # The cell of a vessel or a goal may be shut by what is only near.
    every = np.arange(len(blocked))
    for cell in (first, last):
        blocked[every, cell[:, 1], cell[:, 0]] = False
    ways = astar(blocked, first, last)
    reached = ways.status == int(Status.FOUND)
    keys = key_points(ways.path, np.where(reached, ways.path_cells, 0), blocked)
    count = np.where(reached, np.maximum(keys.path_cells, 2), 2)
    cells = filled(keys.path, int(count.max()), axis=1)[:, : count.max()]
    points = grids.low[:, None] + grids.cell[:, None, None] * (cells + 0.5)
    points[:, 0] = start
    at_end = np.arange(points.shape[1]) >= (count - 1)[:, None]
    return np.where(at_end[..., None], end[:, None], points), count, reached


def _cells(points: np.ndarray, grids: _Grids) -> np.ndarray:
    cells = np.floor((points - grids.low) / grids.cell[:, None]).astype(np.int64)
    return np.clip(cells, 0, grids.sides - 1)


def _distance(start: np.ndarray, end: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """From segments [R, 2] to points [R, K, 2]; m, [R, K]."""
    way = end - start
    square = np.maximum(np.sum(way * way, axis=1), 1e-300)[:, None]
    offset = centres - start[:, None]
    share = np.clip(np.einsum("rkd,rd->rk", offset, way) / square, 0.0, 1.0)
    nearest = offset - share[..., None] * way[:, None]
    return np.sqrt(np.sum(nearest * nearest, axis=2))
