"""How a search, a plan or an episode ended."""

from enum import IntEnum


class Status(IntEnum):
    """One code for every ending; a failure is never dressed up as a long path."""

    RUNNING = 0
    REACHED = 1
    COLLIDED = 2
    STUCK = 3
    TIMED_OUT = 4
    PARTIAL = 5  # home again, but not all stations were visited
    FOUND = 10  # a path; the searches' success
    UNREACHABLE = 11  # proven: no path
    OUT_OF_BUDGET = 12  # a bound on steps or on length was met first
    BLOCKED = 13  # start or goal lies on a blocked cell
    NO_APPROACH = 14  # a route, but none that leads to the goal on the heading asked for


EPISODE_ENDINGS = (Status.REACHED, Status.COLLIDED, Status.STUCK, Status.TIMED_OUT)
FLEET_ENDINGS = (*EPISODE_ENDINGS, Status.UNREACHABLE)
AGGREGATE_ENDINGS = (*FLEET_ENDINGS, Status.NO_APPROACH)
CRUISE_ENDINGS = (
    Status.REACHED,
    Status.PARTIAL,
    Status.UNREACHABLE,
    Status.TIMED_OUT,
    Status.OUT_OF_BUDGET,
)
