"""Where routes are sought: maps with a start and a goal cell, one per job.

Job j draws from `fold_in(key(seed), j)` and from nothing else, so its query depends neither on
the shard it is computed in, nor on how many jobs there are, nor on the method. Random maps of
several densities share their uniform field: a denser one only has more blocked cells.
"""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import jax
import jax.numpy as jnp
import numpy as np
from scipy import ndimage

from usvjax.errors import BadInputError
from usvjax.maps import GridMap, random_maps
from usvjax.maps.tables import MapSource, OnChart
from usvjax.missions.dwa.scenes import check_share
from usvjax.suggest import did_you_mean

ENDS = ("free", "connected", "harbours")

# A start without any goal is drawn again, so often at most.
_ROUNDS = 1000

# Random maps draw from fold_in(key, job); starts and goals must not see the same numbers.
_STREAM = 1


@dataclass(frozen=True)
class Queries:
    """Queries of some jobs, in the order of the jobs.

    Attributes:
        blocked: bool[H, W] shared or bool[J, H, W], what routes keep off.
        land: likewise, what clearance is measured from; the map before it was inflated.
        starts, goals: int32[J, 2], cells (x, y).
        published: float64[J], published lengths of the shortest routes, cells; or None.
    """

    blocked: np.ndarray
    land: np.ndarray
    starts: np.ndarray
    goals: np.ndarray
    published: np.ndarray | None = None


class QuerySource(MapSource, Protocol):
    """A generator of queries: the `[maps]` table of a study."""

    @property
    def shape(self) -> tuple[int, int]:
        """(H, W): rows and columns of the maps."""
        ...

    @property
    def most_jobs(self) -> int | None:
        """How many queries there are; None where any number can be drawn."""
        ...

    def draw(self, seed: int, jobs: np.ndarray) -> Queries:
        """Return the queries of int64[J] jobs."""
        ...


