"""What paths cost, against plain arithmetic and brute force."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import segments
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples

from usvjax.paths.metrics import path_metrics
from usvjax.paths.points import sample_pieces
from usvjax.paths.turns import smooth_turns
from usvkernels.paths import arcs


def test_a_path_by_hand() -> None:
    path = [[[0, 0], [3, 0], [3, 0], [3, 4], [6, 4], [9, 4]], [[1, 1]] * 6]
    found = path_metrics(path, [6, 0], cell_size=100.0)
    assert found.length[0] == pytest.approx(1300)
    assert found.inflections.tolist() == [2, 0]
    assert found.turning[0] == pytest.approx(np.pi, rel=1e-6)
    assert found.curvature[0] == pytest.approx(2 * np.sin(np.pi / 4) / 350, rel=1e-6)
    # Zhang: 13 units of 100 m ahead, two turns of 90 degrees at 0.5 for every 45.
    assert found.energy[0] == pytest.approx(15, rel=1e-6)
    for name in ("length", "turning", "curvature", "energy"):
        assert np.isnan(getattr(found, name)).tolist() == [False, True], name
    assert found.clearance is None
    dear = path_metrics(path, [6, 0], cell_size=100.0, turn_cost=2.0, energy_unit=1300.0)
    assert dear.energy[0] == pytest.approx(1 + 8, rel=1e-6)


def test_curvature_of_samples_is_that_of_the_arc() -> None:
    path = np.array([[[10.0, 20.0], [60.0, 20.0], [60.0, 70.0]]])
    arcs = smooth_turns(path, None, np.zeros((80, 80), bool), turning_radius=8.0, spacing=0.4)
    found = path_metrics(arcs.points, arcs.counts)
    # Places of 64 are rounded by 4e-6: the course of a chord of 0.4, which turns by 0.05, by 2e-5.
    assert found.curvature[0] == pytest.approx(arcs.curvature_bound[0], rel=2 * 2e-5 / 0.05)
    assert found.turning[0] == pytest.approx(np.pi / 2, rel=1e-3)
    # Chords of s fall short of an arc by s**2 / (24 R**2) of it.
    assert 0 <= 1 - found.length[0] / arcs.length[0] <= 0.05**2 / 24


def test_a_turn_back_on_itself_is_finite() -> None:
    found = path_metrics([[[0.0, 0.0], [10.0, 0.0], [5.0, 0.0]]], None)
    assert found.turning[0] == pytest.approx(np.pi, rel=1e-6)
    assert found.curvature[0] == pytest.approx(2 / 7.5, rel=1e-6)


# --- clearance --------------------------------------------------------------------------------

# Points are measured half a cell apart along the path, the last of them up to a thousandth of that
# more, and at its end: no place on it is more than a quarter of a cell from one. So what is found
# is never less than the clearance of the path, and a quarter of a cell more at most, but for single
# precision: a coordinate of up to 400 cells is rounded by 2e-5, a length of up to 400 summed in it
# by some 1e-4 cells.
TOO_LARGE, ROUNDING = 0.25 * 1.001, 2e-4  # cells


@examples(15)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.002, 0.02, 0.1]))
def test_clearance_against_exact_distances(seed: int, density: float) -> None:
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
        wanted, got = segments.clearance(blocked[row], path), found.clearance[row] / 2
        if np.isinf(got):
            assert wanted + TOO_LARGE + ROUNDING > 8
        else:
            assert wanted - ROUNDING <= got <= min(wanted + TOO_LARGE + ROUNDING, 8)


def test_clearance_where_no_point_is_measured_is_too_large_by_a_quarter_of_a_cell() -> None:
    """Paths that touch land where they turn back, wherever that is between two points."""
    blocked = np.zeros((9, 9), bool)
    blocked[4, 5] = True
    starts = np.linspace(2, 2.95, 20)
    paths = np.array([[[x, 4.5], [5.0, 4.5], [1.0, 4.5]] for x in starts])
    found = path_metrics(paths, None, blocked).clearance
    assert found is not None
    assert 0.9 * TOO_LARGE < found.max() <= TOO_LARGE + ROUNDING


def test_clearance_on_a_blocked_cell_and_without_any() -> None:
    blocked = np.zeros((2, 20, 20), bool)
    blocked[0, 5, 5] = True
    path = np.array([[[2, 5], [9, 5]]] * 2)
    found = path_metrics(path, None, blocked)
    assert found.clearance is not None
    assert found.clearance.tolist() == [0, np.inf]
    lost = path_metrics(path, [2, 0], blocked).clearance
    assert lost is not None
    assert lost[0] == 0
    assert np.isnan(lost[1])
    far = path_metrics(path, None, np.roll(blocked, 7, axis=2), clearance_limit=1e12).clearance
    assert far is not None
    assert far.tolist() == [2.5, np.inf]


def staircases(steps: int) -> np.ndarray:
    """Eight paths of random steps north, east and north-east, float64[8, steps + 1, 2]."""
    step = np.array([[0, 1], [1, 0], [1, 1]])[np.random.default_rng(5).integers(0, 3, (8, steps))]
    return np.pad(np.cumsum(step, axis=1), ((0, 0), (1, 0), (0, 0))) + 0.5


def test_samples_of_many_pieces_end_where_the_path_ends() -> None:
    """Sums of more than 256 lengths differ by their order, padding's from those of pieces."""
    paths = staircases(1100) + 20.0
    step = np.diff(paths, axis=1)
    length = np.hypot(step[..., 0], step[..., 1]).astype(np.float32)
    heading = np.arctan2(step[..., 1], step[..., 0])
    pieces = (paths[:, :-1], heading, length, np.zeros_like(length))
    points, course, _, counts = sample_pieces(pieces, 0.5, 4096)
    for row in range(8):
        got = points[row, : counts[row]]
        np.testing.assert_allclose(got[-1], paths[row, -1], atol=1e-3)
        assert (points[row, counts[row] :] == got[-1]).all()
        assert course[row, counts[row] - 1] == pytest.approx(heading[row, -1], abs=1e-5)
        ends = np.append(0.0, np.cumsum(np.hypot(step[row, :, 0], step[row, :, 1])))
        place = np.minimum(0.5 * np.arange(len(got)), ends[-1])
        for axis in range(2):
            wanted = np.interp(place, ends, paths[row, :, axis])
            np.testing.assert_allclose(got[:, axis], wanted, atol=2e-3)


