"""Checks of a function to minimise and of its bounds."""

from collections.abc import Callable, Hashable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.checks import any_array, shown
from usvjax.errors import BadInputError, BadTypeError
from usvkernels.swarms.pack import Objective, evaluate


def checked_bounds(bounds: Any, dim: int, dtype: Any) -> tuple[np.ndarray, np.ndarray]:
    """Bounds (low, high) as float[dim] each.

    Raises:
        BadTypeError: not two of numbers or arrays.
        BadInputError: a wrong shape, not finite, or not low < high.
    """
    try:
        low, high = bounds
    except Exception:  # whatever a user's class may raise
        raise BadTypeError(
            f"bounds: got {shown(bounds)}; wanted (low, high), each a number or float[{dim}]"
        ) from None
    sides = [_side(name, side, dim) for name, side in (("low", low), ("high", high))]
    with np.errstate(over="ignore"):
        low, high = (side.astype(dtype) for side in sides)
        width = high - low
    reversed_ = np.flatnonzero(~(sides[0] < sides[1]))
    if len(reversed_):
        first = reversed_[0]
        raise BadInputError(
            f"bounds: low {sides[0][first]:g} is not below high {sides[1][first]:g} at "
            f"coordinate {first}"
        )
    if not (np.isfinite(width).all() and (width > 0).all()):
        raise BadInputError(f"bounds: too far apart, or too near each other, for {dtype}")
    return low, high


def _side(name: str, value: Any, dim: int) -> np.ndarray:
    array = any_array(f"bounds: {name}", value, f"a number or float[{dim}]")
    if array.dtype.kind not in "iuf":
        raise BadTypeError(f"bounds: {name} is {shown(value)}; wanted a number or float[{dim}]")
    if array.shape not in ((), (dim,)):
        raise BadInputError(
            f"bounds: {name} has shape {array.shape}; wanted a number or shape ({dim},), "
            "bounds being (low, high)"
        )
    if not np.isfinite(array).all():
        raise BadInputError(f"bounds: {name} is {shown(value)}; wanted finite numbers")
    return np.broadcast_to(array, (dim,)).astype(np.float64)


def checked_objective(fn: Any, dim: int, dtype: Any) -> Objective:
    """The function, which JAX can trace and map over swarms, and which returns one number.

    Raises:
        BadTypeError: not callable, or it raises while JAX traces it.
        BadInputError: it returns anything but one real number.
    """
    if not callable(fn):
        raise BadTypeError(f"fn: got {shown(fn)}; wanted a function of float[{dim}]")
    if not isinstance(fn, Hashable):
        fn = _Hashable(fn)
    made = _traced(fn, jax.ShapeDtypeStruct((dim,), dtype))
    leaves = jax.tree.leaves(made)
    if len(leaves) != 1 or not hasattr(made, "shape"):
        raise BadInputError(f"fn: returns {_named(made)}; wanted one number")
    if made.shape != ():
        raise BadInputError(
            f"fn: returns shape {made.shape} for an x of shape ({dim},); wanted one number"
        )
    if not (jnp.issubdtype(made.dtype, jnp.floating) or jnp.issubdtype(made.dtype, jnp.integer)):
        raise BadInputError(f"fn: returns dtype {made.dtype}; wanted a real number")
    # Mapped as the swarms map it, so that what fails does so here.
    _traced(lambda x: evaluate(fn, x), jax.ShapeDtypeStruct((2, dim, 2), dtype))
    return fn


def _traced(fn: Callable[..., Any], x: jax.ShapeDtypeStruct) -> Any:
    try:
        return jax.eval_shape(fn, x)
    except Exception as error:
        reason = (str(error).strip() or "no message").splitlines()[0]
        raise BadTypeError(
            f"fn: JAX cannot trace it, {type(error).__name__}: {reason}; wanted a function of "
            "one array that computes with jax.numpy"
        ) from error


def _named(made: Any) -> str:
    return "nothing" if made is None else f"a {type(made).__name__}"


class _Hashable:
    """A function that has no hash of its own; equal to itself only."""

    def __init__(self, fn: Callable[[jax.Array], Any]):
        self.fn = fn

    def __call__(self, x: jax.Array) -> Any:
        return self.fn(x)
