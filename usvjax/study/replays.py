"""Episodes of a finished run, simulated again with their trajectories recorded.

A run keeps one row per episode and no trajectory. Job j's scenario and result depend on the
study alone, so the very episode of a row can be had back at any time; whether it really is
the same one is checked against the row.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.mission import get_workload
from usvjax.missions.dwa.candidates import DwaCandidates, dwa_candidates
from usvjax.missions.dwa.decision import Decide, Episode
from usvjax.missions.dwa.inputs import set_scene
from usvjax.missions.dwa.mission import DwaCondition
from usvjax.missions.dwa.params import DwaParams, DwaStatic
from usvjax.missions.dwa.run import NavigateResult, navigate_dwa
from usvjax.missions.dwa.scenes import Scenarios
from usvjax.plots.paths import Outcome
from usvjax.study import Run

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Replay:
    """Episodes of one condition and method, with trajectories.

    Attributes:
        label: Condition and method in words.
        jobs: int64[J], numbers of the episodes.
        params: Of the method.
        static: Of the method, the method's name included.
        scenarios: Where the episodes took place, in the order of `jobs`.
        result: How they went, in the order of `jobs`, with `trajectory`.
    """

    label: str
    jobs: NDArray[np.int64]
    params: DwaParams
    static: DwaStatic
    scenarios: Scenarios
    result: NavigateResult

    @property
    def grid_map(self) -> GridMap | None:
        """The shared map, or None where every episode has circles of its own."""
        found = self.scenarios.obstacles
        return found if isinstance(found, GridMap) else None

    @property
    def trajectories(self) -> FloatArray:
        """float[J, T, 5]: x, y (m), psi (rad), v (m/s), w (rad/s)."""
        assert self.result.trajectory is not None
        return self.result.trajectory

    def circles(self, row: int) -> FloatArray:
        """Centres of the obstacles of one episode, float[K, 2] m; none on a shared map."""
        if isinstance(self.scenarios.obstacles, GridMap):
            return np.empty((0, 2))
        centres = np.asarray(self.scenarios.obstacles[row], dtype=float)
        if self.scenarios.valid is not None:
            centres = centres[self.scenarios.valid[row]]
        return centres

    def outcome(self, row: int) -> Outcome:
        """How one episode ended."""
        found = self.result
        return Outcome(
            status=int(found.status[row]),
            time=float(found.time[row]),
            path_length=float(found.path_length[row]),
        )

    def episode(self, row: int) -> Episode:
        """One episode as something to animate."""
        return Episode(
            trajectory=self.trajectories[row],
            goal=self.scenarios.goals[row],
            obstacles=self.circles(row),
            radius=float(self.params.radius),
            dt=float(self.params.dt),
            goal_tolerance=float(self.params.goal_tolerance),
            status=int(self.result.status[row]),
            steps=int(self.result.steps[row]),
            grid_map=self.grid_map,
            title=f"{self.label}, job {self.jobs[row]}",
        )

    def decide(self, row: int) -> Decide:
        """Return the function from a state of one episode to the decision taken there."""
        starts, goals = self.scenarios.starts[row], self.scenarios.goals[row]
        seen = self.circles(row) if self.grid_map is None else self.grid_map
        scene = set_scene(seen, starts, goals, None, self.params, self.static, None)
        origin, goal = scene.origin, scene.goal[0]

        # As the kernel does, in the map's frame: single precision is too coarse in the world's.
        def decision(state: FloatArray) -> DwaCandidates:
            state = np.concatenate([state[:2] - origin, state[2:]])
            near = scene.sensed(state[None, :2])[0].T
            found = dwa_candidates(near, state, goal, params=self.params, static=self.static)
            return replace(found, end=found.end + origin, paths=found.paths + origin)

        return decision


def replay(
    run: Run,
    table: pl.DataFrame,
    condition: int,
    method: str,
    jobs: Sequence[int],
    *,
    folder: Path | None = None,
) -> Replay:
    """Simulate episodes of a run again, recording their trajectories.

    Args:
        run: The run, of kind "dwa".
        table: Its rows, as `run.table()`.
        condition: Index of the condition.
        method: One of the run's methods.
        jobs: Numbers of the episodes, at least one.
        folder: What a map file named by the study is relative to; the working directory when
            None. Packaged maps need none.

    Returns:
        The episodes, in the order of `jobs`.

    Raises:
        BadInputError: There is no such condition, method or episode, a map file is missing or
            has changed, or the episodes end otherwise than in the table, because the run was
            made with another version or kind of device.
    """
    rows = rows_of(run, table, condition, method, jobs)
    kind = run.manifest["study"]["kind"]
    if kind != "dwa":
        raise BadInputError(f"{run.path} is of kind {kind!r}; only 'dwa' can be replayed")
    payload: DwaCondition = payload_of(run, condition, folder)
    numbers = np.asarray(jobs, dtype=np.int64)
    seed = int(run.manifest["study"]["seed"])
    scenarios = payload.source.draw(seed, numbers, float(payload.params.radius))
    static = replace(payload.static, method=method)
    result = navigate_dwa(
        scenarios.obstacles,
        scenarios.starts,
        scenarios.goals,
        valid=scenarios.valid,
        params=payload.params,
        static=static,
        record=True,
    )
    _check_same(run, rows, result, numbers)
    label = f"{run.labels[condition]}, {method}"
    return Replay(label, numbers, payload.params, static, scenarios, result)


def rows_of(
    run: Run, table: pl.DataFrame, condition: int, method: str, jobs: Sequence[int]
) -> pl.DataFrame:
    """Return the rows of some episodes.

    Args:
        run: The run, of any kind.
        table: Its rows, as `run.table()`.
        condition: Index of the condition.
        method: One of the run's methods.
        jobs: Numbers of the episodes.

    Returns:
        Their rows, in the order of `jobs`.

    Raises:
        BadInputError: There is no such condition, method or episode.
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


def payload_of(run: Run, condition: int, folder: Path | None) -> Any:
    """Build what runs the episodes of a condition again, from the settings in the manifest.

    Args:
        run: The run, of any kind.
        condition: Index of the condition.
        folder: What files named by the study are relative to; the working directory when None.

    Returns:
        The payload of the condition; see `usvjax.mission.Prepared`.

    Raises:
        BadInputError: A file is missing or has changed.
    """
    study = run.manifest["study"]
    workload = get_workload(study["kind"], str(run.path))
    settings = _given(run.settings[condition])
    prepared = workload.prepare(settings, folder or Path(), str(run.path))
    inputs = study["conditions"][condition]["inputs"]
    if prepared.inputs != inputs:
        names = ", ".join(inputs)
        raise BadInputError(f"the map {names} is not the one that {run.path} was made with")
    return prepared.payload


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
    run: Run, rows: pl.DataFrame, result: NavigateResult, jobs: NDArray[np.int64]
) -> None:
    """Raise where an episode went otherwise than in the table."""
    same = rows["status"].to_numpy() == result.status
    same &= rows["steps"].to_numpy() == result.steps
    check_same(run, same, jobs)


def check_same(run: Run, same: NDArray[np.bool_], jobs: NDArray[np.int64]) -> None:
    """Raise BadInputError unless all episodes, bool[J], went as the run says they did."""
    if not same.all():
        made = ", ".join(f"{k} {run.manifest[k]}" for k in ("usvjax", "jax", "device"))
        raise BadInputError(
            f"episode {jobs[~same][0]} goes otherwise here than in {run.path}, which was made "
            f"with {made}; replay it with the same code on the same kind of device"
        )
