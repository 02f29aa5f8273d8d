"""A*: costs against scipy, expansions against heapq, statuses, lanes."""

import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from astar_reference import Reference, Scenes, may_step, random_scenes, shortest
from property_draws import FUZZ

import usvjax as uj
from usvjax.search.astar import AstarResult, astar
from usvkernels.status import Status

MOVINGAI = Path(__file__).parents[3] / "shared" / "data" / "movingai"


def search(scenes: Scenes, **options: Any) -> AstarResult:
    return astar(scenes.blocked, scenes.starts, scenes.goals, **{"engine": "queue", **options})


def assert_valid(scenes: Scenes, found: AstarResult, corner_cutting: bool = False) -> None:
    """Every path goes step by step over free cells, and its cost is its length."""
    for row in range(len(scenes)):
        count = int(found.path_cells[row])
        path = [tuple(cell) for cell in found.path[row, :count].tolist()]
        rest = found.path[row, count:]
        assert (rest == (scenes.goals[row] if count else -1)).all()
        if found.status[row] != Status.FOUND:
            assert count == 0
            assert np.isinf(found.cost[row])
            continue
        assert path[0] == tuple(scenes.starts[row])
        assert path[-1] == tuple(scenes.goals[row])
        length = 0.0
        for a, b in itertools.pairwise(path):
            move = (b[0] - a[0], b[1] - a[1])
            assert may_step(scenes.blocked[row], a, move, corner_cutting)
            length += math.hypot(*move)
        assert found.cost[row] == pytest.approx(length, abs=1e-9)


@pytest.mark.parametrize("corner_cutting", [False, True])
def test_costs_equal_dijkstra(corner_cutting: bool) -> None:
    scenes = random_scenes(1, 600, (60, 60), least=5)
    found = search(scenes, corner_cutting=corner_cutting, max_lanes=64)
    wanted = [
        shortest(b, s, g, corner_cutting)
        for b, s, g in zip(scenes.blocked, scenes.starts, scenes.goals, strict=True)
    ]
    np.testing.assert_allclose(found.cost, wanted, rtol=1e-12)
    assert (found.status == np.where(np.isfinite(wanted), Status.FOUND, Status.UNREACHABLE)).all()
    assert 50 < np.isinf(wanted).sum() < 300
    assert_valid(scenes, found, corner_cutting)


CHOICES: list[dict[str, Any]] = [
    {},
    {"heuristic": "euclidean"},
    {"heuristic": "chebyshev"},
    {"heuristic": "manhattan"},
    {"weight": 2.5},
    {"connectivity": 4, "heuristic": "manhattan"},
]


@pytest.mark.parametrize("options", CHOICES, ids=lambda o: "-".join(map(str, o.values())))
def test_expands_what_a_heap_does(options: dict[str, Any]) -> None:
    scenes = random_scenes(2, 60, (19, 33), density=(0.0, 0.45))
    found = search(scenes, **options)
    overestimates = options in ({"heuristic": "manhattan"}, {"weight": 2.5})
    for row in range(len(scenes)):
        wanted = Reference(
            scenes.blocked[row],
            tuple(scenes.starts[row].tolist()),
            tuple(scenes.goals[row].tolist()),
            reopen=overestimates,
            **options,
        ).run()
        assert found.expanded[row] == len(wanted.expansions)
        path = found.path[row, : found.path_cells[row]].tolist()
        assert [tuple(cell) for cell in path] == (wanted.path or [])
        optimum = shortest(
            scenes.blocked[row],
            scenes.starts[row],
            scenes.goals[row],
            connectivity=options.get("connectivity", 8),
        )
        if overestimates:
            assert optimum - 1e-9 <= found.cost[row]
            assert np.isinf(optimum) or found.cost[row] <= options.get("weight", 2) * optimum + 1e-9
        else:
            assert found.cost[row] == pytest.approx(optimum, rel=1e-12)
    assert_valid(scenes, found)


def test_overestimates_are_not_all_optimal() -> None:
    """Else the test above would say nothing of them."""
    scenes = random_scenes(2, 60, (19, 33), density=(0.0, 0.45))
    best = search(scenes).cost
    for options in ({"heuristic": "manhattan"}, {"weight": 2.5}):
        cost = search(scenes, **options).cost
        assert (cost[np.isfinite(best)] > best[np.isfinite(best)] + 0.1).any()


def assert_same(a: AstarResult, b: AstarResult, rows: Any = slice(None)) -> None:
    for name in ("status", "cost", "path_cells", "turning", "expanded"):
        np.testing.assert_array_equal(getattr(a, name)[rows], getattr(b, name))
    width = min(a.path.shape[1], b.path.shape[1])
    np.testing.assert_array_equal(a.path[rows][:, :width], b.path[:, :width])


def test_results_do_not_depend_on_lanes_order_or_company() -> None:
    """With 800 queries the last ones are moved into fewer lanes."""
    scenes = random_scenes(3, 1600, (20, 20), density=(0.0, 0.5))
    found = search(scenes)
    assert_same(found, search(scenes, max_lanes=5))
    order = np.random.default_rng(0).permutation(len(scenes))
    shuffled = Scenes(scenes.blocked[order], scenes.starts[order], scenes.goals[order])
    assert_same(found, search(shuffled), order)
    few = Scenes(scenes.blocked[40:60], scenes.starts[40:60], scenes.goals[40:60])
    assert_same(found, search(few), slice(40, 60))


