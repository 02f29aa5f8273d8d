"""What is done to the paths of a search: pulled straight, key points, arcs, a B-spline."""

from dataclasses import dataclass

import numpy as np

from usvjax.batches import bucket
from usvjax.paths.smoothing import bspline, key_points, shorten
from usvjax.paths.turns import smooth_turns
from usvkernels.paths.turning import Turn

# Rounding of single precision must not make a curvature exceed 1 / R.
_ROUNDING = 1e-3

# Points of a B-spline for every cell of its path, at least.
_SPLINE_SAMPLES = 4


@dataclass(frozen=True)
class Sailing:
    """What a path is sailed on and with.

    Attributes:
        blocked: bool[H, W] shared or bool[J, H, W], what routes keep off.
        cell_size: m.
        origin: (x, y) of the south-west corner, m.
        corner_cutting: whether paths may touch corners of blocked cells.
        turning_radius: R, m.
        safety_range: R_s, m, or None.
        repair: rounds of moving corners that cannot be sailed.
    """

    blocked: np.ndarray
    cell_size: float
    origin: tuple[float, float]
    corner_cutting: bool
    turning_radius: float
    safety_range: float | None
    repair: int

    def metres(self, cells: np.ndarray) -> np.ndarray:
        """Centres of cells int[..., 2], float64[..., 2], m."""
        return np.asarray(self.origin) + self.cell_size * (cells + 0.5)


@dataclass(frozen=True)
class Line:
    """Finished paths; numpy arrays.

    Attributes:
        points: float64[J, P, 2], m, the last repeated; along arcs and splines samples.
        counts: int32[J], points of each path, 0 where there was none.
        curvature: float32[J, P], 1/m, along arcs and splines; None of paths with corners.
        corners: int32[J], corners, rounded or not.
        sharp: int32[J], how many of them a vessel cannot sail.
        length: float64[J], m.
        turning: float64[J], changes of course added up, rad.
        left: float64[J, L, 2], m, corners that stayed where others were rounded, nan as padding;
            None where none is to be.
    """

    points: np.ndarray
    counts: np.ndarray
    curvature: np.ndarray | None
    corners: np.ndarray
    sharp: np.ndarray
    length: np.ndarray
    turning: np.ndarray
    left: np.ndarray | None = None


def as_it_is(cells: np.ndarray, counts: np.ndarray, sailing: Sailing) -> Line:
    """The path through the centres of its cells, int32[J, P, 2]; every corner is sharp."""
    corners = count_corners(cells, counts)
    points = sailing.metres(cells)
    return Line(points, counts, None, corners, corners, *length_and_turning(points, counts))


def pulled_straight(cells: np.ndarray, counts: np.ndarray, sailing: Sailing) -> Line:
    """As `usvjax.shorten`."""
    found = shorten(cells, counts, sailing.blocked, corner_cutting=sailing.corner_cutting)
    return as_it_is(found.path, found.path_cells, sailing)


def through_key_points(cells: np.ndarray, counts: np.ndarray, sailing: Sailing) -> Line:
    """As `usvjax.key_points`."""
    found = key_points(cells, counts, sailing.blocked, corner_cutting=sailing.corner_cutting)
    return as_it_is(found.path, found.path_cells, sailing)


def with_arcs(cells: np.ndarray, counts: np.ndarray, sailing: Sailing) -> Line:
    """As `usvjax.smooth_turns` of the path pulled straight."""
    short = shorten(cells, counts, sailing.blocked, corner_cutting=sailing.corner_cutting)
    found = smooth_turns(
        short.path,
        short.path_cells,
        sailing.blocked,
        turning_radius=sailing.turning_radius,
        safety_range=sailing.safety_range,
        cell_size=sailing.cell_size,
        origin=sailing.origin,
        corner_cutting=sailing.corner_cutting,
        repair=sailing.repair,
        spacing=min(sailing.turning_radius / 5, sailing.cell_size / 2),
    )
    corners = (found.turns != Turn.NONE).sum(axis=1, dtype=np.int32)
    unfitted = found.turns == Turn.UNFITTED
    sharp = unfitted.sum(axis=1, dtype=np.int32)
    return Line(
        points=found.points,
        counts=found.counts,
        curvature=found.curvature,
        corners=corners,
        sharp=sharp,
        length=found.length.astype(np.float64),
        turning=found.turning.astype(np.float64),
        left=np.where(unfitted[..., None], found.corners, np.nan),
    )


def as_spline(cells: np.ndarray, counts: np.ndarray, sailing: Sailing) -> Line:
    """As `usvjax.bspline`, with the cells of the path as control points."""
    drawn = np.where(counts > 1, np.array([bucket(_SPLINE_SAMPLES * n) for n in counts]), counts)
    width = max(int(drawn.max(initial=0)), 2)
    points = np.zeros((len(cells), width, 2))
    curvature = np.zeros((len(cells), width), np.float32)
    points[:] = sailing.metres(cells[:, :1])
    # The number of samples decides the result, so it may depend on a path's own length only.
    for samples in np.unique(drawn[counts > 1]):
        rows = np.flatnonzero(drawn == samples)
        spline = bspline(
            cells[rows],
            counts[rows],
            samples=int(samples),
            cell_size=sailing.cell_size,
            origin=sailing.origin,
        )
        points[rows, :samples], points[rows, samples:] = spline.points, spline.points[:, -1:]
        curvature[rows, :samples] = spline.curvature
    tight = np.abs(curvature) * sailing.turning_radius > 1.0 + _ROUNDING
    begins = tight & ~np.pad(tight, ((0, 0), (1, 0)))[:, :-1]
    drawn = drawn.astype(np.int32)
    return Line(
        points,
        drawn,
        curvature,
        count_corners(cells, counts),
        begins.sum(axis=1, dtype=np.int32),
        *length_and_turning(points, drawn),
    )


def count_corners(cells: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Points of paths int32[J, P, 2] where the course changes, int32[J]."""
    step: np.ndarray = np.diff(cells.astype(np.int64), axis=1)
    before, after = step[:, :-1], step[:, 1:]
    across = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    turns = (across != 0) | ((before * after).sum(axis=-1) < 0)
    inside = np.arange(1, cells.shape[1] - 1) < counts[:, None] - 1
    return (turns & inside).sum(axis=1, dtype=np.int32)


def length_and_turning(points: np.ndarray, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lengths (m) and turning angles (rad) of lines float64[J, P, 2], float64[J] each.

    Added up along the line, so that padding cannot change the rounding.
    """
    step: np.ndarray = np.diff(points, axis=1)
    step[np.arange(1, points.shape[1]) >= counts[:, None]] = 0.0
    length = np.hypot(step[..., 0], step[..., 1])
    before, after = step[:, :-1], step[:, 1:]
    across = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    turn = np.abs(np.arctan2(across, (before * after).sum(axis=-1)))
    zero = np.zeros((len(points), 1))
    total, turned = (np.cumsum(np.hstack([zero, a]), axis=1)[:, -1] for a in (length, turn))
    return total, turned


FINISHES = {
    None: as_it_is,
    "shorten": pulled_straight,
    "key_points": through_key_points,
    "arcs": with_arcs,
    "bspline": as_spline,
}
"""By `RouteMethod.finish`."""
