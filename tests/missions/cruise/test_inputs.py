"""Every mistake in the arguments of `cruise` is named before anything is computed."""

import inspect
import re
from dataclasses import fields
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from cruise_scenes import arguments

from usvjax import memory, planners
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap
from usvjax.missions.cruise import CruiseParams, CruiseStatic, cruise, rounds, run

BLOCKED = np.zeros((3, 6, 7), bool)
BLOCKED[1, 5, 0] = True
STATIONS = np.array([[[0, 0], [6, 5], [3, 2]]] * 3)
ORDER = np.array([[0, 2, 1]] * 3)


class ComputeError(Exception):
    """Raised in these tests where compute would begin."""


@pytest.fixture(autouse=True)
def _no_compute(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(checked: object, *_: object, **__: object) -> None:
        raise ComputeError(checked)

    monkeypatch.setattr(run, "sail_in_lanes", refuse)
    monkeypatch.setattr(run, "sail_in_rounds", refuse)


def sail(**changes: Any) -> None:
    """Check these cruises, in which nothing is wrong but the changes."""
    given = {"blocked": BLOCKED, "stations": STATIONS, "key": 1, "order": ORDER, **changes}
    cruise(**arguments(**given))


def put(array: np.ndarray, index: tuple[int, ...], value: Any) -> np.ndarray:
    array = array.copy()
    array[index] = value
    return array


@pytest.mark.parametrize(
    "fine",
    [
        {},
        {"blocked": BLOCKED[0]},
        {"blocked": BLOCKED[0], "stations": STATIONS[0], "order": [0, 1, 2]},
        {"blocked": BLOCKED[0], "stations": STATIONS[0], "order": [0, 1, 2], "runs": 3},
        {"blocked": GridMap(BLOCKED[0]), "stations": STATIONS[0], "order": [0, 1, 2]},
        {"stations": STATIONS.astype(np.int8)},
        {"stations": STATIONS[:, :2], "order": [0, 1]},
        {"key": jax.random.key(3)},
        {"key": jax.random.PRNGKey(3)},
        {"flip_rate": 0},
        {"flip_rate": 1.0},
        {"flip_rate": [0.0, 0.5, 1.0]},
        {"flip_rate": np.float32(0.5), "speed": np.full(3, 2.0)},
        {"flip_rate": jnp.asarray(0.5), "speed": jnp.full(3, 2.0)},
        {"sensing": [3, 7]},
        {"method": "astar", "corner_cutting": True},
        {"method": "astar", "max_steps": 20000},
        {"method": "astar", "blocked": np.zeros((2100, 2100), bool)},
        {"method": "ga", "planner_options": {"iterations": 3, "population": 8, "params": None}},
        {"stations": STATIONS.astype(np.uint64)},
        {"first": 2**31 - 3},
        {"heuristic": "weighted_octile", "weight": 2},
        {"walled_in": "skip", "max_wait": 0},
    ],
)
def test_good_input_passes(fine: dict[str, Any]) -> None:
    with pytest.raises(ComputeError):
        sail(**fine)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"stations": STATIONS[:, :1]}, r"stations: got 1 of them; wanted two or more"),
        ({"stations": STATIONS[0, 0]}, r"stations: got shape \(2,\); wanted int \[B, d, 2\]"),
        ({"stations": np.zeros((0, 3, 2), int)}, r"stations: got shape \(0, 3, 2\)"),
        ({"stations": [[0, 0], [1]]}, r"stations: rows of unequal length"),
        ({"stations": put(STATIONS, (1, 2), (6, 5))}, r"\(6, 5\), station 2 in row 1, is there"),
        ({"stations": put(STATIONS, (1, 2), (0, 5))}, r"\(0, 5\), station 2 in row 1, is a block"),
        ({"stations": put(STATIONS, (2, 1), (7, 5))}, r"\(7, 5\), station 1 in row 2, lies outs"),
        ({"stations": put(STATIONS, (2, 1), (0, -1))}, r"\(0, -1\), station 1 in row 2, lies out"),
        ({"stations": put(STATIONS, (2, 1, 0), 2**32 + 3)}, r"\(4294967299, 5\), station 1 in row"),
        ({"stations": put(STATIONS[0], (1, 1), 2**32)}, r"\(6, 4294967296\), station 1 in row 0,"),
        ({"stations": put(STATIONS[0], (2,), (0, 5))}, r"\(0, 5\), station 2 in row 1, is a block"),
        ({"stations": STATIONS[:2]}, r"stations: got 2 rows; wanted 3, or one for all"),
        ({"runs": 4}, r"blocked: got 3 rows; wanted 4, as runs says"),
        ({"runs": 0}, r"runs: got 0; wanted 1 or more"),
        ({"blocked": BLOCKED[0, 0]}, r"blocked: got shape \(7,\)"),
        ({"order": [0, 1]}, r"order: got shape \(2,\) for d = 3"),
        ({"order": [0, 1, 1]}, r"order: got \[0, 1, 1\] in row 0; wanted int .* each of 0"),
        ({"order": [1, 0, 2]}, r"order: got \[1, 0, 2\] in row 0; .* beginning with 0"),
        ({"order": put(ORDER, (2, 1), 3)}, r"order: got \[0, 3, 1\] in row 2"),
        ({"order": ORDER[:2]}, r"order: got 2 rows; wanted 3, or one for all"),
        ({"order": [[0, 1, 2], [0]]}, r"order: rows of unequal length"),
        ({"method": "dstar-lite"}, r"method: got 'dstar-lite'; did you mean 'dstar_lite'\?"),
        ({"method": "astra"}, r"method: got 'astra'; did you mean 'astar'\?"),
        ({"heuristic": "octil"}, r"heuristic: got 'octil'; did you mean 'octile'\?"),
        ({"weight": 2.0}, r"weight: got 2.0 with heuristic='weighted'"),
        ({"distances": "waters"}, r"static\.distances: got 'waters'; did you mean 'water'\?"),
        ({"tour": "igw"}, r"tour: got 'igw'; did you mean 'igwo'\?"),
        ({"flip_scope": "maps"}, r"static\.flip_scope: got 'maps'; did you mean 'map'\?"),
        ({"walled_in": "waits"}, r"static\.walled_in: got 'waits'; did you mean 'wait'\?"),
        ({"flip_rate": -0.1}, r"params\.flip_rate: got -0.1; wanted a number in \[0, 1\]"),
        ({"flip_rate": 1.5}, r"params\.flip_rate: got 1.5; wanted a number in \[0, 1\]"),
        ({"flip_rate": float("nan")}, r"params\.flip_rate: got nan; wanted a finite number"),
        ({"flip_rate": [0.1, 0.2, 3.0]}, r"params\.flip_rate\[2\]: got 3.0"),
        ({"flip_rate": [0.1, 0.2]}, r"params\.flip_rate: got 2 numbers; wanted one, or 3"),
        ({"sensing": (4, 5)}, r"static\.sensing: got \(4, 5\); wanted \(h, w\), two odd"),
        ({"sensing": (1, 5)}, r"static\.sensing: got \(1, 5\); wanted \(h, w\), two odd"),
        ({"max_wait": -1}, r"params\.max_wait: got -1; wanted 0 or more"),
        ({"first": -1}, r"first: got -1; wanted 0 or more"),
        ({"max_steps": 0}, r"static\.max_steps: got 0; wanted 1 or more"),
        (
            {"max_steps": 10**6},
            r"static\.max_steps: got 1000000 on maps of 7 x 6 cells; wanted at most",
        ),
        (
            {"max_steps": 2**29, "method": "astar"},
            r"static\.max_steps: got 536870912 for cruises of 3 stations; wanted at most 178956970",
        ),
        (
            {"blocked": np.zeros((1400, 1400), bool)},
            r"blocked: got maps of 1400 x 1400 cells, on which a leg can have at most 2634 steps "
            r"with heuristic='weighted'; wanted smaller maps, or static\.max_steps up to 2634$",
        ),
        (
            {"blocked": np.zeros((1979, 1979), bool), "max_steps": 9},
            r"blocked: .* at most 0 steps with heuristic='weighted'; wanted smaller maps$",
        ),
        ({"blocked": np.zeros((1990, 1990), bool)}, r"blocked: .* wanted a diagonal of at most"),
        ({"heuristic": "octil", "method": "astar"}, r"heuristic: got 'octil'; did you mean"),
        ({"first": 2**31 - 2}, r"first \+ runs: got 2147483646 \+ 3; wanted at most 2\*\*31"),
        ({"method": "ga", "planner_options": {"iteration": 3}}, r"'iteration'; did you mean 'it"),
        ({"method": "ga", "planner_options": {"algorithm": "ga"}}, r"got 'algorithm'; valid: it"),
        ({"method": "ga", "planner_options": {"iterations": 0}}, r"iterations: got 0; wanted 1"),
        (
            {"flip_rate": np.zeros((3, 1))},
            r"params\.flip_rate: got shape \(3, 1\); wanted one, or 3",
        ),
        ({"speed": [1.0, 2.0, 0.0]}, r"params\.speed\[2\]: got 0.0; wanted a number above 0"),
        ({"max_expansions": 0}, r"static\.max_expansions: got 0; wanted 1 or more"),
        ({"speed": 0.0}, r"params\.speed: got 0.0; wanted a number above 0"),
        ({"cell_size": -1}, r"cell_size: got -1; wanted a number above 0"),
        ({"blocked": GridMap(BLOCKED[0]), "cell_size": 2}, r"cell_size: got 2 with a GridMap"),
        (
            {"method": "aco", "corner_cutting": True},
            r"static\.corner_cutting: got True; wanted False",
        ),
        ({"planner_options": {"ants": 3}}, r"planner_options: got .* with method='dstar_lite'"),
        ({"key": -1}, r"key: got -1; wanted a seed from 0"),
        ({"key": jax.random.split(jax.random.key(1), 2)}, r"key: got an array of shape \(2,\)"),
    ],
)
def test_bad_values(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(BadInputError, match=message) as caught:
        sail(**changes)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("given", "steps"),
    [
        ({}, 5694),
        ({"heuristic": "octile"}, 8577),
        ({"heuristic": "chebyshev"}, 8577),
        ({"method": "astar"}, 12672),
        ({"max_steps": 5694}, 5694),
    ],
)
def test_default_steps_of_a_leg_are_as_many_as_fit(given: dict[str, Any], steps: int) -> None:
    with pytest.raises(ComputeError) as caught:
        sail(blocked=np.zeros((730, 854), bool), **given)
    assert caught.value.args[0].max_steps == steps
    with pytest.raises(ComputeError) as caught:
        sail(**given)
    assert caught.value.args[0].max_steps == given.get("max_steps", 8 * (6 + 7))


