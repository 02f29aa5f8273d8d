"""Figures with their intervals, drawn."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from usvjax.plots import style


def draw_bars(
    ax: Axes,
    at: np.ndarray,
    found: Sequence[Mapping[str, Any]],
    look: style.Look,
    scale: float = 1.0,
    joined: bool = True,
) -> None:
    """Draw figures with bars for their intervals; one without an interval is a mark alone.

    Args:
        ax: to draw on.
        at: float[n], places of the figures.
        found: the figures, with "value", "low" and "high"; one without a value is left out.
        look: of the method.
        scale: of the figures.
        joined: whether a line joins them.
    """
    known = [(x, one) for x, one in zip(at, found, strict=True) if one["value"] is not None]
    value, low, high = (
        np.array([scale * (one["value"] if one[end] is None else one[end]) for _, one in known])
        for end in ("value", "low", "high")
    )
    ax.errorbar(
        [x for x, _ in known],
        value,
        yerr=[value - low, high - value],
        color=look.colour,
        linestyle=look.line if joined else "none",
        marker=look.marker,
        markersize=4,
        linewidth=1.1,
        elinewidth=0.9,
        capsize=2,
        zorder=look.zorder,
    )
