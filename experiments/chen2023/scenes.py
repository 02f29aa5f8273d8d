"""Scenes of ours in place of the paper's: islands on 900 x 900 m of water, drawn from a seed.

The paper prints neither its map nor a cell size; its text gives the start and end points, the
safety range and the expansion coefficient of obstacles (Table 1), which are all used here.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from experiments.chen2023.published import ENDS, EXPANSION
from usvkernels.grids import expand_about_centre

SIDE = 910.0  # m: 900 m, and 5 m more on every side, since (347, -451) is an end point
ORIGIN = (-SIDE / 2, -SIDE / 2)  # m, the corner of cell (0, 0)
ISLAND_FIELD = 450.0  # m: centres of islands lie within +- this

CORNERS = 8
CLEAR = 20.0  # m, from every start and end to the expanded islands
SEED = 2023

_JITTER = 0.3  # of the angle between two corners
_AT_ONCE = 4096  # islands rasterised in one array


TURNS = ("any", "fewest")


@dataclass(frozen=True)
class Waters:
    """The `[waters]` table of a study: how scenes are drawn, and the grid that is searched.

    Attributes:
        islands: in every scene; 1 or more.
        least_axis: least semi-axis of the ellipses that islands are cut from; m, above 0.
        greatest_axis: greatest of them; m, at least `least_axis`.
        expansion: E of Eq. 4, that islands are searched with; 0 or more.
        cell: of the grid; m, a whole number of them makes 910 m.
        turns: which of the shortest paths A* takes, "any" or one of the "fewest" turns.
    """

    islands: int = 60
    least_axis: float = 8.0
    greatest_axis: float = 24.0
    expansion: float = EXPANSION
    cell: float = 5.0
    turns: str = "any"

    @property
    def cells(self) -> int:
        """On each side of the grid."""
        return round(SIDE / self.cell)

    @property
    def words(self) -> str:
        """How islands are drawn, for tables."""
        axes = f"{self.least_axis:g} to {self.greatest_axis:g} m"
        return f"{self.islands} islands, semi-axes {axes}"


@dataclass(frozen=True)
class Scenes:
    """Islands of n scenes, K each.

    Attributes:
        centres: float64[n, K, 2], m.
        corners: float64[n, K, CORNERS, 2], of convex polygons, counter-clockwise, m.
    """

    centres: np.ndarray
    corners: np.ndarray

    def __len__(self) -> int:
        return len(self.centres)

    def expanded(self, expansion: float) -> np.ndarray:
        """Corners after Eq. 4, float64[n, K, CORNERS, 2], m."""
        wider = expand_about_centre(self.corners - self.centres[:, :, None], np.zeros(2), expansion)
        return self.centres[:, :, None] + np.asarray(wider, np.float64)

    def blocked(self, expansion: float, cell: float) -> np.ndarray:
        """Cells that touch an island scaled by 1 + E, bool[n, C, C]."""
        corners = self.expanded(expansion)
        cells = round(SIDE / cell)
        grids = np.zeros((len(self), cells, cells), bool)
        scene = np.repeat(np.arange(len(self)), corners.shape[1])
        flat = corners.reshape(-1, CORNERS, 2)
        for part in range(0, len(flat), _AT_ONCE):
            _stamp(grids, cell, scene[part : part + _AT_ONCE], flat[part : part + _AT_ONCE])
        return grids

    def inside(self, expansion: float, scene: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Which points lie in an island scaled by 1 + E.

        Args:
            expansion: E.
            scene: int[m], of each point.
            points: float64[m, 2], m.

        Returns:
            bool[m].
        """
        corners = self.expanded(expansion)
        reach = np.linalg.norm(corners - self.centres[:, :, None], axis=-1).max(axis=-1)
        found = np.zeros(len(points), bool)
        for part in range(0, len(points), _AT_ONCE):
            where, at = scene[part : part + _AT_ONCE], points[part : part + _AT_ONCE]
            gap = np.linalg.norm(at[:, None] - self.centres[where], axis=-1)
            point, island = np.nonzero(gap <= reach[where])
            corner = corners[where[point], island]
            edge, to = np.roll(corner, -1, axis=1) - corner, at[point, None] - corner
            port = edge[..., 0] * to[..., 1] - edge[..., 1] * to[..., 0]
            found[part + point[(port >= 0).all(axis=1)]] = True
        return found


def draw_scenes(numbers: Sequence[int], waters: Waters, seed: int = SEED) -> Scenes:
    """Draw scenes; scene j depends on the seed, j, and the waters' islands and axes alone.

    Args:
        numbers: which of the sequence, each 0 or more.
        waters: what they are like.
        seed: of the sequence.
    """
    drawn = [_islands(np.random.default_rng([seed, int(j)]), waters) for j in numbers]
    centres, corners = (np.stack(parts) for parts in zip(*drawn, strict=True))
    return Scenes(centres, corners)


