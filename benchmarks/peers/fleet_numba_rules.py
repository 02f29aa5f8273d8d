"""What `fleet_numba` has vessels see of each other, and which course and speed they choose.

Rules as a user may write them: simpler than those of `usvkernels.fleet.rules`.
"""

from typing import Any, NamedTuple

import numba as nb
import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple

from usvkernels.status import Status

RUNNING, REACHED, COLLIDED, STUCK, TIMED_OUT = (
    int(status)
    for status in (
        Status.RUNNING,
        Status.REACHED,
        Status.COLLIDED,
        Status.STUCK,
        Status.TIMED_OUT,
    )
)
NONE, HEAD_ON, GIVE_WAY, STAND_ON, OVERTAKING, OVERTAKEN = range(6)
COS_HEAD_ON, COS_ABAFT = np.cos(np.radians(6.0)), np.cos(np.radians(112.5))
RELEASE, AHEAD, ESCAPE, SLACK = 1.25, 2.0, 0.999999, 1e-3
COMFORT, TURNING = 0.8, 0.1
VIOLATION, SLOWER, CHANGE = 30.0, 2.0, 0.1
DEGREES = np.array([0.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0])
SHARES = np.array([1.0, 0.5, 0.0])

# Columns of a fleet's reals: what a step carries on, and what it sees before it decides.
X, Y, PSI, V, W, LENGTH, ANCHOR_X, ANCHOR_Y = range(8)
EAST, NORTH, INTENT_X, INTENT_Y, COURSE_X, COURSE_Y, GUIDE, SPEED, ROOM, ARRIVAL = range(8, 18)
STATUS, ENDED, ANCHOR_STEP, INDEX, INDEX_STEP, ALTERED = range(6)


class Numbers(NamedTuple):
    """Those of `FleetParams` that the loops need."""

    v_max: Any
    w_max: Any
    v_acc: Any
    v_dec: Any
    w_acc: Any
    v_step: Any
    w_step: Any
    heading_weight: Any
    clearance_weight: Any
    velocity_weight: Any
    dt: Any
    clearance_cap: Any
    hull_radius: Any
    obstacle_radius: Any
    goal_tolerance: Any
    passing: Any
    sight_time: Any
    act_time: Any
    stuck_distance: Any
    stuck_time: Any
    livelock_time: Any


N_NUMBERS = len(Numbers._fields)


@nb.njit
def named(a):  # type: ignore[no-untyped-def]
    """Name the packed numbers; arrays are all that a parallel loop can take."""
    return Numbers(*to_fixed_tuple(a, N_NUMBERS))


@nb.njit
def closest_time(px, py, vx, vy, until):  # type: ignore[no-untyped-def]
    """Return when straight courses are closest, until a time."""
    square = vx * vx + vy * vy
    if square == 0.0:
        return 0.0
    return min(max(-(px * vx + py * vy) / square, 0.0), until)


@nb.njit
def least_distance(px, py, vx, vy, until):  # type: ignore[no-untyped-def]
    """Return the least distance on straight courses until a time."""
    time = closest_time(px, py, vx, vy, until)
    return np.hypot(px + vx * time, py + vy * time)


@nb.njit
def _contact(px, py, vx, vy, reach):  # type: ignore[no-untyped-def]
    """Return when straight courses come within `reach`."""
    outside = px * px + py * py - reach * reach
    if outside <= 0.0:
        return 0.0
    closing = -(px * vx + py * vy)
    across = px * vy - py * vx
    root = (vx * vx + vy * vy) * reach * reach - across * across
    if closing <= 0.0 or root < 0.0:
        return np.inf
    return outside / (closing + np.sqrt(root))


# --- what vessels see -------------------------------------------------------------------------


