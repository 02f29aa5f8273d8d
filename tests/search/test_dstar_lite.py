"""D* Lite against Dijkstra on every map as it was known, and against a plain D* Lite."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import dstar_reference as plain
import jax
import numpy as np
import pytest
from dstar_scenes import (
    CHANGES,
    EPISODES,
    FREE,
    HEIGHT,
    STEPS,
    WIDTH,
    Changes,
    Scenes,
    random_scenes,
    scenes_of,
    wall,
)

from usvjax.search.replanning import DstarLiteResult, dstar_lite
from usvkernels.status import Status

EXACT = ("octile", "chebyshev")
METHODS: dict[str, dict[str, Any]] = {
    "octile": {},
    "cutting corners": {"corner_cutting": True},
    "chebyshev": {"heuristic": "chebyshev"},
    "weighted": {"heuristic": "weighted"},
    "weighted octile": {"heuristic": "weighted_octile", "weight": 2.5},
    "sensing": {"sensing": (5, 5)},
    "sensing, weighted": {"sensing": (3, 7), "heuristic": "weighted_octile"},
}
SQUARE_ROOT = np.sqrt(2.0)


@pytest.fixture(autouse=True)
def _one_device() -> Iterator[None]:
    """Programs are compiled per device; one of these tests takes them all."""
    with jax.default_device(jax.devices()[0]):
        yield


def length(units: int) -> float:
    """Cells of a length in units that stays below a thousand diagonal steps."""
    if units >= plain.INF:
        return np.inf
    diagonal = next(d for d in range(1000) if (units - d * plain.DIAGONAL) % plain.STRAIGHT == 0)
    return (units - diagonal * plain.DIAGONAL) // plain.STRAIGHT + diagonal * SQUARE_ROOT


def step_length(here: np.ndarray, there: np.ndarray) -> float:
    return float(np.hypot(*(there - here)))


def assert_sound(
    scenes: Scenes, result: DstarLiteResult, rows: int = EPISODES, **method: Any
) -> None:
    """Every record and every move of the first `rows` episodes is right, by Dijkstra."""
    cutting, sensing = method.get("corner_cutting", False), method.get("sensing")
    exact = method.get("heuristic", "octile") in EXACT
    for row in range(rows):
        goal = scenes.ends(row)[1]
        position, cost = result.position[row], result.cost_to_go[row]
        maps = plain.replay(scenes.blocked[row], position, goal, scenes.flips[row], sensing)
        for t in range(STEPS + 1):
            best = plain.distances(maps.known[t], goal, cutting)[position[t, 1], position[t, 0]]
            best = best / plain.STRAIGHT
            if exact or np.isinf(best):
                assert cost[t] == pytest.approx(best, rel=1e-9), (row, t)
            else:
                assert best * (1 - 1e-9) <= cost[t] < np.inf, (row, t)
        for t in range(STEPS):
            here, there = (tuple(cell) for cell in position[t : t + 2].tolist())
            ahead = plain.distances(maps.planned[t], goal, cutting)
            if here == there:
                assert here == goal or np.isinf(ahead[here[1], here[0]]), (row, t)
                continue
            steps = dict(plain.steps_from(maps.true[t], here, cutting))
            assert there in steps, (row, t)
            if exact:
                assert steps[there] + ahead[there[1], there[0]] == ahead[here[1], here[0]], (row, t)


@pytest.fixture(scope="module")
def scenes() -> Scenes:
    return random_scenes(7)


@pytest.mark.parametrize("name", METHODS)
def test_every_record_is_right(scenes: Scenes, name: str) -> None:
    result = scenes.sail(**METHODS[name])
    assert_sound(scenes, result, **METHODS[name])
    assert set(result.status.tolist()) <= {Status.REACHED, Status.UNREACHABLE, Status.FOUND}
    cut_off = np.isinf(result.cost_to_go)
    assert np.any(cut_off[:, :-1] & ~cut_off[:, 1:])  # some are let go again
    assert np.any(~cut_off[:, :-1] & cut_off[:, 1:])


@pytest.mark.parametrize("name", METHODS)
def test_same_as_a_plain_planner(scenes: Scenes, name: str) -> None:
    """Not only the costs: the same cells expanded, and of equal moves the same one."""
    result = scenes.sail(**METHODS[name])
    for row in range(EPISODES):
        start, goal = scenes.ends(row)
        want = plain.sail(scenes.blocked[row], start, goal, scenes.flips[row], **METHODS[name])
        assert result.position[row].tolist() == [list(cell) for cell in want.position], row
        assert result.expanded[row].tolist() == want.expanded, row
        assert result.cost_to_go[row] == pytest.approx([length(c) for c in want.cost]), row


def test_keys_of_one_part_serve_as_well_as_pairs() -> None:
    scenes = random_scenes(11)
    single = double = 0
    for row in range(EPISODES):
        start, goal = scenes.ends(row)
        episode = (scenes.blocked[row], start, goal, scenes.flips[row])
        one, two = plain.sail(*episode), plain.sail(*episode, two_part=True)
        assert one.cost[0] == two.cost[0]
        single, double = single + sum(one.expanded), double + sum(two.expanded)
    assert single <= 1.02 * double


def test_replanning_touches_only_what_changed() -> None:
    """Far from the vessel, behind the goal: nothing to do. A new search would cost hundreds."""
    quiet: Changes = [[]] * 6
    changes = [[(12, 10)], [(12, 0)], [], [(12, 10)], [(11, 0)], []]
    result = scenes_of((FREE, (0, 5), (8, 5), quiet), (FREE, (0, 5), (8, 5), changes)).sail()
    assert result.expanded[0, 0] >= 9
    assert np.all(result.expanded[0, 1:] == 0)
    assert np.all(result.expanded[1, 1:] == 0)
    assert np.array_equal(result.position[0], result.position[1])


# --- ways in which other implementations fail ---------------------------------------------------


def test_a_door_that_closes_and_opens_again_and_again() -> None:
    """Cut off and let go, with the open list run empty in between: no false "no path"."""
    door = [(6, 9)]
    changes = [door if t % 3 == 2 else [] for t in range(30)]
    scenes = scenes_of(
        (wall(6, 9), (0, 0), (12, 0), changes),
        (wall(6), (0, 0), (12, 0), [[]] * 5 + [door]),  # opens for the first time
        (wall(6, 9), (0, 0), (12, 0), [door]),  # closes for good
    )
    result = scenes.sail()
    assert_sound(scenes, result, rows=3)
    assert result.status[:3].tolist() == [Status.REACHED, Status.REACHED, Status.UNREACHABLE]
    assert np.all(np.isinf(result.cost_to_go[1, :6]))
    assert np.isfinite(result.cost_to_go[1, 6])
    assert np.all(result.position[2] == result.position[2, 0])


def ring(cell: plain.Cell) -> list[plain.Cell]:
    return [(cell[0] + x, cell[1] + y) for x, y in plain.AROUND]


def test_start_and_goal_walled_in_and_freed() -> None:
    """The vessel's own cell stays unexpanded, or the goal's alone is expanded, for many changes."""
    start, goal = (2, 5), (10, 5)
    at_start, at_goal = FREE.copy(), FREE.copy()
    for grid, cell in ((at_start, start), (at_goal, goal)):
        for x, y in ring(cell):
            grid[y, x] = True
    elsewhere = [[(6, y)] for y in range(8)]
    scenes = scenes_of(
        (at_start, start, goal, [*elsewhere, [ring(start)[1]]]),
        (at_goal, start, goal, [*elsewhere, [ring(goal)[6]]]),
        (FREE, start, goal, [ring(start)[:6], ring(start)[6:], *elsewhere, ring(start)[3:5]]),
        (FREE, start, goal, [ring(goal)[:6], ring(goal)[6:], *elsewhere, ring(goal)[2:6]]),
    )
    result = scenes.sail()
    assert_sound(scenes, result, rows=4)
    assert np.all(np.isinf(result.cost_to_go[:2, :9]))
    assert np.all(result.status[:4] == Status.REACHED)


def test_changes_while_cut_off_after_a_long_way() -> None:
    """Keys of the far side date from long ago when the way opens, and what they say is outdated."""
    changes: Changes = [[] for _ in range(STEPS)]
    changes[5] = [(6, 9)]
    for t in range(8, 20):
        changes[t] = [(t % 5 + 7, y) for y in (t % 7, t % 7 + 2)]
    changes[20] = [(6, 0)]
    scenes = scenes_of((wall(6, 9), (5, 0), (12, 10), changes))
    result = scenes.sail()
    assert_sound(scenes, result, rows=1)
    assert result.status[0] == Status.REACHED
    assert np.all(np.isinf(result.cost_to_go[0, 6:21]))


@pytest.mark.parametrize("name", ["octile", "cutting corners", "chebyshev", "weighted"])
def test_never_back_and_forth_where_nothing_changes(name: str) -> None:
    """Open water and symmetric obstacles, full of ties: each move brings the vessel nearer."""
    bar, cup = FREE.copy(), FREE.copy()
    bar[2:9, 6] = True
    cup[2:9, 6] = cup[2, 3:7] = cup[8, 3:7] = True
    quiet: Changes = []
    scenes = scenes_of(
        *((grid, (1, 5), (11, 5), quiet) for grid in (FREE, bar, cup)),
        (cup, (5, 5), (11, 5), quiet),
        (cup, (4, 3), (11, 10), quiet),
    )
    result = scenes.sail(**METHODS[name])
    assert np.all(result.status[:5] == Status.REACHED)
    for row in range(5):
        moves = np.flatnonzero(np.any(np.diff(result.position[row], axis=0), axis=1))
        visited = result.position[row, : len(moves) + 1]
        assert len(np.unique(visited, axis=0)) == len(visited)
        sailed = sum(step_length(*visited[t : t + 2]) for t in moves)
        assert sailed <= result.cost_to_go[row, 0] + 1e-9
        fall = -np.diff(result.cost_to_go[row, : len(visited)])
        steps = [step_length(*visited[t : t + 2]) for t in moves]
        assert np.all(fall >= np.array(steps) - 1e-9)
        if METHODS[name].get("heuristic", "octile") in EXACT:
            assert sailed == pytest.approx(result.cost_to_go[row, 0])


def test_back_and_forth_only_as_doors_change() -> None:
    """Two doors open in turn, far apart: the vessel turns round, rightly each time."""
    both = wall(6, 0)
    doors: list[plain.Cell] = [(6, 0), (6, 10)]
    changes = [doors if t % 4 == 0 else [] for t in range(1, STEPS)]
    scenes = scenes_of((both, (1, 5), (12, 5), changes), (both, (4, 5), (12, 5), changes))
    result = scenes.sail()
    assert_sound(scenes, result, rows=2)
    assert np.any(np.diff(result.position[0, :, 1]) > 0)
    assert np.any(np.diff(result.position[0, :, 1]) < 0)


# --- what the arguments mean --------------------------------------------------------------------


def test_own_cell_and_goal_never_change() -> None:
    changes: Changes = [[(t, 5), (12, 5)] for t in range(12)]
    scenes = scenes_of((FREE, (0, 5), (12, 5), changes), (FREE, (0, 5), (12, 5), []))
    result = scenes.sail()
    assert np.array_equal(result.position[0], result.position[1])
    assert np.array_equal(result.cost_to_go[0], result.cost_to_go[1])
    assert result.position[0, 12].tolist() == [12, 5]


def test_a_cell_named_twice_is_as_before() -> None:
    twice: Changes = [[(3, 5), (3, 5)], [(4, 5), (9, 9), (4, 5)]]
    once: Changes = [[], [(9, 9)]]
    result = scenes_of((FREE, (0, 5), (12, 5), twice), (FREE, (0, 5), (12, 5), once)).sail()
    assert np.array_equal(result.cost_to_go[0], result.cost_to_go[1])
    assert np.array_equal(result.position[0], result.position[1])


def test_neither_order_nor_place_within_a_step_matters(scenes: Scenes) -> None:
    rng = np.random.default_rng(3)
    order = rng.permuted(np.tile(np.arange(CHANGES), (EPISODES, STEPS, 1)), axis=2)
    shuffled = np.take_along_axis(scenes.flips, order[..., None], axis=2)
    want, got = scenes.sail(), replace(scenes, flips=shuffled).sail()
    assert np.array_equal(got.position, want.position)
    assert np.array_equal(got.cost_to_go, want.cost_to_go)
    assert np.array_equal(got.expanded, want.expanded)


def test_changes_after_arrival_matter_to_nobody() -> None:
    changes: Changes = [[], [], [], *([[(1, 1), (0, 0)]] * 9)]
    result = scenes_of((FREE, (3, 0), (0, 0), changes)).sail()
    assert result.position[0, 3:].tolist() == [[0, 0]] * (STEPS - 2)
    assert np.all(result.cost_to_go[0, 3:] == 0)
    assert np.all(result.expanded[0, 4:] == 0)


def test_how_episodes_end() -> None:
    shut = wall(6)
    onto = FREE.copy()
    onto[0, 0] = True
    scenes = scenes_of(
        (FREE, (0, 5), (12, 5), []),
        (FREE, (4, 4), (4, 4), [[(4, 5)]]),
        (shut, (0, 5), (12, 5), []),
        (onto, (0, 0), (12, 5), []),
        (onto, (12, 5), (0, 0), []),
    )
    result = scenes.sail(on_blocked="status")
    names = ["REACHED", "REACHED", "UNREACHABLE", "BLOCKED", "BLOCKED"]
    assert [Status(s).name for s in result.status[:5]] == names
    assert np.all(result.cost_to_go[1] == 0)
    assert np.all(result.expanded[1] == 0)
    assert np.all(np.isinf(result.cost_to_go[2:5]))
    assert np.array_equal(result.position[2:5, -1], scenes.starts[2:5])
    assert result.status.dtype == result.position.dtype == result.expanded.dtype == np.int32


def test_no_steps_and_no_changes() -> None:
    none = dstar_lite(FREE, [0, 5], [12, 5], np.zeros((1, 0, 0, 2), int))
    assert none.position.tolist() == [[[0, 5]]]
    assert none.cost_to_go.tolist() == [[12.0]]
    assert none.status.tolist() == [Status.FOUND]
    some = dstar_lite(FREE, [0, 5], [12, 5], np.zeros((1, 5, 0, 2), int))
    assert some.position[0, :, 0].tolist() == list(range(6))
    assert some.status.tolist() == [Status.FOUND]


def test_shared_arguments() -> None:
    rng = np.random.default_rng(5)
    flips = rng.integers([1, 0], [12, 11], (STEPS, CHANGES, 2))
    each = Scenes(
        np.repeat(FREE[None], EPISODES, axis=0),
        np.stack([np.zeros(EPISODES, int), np.arange(EPISODES) % HEIGHT], axis=1),
        np.tile([12, 5], (EPISODES, 1)),
        np.repeat(flips[None], EPISODES, axis=0),
    )
    want = each.sail()
    got = dstar_lite(FREE, each.starts, [12, 5], flips)
    assert np.array_equal(got.position, want.position)
    assert np.array_equal(got.cost_to_go, want.cost_to_go)
    rows = dstar_lite(FREE, each.starts[0], [12, 5], each.flips)
    assert np.array_equal(rows.position, np.repeat(want.position[:1], EPISODES, axis=0))


def test_a_budget_too_small_is_reported() -> None:
    scenes = scenes_of(
        (FREE, (0, 5), (12, 5), []),
        (FREE, (0, 0), (1, 0), []),
        (wall(6, 0), (5, 0), (7, 0), [[], [(6, 0), (6, 10)]]),
    )
    result = scenes.sail(max_expansions=8)
    assert result.status[:2].tolist() == [Status.OUT_OF_BUDGET, Status.REACHED]
    assert np.all(np.isnan(result.cost_to_go[0]))
    assert np.all(result.position[0] == result.position[0, 0])
    assert result.expanded[0].tolist() == [9] + [0] * STEPS
    assert np.all(np.isfinite(result.cost_to_go[1]))


def test_a_path_too_long_for_its_integers_is_reported() -> None:
    """A maze with one way through of some 14,600 cells; the limit is 13,291."""
    maze = np.zeros((171, 171), bool)
    maze[1::4, :-1] = maze[3::4, 1:] = True
    quiet = np.zeros((1, 1, 0, 2), int)
    result = dstar_lite(maze, [[0, 0], [0, 50]], [0, 170], quiet)
    assert result.status.tolist() == [Status.OUT_OF_BUDGET, Status.FOUND]
    assert np.all(np.isnan(result.cost_to_go[0]))
    assert 9000 < result.cost_to_go[1, 0] < 11000


def test_a_window_over_all_sees_all(scenes: Scenes) -> None:
    want, got = scenes.sail(), scenes.sail(sensing=(2 * HEIGHT + 1, 2 * WIDTH + 1))
    assert np.array_equal(got.position, want.position)
    assert np.array_equal(got.cost_to_go, want.cost_to_go)


def test_a_change_out_of_sight_is_noticed_on_the_way() -> None:
    door: list[plain.Cell] = [(6, 5)]
    scenes = scenes_of((wall(6, 5), (0, 5), (12, 5), [door]))
    result = scenes.sail(sensing=(5, 5))
    assert_sound(scenes, result, rows=1, sensing=(5, 5))
    assert result.cost_to_go[0, :4].tolist() == [12, 11, 10, 9]
    assert np.all(np.isinf(result.cost_to_go[0, 4:]))  # at (4, 5) the door comes into view
    assert result.position[0, -1].tolist() == [4, 5]


# --- lanes and devices --------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "lanes"), [("octile", 3), ("weighted", 7)])
def test_lanes_do_not_matter(scenes: Scenes, name: str, lanes: int) -> None:
    want, got = scenes.sail(**METHODS[name]), scenes.sail(**METHODS[name], max_lanes=lanes)
    for field in ("status", "position", "cost_to_go", "expanded"):
        assert np.array_equal(getattr(got, field), getattr(want, field)), field
    assert 0 < got.occupancy <= 1


def test_many_episodes_and_the_last_ones_in_fewer_lanes(scenes: Scenes) -> None:
    want = scenes.sail()
    rows = np.arange(520) % EPISODES
    got = dstar_lite(
        *(a[rows] for a in (scenes.blocked, scenes.starts, scenes.goals, scenes.flips))
    )
    assert np.array_equal(got.position, want.position[rows])
    assert np.array_equal(got.cost_to_go, want.cost_to_go[rows])
    assert np.array_equal(got.expanded, want.expanded[rows])


def test_all_devices(scenes: Scenes) -> None:
    want = scenes.sail()
    with jax.default_device(None):
        got = scenes.sail()
    assert np.array_equal(got.position, want.position)
    assert np.array_equal(got.expanded, want.expanded)
