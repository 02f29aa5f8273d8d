"""A lake chart with many trajectories, coloured by how they ended."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.plots import style
from usvjax.plots.paths import clean_track
from usvkernels.status import Status

STATUS_ORDER = (*sorted(Status)[1:], Status.RUNNING)
NICE_LENGTHS_KM = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100)
_M_PER_KM = 1000.0


@style.styled
def plot_chart(
    grid_map: GridMap,
    trajectories: ArrayLike,
    status: ArrayLike,
    *,
    max_paths: int = 200,
    view: tuple[float, float, float, float] | None = None,
    attribution: str | None = None,
    title: str | None = None,
) -> Figure:
    """Draw trajectories on a map of land and water, coloured by outcome, north up.

    Args:
        grid_map: The map; `blocked` cells are land.
        trajectories: float[B, T, 2 or more]; the first two columns are (x, y) in m, NaN is
            padding.
        status: int[B], codes of `usvkernels.status.Status`.
        max_paths: Draw at most so many, spread evenly over the B given; the counts in the
            legend are always of all B.
        view: (west, east, south, north), m: the part to show; None shows the whole map.
        attribution: Source of the chart, written small into it; None takes the map's own.
        title: Title of the axes.

    Returns:
        The figure, 170 mm wide.

    Raises:
        BadInputError: Shapes that do not agree, an unknown status, max_paths below 1, or an
            empty view.
    """
    tracks, codes = _check(trajectories, status, max_paths)
    west, east, south, north = grid_map.extent if view is None else view
    if not (west < east and south < north):
        raise BadInputError(f"view is {view}; (west, east, south, north) in m was wanted")
    shape = min(max((north - south) / (east - west), 0.4), 1.3)
    fig = style.new_figure(style.DOUBLE_MM, style.DOUBLE_MM * shape * 0.92 + 22)
    ax = fig.subplots()
    draw_map(ax, grid_map, _M_PER_KM)
    ax.set(xlim=(west / _M_PER_KM, east / _M_PER_KM), ylim=(south / _M_PER_KM, north / _M_PER_KM))
    drawn = np.unique(np.linspace(0, len(codes) - 1, min(max_paths, len(codes))).astype(int))
    handles = _draw_tracks(ax, tracks, codes, drawn)
    _scale_bar(ax)
    _north_arrow(ax)
    note = f"{len(drawn):,} of {len(codes):,} episodes drawn"
    ax.set_title(style.folded(f"{title}: {note}" if title else note, 95))
    style.map_axes(ax, "km")
    _attribute(ax, grid_map.attribution if attribution is None else attribution)
    style.outside_legend(fig, handles, columns=len(handles))
    return style.settle(fig)


def _check(
    trajectories: ArrayLike, status: ArrayLike, max_paths: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    tracks = np.asarray(trajectories, dtype=float)
    codes = np.asarray(status)
    if tracks.ndim != 3 or tracks.shape[2] < 2 or tracks.shape[0] == 0:
        raise BadInputError(f"trajectories has shape {tracks.shape}; (B, T, 5) was wanted")
    if codes.shape != tracks.shape[:1]:
        wanted = tracks.shape[:1]
        raise BadInputError(f"status has shape {codes.shape}; {wanted} was wanted")
    for code in np.unique(codes):
        style.status_name(code)
    if max_paths < 1:
        raise BadInputError(f"max_paths is {max_paths}; at least 1 was wanted")
    return tracks, codes.astype(np.int64)


def detail(
    grid_map: GridMap, trajectories: ArrayLike, status: ArrayLike, width: float
) -> tuple[float, float, float, float] | None:
    """Choose the square in which most episodes failed, for `plot_chart`'s `view`.

    Args:
        grid_map: The map; the square lies inside it where it fits.
        trajectories: float[B, T, 2 or more], m, NaN is padding.
        status: int[B].
        width: Side of the square, m.

    Returns:
        (west, east, south, north), m, about the end of a failed episode, the first of equals;
        None where none failed.

    Raises:
        BadInputError: Shapes that do not agree, or an unknown status.
    """
    tracks, codes = _check(trajectories, status, 1)
    failed = np.flatnonzero(codes != Status.REACHED)
    if len(failed) == 0:
        return None
    ends = np.array([clean_track(tracks[i], f"{i}")[-1] for i in failed])
    near = (np.abs(ends[:, None] - ends[None]) < width / 2).all(axis=-1)
    x, y = ends[near.sum(axis=1).argmax()]
    west, east, south, north = grid_map.extent
    left = max(min(float(x) - width / 2, east - width), west)
    bottom = max(min(float(y) - width / 2, north - width), south)
    return left, min(left + width, east), bottom, min(bottom + width, north)


def draw_map(ax: Axes, grid_map: GridMap, unit: float) -> None:
    """Draw land, water and the shoreline between them.

    Args:
        ax: Axes to draw on; their limits become those of the map.
        grid_map: The map.
        unit: Metres in one unit of the axes: 1000 for axes in km.
    """
    land, size = grid_map.blocked, grid_map.cell_size / unit
    west, east, south, north = (edge / unit for edge in grid_map.extent)
    colours = ListedColormap([style.WATER, style.LAND])
    ax.imshow(
        land,
        origin="lower",
        extent=(west, east, south, north),
        cmap=colours,
        vmin=0,
        vmax=1,
        zorder=0,
    )
    if land.any() and not land.all():
        x = west + size * (np.arange(land.shape[1]) + 0.5)
        y = south + size * (np.arange(land.shape[0]) + 0.5)
        ax.contour(x, y, land, levels=[0.5], colors=style.SHORE, linewidths=0.5, zorder=1)
    ax.set(xlim=(west, east), ylim=(south, north))
    ax.grid(visible=False)


def _draw_tracks(
    ax: Axes, tracks: NDArray[np.float64], codes: NDArray[np.int64], drawn: NDArray[np.int64]
) -> list[Line2D]:
    handles = []
    for status in STATUS_ORDER:
        count = int((codes == status).sum())
        if count == 0:
            continue
        mine = drawn[codes[drawn] == status]
        colour, marker = style.STATUS_COLOUR[status], style.STATUS_MARKER[status]
        lines = [clean_track(tracks[i], f"{i}") / _M_PER_KM for i in mine]
        # Failures are what the eye should find: above the others, and larger.
        failed = status != Status.REACHED
        layer, size = (2.5, 3.2) if failed else (2.0, 2.0)
        paths = LineCollection(lines, colors=colour, linewidths=0.8, alpha=0.75, zorder=layer)
        ax.add_collection(paths)
        ends = np.array([line[-1] for line in lines]).reshape(-1, 2)
        ax.plot(*ends.T, marker, color=colour, markersize=size, zorder=layer + 0.1)
        share = 100 * count / len(codes)
        label = f"{style.STATUS_LABEL[status]} {count:,} ({share:.1f} %)"
        handles.append(Line2D([], [], color=colour, marker=marker, markersize=4, label=label))
    return handles


def _scale_bar(ax: Axes) -> None:
    (west, east), (south, north) = ax.get_xlim(), ax.get_ylim()
    length = max((n for n in NICE_LENGTHS_KM if n <= 0.25 * (east - west)), default=east - west)
    x, y = west + 0.04 * (east - west), south + 0.05 * (north - south)
    ax.plot([x, x + length], [y, y], color=style.BLACK, linewidth=2, solid_capstyle="butt")
    ax.annotate(
        f"{length:g} km", (x + length / 2, y), (0, 3), textcoords="offset points", ha="center"
    )


def _attribute(ax: Axes, text: str) -> None:
    """Write the source of the chart small in the south-east corner."""
    if not text:
        return
    box = {"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 1.5}
    mark = ax.text(0.995, 0.006, text, fontsize=6, bbox=box, zorder=5, transform=ax.transAxes)
    mark.set(ha="right", va="bottom", color="#404040")


def _north_arrow(ax: Axes) -> None:
    ax.annotate(
        "N",
        xy=(0.965, 0.965),
        xytext=(0.965, 0.885),
        xycoords="axes fraction",
        ha="center",
        va="center",
        arrowprops={"arrowstyle": "-|>", "color": style.BLACK, "linewidth": 0.9},
    )
