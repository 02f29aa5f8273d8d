"""Maps of a batch as one run of cells, so that their size is no part of what is compiled."""

from dataclasses import dataclass
from functools import partial

import jax
from jax import Array


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Charts:
    """The maps that n things, each on one of them, lie on; all of one size."""

    cells: Array  # bool[N], the maps row by row, one after the other; True = not navigable
    first: Array  # int32[n], place in `cells` of the first cell of each thing's map
    height: Array  # int32, rows of a map
    width: Array  # int32, columns of a map

    def at(self, column: Array, row: Array) -> Array:
        """Whether cells of the maps are blocked: bool, for int32[n, ...] each."""
        first = self.first.reshape(self.first.shape + (1,) * (column.ndim - self.first.ndim))
        place = first + row * self.width + column
        return self.cells.at[place].get(mode="promise_in_bounds")

    def holds(self, column: Array, row: Array) -> Array:
        """Whether cells lie on the map: bool, for numbers of any shape."""
        return (column >= 0) & (row >= 0) & (column < self.width) & (row < self.height)
