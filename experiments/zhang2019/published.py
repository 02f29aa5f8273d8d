"""What Zhang et al. 2019 print: Tables 3 and 4, and what these numbers say about their map.

Source: J. Zhang, F. Zhang, Z. Liu, Y. Li, "Efficient Path Planning Method of USV for Intelligent
Target Search", Journal of Geovisualization and Spatial Analysis, 2019.
"""

from dataclasses import dataclass

GAMMA = 0.5
"""Cost of a turn by 45 degrees, in squares (Eq. 6)."""
DIAGONAL = 1.4
"""Cost of a diagonal step, in squares."""


@dataclass(frozen=True)
class Row:
    """A row of Table 3, in squares."""

    total: float
    turning: float

    @property
    def length(self) -> float:
        """What is left of the total without the turning cost."""
        return self.total - self.turning


TRADITIONAL = Row(total=59.3, turning=15.5)
IMPROVED = Row(total=54.3, turning=10.5)

TIMES = {"traditional": 116.0, "improved": 124.0}
"""Table 4, ms."""


@dataclass(frozen=True)
class Steps:
    """One way to make up the published length.

    Attributes:
        straight, diagonal: steps.
        side: cells of a square map that a path from corner to corner with these steps and
            without detours crosses, None where there is no such map.
    """

    straight: int
    diagonal: int

    @property
    def side(self) -> int | None:
        """Each diagonal step goes one column and one row on, a straight one either."""
        squares = self.straight + 2 * self.diagonal
        return None if squares % 2 else squares // 2 + 1


def steps_of(length: float) -> list[Steps]:
    """All numbers of steps that add up to a length with a diagonal cost of 1.4."""
    tenths = round(10 * length)
    return [
        Steps((tenths - 14 * diagonal) // 10, diagonal)
        for diagonal in range(tenths // 14 + 1)
        if (tenths - 14 * diagonal) % 10 == 0
    ]


@dataclass(frozen=True)
class Check:
    """One of the paper's numbers against the others.

    Attributes:
        where: which number.
        printed: as printed.
        recomputed: from the other numbers.
        agrees: whether they agree.
    """

    where: str
    printed: str
    recomputed: str
    agrees: bool


def arithmetic() -> list[Check]:
    """Compare the paper's numbers with each other."""
    slower = TIMES["improved"] / TIMES["traditional"] - 1.0
    return [
        Check(
            "Table 3, turning cost, traditional",
            f"{TRADITIONAL.turning} at {GAMMA} per 45 deg",
            f"{TRADITIONAL.turning / GAMMA:g} turns by 45 deg",
            (TRADITIONAL.turning / GAMMA).is_integer(),
        ),
        Check(
            "Table 3, turning cost, improved",
            f"{IMPROVED.turning} at {GAMMA} per 45 deg",
            f"{IMPROVED.turning / GAMMA:g} turns by 45 deg",
            (IMPROVED.turning / GAMMA).is_integer(),
        ),
        Check(
            "Table 3, length without turning",
            "not printed",
            f"{TRADITIONAL.length:.1f} and {IMPROVED.length:.1f}: the paths are equally long",
            abs(TRADITIONAL.length - IMPROVED.length) < 1e-9,
        ),
        Check(
            'Table 4, "only 6 % lower" performance',
            "6 %",
            f"124 / 116 is {100 * slower:+.1f} % of time, "
            f"{100 * (1 - 1 / (1 + slower)):.1f} % fewer queries a second",
            True,
        ),
    ]
