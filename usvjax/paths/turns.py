"""Paths that a vessel can sail: corners turned into arcs no tighter than its turning circle."""

from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from usvjax.batches import sized
from usvjax.checks import any_array, float_array, not_negative, positive, whole_number
from usvjax.errors import BadInputError
from usvjax.paths.corners import Turned, TurnLimits, turn_corners
from usvjax.paths.inputs import Frame, path_frame, path_rows
from usvjax.paths.points import sample_pieces, sample_room, without_idle_points
from usvjax.paths.turn_repair import repair_corners
from usvjax.paths.water import check_on_water
from usvjax.public import public
from usvkernels.paths.turning import Turn


@dataclass(frozen=True)
class PathPieces:
    """Segments and arcs of paths; numpy arrays, S pieces a path.

    Attributes:
        start: float64[B, S, 2], m; nan where there is no piece.
        heading: float32[B, S], course at the start, rad; nan where there is no piece.
        length: float32[B, S], m; 0 where there is no piece, so that sums are of the path.
        curvature: float32[B, S], 1/m, positive to port; 0 on a segment and where there is no piece.
    """

    start: np.ndarray
    heading: np.ndarray
    length: np.ndarray
    curvature: np.ndarray

    @property
    def valid(self) -> np.ndarray:
        """bool[B, S], False at padding."""
        return self.length > 0

    @property
    def sweep(self) -> np.ndarray:
        """float64[B, S], angle turned through, rad, positive to port."""
        return self.curvature.astype(np.float64) * self.length

    @property
    def radius(self) -> np.ndarray:
        """float64[B, S], m; inf on a segment."""
        with np.errstate(divide="ignore"):
            return 1.0 / np.abs(self.curvature.astype(np.float64))

    @property
    def centre(self) -> np.ndarray:
        """float64[B, S, 2], of the arcs (m); nan on a segment."""
        curvature = self.curvature.astype(np.float64)
        signed = np.divide(
            1.0, curvature, out=np.full_like(curvature, np.nan), where=curvature != 0
        )
        normal = np.stack([-np.sin(self.heading), np.cos(self.heading)], axis=-1)
        return self.start + signed[..., None] * normal

    @property
    def end(self) -> np.ndarray:
        """float64[B, S, 2], m."""
        half = self.sweep / 2
        chord = self.length * np.sinc(half / pi)
        course = self.heading + half
        return self.start + chord[..., None] * np.stack([np.cos(course), np.sin(course)], axis=-1)


@dataclass(frozen=True)
class SmoothTurns:
    """Smoothed paths; numpy arrays, in the order of the arguments.

    Attributes:
        fitted: bool[B], whether every corner got its arcs; False where there was no path.
        turns: int32[B, C], how each corner is sailed (`Turn`): 1 inside, 2 late, 3 early, -1 left
            as it is since no template fits, 0 padding.
        corners: float64[B, C, 2], where they are (m); nan where there was no path.
        repaired: bool[B], whether corners were moved.
        pieces: the segments and arcs.
        points: float64[B, N, 2], samples (m) from the path's first point to its last; nan where
            there was no path.
        heading: float32[B, N], rad; curvature: float32[B, N], 1/m, at the samples; nan where there
            was no path.
        counts: int32[B], samples of each path, two at least where it has a length; the last is
            repeated. 0 where there was no path.
        length: float32[B], m; nan where there was no path.
        turning: float32[B], sum of the changes of course, rad; nan where there was no path.
        curvature_bound: float32[B], the largest curvature, 1/m; inf where a corner is left, nan
            where there was no path.
    """

    fitted: np.ndarray
    turns: np.ndarray
    corners: np.ndarray
    repaired: np.ndarray
    pieces: PathPieces
    points: np.ndarray
    heading: np.ndarray
    curvature: np.ndarray
    counts: np.ndarray
    length: np.ndarray
    turning: np.ndarray
    curvature_bound: np.ndarray


