"""Waters of the paper's kind: a few round obstacles between one corner and the opposite one."""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from experiments.wei2023.published import COLLISION_RADIUS, OBSTACLES, UNIT


@dataclass(frozen=True)
class Waters:
    """A kind of scene.

    Attributes:
        label: for tables.
        side: nm.
        obstacles: how many.
        radius: nm, least and greatest radius of an obstacle.
    """

    label: str
    side: float
    obstacles: int = OBSTACLES
    radius: tuple[float, float] = (0.25, 0.75)

    @property
    def cells(self) -> int:
        """Of a side of the grid, at the paper's unit length."""
        return round(self.side / UNIT)


SHOWN = Waters("5 nm, 3 obstacles", 5.0)
"""The kind whose paths come nearest to the paper's."""
KINDS = (
    SHOWN,
    Waters("5 nm, 8 obstacles", 5.0, obstacles=8, radius=(0.1, 0.4)),
    Waters("2.5 nm, 3 obstacles", 2.5, radius=(0.1, 0.35)),
    Waters("10 nm, 3 obstacles", 10.0, radius=(0.5, 1.5)),
)


@dataclass(frozen=True)
class Scenes:
    """Scenes of one kind.

    Attributes:
        blocked: bool[n, H, W], cells whose centre lies within the collision radius of an obstacle.
        starts, goals: int[n, 2], cells (x, y), connected but out of sight of each other.
        circles: float[n, obstacles, 3], centre (x, y) and radius, nm.
    """

    blocked: np.ndarray
    starts: np.ndarray
    goals: np.ndarray
    circles: np.ndarray


def draw(waters: Waters, count: int, seed: int) -> Scenes:
    """Draw scenes in which the straight course is barred and another one is open."""
    rng = np.random.default_rng([seed, waters.cells, waters.obstacles])
    found = [_scene(waters, rng) for _ in range(count)]
    blocked, starts, goals, circles = (np.array(column) for column in zip(*found, strict=True))
    return Scenes(blocked, starts, goals, circles)


def _scene(waters: Waters, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    side, cells = waters.side, waters.cells
    while True:
        centres = rng.uniform(0.2, 0.8, (waters.obstacles, 2)) * side
        radii = rng.uniform(*waters.radius, waters.obstacles)
        circles = np.column_stack([centres, radii])
        start, goal = rng.uniform([[0.04], [0.82]], [[0.18], [0.96]], (2, 2))
        ends = np.floor(np.array([start, goal]) * cells).astype(int)
        line = np.array([centre_of(ends)])
        if clearance(line, circles[None])[0] > COLLISION_RADIUS:
            continue
        blocked = barred(circles, cells)
        water, _ = ndimage.label(~blocked)
        at = water[ends[:, 1], ends[:, 0]]
        if at[0] and at[0] == at[1]:
            return blocked, ends[0], ends[1], circles


def barred(circles: np.ndarray, cells: int) -> np.ndarray:
    """Cells too near to an obstacle, float[K, 3] (nm); bool[cells, cells]."""
    centres = (np.arange(cells) + 0.5) * UNIT
    x, y, radius = circles.T[:, :, None, None]
    apart = np.hypot(centres[None, None, :] - x, centres[None, :, None] - y)
    hit: np.ndarray = (apart < radius + COLLISION_RADIUS).any(axis=0)
    return hit


def centre_of(cells: np.ndarray) -> np.ndarray:
    """Centres of cells (x, y), nm."""
    centres: np.ndarray = (cells + 0.5) * UNIT
    return centres


def clearance(points: np.ndarray, circles: np.ndarray) -> np.ndarray:
    """Least distance of polylines to obstacles, exact.

    Args:
        points: float[n, P, 2], nm; the last point may be repeated.
        circles: float[n, K, 3], nm.

    Returns:
        float[n], nm.
    """
    begin, end = points[:, :-1, None], points[:, 1:, None]
    centre = circles[:, None, :, :2]
    step = end - begin
    length2 = (step**2).sum(axis=-1)
    along = ((centre - begin) * step).sum(axis=-1) / np.where(length2 > 0, length2, 1.0)
    foot = begin + np.clip(along, 0.0, 1.0)[..., None] * step
    apart = np.sqrt(((centre - foot) ** 2).sum(axis=-1)) - circles[:, None, :, 2]
    least: np.ndarray = apart.min(axis=(1, 2))
    return least
