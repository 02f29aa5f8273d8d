"""Compiled programs: ahead of time for each device, for calls sooner than `jax.jit`; and room."""

from functools import partial
from pathlib import Path
from threading import Lock
from typing import Any
from weakref import WeakSet

import jax
from jax.sharding import SingleDeviceSharding

_MAPPINGS = Path("/proc/self/maps")
_MOST_MAPPINGS = Path("/proc/sys/vm/max_map_count")
"""Linux lets a process map memory 65,530 times unless it was set otherwise."""

_COMPILED = "/jax/core/compile/backend_compile_duration"
_compilations = [0, 0]
"""How many there were in this process, and how many when room was last looked for."""

_instances: WeakSet["Programs"] = WeakSet()


def make_room() -> None:
    """Let all compiled programs go where they have taken half of what the system allows.

    XLA maps the memory of each of a program's kernels three times: fleets take 650 mappings for one
    size of fleet on one device. JAX keeps every program and crashes where mappings run out.
    """
    if _compilations[0] == _compilations[1]:
        return
    _compilations[1] = _compilations[0]
    if mappings() * 2 < most_mappings():
        return
    for programs in _instances:
        programs.forget()
    jax.clear_caches()


def mappings() -> int:
    """Of memory, by this process; 0 where the system does not tell."""
    try:
        with _MAPPINGS.open("rb") as lines:
            return sum(1 for _ in lines)
    except OSError:
        return 0


def most_mappings() -> int:
    """How many mappings a process may have, 65,530 where the system does not tell."""
    try:
        return int(_MOST_MAPPINGS.read_text("ascii"))
    except (OSError, ValueError):
        return 65_530


def _count(event: str, *_: Any, **__: Any) -> None:
    _compilations[0] += event == _COMPILED


jax.monitoring.register_event_duration_secs_listener(_count)


class Programs:
    """Jitted functions as compiled, by device and by a key that says what they depend on."""

    def __init__(self) -> None:
        self._compiled: dict[tuple[Any, jax.Device], Any] = {}
        self._tracing = Lock()
        _instances.add(self)

    def ready(self, key: Any, devices: list[jax.Device]) -> bool:
        """Whether nothing is left to compile on these devices."""
        return all((key, device) in self._compiled for device in devices)

    def forget(self) -> None:
        """Keep none of them; calls that are under way end as they would."""
        self._compiled.clear()

    def run(self, key: Any, device: jax.Device, kernel: Any, *arrays: Any, **static: Any) -> Any:
        """Run a jitted function on a device; numpy arrays go there with the call, not before it.

        Args:
            key: hashable; the same only for the same function, static arguments and shapes.
            device: where to.
            kernel: what `jax.jit` made.
            arrays: pytrees of numpy arrays.
            static: the static arguments.

        Returns:
            Arrays on the device, which may still be under way.
        """
        program = self._compiled.get((key, device))
        if program is None:
            there = partial(_shape_on, SingleDeviceSharding(device))
            with self._tracing:  # the first device traces for all
                traced = kernel.trace(*jax.tree.map(there, arrays), **static)
            program = self._compiled[key, device] = traced.lower().compile()
        return program(*arrays)


def _shape_on(device: SingleDeviceSharding, array: Any) -> jax.ShapeDtypeStruct:
    return jax.ShapeDtypeStruct(array.shape, array.dtype, sharding=device)
