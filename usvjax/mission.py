"""What a mission is: the contract between missions and the engines.

A mission turns a study's tables into cases, draws the scenes of some jobs, runs a method on
them, and draws what came out. Studies, resuming, replays, animations and exports know a mission
by this contract only, and no mission by name. `pose` and `run` must be pure: job j's scene and
row may not depend on which other jobs share the call, on the device, or on the order, because
a study is cut into shards that run anywhere, in any order, and are resumed at any time. Whatever
a method returns or is given crosses to other processes, so it must pickle.
"""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from pathlib import Path
from typing import Any, Protocol, cast

import numpy as np

from usvjax.checks import shown
from usvjax.errors import BadInputError, unprintable
from usvjax.maps import GridMap
from usvjax.maps.disk import read_bytes
from usvjax.sections import Table

MOST_CONDITIONS = 12
"""Of a study, which figures and a terminal show one by one: of more, one figure shows the success
rate of all, and a terminal the ends of their ranking."""


@dataclass(frozen=True)
class Metric:
    """One column of results.

    Attributes:
        name: column name.
        unit: SI unit, "" for none, or "%" of a share from 0 to 100.
        label: words for tables and figures.
        integer: stored as int32 rather than float32.
        summarised: whether the summary reports its averages and paired differences, which are
            over successes.
        counted: whether the summary reports its mean over all episodes, however they ended.
        share: whether it is a share from 0 to 1; like one in "%", it changes by percentage points.
    """

    name: str
    unit: str
    label: str
    integer: bool = False
    summarised: bool = True
    counted: bool = False
    share: bool = False

    @property
    def points(self) -> float | None:
        """Percentage points in one unit of a share; None for what is no share."""
        return 1.0 if self.unit == "%" else 100.0 if self.share else None


@dataclass(frozen=True)
class Files:
    """Where the tables of a study come from.

    Attributes:
        folder: what relative paths in them are relative to.
        where: the study file, for messages.
        kept: what the conditions before have read of them, for those after.
    """

    folder: Path = field(default_factory=Path)
    where: str = "the study"
    kept: dict[Any, Any] = field(default_factory=dict, repr=False, compare=False)

    def table(self, name: str) -> str:
        """What messages call a table."""
        return f"{self.where}: [{name}]"

    def read(self, name: str) -> bytes:
        """The content of a file that a table names, of which the run will hold a copy.

        A digest of it belongs into `Case.inputs`: without, a run is continued with a changed file.

        Raises:
            BadInputError: it cannot be read.
        """
        return read_bytes(self.folder / name)


@dataclass(frozen=True)
class Case:
    """One condition, checked and ready to be posed.

    Attributes:
        settings: every setting in force by table, defaults filled in; JSON-able.
        inputs: SHA-256 of each file that the condition reads, by the name in the study.
        given: what the mission's own `pose` needs; opaque to the engines.
        most_jobs: how many different episodes there are, where that is limited.
        refusals: by method, why it cannot be run under these settings.
    """

    settings: dict[str, dict[str, Any]]
    inputs: dict[str, str]
    given: Any = field(repr=False, compare=False)
    most_jobs: int | None = None
    refusals: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Ground:
    """Where an episode took place.

    Attributes:
        grid: the map, or None.
        circles: float64[K, 2], centres of round obstacles, m.
        radius: of the circles, m.
        marks: places to mark by what they are, float64[N, 2] each, m.
    """

    grid: GridMap | None
    circles: np.ndarray
    radius: float
    marks: Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Track:
    """Where the vessels of an episode were.

    Attributes:
        along: float64[T], when, never falling.
        unit: of `along`: "s", or "m" of a way that nobody sails yet.
        places: float64[T, n, 2], x, y of each vessel, m.
    """

    along: np.ndarray
    unit: str
    places: np.ndarray


@dataclass(frozen=True)
class Recording:
    """What a replay needs of some jobs, in their order.

    Attributes:
        grounds: where each took place.
        tracks: where its vessels were.
        detail: what the mission's own figures need besides; opaque to the engines.
    """

    grounds: tuple[Ground, ...]
    tracks: tuple[Track, ...]
    detail: Any


@dataclass(frozen=True)
class Outcome:
    """What became of some jobs.

    Attributes:
        columns: "status" and every metric's name -> array[J], in the order of the jobs.
        recording: where it was asked for.
    """

    columns: Mapping[str, np.ndarray]
    recording: Recording | None = None


@dataclass(frozen=True)
class Replayed:
    """Episodes of a run, had back.

    Attributes:
        label: condition and method in words.
        jobs: int64[J].
        method: of the mission.
        case: the condition.
        scene: what `pose` made of it.
        columns: as in `Outcome`.
        recording: what was recorded.
    """

    label: str
    jobs: np.ndarray
    method: str
    case: Case
    scene: Any
    columns: Mapping[str, np.ndarray]
    recording: Recording


class Replay(Protocol):
    """Has episodes of a run back; given to `Mission.figures`."""

    @property
    def table(self) -> Any:
        """All rows of the run, which are read and checked once."""
        ...

    @property
    def examples(self) -> int:
        """Conditions, from the first, of which episodes may be had back."""
        ...

    @property
    def most(self) -> int:
        """Episodes that one figure may show."""
        ...

    def __call__(self, condition: int, method: str, jobs: Sequence[int]) -> Replayed:
        """Run episodes again, recording them.

        Raises:
            BadInputError: a file is missing or has changed, or an episode went otherwise than
                the run says.
        """
        ...

    def example(self, condition: int) -> tuple[int, str]:
        """The episode that stands for a condition, and why; see `Mission.example`."""
        ...


