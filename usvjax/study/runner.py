"""Running a study: shards to devices, shards to disk, looks, and a clean stop.

Each JAX device has a thread that takes the next unit (condition, shard) when it is free.
Results depend only on the unit, so neither the number of devices nor the order matters, and
only shard-sized arrays are alive at a time, so memory does not grow with the episodes.
"""

import queue
import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import jax
import numpy as np
import polars as pl

from usvjax.ambient import pinned
from usvjax.checks import shown
from usvjax.devices import local_devices
from usvjax.errors import BadInputError
from usvjax.mission import Metric
from usvjax.study.looks import look_level, look_schedule, narrow_enough
from usvjax.study.shards import KEY_COLUMNS, Unit
from usvjax.study.spec import StudySpec
from usvjax.study.store import RunDirectory
from usvjax.study.timings import Timings


class Listener(Protocol):
    """Who is told about progress. An episode counts once per method."""

    def begin(self, done: int, total: int) -> None:
        """`done` of at most `total` episodes are on disk already."""
        ...

    def advance(self, episodes: int) -> None:
        """So many more episodes are on disk."""
        ...

    def stopping(self) -> None:
        """Asked to stop; the shards under way are being finished."""
        ...


class Silent:
    """A listener that says nothing."""

    def begin(self, done: int, total: int) -> None:
        """Say nothing."""

    def advance(self, episodes: int) -> None:
        """Say nothing."""

    def stopping(self) -> None:
        """Say nothing."""


class StudyStoppedError(KeyboardInterrupt):
    """The study was interrupted; what it wrote is whole and it can be continued.

    Attributes:
        done: episodes on disk.
        total: episodes of the whole study, at most.
    """

    def __init__(self, done: int, total: int) -> None:
        super().__init__(f"stopped after {done} of {total} episodes")
        self.done = done
        self.total = total


@dataclass(frozen=True)
class Progress:
    """How far a study has got.

    Attributes:
        episodes: per condition, how many episodes each method ran when it stopped.
        looks: the schedule of looks.
        level: of every single interval.
    """

    episodes: tuple[int, ...]
    looks: tuple[int, ...]
    level: float


def run_episodes(
    spec: StudySpec,
    run: RunDirectory,
    *,
    devices: Sequence[jax.Device] | None = None,
    listener: Listener | None = None,
) -> Progress:
    """Run what is missing of a study, until every condition is done or narrow enough.

    Args:
        spec: the study.
        run: its run directory.
        devices: to work on; all local ones when None.
        listener: told about progress.

    Returns:
        How many episodes each condition took.

    Raises:
        BadInputError: the run directory cannot be written, or inputs were refused.
        StudyStoppedError: on Ctrl-C, after the shards under way were written.
        RuntimeError: the mission returned NaN or an unfinished episode.
    """
    crew = _Crew(spec, run, tuple(devices or local_devices()), listener or Silent())
    looks = look_schedule(spec.episodes, spec.shard, spec.until)
    level = look_level(spec.confidence, len(looks))
    episodes = [0] * len(spec.conditions)
    unfinished = list(range(len(spec.conditions)))
    try:
        for at in looks:
            crew.run(_units(spec, unfinished, at))
            for index in unfinished:
                episodes[index] = at
            if spec.until is not None:
                unfinished = [
                    index
                    for index in unfinished
                    if not narrow_enough(_successes(spec, run, index, at), at, level, spec.until)
                ]
    finally:
        crew.timings.save(run)
    return Progress(tuple(episodes), looks, level)


def pick_devices(count: int | None) -> tuple[jax.Device, ...]:
    """Return the first `count` local devices, all when None.

    Raises:
        BadInputError: there are not that many, `count` is below 1, or JAX cannot start.
    """
    devices = local_devices()
    if count is None:
        return tuple(devices)
    if not 1 <= count <= len(devices):
        raise BadInputError(
            f"--devices must lie between 1 and the {len(devices)} devices of this machine, "
            f"got {shown(count)}"
        )
    return tuple(devices[:count])


