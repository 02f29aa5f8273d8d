"""Search for short tours, many problems and many runs at once."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import numpy as np

from usvjax.checks import one_of, whole_number
from usvjax.devices import COMPILER_OPTIONS, chosen_devices, share_out
from usvjax.errors import BadInputError
from usvjax.keys import as_key
from usvjax.tours import exact
from usvjax.tours.algorithms import (
    ALGORITHMS,
    NAMES,
    checked_iterations,
    checked_params,
    checked_population,
    refuse_options,
)
from usvjax.tours.inputs import Legs, checked_legs, truth
from usvjax.tours.lengths import lengths
from usvkernels import draws
from usvkernels.status import Status
from usvkernels.tours.lengths import from_start

EXACT_UP_TO = 12
"""Stations; so few are solved exactly by "recommended"."""


@dataclass(frozen=True)
class TourResult:
    """The best tour of each run; numpy arrays, in the order of the arguments.

    Attributes:
      order: int32[B, d], the stations in the order of the visits, station 0 first.
      length: float64[B], in the unit of the points or distances; inf where no tour without a
        missing leg was found.
      history: float64[B, iterations], least length up to the end of each iteration.
      status: int32[B], `Status`: FOUND; UNREACHABLE, proven that no tour is of finite length;
        OUT_OF_BUDGET, none was found.
      algorithm: that ran: "exact" or "ils" for "recommended".
    """

    order: np.ndarray
    length: np.ndarray
    history: np.ndarray
    status: np.ndarray
    algorithm: str


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
      params: of the algorithm, `IlsParams` and so on; a leaf may be an array, one value per run.
      first: number of the first run, so that parts of a batch can be solved apart.

    Returns:
      The best tours, in the order of the runs.

    Raises:
      BadTypeError: an argument of the wrong type.
      BadInputError: an unknown algorithm; fewer than two stations, two in one place, NaN, negative
        distances or a wrong shape; too few runs, iterations or members.
    """
    one_of("algorithm", algorithm, NAMES)
    legs = checked_legs(points, distances)
    closed = truth("closed", closed)
    stream = as_key(key)
    count = _count(legs, runs)
    first = whole_number("first", first, 0)
    if algorithm == "recommended":
        algorithm = "exact" if legs.stations <= EXACT_UP_TO else "ils"
    if algorithm == "exact":
        refuse_options(iterations=iterations, population=population, params=params)
        order = np.broadcast_to(exact.orders(legs, closed), (count, legs.stations))
        return _collected(legs, closed, order, None, algorithm)
    task = _Task(
        algorithm,
        checked_iterations(algorithm, iterations, legs.stations),
        checked_population(algorithm, population),
        legs.symmetric and closed,
    )
    leaves = checked_params(algorithm, params, count)
    # Few sizes, so that few programs are compiled.
    seeds = np.asarray(_seeds(stream, 1 << (count - 1).bit_length(), first))
    order, history = _in_blocks(task, exact.scaled(legs, closed), seeds, leaves, count)
    return _collected(legs, closed, order, history, algorithm)


@dataclass(frozen=True)
class _Task:
    """What a program is compiled for."""

    algorithm: str
    iterations: int
    population: int | None
    symmetric: bool


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
    task: _Task, distances: np.ndarray, seeds: np.ndarray, params: Any, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Run blocks of lanes, shared out over the devices; int[B, d] and float[B, T]."""
    devices = chosen_devices()
    size = lanes(distances.shape[1])
    blocks = [np.arange(first, first + size) for first in range(0, count, size)]
    shared = len(distances) == 1

    def on_device(rows: np.ndarray, device: jax.Device) -> tuple[np.ndarray, np.ndarray]:
        own = np.minimum(rows, count - 1)
        legs = distances[0] if shared else np.moveaxis(distances[own], 0, -1)
        leaves = jax.tree.map(lambda leaf: leaf[own], params)
        arrays = jax.device_put((legs, seeds[:, own], leaves), device)
        order, history = jax.device_get(_run(*arrays, task))
        return order.T, history.T

    parts = list(share_out(on_device, blocks, devices))
    order, history = (np.concatenate(arrays)[:count] for arrays in zip(*parts, strict=True))
    return order, history


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
        history = exact.unscaled(legs, history)
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
