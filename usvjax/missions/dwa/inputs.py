"""The scenes of episodes, checked: circles per episode, or a map shared by all."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import hypot, sqrt
from typing import Any

import numpy as np

from usvjax.angles import wrapped
from usvjax.checks import any_array, float_array, positive
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap
from usvjax.maps.sensed import MOST_REMOTE, charted, padded
from usvjax.missions.dwa.params import DwaParams, DwaStatic, check_dwa
from usvkernels.dwa.charted import Charted
from usvkernels.dwa.clearance import FAR
from usvkernels.dwa.episodes import Jobs

ROWS_AT_ONCE = 1024  # of a check over all rows and obstacles, so that its arrays stay in the cache

TINY = 1e-30
"""Keeps a quotient finite whose divisor is 0."""


@dataclass(frozen=True)
class PackedEpisodes:
    """Checked episodes on the host, in the frame of the map's corner.

    Attributes:
        start: float64[B, 3], x (m), y (m), psi (rad).
        goal: float64[B, 2] (m).
        origin: float64[2] (m), what was subtracted from the world's coordinates.
        obstacles: float32[B or 1, 2, K], centres (m), FAR pads; None on a chart.
        chart: the shared map; None among circles.
    """

    start: np.ndarray
    goal: np.ndarray
    origin: np.ndarray
    obstacles: np.ndarray | None
    chart: Charted | None

    def rows(self, rows: np.ndarray) -> Jobs:
        """The episodes of the given rows, in single precision."""
        obstacles = self.obstacles
        if obstacles is not None:
            obstacles = obstacles[rows] if len(obstacles) > 1 else obstacles[np.zeros_like(rows)]
        return Jobs(
            start=self.start[rows].astype(np.float32),
            goal=self.goal[rows].astype(np.float32),
            obstacles=obstacles,
            chart=self.chart,
        )

    def sensed(self, points: np.ndarray) -> np.ndarray:
        """Centres [B, 2, K] (m, FAR pads) that vessels at points [B, 2] (m) sense."""
        chart = self.chart
        if chart is None:
            assert self.obstacles is not None
            return self.obstacles
        last = np.array([chart.width, len(chart.table) // chart.width]) - 1
        cell = np.clip(np.floor(points / chart.cell_size).astype(np.int64), 0, last)
        blocked = chart.table[cell[:, 1] * chart.width + cell[:, 0]]
        row, column = np.divmod(blocked, chart.width)
        centres = (np.stack([column, row], axis=1) + 0.5) * chart.cell_size
        return np.where(blocked[:, None] < 0, FAR, centres)

    @property
    def sensed_shape(self) -> tuple[int, ...]:
        """Of what one episode senses, or of the chart's table."""
        if self.obstacles is not None:
            return self.obstacles.shape[1:]
        return np.shape(self.chart.table) if self.chart is not None else ()

    def expected_steps(self, params: DwaParams) -> np.ndarray:
        """Guess how many steps each episode takes, float[B]: enough to tell long from short.

        That is the straight course at full speed, up to twice as long for an obstacle on it. Rank
        correlation with the steps taken: 0.9 and more on Hongze Lake, where distances differ (a
        study of 2,000 takes 1 to 6 % less); 0.8 on a lattice of 5 m; none on Tan's maps, where it
        matters who gets stuck.
        """
        course = self.goal - self.start[:, :2]
        length = np.hypot(course[:, 0], course[:, 1])
        radius = np.asarray(params.radius)
        detour = radius / np.maximum(radius + self._off_course(course, length), TINY)
        return (1.0 + detour) * length / np.maximum(params.top_speed * params.dt, TINY)

    def _off_course(self, course: np.ndarray, length: np.ndarray) -> np.ndarray | float:
        """Distance (m) from each straight course to the nearest centre beside it, inf if none."""
        if self.obstacles is None:
            return np.inf
        ahead = (course / np.maximum(length, TINY)[:, None]).astype(np.float32)
        start, length = self.start.astype(np.float32), length.astype(np.float32)
        nearest = np.empty(len(length), np.float32)
        for rows, east, north in _offsets(self.obstacles, start):
            x, y = ahead[rows, 0, None], ahead[rows, 1, None]
            along, across = east * x + north * y, np.abs(east * y - north * x)
            across[(along <= 0.0) | (along >= length[rows, None])] = np.inf
            nearest[rows] = across.min(axis=1)
        return nearest


