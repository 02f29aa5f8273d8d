"""Many routes between the same two points: a small chart for each, the others in grey below."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from usvjax.maps import GridMap
from usvjax.plots import base_map, style
from usvjax.plots.paths import draw_ends

FloatArray = NDArray[np.float64]

MOST_TOGETHER = 3
"""More routes than this on one chart hide each other."""

HALO_ID = "halo"
"""Artist id (`get_gid`) of the white line below a route."""

# Charts side by side by the shape (height / width) that they have at least; width of one, mm.
_COLUMNS = ((0.8, 4), (0.5, 3), (0.0, 2))
_PANEL_MM = {4: 38.0, 3: 51.0, 2: 77.0}
_OTHERS: dict[str, Any] = {"color": style.GREY, "linewidth": 0.8}


def draw_panels(
    grid_map: GridMap,
    lines: Mapping[str, FloatArray],
    views: Sequence[base_map.View],
    captions: Sequence[str],
) -> tuple[Figure, list[list[Axes]], list[Line2D]]:
    """Draw each route on a chart of its own, above the others in grey.

    Args:
        grid_map: the map.
        lines: name to float[P, 2], m.
        views: (west, east, south, north), m; a block of charts for each.
        captions: what stands above each block.

    Returns:
        The figure; the axes of each block, a chart for each route; handles of the legend for
        what all charts have.
    """
    shapes = [min(max((n - s) / (e - w), 0.3), 1.6) for w, e, s, n in views]
    columns = [next(count for least, count in _COLUMNS if shape >= least) for shape in shapes]
    rows = [-(-len(lines) // count) for count in columns]
    heights = [
        high * (_PANEL_MM[wide] * shape + 6.0) + 10.0
        for high, wide, shape in zip(rows, columns, shapes, strict=True)
    ]
    legend = 20.0 + 1.5 * len(lines)
    fig = style.new_figure(style.DOUBLE_MM, sum(heights) + legend)
    blocks = fig.subfigures(len(views), 1, height_ratios=heights, squeeze=False)[:, 0]
    handles: list[Line2D] = []
    drawn = []
    for i, (block, view, caption) in enumerate(zip(blocks, views, captions, strict=True)):
        grid = block.subplots(rows[i], columns[i], squeeze=False, sharex=True, sharey=True)
        axes = grid.reshape(-1)
        if caption:
            block.suptitle(caption)
        for ax in axes[len(lines) :]:
            ax.remove()
        drawn.append(list(axes[: len(lines)]))
        for ax, name in zip(drawn[-1], lines, strict=True):
            handles = _draw_one(ax, grid_map, lines, name, view)
        for ax in drawn[-1][-columns[i] :]:
            # Where nothing stands below, though it is not the last row.
            ax.tick_params(labelbottom=True)
            ax.set_xlabel(drawn[-1][-1].get_xlabel())
    return fig, drawn, handles


def _draw_one(
    ax: Axes, grid_map: GridMap, lines: Mapping[str, FloatArray], name: str, view: base_map.View
) -> list[Line2D]:
    """Draw one route above the others; return the legend's handles of ends and others."""
    base_map.paint_map(ax, grid_map)
    ax.set(xlim=view[:2], ylim=view[2:])
    for other, line in lines.items():
        if other != name:
            ax.plot(*line.T, zorder=2, **_OTHERS)
    colour, dashes, _ = style.method_looks(lines)[name]
    # Where another is the same, it would show through the gaps of a broken line.
    ax.plot(*lines[name].T, color="white", linewidth=2.2, zorder=2.5, gid=HALO_ID)
    ax.plot(*lines[name].T, color=colour, linestyle=dashes, linewidth=1.4, zorder=3)
    ax.set_title(name)
    base_map.label_axes(ax)
    ax.label_outer()
    ends = draw_ends(ax, lines[name][0], lines[name][-1], None)
    return [*ends, Line2D([], [], label="the other routes", **_OTHERS)]
