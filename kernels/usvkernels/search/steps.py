"""Moves on a grid and their lengths as exact integers.

A length is n_straight + n_diagonal * sqrt(2) cells. Searches add up whole units instead, so
that sums are exact, independent of the order of addition, and ties are true ties:
``STRAIGHT`` units to a straight step, ``DIAGONAL`` to a diagonal one. DIAGONAL / STRAIGHT is a
convergent of the continued fraction of sqrt(2), so no fraction with a denominator below STRAIGHT
lies between the two: lengths compare in units exactly as in cells while their numbers of
diagonal steps differ by less than ``STRAIGHT``.
"""

import math
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np


@dataclass(frozen=True)
class Units:
    """Whole units of length in unsigned integers of one width (hashable: static in jit).

    The top bit is left to mark blocked cells. ``cap`` stands for "not reached"; one more step
    does not carry it over the top, with the mark or without. No path as long as ``cap`` has
    ``straight`` diagonal steps, so every sum below ``cap`` compares exactly and `counts` can
    tell the steps apart again.
    """

    bits: int
    straight: int
    diagonal: int

    @property
    def dtype(self) -> np.dtype:
        """Of planes of lengths."""
        return np.dtype(f"uint{self.bits}")

    @property
    def flag(self) -> int:
        """The top bit: a blocked cell."""
        return 1 << (self.bits - 1)

    @property
    def cap(self) -> int:
        """Not reached, or at this length or beyond."""
        return self.flag - 1 - self.diagonal


UNITS = Units(bits=32, straight=80782, diagonal=114243)
"""For maps of any size: lengths to 26,582 cells."""

SMALL_UNITS = Units(bits=16, straight=169, diagonal=239)
"""Half as wide, for small maps: lengths to 192 cells."""

STRAIGHT = UNITS.straight
"""Units to a cell (uint32 or int32)."""

DIAGONAL = UNITS.diagonal
"""Units to a diagonal step."""

Move = tuple[int, int, int]
"""(dx, dy, units)."""


def moves(connectivity: int = 8, units: Units = UNITS) -> tuple[Move, ...]:
    """The steps to the neighbours, four straight ones and, if wanted, four diagonal ones.

    In the order (1, 0), (0, -1), (-1, 0), (0, 1), (1, -1), (-1, -1), (-1, 1), (1, 1).

    Args:
        connectivity: 4 or 8.
        units: what lengths are counted in.
    """
    straight = ((1, 0), (0, -1), (-1, 0), (0, 1))
    diagonal = ((1, -1), (-1, -1), (-1, 1), (1, 1)) if connectivity == 8 else ()
    return tuple((x, y, units.straight) for x, y in straight) + tuple(
        (x, y, units.diagonal) for x, y in diagonal
    )


def octile(dx: Any, dy: Any, units: Units = UNITS) -> Any:
    """Length in units of the shortest path over free cells, for |dx| and |dy| cells.

    Args:
        dx, dy: numbers of cells >= 0; ints, or numpy or JAX integer arrays wide enough.
        units: what lengths are counted in.
    """
    larger = jnp.maximum if isinstance(dx, jax.Array) else np.maximum
    smaller = jnp.minimum if isinstance(dx, jax.Array) else np.minimum
    rise = units.diagonal - units.straight
    return larger(dx, dy) * units.straight + smaller(dx, dy) * rise


def manhattan(dx: Any, dy: Any, units: Units = UNITS) -> Any:
    """As `octile`, where only straight steps are allowed."""
    return (dx + dy) * units.straight


def counts(length: Any, units: Units = UNITS) -> tuple[np.ndarray, np.ndarray]:
    """Straight and diagonal steps in lengths (exact; on the host).

    Args:
        length: lengths in units below ``units.cap``, any integer array.
        units: what they are counted in.

    Returns:
        Two int64 arrays.
    """
    length = np.asarray(length, np.int64)
    inverse = pow(units.diagonal, -1, units.straight)
    diagonal = length * inverse % units.straight
    return (length - diagonal * units.diagonal) // units.straight, diagonal


def cells(length: Any, units: Units = UNITS) -> np.ndarray:
    """Lengths in cells, float64: n_straight + n_diagonal * sqrt(2); inf at ``units.cap``."""
    straight, diagonal = counts(length, units)
    return np.where(np.asarray(length) >= units.cap, np.inf, straight + diagonal * math.sqrt(2.0))
