"""The algorithms by name, their defaults, and the checks of their options."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial
from typing import Any

import jax.numpy as jnp
import numpy as np

from usvjax.checks import default_or, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvkernels.swarms.cmpso import CmpsoParams, CmpsoStatic
from usvkernels.swarms.gwo import LEADERS
from usvkernels.swarms.laws import GwoParams
from usvkernels.tours import aco, ga, ils, keys, swaps

Run = Callable[..., Any]
"""(distances, seed, params, *, iterations, population, symmetric) -> orders, history."""


@dataclass(frozen=True)
class Algorithm:
    """One way to search for a tour.

    Attributes:
      run: the kernel.
      params: default numbers.
      population: default members; None where there are none.
      least: members at least.
      iterations: default number, by the number of stations.
    """

    run: Run
    params: Any
    population: int | None
    least: int
    iterations: Callable[[int], int]


def _ils(*args: Any, population: int | None, **options: Any) -> Any:
    del population  # it has none
    return ils.run(*args, **options)


def _either_way(run: Run) -> Run:
    """A kernel that does not care whether distances are the same in both directions."""

    def called(*args: Any, symmetric: bool, **options: Any) -> Any:
        del symmetric
        return run(*args, **options)

    return called


def _wolves(run: Run, law: str) -> Algorithm:
    return Algorithm(_either_way(partial(run, law=law)), GwoParams(), 20, LEADERS, lambda d: 200)


ALGORITHMS: dict[str, Algorithm] = {
    "ils": Algorithm(_ils, ils.IlsParams(), None, 0, lambda d: max(100, 20 * d)),
    "igwo": _wolves(keys.run_gwo, "beta"),
    "gwo": _wolves(keys.run_gwo, "linear"),
    "igwo_swap": _wolves(swaps.run, "beta"),
    "gwo_swap": _wolves(swaps.run, "linear"),
    "aco": Algorithm(aco.run, aco.AcoParams(), 200, 1, lambda d: 100),
    # Populations of these two are not printed; theirs make as many evaluations as the wolves'.
    "ga": Algorithm(_either_way(ga.run), ga.GaParams(), 80, 2, lambda d: 50),
    "cmpso": Algorithm(_either_way(keys.run_cmpso), CmpsoParams(), 20, 4, lambda d: 200),
}
"""Yu et al. 2022, section 5.1 and Table 2; "ils" is not theirs."""

NAMES = ("recommended", "exact", *ALGORITHMS)


_RANGES = {
    "patience": (-1, 1e9),
    "mu2": (1e-6, 1e6),
    "lambda1": (1e-6, 1e6),
    "inertia": (0, 1e3),
    "cognitive": (0, 1e3),
    "social": (0, 1e3),
    "max_speed": (1e-6, 1),
    "crossing": (0, 1),
    "mutation": (0, 1),
    "pheromone": (0, 10),
    "visibility": (0, 10),
    "evaporation": (0, 1),
    "intensity": (0, 1e6),
}
_WHOLE = ("patience",)


def checked_population(name: str, given: Any) -> int | None:
    """Members, those given or the default."""
    method = ALGORITHMS[name]
    if method.population is None:
        if given is not None:
            raise BadInputError(f"population: got {given!r}; algorithm {name!r} has none")
        return None
    if given is None:
        return method.population
    members = whole_number("population", given, method.least)
    swarms = CmpsoStatic().swarms
    if name == "cmpso" and members % swarms:
        raise BadInputError(f"population: got {members}; wanted a multiple of {swarms}, the swarms")
    return members


def checked_iterations(name: str, given: Any, stations: int) -> int:
    """Iterations, those given or the default."""
    if given is None:
        return ALGORITHMS[name].iterations(stations)
    return whole_number("iterations", given, 1)


def checked_params(name: str, given: Any, runs: int) -> Any:
    """Numbers of an algorithm, those given or its defaults, each leaf as [runs].

    Raises:
      BadTypeError: parameters of another algorithm, or no numbers.
      BadInputError: a wrong shape, not finite, or out of range.
    """
    default = ALGORITHMS[name].params
    given = default_or("params", given, default, name)
    leaves = {f.name: _leaf(f.name, getattr(given, f.name), runs) for f in fields(default)}
    return type(default)(**leaves)


def _leaf(name: str, value: Any, runs: int) -> np.ndarray:
    array = np.asarray(value)
    if array.dtype.kind not in "iuf":
        raise BadTypeError(f"params.{name}: got {value!r}; wanted a number or float[{runs}]")
    if array.shape not in ((), (runs,)):
        raise BadInputError(
            f"params.{name}: got shape {array.shape}; wanted a number or one for each of "
            f"{runs} runs"
        )
    low, high = _RANGES.get(name, (-np.inf, np.inf))
    for bad, wanted in (
        (~np.isfinite(array), "a finite number"),
        ((array < low) | (array > high), f"a number from {low:g} to {high:g}"),
    ):
        if bad.any():
            raise BadInputError(f"params.{name}: got {array[bad].flat[0]:g}; wanted {wanted}")
    if name in _WHOLE and array.dtype.kind == "f":
        raise BadTypeError(f"params.{name}: got {value!r}; wanted whole numbers")
    kind = np.int32 if name in _WHOLE else jnp.result_type(float)
    return np.broadcast_to(array.astype(kind), (runs,))


def refuse_options(**given: Any) -> None:
    """The exact algorithm takes none."""
    for name, value in given.items():
        if value is not None:
            raise BadInputError(
                f"{name}: got {value!r}; exact tours, taken for few stations, take none"
            )
