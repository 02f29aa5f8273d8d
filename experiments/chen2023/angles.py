"""What the angles of Table 3 may mean: four digits after the degree sign, marked as minutes."""

from experiments.chen2023.published import Planned, Row

DIGITS = {"decimals": 10_000, "minutes": 60}
"""Ways to read these digits, and how many of them make a degree."""


def turning(planned: Planned, digits: str) -> float:
    """A total turning angle (deg), its digits read as one of DIGITS."""
    whole, part = planned.angle
    return whole + int(part) / DIGITS[digits]


def ratio(row: Row, metric: str, digits: str = "decimals") -> float:
    """Proposed over B-spline: of "time", "length" or "turning"."""
    ours, theirs = row.proposed, row.bspline
    if metric == "turning":
        return turning(ours, digits) / turning(theirs, digits)
    found: float = getattr(ours, metric) / getattr(theirs, metric)
    return found
