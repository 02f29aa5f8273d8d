"""A map as a figure: land and water, true to its cells, with scale, north and source."""

import math
import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator
from mpl_toolkits.axes_grid1.anchored_artists import AnchoredSizeBar  # type: ignore[import-untyped]

from usvjax.maps.grid_map import GridMap
from usvjax.plots import style

# Deeper than the chart's water, which lies under trajectories; the two differ in lightness too.
_WATER = "#B5D6EC"
_KILOMETRES_FROM_M = 5000.0
# Beyond this, lines between cells are finer than a pixel and only cost time.
_MOST_EDGES = 200_000
# Characters: what fits to the right of the legend.
_NOTE_WIDTH = 80


@style.styled
def map_figure(grid: GridMap, *, title: str | None = None) -> Figure:
    """Draw a map, north up, axes in metres, or in kilometres from 5 km up.

    Args:
        grid: The map.
        title: Title; None gives the name, size and cell size of the map.

    Returns:
        The figure, 170 mm wide. Data coordinates are metres.
    """
    x0, x1, y0, y1 = grid.extent
    shape = min(max((y1 - y0) / (x1 - x0), 0.3), 1.3)
    fig = style.new_figure(style.DOUBLE_MM, style.DOUBLE_MM * shape * 0.9 + 24)
    ax = fig.subplots()
    paint_map(ax, grid)
    unit = "km" if max(x1 - x0, y1 - y0) >= _KILOMETRES_FROM_M else "m"
    _label_axes(ax, unit)
    _draw_scale(ax, grid, unit)
    _draw_north(ax)
    ax.set_title(_title_of(grid) if title is None else title)
    handles = [
        Patch(facecolor=_WATER, edgecolor=style.SHORE, label="water (free)"),
        Patch(facecolor=style.LAND, edgecolor=style.SHORE, label="land (blocked)"),
    ]
    fig.legend(handles=handles, loc="outside lower left", ncols=2)
    if grid.attribution:
        note = textwrap.fill(grid.attribution, _NOTE_WIDTH, max_lines=2, placeholder=" ...")
        fig.text(0.99, 0.01, note, fontsize=6, color="#404040", ha="right", va="bottom")
    return style.settle(fig)


def paint_map(ax: Axes, grid: GridMap) -> None:
    """Paint the cells of a map and the lines between land and water; axes in metres."""
    x0, x1, y0, y1 = grid.extent
    ax.imshow(
        grid.blocked,
        origin="lower",
        extent=grid.extent,
        cmap=ListedColormap([_WATER, style.LAND]),
        vmin=0,
        vmax=1,
        interpolation="nearest",
        zorder=0,
    )
    edges = _shore_edges(grid)
    if len(edges) <= _MOST_EDGES:
        width = 0.6 if max(grid.shape) <= 200 else 0.35
        lines = LineCollection(list(edges), colors=style.SHORE, linewidths=width, zorder=1)
        lines.set_capstyle("projecting")
        ax.add_collection(lines)
    ax.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal")
    ax.grid(visible=False)


def _shore_edges(grid: GridMap) -> np.ndarray:
    """Cell edges between blocked and free cells, float[n, 2 ends, 2], m."""
    y, x = np.nonzero(grid.blocked[:, 1:] != grid.blocked[:, :-1])
    upright = np.stack([np.stack([x + 1, y], -1), np.stack([x + 1, y + 1], -1)], 1)
    y, x = np.nonzero(grid.blocked[1:] != grid.blocked[:-1])
    level = np.stack([np.stack([x, y + 1], -1), np.stack([x + 1, y + 1], -1)], 1)
    return np.asarray(grid.origin) + grid.cell_size * np.concatenate([upright, level])


def _title_of(grid: GridMap) -> str:
    height, width = grid.shape
    size = f"{width} x {height} cells of {grid.cell_size:g} m"
    return f"{grid.name}: {size}" if grid.name else size


def _label_axes(ax: Axes, unit: str) -> None:
    metres = 1000.0 if unit == "km" else 1.0
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(nbins=8, steps=[1, 2, 5, 10]))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value / metres:g}"))
    style.map_axes(ax, unit)


def _draw_scale(ax: Axes, grid: GridMap, unit: str) -> None:
    x0, x1, _, _ = grid.extent
    length = _round_length(0.25 * (x1 - x0))
    text = f"{length / 1000:g} km" if unit == "km" else f"{length:g} m"
    bar = AnchoredSizeBar(
        ax.transData,
        length,
        text,
        _corner_of_land(grid.blocked),
        pad=0.4,
        borderpad=0.8,
        sep=3,
        frameon=True,
        size_vertical=0.004 * length,
        color=style.BLACK,
        fill_bar=True,
    )
    bar.patch.set(facecolor="white", alpha=0.75, edgecolor="none")
    bar.set_zorder(3)
    ax.add_artist(bar)


def _corner_of_land(blocked: np.ndarray) -> str:
    """Return the corner where a scale bar hides the least water (north-east has the arrow)."""
    height, width = (
        max(size // part, 1) for size, part in zip(blocked.shape, (10, 3), strict=True)
    )
    corners = {
        "lower left": blocked[:height, :width],
        "lower right": blocked[:height, -width:],
        "upper left": blocked[-height:, :width],
    }
    return max(corners, key=lambda corner: corners[corner].mean())


def _round_length(longest: float) -> float:
    """Return the largest of 1, 2, 5, 10, 20, ... that is no longer than ``longest``."""
    decade = 10.0 ** math.floor(math.log10(longest))
    return max(step * decade for step in (1, 2, 5) if step * decade <= longest)


def _draw_north(ax: Axes) -> None:
    ax.annotate(
        "N",
        xy=(0.965, 0.975),
        xytext=(0.965, 0.905),
        xycoords="axes fraction",
        ha="center",
        va="center",
        arrowprops={"arrowstyle": "-|>", "color": style.BLACK, "linewidth": 0.9},
        zorder=3,
    )
