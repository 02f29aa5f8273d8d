"""Obstacles as vessels sense them: circles padded to few sizes, or what is near on a map."""

from functools import lru_cache
from math import sqrt
from typing import Any

import numpy as np

from usvjax.maps.grid_map import GridMap
from usvjax.maps.obstacles import obstacle_table
from usvkernels.dwa.charted import Charted
from usvkernels.dwa.clearance import FAR

MOST_REMOTE = 2e5
"""Largest coordinate (m) of a vessel: there, single precision resolves 16 mm."""


def padded(centres: np.ndarray, shown: np.ndarray | None = None) -> np.ndarray:
    """Centres [B, K, 2] as float32[B, 2, K'], K' a multiple of 8 so that few shapes are compiled.

    FAR pads, and stands where `shown`, bool[B, K] or [K], is False.
    """
    if shown is not None and shown.ndim == 2:
        centres = np.broadcast_to(centres, (len(shown), *centres.shape[1:]))
    maps, count, _ = centres.shape
    packed = np.full((maps, 2, max(8, -(-count // 8) * 8)), FAR, np.float32)
    inside = packed[:, :, :count]
    # What is farther than FAR is as far, and float32 holds it.
    np.clip(centres.swapaxes(1, 2), -FAR, FAR, out=inside, casting="same_kind")
    if shown is not None:
        np.copyto(inside, np.float32(FAR), where=~shown[..., None, :])
    return packed


@lru_cache(maxsize=4)
def charted(grid: GridMap, reach: float) -> Charted:
    """What vessels on a map sense that see so far (m)."""
    # The table holds for a whole cell: a vessel in its corner sees half a diagonal farther.
    table: Any = obstacle_table(grid.blocked, None, reach / grid.cell_size + sqrt(0.5))
    width: Any = np.int32(grid.shape[1])
    cell_size: Any = np.float32(grid.cell_size)
    return Charted(table=table.reshape(-1, table.shape[-1]), width=width, cell_size=cell_size)
