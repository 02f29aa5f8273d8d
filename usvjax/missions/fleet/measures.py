"""What an observer notes of every pair of a recorded fleet: who met whom how, and who did what.

Written in NumPy and double precision on recorded tracks alone: it knows nothing of the strategies,
so it judges them all alike. Made for open water, where a vessel that meets nobody keeps its course.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

from usvjax.angles import wrapped
from usvjax.batches import filled
from usvjax.checks import MOST_SINGLE, any_array, float_array, positive
from usvjax.errors import BadInputError
from usvjax.missions.fleet.inputs import MOST_VESSELS
from usvjax.missions.fleet.params import FleetParams
from usvjax.public import public


class MeetingKind(IntEnum):
    """How two vessels meet, of which the rules know three ways."""

    NONE = 0
    HEAD_ON = 1
    CROSSING = 2
    OVERTAKING = 3


NONE, HEAD_ON, CROSSING, OVERTAKING = MeetingKind
KINDS = ("none", "head-on", "crossing", "overtaking")

AHEAD, ABAFT = np.cos(np.radians(6.0)), np.cos(np.radians(112.5))
UNDER_WAY = 0.9
"""Of a vessel's largest speed, with which it is seen for the first time."""

ALTERED, SLOWED = np.radians(10.0), 0.1
"""What another vessel would notice: a course altered so much, a share of the speed lost."""

SLIGHT = 0.97
"""Of the distance wanted, as near as which vessels pass without having to act."""

LAST_MOMENT = 60.0
"""Seconds before contact, from which a stand-on vessel may act as well."""


@dataclass(frozen=True)
class Meetings:
    """Pairs of B fleets, [B, n, n]: of vessel i with vessel j; numpy arrays.

    Attributes:
        kind: int, `MeetingKind` by the bearings at first sight; NONE where the two would not pass
            within the distance wanted, or hardly.
        gives_way: bool, whether i gives way to j.
        bearing: of j off the bow of i at first sight, to port positive (rad).
        dcpa, tcpa: at first sight, between centres (m) and from then (s).
        action_time: when i first altered course or speed so that it shows (s); inf if never.
        action_dcpa, action_tcpa: then; NaN if never.
        action_contact: then, how long until hulls would have touched (s), had it gone on; inf where
            they would not have; NaN if never.
        least_distance: between hulls (m), over the record.
        to_starboard, to_port: largest alterations of i until the two are closest (rad).
        slowest: of i until then, as a share of its speed at first sight.
        kept: bool, whether i did what the rules ask of it.
    """

    kind: np.ndarray
    gives_way: np.ndarray
    bearing: np.ndarray
    dcpa: np.ndarray
    tcpa: np.ndarray
    action_time: np.ndarray
    action_dcpa: np.ndarray
    action_tcpa: np.ndarray
    action_contact: np.ndarray
    least_distance: np.ndarray
    to_starboard: np.ndarray
    to_port: np.ndarray
    slowest: np.ndarray
    kept: np.ndarray


@public()
def meetings(trajectory: Any, hull_radius: Any, passing: float, dt: float) -> Meetings:
    """Note what happened between the vessels of recorded fleets.

    Args:
        trajectory: float[B, T, n, 5], of `navigate`.
        hull_radius: float[B, n] or float[1, n] (m).
        passing: distance wanted between hulls (m); pairs that would pass farther off do not meet.
        dt: control period (s).

    Raises:
        BadTypeError, BadInputError: other types or shapes, numbers that single precision does not
            hold, hulls below 0 m.
    """
    track = float_array("trajectory", trajectory, (None, None, None, 5), MOST_SINGLE)
    fleets, _, n, _ = track.shape
    if not track.size or n > MOST_VESSELS:
        raise BadInputError(
            f"trajectory: got shape {track.shape}; wanted at least one step of at least one fleet "
            f"of 1 to {MOST_VESSELS} vessels"
        )
    hull = any_array("hull_radius", hull_radius, "float[B or 1, n]")
    rows = 1 if hull.shape[:1] == (1,) else fleets
    hull = float_array("hull_radius", hull, (rows, n), MOST_SINGLE)
    if (hull < 0).any():
        raise BadInputError(f"hull_radius: got {hull.min():g} m; wanted 0 m or more")
    hull = np.broadcast_to(hull, (fleets, n))
    wanted = positive("passing", passing)
    step = positive("dt", dt)
    parts = [
        _pair(track[:, :, i], track[:, :, j], hull[:, i] + hull[:, j], wanted, step)
        for i in range(n)
        for j in range(n)
    ]
    names = list(Meetings.__annotations__)
    made = {
        name: np.stack([part[name] for part in parts], axis=1).reshape(fleets, n, n)
        for name in names
    }
    own = np.eye(n, dtype=bool)
    made["kind"][:, own], made["gives_way"][:, own], made["kept"][:, own] = NONE, False, True
    return Meetings(**made)