def test_a_shared_map_is_the_same_as_copies_of_it() -> None:
    """Its lanes are reset in part only."""
    rng = np.random.default_rng(4)
    blocked = rng.random((120, 130)) < 0.35
    free = np.argwhere(~blocked)[:, ::-1]
    ends = free[rng.integers(0, len(free), (2, 150))]
    near = np.abs(free[None] - ends[0, 1::2, None]).sum(2).argsort(1)[:, 5]
    ends[1, 1::2] = free[near]  # every other query is short
    one = astar(blocked, *ends, engine="queue", max_lanes=16)
    copies = np.repeat(blocked[None], 150, axis=0)
    assert_same(one, astar(copies, *ends, engine="queue", max_lanes=16))
    wanted = [shortest(blocked, s, g) for s, g in ends.transpose(1, 0, 2)[:40]]
    np.testing.assert_allclose(one.cost[:40], wanted, rtol=1e-12)
    assert_same(one, astar(uj.GridMap(blocked), *ends, engine="queue", max_lanes=16))


def test_engines_agree() -> None:
    scenes = random_scenes(5, 200, (20, 20), density=(0.0, 0.5))
    queue, sweep = search(scenes), search(scenes, engine="sweep")
    assert (queue.engine, sweep.engine) == ("queue", "sweep")
    assert search(scenes, engine="auto").engine == "sweep"
    np.testing.assert_array_equal(queue.status, sweep.status)
    np.testing.assert_allclose(queue.cost, sweep.cost, atol=1e-9)
    np.testing.assert_array_equal(queue.path_cells > 0, sweep.path_cells > 0)
    assert_valid(scenes, sweep)


def test_endings() -> None:
    blocked = np.zeros((6, 7), bool)
    blocked[:, 3] = True
    blocked[2, 3] = False
    starts = np.array([[0, 2], [0, 2], [3, 0], [1, 1], [0, 0]])
    goals = np.array([[6, 2], [0, 2], [0, 0], [3, 5], [6, 5]])
    found = astar(blocked, starts, goals, on_blocked="status", engine="queue")
    wanted = [Status.FOUND, Status.FOUND, Status.BLOCKED, Status.BLOCKED, Status.FOUND]
    assert found.status.tolist() == wanted
    assert found.cost[[0, 1]].tolist() == [6, 0]
    assert found.path_cells.tolist()[:4] == [7, 1, 0, 0]
    assert found.expanded.tolist()[1:4] == [1, 0, 0]
    assert found.path[0, :7].tolist() == [[x, 2] for x in range(7)]
    blocked[2, 3] = True
    cut_off = astar(blocked, starts[:1], goals[:1], engine="queue")
    assert cut_off.status.tolist() == [Status.UNREACHABLE]
    assert cut_off.expanded.tolist() == [18]
    assert cut_off.path[0].tolist() == [[-1, -1]]
    all_blocked = astar(blocked, starts[2:4], goals[2:4], on_blocked="status", engine="queue")
    assert all_blocked.status.tolist() == [Status.BLOCKED] * 2


def test_a_budget_of_expansions() -> None:
    scenes = random_scenes(6, 100, (20, 20), density=(0.0, 0.4))
    free = search(scenes)
    held = search(scenes, max_expansions=25)
    within = (free.expanded < 25) | ((free.expanded == 25) & (free.status == Status.FOUND))
    assert 20 < within.sum() < 80
    np.testing.assert_array_equal(held.status[within], free.status[within])
    np.testing.assert_array_equal(held.cost[within], free.cost[within])
    assert (held.status[~within] == Status.OUT_OF_BUDGET).all()
    assert (held.expanded[~within] == 25).all()


def test_a_path_too_long_for_the_keys_is_said_to_be() -> None:
    blocked = np.zeros((301, 200), bool)
    blocked[1::4, :-1] = True
    blocked[3::4, 1:] = True  # a serpentine of 30,000 cells
    ends = np.array([[0, 0], [0, 100]])
    found = astar(blocked, [0, 0], [[199, 300], [0, 100], [0, 0]], engine="queue")
    assert found.status.tolist() == [Status.OUT_OF_BUDGET, Status.FOUND, Status.FOUND]
    assert found.cost[1] == pytest.approx(shortest(blocked, *ends), rel=1e-12)


@pytest.mark.parametrize(
    "name",
    [
        "cities/Shanghai_0_256",
        "dao/arena",
        "dao/arena2",
        *(["mazes/maze512-32-0"] if FUZZ else []),
        "random/random512-10-0",
        "rooms/8room_000",
    ],
)
def test_published_optima(name: str) -> None:
    path = MOVINGAI / f"{name}.map"
    if not path.exists():
        pytest.skip(f"no MovingAI map at {path}")
    lines = Path(f"{path}.scen").read_text(encoding="utf-8").splitlines()[1:]
    rows = np.array([line.split()[4:9] for line in lines if line.strip()], float)
    rows = rows[np.linspace(0, len(rows) - 1, 200 if FUZZ else 60).astype(int)]
    cells = rows[:, :4].astype(int)
    found = astar(uj.load_map(path), cells[:, :2], cells[:, 2:], engine="queue")
    assert (found.status == Status.FOUND).all()
    # Published with six figures.
    np.testing.assert_allclose(found.cost, rows[:, 4], rtol=6e-6)
