"""What the dynamic window approach leaves to choose, apart by what it is about.

Numbers are leaves, scalar or one per lane; what is marked static is part of the tree's structure,
and another value of it compiles anew. Defaults, and what each field means to a user, are with the
flat records of `usvjax.missions.dwa.params`.
"""

from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

import jax

from usvkernels.dwa.clearance import Scalar
from usvkernels.vessel import Plant

STATIC = {"static": True}


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Vessel:
    """What the vessel can do: limits of its commands, how long one holds, how it moves."""

    v_min: Scalar  # m/s
    v_max: Scalar  # m/s
    w_min: Scalar  # rad/s
    w_max: Scalar  # rad/s
    v_acc: Scalar  # m/s^2
    v_dec: Scalar  # m/s^2, magnitude
    w_acc: Scalar  # rad/s^2
    w_dec: Scalar  # rad/s^2, magnitude
    dt: Scalar  # s, control period
    plant: str | Plant = field(metadata=STATIC)  # a name of `vessel.PLANTS`, or a function


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Sampling:
    """Which commands of the window are tried, and how far ahead each is predicted."""

    v_step: Scalar  # m/s
    w_step: Scalar  # rad/s
    n_v: int = field(metadata=STATIC)
    n_w: int = field(metadata=STATIC)
    horizon: int = field(metadata=STATIC)  # steps of one control period


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Objective:
    """Which candidates are admitted, how they score, and what is done where there is none."""

    heading_weight: Scalar
    clearance_weight: Scalar
    velocity_weight: Scalar
    search_angle: Scalar  # rad
    clearance_cap: Scalar  # m
    clear_distance: Scalar  # m
    method: str = field(metadata=STATIC)
    clearance: str = field(metadata=STATIC)
    clearance_score: str = field(metadata=STATIC)
    normalise: str = field(metadata=STATIC)
    braking: bool = field(metadata=STATIC)
    when_blocked: str = field(metadata=STATIC)


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Rules:
    """When an episode is over."""

    radius: Scalar  # m, of the circles that are collided with
    goal_tolerance: Scalar  # m
    stuck_distance: Scalar  # m
    stuck_time: Scalar  # s
    max_steps: int = field(metadata=STATIC)


class Settings(NamedTuple):
    """All that an episode is sailed under."""

    vessel: Vessel
    sampling: Sampling
    objective: Objective
    rules: Rules
