"""How long a process spends on tracing, compiling and loading programs.

As a program: `python -m benchmarks.compile_log LOG COMMAND ...` runs a `usvjax` command and writes
what it spent to LOG.
"""

import json
import sys
import time
from pathlib import Path
from typing import Any

import jax.monitoring

import usvjax  # noqa: F401, before JAX, to which it gives a device per core

_WORK = ("/jax/core/compile/", "/jax/compilation_cache/")


class CompileLog:
    """Listens to JAX from when it is made; stretches that overlap count once."""

    def __init__(self) -> None:
        self._stretches: list[tuple[float, float]] = []
        self._programs = 0
        jax.monitoring.register_event_duration_secs_listener(self._note)

    def _note(self, event: str, seconds: float, **_: Any) -> None:
        if event.startswith(_WORK) and event.endswith(("_duration", "_time_sec")):
            now = time.perf_counter()
            self._stretches.append((now - seconds, now))
        self._programs += event.endswith("backend_compile_duration")

    def spent(self) -> dict[str, float]:
        """Seconds in which at least one thread was at it, and how many programs it was."""
        total, until = 0.0, 0.0
        for start, end in sorted(self._stretches):
            total += max(0.0, end - max(start, until))
            until = max(until, end)
        return {"compile_seconds": total, "programs": self._programs}


def _main() -> int:
    log = CompileLog()
    from usvjax.cli import main

    code = main(sys.argv[2:])
    Path(sys.argv[1]).write_text(json.dumps(log.spent()))
    return code


if __name__ == "__main__":
    sys.exit(_main())
