"""The map below every chart: cells and shore, scale bar, north arrow, axes and source.

Data coordinates are metres in every figure; only the labels change to kilometres.
"""

import math
import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.ticker import FuncFormatter, MaxNLocator
from matplotlib.transforms import ScaledTranslation, Transform
from mpl_toolkits.axes_grid1.anchored_artists import AnchoredSizeBar  # type: ignore[import-untyped]
from numpy.typing import NDArray

from usvjax.maps import GridMap
from usvjax.plots import style

View = tuple[float, float, float, float]
"""(west, east, south, north), m; the order of `GridMap.extent`."""

SHORE_ID = "shore"
"""Artist id (`get_gid`) of the lines between land and water."""

_KILOMETRES_FROM_M = 5000.0
# Beyond this, lines between cells are finer than a pixel and only cost time.
_MOST_EDGES = 200_000
_SOURCE_SIZE, _SOURCE_LINES = 6.0, 3
# Share of the width that the source may take beside the scale bar, which takes a quarter; where
# axes are narrower than this (points), it stands below the bar.
_SOURCE_SHARE, _NARROW = 0.6, 200.0
# Mean width of a letter in units of its font size, on the wide side.
_LETTER = 0.6
# Points: the arrow, the room that it takes beside the scale bar, and what stands below a bar.
_ARROW, _BESIDE, _BELOW = 14.0, 12.0, 21.0


def new_sheet(grid: GridMap, view: View | None = None) -> tuple[Figure, Axes]:
    """Make a figure 170 mm wide with a map on it, north up.

    Args:
        grid: the map.
        view: the part to show; None shows the whole map.

    Returns:
        The figure and its axes, in m. Draw on them, then call `finish_sheet`.
    """
    west, east, south, north = view or grid.extent
    shape = min(max((north - south) / (east - west), 0.15), 1.3)
    fig = style.new_figure(style.DOUBLE_MM, style.DOUBLE_MM * shape * 0.92 + 22)
    ax = fig.subplots()
    paint_map(ax, grid)
    ax.set(xlim=(west, east), ylim=(south, north))
    return fig, ax


def finish_sheet(fig: Figure, ax: Axes, source: str) -> Figure:
    """Label the axes of a sheet, write below them what `write_below` does, run the layout.

    Args:
        fig: the figure, with its title and legends.
        ax: its axes, with their limits.
        source: source and licence of the map; "" writes none.

    Returns:
        The figure.
    """
    label_axes(ax)
    style.settle(fig)
    write_below(ax, source)
    return style.settle(fig)


def write_below(ax: Axes, source: str) -> None:
    """Draw north arrow, scale bar and source below a map, where they hide nothing of it.

    Args:
        ax: axes in m, whose layout is settled: the room is measured. Run it again afterwards.
        source: source and licence of the map; "" writes none.
    """
    labels = ax.xaxis.get_tightbbox()
    assert labels is not None
    window = ax.get_window_extent()
    down = (labels.y0 - window.y0) * 72 / ax.figure.dpi - 4
    _draw_north(ax, down)
    _draw_scale(ax, down)
    narrow = window.width * 72 / ax.figure.dpi < _NARROW
    ax.annotate(
        _folded_source(ax, source, 1.0 if narrow else _SOURCE_SHARE),
        xy=(1, 0),
        xycoords="axes fraction",
        xytext=(0, down - _BELOW * narrow),
        textcoords="offset points",
        fontsize=_SOURCE_SIZE,
        color="#404040",
        ha="right",
        va="top",
    )


def paint_map(ax: Axes, grid: GridMap) -> None:
    """Paint the cells of a map and the lines between land and water.

    Args:
        ax: axes in m; their limits become those of the map.
        grid: the map.
    """
    west, east, south, north = grid.extent
    ax.imshow(
        grid.blocked,
        origin="lower",
        extent=grid.extent,
        cmap=ListedColormap([style.WATER, style.LAND]),
        vmin=0,
        vmax=1,
        interpolation="nearest",
        zorder=0,
    )
    edges = _shore_edges(grid)
    if len(edges) <= _MOST_EDGES:
        shore = LineCollection(list(edges), colors=style.SHORE, linewidths=0.4, zorder=1)
        shore.set(capstyle="projecting", gid=SHORE_ID)
        ax.add_collection(shore, autolim=False)
    ax.set(xlim=(west, east), ylim=(south, north), aspect="equal")
    ax.grid(visible=False)


