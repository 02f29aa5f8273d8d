"""Routes of a fleet: searched, pulled straight, led in on a heading, laid at the unit length."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from usvjax.batches import bucket, filled
from usvjax.errors import BadInputError
from usvjax.memory import check_memory
from usvjax.missions.fleet.ground import Ground
from usvjax.missions.fleet.params import FleetStatic
from usvjax.paths.smoothing import redensify
from usvkernels.fleet.guidance import Routes
from usvkernels.status import Status

SHORTER = (1.0, 0.75, 0.5)
"""Shares of the guide length that are tried, one after the other."""

LEAST_POINTS, MOST_POINTS = 64, 1 << 16
"""Places for points on a route, and points."""

BYTES = 128
"""Of memory that a point takes while routes are laid."""


@dataclass(frozen=True)
class Plan:
    """Where the vessels of B fleets are to go; numpy arrays.

    Attributes:
        routes: their paths, [B, n, P].
        status: int32[B, n], RUNNING where there is a route, else why there is none.
        length: float64[B, n], of the routes (m).
    """

    routes: Routes
    status: np.ndarray
    length: np.ndarray


def lay(
    ground: Ground,
    start: np.ndarray,
    goal: np.ndarray,
    heading: np.ndarray | None,
    reach: np.ndarray,
    static: FleetStatic,
    via: np.ndarray | None = None,
) -> Plan:
    """Lay the routes of B fleets of n vessels.

    Args:
        ground: where they sail.
        start, goal: float64[B, n, 2] (m).
        heading: float64[B, n] (rad), to arrive at; None for any.
        reach: float64[B, n], distance to keep from what the ground has (m).
        static: unit length, look-ahead, guide length.
        via: float64[W, B, n, S, 2], for each vessel W ways round something, S points each (m), of
            which the first is taken that is open; None: nothing but the shortest way.
    """
    fleets, n = start.shape[:2]
    rows = np.repeat(np.arange(fleets), n)
    start, goal, reach = start.reshape(-1, 2), goal.reshape(-1, 2), reach.reshape(-1)
    status = np.full(len(rows), int(Status.RUNNING), np.int32)
    target = goal
    if heading is not None:
        target, led = _way_points(ground, rows, goal, heading.reshape(-1), reach, static)
        status[~led] = int(Status.NO_APPROACH)
    corners, counts, found = _ways(ground, rows, start, target, reach, via)
    status[~found & (status == int(Status.RUNNING))] = int(Status.UNREACHABLE)
    sound = status == int(Status.RUNNING)
    corners, counts = _ended(corners, counts, start, goal, heading is not None, sound)
    beyond = np.zeros(len(rows))
    if heading is not None:
        corners, beyond = _extended(corners, counts, goal, heading.reshape(-1), static, sound)
        counts = counts + sound.astype(np.int32)
    _check_points(corners, static.unit_length)
    dense = redensify(corners, counts, static.unit_length)
    # Few sizes, since each is compiled.
    points = filled(dense.path, bucket(max(dense.path.shape[1], LEAST_POINTS)), axis=1)
    end, along = dense.path_cells - 1, _along(points)
    last = np.minimum(np.sum(along < (along[:, -1] - beyond)[:, None] - 1e-3, axis=1), end)
    length = along[:, -1] - beyond
    ahead = _ahead(ground, rows, points, along, end, reach, static.look_ahead)
    shape = (fleets, n)
    tables: dict[str, Any] = {
        "points": points.reshape(*shape, -1, 2).astype(np.float32),
        "ahead": ahead.reshape(*shape, -1),
        "last": last.astype(np.int32).reshape(shape),
        "gate": _gates(along, length, target, goal, last).reshape(shape),
        "bow": _bows(heading, len(rows)).reshape(*shape, 2),
    }
    return Plan(
        routes=Routes(**tables),
        status=status.reshape(shape),
        length=length.reshape(shape),
    )


def _check_points(corners: np.ndarray, unit: float) -> None:
    """Refuse routes, float64[R, P, 2] (m), of too many points at the unit length."""
    longest = np.linalg.norm(np.diff(corners, axis=1), axis=2).sum(axis=1).max()
    points = longest / unit + corners.shape[1]
    what = f"static.unit_length: got {unit:g} m, for a route of {longest:g} m"
    if points > MOST_POINTS:
        raise BadInputError(f"{what}; wanted at most {MOST_POINTS:,} points on it")
    check_memory(len(corners) * bucket(int(points)) * BYTES, f"{what}, and {len(corners):,} routes")


def _way_points(
    ground: Ground,
    rows: np.ndarray,
    goal: np.ndarray,
    heading: np.ndarray,
    reach: np.ndarray,
    static: FleetStatic,
) -> tuple[np.ndarray, np.ndarray]:
    """P_k of Wei & Zhang 2023, section 2.3.2, and whether its guide segment is clear; bool[R]."""
    bow = np.stack([np.cos(heading), np.sin(heading)], axis=1)
    way = goal.copy()
    led = np.zeros(len(goal), bool)
    for share in SHORTER:
        from_here = goal - share * static.guide_length * bow
        clear = ground.clear(rows, from_here, goal, reach) & ~led
        way[clear] = from_here[clear]
        led |= clear
    return way, led


def _ways(
    ground: Ground,
    rows: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
    reach: np.ndarray,
    via: np.ndarray | None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `Ground.path`, by the first of the ways via that is open, else straight."""
    ways = [] if via is None else list(via.reshape(len(via), len(rows), -1, 2))
    left, found = np.arange(len(rows)), np.zeros(len(rows), bool)
    corners, counts = np.stack([start, end], axis=1), np.full(len(rows), 2, np.int32)
    for stops in [*ways, np.empty((len(rows), 0, 2))]:
        points = np.concatenate([start[:, None], stops, end[:, None]], axis=1)[left]
        own, count, open_ = _by_way_of(ground, rows[left], points, reach[left])
        size = max(corners.shape[1], own.shape[1])
        corners = filled(corners, size, axis=1)
        corners[left], counts[left] = filled(own, size, axis=1), count
        found[left] = open_
        left = left[~open_]
        if not len(left):
            break
    return corners, counts, found


