"""Paths on grids, drawn as the papers draw them: row 0 uppermost, blocked cells black."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from usvjax.plots import style


def paint_cells(
    ax: Axes, blocked: np.ndarray, marked: Sequence[tuple[int, int]] = (), north_up: bool = False
) -> None:
    """Paint the cells of a map.

    Args:
        ax: Where to.
        blocked: bool[H, W], drawn black.
        marked: Cells (x, y) to draw grey.
        north_up: Whether row 0 is the lowest, as on a chart.
    """
    shade = np.where(blocked, 0.15, 1.0)
    for x, y in marked:
        shade[y, x] = 0.72
    ax.imshow(
        shade,
        cmap="gray",
        vmin=0.0,
        vmax=1.0,
        origin="lower" if north_up else "upper",
        interpolation="nearest",
    )
    height, width = blocked.shape
    frame = Rectangle((-0.5, -0.5), width, height, fill=False, edgecolor=style.BLACK, lw=0.8)
    ax.add_patch(frame)
    ax.set(xticks=[], yticks=[])
    ax.grid(visible=False)
    for spine in ax.spines.values():
        spine.set_visible(False)


def draw_path(ax: Axes, cells: np.ndarray, colour: str = style.VERMILLION, **look: Any) -> None:
    """Draw a path, int[P, 2], with its start (circle) and goal (square)."""
    ax.plot(cells[:, 0], cells[:, 1], color=colour, **{"linewidth": 1.3, **look})
    for end, marker in ((0, "o"), (-1, "s")):
        ax.plot(
            *cells[end],
            marker=marker,
            markersize=4,
            markerfacecolor="white",
            markeredgecolor=style.BLACK,
            zorder=4,
        )


def end_handles() -> list[Line2D]:
    """What a legend shows of the ends that `draw_path` marks: start and goal."""
    look = {"markersize": 4, "markerfacecolor": "white", "linestyle": "none"}
    return [
        Line2D([], [], color=style.BLACK, marker=marker, label=end, **look)
        for marker, end in (("o", "start"), ("s", "goal"))
    ]
