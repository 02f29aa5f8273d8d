"""Reading `[maps]` tables of studies, and checks of the numbers in them."""

import math
from collections.abc import Mapping
from typing import Any, TypeVar

from usvjax.errors import BadInputError, BadTypeError
from usvjax.suggest import did_you_mean
from usvjax.tables import read_table

T = TypeVar("T")


def read_source(
    table: Mapping[str, Any], sources: Mapping[str, type[T]], default: str, where: str
) -> tuple[str, T]:
    """Read the `source` of a `[maps]` table and the options that go with it.

    Args:
        table: the TOML table.
        sources: name of a source to its dataclass of options.
        default: the source where none is named.
        where: the study file and table, for the messages.

    Returns:
        The source's name and its options.

    Raises:
        BadInputError: no such source, or a key or value that it cannot use.
        BadTypeError: a value of the wrong type.
    """
    name = table.get("source", default)
    if not isinstance(name, str):
        raise BadTypeError(f"{where}: 'source' must be a string, got {name!r}")
    if name not in sources:
        raise BadInputError(f"{where}: unknown source {name!r}; {did_you_mean(name, sources)}")
    rest = {k: v for k, v in table.items() if k != "source"}
    return name, read_table(sources[name], rest, where)


def check_share(name: str, value: float, where: str) -> None:
    """Raise BadInputError unless a share lies in [0, 1]."""
    if not 0.0 <= value <= 1.0:
        raise BadInputError(f"{where}: {name!r} must lie in [0, 1], got {value:g}")


def check_length(name: str, value: float, where: str) -> None:
    """Raise BadInputError unless a length (m) is 0 or more, and finite."""
    if not 0.0 <= value < math.inf:
        raise BadInputError(f"{where}: {name!r} must be 0 or more, got {value:g}")
