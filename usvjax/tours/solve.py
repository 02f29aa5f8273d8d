"""Search for short tours, many problems and many runs at once."""

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import jax
import numpy as np

from usvjax.batches import Batch, bucket, split
from usvjax.checks import one_of, whole_number
from usvjax.devices import COMPILER_OPTIONS, chosen_devices
from usvjax.errors import BadInputError
from usvjax.keys import as_key, first_run
from usvjax.memory import check_memory
from usvjax.public import public
from usvjax.tours import exact
from usvjax.tours.algorithms import (
    ALGORITHMS,
    NAMES,
    Static,
    checked_iterations,
    checked_params,
    checked_population,
    checked_static,
    refuse_options,
)
from usvjax.tours.inputs import Legs, checked_legs
from usvjax.tours.lengths import lengths
from usvjax.tours.scaling import Scaled, search
from usvkernels import draws
from usvkernels.status import Status
from usvkernels.tours.lengths import from_start

EXACT_UP_TO = 12
"""Stations; so few are solved exactly by "recommended"."""
_SWARM_COPIES = 6  # arrays as large as the swarm, in an iteration
_RESULT_COPIES = 4  # arrays as large as the results, while they are collected


@dataclass(frozen=True)
class TourResult:
    """The best tour of each run; numpy arrays, in the order of the arguments.

    Attributes:
        order: int32[B, d], the stations in the order of the visits, station 0 first.
        length: float64[B], in the unit of the points or distances; inf where no tour without a
            missing leg was found.
        history: float64[B, iterations], least length up to the end of each iteration; inf where
            that tour has a missing leg, or one so long that no short tour has it.
        status: int32[B], `Status`: FOUND; UNREACHABLE, proven that no tour is of finite length;
            OUT_OF_BUDGET, none was found.
        algorithm: that ran: "exact" or "ils" for "recommended".
    """

    order: np.ndarray
    length: np.ndarray
    history: np.ndarray
    status: np.ndarray
    algorithm: str


@public("usvkernels.tours")
def solve_tour(
    points: Any = None,
    key: Any = 0,
    *,
    algorithm: str = "recommended",
    distances: Any = None,
    closed: bool = True,
    runs: int | None = None,
    iterations: int | None = None,
    population: int | None = None,
    params: Any = None,
    static: Static | None = None,
    first: int = 0,
) -> TourResult:
    """Search for the shortest tour from station 0 through all others.

    Run j depends on the key, j, its problem and its parameters alone, not on how many runs there
    are. Runs on all devices, or on that of an enclosing `jax.default_device`.

    Source: Yu et al. 2022, sections 3.4, 4.1 and 5.1; of each algorithm, its kernel.

    Args:
        points: float[B, d, 2], one problem for each run, or float[d, 2]: (x, y) of the stations,
            the start first. Legs are straight.
        key: a seed (integer) or a JAX threefry key.
        algorithm: "recommended": the exact optimum up to 12 stations and "ils" beyond. "ils":
            iterated local search by 2-opt, Or-opt and double bridges, which is neither a swarm nor
            the paper's. "exact": dynamic programming, up to 13 stations. The paper's, with its
            settings: "igwo" and "gwo", grey wolves by random keys; "aco", ants; "ga", a genetic
            algorithm; "cmpso", chaos multi-population particle swarm. "igwo_swap" and "gwo_swap":
            wolves by swap sequences.
        distances: float[B, d, d] or float[d, d], instead of points: [a, b] from a to b; inf where
            not connected. They need not be the same in both directions.
        closed: whether the tour returns to station 0; otherwise it ends anywhere.
        runs: number of runs of a single problem.
        iterations: of each run; by default the paper's: 200, for "aco" 100 and for "ga" 50. For
            "ils", moves and kicks together: 20 per station.
        population: wolves, ants, individuals or particles; by default the paper's: 20 wolves, 200
            ants; where it prints none, 80 individuals and 20 particles.
        params: of the algorithm, `usvjax.tours.IlsParams` and so on; a leaf may be an array, one
            value per run.
        static: choices of method: `usvjax.swarms.GwoStatic` of the wolves, `CmpsoStatic` of
            "cmpso". "igwo" and "igwo_swap" have the law "beta" only. Wolves by swap sequences are
            by default greedy and led by the best of the pack.
        first: number of the first run, so that parts of a batch can be solved apart.

    Returns:
        The best tours, in the order of the runs.

    Raises:
        BadTypeError: an argument of the wrong type.
        BadInputError: an unknown algorithm; fewer than two stations, two in one place, NaN,
            negative distances or a wrong shape; too few runs, iterations or members, or more than
            memory holds; an impossible choice.
    """
    one_of("algorithm", algorithm, NAMES)
    legs = checked_legs(points, distances)
    stream = as_key(key)
    count = _count(legs, runs)
    first = first_run(first, count)
    if algorithm == "recommended":
        algorithm = "exact" if legs.stations <= EXACT_UP_TO else "ils"
    if algorithm == "exact":
        refuse_options(iterations=iterations, population=population, params=params, static=static)
        _check_sizes(legs, count, 1, 0)
        order = np.broadcast_to(exact.orders(legs, closed), (count, legs.stations))
        return _collected(legs, closed, order, None, algorithm)
    iterations = checked_iterations(algorithm, iterations, legs.stations)
    population = checked_population(algorithm, population)
    chosen = checked_static(algorithm, static, population)
    _check_sizes(legs, count, iterations, population or 0)
    leaves = checked_params(algorithm, params, count)
    # Few sizes, so that few programs are compiled.
    seeds = np.asarray(_seeds(stream, bucket(count), first))
    task = _Task(algorithm, chosen, iterations, population)
    symmetric = np.broadcast_to(legs.symmetric & closed, count)

    def run(runs: np.ndarray, distances: Scaled) -> tuple[np.ndarray, np.ndarray]:
        order, found = _in_blocks(task, distances.table, symmetric, seeds, leaves, runs)
        return order, distances.history(found, runs)

    order, history = search(legs, closed, count, run)
    return _collected(legs, closed, order, history, algorithm)


