"""Shortest tours of few stations, exactly."""

from functools import partial
from typing import Any

import jax
import numpy as np

from usvjax.batches import Batch, split
from usvjax.devices import COMPILER_OPTIONS, chosen_devices
from usvjax.errors import BadInputError
from usvjax.public import public
from usvjax.tours.inputs import Legs, checked_legs
from usvjax.tours.scaling import Scaled, search
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
    return orders(checked_legs(points, distances), closed)


def orders(legs: Legs, closed: bool) -> np.ndarray:
    """int32[B, d]; refuses too many stations."""
    if legs.stations > MOST_STATIONS:
        raise BadInputError(
            f"{legs.name}: got {legs.stations} stations; wanted {MOST_STATIONS} or fewer for an "
            "exact tour"
        )
    return search(legs, closed, len(legs.distances), _in_blocks)[0]


def _in_blocks(problems: np.ndarray, distances: Scaled) -> tuple[np.ndarray, np.ndarray]:
    """Exact tours of some problems, int[n, d]; nothing is told by iteration, float64[n, 0]."""

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array]:
        own = np.moveaxis(distances.table[problems[rows]], 0, -1).astype(np.float32)
        return (_solved(jax.device_put(own, device)),)

    blocks = split(np.arange(len(problems)), _LANES)
    (found,) = Batch(blocks, _LANES, chosen_devices()).arrays(work, axis=1)
    return found.T, np.empty((len(problems), 0))


@partial(jax.jit, compiler_options=COMPILER_OPTIONS)
def _solved(distances: jax.Array) -> jax.Array:
    return held_karp(distances)
