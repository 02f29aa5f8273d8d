"""The process of a command: signals, standard output, and a home that may be missing.

A signal to stop is one line and an exit code of 128 and its number, as shells have it: 130 for
Ctrl-C, 143 for the SIGTERM that cluster schedulers send. Standard output that cannot be written
is one line as well.
"""

import atexit
import io
import os
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

EXIT_OUTPUT = 1
EXIT_SIGNAL = 128

_STOPPING = (signal.SIGINT, signal.SIGTERM)

_received: list[int] = []


@contextmanager
def stopped_by_signals(to_the_end: bool) -> Iterator[None]:
    """Raise KeyboardInterrupt on Ctrl-C and SIGTERM within, or leave at once while importing.

    An interrupt in the midst of an import would come out as whatever the module under way makes
    of it.

    Args:
        to_the_end: whether the process ends with this; then signals after it leave at once.
    """
    _received.clear()
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in _STOPPING}
    # What a shell has set to be ignored, such as Ctrl-C of a job in the background, stays so.
    ours = [number for number, old in before.items() if old not in (signal.SIG_IGN, None)]
    for number in ours:
        signal.signal(number, _stop)
    try:
        yield
    finally:
        for number in ours:
            signal.signal(number, _leave_at_once if to_the_end else before[number])


def was_stopped() -> bool:
    """Whether a signal to stop has come."""
    return bool(_received)


def exit_code() -> int:
    """That of a process that was told to stop; by Ctrl-C where no signal said so."""
    return EXIT_SIGNAL + (_received[0] if _received else signal.SIGINT)


def _stop(number: int, frame: FrameType | None) -> None:
    _received.append(number)
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            _leave_at_once(number, frame)
        frame = frame.f_back
    raise KeyboardInterrupt


def _leave_at_once(number: int, _: FrameType | None) -> None:
    with suppress(OSError):
        os.write(2, b"usvjax: interrupted\n")
    os._exit(EXIT_SIGNAL + number)


def flush() -> None:
    """Write out what was printed.

    Raises:
        OSError: it cannot be written.
    """
    if sys.stdout is not None:
        sys.stdout.flush()


def output_fails() -> bool:
    """Whether an error was one of writing to standard output, which then fails again."""
    try:
        flush()
        os.write(sys.stdout.fileno(), b"\n")
    except io.UnsupportedOperation:  # no file of the system is behind it
        return False
    except OSError:
        return True
    return False


def drop_output() -> None:
    """Let what cannot be written go; without this, Python would complain on exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def prepare() -> None:
    """See to what a process may lack: open standard streams, and a folder for matplotlib."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
    if "MPLCONFIGDIR" not in os.environ and not _has_home():
        # It would warn at length, or fail.
        folder = tempfile.mkdtemp(prefix="usvjax-")
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        os.environ["MPLCONFIGDIR"] = folder


def _has_home() -> bool:
    try:
        return os.access(Path.home(), os.W_OK)
    except RuntimeError:  # neither HOME nor an entry among the users
        return False
