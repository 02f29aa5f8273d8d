"""Which cells change with a step: a function of the seed, the step and the cell alone.

So every method meets the same changes at the same place and time, in whatever batch, and anybody
can compute them again.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from usvkernels.draws import words

BITS = 24
"""A probability is a whole multiple of 2^-BITS; 0 never happens and 1 always does."""


class View(NamedTuple):
    """The cells of windows, row by row; n = h * w of them."""

    column: Array  # int32[n, lanes]
    row: Array  # int32[n, lanes]
    inside: Array  # bool[n, lanes], whether on the map
    others: Array  # bool[n, lanes], those of them in which the vessel is not


def flipped(seed: Array, step: Array, cell: Array, rate: Array) -> Array:
    """Whether cells flip.

    Args:
        seed: uint32[2, ...], of `draws.seeds`.
        step: int32[...], counted from the start of the cruise.
        cell: int32[...], row * width + column of the map.
        rate: int32[...], probability times 2^BITS.

    Returns:
        bool[...].
    """
    word = words(seed, step, cell)[0]
    return (word >> (32 - BITS)).astype(jnp.int32) < rate


def view(
    column: Array,
    row: Array,
    window: tuple[int, int],
    width: Array | int,
    height: Array | int,
) -> View:
    """The cells of the windows about some cells.

    Args:
        column, row: int32[lanes], the cells.
        window: (h, w), odd, static.
        width, height: of the map.
    """
    up, right = (np.arange(n, dtype=np.int32) - n // 2 for n in window)
    ups, rights = (a.reshape(-1, 1) for a in np.meshgrid(up, right, indexing="ij"))
    column, row = column + rights, row + ups
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    return View(column, row, inside, inside & ((ups != 0) | (rights != 0)))


def view_flips(seed: Array, step: Array, rate: Array, seen: View, width: Array | int) -> Array:
    """Which of the cells in view flip; bool[n, lanes], never the vessel's own."""
    return seen.others & flipped(seed[:, None], step, seen.row * width + seen.column, rate)
