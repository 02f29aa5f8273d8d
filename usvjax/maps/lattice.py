"""Obstacles on the integer points of a square, as in the figures of Tan et al. 2022.

Ends (start and goal) are never obstacles, and a point whose obstacle circle contains one of them
is left out. The paper does not say what its obstacle rate is a share of, hence three meanings:

- "bernoulli": each point is an obstacle with probability `rate`;
- "count": exactly `rate` of the points are, rounded;
- "area": so many that the circles add up to `rate` of the square's area, at most all points. This
  number, unlike the others, depends on the radius.

A point that is an obstacle at a low rate still is one at a higher rate, and a change of radius
moves nothing, so that differences between conditions of a study are paired.
"""

import numpy as np
import scipy

from usvjax.checks import shown
from usvjax.errors import BadInputError
from usvjax.maps.discs import check_has_area, discs_for_share, outside_circles
from usvjax.maps.draws import uniform_fields
from usvjax.suggest import did_you_mean

RATE_MEANINGS = ("bernoulli", "count", "area")

MAX_LATTICE = 100_000  # points

# A lattice with Bernoulli obstacles gets as many rows as all but one map in ten million need;
# a shard with a fuller map is given all lattice points instead.
_OVERFLOW = 1e-7

# Conditions of nearly the same rate share their number of rows, and so their compiled kernels.
_ROWS = 32


def lattice_obstacles(
    seed: int,
    jobs: np.ndarray,
    rate: float,
    meaning: str,
    lo: int,
    hi: int,
    ends: tuple[tuple[float, float], ...],
    radius: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Draw which points of a lattice are obstacles.

    Args:
        seed: of the study.
        jobs: int64[J].
        rate: of obstacles, in [0, 1].
        meaning: of the rate, one of RATE_MEANINGS.
        lo, hi: corners of the square, m.
        ends: points (x, y) that stay free, m.
        radius: of the obstacle circles, m.

    Returns:
        float32[J, K, 2] centres, m, a job's obstacles first, and bool[J, K], which they are.
    """
    points = _points(lo, hi)
    free = np.ones(len(points), bool)
    for end in ends:
        free &= ~(points == np.asarray(end)).all(axis=-1)
    room = int(free.sum())
    field = np.where(free, uniform_fields(seed, jobs, len(points)), np.inf)
    if meaning == "bernoulli":
        chosen = field < rate
        # What scipy.stats.binom.ppf gives, without the second that loading all its laws takes.
        shares = scipy.special.bdtr(np.arange(room + 1.0), room, rate)
        most = int(np.searchsorted(shares, 1.0 - _OVERFLOW))
    else:
        wanted = rate * room if meaning == "count" else discs_for_share(rate, lo, hi, radius)
        most = min(round(wanted), room)
        chosen = _ranks(field) < most
    chosen &= outside_circles(points, ends, radius)
    return _compact(points, chosen, most)


def check_lattice(rate_meaning: str, lo: int, hi: int, radius: float, where: str) -> None:
    """Raise BadInputError where a lattice is too large, or its rate has no such meaning."""
    count = (hi - lo + 1) ** 2
    if count > MAX_LATTICE:
        raise BadInputError(
            f"{where}: 'lo' and 'hi' make {count:,} lattice points; wanted at most {MAX_LATTICE:,}"
        )
    if rate_meaning == "area":
        check_has_area(radius, "rate_meaning", where)
    if rate_meaning not in RATE_MEANINGS:
        hint = did_you_mean(rate_meaning, RATE_MEANINGS)
        raise BadInputError(f"{where}: unknown rate_meaning {shown(rate_meaning)}; {hint}")


def _points(lo: int, hi: int) -> np.ndarray:
    """All lattice points, float64[(hi - lo + 1)^2, 2], row by row."""
    line = np.arange(lo, hi + 1, dtype=np.float64)
    y, x = np.meshgrid(line, line, indexing="ij")
    return np.stack([x.ravel(), y.ravel()], axis=-1)


def _ranks(field: np.ndarray) -> np.ndarray:
    """Rank float[J, N] within each row from 0; of equal values the first counts as lower."""
    order = np.argsort(field, axis=-1, kind="stable")
    ranks = np.empty_like(order)
    np.put_along_axis(ranks, order, np.arange(field.shape[-1])[None, :], axis=-1)
    return ranks


def _compact(points: np.ndarray, chosen: np.ndarray, room: int) -> tuple[np.ndarray, np.ndarray]:
    """Gather each job's chosen points in the first rows: float32[J, K, 2] and bool[J, K].

    K is `room` rounded up to a multiple of 32, or all points where a job has more than that;
    nothing but speed depends on it, since the rest is masked.
    """
    rows = min(max(_ROWS, -(-room // _ROWS) * _ROWS), len(points))
    counts = chosen.sum(axis=-1)
    if counts.size and counts.max() > rows:
        rows = len(points)
    order = np.argsort(~chosen, axis=-1, kind="stable")[:, :rows]
    return points[order].astype(np.float32), np.arange(rows) < counts[:, None]