def _by_way_of(
    ground: Ground, rows: np.ndarray, stops: np.ndarray, reach: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `Ground.path`, from the first of stops float64[R, S, 2] by way of the others."""
    found, legs, kept = np.ones(len(rows), bool), [], []
    for start, end in pairwise(np.moveaxis(stops, 1, 0)):
        corners, count, there = ground.path(rows, start, end, reach)
        # A leg's end is where the next begins; one without length has none.
        moves = np.any(start != end, axis=1)
        found &= there
        # The ends need not be clear of what is only near; what lies between has to, and on the map.
        between = np.flatnonzero(moves & np.any(end != stops[:, -1], axis=1))
        if len(between):
            point = end[between]
            found[between] &= ground.clear(rows[between], point, point, reach[between])
        kept.append(np.arange(corners.shape[1]) < np.where(moves, count - 1, 0)[:, None])
        legs.append(corners)
    points = np.concatenate([*legs, stops[:, -1:]], axis=1)
    keep = np.concatenate([*kept, np.ones((len(rows), 1), bool)], axis=1)
    count = keep.sum(axis=1).astype(np.int32)
    # Those kept come first, and the last again for the others.
    order = np.argsort(~keep, axis=1, kind="stable")[:, : max(2, int(count.max()))]
    points = np.take_along_axis(points, order[..., None], axis=1)
    ended = np.arange(order.shape[1]) >= (count - 1)[:, None]
    return np.where(ended[..., None], stops[:, -1:], points), np.maximum(count, 2), found


def _ended(
    corners: np.ndarray,
    counts: np.ndarray,
    start: np.ndarray,
    goal: np.ndarray,
    led: bool,
    sound: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Paths with the goal behind the way point; those of vessels without one stay at the start."""
    counts = np.where(sound, counts + led, 1).astype(np.int32)
    if led:
        corners = np.concatenate([corners, corners[:, -1:]], axis=1)
        at = np.arange(corners.shape[1]) >= (counts - 1)[:, None]
        corners = np.where((at & sound[:, None])[..., None], goal[:, None], corners)
    return np.where(sound[:, None, None], corners, start[:, None]), counts


def _extended(
    corners: np.ndarray,
    counts: np.ndarray,
    goal: np.ndarray,
    heading: np.ndarray,
    static: FleetStatic,
    sound: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Paths led on beyond the goal by a look-ahead, and by how much (m).

    A vessel that steered for the goal itself to the end would turn for every metre that it is off
    the guide segment.
    """
    bow = np.stack([np.cos(heading), np.sin(heading)], axis=1)
    tail = goal + static.look_ahead * bow
    corners = np.concatenate([corners, corners[:, -1:]], axis=1)
    at = (np.arange(corners.shape[1]) >= counts[:, None]) & sound[:, None]
    return np.where(at[..., None], tail[:, None], corners), static.look_ahead * sound


def _gates(
    along: np.ndarray,
    length: np.ndarray,
    target: np.ndarray,
    goal: np.ndarray,
    last: np.ndarray,
) -> np.ndarray:
    """The first point of each path's guide segment, int32[R]; of all the path without one."""
    led = np.linalg.norm(goal - target, axis=1)
    gate = np.sum(along < (length - led)[:, None] - 1e-3, axis=1)
    return np.where(led > 0, np.minimum(gate, last), 0).astype(np.int32)


def _bows(heading: np.ndarray | None, rows: int) -> np.ndarray:
    """Unit vectors of headings, float32[R, 2]; 0 where any heading will do."""
    if heading is None:
        return np.zeros((rows, 2), np.float32)
    heading = heading.reshape(-1)
    return np.stack([np.cos(heading), np.sin(heading)], axis=1).astype(np.float32)


def _along(points: np.ndarray) -> np.ndarray:
    """How far along its path each point is (m); float64[R, P]."""
    steps = np.linalg.norm(np.diff(points, axis=1), axis=2)
    return np.concatenate([np.zeros((len(points), 1)), np.cumsum(steps, axis=1)], axis=1)


def _ahead(
    ground: Ground,
    rows: np.ndarray,
    points: np.ndarray,
    along: np.ndarray,
    last: np.ndarray,
    reach: np.ndarray,
    look_ahead: float,
) -> np.ndarray:
    """The point to steer for from each: the farthest within the look-ahead that is in sight."""
    own = np.arange(along.shape[1])
    ahead = np.stack([np.searchsorted(way, way + look_ahead, side="right") - 1 for way in along])
    ahead = np.minimum(np.maximum(ahead, own + 1), last[:, None])
    row, at = np.nonzero(own < last[:, None])
    while len(row):
        to = ahead[row, at]
        hidden = (to > at + 1) & ~ground.clear(
            rows[row], points[row, at], points[row, to], reach[row]
        )
        row, at = row[hidden], at[hidden]
        ahead[row, at] -= 1
    return ahead.astype(np.int32)
