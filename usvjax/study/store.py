"""The run directory: one place on disk that survives being killed at any moment.

    manifest.json      the study, its hash, versions, device, seed; written first
    shards/*.parquet   rows of one (condition, shard), all methods
    summary.json, summary.md
    timings.json       seconds per shard; the only file that differs between equal runs
    figures/

Every file is written under a temporary name, synced and renamed, and a shard's name carries
the SHA-256 of its bytes. So a file that is there is whole, and one that a failing disk has
damaged since is found out before it is read, and computed again.
"""

import hashlib
import io
import json
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from usvjax.errors import BadInputError
from usvjax.study.versions import COMPARED, environment

try:
    import fcntl
except ImportError:  # no such locks outside POSIX; there the user must not start a run twice
    fcntl = None  # type: ignore[assignment]

MANIFEST = "manifest.json"
LOCK = "run.lock"

_TEMPORARY = ".tmp-"
_SHARD = re.compile(r"c(\d+)-s(\d+)-([0-9a-f]{16})\.parquet")


@dataclass(frozen=True, order=True)
class Unit:
    """The unit of work and of resuming: some jobs of one condition, with every method.

    Attributes:
        condition: index of the condition.
        shard: index of the shard.
    """

    condition: int
    shard: int


class RunDirectory:
    """One run's files. Open it with `RunDirectory.open`, use it as a context manager.

    Attributes:
        path: the directory.
        done: the units whose shards are on disk and whole.
    """

    def __init__(self, path: Path, lock: io.TextIOWrapper) -> None:
        self.path = path
        self._lock = lock
        self._shards = self._verified_shards()

    @classmethod
    def open(
        cls, path: Path, study: Mapping[str, Any], study_hash: str, code: str
    ) -> "RunDirectory":
        """Create a run directory, or take up one of the same study and versions.

        Args:
            path: the directory; made if absent.
            study: the canonical study, for the manifest.
            study_hash: its hash.
            code: digest of the code that runs it.

        Returns:
            The open directory; close it, or leave its `with` block, to release its lock.

        Raises:
            BadInputError: the directory belongs to something else, is in use, or cannot be
                written. Nothing in it has been changed.
        """
        path = Path(path)
        _check_is_ours(path)
        manifest = {"hash": study_hash, **environment(code), "study": dict(study)}
        if (path / MANIFEST).exists():
            _check_same(path, read_manifest(path), manifest)
        with _clear_errors(path):
            (path / "shards").mkdir(parents=True, exist_ok=True)
            lock = _locked(path)
        try:
            if not (path / MANIFEST).exists():
                _write(path / MANIFEST, _json_bytes(manifest))
            return cls(path, lock)
        except BaseException:
            lock.close()
            raise

    def __enter__(self) -> "RunDirectory":
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def close(self) -> None:
        """Release the lock."""
        self._lock.close()

    @property
    def done(self) -> frozenset[Unit]:
        """The units whose shards are on disk and whole."""
        return frozenset(self._shards)

    def write_shard(self, unit: Unit, table: pl.DataFrame) -> None:
        """Write a unit's rows; they are on disk when this returns.

        Args:
            unit: what the rows belong to.
            table: one row per job and method.

        Raises:
            BadInputError: the directory cannot be written or is full.
        """
        buffer = io.BytesIO()
        table.write_parquet(buffer, compression="zstd", statistics=False)
        content = buffer.getvalue()
        name = f"c{unit.condition:04d}-s{unit.shard:06d}-{_digest(content)}.parquet"
        path = self.path / "shards" / name
        _write(path, content)
        self._shards[unit] = path

    def read_shard(self, unit: Unit) -> pl.DataFrame:
        """Read a unit's rows.

        Args:
            unit: one of `done`.

        Returns:
            The table that `write_shard` was given.
        """
        return pl.read_parquet(io.BytesIO(self._shards[unit].read_bytes()))

    def write_json(self, name: str, value: Any) -> Path:
        """Write a JSON file into the run directory; errors as `write_shard`."""
        return _write(self.path / name, _json_bytes(value))

    def write_text(self, name: str, text: str) -> Path:
        """Write a text file into the run directory; errors as `write_shard`."""
        return _write(self.path / name, text.encode())

    def _verified_shards(self) -> dict[Unit, Path]:
        """List whole shards; remove damaged ones and what a crash left half-written."""
        shards: dict[Unit, Path] = {}
        with _clear_errors(self.path):
            for folder in (self.path, self.path / "shards"):
                for rubbish in folder.glob(f"{_TEMPORARY}*"):
                    rubbish.unlink()
            for path in sorted((self.path / "shards").glob("*.parquet")):
                match = _SHARD.fullmatch(path.name)
                if match is None:
                    continue
                if _digest(path.read_bytes()) == match[3]:
                    shards[Unit(int(match[1]), int(match[2]))] = path
                else:
                    path.unlink()
        return shards