@pytest.mark.parametrize("method", ["dstar_lite", "astar"])
def test_more_cruises_than_memory_holds(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda: 2**30)
    given = {"blocked": BLOCKED[0], "stations": STATIONS[0], "order": [0, 1, 2], "method": method}
    with pytest.raises(BadInputError, match=r"runs: 2000000000 cruises of 3 stations needs .* GiB"):
        sail(runs=2 * 10**9, **given)


def test_numbers_are_those_of_each_cruise() -> None:
    with pytest.raises(ComputeError) as caught:
        sail(flip_rate=jnp.asarray([0.0, 0.5, 1.0]), speed=4)
    checked = caught.value.args[0]
    assert checked.rate.tolist() == [0, 2**23, 2**24]
    assert checked.speed.tolist() == [4.0, 4.0, 4.0]
    part = checked.part(np.array([2, 1]))
    assert part.rate.tolist() == [2**24, 2**23]
    assert part.speed.tolist() == [4.0, 4.0]


@pytest.mark.parametrize("cls", [CruiseParams, CruiseStatic])
def test_every_field_is_explained(cls: Any) -> None:
    text = inspect.getdoc(cls)
    assert text is not None
    entries = text.partition("Attributes:\n")[2]
    for field in fields(cls):
        assert re.search(rf"^    {field.name}: [^;:]+;", entries, re.MULTILINE), field.name


