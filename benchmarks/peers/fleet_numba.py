"""Fleets by the rules of the road as a numba `prange` loop over fleets.

Written as users write it: compiled functions over plain loops in float64, a stepwise Euler rollout
of each candidate, no fastmath; a candidate that is not clear of one obstacle is not held against
the others. `shared=True` takes the rollout's sines once for all speeds of a yaw rate, as the
kernels do, so that the comparison can tell the algebra from the machine.

The method is that of `usvkernels.fleet` with encounters "rules": vessels in circles' open water,
all of them present, one set of numbers for all.
"""

from typing import NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from benchmarks.peers.fleet_numba_rules import (
    ALTERED,
    ANCHOR_STEP,
    ANCHOR_X,
    ANCHOR_Y,
    ARRIVAL,
    COLLIDED,
    EAST,
    ENDED,
    ESCAPE,
    GUIDE,
    INDEX,
    INDEX_STEP,
    LENGTH,
    NONE,
    NORTH,
    PSI,
    REACHED,
    ROOM,
    RUNNING,
    SLACK,
    SPEED,
    STATUS,
    STUCK,
    TIMED_OUT,
    TURNING,
    Numbers,
    V,
    W,
    X,
    Y,
    alter,
    closest_time,
    least_distance,
    look_ahead,
    meet,
    named,
)
from usvjax.missions.fleet.inputs import Voyage
from usvjax.missions.fleet.params import FleetStatic

Real = npt.NDArray[np.float64]


class Ended(NamedTuple):
    """How fleets ended, [B, n]."""

    status: npt.NDArray[np.int64]
    ended_step: npt.NDArray[np.int64]
    path_length: Real


@nb.njit
def _rollout(psi, v, w, dt, horizon):  # type: ignore[no-untyped-def]
    """Predict by Euler steps: displacement and heading."""
    east = north = 0.0
    for _ in range(horizon):
        east += v * dt * np.cos(psi)
        north += v * dt * np.sin(psi)
        psi += w * dt
    return east, north, psi


@nb.njit
def _passes(px, py, vx, vy, reach, legs):  # type: ignore[no-untyped-def]
    """Return least distance to an obstacle along turn and course, and whether it is clear."""
    turn_x, turn_y, course_x, course_y, turning, course, stopping, bulge = legs
    cx, cy = vx - turn_x, vy - turn_y
    on_turn = least_distance(px, py, cx, cy, turning) - bulge
    ax, ay = px + cx * turning, py + cy * turning
    cx, cy = vx - course_x, vy - course_y
    time = closest_time(ax, ay, cx, cy, course)
    far = np.hypot(ax + cx * time, ay + cy * time)
    time = min(time, stopping)
    soon = np.hypot(ax + cx * time, ay + cy * time)
    allowed = min(reach, ESCAPE * np.hypot(px, py) - bulge)
    return min(on_turn, far) - reach, min(on_turn, soon) > allowed


@nb.njit
def _clearance(i, legs, real, sees, circles, p):  # type: ignore[no-untyped-def]
    """Return least distance to the circles, capped, and whether all is clear."""
    x, y, least = real[i, X], real[i, Y], real[i, ROOM]
    for c in range(circles.shape[0]):
        reach = p.hull_radius + p.obstacle_radius
        gap, clear = _passes(circles[c, 0] - x, circles[c, 1] - y, 0.0, 0.0, reach, legs)
        least = min(least, gap)
        if not clear:
            return least, False
    for j in range(real.shape[0]):
        if i != j and sees[i, j]:
            px, py, reach = real[j, X] - x, real[j, Y] - y, 2.0 * p.hull_radius
            _, clear = _passes(px, py, real[j, EAST], real[j, NORTH], reach, legs)
            if not clear:
                return least, False
    return least, True


@nb.njit
def _step_is_clear(i, v, real, sees, circles, p):  # type: ignore[no-untyped-def]
    """Return whether the next step, which is along the heading, touches nothing."""
    x, y = real[i, X], real[i, Y]
    east, north = v * np.cos(real[i, PSI]), v * np.sin(real[i, PSI])
    for c in range(circles.shape[0]):
        px, py, reach = circles[c, 0] - x, circles[c, 1] - y, p.hull_radius + p.obstacle_radius
        if least_distance(px, py, -east, -north, p.dt) <= min(reach, ESCAPE * np.hypot(px, py)):
            return False
    for j in range(real.shape[0]):
        if i != j and sees[i, j]:
            px, py, reach = real[j, X] - x, real[j, Y] - y, 2.0 * p.hull_radius
            vx, vy = real[j, EAST] - east, real[j, NORTH] - north
            if least_distance(px, py, vx, vy, p.dt) <= min(reach, ESCAPE * np.hypot(px, py)):
                return False
    return True


