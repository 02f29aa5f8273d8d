"""Shortest paths by sweeps: exact, valid, and the same whatever else is solved with them."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from grid_oracle import check_path, lengths
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples

from usvjax.search.inputs import SearchScene, search_scene
from usvjax.search.sweeping import SweepPaths, pack_maps, sweep_paths
from usvkernels.search import sweep_search
from usvkernels.search.steps import (
    SMALL_UNITS,
    UNITS,
    Units,
    cells,
    counts,
    manhattan,
    moves,
    octile,
)
from usvkernels.search.sweep import Sweep
from usvkernels.status import Status

RULES: dict[str, dict[str, Any]] = {
    "octile": {},
    "cutting": {"corner_cutting": True},
    "four": {"connectivity": 4},
}


def random_scene(
    seed: int, count: int, shape: tuple[int, int], density: float | None = None
) -> SearchScene:
    """Random maps, of random densities 0 to 0.6 by default, random starts and goals."""
    rng = np.random.default_rng(seed)
    height, width = shape
    share = rng.random((count, 1, 1)) * 0.6 if density is None else density
    blocked = rng.random((count, height, width)) < share
    ends = rng.integers(0, [width, height], (2, count, 2))
    for end in ends:
        blocked[np.arange(count), end[:, 1], end[:, 0]] = False
    return search_scene(blocked, ends[0], ends[1])


def assert_exact(scene: SearchScene, result: SweepPaths, rules: dict[str, Any]) -> None:
    """Every answer against Dijkstra, every path step by step."""
    for row in range(len(scene)):
        blocked = scene.blocked[0 if scene.shared else row]
        start, goal = scene.starts[row], scene.goals[row]
        length = lengths(blocked, start[None], **rules)[goal[1], goal[0]]
        count, path = result.path_cells[row], result.path[row]
        if np.isinf(length):
            assert result.status[row] == Status.UNREACHABLE
            assert np.isinf(result.cost[row])
            assert count == 0
            assert (path == -1).all()
            continue
        assert result.status[row] == Status.FOUND
        assert result.cost[row] == pytest.approx(length, abs=1e-9)
        assert (path[0] == start).all()
        assert (path[count - 1 :] == goal).all()
        assert check_path(blocked, path[:count], **rules) == pytest.approx(length, abs=1e-9)


def assert_same(one: SweepPaths, other: SweepPaths, rows: np.ndarray | slice) -> None:
    """`other` holds these rows of `one`."""
    for name in ("status", "cost", "path_cells", "expanded", "passes"):
        np.testing.assert_array_equal(getattr(one, name)[rows], getattr(other, name), name)
    for path, count, again in zip(one.path[rows], other.path_cells, other.path, strict=True):
        np.testing.assert_array_equal(path[:count], again[:count])


@pytest.mark.parametrize(
    ("shape", "rule"),
    [((5, 5), "cutting"), ((40, 27), "octile"), *(((12, 31), rule) for rule in RULES)],
)
def test_random_maps(shape: tuple[int, int], rule: str) -> None:
    scene = random_scene(1, 150, shape)
    assert_exact(scene, sweep_paths(scene, **RULES[rule]), RULES[rule])


@pytest.mark.parametrize("shape", [(1, 9), (9, 1), (1, 1)])
def test_thin_maps(shape: tuple[int, int]) -> None:
    scene = random_scene(2, 70, shape, 0.3)
    assert_exact(scene, sweep_paths(scene), {})


@examples(40)
@given(st.integers(0, 2**32 - 1), st.floats(0, 0.7), st.sampled_from(list(RULES)))
def test_any_map(seed: int, density: float, rule: str) -> None:
    scene = random_scene(seed, 9, (12, 31), density)
    assert_exact(scene, sweep_paths(scene, **RULES[rule]), RULES[rule])


def test_long_maps_need_the_wide_units() -> None:
    scene = random_scene(3, 12, (20, 260))
    result = sweep_paths(scene)
    assert result.cost[np.isfinite(result.cost)].max() > 193
    assert_exact(scene, result, {})


def serpentine(width: int, height: int) -> np.ndarray:
    """Every second row is a wall with a gap at one end, now left, now right."""
    blocked = np.zeros((height, width), bool)
    blocked[1::2] = True
    blocked[1::4, -1] = blocked[3::4, 0] = False
    return blocked


def test_winding_path_on_a_small_map() -> None:
    # 441 cells of way: more than 16 bits hold, and than the first guess at a path's cells.
    maps = np.stack([serpentine(21, 41), serpentine(21, 41)[:, ::-1], np.zeros((41, 21), bool)])
    scene = search_scene(maps, [[0, 0], [20, 0], [0, 0]], [[20, 40], [0, 40], [20, 40]])
    result = sweep_paths(scene)
    assert_exact(scene, result, {})
    assert result.path_cells.tolist() == [461, 461, 41]


def test_lengths_beyond_the_units_are_told() -> None:
    sweep = Sweep(21, 41, 1, 8, SMALL_UNITS)
    packed = pack_maps(serpentine(21, 41)[None], 1, 1)
    ends = np.array([[[0, 0]]], np.int32), np.array([[[20, 40]]], np.int32)
    live = np.ones((1, 1), bool)
    queries = jax.tree.map(jnp.asarray, sweep_search.SweepQueries(packed, *ends, live))
    routes = sweep_search.solve(sweep, 16, queries, np.int32(1), np.int32(0))
    assert int(routes.status[0, 0]) == Status.OUT_OF_BUDGET


def test_start_is_goal() -> None:
    scene = search_scene(np.zeros((4, 6), bool), [[3, 2], [0, 0]], [[3, 2], [0, 0]])
    result = sweep_paths(scene)
    assert result.cost.tolist() == [0.0, 0.0]
    assert result.path.tolist() == [[[3, 2]], [[0, 0]]]
    assert result.path_cells.tolist() == [1, 1]
    assert result.expanded.tolist() == [1, 1]


def test_blocked_ends() -> None:
    blocked = np.zeros((4, 6), bool)
    blocked[2, 3] = True
    scene = search_scene(blocked, [[3, 2], [0, 0], [0, 0]], [[0, 0], [3, 2], [5, 3]], "status")
    result = sweep_paths(scene)
    assert result.status.tolist() == [Status.BLOCKED, Status.BLOCKED, Status.FOUND]
    assert result.path_cells.tolist() == [0, 0, 7]
    assert (result.path[:2] == -1).all()


def test_all_ends_blocked() -> None:
    blocked = np.eye(3, dtype=bool)
    result = sweep_paths(search_scene(blocked, [1, 1], [0, 2], "status"))
    assert result.status.tolist() == [Status.BLOCKED]
    assert result.path.shape == (1, 1, 2)


def test_unreachable_expands_what_can_be_reached() -> None:
    blocked = np.zeros((7, 9), bool)
    blocked[:, 4] = True
    result = sweep_paths(search_scene(blocked, [0, 0], [8, 6]))
    assert result.status.tolist() == [Status.UNREACHABLE]
    assert result.expanded.tolist() == [28]


def test_expanded_is_what_every_a_star_must_expand() -> None:
    scene = random_scene(5, 100, (12, 31), 0.25)
    result = sweep_paths(scene)
    y, x = np.mgrid[:12, :31]
    checked = 0
    for row in np.flatnonzero(result.status == Status.FOUND):
        g = lengths(scene.blocked[row], scene.starts[row][None])
        dx, dy = np.abs(x - scene.goals[row, 0]), np.abs(y - scene.goals[row, 1])
        f = g + np.maximum(dx, dy) + (np.sqrt(2) - 1) * np.minimum(dx, dy)
        path = result.path[row, : result.path_cells[row]]
        tied = np.abs(f[path[:, 1], path[:, 0]] - result.cost[row]) < 1e-9
        assert result.expanded[row] == (f < result.cost[row] - 1e-9).sum() + tied.sum()
        checked += 1
    assert checked > 50


def test_empty_map_expands_the_path_alone() -> None:
    result = sweep_paths(search_scene(np.zeros((12, 31), bool), [0, 3], [30, 11]))
    assert result.expanded.tolist() == result.path_cells.tolist() == [31]


def test_same_result_in_any_company() -> None:
    scene = random_scene(6, 700, (12, 31), 0.3)
    whole = sweep_paths(scene)
    assert len(np.unique(whole.passes)) > 4  # some are left over and regrouped
    rng = np.random.default_rng(0)
    for rows in (rng.permutation(700), np.array([17])):
        part = SearchScene(
            scene.blocked[rows], scene.starts[rows], scene.goals[rows], scene.open_ends[rows]
        )
        assert_same(whole, sweep_paths(part), rows)
    assert_same(whole, sweep_paths(scene, max_lanes=8), slice(None))


def test_shared_map_is_as_a_map_each() -> None:
    scene = random_scene(7, 1, (12, 31), 0.2)
    ends = random_scene(8, 300, (12, 31), 0.0)
    shared = search_scene(scene.blocked[0], ends.starts, ends.goals, "status")
    each = np.repeat(scene.blocked, 300, axis=0)
    apart = search_scene(each, ends.starts, ends.goals, "status")
    one, other = sweep_paths(shared), sweep_paths(apart)
    assert (one.status == Status.FOUND).sum() > 150
    assert_same(one, other, slice(None))


def test_mirrored_queries_have_mirrored_paths() -> None:
    scene = random_scene(9, 80, (12, 31), 0.2)
    result = sweep_paths(scene)
    moved = scene.starts[:, 0] != scene.goals[:, 0]
    flipped = search_scene(
        scene.blocked[:, :, ::-1], [30, 0] + scene.starts * [-1, 1], [30, 0] + scene.goals * [-1, 1]
    )
    other = sweep_paths(flipped)
    np.testing.assert_array_equal(result.cost, other.cost)
    assert (moved & (result.status == Status.FOUND)).sum() > 50
    np.testing.assert_array_equal(result.expanded[moved], other.expanded[moved])
    for row in np.flatnonzero(moved & (result.status == Status.FOUND)):
        count = result.path_cells[row]
        back = [30, 0] + other.path[row, :count] * [-1, 1]
        np.testing.assert_array_equal(result.path[row, :count], back)


# --- units ------------------------------------------------------------------------------------


@pytest.mark.parametrize("units", [SMALL_UNITS, UNITS])
def test_units_compare_as_lengths_do(units: Units) -> None:
    """Over all that fit below the cap, the closest calls among differences of steps."""
    most = int(units.cap / units.diagonal) + 1
    diagonal = np.arange(1, most, dtype=np.int64)
    for rounded in (np.floor(diagonal * np.sqrt(2)), np.ceil(diagonal * np.sqrt(2))):
        straight = rounded.astype(np.int64)
        exact = np.sign(2 * diagonal**2 - straight**2)
        assert (np.sign(diagonal * units.diagonal - straight * units.straight) == exact).all()


@pytest.mark.parametrize("units", [SMALL_UNITS, UNITS])
def test_steps_are_told_apart_again(units: Units) -> None:
    rng = np.random.default_rng(0)
    diagonal = rng.integers(0, units.cap // units.diagonal, 10_000)
    room = (units.cap - 1 - diagonal * units.diagonal) // units.straight
    straight = (room * rng.random(10_000)).astype(np.int64)
    length = straight * units.straight + diagonal * units.diagonal
    np.testing.assert_array_equal(counts(length, units), [straight, diagonal])
    np.testing.assert_allclose(cells(length, units), straight + diagonal * np.sqrt(2.0))
    assert cells(units.cap, units) == np.inf
    assert units.cap + units.diagonal < units.flag
    assert units.flag + units.cap + units.diagonal < 2**units.bits


def test_distances_on_a_free_map() -> None:
    assert octile(3, 5) == 3 * UNITS.diagonal + 2 * UNITS.straight
    assert manhattan(3, 5) == 8 * UNITS.straight
    assert len(moves()) == len(set(moves())) == 8
    assert moves(4) == moves()[:4]
    assert all((x * x + y * y == 2) == (cost == UNITS.diagonal) for x, y, cost in moves())
