"""The encounter coordination of Wei & Zhang 2023, section 2.4.

Two vessels meet while their guidance points are within a threshold. The one with the larger
outboard angle, the bearing of the other off its bow, goes first, and the other's position is an
obstacle to it; the other keeps its guidance point and slows down towards it. What the paper leaves
open is chosen by name: who goes first of equals, and who goes at all in a ring.
"""

import jax.numpy as jnp
from jax import Array

from usvkernels.fleet.approach import cross, dot
from usvkernels.fleet.params import Encounters
from usvkernels.fleet.sight import Orders, Vessels, between, minus, of_looker, others, sums
from usvkernels.trig import angle_between

EQUAL = {"first": "the first of the fleet goes", "both_yield": "both slow down"}
"""Who goes first at equal angles."""

RING = {"all_yield": "who yields to one yields", "largest_goes": "the largest angle goes"}
"""Whether a vessel that yields to one and goes before another yields."""


def meet(how: Encounters, vessels: Vessels, v_dec: Array) -> tuple[Orders, Array]:
    """What the vessels do, and which of them keep their guidance points, bool[n, lanes].

    Args:
        how: the strategy's numbers and readings.
        vessels: the fleet.
        v_dec: [n, lanes], what a vessel slows down by (m/s^2).
    """
    other = others(vessels.present)
    under_way = vessels.under_way[:, None] & vessels.under_way
    apart = between(vessels.guide)
    threshold = of_looker(how.threshold)
    meets = other & under_way & (dot(apart, apart) <= threshold * threshold)
    angle = _outboard(vessels)
    goes = _goes_first(how.equal, angle)
    yields = jnp.any(meets & ~goes, axis=1)
    if how.ring == "largest_goes":
        most = jnp.max(jnp.where(meets, angle, -1.0), axis=1)
        highest = jnp.max(jnp.where(meets, most[None], -1.0), axis=1)
        yields &= ~((most > highest) & jnp.any(meets, axis=1))
    left = minus(vessels.guide, vessels.place)
    to_stop = jnp.sqrt(2.0 * v_dec * jnp.sqrt(dot(left, left)))
    cap = jnp.where(yields, jnp.minimum(vessels.speed, to_stop), vessels.speed)
    # Who has arrived is an obstacle like any other.
    rests = other & vessels.under_way[:, None] & ~vessels.under_way
    sees = (meets & goes) | rests
    return Orders(
        vessels.course, cap, sees, jnp.ones_like(vessels.present), sums(vessels.hull)
    ), yields


def _outboard(vessels: Vessels) -> Array:
    """Bearing of j off the bow of i, to either side; [n, n, lanes], rad in [0, pi]."""
    place = between(vessels.place)
    bow = vessels.bow[0][:, None], vessels.bow[1][:, None]
    return angle_between(cross(bow, place), dot(bow, place))


def _goes_first(equal: str, angle: Array) -> Array:
    """Whether i goes before j, bool[n, n, lanes]."""
    theirs = angle.swapaxes(0, 1)
    if equal == "both_yield":
        return angle > theirs
    n = angle.shape[0]
    earlier = (jnp.arange(n)[:, None] < jnp.arange(n))[:, :, None]
    return (angle > theirs) | ((angle == theirs) & earlier)
