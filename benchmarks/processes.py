"""Fresh Python processes that answer calls, so that contestants do not share a start.

A process can be bound to some cores before it imports anything, given a cache folder of its own,
asked for its peak memory, or killed. Calls name module-level functions; arguments and answers
travel as pickles.
"""

import importlib
import os
import pickle
import struct
import subprocess
import sys
import traceback
from collections.abc import Callable, Mapping
from types import TracebackType
from typing import IO, Any

# Set by `import usvjax` for the process that did so; a child counts its own cores.
_NOT_INHERITED = ("JAX_NUM_CPU_DEVICES",)


class ProcessFailedError(RuntimeError):
    """A call raised in the other process, or the process ended; holds its traceback."""


class FreshProcess:
    """One more Python; use it in a `with` block."""

    def __init__(
        self,
        *,
        cores: int | None = None,
        variables: Mapping[str, str] | None = None,
        python: str = sys.executable,
    ):
        """Start it.

        Args:
            cores: how many of the usable cores to bind it to; all when None.
            variables: environment variables to set.
            python: the interpreter, for a peer with an environment of its own.
        """
        command = [python, "-m", "benchmarks.processes", str(cores or 0)]
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment(variables),
        )

    def __enter__(self) -> "FreshProcess":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._process.kill() if error else self._process.stdin.close()  # type: ignore[union-attr]
        self._process.wait()

    def call(self, function: Callable[..., Any] | str, *args: Any) -> Any:
        """Call a module-level function there and return what it returns.

        Args:
            function: the function, or "package.module:name" of one that is not imported here.
            args: anything that can be pickled.

        Raises:
            ProcessFailedError: it raised, or the process ended.
        """
        name = function
        if not isinstance(name, str):
            name = f"{name.__module__}:{name.__qualname__}"
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        _send(self._process.stdin, (name, args))
        try:
            worked, answer = _receive(self._process.stdout)
        except EOFError:
            raise ProcessFailedError(f"{name}: exit code {self._process.wait()}") from None
        if not worked:
            raise ProcessFailedError(f"{name}:\n{answer}")
        return answer


def environment(variables: Mapping[str, str] | None = None) -> dict[str, str]:
    """The environment of this process for another one, with some variables set."""
    inherited = {k: v for k, v in os.environ.items() if k not in _NOT_INHERITED}
    return {**inherited, **(variables or {})}


def peak_memory() -> int:
    """Most memory that this process has held at a time, bytes.

    Not `ru_maxrss` where the kernel says better: that one also remembers the parent, which the
    process was a copy of before it became this program.
    """
    try:
        with open("/proc/self/status", encoding="utf-8") as status:
            line = next(line for line in status if line.startswith("VmHWM"))
        return int(line.split()[1]) * 1024
    except (OSError, StopIteration):
        import resource

        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return most if sys.platform == "darwin" else most * 1024


def _send(pipe: IO[bytes], message: Any) -> None:
    content = pickle.dumps(message)
    pipe.write(struct.pack("<Q", len(content)) + content)
    pipe.flush()


def _receive(pipe: IO[bytes]) -> Any:
    header = pipe.read(8)
    if len(header) < 8:
        raise EOFError
    return pickle.loads(pipe.read(struct.unpack("<Q", header)[0]))


def _bind(cores: int) -> None:
    if cores:
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:cores])


def _serve() -> None:
    _bind(int(sys.argv[1]))
    # Whatever the called functions print goes to stderr and does not garble the answers.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while True:
        try:
            name, args = _receive(sys.stdin.buffer)
        except EOFError:
            return
        try:
            module, _, function = name.partition(":")
            answer = True, getattr(importlib.import_module(module), function)(*args)
        except Exception:
            answer = False, traceback.format_exc()
        _send(answers, answer)


if __name__ == "__main__":
    _serve()
