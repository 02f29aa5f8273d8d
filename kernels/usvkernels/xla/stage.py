"""Computing a stage of a loop's body once, for XLA's CPU backend."""

from collections.abc import Callable
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
from jax import Array, lax

Out = TypeVar("Out")


def stage(go: Array, fn: Callable[..., Out], *args: Any) -> Out:
    """Return fn(*args), with its results computed once and stored.

    XLA fuses cheap arithmetic into every operation that uses it: an index that takes a hundred
    operations to find is then found again for each element of every gather and scatter behind
    it, in scalar code, because these flatten their index arrays. `lax.optimization_barrier`
    does not prevent it on a CPU. A branch that the compiler cannot decide does, for about
    0.3 us; a step of A* became eight times faster. On other devices this is fn(*args).

    Stages also keep a loop's body short. XLA's CPU runtime runs up to eight operations one after
    the other; a longer body or branch goes through a scheduler, with its queue on the heap, at
    1.5 us more for 40 operations. So a decision of DWA, in bodies and branches of eight operations
    or less, takes 10.1 us instead of 11.7 for 16 lanes.

    Args:
        go: bool[], True, and an operand of the compiled function, so that the compiler does not
            know. With False, the results are zeros.
        fn: pure; what it closes over counts as an argument.
        args: its arguments.
    """

    def guarded(*args: Any) -> Out:
        out = jax.eval_shape(fn, *args)
        zeros = jax.tree.map(lambda leaf: jnp.zeros(leaf.shape, leaf.dtype), out)
        return lax.cond(go, fn, lambda *_: zeros, *args)

    return lax.platform_dependent(*args, cpu=guarded, default=fn)
