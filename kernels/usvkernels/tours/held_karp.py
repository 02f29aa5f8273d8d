"""Shortest tours of a few stations, exactly: dynamic programming over sets of stations.

Source: Held and Karp 1962, A dynamic programming approach to sequencing problems; Bellman 1962.
"""

from itertools import combinations

import jax.numpy as jnp
import numpy as np
from jax import Array, lax

MOST_STATIONS = 13
"""A table has 2**(d - 1) (d - 1) numbers per run, 196 KB at 13 stations in float32."""


def held_karp(distances: Array) -> Array:
    """Shortest closed tours.

    Args:
        distances: float[d, d, R], finite, d from 2 to `MOST_STATIONS`.

    Returns:
        int32[d, R], the stations in order, 0 first. Of equally short tours one.
    """
    count, runs = distances.shape[0] - 1, distances.shape[2]
    legs = distances[1:, 1:]  # between the stations other than 0
    layers = _Layers(count)
    # tables[c][s, j]: shortest way from 0 through the s-th set of c + 1 stations, j of it last.
    tables = [jnp.where(jnp.eye(count, dtype=bool)[:, :, None], distances[0, 1:], jnp.inf)]
    for size in range(2, count + 1):
        before = lax.optimization_barrier(tables[-1][layers.without[size]])  # [sets, j, k, R]
        longer = before[:, :, 0] + legs[0]
        for k in range(1, count):
            longer = jnp.minimum(longer, before[:, :, k] + legs[k])
        inside = jnp.asarray(layers.inside[size])[:, :, None]
        tables.append(lax.optimization_barrier(jnp.where(inside, longer, jnp.inf)))
    last = jnp.argmin(tables[-1][0] + distances[1:, 0], axis=0).astype(jnp.int32)
    chosen, visits = jnp.zeros(runs, jnp.int32), [last]
    for size in range(count, 1, -1):
        chosen = jnp.asarray(layers.without[size])[chosen, last]
        ways = jnp.take_along_axis(tables[size - 2], chosen[None, None], axis=0)[0]
        ways = ways + jnp.take_along_axis(legs, last[None, None], axis=1)[:, 0]
        last = jnp.argmin(ways, axis=0).astype(jnp.int32)
        visits.append(last)
    return jnp.concatenate([jnp.zeros((1, runs), jnp.int32), jnp.stack(visits[::-1]) + 1])


class _Layers:
    """The sets of `count` stations by their size.

    `inside[c][s, j]`: whether station j is in the s-th set of c stations; `without[c][s, j]`: which
    of the sets of c - 1 stations it is without j, 0 where j is not in it.
    """

    def __init__(self, count: int):
        self.inside: dict[int, np.ndarray] = {}
        self.without: dict[int, np.ndarray] = {}
        smaller = {frozenset([j]): j for j in range(count)}
        for size in range(2, count + 1):
            sets = [frozenset(chosen) for chosen in combinations(range(count), size)]
            self.inside[size] = np.array([[j in s for j in range(count)] for s in sets])
            self.without[size] = np.array(
                [[smaller.get(s - {j}, 0) if j in s else 0 for j in range(count)] for s in sets],
                np.int32,
            )
            smaller = {s: place for place, s in enumerate(sets)}
