"""Running units: their rows, checked; in one call where the mission can join their scenes."""

from collections.abc import Mapping, Sequence

import numpy as np
import polars as pl

from usvjax.ambient import pinned
from usvjax.study.calls import Kindred
from usvjax.study.shards import KEY_COLUMNS, Unit
from usvjax.study.spec import StudySpec


def run_unit(spec: StudySpec, unit: Unit, first_method: int = 0) -> pl.DataFrame:
    """Run one unit on its own; see `run_units`."""
    return run_units(spec, [unit], Kindred(spec), first_method)[0]


@pinned()
def run_units(
    spec: StudySpec, units: Sequence[Unit], kindred: Kindred, first_method: int = 0
) -> list[pl.DataFrame]:
    """Run units in one call per method, and check what came back.

    Args:
        spec: the study.
        units: which jobs of which conditions; of one kin.
        kindred: of the study.
        first_method: which method to begin with, counted round. Devices that begin with
            different methods prepare different programs side by side.

    Returns:
        For each unit, one row per job and method, jobs ascending, methods in the order of the
        study.

    Raises:
        RuntimeError: an episode has no ending, or a successful one has a NaN; names the job.
    """
    scene = kindred.pose(units)  # once, for all methods
    sizes = [len(spec.layout.jobs(unit)) for unit in units]
    ends = np.cumsum(sizes)
    tables: list[list[pl.DataFrame]] = [[] for _ in units]
    count = len(spec.methods)
    for rank in ((first_method + i) % count for i in range(count)):
        found = spec.mission.run(scene, spec.methods[rank]).columns
        columns = _columns(spec, found, sum(sizes), _place(spec, units[0], spec.methods[rank]))
        for unit, end, size, parts in zip(units, ends, sizes, tables, strict=True):
            own = {name: column[end - size : end] for name, column in columns.items()}
            parts.append(_table(spec, unit, rank, own))
    return [pl.concat(parts).sort("job", "rank").drop("rank") for parts in tables]


def _table(
    spec: StudySpec, unit: Unit, rank: int, columns: Mapping[str, np.ndarray]
) -> pl.DataFrame:
    """The rows of a unit by one method."""
    jobs, method = spec.layout.jobs(unit), spec.methods[rank]
    _check_ended(spec, columns, jobs, _place(spec, unit, method))
    metrics = {
        metric.name: pl.Series(
            columns[metric.name], dtype=pl.Int32 if metric.integer else pl.Float32
        )
        for metric in spec.mission.metrics
    }
    keys = {
        "condition": np.full(len(jobs), unit.condition),
        "job": jobs,
        "method": [method] * len(jobs),
        "status": columns["status"],
    }
    table = pl.DataFrame(keys, schema_overrides=KEY_COLUMNS).with_columns(**metrics)
    return table.with_columns(rank=pl.lit(rank))


def _place(spec: StudySpec, unit: Unit, method: str) -> str:
    condition = spec.conditions[unit.condition]
    return f"condition {condition.index} ({condition.label}), method {method}"


def _columns(
    spec: StudySpec, found: Mapping[str, np.ndarray], rows: int, place: str
) -> dict[str, np.ndarray]:
    """What a mission returned of so many rows, as arrays of numpy.

    Raises:
        RuntimeError: a column is not there, or has another length; a defect of the mission.
    """
    wanted = ["status", *(metric.name for metric in spec.mission.metrics)]
    missing = [name for name in wanted if name not in found]
    if missing:
        raise RuntimeError(f"{place}: the mission returned no column {missing[0]!r}")
    columns = {name: np.asarray(found[name]) for name in wanted}
    for name, column in columns.items():
        if column.shape != (rows,):
            raise RuntimeError(
                f"{place}: the column {name!r} has shape {column.shape}; wanted {(rows,)}"
            )
    return columns


def _check_ended(
    spec: StudySpec, columns: Mapping[str, np.ndarray], jobs: np.ndarray, place: str
) -> None:
    """Raise RuntimeError where an episode did not end; a defect, not a user's mistake."""
    status = columns["status"]
    unfinished = ~np.isin(status, [int(s) for s in spec.mission.endings])
    if unfinished.any():
        job = jobs[unfinished.argmax()]
        raise RuntimeError(f"job {job} of {place} has no ending: {status[unfinished.argmax()]}")
    for metric in spec.mission.metrics:
        bad = np.isnan(columns[metric.name]) & (status == int(spec.mission.endings[0]))
        if bad.any():
            raise RuntimeError(f"job {jobs[bad.argmax()]} of {place}: {metric.name} is NaN")
