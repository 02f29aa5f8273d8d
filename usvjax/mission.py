"""What a kind of study must offer: the contract between the study machinery and a mission.

A workload turns (condition, method, jobs) into one row of numbers per job. It must be a
pure function of those three and the seed: job j's row may not depend on which other jobs
share its call, on the device, or on the order, because a study is cut into shards that
run anywhere and in any order and are resumed at any time.
"""

import importlib
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

import numpy as np

from usvjax.errors import BadInputError
from usvjax.sections import Sections
from usvjax.suggest import did_you_mean

if TYPE_CHECKING:
    from usvjax.study.spec import Condition, StudySpec

Posed = TypeVar("Posed")


@dataclass(frozen=True)
class Metric:
    """One column of results.

    Attributes:
        name: column name.
        unit: SI unit, "" for none.
        label: words for tables and figures.
        integer: stored as int32 rather than float32.
        summarised: whether the summary reports its averages and paired differences, which are
            over successes.
        counted: whether the summary reports its mean over all episodes, however they ended.
    """

    name: str
    unit: str
    label: str
    integer: bool = False
    summarised: bool = True
    counted: bool = False


@dataclass(frozen=True)
class Prepared:
    """One condition, checked and ready to run.

    Attributes:
        settings: every setting in force by section, defaults filled in; JSON-able.
        inputs: SHA-256 of each file that the condition reads, by the name in the study.
        payload: what the workload's own `run` needs; opaque to the study machinery.
        most_jobs: how many episodes there can be, where a file limits them.
        refusals: by method, why it cannot be run under these settings.
    """

    settings: dict[str, dict[str, Any]]
    inputs: dict[str, str]
    payload: Any
    most_jobs: int | None = None
    refusals: Mapping[str, str] = field(default_factory=dict)


class Workload(Protocol):
    """A kind of study.

    Attributes:
        sections: TOML tables that it reads, such as "maps" or "params", and the keys that each
            may hold under some setting; only the hints about unknown keys rest on the latter.
        methods: methods that it can run, in the order of the default table.
        metrics: columns of its results, besides job, condition, method and status.
        endings: the codes that the status column may hold, in the order of the tables.
        success: the code that counts as success.
    """

    sections: Sections
    methods: tuple[str, ...]
    metrics: tuple[Metric, ...]
    endings: tuple[IntEnum, ...]
    success: IntEnum

    def prepare(
        self, settings: Mapping[str, Mapping[str, Any]], folder: Path, where: str
    ) -> Prepared:
        """Check one condition's settings and build what `run` needs.

        Args:
            settings: the TOML tables by section.
            folder: what relative paths in the settings are relative to.
            where: the study file, for messages.

        Returns:
            The condition, ready to run.

        Raises:
            BadInputError: a key or value cannot be used.
            BadTypeError: a value has the wrong type.
        """
        ...

    def run(
        self, spec: "StudySpec", condition: "Condition", method: str, jobs: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Run one method on some jobs of one condition.

        Args:
            spec: the study; only its seed may influence the result.
            condition: one of `spec.conditions`.
            method: one of `spec.methods`.
            jobs: int64[J], job numbers.

        Returns:
            "status" and every metric's name -> array[J], in the order of `jobs`.
        """
        ...


class LastShard(Generic[Posed]):
    """What the methods of a shard share; they follow one another on one thread."""

    def __init__(self) -> None:
        self._last = threading.local()

    def get(self, given: Any, seed: int, jobs: np.ndarray, pose: Callable[[], Posed]) -> Posed:
        """What was posed last on this thread, if for the same; else pose it.

        Args:
            given: the payload of a condition.
            seed: of the study.
            jobs: int64[J].
            pose: draws what the methods share.
        """
        key = (id(given), seed, jobs.tobytes())
        if getattr(self._last, "key", None) != key:
            self._last.posed = pose()
            # The condition is kept as well, so that its id stays its own.
            self._last.key, self._last.given = key, given
        posed: Posed = self._last.posed
        return posed


# Import paths, not classes: a kind is imported when a study asks for it.
_KINDS = {
    "dwa": "usvjax.missions.dwa.mission:DwaWorkload",
    "route": "usvjax.missions.route.mission:RouteWorkload",
    "cruise": "usvjax.missions.cruise.mission:CruiseWorkload",
}


def register_kind(kind: str, path: str) -> None:
    """Make a kind of study known under a name.

    Args:
        kind: the `kind` of a study file.
        path: "package.module:Class", a `Workload` without constructor arguments.
    """
    _KINDS[kind] = path


def get_workload(kind: str, where: str = "the study") -> Workload:
    """Import and build the workload of a kind of study.

    Args:
        kind: the `kind` of a study file.
        where: the study file, for the message.

    Returns:
        The workload.

    Raises:
        BadInputError: no such kind; names the nearest.
    """
    if kind not in _KINDS:
        raise BadInputError(f"{where}: unknown kind {kind!r}; {did_you_mean(kind, _KINDS)}")
    module, _, name = _KINDS[kind].partition(":")
    workload: Workload = getattr(importlib.import_module(module), name)()
    return workload