class Mission(Protocol):
    """A mission, which is what a study calls its kind.

    Attributes:
        tables: tables of a study file by name, beside those that every study has.
        methods: what can be compared, with words for each; in the order of the default table.
        metrics: columns of its results, besides job, condition, method and status.
        endings: the codes that the status column may hold, in the order of the tables; the
            first is success.
    """

    tables: Mapping[str, Table]
    methods: Mapping[str, str]
    metrics: tuple[Metric, ...]
    endings: tuple[IntEnum, ...]

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        """Check one condition.

        Args:
            tables: of the study file, by name; empty where the file has none.
            files: where they come from.

        Raises:
            BadInputError: a key or value cannot be used.
            BadTypeError: a value has the wrong type.
        """
        ...

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> Any:
        """Draw the scenes that all methods meet; a pure function of each job.

        Args:
            case: of this mission.
            seed: of the study.
            jobs: int64[J], job numbers.

        Returns:
            The scenes, for `run`; opaque to the engines.
        """
        ...

    def run(self, scene: Any, method: str, record: bool = False) -> Outcome:
        """Run one method.

        Args:
            scene: what `pose` returned. It may keep there what other methods will want as well,
                so long as nothing that comes out depends on it.
            method: one of `methods`.
            record: whether a recording is wanted.
        """
        ...

    def example(self, rows: Any, methods: list[str]) -> tuple[int, str]:
        """Choose the episode that stands for a condition, by a rule rather than by eye.

        Args:
            rows: polars.DataFrame, all rows of the condition.
            methods: of the run, the baseline first.

        Returns:
            The job, and why it was chosen.
        """
        ...

    def figures(self, run: Any, replay: Replay) -> Iterator[tuple[str, Any]]:
        """Draw a run; matplotlib is loaded here and not before.

        Args:
            run: `usvjax.study.Run`.
            replay: has episodes of it back.

        Yields:
            Name of a file without suffix, and a matplotlib Figure or a polars.DataFrame; the
            cheap ones first.
        """
        ...

    def film(self, replayed: Replayed, row: int) -> Any:
        """One of the episodes as `usvjax.plots.film.Film`."""
        ...


@dataclass(frozen=True)
class Kin:
    """Which cases can share a call.

    Attributes:
        key: cases with equal keys can.
        most: episodes in a call, beyond which it is no faster or takes too much memory.
    """

    key: Hashable
    most: int


class Joining(Mission, Protocol):
    """A mission that runs the scenes of several conditions in one call, as many lanes want.

    A row must be the same bits joined as alone. A class that derives from a joining one and brings
    a `pose` or a `run` of its own joins no more, unless it brings a `join` as well.
    """

    def kin(self, case: Case) -> Kin | None:
        """Which others the case can share a call with; None if it cannot be joined."""
        ...

    def join(self, scenes: Sequence[Any], cases: Sequence[Case]) -> Any:
        """One scene of several, whose rows follow each other in their order.

        Args:
            scenes: what `pose` returned, of `cases`; their episodes together are at most `most`.
            cases: all of the study that are of this kin, for one program to do for all calls.
        """
        ...


def joining(mission: Mission) -> Joining | None:
    """The mission, if it joins scenes."""
    for kind in type(mission).__mro__:
        if {"pose", "run", "join"} & vars(kind).keys():
            return cast(Joining, mission) if "join" in vars(kind) else None
    return None


_NAMES = [name for name in (*Mission.__annotations__, *vars(Mission)) if not name.startswith("_")]

_DATA: Mapping[str, tuple[type, type, str]] = {
    "tables": (Mapping, Table, "a dictionary of usvjax.sections.Table"),
    "methods": (Mapping, str, "a dictionary of words"),
    "metrics": (Sequence, Metric, "a tuple of usvjax.mission.Metric"),
    "endings": (Sequence, IntEnum, "a tuple of codes that are an IntEnum"),
}
"""Attributes of a mission: what they are, what they hold, and words for both."""


def check_mission(mission: Any, what: str) -> None:
    """Refuse what keeps no mission's contract, as far as that shows before it runs.

    Args:
        mission: what is to be one.
        what: it is called, for the message.

    Raises:
        BadInputError: naming what is missing or wrong.
    """
    missing = [name for name in _NAMES if not hasattr(mission, name)]
    if missing:
        raise BadInputError(f"{what} has no {missing[0]!r}; see usvjax.mission.Mission")
    if isinstance(mission, type):
        raise BadInputError(f"{what} is a class; wanted one of it, {mission.__name__}()")
    for name, (group, each, words) in _DATA.items():
        found = getattr(mission, name)
        items = found.values() if isinstance(found, Mapping) else found
        if not isinstance(found, group) or not all(isinstance(one, each) for one in items):
            raise BadInputError(f"{what}: {name!r} must be {words}, got {shown(found)}")
        if name != "tables" and not found:
            raise BadInputError(f"{what}: {name!r} is empty")
    for name in _NAMES:
        if name not in _DATA and not callable(getattr(mission, name)):
            raise BadInputError(f"{what}: {name!r} must be a method")
    metrics = [word for m in mission.metrics for word in (m.name, m.unit, m.label)]
    for word in (*mission.tables, *mission.methods, *mission.methods.values(), *metrics):
        if not isinstance(word, str) or unprintable(word):
            raise BadInputError(
                f"{what} has the name {shown(word)}; wanted text that can be printed in one line"
            )
