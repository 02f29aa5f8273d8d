"""Exact distances from segments to unit squares; errors are those of float64, below 1e-12 here."""

from itertools import pairwise

import numpy as np


def clearance(blocked: np.ndarray, path: np.ndarray) -> float:
    """Least distance, in cells, from a path float[n, 2] to closed blocked cells; inf for none."""
    low = np.argwhere(blocked)[:, ::-1].astype(float)
    legs = [*pairwise(path), (path[-1], path[-1])]  # of one point, too
    return min(float(gaps(a, b, low).min(initial=np.inf)) for a, b in legs)


def gaps(a: np.ndarray, b: np.ndarray, low: np.ndarray) -> np.ndarray:
    """Distances float64[K] from the segment ab to closed squares of side 1 from float64[K, 2].

    0 where they meet. Where they do not, the least is from an end of the segment to the square,
    or from a corner of the square to the segment.
    """
    from_ends = np.minimum(to_squares(a, low), to_squares(b, low))
    corners = low[:, None] + np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
    least = np.minimum(from_ends, to_segment(corners, a, b).min(axis=1))
    return np.where(meets(a, b, low), 0.0, least)


def to_squares(point: np.ndarray, low: np.ndarray) -> np.ndarray:
    """Distances float64[K] from a point to closed squares of side 1."""
    outside = np.maximum(np.maximum(low - point, point - low - 1), 0.0)
    return np.hypot(*outside.T)


def to_segment(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distances float64[...] from points float64[..., 2] to the segment ab."""
    span = b - a
    length = float(span @ span)
    along = np.clip((points - a) @ span / length, 0.0, 1.0) if length else 0.0
    away = points - a - np.multiply.outer(along, span)
    return np.hypot(away[..., 0], away[..., 1])


def meets(a: np.ndarray, b: np.ndarray, low: np.ndarray) -> np.ndarray:
    """Whether the segment ab meets closed squares of side 1, bool[K]: clipped by their slabs."""
    first, last = np.zeros(len(low)), np.ones(len(low))
    for axis in range(2):
        span, near, far = b[axis] - a[axis], low[:, axis] - a[axis], low[:, axis] - a[axis] + 1
        if span == 0:
            last = np.where((near <= 0) & (far >= 0), last, -1.0)
        else:
            first = np.maximum(first, np.minimum(near / span, far / span))
            last = np.minimum(last, np.maximum(near / span, far / span))
    return first <= last
