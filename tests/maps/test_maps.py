"""Maps in the world: GridMap, obstacles, random maps, the packaged lake."""

import dataclasses
import json
from pathlib import Path

import jax
import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from property_draws import examples
from scipy import ndimage
from scipy.spatial.distance import cdist

import usvjax
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import (
    GridMap,
    find_map,
    hongze_lake,
    packaged_names,
    random_maps,
)
from usvkernels import grids

CELLS = arrays(bool, array_shapes(min_dims=2, max_dims=2, max_side=9))
OPEN = np.zeros((3, 4), bool)


# --- GridMap ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"blocked": np.zeros((3, 4))}, BadTypeError, "blocked: got dtype float64"),
        ({"blocked": np.zeros((3, 4), np.uint8)}, BadTypeError, "blocked: got dtype uint8"),
        ({"blocked": np.zeros(4, bool)}, BadInputError, r"blocked: got shape \(4,\)"),
        ({"blocked": np.zeros((2, 3, 4), bool)}, BadInputError, "blocked: got shape"),
        ({"blocked": np.zeros((0, 4), bool)}, BadInputError, r"blocked: got shape \(0, 4\)"),
        ({"blocked": [[True], [True, False]]}, BadInputError, "blocked: rows of unequal"),
        ({"cell_size": 0.0}, BadInputError, "cell_size: got 0.0"),
        ({"cell_size": -1}, BadInputError, "cell_size: got -1"),
        ({"cell_size": float("nan")}, BadInputError, "cell_size: got nan"),
        ({"cell_size": float("inf")}, BadInputError, "cell_size: got inf"),
        ({"cell_size": 10**400}, BadInputError, "cell_size: got a whole number of more than 308"),
        ({"cell_size": -(10**5000)}, BadInputError, "cell_size: got a whole number of more than"),
        ({"cell_size": "250"}, BadTypeError, "cell_size: got '250'"),
        ({"cell_size": True}, BadTypeError, "cell_size: got True"),
        ({"origin": (0.0,)}, BadInputError, "origin: got 1 numbers"),
        ({"origin": 3.0}, BadTypeError, "origin: got 3.0"),
        ({"origin": np.array(3.0)}, BadTypeError, "origin: got 3.0"),
        ({"origin": np.zeros(3)}, BadInputError, "origin: got 3 numbers"),
        ({"origin": "xy"}, BadTypeError, "origin: got 'xy'"),
        ({"origin": (0.0, float("nan"))}, BadInputError, r"origin\[1\]: got nan"),
    ],
)
def test_grid_map_refuses(change: dict, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        GridMap(**{"blocked": OPEN, **change})


def test_grid_map_is_immutable_and_private() -> None:
    cells = OPEN.copy()
    grid = GridMap(cells)
    cells[0, 0] = True
    assert not grid.blocked.any()
    with pytest.raises(ValueError, match="read-only"):
        grid.blocked[0, 0] = True
    with pytest.raises(dataclasses.FrozenInstanceError):
        grid.cell_size = 2.0  # type: ignore[misc]


def test_equality_is_cells_size_and_place() -> None:
    grid = GridMap(OPEN, 2.0, (1.0, 3.0), "a")
    same = GridMap(OPEN, 2, (1, 3), "b")
    assert grid == same
    assert hash(grid) == hash(same)
    assert grid != GridMap(~OPEN, 2.0, (1.0, 3.0))
    assert grid != GridMap(OPEN, 2.5, (1.0, 3.0))
    assert grid != GridMap(OPEN, 2.0, (1.0, 2.0))
    assert grid != "grid"


def test_extent_shape_and_share() -> None:
    blocked = OPEN.copy()
    blocked[0] = True
    grid = GridMap(blocked, 2.5, (-10.0, 4.0))
    assert grid.shape == (3, 4)
    assert grid.extent == (-10.0, 0.0, 4.0, 11.5)
    assert grid.free_share == pytest.approx(2 / 3)


@examples(50)
@given(
    CELLS,
    st.floats(1e-3, 1e3),
    st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3)),
    st.integers(0, 2**32 - 1),
)
def test_points_cells_and_blocked_agree(
    blocked: np.ndarray, cell_size: float, origin: tuple[float, float], seed: int
) -> None:
    grid = GridMap(blocked, cell_size, origin)
    cells = np.argwhere(np.ones_like(blocked))[:, ::-1]
    centres = grid.points_of(cells)
    np.testing.assert_array_equal(grid.cells_of(centres), cells)
    inside = np.random.default_rng(seed).uniform(-0.49, 0.49, centres.shape) * cell_size
    expected = blocked[cells[:, 1], cells[:, 0]]
    np.testing.assert_array_equal(grid.is_blocked(centres + inside), expected)