def meetings_of(
    states: Sequence[np.ndarray], hull_radius: np.ndarray, params: FleetParams
) -> Meetings:
    """As `meetings`, of records that end when their fleets do.

    Args:
        states: float64[T, n, 5] of each fleet.
        hull_radius: float64[B, n] (m).
        params: the distance wanted and the control period.
    """
    most = max(map(len, states))
    track = np.stack([filled(own, most) for own in states])
    return meetings(track, hull_radius, float(params.passing), float(params.dt))


def _pair(
    own: np.ndarray, other: np.ndarray, hulls: np.ndarray, passing: float, dt: float
) -> dict[str, np.ndarray]:
    """Of vessels [B, T, 5]: what the first does about the second."""
    row = np.arange(len(own))
    first = np.maximum(_seen(own), _seen(other))
    apart = np.linalg.norm(other[..., :2] - own[..., :2], axis=-1)
    time = np.arange(apart.shape[1])
    apart_since = np.where(time >= first[:, None], apart, np.inf)
    closest = apart_since.argmin(axis=1)
    place, velocity = _relative(own[row, first], other[row, first])
    dcpa, tcpa = _approach(place, velocity)
    kind, gives = _roles(own[row, first], other[row, first], place)
    bearing = wrapped(np.arctan2(place[:, 1], place[:, 0]) - own[row, first, 2])
    meets = (tcpa > 0) & (dcpa < SLIGHT * (hulls + passing))
    kind, gives = np.where(meets, kind, NONE), gives & meets
    turned = wrapped(own[..., 2] - own[row, first, 2][:, None])
    speed = own[..., 3] / np.maximum(own[row, first, 3], 1e-9)[:, None]
    during = (time >= first[:, None]) & (time <= closest[:, None])
    acted = during & ((np.abs(turned) > ALTERED) | (speed < 1 - SLOWED))
    action = acted.argmax(axis=1)
    never = ~acted.any(axis=1)
    then_dcpa, then_tcpa = _approach(*_relative(own[row, action], other[row, action]))
    starboard = np.where(during, -turned, 0.0).max(axis=1)
    port = np.where(during, turned, 0.0).max(axis=1)
    found = {
        "kind": kind,
        "gives_way": gives,
        "bearing": bearing,
        "dcpa": dcpa,
        "tcpa": tcpa,
        "action_time": np.where(never, np.inf, action * dt),
        "action_dcpa": np.where(never, np.nan, then_dcpa),
        "action_tcpa": np.where(never, np.nan, then_tcpa),
        "least_distance": apart.min(axis=1) - hulls,
        "to_starboard": starboard,
        "to_port": port,
        "slowest": np.where(during, speed, np.inf).min(axis=1),
    }
    # Once clear it may come back to its route from starboard: what counts is its first action.
    began_to_port = turned[row, action] > ALTERED
    unaltered = own[row, action]
    unaltered[:, 2:4] = own[row, first, 2:4]
    contact = _contact(unaltered, other[row, action], hulls)
    acted_well = ~began_to_port & (_ahead(own, other) >= hulls + 2 * passing)
    kept = _kept(found, acted_well, never, contact)
    return found | {"kept": kept, "action_contact": np.where(never, np.nan, contact)}


