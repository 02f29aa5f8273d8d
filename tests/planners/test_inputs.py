"""Every mistake in the arguments of a planner is named before anything is computed."""

from typing import Any

import jax
import numpy as np
import pytest

from usvjax import swarms
from usvjax.errors import BadInputError as BadInput
from usvjax.errors import BadTypeError as BadType
from usvjax.planners import AcoParams, CmpsoParams, GaParams, plan_paths, plans
from usvkernels.planners.rows import MOST_SIDE

BLOCKED = np.zeros((3, 4, 6), bool)
BLOCKED[:, 1, 2] = True
STARTS = np.array([[0, 0], [1, 1], [5, 3]])
GOALS = np.array([[5, 3], [0, 3], [3, 1]])
NAN = float("nan")


class ComputeError(Exception):
    """Raised in these tests where compute would begin."""


@pytest.fixture(autouse=True)
def _no_compute(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise ComputeError

    for name, (defaults, _) in plans._PLANNERS.items():
        monkeypatch.setitem(plans._PLANNERS, name, (defaults, refuse))


def plan(**changes: Any) -> None:
    """Check these queries, in which nothing is wrong but the changes."""
    arguments = {"blocked": BLOCKED, "starts": STARTS, "goals": GOALS, "key": 0, **changes}
    plan_paths(**arguments)


def assert_refused(error: type[Exception], message: str, **changes: Any) -> None:
    with pytest.raises(error, match=f"^{message}"):
        plan(**changes)


@pytest.mark.parametrize(
    "good",
    [
        {},
        {"key": jax.random.key(1)},
        {"key": jax.random.PRNGKey(1)},
        {"key": jax.random.split(jax.random.key(1), 3)},
        {"algorithm": "ga", "params": GaParams(mutation=0.0)},
        {"algorithm": "ga", "params": GaParams(smoothness_weight=0.0)},
        {"algorithm": "cmpso", "population": 8, "iterations": 1},
        {"population": 1, "params": AcoParams(alpha=0.0, rho=1.0)},
        {"starts": [2, 1], "on_blocked": "status"},
    ],
)
def test_nothing_is_wrong_with_these(good: dict[str, Any]) -> None:
    with pytest.raises(ComputeError):
        plan(**good)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("acco", "algorithm: got 'acco'; did you mean 'aco'"),
        ("cmspo", "algorithm: got 'cmspo'; did you mean 'cmpso'"),
        ("GA", "algorithm: got 'GA'; did you mean 'ga'"),
        ("wolves", "algorithm: got 'wolves'; valid: aco, cmpso, ga"),
    ],
)
def test_unknown_algorithm(value: Any, message: str) -> None:
    assert_refused(BadInput, message, algorithm=value)


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"starts": [[2, 1]]}, BadInput, r"starts: \(2, 1\) in row 0 is a blocked cell"),
        ({"goals": [2, 1]}, BadInput, r"goals: \(2, 1\) in row 0 is a blocked cell"),
        ({"goals": [6, 0]}, BadInput, r"goals: \(6, 0\) in row 0 lies outside the map"),
        ({"starts": [0, -1]}, BadInput, r"starts: \(0, -1\) in row 0 lies outside the map"),
        ({"starts": [0.0, 1.0]}, BadType, "starts: got dtype float64"),
        ({"goals": GOALS[:2]}, BadInput, "goals: got 2 rows; wanted 3"),
        ({"blocked": BLOCKED.astype(int)}, BadType, "blocked: got dtype int"),
        ({"on_blocked": "skip"}, BadInput, "on_blocked: got 'skip'"),
    ],
)
def test_bad_scene(change: dict[str, Any], error: type[Exception], message: str) -> None:
    assert_refused(error, message, **change)


@pytest.mark.parametrize("name", ["iterations", "population"])
@pytest.mark.parametrize(
    ("value", "error", "said"),
    [
        (0, BadInput, "got 0; wanted 1 or more"),
        (-3, BadInput, "got -3; wanted 1 or more"),
        (10.0, BadType, "got 10.0; wanted a whole number"),
        (True, BadType, "got True; wanted a whole number"),
        (10**9, BadInput, "got 1000000000; wanted at most"),
    ],
)
def test_bad_sizes(name: str, value: Any, error: type[Exception], said: str) -> None:
    assert_refused(error, f"{name}: {said}", **{name: value})