def _islands(rng: np.random.Generator, waters: Waters) -> tuple[np.ndarray, np.ndarray]:
    """Centres and corners of the first islands drawn that leave all starts and ends free."""
    wanted = waters.islands
    centres, corners = np.zeros((0, 2)), np.zeros((0, CORNERS, 2))
    while len(centres) < wanted:
        middle = rng.uniform(-ISLAND_FIELD, ISLAND_FIELD, (wanted, 2))
        shape = _shapes(rng, wanted, (waters.least_axis, waters.greatest_axis))
        radius = (1.0 + EXPANSION) * np.linalg.norm(shape, axis=-1).max(axis=1)
        gap = np.linalg.norm(middle[:, None] - _all_ends(), axis=-1).min(axis=1)
        free = gap > radius + CLEAR
        centres = np.concatenate([centres, middle[free]])
        corners = np.concatenate([corners, (middle[:, None] + shape)[free]])
    return centres[:wanted], corners[:wanted]


def _shapes(rng: np.random.Generator, count: int, axes: tuple[float, float]) -> np.ndarray:
    """Convex polygons about (0, 0), float64[count, CORNERS, 2]: corners on turned ellipses."""
    half = rng.uniform(*axes, (count, 2))
    course = rng.uniform(0.0, np.pi, count)[:, None]
    jitter = rng.uniform(-_JITTER, _JITTER, (count, CORNERS))
    angle = (np.arange(CORNERS) + jitter) * (2 * np.pi / CORNERS)
    along, across = half[:, :1] * np.cos(angle), half[:, 1:] * np.sin(angle)
    cos, sin = np.cos(course), np.sin(course)
    return np.stack([along * cos - across * sin, along * sin + across * cos], axis=-1)


def _all_ends() -> np.ndarray:
    return np.array([point for pair in ENDS for point in pair])


def _stamp(grids: np.ndarray, cell: float, scene: np.ndarray, corners: np.ndarray) -> None:
    """Block the cells, of this size, that touch convex polygons, float64[m, CORNERS, 2].

    Two convex shapes are apart if and only if they are apart along the normal of an edge: here
    along x, y, or the normal of one of the polygon's edges.
    """
    low = np.floor((corners.min(axis=1) - ORIGIN) / cell).astype(int)
    high = np.floor((corners.max(axis=1) - ORIGIN) / cell).astype(int)
    size = int((high - low).max()) + 1
    x, y = (low[:, axis, None] + np.arange(size) for axis in range(2))
    edge = np.roll(corners, -1, axis=1) - corners
    normal = np.stack([edge[..., 1], -edge[..., 0]], axis=-1)  # outwards
    half = 0.5 * cell * np.abs(normal).sum(axis=-1)
    limit = half + (normal * corners).sum(axis=-1)
    centre_x, centre_y = (ORIGIN[axis] + cell * (v + 0.5) for axis, v in ((0, x), (1, y)))
    touched = (y <= high[:, 1:])[:, :, None] & (x <= high[:, :1])[:, None, :]
    for k in range(CORNERS):
        outwards = (
            normal[:, k, 1, None, None] * centre_y[:, :, None]
            + normal[:, k, 0, None, None] * centre_x[:, None, :]
        )
        touched &= outwards <= limit[:, k, None, None]
    cells = grids.shape[1]
    on_map = ((y >= 0) & (y < cells))[:, :, None] & ((x >= 0) & (x < cells))[:, None, :]
    which, row, column = np.nonzero(touched & on_map)
    grids[scene[which], y[which, row], x[which, column]] = True


def to_cells(points: np.ndarray, cell: float) -> np.ndarray:
    """Cells of points, int32[..., 2]."""
    return np.floor((np.asarray(points) - ORIGIN) / cell).astype(np.int32)


def to_points(cells: np.ndarray, cell: float) -> np.ndarray:
    """Centres of cells, float64[..., 2], m."""
    return np.asarray(ORIGIN) + cell * (np.asarray(cells) + 0.5)


def on_blocked(grids: np.ndarray, cell: float, which: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Which places lie on blocked cells; off the map there is water.

    Args:
        grids: bool[n, C, C].
        cell: m, of their cells.
        which: int[B], the grid of each row.
        places: float64[B, T, 2], m.

    Returns:
        bool[B, T].
    """
    cells, side = to_cells(places, cell), grids.shape[1]
    inside = ((cells >= 0) & (cells < side)).all(axis=-1)
    x, y = np.moveaxis(np.clip(cells, 0, side - 1), -1, 0)
    touched: np.ndarray = grids[which[:, None], y, x] & inside
    return touched