@nb.njit
def look_ahead(real, count, path, ahead, last, circles, p):  # type: ignore[no-untyped-def]
    """Guidance: course, speed, room about the guidance point, and time to the goal."""
    for i in range(real.shape[0]):
        x, y, psi, v = real[i, X], real[i, Y], real[i, PSI], real[i, V]
        at = ahead[i, count[i, INDEX]]
        east, north = path[i, at, 0] - x, path[i, at, 1] - y
        distance = np.hypot(east, north)
        real[i, GUIDE] = distance
        nearest = np.inf
        for c in range(circles.shape[0]):
            gap = np.hypot(circles[c, 0] - path[i, at, 0], circles[c, 1] - path[i, at, 1])
            nearest = min(nearest, gap - p.hull_radius - p.obstacle_radius)
        real[i, ROOM] = min(max(nearest, 0.0), p.clearance_cap)
        real[i, COURSE_X] = east / distance if distance > 0.0 else np.cos(psi)
        real[i, COURSE_Y] = north / distance if distance > 0.0 else np.sin(psi)
        left = np.hypot(path[i, last[i], 0] - x, path[i, last[i], 1] - y)
        along = np.cos(psi) * (path[i, last[i], 0] - x) + np.sin(psi) * (path[i, last[i], 1] - y)
        abeam = min(max(along / max(left, 1e-3), TURNING), 1.0)
        speed = min(p.v_max, abeam * np.sqrt(2.0 * COMFORT * p.v_dec * left))
        real[i, SPEED] = speed
        real[i, ARRIVAL] = max(left - p.goal_tolerance, 0.0) / p.v_max
        real[i, EAST], real[i, NORTH] = v * np.cos(psi), v * np.sin(psi)
        if count[i, STATUS] != RUNNING:
            speed = 0.0
        real[i, INTENT_X] = real[i, COURSE_X] * speed
        real[i, INTENT_Y] = real[i, COURSE_Y] * speed


@nb.njit
def _wanted(i, j, real, count, goal_x, goal_y, p):  # type: ignore[no-untyped-def]
    """Return the distance that i wants from j."""
    hulls = 2.0 * p.hull_radius
    if count[j, STATUS] == RUNNING:
        return hulls + p.passing
    room = 0.9 * np.hypot(goal_x - real[j, X], goal_y - real[j, Y])
    return min(max(room, hulls), hulls + p.passing)


@nb.njit
def _role(i, j, real, count):  # type: ignore[no-untyped-def]
    """Return what i is to j by relative bearings."""
    sails, other_sails = count[i, STATUS] == RUNNING, count[j, STATUS] == RUNNING
    if not sails and other_sails:
        return OVERTAKEN
    if sails and not other_sails:
        return OVERTAKING
    px, py = real[j, X] - real[i, X], real[j, Y] - real[i, Y]
    distance = np.hypot(px, py)
    cx, cy = real[i, COURSE_X], real[i, COURSE_Y]
    dx, dy = real[j, COURSE_X], real[j, COURSE_Y]
    along, across = cx * px + cy * py, cx * py - cy * px
    along_j, across_j = -(dx * px + dy * py), -(dx * py - dy * px)
    if along < COS_ABAFT * distance:
        return OVERTAKEN
    if along_j < COS_ABAFT * distance:
        return OVERTAKING
    ahead = along >= COS_HEAD_ON * distance and along_j >= COS_HEAD_ON * distance
    reciprocal = cx * dx + cy * dy <= -COS_HEAD_ON
    if (reciprocal and ahead) or (across < 0.0) == (across_j < 0.0):
        return HEAD_ON
    return GIVE_WAY if across < 0.0 else STAND_ON


