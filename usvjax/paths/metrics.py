"""What paths cost: length, turns, curvature, clearance, energy."""

from dataclasses import dataclass
from functools import partial
from math import ceil, inf, pi
from typing import Any

import jax
import numpy as np

from usvjax.batches import bucket, few_sizes, filled
from usvjax.checks import not_negative, positive
from usvjax.devices import QUICKLY_COMPILED
from usvjax.paths.inputs import EDGE, Frame, check_on_map, path_frame, path_rows, scale
from usvjax.paths.points import polyline_pieces, sample_pieces, sample_room, without_repeats
from usvjax.public import public
from usvkernels.paths import path_metrics as kernel

STEP = 0.5  # cells along a path, between points whose clearance is measured


@dataclass(frozen=True)
class PathMetrics:
    """Measures of B paths; numpy arrays.

    Attributes:
        length: float32[B], m; nan where there is no path.
        inflections: int32[B], points at which the course changes; 0 where there is no path.
        turning: float32[B], sum of the changes of course, rad; nan where there is no path.
        curvature: float32[B], the largest discrete curvature, 1/m: at a point between segments a
            and b that meet at the angle w, 2 sin(w / 2) / ((a + b) / 2); on samples of an arc that
            is 1 / radius; nan where there is no path.
        clearance: float32[B], least distance (m) of points on the path, at most half a cell
            apart, to a blocked cell, 0 on one; inf beyond `clearance_limit`, nan where there is no
            path. None where no map was given.
        energy: float32[B], that of `length` straight ahead plus that of turning; nan where there
            is no path.
    """

    length: np.ndarray
    inflections: np.ndarray
    turning: np.ndarray
    curvature: np.ndarray
    clearance: np.ndarray | None
    energy: np.ndarray


@public("usvkernels.paths")
def path_metrics(
    paths: Any,
    lengths: Any,
    blocked: Any = None,
    *,
    cell_size: float | None = None,
    origin: Any = None,
    turn_cost: float = 0.5,
    energy_unit: float = 100.0,
    tolerance: float = 1e-3,
    clearance_limit: float | None = None,
) -> PathMetrics:
    """Measure paths.

    Args:
        paths: int[B, P, 2], cells, or float[B, P, 2], m.
        lengths: int[B], points of each path, 0 where there is none; None: all P.
        blocked: map for the clearance: bool[H, W] shared, bool[B, H, W], or a `GridMap`.
        cell_size: m, default 1; origin: (x, y), m, default (0, 0). A `GridMap` has its own.
        turn_cost: gamma, energy of a turn by 45 deg: e = gamma * angle / 45 deg (Zhang et al.
            2019, Eq. 6, where it is 0.5).
        energy_unit: m, length that costs an energy of 1 (Zhang: 100 m).
        tolerance: rad, change of course up to which a point is no inflection.
        clearance_limit: m, how far to look for blocked cells; default 16 cells.

    Raises:
        BadTypeError, BadInputError: wrong types, shapes or numbers; a path that leaves the map, or
            as many maps as do not go with the paths; more samples than memory holds.
    """
    frame = None
    if blocked is not None:
        frame = path_frame(blocked, cell_size, origin)
        size, corner = frame.cell_size, frame.origin
    else:
        size, corner = scale(cell_size, origin)
    turn_cost, tolerance = (
        not_negative("turn_cost", turn_cost),
        not_negative("tolerance", tolerance),
    )
    energy_unit = positive("energy_unit", energy_unit)
    limit = 16 * size
    if clearance_limit is not None:
        limit = positive("clearance_limit", clearance_limit)
    given = path_rows(paths, lengths)
    world = given.metres(size, corner)
    if frame is not None:
        check_on_map(given, frame, EDGE)
    points, counts = without_repeats(world - corner, given.counts)
    length, inflections, turning, curvature = _measured(points, counts, tolerance)
    clearance = None
    if frame is not None:
        clearance = _clearance(points, counts, frame, limit)
    energy = length / energy_unit + turn_cost * turning / (pi / 4)
    there = given.counts > 0

    def known(values: np.ndarray) -> np.ndarray:
        return np.where(there, values, np.nan).astype(np.float32)

    return PathMetrics(
        length=known(length),
        inflections=inflections,
        turning=known(turning),
        curvature=known(curvature),
        clearance=None if clearance is None else known(clearance),
        energy=known(energy),
    )


def _measured(points: np.ndarray, counts: np.ndarray, tolerance: float) -> tuple[np.ndarray, ...]:
    capacity = bucket(max(points.shape[1], 16), 4)
    base = points[:, :1]

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array, ...]:
        local = filled(points[rows] - base[rows], capacity, axis=1).astype(np.float32)
        arrays = (local, counts[rows], np.float32(tolerance))
        return _measure(*jax.device_put(arrays, device))

    return few_sizes(len(points)).arrays(work)


def _clearance(points: np.ndarray, counts: np.ndarray, frame: Frame, limit: float) -> np.ndarray:
    """float32[B], m."""
    pieces = polyline_pieces(filled(points / frame.cell_size, 2, axis=1))
    longest = float(pieces[2].sum(axis=1, dtype=np.float64).max()) * frame.cell_size
    step = STEP * frame.cell_size
    what = f"paths: clearance at points {step:g} m apart"
    capacity = sample_room(longest, step, len(points), what, least=64, factor=4)
    places, _, _, number = sample_pieces(pieces, STEP, capacity)
    number = np.where(counts > 0, number, 0).astype(np.int32)
    # No cell of the map is farther off than this.
    reach = np.int32(ceil(min(limit / frame.cell_size, sum(frame.blocked.shape[1:]))))

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array]:
        arrays = jax.device_put((places[rows], number[rows], reach), device)
        return (_least(frame.charts(rows, device), *arrays),)

    (found,) = few_sizes(len(points), frame.most_rows).arrays(work)
    clearance = found * np.float32(frame.cell_size)
    return np.where(clearance <= limit, clearance, np.float32(inf))


@partial(jax.jit, compiler_options=QUICKLY_COMPILED)
def _measure(points: jax.Array, counts: jax.Array, tolerance: jax.Array) -> tuple[jax.Array, ...]:
    found = kernel.measure(points, counts, tolerance)
    return found.length, found.inflections, found.turning, found.curvature


_least = jax.jit(kernel.least_clearance, compiler_options=QUICKLY_COMPILED)
