"""Compiling a function as one piece, for XLA's CPU backend."""

from collections.abc import Callable
from typing import Any, TypeVar

import jax
from jax import lax
from jax.experimental.xla_metadata import set_xla_metadata

Out = TypeVar("Out")

_PIECE: dict[str, Any] = {"xla_cpu_small_call": "true", "inlineable": "false"}
_INSIDE: dict[str, Any] = dict.fromkeys(_PIECE)


def single(fn: Callable[..., Out], *args: Any) -> Out:
    """Return fn(*args), compiled as a single machine function on a CPU.

    XLA's CPU runtime dispatches every operation of a loop's body by itself, at 0.2 to 0.3 us
    each and more where it hands them to its thread pool; a body of small operations spends its
    time there. Loops that XLA takes for small are compiled as a whole instead, and the same
    attribute on a call does it for loops of any size: a sweep over 64 grids became ten times
    faster. Worth it for bodies of about 1,000 elements or less, on one thread. An XLA that does
    not know the attribute ignores it; on other devices this is fn(*args).

    What XLA cannot compile in this way ends the process instead of raising (jaxlib 0.10): a large
    reduction, which it hands to a library; a loop whose body is heavy enough for its thread pool;
    an argument that is a slice of another array. Loops over rows of whole arrays are safe.

    Args:
      fn: pure; arrays that it closes over are constants.
      args: its arguments.
    """

    def inside(*args: Any) -> Out:
        with set_xla_metadata(**_INSIDE):  # the mark is for the call, not for what is in it
            return fn(*args)

    def piece(*args: Any) -> Out:
        with set_xla_metadata(**_PIECE):
            return jax.jit(inside)(*args)

    return lax.platform_dependent(*args, cpu=piece, default=fn)
