"""Episodes of a run, run again and recorded.

A run keeps one row per episode and no trajectory. Job j's scene and result depend on the study
alone, so the very episode of a row can be had back at any time; whether it really is the same
one is checked against the row.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from usvjax.ambient import pinned
from usvjax.errors import BadInputError
from usvjax.mission import Case, Files, Metric, Mission, Replayed
from usvjax.registry import find_mission
from usvjax.study.code import code_digest
from usvjax.study.held import are_beside, held_folder, with_relative_names
from usvjax.study.plugin import Plugin, read_plugin
from usvjax.study.reader import Run

ROUNDING = 1e-4
"""By which numbers of a recorded episode may differ: its program rounds in another order."""


@dataclass(frozen=True)
class Replay:
    """Has episodes of a run back; see `usvjax.mission.Replay`.

    Attributes:
        run: the run.
        folder: of the study; where it has all files that the study names, they are read there, and
            refused where they have changed; else the copies that the run holds are read.
        examples: conditions, from the first, of which figures may have episodes back.
        most: episodes that one figure may show.
    """

    run: Run
    folder: Path = field(default_factory=Path)
    examples: int = 4
    most: int = 200

    @cached_property
    def table(self) -> pl.DataFrame:
        """All rows of the run."""
        return self.run.table()

    @cached_property
    def files(self) -> Path:
        """What the files that the study names are relative to."""
        held = self.run.manifest["files"]
        return self.folder if are_beside(self.folder, held) else held_folder(self.run.path, held)

    @cached_property
    def plugin(self) -> Plugin | None:
        """That of the study, if it has one."""
        return plugin_of(self.run, self.files)

    @cached_property
    def mission(self) -> Mission:
        """Of the run; a plug-in is loaded."""
        return mission_of(self.run, self.plugin)

    @pinned()
    def __call__(self, condition: int, method: str, jobs: Sequence[int]) -> Replayed:
        """Run episodes again, recording them.

        Args:
            condition: its index.
            method: one of the run's.
            jobs: numbers of the episodes, at least one.

        Returns:
            The episodes, in the order of `jobs`.

        Raises:
            BadInputError: there is no such condition, method or episode, a file is missing or
                has changed, or the episodes go otherwise than the table says, because the run
                was made with another version or kind of device.
        """
        run = self.run
        rows = rows_of(run, self.table, condition, method, jobs)
        numbers = np.asarray(jobs, np.int64)
        case, scene = self._posed(condition, numbers)
        outcome = self.mission.run(scene, method, record=True)
        assert outcome.recording is not None
        _check_same(run, rows, outcome.columns, numbers, self.mission.metrics)
        label = f"{run.labels[condition]}, {method}"
        return Replayed(label, numbers, method, case, scene, outcome.columns, outcome.recording)

    def example(self, condition: int) -> tuple[int, str]:
        """The episode that stands for a condition, and why; job 0 where it has no rows yet."""
        mine = self.table.filter(pl.col("condition") == condition)
        if mine.is_empty():
            return 0, "the first"
        return self.mission.example(mine, self.run.methods)

    def _posed(self, condition: int, jobs: np.ndarray) -> tuple[Case, Any]:
        """The case and the scenes; those of the last call again, for another method."""
        key = (condition, jobs.tobytes())
        if self._last.get("key") != key:
            case = case_of(self.run, condition, self.mission, self.files)
            seed = int(self.run.manifest["study"]["seed"])
            self._last.update(key=key, posed=(case, self.mission.pose(case, seed, jobs)))
        posed: tuple[Case, Any] = self._last["posed"]
        return posed

    @cached_property
    def _last(self) -> dict[str, Any]:
        return {}


def plugin_of(run: Run, folder: Path) -> Plugin | None:
    """The plug-in of a run, if it has one.

    Args:
        run: the run.
        folder: what the study's plug-in is relative to.

    Raises:
        BadInputError: it cannot be read.
    """
    name = run.manifest["study"].get("plugin")
    if name is None:
        return None
    return read_plugin(run.manifest["files"]["moved"].get(name, name), folder, str(run.path))


def mission_of(run: Run, plugin: Plugin | None) -> Mission:
    """The mission of a run.

    Args:
        run: the run.
        plugin: that of its study, if it has one.

    Raises:
        BadInputError: there is no such mission, or its plug-in cannot be loaded or has changed.
    """
    kind = run.manifest["study"]["kind"]
    if plugin is None:
        return find_mission(kind, str(run.path))
    plugin.load(str(run.path))
    mission = find_mission(kind, str(run.path))
    # Rows may be the same where episodes are not: one that times out says little of its way.
    if code_digest(mission, plugin.path) != run.manifest["code"]:
        raise BadInputError(
            f"{run.path} was made with another {plugin.path.name} than that in "
            f"{plugin.path.parent}; bring that one back, or run the study under another name"
        )
    return mission


def rows_of(
    run: Run, table: pl.DataFrame, condition: int, method: str, jobs: Sequence[int]
) -> pl.DataFrame:
    """Return the rows of some episodes.

    Args:
        run: the run.
        table: its rows, as `run.table()`.
        condition: index of the condition.
        method: one of the run's methods.
        jobs: numbers of the episodes.

    Returns:
        Their rows, in the order of `jobs`.

    Raises:
        BadInputError: there is no such condition, method or episode.
    """
    if not 0 <= condition < len(run.settings):
        last = len(run.settings) - 1
        raise BadInputError(f"condition is {condition}; 0 to {last} was wanted in {run.path}")
    if method not in run.methods:
        known = ", ".join(run.methods)
        raise BadInputError(f"method is {method!r}; one of {known} was wanted in {run.path}")
    mine = table.filter((pl.col("condition") == condition) & (pl.col("method") == method))
    wanted = pl.DataFrame({"job": list(jobs)}, schema={"job": mine.schema["job"]})
    found = wanted.join(mine, on="job", how="left", maintain_order="left")
    missing = found.filter(pl.col("status").is_null())["job"].to_list()
    if missing:
        raise BadInputError(
            f"episode {missing[0]} is not in {run.path}; condition {condition} has "
            f"{len(mine):,} of them, from 0"
        )
    return found


def case_of(run: Run, condition: int, mission: Mission, folder: Path) -> Case:
    """Build a condition again from the settings in the manifest.

    Args:
        run: the run.
        condition: index of the condition.
        mission: of the run.
        folder: what files named by the study are relative to.

    Raises:
        BadInputError: a file is missing or has changed.
    """
    moved = run.manifest["files"]["moved"]
    settings = with_relative_names(_given(run.settings[condition]), moved)
    tables = {name: settings.get(name, {}) for name in mission.tables}
    case = mission.case(tables, Files(folder, str(run.path)))
    inputs = run.manifest["study"]["conditions"][condition]["inputs"]
    if case.inputs != {moved.get(name, name): mark for name, mark in inputs.items()}:
        names = ", ".join(inputs)
        raise BadInputError(f"{names} is not what {run.path} was made with")
    return case


def _given(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Turn settings of a manifest back into those of a study file.

    TOML has no null, so what was left open is left out; infinities are strings in JSON.
    """
    given: dict[str, Any] = {}
    for key, value in settings.items():
        if isinstance(value, Mapping):
            given[key] = _given(value)
        elif value in ("inf", "-inf"):
            given[key] = math.inf if value == "inf" else -math.inf
        elif value is not None:
            given[key] = value
    return given


def _check_same(
    run: Run,
    rows: pl.DataFrame,
    columns: Mapping[str, np.ndarray],
    jobs: np.ndarray,
    metrics: tuple[Metric, ...],
) -> None:
    """Raise BadInputError unless all episodes went as the run says they did."""
    same = rows["status"].to_numpy() == columns["status"]
    for metric in metrics:
        was, now = rows[metric.name].to_numpy(), np.asarray(columns[metric.name])
        if metric.integer:
            same &= was == now
        else:
            close = np.isclose(now.astype(was.dtype), was, ROUNDING, ROUNDING, equal_nan=True)
            same &= close
    if not same.all():
        made = ", ".join(f"{k} {run.manifest[k]}" for k in ("usvjax", "code", "jax", "device"))
        raise BadInputError(
            f"episode {jobs[~same][0]} goes otherwise here than in {run.path}, which was made "
            f"with {made}; replay it with the same code on the same kind of device"
        )
