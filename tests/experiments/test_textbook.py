"""The textbook search that papers share: shortest where it should be, and ties as asked."""

from dataclasses import replace

import numpy as np
import pytest
from corner_grids import grids, shortest

from experiments import textbook
from experiments.textbook import LOWER_FIRST, STRAIGHTS_FIRST, UPPER_FIRST, Rules
from experiments.zhang2019.paths import counted

EXACT = Rules(1000, 1400, heuristic="octile")


def cost_of(path):
    own = {name: int(count[0]) for name, count in counted(np.array([path])).items()}
    return 1000 * own["straight"] + 1400 * own["diagonal"], own["turns"]


@pytest.mark.parametrize("corner_cutting", [False, True])
@pytest.mark.parametrize("heuristic", ["octile", "euclidean"])
def test_a_consistent_heuristic_gives_the_shortest_path(heuristic, corner_cutting):
    rules = replace(EXACT, heuristic=heuristic, corner_cutting=corner_cutting)
    for blocked in grids(25, 9, 0.35):
        path, expanded = textbook.search(blocked, (0, 0), (8, 8), rules)
        least = shortest(blocked, corner_cutting)
        assert bool(path) == np.isfinite(least)
        assert len(expanded) == len(set(expanded))
        if path:
            assert cost_of(path)[0] == least
            assert path[0] == (0, 0)
            assert path[-1] == expanded[-1] == (8, 8)


def test_orders_are_permutations_and_named_for_what_comes_first():
    for order in (LOWER_FIRST, UPPER_FIRST, STRAIGHTS_FIRST):
        assert sorted(order) == list(range(8))
    rows = {name: [textbook.CLOCKWISE[i][1] for i in order] for name, order in
            (("lower", LOWER_FIRST), ("upper", UPPER_FIRST))}  # fmt: skip
    assert rows["upper"] == sorted(rows["upper"])
    assert rows["lower"] == sorted(rows["lower"], reverse=True)


def test_ties_go_to_the_cell_that_entered_first_or_last():
    # Along an open row both diagonal starts are equally good.
    blocked = np.zeros((3, 6), bool)
    blocked[1, 2] = True
    for order, row in ((LOWER_FIRST, 2), (UPPER_FIRST, 0)):
        rules = replace(EXACT, order=order, corner_cutting=True)
        path, _ = textbook.search(blocked, (0, 1), (5, 1), rules)
        assert {y for _, y in path} == {1, row}


def test_a_turning_cost_of_almost_nothing_decides_ties_only():
    better = 0
    for blocked in grids(40, 12, 0.15, seed=3):
        before, after = (
            textbook.search(blocked, (0, 0), (11, 11), replace(EXACT, turn=turn, accumulate=True))
            for turn in (0, 1)
        )
        if before[0]:
            assert cost_of(after[0])[0] <= cost_of(before[0])[0]
            better += cost_of(after[0])[1] < cost_of(before[0])[1]
    assert better > 10