@public("usvkernels.paths")
def smooth_turns(
    paths: Any,
    lengths: Any,
    blocked: Any,
    *,
    turning_radius: Any,
    safety_range: Any = None,
    cell_size: float | None = None,
    origin: Any = None,
    margin: float = 0.0,
    spacing: float | None = None,
    corner_cutting: bool = False,
    repair: int = 0,
) -> SmoothTurns:
    """Turn the corners of paths into arcs no tighter than a vessel's turning circle.

    Source: Chen et al. 2023, section 4.1 and Algorithm 1; the geometry of the three templates is
    in `usvkernels.paths.turning`, the readings in docs/equations.md. Give it paths of few points,
    as `shorten` or `key_points` return them: arcs need room between corners. Where two points of a
    path are equal, or three in line, they are taken as one and two.

    Collision: arcs keep more than `margin` off every blocked cell and the map's edge, which
    the test assures for all their points; it refuses a candidate that comes nearer than that
    and a quarter of a cell. Straight pieces are parts of the given path and as clear as it.

    Args:
        paths: int[B, P, 2], cells (x, y), or float[B, P, 2], m; clear of blocked cells.
        lengths: int[B], points of each path, 0 where there is none; None: all P.
        blocked: the map, already inflated: bool[H, W] shared, bool[B, H, W], or a `GridMap`.
        turning_radius: R (m), the vessel's least turning radius; or float[B].
        safety_range: R_s (m), how far from the corner an inside arc leaves the path, where that
            is possible; default 2 R (Chen, Table 1). Or float[B].
        cell_size: m, default 1; origin: (x, y), m, default (0, 0). A `GridMap` has its own.
        margin: m, at most a fifth of a cell; inflate the map for more.
        spacing: m, of the samples; default R / 5.
        corner_cutting: let the given path touch corners of blocked cells.
        repair: rounds, each of which moves, on every path with a corner left over, that corner or
            a neighbour to the best of some 100 places. 0 leaves corners where they are.

    Raises:
        BadTypeError: arguments of the wrong type.
        BadInputError: R not above 0 or beyond the map's longer side, a path that leaves the map
            or meets a blocked cell, ragged or unequal batches, numbers that are not finite, more
            samples than memory holds.
    """
    frame = path_frame(blocked, cell_size, origin)
    given = path_rows(paths, lengths)
    limits = _limits(turning_radius, safety_range, margin, frame, len(given))
    spacing = None if spacing is None else positive("spacing", spacing)
    rounds = whole_number("repair", repair, 0)
    check_on_water(given, frame, corner_cutting)
    points = given.metres(frame.cell_size, frame.origin) - frame.origin
    points, counts = without_idle_points(points, given.counts)
    turned = turn_corners(points, counts, np.arange(len(given)), frame, limits)
    repaired = np.zeros(len(given), bool)
    if rounds:
        points, counts, repaired = repair_corners(
            points, counts, turned[0], frame, limits, turn_corners, rounds, corner_cutting
        )
        changed = np.flatnonzero(repaired)
        if len(changed):
            anew = turn_corners(points[changed], counts[changed], changed, frame, limits)
            turned = tuple(_put(old, new, changed) for old, new in zip(turned, anew, strict=True))
    return _result(turned, points, counts, repaired, frame, _Spacing.of(spacing, limits))


@dataclass(frozen=True)
class _Spacing:
    """How far apart samples are, m, and the argument that says so."""

    metres: float
    what: str

    @classmethod
    def of(cls, given: float | None, limits: TurnLimits) -> "_Spacing":
        if given is not None:
            return cls(given, f"spacing: got {given:g} m")
        least = float(limits.radius.min())
        said = f"turning_radius: got {least:g} m; samples R / 5 apart, for want of a spacing"
        return cls(least / 5, said)


def _put(old: np.ndarray, new: np.ndarray, rows: np.ndarray) -> np.ndarray:
    size = max(old.shape[1], new.shape[1])
    old, new = sized(old, size, axis=1), sized(new, size, axis=1)
    old[rows] = new
    return old


def _limits(
    turning_radius: Any, safety_range: Any, margin: Any, frame: Frame, rows: int
) -> TurnLimits:
    radius = _per_path("turning_radius", turning_radius, rows, frame)
    reach = 2 * radius
    if safety_range is not None:
        reach = _per_path("safety_range", safety_range, rows, frame)
    margin = not_negative("margin", margin)
    if margin > 0.2 * frame.cell_size:
        raise BadInputError(
            f"margin: got {margin:g} m; wanted at most {0.2 * frame.cell_size:g} m, a fifth of a "
            "cell; inflate the map for more"
        )
    return TurnLimits(radius, reach, margin)


