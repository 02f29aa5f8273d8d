"""What every swarm must do: stay inside, never worsen, say what it found, and repeat itself."""

import itertools
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from property_draws import examples

from usvjax.swarms import minimising as module
from usvjax.swarms.algorithms import ALGORITHMS
from usvjax.swarms.minimising import MinimiseResult, minimise
from usvjax.swarms.objective import checked_objective
from usvjax.swarms.ranges import RANGES
from usvkernels.swarms import aco, cmpso, ga, gwo
from usvkernels.swarms.functions import TABLE_8, shifted, sphere
from usvkernels.swarms.laws import GwoParams
from usvkernels.swarms.pack import evaluate

DIM = 3
LOW = np.array([-4.0, 1.0, -1e-3])
HIGH = np.array([-3.0, 50.0, 2e-3])
CENTRE = (-3.4, 2.0, 1e-3)
INSIDE = shifted(sphere, CENTRE)
SMALL: dict[str, Any] = {"dim": DIM, "iterations": 30, "population": 12}


def half(x: jax.Array) -> jax.Array:
    """NaN in the part of the box that holds the optimum of the rest."""
    return jnp.where(x[1] < 3.0, jnp.nan, INSIDE(x))


def small(algorithm: str, **changes: Any) -> MinimiseResult:
    options = {**SMALL, "runs": 5, "key": 4, "bounds": (LOW, HIGH), "fn": half, **changes}
    fn, bounds, key = (options.pop(name) for name in ("fn", "bounds", "key"))
    return minimise(fn, bounds, key, algorithm=algorithm, **options)


def same(one: MinimiseResult, other: MinimiseResult, runs: int) -> None:
    for name in ("best", "x", "history", "nans"):
        np.testing.assert_array_equal(getattr(one, name)[:runs], getattr(other, name)[:runs])


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_properties(algorithm: str) -> None:
    found = small(algorithm)
    assert found.best.shape == (5,)
    assert found.x.shape == (5, DIM)
    assert found.history.shape == (5, SMALL["iterations"])
    assert found.best.dtype == found.x.dtype == found.history.dtype == np.float32
    assert (np.diff(found.history, axis=1) <= 0).all()
    np.testing.assert_array_equal(found.history[:, -1], found.best)
    np.testing.assert_allclose(jax.vmap(INSIDE)(found.x), found.best, rtol=1e-5)
    assert (np.float32(LOW) <= found.x).all()
    assert (found.x <= np.float32(HIGH)).all()
    assert len(np.unique(found.best)) == 5
    # What is NaN is counted and never wins.
    assert (found.nans > 0).all()
    assert (found.nans < found.evaluations).all()
    assert (found.x[:, 1] >= 3.0).all()
    assert found.evaluations == 12 * 30 + (50 if algorithm == "aco" else 0)
    # It searches: a tenth of the evaluations, drawn blindly, do worse.
    rng = np.random.default_rng(0)
    x = rng.uniform(LOW, HIGH, (200, 36, DIM))
    blind = np.where(x[..., 1] < 3.0, np.inf, ((x - CENTRE) ** 2).sum(-1)).min(1)
    assert np.median(found.best - 1.0) < np.median(blind - 1.0) / 3


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_run_depends_on_itself_alone(algorithm: str) -> None:
    few = small(algorithm)
    same(few, small(algorithm), 5)
    same(few, small(algorithm, runs=2 * module.LANES + 3), 5)
    assert (small(algorithm, key=5).best != few.best).all()
    same(few, small(algorithm, key=jax.random.key(4)), 5)
    apart = small(algorithm, runs=3, first=2)
    np.testing.assert_array_equal(apart.history, few.history[2:])


def test_as_many_devices_as_there_are() -> None:
    runs = 4 * module.LANES + 1
    together = small("gwo", runs=runs)
    with jax.default_device(jax.devices()[0]):
        alone = small("gwo", runs=runs)
    same(together, alone, runs)


def test_nothing_but_nan() -> None:
    found = small("gwo", fn=lambda x: x[0] * jnp.nan)
    assert (found.nans == found.evaluations).all()
    assert np.isnan(found.best).all()
    assert np.isnan(found.x).all()
    assert np.isinf(found.history).all()


def test_infinite_values_are_no_nan() -> None:
    found = small("igwo", fn=lambda x: jnp.where(x[1] < 3.0, jnp.nan, jnp.inf))
    assert (found.nans > 0).any()
    assert (found.nans < found.evaluations).all()
    assert np.isposinf(found.best).all()
    assert np.isfinite(found.x).all()


def test_values_are_numbers_of_the_swarm_s_type() -> None:
    x = jnp.ones((4, DIM, 2)).at[1, 0].set(jnp.nan)
    value, nans = evaluate(lambda x: jnp.sum(x > 0).astype(jnp.int32), x)
    assert value.dtype == jnp.float32
    assert value.tolist() == [[3, 3], [2, 2], [3, 3], [3, 3]]
    value, nans = evaluate(sphere, x)
    assert value.tolist() == [[3, 3], [np.inf, np.inf], [3, 3], [3, 3]]
    assert nans.tolist() == [1, 1]


