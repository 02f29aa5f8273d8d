"""The preset "pythonrobotics" against that demo's published rules, written anew.

The rules, as the demo states them: a step turns first and moves then; a command's cost is 0.15
times the angle to the goal at its end, plus the speed it lacks to the greatest, plus one over the
least distance to an obstacle anywhere on its trajectory, the present position included; a
command whose trajectory comes within the robot's radius of an obstacle is out; the lowest cost
wins. Three seconds are predicted in steps of 0.1 s.
"""

from dataclasses import dataclass
from math import inf, radians

import numpy as np

import usvjax as uj
from benchmarks.peers import SLACK

RADIUS, DT, STEPS = 1.0, 0.1, 30
V_LIMITS, W_LIMITS = (-0.5, 1.0), (-radians(40.0), radians(40.0))
V_ACC, W_ACC = 0.2, radians(40.0)
V_STEP, W_STEP = 0.01, radians(0.1)
GOAL_GAIN, SPEED_GAIN, OBSTACLE_GAIN = 0.15, 1.0, 1.0
TIE = 2e-5  # between two costs of which the kernel has float32


@dataclass(frozen=True)
class Costs:
    """What the demo's rules make of one situation."""

    v: np.ndarray  # [V], m/s
    w: np.ndarray  # [W], rad/s
    total: np.ndarray  # [V, W]; inf where the command is out
    nearest: np.ndarray  # [V, W], m


def window(now: float, limits: tuple[float, float], acc: float, step: float) -> np.ndarray:
    """Commands at the resolution, both ends of the window included."""
    low, high = max(limits[0], now - acc * DT), min(limits[1], now + acc * DT)
    return low + step * np.arange(int((high - low) / step + SLACK) + 1)


def demo(state: np.ndarray, goal: np.ndarray, obstacles: np.ndarray) -> Costs:
    v = window(state[3], V_LIMITS, V_ACC, V_STEP)
    w = window(state[4], W_LIMITS, W_ACC, W_STEP)
    x, y, yaw = (np.full((len(v), len(w)), coordinate) for coordinate in state[:3])
    nearest = np.full(x.shape, inf)
    for step in range(STEPS + 1):
        if step:
            yaw = yaw + w[None] * DT
            x = x + v[:, None] * np.cos(yaw) * DT
            y = y + v[:, None] * np.sin(yaw) * DT
        for ox, oy in obstacles:
            nearest = np.minimum(nearest, np.hypot(x - ox, y - oy))
    bearing = np.arctan2(goal[1] - y, goal[0] - x) - yaw
    angle = np.abs(np.arctan2(np.sin(bearing), np.cos(bearing)))
    obstacle_cost = np.where(nearest <= RADIUS, inf, 1.0 / nearest)
    speed_cost = V_LIMITS[1] - v[:, None]
    total = GOAL_GAIN * angle + SPEED_GAIN * speed_cost + OBSTACLE_GAIN * obstacle_cost
    return Costs(v, w, total, nearest)


def random_situation(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    state = np.array(
        [
            *rng.uniform(0.0, 10.0, 2),
            rng.uniform(-np.pi, np.pi),
            rng.uniform(*V_LIMITS),
            rng.uniform(*W_LIMITS),
        ]
    )
    obstacles = rng.uniform(-2.0, 12.0, (8, 2))
    goal = rng.uniform(0.0, 10.0, 2)
    state, goal, obstacles = (a.astype(np.float32).astype(float) for a in (state, goal, obstacles))
    return state, goal, obstacles


def test_preset_makes_the_demos_decisions() -> None:
    preset = uj.preset("pythonrobotics")
    rng = np.random.default_rng(5)
    n, ties, out = 300, 0, 0
    for _ in range(n):
        state, goal, obstacles = random_situation(rng)
        want = demo(state, goal, obstacles)
        got = uj.dwa_candidates(obstacles, state, goal, params=preset.params, static=preset.static)
        rows, columns = want.total.shape
        np.testing.assert_allclose(got.v[:rows], want.v, atol=1e-6)
        np.testing.assert_allclose(got.w[:columns], want.w, atol=1e-6)
        assert not got.admissible[rows:].any()
        assert not got.admissible[:, columns:].any()
        sure = np.abs(want.nearest - RADIUS) > 1e-5
        free = np.isfinite(want.total)
        admissible = got.admissible[:rows, :columns]
        np.testing.assert_array_equal(admissible[sure], free[sure])
        both = admissible & free
        # The score is the cost turned round: their sum is one number for all commands.
        constant = got.score[:rows, :columns][both] + want.total[both]
        assert not both.any() or np.ptp(constant) < TIE
        if got.chosen is None:
            out += 1
            assert not (free & sure).any()
        elif want.total[got.chosen] > want.total.min():
            ties += 1
            assert want.total[got.chosen] - want.total.min() < TIE
    assert ties <= 0.05 * n
    assert out < 0.5 * n


def test_preset_says_what_the_demo_says() -> None:
    preset = uj.preset("pythonrobotics")
    p, s = preset.params, preset.static
    assert (p.v_min, p.v_max, p.v_acc, p.v_dec, p.v_step) == (*V_LIMITS, V_ACC, V_ACC, V_STEP)
    assert (p.w_min, p.w_max, p.w_acc, p.w_dec, p.w_step) == (*W_LIMITS, W_ACC, W_ACC, W_STEP)
    gains = (p.heading_weight, p.velocity_weight, p.clearance_weight)
    assert gains == (GOAL_GAIN, SPEED_GAIN, OBSTACLE_GAIN)
    assert (p.dt, s.horizon, p.radius, p.goal_tolerance) == (DT, STEPS, RADIUS, RADIUS)
    assert (s.n_v, s.n_w) == (5, 81)


def test_a_step_turns_before_it_moves() -> None:
    preset = uj.preset("pythonrobotics")
    r = uj.navigate_dwa(
        [[50.0, 50.0]],
        [0.0, 0.0, 0.5],
        [6.0, 4.0],
        params=preset.params,
        static=preset.static,
        record=True,
    )
    assert r.status[0] == uj.Status.REACHED
    assert r.trajectory is not None
    before, after = r.trajectory[0, :-1].astype(float), r.trajectory[0, 1:].astype(float)
    np.testing.assert_allclose(after[:, 2], before[:, 2] + after[:, 4] * DT, atol=1e-6)
    moved = after[:, 3:4] * DT * np.stack((np.cos(after[:, 2]), np.sin(after[:, 2])), axis=1)
    np.testing.assert_allclose(after[:, :2] - before[:, :2], moved, atol=1e-6)
