"""Starts and goals: the same for every job, or drawn on water that joins them."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import scipy

from usvjax.checks import shown
from usvjax.errors import BadInputError
from usvjax.maps.draws import Stream, in_rounds, round_bits, round_uniforms
from usvjax.maps.grid_map import GridMap
from usvjax.maps.tables import check_length
from usvjax.suggest import did_you_mean

ENDS = ("free", "connected", "harbours")

GOALS_PER_START = 32

# Each round draws a start and GOALS_PER_START goals for it. On a map where one start in a
# hundred works, a job fails all rounds once in 10^13.
PAIR_ROUNDS = 3000

# A start without any goal is drawn again, so often at most.
CELL_ROUNDS = 1000

_FARTHEST = 1e12  # m; whatever lies farther off overflows the number of a cell


def fixed_ends(
    start: tuple[float, float], goal: tuple[float, float], heading: float | None, jobs: int
) -> tuple[np.ndarray, np.ndarray]:
    """Repeat one start and goal.

    Args:
        start, goal: x, y, m.
        heading: rad; towards the goal when None.
        jobs: J.

    Returns:
        float64[J, 3] starts, x, y (m) and heading (rad), and float64[J, 2] goals, m.
    """
    if heading is None:
        heading = math.atan2(goal[1] - start[1], goal[0] - start[0])
    starts = np.tile(np.asarray([*start, heading], np.float64), (jobs, 1))
    return starts, np.tile(np.asarray(goal, np.float64), (jobs, 1))


def facing(starts: np.ndarray, goals: np.ndarray) -> np.ndarray:
    """Starts with the bow towards the goal: float64[J, 3] from float64[J, 2] each, m and rad."""
    bearing = np.arctan2(*np.moveaxis(goals - starts, -1, 0)[::-1])
    return np.concatenate([starts, bearing[:, None]], axis=-1)


def turned(starts: np.ndarray, seed: int, jobs: np.ndarray, jitter: float) -> np.ndarray:
    """Starts with each job's heading turned by a draw of its own, the same whatever the method.

    Args:
        starts: float64[J, 3], x, y (m) and heading (rad).
        seed: of the study.
        jobs: int64[J].
        jitter: rad; turns are uniform within plus or minus this.

    Returns:
        float64[J, 3]; at a jitter of 0 the starts themselves.
    """
    if jitter == 0.0:
        return starts
    drawn = round_bits(seed, jobs, Stream.HEADINGS, 0, 1, len(jobs))
    turns = jitter * ((np.asarray(drawn, np.float64)[:, 0] + 0.5) / 2**31 - 1.0)
    return np.column_stack([starts[:, :2], starts[:, 2] + turns])


def check_jitter(jitter: float, where: str) -> None:
    """Raise BadInputError unless headings may be turned by up to this angle (rad)."""
    if not 0.0 <= jitter <= math.pi:
        raise BadInputError(f"{where}: 'start_jitter' must lie in [0, pi] rad, got {jitter:g}")


def check_fixed_ends(
    start: tuple[float, float], goal: tuple[float, float], heading: float | None, where: str
) -> None:
    """Raise BadInputError unless start, goal and heading are finite and start is not the goal."""
    if not all(map(math.isfinite, (*start, *goal, heading or 0.0))):
        raise BadInputError(f"{where}: 'start', 'goal' and 'start_heading' must be finite")
    if start == goal:
        raise BadInputError(f"{where}: 'start' and 'goal' are the same point, {list(start)!r}")


NamedPoints = Sequence[tuple[str, tuple[float, float]]]
"""What messages call a point, and its x and y, m."""


def named_points(**points: tuple[float, float]) -> NamedPoints:
    """Points by their keys in a study, such as "'start' (3, 4)"."""
    return [(f"{name!r} ({x:g}, {y:g})", (x, y)) for name, (x, y) in points.items()]


def check_on_water(points: NamedPoints, water: GridMap, where: str) -> None:
    """Raise BadInputError unless points lie on free cells of a map."""
    for name, (x, y) in points:
        if not max(abs(x), abs(y)) < _FARTHEST:
            raise BadInputError(f"{where}: {name} is no place in metres")
        if water.is_blocked((x, y)):
            raise BadInputError(f"{where}: {name} is not on the map's water")


def check_joined(points: NamedPoints, water: GridMap, where: str) -> None:
    """Raise BadInputError unless points on the water lie in the same body of it."""
    cells = water.cells_of([point for _, point in points])
    bodies = water.components()[cells[:, 1], cells[:, 0]]
    if (bodies != bodies[0]).any():
        other = points[int(np.argmax(bodies != bodies[0]))][0]
        raise BadInputError(f"{where}: no water joins {other} to {points[0][0]}")


def check_both_ends(
    start: tuple[float, float] | None, goal: tuple[float, float] | None, where: str
) -> None:
    """Raise BadInputError where one of start and goal is given without the other."""
    if (start is None) != (goal is None):
        given, missing = ("start", "goal") if goal is None else ("goal", "start")
        raise BadInputError(f"{where}: {given!r} is given without {missing!r}; wanted both or none")


def check_only_drawn(given: Mapping[str, object], fixed: str, where: str) -> None:
    """Raise BadInputError where a setting of what is drawn stands beside what is `fixed`.

    Args:
        given: values of the settings by key; falsy ones were left out.
        fixed: what is given instead.
        where: the study file and table, for the messages.
    """
    for name, value in given.items():
        if value:
            raise BadInputError(f"{where}: {name!r} is of what is drawn, but {fixed} is given")


def check_outside_goal(
    start: tuple[float, float], goal: tuple[float, float], tolerance: float, where: str
) -> None:
    """Raise BadInputError where a start counts as its goal: every episode would end in 0 s."""
    apart = math.dist(start, goal)
    if np.float32(apart) <= np.float32(tolerance):
        raise BadInputError(
            f"{where}: 'start' {list(start)!r} lies {apart:g} m from 'goal' {list(goal)!r}, within "
            f"'goal_tolerance' of {tolerance:g} m, so every episode would be over at once; "
            f"wanted them farther apart"
        )


def draw_pairs(
    seed: int,
    jobs: np.ndarray,
    grid: GridMap,
    bodies: np.ndarray,
    cells: np.ndarray,
    distance: tuple[float, float],
    place: str,
    water: str,
) -> tuple[np.ndarray, np.ndarray]:
    """Draw starts and goals by bearing and distance, both in the same body of water.

    A start is uniform over the cells; its goal has a uniform bearing and a uniform distance from
    it and is then moved to the centre of its cell. Pairs that are ashore, in another body of
    water or out of the range of distances are drawn again.

    Args:
        seed: of the study.
        jobs: int64[J].
        grid: the map.
        bodies: int32[H, W], the number of the body of water; 0 where nothing starts or ends.
        cells: int64[N, 2], (x, y) of the cells of all bodies.
        distance: least and greatest straight-line distance from start to goal, m.
        place: what the map is, and
        water: which of its water is meant, for the message.

    Returns:
        float64[J, 2] starts and float64[J, 2] goals, m.

    Raises:
        BadInputError: no start and goal could be found for a job.
    """
    starts, goals = np.zeros((len(jobs), 2)), np.zeros((len(jobs), 2))

    def attempt(rows: np.ndarray, number: int) -> np.ndarray:
        unit = round_uniforms(seed, jobs[rows], number, 1 + 2 * GOALS_PER_START, len(jobs))
        start, goal, found = _pairs(unit, grid, bodies, cells, distance)
        starts[rows[found]], goals[rows[found]] = start[found], goal[found]
        return found

    left = in_rounds(len(jobs), PAIR_ROUNDS, attempt)
    if len(left):
        near, far = distance
        raise BadInputError(
            f"{place} has no start and goal {near:g} to {far:g} m apart on connected {water} "
            f"(job {jobs[left[0]]} found none in {PAIR_ROUNDS} rounds)"
        )
    return starts, goals


def _pairs(
    unit: np.ndarray,
    grid: GridMap,
    bodies: np.ndarray,
    cells: np.ndarray,
    distance: tuple[float, float],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Turn uniform numbers into one start and one goal per job, and whether they serve.

    Args:
        unit: float64[J, 1 + 2 * GOALS_PER_START].
        grid, bodies, cells, distance: as of `draw_pairs`.

    Returns:
        float64[J, 2] and float64[J, 2], m, and bool[J].
    """
    cell = cells[(unit[:, 0] * len(cells)).astype(np.int64)]
    start = grid.points_of(cell)
    near, far = distance
    bearing = 2.0 * np.pi * unit[:, 1 : 1 + GOALS_PER_START]
    reach = near + (far - near) * unit[:, 1 + GOALS_PER_START :]
    offset = reach[..., None] * np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
    goal_cells = grid.cells_of(start[:, None] + offset)
    goals = grid.points_of(goal_cells)
    apart = np.hypot(*np.moveaxis(goals - start[:, None], -1, 0))
    good = _body_at(bodies, goal_cells) == _body_at(bodies, cell)[:, None]
    good &= (apart >= near) & (apart <= far)
    first = good.argmax(axis=1)
    return start, goals[np.arange(len(unit)), first], good.any(axis=1)


