"""The files of a run's folder: read and written whole, and never through a link.

Others may have put anything there under a name of ours: a link to a file elsewhere, a pipe, a
folder. What is not a plain file is neither read, which could wait for ever, nor written, which
could destroy what the link leads to.
"""

import errno
import hashlib
import json
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from usvjax.errors import BadInputError

TEMPORARY = ".tmp-"
MOST_BYTES = 2**31
"""Of one file; a shard of a million episodes, the most there can be, takes a quarter."""

# Outside POSIX there are none of these, nor the links and pipes that they are for.
_PLAINLY = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)


def open_plain(path: Path, flags: int) -> int:
    """Open a plain file; its descriptor.

    Args:
        path: not a link, though its folder may be reached by one.
        flags: as for `os.open`.

    Raises:
        BadInputError: it is something other than a plain file.
        OSError: it cannot be opened, or is not there.
    """
    try:
        handle = os.open(path, flags | _PLAINLY, 0o644)
    except OSError as error:
        if error.errno in (errno.ELOOP, errno.ENXIO, errno.EISDIR):
            raise BadInputError(f"{path} is a {_kind(path)}; wanted a plain file") from None
        raise
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise BadInputError(f"{path} is a {_kind(path)}; wanted a plain file")
    return handle


def read_plain(path: Path) -> bytes:
    """The content of a plain file.

    Raises:
        BadInputError: it is something other than a plain file, or too large to be ours.
        OSError: it cannot be read, or is not there.
    """
    with os.fdopen(open_plain(path, os.O_RDONLY), "rb") as file:
        size = os.fstat(file.fileno()).st_size
        if size > MOST_BYTES:
            raise BadInputError(f"{path} has {size:,} bytes; wanted at most {MOST_BYTES:,}")
        return file.read()


def read_json(path: Path) -> Any:
    """The value that a plain file holds as JSON; errors as `read_plain`.

    Raises:
        ValueError: it holds no JSON.
    """
    try:
        return json.loads(read_plain(path))
    except RecursionError as error:
        raise ValueError("it is nested too deeply") from error


def json_bytes(value: Any) -> bytes:
    """A value as the content of a JSON file."""
    return (json.dumps(value, indent=2, sort_keys=True, allow_nan=False) + "\n").encode()


def digest(content: bytes) -> str:
    """SHA-256 of a file's content, 64 hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def write_plain(path: Path, content: bytes) -> None:
    """Write a file so that after a crash it is there whole or not at all.

    Raises:
        OSError: it cannot be written.
    """
    temporary = path.with_name(f"{TEMPORARY}{path.name}")
    temporary.unlink(missing_ok=True)
    try:
        # A file that nobody else has made in the meantime, and no link.
        with os.fdopen(open_plain(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL), "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
        _sync_folder(path.parent)
    except OSError:
        with suppress(OSError):
            temporary.unlink()
        raise


def make_folder(path: Path) -> None:
    """Make a folder inside a run's, where it is not there.

    Raises:
        BadInputError: something else, such as a link, has its name.
        OSError: it cannot be made.
    """
    path.mkdir(exist_ok=True)
    check_no_link(path)


def check_no_link(path: Path) -> None:
    """Raise BadInputError where a folder inside a run's is a link to one elsewhere."""
    if path.is_symlink():
        raise BadInputError(
            f"{path} is a link; nothing is written through a link inside a run, so put the folder "
            f"itself there, or let the run's own folder be the link"
        )


@contextmanager
def in_one_line(doing: str, kept: Callable[[], bool] = lambda: False) -> Iterator[None]:
    """Turn an error of the file system into one line.

    Args:
        doing: what cannot be done, such as "read the run at runs/a".
        kept: says whether episodes are on disk, from which the same command continues.
    """
    try:
        yield
    except OSError as error:
        rest = "; what was written before is kept, and the same command continues from there"
        raise BadInputError(
            f"cannot {doing}: {error.strerror or error}{rest if kept() else ''}"
        ) from error


def _kind(path: Path) -> str:
    """What stands under a name, in a word."""
    with suppress(OSError):
        mode = os.lstat(path).st_mode
        for word, test in (
            ("link", stat.S_ISLNK),
            ("folder", stat.S_ISDIR),
            ("pipe", stat.S_ISFIFO),
            ("socket", stat.S_ISSOCK),
        ):
            if test(mode):
                return word
    return "device"


def _sync_folder(folder: Path) -> None:
    """Make a rename durable; a folder cannot be opened for this outside POSIX."""
    if os.name != "posix":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
