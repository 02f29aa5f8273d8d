"""Shortened paths, key points, points at a spacing and B-splines against slow oracles."""

from functools import partial
from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from path_cases import centre, packed, routes, sees
from property_draws import examples
from scipy.interpolate import BSpline

import usvjax as uj
from usvjax.paths.smoothing import bspline, key_points, redensify, shorten
from usvkernels.paths.charts import Charts
from usvkernels.paths.smoothing import line_of_sight


@partial(jax.jit, static_argnames="corner_cutting")
def sight(
    blocked: jax.Array, starts: jax.Array, ends: jax.Array, *, corner_cutting: bool = False
) -> jax.Array:
    first = jnp.zeros(len(starts), jnp.int32)  # all on one map
    charts = Charts(jnp.ravel(blocked), first, *map(jnp.int32, blocked.shape))
    return line_of_sight(charts, starts, ends, corner_cutting=corner_cutting)


MAPS, PATHS, LENGTHS = routes(seed=3, count=24, size=20, density=0.2, far=14)


# --- line of sight ----------------------------------------------------------------------------


@examples(15)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.05, 0.15, 0.3]), st.booleans())
def test_line_of_sight_is_exact(seed: int, density: float, corner_cutting: bool) -> None:
    rng = np.random.default_rng(seed)
    blocked = np.zeros((13, 13), bool)
    height, width = rng.integers(2, 14, 2)
    blocked[:height, :width] = rng.random((height, width)) < density
    ends = rng.integers(0, [width, height], (64, 2, 2)).astype(np.int32)
    found = np.asarray(
        sight(
            blocked,
            ends[:, 0],
            ends[:, 1],
            corner_cutting=corner_cutting,
        )
    )
    for (start, end), clear in zip(ends, found, strict=True):
        assert clear == sees(blocked, centre(start), centre(end), corner_cutting), (start, end)


def test_line_of_sight_through_a_corner_of_the_lattice() -> None:
    blocked = np.zeros((3, 3), bool)
    blocked[1, 0] = True  # beside the first step of the diagonal
    starts, ends = np.array([[0, 0], [0, 0]], np.int32), np.array([[2, 2], [2, 0]], np.int32)
    assert np.asarray(sight(blocked, starts, ends)).tolist() == [False, True]
    cut = sight(blocked, starts, ends, corner_cutting=True)
    assert np.asarray(cut).tolist() == [True, True]


# --- shorten and key points -------------------------------------------------------------------


def yu_smoothing(blocked: np.ndarray, path: np.ndarray) -> list[int]:
    """Yu et al. 2022, section 4.2.2, steps 1 to 5, word for word."""
    kept = [0]
    while kept[-1] < len(path) - 1:
        k = kept[-1] + 1
        while k + 1 < len(path) and sees(blocked, centre(path[kept[-1]]), centre(path[k + 1])):
            k += 1
        kept.append(k)
    return kept


def test_shorten_is_yu_s_algorithm() -> None:
    found = shorten(PATHS, LENGTHS, MAPS)
    for row in range(len(MAPS)):
        wanted = yu_smoothing(MAPS[row], PATHS[row, : LENGTHS[row]])
        n = found.path_cells[row]
        assert found.index[row, :n].tolist() == wanted
        assert (found.index[row, n:] == wanted[-1]).all()
        assert np.array_equal(found.path[row, :n], PATHS[row][wanted])


def test_key_points_leaves_no_point_that_could_go() -> None:
    found = key_points(PATHS, LENGTHS, MAPS)
    fewer = shorten(PATHS, LENGTHS, MAPS).path_cells - found.path_cells
    assert (fewer >= 0).all()
    assert fewer.any()
    for row in range(len(MAPS)):
        path = found.path[row, : found.path_cells[row]]
        assert np.array_equal(path[[0, -1]], PATHS[row][[0, LENGTHS[row] - 1]])
        assert (np.diff(found.index[row, : len(path)]) > 0).all()
        for a, b in pairwise(path):
            assert sees(MAPS[row], centre(a), centre(b))
        for a, b in zip(path, path[2:], strict=False):
            assert not sees(MAPS[row], centre(a), centre(b))


def test_a_row_does_not_depend_on_the_others_nor_on_sharing_its_map() -> None:
    together = key_points(PATHS, LENGTHS, MAPS)
    for row in (0, 7):
        alone = key_points(PATHS[row : row + 1], LENGTHS[row : row + 1], MAPS[row])
        n = alone.path_cells[0]
        assert n == together.path_cells[row]
        assert np.array_equal(alone.path[0, :n], together.path[row, :n])


@pytest.mark.parametrize("function", [shorten, key_points])
def test_rows_without_a_path_and_of_one_or_two_points(function: object) -> None:
    path = np.array([[[2, 3], [9, 9]], [[2, 3], [9, 9]], [[2, 3], [5, 3]]])
    found = function(path, [0, 1, 2], np.zeros((6, 8), bool))  # type: ignore[operator]
    assert found.path_cells.tolist() == [0, 1, 2]
    assert found.path[2].tolist() == [[2, 3], [5, 3]]
    assert (found.path[1] == [2, 3]).all()


