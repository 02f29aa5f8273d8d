"""How two straight courses approach each other: closest point, time to it, first contact.

All functions take the position and velocity of one relative to the other, (east, north) in m and
m/s, of any common shape, so they hold for vessels on the two last axes of a fleet as for a pair.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jax import Array

from usvkernels.vessel import Complex


class Closest(NamedTuple):
    """The closest point of approach."""

    distance: Array  # DCPA, m, between centres
    time: Array  # TCPA, s; below 0 where it is past, 0 where the distance does not change


def dot(a: Complex, b: Complex) -> Array:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1]


def cross(a: Complex, b: Complex) -> Array:
    """Of a and b, above 0 where b points to the left (port) of a."""
    return a[0] * b[1] - a[1] * b[0]


def closest_approach(place: Complex, velocity: Complex) -> Closest:
    """DCPA and TCPA of straight courses.

    Two vessels of the same velocity, or both at rest, keep their distance: their closest point is
    now. One that is past has a negative time, and its distance is that of then.

    Args:
        place: of the other relative to one's own (m).
        velocity: of the other relative to one's own (m/s).
    """
    speed_square = dot(velocity, velocity)
    moving = speed_square > 0.0
    over = jnp.where(moving, speed_square, 1.0)
    time = jnp.where(moving, -dot(place, velocity) / over, 0.0)
    # Across the relative course, not at the time: far from the point, rounding would decide.
    across = jnp.abs(cross(place, velocity)) / jnp.sqrt(over)
    still = jnp.sqrt(dot(place, place))
    return Closest(jnp.where(moving, across, still), time)


def least_square(place: Complex, velocity: Complex, until: Array | float) -> Array:
    """Least squared distance (m^2) on straight courses from now to `until` (s, 0 or more)."""
    speed_square = dot(velocity, velocity)
    over = jnp.where(speed_square > 0.0, speed_square, 1.0)
    time = jnp.clip(-dot(place, velocity) / over, 0.0, until)
    at = place[0] + velocity[0] * time, place[1] + velocity[1] * time
    return dot(at, at)


def contact_time(place: Complex, velocity: Complex, distance: Array | float) -> Array:
    """When straight courses first come within `distance` (m); s, 0 if they are, inf if never."""
    speed_square = dot(velocity, velocity)
    closing = -dot(place, velocity)
    outside = dot(place, place) - distance * distance
    # closing^2 - speed^2 * outside, without the cancellation of large squares.
    across = cross(place, velocity)
    root = speed_square * (distance * distance) - across * across
    meets = (closing > 0.0) & (root >= 0.0)
    # outside / (closing + sqrt(root)) is the smaller root, and keeps its digits.
    below = jnp.where(meets, closing + jnp.sqrt(jnp.maximum(root, 0.0)), 1.0)
    time = jnp.where(meets, outside / below, jnp.inf)
    return jnp.where(outside <= 0.0, 0.0, time)
