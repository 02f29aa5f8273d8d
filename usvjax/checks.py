"""Checks of what a user passes in, before anything is traced."""

import math
import os
import re
import reprlib
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from usvjax.errors import BadInputError, BadTypeError
from usvjax.suggest import did_you_mean

T = TypeVar("T")

MOST_SHOWN = 60
"""Characters of a value that a message shows."""

MOST_FILE_NAME = 255
"""Characters of a file's name; so many bytes are what file systems hold."""

_brief = reprlib.Repr()
_brief.maxstring = _brief.maxlong = _brief.maxother = MOST_SHOWN
_brief.maxlevel = 3


def shown(value: object) -> str:
    """A value as a message shows it: what `repr` says, cut short, in one line."""
    try:
        text = re.sub(r"\s*\n\s*", " ", _brief.repr(value))
    except Exception:  # Python prints no such number, and a user's class may fail
        return (
            "a whole number of thousands of digits"
            if isinstance(value, int)
            else f"a {type(value).__name__}"
        )
    return text if len(text) <= MOST_SHOWN else f"{text[: MOST_SHOWN - 3]}..."


def float_array(
    name: str, value: Any, shape: tuple[int | None, ...], most: float = math.inf
) -> np.ndarray:
    """The value as a finite float64 array of the given shape.

    Args:
        name: of the argument, for the message.
        value: anything that numpy takes.
        shape: wanted sizes; None takes any.
        most: largest magnitude.

    Raises:
        BadTypeError: not real numbers.
        BadInputError: another shape, NaN, infinite or too large.
    """
    array = any_array(name, value, _shape(shape))
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
    if most < math.inf and (largest := np.abs(array).max(initial=0.0)) > most:
        raise BadInputError(f"{name}: got {largest:g}; wanted at most {most:g} in magnitude")
    return array


def any_array(name: str, value: Any, wanted: str) -> np.ndarray:
    """The value as an array of whatever dtype and shape.

    Args:
        name: of the argument, for the message.
        value: anything that numpy takes.
        wanted: words for the message.

    Raises:
        BadTypeError: not an array, or one with a mask, which numpy would drop.
        BadInputError: rows of unequal length.
    """
    if isinstance(value, np.ma.MaskedArray):
        raise BadTypeError(f"{name}: got a masked array; wanted {wanted}, without a mask")
    try:
        return np.asarray(value)
    except ValueError:
        raise BadInputError(f"{name}: rows of unequal length; wanted {wanted}") from None
    except jax_tracing_errors():
        raise
    except Exception:  # what a user's class, or a key of JAX, raises
        raise BadTypeError(f"{name}: got {shown(value)}; wanted {wanted}") from None


def jax_tracing_errors() -> tuple[type[Exception], ...]:
    """What JAX raises where an array is not concrete; nothing while JAX is not loaded."""
    jax = sys.modules.get("jax")
    return (jax.errors.TracerArrayConversionError,) if jax else ()


def one_of(name: str, value: object, allowed: Iterable[str]) -> None:
    """Refuse a value that is not among the allowed names.

    Raises:
        BadTypeError: not a string.
        BadInputError: naming the argument, the value and the nearest name, or all of them.
    """
    allowed = list(allowed)
    if not isinstance(value, str):
        raise BadTypeError(f"{name}: got {shown(value)}; wanted a string")
    if value not in allowed:
        raise BadInputError(f"{name}: got {shown(value)}; {did_you_mean(value, allowed)}")


def whole_number(name: str, value: object, least: int) -> int:
    """The value as an int from `least` to 2**63 - 1.

    Raises:
        BadTypeError: not a whole number.
        BadInputError: too small, or too large.
    """
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
        raise BadTypeError(f"{name}: got {shown(value)}; wanted a whole number")
    if value < least:
        raise BadInputError(f"{name}: got {shown(value)}; wanted {least} or more")
    if value >= 2**63:
        raise BadInputError(f"{name}: got {shown(value)}; wanted less than 2**63")
    return int(value)


def _shape(shape: tuple[int | None, ...]) -> str:
    return "shape (" + ", ".join("any" if s is None else str(s) for s in shape) + ")"


def truth(name: str, value: object) -> bool:
    """The value as a bool.

    Raises:
        BadTypeError: anything else: "false" would count as True.
    """
    if not isinstance(value, bool | np.bool_):
        raise BadTypeError(f"{name}: got {shown(value)}; wanted True or False")
    return bool(value)


