"""Random layouts in which fleets gather among obstacles; the paper prints none of its own."""

from dataclasses import dataclass

import numpy as np

from usvjax.missions.aggregate.formations import placed, slots_of
from usvjax.units import NAUTICAL_MILE

HEADINGS = (0.0, 60.0, 90.0)
"""deg, of Figs. 19 to 21."""
OBSTACLES = 6
RADIUS = 0.125 * NAUTICAL_MILE
"""m, of an obstacle: half of the printed collision radius."""
SIDE = 14e3
"""m, of the water in which three begin; that of more grows with their number."""
APART = 1500.0
"""m, between starts, at least."""
AWAY = 3500.0
"""m, of starts from the centre of the formation, at least."""
ROOM = 150.0
"""m, that guide segments have beside what touches an obstacle, at least; starts have twice that."""
GUIDE = 1.0 * NAUTICAL_MILE
"""m, the length of the guide segments that are kept clear."""


@dataclass(frozen=True)
class Layouts:
    """B fleets of n vessels that gather about the origin in a wedge.

    Attributes:
        starts: float64[B, n, 3], x, y (m), psi (rad).
        circles: float64[B, K, 2] (m).
        headings: float64[B] (rad), of `HEADINGS` in turn.
        goals: float64[B, n, 2], the slots (m).
    """

    starts: np.ndarray
    circles: np.ndarray
    headings: np.ndarray
    goals: np.ndarray


def layouts(count: int, n: int, hull: float, spacing: float, seed: int) -> Layouts:
    """Draw layouts until there are so many in which starts and guide segments are clear.

    Args:
        count: B.
        n: vessels in a fleet.
        hull: their radius (m).
        spacing: of the slots (m).
        seed: of the draws.
    """
    rng = np.random.default_rng(seed)
    half = SIDE / 2 * max(1.0, np.sqrt(n / 3))
    slots = slots_of("wedge", n, np.array([spacing]))
    headings = np.radians(np.resize(HEADINGS, count))
    goals = placed(np.repeat(slots, count, axis=0), np.zeros((count, 2)), headings)
    starts, circles = np.empty((count, n, 3)), np.empty((count, OBSTACLES, 2))
    for k, (heading, ends) in enumerate(zip(headings, goals, strict=True)):
        place, circle = rng.uniform(-half, half, (n, 2)), _circles(rng, half)
        while not _clear(place, circle, ends, heading, hull + RADIUS):
            place, circle = rng.uniform(-half, half, (n, 2)), _circles(rng, half)
        starts[k] = np.column_stack([place, rng.uniform(-np.pi, np.pi, n)])
        circles[k] = circle
    return Layouts(starts, circles, headings, goals)


def _circles(rng: np.random.Generator, half: float) -> np.ndarray:
    return 0.8 * half * rng.uniform(-1.0, 1.0, (OBSTACLES, 2))


def _clear(
    place: np.ndarray, circles: np.ndarray, goals: np.ndarray, heading: float, reach: float
) -> bool:
    """Whether starts lie apart, away and afloat, and guide segments in the clear."""
    apart = np.linalg.norm(place[:, None] - place, axis=-1) + APART * np.eye(len(place))
    if apart.min() < APART or np.linalg.norm(place, axis=1).min() < AWAY:
        return False
    if _least(place, circles) < reach + 2 * ROOM:
        return False
    along = GUIDE * np.linspace(-1.0, 0.4, 80)[:, None] * [np.cos(heading), np.sin(heading)]
    return bool(_least((goals[:, None] + along).reshape(-1, 2), circles) >= reach + ROOM)


def _least(points: np.ndarray, circles: np.ndarray) -> float:
    return float(np.linalg.norm(points[:, None] - circles, axis=-1).min())
