"""The scene that `navigate` is given, as routes see it and as vessels sense it."""

from dataclasses import dataclass, replace
from math import hypot, sqrt
from typing import Any

import numpy as np

from usvjax.checks import any_array, float_array
from usvjax.errors import BadInputError, saying_where
from usvjax.maps import GridMap
from usvjax.maps.grid_map import check_size
from usvjax.maps.sensed import charted, padded
from usvjax.missions.fleet.chart import Chart
from usvjax.missions.fleet.ground import Circles, Ground
from usvjax.missions.fleet.params import MOST_SPEED, FleetParams, FleetStatic
from usvjax.paths.inputs import scale
from usvkernels import grids
from usvkernels.dwa.charted import Charted
from usvkernels.dwa.clearance import FAR

MOST_SHORE = 4096
"""Blocked cells on the shoreline of a map of one's own, for each fleet."""

CELL_BYTES, OWN_BYTES = 32, 12
"""Of memory that a cell takes while its distance to shore is measured, and while it is kept."""


@dataclass(frozen=True)
class Place:
    """Where fleets sail.

    Attributes:
        ground: for routes.
        at_start: for what may touch nothing when an episode begins.
        reach: float64[B, n], distance from an obstacle's centre that is contact (m).
        obstacle_radius: of the circles (m), in this scene; float64[B or 1, n] or one number.
        origin: float64[2] (m), subtracted from the world's coordinates.
        obstacles: float32[B or 1, 2, K], centres (m), FAR pads; None on a shared map.
        chart: the shared map; None among circles.
        velocities: float32[B or 1, 2, K], of obstacles (m/s); None where all are at rest.
    """

    ground: Ground
    at_start: Ground
    reach: np.ndarray
    obstacle_radius: Any
    origin: np.ndarray
    obstacles: np.ndarray | None
    chart: Charted | None
    velocities: np.ndarray | None = None


def place(
    scene: Any,
    velocities: Any,
    fleets: int,
    hull: np.ndarray,
    params: FleetParams,
    static: FleetStatic,
) -> Place:
    """Check a scene; see `navigate`.

    Args:
        scene, velocities: as given.
        fleets: B.
        hull: float64[B, n], radii (m).
        params, static: of the fleets.
    """
    nowhere = np.zeros(2)
    if scene is None or isinstance(scene, GridMap):
        _refuse_velocities(velocities)
    if isinstance(scene, GridMap):
        return _on_map(scene, hull, params, static)
    if scene is None:
        centres = np.full((1, 1, 2), FAR)
        reach = hull + np.asarray(params.obstacle_radius, np.float64)
        ground = Circles(centres, static.unit_length)
        return Place(ground, ground, reach, params.obstacle_radius, nowhere, padded(centres), None)
    array = any_array("scene", scene, "circles, or a map")
    if array.dtype == bool:
        _refuse_velocities(velocities)
        if array.ndim == 2:
            return _on_map(GridMap(array), hull, params, static)
        return _on_own_maps(array, fleets, hull)
    return _among_circles(array, velocities, fleets, hull, params, static)


def _refuse_velocities(velocities: Any) -> None:
    if velocities is not None:
        raise BadInputError("velocities: got some; only circles move, and the scene has none")


def _among_circles(
    array: np.ndarray,
    velocities: Any,
    fleets: int,
    hull: np.ndarray,
    params: FleetParams,
    static: FleetStatic,
) -> Place:
    shared = array.ndim == 2
    centres = float_array("scene", array, (None, 2) if shared else (fleets, None, 2))
    # What is farther than FAR is as far.
    centres = np.clip(centres[None] if shared else centres, -FAR, FAR)
    reach = hull + np.asarray(params.obstacle_radius, np.float64)
    if static.cell_size is None and not np.min(reach) > 0:
        raise BadInputError("params.obstacle_radius: got 0 with hulls of 0 m; wanted more than 0")
    everything = Circles(centres, static.cell_size, static.unit_length)
    still = Place(
        everything, everything, reach, params.obstacle_radius, np.zeros(2), padded(centres), None
    )
    if velocities is None:
        return still
    moves = _velocities(velocities, fleets, centres.shape[1])
    # A route keeps clear of what stays where it is; what moves is met on the way.
    ground = replace(everything, centres=np.where(moves.any(axis=2, keepdims=True), FAR, centres))
    packed = np.zeros((len(moves), *padded(centres).shape[1:]), np.float32)
    packed[:, :, : moves.shape[1]] = moves.swapaxes(1, 2)
    return replace(still, ground=ground, velocities=packed)


def _velocities(velocities: Any, fleets: int, count: int) -> np.ndarray:
    """Float64[B or 1, K, 2] (m/s)."""
    array = any_array("velocities", velocities, f"float[{count}, 2]")
    each = (1 if array.shape[:1] == (1,) else fleets,) if array.ndim == 3 else ()
    moves = float_array("velocities", array, (*each, count, 2), MOST_SPEED)
    return moves.reshape(-1, count, 2)


def _on_map(grid: GridMap, hull: np.ndarray, params: FleetParams, static: FleetStatic) -> Place:
    with saying_where("scene"):
        scale(grid.cell_size, grid.origin)
    check_size(*grid.shape, "scene: a map", each=CELL_BYTES)
    covers = grid.cell_size * sqrt(0.5)
    reach = hull + covers
    across = grid.cell_size * hypot(*grid.shape)
    chart = charted(grid, min(_sight(reach, params, static), across))
    ground = Chart(np.asarray(grid.blocked)[None], grid.cell_size)
    return Place(ground, ground, reach, covers, np.asarray(grid.origin, np.float64), None, chart)


def _on_own_maps(array: np.ndarray, fleets: int, hull: np.ndarray) -> Place:
    if array.ndim != 3 or len(array) not in (1, fleets) or not array.size:
        raise BadInputError(
            f"scene: got bool{list(array.shape)}; wanted [H, W] or [{fleets}, H, W]"
        )
    maps, height, width = array.shape
    check_size(height, width, "scene: a map", each=CELL_BYTES + maps * OWN_BYTES)
    cells: Any = array
    shore = np.asarray(grids.shoreline(cells))
    most = int(shore.sum(axis=(1, 2)).max())
    if most > MOST_SHORE:
        raise BadInputError(
            f"scene: a map has {most:,} blocked cells on its shoreline; wanted at most "
            f"{MOST_SHORE:,} where each fleet has a map of its own"
        )
    centres = np.full((len(array), max(most, 1), 2), FAR)
    for row, y, x, k in zip(*np.nonzero(shore), _counted(shore), strict=True):
        centres[row, k] = x + 0.5, y + 0.5
    covers = sqrt(0.5)
    ground = Chart(array, 1.0)
    return Place(ground, ground, hull + covers, covers, np.zeros(2), padded(centres), None)


def _counted(shore: np.ndarray) -> np.ndarray:
    """Number of each shoreline cell among those of its map, in the order of `nonzero`."""
    counts = shore.sum(axis=(1, 2))
    return np.concatenate([np.arange(n) for n in counts]) if counts.sum() else np.zeros(0, int)


def _sight(reach: np.ndarray, params: FleetParams, static: FleetStatic) -> float:
    """How far off shore can matter to a vessel (m): turning, stopping, contact."""
    fastest = np.asarray(params.v_max, np.float64)
    turning = fastest * np.asarray(params.dt) * (static.horizon + 1)
    stopping = fastest**2 / (2.0 * np.asarray(params.v_dec))
    return float(np.max(turning + stopping) + np.max(reach))
