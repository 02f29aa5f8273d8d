"""Labels of places on a chart, beside what is drawn there rather than over it."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from usvjax.plots import style

FloatArray = NDArray[np.float64]

LABEL_ID = "label"
"""Artist id (`get_gid`) of labels."""

# Points: size of the letters, and how far from its place the middle of a label may be.
_SIZE = 6.5
_AWAY = (8.0, 11.0, 15.0, 20.0)
_DIRECTIONS = 16
# From here on a thin line leads to the place.
_LED_FROM = 12.0
# Points between the samples of a line, and width of a letter in units of its size.
_STEP, _LETTER = 1.5, 0.62


def draw_labels(
    ax: Axes, places: FloatArray, texts: Sequence[str], lines: Sequence[FloatArray]
) -> None:
    """Write a label beside each place, off lines, places and other labels where there is room.

    Args:
        ax: axes with their limits, whose layout is settled: the room is measured.
        places: float[N, 2], in data coordinates.
        texts: N labels.
        lines: float[P, 2] each, in data coordinates, that labels shall keep off.
    """
    points = ax.transData.transform(places) * 72 / ax.figure.dpi
    taken = np.concatenate([points, *(_samples(ax, line) for line in lines)])
    frame = np.asarray(ax.get_window_extent().extents) * 72 / ax.figure.dpi
    boxes: list[FloatArray] = []
    for place, point, text in zip(places, points, texts, strict=True):
        half = np.array([_LETTER * _SIZE * len(text) + 1.0, _SIZE + 1.0]) / 2
        around = [point + offset for offset in _offsets()]
        costs = [_cost(middle, half, taken, boxes, frame) for middle in around]
        chosen = around[int(np.argmin(costs))]  # the first, and so the nearest, of equals
        boxes.append(np.concatenate([chosen - half, chosen + half]))
        _write(ax, place, text, chosen - point)


def _offsets() -> list[FloatArray]:
    """Where a label may be, in points from its place, the nearest first."""
    angles = np.arange(_DIRECTIONS) * 2 * math.pi / _DIRECTIONS
    return [r * np.array([math.cos(a), math.sin(a)]) for r in _AWAY for a in angles]


def _cost(
    middle: FloatArray,
    half: FloatArray,
    taken: FloatArray,
    boxes: Sequence[FloatArray],
    frame: FloatArray,
) -> float:
    """How much a label there hides: points of lines, more for labels, most for leaving the axes."""
    low, high = middle - half, middle + half
    hidden = int((np.abs(taken - middle) < half).all(axis=1).sum())
    over = sum((low < box[2:]).all() and (high > box[:2]).all() for box in boxes)
    outside = (low < frame[:2]).any() or (high > frame[2:]).any()
    return float(hidden + 100 * over + 10_000 * bool(outside))


def _samples(ax: Axes, line: FloatArray) -> FloatArray:
    """A line as points close to each other, in points of the page."""
    corners = ax.transData.transform(line) * 72 / ax.figure.dpi
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    where = np.linspace(0.0, along[-1], int(along[-1] / _STEP) + 2)
    return np.column_stack([np.interp(where, along, axis) for axis in corners.T])


def _write(ax: Axes, place: FloatArray, text: str, offset: FloatArray) -> None:
    led = math.hypot(*offset) >= _LED_FROM
    label = ax.annotate(
        text,
        xy=tuple(place),
        xytext=tuple(offset),
        textcoords="offset points",
        fontsize=_SIZE,
        ha="center",
        va="center_baseline",
        zorder=6,
        annotation_clip=True,
        path_effects=[withStroke(linewidth=1.8, foreground="white")],
        arrowprops={"arrowstyle": "-", "linewidth": 0.4, "color": style.BLACK} if led else None,
    )
    label.set_gid(LABEL_ID)
    # It lies inside the axes and must not move a layout that is settled.
    label.set_in_layout(False)