def test_a_parameter_of_each_run() -> None:
    """A sweep gives what each of its values gives."""
    values = np.array([0.05, 0.5, 4.0, 0.01, 0.3])
    swept = small("igwo", params=GwoParams(mu1=values))
    for run in (0, 2):
        one = small("igwo", params=GwoParams(mu1=float(values[run])))
        np.testing.assert_allclose(swept.history[run], one.history[run], rtol=2e-4)
    assert abs(swept.best[2] / small("igwo").best[2] - 1) > 1e-3


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_no_parameter_in_range_makes_nan(algorithm: str) -> None:
    """All corners of the ranges at once, one for each run."""
    kind = type(ALGORITHMS[algorithm].params)
    corners = np.array(list(itertools.product(*RANGES[kind].values())))
    params = kind(**dict(zip(RANGES[kind], corners.T, strict=True)))
    found = small(algorithm, fn=sphere, runs=len(corners), params=params)
    assert not found.nans.any()
    assert np.isfinite(found.best).all()


def test_function_without_a_hash() -> None:
    class Moved:
        __hash__ = None  # type: ignore[assignment]

        def __call__(self, x: jax.Array) -> jax.Array:
            return half(x)

    kept = checked_objective(Moved(), DIM, np.float32)
    assert {kept: 1}[kept] == 1
    assert kept(jnp.full(DIM, 4.0)) == half(jnp.full(DIM, 4.0))


def test_equal_shifts_are_equal_functions() -> None:
    assert shifted(sphere, np.array([1.0, 2.0])) == shifted(sphere, (1.0, 2.0))
    assert hash(shifted(sphere, 1)) == hash(shifted(sphere, 1.0))
    assert float(shifted(sphere, (1.0, 2.0))(jnp.array([1.0, 5.0]))) == 9.0


@pytest.mark.parametrize("name", TABLE_8)
def test_functions_of_table_8(name: str) -> None:
    function = TABLE_8[name]
    x = np.random.default_rng(3).uniform(*function.bounds, 7)
    wanted = {
        "f1": sum(v * v for v in x),
        "f2": max(abs(v) for v in x),
        "f3": sum(v * v - 10 * np.cos(2 * np.pi * v) + 10 for v in x),
        "f4": sum(abs(v * np.sin(v) + 0.1 * v) for v in x),
    }[name]
    assert float(function.fn(jnp.asarray(x))) == pytest.approx(wanted, rel=1e-5)
    assert float(function.fn(jnp.zeros(7))) == 0.0


@pytest.mark.parametrize("archive", [2, 50])
def test_ants_choose_ranks_by_a_gaussian(archive: int) -> None:
    locality = np.float32([1e-4, 0.01, 0.3, 10.0])
    chances = np.asarray(aco.rank_chances(archive, jnp.asarray(locality)))
    weight = np.exp(-0.5 * (np.arange(archive)[:, None] / (locality * archive)) ** 2)
    np.testing.assert_allclose(chances, np.cumsum(weight / weight.sum(0), axis=0), atol=1e-5)


@examples(30)
@given(z=st.floats(0, 1))
def test_logistic_map_never_dies(z: float) -> None:
    value = jnp.float32(z)
    for _ in range(3):
        value = cmpso.logistic(value)
        assert 0 < float(value) < 1
    assert float(cmpso.logistic(jnp.float32(0.3))) == pytest.approx(0.84)


def test_options_are_heeded() -> None:
    base = {name: small(name) for name in ("gwo", "aco", "ga", "cmpso")}
    for name, changes in {
        "gwo": [
            {"static": gwo.GwoStatic(greedy=True)},
        ],
        "aco": [{"params": aco.AcoParams(locality=0.5)}, {"params": aco.AcoParams(evaporation=2)}],
        "ga": [
            {"params": ga.GaParams(crossing=0.0)},
            {"params": ga.GaParams(mutation=1.0)},
            {"params": replace(ga.GaParams(), blend=0.0)},
        ],
        "cmpso": [
            {"params": cmpso.CmpsoParams(inertia=0.9)},
            {"params": cmpso.CmpsoParams(cognitive=0.0)},
            {"params": cmpso.CmpsoParams(social=0.0)},
            {"params": cmpso.CmpsoParams(max_speed=0.01)},
        ],
    }.items():
        for change in changes:
            assert (small(name, **change).best != base[name].best).any(), change


def test_ga_without_crossing_or_mutation_keeps_the_first_population() -> None:
    still = small("ga", params=ga.GaParams(crossing=0.0, mutation=0.0))
    assert (still.history == still.history[:, :1]).all()
