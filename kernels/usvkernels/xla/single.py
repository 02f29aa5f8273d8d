"""Compiling a function as one piece, for XLA's CPU backend."""

from collections.abc import Callable
from itertools import compress
from typing import Any, TypeVar

import jax
from jax import lax
from jax.experimental.xla_metadata import set_xla_metadata
from jax.extend.core import ClosedJaxpr, jaxpr_as_fun
from jax.interpreters.partial_eval import dce_jaxpr

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
    an argument that is a slice of another array. Loops over rows of whole arrays are safe. An
    argument that nothing comes of would end it too, and is left out.

    Args:
        fn: pure; arrays that it closes over are constants.
        args: its arguments.
    """
    traced, shape = jax.make_jaxpr(fn, return_shape=True)(*args)
    jaxpr, used = dce_jaxpr(traced.jaxpr, [True] * len(traced.out_avals))
    needed = jaxpr_as_fun(ClosedJaxpr(jaxpr, traced.consts))

    def inside(*leaves: Any) -> list[Any]:
        with set_xla_metadata(**_INSIDE):  # the mark is for the call, not for what is in it
            return needed(*leaves)

    def piece(*leaves: Any) -> list[Any]:
        with set_xla_metadata(**_PIECE):
            return jax.jit(inside)(*leaves)

    leaves = compress(jax.tree.leaves(args), used)
    out = lax.platform_dependent(*leaves, cpu=piece, default=needed)
    return jax.tree.unflatten(jax.tree.structure(shape), out)
