"""A workload without simulation, for the tests of the study machinery."""

import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any

import numpy as np

from usvjax.mission import Metric, Prepared, get_workload, register_kind
from usvjax.tables import field_names, read_table
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


class ToyWorkload:
    sections: Mapping[str, tuple[str, ...]] = {"params": field_names(ToyParams)}
    methods: tuple[str, ...] = ("plain", "better", "worse")
    metrics: tuple[Metric, ...] = (
        Metric("time", "s", "Time"),
        Metric("clearance", "m", "Clearance"),
        Metric("steps", "", "Steps", integer=True, summarised=False),
    )
    endings: tuple[IntEnum, ...] = EPISODE_ENDINGS
    success: IntEnum = Status.REACHED

    def prepare(
        self, settings: Mapping[str, Mapping[str, Any]], folder: Path, where: str
    ) -> Prepared:
        params = read_table(ToyParams, settings["params"], f"{where}: [params]")
        return Prepared({"params": asdict(params)}, {}, params)

    def run(self, spec: Any, condition: Any, method: str, jobs: np.ndarray) -> dict[str, Any]:
        params: ToyParams = condition.payload
        time.sleep(params.sleep)
        if params.crash_job in jobs:
            raise OSError("a defect, not a user's mistake")
        shift = {"plain": 0.0, "better": 0.05, "worse": -0.2}[method]
        luck = toy_uniforms(spec.seed, jobs, 0)
        status = np.where(luck < params.rate + shift, Status.REACHED, Status.STUCK)
        noise = toy_uniforms(spec.seed, jobs, 1 + len(method))
        seconds = 10.0 + 5.0 * luck + noise - 4.0 * shift
        seconds[(jobs == params.nan_job)] = np.nan
        status[(jobs == params.nan_job)] = Status.REACHED
        status[(jobs == params.running_job)] = Status.RUNNING
        clearance = noise + params.radius
        clearance[toy_uniforms(spec.seed, jobs, 9 + len(method)) < params.unsensed] = np.inf
        return {
            "status": status.astype(np.int32),
            "time": seconds.astype(np.float32),
            "clearance": clearance.astype(np.float32),
            "steps": (10 * seconds).astype(np.int32) if params.nan_job < 0 else jobs,
        }


register_kind(KIND, "study_fake:ToyWorkload")


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


def run_files(path: Path) -> dict[str, bytes]:
    """All files that must be equal between equal runs, by relative name."""
    return {
        str(file.relative_to(path)): file.read_bytes()
        for file in sorted(path.rglob("*"))
        if file.is_file() and file.name != "timings.json"
    }


def test_uniforms_of_a_job_do_not_depend_on_the_others():
    alone = toy_uniforms(3, np.asarray([41]), 2)
    assert alone[0] == toy_uniforms(3, np.arange(100), 2)[41]


def test_registered_kind_is_found():
    assert isinstance(get_workload(KIND), ToyWorkload)
