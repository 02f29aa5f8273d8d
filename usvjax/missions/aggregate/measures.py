"""How far a fleet is from its formation at every step of a record."""

from typing import Any

import numpy as np

from usvjax.angles import wrapped
from usvjax.checks import MOST_SINGLE, float_array
from usvjax.errors import BadInputError
from usvjax.missions.aggregate.run import of_fleets
from usvjax.missions.fleet.inputs import presence
from usvjax.paths.inputs import MOST_COORDINATE


def formation_errors(trajectory: Any, slots: Any, valid: Any = None) -> np.ndarray:
    """Largest distance of a vessel from its slot over time, float64[B, T] (m).

    Args:
        trajectory: float[B, T, n, 5], of `aggregate`.
        slots: float[B, n, 2], each vessel's (m), likewise.
        valid: bool[B, n], False for a place in the fleet that nobody takes. None: all are taken.

    Raises:
        BadTypeError, BadInputError: other types or shapes, numbers that are not finite.
    """
    track, present = _checked(trajectory, valid)
    fleets, _, n, _ = track.shape
    goals = float_array("slots", slots, (fleets, n, 2), MOST_COORDINATE)
    off = np.linalg.norm(track[..., :2] - goals[:, None], axis=-1)
    return _largest(off, present)


def heading_errors(trajectory: Any, heading: Any, valid: Any = None) -> np.ndarray:
    """Largest difference of a vessel's heading from the formation's over time, float64[B, T] (rad).

    Args:
        trajectory: float[B, T, n, 5], of `aggregate`.
        heading: float[B] or one number (rad), likewise.
        valid: bool[B, n], False for a place in the fleet that nobody takes. None: all are taken.

    Raises:
        BadTypeError, BadInputError: other types or shapes, numbers that are not finite.
    """
    track, present = _checked(trajectory, valid)
    wanted = of_fleets("heading", heading, len(track), ())
    off = wrapped(track[..., 2] - wanted[:, None, None])
    return _largest(np.abs(off), present)


def _checked(trajectory: Any, valid: Any) -> tuple[np.ndarray, np.ndarray]:
    """The record, and bool[B, n], who is there."""
    track = float_array("trajectory", trajectory, (None, None, None, 5), MOST_SINGLE)
    if not track.size:
        raise BadInputError(
            f"trajectory: got shape {track.shape}; wanted at least one step of at least one fleet "
            "of at least one vessel"
        )
    return track, presence(valid, (track.shape[0], track.shape[2]))


def _largest(off: np.ndarray, present: np.ndarray) -> np.ndarray:
    found: np.ndarray = np.where(present[:, None], off, 0.0).max(axis=2)
    return found
