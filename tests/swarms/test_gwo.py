"""Grey wolves: step by step against plain NumPy, and in distribution against it and mealpy."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import swarms_reference as plain
from dwa_situations import enable_x64
from scipy import special, stats

from usvjax.swarms.minimising import minimise
from usvkernels import draws
from usvkernels.swarms import gwo
from usvkernels.swarms.functions import TABLE_8, shifted, sphere
from usvkernels.swarms.laws import LAWS, GwoParams, convergence
from usvkernels.swarms.pack import Box, lowest

WOLVES, DIM, STEPS, RUNS = 5, 4, 25, 3
BOUNDS = (-3.0, 8.0)
CENTRE = 1.25
LEVEL = 1e-3  # of a comparison in distribution; the seeds are fixed


def first_seeds() -> jax.Array:
    return jax.jit(draws.seeds, static_argnums=1)(jax.random.key(9), RUNS)


def written_out(seed: np.ndarray, time: int) -> np.ndarray:
    """Six numbers in [-1, 1] for each wolf and coordinate, from whole numbers."""
    size = WOLVES * DIM
    first, second = int(seed[0]), int(seed[1])
    drawn = [
        plain.words(first, second, time, i) + plain.words(first, second, time, size + i)[:2]
        for i in range(size)
    ]
    whole = np.array(drawn, np.uint32).astype(np.int32)
    return (whole * 2.0**-31).T.reshape(6, WOLVES, DIM)


@pytest.mark.parametrize(
    "static",
    [
        gwo.GwoStatic(),
        gwo.GwoStatic(leaders="pack", law="beta"),
        gwo.GwoStatic(leaders="pack", greedy=True, law="cosine"),
        gwo.GwoStatic(greedy=True),
    ],
    ids=str,
)
def test_same_draws_give_the_same_wolves(static: gwo.GwoStatic) -> None:
    seeds = first_seeds()

    def packs(seed: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        box = Box(jnp.full((DIM, 1), BOUNDS[0]), jnp.full((DIM, 1), BOUNDS[1]))
        fn = shifted(TABLE_8["f3"].fn, CENTRE)
        start = gwo.first_pack(gwo.scattered(seed, box, WOLVES), static)
        factors = convergence(static.law, STEPS, GwoParams(), box.low.dtype)

        def step(wolves: gwo.Wolves, now: Any) -> tuple[gwo.Wolves, Any]:
            wolves = gwo.advance(fn, box, seed, static, wolves, *now)
            return wolves, (wolves.x, wolves.kept_value[0])

        _, (x, history) = jax.lax.scan(step, start, (jnp.arange(STEPS), factors))
        return start.x, x, history

    with enable_x64():
        began, x, history = jax.device_get(jax.jit(packs)(seeds))
        factors = np.asarray(convergence(static.law, STEPS, GwoParams(), jnp.float64))[:, 0]
    assert (history[-1] < history[0]).any()
    for run, seed in enumerate(np.asarray(seeds).T):
        first = [plain.words(int(seed[0]), int(seed[1]), 0, i)[0] for i in range(WOLVES * DIM)]
        start = BOUNDS[0] + np.array(first).reshape(WOLVES, DIM) * 2.0**-32 * np.ptp(BOUNDS)
        np.testing.assert_allclose(began[..., run], start, rtol=1e-14)

        def step(t: int, _: Any, seed: np.ndarray = seed) -> tuple[np.ndarray, np.ndarray]:
            numbers = (written_out(seed, t + 1) + 1) / 2
            return numbers[0::2], numbers[1::2]

        def fn(place: np.ndarray) -> np.ndarray:
            return plain.FUNCTIONS["f3"](place - CENTRE)

        wanted, values = plain.hunt(fn, start, BOUNDS, factors, step, static.leaders, static.greedy)
        np.testing.assert_allclose(x[..., run], np.stack(wanted), rtol=1e-7, atol=1e-9)
        np.testing.assert_allclose(history[:, run], values, rtol=1e-7, atol=1e-9)


def test_run_is_its_steps() -> None:
    bounds = (np.full(DIM, BOUNDS[0]), BOUNDS[1])
    whole = minimise(
        sphere, bounds, 9, algorithm="gwo", dim=DIM, population=WOLVES, iterations=STEPS, runs=RUNS
    )
    seeds = np.asarray(first_seeds())
    for run in range(RUNS):

        def step(t: int, _: Any, run: int = run) -> tuple[np.ndarray, np.ndarray]:
            numbers = (written_out(seeds[:, run], t + 1) + 1) / 2
            return numbers[0::2], numbers[1::2]

        first = [plain.words(*map(int, seeds[:, run]), 0, i)[0] for i in range(WOLVES * DIM)]
        start = BOUNDS[0] + np.array(first).reshape(WOLVES, DIM) * 2.0**-32 * np.ptp(BOUNDS)
        factors = 2 - 2 * np.arange(STEPS) / STEPS
        _, values = plain.hunt(plain.FUNCTIONS["f1"], start, BOUNDS, factors, step)
        np.testing.assert_allclose(whole.history[run], values, rtol=1e-3)  # float32


@pytest.mark.parametrize("name", TABLE_8)
def test_as_good_as_plain_numpy(name: str) -> None:
    function = TABLE_8[name]
    size: dict[str, int] = {"runs": 30, "dim": 30, "iterations": 200}
    ours = minimise(
        function.fn,
        function.bounds,
        1,
        algorithm="gwo",
        population=20,
        dtype="float64",
        **size,
    )
    assert ours.best.dtype == np.float64
    rng = np.random.default_rng(2)
    theirs = plain.hunts(plain.FUNCTIONS[name], rng, function.bounds, wolves=20, **size)
    logarithms = np.log10(ours.best), np.log10(theirs)
    assert stats.ks_2samp(*logarithms).pvalue > LEVEL
    assert stats.mannwhitneyu(*logarithms).pvalue > LEVEL
    if name == "f1":
        assert 3e-9 < np.median(ours.best) < 1e-7


# mealpy 3.0.3, least value found of x @ x, each of 4 coordinates in [-100, 100]:
# GWO.OriginalGWO(epoch=30, pop_size=6).solve(problem, seed=seed).target.fitness, seeds 0 to 24.
MEALPY = (
    *(3.45e0, 1.68e-2, 1.20e-1, 1.36e0, 3.56e-1, 3.25e0, 4.75e-1, 6.83e-1, 4.19e-1, 1.52e0),
    *(4.90e0, 1.30e0, 1.48e1, 1.68e0, 5.84e0, 7.23e-1, 7.05e0, 9.96e-1, 4.27e0, 7.48e0),
    *(3.99e-1, 4.68e0, 4.95e0, 6.39e-1, 1.41e-3),
)


def test_as_good_as_mealpy() -> None:
    ours = minimise(
        sphere,
        (-100, 100),
        1,
        algorithm="gwo",
        dim=4,
        population=6,
        iterations=31,  # it makes one evaluation more
        runs=25,
        static=gwo.GwoStatic(leaders="pack", greedy=True),  # its rules
    )
    assert stats.ks_2samp(np.log10(MEALPY), np.log10(ours.best)).pvalue > LEVEL


def factors(law: str, iterations: int, params: GwoParams) -> np.ndarray:
    return np.asarray(jax.jit(convergence, static_argnums=(0, 1))(law, iterations, params))


def test_laws() -> None:
    steps = 50
    t = np.arange(steps) / steps
    wanted = {
        "linear": 2 - 2 * t,
        "quadratic": 2 - 2 * t**2,
        "cosine": 2 * np.cos(np.pi * t / 2) ** 2,
        "exponential": 2 - 2 * (np.exp(t) - 1) / (np.e - 1),
    }
    for law, values in wanted.items():
        got = factors(law, steps, GwoParams())
        np.testing.assert_allclose(got[:, 0], values, atol=1e-6)
    for law in LAWS:
        got = factors(law, steps, GwoParams())
        assert got.shape == (steps, 1)
        assert (np.diff(got[:, 0]) < 0).all()
    with pytest.raises(ValueError, match="law"):
        convergence("line", steps, GwoParams())


def test_beta_law_is_the_integral() -> None:
    params = GwoParams(mu1=0.3, mu2=jnp.array([0.5, 2.0]), lambda1=jnp.array([1.0, 4.0]))
    got = factors("beta", 8, params)
    for t, run in np.ndindex(8, 2):
        x, y = (0.5, 2.0)[run], (t + (1.0, 4.0)[run]) / 8
        # In double precision; the kernel takes exponentials of sums of logarithms of up to 40.
        assert got[t, run] == pytest.approx(0.3 * special.beta(x, y) + 0.1, rel=2e-5)


def test_eq_14_as_printed_is_no_search_after_a_few_iterations() -> None:
    a = factors("beta", 200, GwoParams())[:, 0]
    assert 2.1 < a[0] < 2.2
    assert a[5] < 0.6
    assert 0.19 < a[-1] < 0.21  # and not 0, as section 4.1.2 has it


def test_lowest_takes_the_first_of_equals() -> None:
    value = jnp.array([[3.0, jnp.inf], [1.0, jnp.inf], [1.0, 5.0], [2.0, jnp.inf]])
    values, index = lowest(value, 3)
    np.testing.assert_array_equal(index, [[1, 2], [2, 0], [3, 1]])
    np.testing.assert_array_equal(values, [[1, 5], [1, np.inf], [2, np.inf]])