def test_outside_the_map_is_blocked() -> None:
    grid = GridMap(OPEN, 1.0, (0.0, 0.0))
    points = [[-0.01, 1.0], [4.01, 1.0], [1.0, -0.01], [1.0, 3.01], [1.0, 1.0], [1e12, 0.0]]
    np.testing.assert_array_equal(grid.is_blocked(points), [True] * 4 + [False, True])
    assert grid.is_blocked([1.0, 1.0]).shape == ()


@pytest.mark.parametrize("points", [[[0.0, np.nan]], [[np.inf, 0.0]], [1.0, 2.0, 3.0], 1.0])
def test_points_must_be_finite_pairs(points: object) -> None:
    grid = GridMap(OPEN)
    for method in (grid.cells_of, grid.is_blocked, grid.points_of):
        with pytest.raises(BadInputError, match=r"(points|cells): got"):
            method(points)


@pytest.mark.parametrize("points", ["here", [["a", "b"]], [[1.0, 2.0], [3.0]], None])
def test_points_must_be_numbers(points: object) -> None:
    with pytest.raises((BadTypeError, BadInputError), match=r"points: (got|rows)"):
        GridMap(OPEN).cells_of(points)


@examples(40)
@given(CELLS, st.floats(0.1, 50.0))
def test_clearance_against_all_pairs(blocked: np.ndarray, cell_size: float) -> None:
    land = np.argwhere(blocked)
    cells = np.argwhere(np.ones_like(blocked))
    if len(land):
        expected = cdist(cells, land).min(axis=1).reshape(blocked.shape) * cell_size
    else:
        expected = np.full(blocked.shape, np.inf)
    np.testing.assert_allclose(GridMap(blocked, cell_size).clearance(), expected, rtol=1e-12)


@pytest.mark.parametrize("radius", [0.0, 0.3, 0.5, 1.1])
def test_inflated_agrees_with_the_kernel(radius: float) -> None:
    blocked = np.random.default_rng(2).random((20, 30)) < 0.05
    grid = GridMap(blocked, 0.1, (5.0, 6.0), "pond")
    grown = grid.inflated(radius)
    np.testing.assert_array_equal(grown.blocked, grids.inflate(blocked, radius / 0.1))
    assert (grown.cell_size, grown.origin, grown.name) == (0.1, (5.0, 6.0), "pond")


@pytest.mark.parametrize(
    ("radius", "error"),
    [(-0.1, BadInputError), (float("nan"), BadInputError), ("1", BadTypeError)],
)
def test_inflated_refuses(radius: object, error: type[Exception]) -> None:
    with pytest.raises(error, match="radius_m: got"):
        GridMap(OPEN).inflated(radius)  # type: ignore[arg-type]


# --- refinement ------------------------------------------------------------------------------


@examples(60)
@given(CELLS, st.integers(1, 6))
def test_refined_is_bilinear_interpolation(blocked: np.ndarray, factor: int) -> None:
    grid = GridMap(blocked, 12.0, (3.0, -4.0)).refined(factor)
    height, width = blocked.shape
    assert grid.shape == (height * factor, width * factor)
    assert grid.cell_size == pytest.approx(12.0 / factor)
    assert grid.origin == (3.0, -4.0)
    y, x = (np.mgrid[: height * factor, : width * factor] + 0.5) / factor - 0.5
    weight = ndimage.map_coordinates(blocked.astype(float), [y, x], order=1, mode="nearest")
    np.testing.assert_array_equal(grid.blocked, weight > 0.5 - 1e-9)