def read_manifest(path: Path) -> dict[str, Any]:
    """Read the manifest of a run directory.

    Args:
        path: the run directory.

    Returns:
        Its content.

    Raises:
        BadInputError: there is none, or it cannot be read.
    """
    try:
        manifest = json.loads((path / MANIFEST).read_bytes())
    except OSError as error:
        raise BadInputError(f"{path} is not a run of usvjax: no readable {MANIFEST}") from error
    except ValueError as error:
        raise BadInputError(f"{path / MANIFEST} is damaged: {error}") from error
    if not isinstance(manifest, dict) or "study" not in manifest:
        raise BadInputError(f"{path / MANIFEST} is not a manifest of usvjax")
    return manifest


def _check_is_ours(path: Path) -> None:
    """Refuse a path that holds something other than a run, before touching it."""
    with _clear_errors(path):
        if not path.exists() or (path / MANIFEST).exists():
            return
        if not path.is_dir():
            raise BadInputError(f"the run directory {path} is a file; choose another --out")
        # Killed before the manifest was written, a run leaves these and nothing else.
        foreign = [
            p.name
            for p in path.iterdir()
            if p.name not in (LOCK, "shards") and not p.name.startswith(_TEMPORARY)
        ]
    if foreign:
        raise BadInputError(
            f"the run directory {path} is not empty and not a run of usvjax "
            f"(it holds {sorted(foreign)[0]!r}); choose another --out or name"
        )


def _check_same(path: Path, found: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    """Refuse to mix two studies, or two versions, in one directory."""
    remedy = "choose another name or --out, or delete the directory"
    if found.get("hash") != wanted["hash"]:
        difference = _first_difference(found["study"], wanted["study"])
        raise BadInputError(f"{path} holds a run of another study: {difference}; {remedy}")
    for key, words in COMPARED.items():
        if found.get(key) != wanted[key]:
            raise BadInputError(
                f"{path} holds a run made with {words} {found.get(key)}, this is "
                f"{wanted[key]}, and results are not mixed; {remedy}"
            )


def _first_difference(found: Any, wanted: Any, where: str = "") -> str:
    """Name the first place where two JSON values differ."""
    if isinstance(found, Mapping) and isinstance(wanted, Mapping):
        for key in sorted(set(found) | set(wanted)):
            if found.get(key) != wanted.get(key):
                place = f"{where}.{key}" if where else str(key)
                return _first_difference(found.get(key), wanted.get(key), place)
    if isinstance(found, list) and isinstance(wanted, list) and len(found) == len(wanted):
        for index, (a, b) in enumerate(zip(found, wanted, strict=True)):
            if a != b:
                return _first_difference(a, b, f"{where}[{index}]")
    return f"{where or 'the study'} is {_short(found)} there and {_short(wanted)} here"


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 40 else f"{text[:37]}..."


def _json_bytes(value: Any) -> bytes:
    return (json.dumps(value, indent=2, sort_keys=True, allow_nan=False) + "\n").encode()


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]


def _locked(path: Path) -> io.TextIOWrapper:
    """Take the directory's lock; the system drops it when the process ends, however it ends."""
    lock = open(path / LOCK, "w", encoding="utf-8")  # noqa: SIM115 - held until the run directory is closed
    if fcntl is not None:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            lock.close()
            raise BadInputError(f"{path} is in use by another usvjax process") from None
    return lock


def _write(path: Path, content: bytes) -> Path:
    """Write a file so that after a crash it is there whole or not at all."""
    temporary = path.with_name(f"{_TEMPORARY}{path.name}")
    with _clear_errors(path):
        try:
            with open(temporary, "wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            os.replace(temporary, path)
            _sync_folder(path.parent)
        except OSError:
            with suppress(OSError):
                temporary.unlink()
            raise
    return path


def _sync_folder(folder: Path) -> None:
    """Make a rename durable; a folder cannot be opened for this outside POSIX."""
    if fcntl is None:
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


@contextmanager
def _clear_errors(path: Path) -> Iterator[None]:
    """Turn an error of the file system into one line."""
    try:
        yield
    except OSError as error:
        raise BadInputError(
            f"cannot write the run directory at {path}: {error.strerror or error}; what was "
            f"written before is kept, and the same command continues from there"
        ) from error
