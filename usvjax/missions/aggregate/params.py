"""What gathering fleets leave to choose: as of fleets in general, with other defaults."""

from dataclasses import dataclass

from usvjax.missions.fleet.params import FleetParams, FleetStatic, Scalar


@dataclass(frozen=True)
class AggregateParams(FleetParams):
    """Numbers of a fleet that gathers; each one number, or float[B or 1, n], one per vessel.

    Attributes:
        goal_tolerance: distance from its slot within which a vessel stops (m). Not printed.
        livelock_time: a vessel that comes no further along its route for this (s) is stuck: where
            all meet, many have to come back. Not printed.
    """

    goal_tolerance: Scalar = 10.0
    livelock_time: Scalar = 1800.0


@dataclass(frozen=True)
class AggregateStatic(FleetStatic):
    """Choices of method, sizes, and how routes are laid; hashable.

    Attributes:
        max_steps: bound on the steps of an episode.
    """

    max_steps: int = 7200
