"""Figs. 3 to 5 of Yu et al. 2022: the maps, what is counted on them, and the verdicts."""

from math import sqrt

import jax
import numpy as np
import pytest

import usvjax as uj
from experiments import textbook
from experiments.claims import judge
from experiments.textbook import Rules
from experiments.yu2022 import heuristic
from experiments.yu2022.heuristic import compare
from experiments.yu2022.heuristic.claims import claims
from experiments.yu2022.heuristic.expansion import expand
from experiments.yu2022.heuristic.mission import MISSION, TRADITIONAL, UNIT, Scenes
from experiments.yu2022.options import YuOptions
from usvjax.mission import Files
from usvkernels.search.steps import STRAIGHT
from usvkernels.status import Status

NEW = ("octile", "weighted", "weighted_octile")


def posed(jobs, **maps) -> Scenes:
    return MISSION.pose(MISSION.case({"maps": maps}, Files()), 5, np.asarray(jobs))


def ends_of(scene, row):
    return [tuple(map(int, cells[row])) for cells in (scene.starts, scene.goals)]


@pytest.fixture(scope="module", autouse=True)
def on_one_device():
    with jax.default_device(jax.local_devices()[0]):
        yield


@pytest.fixture(scope="module")
def small():
    return posed(range(8), side=20, density=0.2, moves=40)


def test_a_scene_is_a_function_of_its_job_and_ends_are_free_apart_and_connected():
    scene = posed(range(12), density=0.3, flips=3)
    again = posed([7, 3], density=0.3, flips=3)
    for name in ("blocked", "starts", "goals", "flips"):
        np.testing.assert_array_equal(getattr(again, name), getattr(scene, name)[[7, 3]])
    assert len(np.unique(scene.blocked, axis=0)) == 12
    assert np.abs(scene.starts - scene.goals).max(axis=1).min() >= 25
    assert (scene.flips[:, :, :3] >= 0).all()
    assert (scene.flips[:, :, 3:] == -1).all()
    for row, blocked in enumerate(scene.blocked):
        path, _ = textbook.search(blocked, *ends_of(scene, row), Rules(heuristic="octile"))
        assert path


def test_smaller_maps_have_a_rim_and_denser_ones_more_blocked_cells(small):
    assert small.blocked.shape == (8, 50, 50)
    assert small.blocked[:, 20:].all()
    assert small.blocked[:, :, 20:].all()
    thin = posed(range(8), side=20, density=0.1)
    assert (small.blocked | ~thin.blocked).all()
    assert small.blocked.sum() > thin.blocked.sum()


def test_the_plain_search_expands_and_goes_as_the_planner_does(small):
    for name in (TRADITIONAL, "weighted"):
        found = uj.dstar_lite(small.blocked, small.starts, small.goals, small.flips, heuristic=name)
        for row, blocked in enumerate(small.blocked):
            plain = expand(blocked, *ends_of(small, row), name)
            assert len(plain.cells) == found.expanded[row, 0]
            if name == TRADITIONAL:
                sailed = [tuple(map(int, cell)) for cell in found.position[row]]
                assert sailed[: len(plain.path)] == plain.path


def test_with_diagonal_steps_of_one_the_path_has_the_fewest_moves(small):
    found = MISSION.run(small, UNIT).columns
    for row, blocked in enumerate(small.blocked):
        rules = Rules(1, 1, heuristic="octile")
        path, _ = textbook.search(blocked, *ends_of(small, row), rules)
        assert found["moves"][row] == len(path) - 1
        plain = expand(blocked, *ends_of(small, row), TRADITIONAL, STRAIGHT)
        assert found["first"][row] == len(plain.cells)
    exact = MISSION.run(small, TRADITIONAL).columns
    assert (found["length"] >= exact["length"] - 1e-9).all()
    assert (found["moves"] <= exact["moves"]).all()
    assert (exact["path"] != found["path"]).any()
    assert (exact["status"] == Status.REACHED).all()
    cut = posed(range(2), side=20, moves=3)
    assert (MISSION.run(cut, UNIT).columns["status"] == Status.FOUND).all()


def test_from_no_other_nodes_are_those_of_fig_3_tied(monkeypatch):
    whole = (("D2", "D3", "D4"), ("C1", "C2", "C3", "C4", "C5"))
    nodes = [f"{row}{column}" for row in "AB" for column in range(1, 6)]
    fitting = set(nodes)
    for rows in (whole, compare.TIED):  # from B4 and the like others of row C are tied
        monkeypatch.setattr(compare, "TIED", rows)
        fitting &= {node for node in nodes if compare.layers(TRADITIONAL, node) == [3, 3]}
    assert fitting == set(compare.VESSELS)


@pytest.mark.parametrize("vessel", compare.VESSELS)
def test_nodes_tied_for_the_least_key_in_figs_3_and_4(vessel):
    found = {name: compare.layers(name, vessel) for name in (TRADITIONAL, *NEW)}
    assert found[TRADITIONAL] == [3, 3]
    assert found["weighted"] == found["weighted_octile"] == [1, 1]
    assert found["octile"][0] == 2


