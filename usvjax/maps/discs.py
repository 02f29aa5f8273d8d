"""Obstacle discs with centres uniform in a square, and circles about points in general."""

import math

import numpy as np

from usvjax.errors import BadInputError
from usvjax.maps.draws import uniform_points

MAX_DISCS = 10_000


def uniform_discs(
    seed: int,
    jobs: np.ndarray,
    number: int,
    lo: float,
    hi: float,
    ends: tuple[tuple[float, float], ...],
    radius: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Draw discs that may overlap; one that contains an end is left out.

    A job's first discs are the same whatever their number, and their centres whatever the radius.

    Args:
        seed: of the study.
        jobs: int64[J].
        number: K, discs per job, those left out included.
        lo, hi: corners of the square, m.
        ends: points (x, y) that stay free, m.
        radius: of the discs, m.

    Returns:
        float32[J, K, 2] centres, m, and bool[J, K], False where a disc is left out.
    """
    centres = lo + (hi - lo) * uniform_points(seed, jobs, number).astype(np.float64)
    return centres.astype(np.float32), outside_circles(centres, ends, radius)


def discs_for_share(share: float, lo: float, hi: float, radius: float) -> int:
    """How many discs of `radius` (m) add up to a share of the square's area; overlaps ignored."""
    return round(share * (hi - lo) ** 2 / (math.pi * radius**2))


def outside_circles(
    points: np.ndarray, ends: tuple[tuple[float, float], ...], radius: float
) -> np.ndarray:
    """Whether the circle of `radius` (m) about each of float[..., 2] points holds no end."""
    outside = np.ones(points.shape[:-1], bool)
    for end in ends:
        outside &= np.hypot(*np.moveaxis(points - np.asarray(end), -1, 0)) > radius
    return outside


def check_square(lo: float, hi: float, most: float, where: str) -> None:
    """Raise BadInputError unless lo < hi, both at most `most` (m) from 0."""
    if not -most <= lo < hi <= most:
        raise BadInputError(
            f"{where}: 'lo' must be below 'hi', both within {most:g} m of 0, got {lo:g} and {hi:g}"
        )


def check_has_area(radius: float, name: str, where: str) -> None:
    """Raise BadInputError where discs of no area are to cover a share of the square."""
    # What single precision cannot tell from 0 may have a square that is 0.
    if not np.float32(radius) > 0:
        raise BadInputError(
            f"{where}: {name!r} counts areas; wanted a radius above 0 in single precision, "
            f"got {radius:g}"
        )


def check_number(number: float, radius: float, where: str) -> None:
    """Raise BadInputError unless 0 to MAX_DISCS discs of `radius` (m) are wanted."""
    if not 0 <= number <= MAX_DISCS:
        raise BadInputError(
            f"{where}: between 0 and {MAX_DISCS} discs are possible, "
            f"got {number:g} of radius {radius:g} m"
        )
