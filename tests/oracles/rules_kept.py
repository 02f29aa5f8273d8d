"""Whether vessels kept the rules of the road, judged from their tracks alone, pair by pair.

NumPy and double precision; angles in degrees off the bow, to starboard above 0. It shares nothing
with `usvjax.missions.fleet.measures`: no code, no bounds.
"""

from typing import NamedTuple

import numpy as np

NOTICED = 10.0, 0.10
"""Alteration (deg), and share of the speed lost, from which others see that a vessel acts."""

APPARENT = 25.0, 0.40
"""What a vessel that gives way comes to at least (Rule 8 b)."""

HARDLY = 0.03
"""Share of the distance wanted that nobody acts for."""

EARLY = 120.0
"""s before the closest point of the first courses, by which it has begun (Rules 8 a, 16)."""

PLAIN = 75.0
"""s before contact, from which a vessel that stands on sees that the other does not act (17)."""

ARRIVING = 60.0
"""s before the end of a passage, in which a vessel slows down for its goal."""


class Verdict(NamedTuple):
    """What a vessel was to the other, and what it did wrong; "" for nothing."""

    role: str
    fault: str


def judge(track: np.ndarray, hulls: float, passing: float, dt: float) -> list[Verdict]:
    """Judge both vessels of a pair.

    Args:
        track: float64[T, 2, 5], x, y (m), psi (rad), v, w, both under way from the start on.
        hulls: sum of both radii (m).
        passing: distance wanted between them (m).
        dt: s.
    """
    return [_judged(track[:, i], track[:, 1 - i], hulls, passing, dt) for i in (0, 1)]


def bearing(own: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Of the other off own bow, deg in (-180, 180]; states float64[..., 5]."""
    east, north = other[..., 0] - own[..., 0], other[..., 1] - own[..., 1]
    return _wrapped(np.degrees(own[..., 2] - np.arctan2(north, east)))


def role_of(own: np.ndarray, other: np.ndarray) -> str:
    """What own ship is to the other at first sight (Rules 13 to 15), if they meet."""
    there, here = bearing(own, other), bearing(other, own)
    if abs(here) > 112.5:
        return "overtaking"
    if abs(there) > 112.5:
        return "overtaken"
    opposite = abs(_wrapped(np.degrees(own[2] - other[2]))) >= 174.0
    if (opposite and max(abs(there), abs(here)) <= 6.0) or (there > 0) == (here > 0):
        return "head-on"
    return "give way" if there > 0 else "stand on"


def closest(own: np.ndarray, other: np.ndarray) -> tuple[float, float]:
    """DCPA (m) and TCPA (s) of two states that keep course and speed."""
    place, velocity = other[:2] - own[:2], _velocity(other) - _velocity(own)
    square = velocity @ velocity
    time = -(place @ velocity) / square if square > 0 else 0.0
    return float(np.hypot(*(place + time * velocity))), float(time)


def _judged(own: np.ndarray, other: np.ndarray, hulls: float, passing: float, dt: float) -> Verdict:
    dcpa, tcpa = closest(own[0], other[0])
    if tcpa <= 0 or dcpa >= (1 - HARDLY) * (hulls + passing):
        return Verdict("none", "")
    role = role_of(own[0], other[0])
    if _least(own, other) < hulls:
        return Verdict(role, "contact")
    apart = np.hypot(*(other - own)[:, :2].T)
    sailing = np.flatnonzero(own[:, 3] > 0)[-1] - int(ARRIVING / dt)
    until = min(int(apart.argmin()), max(int(sailing), 0)) + 1
    turned = _wrapped(np.degrees(own[0, 2] - own[:, 2]))
    lost = 1 - own[:, 3] / own[0, 3]
    seen = (np.abs(turned) > NOTICED[0]) | (lost > NOTICED[1])
    acts = np.flatnonzero(seen[:until])
    if role in ("stand on", "overtaken"):
        return Verdict(role, _stood_on(own, other, acts, hulls))
    if not len(acts):
        return Verdict(role, "never acted")
    if tcpa - acts[0] * dt < EARLY:
        return Verdict(role, "late")
    if np.abs(turned[:until]).max() < APPARENT[0] and lost[:until].max() < APPARENT[1]:
        return Verdict(role, "not apparent")
    if role != "overtaking":
        if turned[acts[0]] < -NOTICED[0]:
            return Verdict(role, "to port")
        if _ahead(own, other) < hulls + 2 * passing:
            return Verdict(role, "crossed ahead")
    return Verdict(role, "")


def _stood_on(own: np.ndarray, other: np.ndarray, acts: np.ndarray, hulls: float) -> str:
    if not len(acts):
        return ""
    # As it sailed until then, not as it does now that it has altered.
    then = np.concatenate([own[acts[0], :2], own[0, 2:]])
    dcpa, tcpa = closest(then, other[acts[0]])
    speed = np.hypot(*(_velocity(other[acts[0]]) - _velocity(then)))
    if dcpa >= hulls or tcpa <= 0:
        return "acted without need"
    contact = tcpa - np.sqrt(hulls**2 - dcpa**2) / speed
    return "" if contact <= PLAIN else "acted early"


def _ahead(own: np.ndarray, other: np.ndarray) -> float:
    """Least distance (m) at which own ship crosses the line ahead of the other; inf if never."""
    off = own[:, :2] - other[:, :2]
    cos, sin = np.cos(other[:, 2]), np.sin(other[:, 2])
    along, across = cos * off[:, 0] + sin * off[:, 1], cos * off[:, 1] - sin * off[:, 0]
    # From its starboard side to its port side, or back, while it makes way.
    over = (across[:-1] > 0) != (across[1:] > 0)
    share = np.abs(across[:-1]) / np.maximum(np.abs(across[:-1]) + np.abs(across[1:]), 1e-12)
    at = along[:-1] + share * np.diff(along)
    met = at[over & (at > 0) & (other[1:, 3] > 0)]
    return float(met.min()) if len(met) else np.inf


def _least(own: np.ndarray, other: np.ndarray) -> float:
    """Least distance (m) between centres, along the segments between states."""
    off = (other - own)[:, :2]
    start, way = off[:-1], np.diff(off, axis=0)
    square = np.maximum(np.sum(way * way, axis=1), 1e-300)
    share = np.clip(-np.sum(start * way, axis=1) / square, 0.0, 1.0)
    return float(np.hypot(*(start + share[:, None] * way).T).min())


def _velocity(state: np.ndarray) -> np.ndarray:
    return state[3] * np.array([np.cos(state[2]), np.sin(state[2])])


def _wrapped(degrees: np.ndarray) -> np.ndarray:
    return -((-degrees + 180.0) % 360.0 - 180.0)
