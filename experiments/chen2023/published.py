"""What Chen et al. 2023 print on path planning, and whether their numbers agree with each other.

Source: Z. Chen, Z. Zhao, J. Xu, X. Wang, Y. Lu, J. Yu, "A Cooperative Hunting Method for Multi-USV
Based on the A* Algorithm in an Environment with Obstacles", Sensors 23 (2023) 7058: Tables 1 to 3.
"""

from dataclasses import dataclass
from math import cos, dist, inf, pi, radians

SPEED = 15.0  # u, m/s, Table 1
YAW_RATE = 1.0  # r, rad/s, Table 1
EXPANSION = 1.5  # E, Table 1
PRINTED_RADIUS = 3.0  # R, m, Table 1
SAFETY_RANGE = 6.0  # R_s, m, Table 1
TURNING_RADIUS = SPEED / YAW_RATE  # m, of the circle that Table 1's speed and yaw rate make

Point = tuple[float, float]
SCENE_1: tuple[Point, Point] = ((-55.0, -284.0), (291.0, -49.0))
ALGORITHMS = ("bspline", "proposed")


@dataclass(frozen=True)
class Planned:
    """What Table 3 prints of one algorithm.

    Attributes:
        time: planning time, s.
        length: path length, m.
        angle: total turning angle as printed, "161 deg 1548'": (161, 1548), and the digits
            after the degree sign, which are four throughout.
    """

    time: float
    length: float
    angle: tuple[int, int]

    @property
    def degrees(self) -> float:
        """The angle with the digits read as decimals of a degree."""
        return self.angle[0] + self.angle[1] / 10_000

    @property
    def degrees_by_minutes(self) -> float:
        """The angle with the digits read as minutes, as they are marked."""
        return self.angle[0] + self.angle[1] / 60


@dataclass(frozen=True)
class Row:
    """A start and end point of Table 3, m, and both algorithms between them."""

    start: Point
    end: Point
    bspline: Planned
    proposed: Planned

    @property
    def straight(self) -> float:
        """Distance from start to end, m."""
        return dist(self.start, self.end)

    def of(self, algorithm: str) -> Planned:
        """The values of one of ALGORITHMS."""
        return self.bspline if algorithm == "bspline" else self.proposed


TABLE_3 = (
    Row(
        (181.0, -419.0),
        (-84.0, 103.0),
        Planned(0.90211, 701.87774, (161, 1548)),
        Planned(0.66402, 678.60917, (87, 683)),
    ),
    Row(
        (-94.0, -27.0),
        (347.0, -451.0),
        Planned(0.97951, 725.15104, (45, 1268)),
        Planned(0.61845, 709.13587, (44, 1534)),
    ),
    Row(
        (400.0, 400.0),
        (-400.0, -400.0),
        Planned(1.24851, 1634.9875, (109, 8418)),
        Planned(0.75112, 1568.27831, (105, 7518)),
    ),
    Row(
        (400.0, -400.0),
        (-400.0, 400.0),
        Planned(1.190011, 1612.83788, (141, 4894)),
        Planned(0.74848, 1567.15489, (134, 4537)),
    ),
)
"""Its first row is Table 2."""

ENDS = (SCENE_1, *((row.start, row.end) for row in TABLE_3))
"""The five pairs of start and end points, m: that of Scene 1, then those of Table 3."""


@dataclass(frozen=True)
class Check:
    """One comparison of printed numbers with each other.

    Attributes:
        where: which.
        printed: as printed, with units.
        wanted: what the other numbers want of it.
        verdict: "agrees" or "contradicts".
    """

    where: str
    printed: str
    wanted: str
    verdict: str


def arithmetic() -> list[Check]:
    """Compare the printed numbers with each other, under both readings of the angles."""
    return [
        Check(
            "Table 1: R against u / r",
            f"R = {PRINTED_RADIUS:g} m",
            f"{TURNING_RADIUS:g} m at {SPEED:g} m/s and {YAW_RATE:g} rad/s",
            "agrees" if PRINTED_RADIUS == TURNING_RADIUS else "contradicts",
        ),
        *(_smaller(place, row) for place, row in enumerate(TABLE_3, start=1)),
        *(
            _bound(place, row, algorithm, by_minutes)
            for by_minutes in (False, True)
            for place, row in enumerate(TABLE_3, start=1)
            for algorithm in ALGORITHMS
        ),
    ]


def _smaller(place: int, row: Row) -> Check:
    """The proposed path turns less, says the text; the minutes may say otherwise."""
    ours, theirs = row.proposed.degrees_by_minutes, row.bspline.degrees_by_minutes
    return Check(
        f"Table 3, row {place}: the proposed path turns less, digits as minutes",
        f"{ours:.1f} deg",
        f"less than {theirs:.1f} deg",
        "agrees" if ours < theirs else "contradicts",
    )


def _bound(place: int, row: Row, algorithm: str, by_minutes: bool) -> Check:
    planned = row.of(algorithm)
    angle = planned.degrees_by_minutes if by_minutes else planned.degrees
    most = longest(row.straight, angle)
    bound = f"at most {most:.1f} m" if most < inf else "any length"
    return Check(
        f"Table 3, row {place}, {algorithm}: length, "
        f"digits as {'minutes' if by_minutes else 'decimals'}",
        f"{planned.length:.1f} m",
        f"{bound} with {angle:.1f} deg of turning over {row.straight:.1f} m",
        "agrees" if planned.length <= most else "contradicts",
    )


def longest(straight: float, turning: float) -> float:
    """The longest a path can be that turns by a total of `turning` (deg) on its way.

    A curve of total curvature k < pi between points D apart is no longer than D / cos(k / 2):
    two equal sides are the longest (J. M. Sullivan, "Curves of finite total curvature", 2008).
    """
    angle = radians(turning)
    return straight / cos(angle / 2) if angle < pi else inf