@nb.njit
def meet(real, count, roles, must, sees, wanted, goal, p):  # type: ignore[no-untyped-def]
    """Fill, of each pair, the role, whether i must keep clear and sees j, and the distance."""
    n = real.shape[0]
    for i in range(n):
        for j in range(n):
            if i == j:
                continue
            wanted[i, j] = _wanted(i, j, real, count, goal[i, 0], goal[i, 1], p)
            px, py = real[j, X] - real[i, X], real[j, Y] - real[i, Y]
            vx = real[j, INTENT_X] - real[i, INTENT_X]
            vy = real[j, INTENT_Y] - real[i, INTENT_Y]
            until = min(p.sight_time, min(real[i, ARRIVAL], real[j, ARRIVAL]))
            meets = px * vx + py * vy < 0.0
            least = least_distance(px, py, vx, vy, until)
            if roles[i, j] == NONE:
                sails = count[i, STATUS] == RUNNING or count[j, STATUS] == RUNNING
                if sails and meets and least < wanted[i, j]:
                    roles[i, j] = _role(i, j, real, count)
            elif not (meets and least < RELEASE * wanted[i, j]):
                roles[i, j] = NONE
            role = roles[i, j]
            must[i, j] = role in (HEAD_ON, GIVE_WAY, OVERTAKING)
            if not must[i, j]:
                vx, vy = real[j, EAST] - real[i, EAST], real[j, NORTH] - real[i, NORTH]
                must[i, j] = _contact(px, py, vx, vy, 2.0 * p.hull_radius) < p.act_time
            sees[i, j] = must[i, j] or (role != STAND_ON and role != OVERTAKEN)


# --- what they do about it --------------------------------------------------------------------


@nb.njit
def _short_of(px, py, vx, vy, wanted, port, until):  # type: ignore[no-untyped-def]
    if port and px * vy - py * vx < 0.0 and px * vx + py * vy < 0.0:
        wanted = AHEAD * wanted
    return 1.0 - least_distance(px, py, vx, vy, until) / wanted


@nb.njit
def _cost(i, k, vx, vy, real, count, roles, must, wanted, circles, p):  # type: ignore[no-untyped-def]
    """Return what candidate k of the alterations costs vessel i."""
    until = min(real[i, ARRIVAL], p.sight_time)
    x, y, short = real[i, X], real[i, Y], 0.0
    for j in range(real.shape[0]):
        if i == j or (k == 0 and not must[i, j]):
            continue
        px, py = real[j, X] - x, real[j, Y] - y
        port = roles[i, j] in (HEAD_ON, GIVE_WAY)
        now = _short_of(px, py, real[j, EAST] - vx, real[j, NORTH] - vy, wanted[i, j], port, until)
        ux, uy = real[j, INTENT_X] - vx, real[j, INTENT_Y] - vy
        short = max(short, now, _short_of(px, py, ux, uy, wanted[i, j], port, until))
    if k > 0:
        reach = p.hull_radius + p.obstacle_radius
        for c in range(circles.shape[0]):
            least = least_distance(circles[c, 0] - x, circles[c, 1] - y, -vx, -vy, p.act_time)
            short = max(short, 1.0 - least / reach)
    n = DEGREES.shape[0]
    cost = VIOLATION * short + DEGREES[k % n] / 90.0 + SLOWER * (1.0 - SHARES[k // n])
    return cost if count[i, ALTERED] == k else cost + CHANGE


@nb.njit
def _turned(real, i, k):  # type: ignore[no-untyped-def]
    angle = -np.radians(DEGREES[k % DEGREES.shape[0]])
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = real[i, COURSE_X], real[i, COURSE_Y]
    return x * cos - y * sin, x * sin + y * cos, SHARES[k // DEGREES.shape[0]]


@nb.njit
def alter(i, real, count, roles, must, wanted, circles, p):  # type: ignore[no-untyped-def]
    """Return course and speed that vessel i is ordered; note the alteration."""
    best, chosen = np.inf, 0
    for k in range(DEGREES.shape[0] * SHARES.shape[0]):
        x, y, share = _turned(real, i, k)
        speed = share * real[i, SPEED]
        cost = _cost(i, k, x * speed, y * speed, real, count, roles, must, wanted, circles, p)
        if cost < best:
            best, chosen = cost, k
    count[i, ALTERED] = chosen
    x, y, share = _turned(real, i, chosen)
    return x, y, share * real[i, SPEED]
