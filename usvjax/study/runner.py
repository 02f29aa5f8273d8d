"""Running a study: shards to devices, shards to disk, looks, and a clean stop.

Each JAX device has a thread that takes the next units (condition, shard) when it is free, one or
some that share a call (see `calls`). Results depend only on the unit, so neither the number of
devices nor the order matters, and only the arrays of a call are alive at a time, so memory does not
grow with the episodes.
"""

import queue
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import jax
import polars as pl

from usvjax.checks import shown
from usvjax.devices import local_devices
from usvjax.errors import BadInputError
from usvjax.study.calls import Calls, Kindred
from usvjax.study.looks import look_level, look_schedule, narrow_enough
from usvjax.study.shards import Unit
from usvjax.study.spec import StudySpec
from usvjax.study.store import RunDirectory
from usvjax.study.timings import Timings
from usvjax.study.units import run_units


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
    """One thread per device, working through the units that are missing."""

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
        self.kindred = Kindred(spec)
        self.calls = Calls(spec, self.kindred, len(devices))
        self.abandoned = threading.Event()
        self.total = spec.layout.all_rows
        self.done = self._on_disk()
        listener.begin(self.done, self.total)

    def run(self, units: Iterable[Unit]) -> None:
        """Run those units that are not on disk."""
        done = self.directory.done
        missing = [unit for unit in units if unit not in done]
        if not missing:
            return
        self.calls.put(missing)
        self.directory.check_writable()
        finished: queue.SimpleQueue[tuple[Unit, float] | BaseException | None]
        finished = queue.SimpleQueue()
        stop = threading.Event()
        threads = [
            threading.Thread(target=self._work, args=(i, finished, stop), daemon=True)
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
        finished: "queue.SimpleQueue[tuple[Unit, float] | BaseException | None]",
        stop: threading.Event,
    ) -> None:
        """Run units on one device until none is left; a thread's whole life."""
        try:
            with jax.default_device(self.devices[number]):
                while not stop.is_set() and (units := self.calls.take()):
                    self._call(number, units, finished)
        except BaseException as error:
            finished.put(error)
        finally:
            finished.put(None)

    def _call(
        self,
        number: int,
        units: list[Unit],
        finished: "queue.SimpleQueue[tuple[Unit, float] | BaseException | None]",
    ) -> None:
        """Run units in one call, and write each as a shard of its own."""
        began = time.perf_counter()
        tables = run_units(self.spec, units, self.kindred, first_method=number)
        seconds = time.perf_counter() - began
        self.calls.took(units, seconds)
        rows = sum(map(self.spec.layout.rows, units))
        for unit, table in zip(units, tables, strict=True):
            if self.abandoned.is_set():
                return  # nobody waits, and the run may be another process's by now
            began = time.perf_counter()
            self.directory.write_shard(unit, table)
            share = seconds * self.spec.layout.rows(unit) / rows
            finished.put((unit, share + time.perf_counter() - began))

    def _on_disk(self) -> int:
        return sum(map(self.spec.layout.rows, self.directory.done))
