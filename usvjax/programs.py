"""Programs compiled ahead of time for each device, which are called sooner than `jax.jit` calls."""

from functools import partial
from threading import Lock
from typing import Any

import jax
from jax.sharding import SingleDeviceSharding


class Programs:
    """Jitted functions as compiled, by device and by a key that says what they depend on."""

    def __init__(self) -> None:
        self._compiled: dict[tuple[Any, jax.Device], Any] = {}
        self._tracing = Lock()

    def ready(self, key: Any, devices: list[jax.Device]) -> bool:
        """Whether nothing is left to compile on these devices."""
        return all((key, device) in self._compiled for device in devices)

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
