"""Where compute runs: one host device per core, a compilation cache, work shared out."""

import contextlib
import os
import queue
import sys
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from usvjax.errors import BadInputError, BadTypeError

if TYPE_CHECKING:
    import jax

_VARIABLE = "JAX_NUM_CPU_DEVICES"
_FLAG = "xla_force_host_platform_device_count"

COMPILER_OPTIONS = {"xla_cpu_prefer_vector_width": "512"}
"""For `jax.jit`: full vectors where the processor has them, a quarter faster on such a CPU."""

QUICKLY_COMPILED = {"xla_backend_optimization_level": 1}
"""For `jax.jit`: a third less time to compile; on some kernels (of paths, planners) no slower."""

ONE_THREAD = {"xla_disable_hlo_passes": "cpu-parallel-task-assigner"}
"""For `jax.jit`, where all devices have work: no operation is split over XLA's thread pool.

With the pool, one device alone is faster (DWA by 12 %, a few long tours up to twice), on twice the
time of the cores; where each core has a device of its own at work, it costs a few per cent.
"""

Item = TypeVar("Item")
Done = TypeVar("Done")


def use_all_cores(count: int | None = None) -> None:
    """Ask JAX for one host device per core, where JAX has not started yet.

    XLA's own thread pool gains nothing on these kernels; a device per core does. A setting
    that the user made (JAX_NUM_CPU_DEVICES, XLA_FLAGS with a count of host devices, or a JAX
    already started) stays as it is.

    Args:
        count: number of host devices, 1 or more; by default the cores that this process may use.

    Raises:
        BadTypeError, BadInputError: not such a number.
    """
    if count is not None and (isinstance(count, bool) or not isinstance(count, int)):
        raise BadTypeError(f"count: got {type(count).__name__}; wanted a whole number")
    if count is not None and count < 1:
        raise BadInputError(f"count: got {count}; wanted 1 or more")
    made = _VARIABLE in os.environ or _FLAG in os.environ.get("XLA_FLAGS", "")
    if made and count is None:
        return
    count = count or usable_cores()
    os.environ[_VARIABLE] = str(count)
    if "jax" not in sys.modules:
        return  # JAX reads the variable when it is imported, which we need not hurry.
    import jax

    # Refused where JAX is running already; the devices that it has work as well.
    with contextlib.suppress(RuntimeError):
        jax.config.update("jax_num_cpu_devices", count)


def usable_cores() -> int:
    """Cores that this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def use_compilation_cache(folder: Path | None = None) -> Path:
    """Keep compiled kernels between runs, so that a second start does not compile.

    Args:
        folder: where; by default usvjax/ in the user's cache folder.

    Returns:
        The folder.
    """
    import jax

    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    folder = folder or base / "usvjax" / "compiled"
    jax.config.update("jax_compilation_cache_dir", str(folder))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.1)
    jax.config.update("jax_persistent_cache_min_entry_size_bytes", 0)
    return folder


def chosen_devices() -> "list[jax.Device]":
    """The one device of `jax.default_device`, where it is set; else all local devices."""
    import jax

    chosen = getattr(jax.config, "jax_default_device")  # noqa: B009, the stubs lack it
    if isinstance(chosen, jax.Device):
        return [chosen]
    return jax.local_devices(backend=chosen)


def share_out(
    work: "Callable[[Item, jax.Device], Done]", items: Iterable[Item], devices: "list[jax.Device]"
) -> Iterator[Done]:
    """Run work(item, device) over the items, each device taking the next when it is free.

    Args:
        work: called from one thread per device.
        items: in order.
        devices: to run on.

    Yields:
        What `work` returned, in the order of the items.
    """
    from usvjax.ambient import pinned

    free: queue.SimpleQueue[jax.Device] = queue.SimpleQueue()
    for device in devices:
        free.put(device)

    def on_free_device(item: Item) -> Done:
        device = free.get()
        try:
            with pinned():  # which holds for one thread only
                return work(item, device)
        finally:
            free.put(device)

    with ThreadPoolExecutor(max_workers=len(devices)) as pool:
        yield from pool.map(on_free_device, items)