def _kept(
    found: dict[str, np.ndarray], acted_well: np.ndarray, never: np.ndarray, contact: np.ndarray
) -> np.ndarray:
    """Whether a vessel did what its role asks.

    Args:
        found: of the pairs.
        acted_well: whether it did not begin to port, nor cross ahead of the other but far off.
        never: whether the vessel never acted.
        contact: how long before contact it did (s), as it sailed until then; inf for none.
    """
    kind, gives = found["kind"], found["gives_way"]
    clear = found["least_distance"] > 0
    in_time = ~never & (contact > LAST_MOMENT)
    yields = clear & in_time & acted_well
    overtakes = clear & in_time
    stands = clear & (never | (contact <= LAST_MOMENT))
    role = np.where(kind == OVERTAKING, overtakes, yields)
    return np.where(kind == NONE, True, np.where(gives, role, stands))


def _ahead(own: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Least distance at which the first crosses ahead of the other (m); inf if it does not."""
    place = own[..., :2] - other[..., :2]
    cos, sin = np.cos(other[..., 2]), np.sin(other[..., 2])
    along = cos * place[..., 0] + sin * place[..., 1]
    port = cos * place[..., 1] - sin * place[..., 0] > 0
    crosses = (port[:, 1:] != port[:, :-1]) & (along[:, 1:] > 0) & (other[:, 1:, 3] > 0)
    least: np.ndarray = np.where(crosses, along[:, 1:], np.inf).min(axis=1)
    return least


def _seen(track: np.ndarray) -> np.ndarray:
    """Step of [B, T, 5] from which a vessel is well under way."""
    speed = track[..., 3]
    return (speed >= UNDER_WAY * speed.max(axis=1, keepdims=True)).argmax(axis=1)


def _velocity(state: np.ndarray) -> np.ndarray:
    bow = np.stack([np.cos(state[:, 2]), np.sin(state[:, 2])], axis=1)
    return state[:, 3, None] * bow


def _relative(own: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return other[:, :2] - own[:, :2], _velocity(other) - _velocity(own)


def _approach(place: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """DCPA (m) and TCPA (s); for equal velocities the distance, and 0."""
    square = np.sum(velocity**2, axis=1)
    time = -np.sum(place * velocity, axis=1) / np.where(square > 0, square, 1.0)
    time = np.where(square > 0, time, 0.0)
    return np.linalg.norm(place + velocity * time[:, None], axis=1), time


def _contact(own: np.ndarray, other: np.ndarray, hulls: np.ndarray) -> np.ndarray:
    """When straight courses would bring hulls into contact (s); inf if they would not."""
    dcpa, tcpa = _approach(*_relative(own, other))
    speed = np.linalg.norm(_velocity(other) - _velocity(own), axis=1)
    half = np.sqrt(np.maximum(hulls**2 - dcpa**2, 0.0)) / np.maximum(speed, 1e-9)
    return np.where((dcpa < hulls) & (tcpa > 0), np.maximum(tcpa - half, 0.0), np.inf)


def _roles(own: np.ndarray, other: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Kind of meeting, and whether the first gives way, by Rules 13 to 15."""
    distance = np.maximum(np.linalg.norm(place, axis=1), 1e-9)

    def bearing(state: np.ndarray, to: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        cos, sin = np.cos(state[:, 2]), np.sin(state[:, 2])
        ahead = (cos * to[:, 0] + sin * to[:, 1]) / distance
        return ahead, cos * to[:, 1] - sin * to[:, 0] < 0

    ahead, starboard = bearing(own, place)
    theirs, their_starboard = bearing(other, -place)
    reciprocal = np.cos(own[:, 2] - other[:, 2]) <= -AHEAD
    overtaken, overtakes = ahead < ABAFT, theirs < ABAFT
    both = (reciprocal & (ahead >= AHEAD) & (theirs >= AHEAD)) | (starboard == their_starboard)
    head_on = both & ~overtaken & ~overtakes
    kind = np.where(overtaken | overtakes, OVERTAKING, np.where(head_on, HEAD_ON, CROSSING))
    gives = np.where(kind == OVERTAKING, overtakes & ~overtaken, head_on | starboard)
    return kind, gives
