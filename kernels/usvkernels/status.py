"""How a search, a plan or an episode ended."""

from enum import IntEnum


class Status(IntEnum):
    """One code for every ending; a failure is never dressed up as a long path."""

    RUNNING = 0
    REACHED = 1
    COLLIDED = 2
    STUCK = 3
    TIMED_OUT = 4
