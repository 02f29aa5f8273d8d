"""The dynamic window approach in vectorised NumPy, float64: contestant and main oracle.

Written straight from the description: a plain Euler loop predicts every candidate, angles come
from `arctan2`, the distance to the search sector is elementary geometry. Nothing is shared with
the JAX kernel, not even a formula rearranged for speed.

Sizes: S situations, K obstacles, V speeds, W yaw rates, N = V * W candidates (index i * W + j).
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from benchmarks.peers import SLACK, Settings
from usvkernels.status import Status

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Decision:
    """Everything one decision weighs, for S situations."""

    chosen: Ints  # [S] index of the winner, -1 where no candidate is admissible
    command: Floats  # [S, 2] (v, w) to execute, m/s and rad/s; braking where chosen is -1
    v: Floats  # [S, N] m/s
    w: Floats  # [S, N] rad/s
    end: Floats  # [S, N, 3] (x, y, heading) at the end of the prediction
    clearance: Floats  # [S, N] m, capped
    admissible: Bools  # [S, N]
    heading: Floats  # [S, N] pi - theta, rad
    score: Floats  # [S, N] weighted sum; -inf where not admissible
    margin: Floats  # [S, N] m, by how much the nearest yes/no question of distance was decided
    rate_margin: Floats  # [S, N] m/s or rad/s, the same for the questions of speed and yaw rate


def wrap(angle: Floats) -> Floats:
    """Return the angle in [-pi, pi) that is congruent to `angle`, rad."""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


def decide(
    states: Floats,
    obstacles: Floats,
    goals: Floats,
    settings: Settings,
    valid: Bools | None = None,
    chunk: int = 128,
) -> Decision:
    """Weigh every candidate of every situation.

    Args:
        states: float[S, 5] (x, y, psi, v, w).
        obstacles: float[S, K, 2] centres, m.
        goals: float[S, 2], m.
        settings: numbers and choices of the method.
        valid: bool[S, K], which obstacle rows exist; None means all.
        chunk: situations weighed at a time, so that the S x N x K arrays stay in cache.
    """
    if valid is None:
        valid = np.ones(obstacles.shape[:2], bool)
    parts = [
        _decide_chunk(states[rows], obstacles[rows], goals[rows], settings, valid[rows])
        for rows in (slice(at, at + chunk) for at in range(0, len(states), chunk))
    ]
    return Decision(
        **{
            name: np.concatenate([getattr(part, name) for part in parts])
            for name in Decision.__dataclass_fields__
        }
    )


def _decide_chunk(
    states: Floats, obstacles: Floats, goals: Floats, s: Settings, valid: Bools
) -> Decision:
    v, v_inside, v_margin = _window(
        states[:, 3], s.v_min, s.v_max, s.v_dec, s.v_acc, s.v_step, s.n_v, s.dt
    )
    w, w_inside, w_margin = _window(
        states[:, 4], s.w_min, s.w_max, s.w_dec, s.w_acc, s.w_step, s.n_w, s.dt
    )
    shape = (len(states), s.n_v * s.n_w)
    v, w = (a.reshape(shape) for a in _pairs(v, w))
    inside = np.logical_and(*_pairs(v_inside, w_inside)).reshape(shape)
    rate_margin = np.minimum(*_pairs(v_margin, w_margin)).reshape(shape)
    margin = np.full(shape, np.inf)

    paths = _rollout(states, v, w, s)
    end = paths[-1]
    distance = _distances(end[:, :, :2], obstacles)
    counted = np.broadcast_to(valid[:, None, :], distance.shape)
    if s.method == "improved":
        astern = v + SLACK * s.v_step
        course = np.where(astern >= 0.0, end[:, :, 2], end[:, :, 2] + np.pi)
        beyond = _sector_distance(end, course, obstacles, s.search_angle) - s.radius
        counted = counted & (beyond <= 0.0)
        doubt = np.where(valid[:, None, :], np.abs(beyond), np.inf).min(axis=2, initial=np.inf)
        margin = doubt
        rate_margin = np.minimum(rate_margin, np.abs(astern))
    if s.clearance == "trajectory":
        for position in paths[1:-1]:
            distance = np.minimum(distance, _distances(position[:, :, :2], obstacles))
    nearest = np.where(counted, distance, np.inf).min(axis=2, initial=np.inf) - s.radius
    clearance = np.minimum(np.where(np.isinf(nearest), s.clear_distance, nearest), s.clearance_cap)

    stops_v = clearance - v**2 / (2.0 * s.v_dec)
    stops_w = clearance - w**2 / (2.0 * s.w_dec)
    admissible = inside & (clearance > 0.0) & (stops_v >= 0.0) & (stops_w >= 0.0)
    for doubt in (clearance, stops_v, stops_w):
        margin = np.minimum(margin, np.abs(doubt))

    bearing = np.arctan2(goals[:, None, 1] - end[:, :, 1], goals[:, None, 0] - end[:, :, 0])
    heading = np.pi - np.abs(wrap(bearing - end[:, :, 2]))
    score = _score(heading, clearance, v, admissible, s)
    chosen = np.where(admissible.any(axis=1), score.argmax(axis=1), -1)
    command = _command(states, v, w, chosen, s)
    return Decision(
        chosen, command, v, w, end, clearance, admissible, heading, score, margin, rate_margin
    )


def _pairs(a: npt.NDArray, b: npt.NDArray) -> tuple[npt.NDArray, npt.NDArray]:
    """Spread [S, V] and [S, W] over the candidates [S, V, W]."""
    both = np.broadcast_arrays(a[:, :, None], b[:, None, :])
    return both[0], both[1]


def _window(
    now: Floats, low: float, high: float, dec: float, acc: float, step: float, n: int, dt: float
) -> tuple[Floats, Bools, Floats]:
    """Return the n candidates [S, n], which lie in the window, and how clearly they do."""
    first = np.maximum(low, now - dec * dt)
    last = np.minimum(high, now + acc * dt) + SLACK * step
    values = first[:, None] + np.arange(n) * step
    return values, values <= last[:, None], np.abs(values - last[:, None])


def _rollout(states: Floats, v: Floats, w: Floats, s: Settings) -> list[Floats]:
    """Predict every candidate by Euler steps of Eq. 1: horizon + 1 arrays [S, N, 3]."""
    x, y, psi = (np.broadcast_to(states[:, i, None], v.shape) for i in range(3))
    paths = [np.stack((x, y, psi), axis=2)]
    for _ in range(s.horizon):
        x = x + v * s.dt * np.cos(psi)
        y = y + v * s.dt * np.sin(psi)
        psi = psi + w * s.dt
        paths.append(np.stack((x, y, psi), axis=2))
    return paths


def _distances(points: Floats, obstacles: Floats) -> Floats:
    """Return the distances [S, N, K] from points [S, N, 2] to obstacles [S, K, 2], m."""
    dx = obstacles[:, None, :, 0] - points[:, :, None, 0]
    dy = obstacles[:, None, :, 1] - points[:, :, None, 1]
    return np.sqrt(dx * dx + dy * dy)


def _sector_distance(end: Floats, course: Floats, obstacles: Floats, half_angle: float) -> Floats:
    """Return the distance [S, N, K] from each obstacle centre to the search sector, m.

    The sector has its apex at the end of the prediction, opens by `half_angle` to both sides of
    the direction of motion `course` [S, N] there, and is unbounded.
    """
    dx = obstacles[:, None, :, 0] - end[:, :, None, 0]
    dy = obstacles[:, None, :, 1] - end[:, :, None, 1]
    off = np.abs(wrap(np.arctan2(dy, dx) - course[:, :, None])) - half_angle
    away = np.sqrt(dx * dx + dy * dy)
    return np.where(off <= 0.0, 0.0, np.where(off < np.pi / 2.0, away * np.sin(off), away))


def _score(heading: Floats, clearance: Floats, v: Floats, admissible: Bools, s: Settings) -> Floats:
    parts = [_normalise(part, admissible, s.normalise) for part in (heading, clearance, v)]
    weights = (s.heading_weight, s.clearance_weight, s.velocity_weight)
    total = weights[0] * parts[0] + weights[1] * parts[1] + weights[2] * parts[2]
    return np.where(admissible, total, -np.inf)


def _normalise(part: Floats, admissible: Bools, how: str) -> Floats:
    if how == "none":
        return part
    if how == "sum":
        low = np.zeros((len(part), 1))
        span = np.where(admissible, np.abs(part), 0.0).sum(axis=1, keepdims=True)
    else:
        low = np.where(admissible, part, np.inf).min(axis=1, keepdims=True)
        high = np.where(admissible, part, -np.inf).max(axis=1, keepdims=True)
        span = np.maximum(high - low, 0.0)
        low = np.where(np.isinf(low), 0.0, low)
    return np.where(span > 0.0, (part - low) / np.where(span > 0.0, span, 1.0), 0.0)


def _command(states: Floats, v: Floats, w: Floats, chosen: Ints, s: Settings) -> Floats:
    rows = np.arange(len(states))
    picked = np.stack((v[rows, chosen], w[rows, chosen]), axis=1)
    limits = np.array((s.v_dec, s.w_dec)) * s.dt
    now = states[:, 3:5]
    braked = np.sign(now) * np.maximum(np.abs(now) - limits, 0.0)
    return np.where(chosen[:, None] >= 0, picked, braked)


def advance(states: Floats, command: Floats, dt: float) -> Floats:
    """Execute (v, w) for one control period: one Euler step of Eq. 1, psi wrapped."""
    x, y, psi = states[:, 0], states[:, 1], states[:, 2]
    v, w = command[:, 0], command[:, 1]
    return np.stack(
        (x + v * dt * np.cos(psi), y + v * dt * np.sin(psi), wrap(psi + w * dt), v, w), axis=1
    )


def run(poses: Floats, obstacles: Floats, goals: Floats, params: Settings, steps: int) -> Floats:
    """Take `steps` decisions in closed loop and return the final states float[B, 5].

    Args:
        poses: float[B, 5] (x, y, psi, v, w).
        obstacles: float[B, K, 2] centres, m.
        goals: float[B, 2], m.
        params: numbers and choices of the method.
        steps: decisions per episode; an episode goes on after it reached or hit something.
    """
    states = poses
    for _ in range(steps):
        states = advance(states, decide(states, obstacles, goals, params).command, params.dt)
    return states


@dataclass(frozen=True)
class Episodes:
    """How B episodes went."""

    status: Ints  # [B], `usvkernels.status.Status`
    steps: Ints  # [B], control periods executed
    path_length: Floats  # [B], m
    min_clearance: Floats  # [B], m, over the executed positions, the start included
    trajectory: Floats  # [B, T, 5]; index 0 is the start, the last state repeats after the end


def episodes(
    starts: Floats,
    obstacles: Floats,
    goals: Floats,
    settings: Settings,
    valid: Bools | None = None,
) -> Episodes:
    """Run episodes from rest until each has ended.

    Args:
        starts: float[B, 3] (x, y, psi).
        obstacles: float[B, K, 2] centres, m.
        goals: float[B, 2], m.
        settings: numbers and choices of the method, and when an episode ends.
        valid: bool[B, K], which obstacle rows exist; None means all.
    """
    s = settings
    if valid is None:
        valid = np.ones(obstacles.shape[:2], bool)
    states = np.concatenate((starts, np.zeros((len(starts), 2))), axis=1)
    status = np.where(_gap(states, goals) <= s.goal_tolerance, Status.REACHED, Status.RUNNING)
    steps, anchor_step = np.zeros((2, len(states)), np.int64)
    path_length = np.zeros(len(states))
    anchor = states[:, :2].copy()
    clearance = _nearest(states, obstacles, valid) - s.radius
    trajectory = [states]
    for step in range(1, s.max_steps + 1):
        on = np.flatnonzero(status == Status.RUNNING)
        if not len(on):
            break
        command = decide(states[on], obstacles[on], goals[on], s, valid[on]).command
        states = states.copy()
        states[on] = advance(states[on], command, s.dt)
        steps[on] = step
        path_length[on] += np.abs(command[:, 0]) * s.dt
        here = _nearest(states[on], obstacles[on], valid[on]) - s.radius
        clearance[on] = np.minimum(clearance[on], here)
        left = on[_gap(states[on], anchor[on]) > s.stuck_distance]
        anchor[left], anchor_step[left] = states[left, :2], step
        there = _gap(states[on], goals[on]) <= s.goal_tolerance
        idle = (step - anchor_step[on]) * s.dt >= s.stuck_time
        late = np.full(len(on), step >= s.max_steps)
        codes = [Status.COLLIDED, Status.REACHED, Status.STUCK, Status.TIMED_OUT]
        status[on] = np.select([here < 0.0, there, idle, late], codes, Status.RUNNING)
        trajectory.append(states)
    return Episodes(status, steps, path_length, clearance, np.stack(trajectory, axis=1))


def _gap(states: Floats, points: Floats) -> Floats:
    return np.hypot(states[:, 0] - points[:, 0], states[:, 1] - points[:, 1])


def _nearest(states: Floats, obstacles: Floats, valid: Bools) -> Floats:
    distance = _distances(states[:, None, :2], obstacles)[:, 0]
    return np.where(valid, distance, np.inf).min(axis=1, initial=np.inf)
