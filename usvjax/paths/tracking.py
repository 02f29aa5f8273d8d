"""Whether a vessel of limited yaw rate stays on its path: many at once."""

from dataclasses import dataclass, fields
from functools import partial
from math import ceil
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from usvjax.batches import bucket, few_sizes, filled
from usvjax.checks import any_array, float_array, positive
from usvjax.devices import QUICKLY_COMPILED
from usvjax.errors import BadInputError
from usvjax.memory import check_memory
from usvjax.paths.inputs import EDGE, Frame, Paths, check_on_map, path_frame, path_rows
from usvjax.paths.points import polyline_pieces, sample_pieces, sample_room, without_repeats
from usvjax.public import public
from usvkernels.paths import tracking as kernel
from usvkernels.paths.charts import Charts
from usvkernels.paths.tracking import TrackParams

STEPS = 1.5  # times those that the path's length takes, before a vessel is given up
WINDOW = 4  # periods of sailing, whose samples may be passed in one
SAMPLES_PER_CELL = 5  # of straight segments, at most, so that corners are cut by little
MOST_STEPS = 1 << 24  # control periods of a vessel
_STEP_BYTES = 72  # pose and distance of a vessel at a control period, and the copies made of them

Samples = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Points [B, N, 2] from the map's corner (m), curvature (1/m), their number."""


@dataclass(frozen=True)
class Tracks:
    """How B vessels followed their paths; numpy arrays.

    Attributes:
        arrived: bool[B], abeam of the path's end in time.
        collided: bool[B], at any control period on a blocked cell or off the map.
        error: float32[B], largest distance from the path (m).
        time: float32[B], s.
        poses: float64[B, T + 1, 3], x, y (m), psi (rad) at every control period; stays at its
            last when the vessel has arrived.
        distance: float32[B, T + 1], from the path (m).
    """

    arrived: np.ndarray
    collided: np.ndarray
    error: np.ndarray
    time: np.ndarray
    poses: np.ndarray
    distance: np.ndarray


@public("usvkernels.paths")
def track_paths(
    paths: Any,
    lengths: Any,
    blocked: Any,
    *,
    curvature: Any = None,
    params: TrackParams | None = None,
    spacing: float | None = None,
    cell_size: float | None = None,
    origin: Any = None,
) -> Tracks:
    """Let vessels of constant speed and bounded yaw rate follow paths.

    Chen et al. 2023, Figs. 15 and 16: the vessel turns with u / r at the tightest, so that it
    runs wide of a sharp corner. The helmsman steers by the path's curvature and corrects what
    he is off; he does not look ahead.

    Time and memory grow with the control periods of the longest path, which follow one another
    and are all kept: 150 km at 15 m/s and 0.05 s are 200,000 of them, of 72 bytes a vessel. For
    long routes take a larger `dt` (u dt well below the recovery length) or a part of the route.

    Args:
        paths: int[B, P, 2], cells, or float[B, P, 2], m: the straight segments to follow; or,
            with `curvature`, samples of a smooth path as `smooth_turns` returns them.
        lengths: int[B], points of each path, 0 where there is none; None: all P.
        blocked: the map as it is, not inflated: bool[H, W] shared, bool[B, H, W], a `GridMap`.
        curvature: float[B, P], 1/m, at the samples; None: straight segments.
        params: speed, yaw rate, recovery length, control period; defaults to Chen's Table 1.
        spacing: m, of the samples that stand for straight segments, which cut a right-angled
            corner by up to a third of it; default a fifth of a cell, or u dt where that is more.
        cell_size: m, default 1; origin: (x, y), m, default (0, 0). A `GridMap` has its own.

    Raises:
        BadTypeError, BadInputError: wrong types, shapes or numbers, a path off the map, more
            samples or control periods than memory holds.
    """
    frame = path_frame(blocked, cell_size, origin)
    given = path_rows(paths, lengths)
    check_on_map(given, frame, EDGE)
    params = _checked(params or TrackParams())
    spacing = None if spacing is None else positive("spacing", spacing)
    period = float(params.speed) * float(params.dt)
    points = given.metres(frame.cell_size, frame.origin) - frame.origin
    if curvature is None:
        apart = spacing or max(frame.cell_size / SAMPLES_PER_CELL, period)
        samples = _along_segments(points, given.counts, apart)
    else:
        samples = (points, _curvature(curvature, given), given.counts)
    return _sailed(samples, frame, params)


