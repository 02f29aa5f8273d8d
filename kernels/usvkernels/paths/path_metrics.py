"""What a path costs: its length, how much and how sharply it turns, what it keeps clear of."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.paths.charts import Charts
from usvkernels.paths.turning import find_corners


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Measures:
    """Of each path, in the unit of its points and rad."""

    length: Array  # float[B]
    inflections: Array  # int32[B], points where the course changes by more than the tolerance
    turning: Array  # float[B], sum of the changes of course
    curvature: Array  # float[B], the largest discrete curvature


def measure(points: Array, counts: Array, tolerance: Array | float) -> Measures:
    """Measure paths of straight segments.

    The discrete curvature at a point where two segments a and b meet at the deflection w is
    2 sin(w / 2) / ((a + b) / 2): on equal chords of a circle exactly 1 / radius.

    Args:
        points: float[B, P, 2], P >= 3; no point of a path equals the one before it.
        counts: int32[B], points of each path, at most P.
        tolerance: rad, a change of course that does not count as one.
    """
    corners = find_corners(points, counts)
    angle = jnp.where(corners.turns, jnp.abs(corners.deflection), 0.0)
    mean = 0.5 * (corners.segment[:, :-1] + corners.segment[:, 1:])
    curvature = 2.0 * jnp.sin(0.5 * angle) / jnp.where(corners.turns, mean, 1.0)
    return Measures(
        length=jnp.sum(corners.segment, axis=1),
        inflections=jnp.sum(angle > tolerance, axis=1, dtype=jnp.int32),
        turning=jnp.sum(angle, axis=1),
        curvature=jnp.max(curvature, axis=1),
    )


def least_clearance(charts: Charts, points: Array, counts: Array, limit: Array | int) -> Array:
    """Distance from the points of paths to the nearest blocked cell, a closed square.

    Rings of cells about each point are searched outwards until no farther cell can be nearer
    than what the path has met.

    Args:
        charts: each path's map.
        points: float[B, P, 2], in cells from the map's corner.
        counts: int32[B], points of each path, at most P.
        limit: cells, how far to look.

    Returns:
        float[B], in cells; 0 on a blocked cell, inf where none is as near as `limit`.
    """
    exists = jnp.arange(points.shape[1], dtype=jnp.int32) < counts[:, None]
    x, y = points[..., 0], points[..., 1]
    column, row = jnp.floor(x).astype(jnp.int32), jnp.floor(y).astype(jnp.int32)

    def squared(right: Array, up: Array) -> Array:
        """Least squared distance of each path to the cells at one offset from its points'."""
        i, j = column + right, row + up
        inside = exists & charts.holds(i, j)
        met = inside & charts.at(jnp.where(inside, i, 0), jnp.where(inside, j, 0))
        east = jnp.maximum(jnp.maximum(i - x, x - (i + 1)), 0.0)
        north = jnp.maximum(jnp.maximum(j - y, y - (j + 1)), 0.0)
        return jnp.min(jnp.where(met, east * east + north * north, jnp.inf), axis=1)

    def ring(carry: tuple[Array, Array]) -> tuple[Array, Array]:
        k, best = carry

        def corner(i: Array, best: Array) -> Array:
            along = i - k  # the four cells of the ring that a quarter turn maps on one another
            turned = ((along, -k), (k, along), (-along, k), (-k, -along))
            for right, up in turned:
                best = jnp.minimum(best, squared(right, up))
            return best

        return k + 1, jax.lax.fori_loop(0, 2 * k, corner, best)

    def unfinished(carry: tuple[Array, Array]) -> Array:
        k, best = carry
        nearer = (k - 1) * (k - 1) < best  # a cell of ring k is at least k - 1 away
        return (k <= limit + 1) & jnp.any(nearer & (counts > 0))

    zero = jnp.int32(0)
    _, best = jax.lax.while_loop(unfinished, ring, (jnp.int32(1), squared(zero, zero)))
    distance = jnp.sqrt(best)
    return jnp.where(distance <= limit, distance, jnp.inf)
