"""Reading and writing whole files: one clear error, and never half a file."""

import hashlib
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from usvjax.errors import BadInputError

_NOTED: ContextVar[dict[Path, str] | None] = ContextVar("noted", default=None)


@contextmanager
def noting_reads() -> Iterator[dict[Path, str]]:
    """Note every file that is read within: SHA-256 of its content, by its path as it was asked."""
    noted: dict[Path, str] = {}
    before = _NOTED.set(noted)
    try:
        yield noted
    finally:
        _NOTED.reset(before)


def read_bytes(path: Path) -> bytes:
    """Return a file's content.

    Raises:
        BadInputError: it is missing, a directory, not permitted, or cannot be read.
    """
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise BadInputError(f"{path}: no such file") from None
    except OSError as error:
        raise BadInputError(f"{path}: cannot be read ({error.strerror})") from error
    if (noted := _NOTED.get()) is not None:
        noted[path] = hashlib.sha256(content).hexdigest()
    return content


def write_all(files: Mapping[Path, bytes]) -> None:
    """Write files, each under a temporary name that is synced and then renamed.

    All contents are on disk before the first rename, so a full disk, a missing folder or an
    interruption leaves every existing file as it was.

    Raises:
        BadInputError: a file cannot be written.
    """
    for path in files:
        if path.is_dir():
            raise BadInputError(f"{path}: cannot be written (is a directory)")
    pending: dict[Path, tuple[Path, Path]] = {}
    try:
        for path, content in files.items():
            # Through a link, so that a rename does not replace the link itself.
            target = Path(os.path.realpath(path))
            temporary = target.with_name(f".{target.name}.{os.getpid()}.tmp")
            pending[path] = temporary, target
            _write_synced(temporary, content)
        for path in pending:
            os.replace(*pending[path])
    except OSError as error:
        raise BadInputError(f"{path}: cannot be written ({error.strerror})") from error
    finally:
        for temporary, _ in pending.values():
            temporary.unlink(missing_ok=True)


def _write_synced(path: Path, content: bytes) -> None:
    with path.open("wb") as stream:
        stream.write(content)
        stream.flush()
        os.fsync(stream.fileno())
