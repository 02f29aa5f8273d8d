"""Where fleets meet: starts, goals, speeds and hulls of their vessels, one scene per job.

Job j's scene is a pure function of the seed and j (see `usvjax.maps.draws`), and all strategies
meet it. Crowds are in `usvjax.missions.fleet.crowds`.
"""

import math
from dataclasses import dataclass

import numpy as np

from usvjax.checks import one_of
from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.maps.draws import Stream, round_bits
from usvjax.maps.ends import facing
from usvjax.maps.sensed import MOST_REMOTE
from usvjax.missions.fleet.inputs import MOST_VESSELS
from usvjax.missions.fleet.params import FleetParams

ENCOUNTERS = ("head-on", "crossing", "overtaking")

# How far courses differ (deg), and from where on the faster one of two is overtaking.
_HEAD_ON, _CROSSING, _OVERTAKING = (174.0, 186.0), (30.0, 150.0), (-15.0, 15.0)
_FASTER = 1.25

# Beyond the closest point, goals lie so many sums of hull radii and so much (m) apart.
_APART, _BEYOND = 3.0, 500.0

Range = tuple[float, float]


@dataclass(frozen=True)
class FleetScenes:
    """Scenes of J jobs with fleets of n vessels, in the order of the jobs.

    Attributes:
        starts: float64[J, n, 3], x, y (m) and heading (rad).
        goals: float64[J, n, 2], m.
        speeds: float64[J, n], at the start, m/s.
        hulls: float64[J, n], radii, m; None: as the parameters say.
        limits: float64[J, n], largest speeds, m/s; None: as the parameters say.
        water: circles float32[J, K, 2], centres, m; a map that all jobs share; None: open water.
    """

    starts: np.ndarray
    goals: np.ndarray
    speeds: np.ndarray
    hulls: np.ndarray | None
    limits: np.ndarray | None
    water: np.ndarray | GridMap | None

    def circles(self, row: int) -> np.ndarray:
        """Centres of the obstacles of one episode, float64[K, 2], m; none on a map."""
        if isinstance(self.water, np.ndarray):
            return self.water[row].astype(np.float64)
        return np.empty((0, 2))

    def water_of(self, rows: slice) -> np.ndarray | GridMap | None:
        """The water of some episodes, as `navigate` takes it."""
        return self.water[rows] if isinstance(self.water, np.ndarray) else self.water

    @property
    def grid_map(self) -> GridMap | None:
        """The shared map, or None."""
        return self.water if isinstance(self.water, GridMap) else None


