"""Rows of a batch in blocks of few sizes, shared out over the devices."""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np

from usvjax.devices import chosen_devices, share_out

SIZES = (8, 64, 512)
"""Rows in one call of a device; few sizes, since each is compiled."""

MOST_ROWS = SIZES[-1]

MOST_PADDED = 1.5
"""Times the rows that a batch has, padding included; a small batch is padded to SIZES[0]."""

QUICKLY_COMPILED = {"xla_backend_optimization_level": 1}
"""For `jax.jit`: a third less time to compile, and no slower on these kernels."""


def in_blocks(
    work: Callable[[np.ndarray], Any], count: int, most: int = MOST_ROWS
) -> tuple[np.ndarray, ...]:
    """Run work(rows) on blocks of the rows 0 .. count - 1, shared out over the devices.

    Args:
      work: on rows, of which the last is repeated to make up one of few sizes; returns a tuple
        of arrays whose first axis is the rows.
      count: number of rows.
      most: rows in a block.

    Returns:
      The arrays for all rows.
    """
    # The largest size that little padding fills; a device that gets no block does not compile.
    fitting = [n for n in SIZES if n <= most and -(-count // n) * n <= MOST_PADDED * count]
    size = max(fitting, default=min(SIZES[0], most))
    blocks = np.array_split(np.arange(count), -(-count // size))
    devices = chosen_devices()[: len(blocks)]

    def on_device(rows: np.ndarray, device: jax.Device) -> tuple[np.ndarray, ...]:
        with jax.default_device(device):
            arrays = jax.device_get(work(padded_rows(rows, SIZES)))
        return tuple(np.asarray(a)[: len(rows)] for a in arrays)

    parts = list(share_out(on_device, blocks, devices))
    return tuple(np.concatenate(arrays) for arrays in zip(*parts, strict=True))


def bucket(size: int, factor: int = 2) -> int:
    """The next power of `factor`, so that few shapes are compiled."""
    found = 1
    while found < size:
        found *= factor
    return found


def padded_points(points: np.ndarray, least: int) -> np.ndarray:
    """Points [B, P, 2] with P at least `least`, the last repeated."""
    place = np.minimum(np.arange(max(least, points.shape[1])), points.shape[1] - 1)
    return points[:, place]


def padded_rows(rows: np.ndarray, sizes: tuple[int, ...]) -> np.ndarray:
    """The rows with the last repeated until their number is one of `sizes`."""
    size = next((n for n in sizes if n >= len(rows)), len(rows))
    return rows[np.minimum(np.arange(size), len(rows) - 1)]


def sized(array: np.ndarray, size: int) -> np.ndarray:
    """The array [n, m, ...] with its second axis cut to `size`, or filled up with zeros."""
    array = array[:, :size]
    missing = [(0, 0), (0, size - array.shape[1])] + [(0, 0)] * (array.ndim - 2)
    return np.pad(array, missing)
