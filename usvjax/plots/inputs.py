"""Checks of what figures are made from, before anything is drawn."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from usvjax.checks import any_array, number, shown, whole_number
from usvjax.errors import BadInputError, BadTypeError, unprintable
from usvjax.maps import GridMap

MOST_METRES = 1e12
"""Of a coordinate or a length; beyond, ticks of axes cannot be told apart."""

MOST_LETTERS = 10_000
"""Of a text: what lays figures out measures every letter."""

_FINEST = 1e-9  # of a coordinate: the least side of what is shown
_WHOLE = ("condition", "job", "status")


def text(name: str, value: Any) -> str:
    """A text that can be drawn, of whatever lines.

    Raises:
        BadTypeError: it is no string.
        BadInputError: it is too long, or holds control characters or lone surrogates.
    """
    if not isinstance(value, str):
        raise BadTypeError(f"{name}: got {shown(value)}; wanted a string")
    if len(value) > MOST_LETTERS or unprintable(value.replace("\n", " ")):
        raise BadInputError(
            f"{name}: got {shown(value)}; wanted at most {MOST_LETTERS:,} characters, all of which "
            f"can be drawn"
        )
    return value


def titles(**given: str | None) -> None:
    """Check texts that may be left out; raises like `text`."""
    for name, value in given.items():
        if value is not None:
            text(name, value)


def texts(name: str, value: Any) -> list[str]:
    """A sequence of different texts, at least one.

    Raises:
        BadTypeError: it is none, or one of them is no string.
        BadInputError: it is empty or names one twice, or as `text`.
    """
    if not isinstance(value, list | tuple):
        raise BadTypeError(f"{name}: got {shown(value)}; wanted a list of strings")
    if not value:
        raise BadInputError(f"{name} is empty; at least one was wanted")
    found = [text(f"{name}[{i}]", one) for i, one in enumerate(value)]
    if len(set(found)) < len(found):
        raise BadInputError(f"{name}: got {shown(value)}; wanted none of them twice")
    return found


def by_name(name: str, value: Mapping[Any, Any]) -> Mapping[str, Any]:
    """A dictionary whose keys are texts; raises like `text`."""
    for key in value:
        text(f"a key of {name}", key)
    return value


def text_by(name: str, value: Mapping[Any, Any] | None) -> Mapping[Any, str]:
    """A dictionary of texts, empty for None; raises like `text`."""
    return {key: text(f"{name}[{shown(key)}]", one) for key, one in (value or {}).items()}


def metres_by(name: str, value: Mapping[Any, Any] | None) -> Mapping[Any, float]:
    """A dictionary of numbers, empty for None; raises like `metres`."""
    return {key: metres(f"{name}[{shown(key)}]", one) for key, one in (value or {}).items()}


def metres(name: str, value: Any, least: float = 0.0) -> float:
    """A number from `least` to MOST_METRES.

    Raises:
        BadTypeError: no number.
        BadInputError: NaN, infinite, too small or too large.
    """
    found = number(name, value)
    if not least <= found <= MOST_METRES:
        raise BadInputError(
            f"{name} is {found:g}; a number from {least:g} to {MOST_METRES:g} was wanted"
        )
    return found


LEAST_METRES = 1e-6
"""Of a length that must be above 0."""


def share(name: str, value: Any) -> float:
    """A number between 0 and 1, neither included; raises like `metres`."""
    found = number(name, value)
    if not 0.0 < found < 1.0:
        raise BadInputError(f"{name} is {found:g}; a number between 0 and 1 was wanted")
    return found


def numbers(name: str, value: Any, wanted: str) -> NDArray[np.float64]:
    """Any numbers as float64, NaN and infinities among them.

    Args:
        name: of the argument, for the message.
        value: anything that numpy takes.
        wanted: its shape in words, for the message.

    Raises:
        BadTypeError: not real numbers.
        BadInputError: rows of unequal length, or a number beyond MOST_METRES.
    """
    array = any_array(name, value, wanted)
    if array.dtype.kind not in "iuf":
        raise BadTypeError(f"{name}: got dtype {array.dtype}; wanted real numbers, {wanted}")
    array = array.astype(np.float64)
    if (np.isfinite(array) & (np.abs(array) > MOST_METRES)).any():
        raise BadInputError(f"{name}: wanted numbers of at most {MOST_METRES:g}")
    return array


def shaped(name: str, array: NDArray[Any], shape: tuple[int | None, ...]) -> None:
    """Refuse an array of another shape; None stands for any size.

    Raises:
        BadInputError: naming both shapes.
    """
    if array.ndim != len(shape) or any(
        want is not None and got != want for got, want in zip(array.shape, shape, strict=True)
    ):
        wanted = ", ".join("any" if size is None else str(size) for size in shape)
        raise BadInputError(f"{name} has shape {array.shape}; ({wanted}) was wanted")


def cells(name: str, value: Any, grid_shape: tuple[int, int], shape: Any) -> NDArray[np.int64]:
    """Cells (x, y) of a map in an array whose last axis has two numbers.

    Raises:
        BadTypeError: not whole numbers.
        BadInputError: another shape, or a cell off the map.
    """
    array = whole_numbers(name, value)
    shaped(name, array, (*shape, 2))
    if array.size and ((array < 0) | (array >= grid_shape[::-1])).any():
        high, wide = grid_shape
        raise BadInputError(f"{name} has cells off the map of {wide} x {high} cells")
    return array


def flags(name: str, value: Any, shape: tuple[int | None, ...]) -> NDArray[np.bool_]:
    """An array of truths of a shape; raises like `cells`."""
    array = any_array(name, value, "bool")
    if array.dtype != np.bool_:
        raise BadTypeError(f"{name}: got dtype {array.dtype}; wanted bool")
    shaped(name, array, shape)
    return array


def series(name: str, value: Any) -> NDArray[np.float64]:
    """Finite numbers, float[n]; raises like `numbers`."""
    array = numbers(name, value, "[n]")
    if array.ndim != 1 or not np.isfinite(array).all():
        raise BadInputError(f"{name} has shape {array.shape}; finite numbers [n] were wanted")
    return array


def point(name: str, value: Any) -> NDArray[np.float64]:
    """(x, y) of float[2 or more], the other numbers left out; raises like `series`."""
    array = numbers(name, value, "(x, y)")
    if array.ndim != 1 or len(array) < 2 or not np.isfinite(array[:2]).all():
        raise BadInputError(f"{name} has shape {array.shape}; finite numbers (x, y) were wanted")
    return array[:2]


def whole_numbers(name: str, value: Any) -> NDArray[np.int64]:
    """Whole numbers of 64 bits in an array of any shape.

    Raises:
        BadTypeError: other numbers, or none.
        BadInputError: one is too large, or rows are of unequal length.
    """
    array = any_array(name, value, "whole numbers")
    if array.dtype.kind not in "iu":
        raise BadTypeError(f"{name}: got dtype {array.dtype}; wanted whole numbers")
    if array.size and int(array.max()) >= 2**62:
        raise BadInputError(f"{name}: wanted whole numbers below 2**62")
    return array.astype(np.int64)


def check_chart(grid: GridMap) -> None:
    """Refuse a map that cannot be drawn.

    Raises:
        BadInputError: it lies too far away for the size of its cells, or bears no such name.
    """
    titles(name=grid.name, attribution=grid.attribution)
    check_view("grid_map", grid.extent)
    if grid.cell_size < _FINEST * max(map(abs, grid.extent)):
        raise BadInputError(
            f"grid_map has cells of {grid.cell_size:g} m, too small for where it lies; wanted at "
            f"least {_FINEST:g} of its coordinates"
        )


def check_view(name: str, view: Any) -> tuple[float, float, float, float]:
    """(west, east, south, north), m, of a part of a chart that can be drawn.

    Raises:
        BadTypeError: not numbers.
        BadInputError: not four of them, none between two of them, or too many metres.
    """
    found = numbers(name, view, "(west, east, south, north)")
    wanted = f"{name} is {shown(view)}; (west, east, south, north) in m was wanted"
    if found.shape != (4,) or not np.isfinite(found).all():
        raise BadInputError(wanted)
    west, east, south, north = map(float, found)
    least = max(_FINEST * float(np.abs(found).max()), LEAST_METRES)
    if east - west < least or north - south < least:
        raise BadInputError(f"{wanted}, at least {least:g} m each way")
    return west, east, south, north


def check_table(table: pl.DataFrame, wanted: Mapping[str, str]) -> None:
    """Check that a result table has the columns a figure needs.

    Args:
        table: the table.
        wanted: column name to what it holds, for the message. "condition", "job" and "status" hold
            whole numbers, "method" names, all others numbers.

    Raises:
        BadTypeError: a column holds something else.
        BadInputError: one is missing, or holds nothing somewhere.
    """
    for name, meaning in wanted.items():
        if name not in table.columns:
            found = ", ".join(table.columns) or "none"
            raise BadInputError(f"table has no column {name!r} ({meaning}); it has {found}")
        column = table[name]
        kind, words = column.dtype.is_numeric(), "numbers"
        if name in _WHOLE:
            kind, words = column.dtype.is_integer(), "whole numbers"
        elif name == "method":
            kind, words = column.dtype == pl.String, "names"
        if not kind and not table.is_empty():
            raise BadTypeError(f"table: column {name!r} holds {column.dtype}; wanted {words}")
        if (name in _WHOLE or name == "method") and column.null_count():
            raise BadInputError(f"table: column {name!r} lacks values; wanted {words} in all rows")
        if name == "method":
            _check_names(column)
        elif column.dtype.is_float() and not table.is_empty():
            numbers(f"table: column {name!r}", column.to_numpy(), "[n]")


def _check_names(column: pl.Series) -> None:
    for one in column.unique().to_list():
        text("table: column 'method'", one)


def keys_of(name: str, value: Mapping[Any, Any], conditions: Iterable[int]) -> None:
    """Refuse a dictionary that lacks a condition.

    Raises:
        BadInputError: naming it.
    """
    for condition in conditions:
        if condition not in value:
            raise BadInputError(f"{name} has no condition {condition}, which the table has")


def codes(name: str, value: Any) -> list[int]:
    """A sequence of status codes, at least one.

    Raises:
        BadTypeError: it is none, or one is no whole number.
        BadInputError: it is empty.
    """
    if not isinstance(value, Sequence) or isinstance(value, str | bytes):
        raise BadTypeError(f"{name}: got {shown(value)}; wanted a list of statuses")
    if not value:
        raise BadInputError(f"{name} is empty; at least one status was wanted")
    return [whole_number(f"{name}[{i}]", one, 0) for i, one in enumerate(value)]


def is_setting(value: object) -> bool:
    """Whether a value may be one of a study's settings, as TOML or JSON has it."""
    if isinstance(value, list | tuple):
        return all(map(is_setting, value))
    if isinstance(value, float):
        return not math.isfinite(value) or abs(value) <= MOST_METRES
    if isinstance(value, int):
        return abs(value) < 2**62
    if isinstance(value, str):
        return len(value) <= MOST_LETTERS and not unprintable(value)
    return value is None
