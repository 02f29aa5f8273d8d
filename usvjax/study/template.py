"""A study file to begin with: every key of a mission, what it means, and its default."""

import dataclasses
import json
import math
import textwrap
from collections.abc import Iterator
from typing import Any

from usvjax.mission import Mission
from usvjax.sections import Table
from usvjax.study.meanings import meanings_of
from usvjax.study.top import StudyFile

_WIDTH = 98
_EPISODES = 1000


def template(kind: str, mission: Mission, plugin: str | None = None) -> str:
    """A commented study file that runs as it is where no key lacks a default.

    Args:
        kind: of the study.
        mission: of that kind.
        plugin: the file that it is from, if it is a user's own.
    """
    head = {"name": f"my_{kind}", "kind": kind, "episodes": _EPISODES}
    if plugin is not None:
        head["plugin"] = plugin
    lines = [
        f"# A study of kind {kind}. Keys that are commented out show their defaults.",
        "# Run it with: usvjax study FILE; see what it would run with: usvjax check FILE",
    ]
    meanings = meanings_of(StudyFile)
    for field in dataclasses.fields(StudyFile):
        value = head.get(field.name, field.default)
        block = list(_key(field.name, meanings[field.name], value, field.name in head))
        if field.name == "methods":
            said = [f"{name}: {words}" for name, words in mission.methods.items()]
            block[-1:-1] = [f"#   {line}" for words in said for line in _wrapped(words)]
        lines += block
    for name, table in mission.tables.items():
        lines += ["", f"[{name}]", *_comment(table.about), *_table(table)]
    lines += [
        "",
        *_comment(
            "What varies: [axes] lists values whose combinations are all run; [[conditions]], each "
            "with a label, lists combinations one by one."
        ),
        "# [axes]",
        *_some_axis(mission),
    ]
    return "\n".join(lines) + "\n"


def _some_axis(mission: Mission) -> Iterator[str]:
    """An example of what may vary: the first number of the first table."""
    for name, table in mission.tables.items():
        for cls in table.classes(table.default):
            for field in dataclasses.fields(cls):
                if isinstance(field.default, float):
                    yield f"# {name}.{field.name} = {toml([field.default, 2 * field.default])}"
                    return


def _table(table: Table) -> Iterator[str]:
    for key, text in table.extra.items():
        yield from _key(key, text, None, given=False)
    if table.choice:
        others = ", ".join(f'"{kind}"' for kind in table.kinds if kind != table.default)
        yield ""
        yield f'{table.choice} = "{table.default}"  # or {others}'
    for kind in table.kinds:
        classes = table.classes(kind)
        if kind:
            words = (classes[0].__doc__ or "").partition("\n")[0]
            yield from ("", *_comment(f'With {table.choice} = "{kind}": {words}'))
        for cls in classes:
            yield from _fields(cls, table, needed_given=kind == table.default)


def _fields(cls: type, table: Table, needed_given: bool) -> Iterator[str]:
    meanings = meanings_of(cls)
    for field in dataclasses.fields(cls):
        if field.name not in table.without:
            needed = field.default is dataclasses.MISSING
            value = table.examples.get(field.name) if needed else field.default
            yield from _key(field.name, meanings[field.name], value, needed and needed_given)


def _key(name: str, text: str, value: Any, given: bool) -> Iterator[str]:
    """Lines of one key: what it means, and its value, commented out where it is the default."""
    yield ""
    yield from _comment(text)
    if value is None or value == ():
        yield f"# {name} ="
    else:
        yield f"{'' if given else '# '}{name} = {toml(value)}"


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in _wrapped(text)]


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(" ".join(text.split()), _WIDTH)


def toml(value: Any) -> str:
    """A value as TOML writes it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml, value))}]"
    if isinstance(value, float) and not math.isfinite(value):
        return "inf" if value > 0 else "-inf"
    return repr(float(value)) if isinstance(value, float) else str(value)
