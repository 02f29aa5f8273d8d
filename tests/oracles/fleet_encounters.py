"""Random two-vessel encounters and the rules of the road, in plain NumPy and double precision."""

from dataclasses import dataclass

import numpy as np

KNOT, MILE = 1852.0 / 3600.0, 1852.0
KINDS = ("head-on", "crossing", "overtaking")
ACCELERATION = 2 * KNOT  # m/s^2, Wei & Zhang 2023, Table 1


@dataclass(frozen=True)
class Encounters:
    """B encounters of two vessels that meet if neither acts.

    Attributes:
        kind: int[B], place in KINDS.
        start: float64[B, 2, 3]; goal: float64[B, 2, 2]; speed, hull: float64[B, 2].
        dcpa: float64[B], between centres (m); tcpa: float64[B] (s).
    """

    kind: np.ndarray
    start: np.ndarray
    goal: np.ndarray
    speed: np.ndarray
    hull: np.ndarray
    dcpa: np.ndarray
    tcpa: np.ndarray


def draw(count: int, seed: int, least_tcpa: float = 180.0, stops: float = 4.0) -> Encounters:
    """Encounters whose first sight is early: see the issue's bar in docs/fleets.md."""
    rng = np.random.default_rng(seed)
    kind = rng.integers(0, 3, count)
    hull = rng.uniform(2.0, 50.0, (count, 2))
    knots = rng.uniform(5.0, 20.0, (count, 2))
    fast = rng.uniform(6.25, 20.0, count)
    slow = fast / rng.uniform(1.25, fast / 5.0)
    knots = np.where((kind == 2)[:, None], np.stack([fast, slow], axis=1), knots)
    turn = np.choose(
        kind,
        [
            180.0 + rng.uniform(-6.0, 6.0, count),
            rng.uniform(20.0, 160.0, count) * rng.choice([-1, 1], count),
            rng.uniform(-20.0, 20.0, count),
        ],
    )
    course = rng.uniform(-np.pi, np.pi, count)
    courses = np.stack([course, course + np.radians(turn)], axis=1)
    speed = knots * KNOT
    velocity = speed[..., None] * np.stack([np.cos(courses), np.sin(courses)], axis=-1)
    relative = velocity[:, 1] - velocity[:, 0]
    closing = np.linalg.norm(relative, axis=1)
    radii = hull.sum(axis=1)
    stopping = (speed**2).sum(axis=1) / (2 * ACCELERATION)
    dcpa = rng.uniform(-3.0, 3.0, count) * radii
    least = np.maximum(least_tcpa, stops * (radii + stopping) / closing)
    tcpa = least * rng.uniform(1.0, 1.5, count)
    across = np.stack([-relative[:, 1], relative[:, 0]], axis=1) / closing[:, None]
    other = dcpa[:, None] * across - relative * tcpa[:, None]
    place = np.stack([np.zeros_like(other), other], axis=1)
    after = tcpa + np.maximum(120.0, 3 * (radii + 500.0) / closing)
    goal = place + velocity * after[:, None, None]
    start = np.concatenate([place, ((courses + np.pi) % (2 * np.pi) - np.pi)[..., None]], axis=2)
    return Encounters(kind, start, goal, speed, hull, np.abs(dcpa), tcpa)
