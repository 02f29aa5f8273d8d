"""Fewer and smoother points: shortened paths, key points, points at a spacing, B-splines."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import numpy as np

from usvjax.batches import bucket, few_sizes, filled
from usvjax.checks import positive, whole_number
from usvjax.devices import QUICKLY_COMPILED
from usvjax.errors import BadInputError
from usvjax.memory import check_memory
from usvjax.paths.inputs import Frame, Paths, path_frame, path_rows, scale
from usvjax.paths.points import MOST_SAMPLES
from usvjax.paths.water import check_on_water
from usvjax.public import public
from usvkernels.paths import bspline as spline_kernel
from usvkernels.paths import smoothing
from usvkernels.paths.charts import Charts

_POINT_BYTES = 64  # a point with heading and curvature, and the copies made of it


@dataclass(frozen=True)
class KeyPaths:
    """Paths through some of their points; numpy arrays, in the order of the arguments.

    Attributes:
        path: int32[B, Q, 2], cells (x, y); the last is repeated.
        path_cells: int32[B], points of each path, 0 where there was none.
        index: int32[B, Q], place of each point in the path it came from.
    """

    path: np.ndarray
    path_cells: np.ndarray
    index: np.ndarray


@dataclass(frozen=True)
class DensePaths:
    """Paths in the world; numpy arrays.

    Attributes:
        path: float64[B, Q, 2], points (m); the last is repeated.
        path_cells: int32[B], points of each path, 0 where there was none.
    """

    path: np.ndarray
    path_cells: np.ndarray


@dataclass(frozen=True)
class Splines:
    """B-splines along paths; numpy arrays.

    Attributes:
        points: float64[B, n, 2], points (m).
        heading: float32[B, n], rad.
        curvature: float32[B, n], 1/m, positive to port.
        counts: int32[B], n, or 0 where there was no path.
    """

    points: np.ndarray
    heading: np.ndarray
    curvature: np.ndarray
    counts: np.ndarray


@public("usvkernels.paths")
def shorten(paths: Any, lengths: Any, blocked: Any, *, corner_cutting: bool = False) -> KeyPaths:
    """Pull paths straight: from each point kept on to the last before the first out of sight.

    Source: Yu et al. 2022, section 4.2.2. Line of sight is exact: the segment between two
    cells' centres touches no blocked cell, cells being closed squares; through a corner of the
    lattice it touches all four cells there, as for a diagonal step of `astar`.

    Args:
        paths: int[B, P, 2], cells (x, y), as `astar` returns them; points past the end of a path
            are ignored.
        lengths: int[B], points of each path, `path_cells` of `astar`; 0 where there is no path.
            None: all P.
        blocked: bool[H, W] shared, bool[B, H, W], or a `GridMap`.
        corner_cutting: through a corner, count only the two cells that the segment passes
            through; for paths that were searched so.

    Raises:
        BadTypeError: paths that are not whole numbers, a map or a corner_cutting that is not
            boolean.
        BadInputError: ragged or unequal batches, a path that leaves the map or meets a blocked
            cell; the message names the first row.
    """
    return _pruned(paths, lengths, blocked, corner_cutting, repeat=False)


@public("usvkernels.paths")
def key_points(paths: Any, lengths: Any, blocked: Any, *, corner_cutting: bool = False) -> KeyPaths:
    """Drop points whose neighbours see each other, until no such point is left.

    Source: Wei & Zhang 2023, section 2.2.1 and Fig. 4. Never more points than `shorten`, whose
    result is the first pass. `redensify` puts points back at the unit length.

    Args:
        paths, lengths, blocked, corner_cutting: as `shorten`.

    Raises:
        BadTypeError, BadInputError: as `shorten`.
    """
    return _pruned(paths, lengths, blocked, corner_cutting, repeat=True)


@public("usvkernels.paths")
def redensify(
    paths: Any, lengths: Any, unit: float, *, cell_size: float | None = None, origin: Any = None
) -> DensePaths:
    """Points along paths: every point given, and one each `unit` of length from it on.

    Source: Wei & Zhang 2023, section 2.2.1; their unit length is that of the search's grid.

    Args:
        paths: int[B, P, 2], cells, or float[B, P, 2], m.
        lengths: int[B], points of each path; None: all P.
        unit: m.
        cell_size: m, default 1; origin: (x, y), m, default (0, 0); where cells lie.

    Raises:
        BadTypeError, BadInputError: wrong types, shapes or numbers.
    """
    size, corner = scale(cell_size, origin)
    given = path_rows(paths, lengths)
    unit = positive("unit", unit)
    points = given.metres(size, corner)
    steps = np.linalg.norm(np.diff(points, axis=1), axis=2)  # padding adds none
    pieces = np.ceil(steps / unit - 1e-9).sum(axis=1)
    if not (pieces < 2**24).all():
        raise BadInputError(
            f"unit: got {unit:g} m; that makes {pieces.max():.3g} points on a path of "
            f"{steps.sum(axis=1).max():g} m"
        )
    capacity = bucket(max(int(pieces.max()) + 2, 256), 4)
    what = f"unit: got {unit:g} m; {len(given)} x {capacity} points"
    check_memory(len(given) * capacity * _POINT_BYTES, what)
    base = points[:, :1]

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array, jax.Array]:
        local = (points[rows] - base[rows]).astype(np.float32)
        arrays = (local, given.counts[rows], np.float32(unit))
        return _redensify(*jax.device_put(arrays, device), capacity)

    dense, count = few_sizes(len(given)).arrays(work)
    dense = dense[:, : max(int(count.max()), 1)] + base
    # Where the path ends it ends exactly, whatever single precision made of it.
    last = np.maximum(count - 1, 0)[:, None]
    at_end = np.arange(dense.shape[1]) >= last
    return DensePaths(np.where(at_end[..., None], points[:, -1:], dense), count)


@public("usvkernels.paths")
def bspline(
    paths: Any,
    lengths: Any,
    *,
    samples: int = 200,
    cell_size: float | None = None,
    origin: Any = None,
) -> Splines:
    """The clamped uniform cubic B-spline with the points of a path as control points.

    The comparison of Chen et al. 2023, section 5.2. It starts and ends where the path does and
    runs along it, within the hull of every four consecutive points; it knows neither obstacles
    nor a turning radius.

    Args:
        paths: int[B, P, 2], cells, or float[B, P, 2], m.
        lengths: int[B], points of each path; None: all P. Two or three points give a spline of
            degree one or two.
        samples: points of each spline, at equal steps of its parameter.
        cell_size: m, default 1; origin: (x, y), m, default (0, 0); where cells lie.

    Raises:
        BadTypeError, BadInputError: wrong types, shapes or numbers; a path of one point; more
            samples than memory holds.
    """
    size, corner = scale(cell_size, origin)
    samples = whole_number("samples", samples, 2)
    given = path_rows(paths, lengths)
    if (given.counts == 1).any():
        row = int(np.argmax(given.counts == 1))
        raise BadInputError(f"paths: row {row} has one point; wanted two or more for a spline")
    if samples > MOST_SAMPLES:
        raise BadInputError(f"samples: got {samples:,}; wanted at most {MOST_SAMPLES:,}")
    what = f"samples: got {samples:,}; {len(given)} x {samples:,} points"
    check_memory(len(given) * samples * _POINT_BYTES, what)
    cells = given.metres(size, corner)
    points = filled(cells, max(4, bucket(cells.shape[1])), axis=1)
    base = points[:, :1]

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array, ...]:
        local = (points[rows] - base[rows]).astype(np.float32)
        return _spline(*jax.device_put((local, given.counts[rows]), device), samples)

    places, heading, curvature = few_sizes(len(given)).arrays(work)
    places = places + base
    places[:, -1] = points[:, -1]
    counts = np.where(given.counts > 0, samples, 0).astype(np.int32)
    return Splines(places, heading, curvature, counts)


def _pruned(paths: Any, lengths: Any, blocked: Any, corner_cutting: bool, repeat: bool) -> KeyPaths:
    frame = path_frame(blocked, None, None)
    given = path_rows(paths, lengths, cells_only=True)
    check_on_water(given, frame, corner_cutting)
    return prune_cells(given, frame, corner_cutting, repeat)


def prune_cells(given: Paths, frame: Frame, corner_cutting: bool, repeat: bool) -> KeyPaths:
    """`shorten`, or `key_points` where `repeat`, of checked paths."""
    width = given.points.shape[1]

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[np.ndarray, jax.Array]:
        capacity = bucket(max(int(given.counts[rows].max()), 64), 4)
        cells = filled(given.points[rows], capacity, axis=1)[:, :capacity]
        arrays = jax.device_put((cells, given.counts[rows]), device)
        index, count = _prune(frame.charts(rows, device), *arrays, repeat, corner_cutting)
        return filled(np.asarray(index), width, axis=1)[:, :width], count

    # Long paths take longest; alike in a block, none waits for another.
    order = np.argsort(given.counts, kind="stable")
    index, count = few_sizes(len(given), frame.most_rows, order).arrays(work)
    index = index[:, : max(int(count.max()), 1)]
    path = np.take_along_axis(given.points, index[..., None], axis=1)
    return KeyPaths(path, count, index)


@partial(jax.jit, static_argnums=(3, 4), compiler_options=QUICKLY_COMPILED)
def _prune(
    charts: Charts,
    cells: jax.Array,
    counts: jax.Array,
    repeat: bool,
    corner_cutting: bool,
) -> tuple[jax.Array, jax.Array]:
    return smoothing.prune(charts, cells, counts, repeat=repeat, corner_cutting=corner_cutting)


_redensify = jax.jit(smoothing.redensify, static_argnums=3, compiler_options=QUICKLY_COMPILED)
_spline = jax.jit(spline_kernel.clamped_spline, static_argnums=2, compiler_options=QUICKLY_COMPILED)
