"""A map by itself: land and water, true to its cells, with scale, north and source."""

from matplotlib.figure import Figure
from matplotlib.patches import Patch

from usvjax.maps import GridMap
from usvjax.plots import base_map, inputs, style
from usvjax.public import public


@public()
@style.styled
def plot_map(grid_map: GridMap, *, title: str | None = None) -> Figure:
    """Draw a map, north up, axes in metres, or in kilometres from 5 km up.

    Args:
        grid_map: the map; `blocked` cells are land.
        title: title; None gives the name, size and cell size of the map.

    Returns:
        The figure, 170 mm wide. Data coordinates are metres.
    """
    inputs.check_chart(grid_map)
    inputs.titles(title=title)
    fig, ax = base_map.new_sheet(grid_map)
    ax.set_title(style.folded(_title_of(grid_map) if title is None else title, 95))
    kinds = (("water (free)", style.WATER, False), ("land (blocked)", style.LAND, True))
    handles = [
        Patch(facecolor=fill, edgecolor=style.SHORE, label=label)
        for label, fill, blocked in kinds
        if (grid_map.blocked == blocked).any()
    ]
    style.outside_legend(fig, handles, columns=2)
    return base_map.finish_sheet(fig, ax, grid_map.attribution)


def _title_of(grid: GridMap) -> str:
    height, width = grid.shape
    size = f"{width} x {height} cells of {grid.cell_size:g} m"
    return f"{grid.name}: {size}" if grid.name else size
