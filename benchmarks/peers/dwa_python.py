"""The dynamic window approach in plain Python, the way the popular demonstrations write it.

Nested loops over candidates, a list for each predicted trajectory, a loop over obstacles.
Endpoint clearance and normalisation by the sum only. All given obstacles count as existing.
"""

import math
from collections.abc import Sequence

from benchmarks.peers import SLACK, Settings

State = tuple[float, float, float, float, float]  # x, y, psi, v, w
Point = Sequence[float]


def motion(state: State, v: float, w: float, dt: float) -> State:
    """Move for one period under (v, w): one Euler step of Eq. 1, heading not wrapped."""
    x, y, psi = state[:3]
    return (x + v * dt * math.cos(psi), y + v * dt * math.sin(psi), psi + w * dt, v, w)


def window(
    now: float, low: float, high: float, dec: float, acc: float, step: float, n: int, dt: float
) -> list[tuple[int, float]]:
    """Return the candidates (index, value) that the limits allow within one period."""
    first = max(low, now - dec * dt)
    last = min(high, now + acc * dt) + SLACK * step
    values = [(i, first + i * step) for i in range(n)]
    return [(i, value) for i, value in values if value <= last]


def predict(state: State, v: float, w: float, params: Settings) -> list[State]:
    """Return the predicted trajectory, the current state first."""
    trajectory = [state]
    for _ in range(params.horizon):
        trajectory.append(motion(trajectory[-1], v, w, params.dt))
    return trajectory


def counts(end: State, obstacle: Point, params: Settings) -> bool:
    """Whether an obstacle's circle meets the search sector at the end of a prediction."""
    if params.method == "traditional":
        return True
    dx, dy = obstacle[0] - end[0], obstacle[1] - end[1]
    direction = end[2] if end[3] >= -SLACK * params.v_step else end[2] + math.pi
    off = abs(angle_difference(math.atan2(dy, dx), direction)) - params.search_angle
    away = math.hypot(dx, dy)
    if off <= 0.0:
        return True
    return (away * math.sin(off) if off < math.pi / 2.0 else away) <= params.radius


def clearance(end: State, obstacles: Sequence[Point], params: Settings) -> float:
    """Return the distance from the end of a prediction to the nearest circle, capped, m."""
    nearest = math.inf
    for obstacle in obstacles:
        if counts(end, obstacle, params):
            nearest = min(nearest, math.hypot(obstacle[0] - end[0], obstacle[1] - end[1]))
    distance = params.clear_distance if nearest == math.inf else nearest - params.radius
    return min(distance, params.clearance_cap)


def angle_difference(a: float, b: float) -> float:
    """Return a - b wrapped to [-pi, pi), rad."""
    return (a - b + math.pi) % (2.0 * math.pi) - math.pi


def decide(
    state: State, obstacles: Sequence[Point], goal: Point, params: Settings
) -> tuple[int, float, float]:
    """Weigh every candidate of one situation.

    Args:
        state: (x, y, psi, v, w).
        obstacles: centres (x, y), m.
        goal: (x, y), m.
        params: numbers and choices of the method.

    Returns:
        Index of the winner and its (v, w); -1 and a braking command where none is admissible.

    Raises:
        ValueError: `params` asks for an option that this peer does not have.
    """
    s = params
    if s.clearance != "endpoint" or s.normalise != "sum":
        raise ValueError(
            "the plain Python peer has clearance='endpoint' and normalise='sum' only, "
            f"got {s.clearance!r} and {s.normalise!r}"
        )
    found = []
    for i, v in window(state[3], s.v_min, s.v_max, s.v_dec, s.v_acc, s.v_step, s.n_v, s.dt):
        for j, w in window(state[4], s.w_min, s.w_max, s.w_dec, s.w_acc, s.w_step, s.n_w, s.dt):
            end = predict(state, v, w, s)[-1]
            distance = clearance(end, obstacles, s)
            if distance <= 0.0 or v**2 > 2.0 * distance * s.v_dec:
                continue
            if w**2 > 2.0 * distance * s.w_dec:
                continue
            bearing = math.atan2(goal[1] - end[1], goal[0] - end[0])
            heading = math.pi - abs(angle_difference(bearing, end[2]))
            found.append((i * s.n_w + j, v, w, heading, distance))
    if not found:
        return -1, brake(state[3], s.v_dec * s.dt), brake(state[4], s.w_dec * s.dt)
    heading_sum = sum(candidate[3] for candidate in found) or math.inf
    distance_sum = sum(candidate[4] for candidate in found) or math.inf
    speed_sum = sum(abs(candidate[1]) for candidate in found) or math.inf
    best_score, best = -math.inf, (-1, 0.0, 0.0)
    for n, v, w, heading, distance in found:
        score = (
            s.heading_weight * heading / heading_sum
            + s.clearance_weight * distance / distance_sum
            + s.velocity_weight * v / speed_sum
        )
        if score > best_score:
            best_score, best = score, (n, v, w)
    return best


def brake(now: float, limit: float) -> float:
    """Return the value after moving towards 0 by at most `limit`."""
    return math.copysign(max(abs(now) - limit, 0.0), now)


def run(
    pose: State, obstacles: Sequence[Point], goal: Point, params: Settings, steps: int
) -> State:
    """Take `steps` decisions of one episode in closed loop and return the final state.

    Arguments as for `decide`; the episode goes on after it reached or hit something.

    Raises:
        ValueError: `params` asks for an option that this peer does not have.
    """
    state = pose
    for _ in range(steps):
        _, v, w = decide(state, obstacles, goal, params)
        x, y, psi, v, w = motion(state, v, w, params.dt)
        state = (x, y, angle_difference(psi, 0.0), v, w)
    return state
