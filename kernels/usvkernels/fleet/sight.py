"""What every vessel of a fleet sees of every other; vessels [n, lanes], pairs [n, n, lanes].

Of a pair, the first axis is the vessel that looks, the second the one that it looks at.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jax import Array, lax

from usvkernels.dwa.clearance import Scalar
from usvkernels.fleet.approach import least_square
from usvkernels.vessel import Complex


class Obstacles(NamedTuple):
    """Circles that vessels see."""

    centre: Array  # float[2, K, n or 1, lanes], m, FAR pads
    velocity: Array | None  # likewise, m/s; None for those at rest


class Vessels(NamedTuple):
    """Of all vessels, [n, lanes] each."""

    place: Complex  # m
    bow: Complex  # unit vector of the heading
    velocity: Complex  # over ground, m/s
    drift: Complex | None  # of current and wind, m/s; None where there is neither
    course: Complex  # unit vector to be steered towards the guidance point
    guide: Complex  # the guidance point, m
    led: Array  # bool, on its guide segment
    goal: Complex  # m
    speed: Array  # m/s through the water, that it would sail to its guidance point
    made_good: Array  # m/s over ground towards it
    hull: Array  # m, its radius
    arrival: Array  # s, until it would be at its goal
    under_way: Array  # bool, on a passage that has not ended
    present: Array  # bool, False for a place in the fleet that nobody takes


class Orders(NamedTuple):
    """What an encounter strategy has the vessels do, [n, lanes] each unless said otherwise."""

    course: Complex  # unit vector, to be steered
    cap: Array  # m/s, speed not to exceed
    sees: Array  # bool[n, n, lanes], whether the dynamic window keeps clear of j
    still: Array  # bool[n, lanes], seen by the others as if at rest
    apart: Array  # float[n, n, lanes], distance between centres that the window keeps (m)


def nearest_square(
    circles: Obstacles, place: Complex, velocity: Complex, until: Array | float
) -> Array:
    """Least squared distance of vessels [n, lanes] to a circle's centre from now on (m^2).

    Args:
        circles: obstacles.
        place, velocity: of the vessels (m, m/s).
        until: how long they are sailed (s).
    """

    def nearest(k: Array, least: Array) -> Array:
        off = circles.centre[0, k] - place[0], circles.centre[1, k] - place[1]
        closing = -velocity[0], -velocity[1]
        if circles.velocity is not None:
            theirs = circles.velocity[:, k]
            closing = theirs[0] - velocity[0], theirs[1] - velocity[1]
        return jnp.minimum(least, least_square(off, closing, until))

    least = jnp.full_like(place[0], jnp.inf)
    return lax.fori_loop(0, circles.centre.shape[1], nearest, least)


def over_ground(vessels: Vessels, velocity: Complex) -> Complex:
    """What a velocity through the water is over ground (m/s)."""
    if vessels.drift is None:
        return velocity
    return velocity[0] + vessels.drift[0], velocity[1] + vessels.drift[1]


def less_drift(vessels: Vessels, velocity: Complex) -> Complex:
    """Velocities over ground, [.., n, lanes], as seen from the water about each vessel (m/s)."""
    if vessels.drift is None:
        return velocity
    return velocity[0] - vessels.drift[0], velocity[1] - vessels.drift[1]


def minus(a: Complex, b: Complex) -> Complex:
    """The vector a - b."""
    return a[0] - b[0], a[1] - b[1]


def between(of: Complex) -> Complex:
    """What j has more than i, [n, n, lanes], of something that vessels [n, lanes] have."""
    return of[0][None] - of[0][:, None], of[1][None] - of[1][:, None]


def others(present: Array) -> Array:
    """Whether i and j are two vessels, bool[n, n, lanes]."""
    distinct = ~jnp.eye(present.shape[0], dtype=bool)
    return distinct[:, :, None] & present[:, None] & present[None]


def of_looker(setting: Scalar) -> Scalar:
    """What the vessel that looks has set, [n, 1, lanes] of [n, lanes]; a scalar as it is."""
    return jnp.asarray(setting)[:, None] if jnp.ndim(setting) else setting


def sums(radius: Array) -> Array:
    """r_i + r_j, [n, n, lanes], of [n, lanes]."""
    return radius[:, None] + radius[None]
