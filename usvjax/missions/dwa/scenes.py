"""Where episodes take place: obstacle fields with a start and a goal, one per job.

Job j draws from `fold_in(key(seed), j)` and from nothing else, so its scenario does not
depend on the shard it is computed in, on how many jobs there are, or on the method. The
conditions of a study share the draws: a lattice point or disc that is an obstacle at a low
rate still is one at a higher rate, and a change of radius moves nothing, so differences
between conditions are paired as well.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import jax
import jax.numpy as jnp
import numpy as np
from scipy.stats import binom

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.missions.dwa.inputs import MOST_REMOTE
from usvjax.suggest import did_you_mean

RATE_MEANINGS = ("bernoulli", "count", "area")

MAX_DISCS = 10_000
MAX_LATTICE = 100_000  # points

# A lattice with Bernoulli obstacles gets as many rows as all but one map in ten million need;
# a shard with a fuller map is given all lattice points instead.
_OVERFLOW = 1e-7

# Conditions of nearly the same rate share their number of rows, and so their compiled kernels.
_ROWS = 32

_BLOCK = 64


@dataclass(frozen=True)
class Scenarios:
    """Scenarios of some jobs, in the order of the jobs.

    Attributes:
        obstacles: float32[J, K, 2], centres (m), or a map that all jobs share.
        valid: bool[J, K], False marks padding; None with a map.
        starts: float64[J, 3], x, y (m) and heading (rad).
        goals: float64[J, 2], m.
    """

    obstacles: np.ndarray | GridMap
    valid: np.ndarray | None
    starts: np.ndarray
    goals: np.ndarray


class Source(Protocol):
    """A generator of scenarios: the `[maps]` table of a study."""

    def check(self, radius: float, where: str) -> None:
        """Raise BadInputError when a value cannot be used with this vessel radius (m)."""
        ...

    def check_outside_goal(self, tolerance: float, where: str) -> None:
        """Raise BadInputError where a start may count as its goal: an episode would end in 0 s."""
        ...

    def draw(self, seed: int, jobs: np.ndarray, radius: float) -> Scenarios:
        """Return the scenarios of int64[J] jobs for obstacle circles of `radius` (m)."""
        ...


@dataclass(frozen=True)
class LatticeMaps:
    """Obstacles on the integer points of a square, as in the figures of Tan et al. 2022.

    Start and goal are never obstacles, and a point whose obstacle circle contains one of them
    is left out. The paper does not say what its obstacle rate is a share of, hence
    `rate_meaning`:

    - "bernoulli": each point is an obstacle with probability `rate`;
    - "count": exactly `rate` of the points are, rounded;
    - "area": so many that the circles add up to `rate` of the square's area, at most all
      points. This number, unlike the others, depends on the radius.

    Attributes:
        rate: obstacle rate, in [0, 1].
        rate_meaning: one of the above.
        lo, hi: integer corners of the square, m.
        start, goal: x, y, m.
        start_heading: rad; towards the goal when None.
    """

    rate: float = 0.3
    rate_meaning: str = "bernoulli"
    lo: int = 0
    hi: int = 10
    start: tuple[float, float] = (0.0, 0.0)
    start_heading: float | None = None
    goal: tuple[float, float] = (10.0, 10.0)

    def check(self, radius: float, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        check_square(self.lo, self.hi, where)
        check_share("rate", self.rate, where)
        check_ends(self.start, self.goal, self.start_heading, where)
        if (self.hi - self.lo + 1) ** 2 > MAX_LATTICE:
            raise BadInputError(
                f"{where}: 'lo' and 'hi' make {(self.hi - self.lo + 1) ** 2:,} lattice points; "
                f"wanted at most {MAX_LATTICE:,}"
            )
        if self.rate_meaning == "area":
            check_disc(radius, "rate_meaning", where)
        if self.rate_meaning not in RATE_MEANINGS:
            hint = did_you_mean(self.rate_meaning, RATE_MEANINGS)
            raise BadInputError(f"{where}: unknown rate_meaning {self.rate_meaning!r}; {hint}")

    def check_outside_goal(self, tolerance: float, where: str) -> None:
        """Raise BadInputError where the start counts as the goal."""
        check_outside_goal(self.start, self.goal, tolerance, where)

    def draw(self, seed: int, jobs: np.ndarray, radius: float) -> Scenarios:
        """Return the scenarios of int64[J] jobs for obstacle circles of `radius` (m)."""
        points = self._points()
        free = np.ones(len(points), bool)
        for end in (self.start, self.goal):
            free &= ~(points == np.asarray(end)).all(axis=-1)
        field = np.where(free, uniform_fields(seed, jobs, len(points)), np.inf)
        if self.rate_meaning == "bernoulli":
            chosen = field < self.rate
        else:
            chosen = _ranks(field) < self._count(radius, int(free.sum()))
        chosen &= outside_circles(points, (self.start, self.goal), radius)
        rows, valid = _compact(points, chosen, self._room(radius, int(free.sum())))
        starts, goals = fixed_ends(self.start, self.goal, self.start_heading, len(jobs))
        return Scenarios(rows, valid, starts, goals)

    def _points(self) -> np.ndarray:
        """Return all lattice points, float64[(hi - lo + 1)^2, 2], row by row."""
        line = np.arange(self.lo, self.hi + 1, dtype=np.float64)
        y, x = np.meshgrid(line, line, indexing="ij")
        return np.stack([x.ravel(), y.ravel()], axis=-1)

    def _count(self, radius: float, free: int) -> int:
        if self.rate_meaning == "count":
            return round(self.rate * free)
        return min(discs_for_share(self.rate, self.lo, self.hi, radius), free)

    def _room(self, radius: float, free: int) -> int:
        if self.rate_meaning == "bernoulli":
            return int(binom.ppf(1.0 - _OVERFLOW, free, self.rate))
        return self._count(radius, free)


@dataclass(frozen=True)
class RandomMaps:
    """Obstacle discs with centres uniform in a square; they may overlap.

    A disc that contains the start or the goal is left out. Give `number`, or `density`: discs
    whose areas add up to this share of the square.

    Attributes:
        number: discs per map.
        density: share of the square, in [0, 1].
        lo, hi: corners of the square, m.
        start, goal: x, y, m.
        start_heading: rad; towards the goal when None.
    """

    number: int | None = None
    density: float | None = None
    lo: float = 0.0
    hi: float = 10.0
    start: tuple[float, float] = (0.0, 0.0)
    start_heading: float | None = None
    goal: tuple[float, float] = (10.0, 10.0)

    def check(self, radius: float, where: str) -> None:
        """Raise BadInputError when a value cannot be used with this vessel radius (m)."""
        check_square(self.lo, self.hi, where)
        check_ends(self.start, self.goal, self.start_heading, where)
        if (self.number is None) == (self.density is None):
            raise BadInputError(f"{where}: give either 'number' or 'density'")
        if self.density is not None:
            check_share("density", self.density, where)
            check_disc(radius, "density", where)
        if not 0 <= self._count(radius) <= MAX_DISCS:
            raise BadInputError(
                f"{where}: between 0 and {MAX_DISCS} discs are possible, "
                f"got {self._count(radius):g} of radius {radius:g} m"
            )

    def check_outside_goal(self, tolerance: float, where: str) -> None:
        """Raise BadInputError where the start counts as the goal."""
        check_outside_goal(self.start, self.goal, tolerance, where)

    def draw(self, seed: int, jobs: np.ndarray, radius: float) -> Scenarios:
        """Return the scenarios of int64[J] jobs for obstacle circles of `radius` (m)."""
        unit = uniform_points(seed, jobs, self._count(radius))
        centres = self.lo + (self.hi - self.lo) * unit.astype(np.float64)
        valid = outside_circles(centres, (self.start, self.goal), radius)
        starts, goals = fixed_ends(self.start, self.goal, self.start_heading, len(jobs))
        return Scenarios(centres.astype(np.float32), valid, starts, goals)

    def _count(self, radius: float) -> int:
        if self.number is not None:
            return self.number
        return discs_for_share(self.density or 0.0, self.lo, self.hi, radius)


@partial(jax.jit, static_argnums=2)
def _fields(key: jax.Array, jobs: jax.Array, count: int) -> jax.Array:
    def field(job: jax.Array) -> jax.Array:
        return jax.random.uniform(jax.random.fold_in(key, job), (count,), jnp.float32)

    return jax.vmap(field)(jobs)


@partial(jax.jit, static_argnums=2)
def _points(key: jax.Array, jobs: jax.Array, count: int) -> jax.Array:
    def point(job_key: jax.Array, disc: jax.Array) -> jax.Array:
        return jax.random.uniform(jax.random.fold_in(job_key, disc), (2,), jnp.float32)

    def points(job: jax.Array) -> jax.Array:
        job_key = jax.random.fold_in(key, job)
        return jax.vmap(partial(point, job_key))(jnp.arange(count, dtype=jnp.uint32))

    return jax.vmap(points)(jobs)


def uniform_fields(seed: int, jobs: np.ndarray, count: int) -> np.ndarray:
    """Uniform numbers in [0, 1), float64[J, count], row j from `fold_in(key(seed), jobs[j])`."""
    key = jax.random.key(seed)
    return np.asarray(_fields(key, jnp.asarray(jobs, jnp.uint32), count), np.float64)


def uniform_points(seed: int, jobs: np.ndarray, count: int) -> np.ndarray:
    """Uniform points of the unit square, float32[J, count, 2].

    Point i has a key of its own, so that the first points of a job are the same whatever the
    count.
    """
    key = jax.random.key(seed)
    # Drawn in blocks, so that a sweep over counts meets few shapes to compile.
    drawn = _points(key, jnp.asarray(jobs, jnp.uint32), -(-count // _BLOCK) * _BLOCK)
    return np.asarray(drawn)[:, :count]


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


def fixed_ends(
    start: tuple[float, float], goal: tuple[float, float], heading: float | None, jobs: int
) -> tuple[np.ndarray, np.ndarray]:
    """Repeat one start and goal: float64[J, 3] poses and float64[J, 2] goals."""
    if heading is None:
        heading = math.atan2(goal[1] - start[1], goal[0] - start[0])
    starts = np.tile(np.asarray([*start, heading], np.float64), (jobs, 1))
    return starts, np.tile(np.asarray(goal, np.float64), (jobs, 1))


def check_share(name: str, value: float, where: str) -> None:
    """Raise BadInputError unless a share lies in [0, 1]."""
    if not 0.0 <= value <= 1.0:
        raise BadInputError(f"{where}: {name!r} must lie in [0, 1], got {value:g}")


def check_square(lo: float, hi: float, where: str) -> None:
    """Raise BadInputError unless lo < hi, both where single precision can tell metres apart."""
    if not -MOST_REMOTE <= lo < hi <= MOST_REMOTE:
        raise BadInputError(
            f"{where}: 'lo' must be below 'hi', both within {MOST_REMOTE:g} m of 0, got {lo:g} "
            f"and {hi:g}"
        )


def check_disc(radius: float, name: str, where: str) -> None:
    """Raise BadInputError where discs of no area are to cover a share of the square."""
    # What single precision cannot tell from 0 may have a square that is 0.
    if not np.float32(radius) > 0:
        raise BadInputError(
            f"{where}: {name!r} counts areas; wanted a radius above 0 in single precision, "
            f"got {radius:g}"
        )


def check_ends(
    start: tuple[float, float], goal: tuple[float, float], heading: float | None, where: str
) -> None:
    """Raise BadInputError unless start, goal and heading are finite and start is not the goal."""
    if not all(map(math.isfinite, (*start, *goal, heading or 0.0))):
        raise BadInputError(f"{where}: 'start', 'goal' and 'start_heading' must be finite")
    if start == goal:
        raise BadInputError(f"{where}: 'start' and 'goal' are the same point, {list(start)!r}")


def check_outside_goal(
    start: tuple[float, float], goal: tuple[float, float], tolerance: float, where: str
) -> None:
    """Raise BadInputError where a start counts as its goal: every episode would end in 0 s."""
    apart = math.dist(start, goal)
    if np.float32(apart) <= np.float32(tolerance):
        raise BadInputError(
            f"{where}: 'start' {list(start)!r} lies {apart:g} m from 'goal' {list(goal)!r}, within "
            f"'goal_tolerance' of {tolerance:g} m, so every episode would be over at once; "
            f"wanted them farther apart"
        )


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