def number(name: str, value: Any) -> float:
    """Return a finite real number as a float.

    Raises:
        BadTypeError: it is not a number.
        BadInputError: it is NaN, infinite or beyond the range of a float.
    """
    if isinstance(value, bool | np.bool_) or not isinstance(
        value, int | float | np.integer | np.floating
    ):
        raise BadTypeError(f"{name}: got {shown(value)}; wanted a number")
    try:
        result = float(value)
    except OverflowError:
        # Not shown: Python refuses to print a whole number of thousands of digits.
        raise BadInputError(
            f"{name}: got a whole number of more than 308 digits; wanted one that a float can hold"
        ) from None
    if not math.isfinite(result):
        raise BadInputError(f"{name}: got {shown(value)}; wanted a finite number")
    return result


def positive(name: str, value: Any) -> float:
    """Return a number above zero that single precision resolves; raises like ``number``."""
    result = number(name, value)
    if result <= 0:
        raise BadInputError(f"{name}: got {shown(value)}; wanted a number above 0")
    return _resolved(name, result)


def not_negative(name: str, value: Any) -> float:
    """Return zero, or a number above it that single precision resolves; raises like ``number``."""
    result = number(name, value)
    if result < 0:
        raise BadInputError(f"{name}: got {shown(value)}; wanted 0 or more")
    return _resolved(name, result) if result else 0.0


def _resolved(name: str, value: float) -> float:
    """Refuse what becomes infinite or loses digits in single precision."""
    if not LEAST_SINGLE <= value <= MOST_SINGLE:
        raise BadInputError(
            f"{name}: got {value:g}; wanted a number from {LEAST_SINGLE:.2g} to {MOST_SINGLE:.2g}, "
            "as single precision has it"
        )
    return value


LEAST_SINGLE, MOST_SINGLE = float(np.finfo(np.float32).tiny), float(np.finfo(np.float32).max)
"""Numbers above zero that single precision holds with all its digits."""


def fraction(name: str, value: Any) -> float:
    """Return a number in [0, 1]; raises like ``number``."""
    result = number(name, value)
    if not 0 <= result <= 1:
        raise BadInputError(f"{name}: got {shown(value)}; wanted a number in [0, 1]")
    return result


def pair(name: str, value: Any) -> tuple[float, float]:
    """Return (x, y) as two finite floats; raises like ``number``."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if not isinstance(value, tuple | list):
        raise BadTypeError(f"{name}: got {shown(value)}; wanted two numbers (x, y)")
    if len(value) != 2:
        raise BadInputError(f"{name}: got {len(value)} numbers; wanted two, (x, y)")
    return number(f"{name}[0]", value[0]), number(f"{name}[1]", value[1])


def grid(name: str, value: Any) -> np.ndarray:
    """Return a private, read-only bool[H, W] with H, W >= 1.

    Raises:
        BadTypeError: the dtype is not bool.
        BadInputError: it is not two-dimensional, or empty.
    """
    array = any_array(name, value, "bool [H, W]")
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
    """Return a path.

    Raises:
        BadTypeError: it is neither a string nor a path.
        BadInputError: it holds a NUL or a character that cannot be encoded, or a name that is too
            long, which no file can have.
    """
    if not isinstance(value, str | os.PathLike):
        raise BadTypeError(f"{name}: got {shown(value)}; wanted a string or a path")
    path = Path(value)
    if "\0" in str(path):
        raise BadInputError(f"{name}: got {shown(str(path))}; wanted a path without NUL characters")
    try:
        os.fsencode(path)
    except UnicodeEncodeError:
        raise BadInputError(
            f"{name}: got {shown(str(path))}; wanted a path of characters that can be encoded"
        ) from None
    if any(len(part) > MOST_FILE_NAME for part in path.parts):
        raise BadInputError(
            f"{name}: got {shown(str(path))}; wanted names of at most {MOST_FILE_NAME} characters"
        )
    return path


def default_or(name: str, given: Any, default: T, algorithm: str) -> T:
    """What was given for an algorithm, or its default where that is None.

    Raises:
        BadTypeError: of another type than the default, such as another algorithm's.
    """
    if given is None:
        return default
    if type(given) is not type(default):
        raise BadTypeError(
            f"{name}: got {public_name(type(given))}; algorithm {algorithm!r} takes "
            f"{public_name(type(default))}"
        )
    return given


_SHARING_NAMES = ("planners", "swarms", "tours")


def public_name(kind: type) -> str:
    """A class as a user imports it, such as `usvjax.tours.AcoParams`.

    Packages in which classes have the same names are named; of other classes, only the name is.
    """
    package, *parts = kind.__module__.split(".")
    if package == "usvkernels" and parts and parts[0] in _SHARING_NAMES:
        return f"usvjax.{parts[0]}.{kind.__name__}"
    return kind.__name__


def byte_size(count: int) -> str:
    """Bytes in a unit that reads well, for a message."""
    if count >= 2**80:
        return "more than 2**80 bytes"  # which may be no float
    for unit, size in (("GiB", 2**30), ("MiB", 2**20), ("KiB", 2**10)):
        if count >= size:
            return f"{count / size:.1f} {unit}"
    return f"{count} bytes"
