"""Heuristics of D* Lite in exact integers: how far a cell at least, or supposedly, lies away.

Two functions of the offset between a cell and the vessel. The *bound* never overestimates and
is a distance (it obeys the triangle inequality); it keys what got worse and carries km. The
*guide* is at least the bound, and orders what got better: it may overestimate.

A step counts one unit less here than it costs (`steps`): the bound then falls short of a path by
at least one unit per step, so that one number orders the queue as Koenig and Likhachev's two do.
What got worse still comes strictly before what leans on it, and of two cells with equal sums the
one nearer to the goal comes first.
"""

import jax.numpy as jnp
from jax import Array, lax

from usvkernels.search.steps import DIAGONAL, STRAIGHT

HEURISTICS = ("octile", "chebyshev", "weighted", "weighted_octile")

FRACTION_BITS = 10
"""Weights are whole multiples of 2^-10, so that keys are integers, the same on any machine."""

LONGEST_EQ_17 = 2800
"""Cells on the diagonal of a map for which w of Eq. 17 fits its integers."""

_LARGEST_WEIGHT = 2.0  # of Eq. 17


def bound(heuristic: str, dx: Array, dy: Array) -> Array:
    """The consistent distance that `heuristic` builds on.

    Args:
        heuristic: of `HEURISTICS`.
        dx: int32[...], columns between the cells.
        dy: int32[...], rows.

    Returns:
        int32[...], in units of `steps`.
    """
    dx, dy = jnp.abs(dx), jnp.abs(dy)
    along, across = jnp.maximum(dx, dy), jnp.minimum(dx, dy)
    if heuristic == "chebyshev":
        return along * (STRAIGHT - 1)
    return along * (STRAIGHT - 1) + across * (DIAGONAL - STRAIGHT)


def guide(
    heuristic: str, weight: float | None, dx: Array, dy: Array, goal_dx: Array, goal_dy: Array
) -> Array:
    """What `heuristic` says of a cell at (dx, dy) from the vessel; at least `bound`.

    "weighted" is Yu et al. 2022, Eq. 17, as printed: sqrt(2) w min(dx, dy) + w (dx + dy) with
    w = 1 + (distance of the cell) / (distance of the goal), both from the vessel and Euclidean;
    w is held within [1, 2], the range that the paper gives for it. It exceeds the true distance
    even on an empty map. "weighted_octile" is w times the octile distance, with that w or a
    constant one.

    Args:
        heuristic: of `HEURISTICS`.
        weight: of "weighted_octile"; None takes w of Eq. 17.
        dx: int32[...], columns between cell and vessel.
        dy: int32[...], rows.
        goal_dx: int32[...], columns between goal and vessel.
        goal_dy: int32[...], rows.

    Returns:
        int32[...], in units of `steps`.
    """
    base = bound(heuristic, dx, dy)
    if heuristic in ("octile", "chebyshev"):
        return base
    if heuristic == "weighted":
        dx, dy = jnp.abs(dx), jnp.abs(dy)
        base = jnp.minimum(dx, dy) * DIAGONAL + (dx + dy) * STRAIGHT
    if weight is None:
        share = _excess_of_eq_17(dx, dy, goal_dx, goal_dy)
    else:
        share = jnp.int32(excess(weight))
    return base + (base >> FRACTION_BITS) * share


def excess(weight: float) -> int:
    """By how much a weight exceeds 1, in units of 2^-FRACTION_BITS."""
    return round((weight - 1.0) * 2**FRACTION_BITS)


def largest_guide(heuristic: str, weight: float | None, height: int, width: int) -> int:
    """The most that `guide` gives on a map, as a Python integer of any size."""
    along, across = max(height, width), min(height, width)
    base = along * STRAIGHT + across * (DIAGONAL - STRAIGHT)
    if heuristic == "weighted":
        base = across * DIAGONAL + (along + across) * STRAIGHT
    if heuristic in ("octile", "chebyshev"):
        return base
    share = excess(_LARGEST_WEIGHT if weight is None else weight)
    return base + (base >> FRACTION_BITS) * share


def _excess_of_eq_17(dx: Array, dy: Array, goal_dx: Array, goal_dy: Array) -> Array:
    """By how much w of Eq. 17 exceeds 1, in units of 2^-FRACTION_BITS."""
    apart = jnp.minimum(_sixteenths(dx, dy), _sixteenths(goal_dx, goal_dy))
    return (apart << FRACTION_BITS) // jnp.maximum(_sixteenths(goal_dx, goal_dy), 1)


def _sixteenths(dx: Array, dy: Array) -> Array:
    """Euclidean distance in sixteenths of a cell, rounded down.

    Quotients and roots of floats differ in their last bit between machines and vector widths; the
    root here is put right by its square.
    """
    squared = (dx * dx + dy * dy) << 8
    root = lax.sqrt(squared.astype(jnp.float32)).astype(jnp.int32)
    root = root - (root * root > squared)
    return root + ((root + 1) * (root + 1) <= squared)