def _per_path(name: str, value: Any, rows: int, frame: Frame) -> np.ndarray:
    if any_array(name, value, f"a number or float[{rows}]").ndim == 0:
        values = np.full(rows, positive(name, value))
    else:
        values = float_array(name, value, (rows,))
    if (values <= 0).any():
        row = int(np.argmax(values <= 0))
        raise BadInputError(f"{name}: got {values[row]:g} in row {row}; wanted a number above 0")
    if (values > frame.longer_side).any():
        raise BadInputError(
            f"{name}: got {values.max():g} m; wanted at most {frame.longer_side:g} m, the longer "
            "side of the map"
        )
    return values


def _result(
    turned: Turned,
    points: np.ndarray,
    counts: np.ndarray,
    repaired: np.ndarray,
    frame: Frame,
    spacing: _Spacing,
) -> SmoothTurns:
    cases, deflection, *found = turned
    start, heading, length, curvature = _compacted(found)
    there = counts > 0
    left = cases == Turn.UNFITTED
    jumps = np.where(left, np.abs(deflection), 0.0).sum(axis=1)
    turning = np.abs(curvature * length).sum(axis=1) + jumps
    largest = np.where(left.any(axis=1), np.inf, np.abs(curvature).max(axis=1))
    samples = _samples((start, heading, length, curvature), points, counts, spacing)
    places, course, bend, number = samples
    no_piece = length <= 0
    return SmoothTurns(
        fitted=there & ~left.any(axis=1),
        turns=cases,
        corners=_known(there, sized(points[:, 1:-1], cases.shape[1], axis=1) + frame.origin),
        repaired=repaired,
        pieces=PathPieces(
            start=_known(~no_piece, start + frame.origin),
            heading=_known(~no_piece, heading),
            length=length,
            curvature=np.where(no_piece, np.float32(0.0), curvature),
        ),
        points=_known(there, places + frame.origin),
        heading=_known(there, course),
        curvature=_known(there, bend),
        counts=number,
        length=_known(there, length.sum(axis=1, dtype=np.float64).astype(np.float32)),
        turning=_known(there, turning.astype(np.float32)),
        curvature_bound=_known(there, largest.astype(np.float32)),
    )


def _samples(
    pieces: tuple[np.ndarray, ...], points: np.ndarray, counts: np.ndarray, spacing: _Spacing
) -> tuple[np.ndarray, ...]:
    """Points float64[B, N, 2] (m, from the map's corner), headings, curvatures, their number."""
    longest = float(pieces[2].sum(axis=1, dtype=np.float64).max())
    room = sample_room(longest, spacing.metres, len(points), spacing.what)
    places, course, bend, number = sample_pieces(pieces, spacing.metres, room)
    number = np.where(counts > 0, number, 0).astype(np.int32)
    width = max(int(number.max()), 1)
    places = places[:, :width].astype(np.float64)
    # The ends are as they were given, whatever single precision made of them.
    places[:, 0] = points[:, 0]
    after = np.arange(width) >= np.maximum(number - 1, 0)[:, None]
    places = np.where(after[..., None], points[:, -1:], places)
    return places, course[:, :width], bend[:, :width], number


def _known(there: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The values, nan where there is nothing; `there` has the first axes of `values`."""
    there = there.reshape(there.shape + (1,) * (values.ndim - there.ndim))
    known: np.ndarray = np.where(there, values, values.dtype.type(np.nan))
    return known


def _compacted(pieces: list[np.ndarray]) -> list[np.ndarray]:
    """Start, heading, length and curvature with pieces of no length moved to the end and cut."""
    length = pieces[2]
    order = np.argsort(length <= 0, axis=1, kind="stable")
    width = max(int((length > 0).sum(axis=1).max()), 1)
    order = order[:, :width]
    start = np.take_along_axis(pieces[0], order[..., None], axis=1).astype(np.float64)
    return [start, *(np.take_along_axis(a, order, axis=1) for a in pieces[1:])]