def test_samples_end_on_the_last_piece_that_there_is() -> None:
    length = jnp.array([[3.0, 0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0]], jnp.float32)
    start = jnp.array([[0.0, 0], [3, 0], [3, 0], [9, 9], [9, 9]], jnp.float32)
    path = arcs.Primitives(jnp.stack([start] * 2), jnp.zeros((2, 5)), length, jnp.zeros((2, 5)))
    points, _, _, counts = jax.jit(arcs.sample, static_argnums=2)(path, 2.0, 4)
    assert counts.tolist() == [4, 1]
    assert points[0].tolist() == [[0, 0], [2, 0], [4, 0], [5, 0]]


def test_clearance_of_long_paths_against_exact_distances() -> None:
    paths = staircases(330) + np.array([0, 8])
    blocked = np.zeros((340, 340), bool)
    blocked[0, 2] = blocked[0, 0] = True
    blocked[200:210, 150] = blocked[300, 220] = True
    found = path_metrics(paths, None, blocked, clearance_limit=500.0).clearance
    assert found is not None
    for row in range(8):
        wanted = segments.clearance(blocked, paths[row])
        assert wanted - ROUNDING <= found[row] <= wanted + TOO_LARGE + ROUNDING
        assert found[row] > 0


def test_exact_distances_are_those_of_points_as_dense_as_can_be() -> None:
    """The oracle itself, against a bound of its own: n points are off by 1 / (2 n) lengths."""
    rng = np.random.default_rng(7)
    met = 0
    for _ in range(200):
        a, b, low = rng.uniform(-3, 3, 2), rng.uniform(-3, 3, 2), rng.integers(-2, 2, (1, 2))
        points = np.linspace(a, b, 2001)
        dense = min(segments.to_squares(point, low)[0] for point in points)
        exact = segments.gaps(a, b, low.astype(float))[0]
        assert dense - np.linalg.norm(b - a) / 4000 <= exact <= dense + 1e-12
        met += exact == 0
    assert 20 < met < 180