def sailed(first, length, reached=None, extra=0, moves=None):
    arrived = np.ones(len(first), bool) if reached is None else np.array(reached)
    return {
        "status": np.where(arrived, int(Status.REACHED), int(Status.OUT_OF_BUDGET)),
        "first": np.array(first),
        "expanded": np.array(first) + extra,
        "length": np.array(length, float),
        "moves": np.round(length).astype(int) if moves is None else np.array(moves),
        "path": np.round(length).astype(int),
    }


def test_expansions_and_lengths_are_relative_to_the_traditional_heuristics():
    rows = {
        TRADITIONAL: sailed([100, 400, 100], [10.0, 20.0, 30.0]),
        "octile": sailed([50, 200, 50], [10.0, 20.0, 30.0]),
        "weighted": sailed([10, 40, 10], [11.0, 20.0, 30.0], [True, True, False]),
        "weighted_octile": sailed([25, 25, 25], [10.0, 22.0, 30.0], extra=5),
        UNIT: sailed([50, 400, 100], [12.0, 24.0, 30.0], moves=[11, 19, 30]),
    }
    found = compare.first_plans(rows)
    assert found["n"] == 2
    weighted = found["heuristics"]["weighted"]
    old, unit = (weighted["against"][name] for name in (TRADITIONAL, UNIT))
    assert old["times"]["value"] == pytest.approx(0.1)
    assert unit["times"]["value"] == pytest.approx(sqrt(10 / 50 * 40 / 400))
    assert weighted["length_ratio"]["value"] == pytest.approx(1.05)
    assert old["as_short"]["value"] == 0.5
    assert old["same_cells"]["value"] == 0.5
    assert unit["as_short"]["value"] == 0.5
    octile = found["heuristics"]["weighted_octile"]
    assert octile["longest_ratio"] == pytest.approx(1.1)
    changing = compare.whole_episodes(rows)["heuristics"]
    assert changing["weighted_octile"]["replanning"]["value"] == 5
    assert changing["weighted"]["out_of_budget"]["value"] == pytest.approx(1 / 3)


def table(times, short, unit_short=0.0, n=100):
    def against(share):
        same = {"value": share, "low": share - 0.01, "high": share + 0.01}
        figure = {"value": times, "low": times - 0.01, "high": times + 0.01}
        return {"times": figure, "as_short": same, "same_cells": same}

    row = {"against": {TRADITIONAL: against(short), UNIT: against(unit_short)}}
    return {"n": n, "heuristics": dict.fromkeys(NEW, row)}


def verdicts(plans, episodes, *others):
    numbers = {
        "plans": dict(enumerate((plans, *others))),
        "episodes": {"b": {"n": 100, "heuristics": dict.fromkeys(NEW, episodes)}},
        "layers": {"A1": {name: compare.layers(name, "A1") for name in (TRADITIONAL, *NEW)}},
    }
    return [one.verdict for one in judge(claims(numbers), numbers)]


def test_verdicts_follow_from_the_numbers():
    fewer = {"times": {"value": 0.2, "low": 0.1, "high": 0.3}}
    more = {"times": {"value": 0.9, "low": 0.8, "high": 1.01}}
    found = verdicts(table(0.2, 0.3), more)
    assert found == [
        "reproduces",
        "reproduces",
        "depends on the reading",
        "does not reproduce",
        "undecided",
    ]
    found = verdicts(table(1.02, 0.97, 0.97), fewer)
    assert found[1:] == ["does not reproduce", "not excluded", "reproduces", "reproduces"]
    assert verdicts(table(0.2, 0.039, 0.03), fewer)[2] == "does not reproduce"
    assert verdicts(table(0.2, 0.3, n=5), fewer)[1:4] == ["undecided"] * 3


@pytest.mark.parametrize(
    ("times", "short"),
    [
        (1.0, 0.945),  # the intervals hold the bounds
        (None, None),  # there are none
    ],
)
def test_what_is_not_shown_is_not_refuted(times, short):
    plans = table(times or 0.0, short or 0.0, short or 0.0)
    if times is None:
        for own in plans["heuristics"]["weighted"]["against"].values():
            for figure in (own["times"], own["as_short"]):
                figure.update(value=1.0, low=None, high=None)
    episodes = {"times": plans["heuristics"]["weighted"]["against"][TRADITIONAL]["times"]}
    fewer, _, rule, changing = verdicts(plans, episodes)[1:]
    assert (fewer, rule, changing) == ("undecided",) * 3


def test_kinds_of_maps_that_differ_decide_nothing():
    fewer = {"times": {"value": 0.2, "low": 0.1, "high": 0.3}}
    found = verdicts(table(0.2, 0.3), fewer, table(2.0, 0.99, 0.99))
    assert found[1:4] == ["undecided", "not excluded", "undecided"]


def test_what_is_run_follows_the_options():
    looked = heuristic.PART.runs(YuOptions(quick=True))
    assert looked["plans"].size == 4 * 5 * 100
    assert looked["episodes"].size == 2 * 4 * 100
    with pytest.raises(uj.BadInputError, match="--maps: got 0; wanted at least 1 map"):
        heuristic.PART.runs(YuOptions(maps=0))
