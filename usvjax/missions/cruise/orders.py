"""In which order a cruise visits its stations."""

import jax
import numpy as np

from usvjax.missions.cruise.inputs import Expedition
from usvjax.search.distance import distance_field
from usvjax.tours import solve_tour

_MOST_CELLS = 1 << 24  # of distance fields held at a time


def tour_order(
    expedition: Expedition, key: jax.Array, tour: str, distances: str, first: int
) -> np.ndarray:
    """The order of `solve_tour`, int32[B, d], home first.

    Args:
        expedition: the cruises.
        key: of the tours' random numbers.
        tour: algorithm of `solve_tour`.
        distances: "straight" between the cells' centres, or "water" along shortest paths on the
            first map.
        first: number of the first cruise.
    """
    if distances == "straight":
        points, legs = expedition.stations.astype(np.float32), None
    else:
        points, legs = None, water_distances(expedition)
    solved = solve_tour(points, key, algorithm=tour, distances=legs, first=first)
    return np.asarray(solved.order, np.int32)


def water_distances(expedition: Expedition) -> np.ndarray:
    """Lengths of shortest paths on the first maps between stations, float32[B, d, d], cells.

    inf where there is no path.
    """
    count, legs = len(expedition), expedition.legs
    height, width = expedition.shape
    shared = len(expedition.blocked) == 1
    # Cruises that share map and stations share their distances as well.
    if shared and np.all(expedition.stations == expedition.stations[:1]):
        between = _between(expedition.blocked[0], expedition.stations[:1])
        return np.broadcast_to(between, (count, legs, legs)).copy()
    step = max(1, _MOST_CELLS // (legs * height * width))
    parts = []
    for first in range(0, count, step):
        rows = slice(first, first + step)
        maps = expedition.blocked[0] if shared else expedition.blocked[rows]
        parts.append(_between(maps, expedition.stations[rows]))
    return np.concatenate(parts)


def _between(blocked: np.ndarray, stations: np.ndarray) -> np.ndarray:
    """Distances between stations int32[n, d, 2] on bool[H, W] or bool[n, H, W]."""
    count, legs, _ = stations.shape
    maps = blocked if blocked.ndim == 2 else np.repeat(blocked, legs, axis=0)
    fields = distance_field(maps, stations.reshape(-1, 2)).reshape(count, legs, *maps.shape[-2:])
    row = np.arange(count)[:, None, None]
    source = np.arange(legs)[None, :, None]
    return fields[row, source, stations[:, None, :, 1], stations[:, None, :, 0]]
