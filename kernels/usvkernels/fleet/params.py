"""What a fleet's episode leaves to choose, besides what the dynamic window approach does.

Numbers are leaves: scalar, or float[n, lanes], one per vessel. What is marked static is part of the
tree's structure, and another value of it compiles anew. Defaults, and what each field means to a
user, are with the flat records of `usvjax.missions.fleet.params`.
"""

from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

import jax

from usvkernels.dwa.clearance import Scalar
from usvkernels.dwa.params import STATIC, Sampling, Vessel
from usvkernels.fleet.environment import Environment


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Objective:
    """What a candidate of the window scores by, each part over its sum of all that are admitted."""

    heading_weight: Scalar
    clearance_weight: Scalar
    velocity_weight: Scalar
    clearance_cap: Scalar  # m, from which clearance scores no more


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Passage:
    """Sizes, and when a vessel's passage is over."""

    hull_radius: Scalar  # m
    obstacle_radius: Scalar  # m, of the circles that are collided with
    goal_tolerance: Scalar  # m
    heading_tolerance: Scalar  # rad, to either side of the one to arrive on
    stuck_distance: Scalar  # m
    stuck_time: Scalar  # s
    livelock_time: Scalar  # s
    unit_length: Scalar  # m, between path points
    model: str = field(metadata=STATIC)  # a name of `models.MODELS`
    clearance: str = field(metadata=STATIC)  # a name of `steering.CLEARANCES`
    max_steps: int = field(metadata=STATIC)
    strides: int = field(metadata=STATIC)  # path points that a vessel may pass in a step


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Encounters:
    """How vessels that meet behave; see `rules`, `wei2023` and `orca`."""

    passing: Scalar  # m, wanted between hulls
    sight_time: Scalar  # s, before the closest point
    act_time: Scalar  # s, before contact
    threshold: Scalar  # m, between guidance points
    strategy: str = field(metadata=STATIC)
    equal: str = field(metadata=STATIC)
    ring: str = field(metadata=STATIC)


class Settings(NamedTuple):
    """All that a fleet is sailed under."""

    vessel: Vessel
    sampling: Sampling
    objective: Objective
    passage: Passage
    encounters: Encounters
    environment: Environment | None  # None for neither current nor wind
