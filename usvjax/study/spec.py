"""What a study is: the TOML file, checked and resolved into conditions.

A study file has top-level keys (`StudyFile`), the tables of its mission, and what varies:
`[[conditions]]` lists combinations one by one, `[axes]` lists values whose cross product is taken.
Both may be given; then every listed combination is crossed with the axes.
"""

import math
import pickle
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import Any

from usvjax.checks import file_path, shown
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps.disk import noting_reads, read_text
from usvjax.mission import Case, Files, Mission, check_mission
from usvjax.public import public
from usvjax.registry import find_mission, mission_kinds
from usvjax.sections import (
    check_homes,
    check_top_keys,
    sections_of,
)
from usvjax.study.held import NOTHING, Held, Source, words_of
from usvjax.study.manifest import hash_of
from usvjax.study.plugin import Plugin, read_plugin
from usvjax.study.shards import Layout
from usvjax.study.top import StudyFile, check_shards, check_top
from usvjax.study.variants import label_of, overridden, short_names, table_of, variants_of
from usvjax.tables import MAX_NESTED, check_plain, read_table

_MOST_OF_ERROR = 200
"""Characters of what the parser says: it quotes what it read."""


@dataclass(frozen=True)
class Condition:
    """One setting of everything that varies.

    Attributes:
        index: place in the study, from 0.
        label: short words for tables and figures.
        varied: what distinguishes it, by dotted key such as "params.radius".
        case: its settings, checked and ready to be posed.
    """

    index: int
    label: str
    varied: dict[str, Any]
    case: Case


