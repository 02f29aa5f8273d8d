"""Checks of what the planners are given beside the scene."""

from dataclasses import dataclass, fields
from typing import Any

import jax
import numpy as np

from usvjax.checks import number, public_name, shown, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.keys import as_key
from usvjax.search.inputs import SearchScene
from usvkernels.draws import seeds

MOST_ITERATIONS = 1 << 20
LEAST_WEIGHT = 1e-6  # with all below it, no path is fitter than none


@dataclass(frozen=True)
class Defaults:
    """What a planner takes where the user says nothing, and what it can take.

    Attributes:
        params: its parameters.
        iterations: of it.
        population: of it.
        least: members that it needs.
        most: members that it can have.
        multiple: of which the population must be one.
        ranges: (least, most) of each parameter, both allowed.
        weights: parameters of which one at least must be `LEAST_WEIGHT`; none where empty.
    """

    params: Any
    iterations: int
    population: int
    least: int
    most: int
    multiple: int
    ranges: dict[str, tuple[float, float]]
    weights: tuple[str, ...] = ()


@dataclass(frozen=True)
class Request:
    """Checked arguments.

    Attributes:
        scene: the queries.
        seeds: uint32[2, B].
        iterations: 1 or more.
        population: enough for the algorithm.
        params: of numbers.
    """

    scene: SearchScene
    seeds: np.ndarray
    iterations: int
    population: int
    params: Any


def planner_request(
    defaults: Defaults, scene: SearchScene, key: Any, iterations: Any, population: Any, params: Any
) -> Request:
    """Check the arguments of a planner.

    Raises:
        BadTypeError: not a key, not whole numbers, another planner's parameters.
        BadInputError: too few members or iterations, a parameter out of range or not finite, keys
            that are not one for each query.
    """
    if iterations is None:
        iterations = defaults.iterations
    if population is None:
        population = defaults.population
    iterations = whole_number("iterations", iterations, 1)
    population = whole_number("population", population, defaults.least)
    for name, value, most in (
        ("iterations", iterations, MOST_ITERATIONS),
        ("population", population, defaults.most),
    ):
        if value > most:
            raise BadInputError(f"{name}: got {shown(value)}; wanted at most {most}")
    if population % defaults.multiple:
        raise BadInputError(
            f"population: got {shown(population)}; wanted a multiple of {defaults.multiple}"
        )
    return Request(
        scene=scene,
        seeds=_seeds(key, len(scene)),
        iterations=iterations,
        population=population,
        params=_params(defaults, params),
    )


def _params(defaults: Defaults, params: Any) -> Any:
    """The parameters as plain floats."""
    kind = type(defaults.params)
    if params is None:
        return defaults.params
    if not isinstance(params, kind):
        raise BadTypeError(f"params: got {public_name(type(params))}; wanted {public_name(kind)}")
    values = {f.name: number(f"params.{f.name}", getattr(params, f.name)) for f in fields(kind)}
    for name, value in values.items():
        low, high = defaults.ranges[name]
        if not low <= value <= high:
            raise BadInputError(f"params.{name}: got {value:g}; wanted {low:g} to {high:g}")
    _check_weights({name: values[name] for name in defaults.weights})
    return kind(**values)


def _check_weights(weights: dict[str, float]) -> None:
    if weights and max(weights.values()) < LEAST_WEIGHT:
        names = ", ".join(f"params.{name}" for name in weights)
        got = " and ".join(f"{weight:g}" for weight in weights.values())
        raise BadInputError(f"{names}: got {got}; wanted {LEAST_WEIGHT:g} or more of one of them")


def _seeds(key: Any, count: int) -> np.ndarray:
    """Seeds uint32[2, B], each query's its own."""
    typed = isinstance(key, jax.Array) and jax.dtypes.issubdtype(key.dtype, jax.dtypes.prng_key)
    if typed and key.ndim == 1:
        return _own_seeds(key, count)
    return np.asarray(seeds(as_key(key), count))


def _own_seeds(keys: jax.Array, count: int) -> np.ndarray:
    if len(keys) != count:
        raise BadInputError(f"key: got {len(keys)} keys; wanted one, or {count}, one per query")
    return np.asarray(jax.vmap(lambda key: jax.random.bits(key, (2,), np.uint32))(keys)).T