@dataclass(frozen=True)
class RandomQueries:
    """Random maps, each cell blocked with the same probability, with random free cells as ends.

    Attributes:
        shape: rows and columns.
        density: probability that a cell is blocked, in [0, 1].
        cell_size: edge of a cell, m.
        ends: "free": start and goal are any two free cells, so that some have no route between
            them; "connected": two cells with a route.
        min_distance: least straight-line distance from start to goal, m.
    """

    shape: tuple[int, int] = (50, 50)
    density: float = 0.1
    cell_size: float = 1.0
    ends: str = "free"
    min_distance: float = 0.0

    @property
    def origin(self) -> tuple[float, float]:
        """South-west corner of cell (0, 0), m."""
        return 0.0, 0.0

    @property
    def chart(self) -> None:
        """Every query has a map of its own."""
        return None

    @property
    def most_jobs(self) -> None:
        """Any number can be drawn."""
        return None

    def check(self, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        check_share("density", self.density, where)
        if not 0.0 < self.cell_size < math.inf:
            raise BadInputError(f"{where}: 'cell_size' must be above 0, got {self.cell_size:g}")
        if min(self.shape) < 1 or max(self.shape) < 2:
            raise BadInputError(
                f"{where}: 'shape' must be [rows, columns] with two cells at least, "
                f"got {list(self.shape)!r}"
            )
        _check_ends(self.ends, ("free", "connected"), self.min_distance, where)
        self.draw(0, np.arange(8))

    def draw(self, seed: int, jobs: np.ndarray) -> Queries:
        """Return the queries of int64[J] jobs.

        Raises:
            BadInputError: a job has no two cells that serve.
        """
        grids = random_grids(seed, jobs, self.shape, self.density)
        groups = (~grids).astype(np.int32) if self.ends == "free" else _components(grids)
        least = self.min_distance / self.cell_size
        starts, goals = _draw_ends(seed, jobs, groups, least, f"a map of density {self.density:g}")
        return Queries(grids, grids, starts, goals)


@dataclass(frozen=True)
class GridQueries:
    """Routes on one map, from a random cell to another.

    Attributes:
        map: a packaged map's name, or a map file.
        cell_size: m; required for a plain image, refused otherwise.
        refine: cells are divided into refine x refine by interpolating the shore.
        inflate: m; routes keep off cells whose centre is this near to a blocked one's.
        ends: "harbours": cells at the shore of the largest body of water; "connected": any two
            cells of one body of water; "free": any two free cells.
        min_distance: least straight-line distance from start to goal, m.
    """

    map: str
    cell_size: float | None = None
    refine: int = 1
    inflate: float = 0.0
    ends: str = "harbours"
    min_distance: float = 0.0


@dataclass(frozen=True)
class Chart(OnChart):
    """The queries of a `GridQueries`.

    Attributes:
        chart: the map.
        spec: the `[maps]` table.
    """

    chart: GridMap
    spec: GridQueries = field(compare=False)

    @property
    def most_jobs(self) -> None:
        """Any number can be drawn."""
        return None

    @cached_property
    def water(self) -> GridMap:
        """The map that routes are sought on."""
        return self.chart.inflated(self.spec.inflate) if self.spec.inflate else self.chart

    @cached_property
    def groups(self) -> np.ndarray:
        """int32[H, W]: 0 where no route ends; cells of one number may be joined."""
        if self.spec.ends == "free":
            return (~self.water.blocked).astype(np.int32)
        bodies = self.water.components()
        if self.spec.ends == "connected":
            return bodies
        shore = ndimage.binary_dilation(self.water.blocked, np.ones((3, 3), bool))
        return ((bodies == 1) & shore).astype(np.int32)

    def check(self, where: str) -> None:
        """Raise BadInputError when a value cannot be used."""
        _check_ends(self.spec.ends, ENDS, self.spec.min_distance, where)
        if not 0.0 <= self.spec.inflate < math.inf:
            raise BadInputError(f"{where}: 'inflate' must be 0 or more, got {self.spec.inflate:g}")
        self.draw(0, np.arange(8))

    def draw(self, seed: int, jobs: np.ndarray) -> Queries:
        """Return the queries of int64[J] jobs.

        Raises:
            BadInputError: a job has no two cells that serve.
        """
        least = self.spec.min_distance / self.cell_size
        starts, goals = _draw_ends(seed, jobs, self.groups[None], least, repr(self.spec.map))
        return Queries(self.water.blocked, self.chart.blocked, starts, goals)


def _check_ends(ends: str, known: tuple[str, ...], min_distance: float, where: str) -> None:
    if ends not in known:
        raise BadInputError(f"{where}: unknown ends {ends!r}; {did_you_mean(ends, known)}")
    if not 0.0 <= min_distance < math.inf:
        raise BadInputError(f"{where}: 'min_distance' must be 0 or more, got {min_distance:g}")


def random_grids(seed: int, jobs: np.ndarray, shape: tuple[int, int], density: float) -> np.ndarray:
    """The maps of int64[J] jobs, bool[J, H, W]."""
    if len(jobs) and (np.diff(jobs) == 1).all():
        return random_maps(seed, len(jobs), shape, density, first=int(jobs[0]))
    # Another number of maps is another program to compile; one at a time there is only one.
    alone = [random_maps(seed, 1, shape, density, first=int(job)) for job in jobs]
    return np.concatenate([np.empty((0, *shape), bool), *alone])


def _components(grids: np.ndarray) -> np.ndarray:
    """Label connected free cells, int32[J, H, W]: 0 in blocked cells; each map has its own."""
    within = np.zeros((3, 3, 3), bool)
    within[1] = ndimage.generate_binary_structure(2, 1)
    labels: np.ndarray = ndimage.label(~grids, within)[0]
    return labels


def _draw_ends(
    seed: int, jobs: np.ndarray, groups: np.ndarray, least: float, place: str
) -> tuple[np.ndarray, np.ndarray]:
    """Draw a start and a goal for each job.

    A start is uniform over the cells that have a group, and its goal over those of the same
    group that are far enough; a start without a goal is drawn again.

    Args:
        seed: of the study.
        jobs: int64[J].
        groups: int32[1 or J, H, W], 0 where no route ends.
        least: cells, from start to goal.
        place: what the map is, for the message.

    Returns:
        int32[J, 2] starts and int32[J, 2] goals, cells (x, y).

    Raises:
        BadInputError: there is no such pair for a job.
    """
    ends = np.zeros((len(jobs), 2, 2), np.int32)
    open_rows = list(range(len(jobs)))
    shared = _Cells(groups[0], least) if len(groups) == 1 else None
    for number in range(_ROUNDS):
        if not open_rows:
            return ends[:, 0], ends[:, 1]
        missing = []
        drawn = _bits(seed, jobs[open_rows], number, len(jobs))
        for row, numbers in zip(open_rows, drawn, strict=True):
            pair = (shared or _Cells(groups[row], least)).pair(*numbers)
            if pair is None:
                missing.append(row)
            else:
                ends[row] = pair
        open_rows = missing
    raise BadInputError(
        f"{place} has no start and goal {least:.4g} cells apart that 'ends' allows "
        f"(job {jobs[open_rows[0]]}); lower 'min_distance' or change 'ends'"
    )


class _Cells:
    """The cells of one map where routes may start and end."""

    def __init__(self, groups: np.ndarray, least: float) -> None:
        # Squared distances fit; int32 is twice as fast.
        kind = np.int32 if max(groups.shape) < 2**15 else np.int64
        place = np.flatnonzero(groups)
        y = place // groups.shape[1]
        self._x, self._y = (place - y * groups.shape[1]).astype(kind), y.astype(kind)
        self._group = groups.reshape(-1)[place]
        # A distance of a whole number of cells must survive the rounding of metres.
        self._least = max(least * least * (1.0 - 1e-9), 0.5)

    def pair(self, first: int, second: int) -> tuple[list[int], list[int]] | None:
        """Start and goal for two random numbers below 2**32; None where there is no goal."""
        count = len(self._x)
        if not count:
            return None
        start = first * count >> 32
        east, north = self._x - self._x[start], self._y - self._y[start]
        serves = east * east + north * north >= self._least
        serves &= self._group == self._group[start]
        goals = np.flatnonzero(serves)
        if not len(goals):
            return None
        goal = int(goals[second * len(goals) >> 32])
        return [self._x[start], self._y[start]], [self._x[goal], self._y[goal]]


def _bits(seed: int, jobs: np.ndarray, number: int, size: int) -> list[list[int]]:
    """Two random whole numbers below 2**32 per job, of one round of draws.

    The jobs are padded to `size`, so that rounds with ever fewer jobs compile only once.
    """
    padded = np.zeros(size, np.uint32)
    padded[: len(jobs)] = jobs
    drawn = _round(jax.random.key(seed), jnp.asarray(padded), number)
    numbers: list[list[int]] = np.asarray(drawn)[: len(jobs)].tolist()
    return numbers


@jax.jit
def _round(key: jax.Array, jobs: jax.Array, number: int) -> jax.Array:
    def one(job: jax.Array) -> jax.Array:
        own = jax.random.fold_in(jax.random.fold_in(key, job), _STREAM)
        return jax.random.bits(jax.random.fold_in(own, number), (2,), jnp.uint32)

    return jax.vmap(one)(jobs)
