"""Reading and writing whole files: one clear error, never half a file, never an endless one."""

import codecs
import errno
import hashlib
import os
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from usvjax.checks import byte_size, shown
from usvjax.errors import BadInputError

MOST_BYTES = 2**29
"""Largest file of cells that is read: a map, an image."""
MOST_QUERIES = 2**25
"""Largest scenario file that is read."""
MOST_TEXT = 2**20
"""Largest file of settings that is read: a study, a plug-in, a sidecar, a map_server file."""

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


_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
# A file may not say its size, as those of /proc, and have no end.
_UNSIZED = 2**20
_AT_ONCE = getattr(os, "O_NONBLOCK", 0)


def read_bytes(path: Path, most: int = MOST_BYTES) -> bytes:
    """Return a file's content.

    Args:
        path: the file.
        most: bytes that it may have.

    Raises:
        BadInputError: it is missing, a directory, a device or a pipe, not permitted, larger than
            `most`, or cannot be read.
    """
    try:
        status = os.stat(path)
        if not stat.S_ISREG(status.st_mode):
            raise BadInputError(f"{path}: cannot be read (is {_kind(status)}, wanted a file)")
        size = max(status.st_size, min(_UNSIZED, most))
        if size <= most:
            with open(path, "rb", opener=lambda name, how: os.open(name, how | _AT_ONCE)) as stream:
                content = stream.read(size + 1) or b""
            if len(content) <= size:
                if (noted := _NOTED.get()) is not None:
                    noted[path] = hashlib.sha256(content).hexdigest()
                return content
    except FileNotFoundError:
        raise BadInputError(f"{path}: no such file") from None
    except OSError as error:
        name = shown(str(path)) if error.errno == errno.ENAMETOOLONG else path
        raise BadInputError(f"{name}: cannot be read ({error.strerror})") from error
    except UnicodeEncodeError:
        raise BadInputError(f"{path}: no such file (its name cannot be encoded)") from None
    raise BadInputError(f"{path}: cannot be read (larger than {byte_size(most)}, or endless)")


def read_text_bytes(path: Path, most: int = MOST_TEXT) -> bytes:
    """Return the content of a text file in UTF-8 or ASCII, without a byte order mark.

    Raises:
        BadInputError: as of `read_bytes`, or it is UTF-16 or no text.
    """
    content = read_bytes(path, most)
    if content.startswith(_UTF_16):
        raise BadInputError(f"{path}: is UTF-16; wanted a text file in UTF-8")
    content = content.removeprefix(codecs.BOM_UTF8)
    if b"\0" in content:
        raise BadInputError(f"{path}: holds NUL characters; wanted a text file in UTF-8")
    return content


def read_text(path: Path, most: int = MOST_TEXT) -> str:
    """Return a text file in UTF-8, without a byte order mark.

    Raises:
        BadInputError: as of `read_text_bytes`, or it is not UTF-8.
    """
    content = read_text_bytes(path, most)
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise BadInputError(f"{path} line {line}: not a text file in UTF-8") from None


def _kind(status: os.stat_result) -> str:
    if stat.S_ISDIR(status.st_mode):
        return "a directory"
    return "a pipe" if stat.S_ISFIFO(status.st_mode) else "a device or a socket"


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
