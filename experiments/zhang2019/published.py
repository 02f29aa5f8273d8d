"""What Zhang et al. 2019 print on their obstacle avoidance: Eq. 6, Tables 3 and 4.

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
LOWER = 6.0
"""By how much the performance is lower, %."""
