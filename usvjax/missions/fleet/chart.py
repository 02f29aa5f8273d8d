"""Maps as the ground of fleets: what is clear there for a hull of some size, and the ways round."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from usvjax.maps import GridMap
from usvjax.paths.inputs import Frame
from usvjax.paths.smoothing import key_points
from usvjax.paths.water import segments_clear
from usvjax.search.astar import astar
from usvkernels.status import Status

MOST_CELLS = 1 << 26
"""Of the maps of some vessels at a time, where each has its own."""


@dataclass(frozen=True)
class Chart:
    """Maps, in the frame of their corner; off the map nothing is clear.

    Attributes:
        blocked: bool[B or 1, H, W].
        cell_size: m.
    """

    blocked: np.ndarray
    cell_size: float

    def clear(
        self, fleet: np.ndarray, start: np.ndarray, end: np.ndarray, reach: np.ndarray
    ) -> np.ndarray:
        """See `Ground`."""
        found = np.zeros(len(fleet), bool)
        for rows, shut in self._shut(fleet, reach):
            frame = Frame(shut, self.cell_size, np.zeros(2))
            ends = (start[rows] / self.cell_size, end[rows] / self.cell_size)
            # A vessel may lie nearer to the shore than a route does: cells count as open squares.
            found[rows] = segments_clear(*ends, np.arange(len(rows)), frame, True)
        return found

    def path(
        self, fleet: np.ndarray, start: np.ndarray, end: np.ndarray, reach: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """See `Ground`."""
        parts = []
        for rows, shut in self._shut(fleet, reach):
            first, last = (self._cells(p[rows], shut.shape) for p in (start, end))
            ways = astar(shut if len(shut) > 1 else shut[0], first, last, on_blocked="status")
            found = ways.status == int(Status.FOUND)
            counts = np.where(found, ways.path_cells, 0)
            keys = key_points(ways.path, counts, shut if len(shut) > 1 else shut[0])
            parts.append((rows, keys.path, np.maximum(keys.path_cells, 2), found))
        size = max(2, max(int(counts.max()) for _, _, counts, _ in parts))
        corners = np.repeat(end[:, None], size, axis=1)
        count, reached = np.full(len(fleet), 2, np.int32), np.zeros(len(fleet), bool)
        for rows, cells, counts, found in parts:
            points = self.cell_size * (cells[:, :size] + 0.5)
            inner = np.arange(points.shape[1]) < (counts - 1)[:, None]
            width = points.shape[1]
            corners[rows, :width] = np.where(inner[..., None], points, end[rows, None])
            count[rows], reached[rows] = counts, found
        corners[:, 0] = start
        return corners, count, reached

    def _cells(self, points: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
        cells = np.floor(points / self.cell_size).astype(np.int64)
        return np.clip(cells, 0, np.array(shape[:0:-1]) - 1)

    def _shut(
        self, fleet: np.ndarray, reach: np.ndarray
    ) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Rows, and the cells whose centre is nearer to a blocked one's than their vessels may be.

        One map for all rows where they have map and hull in common, else one each.
        """
        layer = np.zeros_like(fleet) if len(self.blocked) == 1 else fleet
        if len(np.unique(layer)) == len(np.unique(reach)) == 1:
            yield np.arange(len(fleet)), (self._distance[layer[0]] < reach[0])[None]
            return
        each = max(1, MOST_CELLS // self.blocked[0].size)
        for first in range(0, len(fleet), each):
            rows = np.arange(first, min(first + each, len(fleet)))
            yield rows, np.stack([self._distance[layer[row]] < reach[row] for row in rows])

    @cached_property
    def _distance(self) -> np.ndarray:
        """From each cell's centre to the nearest of a blocked one, float64[B or 1, H, W] (m)."""
        return np.stack([GridMap(cells, self.cell_size).clearance() for cells in self.blocked])
