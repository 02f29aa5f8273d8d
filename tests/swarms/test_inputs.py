"""Mistakes of a user of `minimise`: refused in one sentence, before anything is computed."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from usvjax import tours
from usvjax.errors import BadInputError, BadTypeError
from usvjax.missions.dwa.params import DwaParams
from usvjax.swarms import minimising as module
from usvjax.swarms.minimising import minimise
from usvkernels.swarms.aco import AcoParams, AcoStatic
from usvkernels.swarms.cmpso import CmpsoParams, CmpsoStatic
from usvkernels.swarms.functions import sphere
from usvkernels.swarms.ga import GaParams, GaStatic
from usvkernels.swarms.gwo import GwoStatic
from usvkernels.swarms.laws import GwoParams

NAN, INF = np.nan, np.inf
UNIT = np.zeros(3), np.ones(3)


class ComputeError(Exception):
    """Raised instead of computing."""


@pytest.fixture(autouse=True)
def _no_compute(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any) -> None:
        raise ComputeError

    monkeypatch.setattr(module, "_in_blocks", refuse)


def call(**changes: Any) -> None:
    options: dict[str, Any] = {"fn": sphere, "bounds": UNIT, "key": 0, "dim": 3, **changes}
    fn, bounds, key = (options.pop(name) for name in ("fn", "bounds", "key"))
    minimise(fn, bounds, key, **options)


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"algorithm": "gwoo"}, BadInputError, r"algorithm: got 'gwoo'; did you mean 'gwo'\?"),
        ({"algorithm": "IGWO"}, BadInputError, r"algorithm: got 'IGWO'; did you mean 'igwo'\?"),
        ({"algorithm": 3}, BadTypeError, "algorithm: got 3; wanted a string"),
        ({"dim": 0}, BadInputError, "dim: got 0; wanted 1 or more"),
        ({"dim": 2.0}, BadTypeError, "dim: got 2.0; wanted a whole number"),
        ({"runs": 0}, BadInputError, "runs: got 0; wanted 1 or more"),
        ({"iterations": 0}, BadInputError, "iterations: got 0; wanted 1 or more"),
        ({"iterations": True}, BadTypeError, "iterations: got True; wanted a whole number"),
        ({"population": 0}, BadInputError, "population: got 0; wanted 1 or more"),
        ({"population": 2}, BadInputError, "population: got 2; wanted 3 or more wolves"),
        (
            {"runs": 10**12},
            BadInputError,
            "runs: 1000000000000 of 200 iterations .* needs .* of mem",
        ),
        ({"population": 10**11}, BadInputError, "runs: 30 of .* with 100000000000 members"),
        (
            {"algorithm": "aco", "static": AcoStatic(archive=10**11)},
            BadInputError,
            "runs: 30 of 100 .* 200 members and an archive of 100000000000 in 3 dimensions needs",
        ),
        ({"key": -1}, BadInputError, "key: got -1; wanted a seed"),
        ({"key": "one"}, BadTypeError, "key: got 'one'; wanted an integer seed or a JAX key"),
        (
            {"algorithm": "cmpso", "population": 21},
            BadInputError,
            r"population: got 21; wanted a multiple of static\.swarms = 2",
        ),
        (
            {"algorithm": "cmpso", "population": 2},
            BadInputError,
            "population: got 2; .* with 2 particles or more in each",
        ),
    ],
)
def test_names_and_numbers(change: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{message}"):
        call(**change)


@pytest.mark.parametrize(
    ("bounds", "error", "message"),
    [
        ((1.0, -1.0), BadInputError, "low 1 is not below high -1 at coordinate 0"),
        ((1, 1), BadInputError, "low 1 is not below high 1 at coordinate 0"),
        (([0, 0, 5], 4), BadInputError, "low 5 is not below high 4 at coordinate 2"),
        ((NAN, 1.0), BadInputError, "low is nan; wanted finite numbers"),
        ((0, [1, INF, 1]), BadInputError, r"high is \[1, inf, 1\]; wanted finite numbers"),
        ((0, [1, 1]), BadInputError, r"high has shape \(2,\); wanted a number or shape \(3,\)"),
        ([(0, 1)] * 3, BadTypeError, r"got .*; wanted \(low, high\), each a number or float\[3\]"),
        (np.zeros((2, 3, 1)), BadInputError, r"low has shape \(3, 1\)"),
        (5.0, BadTypeError, r"got 5\.0; wanted \(low, high\)"),
        (None, BadTypeError, r"got None; wanted \(low, high\)"),
        (("a", "b"), BadTypeError, "low is 'a'; wanted a number"),
        ((0, [[1], [2, 3]]), BadInputError, "high: rows of unequal length"),
        ((-3e38, 3e38), BadInputError, "too far apart, or too near each other, for float32"),
        ((1.0, 1.0 + 1e-12), BadInputError, "too far apart, or too near each other"),
    ],
)
def test_bounds(bounds: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^bounds: {message}"):
        call(bounds=bounds)


def untraceable(x: jax.Array) -> float:
    return float(np.asarray(x).sum())


def branching(x: jax.Array) -> jax.Array:
    return x[0] if x[0] > 0 else x[1]


@pytest.mark.parametrize(
    ("fn", "error", "message"),
    [
        (None, BadTypeError, r"got None; wanted a function of float\[3\]"),
        (untraceable, BadTypeError, "JAX cannot trace it, TracerArrayConversionError: "),
        (branching, BadTypeError, "JAX cannot trace it, TracerBoolConversionError: "),
        (lambda x, y: x, BadTypeError, "JAX cannot trace it, TypeError: "),
        (lambda x: x @ jnp.ones(4), BadTypeError, "JAX cannot trace it, TypeError: .* jax.numpy"),
        (lambda x: x, BadInputError, r"returns shape \(3,\) for an x of shape \(3,\); wanted one"),
        (lambda x: x[:1], BadInputError, r"returns shape \(1,\)"),
        (lambda x: None, BadInputError, "returns nothing; wanted one number"),
        (lambda x: (x[0], x[1]), BadInputError, "returns a tuple; wanted one number"),
        (lambda x: x[0] > 0, BadInputError, "returns dtype bool; wanted a real number"),
        (lambda x: x[0] * 1j, BadInputError, "returns dtype complex64; wanted a real number"),
    ],
)
def test_function(fn: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^fn: {message}"):
        call(fn=fn)


@pytest.mark.parametrize(
    ("algorithm", "params", "error", "message"),
    [
        (
            "igwo",
            AcoParams(),
            BadTypeError,
            r"params: got usvjax\.swarms\.AcoParams; .* 'igwo' takes usvjax\.swarms\.GwoParams",
        ),
        (
            "aco",
            tours.AcoParams(),
            BadTypeError,
            r"params: got usvjax\.tours\.AcoParams; .* 'aco' takes usvjax\.swarms\.AcoParams",
        ),
        ("gwo", {"mu1": 1}, BadTypeError, r"params: got dict; .* takes usvjax\.swarms\.GwoParams"),
        ("gwo", DwaParams(), BadTypeError, "params: got DwaParams; algorithm 'gwo' takes"),
        ("gwo", GwoParams(mu1=NAN), BadInputError, r"params\.mu1: got nan; wanted a finite"),
        ("gwo", GwoParams(mu2=0), BadInputError, r"params\.mu2: got 0; wanted a number from"),
        ("gwo", GwoParams(lambda1=-1), BadInputError, r"params\.lambda1: got -1; wanted a number"),
        ("gwo", GwoParams(mu1="a"), BadTypeError, r"params\.mu1: got 'a'; wanted a number"),
        (
            "gwo",
            GwoParams(mu1=[1, [2]]),
            BadInputError,
            r"params\.mu1: rows of unequal length; wanted a number or float\[30\]",
        ),
        ("gwo", GwoParams(mu1=1e38), BadInputError, r"params\.mu1: got 1e\+38; wanted a number fr"),
        ("gwo", GwoParams(lambda1=1e300), BadInputError, r"params\.lambda1: got 1e\+300; wanted"),
        ("aco", AcoParams(locality=1e-40), BadInputError, r"params\.locality: got 1e-40; wanted a"),
        (
            "gwo",
            GwoParams(lambda2=np.zeros(4)),
            BadInputError,
            r"params\.lambda2: got shape \(4,\); wanted a number or one for each of 30 runs",
        ),
        ("aco", AcoParams(locality=0), BadInputError, r"params\.locality: got 0; wanted a number"),
        (
            "ga",
            GaParams(mutation=1.5),
            BadInputError,
            r"params\.mutation: got 1\.5; .* from 0 to 1$",
        ),
        (
            "ga",
            GaParams(blend=-0.1),
            BadInputError,
            r"params\.blend: got -0\.1; wanted a number from",
        ),
        ("cmpso", CmpsoParams(max_speed=0), BadInputError, r"params\.max_speed: got 0; wanted"),
        (
            "ga",
            GaParams(crossing=np.linspace(0, 1.2, 30)),
            BadInputError,
            r"params\.crossing: got 1\.0\d*; wanted a number from 0 to 1",
        ),
    ],
)
def test_params(algorithm: str, params: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{message}"):
        call(algorithm=algorithm, params=params)


@pytest.mark.parametrize(
    ("algorithm", "static", "error", "message"),
    [
        (
            "gwo",
            AcoStatic(),
            BadTypeError,
            r"static: got usvjax\.swarms\.AcoStatic; .* 'gwo' takes",
        ),
        ("gwo", GwoStatic(law="betta"), BadInputError, r"static\.law: .* did you mean 'beta'\?"),
        ("gwo", GwoStatic(leaders="best"), BadInputError, r"static\.leaders: got 'best'; "),
        ("gwo", GwoStatic(greedy=1), BadTypeError, r"static\.greedy: got 1; wanted True or False"),
        ("igwo", GwoStatic(), BadInputError, r"static\.law: got 'linear'; 'igwo' is 'gwo' with"),
        ("aco", AcoStatic(1), BadInputError, r"static\.archive: got 1; wanted 2 or more"),
        ("cmpso", CmpsoStatic(swarms=0), BadInputError, r"static\.swarms: got 0; wanted 1"),
        ("cmpso", CmpsoStatic(exchange=0), BadInputError, r"static\.exchange: got 0; wanted 1"),
        (
            "cmpso",
            CmpsoStatic(exchange=2**40),
            BadInputError,
            r"static\.exchange: got 1099511627776;",
        ),
        ("ga", GaStatic(elitism="no"), BadTypeError, r"static\.elitism: got 'no'; wanted True"),
    ],
)
def test_static(algorithm: str, static: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{message}"):
        call(algorithm=algorithm, static=static)


def test_what_is_right_is_computed() -> None:
    for change in (
        {},
        {"bounds": (-1, 1)},
        {"bounds": (np.zeros(3), 2)},
        {"bounds": np.array([[0.0, 0, 0], [1, 1, 1]])},
        {"key": jax.random.PRNGKey(0)},
        {"algorithm": "gwo", "params": GwoParams(mu1=np.ones(7)), "runs": 7},
        {"algorithm": "gwo", "static": GwoStatic(law="cosine"), "population": 3},
        {"algorithm": "ga", "population": 1, "iterations": 1},
    ):
        with pytest.raises(ComputeError):
            call(**change)
