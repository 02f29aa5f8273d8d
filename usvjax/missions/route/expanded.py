"""Which cells a search expands, by its heuristic."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import ArrayLike, NDArray

from usvjax.checks import number, one_of, shown, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap
from usvjax.plots import base_map, inputs, style
from usvjax.plots.paths import draw_ends
from usvjax.public import public
from usvjax.search.astar import astar
from usvjax.search.distance import distance_field

BoolArray = NDArray[np.bool_]
FloatArray = NDArray[np.float64]

HEURISTICS = ("zero", "chebyshev", "euclidean", "octile")
"""Those that never overestimate with diagonal moves."""

# Distances are exact to single precision.
_ON_A_TIE = 1e-5


@dataclass(frozen=True)
class Expanded:
    """What a search with one heuristic expands.

    Attributes:
        heuristic: its name.
        surely: bool[H, W], cells with g + h below the cost of the path: expanded in any case.
        on_tie: bool[H, W], cells with g + h equal to it: expanded or not as ties are broken.
        path: int[P, 2], cells from start to goal.
        cost: its length, cells.
        expanded: how many cells the search expanded.
    """

    heuristic: str
    surely: BoolArray
    on_tie: BoolArray
    path: NDArray[np.int64]
    cost: float
    expanded: int

    def __post_init__(self) -> None:
        inputs.text("heuristic", self.heuristic)
        surely = inputs.flags("surely", self.surely, (None, None))
        inputs.flags("on_tie", self.on_tie, surely.shape)
        high, wide = surely.shape
        if not len(inputs.cells("path", self.path, (high, wide), (None,))):
            raise BadInputError("path is empty; at least one cell was wanted")
        number("cost", self.cost)
        whole_number("expanded", self.expanded, 0)


@public(jit=True)
def expanded_cells(
    grid_map: GridMap,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    heuristics: Sequence[str] = ("zero", "euclidean", "octile"),
    corner_cutting: bool = False,
) -> list[Expanded]:
    """Work out which cells searches from one cell to another expand, for `plot_expanded`.

    A search with a consistent heuristic h expands every cell that it can reach with g + h below
    the cost of the path and none with g + h above it, g being the length of the shortest path
    from the start.

    Args:
        grid_map: the map.
        start: int[2], cell (x, y).
        goal: int[2], cell (x, y).
        heuristics: of `HEURISTICS`.
        corner_cutting: as in `usvjax.search.astar`.

    Raises:
        BadTypeError: cells that are not whole numbers.
        BadInputError: another heuristic, a cell off the map or blocked, or no path.
    """
    for name in inputs.texts("heuristics", heuristics):
        one_of("heuristics", name, HEURISTICS)
    inputs.cells("start", start, grid_map.shape, ())
    x, y = inputs.cells("goal", goal, grid_map.shape, ())
    (length,) = distance_field(grid_map.blocked, start, corner_cutting=corner_cutting)
    result = []
    for name in heuristics:
        found = astar(
            grid_map.blocked,
            start,
            goal,
            heuristic=name,
            corner_cutting=corner_cutting,
            engine="queue",
        )
        cost = float(found.cost[0])
        if not math.isfinite(cost):
            raise BadInputError(f"goal {[int(x), int(y)]} cannot be reached from {shown(start)}")
        total = length.astype(float) + _estimate(name, grid_map.shape, (int(x), int(y)))
        on_tie = np.abs(total - cost) <= _ON_A_TIE * max(cost, 1.0)
        result.append(
            Expanded(
                heuristic=name,
                surely=(total < cost) & ~on_tie,
                on_tie=on_tie,
                path=np.asarray(found.path[0, : found.path_cells[0]], np.int64),
                cost=cost,
                expanded=int(found.expanded[0]),
            )
        )
    return result


def _estimate(heuristic: str, shape: tuple[int, int], goal: tuple[int, int]) -> FloatArray:
    """The heuristic h of every cell, float[H, W], cells."""
    y, x = np.mgrid[: shape[0], : shape[1]]
    east, north = np.abs(x - goal[0]).astype(float), np.abs(y - goal[1]).astype(float)
    longer, shorter = np.maximum(east, north), np.minimum(east, north)
    by_name: dict[str, FloatArray] = {
        "zero": np.zeros(shape),
        "chebyshev": longer,
        "euclidean": np.hypot(east, north),
        "octile": longer + (math.sqrt(2.0) - 1.0) * shorter,
    }
    return by_name[heuristic]


@public()
@style.styled
def plot_expanded(
    grid_map: GridMap, searches: Sequence[Expanded], *, title: str | None = None
) -> Figure:
    """Draw the cells that searches expand on a chart, side by side, with their paths.

    Args:
        grid_map: the map.
        searches: one to four, from `expanded_cells`.
        title: title of the figure.

    Returns:
        The figure, 170 mm wide. Data coordinates are metres; the axes are labelled in
        kilometres from 5 km up.

    Raises:
        BadInputError: None, or more than four.
    """
    inputs.check_chart(grid_map)
    inputs.titles(title=title)
    if not isinstance(searches, list | tuple):
        raise BadTypeError(f"searches: got {shown(searches)}; wanted a list of Expanded")
    if not 1 <= len(searches) <= 4:
        raise BadInputError(f"searches holds {len(searches)}; 1 to 4 were wanted")
    for search in searches:
        if not isinstance(search, Expanded):
            raise BadTypeError(f"searches: got {shown(search)}; wanted Expanded")
        inputs.shaped("surely", search.surely, grid_map.shape)
    west, east, south, north = grid_map.extent
    columns = len(searches)
    high = style.DOUBLE_MM / (columns + 0.15) * (north - south) / (east - west)
    fig = style.new_figure(style.DOUBLE_MM, min(high, 200.0) + 34)
    axes = fig.subplots(1, columns, squeeze=False, sharex=True, sharey=True)[0]
    ends: list[Line2D] = []
    for ax, search in zip(axes, searches, strict=True):
        ends = _draw_search(ax, grid_map, search)
        base_map.label_axes(ax)
        ax.label_outer()
    handles = [
        *ends,
        Line2D([], [], color=style.BLACK, label="route"),
        *_patches(searches),
    ]
    if title:
        fig.suptitle(style.folded(title, 95))
    style.outside_legend(fig, handles, columns=3)
    style.settle(fig)
    base_map.write_below(axes[0], grid_map.attribution)
    return style.settle(fig)


def _patches(searches: Sequence[Expanded]) -> list[Patch]:
    """Handles of the legend for the kinds of cells that any search has."""
    kinds = (
        ("surely", style.ORANGE, "expanded: g + h below the cost of the route"),
        ("on_tie", style.YELLOW, "on a tie: g + h equal to it"),
    )
    return [
        Patch(facecolor=fill, label=label)
        for name, fill, label in kinds
        if any(getattr(search, name).any() for search in searches)
    ]


def _draw_search(ax: Axes, grid_map: GridMap, search: Expanded) -> list[Line2D]:
    """Draw one search on a map; return the legend's handles of its ends."""
    base_map.paint_map(ax, grid_map)
    shade = np.where(search.surely, 0.0, np.where(search.on_tie, 1.0, np.nan))
    ax.imshow(
        np.ma.masked_invalid(shade),
        origin="lower",
        extent=grid_map.extent,
        cmap=ListedColormap([style.ORANGE, style.YELLOW]),
        vmin=0,
        vmax=1,
        interpolation="nearest",
        zorder=0.5,
    )
    route = grid_map.points_of(search.path)
    ax.plot(*route.T, color=style.BLACK, linewidth=1.0, zorder=3)
    ax.set_title(f"{search.heuristic}: {search.expanded:,} expanded\n({_share(grid_map, search)})")
    return draw_ends(ax, route[0], route[-1], None)


def _share(grid_map: GridMap, search: Expanded) -> str:
    sure, tie = int(search.surely.sum()), int(search.on_tie.sum())
    return f"{sure:,} to {sure + tie:,} by ties"
