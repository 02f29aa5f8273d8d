"""Checks that everything about tours shares: stations, or the distances between them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse.csgraph import connected_components

from usvjax.checks import any_array
from usvjax.errors import BadInputError, BadTypeError
from usvjax.memory import check_memory

MOST_STATIONS = 1000
_POINTS = "float [B, d, 2] or [d, 2]"
_DISTANCES = "float [B, d, d] or [d, d]"
_COPIES = 5  # of the distances, while they are checked and scaled


@dataclass(frozen=True)
class Legs:
    """Distances of B tours or of one problem that they share; checked.

    Attributes:
        distances: float64[B or 1, d, d], from row to column; inf where not connected, 0 on the
            diagonal.
        name: of the argument that they came from.
        batched: whether that argument had a batch axis.
    """

    distances: np.ndarray
    name: str
    batched: bool

    @property
    def stations(self) -> int:
        """How many."""
        return self.distances.shape[1]

    @property
    def symmetric(self) -> np.ndarray:
        """Of which problems all distances are the same in both directions; bool[B or 1]."""
        same: np.ndarray = self.distances == self.distances.transpose(0, 2, 1)
        return np.asarray(same.all(axis=(1, 2)))

    def joined(self, closed: bool) -> np.ndarray:
        """Which problems may have a tour of finite length; bool[B or 1].

        False is certain: some station cannot be reached, or not be left.
        """
        distances = self.distances
        if not closed:
            distances = np.concatenate([np.zeros_like(distances[:, :, :1]), distances[:, :, 1:]], 2)
        if np.isfinite(distances).all():
            return np.ones(len(distances), bool)
        return np.array(
            [
                connected_components(np.isfinite(one), connection="strong")[0] == 1
                for one in distances
            ]
        )


def checked_legs(points: Any, distances: Any) -> Legs:
    """Distances from points or as given.

    Args:
        points: float[B, d, 2] or float[d, 2], or None.
        distances: float[B, d, d] or float[d, d], or None; inf where not connected.

    Raises:
        BadTypeError: not real numbers.
        BadInputError: both or neither given; a wrong shape; fewer than two stations; NaN, or an
            infinite point; two points in one place; a negative distance, or one of a station to
            itself that is not 0.
    """
    if (points is None) == (distances is None):
        got = "neither" if points is None else "both"
        raise BadInputError(f"points, distances: got {got}; wanted one of them")
    if distances is None:
        places = _numbers("points", points, _POINTS)
        if places.shape[-1] != 2:
            raise BadInputError(f"points: got shape {places.shape}; wanted {_POINTS}")
        return _from_points(places)
    table = _numbers("distances", distances, _DISTANCES)
    if table.shape[-1] != table.shape[-2]:
        raise BadInputError(f"distances: got shape {table.shape}, not square; wanted {_DISTANCES}")
    return _from_distances(table)


def _numbers(name: str, value: Any, wanted: str) -> np.ndarray:
    array = any_array(name, value, wanted)
    if array.dtype.kind not in "iuf":
        raise BadTypeError(f"{name}: got dtype {array.dtype}; wanted {wanted}")
    if array.ndim not in (2, 3) or len(array) == 0:
        raise BadInputError(f"{name}: got shape {array.shape}; wanted {wanted}")
    stations = array.shape[-2]
    if not 2 <= stations <= MOST_STATIONS:
        raise BadInputError(
            f"{name}: got {stations} station{'s' * (stations != 1)}; wanted 2 to {MOST_STATIONS}"
        )
    problems = len(array) if array.ndim == 3 else 1
    check_memory(
        8 * _COPIES * problems * stations**2, f"{name}: {problems} problems of {stations} stations"
    )
    array = array.astype(np.float64)
    if np.isnan(array).any():
        raise BadInputError(f"{name}: nan at index {_first(np.isnan(array))}; wanted numbers")
    return array


def _from_points(places: np.ndarray) -> Legs:
    if not np.isfinite(places).all():
        where = _first(~np.isfinite(places))
        raise BadInputError(f"points: inf at index {where}; wanted finite numbers")
    batch = places if places.ndim == 3 else places[None]
    apart = batch[:, :, None] - batch[:, None]
    table = np.hypot(apart[..., 0], apart[..., 1])
    same = np.triu(table == 0, 1)
    if same.any():
        row, one, other = np.argwhere(same)[0]
        of = f" of tour {row}" if places.ndim == 3 else ""
        x, y = batch[row, one]
        raise BadInputError(
            f"points: stations {one} and {other}{of} are both at ({x:g}, {y:g}); "
            "wanted each station once"
        )
    return Legs(table, "points", places.ndim == 3)


def _from_distances(table: np.ndarray) -> Legs:
    if (table < 0).any():
        where = _first(table < 0)
        raise BadInputError(
            f"distances: {table[tuple(where)]:g} at index {where}; wanted 0 or more"
        )
    own = np.diagonal(table, axis1=-2, axis2=-1)
    if own.any():
        where = _first(own != 0)
        raise BadInputError(
            f"distances: {own[tuple(where)]:g} from a station to itself at index "
            f"{[*where, where[-1]]}; wanted 0"
        )
    return Legs(table if table.ndim == 3 else table[None], "distances", table.ndim == 3)


def _first(bad: np.ndarray) -> list[int]:
    return [int(i) for i in np.argwhere(bad)[0]]
