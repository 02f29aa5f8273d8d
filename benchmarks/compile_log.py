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

import usvjax  # noqa: F401, gives JAX a device per core

_EVENTS = {
    "/jax/core/compile/jaxpr_trace_duration": "trace_seconds",
    "/jax/core/compile/jaxpr_to_mlir_module_duration": "lower_seconds",
    "/jax/core/compile/backend_compile_duration": "compile_or_load_seconds",
}


class CompileLog:
    """Listens to JAX from when it is made; stretches of several threads that overlap count once."""

    def __init__(self) -> None:
        self._stretches: dict[str, list[tuple[float, float]]] = {k: [] for k in _EVENTS.values()}
        jax.monitoring.register_event_duration_secs_listener(self._note)

    def _note(self, event: str, duration_secs: float, **_: Any) -> None:
        if event in _EVENTS:
            now = time.perf_counter()
            self._stretches[_EVENTS[event]].append((now - duration_secs, now))

    def spent(self) -> dict[str, float]:
        """Seconds in which at least one thread was at it, each kind apart, and of programs."""
        kinds = {name: _covered(stretches) for name, stretches in self._stretches.items()}
        everything = _covered([one for several in self._stretches.values() for one in several])
        programs = len(self._stretches["compile_or_load_seconds"])
        return {"preparing_seconds": everything, "programs": programs, **kinds}


def _covered(stretches: list[tuple[float, float]]) -> float:
    total, until = 0.0, 0.0
    for start, end in sorted(stretches):
        total += max(0.0, end - max(start, until))
        until = max(until, end)
    return total


def _main() -> int:
    log = CompileLog()
    from usvjax.cli import main

    code = main(sys.argv[2:])
    Path(sys.argv[1]).write_text(json.dumps(log.spent()), encoding="utf-8")
    return code


if __name__ == "__main__":
    sys.exit(_main())
