"""The state of fleets under way, what an episode begins with, and what comes of it.

Vessels are an axis before the lanes: arrays of a fleet are [n, lanes], of its pairs [n, n, lanes].
"""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.charted import Charted
from usvkernels.fleet.guidance import Routes
from usvkernels.fleet.sight import Obstacles
from usvkernels.status import Status
from usvkernels.vessel import Complex

ABSENT = -1
"""Status of a place in the fleet that nobody takes."""

BOOKS = 10
"""Reals of every fleet; what else a vessel model keeps follows them."""


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Jobs:
    """Episodes to run, one per row."""

    start: Array  # float[rows, n, 4], x, y (m), psi (rad), v (m/s)
    status: Array  # int32[rows, n], RUNNING, ABSENT, or why a vessel stays where it is
    routes: Routes
    obstacles: Array | None  # float[rows or 1, 2, K], centres (m), FAR pads; None on a chart
    velocities: Array | None = None  # likewise, of obstacles (m/s); None where all are at rest
    chart: Charted | None = None


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Fleet:
    """Episodes under way; lanes are the last axis."""

    reals: Array  # float[BOOKS or more, n, lanes]: x, y, psi, v, w, then as the properties say
    counts: Array  # int32[9, n, lanes], likewise
    roles: Array  # int32[n, n, lanes], of `rules`
    present: Array  # bool[n, lanes]
    obstacles: Obstacles | None  # at the start; None on a chart
    job: Array  # int32[lanes]
    steps: Array  # int32[lanes], control periods so far
    swept: dict[int, Array]  # float[n, lanes], the settings that differ, by place among the leaves

    @property
    def place(self) -> Complex:
        """X and y, [n, lanes] (m)."""
        return self.reals[0], self.reals[1]

    @property
    def motion(self) -> Array:
        """The state of the vessel model, float[5 or more, n, lanes]; see `models`."""
        if self.reals.shape[0] == BOOKS:
            return self.reals[:5]
        return jnp.concatenate([self.reals[:5], self.reals[BOOKS:]])

    @property
    def length(self) -> Array:
        """Distance sailed over ground (m)."""
        return self.reals[5]

    @property
    def clearance(self) -> Array:
        """Least distance so far to an obstacle's circle (m)."""
        return self.reals[6]

    @property
    def separation(self) -> Array:
        """Least distance so far between a vessel's hull and another's (m)."""
        return self.reals[7]

    @property
    def anchor(self) -> Complex:
        """Where the vessel last made way (m)."""
        return self.reals[8], self.reals[9]

    @property
    def under_way(self) -> Array:
        """Whose passage has not ended."""
        return self.status == int(Status.RUNNING)

    @property
    def status(self) -> Array:
        """`Status` of each vessel, RUNNING until its passage ends."""
        return self.counts[0]

    @property
    def ended_step(self) -> Array:
        """The step at which a vessel's passage ended."""
        return self.counts[1]

    @property
    def anchor_step(self) -> Array:
        """The step at `anchor`."""
        return self.counts[2]

    @property
    def index(self) -> Array:
        """The path point that the vessel has come to."""
        return self.counts[3]

    @property
    def index_step(self) -> Array:
        """The step at which it came there."""
        return self.counts[4]

    @property
    def altered(self) -> Array:
        """Which of `rules.CANDIDATES` the vessel is on."""
        return self.counts[5]

    @property
    def moving_step(self) -> Array:
        """The last step in which the vessel moved."""
        return self.counts[6]

    @property
    def around(self) -> Array:
        """How often it came to its goal on another heading, and went around."""
        return self.counts[7]

    @property
    def returns(self) -> Array:
        """Whether it is on the way back to where its guide segment begins."""
        return self.counts[8] > 0


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Outcome:
    """How episodes ended; leaves [episodes, n], but `steps` [episodes]."""

    status: Array  # int32, `Status` of each vessel, ABSENT for none
    ended_step: Array  # int32
    moving_step: Array  # int32, the last step in which the vessel moved
    livelock: Array  # bool, whether a STUCK vessel moved, but no further along its route
    path_length: Array  # float, m over ground
    clearance: Array  # float, m, inf where no obstacle was near
    separation: Array  # float, m, inf for a vessel alone
    place: Array  # float[episodes, n, 3], x, y (m), psi (rad) at rest
    steps: Array  # int32[episodes]
