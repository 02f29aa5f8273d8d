"""Whether the numbers of Chen et al. 2023 agree with each other."""

from math import cos, inf, pi, radians

from experiments.chen2023.angles import DIGITS, turning
from experiments.chen2023.published import (
    ALGORITHMS,
    PRINTED_RADIUS,
    SPEED,
    TABLE_3,
    YAW_RATE,
    Row,
)
from experiments.claims import Check

AGREES, CONTRADICTS = "agrees", "contradicts"


def checks() -> list[Check]:
    """Compare the printed numbers with each other, under both readings of the angles."""
    radius = SPEED / YAW_RATE
    return [
        Check(
            "Table 1: R against u / r",
            f"R = {PRINTED_RADIUS:g} m",
            f"{radius:g} m at {SPEED:g} m/s and {YAW_RATE:g} rad/s",
            AGREES if radius == PRINTED_RADIUS else CONTRADICTS,
        ),
        *(_smaller(place, row, d) for d in DIGITS for place, row in enumerate(TABLE_3, start=1)),
        *(
            _bound(place, row, algorithm, digits)
            for digits in DIGITS
            for place, row in enumerate(TABLE_3, start=1)
            for algorithm in ALGORITHMS
        ),
    ]


def _smaller(place: int, row: Row, digits: str) -> Check:
    """The proposed path turns less, says the text; the digits may say otherwise."""
    ours, theirs = turning(row.proposed, digits), turning(row.bspline, digits)
    return Check(
        f"Table 3, row {place}: the proposed path turns less, digits as {digits}",
        f"{ours:.1f} deg",
        f"less than {theirs:.1f} deg",
        AGREES if ours < theirs else CONTRADICTS,
    )


def _bound(place: int, row: Row, algorithm: str, digits: str) -> Check:
    planned = row.of(algorithm)
    angle = turning(planned, digits)
    most = longest(row.straight, angle)
    bound = f"at most {most:.1f} m" if most < inf else "any length"
    return Check(
        f"Table 3, row {place}, {algorithm}: length, digits as {digits}",
        f"{planned.length:.1f} m",
        f"{bound} with {angle:.1f} deg of turning over {row.straight:.1f} m",
        AGREES if planned.length <= most else CONTRADICTS,
    )


def longest(straight: float, turning: float) -> float:
    """The longest a path can be that turns by a total of `turning` (deg) on its way.

    A curve of total curvature k < pi between points D apart is no longer than D / cos(k / 2):
    two equal sides are the longest (J. M. Sullivan, "Curves of finite total curvature", 2008).
    """
    angle = radians(turning)
    return straight / cos(angle / 2) if angle < pi else inf