def pack_episodes(
    obstacles: Any,
    starts: Any,
    goals: Any,
    valid: Any,
    params: DwaParams,
    static: DwaStatic,
    sensing_range: float | None,
) -> PackedEpisodes:
    """Check and pack the episodes of `navigate_dwa`, whose docstring says what is what."""
    on_map = isinstance(obstacles, GridMap)
    start, goal = _rows("starts", starts, 3), _rows("goals", goals, 2)
    maps = 1 if on_map or _depth("obstacles", obstacles) < 3 else len(obstacles)
    count = max(len(start), len(goal), maps)
    count = count if count > 1 else params.sets
    check_dwa(params, static, count)
    # Wrapped in double precision: single loses the angle of a heading of many turns.
    start = np.column_stack([start[:, :2], wrapped(start[:, 2])])
    start, goal = _repeat("starts", start, count), _repeat("goals", goal, count)
    for name, points in (("starts", start[:, :2]), ("goals", goal)):
        refuse_remote(name, points - (obstacles.origin if on_map else 0.0))
    if on_map:
        return _on_chart(obstacles, valid, start, goal, params, static, sensing_range)
    return _among_circles(obstacles, valid, start, goal, params, sensing_range)


def _depth(name: str, value: Any) -> int:
    return any_array(name, value, "a full array").ndim


def _rows(name: str, value: Any, width: int) -> np.ndarray:
    shape = (width,) if _depth(name, value) == 1 else (None, width)
    rows = np.atleast_2d(float_array(name, value, shape))
    if len(rows) == 0:
        raise BadInputError(f"{name}: got no rows; wanted at least one episode")
    return rows


def _repeat(name: str, rows: np.ndarray, count: int) -> np.ndarray:
    if len(rows) not in (1, count):
        raise BadInputError(f"{name}: got {len(rows)} rows; wanted {count}, one per episode")
    return np.broadcast_to(rows, (count, rows.shape[1]))


def refuse_remote(name: str, points: np.ndarray) -> None:
    """Refuse points, float[B, 2] (m), that single precision resolves badly.

    Raises:
        BadInputError: naming the argument and, of several, the first such row.
    """
    remote = np.abs(points) > MOST_REMOTE
    if remote.any():
        row = int(np.argmax(remote.any(axis=1)))
        which = f"episode {row} lies at" if len(points) > 1 else "got"
        raise BadInputError(
            f"{name}: {which} ({points[row, 0]:g}, {points[row, 1]:g}) m; single precision wants "
            f"coordinates below {MOST_REMOTE:g} m: subtract a local origin"
        )


def _among_circles(
    obstacles: Any,
    valid: Any,
    start: np.ndarray,
    goal: np.ndarray,
    params: DwaParams,
    sensing_range: float | None,
) -> PackedEpisodes:
    if sensing_range is not None:
        raise BadInputError("sensing_range: goes with a GridMap; circles are all in sight")
    shared = np.ndim(obstacles) == 2
    shape = (None, 2) if shared else (len(start), None, 2)
    centres = float_array("obstacles", obstacles, shape)
    centres = centres[None] if shared else centres
    shown = None if valid is None else _mask(valid, (len(start), centres.shape[1]))
    packed = padded(centres, shown)
    _refuse_inside(packed, start, np.asarray(params.radius, np.float64), np.zeros(2))
    return PackedEpisodes(start, goal, np.zeros(2), packed, None)


def _mask(valid: Any, shape: tuple[int, int]) -> np.ndarray:
    _depth("valid", valid)
    mask = np.asarray(valid)
    if mask.dtype != bool:
        raise BadTypeError(f"valid: got dtype {mask.dtype}; wanted bool")
    if mask.shape not in (shape, shape[1:]):
        raise BadInputError(
            f"valid: got shape {mask.shape}; wanted {shape} or {shape[1:]}, as the obstacles"
        )
    return mask