def test_params_are_a_pytree_and_static_is_hashable() -> None:
    twice = jax.tree.map(lambda leaf: 2 * leaf, CruiseParams(0.25, 3, 4.0))
    assert twice == CruiseParams(0.5, 6, 8.0)
    assert hash(CruiseStatic(sensing=(3, 5))) == hash(CruiseStatic(sensing=(3, 5)))


def test_planner_options_are_those_of_plan_paths() -> None:
    parameters = inspect.signature(planners.plan_paths).parameters.values()
    keywords = {one.name for one in parameters if one.kind is one.KEYWORD_ONLY}
    assert set(rounds.PLANNER_OPTIONS) == keywords - {"algorithm"}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"stations": STATIONS.astype(float)}, r"stations: got dtype float64; wanted int"),
        ({"order": ORDER * 1.0}, r"order: got dtype float64; wanted int"),
        ({"blocked": BLOCKED.astype(int)}, r"blocked: got dtype int64; wanted bool"),
        ({"flip_rate": "3 %"}, r"params\.flip_rate: got '3 %'; wanted a number"),
        ({"sensing": None}, r"static\.sensing: got None; wanted \(h, w\), two odd"),
        ({"sensing": 5}, r"static\.sensing: got 5; wanted \(h, w\), two odd"),
        ({"sensing": (5.0, 5)}, r"static\.sensing: got \(5.0, 5\); wanted \(h, w\), two odd"),
        ({"max_wait": 1.5}, r"params\.max_wait: got 1.5; wanted a whole number"),
        ({"corner_cutting": 1}, r"static\.corner_cutting: got 1; wanted True or False"),
        ({"speed": None}, r"params\.speed: got None; wanted a number"),
        ({"runs": 2.0}, r"runs: got 2.0; wanted a whole number"),
        ({"key": 1.5}, r"key: got 1.5; wanted an integer seed or a JAX key"),
        ({"params": {"speed": 3.0}}, r"^params: got dict; wanted CruiseParams$"),
        ({"static": CruiseParams()}, r"^static: got CruiseParams; wanted CruiseStatic$"),
        ({"speed": [1.0, 2.0, "3"]}, r"params\.speed\[2\]: got '3'; wanted a number"),
        ({"max_wait": np.arange(3)}, r"params\.max_wait: got array\(.*\); wanted a whole number"),
        (
            {"method": "aco", "planner_options": {"params": 3}},
            r"^planner_options: params: got int; .*AcoPar",
        ),
        ({"method": "ga", "planner_options": {1: 2}}, r"planner_options: got 1; wanted a string"),
        ({"planner_options": [1]}, r"planner_options: got \[1\]; wanted a dictionary"),
    ],
)
def test_bad_types(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(BadTypeError, match=message) as caught:
        sail(**changes)
    assert "\n" not in str(caught.value)
