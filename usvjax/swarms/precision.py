"""Double precision for a while."""

from contextlib import AbstractContextManager

import jax


def precision(double: bool) -> AbstractContextManager[None]:
    """Compute in float64, or in float32, inside a `with` block and in this thread alone."""
    if hasattr(jax, "enable_x64"):
        return jax.enable_x64(double)
    from jax.experimental import enable_x64  # type: ignore[attr-defined]

    return enable_x64(double)
