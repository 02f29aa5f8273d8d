"""Where compute runs: one host device per core, a compilation cache, work shared out."""

import contextlib
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from usvjax.checks import shown, whole_number
from usvjax.errors import BadInputError

if TYPE_CHECKING:
    import jax

_CACHE = "jax_compilation_cache_dir"
_USUAL_SECONDS = 1.0
"""Of compiling, from which JAX keeps a kernel unless it is told otherwise."""

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

MOST_DEVICES = 4096
"""Of a host: each takes threads of its own."""

_started = _forked = False


def _note_fork() -> None:
    global _forked
    _forked = _started


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_note_fork)

Item = TypeVar("Item")
Done = TypeVar("Done")


def use_all_cores(count: int | None = None) -> None:
    """Ask JAX for one host device per core, where JAX has not started yet.

    XLA's own thread pool gains nothing on these kernels; a device per core does. A setting
    that the user made (JAX_NUM_CPU_DEVICES, XLA_FLAGS with a count of host devices, or a JAX
    already started) stays as it is.

    Args:
        count: number of host devices, 1 to MOST_DEVICES; by default the cores that this
            process may use.

    Raises:
        BadTypeError, BadInputError: not such a number.
    """
    count = None if count is None else whole_number("count", count, 1)
    if count is not None and count > MOST_DEVICES:
        raise BadInputError(f"count: got {shown(count)}; wanted at most {MOST_DEVICES:,}")
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


def use_compilation_cache(folder: Path | None = None) -> Path | None:
    """Keep compiled kernels between runs, so that a second start does not compile.

    What the user has set, by JAX's own variables or in `jax.config`, stays as it is.

    Args:
        folder: where; by default what the user has set, else usvjax/ in the user's cache folder.

    Returns:
        The folder; None where there is no place to keep anything, which is said on stderr.
    """
    import jax

    seconds = "jax_persistent_cache_min_compile_time_secs"
    if seconds.upper() not in os.environ and getattr(jax.config, seconds) == _USUAL_SECONDS:
        jax.config.update(seconds, 0.1)
    chosen = folder or getattr(jax.config, _CACHE) or _cache_folder()
    if chosen is None:
        print(
            "usvjax: no folder to keep compiled kernels in, so they are compiled anew each time; "
            "XDG_CACHE_HOME or JAX_COMPILATION_CACHE_DIR may name one",
            file=sys.stderr,
        )
        return None
    jax.config.update(_CACHE, str(chosen))
    return Path(chosen)


def _cache_folder() -> Path | None:
    """Ours in the user's cache folder, where it can be written."""
    try:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        folder = base / "usvjax" / "compiled"
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError):  # no home either
        return None
    return folder if os.access(folder, os.W_OK) else None


@contextlib.contextmanager
def naming_the_platform() -> Iterator[None]:
    """Turn an error within into one line, where the reason is a platform that JAX cannot start.

    Raises:
        BadInputError: with that line, which names the setting.
    """
    try:
        yield
    except (RuntimeError, AssertionError) as error:
        if _starts():
            raise
        import jax

        platforms = getattr(jax.config, "jax_platforms")  # noqa: B009, the stubs lack it
        if not platforms:
            raise BadInputError(f"JAX cannot start on this machine: {error}") from error
        raise BadInputError(
            f"JAX cannot start on this machine with JAX_PLATFORMS={platforms}; unset it, or set it "
            f"to a platform that is here, such as cpu"
        ) from error


def _starts() -> bool:
    """Whether JAX has started or can be."""
    if "jax" not in sys.modules:
        return True
    try:
        import jax

        return bool(jax.local_devices())
    except (RuntimeError, AssertionError):
        return False


def local_devices(backend: str | None = None) -> "list[jax.Device]":
    """The devices of this machine, of JAX's own choice of platform or of one by name.

    Raises:
        BadInputError: JAX cannot start, or would hang because it had started before a fork.
    """
    import jax

    global _started
    if _forked:
        raise BadInputError(
            "JAX had started before this process was forked, and would wait for ever here; start "
            'processes by multiprocessing.get_context("spawn")'
        )
    with naming_the_platform():
        found = jax.local_devices(backend=backend)
    _started = True
    return found


def chosen_devices() -> "list[jax.Device]":
    """The one device of `jax.default_device`, where it is set; else all local devices.

    Raises:
        BadInputError: as `local_devices`.
    """
    import jax

    chosen = getattr(jax.config, "jax_default_device")  # noqa: B009, the stubs lack it
    if isinstance(chosen, jax.Device):
        return [chosen]
    return local_devices(chosen)


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
    # Not at the top, for a command should soon be able to say that it was interrupted.
    import queue
    from concurrent.futures import ThreadPoolExecutor

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
