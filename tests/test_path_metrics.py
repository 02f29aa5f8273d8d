"""What paths cost, against plain arithmetic and brute force."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from usvjax.paths.metrics import path_metrics
from usvjax.paths.turns import smooth_turns


def test_a_path_by_hand() -> None:
    path = [[[0, 0], [3, 0], [3, 0], [3, 4], [6, 4], [9, 4]], [[1, 1]] * 6]
    found = path_metrics(path, [6, 0], cell_size=100.0)
    assert found.length[0] == pytest.approx(1300)
    assert found.inflections.tolist() == [2, 0]
    assert found.turning[0] == pytest.approx(np.pi, rel=1e-6)
    assert found.curvature[0] == pytest.approx(2 * np.sin(np.pi / 4) / 350, rel=1e-6)
    # Zhang: 13 units of 100 m ahead, two turns of 90 degrees at 0.5 for every 45.
    assert found.energy[0] == pytest.approx(15, rel=1e-6)
    assert np.isnan(found.length[1])
    assert np.isnan(found.energy[1])
    assert found.clearance is None
    dear = path_metrics(path, [6, 0], cell_size=100.0, turn_cost=2.0, energy_unit=1300.0)
    assert dear.energy[0] == pytest.approx(1 + 8, rel=1e-6)


def test_curvature_of_samples_is_that_of_the_arc() -> None:
    path = np.array([[[10.0, 20.0], [60.0, 20.0], [60.0, 70.0]]])
    arcs = smooth_turns(path, None, np.zeros((80, 80), bool), turning_radius=8.0, spacing=0.4)
    found = path_metrics(arcs.points, arcs.counts)
    assert found.curvature[0] == pytest.approx(arcs.curvature_bound[0], rel=1e-2)
    assert found.turning[0] == pytest.approx(np.pi / 2, rel=1e-3)
    assert found.length[0] == pytest.approx(arcs.length[0], rel=1e-4)


def test_a_turn_back_on_itself_is_finite() -> None:
    found = path_metrics([[[0.0, 0.0], [10.0, 0.0], [5.0, 0.0]]], None)
    assert found.turning[0] == pytest.approx(np.pi, rel=1e-6)
    assert found.curvature[0] == pytest.approx(2 / 7.5, rel=1e-6)


def nearest_cell(blocked: np.ndarray, points: np.ndarray) -> float:
    """Least distance from points, in cells, to closed blocked squares; brute force."""
    least = np.inf
    for y, x in np.argwhere(blocked):
        east = np.maximum(np.maximum(x - points[:, 0], points[:, 0] - x - 1), 0)
        north = np.maximum(np.maximum(y - points[:, 1], points[:, 1] - y - 1), 0)
        least = min(least, float(np.hypot(east, north).min()))
    return least


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.002, 0.02, 0.1]))
def test_clearance_against_brute_force(seed: int, density: float) -> None:
    rng = np.random.default_rng(seed)
    blocked = rng.random((4, 30, 40)) < density
    paths = rng.uniform(0, [80, 60], (4, 5, 2)) + np.array([100, 200])
    counts = rng.integers(1, 6, 4)
    found = path_metrics(
        paths, counts, blocked, cell_size=2.0, origin=(100, 200), clearance_limit=16.0
    )
    assert found.clearance is not None
    for row in range(4):
        path = (paths[row, : counts[row]] - [100, 200]) / 2
        between = [np.linspace(a, b, 400) for a, b in pairwise(path)]
        wanted = 2 * nearest_cell(blocked[row], np.concatenate([path[:1], *between]))
        got = found.clearance[row]
        # Measured at points half a cell apart: never too small, too large by 0.5 m at most.
        if wanted < 15:
            assert wanted - 1e-2 <= got <= wanted + 0.5
        elif wanted > 16:
            assert got == np.inf


def test_clearance_on_a_blocked_cell_and_without_any() -> None:
    blocked = np.zeros((2, 20, 20), bool)
    blocked[0, 5, 5] = True
    path = np.array([[[2, 5], [9, 5]]] * 2)
    found = path_metrics(path, None, blocked)
    assert found.clearance is not None
    assert found.clearance.tolist() == [0, np.inf]
