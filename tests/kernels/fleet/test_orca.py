"""Reciprocal velocities: half-planes by the definition, the best velocity by enumeration."""

from itertools import combinations

import jax
import numpy as np
import pytest

from usvkernels.fleet.orca import Lines, best_velocity, lines

MOST = 1.0

ROUNDED = 5e-4
"""Of a chord's end where a line just meets the circle: a root of single precision's last digit."""


def random_lines(rng, count: int, lanes: int, spread: float) -> np.ndarray:
    """float64[lanes, count, 4]: a point and the unit vector along the line."""
    angle = rng.uniform(-np.pi, np.pi, (lanes, count))
    along = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return np.concatenate([rng.normal(0, spread, (lanes, count, 2)), along], axis=-1)


def solve(table: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    parts = np.moveaxis(table, 0, -1).astype(np.float32)
    given = Lines(
        (parts[:, 0], parts[:, 1]), (parts[:, 2], parts[:, 3]), np.ones(parts[:, 0].shape, bool)
    )
    goal = tuple(wanted.T.astype(np.float32))
    found = jax.jit(best_velocity)(given, goal, np.full(len(wanted), MOST, np.float32))
    return np.stack(found, axis=1).astype(np.float64)


def violation(table: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """How far velocities [..., 2] are to the right of the worst line."""
    off = table[:, :2] - velocity[..., None, :]
    return np.max(table[:, 2] * off[..., 1] - table[:, 3] * off[..., 0], axis=-1)


def corners(table: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Every velocity that can be the nearest allowed one."""
    found = [wanted * min(1.0, MOST / np.linalg.norm(wanted))]
    for point, along in zip(table[:, :2], table[:, 2:], strict=True):
        found.append(point + along * np.dot(along, wanted - point))
        middle = np.dot(point, along)
        root = middle**2 + MOST**2 - np.dot(point, point)
        if root >= 0:
            found += [point + along * (s * np.sqrt(root) - middle) for s in (-1, 1)]
    for one, two in combinations(table, 2):
        matrix = np.stack([one[2:], -two[2:]], axis=1)
        if abs(np.linalg.det(matrix)) > 1e-9:
            found.append(one[:2] + one[2:] * np.linalg.solve(matrix, two[:2] - one[:2])[0])
    return np.array(found)


@pytest.mark.parametrize("count", [1, 2, 5, 9])
def test_the_nearest_allowed_velocity(count):
    rng = np.random.default_rng(count)
    table, wanted = random_lines(rng, count, 300, 0.3), rng.normal(0, 0.7, (300, 2))
    found = solve(table, wanted)
    possible = 0
    for own, goal, velocity in zip(table, wanted, found, strict=True):
        all_of_them = corners(own, goal)
        fine = (violation(own, all_of_them) <= 1e-9) & (
            np.linalg.norm(all_of_them, axis=1) <= MOST + 1e-9
        )
        if not fine.any():
            continue
        possible += 1
        best = np.min(np.linalg.norm(all_of_them[fine] - goal, axis=1))
        assert violation(own, velocity) <= 2e-5
        assert np.linalg.norm(velocity) <= MOST + ROUNDED
        assert np.linalg.norm(velocity - goal) == pytest.approx(best, abs=ROUNDED)
    assert possible > 20


def test_without_an_allowed_velocity_the_worst_line_is_violated_least():
    rng = np.random.default_rng(0)
    table, wanted = random_lines(rng, 8, 300, 0.6), rng.normal(0, 0.7, (300, 2))
    found = solve(table, wanted)
    radius, angle = np.meshgrid(np.linspace(0, MOST, 120), np.linspace(-np.pi, np.pi, 240))
    disc = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1).reshape(-1, 2)
    crowded = 0
    for own, velocity in zip(table, found, strict=True):
        least = violation(own, disc).min()
        if least > 0.02:
            crowded += 1
            assert violation(own, velocity) <= least + 1e-4
            assert np.linalg.norm(velocity) <= MOST + ROUNDED
    assert crowded > 50


def test_velocities_on_the_line_touch_at_the_horizon():
    """A vessel that takes its whole share of the least change just grazes the other in time."""
    rng = np.random.default_rng(3)
    place = rng.normal(0, 500, (2, 400))
    place = place[:, np.hypot(*place) > 120]
    count = place.shape[1]
    velocity, own = rng.normal(0, 5, (2, count)), rng.normal(0, 5, (2, count))
    single = [a.astype(np.float32)[None] for a in (*place, *velocity)]
    found = lines(
        (single[0], single[1]),
        (single[2], single[3]),
        tuple(own.astype(np.float32)),
        np.full((1, count), 100.0, np.float32),
        60.0,
        1.0,
        np.ones((1, count), np.float32),
        np.ones((1, count), bool),
    )
    relative = np.stack(found.point)[:, 0].astype(np.float64) - velocity
    along = np.clip(np.sum(place * relative, axis=0) / np.sum(relative**2, axis=0), 0, 60)
    least = np.hypot(*(place - relative * along))
    assert np.allclose(least, 100.0, atol=0.2)
