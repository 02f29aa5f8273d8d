"""Moves, lengths, heuristics and turning cost of A*, in whole numbers.

Lengths are int32 multiples of 1/STRAIGHT cell, a diagonal step DIAGONAL of them: the Pell pair
3363/2378 exceeds the square root of 2 by 6e-8. Sums are exact, whatever their order, and equal
lengths are truly equal: two paths compare as their real lengths do unless they differ by 2,378
diagonal steps or more.
"""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jax import Array

STRAIGHT, DIAGONAL = 2378, 3363

DIRECTIONS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
"""Moves (dx, dy) by angle, 45 degrees apart; odd ones are diagonal."""

HEURISTICS = ("octile", "euclidean", "chebyshev", "manhattan", "zero")

_SMALL = 2**14  # cells of a map on which no shortest path is longer than seven tie bits allow


@dataclass(frozen=True)
class AstarStatic:
    """What is fixed when a search is compiled.

    Attributes:
        height: rows of the map.
        width: columns of the map.
        connectivity: 8, or 4 for straight moves only.
        corner_cutting: whether a diagonal step may pass a blocked cell beside it.
        heuristic: one of `HEURISTICS`, or "table" to look distances up.
        consistent: whether f never falls from a cell to the next.
        reopen: whether a closed cell is opened again when a shorter way to it is found; never
            happens with a consistent heuristic.
        turn_mode: "none"; "parent": e(n) enters the evaluation of a cell only, given the direction
            its parent was entered by (Zhang et al. 2019, Eq. 7 as printed); "accumulated":
            likewise, and it counts as length from there on; "exact": search over (cell, heading).
        shared: whether all queries are on one map.
    """

    height: int
    width: int
    connectivity: int = 8
    corner_cutting: bool = False
    heuristic: str = "octile"
    consistent: bool = True
    reopen: bool = False
    turn_mode: str = "none"
    shared: bool = True

    @property
    def stride(self) -> int:
        """Places from one row to the next; a column of walls serves both sides."""
        return self.width + 1

    @property
    def places(self) -> int:
        """Cells with the walls around them."""
        return (self.height + 2) * self.stride + 1

    @property
    def headings(self) -> int:
        """States of a cell."""
        return 8 if self.turn_mode == "exact" else 1

    @property
    def turning(self) -> bool:
        """Whether turning costs anything."""
        return self.turn_mode != "none"

    @property
    def states(self) -> int:
        """Places of a queue."""
        return self.places * self.headings

    @property
    def moves(self) -> tuple[int, ...]:
        """Indices into `DIRECTIONS`."""
        return tuple(range(8)) if self.connectivity == 8 else (0, 2, 4, 6)

    @property
    def tie_bits(self) -> int:
        """Of a key; what they hold is taken from the greatest length."""
        return 7 if self.height * self.width <= _SMALL else 5

    @property
    def tie_shift(self) -> int:
        """Bits of h that the ties leave out, so that the farthest corner just fits."""
        farthest = DIAGONAL * (self.height + self.width)
        return max(0, farthest.bit_length() - self.tie_bits)

    @property
    def longest(self) -> int:
        """Greatest f, less that of the start where f never falls, in 1/STRAIGHT cells."""
        return (2**31 >> self.tie_bits) - 2


def place(static: AstarStatic, x: Array, y: Array) -> Array:
    """Place of cell (x, y) within the walls."""
    return (y + 1) * static.stride + x + 1


def walled(static: AstarStatic, blocked: np.ndarray, size: int) -> np.ndarray:
    """Maps with walls around them, as the search reads them.

    Args:
        static: of the search.
        blocked: bool[n, H, W].
        size: places of a queue, at least `static.states`.

    Returns:
        bool[n, size].
    """
    count, height, _ = blocked.shape
    plane = np.ones((count, size), bool)
    rows = np.ones((count, height, static.stride), bool)
    rows[:, :, 1:] = blocked
    cells = np.repeat(rows.reshape(count, -1), static.headings, axis=1)
    first = static.stride * static.headings
    plane[:, first : first + cells.shape[1]] = cells
    return plane


def distance_table(static: AstarStatic, heuristic: str, weight: float) -> np.ndarray:
    """A weighted heuristic by |dy| and |dx|, for a search with heuristic "table".

    Rounded down, which keeps a consistent one consistent since steps are whole numbers. Values
    end at a quarter of the greatest length, which only a weighted heuristic reaches.

    Returns:
        int32[(H + 2) * (W + 2)].
    """
    dy, dx = np.meshgrid(np.arange(static.height + 2), np.arange(static.width + 2), indexing="ij")
    dx, dy = dx.astype(np.int64), dy.astype(np.int64)
    if heuristic == "euclidean":
        square = (dx * dx + dy * dy) * STRAIGHT**2
        exact = np.floor(np.sqrt(square.astype(np.float64))).astype(np.int64)
        exact -= exact * exact > square
        exact += (exact + 1) * (exact + 1) <= square
    else:
        exact = _length(heuristic, dx, dy)
    capped = np.minimum(np.floor(weight * exact), static.longest // 4)
    return capped.astype(np.int32).reshape(-1)


def estimate(static: AstarStatic, table: Array, dx: Array, dy: Array) -> Array:
    """Heuristic of a cell that is (dx, dy) from the goal, int32 as they are."""
    dx, dy = jnp.abs(dx), jnp.abs(dy)
    if static.heuristic == "table":
        return table.at[dy * (static.width + 2) + dx].get(mode="promise_in_bounds")
    return _length(static.heuristic, dx, dy)


def turn(a: Array, b: Array) -> Array:
    """Angle between two directions in multiples of 45 degrees, 0 to 4."""
    apart = (a - b) & 7
    return jnp.minimum(apart, 8 - apart)


def _length(heuristic: str, dx, dy):  # type: ignore[no-untyped-def]  # numpy or jax
    if heuristic == "zero":
        return 0 * dx
    if heuristic == "manhattan":
        return STRAIGHT * (dx + dy)
    longer = (dx + dy + abs(dx - dy)) >> 1
    if heuristic == "chebyshev":
        return STRAIGHT * longer
    return STRAIGHT * longer + (DIAGONAL - STRAIGHT) * (dx + dy - longer)
