"""The turning cost of Zhang et al. 2019 in its three readings."""

from typing import Any

import numpy as np
import pytest
from astar_reference import Reference, least_with_turning, random_scenes, turning

from usvjax.search.astar import AstarResult, astar
from usvkernels.status import Status

SCENES = random_scenes(11, 50, (13, 17), density=(0.0, 0.4))


def search(**options: Any) -> AstarResult:
    return astar(SCENES.blocked, SCENES.starts, SCENES.goals, **options)


def reference(row: int, **options: Any) -> Reference:
    start, goal = tuple(SCENES.starts[row].tolist()), tuple(SCENES.goals[row].tolist())
    return Reference(SCENES.blocked[row], start, goal, **options).run()


def assert_costs_are_those_of_the_paths(found: AstarResult, turn_cost: float) -> None:
    for row in range(len(SCENES)):
        if found.status[row] != Status.FOUND:
            assert np.isinf(found.cost[row])
            continue
        path = found.path[row, : found.path_cells[row]]
        length = np.hypot(*np.diff(path, axis=0).T).sum()
        turns = turning([tuple(cell) for cell in path.tolist()])
        assert found.turning[row] == pytest.approx(turns * np.pi / 4)
        assert found.cost[row] == pytest.approx(length + turn_cost * turns, abs=1e-9)


@pytest.mark.parametrize("turn_cost", [0.5, 2.0])
def test_exact_is_the_least_sum(turn_cost: float) -> None:
    found = search(turn_cost=turn_cost)
    wanted = [
        least_with_turning(b, s, g, turn_cost)
        for b, s, g in zip(SCENES.blocked, SCENES.starts, SCENES.goals, strict=True)
    ]
    np.testing.assert_allclose(found.cost, wanted, rtol=1e-12)
    assert np.isfinite(wanted).sum() > 30
    assert_costs_are_those_of_the_paths(found, turn_cost)


@pytest.mark.parametrize(
    ("mode", "heuristic"),
    [
        ("parent", "octile"),
        ("parent", "manhattan"),
        ("accumulated", "manhattan"),
        ("exact", "octile"),
        ("exact", "manhattan"),
    ],
)
def test_expands_what_a_heap_does(mode: str, heuristic: str) -> None:
    found = search(turn_cost=0.5, turn_mode=mode, heuristic=heuristic)
    for row in range(len(SCENES)):
        wanted = reference(
            row,
            heuristic=heuristic,
            reopen=heuristic == "manhattan" and mode != "parent",
            turn_mode=mode,
            turn_cost=1189,
        )
        assert found.expanded[row] == len(wanted.expansions)
        path = found.path[row, : found.path_cells[row]].tolist()
        assert [tuple(cell) for cell in path] == (wanted.path or [])
    assert_costs_are_those_of_the_paths(found, 0.5)


def test_the_readings_differ_and_exact_is_best() -> None:
    exact = search(turn_cost=0.5).cost
    plain = search(engine="queue")
    with_turns = plain.cost + 0.5 * plain.turning / (np.pi / 4)
    reached = np.isfinite(exact)
    for mode in ("parent", "accumulated"):
        cost = search(turn_cost=0.5, turn_mode=mode).cost
        assert (cost[reached] >= exact[reached] - 1e-6).all()
        assert (cost[reached] > exact[reached] + 0.1).any()
        assert cost[reached].mean() < with_turns[reached].mean()


def test_the_heading_at_the_start_is_free() -> None:
    found = astar(np.zeros((5, 5), bool), [4, 2], [[0, 2], [4, 2], [4, 4]], turn_cost=3.0)
    assert found.cost.tolist() == [4, 0, 2]
    assert found.turning.tolist() == [0, 0, 0]


def test_a_turn_costs_by_its_angle() -> None:
    blocked = np.ones((3, 5), bool)
    blocked[0], blocked[:, 4] = False, False  # along the row, then up: one turn of 90 degrees
    found = astar(blocked, [0, 0], [4, 2], turn_cost=0.5)
    assert found.turning[0] == pytest.approx(np.pi / 2)
    assert found.cost[0] == pytest.approx(6 + 2 * 0.5)


def test_the_cost_is_with_the_turning_cost_that_was_searched_with() -> None:
    found = search(turn_cost=0.3)
    assert_costs_are_those_of_the_paths(found, 713 / 2378)
    there = found.status == Status.FOUND
    queue = search(engine="queue").cost
    assert (found.cost[there] >= queue[there] - 1e-9).all()


def test_no_turn_cost_is_plain_search() -> None:
    for mode in ("exact", "parent"):
        found = search(turn_cost=0.0, turn_mode=mode, engine="queue")
        np.testing.assert_array_equal(found.path, search(engine="queue").path)
