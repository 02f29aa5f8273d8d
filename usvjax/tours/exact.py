"""Shortest tours of few stations, exactly; and distances as the kernels take them."""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.batches import Batch, split
from usvjax.devices import COMPILER_OPTIONS, chosen_devices
from usvjax.errors import BadInputError
from usvjax.public import public
from usvjax.tours.inputs import Legs, checked_legs, truth
from usvkernels.tours.held_karp import MOST_STATIONS, held_karp

_LANES = 16


@public("usvkernels.tours")
def optimal_tour(points: Any = None, *, distances: Any = None, closed: bool = True) -> np.ndarray:
    """Shortest tours of at most 13 stations, proven. Source: Held and Karp 1962.

    Distances that differ by less than a part in a million of a tour count as equal in float32.

    Args:
        points: float[B, d, 2] or float[d, 2]: (x, y) of the stations, the start first.
        distances: float[B, d, d] or float[d, d], instead of points: [a, b] from a to b; inf where
            not connected.
        closed: whether the tour returns to station 0; otherwise it ends anywhere.

    Returns:
        int32[B, d], the stations in the order of the visits, station 0 first; `tour_length` says
        how long. Where no tour is of finite length, some order, of which it says inf.

    Raises:
        BadTypeError: an argument of the wrong type.
        BadInputError: fewer than 2 stations or more than 13, or another wrong value or shape.
    """
    return orders(checked_legs(points, distances), truth("closed", closed))


def orders(legs: Legs, closed: bool) -> np.ndarray:
    """int32[B, d]; refuses too many stations."""
    if legs.stations > MOST_STATIONS:
        raise BadInputError(
            f"{legs.name}: got {legs.stations} stations; wanted {MOST_STATIONS} or fewer for an "
            "exact tour"
        )
    distances = scaled(legs, closed)

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array]:
        own = np.moveaxis(distances[rows], 0, -1)
        return (_solved(jax.device_put(own, device)),)

    blocks = split(np.arange(len(distances)), _LANES)
    (found,) = Batch(blocks, _LANES, chosen_devices()).arrays(work, axis=1)
    return found.T


@partial(jax.jit, compiler_options=COMPILER_OPTIONS)
def _solved(distances: jax.Array) -> jax.Array:
    return held_karp(distances)


def scaled(legs: Legs, closed: bool) -> np.ndarray:
    """Distances for the kernels: at most 1, a missing leg as one that costs more than any tour.

    Returns:
        float[B or 1, d, d]. For an open tour the legs back to station 0 cost nothing.
    """
    finite = np.isfinite(legs.distances)
    found = np.where(finite, legs.distances, 0) / _unit(legs)
    found = np.where(finite, found, _missing(legs))
    if not closed:
        found[:, :, 0] = 0
    return np.asarray(found, jnp.result_type(float))


def unscaled(legs: Legs, lengths: np.ndarray) -> np.ndarray:
    """Lengths float[B, T] of the kernels in the unit of the distances; inf with a missing leg."""
    found = lengths.astype(np.float64)
    longer = found > 0.75 * _missing(legs)
    return np.where(longer, np.inf, found * _unit(legs)[:, 0])


def _missing(legs: Legs) -> float:
    return 2.0 * legs.stations


def _unit(legs: Legs) -> np.ndarray:
    """The longest distance of each problem, [B or 1, 1, 1]; 1 where all are 0."""
    longest = np.where(np.isfinite(legs.distances), legs.distances, 0).max(
        axis=(1, 2), keepdims=True
    )
    return np.where(longest > 0, longest, 1.0)
