"""Obstacles of a grid: scaling each about its centre, and the table of nearest shoreline."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from property_draws import examples
from scipy import ndimage

from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap, expand_obstacles, hongze_lake, obstacle_table
from usvkernels import grids

CELLS = arrays(bool, array_shapes(min_dims=2, max_dims=2, max_side=9))
OPEN = np.zeros((3, 4), bool)


@examples(60)
@given(CELLS, st.sampled_from([0.0, 0.25, 0.5, 1.0, 1.7, 3.0]))
def test_expand_obstacles_against_scaled_squares(blocked: np.ndarray, expansion: float) -> None:
    """A cell centre is covered if it lies in the scaled square of any cell of an obstacle."""
    labels, count = ndimage.label(blocked, np.ones((3, 3)))
    expected = blocked.copy()
    everywhere = np.argwhere(np.ones_like(blocked))
    for label in range(1, count + 1):
        cells = np.argwhere(labels == label)
        centre = cells.mean(axis=0)
        squares = centre + (1 + expansion) * (cells - centre)
        # Gaps and reach differ by whole multiples of 1 / (20 n), n cells at most 81, or not at all.
        gap = np.abs(everywhere[:, None] - squares).max(axis=-1)
        covered = (gap <= 0.5 * (1 + expansion) + 1e-6).any(axis=1)
        expected |= covered.reshape(blocked.shape)
    np.testing.assert_array_equal(expand_obstacles(blocked, expansion), expected)


def test_expansion_of_one_cell_by_one_blocks_its_neighbours() -> None:
    blocked = np.zeros((7, 7), bool)
    blocked[3, 3] = True
    grown = GridMap(blocked, 2.0).expanded(1.0)
    assert grown.blocked.sum() == 9
    assert grown.blocked[2:5, 2:5].all()
    assert grown.cell_size == 2.0
    np.testing.assert_array_equal(GridMap(blocked).expanded(0.5).blocked, blocked)


@pytest.mark.parametrize(
    ("blocked", "expansion", "error"),
    [
        (OPEN, -0.1, BadInputError),
        (OPEN, float("nan"), BadInputError),
        (OPEN, None, BadTypeError),
        (OPEN.astype(int), 0.5, BadTypeError),
        (OPEN[0], 0.5, BadInputError),
    ],
)
def test_expand_obstacles_refuses(
    blocked: np.ndarray, expansion: float, error: type[Exception]
) -> None:
    with pytest.raises(error, match=r"(blocked|expansion): got"):
        expand_obstacles(blocked, expansion)


@examples(40)
@given(
    st.integers(0, 2**32 - 1),
    st.floats(0.0, 1.0),
    st.sampled_from([1, 3, 30]),
    st.sampled_from([1.0, 2.0, 2.9, 100.0]),
)
def test_obstacle_table_against_all_pairs(seed: int, density: float, k: int, reach: float) -> None:
    blocked = np.random.default_rng(seed).random((8, 11)) < density
    table = obstacle_table(blocked, k, reach)
    assert table.shape == (8, 11, k)
    assert table.dtype == np.int32
    assert (table[blocked] == -1).all()
    shore = np.argwhere(np.asarray(grids.shoreline(blocked)))
    for y, x in np.argwhere(~blocked):
        listed = table[y, x][table[y, x] >= 0]
        gaps = np.hypot(*(shore - (y, x)).T)
        expected = np.sort(gaps[gaps <= reach + 1e-9])[:k]
        assert len(set(listed)) == len(listed)
        assert (table[y, x][len(listed) :] == -1).all()
        rows, columns = np.divmod(listed, 11)
        assert np.asarray(grids.shoreline(blocked))[rows, columns].all()
        np.testing.assert_allclose(np.hypot(rows - y, columns - x), expected)


def test_obstacle_table_with_room_for_all_leaves_none_out() -> None:
    blocked = np.random.default_rng(3).random((12, 9)) < 0.4
    everything = obstacle_table(blocked, blocked.size, 4.0)
    table = obstacle_table(blocked, None, 4.0)
    assert table.shape[-1] % 8 == 0
    np.testing.assert_array_equal(table, everything[..., : table.shape[-1]])
    assert (everything[..., table.shape[-1] :] == -1).all()


def test_obstacle_table_made_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    blocked = np.random.default_rng(3).random((12, 9)) < 0.4
    whole = obstacle_table(blocked, 8, 4.0)
    monkeypatch.setattr("usvjax.maps.obstacles._AT_ONCE", 40)  # five cells
    np.testing.assert_array_equal(obstacle_table(blocked, 8, 4.0), whole)


def test_obstacle_table_of_the_lake() -> None:
    lake = hongze_lake()
    table = obstacle_table(lake.blocked, 16, 20.0)
    nearest = table[..., 0]
    y, x = np.nonzero(nearest >= 0)
    rows, columns = np.divmod(nearest[y, x], lake.shape[1])
    gap = np.hypot(rows - y, columns - x) * lake.cell_size
    np.testing.assert_allclose(gap, lake.clearance()[y, x])
    beyond = ~lake.blocked & (nearest < 0)
    assert (lake.clearance()[beyond] > 20 * lake.cell_size).all()


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ((OPEN, 0, 5.0), BadInputError, "k: got 0"),
        ((OPEN, 2.0, 5.0), BadTypeError, "k: got 2.0"),
        ((OPEN, 2, 0.0), BadInputError, "reach_cells: got 0.0"),
        ((OPEN, 2, float("nan")), BadInputError, "reach_cells: got nan"),
        ((OPEN.astype(float), 2, 5.0), BadTypeError, "blocked: got dtype"),
    ],
)
def test_obstacle_table_refuses(arguments: tuple, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        obstacle_table(*arguments)