@dataclass(frozen=True)
class StudySpec:
    """A study, checked and resolved; every field decides the results.

    Attributes:
        name, kind, seed, episodes, shard, until, confidence: see `StudyFile`.
        methods: what is compared, the baseline among them.
        baseline: what paired differences are taken against.
        conditions: the settings to run, in order.
        mission: runs the episodes.
        plugin: where the mission is from, if it is a user's own.
        held: the files that it reads, for its run to hold.
    """

    name: str
    kind: str
    seed: int
    episodes: int
    shard: int
    methods: tuple[str, ...]
    baseline: str
    until: float | None
    confidence: float
    conditions: tuple[Condition, ...]
    mission: Mission = field(repr=False, compare=False)
    plugin: Plugin | None = field(default=None, repr=False, compare=False)
    held: Held = field(default=NOTHING, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Check it anew: `dataclasses.replace` makes specs as well."""
        where = type(self).__name__
        for name, kind, words in (
            ("kind", str, "a string"),
            ("plugin", Plugin | None, "a Plugin or None"),
            ("held", Held, "a Held"),
        ):
            if not isinstance(value := getattr(self, name), kind):
                raise BadTypeError(f"{where}: {name!r} is {shown(value)}; wanted {words}")
        check_mission(self.mission, f"{where}: 'mission'")
        given = {f.name: getattr(self, f.name) for f in fields(StudyFile) if f.name != "plugin"}
        if self.until is None:
            del given["until"]
        if isinstance(self.methods, tuple):
            given["methods"] = list(self.methods)
        check_plain(given, where)
        top = read_table(StudyFile, given, where)
        methods, baseline = check_top(top, self.mission, where)
        if not (isinstance(self.conditions, tuple) and self.conditions) or not all(
            isinstance(one, Condition) for one in self.conditions
        ):
            raise BadTypeError(
                f"{where}: 'conditions' is {shown(self.conditions)}; wanted a tuple of Condition"
            )
        check_shards(top, len(self.conditions), where)
        _check_conditions(top, methods, self.conditions, where)
        for name, value in {**vars(top), "methods": methods, "baseline": baseline}.items():
            if name in given:
                object.__setattr__(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        """Take the plug-in's source along: in another process its classes are not known yet."""
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return _unpacked, (self.plugin, pickle.dumps(values))

    def canonical(self) -> dict[str, Any]:
        """Everything that decides the results, as JSON-able values with defaults filled in."""
        own = {} if self.plugin is None else {"plugin": self.plugin.name}
        return own | {
            "name": self.name,
            "kind": self.kind,
            "seed": self.seed,
            "episodes": self.episodes,
            "shard": self.shard,
            "methods": list(self.methods),
            "baseline": self.baseline,
            "until": self.until,
            "confidence": self.confidence,
            "conditions": [
                {
                    "label": c.label,
                    "varied": plain(c.varied),
                    "settings": plain(c.case.settings),
                    "inputs": c.case.inputs,
                }
                for c in self.conditions
            ],
        }

    @property
    def layout(self) -> Layout:
        """Which shards it has, and which rows each holds."""
        return Layout(self.episodes, self.shard, len(self.conditions), self.methods)

    @cached_property
    def hash(self) -> str:
        """SHA-256 of the canonical JSON, 64 hexadecimal digits."""
        return hash_of(self.canonical())


@public()
def load_spec(path: str | Path) -> StudySpec:
    """Read a study file.

    Args:
        path: a TOML file; relative paths inside it are relative to its folder.

    Returns:
        The study, ready to run.

    Raises:
        BadInputError: the file cannot be read, or a key or value cannot be used.
        BadTypeError: a value has the wrong type.
    """
    path = file_path("path", path)
    text = read_text(path)
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise BadInputError(f"{path} is not valid TOML: {str(error)[:_MOST_OF_ERROR]}") from error
    except RecursionError as error:
        raise BadInputError(
            f"{path} is nested too deeply; wanted at most {MAX_NESTED} tables or lists within "
            f"one another"
        ) from error
    except ValueError as error:
        # Python reads no decimal whole number of more than some thousands of digits.
        raise BadInputError(
            f"{path} holds a whole number of thousands of digits; wanted ones of 64 bits at most"
        ) from error
    return parse_spec(tables, folder=path.parent, where=str(path))


@public()
def parse_spec(
    tables: Mapping[str, Any], *, folder: str | Path | None = None, where: str = "the study"
) -> StudySpec:
    """Check a study given as nested dictionaries, as `tomllib` returns them.

    Args:
        tables: the content of a study file.
        folder: what relative paths are relative to; the working directory when None.
        where: what to call the study in messages.

    Returns:
        The study, ready to run.

    Raises:
        BadInputError: an unknown key (the nearest valid one is named) or an unusable value.
        BadTypeError: a value has the wrong type.
    """
    check_plain(tables, where)
    kind = tables.get("kind", mission_kinds()[0])
    files = Files(Path() if folder is None else file_path("folder", folder), where)
    plugin = _plugin(tables, files)
    if not isinstance(kind, str):
        raise BadTypeError(f"{where}: 'kind' must be a string, got {shown(kind)}")
    mission = find_mission(kind, where)
    sections = sections_of(mission.tables)
    top_names = list(StudyFile.__dataclass_fields__)
    check_top_keys(tables, sections, [*top_names, *sections, "axes", "conditions"], where)
    top = read_table(StudyFile, {k: v for k, v in tables.items() if k in top_names}, where)
    methods, baseline = check_top(top, mission, where)
    given = {name: table_of(tables, name, where) for name in sections}
    variants = list(variants_of(tables, sections, where))
    check_shards(top, len(variants), where)
    names = short_names({key for _, varied, _ in variants for key in varied})
    conditions = []
    read: dict[Path, str] = {}
    for index, (title, varied, told) in enumerate(variants):
        settings = overridden(given, varied)
        check_homes(settings, sections, where)
        with noting_reads() as noted:
            case = mission.case(settings, files)
        read |= noted
        label = ", ".join(filter(None, (title, label_of(told, names)))) or top.name
        conditions.append(Condition(index, label, varied, case))
    _check_conditions(top, methods, conditions, where)
    return StudySpec(
        name=top.name,
        kind=kind,
        seed=top.seed,
        episodes=top.episodes,
        shard=top.shard,
        methods=methods,
        baseline=baseline,
        until=top.until,
        confidence=top.confidence,
        conditions=tuple(conditions),
        mission=mission,
        plugin=plugin,
        held=_held(files.folder, read, plugin, conditions),
    )


def _held(
    folder: Path, read: Mapping[Path, str], plugin: Plugin | None, conditions: Iterable[Condition]
) -> Held:
    """What a run must hold: files that were read, and a plug-in with what it imports."""
    sources = [Source(path, path, digest) for path, digest in read.items()]
    words = [word for condition in conditions for word in words_of(condition.case.settings)]
    if plugin is not None:
        words.append(plugin.name)
        for name, digest in plugin.beside.items():
            path = plugin.path.parent / name
            own = folder / plugin.name
            place = own if path == plugin.path else own.parent / name
            sources.append(Source(place, path, digest))
    return Held.of(folder, sources, words)


def _unpacked(plugin: Plugin | None, values: bytes) -> StudySpec:
    """A study from another process."""
    if plugin is not None:
        plugin.load()
    return StudySpec(**pickle.loads(values))


def _plugin(tables: Mapping[str, Any], files: Files) -> Plugin | None:
    """Load the plug-in of a study, if it has one."""
    name = tables.get("plugin")
    if name is None:
        return None
    if not isinstance(name, str):
        raise BadTypeError(f"{files.where}: 'plugin' must be a string, got {shown(name)}")
    plugin = read_plugin(name, files.folder, files.where)
    plugin.load(files.where)
    return plugin


def plain(value: Any) -> Any:
    """Make settings JSON-able: tuples become lists, infinities and NaN become strings."""
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value


def _check_conditions(
    top: StudyFile, methods: Iterable[str], conditions: Iterable[Condition], where: str
) -> None:
    """Check whether every condition has so many episodes and takes all methods."""
    for case in (condition.case for condition in conditions):
        if case.most_jobs is not None and top.episodes > case.most_jobs:
            raise BadInputError(
                f"{where}: 'episodes' must be at most {case.most_jobs}, as many different ones as "
                f"'maps' gives, got {top.episodes}"
            )
        for method in methods:
            if method in case.refusals:
                raise BadInputError(f"{where}: method {method!r}: {case.refusals[method]}")
