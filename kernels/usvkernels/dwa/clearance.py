"""How far the obstacles are: from points of many lanes to circles given by their centres.

Obstacles are float[2, K, lanes]: east and north of the centre (m), rows at FAR pad.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from usvkernels.trig import sincos
from usvkernels.vessel import Complex

Scalar = Array | float
"""One number, or one per lane."""

FAR = 1e6
"""Coordinate (m) that pads obstacle rows; what lies beyond FAR / 2 of a point is no obstacle."""

LEAST_SINE = 1e-9
"""Of the sector's half-angle; a product of its cotangent with 2 FAR stays finite."""

UNROLLED_OBSTACLES = 64
"""Up to this many obstacles the running minimum is unrolled; more go in blocks of this size."""


class Sector(NamedTuple):
    """The search sector of a vessel, and the obstacle circles that may meet it."""

    cot: Array  # cotangent of half its angle
    reach: Array  # m, their radius over the sine of half its angle
    radius: Scalar  # m, theirs


Fold = Callable[[Array, Array], Array]
"""From obstacles [2, block, lanes] and a running minimum to the new running minimum."""


def nearest_squared(
    obstacles: Array, point: Complex, counted: list[Array] | None, least: Array
) -> Array:
    """Running minimum of the squared distance from `point` to the obstacles [2, block, lanes]."""
    for k, centre in enumerate(centres(obstacles)):
        least = _nearer(centre, point, None if counted is None else counted[k], least)
    return least


def centres(obstacles: Array) -> list[Complex]:
    """The obstacles [2, K, lanes] one by one, K times [lanes] and [lanes]."""
    count, lanes = obstacles.shape[1:]
    rows = jnp.unstack(obstacles.reshape(2 * count, lanes))  # slices of one array cost no copy
    return list(zip(rows[:count], rows[count:], strict=True))


@jax.jit  # traced once for all obstacles of an unrolled chain, and inlined again by XLA
def _nearer(centre: Complex, point: Complex, counts: Array | None, least: Array) -> Array:
    east, north = centre[0] - point[0], centre[1] - point[1]
    squared = east * east + north * north
    # Not jnp.minimum, which spends three more operations on NaN.
    nearer = jnp.where(squared < least, squared, least)
    return nearer if counts is None else jnp.where(counts, nearer, least)


def sector_of(half_angle: Scalar, radius: Scalar, dtype: jnp.dtype) -> Sector:
    """The search sector of this half-angle (rad) for obstacle circles of `radius` (m)."""
    sin, cos = sincos(jnp.asarray(half_angle, dtype))
    # At pi, rounding makes it negative and would drop what is dead ahead.
    sin = jnp.maximum(jnp.abs(sin), LEAST_SINE)
    return Sector(cot=cos / sin, reach=jnp.asarray(radius, dtype) / sin, radius=radius)


@jax.jit  # as `_nearer`
def in_sector(centre: Complex, point: Complex, ahead: Complex, sector: Sector) -> Array:
    """Whether an obstacle's circle meets the search sector at P (Tan et al. 2022, Fig. 1).

    That is, whether its centre is within the radius of the sector that opens from `point`, P,
    about the direction `ahead`: by its distance from the nearer ray (not above 0 inside the
    sector), where the foot lies on the ray, or from P itself. Lengths across and along a ray are
    over the sine of the half-angle, which saves two products for each obstacle and candidate.
    """
    offset = (centre[0] - point[0], centre[1] - point[1])
    along = offset[0] * ahead[0] + offset[1] * ahead[1]
    across = jnp.abs(offset[0] * ahead[1] - offset[1] * ahead[0])
    foot_on_ray = along * sector.cot + across > 0.0
    from_ray = across * sector.cot - along
    touches_p = offset[0] * offset[0] + offset[1] * offset[1] <= sector.radius * sector.radius
    return (from_ray <= jnp.where(foot_on_ray, sector.reach, 0.0)) | touches_p


def fold_blocks(fold: Fold, obstacles: Array, least: Array) -> Array:
    """Fold obstacles [2, K, lanes] into `least`, in blocks where K is large; its square root.

    The root is taken here because XLA computes a root once, but a chain of minima anew in each
    of its users: with two users a decision takes 2.5 times as long.
    """
    count = obstacles.shape[1]
    if count <= UNROLLED_OBSTACLES:
        return jnp.sqrt(fold(obstacles, least))
    blocks = -(-count // UNROLLED_OBSTACLES)
    padding = blocks * UNROLLED_OBSTACLES - count
    padded = jnp.pad(obstacles, ((0, 0), (0, padding), (0, 0)), constant_values=FAR)
    split = padded.reshape(2, blocks, UNROLLED_OBSTACLES, -1).swapaxes(0, 1)
    return jnp.sqrt(jax.lax.scan(lambda m, block: (fold(block, m), None), least, split)[0])


def nearest_distance(obstacles: Array, x: Array, y: Array) -> Array:
    """Distance (m), float[lanes], from x, y to the nearest centre of obstacles [2, K, lanes]."""

    def fold(block: Array, least: Array) -> Array:
        return nearest_squared(block, (x, y), None, least)

    return fold_blocks(fold, obstacles, jnp.full_like(x, jnp.inf))
