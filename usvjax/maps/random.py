"""Random maps for Monte Carlo studies."""

from typing import Any

import jax
import numpy as np

from usvjax import checks
from usvjax.checks import whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.keys import as_key
from usvkernels import grids

# Cells drawn per call: bounds the memory of the uniform fields (16 bytes a cell) to 64 MB.
_CELLS_PER_CALL = 4_000_000

_draw = jax.jit(grids.random_blocked, static_argnums=(1, 2))


def random_maps(
    key: Any,
    n: int,
    shape: tuple[int, int] = (50, 50),
    density: float = 0.1,
    *,
    first: int = 0,
) -> np.ndarray:
    """Draw maps whose cells are blocked independently with probability ``density``.

    Map j depends on the key, j and the shape alone: a longer list, another shard of it or
    another device gives the same map, and a higher density only adds blocked cells to it.

    Args:
        key: A seed (integer from 0 to 2**32 - 1) or a JAX threefry key.
        n: Number of maps, >= 1.
        shape: (H, W), rows and columns.
        density: Probability in [0, 1] that a cell is blocked.
        first: Index j of the first map, so that shards can draw their own.

    Returns:
        bool[n, H, W], True = not navigable.

    Raises:
        BadTypeError: ``key``, ``n``, ``shape`` or ``density`` has the wrong type.
        BadInputError: ``n`` or a side of ``shape`` is below 1, ``density`` lies outside
            [0, 1], ``first`` is negative, or the seed or an index exceeds 32 bits.
    """
    stream = as_key(key)
    n = whole_number("n", n, 1)
    height, width = _as_shape(shape)
    level = np.float32(checks.fraction("density", density))
    first = whole_number("first", first, 0)
    if first + n > 2**32:
        raise BadInputError(f"first + n: got {first} + {n}; wanted at most 2**32")
    chunk = min(n, max(1, _CELLS_PER_CALL // (height * width)))
    maps = np.empty((n, height, width), bool)
    for start in range(0, n, chunk):
        # Always the same chunk, so that one compiled program serves every call.
        drawn = _draw(stream, chunk, (height, width), level, np.uint32(first + start))
        maps[start : start + chunk] = np.asarray(drawn)[: n - start]
    return maps


def _as_shape(shape: Any) -> tuple[int, int]:
    if not isinstance(shape, tuple | list) or len(shape) != 2:
        raise BadTypeError(f"shape: got {shape!r}; wanted (H, W)")
    return whole_number("shape[0]", shape[0], 1), whole_number("shape[1]", shape[1], 1)
