"""Imazu's problem: 22 situations in which one to three vessels come upon own ship at one point.

If nobody acts, all are at the meeting point at the same time. Own ship is vessel 0, heads north
and has it at the origin.

Source: headings as found in public copies of the Imazu problem, as used by Sawada, Sato and
Majima, J. Mar. Sci. Technol. 26, 2021. Copies differ: situations 5 and 8 are the same in most, 15
and 22 in all, and some have other places. Here places follow from the headings, so all meet.
"""

from dataclasses import dataclass

import numpy as np

from usvjax.checks import positive
from usvjax.errors import BadInputError
from usvjax.missions.fleet.params import FleetParams
from usvjax.missions.fleet.scenes import FleetScenes
from usvjax.public import public
from usvjax.units import KNOT

HEADINGS: dict[int, tuple[int, ...]] = {
    1: (180,),
    2: (-90,),
    3: (0,),
    4: (45,),
    5: (180, -90),
    6: (-10, -45),
    7: (0, -45),
    8: (180, -90),
    9: (-30, -90),
    10: (-90, 15),
    11: (90, -30),
    12: (180, -45, -10),
    13: (180, 10, 45),
    14: (-10, -45, -90),
    15: (0, -45, -90),
    16: (45, 90, -90),
    17: (0, 10, -45),
    18: (-135, -15, -30),
    19: (15, -15, -135),
    20: (0, -15, -90),
    21: (-15, 15, -90),
    22: (0, -45, -90),
}
"""Of the others by number of the situation, deg clockwise from own ship's."""

SPEED, SLOW = 10 * KNOT, 4 * KNOT
"""m/s; a vessel on own ship's heading would never meet it at the same speed, so it is slow."""

MEETING_TIME = 720.0
"""s from the start to the meeting point."""

HULL_RADIUS = 50.0
"""m, by default."""

MOST = 1 + max(map(len, HEADINGS.values()))
"""Vessels of the largest situation."""

_AWAY, _APART = 5e4, 1e3
"""m, how far off a place lies that nobody takes, and how far its goal and the next are from it."""


@dataclass(frozen=True)
class Situations:
    """All situations, as `navigate` takes them; places that nobody takes are far away, at rest.

    Attributes:
        starts: float64[22, 4, 3], x, y (m) and heading (rad).
        goals: float64[22, 4, 2], m, as far beyond the meeting point.
        speeds: float64[22, 4], at the start, m/s.
        valid: bool[22, 4].
        params: numbers, the largest speeds those at the start.
    """

    starts: np.ndarray
    goals: np.ndarray
    speeds: np.ndarray
    valid: np.ndarray
    params: FleetParams

    @property
    def velocities(self) -> np.ndarray:
        """At the start, float64[22, 4, 2], m/s."""
        psi = self.starts[..., 2]
        return self.speeds[..., None] * np.stack([np.cos(psi), np.sin(psi)], axis=-1)


@public()
def imazu(hull_radius: float = HULL_RADIUS) -> Situations:
    """All 22 situations, in their order; own ship is vessel 0 of each.

    Args:
        hull_radius: of every vessel (m).

    Raises:
        BadTypeError, BadInputError: a radius that is not a number above 0.
    """
    hull = positive("hull_radius", hull_radius)
    count = len(HEADINGS)
    starts, speeds = np.zeros((count, MOST, 3)), np.zeros((count, MOST))
    starts[..., 0] = _AWAY + 2 * _APART * np.arange(MOST)
    valid = np.zeros((count, MOST), bool)
    for row, headings in enumerate(HEADINGS.values()):
        n = 1 + len(headings)
        starts[row, :n], speeds[row, :n] = _placed(headings)
        valid[row, :n] = True
    goals = np.where(valid[..., None], -starts[..., :2], starts[..., :2] + _APART)
    limits = np.where(valid, speeds, SPEED)
    return Situations(starts, goals, speeds, valid, FleetParams(v_max=limits, hull_radius=hull))


@dataclass(frozen=True)
class ImazuTable:
    """One of Imazu's 22 situations: own ship and one to three others, which all meet at one point.

    All sail at 10 kn, those on own ship's heading at 4 kn, and would be there after 12 minutes.

    Attributes:
        situation: its number, 1 to 22.
        hull: radius of every vessel, m, above 0; in place of `params.hull_radius`.
    """

    situation: int = 1
    hull: float = HULL_RADIUS

    most_jobs = 1

    def check(self, params: FleetParams, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        if self.situation not in HEADINGS:
            raise BadInputError(
                f"{where}: 'situation' must be 1 to {len(HEADINGS)}, got {self.situation}"
            )
        positive(f"{where}: 'hull'", self.hull)

    def draw(self, seed: int, jobs: np.ndarray, params: FleetParams) -> FleetScenes:
        """Return the scene, the same for all of int64[J] jobs."""
        starts, speeds = (
            np.repeat(one[None], len(jobs), axis=0) for one in _placed(HEADINGS[self.situation])
        )
        hulls = np.full(speeds.shape, self.hull)
        return FleetScenes(starts, -starts[..., :2], speeds, hulls, speeds, None)


def _placed(headings: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Starts float64[n, 3] (m, rad) and speeds float64[n] (m/s) of own ship and the others."""
    compass = np.radians([0, *headings])
    speeds = np.where(compass == 0, SLOW, SPEED)
    speeds[0] = SPEED
    course = np.stack([np.sin(compass), np.cos(compass)], axis=1)
    places = -MEETING_TIME * speeds[:, None] * course
    return np.column_stack([places, np.pi / 2 - compass]), speeds