def _body_at(bodies: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Body of water of int64[..., 2] cells; -1 where nothing may start or end."""
    limit = np.asarray(bodies.shape[::-1])
    inside = ((cells >= 0) & (cells < limit)).all(axis=-1)
    x, y = np.moveaxis(np.clip(cells, 0, limit - 1), -1, 0)
    body = np.where(inside, bodies[y, x], 0)
    return np.where(body > 0, body, -1)


def end_groups(blocked: np.ndarray, ends: str) -> np.ndarray:
    """Which cells may be joined by a route from start to goal.

    Args:
        blocked: bool[M, H, W].
        ends: "free": any two free cells of a map; "connected": any two of one body of water;
            "harbours": any two at the shore of the largest body.

    Returns:
        int32[M, H, W]: 0 where no route ends; start and goal share a number.
    """
    if ends == "free":
        return (~blocked).astype(np.int32)
    if ends == "connected":
        within = np.zeros((3, 3, 3), bool)
        within[1] = scipy.ndimage.generate_binary_structure(2, 1)
        labels: np.ndarray = scipy.ndimage.label(~blocked, within)[0]
        return labels
    around = np.ones((1, 3, 3), bool)
    largest = np.stack([GridMap(grid).largest_component() for grid in blocked])
    return (largest & scipy.ndimage.binary_dilation(blocked, around)).astype(np.int32)


def check_ends(ends: str, known: tuple[str, ...], min_distance: float, where: str) -> None:
    """Raise BadInputError unless `ends` is known and a least distance (m) 0 or more."""
    if ends not in known:
        raise BadInputError(f"{where}: unknown ends {shown(ends)}; {did_you_mean(ends, known)}")
    check_length("min_distance", min_distance, where)


def draw_ends(
    seed: int, jobs: np.ndarray, groups: np.ndarray, least: float, place: str
) -> tuple[np.ndarray, np.ndarray]:
    """Draw a start and a goal cell for each job.

    A start is uniform over the cells that have a group, and its goal over those of the same
    group that are far enough; a start without a goal is drawn again.

    Args:
        seed: of the study.
        jobs: int64[J].
        groups: int32[1 or J, H, W], of `end_groups`.
        least: cells, from start to goal.
        place: what the map is, for the message.

    Returns:
        int32[J, 2] starts and int32[J, 2] goals, cells (x, y).

    Raises:
        BadInputError: there is no such pair for a job.
    """
    ends = np.zeros((len(jobs), 2, 2), np.int32)
    shared = _Cells(groups[0], least) if len(groups) == 1 else None

    def attempt(rows: np.ndarray, number: int) -> np.ndarray:
        found = np.zeros(len(rows), bool)
        drawn = round_bits(seed, jobs[rows], Stream.ENDS, number, 2, len(jobs))
        for i, (row, numbers) in enumerate(zip(rows, drawn, strict=True)):
            pair = (shared or _Cells(groups[row], least)).pair(*numbers)
            if pair is not None:
                ends[row], found[i] = pair, True
        return found

    left = in_rounds(len(jobs), CELL_ROUNDS, attempt)
    if len(left):
        raise BadInputError(
            f"{place} has no start and goal {least:.4g} cells apart that 'ends' allows "
            f"(job {jobs[left[0]]}); lower 'min_distance' or change 'ends'"
        )
    return ends[:, 0], ends[:, 1]


class _Cells:
    """The cells of one map where routes may start and end."""

    def __init__(self, groups: np.ndarray, least: float) -> None:
        # Squared distances fit; int32 is twice as fast.
        kind = np.int32 if max(groups.shape) < 2**15 else np.int64
        place = np.flatnonzero(groups)
        y = place // groups.shape[1]
        self._x, self._y = (place - y * groups.shape[1]).astype(kind), y.astype(kind)
        self._group = groups.reshape(-1)[place]
        self._least = least_squared(least)

    def pair(self, first: int, second: int) -> tuple[list[int], list[int]] | None:
        """Start and goal for two random numbers below 2**32; None where there is no goal."""
        count = len(self._x)
        if not count:
            return None
        start = first * count >> 32
        east, north = self._x - self._x[start], self._y - self._y[start]
        serves = east * east + north * north >= self._least
        serves &= self._group == self._group[start]
        goals = np.flatnonzero(serves)
        if not len(goals):
            return None
        goal = int(goals[second * len(goals) >> 32])
        return [self._x[start], self._y[start]], [self._x[goal], self._y[goal]]


def least_squared(least: float) -> float:
    """The square that two different cells, at least `least` cells apart, reach."""
    # A distance of a whole number of cells must survive the rounding of metres.
    return max(least * least * (1.0 - 1e-9), 0.5)
