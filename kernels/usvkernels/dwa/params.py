"""What the dynamic window approach of Tan et al. 2022 leaves to choose."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import numpy as np

from usvkernels.dwa.clearance import Scalar


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class DwaParams:
    """Numbers of the method; each leaf a float, or float[lanes] to sweep it.

    Defaults are Table 1 of Tan et al. 2022; what the paper does not print says so.
    """

    v_min: Scalar = -1.0  # m/s, Table 1
    v_max: Scalar = 1.0  # m/s, Table 1
    w_min: Scalar = -0.5236  # rad/s, Table 1
    w_max: Scalar = 0.5236  # rad/s, Table 1
    v_acc: Scalar = 0.2  # m/s^2, Table 1
    v_dec: Scalar = 0.2  # m/s^2, magnitude, Table 1
    w_acc: Scalar = 0.8727  # rad/s^2, Table 1
    w_dec: Scalar = 0.8727  # rad/s^2, magnitude, Table 1
    v_step: Scalar = 0.01  # m/s, speed resolution, not printed
    w_step: Scalar = np.pi / 180  # rad/s, yaw-rate resolution, not printed
    heading_weight: Scalar = 0.05  # alpha, Table 1
    clearance_weight: Scalar = 0.2  # beta, Table 1
    velocity_weight: Scalar = 0.1  # gamma, Table 1
    dt: Scalar = 0.1  # s, control period, not printed
    search_angle: Scalar = np.pi / 3  # rad, phi, Table 1
    clearance_cap: Scalar = np.inf  # m, largest dist that scores, not printed
    clear_distance: Scalar = 2.0  # m, dist where no obstacle counts, not printed
    radius: Scalar = 0.5  # m, obstacle expansion circle, Tables 2 to 4
    goal_tolerance: Scalar = 0.5  # m, not printed
    stuck_distance: Scalar = 0.2  # m, an episode that stays within this ...
    stuck_time: Scalar = 20.0  # s, ... for this long is stuck

    @property
    def top_speed(self) -> Any:
        """Largest speed, ahead or astern (m/s), of parameters on the host."""
        return np.maximum(np.abs(self.v_min), np.abs(self.v_max))


@dataclass(frozen=True)
class DwaStatic:
    """Sizes and choices of method; hashable, a change compiles anew.

    Attributes:
      method: "traditional" (every obstacle counts) or "improved" (only those that the search
        sector at the predicted position meets; Tan et al. 2022, section 3).
      n_v, n_w: candidates along speed and yaw rate.
      horizon: Euler steps of the predicted trajectory; t_sim = horizon * dt.
      clearance: "endpoint" (at the predicted position, as in Tan's Fig. 1) or "trajectory"
        (the least over all predicted positions) or "trajectory_and_start" (the present one too).
      clearance_score: "distance", or "reciprocal": minus one over the distance to the centre.
      normalise: "sum" (by the sum of magnitudes over the admissible candidates), "range"
        (to 0..1 between the worst and the best) or "none".
      braking: whether Eq. 4 (able to stop before the obstacle) bounds the candidates.
      heading_first: whether a step turns before it moves, as one widely used demo has it,
        instead of after (Eq. 1).
      when_blocked: without an admissible candidate, "brake" (both rates towards zero) or
        "turn" (brake, and turn on towards the goal).
      max_steps: bound on the steps of an episode.
    """

    method: str = "traditional"
    n_v: int = 5
    n_w: int = 11
    horizon: int = 30
    clearance: str = "endpoint"
    clearance_score: str = "distance"
    normalise: str = "sum"
    braking: bool = True
    heading_first: bool = False
    when_blocked: str = "brake"
    max_steps: int = 1500  # 150 s, twice the longest time in Tan et al. 2022
