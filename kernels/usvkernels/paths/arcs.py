"""Segments and arcs: their points, and whether blocked cells are near a point."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.paths.charts import Charts
from usvkernels.trig import sincos, wrap_angle


@partial(jax.tree_util.register_dataclass)
@dataclass(frozen=True)
class Primitives:
    """Segments and arcs, each given by its start; S = 3 C + 1. Those of no length are absent."""

    start: Array  # float[B, S, 2]
    heading: Array  # float[B, S], at the start, rad
    length: Array  # float[B, S]
    curvature: Array  # float[B, S], signed, 0 on a segment; positive to port


def arc_point(
    start: tuple[Array, Array], heading: Array, curvature: Array, distance: Array
) -> tuple[Array, Array]:
    """Point at a distance along an arc, or along a straight line where the curvature is 0."""
    half = 0.5 * curvature * distance
    sin, _ = sincos(half)
    safe = jnp.where(half == 0.0, 1.0, half)
    chord = distance * jnp.where(jnp.abs(half) < 1e-3, 1.0 - half * half / 6.0, sin / safe)
    sin, cos = sincos(heading + half)
    return start[0] + chord * cos, start[1] + chord * sin


def near_blocked(charts: Charts, x: Array, y: Array, reach: Array) -> Array:
    """Whether blocked cells, or the map's edge, lie nearer to points than `reach`.

    Args:
        charts: the map of each row of points.
        x, y: points, float[n, ...], in cells from the map's corner.
        reach: cells, at most a half: only the cells on the nearer sides can then be as near.

    Returns:
        bool[n, ...]; True off the map.
    """
    column, row = jnp.floor(x), jnp.floor(y)
    off = ~charts.holds(column, row)
    west, south = x - column < 0.5, y - row < 0.5
    across = jnp.where(west, x - column, column + 1.0 - x)
    along = jnp.where(south, y - row, row + 1.0 - y)
    i = jnp.where(off, 0, column.astype(jnp.int32))
    j = jnp.where(off, 0, row.astype(jnp.int32))
    beside, above = i + jnp.where(west, -1, 1), j + jnp.where(south, -1, 1)

    def at(i: Array, j: Array) -> Array:
        inside = charts.holds(i, j)
        return ~inside | charts.at(jnp.where(inside, i, 0), jnp.where(inside, j, 0))

    corner = (across * across + along * along < reach * reach) & at(beside, above)
    sides = ((across < reach) & at(beside, j)) | ((along < reach) & at(i, above))
    return off | at(i, j) | sides | corner


def sample(
    primitives: Primitives, spacing: Array | float, capacity: int
) -> tuple[Array, Array, Array, Array]:
    """Points along smoothed paths, one every `spacing`, the end being the last.

    Args:
        primitives: of `assemble`, or the same compacted.
        spacing: in the unit of the lengths.
        capacity: most points of a path, static; further ones are cut off.

    Returns:
        float[B, capacity, 2], points, the last repeated; float[B, capacity], headings (rad);
        float[B, capacity], curvatures; int32[B], points of each path, two at least where it has a
        length.
    """
    ends = _ends(primitives.length)
    place = jnp.arange(capacity, dtype=jnp.int32)

    def fill(path: Primitives, ends: Array) -> tuple[Array, Array, Array, Array]:
        # Beyond the last piece there is nothing, whatever rounding makes of its end.
        last = jnp.max(jnp.where(path.length > 0.0, jnp.arange(ends.shape[0]), 0))
        total = ends[last]
        distance = place * spacing
        on = jnp.minimum(jnp.searchsorted(ends, distance, side="left"), last)
        on = jnp.where(distance < total, on, last)
        rest = jnp.clip(distance - (ends[on] - path.length[on]), 0.0, path.length[on])
        rest = jnp.where(distance < total, rest, path.length[last])
        start = path.start[on]
        x, y = arc_point((start[:, 0], start[:, 1]), path.heading[on], path.curvature[on], rest)
        return (
            jnp.stack([x, y], -1),
            wrap_angle(path.heading[on] + path.curvature[on] * rest),
            path.curvature[on],
            jnp.where(total > 0.0, jnp.maximum(_steps_of(total, spacing), 1), 0) + 1,
        )

    points, heading, curvature, count = jax.vmap(fill)(primitives, ends)
    return points, heading, curvature, jnp.minimum(count, capacity)


def _ends(length: Array) -> Array:
    """Where pieces float[B, S] end along their paths, never less than the one before.

    Rounding of a sum in pairs may put an end before that of the piece before it.
    """
    return jax.lax.cummax(jnp.cumsum(length, axis=1), axis=1)


def _steps_of(total: Array, spacing: Array | float) -> Array:
    # A path of a whole number of spacings must not gain a point through rounding.
    return jnp.ceil(total / spacing - 1e-3).astype(jnp.int32)
