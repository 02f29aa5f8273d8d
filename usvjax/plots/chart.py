"""A lake chart with many trajectories, coloured by how they ended."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.plots import base_map, inputs, style
from usvjax.plots.paths import clean_track
from usvjax.public import public
from usvkernels.status import EPISODE_ENDINGS, Status

STATUS_ORDER = (*EPISODE_ENDINGS, Status.RUNNING)


@public()
@style.styled
def plot_chart(
    grid_map: GridMap,
    trajectories: ArrayLike,
    status: ArrayLike,
    *,
    max_paths: int = 200,
    sample_of: ArrayLike | None = None,
    view: base_map.View | None = None,
    attribution: str | None = None,
    title: str | None = None,
) -> Figure:
    """Draw trajectories on a map of land and water, coloured by outcome, north up.

    Args:
        grid_map: the map; `blocked` cells are land.
        trajectories: float[B, T, 2 or more]; the first two columns are (x, y) in m, NaN is
            padding.
        status: int[B], codes of `usvkernels.status.Status`.
        max_paths: draw at most so many, spread evenly over the B given. The legend has the
            endings of those drawn, the title the others; counts are always of all episodes.
        sample_of: int[N], status of all the episodes that the B given are a sample of; None
            where these are all.
        view: (west, east, south, north), m: the part to show; None shows the whole map.
        attribution: source of the chart, written small into it; None takes the map's own.
        title: title of the axes.

    Returns:
        The figure, 170 mm wide. Data coordinates are metres; the axes are labelled in
        kilometres from 5 km up.

    Raises:
        BadInputError: shapes that do not agree, an unknown status, max_paths below 1, or an
            empty view.
    """
    inputs.check_chart(grid_map)
    inputs.titles(title=title, attribution=attribution)
    tracks, codes = _check(trajectories, status, max_paths)
    if view is not None:
        view = inputs.check_view("view", view)
    fig, ax = base_map.new_sheet(grid_map, view)
    sample = np.unique(np.linspace(0, len(codes) - 1, min(max_paths, len(codes))).astype(int))
    every = codes if sample_of is None else _codes("sample_of", sample_of)
    lines = [clean_track(tracks[i], f"{i}") for i in sample]
    seen = [i for i, line in enumerate(lines) if _is_seen(line, view or grid_map.extent)]
    shown = codes[sample][seen]
    handles = _draw_tracks(ax, [lines[i] for i in seen], shown, every)
    ax.set_title(_title(title, shown, every))
    style.outside_legend(fig, handles, columns=len(handles))
    source = grid_map.attribution if attribution is None else attribution
    return base_map.finish_sheet(fig, ax, source)


def _is_seen(line: NDArray[np.float64], view: base_map.View) -> bool:
    """Whether any place of a line lies in a view."""
    west, east, south, north = view
    x, y = line.T
    return bool(((x >= west) & (x <= east) & (y >= south) & (y <= north)).any())


def _title(title: str | None, shown: NDArray[np.int64], every: NDArray[np.int64]) -> str:
    """How many are drawn, and how often the endings came that are not among these."""
    note = f"{len(shown):,} of {len(every):,} episodes drawn, marks where they ended; counts of all"
    lines = [*([style.folded(title, 95)] if title else []), note]
    missing = [s for s in STATUS_ORDER if s in every and s not in shown]
    if missing:
        lines.append(f"not among these: {', '.join(_how_often(s, every) for s in missing)}")
    return "\n".join(lines)


def _how_often(status: int, every: NDArray[np.int64]) -> str:
    """How often an ending came, in words."""
    count = int((every == status).sum())
    percent = 100 * count / len(every)
    return f"{style.STATUS_LABEL[status]} {count:,} ({percent:.{1 if percent >= 1 else 2}f} %)"


def _check(
    trajectories: ArrayLike, status: ArrayLike, max_paths: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    tracks = inputs.numbers("trajectories", trajectories, "(B, T, 5)")
    codes = inputs.whole_numbers("status", status)
    if tracks.ndim != 3 or tracks.shape[2] < 2 or tracks.shape[0] == 0:
        raise BadInputError(f"trajectories has shape {tracks.shape}; (B, T, 5) was wanted")
    if codes.shape != tracks.shape[:1]:
        wanted = tracks.shape[:1]
        raise BadInputError(f"status has shape {codes.shape}; {wanted} was wanted")
    if max_paths < 1:
        raise BadInputError(f"max_paths is {max_paths}; at least 1 was wanted")
    return tracks, _codes("status", codes)


def _codes(name: str, status: ArrayLike) -> NDArray[np.int64]:
    codes = inputs.whole_numbers(name, status)
    if codes.ndim != 1 or not len(codes):
        raise BadInputError(f"{name} has shape {codes.shape}; (B,) was wanted, B at least 1")
    for code in np.unique(codes):
        style.status_name(code)
    return codes


def detail(
    grid_map: GridMap, trajectories: ArrayLike, status: ArrayLike, width: float
) -> base_map.View | None:
    """Choose the square in which most episodes failed, for `plot_chart`'s `view`.

    Args:
        grid_map: the map; the square lies inside it where it fits.
        trajectories: float[B, T, 2 or more], m, NaN is padding.
        status: int[B].
        width: side of the square, m.

    Returns:
        (west, east, south, north), m, about the end of a failed episode, the first of equals;
        None where none failed.

    Raises:
        BadInputError: shapes that do not agree, or an unknown status.
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


def _draw_tracks(
    ax: Axes,
    lines: list[NDArray[np.float64]],
    codes: NDArray[np.int64],
    every: NDArray[np.int64],
) -> list[Line2D]:
    """Draw tracks; the legend tells how often their endings came among `every` episode."""
    handles = []
    for status in STATUS_ORDER:
        mine = [line for line, code in zip(lines, codes, strict=True) if code == status]
        if not mine:
            continue
        colour, marker = style.STATUS_COLOUR[status], style.STATUS_MARKER[status]
        # Failures are what the eye should find: above the others, and larger.
        failed = status != Status.REACHED
        layer, size = (2.5, 3.2) if failed else (2.0, 2.0)
        paths = LineCollection(mine, colors=colour, linewidths=0.8, alpha=0.75, zorder=layer)
        ax.add_collection(paths)
        ends = np.array([line[-1] for line in mine])
        ax.plot(*ends.T, marker, color=colour, markersize=size, zorder=layer + 0.1)
        label = _how_often(status, every)
        handles.append(Line2D([], [], color=colour, marker=marker, markersize=4, label=label))
    return handles
