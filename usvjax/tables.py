"""Strict reading of TOML tables into dataclasses.

A misspelt key or a value of the wrong type is a user's mistake that must not become a
default silently, so every table of a study goes through `read_table`.
"""

import dataclasses
import types
import typing
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any, TypeVar

from usvjax.checks import shown
from usvjax.errors import BadInputError, BadTypeError, unprintable
from usvjax.suggest import did_you_mean

T = TypeVar("T")

_TOML_NAMES = {bool: "a boolean", int: "an integer", float: "a number", str: "a string"}

MAX_NESTED = 16
"""Tables and lists within one another; the deepest that a study can use is 6."""


def field_names(*classes: type) -> tuple[str, ...]:
    """Names of the fields of some dataclasses, each once."""
    return tuple(dict.fromkeys(f.name for cls in classes for f in dataclasses.fields(cls)))


def check_plain(tables: Mapping[str, Any], where: str) -> None:
    """Refuse numbers, characters and nesting that no setting has, before anything is made of them.

    Raises:
        BadTypeError: a key is no string.
        BadInputError: naming the key.
    """
    level: list[tuple[str, Any]] = list(tables.items())
    for _ in range(MAX_NESTED):
        deeper: list[tuple[str, Any]] = []
        for key, value in level:
            if not isinstance(key, str):
                raise BadTypeError(f"{where}: got the key {shown(key)}; wanted a string")
            if isinstance(value, int) and not -(2**63) <= value < 2**63:
                raise BadInputError(
                    f"{where}: {shown(key)} is too large: a whole number must fit in 64 bits"
                )
            if isinstance(value, str) and (found := unprintable(value)):
                raise BadInputError(
                    f"{where}: {shown(key)} holds the control character {found}; wanted text that "
                    f"can be printed in one line"
                )
            if isinstance(value, Mapping):
                deeper += value.items()
            elif isinstance(value, list | tuple):
                deeper += [(key, item) for item in value]
        level = deeper
    if level:
        raise BadInputError(
            f"{where}: {shown(level[0][0])} is nested too deeply; wanted at most {MAX_NESTED} "
            f"tables or lists within one another"
        )


def check_keys(table: Mapping[str, Any], valid: Iterable[str], where: str) -> None:
    """Refuse keys that nobody reads.

    Args:
        table: a TOML table.
        valid: the keys that are read.
        where: the file and table, for the message.

    Raises:
        BadInputError: on an unknown key, naming the nearest valid one.
    """
    names = list(valid)
    for key in table:
        if key not in names:
            raise BadInputError(f"{where}: unknown key {shown(key)}; {did_you_mean(key, names)}")


def read_table(cls: type[T], table: Mapping[str, Any], where: str) -> T:
    """Build the dataclass `cls` from a TOML table, checking every key and type.

    Args:
        cls: a dataclass whose annotations say which types are accepted.
        table: a TOML table.
        where: the file and table, for the messages.

    Returns:
        An instance of `cls`; missing keys take its defaults.

    Raises:
        BadInputError: on an unknown key or a missing required one.
        BadTypeError: on a value of the wrong type.
    """
    fields = {f.name: f for f in dataclasses.fields(cls)}  # type: ignore[arg-type]
    check_keys(table, fields, where)
    for name, field in fields.items():
        required = (
            field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
        )
        if required and name not in table:
            raise BadInputError(f"{where}: the key {name!r} is missing")
    return cls(**read_values(cls, table, where))


def read_values(cls: type, table: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Convert the values of a TOML table to the types that the fields of `cls` declare.

    Args:
        cls: a dataclass.
        table: a TOML table whose keys are all fields of `cls`.
        where: the file and table, for the messages.

    Returns:
        The converted values: numbers for `float` fields become floats, lists for
        `tuple` fields become tuples.

    Raises:
        BadInputError: on an unknown key.
        BadTypeError: on a value of the wrong type.
    """
    check_keys(table, [f.name for f in dataclasses.fields(cls)], where)
    hints = _hints(cls)
    return {
        name: _convert(value, hints[name], f"{where}: {name!r}") for name, value in table.items()
    }


@cache  # asked once for each condition of a study, of which there may be thousands
def _hints(cls: type) -> dict[str, Any]:
    return typing.get_type_hints(cls)


def _convert(value: Any, hint: Any, what: str) -> Any:
    """Return `value` as `hint` wants it, or raise BadTypeError."""
    for option in _options(hint):
        if option is float and _is_number(value):
            return float(value)
        if option in (int, str, bool) and type(value) is option:
            return value
        if typing.get_origin(option) is tuple and isinstance(value, list):
            return _convert_list(value, typing.get_args(option), what)
    raise BadTypeError(f"{what} must be {_describe(hint)}, got {shown(value)}")


def _convert_list(values: list[Any], items: tuple[Any, ...], what: str) -> tuple[Any, ...]:
    if len(items) == 2 and items[1] is Ellipsis:
        items = (items[0],) * len(values)
    if len(values) != len(items):
        raise BadTypeError(f"{what} must be a list of {len(items)} values, got {shown(values)}")
    return tuple(
        _convert(v, hint, f"{what}[{i}]")
        for i, (v, hint) in enumerate(zip(values, items, strict=True))
    )


def _options(hint: Any) -> tuple[Any, ...]:
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        return typing.get_args(hint)
    return (hint,)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _describe(hint: Any) -> str:
    names = []
    for option in _options(hint):
        if option in _TOML_NAMES:
            names.append(_TOML_NAMES[option])
        elif typing.get_origin(option) is tuple:
            names.append(f"a list, each {_describe(typing.get_args(option)[0])}")
    return " or ".join(names)