def _offsets(
    packed: np.ndarray, start: np.ndarray
) -> Iterator[tuple[slice, np.ndarray, np.ndarray]]:
    """How far east and north (m) of its start an episode's centres lie, some rows at a time."""
    for first in range(0, len(start), ROWS_AT_ONCE):
        rows = slice(first, first + ROWS_AT_ONCE)
        centres = packed[rows] if len(packed) > 1 else packed
        yield rows, centres[:, 0] - start[rows, 0, None], centres[:, 1] - start[rows, 1, None]


def _refuse_inside(
    packed: np.ndarray, start: np.ndarray, radius: np.ndarray, origin: np.ndarray
) -> None:
    for rows, east, north in _offsets(packed, start):
        inside = east * east + north * north < np.reshape(_of_rows(radius, rows), (-1, 1)) ** 2
        if inside.any():
            row, k = (int(i) for i in np.argwhere(inside)[0])
            row += rows.start
            x, y = packed[row if len(packed) > 1 else 0][:, k] + origin
            raise BadInputError(
                f"starts: episode {row} starts inside the obstacle at ({x:g}, {y:g}) m; "
                "wanted a start outside every inflated circle"
            )


def _of_rows(value: np.ndarray, rows: slice) -> np.ndarray:
    return value[rows] if value.ndim else value


def _on_chart(
    grid: GridMap,
    valid: Any,
    start: np.ndarray,
    goal: np.ndarray,
    params: DwaParams,
    static: DwaStatic,
    sensing_range: float | None,
) -> PackedEpisodes:
    if valid is not None:
        raise BadInputError("valid: goes with obstacle centres, not with a GridMap")
    covers = grid.cell_size * sqrt(0.5)
    if np.min(params.radius) < covers:
        raise BadInputError(
            f"params.radius: got {np.min(params.radius):g} m; wanted at least {covers:g} m, half "
            f"the diagonal of a {grid.cell_size:g} m cell, so that no vessel slips between cells"
        )
    for name, points in (("starts", start[:, :2]), ("goals", goal)):
        blocked = np.asarray(grid.is_blocked(points))
        if blocked.any():
            row = int(np.argmax(blocked))
            raise BadInputError(
                f"{name}: episode {row} at ({points[row, 0]:g}, {points[row, 1]:g}) m is on a "
                "blocked cell or off the map; wanted open water"
            )
    across = grid.cell_size * hypot(*grid.shape)  # farther there is no shore
    reach = min(_reach(params, static, sensing_range), across)
    origin = np.asarray(grid.origin, np.float64)
    packed = PackedEpisodes(
        start=start - np.append(origin, 0.0),
        goal=goal - origin,
        origin=origin,
        obstacles=None,
        chart=charted(grid, reach),
    )
    radius = np.asarray(params.radius, np.float64)
    _refuse_inside(packed.sensed(packed.start[:, :2]), packed.start, radius, origin)
    return packed


def _reach(params: DwaParams, static: DwaStatic, sensing_range: float | None) -> float:
    """How far off shore is seen (m); by default, how far from the vessel it can matter."""
    fastest = params.top_speed
    if sensing_range is None:
        if np.ndim(fastest * params.dt * params.v_dec * params.radius):
            raise BadInputError(
                "sensing_range: not given; wanted a length (m) where v_min, v_max, v_dec, dt or "
                "radius differ between episodes, so that none depends on the others"
            )
        prediction = fastest * static.horizon * np.asarray(params.dt)
        braking = fastest**2 / (2.0 * np.maximum(params.v_dec, 1e-9))
        return float(np.max(prediction + braking + params.radius))
    reach = positive("sensing_range", sensing_range)
    least = float(np.max(fastest * np.asarray(params.dt) + params.radius))
    if reach < least:
        raise BadInputError(
            f"sensing_range: got {reach:g} m; wanted at least {least:g} m, the radius and one "
            "step at full speed, so that every collision is seen"
        )
    return reach
