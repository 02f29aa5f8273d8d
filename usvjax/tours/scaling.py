"""Distances as the kernels take them: in a unit in which single precision tells tours apart.

The longest leg would be that unit, were there no table in which one leg says "not this way" by a
number such as 1e9 beside legs of 1 to 10: in that unit, all others are nothing. So a leg that is
longer than any tour needs, a multiple of what every tour costs at least, counts as missing at
first. A tour no longer than that bound shows that the bound was right; where none is found, the
bound is raised past the next longer leg and the search repeated.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse.csgraph import connected_components

from usvjax.tours.inputs import Legs
from usvjax.tours.lengths import lengths

_ROOM = 16.0
"""Least tour lengths to a bound: 24 bits less 4 for the sum still tell a millionth."""

Search = Callable[[np.ndarray, "Scaled"], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Scaled:
    """Distances in a unit of their own, a missing leg as one that costs more than any tour.

    Attributes:
        table: float64[B or 1, d, d], at most 1 where not missing. For an open tour the legs back
            to station 0 cost nothing.
        unit: float64[B or 1], what 1 stands for.
    """

    table: np.ndarray
    unit: np.ndarray

    def history(self, found: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Lengths float[n, T] of rows int[n] in the user's unit; inf with a missing leg."""
        unit = self.unit[rows] if len(self.unit) > 1 else self.unit
        missing = found > 0.75 * _missing(self.table.shape[1])
        return np.where(missing, np.inf, found.astype(np.float64) * unit[:, None])


def scaled(legs: Legs, closed: bool, bounds: np.ndarray) -> Scaled:
    """Distances for the kernels; those above bounds float64[B or 1] are missing."""
    there = np.isfinite(legs.distances) & (legs.distances <= bounds[:, None, None])
    known = np.where(there, legs.distances, 0)
    longest = known.max(axis=(1, 2))
    unit = np.where(longest > 0, longest, 1.0)
    table = np.where(there, known / unit[:, None, None], _missing(legs.stations))
    if not closed:
        table[:, :, 0] = 0
    return Scaled(table, unit)


def _missing(stations: int) -> float:
    return 2.0 * stations


def search(legs: Legs, closed: bool, count: int, run: Search) -> tuple[np.ndarray, np.ndarray]:
    """Tours by a kernel, under bounds that are raised for those runs whose tours exceed them.

    Args:
        legs: of each run, or of one problem that they share.
        closed: whether tours are.
        count: runs.
        run: takes the rows int[n] of some runs and the distances, and returns their orders
            int[n, d] and lengths float64[n, T] by iteration.

    Returns:
        int[B, d] and float64[B, T] of all runs. A run depends on its own problem alone.
    """
    bounds = _first_bounds(legs, closed)
    rows = np.arange(count)
    order, history = run(rows, scaled(legs, closed, bounds))
    length = lengths(legs.distances, order, closed)
    while True:
        rows = rows[length[rows] > np.broadcast_to(bounds, count)[rows]]
        if not len(rows):
            return order, history
        bounds = _raised(legs, bounds)
        other, by_iteration = run(rows, scaled(legs, closed, bounds))
        again = lengths(_of(legs.distances, rows), other, closed)
        better = again < length[rows]
        taken = rows[better]
        order[taken], history[taken] = other[better], by_iteration[better]
        length[taken] = again[better]


def _of(array: np.ndarray, rows: np.ndarray) -> np.ndarray:
    return array[rows] if len(array) > 1 else array


def _first_bounds(legs: Legs, closed: bool) -> np.ndarray:
    """Above which legs are left out, float64[B or 1]; inf where the longest leg serves as unit."""
    bounds = np.full(len(legs.distances), np.inf)
    if legs.name == "points":  # where no leg is longer than half a tour
        return bounds
    away = legs.distances + np.where(np.eye(legs.stations, dtype=bool), np.inf, 0)
    if not closed:
        away[:, :, 0] = np.inf
    out = away.min(axis=2)
    out = np.where(np.isfinite(out), out, 0)
    least = out.sum(axis=1) - (0 if closed else out.max(axis=1))
    longest = _longest(legs)
    for row in np.flatnonzero(longest / _ROOM > least):
        least_tour = max(least[row], _narrowest(legs.distances[row], closed))
        if longest[row] / _ROOM > least_tour:
            bounds[row] = _ROOM * least_tour
    return bounds


def _longest(legs: Legs) -> np.ndarray:
    found: np.ndarray = np.where(np.isfinite(legs.distances), legs.distances, 0).max(axis=(1, 2))
    return found


def _narrowest(distances: np.ndarray, closed: bool) -> float:
    """The longest leg that some tour of float64[d, d] cannot do without, by connection; or 0."""
    values = np.unique(distances[np.isfinite(distances)])
    low, high = 0, len(values) - 1
    while low < high:
        middle = (low + high) // 2
        if _joined(distances <= values[middle], closed):
            high = middle
        else:
            low = middle + 1
    return float(values[low]) if _joined(distances <= values[low], closed) else 0.0


def _joined(there: np.ndarray, closed: bool) -> bool:
    if not closed:
        there = there.copy()
        there[:, 0] = True
    return bool(connected_components(there, connection="strong")[0] == 1)


def _raised(legs: Legs, bounds: np.ndarray) -> np.ndarray:
    """Bounds with room beyond the next longer leg of each problem; inf beyond the longest."""
    longer = np.where(legs.distances > bounds[:, None, None], legs.distances, np.inf)
    next_longer = longer.min(axis=(1, 2))
    served = next_longer < _longest(legs) / _ROOM
    return np.where(served, _ROOM * np.where(served, next_longer, 0), np.inf)
