"""Occupancy grids: random maps, obstacle inflation, points spread apart, the shoreline.

A grid is ``blocked[y, x]`` (True = not navigable) with y growing with the row index. Cell
(x, y) has its centre at ``origin + cell_size * (x + 0.5, y + 0.5)``. Leading dimensions are
batch; nothing here looks beyond the edge of the map.
"""

import math

import jax
import jax.numpy as jnp
from jax import lax
from jax.typing import ArrayLike

# A radius in cells is usually a quotient such as 0.3 / 0.1 = 2.9999999999999996; a cell whose
# centre lies on the circle must not be lost to that rounding (float32 rounds at 1.2e-7).
_ON_THE_CIRCLE = 1e-6


def random_blocked(
    key: jax.Array,
    n: int,
    shape: tuple[int, int],
    density: ArrayLike,
    first: ArrayLike = 0,
) -> jax.Array:
    """Draw random maps whose cells are blocked independently of one another.

    Map j comes from ``fold_in(key, j)`` alone, so it depends neither on ``n`` nor on
    ``first``, and raising the density only ever adds blocked cells: all densities threshold
    the same uniform field.

    Args:
        key: a threefry key (the JAX default); with other generators a batch of keys does not
            give each key's own stream.
        n: number of maps (static).
        shape: (H, W), rows and columns (static).
        density: probability in [0, 1] that a cell is blocked; float[] or float[n].
        first: index of the first map: the maps drawn are first, ..., first + n - 1.

    Returns:
        bool[n, H, W].
    """

    def field(index: jax.Array) -> jax.Array:
        # float32 even under x64, so that both precisions see the same maps.
        return jax.random.uniform(jax.random.fold_in(key, index), shape, jnp.float32)

    threshold = jnp.broadcast_to(jnp.asarray(density, jnp.float32), (n,))
    fields = jax.vmap(field)(jnp.asarray(first, jnp.uint32) + jnp.arange(n, dtype=jnp.uint32))
    return fields < threshold[:, None, None]


def _distance_along_row(blocked: jax.Array) -> jax.Array:
    """Distance in cells to the nearest blocked cell of the same row, inf where none is."""
    column = jnp.arange(blocked.shape[-1], dtype=jnp.float32)
    axis = blocked.ndim - 1
    last = lax.cummax(jnp.where(blocked, column, -jnp.inf), axis=axis)
    following = lax.cummin(jnp.where(blocked, column, jnp.inf), axis=axis, reverse=True)
    return jnp.minimum(column - last, following - column)


def inflate(
    blocked: jax.Array, radius_cells: float | jax.Array, bound: int | None = None
) -> jax.Array:
    """Grow every blocked cell into a disc: exact Euclidean dilation between cell centres.

    A cell becomes blocked when the centre of a blocked cell lies within the radius of its own
    centre; on the circle counts. Work is (2 bound + 1) H W.

    Args:
        blocked: bool[..., H, W].
        radius_cells: radius in cells, >= 0; may be traced if ``bound`` is given.
        bound: static whole number of cells, at least the radius; rows further apart than this
            are not compared. None takes the radius itself, which must then be a number.

    Returns:
        bool[..., H, W].
    """
    if bound is None:
        bound = math.ceil(float(radius_cells))
    height = blocked.shape[-2]
    bound = min(bound, height - 1)
    limit = jnp.square(jnp.asarray(radius_cells, jnp.float32) * (1.0 + _ON_THE_CIRCLE))
    margin = [(0, 0)] * (blocked.ndim - 2) + [(bound, bound), (0, 0)]
    along = jnp.pad(_distance_along_row(blocked), margin, constant_values=jnp.inf)

    def compare_rows(i: jax.Array, reached: jax.Array) -> jax.Array:
        rows = lax.dynamic_slice_in_dim(along, i, height, axis=blocked.ndim - 2)
        across = (i - bound).astype(jnp.float32)
        return reached | (rows * rows + across * across <= limit)

    return lax.fori_loop(0, 2 * bound + 1, compare_rows, blocked)


def expand_about_centre(points: ArrayLike, centre: ArrayLike, expansion: ArrayLike) -> jax.Array:
    """Scale an obstacle's boundary by (1 + E) in the obstacle's own frame (Chen 2023, Eq. 4).

    Args:
        points: boundary points, float[..., n, 2], m.
        centre: obstacle centres, the origin of the obstacle's frame, float[..., 2], m.
        expansion: the obstacle expansion coefficient E, float[...] (one per obstacle).

    Returns:
        float[..., n, 2], m.
    """
    middle = jnp.asarray(centre)[..., None, :]
    scale = 1.0 + jnp.asarray(expansion)[..., None, None]
    return middle + scale * (jnp.asarray(points) - middle)


def shoreline(blocked: jax.Array) -> jax.Array:
    """Blocked cells with a free cell among their eight neighbours on the map.

    For every free cell the nearest blocked cell is one of these, so they are all that a
    vessel on the water can meet first. Outside the map there is neither water nor land.

    Args:
        blocked: bool[..., H, W].

    Returns:
        bool[..., H, W].
    """
    edge = [(0, 0)] * (blocked.ndim - 2) + [(1, 1), (1, 1)]
    free = jnp.pad(~blocked, edge)
    across = free[..., :-2] | free[..., 1:-1] | free[..., 2:]
    return blocked & (across[..., :-2, :] | across[..., 1:-1, :] | across[..., 2:, :])
