"""Reading `[maps]` tables of studies, and checks of the numbers in them."""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Generic, TypeVar

from usvjax.checks import shown
from usvjax.errors import BadInputError, BadTypeError
from usvjax.sections import Table
from usvjax.suggest import did_you_mean
from usvjax.tables import read_table

S = TypeVar("S")


@dataclass(frozen=True)
class Opened(Generic[S]):
    """What a `[maps]` table asks for, with its files read.

    Attributes:
        options: dataclass of the options in force.
        source: draws the scenes.
        inputs: SHA-256 of what was read, by the name that the options give it.
    """

    options: Any
    source: S
    inputs: dict[str, str] = field(default_factory=dict)


def read_maps(
    given: Mapping[str, Any],
    table: Table,
    opened: Callable[[Any, Path, str], Opened[S]],
    folder: Path,
    where: str,
    kept: dict[Any, Opened[Any]],
) -> tuple[dict[str, Any], S, dict[str, str]]:
    """Read a `[maps]` table: the source that it names and the options that go with it.

    Args:
        given: the TOML table.
        table: what it may hold, by "source".
        opened: from options, `folder` and `where` to what they ask for.
        folder: what a relative path is relative to.
        where: the study file and table, for the messages.
        kept: what conditions before asked for, by their options, and this one will be put in: of
            a study with hundreds a map is read once, and they share what is found out about it.

    Returns:
        All keys of the table as they are in force, the source, and the digests of its inputs.

    Raises:
        BadInputError: no such source, or a key or value that it cannot use.
        BadTypeError: a value of the wrong type.
    """
    name = given.get("source", table.default)
    if not isinstance(name, str):
        raise BadTypeError(f"{where}: 'source' must be a string, got {shown(name)}")
    if name not in table.kinds:
        raise BadInputError(
            f"{where}: unknown source {shown(name)}; {did_you_mean(name, table.kinds)}"
        )
    (kind,) = table.classes(name)
    options: Any = read_table(kind, {k: v for k, v in given.items() if k != "source"}, where)
    found: Opened[S] | None = kept.get(options)
    if found is None:
        found = kept[options] = opened(options, folder, where)
    return {"source": name, **asdict(found.options)}, found.source, found.inputs


def check_share(name: str, value: float, where: str) -> None:
    """Raise BadInputError unless a share lies in [0, 1]."""
    if not 0.0 <= value <= 1.0:
        raise BadInputError(f"{where}: {name!r} must lie in [0, 1], got {value:g}")


def check_length(name: str, value: float, where: str) -> None:
    """Raise BadInputError unless a length (m) is 0 or more, and finite."""
    if not 0.0 <= value < math.inf:
        raise BadInputError(f"{where}: {name!r} must be 0 or more, got {value:g}")
