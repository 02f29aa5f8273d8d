"""Eager checks of single arguments that the map functions share."""

import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from usvjax.errors import BadInputError, BadTypeError


def number(name: str, value: Any) -> float:
    """Return a finite real number as a float.

    Raises:
        BadTypeError: It is not a number.
        BadInputError: It is NaN or infinite.
    """
    if isinstance(value, bool | np.bool_) or not isinstance(
        value, int | float | np.integer | np.floating
    ):
        raise BadTypeError(f"{name}: got {value!r}; wanted a number")
    if not math.isfinite(value):
        raise BadInputError(f"{name}: got {value}; wanted a finite number")
    return float(value)


def positive(name: str, value: Any) -> float:
    """Return a finite number above zero; raises like ``number``."""
    result = number(name, value)
    if result <= 0:
        raise BadInputError(f"{name}: got {value}; wanted a number above 0")
    return result


def not_negative(name: str, value: Any) -> float:
    """Return a finite number of zero or more; raises like ``number``."""
    result = number(name, value)
    if result < 0:
        raise BadInputError(f"{name}: got {value}; wanted 0 or more")
    return result


def fraction(name: str, value: Any) -> float:
    """Return a number in [0, 1]; raises like ``number``."""
    result = number(name, value)
    if not 0 <= result <= 1:
        raise BadInputError(f"{name}: got {value}; wanted a number in [0, 1]")
    return result


def pair(name: str, value: Any) -> tuple[float, float]:
    """Return (x, y) as two finite floats; raises like ``number``."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if not isinstance(value, tuple | list):
        raise BadTypeError(f"{name}: got {value!r}; wanted two numbers (x, y)")
    if len(value) != 2:
        raise BadInputError(f"{name}: got {len(value)} numbers; wanted two, (x, y)")
    return number(f"{name}[0]", value[0]), number(f"{name}[1]", value[1])


def grid(name: str, value: Any) -> np.ndarray:
    """Return a private, read-only bool[H, W] with H, W >= 1.

    Raises:
        BadTypeError: The dtype is not bool.
        BadInputError: It is not two-dimensional, or empty.
    """
    try:
        array = np.asarray(value)
    except ValueError:
        raise BadInputError(f"{name}: got rows of unequal length; wanted bool [H, W]") from None
    if array.dtype != np.bool_:
        raise BadTypeError(
            f"{name}: got dtype {array.dtype}; wanted bool [H, W] (True = not navigable)"
        )
    if array.ndim != 2 or 0 in array.shape:
        raise BadInputError(f"{name}: got shape {array.shape}; wanted [H, W] with both at least 1")
    array = array.copy()
    array.flags.writeable = False
    return array


def file_path(name: str, value: Any) -> Path:
    """Return a path; raises BadTypeError for anything but a string or a path."""
    if not isinstance(value, str | os.PathLike):
        raise BadTypeError(f"{name}: got {value!r}; wanted a string or a path")
    return Path(value)
