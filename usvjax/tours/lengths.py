"""Lengths of given tours, in float64."""

from typing import Any

import numpy as np

from usvjax.checks import any_array
from usvjax.errors import BadInputError, BadTypeError
from usvjax.public import public
from usvjax.tours.inputs import Legs, checked_legs


@public("usvkernels.tours")
def tour_length(
    order: Any, points: Any = None, *, distances: Any = None, closed: bool = True
) -> np.ndarray:
    """How long tours are. Source: Yu et al. 2022, Eq. 8.

    Args:
        order: int[B, d] or int[d], stations 0 .. d - 1 in the order of the visits, each once; it
            may begin with any of them.
        points: float[B, d, 2] or float[d, 2], shared: (x, y) of the stations.
        distances: float[B, d, d] or float[d, d], shared, instead of points: [a, b] from a to b, in
            any unit; inf where not connected.
        closed: whether the tour returns to where it began.

    Returns:
        float64[B], in the unit of the points or distances, or one number for int[d] with a single
        problem; inf where a leg is not connected.

    Raises:
        BadTypeError: an argument of the wrong type.
        BadInputError: orders that are no permutations, or another wrong value or shape.
    """
    legs = checked_legs(points, distances)
    orders = _checked_orders(order, legs)
    found = lengths(legs.distances, np.atleast_2d(orders), closed)
    return found if orders.ndim == 2 or legs.batched else found[0]


def lengths(distances: np.ndarray, order: np.ndarray, closed: bool) -> np.ndarray:
    """float64[B] of distances float64[B or 1, d, d] and orders int[B or 1, d]."""
    rows = np.arange(len(distances))[:, None] if len(distances) > 1 else 0
    end = np.roll(order, -1, axis=1)
    # In one layout, so that a sum's rounding does not depend on how many problems there are.
    found = np.ascontiguousarray(distances[rows, order, end])
    return np.asarray((found if closed else found[:, :-1]).sum(axis=1))


def _checked_orders(order: Any, legs: Legs) -> np.ndarray:
    wanted = f"int [B, {legs.stations}] or [{legs.stations}]"
    orders = any_array("order", order, wanted)
    if orders.dtype.kind not in "iu":
        raise BadTypeError(f"order: got dtype {orders.dtype}; wanted {wanted}")
    if orders.ndim not in (1, 2) or orders.shape[-1] != legs.stations or len(orders) == 0:
        raise BadInputError(f"order: got shape {orders.shape}; wanted {wanted}")
    problems = len(legs.distances)
    if orders.ndim == 2 and 1 != problems != len(orders):
        raise BadInputError(
            f"order: got {len(orders)} tours for {problems} problems of {legs.name}"
        )
    sorted_ = np.sort(np.atleast_2d(orders), axis=1)
    bad = np.flatnonzero((sorted_ != np.arange(legs.stations)).any(axis=1))
    if len(bad):
        row = np.atleast_2d(orders)[bad[0]].tolist()
        raise BadInputError(
            f"order: tour {bad[0]} is {row}; wanted each of 0 .. {legs.stations - 1} once"
        )
    return orders