def _units(spec: StudySpec, conditions: Sequence[int], episodes: int) -> Iterator[Unit]:
    """Yield the units that cover the first `episodes` of some conditions.

    Conditions take turns, so that the time left is estimated from a fair mixture.
    """
    for shard in range(-(-episodes // spec.shard)):
        for condition in conditions:
            yield Unit(condition, shard)


def _successes(spec: StudySpec, run: RunDirectory, condition: int, episodes: int) -> list[int]:
    """Count each method's successes among the first `episodes` of a condition."""
    counts = dict.fromkeys(spec.methods, 0)
    for unit in _units(spec, [condition], episodes):
        table = run.read_shard(unit).filter(pl.col("status") == int(spec.mission.endings[0]))
        for method in spec.methods:
            counts[method] += int((table["method"] == method).sum())
    return list(counts.values())


class _Crew:
    """One thread per device, working through a queue of units."""

    def __init__(
        self,
        spec: StudySpec,
        run: RunDirectory,
        devices: tuple[jax.Device, ...],
        listener: Listener,
    ) -> None:
        self.spec = spec
        self.directory = run
        self.devices = devices
        self.listener = listener
        self.timings = Timings(run, devices)
        self.abandoned = threading.Event()
        self.total = spec.layout.all_rows
        self.done = self._on_disk()
        listener.begin(self.done, self.total)

    def run(self, units: Iterable[Unit]) -> None:
        """Run those units that are not on disk."""
        missing: queue.SimpleQueue[Unit] = queue.SimpleQueue()
        done = self.directory.done
        for unit in units:
            if unit not in done:
                missing.put(unit)
        if missing.empty():
            return
        self.directory.check_writable()
        finished: queue.SimpleQueue[tuple[Unit, float] | BaseException | None]
        finished = queue.SimpleQueue()
        stop = threading.Event()
        threads = [
            threading.Thread(target=self._work, args=(i, missing, finished, stop), daemon=True)
            for i in range(len(self.devices))
        ]
        for thread in threads:
            thread.start()
        try:
            self._follow(finished, len(threads), stop)
        except KeyboardInterrupt:
            stop.set()
            try:
                self.listener.stopping()
                for thread in threads:
                    thread.join()
            except KeyboardInterrupt:
                self.abandoned.set()
            self.done = self._on_disk()
            raise StudyStoppedError(self.done, self.total) from None

    def _follow(
        self,
        finished: "queue.SimpleQueue[tuple[Unit, float] | BaseException | None]",
        working: int,
        stop: threading.Event,
    ) -> None:
        """Report finished units until every thread has left; then raise the first error."""
        error: BaseException | None = None
        while working:
            try:
                # A wait without a limit could not be interrupted on every platform.
                news = finished.get(timeout=0.5)
            except queue.Empty:
                continue
            if news is None:
                working -= 1
            elif isinstance(news, BaseException):
                stop.set()
                error = error or news
            else:
                unit, seconds = news
                self.timings.add(unit, seconds)
                self.done += self.spec.layout.rows(unit)
                self.listener.advance(self.spec.layout.rows(unit))
        if error is not None:
            raise error

    def _work(
        self,
        number: int,
        missing: "queue.SimpleQueue[Unit]",
        finished: "queue.SimpleQueue[tuple[Unit, float] | BaseException | None]",
        stop: threading.Event,
    ) -> None:
        """Run units on one device until none is left; a thread's whole life."""
        try:
            with jax.default_device(self.devices[number]):
                while not stop.is_set():
                    unit = missing.get_nowait()
                    began = time.perf_counter()
                    table = run_unit(self.spec, unit, first_method=number)
                    if self.abandoned.is_set():
                        break  # nobody waits, and the run may be another process's by now
                    self.directory.write_shard(unit, table)
                    finished.put((unit, time.perf_counter() - began))
        except queue.Empty:
            pass
        except BaseException as error:
            finished.put(error)
        finally:
            finished.put(None)

    def _on_disk(self) -> int:
        return sum(map(self.spec.layout.rows, self.directory.done))


@pinned()
def run_unit(spec: StudySpec, unit: Unit, first_method: int = 0) -> pl.DataFrame:
    """Run one unit and check what came back.

    Args:
        spec: the study.
        unit: which jobs of which condition.
        first_method: which method to begin with, counted round. Devices that begin with
            different methods prepare different programs side by side.

    Returns:
        One row per job and method, jobs ascending, methods in the order of the study.

    Raises:
        RuntimeError: an episode has no ending, or a successful one has a NaN; names the job.
    """
    condition = spec.conditions[unit.condition]
    jobs = spec.layout.jobs(unit)
    scene = spec.mission.pose(condition.case, spec.seed, jobs)  # once, for all methods
    tables = []
    count = len(spec.methods)
    for rank in ((first_method + i) % count for i in range(count)):
        method = spec.methods[rank]
        place = f"condition {condition.index} ({condition.label}), method {method}"
        columns = _checked(spec, spec.mission.run(scene, method).columns, jobs, place)
        metrics = {
            metric.name: pl.Series(columns[metric.name], dtype=_stored(metric))
            for metric in spec.mission.metrics
        }
        keys = {
            "condition": np.full(len(jobs), condition.index),
            "job": jobs,
            "method": [method] * len(jobs),
            "status": columns["status"],
        }
        table = pl.DataFrame(keys, schema_overrides=KEY_COLUMNS).with_columns(**metrics)
        tables.append(table.with_columns(rank=pl.lit(rank)))
    return pl.concat(tables).sort("job", "rank").drop("rank")


def _stored(metric: Metric) -> type[pl.DataType]:
    if metric.integer:
        return pl.Int32
    return pl.Float64 if metric.double else pl.Float32


def _checked(
    spec: StudySpec, found: Mapping[str, np.ndarray], jobs: np.ndarray, place: str
) -> dict[str, np.ndarray]:
    """The columns as arrays of numpy.

    Raises:
        RuntimeError: a mission broke its contract; a defect, not a user's mistake.
    """
    wanted = ["status", *(metric.name for metric in spec.mission.metrics)]
    missing = [name for name in wanted if name not in found]
    if missing:
        raise RuntimeError(f"{place}: the mission returned no column {missing[0]!r}")
    columns = {name: np.asarray(found[name]) for name in wanted}
    for name, column in columns.items():
        if column.shape != jobs.shape:
            raise RuntimeError(
                f"{place}: the column {name!r} has shape {column.shape}; wanted {jobs.shape}"
            )
    status = columns["status"]
    unfinished = ~np.isin(status, [int(s) for s in spec.mission.endings])
    if unfinished.any():
        job = jobs[unfinished.argmax()]
        raise RuntimeError(f"job {job} of {place} has no ending: {status[unfinished.argmax()]}")
    for metric in spec.mission.metrics:
        bad = np.isnan(columns[metric.name]) & (status == int(spec.mission.endings[0]))
        if bad.any():
            raise RuntimeError(f"job {jobs[bad.argmax()]} of {place}: {metric.name} is NaN")
    return columns
