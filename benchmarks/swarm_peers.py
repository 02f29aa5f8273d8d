"""Swarms on the Sphere function: runs per second against what users minimise with today."""

import statistics
from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.markdown import table, verdict
from benchmarks.peers.swarms import DIM, HIGH, ITERATIONS, LOW, MEMBERS, SOLVERS, Crew
from benchmarks.timing import in_turns, seconds_of
from usvjax.devices import COMPILER_OPTIONS, chosen_devices, usable_cores
from usvjax.swarms.minimising import LANES, minimise
from usvkernels import draws
from usvkernels.swarms.functions import sphere
from usvkernels.swarms.gwo import GwoStatic

TITLE = "Swarms against their peers"
MEALPY = "mealpy OriginalGWO"
SAME_RULES = "usvjax GWO, mealpy's rules"
EACH = {MEALPY: 6, "NumPy GWO, runs side by side": 32, "scikit-opt PSO": 16, "scikit-opt GA": 4}
"""Runs per core of each peer: enough for a second or so."""
RUNS = 4096
REPETITIONS = 5
LEAST, AIM = 50.0, 200.0
"""Ratios to mealpy: the bar, and what was aimed for."""
NUMBERS = 6
"""Random numbers per wolf, coordinate and iteration."""

OURS: dict[str, dict[str, Any]] = {
    "usvjax GWO": {"algorithm": "gwo"},
    SAME_RULES: {"algorithm": "gwo", "static": GwoStatic(leaders="pack", greedy=True)},
    "usvjax IGWO": {"algorithm": "igwo"},
    "usvjax CMPSO": {"algorithm": "cmpso"},
    "usvjax GA": {"algorithm": "ga"},
    "usvjax ACO": {"algorithm": "aco"},
}


def measure(quick: bool) -> dict[str, Any]:
    """Time all contestants in turns, on all cores."""
    runs = 2 * LANES if quick else RUNS
    each = {name: 1 if quick else n for name, n in EACH.items() if name in SOLVERS}
    crew = Crew(usable_cores())
    try:
        contest = _contest(crew, runs, each, 1 if quick else REPETITIONS)
    finally:
        crew.close()
    return {"contest": contest, "generators": _generators(quick)}


def _contest(crew: Crew, runs: int, each: dict[str, int], repetitions: int) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name in OURS:
        first = seconds_of(partial(_ours, name, runs))
        found[name] = {"first": first, "rates": [], "runs": runs}
    for name in each:
        crew.run(name, 1)
        found[name] = {"first": None, "rates": [], "runs": each[name] * len(crew.processes)}
    for _ in range(repetitions):
        for name in OURS:
            best: list[np.ndarray] = []
            seconds = seconds_of(lambda name=name, best=best: best.append(_ours(name, runs)))
            found[name]["rates"].append(runs / seconds)
            found[name]["median"] = float(np.median(best[0]))
        for name, n in each.items():
            seconds, values = crew.run(name, n)
            found[name]["rates"].append(len(values) / seconds)
            found[name]["median"] = float(np.median(values))
    return found


def _ours(name: str, runs: int) -> np.ndarray:
    result = minimise(
        sphere,
        (LOW, HIGH),
        0,
        dim=DIM,
        runs=runs,
        population=MEMBERS,
        iterations=ITERATIONS,
        **OURS[name],
    )
    return result.best


def _generators(quick: bool) -> dict[str, float]:
    """Nanoseconds per number in [0, 1), drawn and summed up on one core, by generator."""
    steps = 10 if quick else ITERATIONS
    shape = (NUMBERS, MEMBERS * DIM, LANES)
    with jax.default_device(chosen_devices()[0]):
        calls = {
            f"JAX {kind}": partial(_with_jax, jax.random.key(0, impl=kind), shape, steps)
            for kind in ("threefry2x32", "rbg", "unsafe_rbg")
        }
        calls["pcg4d, from a counter"] = partial(
            _with_counter, draws.seeds(jax.random.key(0), LANES), shape, steps
        )
        timed = in_turns({name: _ready(call) for name, call in calls.items()})
    numbers = steps * shape[0] * shape[1] * shape[2]
    return {name: 1e9 * one["median"] / numbers for name, one in timed.items()}


def _ready(call: Callable[[], jax.Array]) -> Callable[[], Any]:
    return lambda: jax.block_until_ready(call())


@partial(jax.jit, static_argnums=(1, 2), compiler_options=COMPILER_OPTIONS)
def _with_jax(key: jax.Array, shape: tuple[int, int, int], steps: int) -> jax.Array:
    def step(t: jax.Array, total: jax.Array) -> jax.Array:
        drawn = jax.random.uniform(jax.random.fold_in(key, t), shape)
        return total + drawn.sum(axis=(0, 1))

    return jax.lax.fori_loop(0, steps, step, jnp.zeros(shape[2]))


@partial(jax.jit, static_argnums=(1, 2), compiler_options=COMPILER_OPTIONS)
def _with_counter(seed: jax.Array, shape: tuple[int, int, int], steps: int) -> jax.Array:
    index = jnp.arange(shape[1], dtype=jnp.uint32)[:, None]

    def step(t: jax.Array, total: jax.Array) -> jax.Array:
        first = draws.words(seed[:, None], t, 2 * index)
        second = draws.words(seed[:, None], t, 2 * index + 1)
        drawn = [draws.uniform(word) for word in (*first, *second[: shape[0] - 4])]
        return total + sum(drawn[1:], drawn[0]).sum(axis=0)

    return jax.lax.fori_loop(0, steps, step, jnp.zeros(shape[2]))


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    contest = found["contest"]
    rates = {name: statistics.median(one["rates"]) for name, one in contest.items()}
    ours = rates[SAME_RULES]
    rows = [
        (
            name,
            f"{one['runs']:,}",
            f"{rates[name]:,.1f}",
            f"{ours / rates[name]:,.1f}",
            f"{one['median']:.2g}",
            "-" if one["first"] is None else f"{one['first'] - one['runs'] / rates[name]:.1f}",
        )
        for name, one in contest.items()
    ]
    header = ("contestant", "runs", "runs/s", f"of {SAME_RULES}", "median", "compile s")
    cost = [(name, f"{ns:.2f}") for name, ns in found["generators"].items()]
    verdicts = [verdict("mealpy is not installed: no comparison with it", False)]
    if MEALPY in rates:
        ratio = ours / rates[MEALPY]
        verdicts = [
            verdict(
                f"{ratio:,.0f} times mealpy by the same rules, at least {LEAST:g}", ratio >= LEAST
            ),
            verdict(f"{ratio:,.0f} times mealpy, {AIM:g} aimed for", ratio >= AIM),
        ]
    return (
        f"Sphere in {DIM} dimensions, {MEMBERS} members, {ITERATIONS} iterations, all cores, "
        "peers with a process per core; medians. mealpy keeps a wolf where it is unless it "
        "improves and takes the leaders from the pack; so does the second row. PSO with the "
        "inertia and factors of Yu et al. 2022; the sub-swarms of CMPSO and the genetic "
        "algorithms differ in their rules, and are compared in the number of evaluations only.\n\n"
        + table(header, rows)
        + "\n\nRandom numbers, one core:\n\n"
        + table(("generator", "ns per number"), cost)
        + "\n\n"
        + "\n".join(verdicts)
    )
