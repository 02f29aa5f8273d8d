"""What the keys of a study's tables mean, and their units, from the docstrings of their classes."""

import dataclasses
import inspect
import re
from collections.abc import Mapping

from usvjax.errors import BadInputError
from usvjax.sections import Table

_ENTRY = re.compile(r" {4}(\w+(?:, \w+)*): (.*)")
_UNIT = re.compile(r"(?:, |\()((?:m|rad)(?:/s(?:\^2)?)?|s)(?=[;:,.)]|$)")


def meanings_of(cls: type) -> dict[str, str]:
    """What the docstring of a dataclass, or of one it derives from, says of each of its fields.

    Raises:
        BadInputError: it says nothing of a field; names the field.
    """
    found: dict[str, str] = {}
    for kind in reversed(cls.__mro__):
        found |= _entries(kind)
    missing = [f.name for f in dataclasses.fields(cls) if f.name not in found]
    if missing:
        raise BadInputError(
            f"{cls.__name__}: its docstring says nothing of {missing[0]!r}; wanted an entry "
            f"under 'Attributes:'"
        )
    return found


def _entries(kind: type) -> dict[str, str]:
    """What stands under "Attributes:" in the docstring of a class itself."""
    _, _, attributes = inspect.cleandoc(kind.__doc__ or "").partition("Attributes:\n")
    found: dict[str, str] = {}
    names: list[str] = []
    for line in attributes.splitlines():
        if match := _ENTRY.fullmatch(line):
            names = match[1].split(", ")
            found.update(dict.fromkeys(names, match[2]))
        elif line.startswith(" "):
            found.update({name: f"{found[name]} {line.strip()}" for name in names})
        elif line:  # another paragraph
            break
    return found


def units_of(tables: Mapping[str, Table]) -> dict[str, str]:
    """Units of the keys that have one, by dotted key such as "params.radius"."""
    found = {}
    for name, table in tables.items():
        for kind in table.kinds:
            for cls in table.classes(kind):
                for key, meaning in meanings_of(cls).items():
                    if unit := _UNIT.search(meaning):
                        found[f"{name}.{key}"] = unit[1]
    return found
