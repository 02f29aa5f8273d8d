"""Stations of a cruise: cells drawn one after another, or given in metres."""

import numpy as np

from usvjax.errors import BadInputError
from usvjax.maps.draws import Stream, in_rounds, round_bits
from usvjax.maps.ends import check_joined, check_on_water, least_squared
from usvjax.maps.grid_map import GridMap
from usvjax.maps.tables import check_length

MOST_STATIONS = 200

# A set that left no room for its last stations is drawn again, so often at most.
_ROUNDS = 50

_BLOCK = 64  # jobs that draw at once


def draw_stations(
    seed: int,
    jobs: np.ndarray,
    cells: list[np.ndarray],
    count: int,
    least: float,
    place: str,
    lower: str,
) -> np.ndarray:
    """Draw stations for each job, one after another, each uniform over the cells still allowed.

    Args:
        seed: of the study.
        jobs: int64[J].
        cells: int[N, 2] for each job, where a station may be.
        count: d, stations.
        least: cells, between any two.
        place: what the water is, and
        lower: which settings make room, for the message.

    Returns:
        int32[J, d, 2], cells (x, y).

    Raises:
        BadInputError: there is no room for them.
    """
    stations = np.zeros((len(jobs), count, 2), np.int32)

    def attempt(rows: np.ndarray, number: int) -> np.ndarray:
        found = np.zeros(len(rows), bool)
        # Always as many numbers, so that only one program is compiled.
        drawn = round_bits(seed, jobs[rows], Stream.STATIONS, number, MOST_STATIONS, _BLOCK)
        for i, (row, numbers) in enumerate(zip(rows, drawn, strict=True)):
            some = _scattered(cells[row], numbers[:count], least)
            if some is not None:
                stations[row], found[i] = some, True
        return found

    left = in_rounds(len(jobs), _ROUNDS, attempt)
    if len(left):
        raise BadInputError(
            f"{place}, {len(cells[left[0]])} cells where a station may be, has no room for "
            f"{count} stations {least:.4g} cells apart (job {jobs[left[0]]}); lower {lower}"
        )
    return stations


def check_stations(count: int, min_distance: float, where: str) -> None:
    """Raise BadInputError unless there are 2 to MOST_STATIONS, their distance (m) 0 or more."""
    if not 2 <= count <= MOST_STATIONS:
        raise BadInputError(
            f"{where}: a cruise must have 2 to {MOST_STATIONS} stations, home included, got {count}"
        )
    check_length("min_distance", min_distance, where)


def check_places(places: tuple[tuple[float, float], ...], water: GridMap, where: str) -> None:
    """Refuse places that are no stations of one body of water.

    Args:
        places: (x, y) of each station, m.
        water: the map that vessels sail on.
        where: the study file and table, for the messages.

    Raises:
        BadInputError: they are too few or too many, one lies off the water or in another body of
            it, or two share a cell.
    """
    check_stations(len(places), 0.0, where)
    points = [(f"({x:g}, {y:g})", (x, y)) for x, y in places]
    check_on_water(points, water, f"{where}: 'places'")
    check_joined(points, water, f"{where}: 'places'")
    cells = water.cells_of(places)
    if len(np.unique(cells, axis=0)) < len(cells):
        raise BadInputError(f"{where}: 'places' has two stations in one cell")


def _scattered(cells: np.ndarray, numbers: list[int], least: float) -> np.ndarray | None:
    """One station for each random number below 2**32; None where no cell is left."""
    apart = least_squared(least)
    left = cells.astype(np.int64)
    found = []
    for number in numbers:
        if not len(left):
            return None
        found.append(left[number * len(left) >> 32])
        left = left[((left - found[-1]) ** 2).sum(axis=1) >= apart]
    return np.array(found)
