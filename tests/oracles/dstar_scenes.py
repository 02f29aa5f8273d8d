"""Episodes on changing maps that the tests of D* Lite share."""

from dataclasses import dataclass
from typing import Any

import dstar_reference as plain
import numpy as np

from usvjax.search.replanning import DstarLiteResult, dstar_lite

EPISODES, HEIGHT, WIDTH, STEPS, CHANGES = 32, 11, 13, 40, 6
FREE = np.zeros((HEIGHT, WIDTH), bool)
Changes = list[list[plain.Cell]]


@dataclass(frozen=True)
class Scenes:
    """Arguments of `dstar_lite`, one shape for all tests, so that each method compiles once."""

    blocked: np.ndarray  # bool[EPISODES, HEIGHT, WIDTH]
    starts: np.ndarray  # int[EPISODES, 2]
    goals: np.ndarray  # int[EPISODES, 2]
    flips: np.ndarray  # int[EPISODES, STEPS, CHANGES, 2]

    def sail(self, **method: Any) -> DstarLiteResult:
        return dstar_lite(self.blocked, self.starts, self.goals, self.flips, **method)

    def ends(self, row: int) -> tuple[plain.Cell, plain.Cell]:
        start, goal = self.starts[row].tolist(), self.goals[row].tolist()
        return (start[0], start[1]), (goal[0], goal[1])


def random_scenes(seed: int) -> Scenes:
    """Maps from open water to mazes; none to six changes a step, some of them undone at once."""
    rng = np.random.default_rng(seed)
    density = np.linspace(0.0, 0.55, EPISODES)[:, None, None]
    blocked = rng.random((EPISODES, HEIGHT, WIDTH)) < density
    cells = rng.permuted(np.tile(np.arange(HEIGHT * WIDTH), (EPISODES, 1)), axis=1)[:, :2]
    cells = np.stack([cells % WIDTH, cells // WIDTH], axis=-1)
    for end in (cells[:, 0], cells[:, 1]):
        blocked[np.arange(EPISODES), end[:, 1], end[:, 0]] = False
    size = (EPISODES, STEPS, CHANGES)
    flips = np.stack([rng.integers(0, WIDTH, size), rng.integers(0, HEIGHT, size)], axis=-1)
    flips[
        rng.random(size) < np.linspace(0, 1, EPISODES)[rng.permutation(EPISODES), None, None]
    ] = -1
    return Scenes(blocked, cells[:, 0], cells[:, 1], flips)


def scenes_of(
    *episodes: tuple[np.ndarray, plain.Cell, plain.Cell, Changes],
) -> Scenes:
    """Some episodes (map, start, goal, changes by step), and as many that have nothing to do."""
    blocked = np.repeat(FREE[None], EPISODES, axis=0)
    starts = np.zeros((EPISODES, 2), int)
    goals = np.ones((EPISODES, 2), int)
    flips = np.full((EPISODES, STEPS, CHANGES, 2), -1)
    for row, (grid, start, goal, changes) in enumerate(episodes):
        blocked[row], starts[row], goals[row] = grid, start, goal
        for step, cells in enumerate(changes):
            flips[row, step, : len(cells)] = np.reshape(cells, (-1, 2))
    return Scenes(blocked, starts, goals, flips)


def wall(column: int, door: int | None = None) -> np.ndarray:
    grid = FREE.copy()
    grid[:, column] = True
    if door is not None:
        grid[door, column] = False
    return grid