@dataclass(frozen=True)
class _Task:
    """What a program is compiled for."""

    algorithm: str
    static: Static | None
    iterations: int
    population: int | None
    symmetric: bool = True


def _check_sizes(legs: Legs, runs: int, iterations: int, population: int) -> None:
    """Refuse what the machine cannot hold: all histories, and the swarms under way."""
    stations = legs.stations
    results = 8 * _RESULT_COPIES * runs * (iterations + stations)
    at_once = lanes(stations) * len(chosen_devices())
    swarms = 4 * _SWARM_COPIES * at_once * population * stations
    members = f" with {population} members" if population else ""
    check_memory(
        results + swarms, f"runs: {runs} of {iterations} iterations{members} on {stations} stations"
    )


def _count(legs: Legs, runs: int | None) -> int:
    """Number of runs."""
    if runs is None:
        return len(legs.distances)
    runs = whole_number("runs", runs, 1)
    if len(legs.distances) > 1:
        raise BadInputError(
            f"runs: got {runs} with {len(legs.distances)} problems of {legs.name}; wanted runs "
            "with a single problem, or none"
        )
    return runs


def _in_blocks(
    task: _Task,
    distances: np.ndarray,
    symmetric: np.ndarray,
    seeds: np.ndarray,
    params: Any,
    runs: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Run blocks of lanes, shared out over the devices; int[n, d] and float[n, T] of runs int[n].

    Distances that are the same in both directions, and others, run in blocks of their own: so a
    run does not depend on the other problems.
    """
    size = lanes(distances.shape[1])
    shared = len(distances) == 1
    alike = symmetric[runs]
    blocks = [*split(np.flatnonzero(alike), size), *split(np.flatnonzero(~alike), size)]

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array, jax.Array]:
        own = runs[rows]
        legs = distances[0] if shared else np.moveaxis(distances[own], 0, -1)
        leaves = jax.tree.map(lambda leaf: leaf[own], params)
        arrays = jax.device_put((legs.astype(np.float32), seeds[:, own], leaves), device)
        return _run(*arrays, replace(task, symmetric=bool(symmetric[own[0]])))

    order, history = Batch(blocks, size, chosen_devices()).arrays(work, axis=1)
    return order.T, history.T


def lanes(stations: int) -> int:
    """Runs in one call: one size for a problem, so that a run's arithmetic is always the same."""
    return 64 if stations <= 32 else 16


@partial(jax.jit, static_argnums=1)
def _seeds(stream: jax.Array, count: int, first: int) -> jax.Array:
    return draws.seeds(stream, count, first)


@partial(jax.jit, static_argnames="task", compiler_options=COMPILER_OPTIONS)
def _run(
    distances: jax.Array, seed: jax.Array, params: Any, task: _Task
) -> tuple[jax.Array, jax.Array]:
    order, history = ALGORITHMS[task.algorithm].run(
        distances,
        seed,
        params,
        static=task.static,
        iterations=task.iterations,
        population=task.population,
        symmetric=task.symmetric,
    )
    return from_start(order), history


def _collected(
    legs: Legs, closed: bool, order: np.ndarray, history: np.ndarray | None, algorithm: str
) -> TourResult:
    """Lengths anew in float64, from the distances as given."""
    length = lengths(legs.distances, order, closed)
    if history is None:
        history = length[:, None]
    else:
        history = np.maximum(history, length[:, None])
        history[:, -1] = length
    joined = np.broadcast_to(legs.joined(closed), length.shape)
    status = np.where(np.isfinite(length), int(Status.FOUND), int(Status.OUT_OF_BUDGET))
    return TourResult(
        order=order.astype(np.int32),
        length=length,
        history=history,
        status=np.where(joined, status, int(Status.UNREACHABLE)).astype(np.int32),
        algorithm=algorithm,
    )
