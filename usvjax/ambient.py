"""JAX's ambient settings, pinned, so that nothing usvjax computes depends on them.

A user may have asked JAX for double precision, for another generator, for strict promotion of
types or for an error at every NaN. Our kernels are written, tested and timed under the settings
here; within `pinned` they meet no others, whatever the process was started with.
"""

from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager

import jax

GENERATOR = "threefry2x32"
"""Of all random numbers; JAX's default."""

_PINNED = {
    "default_prng_impl": GENERATOR,
    "threefry_partitionable": True,
    "numpy_dtype_promotion": "standard",
    "numpy_rank_promotion": "allow",
    "debug_nans": False,  # NaN stands for "no figure" in results
    "debug_infs": False,
    "debug_key_reuse": False,
    "legacy_prng_key": "allow",
    "default_matmul_precision": None,
    "transfer_guard": "allow",
}
"""Context managers of `jax`, by name, with what they are called with."""

# Those that this JAX has, looked up once: every public call enters them.
_MANAGERS = [(getattr(jax, name), value) for name, value in _PINNED.items() if hasattr(jax, name)]


@contextmanager
def pinned() -> Iterator[None]:
    """Compute under our own settings inside a `with` block and in this thread alone."""
    with ExitStack() as stack:
        stack.enter_context(precision(double=False))
        for manager, value in _MANAGERS:
            stack.enter_context(manager(value))
        yield


def precision(double: bool) -> AbstractContextManager[None]:
    """Compute in float64, or in float32, inside a `with` block and in this thread alone."""
    if hasattr(jax, "enable_x64"):
        return jax.enable_x64(double)
    from jax.experimental import enable_x64  # type: ignore[attr-defined]

    return enable_x64(double)
