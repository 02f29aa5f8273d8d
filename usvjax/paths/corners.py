"""The corners of many paths turned into arcs at once, in blocks of like size."""

from dataclasses import dataclass
from functools import partial
from math import ceil, pi

import jax
import numpy as np

from usvjax.batches import bucket, few_sizes, filled, sized
from usvjax.devices import QUICKLY_COMPILED
from usvjax.paths.inputs import Frame
from usvkernels.paths import turning
from usvkernels.paths.charts import Charts

LEAST_SAMPLES = 16  # of a candidate, tested for collision


@dataclass(frozen=True)
class TurnLimits:
    """What a smoother must respect.

    Attributes:
        radius: float64[B], R (m).
        reach: float64[B], R_s (m).
        margin: m, that arcs keep to blocked cells.
    """

    radius: np.ndarray
    reach: np.ndarray
    margin: float

    def samples(self, cell_size: float) -> int:
        """Points of a candidate that are tested for collision."""
        longest = max(2 * pi * self.radius.max(), 2 * self.reach.max())
        return max(LEAST_SAMPLES, ceil(1.001 * longest / (turning.SAMPLE * cell_size)))


Turned = tuple[np.ndarray, ...]
"""Cases int32[n, C], deflections [n, C]; start [n, S, 2], heading, length, curvature [n, S]."""


def turn_corners(
    points: np.ndarray, counts: np.ndarray, rows: np.ndarray, frame: Frame, limits: TurnLimits
) -> Turned:
    """Smooth paths of distinct points, float64[n, P, 2] from the map's corner, m.

    Args:
        points, counts: the paths.
        rows: int[n], the row of the batch that each belongs to: its map and vessel.
        frame: the maps.
        limits: what smoothing must respect.
    """
    width = max(points.shape[1], 3)
    points = filled(points, width, axis=1)
    samples = limits.samples(frame.cell_size)

    def work(some: np.ndarray, _: int, device: jax.Device) -> tuple[np.ndarray, ...]:
        capacity = bucket(max(-(-int(counts[some].max()) // 2), 4), 4) * 2
        local = filled(points[some], capacity, axis=1)[:, :capacity].astype(np.float32)
        charts = frame.charts(rows[some], device)
        radius, reach = (a[rows[some]].astype(np.float32) for a in (limits.radius, limits.reach))
        scale = np.array([frame.cell_size, limits.margin], np.float32)
        arrays = (local, counts[some], radius, reach, scale, np.int32(samples))
        found = _smooth(charts, *jax.device_put(arrays, device))
        corners, pieces = width - 2, 3 * (width - 2) + 1
        sizes = (corners, corners, pieces, pieces, pieces, pieces)
        return tuple(sized(np.asarray(a), n, axis=1) for a, n in zip(found, sizes, strict=True))

    order = np.argsort(counts, kind="stable")  # alike in a block
    return few_sizes(len(points), frame.most_rows, order).arrays(work)


@partial(jax.jit, compiler_options=QUICKLY_COMPILED)
def _smooth(
    charts: Charts,
    points: jax.Array,
    counts: jax.Array,
    radius: jax.Array,
    reach: jax.Array,
    scale: jax.Array,
    samples: jax.Array,
) -> tuple[jax.Array, ...]:
    corners, cases, pieces = turning.smooth(
        charts, points, counts, radius, reach, scale[0], scale[1], samples
    )
    return (
        cases,
        corners.deflection,
        pieces.start,
        pieces.heading,
        pieces.length,
        pieces.curvature,
    )
