"""Several batches at once, each on a device of its own."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

import jax

from usvjax.devices import chosen_devices

Done = TypeVar("Done")


def on_own_devices(jobs: Sequence[Callable[[], Done]]) -> list[Done]:
    """Run jobs on one device each, in turns where there are more of them.

    Kernels are compiled per device: methods that differ in their kernels compile side by side,
    and each only once.

    Args:
        jobs: job k runs on device `device_of(k)`, after those before it there.

    Returns:
        What they returned, in their order.
    """
    count = len(chosen_devices())
    done: dict[int, Done] = {}

    def work(first: int) -> None:
        for k in range(first, len(jobs), count):
            with jax.default_device(devices[k % count]):
                done[k] = jobs[k]()

    devices = [device_of(k) for k in range(count)]
    with ThreadPoolExecutor(max_workers=count) as pool:
        list(pool.map(work, range(count)))
    return [done[k] for k in range(len(jobs))]


def device_of(job: int) -> Any:
    """The device that `on_own_devices` runs a job on."""
    devices = chosen_devices()
    return devices[job % len(devices)]
