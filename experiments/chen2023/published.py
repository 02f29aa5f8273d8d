"""What Chen et al. 2023 print on path planning.

Source: Z. Chen, Z. Zhao, J. Xu, X. Wang, Y. Lu, J. Yu, "A Cooperative Hunting Method for Multi-USV
Based on the A* Algorithm in an Environment with Obstacles", Sensors 23 (2023) 7058: Tables 1 to 3.
"""

from dataclasses import dataclass
from math import dist

SPEED = 15.0  # u, m/s, Table 1
YAW_RATE = 1.0  # r, rad/s, Table 1
EXPANSION = 1.5  # E, Table 1
PRINTED_RADIUS = 3.0  # R, m, Table 1
SAFETY_RANGE = 6.0  # R_s, m, Table 1

Point = tuple[float, float]
SCENE_1: tuple[Point, Point] = ((-55.0, -284.0), (291.0, -49.0))
ALGORITHMS = ("bspline", "proposed")


@dataclass(frozen=True)
class Planned:
    """What Table 3 prints of one algorithm.

    Attributes:
        time: planning time, s.
        length: path length, m.
        angle: total turning angle as printed, "161 deg 1548'": (161, "1548").
    """

    time: float
    length: float
    angle: tuple[int, str]


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
        Planned(0.90211, 701.87774, (161, "1548")),
        Planned(0.66402, 678.60917, (87, "0683")),
    ),
    Row(
        (-94.0, -27.0),
        (347.0, -451.0),
        Planned(0.97951, 725.15104, (45, "1268")),
        Planned(0.61845, 709.13587, (44, "1534")),
    ),
    Row(
        (400.0, 400.0),
        (-400.0, -400.0),
        Planned(1.24851, 1634.9875, (109, "8418")),
        Planned(0.75112, 1568.27831, (105, "7518")),
    ),
    Row(
        (400.0, -400.0),
        (-400.0, 400.0),
        Planned(1.190011, 1612.83788, (141, "4894")),
        Planned(0.74848, 1567.15489, (134, "4537")),
    ),
)
"""Its first row is Table 2."""

ENDS = (SCENE_1, *((row.start, row.end) for row in TABLE_3))
"""The five pairs of start and end points, m: that of Scene 1, then those of Table 3."""
