"""The run directory: one place on disk that survives being killed at any moment.

    manifest.json      the study, its hash, versions, device, seed; written before any shard
    files/             copies of the files that the study names
    shards/*.parquet   rows of one (condition, shard), all methods
    summary.json, summary.md
    finished.json      what the summary was made from; written last
    timings.json       seconds per shard; the only file that differs between equal runs
    figures/           and figures.json, what they were drawn from

Every file is written under a temporary name, synced and renamed, and a shard's name carries
the SHA-256 of its bytes. So a file that is there is whole, and one that a failing disk has
damaged since is found out before it is read, and computed again. The directory itself may be
reached by a link; inside it, none is followed.
"""

import os
from collections.abc import Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import polars as pl

from usvjax.errors import BadInputError
from usvjax.study import shards
from usvjax.study.folder import (
    TEMPORARY,
    check_no_link,
    in_one_line,
    json_bytes,
    make_folder,
    open_plain,
    write_plain,
)
from usvjax.study.held import FOLDER as FILES
from usvjax.study.held import NOTHING, Held
from usvjax.study.manifest import MANIFEST, check_same, read_manifest
from usvjax.study.shards import Layout, Unit

try:
    import fcntl
except ImportError:  # no such locks outside POSIX; there the user must not start a run twice
    fcntl = None  # type: ignore[assignment]

LOCK = "run.lock"


class RunDirectory:
    """One run's files. Open it with `RunDirectory.open`, use it as a context manager.

    Attributes:
        path: the directory.
        writable: whether it may be written; where not, a finished run can still be read.
        shards: the files of the units that are on disk and whole.
    """

    def __init__(self, path: Path, layout: Layout, lock: int | None) -> None:
        self.path = path
        self.writable = lock is not None
        self._layout = layout
        self._lock = lock
        self.shards = self._whole_shards()

    @classmethod
    def open(cls, path: Path, manifest: Mapping[str, Any], held: Held = NOTHING) -> "RunDirectory":
        """Create a run directory, or take up one of the same study and versions.

        Args:
            path: the directory; made if absent.
            manifest: of the run; see `usvjax.study.manifest.manifest_of`.
            held: the files that the study names, to be copied.

        Returns:
            The open directory; close it, or leave its `with` block, to release its lock.

        Raises:
            BadInputError: the directory belongs to something else, is in use, or cannot be
                written. Nothing in it has been changed.
        """
        path = Path(path)
        layout = Layout.of(manifest["study"])
        _check_is_ours(path)
        if _begun(path, manifest) and not os.access(path, os.W_OK):
            return cls(path, layout, None)
        check_no_link(path / FILES)
        with _writing(path, layout):
            path.mkdir(parents=True, exist_ok=True)
            make_folder(path / shards.FOLDER)
            lock = _locked(path)
        try:
            begun = _begun(path, manifest)  # once more: others may have, until it was locked
            run = cls(path, layout, lock)
            with _writing(path, layout):
                held.write(path, (begun or manifest)["files"])
            if begun is None:
                run.write_json(MANIFEST, manifest)
        except BaseException:
            os.close(lock)
            raise
        return run

    def __enter__(self) -> "RunDirectory":
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def close(self) -> None:
        """Release the lock."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    @property
    def done(self) -> frozenset[Unit]:
        """The units whose shards are on disk and whole."""
        return frozenset(self.shards)

    def write_shard(self, unit: Unit, table: pl.DataFrame) -> None:
        """Write a unit's rows; they are on disk when this returns.

        Args:
            unit: what the rows belong to.
            table: one row per job and method.

        Raises:
            BadInputError: the directory cannot be written or is full.
        """
        name, content = shards.encode_shard(unit, table)
        self.shards[unit] = self.write(f"{shards.FOLDER}/{name}", content)

    def read_shard(self, unit: Unit) -> pl.DataFrame:
        """Read a unit's rows.

        Args:
            unit: one of `done`.

        Returns:
            The table that `write_shard` was given.

        Raises:
            BadInputError: the file has been damaged since.
        """
        return shards.read_shard(self.shards[unit], unit, self._layout)

    def write_json(self, name: str, value: Any) -> None:
        """Write a JSON file into the run directory; errors as `write_shard`."""
        self.write(name, json_bytes(value))

    def check_writable(self) -> None:
        """Raise BadInputError where the directory may only be read."""
        if not self.writable:
            raise BadInputError(
                f"{self.path} may only be read, and episodes are missing; copy it to where it can "
                f"be written, and choose that --out"
            )

    def write(self, name: str, content: bytes) -> Path:
        """Write a file into the run directory; its path. Errors as `write_shard`."""
        self.check_writable()
        with _writing(self.path, self._layout):
            write_plain(self.path / name, content)
        return self.path / name

    def _whole_shards(self) -> dict[Unit, Path]:
        """List whole shards; remove damaged ones and what a crash left half-written."""
        found = shards.find_shards(self.path, self._layout)
        whole = {unit: path for unit, path in found.items() if shards.is_whole(path)}
        if self.writable:
            damaged = [path for unit, path in found.items() if unit not in whole]
            with _writing(self.path, self._layout):
                for path in (*damaged, *leftovers(self.path)):
                    path.unlink()
        return whole


def _writing(path: Path, layout: Layout) -> AbstractContextManager[None]:
    """Turn an error of writing into one line, which says whether anything is on disk."""
    return in_one_line(
        f"write the run directory at {path}", lambda: bool(shards.find_shards(path, layout))
    )


def leftovers(path: Path) -> list[Path]:
    """What a crash left half-written in a run."""
    folders = [path, path / shards.FOLDER]
    names = [(f, name) for f in folders if f.is_dir() for name in os.listdir(f)]
    return [folder / name for folder, name in names if name.startswith(TEMPORARY)]


def _begun(path: Path, wanted: Mapping[str, Any]) -> dict[str, Any] | None:
    """The manifest of a run that is there, which must be of the same study and versions."""
    if not os.path.lexists(path / MANIFEST):
        return None
    found = read_manifest(path)
    check_same(path, found, wanted)
    return found


def _check_is_ours(path: Path) -> None:
    """Refuse a path that holds something other than a run, before touching it."""
    with in_one_line(f"write the run directory at {path}"):
        if not path.exists() or os.path.lexists(path / MANIFEST):
            return
        if not path.is_dir():
            raise BadInputError(f"the run directory {path} is a file; choose another --out")
        # Killed before the manifest was written, a run leaves these and nothing else.
        ours = (LOCK, shards.FOLDER, FILES)
        foreign = [n for n in os.listdir(path) if n not in ours and not n.startswith(TEMPORARY)]
    if foreign:
        raise BadInputError(
            f"the run directory {path} is not empty and not a run of usvjax "
            f"(it holds {min(foreign)!r}); choose another --out or name"
        )


def _locked(path: Path) -> int:
    """Take the directory's lock; the system drops it when the process ends, however it ends."""
    lock = open_plain(path / LOCK, os.O_RDWR | os.O_CREAT)
    if fcntl is not None:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(lock)
            raise BadInputError(f"{path} is in use by another usvjax process") from None
    return lock