@dataclass(frozen=True)
class EncounterTable:
    """Two vessels at full speed on straight courses that bring them close to each other.

    Courses differ by 174 to 186 degrees (head-on), by 30 to 150 to either side (crossing), or by
    15 at most, the faster at least 1.25 times as fast and astern (overtaking). Goals lie on the
    courses beyond the closest point, clear of each other.

    Attributes:
        encounter: "head-on", "crossing", "overtaking", or "any" of them, each as likely.
        hulls: least and greatest hull radius drawn, m; in place of `params.hull_radius`.
        speeds: least and greatest speed drawn, m/s, which is also the largest of the vessel; in
            place of `params.v_max`.
        largest_dcpa: distance at the closest point, uniform up to so many sums of hull radii to
            either side; 0 or more.
        least_tcpa: least time from the start to the closest point, s, above 0; up to a half longer.
        least_room: the start is also at least so many times the hull radii and the stopping
            distances of both before the closest point; 2 or more.
        least_beyond: least time from the closest point to the goals, s, 0 or more.
    """

    encounter: str = "any"
    hulls: Range = (2.0, 50.0)
    speeds: Range = (2.5, 10.0)
    largest_dcpa: float = 3.0
    least_tcpa: float = 180.0
    least_room: float = 4.0
    least_beyond: float = 120.0

    most_jobs = None

    def check(self, params: FleetParams, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        one_of(f"{where}: 'encounter'", self.encounter, (*ENCOUNTERS, "any"))
        for name in ("hulls", "speeds"):
            low, high = getattr(self, name)
            if not 0.0 < low <= high < math.inf:
                raise BadInputError(
                    f"{where}: {name!r} must be two numbers above 0, the first not above the "
                    f"second, got {[low, high]!r}"
                )
        if self.encounter in ("overtaking", "any") and self.speeds[1] < _FASTER * self.speeds[0]:
            raise BadInputError(
                f"{where}: 'speeds' must reach {_FASTER:g} times the least one for a vessel to "
                f"overtake, got {list(self.speeds)!r}"
            )
        for name, least in (("largest_dcpa", 0.0), ("least_room", 2.0), ("least_beyond", 0.0)):
            if not least <= getattr(self, name) < math.inf:
                raise BadInputError(f"{where}: {name!r} must be at least {least:g}")
        if not 0.0 < self.least_tcpa < math.inf:
            raise BadInputError(f"{where}: 'least_tcpa' must be above 0, got {self.least_tcpa:g}")

    def draw(self, seed: int, jobs: np.ndarray, params: FleetParams) -> FleetScenes:
        """Return the scenes of int64[J] jobs."""
        kind, turn, course, side, later, *rest = uniforms(seed, jobs, 0, 9).T
        hulls = _within(self.hulls, np.stack(rest[:2], axis=1))
        kinds = 3 if self.encounter == "any" else 1
        first = 0 if self.encounter == "any" else ENCOUNTERS.index(self.encounter)
        which = first + (kind * kinds).astype(int)
        speeds = self._speeds(which == 2, np.stack(rest[2:], axis=1))
        courses = 2 * np.pi * course[:, None] + np.stack([0 * turn, _turned(which, turn)], axis=1)
        velocity = speeds[..., None] * np.stack([np.cos(courses), np.sin(courses)], axis=-1)
        relative = velocity[:, 1] - velocity[:, 0]
        closing = np.hypot(*relative.T)
        radii = hulls.sum(axis=1)
        stopping = (speeds**2).sum(axis=1) / (2.0 * float(params.v_dec))
        tcpa = np.maximum(self.least_tcpa, self.least_room * (radii + stopping) / closing)
        tcpa *= 1.0 + 0.5 * later
        across = np.stack([-relative[:, 1], relative[:, 0]], axis=1) / closing[:, None]
        dcpa = self.largest_dcpa * (2.0 * side - 1.0) * radii
        other = dcpa[:, None] * across - relative * tcpa[:, None]
        places = np.stack([np.zeros_like(other), other], axis=1)
        until = tcpa + np.maximum(self.least_beyond, (_APART * radii + _BEYOND) / closing)
        goals = places + velocity * until[:, None, None]
        starts = np.concatenate([places, courses[..., None]], axis=2)
        return FleetScenes(starts, goals, speeds, hulls, speeds, None)

    def _speeds(self, overtaking: np.ndarray, unit: np.ndarray) -> np.ndarray:
        """Speeds float64[J, 2] (m/s) from uniform numbers; who overtakes is the first."""
        low, high = self.speeds
        speeds = _within(self.speeds, unit)
        fast = _within((min(_FASTER * low, high), high), unit[:, 0])
        slow = _within((low, np.maximum(fast / _FASTER, low)), unit[:, 1])
        return np.where(overtaking[:, None], np.stack([fast, slow], axis=1), speeds)


@dataclass(frozen=True)
class SwapTable:
    """Vessels on a circle, at rest and facing its centre, that go to the opposite side.

    Attributes:
        vessels: of a fleet; 2 to 256.
        radius: of the circle, m, above 0.
        jitter: starts are moved by up to this share of the radius in x and in y; 0 or more. At 0
            all episodes are the same, and there is one.
    """

    vessels: int = 4
    radius: float = 3000.0
    jitter: float = 0.01

    @property
    def most_jobs(self) -> int | None:
        """One where nothing is drawn."""
        return 1 if self.jitter == 0.0 else None

    def check(self, params: FleetParams, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        check_vessels(self.vessels, where)
        for name, least in (("radius", 1e-3), ("jitter", 0.0)):
            if not least <= getattr(self, name) <= MOST_REMOTE / 2:
                raise BadInputError(f"{where}: {name!r} must be at least {least:g}, and finite")
        moved = 2 * math.sqrt(2) * self.jitter
        apart = self.radius * (2 * math.sin(math.pi / self.vessels) - moved)
        if not apart > 2 * float(params.hull_radius):
            raise BadInputError(
                f"{where}: {self.vessels} starts on a circle of {self.radius:g} m may lie "
                f"{max(apart, 0.0):.4g} m apart; wanted more than two hull radii of "
                f"{params.hull_radius:g} m"
            )

    def draw(self, seed: int, jobs: np.ndarray, params: FleetParams) -> FleetScenes:
        """Return the scenes of int64[J] jobs."""
        n = self.vessels
        angle = 2 * np.pi * np.arange(n) / n
        ring = self.radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        unit = uniforms(seed, jobs, 0, 2 * n).reshape(-1, n, 2)
        places = ring + self.jitter * self.radius * (2.0 * unit - 1.0)
        return at_rest(places, np.broadcast_to(-ring, places.shape), None)


def uniforms(
    seed: int,
    jobs: np.ndarray,
    number: int,
    count: int,
    size: int | None = None,
    stream: Stream = Stream.VESSELS,
) -> np.ndarray:
    """Uniform numbers in (0, 1), float64[J, count], of one round; arguments as of `round_bits`."""
    drawn = round_bits(seed, jobs, stream, number, count, size or len(jobs))
    return (np.asarray(drawn, np.float64).reshape(-1, count) + 0.5) / 2**32


def _within(span: tuple[float, float | np.ndarray], unit: np.ndarray) -> np.ndarray:
    low, high = span
    return low + (high - low) * unit


def _turned(which: np.ndarray, unit: np.ndarray) -> np.ndarray:
    """By how much the second course differs from the first (rad), by the kind of encounter."""
    # A crossing comes from either side: a half of the numbers each.
    crossing = np.copysign(_within(_CROSSING, np.abs(2.0 * unit - 1.0)), unit - 0.5)
    turns = (_within(_HEAD_ON, unit), crossing, _within(_OVERTAKING, unit))
    return np.radians(np.choose(which, turns))


def at_rest(
    places: np.ndarray, goals: np.ndarray, water: np.ndarray | GridMap | None
) -> FleetScenes:
    """Vessels of one kind at rest, the bow towards the goal."""
    flat = facing(places.reshape(-1, 2), goals.reshape(-1, 2))
    starts = flat.reshape(*places.shape[:2], 3)
    return FleetScenes(starts, np.array(goals), np.zeros(places.shape[:2]), None, None, water)


def check_vessels(vessels: int, where: str) -> None:
    """Raise BadInputError unless a fleet can have so many vessels."""
    if not 2 <= vessels <= MOST_VESSELS:
        raise BadInputError(f"{where}: 'vessels' must be 2 to {MOST_VESSELS}, got {vessels}")
