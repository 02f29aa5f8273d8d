"""Random maps of cells, each blocked with the same probability."""

import math
from typing import Any

import jax
import numpy as np

from usvjax import checks
from usvjax.checks import shown, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.keys import as_key
from usvjax.maps.grid_map import check_size
from usvjax.maps.tables import check_share
from usvjax.memory import check_memory
from usvjax.public import public
from usvkernels import grids

# Cells drawn per call: bounds the memory of the uniform fields to 64 MB.
_CELLS_PER_CALL = 4_000_000
_BYTES_DRAWN = 16

_draw = jax.jit(grids.random_blocked, static_argnums=(1, 2))


@public("usvkernels.grids")
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
        key: a seed (integer from 0 to 2**32 - 1) or a JAX threefry key.
        n: number of maps, >= 1.
        shape: (H, W), rows and columns.
        density: probability in [0, 1] that a cell is blocked.
        first: index j of the first map, so that shards can draw their own.

    Returns:
        bool[n, H, W], True = not navigable.

    Raises:
        BadTypeError: ``key``, ``n``, ``shape`` or ``density`` has the wrong type.
        BadInputError: ``n`` or a side of ``shape`` is below 1, ``density`` lies outside
            [0, 1], ``first`` is negative, the seed or an index exceeds 32 bits, or the maps
            need more memory than there is.
    """
    stream = as_key(key)
    n = whole_number("n", n, 1)
    height, width = _as_shape(shape)
    level = np.float32(checks.fraction("density", density))
    first = whole_number("first", first, 0)
    if first + n > 2**32:
        raise BadInputError(f"first + n: got {first} + {n}; wanted at most 2**32")
    chunk = min(n, max(1, _CELLS_PER_CALL // (height * width)))
    needed = (n + _BYTES_DRAWN * chunk) * height * width
    check_memory(needed, f"n: {n} maps of {shown(height)} x {shown(width)} cells")
    maps = np.empty((n, height, width), bool)
    for start in range(0, n, chunk):
        # Always the same chunk, so that one compiled program serves every call.
        drawn = _draw(stream, chunk, (height, width), level, np.uint32(first + start))
        maps[start : start + chunk] = np.asarray(drawn)[: n - start]
    return maps


def _as_shape(shape: Any) -> tuple[int, int]:
    if not isinstance(shape, tuple | list) or len(shape) != 2:
        raise BadTypeError(f"shape: got {shown(shape)}; wanted (H, W)")
    return whole_number("shape[0]", shape[0], 1), whole_number("shape[1]", shape[1], 1)


def maps_of_jobs(seed: int, jobs: np.ndarray, shape: tuple[int, int], density: float) -> np.ndarray:
    """The random maps of some jobs: job j's is map j of `random_maps`.

    Args:
        seed: of the study.
        jobs: int64[J], in any order.
        shape: (H, W), rows and columns.
        density: probability in [0, 1] that a cell is blocked.

    Returns:
        bool[J, H, W], True = not navigable.
    """
    if len(jobs) and (np.diff(jobs) == 1).all():
        return random_maps(seed, len(jobs), shape, density, first=int(jobs[0]))
    # Another number of maps is another program to compile; one at a time there is only one.
    alone = [random_maps(seed, 1, shape, density, first=int(job)) for job in jobs]
    return np.concatenate([np.empty((0, *shape), bool), *alone])


def check_cells(shape: tuple[int, int], density: float, cell_size: float, where: str) -> None:
    """Refuse random maps that cannot be.

    Raises:
        BadInputError: a map is too large, a density is not in [0, 1], or a cell has no edge.
    """
    check_size(*shape, f"{where}: a map of 'shape'", _BYTES_DRAWN)
    check_share("density", density, where)
    if not 0.0 < cell_size < math.inf:
        raise BadInputError(f"{where}: 'cell_size' must be above 0, got {cell_size:g}")


class OnOwnMaps:
    """What a source of scenes says where every job has a map of its own."""

    @property
    def origin(self) -> tuple[float, float]:
        """South-west corner of cell (0, 0), m."""
        return 0.0, 0.0

    @property
    def chart(self) -> None:
        """Every job has a map of its own."""
        return None

    @property
    def most_jobs(self) -> None:
        """Any number can be drawn."""
        return None
