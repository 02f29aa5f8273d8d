"""What a paper needs computed: studies, which are resumed, and calls, which are made anew."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from hashlib import sha256
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import polars as pl

from usvjax.cli.console import Meter, StudyMeter
from usvjax.mission import Replayed
from usvjax.study.code import code_digest
from usvjax.study.reader import Run as StudyRun
from usvjax.study.reader import load_run
from usvjax.study.replay import Replay
from usvjax.study.shards import find_shards
from usvjax.study.spec import StudySpec, parse_spec
from usvjax.study.study import run_study
from usvjax.study.timings import TIMINGS
from usvjax.study.versions import COMPARED, environment

FOLDER = Path("runs/reproduce")
"""Where the runs of studies are kept: under the paper's name, by what they depend on."""

Columns = Mapping[str, np.ndarray]
"""Metrics and "status" of one method, arrays in the order of the jobs."""


@dataclass(frozen=True)
class Study:
    """Episodes of a mission, in shards; what is there is not run again.

    Attributes:
        tables: as `usvjax.study.parse_spec` takes them; the labels of conditions are unique.
    """

    tables: Mapping[str, Any]

    @cached_property
    def spec(self) -> StudySpec:
        """The study, checked."""
        return parse_spec(dict(self.tables))

    @property
    def size(self) -> int:
        """Episodes, of all methods and conditions."""
        return self.spec.layout.all_rows


@dataclass(frozen=True)
class Call:
    """Something computed at once and not kept, such as timings.

    Attributes:
        make: computes it; told what to call with how much is done since the last time.
        size: how much there is to do, in the same units.
    """

    make: Callable[[Callable[[int], object]], Any]
    size: int


Run = Study | Call


class Ran:
    """A study that was run."""

    def __init__(self, spec: StudySpec, path: Path) -> None:
        self.spec = spec
        self.path = path
        self._place = {condition.label: condition.index for condition in spec.conditions}

    @cached_property
    def run(self) -> StudyRun:
        """The run, opened for reading."""
        return load_run(self.path)

    @cached_property
    def table(self) -> pl.DataFrame:
        """All rows; see `usvjax.study.Run.table`."""
        return self.run.table()

    @cached_property
    def _parts(self) -> dict[tuple[int, str], Columns]:
        parts = self.table.partition_by("condition", "method", as_dict=True)
        return {
            (int(condition), str(method)): part.sort("job")
            .drop("condition", "method")
            .to_dict(as_series=False)
            for (condition, method), part in parts.items()
        }

    @cache  # noqa: B019
    def columns(self, label: str, method: str) -> Columns:
        """What became of one method in one condition, job by job."""
        found = self._parts[self._place[label], method]
        return {name: np.asarray(values) for name, values in found.items()}

    def replay(self, label: str, method: str, jobs: list[int]) -> Replayed:
        """Run some episodes again and record them, for figures."""
        return self._replay(self._place[label], method, jobs)

    @cached_property
    def _replay(self) -> Replay:
        return Replay(self.run, examples=len(self.spec.conditions))


@dataclass(frozen=True)
class Found:
    """Everything that was run for a part of a paper.

    Attributes:
        studies: by name.
        made: what calls returned, by name.
    """

    studies: Mapping[str, Ran]
    made: Mapping[str, Any]


def carry_out(paper: str, runs: Mapping[str, Run]) -> tuple[Found, dict[str, float]]:
    """Run everything, or continue.

    Args:
        paper: its name.
        runs: by name.

    Returns:
        What was found, and the seconds that each took.
    """
    studies: dict[str, Ran] = {}
    made: dict[str, Any] = {}
    seconds = {}
    for name, run in runs.items():
        begun = monotonic()
        if isinstance(run, Study):
            studies[name] = _studied(paper, name, run.spec)
            seconds[name] = _seconds(studies[name])
        else:
            made[name] = _called(f"{paper}: {name}", run)
            seconds[name] = monotonic() - begun
    return Found(studies, made), seconds


def _seconds(ran: Ran) -> float:
    """What a study took, in however many sessions; those that were killed left no times."""
    known = json.loads((ran.path / TIMINGS).read_text(encoding="utf-8"))
    share = len(known["units"]) / len(find_shards(ran.path, ran.spec.layout))
    return float(known["device_seconds"]) / len(known["devices"]) / max(share, 1e-9)


def _called(what: str, call: Call) -> Any:
    meter = Meter(what, "done")
    meter.begin(0, call.size)
    try:
        return call.make(meter.advance)
    finally:
        meter.end(whole=False)


def place_of(paper: str, spec: StudySpec) -> Path:
    """Folder of a study's run: another one for other settings, code, versions or devices."""
    made = environment(code_digest(spec.mission))
    known = {"study": spec.canonical(), **{name: made[name] for name in COMPARED}}
    digest = sha256(json.dumps(known, sort_keys=True).encode()).hexdigest()[:12]
    return FOLDER / paper / digest


def _studied(paper: str, name: str, spec: StudySpec) -> Ran:
    with StudyMeter(f"{paper}: {name}") as meter:
        result = run_study(spec, place_of(paper, spec), listener=meter)
    return Ran(spec, result.path)
