"""Checks of what a user passes in, before anything is traced."""

import difflib
from collections.abc import Iterable
from typing import Any

import numpy as np

from usvjax.errors import BadInputError, BadTypeError


def float_array(name: str, value: Any, shape: tuple[int | None, ...]) -> np.ndarray:
    """The value as a finite float64 array of the given shape.

    Args:
      name: of the argument, for the message.
      value: anything that numpy takes.
      shape: wanted sizes; None takes any.

    Raises:
      BadTypeError: not real numbers.
      BadInputError: another shape, NaN or infinite.
    """
    try:
        array = np.asarray(value)
    except ValueError:
        raise BadInputError(f"{name}: rows of unequal length; wanted {_shape(shape)}") from None
    if array.dtype.kind not in "iuf":
        raise BadTypeError(f"{name}: got dtype {array.dtype}; wanted real numbers")
    fits = array.ndim == len(shape) and all(
        want is None or got == want for got, want in zip(array.shape, shape, strict=True)
    )
    if not fits:
        raise BadInputError(f"{name}: got shape {array.shape}; wanted {_shape(shape)}")
    array = array.astype(np.float64)
    if not np.isfinite(array).all():
        first = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise BadInputError(f"{name}: {array[first]} at index {list(first)}; wanted finite numbers")
    return array


def one_of(name: str, value: object, allowed: Iterable[str]) -> None:
    """Refuse a value that is not among the allowed names, naming the nearest.

    Raises:
      BadInputError: naming the argument, the value and what is allowed.
    """
    allowed = list(allowed)
    if value not in allowed:
        raise BadInputError(f"{name}: got {value!r}; wanted {nearest(str(value), allowed)}")


def nearest(word: str, allowed: list[str]) -> str:
    """What to suggest instead of an unknown word: all names, the nearest first."""
    close = difflib.get_close_matches(word, allowed, n=1, cutoff=0.5)
    listed = ", ".join(repr(a) for a in allowed)
    return f"{close[0]!r} (one of {listed})" if close else f"one of {listed}"


def whole_number(name: str, value: object, least: int) -> int:
    """The value as an int of at least `least`.

    Raises:
      BadTypeError: not a whole number.
      BadInputError: too small.
    """
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
        raise BadTypeError(f"{name}: got {value!r}; wanted a whole number")
    if value < least:
        raise BadInputError(f"{name}: got {value}; wanted {least} or more")
    return int(value)


def _shape(shape: tuple[int | None, ...]) -> str:
    return "shape (" + ", ".join("any" if s is None else str(s) for s in shape) + ")"
