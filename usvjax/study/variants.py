"""What varies in a study: `[[conditions]]` one by one, crossed with the values of `[axes]`."""

import itertools
import math
from collections.abc import Iterator, Mapping
from typing import Any

from usvjax.checks import shown
from usvjax.errors import BadInputError, BadTypeError
from usvjax.sections import Sections, check_dotted

MAX_CONDITIONS = 10_000
"""Conditions of a study: each is checked, posed and summarised on its own, in seconds."""


def table_of(tables: Mapping[str, Any], name: str, where: str) -> Mapping[str, Any]:
    """A table of a study file; empty where there is none.

    Raises:
        BadTypeError: the key is something else.
    """
    table = tables.get(name, {})
    if not isinstance(table, Mapping):
        raise BadTypeError(f"{where}: {name!r} must be a table, got {shown(table)}")
    return table


def variants_of(
    tables: Mapping[str, Any], sections: Sections, where: str
) -> Iterator[tuple[str, dict[str, Any], dict[str, Any]]]:
    """Yield (label or "", all dotted overrides, those that its label lacks) of every condition.

    Args:
        tables: the content of a study file.
        sections: keys by table, for hints.
        where: what to call the study in messages.

    Raises:
        BadTypeError: something that must be a table or a list is none.
        BadInputError: a key that no table has, one that varies in both ways, or too many
            combinations.
    """
    axes = _flatten(table_of(tables, "axes", where))
    check_dotted(axes, sections, f"{where}: [axes]")
    for key, values in axes.items():
        if not isinstance(values, list) or not values:
            raise BadTypeError(
                f"{where}: [axes]: {shown(key)} must be a list of values, got {shown(values)}"
            )
    conditions = _listed(tables, sections, where)
    count = len(conditions) * math.prod(map(len, axes.values()))
    if count > MAX_CONDITIONS:
        factors = [*([len(conditions)] if len(conditions) > 1 else []), *map(len, axes.values())]
        raise BadInputError(
            f"{where}: {' x '.join(f'{n:,}' for n in factors)} = {count:,} conditions; wanted at "
            f"most {MAX_CONDITIONS:,}"
        )
    for label, listed in conditions:
        both = sorted(set(listed) & set(axes))
        if both:
            raise BadInputError(f"{where}: {shown(both[0])} is in both [[conditions]] and [axes]")
        for values in itertools.product(*axes.values()):
            crossed = dict(zip(axes, values, strict=True))
            told = {} if label else dict(listed)
            told |= {key: value for key, value in crossed.items() if len(axes[key]) > 1}
            yield label, {**listed, **crossed}, told


def _listed(
    tables: Mapping[str, Any], sections: Sections, where: str
) -> list[tuple[str, dict[str, Any]]]:
    """Read `[[conditions]]`; one empty condition when there is none."""
    listed = tables.get("conditions", [{}])
    if (
        not isinstance(listed, list)
        or not listed
        or not all(isinstance(table, Mapping) for table in listed)
    ):
        raise BadTypeError(
            f"{where}: 'conditions' must be [[conditions]] tables, got {shown(listed)}"
        )
    result = []
    for number, table in enumerate(listed, start=1):
        place = f"{where}: [[conditions]] {number}"
        flat = _flatten(table)
        label = flat.pop("label", "")
        if not isinstance(label, str):
            raise BadTypeError(f"{place}: 'label' must be a string, got {shown(label)}")
        check_dotted(flat, sections, place, ["label"])
        result.append((label, flat))
    return result


def _flatten(table: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Turn nested tables into dotted keys; `"a.b" = 1` and `a.b = 1` become the same."""
    flat: dict[str, Any] = {}
    for key, value in table.items():
        if isinstance(value, Mapping):
            flat.update(_flatten(value, f"{prefix}{key}."))
        else:
            flat[f"{prefix}{key}"] = value
    return flat


def overridden(
    sections: Mapping[str, Mapping[str, Any]], varied: Mapping[str, Any]
) -> dict[str, dict[str, Any]]:
    """The tables with the values of dotted keys put in."""
    settings = {name: dict(table) for name, table in sections.items()}
    for dotted, value in varied.items():
        section, _, key = dotted.partition(".")
        settings[section][key] = value
    return settings


def short_names(keys: set[str]) -> dict[str, str]:
    """Name each dotted key by its last word, in full where two would clash."""
    last = [key.partition(".")[2] for key in keys]
    return {
        key: short if last.count(short) == 1 else key
        for key in keys
        for short in [key.partition(".")[2]]
    }


def label_of(varied: Mapping[str, Any], names: Mapping[str, str]) -> str:
    """Words for a condition: what varies, by its short names."""
    return ", ".join(f"{names[key]} {_show(value)}" for key, value in varied.items())


def _show(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