@nb.njit
def _decide(i, order, real, sees, circles, problem, parts, admissible):  # type: ignore[no-untyped-def]
    """Return speed and yaw rate by the dynamic window; `parts` and `admissible` are scratch."""
    numbers, n_v, n_w, horizon, shared, _, _ = problem
    p = named(numbers)
    psi, v_now, w_now = real[i, PSI], real[i, V], real[i, W]
    cap = max(min(order[2], p.v_max), v_now - p.v_dec * p.dt)
    v_first = max(0.0, v_now - p.v_dec * p.dt)
    v_last = min(cap, v_now + p.v_acc * p.dt) + SLACK * p.v_step
    w_first = max(-p.w_max, w_now - p.w_acc * p.dt)
    w_last = min(p.w_max, w_now + p.w_acc * p.dt) + SLACK * p.w_step
    turning = p.dt * horizon
    facing = min(max(np.cos(psi) * order[0] + np.sin(psi) * order[1], TURNING), 1.0)
    course = facing * real[i, GUIDE] / max(real[i, SPEED], 1e-3) - turning
    course = max(course, (v_now + p.v_acc * p.dt) / p.v_dec)
    goal_x, goal_y = order[0] * real[i, GUIDE], order[1] * real[i, GUIDE]
    totals, serves = np.zeros(3), np.zeros(n_v, np.bool_)
    for k in range(n_v):
        serves[k] = _step_is_clear(i, v_first + k * p.v_step, real, sees, circles, p)
    for j in range(n_w):
        w = w_first + j * p.w_step
        quarter = abs(w * turning) / 4.0
        height = 0.5 * (quarter + 0.45 * quarter * quarter * quarter)
        if shared:
            unit_x, unit_y, heading = _rollout(psi, 1.0, w, p.dt, horizon)
            bow_x, bow_y = np.cos(heading), np.sin(heading)
        for k in range(n_v):
            v, n = v_first + k * p.v_step, k * n_w + j
            admissible[n] = False
            if v > v_last or w > w_last or not serves[k]:
                continue
            if shared:
                east, north = v * unit_x, v * unit_y
            else:
                east, north, heading = _rollout(psi, v, w, p.dt, horizon)
                bow_x, bow_y = np.cos(heading), np.sin(heading)
            turn_x, turn_y, bulge = east / turning, north / turning, v * turning * height
            legs = turn_x, turn_y, v * bow_x, v * bow_y, turning, course, v / p.v_dec, bulge
            dist, admissible[n] = _clearance(i, legs, real, sees, circles, p)
            if admissible[n]:
                theta = np.arctan2(goal_y - north, goal_x - east) - heading
                theta = abs((theta + np.pi) % (2.0 * np.pi) - np.pi)
                parts[0, n], parts[1, n], parts[2, n] = np.pi - theta, dist, v
                totals[0] += np.pi - theta
                totals[1] += abs(dist)
                totals[2] += v
    # Dividing by infinity drops a part whose magnitudes add up to nothing.
    totals[totals <= 0.0] = np.inf
    best, chosen = -np.inf, -1
    for n in range(n_v * n_w):
        if admissible[n]:
            score = p.heading_weight * parts[0, n] / totals[0]
            score += p.clearance_weight * parts[1, n] / totals[1]
            score += p.velocity_weight * parts[2, n] / totals[2]
            if score > best:
                best, chosen = score, n
    if chosen < 0:
        turn = max(abs(w_now) - p.w_acc * p.dt, 0.0)
        return max(v_now - p.v_dec * p.dt, 0.0), turn if w_now > 0.0 else -turn
    return v_first + (chosen // n_w) * p.v_step, w_first + (chosen % n_w) * p.w_step


# --- what comes of it -------------------------------------------------------------------------


@nb.njit
def _advance(i, step, real, count, path, last, strides):  # type: ignore[no-untyped-def]
    """Move on to the next path point as long as that is nearer."""
    index = count[i, INDEX]
    here = np.hypot(path[i, index, 0] - real[i, X], path[i, index, 1] - real[i, Y])
    for _ in range(strides):
        further = min(index + 1, last[i])
        there = np.hypot(path[i, further, 0] - real[i, X], path[i, further, 1] - real[i, Y])
        if there <= here:
            index, here = further, there
    if index > count[i, INDEX]:
        count[i, INDEX], count[i, INDEX_STEP] = index, step


@nb.njit
def _touches(i, before, real, circles, p):  # type: ignore[no-untyped-def]
    """Return whether vessel i touched anything between two executed positions."""
    x, y = before[i, 0], before[i, 1]
    went_x, went_y = real[i, X] - x, real[i, Y] - y
    for j in range(real.shape[0]):
        if j != i:
            vx = real[j, X] - before[j, 0] - went_x
            vy = real[j, Y] - before[j, 1] - went_y
            if (
                least_distance(before[j, 0] - x, before[j, 1] - y, vx, vy, 1.0)
                < 2.0 * p.hull_radius
            ):
                return True
    for c in range(circles.shape[0]):
        least = least_distance(circles[c, 0] - x, circles[c, 1] - y, -went_x, -went_y, 1.0)
        if least < p.hull_radius + p.obstacle_radius:
            return True
    return False


@nb.njit
def _judge(i, step, hit, real, count, goal, max_steps, p):  # type: ignore[no-untyped-def]
    """Note what came of a step, and return whether vessel i sails on."""
    x, y = real[i, X], real[i, Y]
    if np.hypot(x - real[i, ANCHOR_X], y - real[i, ANCHOR_Y]) > p.stuck_distance:
        real[i, ANCHOR_X], real[i, ANCHOR_Y], count[i, ANCHOR_STEP] = x, y, step
    if count[i, STATUS] == RUNNING:
        count[i, ENDED] = step
        idle, nowhere = step - count[i, ANCHOR_STEP], step - count[i, INDEX_STEP]
        if np.hypot(goal[i, 0] - x, goal[i, 1] - y) <= p.goal_tolerance:
            count[i, STATUS] = REACHED
        elif idle * p.dt >= p.stuck_time or nowhere * p.dt >= p.livelock_time:
            count[i, STATUS] = STUCK
        elif step >= max_steps:
            count[i, STATUS] = TIMED_OUT
    if hit:
        count[i, STATUS] = COLLIDED
    return count[i, STATUS] == RUNNING


@nb.njit
def _episode(start, path, ahead, last, circles, problem, real, count):  # type: ignore[no-untyped-def]
    """Sail one fleet; `real` and `count` become its last state."""
    p, n = named(problem[0]), start.shape[0]
    strides, max_steps = problem[5], problem[6]
    real[:], count[:] = 0.0, 0
    real[:, X], real[:, Y], real[:, PSI], real[:, V] = start.T
    real[:, ANCHOR_X], real[:, ANCHOR_Y] = start[:, 0], start[:, 1]
    goal = np.empty((n, 2))
    for i in range(n):
        goal[i] = path[i, last[i]]
    roles = np.full((n, n), NONE)
    must, sees = np.zeros((n, n), np.bool_), np.zeros((n, n), np.bool_)
    wanted, orders, commands = np.zeros((n, n)), np.zeros((n, 3)), np.zeros((n, 2))
    parts = np.empty((3, problem[1] * problem[2]))
    admissible = np.empty(problem[1] * problem[2], np.bool_)
    step, sails = 0, False
    before = real[:, :2].copy()
    for i in range(n):
        hit = _touches(i, before, real, circles, p)
        sails |= _judge(i, step, hit, real, count, goal, max_steps, p)
    while sails:
        step += 1
        look_ahead(real, count, path, ahead, last, circles, p)
        meet(real, count, roles, must, sees, wanted, goal, p)
        for i in range(n):
            orders[i] = alter(i, real, count, roles, must, wanted, circles, p)
        for i in range(n):
            commands[i] = max(real[i, V] - p.v_dec * p.dt, 0.0), 0.0
            if count[i, STATUS] == RUNNING:
                commands[i] = _decide(i, orders[i], real, sees, circles, problem, parts, admissible)
        before[:] = real[:, :2]
        for i in range(n):
            v, w, psi = commands[i, 0], commands[i, 1], real[i, PSI]
            real[i, X] += v * p.dt * np.cos(psi)
            real[i, Y] += v * p.dt * np.sin(psi)
            real[i, PSI] = (psi + w * p.dt + np.pi) % (2.0 * np.pi) - np.pi
            real[i, V], real[i, W] = v, w
            real[i, LENGTH] += v * p.dt
            _advance(i, step, real, count, path, last, strides)
        sails = False
        for i in range(n):
            hit = _touches(i, before, real, circles, p)
            sails |= _judge(i, step, hit, real, count, goal, max_steps, p)


@nb.njit(parallel=True)
def _run(  # type: ignore[no-untyped-def]
    start,
    path,
    ahead,
    last,
    circles,
    numbers,
    n_v,
    n_w,
    horizon,
    shared,
    strides,
    most,
    real,
    count,
):
    for b in nb.prange(start.shape[0]):
        problem = (numbers, n_v, n_w, horizon, shared, strides, most)
        _episode(start[b], path[b], ahead[b], last[b], circles[b], problem, real[b], count[b])


def run(voyage: Voyage, circles: Real, static: FleetStatic, strides: int, shared: bool) -> Ended:
    """Sail the fleets of a voyage in open water.

    Args:
        voyage: all vessels present and under way; parameters one number each.
        circles: float64[B, K, 2], centres of its obstacles (m).
        static: choices of method.
        strides: path points that a vessel may pass in a step.
        shared: take the rollout's sines once for all speeds of a yaw rate.
    """
    fleets, n = voyage.start.shape[:2]
    numbers = np.array([float(getattr(voyage.params, name)) for name in Numbers._fields])
    routes = voyage.plan.routes
    real, count = np.empty((fleets, n, ARRIVAL + 1)), np.empty((fleets, n, ALTERED + 1), np.int64)
    sizes = (static.n_v, static.n_w, static.horizon, shared, strides, static.max_steps)
    points = np.asarray(routes.points, np.float64)
    ahead, last = np.asarray(routes.ahead), np.asarray(routes.last)
    _run(voyage.start, points, ahead, last, circles, numbers, *sizes, real, count)  # type: ignore[call-arg]
    return Ended(count[..., STATUS], count[..., ENDED], real[..., LENGTH])