def test_population_that_the_algorithm_cannot_divide() -> None:
    assert_refused(BadInput, "population: got 1; wanted 2 or more", algorithm="ga", population=1)
    message = "population: got 51; wanted a multiple of 2"
    assert_refused(BadInput, message, algorithm="ga", population=51)
    message = "population: got 62; wanted a multiple of 4"
    assert_refused(BadInput, message, algorithm="cmpso", population=62)
    message = "population: got 4096; wanted at most 2048"
    assert_refused(BadInput, message, algorithm="ga", population=4096)


@pytest.mark.parametrize(
    ("algorithm", "params", "error", "said"),
    [
        (
            "aco",
            GaParams(),
            BadType,
            r"params: got usvjax\.planners\.GaParams; wanted usvjax\.planners\.AcoParams",
        ),
        (
            "aco",
            swarms.AcoParams(),
            BadType,
            r"params: got usvjax\.swarms\.AcoParams; wanted usvjax\.planners\.AcoParams",
        ),
        ("ga", {"mutation": 0.1}, BadType, r"params: got dict; wanted usvjax\.planners\.GaParams"),
        ("aco", AcoParams(rho=1.5), BadInput, r"params\.rho: got 1\.5; wanted 0 to 1"),
        ("aco", AcoParams(beta=-1.0), BadInput, r"params\.beta: got -1; wanted 0 to 20"),
        ("aco", AcoParams(q=NAN), BadInput, r"params\.q: got nan; wanted a finite number"),
        ("aco", AcoParams(alpha="1"), BadType, r"params\.alpha: got '1'; wanted a number"),
        ("ga", GaParams(crossover=80), BadInput, r"params\.crossover: got 80; wanted 0 to 1"),
        ("ga", GaParams(length_weight=-1), BadInput, r"params\.length_weight: got -1; wanted 0"),
        ("cmpso", CmpsoParams(max_speed=0), BadInput, r"params\.max_speed: got 0; wanted 1e-06"),
        ("ga", GaParams(length_weight=1e38), BadInput, r"params\.length_weight: got 1e\+38; want"),
        (
            "ga",
            GaParams(length_weight=0, smoothness_weight=0),
            BadInput,
            r"params\.length_weight, params\.smoothness_weight: got 0 and 0; wanted 1e-06 or m",
        ),
        (
            "ga",
            GaParams(length_weight=1e-50, smoothness_weight=0),
            BadInput,
            ".*: got 1e-50 and 0;",
        ),
        ("cmpso", CmpsoParams(inertia=-0.4), BadInput, r"params\.inertia: got -0\.4; wanted 0"),
        ("cmpso", CmpsoParams(social=1e38), BadInput, r"params\.social: got 1e\+38; wanted 0 to"),
    ],
)
def test_bad_params(algorithm: str, params: Any, error: type[Exception], said: str) -> None:
    assert_refused(error, said, algorithm=algorithm, params=params)


@pytest.mark.parametrize(
    ("key", "error", "said"),
    [
        (-1, BadInput, "got -1; wanted a seed from 0"),
        (2**32, BadInput, "got 4294967296; wanted a seed"),
        (1.0, BadType, "got 1.0; wanted an integer seed or a JAX key"),
        (True, BadType, "got True; wanted an integer seed"),
        (None, BadType, "got None; wanted an integer seed"),
        (jax.random.split(jax.random.key(0), 2), BadInput, "got 2 keys; wanted one, or 3"),
        (jax.random.split(jax.random.key(0), (2, 2)), BadInput, r"got an array of shape \(2, 2\)"),
    ],
)
def test_bad_key(key: Any, error: type[Exception], said: str) -> None:
    assert_refused(error, f"key: {said}", key=key)


def test_a_map_that_is_too_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    long = np.zeros((1, MOST_SIDE + 1), bool)
    for algorithm in ("ga", "cmpso"):
        message = f"blocked: got {MOST_SIDE + 1} x 1 cells; wanted at most"
        with pytest.raises(BadInput, match=f"^{message}"):
            plan_paths(long, [0, 0], [9, 0], 0, algorithm=algorithm)
    monkeypatch.setattr("usvjax.memory.free_memory", lambda: 10**6)
    with pytest.raises(BadInput, match=r"^blocked: .* ants at once on 600 x 600 cells needs"):
        plan_paths(np.zeros((600, 600), bool), [0, 0], [9, 0], 0)
    with pytest.raises(BadInput, match=r"^blocked: 1 plans at once on 600 x 600 cells needs"):
        plan_paths(np.zeros((600, 600), bool), [0, 0], [599, 0], 0, algorithm="ga")
