"""Minimise a function by a swarm, many independent runs at once."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.ambient import precision
from usvjax.batches import Batch, bucket, split
from usvjax.checks import one_of, whole_number
from usvjax.devices import COMPILER_OPTIONS, chosen_devices
from usvjax.keys import as_key, first_run
from usvjax.memory import check_memory
from usvjax.public import public
from usvjax.swarms.algorithms import ALGORITHMS, Params, Static, checked_params, checked_static
from usvjax.swarms.objective import checked_bounds, checked_objective
from usvkernels import draws
from usvkernels.swarms.aco import AcoStatic
from usvkernels.swarms.pack import Box, Found, Objective

LANES = 16
"""Runs in one call of a processor: the numbers in a vector. One size, so that a run's arithmetic
does not depend on how many others there are."""
MOST_LANES = 4096
"""Runs in one call of an accelerator."""
_COPIES = 6  # arrays as large as the swarm, in an iteration
BLOCKS_PER_DEVICE = 2
"""At least, for another device to be used."""


@dataclass(frozen=True)
class MinimiseResult:
    """What each run found; numpy arrays, in the order of the runs.

    Attributes:
        best: float[runs], least value found; nan where every evaluation gave NaN.
        x: float[runs, dim], where; nan where `best` is.
        history: float[runs, iterations], least value up to the end of each iteration; inf before
            the first evaluation that gave a number.
        nans: int32[runs], evaluations that gave NaN. They rank last.
        evaluations: of each run.
    """

    best: np.ndarray
    x: np.ndarray
    history: np.ndarray
    nans: np.ndarray
    evaluations: int


@public("usvkernels.swarms")
def minimise(
    fn: Callable[[jax.Array], Any],
    bounds: Any,
    key: Any,
    *,
    algorithm: str = "igwo",
    dim: int = 30,
    runs: int = 30,
    iterations: int | None = None,
    population: int | None = None,
    params: Params | None = None,
    static: Static | None = None,
    dtype: str = "float32",
    first: int = 0,
) -> MinimiseResult:
    """Minimise a function of `dim` numbers in independent runs.

    Run j depends on the key, j, its parameters and the function alone, not on how many runs there
    are. A function is compiled once for each `algorithm`, `dim`, `population` and `iterations`;
    pass the same function object again, rather than a new lambda, to use the compiled program
    again. Runs on all devices, or on that of an enclosing `jax.default_device`.

    Source: Yu et al. 2022, sections 3.2, 4.1 and 5.3. With its law of a(t) as printed, "igwo" is
    the worse one of the wolves: about 90 on Sphere where "gwo" finds 1e-8. Both look first at the
    origin; where the optimum is elsewhere, "cmpso" is as good or better on all of Table 8.

    Args:
        fn: float[dim] -> float, traceable by JAX.
        bounds: (low, high), each a number or float[dim]; the swarm stays within.
        key: a seed (integer) or a JAX threefry key.
        algorithm: "igwo" or "gwo", grey wolves with the law of Eq. 14 or any other; "aco", ants
            (ACO_R); "ga", a genetic algorithm of real numbers; "cmpso", chaos multi-population
            particle swarm.
        dim: number of coordinates.
        runs: number of runs.
        iterations: of each run; by default the paper's: 200, for "aco" 100 and for "ga" 50.
        population: wolves, ants, individuals or particles; by default the paper's: 20 wolves, 200
            ants; where it prints none, 80 individuals and 20 particles.
        params: `GwoParams`, `AcoParams`, `GaParams` or `CmpsoParams` of `usvjax.swarms`; a leaf may
            be float[runs], one value per run, for a sweep.
        static: `GwoStatic`, `AcoStatic`, `GaStatic` or `CmpsoStatic` of `usvjax.swarms`, choices of
            method.
        dtype: "float32" or "float64", of all that is computed, `fn` included, whatever JAX is set
            to; values below 1e-38 want "float64".
        first: number of the first run, so that parts of a batch can be run apart.

    Returns:
        The results, in the order of the runs.

    Raises:
        BadTypeError: an argument of the wrong type, or a function that JAX cannot trace.
        BadInputError: an unknown algorithm; bounds that are reversed, not finite or of another
            shape; too few members, iterations or runs, or more than memory holds; a parameter out
            of range; an impossible choice; a function that returns no single number.
    """
    one_of("algorithm", algorithm, ALGORITHMS)
    method = ALGORITHMS[algorithm]
    dim = whole_number("dim", dim, 1)
    runs = whole_number("runs", runs, 1)
    first = first_run(first, runs)
    iterations = _default("iterations", iterations, method.iterations)
    population = _default("population", population, method.population)
    one_of("dtype", dtype, ("float32", "float64"))
    chosen = checked_static(algorithm, static, population)
    _check_sizes(dim, runs, iterations, population, chosen)
    low, high = checked_bounds(bounds, dim, dtype)
    stream = as_key(key)
    with precision(double=dtype == "float64"):
        leaves = checked_params(algorithm, params, runs)
        fn = checked_objective(fn, dim, dtype)
        task = _Task(algorithm, fn, chosen, population, iterations)
        box = Box(jnp.asarray(low[:, None]), jnp.asarray(high[:, None]))
        found = _in_blocks(task, box, stream, leaves, runs, first)
    evaluations = population * iterations
    if isinstance(chosen, AcoStatic):
        evaluations += chosen.archive
    return _collected(found, evaluations)


def _check_sizes(dim: int, runs: int, iterations: int, population: int, static: Static) -> None:
    """Refuse what the machine cannot hold: all histories, and the swarms under way."""
    members, kept = population, ""
    if isinstance(static, AcoStatic):
        members += static.archive
        kept = f" and an archive of {static.archive}"
    results = 8 * runs * (iterations + dim)
    swarms = 8 * _COPIES * LANES * len(chosen_devices()) * members * dim
    check_memory(
        results + swarms,
        f"runs: {runs} of {iterations} iterations with {population} members{kept} in {dim} "
        "dimensions",
    )


@dataclass(frozen=True)
class _Task:
    """What a program is compiled for."""

    algorithm: str
    fn: Objective
    static: Static
    population: int
    iterations: int


def _default(name: str, value: Any, default: int) -> int:
    return default if value is None else whole_number(name, value, 1)


def _in_blocks(
    task: _Task, box: Box, stream: jax.Array, params: Params, runs: int, first: int
) -> tuple[np.ndarray, ...]:
    """Run blocks of runs, shared out over the devices; the fields of `Found`, runs last."""
    devices = chosen_devices()
    lanes = LANES
    if devices[0].platform != "cpu":
        lanes = min(MOST_LANES, bucket(-(-runs // len(devices))))
    blocks = split(np.arange(runs), lanes)
    seeds = np.asarray(_drawn(stream, bucket(max(runs, lanes)), first))  # few sizes are compiled
    double = box.low.dtype == jnp.float64

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array, ...]:
        own = jax.tree.map(lambda leaf: leaf[rows], params)
        with precision(double):
            arguments = jax.device_put((box, seeds[:, rows], own), device)
            found = _run(task, *arguments)
        return found.best, found.x, found.history, found.nans

    # A program is compiled for each device: not worth it for a block or two.
    used = devices[: max(1, len(blocks) // BLOCKS_PER_DEVICE)]
    return Batch(blocks, lanes, used).arrays(work, axis=-1)


_drawn = jax.jit(draws.seeds, static_argnums=1)


@partial(jax.jit, static_argnames="task", compiler_options=COMPILER_OPTIONS)
def _run(task: _Task, box: Box, seed: jax.Array, params: Params) -> Found:
    return ALGORITHMS[task.algorithm].run(
        task.fn,
        box,
        seed,
        params,
        task.static,
        population=task.population,
        iterations=task.iterations,
    )


def _collected(found: tuple[np.ndarray, ...], evaluations: int) -> MinimiseResult:
    best, x, history, nans = found
    never = nans == evaluations
    return MinimiseResult(
        best=np.where(never, np.nan, best).astype(best.dtype),
        x=np.where(never[:, None], np.nan, x.T).astype(x.dtype),
        history=np.ascontiguousarray(history.T),
        nans=nans,
        evaluations=evaluations,
    )
