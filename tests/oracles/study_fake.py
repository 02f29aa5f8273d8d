"""A mission without simulation, for the tests of the study machinery."""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import polars as pl

from usvjax.mission import Case, Files, Ground, Metric, Outcome, Recording, Track
from usvjax.registry import register_mission
from usvjax.sections import Table
from usvjax.study.manifest import read_manifest
from usvjax.study.shards import Layout, encode_shard, find_shards
from usvjax.study.spec import StudySpec
from usvjax.tables import read_table
from usvkernels.status import EPISODE_ENDINGS, Status

KIND = "toy"


@dataclass(frozen=True)
class ToyParams:
    rate: float = 0.8
    radius: float = 0.5
    sleep: float = 0.0
    nan_job: int = -1
    running_job: int = -1
    crash_job: int = -1
    unsensed: float = 0.0


def toy_uniforms(seed: int, jobs: np.ndarray, stream: int) -> np.ndarray:
    """SplitMix64 of (seed, job, stream): any job's number on its own."""
    with np.errstate(over="ignore"):
        x = jobs.astype(np.uint64) + np.uint64(seed * 1_000_003 + stream * 97)
        x = x * np.uint64(0x9E3779B97F4A7C15)
        for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
            x = (x ^ (x >> np.uint64(shift))) * np.uint64(factor)
    return (x ^ (x >> np.uint64(31))).astype(np.float64) / 2.0**64


@dataclass(frozen=True)
class ToyScene:
    params: ToyParams
    seed: int
    jobs: np.ndarray


class ToyMission:
    tables = MappingProxyType({"params": Table("numbers", {"": ToyParams})})
    methods = MappingProxyType({"plain": "as it is", "better": "faster", "worse": "slower"})
    metrics = (
        Metric("time", "s", "Time"),
        Metric("clearance", "m", "Clearance"),
        Metric("steps", "", "Steps", integer=True, summarised=False),
    )
    endings = EPISODE_ENDINGS

    def case(self, tables: Mapping[str, Mapping[str, Any]], files: Files) -> Case:
        params = read_table(ToyParams, tables["params"], files.table("params"))
        return Case({"params": asdict(params)}, {}, params)

    def pose(self, case: Case, seed: int, jobs: np.ndarray) -> ToyScene:
        return ToyScene(case.given, seed, jobs)

    def run(self, scene: ToyScene, method: str, record: bool = False) -> Outcome:
        params, seed, jobs = scene.params, scene.seed, scene.jobs
        time.sleep(params.sleep)
        if params.crash_job in jobs:
            raise OSError("a defect, not a user's mistake")
        shift = {"plain": 0.0, "better": 0.05, "worse": -0.2}[method]
        luck = toy_uniforms(seed, jobs, 0)
        status = np.where(luck < params.rate + shift, Status.REACHED, Status.STUCK)
        noise = toy_uniforms(seed, jobs, 1 + len(method))
        seconds = 10.0 + 5.0 * luck + noise - 4.0 * shift
        seconds[(jobs == params.nan_job)] = np.nan
        status[(jobs == params.nan_job)] = Status.REACHED
        status[(jobs == params.running_job)] = Status.RUNNING
        clearance = noise + params.radius
        clearance[toy_uniforms(seed, jobs, 9 + len(method)) < params.unsensed] = np.inf
        columns = {
            "status": status.astype(np.int32),
            "time": seconds.astype(np.float32),
            "clearance": clearance.astype(np.float32),
            "steps": (10 * seconds).astype(np.int32) if params.nan_job < 0 else jobs,
        }
        return Outcome(columns, self._recorded(luck) if record else None)

    def _recorded(self, luck: np.ndarray) -> Recording:
        nowhere = Ground(None, np.empty((0, 2)), 0.0, {})
        places = luck[:, None, None, None] * np.arange(3.0)[:, None, None] + np.zeros(2)
        tracks = tuple(Track(np.arange(3.0), "s", place) for place in places)
        return Recording((nowhere,) * len(luck), tracks, luck)

    def example(self, rows: Any, methods: list[str]) -> tuple[int, str]:
        return int(rows["job"].max()), "the last"

    def figures(self, run: Any, replay: Any) -> Iterator[tuple[str, Any]]:
        yield "times", run.table().select("job", "time")

    def film(self, replayed: Any, row: int) -> Any:
        from usvjax.plots.tracks import track_film

        track = replayed.recording.tracks[row]
        return track_film(track.places, track.along, track.unit)


register_mission(KIND, ToyMission())


def study_rows(spec: StudySpec, method: str, jobs: np.ndarray, condition: int = 0) -> Any:
    """Status and metrics of some jobs of a study, array[J] each."""
    scene = spec.mission.pose(spec.conditions[condition].case, spec.seed, jobs)
    return spec.mission.run(scene, method).columns


def toy_study(**changes: Any) -> dict[str, Any]:
    """A study of two conditions with 250 episodes in shards of 100."""
    study: dict[str, Any] = {
        "name": "toy",
        "kind": KIND,
        "seed": 7,
        "episodes": 250,
        "shard": 100,
        "methods": ["plain", "better"],
        "axes": {"params.rate": [0.5, 0.9]},
    }
    return study | changes


def rewrite_shards(run: Path, change: Callable[[pl.DataFrame], pl.DataFrame]) -> None:
    """Change the rows of a run as other code would have written them."""
    for unit, path in find_shards(run, Layout.of(read_manifest(run)["study"])).items():
        name, content = encode_shard(unit, change(pl.read_parquet(path)))
        path.unlink()
        (path.parent / name).write_bytes(content)


def run_files(path: Path) -> dict[str, bytes]:
    """All files that must be equal between equal runs, by relative name."""
    return {
        str(file.relative_to(path)): file.read_bytes()
        for file in sorted(path.rglob("*"))
        if file.is_file() and file.name != "timings.json"
    }