def label_axes(ax: Axes) -> None:
    """Label axes in metres, or in kilometres where they show 5 km or more.

    Args:
        ax: axes in m, with their limits.
    """
    kilometres = _is_wide(ax)
    scale = 1000.0 if kilometres else 1.0

    def text(value: float, _: int | None) -> str:
        # Ten digits keep 1 m apart in projected coordinates, and hide rounding.
        return FuncFormatter.fix_minus(f"{value / scale:.10g}")

    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(nbins="auto", steps=[1, 2, 5, 10]))
        axis.set_major_formatter(FuncFormatter(text))
    style.map_axes(ax, "km" if kilometres else "m")


def _folded_source(ax: Axes, text: str, share: float) -> str:
    """The source in few lines, none wider than a share of the axes."""
    points = share * ax.get_window_extent().width * 72 / ax.figure.dpi
    letters = max(int(points / (_LETTER * _SOURCE_SIZE)), 12)
    return textwrap.fill(text, letters, max_lines=_SOURCE_LINES, placeholder=" ...")


def _is_wide(ax: Axes) -> bool:
    (west, east), (south, north) = ax.get_xlim(), ax.get_ylim()
    return max(east - west, north - south) >= _KILOMETRES_FROM_M


def _shore_edges(grid: GridMap) -> NDArray[np.float64]:
    """Cell edges between blocked and free cells, float[n, 2 ends, 2], m."""
    y, x = np.nonzero(grid.blocked[:, 1:] != grid.blocked[:, :-1])
    upright = np.stack([np.stack([x + 1, y], -1), np.stack([x + 1, y + 1], -1)], 1)
    y, x = np.nonzero(grid.blocked[1:] != grid.blocked[:-1])
    level = np.stack([np.stack([x, y + 1], -1), np.stack([x + 1, y + 1], -1)], 1)
    edges: NDArray[np.float64] = np.concatenate([upright, level]) * grid.cell_size
    return edges + np.asarray(grid.origin)


def _draw_scale(ax: Axes, down: float) -> None:
    """Draw a bar of a round length, so many points below the axes and beside the arrow."""
    west, east = ax.get_xlim()
    length = _round_length(0.25 * (east - west))
    corner = _shifted(ax, _BESIDE, down)
    bar = AnchoredSizeBar(
        ax.transData,
        length,
        f"{length / 1000:g} km" if length >= 1000 else f"{length:g} m",
        "upper left",
        pad=0.0,
        borderpad=0.0,
        sep=2,
        frameon=False,
        size_vertical=0.0035 * (east - west),
        color=style.BLACK,
        fill_bar=True,
        fontproperties=FontProperties(size=7.0),
        bbox_to_anchor=(0.0, 0.0),
        bbox_transform=corner,
    )
    ax.add_artist(bar)
    bar.set_clip_on(False)  # the layout leaves room only for what is not clipped


def _round_length(longest: float) -> float:
    """Return the largest of 1, 2, 5, 10, 20, ... that is no longer than `longest`."""
    decade = 10.0 ** math.floor(math.log10(longest))
    return max(step * decade for step in (1, 2, 5) if step * decade <= longest)


def _draw_north(ax: Axes, down: float) -> None:
    """Draw an arrow of one size below the western end of the axes, whatever their scale."""
    foot, tip = _shifted(ax, 4.0, down - _ARROW), _shifted(ax, 4.0, down)
    ax.annotate(
        "N",
        xy=(0, 0),
        xycoords=tip,
        xytext=(0, 0),
        textcoords=foot,
        fontsize=7.0,
        ha="center",
        va="center",
        arrowprops={"arrowstyle": "-|>", "color": style.BLACK, "linewidth": 0.9, "shrinkA": 3.0},
        annotation_clip=False,
    )


def _shifted(ax: Axes, right: float, up: float) -> Transform:
    """Places on axes as shares of their size, moved by so many points."""
    return ax.transAxes + ScaledTranslation(right / 72, up / 72, ax.figure.dpi_scale_trans)
