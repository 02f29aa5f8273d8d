"""Which keys stand in which table of a study's file, and what a misplaced one may have meant."""

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from usvjax.checks import shown
from usvjax.errors import BadInputError
from usvjax.suggest import did_you_mean
from usvjax.tables import field_names

Sections = Mapping[str, tuple[str, ...]]
"""By table, the keys that it may hold under some setting."""


@dataclass(frozen=True)
class Table:
    """A table of a study file.

    Attributes:
        about: what it is for; one line.
        kinds: dataclass of its keys, or several whose keys stand together, by what `choice` may
            be; under "" where nothing is chosen. The docstring's "Attributes:" says of every field
            what it means.
        choice: the key that chooses among `kinds`, such as "source", or "".
        default: what is chosen where that key is missing.
        extra: keys that are no field, and what each means.
        without: fields that are no key.
        examples: values of keys that have no default, for a file to begin with.
    """

    about: str
    kinds: Mapping[str, type | tuple[type, ...]]
    choice: str = ""
    default: str = ""
    extra: Mapping[str, str] = field(default_factory=dict)
    without: tuple[str, ...] = ()
    examples: Mapping[str, Any] = field(default_factory=dict)

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys that it may hold under some setting."""
        all_classes = [cls for kind in self.kinds for cls in self.classes(kind)]
        names = (name for name in field_names(*all_classes) if name not in self.without)
        return tuple(dict.fromkeys((*filter(None, (self.choice,)), *self.extra, *names)))

    def classes(self, kind: str) -> tuple[type, ...]:
        """The dataclasses of its keys where this is chosen."""
        found = self.kinds[kind]
        return found if isinstance(found, tuple) else (found,)


def sections_of(tables: Mapping[str, Table]) -> Sections:
    """The keys of some tables."""
    return {name: table.keys for name, table in tables.items()}


def check_top_keys(
    tables: Mapping[str, Any], sections: Sections, known: Iterable[str], where: str
) -> None:
    """Refuse keys outside all sections that are not `known`.

    Raises:
        BadInputError: naming the key and what was likely meant.
    """
    known = list(known)
    for key in tables:
        if key not in known:
            hint = _meant(key, sections, known)
            raise BadInputError(f"{where}: unknown key {shown(key)}; {hint}")


def check_dotted(
    flat: Mapping[str, Any],
    sections: Sections,
    where: str,
    others: Iterable[str] = (),
) -> None:
    """Refuse overrides that are neither section.key nor, by mistake of place, one of `others`.

    Raises:
        BadInputError: naming the key and what was likely meant.
    """
    for key in flat:
        section, _, rest = key.partition(".")
        if section not in sections or not rest or "." in rest:
            hint = _meant(key, sections, others)
            raise BadInputError(f"{where}: {shown(key)} must be section.key; {hint}")


def check_homes(
    settings: Mapping[str, Mapping[str, Any]],
    sections: Sections,
    where: str,
) -> None:
    """Refuse keys that stand in another section than their own; the mission sees to the rest.

    Raises:
        BadInputError: naming the key and its section.
    """
    for section, table in settings.items():
        for key in table:
            homes = _homes(key, sections)
            if homes and key not in sections[section]:
                hint = _at_one_of(homes)
                raise BadInputError(f"{where}: [{section}]: unknown key {shown(key)}; {hint}")


def _homes(name: str, sections: Sections) -> list[str]:
    """Where a key may stand, by dotted key."""
    return [f"{section}.{name}" for section, names in sections.items() if name in names]


def _at_one_of(homes: list[str]) -> str:
    return f"did you mean {' or '.join(map(repr, homes))}?"


def _meant(key: str, sections: Sections, others: Iterable[str]) -> str:
    """Say what an unknown key may have meant: one of `others`, or one of a section, dotted.

    A key that a section has was put in the wrong place, so it comes before any likeness.
    """
    others = list(others)
    section = key.partition(".")[0]
    last = key.rpartition(".")[2]
    if key in _homes(last, sections):
        return "write it without quotation marks"
    names = {name for keys in sections.values() for name in keys} | set(others)
    near = difflib.get_close_matches(last.lower(), sorted(names), n=1, cutoff=0.6)
    for name in (last, *near):
        if homes := _homes(name, sections):
            return _at_one_of(homes)
        if name in others:
            return f"did you mean {name!r}?"
    if section in sections:
        return f"such as {section}.{sections[section][0]}"
    return did_you_mean(section, [*others, *sections])
