"""Ranges of the numbers that algorithms take, for functions and for tours alike."""

from dataclasses import fields
from typing import Any

import jax.numpy as jnp
import numpy as np

from usvjax.checks import any_array, default_or, shown
from usvjax.errors import BadInputError, BadTypeError
from usvkernels.swarms import aco, cmpso, ga
from usvkernels.swarms.laws import GwoParams
from usvkernels.tours import aco as tour_aco
from usvkernels.tours import ga as tour_ga
from usvkernels.tours import ils

_FACTOR = (-1e6, 1e6)
_POSITIVE = (1e-6, 1e6)
_PULL = (0, 1e3)
_SHARE = (0, 1)

# Such that no step overflows in float32, nor is lost in it.
RANGES: dict[type, dict[str, tuple[float, float]]] = {
    GwoParams: {"mu1": _FACTOR, "mu2": _POSITIVE, "lambda1": _POSITIVE, "lambda2": _FACTOR},
    aco.AcoParams: {"locality": _POSITIVE, "evaporation": _POSITIVE},
    ga.GaParams: {"crossing": _SHARE, "mutation": _SHARE, "blend": (0, 1e6)},
    cmpso.CmpsoParams: {
        "inertia": _PULL,
        "cognitive": _PULL,
        "social": _PULL,
        "max_speed": (1e-6, 1),
    },
    tour_aco.AcoParams: {
        "pheromone": (0, 10),
        "visibility": (0, 10),
        "evaporation": _SHARE,
        "intensity": (0, 1e6),
    },
    tour_ga.GaParams: {"crossing": _SHARE, "mutation": _SHARE},
    ils.IlsParams: {"patience": (-1, 1e9)},
}
"""(least, most) of each number, both allowed, by the class that holds it."""

_WHOLE = ("patience",)


def checked_numbers(algorithm: str, given: Any, default: Any, runs: int) -> Any:
    """Numbers of an algorithm, those given or its defaults, each leaf as [runs].

    Args:
        algorithm: its name, for messages.
        given: what the user passed, or None.
        default: of the algorithm; its class is in `RANGES`.
        runs: how many.

    Returns:
        The class of `default`, leaves int32 where whole, else of JAX's default precision.

    Raises:
        BadTypeError: parameters of another algorithm, or no numbers.
        BadInputError: a wrong shape, not finite, or out of range.
    """
    given = default_or("params", given, default, algorithm)
    kind = type(default)
    leaves = {
        f.name: _leaf(f.name, getattr(given, f.name), RANGES[kind][f.name], runs)
        for f in fields(kind)
    }
    return kind(**leaves)


def _leaf(name: str, value: Any, allowed: tuple[float, float], runs: int) -> np.ndarray:
    array = any_array(f"params.{name}", value, f"a number or float[{runs}]")
    if array.dtype.kind not in "iuf":
        raise BadTypeError(f"params.{name}: got {shown(value)}; wanted a number or float[{runs}]")
    if array.shape not in ((), (runs,)):
        raise BadInputError(
            f"params.{name}: got shape {array.shape}; wanted a number or one for each of "
            f"{runs} runs"
        )
    low, high = allowed
    for bad, wanted in (
        (~np.isfinite(array), "a finite number"),
        ((array < low) | (array > high), f"a number from {low:g} to {high:g}"),
    ):
        if bad.any():
            raise BadInputError(f"params.{name}: got {array[bad].flat[0]}; wanted {wanted}")
    if name in _WHOLE and array.dtype.kind == "f":
        raise BadTypeError(f"params.{name}: got {shown(value)}; wanted whole numbers")
    kind = np.int32 if name in _WHOLE else jnp.result_type(float)
    return np.broadcast_to(array.astype(kind), (runs,))
