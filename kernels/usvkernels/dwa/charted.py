"""A map as vessels sense it: from each of its cells, the blocked ones that matter there."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.dwa.clearance import FAR


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Charted:
    """A shared map: for each of its cells, the blocked cells that a vessel there can sense."""

    table: Array  # int32[height * width, K], flat numbers of blocked cells, -1 pads
    width: Array  # int32, cells in a row
    cell_size: Array  # m; the corner of cell (0, 0) is the origin of the episodes


def near(chart: Charted, x: Array, y: Array) -> Array:
    """Centres of the obstacles that are sensed at x, y [...] (m): float[2, K, ...], FAR pads."""
    width, cell = chart.width, chart.cell_size
    column = jnp.clip(jnp.floor(x / cell).astype(jnp.int32), 0, width - 1)
    last = chart.table.shape[0] // width - 1
    row = jnp.clip(jnp.floor(y / cell).astype(jnp.int32), 0, last)
    blocked = jnp.moveaxis(chart.table[row * width + column], -1, 0)
    east = ((blocked % width).astype(cell.dtype) + 0.5) * cell
    north = ((blocked // width).astype(cell.dtype) + 0.5) * cell
    return jnp.where(blocked < 0, FAR, jnp.stack([east, north]))
