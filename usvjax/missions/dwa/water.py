"""Scenarios on one map of real water: starts and goals drawn on connected navigable cells."""

import math
from dataclasses import dataclass, field
from functools import cached_property

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.missions.dwa.scenes import Scenarios

GOALS_PER_START = 32

# Each round draws a start and GOALS_PER_START goals for it. On a map where one start in a
# hundred works, a job fails all rounds once in 10^13.
ROUNDS = 3000


@dataclass(frozen=True)
class GridMaps:
    """Starts and goals on one map, both in the same body of water, the bow towards the goal.

    A start is uniform over the navigable cells; its goal has a uniform bearing and a uniform
    distance from it and is then moved to the centre of its cell. Pairs that are ashore, in
    another body of water or out of the range of distances are drawn again.

    Attributes:
        map: a packaged map's name, or a map file.
        cell_size: m; required for a plain image, refused otherwise.
        refine: cells are divided into refine x refine by interpolating the shore.
        min_clearance: m, from start and goal to the nearest blocked cell's centre.
        distance: least and greatest straight-line distance from start to goal, m.
    """

    map: str
    cell_size: float | None = None
    refine: int = 1
    min_clearance: float = 0.0
    distance: tuple[float, float] = (1000.0, 5000.0)


@dataclass(frozen=True)
class Water:
    """A map with the cells where episodes may start and end.

    Attributes:
        grid: the map.
        spec: the `[maps]` table.
    """

    grid: GridMap
    spec: GridMaps = field(compare=False)

    @cached_property
    def bodies(self) -> np.ndarray:
        """int32[H, W]: the number of the body of water, 0 where no episode may start or end."""
        far = self.grid.clearance() >= self.spec.min_clearance
        return np.where(far & ~self.grid.blocked, self.grid.components(), 0)

    @cached_property
    def cells(self) -> np.ndarray:
        """int64[N, 2]: (x, y) of the cells where an episode may start."""
        return np.argwhere(self.bodies > 0)[:, ::-1]

    def check(self, radius: float, where: str) -> None:
        """Raise BadInputError when a value cannot be used with this vessel radius (m)."""
        near, far = self.spec.distance
        if not 0.0 < near < far < math.inf:
            raise BadInputError(
                f"{where}: 'distance' must be two distances in m, the first above 0 and below "
                f"the second, got {[near, far]!r}"
            )
        covers = self.grid.cell_size * math.sqrt(0.5)
        if not radius >= covers:
            raise BadInputError(
                f"{where}: obstacle circles of {radius:g} m leave gaps between blocked cells of "
                f"{self.grid.cell_size:g} m; the radius must be at least {covers:g} m"
            )
        if not radius < self.spec.min_clearance < math.inf:
            raise BadInputError(
                f"{where}: 'min_clearance' must exceed the radius of the obstacle circle, "
                f"{radius:g} m, got {self.spec.min_clearance:g}"
            )
        if not len(self.cells):
            raise BadInputError(
                f"{where}: no water of {self.spec.map!r} is {self.spec.min_clearance:g} m "
                f"from the shore"
            )
        self.draw(0, np.arange(8), radius)

    def check_outside_goal(self, tolerance: float, where: str) -> None:
        """Raise BadInputError where a start may be drawn that counts as its goal."""
        near, far = self.spec.distance
        if np.float32(near) <= np.float32(tolerance):
            raise BadInputError(
                f"{where}: 'distance' must begin above 'goal_tolerance' of {tolerance:g} m, or "
                f"episodes would be over at once, got {[near, far]!r}"
            )

    def draw(self, seed: int, jobs: np.ndarray, radius: float) -> Scenarios:
        """Return the scenarios of int64[J] jobs.

        Args:
            seed: of the study.
            jobs: int64[J], job numbers.
            radius: not used; the map stays what it is.

        Raises:
            BadInputError: no start and goal could be found for a job.
        """
        starts, goals = np.zeros((len(jobs), 2)), np.zeros((len(jobs), 2))
        open_jobs = np.arange(len(jobs))
        for number in range(ROUNDS):
            if not len(open_jobs):
                break
            unit = _uniforms(seed, jobs[open_jobs], number, len(jobs))
            start, goal, found = self._attempt(unit)
            starts[open_jobs[found]], goals[open_jobs[found]] = start[found], goal[found]
            open_jobs = open_jobs[~found]
        if len(open_jobs):
            near, far = self.spec.distance
            raise BadInputError(
                f"{self.spec.map!r} has no start and goal {near:g} to {far:g} m apart on "
                f"connected water {self.spec.min_clearance:g} m from the shore "
                f"(job {jobs[open_jobs[0]]} found none in {ROUNDS} rounds)"
            )
        bearing = np.arctan2(*np.moveaxis(goals - starts, -1, 0)[::-1])
        poses = np.concatenate([starts, bearing[:, None]], axis=-1)
        return Scenarios(self.grid, None, poses, goals)

    def _attempt(self, unit: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Turn uniform numbers into one start and one goal per job, and whether they serve.

        Args:
            unit: float64[J, 1 + 2 * GOALS_PER_START].

        Returns:
            float64[J, 2] and float64[J, 2], m, and bool[J].
        """
        cell = self.cells[(unit[:, 0] * len(self.cells)).astype(np.int64)]
        start = self.grid.points_of(cell)
        near, far = self.spec.distance
        bearing = 2.0 * np.pi * unit[:, 1 : 1 + GOALS_PER_START]
        reach = near + (far - near) * unit[:, 1 + GOALS_PER_START :]
        offset = reach[..., None] * np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
        goal_cells = self.grid.cells_of(start[:, None] + offset)
        goals = self.grid.points_of(goal_cells)
        apart = np.hypot(*np.moveaxis(goals - start[:, None], -1, 0))
        good = self._body(goal_cells) == self._body(cell)[:, None]
        good &= (apart >= near) & (apart <= far)
        first = good.argmax(axis=1)
        return start, goals[np.arange(len(unit)), first], good.any(axis=1)

    def _body(self, cells: np.ndarray) -> np.ndarray:
        """Body of water of int64[..., 2] cells; -1 where no episode may start or end."""
        limit = np.asarray(self.grid.shape[::-1])
        inside = ((cells >= 0) & (cells < limit)).all(axis=-1)
        x, y = np.moveaxis(np.clip(cells, 0, limit - 1), -1, 0)
        body = np.where(inside, self.bodies[y, x], 0)
        return np.where(body > 0, body, -1)


def _uniforms(seed: int, jobs: np.ndarray, number: int, size: int) -> np.ndarray:
    """Uniform numbers in [0, 1), float64[J, 1 + 2 * GOALS_PER_START], of one round of draws.

    The jobs are padded to `size`, so that rounds with ever fewer jobs compile only once.
    """
    padded = np.zeros(size, np.uint32)
    padded[: len(jobs)] = jobs
    drawn = _round(jax.random.key(seed), jnp.asarray(padded), number)
    return np.asarray(drawn, np.float64)[: len(jobs)]


@jax.jit
def _round(key: jax.Array, jobs: jax.Array, number: int) -> jax.Array:
    def one(job: jax.Array) -> jax.Array:
        own = jax.random.fold_in(jax.random.fold_in(key, job), number)
        return jax.random.uniform(own, (1 + 2 * GOALS_PER_START,), jnp.float32)

    return jax.vmap(one)(jobs)