def test_refined_by_one_is_the_same_map() -> None:
    grid = GridMap(np.random.default_rng(0).random((5, 6)) < 0.4, 2.0)
    assert grid.refined(1) == grid


@examples(60)
@given(CELLS, st.sampled_from([3, 5]))
def test_refined_keeps_water_connected(blocked: np.ndarray, factor: int) -> None:
    """With an odd factor, the middle one of the new cells has the old one's centre."""
    before = GridMap(blocked).components()
    after = (
        GridMap(blocked).refined(factor).components()[factor // 2 :: factor, factor // 2 :: factor]
    )
    np.testing.assert_array_equal(after > 0, before > 0)
    for label in range(1, before.max() + 1):
        assert len(np.unique(after[before == label])) == 1


@pytest.mark.parametrize(
    ("factor", "error"), [(0, BadInputError), (-2, BadInputError), (2.0, BadTypeError)]
)
def test_refined_refuses(factor: object, error: type[Exception]) -> None:
    with pytest.raises(error, match="factor: got"):
        GridMap(OPEN).refined(factor)  # type: ignore[arg-type]


# --- connected water -------------------------------------------------------------------------


def eight_connected(blocked: np.ndarray) -> nx.Graph:
    """Free cells joined as a planner moves: diagonally only past two free side cells."""
    graph = nx.Graph()
    graph.add_nodes_from(map(tuple, np.argwhere(~blocked)))
    for y, x in list(graph):
        for other in ((y, x + 1), (y + 1, x)):
            if other in graph:
                graph.add_edge((y, x), other)
        for step in (-1, 1):
            if {(y + 1, x + step), (y + 1, x), (y, x + step)} <= set(graph):
                graph.add_edge((y, x), (y + 1, x + step))
    return graph


@examples(40)
@given(CELLS)
def test_components_are_what_a_planner_can_reach(blocked: np.ndarray) -> None:
    grid = GridMap(blocked)
    labels = grid.components()
    np.testing.assert_array_equal(labels == 0, blocked)
    bodies = {frozenset(body) for body in nx.connected_components(eight_connected(blocked))}
    ours = {
        frozenset(map(tuple, np.argwhere(labels == label))) for label in range(1, labels.max() + 1)
    }
    assert ours == bodies
    sizes = np.bincount(labels.ravel())[1:]
    assert (np.diff(sizes) <= 0).all()
    assert grid.largest_component().sum() == max(map(len, bodies), default=0)


# --- random maps -----------------------------------------------------------------------------


def test_random_maps_by_seed_key_and_shard() -> None:
    by_seed = random_maps(11, 4, (6, 5), 0.3)
    assert by_seed.shape == (4, 6, 5)
    assert by_seed.dtype == bool
    np.testing.assert_array_equal(by_seed, random_maps(jax.random.key(11), 4, (6, 5), 0.3))
    np.testing.assert_array_equal(by_seed, random_maps(jax.random.PRNGKey(11), 4, (6, 5), 0.3))
    shard = random_maps(11, 4, (6, 5), 0.3, first=2)
    np.testing.assert_array_equal(by_seed[2:], shard[:2])
    assert not np.array_equal(by_seed, random_maps(12, 4, (6, 5), 0.3))


def test_random_maps_do_not_depend_on_how_many_are_drawn_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    together = random_maps(5, 10, (6, 5), 0.4)
    monkeypatch.setattr("usvjax.maps.cells._CELLS_PER_CALL", 4 * 6 * 5)
    np.testing.assert_array_equal(random_maps(5, 10, (6, 5), 0.4), together)


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"n": 0}, BadInputError, "n: got 0"),
        ({"n": -3}, BadInputError, "n: got -3"),
        ({"n": 2.0}, BadTypeError, "n: got 2.0"),
        ({"density": 1.01}, BadInputError, "density: got 1.01"),
        ({"density": -0.1}, BadInputError, "density: got -0.1"),
        ({"density": float("nan")}, BadInputError, "density: got nan"),
        ({"density": "0.1"}, BadTypeError, "density: got '0.1'"),
        ({"shape": (0, 5)}, BadInputError, r"shape\[0\]: got 0"),
        ({"shape": (5, 2.5)}, BadTypeError, r"shape\[1\]: got 2.5"),
        ({"shape": 50}, BadTypeError, "shape: got 50"),
        ({"shape": (5, 5, 5)}, BadTypeError, "shape: got"),
        ({"first": -1}, BadInputError, "first: got -1"),
        ({"first": 2**32 - 1, "n": 2}, BadInputError, "first"),
        ({"key": -1}, BadInputError, "key: got -1"),
        ({"key": 2**32}, BadInputError, "key: got 4294967296"),
        ({"key": 1.5}, BadTypeError, "key: got 1.5"),
        ({"key": jax.random.split(jax.random.key(0), 2)}, BadInputError, "key: got an array"),
        ({"key": jax.random.key(0, impl="rbg")}, BadInputError, "key: got a 'rbg' key"),
    ],
)
def test_random_maps_refuses(change: dict, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        random_maps(**{"key": 0, "n": 2, "shape": (5, 5), "density": 0.1, **change})


# --- Hongze Lake -----------------------------------------------------------------------------


def data_folder() -> Path:
    return Path(usvjax.__file__).parent / "data" / "hongze"


@pytest.mark.parametrize("size", [250, 500, 1000])
def test_the_packaged_lake_is_the_raster_north_up(size: int) -> None:
    lake = hongze_lake(size)
    sidecar = json.loads((data_folder() / f"hongze_{size}m.json").read_text())
    assert lake.cell_size == size
    assert lake.shape == (sidecar["height"], sidecar["width"])
    assert (~lake.blocked).sum() == sidecar["water_cells"]
    northern_row = (data_folder() / f"hongze_{size}m.map").read_text().splitlines()[4]
    np.testing.assert_array_equal(lake.blocked[-1], [cell == "@" for cell in northern_row])
    assert "GSHHG" in lake.attribution
    assert "LGPL-3.0" in lake.attribution


def test_all_cell_sizes_share_one_world() -> None:
    fine = hongze_lake(250)
    for size in (125, 500, 1000):
        other = hongze_lake(size)
        assert other.extent[0] == fine.extent[0]
        assert other.extent[3] == fine.extent[3]
        points = fine.points_of(np.argwhere(~fine.blocked)[:, ::-1])
        assert other.is_blocked(points).mean() < 0.09


def test_the_finer_lake_is_interpolated() -> None:
    lake = hongze_lake(125)
    assert lake == hongze_lake(250).refined(2)
    assert lake.free_share == pytest.approx(hongze_lake(250).free_share, rel=0.01)
    assert hongze_lake(250 / 3).shape == (365 * 3, 427 * 3)


@pytest.mark.parametrize(
    ("size", "error"),
    [
        (100, BadInputError),
        (750, BadInputError),
        (2000, BadInputError),
        (5, BadInputError),
        (0, BadInputError),
        (1e-310, BadInputError),
        (float("nan"), BadInputError),
        ("250", BadTypeError),
    ],
)
def test_hongze_refuses_other_cell_sizes(size: object, error: type[Exception]) -> None:
    with pytest.raises(error, match="cell_size: got"):
        hongze_lake(size)  # type: ignore[arg-type]


def test_the_attribution_is_packaged() -> None:
    text = (data_folder() / "ATTRIBUTION.md").read_text()
    for word in ("GSHHG", "Wessel", "Smith", "LGPL-3.0", "10.1029/96JB00104"):
        assert word in text


def test_maps_are_found_by_name() -> None:
    for name, size in zip(packaged_names(), (250, 500, 1000), strict=True):
        assert find_map(name) == hongze_lake(size)
    assert find_map("hongze-125") == hongze_lake(125)
    path = data_folder() / "hongze_500m.map"
    assert find_map(path).shape == hongze_lake(500).shape


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("hongse-250", {}, "hongse-250: neither a map file nor a packaged map .*hongze-250"),
        ("hongze-300", {}, "cell_size: got 300"),
        ("hongze-250", {"cell_size": 100.0}, "hongze-250: a packaged map has its own"),
        ("nowhere.map", {}, "nowhere.map: no such file"),
    ],
)
def test_find_map_refuses(name: str, options: dict, words: str) -> None:
    with pytest.raises(BadInputError, match=words):
        find_map(name, **options)
