"""Plans of ants, genes and particles are paths, and what is said of them is true."""

from collections.abc import Iterator
from dataclasses import fields

import jax
import numpy as np
import pytest
from grid_oracle import check_path, lengths
from hypothesis import example, given
from hypothesis import strategies as st
from property_draws import examples

from usvjax.planners import ALGORITHMS, PlanResult, plan_paths
from usvkernels.status import Status

SIDE, COUNT = 12, 6
SMALL = {
    "aco": {"iterations": 6, "population": 32},
    "ga": {"iterations": 10, "population": 32},
    "cmpso": {"iterations": 40, "population": 32},
}
Scene = tuple[np.ndarray, np.ndarray, np.ndarray]


@pytest.fixture(autouse=True)
def _one_device() -> Iterator[None]:
    with jax.default_device(jax.local_devices()[0]):  # or each device would compile
        yield


def scene(seed: int, density: float) -> Scene:
    """Maps and ends, both free, of which some coincide."""
    rng = np.random.default_rng(seed)
    blocked = rng.random((COUNT, SIDE, SIDE)) < density
    starts, goals = rng.integers(0, SIDE, (2, COUNT, 2))
    goals[0] = starts[0]
    for cells in (starts, goals):
        blocked[np.arange(COUNT), cells[:, 1], cells[:, 0]] = False
    return blocked, starts, goals


def plan(algorithm: str, queries: Scene, key: object = 7) -> PlanResult:
    return plan_paths(*queries, key, algorithm=algorithm, **SMALL[algorithm])


def assert_same(one: PlanResult, other: PlanResult, rows: list[int]) -> None:
    """`one` holds what these rows of `other` hold, up to the padding of the paths."""
    for field in fields(PlanResult):
        mine, theirs = getattr(one, field.name), getattr(other, field.name)[rows]
        if field.name == "path":
            most = min(mine.shape[1], theirs.shape[1])
            mine, theirs = mine[:, :most], theirs[:, :most]
            assert one.path_cells.max() <= most
        np.testing.assert_array_equal(mine, theirs, field.name)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@examples(10)
@given(seed=st.integers(0, 2**31), density=st.sampled_from((0.0, 0.1, 0.2, 0.35, 0.6)))
@example(seed=123233613, density=0.35)  # finds its first path late
def test_plans_are_paths(algorithm: str, seed: int, density: float) -> None:
    blocked, starts, goals = scene(seed, density)
    result = plan(algorithm, (blocked, starts, goals), seed)
    for row in range(COUNT):
        shortest = lengths(blocked[row], goals[row][None])[starts[row][1], starts[row][0]]
        status, cost = result.status[row], result.cost[row]
        assert (status == Status.UNREACHABLE) == np.isinf(shortest)
        if status != Status.FOUND:
            assert status in (Status.UNREACHABLE, Status.OUT_OF_BUDGET)
            assert np.isinf(cost)
            assert np.isinf(result.history[row]).all()
            assert result.path_cells[row] == 0
            assert (result.path[row] == -1).all()
            continue
        count = result.path_cells[row]
        path = result.path[row, :count]
        assert (path[0] == starts[row]).all()
        assert (path[-1] == goals[row]).all()
        assert (result.path[row, count:] == goals[row]).all()
        assert check_path(blocked[row], path) == pytest.approx(cost, abs=1e-9)
        assert cost >= shortest - 1e-9
        assert result.history[row, -1] == pytest.approx(cost, rel=1e-6)
        if algorithm != "ga":
            history = result.history[row]  # inf until there is a path
            assert (history[1:] <= history[:-1]).all()
        if algorithm == "aco":
            assert len({tuple(cell) for cell in path.tolist()}) == count


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_plan_depends_on_its_own_query_and_key_alone(algorithm: str) -> None:
    blocked, starts, goals = scene(3, 0.15)
    keys = jax.random.split(jax.random.key(11), COUNT)
    whole = plan(algorithm, (blocked, starts, goals), keys)
    assert_same(plan(algorithm, (blocked, starts, goals), keys), whole, list(range(COUNT)))
    order = [4, 2, 5, 0, 1, 3]
    mixed = plan(algorithm, (blocked[order], starts[order], goals[order]), keys[np.array(order)])
    assert_same(mixed, whole, order)
    alone = plan(algorithm, (blocked[[2]], starts[[2]], goals[[2]]), keys[2:3])
    assert_same(alone, whole, [2])
    first = plan(algorithm, (blocked, starts, goals), 5)
    assert_same(plan(algorithm, (blocked[:4], starts[:4], goals[:4]), 5), first, [0, 1, 2, 3])
    assert not np.array_equal(first.history, whole.history)


@pytest.mark.parametrize(("algorithm", "most"), [("aco", 1.01), ("ga", 1.2), ("cmpso", 1.05)])
def test_near_the_optimum_on_an_empty_map(algorithm: str, most: float) -> None:
    rng = np.random.default_rng(5)
    starts, goals = rng.integers(0, SIDE, (2, 24, 2))
    blocked = np.zeros((SIDE, SIDE), bool)
    result = plan_paths(blocked, starts, goals, 1, algorithm=algorithm, **SMALL[algorithm])
    apart = np.abs(goals - starts)
    shortest = apart.max(axis=1) + (np.sqrt(2) - 1) * apart.min(axis=1)
    assert (result.status == Status.FOUND).all()
    assert (result.cost >= shortest - 1e-9).all()
    assert result.cost.sum() <= most * shortest.sum()


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_shared_map_and_rows_that_cannot_begin(algorithm: str) -> None:
    blocked = np.zeros((SIDE, SIDE), bool)
    blocked[:, 6] = True
    starts = np.array([[0, 0], [0, 0], [6, 3], [2, 2], [3, 9]])
    goals = np.array([[5, 11], [8, 3], [1, 1], [2, 2], [6, 0]])
    result = plan_paths(
        blocked, starts, goals, 0, algorithm=algorithm, on_blocked="status", **SMALL[algorithm]
    )
    expected = [Status.FOUND, Status.UNREACHABLE, Status.BLOCKED, Status.FOUND, Status.BLOCKED]
    assert result.status.tolist() == expected
    assert result.path_cells[3] == 1
    assert result.cost[3] == 0
    assert (result.history[3] == 0).all()


def test_a_trap_that_rows_cannot_leave_is_no_fake_path() -> None:
    blocked = np.zeros((SIDE, SIDE), bool)
    blocked[4:7, 3] = blocked[4:7, 9] = True  # a cup that opens away from the goal
    blocked[6, 3:10] = True
    result = plan_paths(blocked, [6, 5], [6, 10], 0, algorithm="ga", **SMALL["ga"])
    assert result.status[0] == Status.OUT_OF_BUDGET
    found = plan_paths(blocked, [6, 5], [6, 10], 0, algorithm="aco", **SMALL["aco"])
    assert found.status[0] == Status.FOUND
