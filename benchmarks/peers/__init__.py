"""Peers: the dynamic window approach as it is written today, without JAX.

They serve twice: as contestants in the benchmarks and, in float64, as oracles of the kernels.
All of them follow one description of the method (Tan et al. 2022) and share one set of numbers.
"""

from dataclasses import dataclass
from math import inf, pi

SLACK = 1e-3
"""Share of a step that rounding may add: to the window's end, and to astern of standing still.

A vessel at rest has a candidate whose speed is zero but for rounding; it looks ahead.
"""


@dataclass(frozen=True)
class Settings:
    """Numbers and choices of one dynamic window; the defaults are Tan et al. 2022, Table 1.

    `dwa_numpy` knows every option. `dwa_numba` and `dwa_python` are written for
    `clearance="endpoint"` and `normalise="sum"` and refuse anything else.
    """

    v_min: float = -1.0  # m/s
    v_max: float = 1.0  # m/s
    w_min: float = -0.5236  # rad/s
    w_max: float = 0.5236  # rad/s
    v_acc: float = 0.2  # m/s^2
    v_dec: float = 0.2  # m/s^2, magnitude
    w_acc: float = 0.8727  # rad/s^2
    w_dec: float = 0.8727  # rad/s^2, magnitude
    v_step: float = 0.01  # m/s between candidates
    w_step: float = pi / 180.0  # rad/s between candidates
    heading_weight: float = 0.05
    clearance_weight: float = 0.2
    velocity_weight: float = 0.1
    dt: float = 0.1  # s, control period and Euler step
    search_angle: float = pi / 3.0  # rad, half-angle of the obstacle search sector
    clearance_cap: float = inf  # m
    clear_distance: float = 2.0  # m, clearance when no obstacle counts
    radius: float = 0.5  # m, obstacle expansion circle
    goal_tolerance: float = 0.5  # m
    stuck_distance: float = 0.0525  # m, an episode that stays within this ...
    stuck_time: float = 20.0  # s, ... for this long is stuck
    max_steps: int = 2000  # bound on the steps of an episode
    n_v: int = 5  # speeds in the window
    n_w: int = 11  # yaw rates in the window
    horizon: int = 30  # Euler steps of the predicted trajectory
    method: str = "traditional"  # or "improved"
    clearance: str = "endpoint"  # or "trajectory"
    normalise: str = "sum"  # or "range" or "none"