def _curvature(value: Any, given: Paths) -> np.ndarray:
    """Curvature at samples, float64[B, P], 0 where there are none, whatever stands there."""
    shape = given.points.shape[:2]
    array = any_array("curvature", value, f"shape {shape}")
    if array.dtype.kind == "f" and array.shape == shape:
        value = np.where(np.arange(shape[1]) < given.counts[:, None], array, 0.0)
    return float_array("curvature", value, shape)


def _along_segments(points: np.ndarray, counts: np.ndarray, spacing: float) -> Samples:
    points, distinct = without_repeats(points, counts)
    pieces = polyline_pieces(filled(points, 2, axis=1))
    longest = float(pieces[2].sum(axis=1, dtype=np.float64).max())
    room = sample_room(longest, spacing, len(points), f"spacing: {spacing:g} m")
    places, _, curvature, number = sample_pieces(pieces, spacing, room)
    return places, curvature, np.where(distinct > 1, number, 0)


def _steps(longest: float, vessels: int, params: TrackParams) -> int:
    """Control periods for a path of so many m; refuses more than memory holds."""
    wanted = STEPS * longest / (float(params.speed) * float(params.dt))
    what = (
        f"params: speed {params.speed:g} m/s and dt {params.dt:g} s, which on a path of "
        f"{longest:.6g} m make {wanted:.3g} control periods"
    )
    if not wanted < MOST_STEPS:
        raise BadInputError(f"{what}; wanted fewer than {MOST_STEPS:,}")
    steps = bucket(ceil(wanted) + 64)
    check_memory(vessels * steps * _STEP_BYTES, f"{what}; tracking {vessels} paths so")
    return steps


def _sailed(samples: Samples, frame: Frame, params: TrackParams) -> Tracks:
    points, curvature, counts = samples
    gaps = np.linalg.norm(np.diff(points, axis=1), axis=2)
    between = np.arange(gaps.shape[1]) < counts[:, None] - 1
    gaps = np.where(between, gaps, 0.0)
    period = float(params.speed) * float(params.dt)
    steps = _steps(float(gaps.sum(axis=1).max()), len(points), params)
    usual = gaps.sum() / max(between.sum(), 1)
    width = bucket(max(points.shape[1], 64), 4)
    window = bucket(ceil(min(WINDOW * period / usual, width))) if usual > 0 else 1

    def work(rows: np.ndarray, _: int, device: jax.Device) -> tuple[jax.Array, ...]:
        reference = tuple(
            filled(a[rows], width, axis=1).astype(np.float32) for a in (points, curvature)
        )
        return _follow(
            jax.device_put((*reference, counts[rows].astype(np.int32)), device),
            frame.charts(rows, device),
            np.float32(frame.cell_size),
            params,
            steps,
            np.int32(window),
        )

    batch = few_sizes(len(points), frame.most_rows)
    poses, distance, worst, arrived, collided, used = batch.arrays(work)
    last = int(used.max(initial=0)) + 1
    poses = poses[:, :last].astype(np.float64)
    poses[..., :2] += frame.origin
    time = (used * np.float32(params.dt)).astype(np.float32)
    return Tracks(arrived, collided, worst, time, poses, distance[:, :last])


def _checked(params: TrackParams) -> TrackParams:
    values = {f.name: positive(f"params.{f.name}", getattr(params, f.name)) for f in fields(params)}
    return TrackParams(**values)


@partial(jax.jit, static_argnums=4, compiler_options=QUICKLY_COMPILED)
def _follow(
    reference: tuple[jax.Array, ...],
    charts: Charts,
    cell_size: jax.Array,
    params: TrackParams,
    steps: int,
    window: jax.Array,
) -> tuple[jax.Array, ...]:
    track = kernel.follow(
        kernel.Reference(*reference), charts, cell_size, params, steps=steps, window=window
    )
    return (
        jnp.moveaxis(track.poses, 0, 1),
        track.error.T,
        track.worst,
        track.arrived,
        track.collided,
        track.steps,
    )