def test_corner_cutting_paths_are_shortened_by_their_own_rule() -> None:
    blocked = np.zeros((4, 4), bool)
    blocked[1, 0] = blocked[0, 1] = True  # the path squeezes between these two
    path = np.array([[[0, 0], [1, 1], [2, 2], [3, 3]]])
    found = shorten(path, None, blocked, corner_cutting=True)
    assert found.path[0].tolist() == [[0, 0], [3, 3]]


# --- points at a spacing ----------------------------------------------------------------------


@examples(20)
@given(st.integers(0, 2**32 - 1), st.floats(0.3, 3.0))
def test_redensify_against_a_plain_loop(seed: int, unit: float) -> None:
    rng = np.random.default_rng(seed)
    counts = rng.integers(0, 7, 5)
    points = rng.uniform(-20, 20, (5, 6, 2)) + np.array([4e5, 6e6])  # as UTM coordinates are
    found = redensify(points, counts, unit)
    for row, count in enumerate(counts):
        # The last unit of a leg may be longer by 1e-4. Units are counted in single precision: of
        # up to 200 in a leg, by 4e-5. As near as that to a whole number, either is right.
        legs = np.linalg.norm(np.diff(points[row, :count], axis=0), axis=1) / unit - 1e-4
        if (np.abs(legs - np.round(legs)) < 4e-5).any():
            continue
        wanted = []
        for a, b in zip(points[row, : count - 1], points[row, 1:count], strict=False):
            pieces = max(1, int(np.ceil(np.linalg.norm(b - a) / unit - 1e-4)))
            ahead = (b - a) / np.linalg.norm(b - a)
            wanted += [a + i * unit * ahead for i in range(pieces)]
        wanted += [points[row, count - 1]] if count else []
        assert found.path_cells[row] == len(wanted)
        if count:
            # Of up to 200 m about the first point, in single precision.
            np.testing.assert_allclose(found.path[row, : len(wanted)], wanted, rtol=0, atol=1e-4)
            assert (found.path[row, len(wanted) - 1 :] == points[row, count - 1]).all()


def test_whole_numbers_of_units_gain_no_point() -> None:
    found = redensify([[[0, 0], [7, 0], [7, 3]]], None, 0.1, cell_size=0.1, origin=(0.05, 0.05))
    assert found.path_cells.tolist() == [11]
    np.testing.assert_allclose(found.path[0, 7], [0.8, 0.1], atol=1e-6)


# --- B-splines --------------------------------------------------------------------------------


def test_bspline_against_scipy() -> None:
    rng = np.random.default_rng(5)
    paths, lengths = packed([rng.uniform(0, 100, (n, 2)) for n in (2, 3, 4, 5, 8, 13)])
    found = bspline(paths, lengths, samples=57)
    at = np.linspace(0, 1, 57)
    for row, n in enumerate(lengths):
        degree = min(3, n - 1)
        inner = np.arange(1, n - degree) / (n - degree)
        knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
        curve = BSpline(knots, paths[row, :n], degree)
        speed = curve.derivative()(at)
        bend = curve.derivative(2)(at) if degree > 1 else np.zeros_like(speed)
        across = speed[:, 0] * bend[:, 1] - speed[:, 1] * bend[:, 0]
        fast = np.linalg.norm(speed, axis=1)
        wanted = across / fast**3
        # In single precision the parameter, of 10 spans at most, is off by a few roundings of 1e-7:
        # a place by as much of the speed, a course by as much of the turn; and what is computed
        # with coordinates of 100 m and their differences, of it.
        late = 4e-7
        off = np.linalg.norm(found.points[row] - curve(at), axis=1)
        assert (off <= late * fast + 2e-5).all()
        course = np.stack([np.cos(found.heading[row]), np.sin(found.heading[row])], axis=1)
        turned = np.linalg.norm(course - speed / fast[:, None], axis=1)
        assert (turned <= late * (np.abs(wanted) * fast + 100 / fast) + 4e-7).all()
        # Curvature divides by the cube of a speed that is off by 100 * late and 11 at least.
        np.testing.assert_allclose(found.curvature[row], wanted, rtol=1e-4, atol=1e-5)
        assert (found.points[row, [0, -1]] == paths[row, [0, n - 1]]).all()


def test_what_a_search_found_is_taken_even_if_that_is_nothing() -> None:
    """Of queries without a way, and of those that are there already, one point is what is left."""
    maps = np.zeros((2, 5, 5), bool)
    maps[0, 3] = True
    found = uj.astar(maps, [[3, 4], [2, 2]], [[0, 0], [2, 2]])
    assert found.path.shape == (2, 1, 2)
    paths = found.path, found.path_cells
    assert uj.shorten(*paths, maps).path_cells.tolist() == [0, 1]
    assert uj.key_points(*paths, maps).path_cells.tolist() == [0, 1]
    assert uj.redensify(*paths, 0.5).path_cells.tolist() == [0, 1]
    np.testing.assert_array_equal(uj.path_metrics(*paths, maps).length, [np.nan, 0.0])
    assert uj.smooth_turns(*paths, maps, turning_radius=1.0).fitted.tolist() == [False, True]
    assert uj.track_paths(*paths, maps).arrived.shape == (2,)
    assert uj.bspline(found.path[:1], found.path_cells[:1]).counts.tolist() == [0]
