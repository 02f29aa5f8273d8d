"""Panels of fleets under way: maps with tracks, and hulls to scale at equal times."""

import math
from collections.abc import Callable, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from usvjax.mission import Replayed
from usvjax.plots import base_map, style
from usvjax.plots.paths import draw_obstacles, view_limits
from usvjax.plots.route import view_around

FloatArray = NDArray[np.float64]

Marking = Callable[[Axes, Replayed], list[Line2D]]
"""Marks places of the first episode, and returns the legend's handles."""

_COLOURS = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.SKY, style.ORANGE)

_TIMES = 8
"""About so many times at which hulls are drawn."""

_TALL = 1.3
"""Panels of a larger height by width stand side by side."""


@style.styled
def plot_fleets(found: Mapping[str, Replayed], title: str, mark: Marking | None = None) -> Figure:
    """Draw fleets side by side, each with its tracks, and its hulls at equal times to scale.

    Args:
        found: by strategy, or by what else differs, the first episode of each.
        title: of the figure.
        mark: marks where they begin and end; None: starts and goals.
    """
    along = [each.recording.tracks[0].along for each in found.values()]
    period = _round_up(max(float(time[-1]) for time in along) / _TIMES)
    view = _view(list(found.values()))
    shape = (view[3] - view[2]) / (view[1] - view[0])
    columns = min(len(found), 3 if len(found) == 3 else 4 if shape > _TALL else 2)
    fig, axes = _axes(len(found), columns)
    handles: list[Line2D] = []
    for ax, (name, each) in zip(axes, found.items(), strict=True):
        obstacles = _draw_ground(ax, each)
        handles = [*_draw_fleet(ax, each, period), *(mark or draw_ends)(ax, each), *obstacles]
        gap = "\n" if columns > 2 else " "
        ax.set(xlim=view[:2], ylim=view[2:], title=f"{name}:{gap}{ending_words(each)}")
        base_map.label_axes(ax)
        ax.label_outer()
    for ax in axes[-columns:]:
        # Where nothing stands below, though it is not the last row.
        ax.tick_params(labelbottom=True)
        ax.set_xlabel(axes[-1].get_xlabel())
    fig.suptitle(style.folded(title, 95))
    style.outside_legend(fig, handles, columns=4)
    grid = next(iter(found.values())).recording.grounds[0].grid
    # The source of a map, and each line of the legend, take room below.
    below = 8 * (grid is not None) + 4.5 * -(-len(handles) // 4)
    wide = (style.DOUBLE_MM - 20) / columns
    rows = -(-len(found) // columns)
    height = rows * (wide * min(max(shape, 0.3), 2.5) + 8) + 22 + below
    fig.set_figheight(height / 25.4)
    style.settle(fig)
    if grid is not None:
        base_map.write_below(axes[-1], grid.attribution)
    return style.settle(fig)


def _axes(count: int, columns: int) -> tuple[Figure, list[Axes]]:
    """An empty figure with so many axes that show the same part of the world."""
    fig = style.new_figure(style.DOUBLE_MM, style.DOUBLE_MM)
    rows = -(-count // columns)
    grid = fig.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).reshape(-1)
    for ax in grid[count:]:
        ax.remove()
    return fig, list(grid[:count])


def ending_words(each: Replayed) -> str:
    """How the first episode ended, and when."""
    status, time = int(each.columns["status"][0]), float(each.columns["time"][0])
    return f"{style.status_name(status)}, {time:,.0f} s"


def _round_up(least: float) -> float:
    """The smallest of 1, 2, 5, 10, 20, ... that is no less."""
    decade = 10.0 ** math.floor(math.log10(max(least, 1.0)))
    return next(step * decade for step in (1, 2, 5, 10) if step * decade >= least)


def _view(found: list[Replayed]) -> base_map.View:
    """The part to show of the first episodes: (west, east, south, north), m."""
    about, grounds = [], [each.recording.grounds[0] for each in found]
    for each, ground in zip(found, grounds, strict=True):
        hull = float(each.scene.hulls[0].max())
        points = [each.recording.tracks[0].places.reshape(-1, 2), *ground.marks.values()]
        about += [p + shift for p in points for shift in (-hull, hull)]
    if grounds[0].grid is not None:
        return view_around(grounds[0].grid, about)
    circles = np.concatenate([ground.circles for ground in grounds])
    (west, east), (south, north) = view_limits(about, circles, grounds[0].radius)
    return west, east, south, north


def colours_of(count: int) -> list[str]:
    """One for each vessel; of more than a reader can tell apart, one for all."""
    return list(_COLOURS[:count]) if count <= len(_COLOURS) else [style.BLUE] * count


def _draw_ground(ax: Axes, each: Replayed) -> list[Line2D]:
    """Draw the map, or the obstacles; return the legend's handles."""
    ground = each.recording.grounds[0]
    if ground.grid is not None:
        base_map.paint_map(ax, ground.grid)
    return draw_obstacles(ax, ground.circles, ground.radius)


def _draw_fleet(ax: Axes, each: Replayed, period: float) -> list[Line2D]:
    """Draw tracks, and hulls each period (s) and at the end; return the legend's handles."""
    track, hulls = each.recording.tracks[0], each.scene.hulls[0]
    along, places = track.along, track.places
    times = np.append(np.arange(0.0, along[-1], period), along[-1])
    shown = places[np.searchsorted(along, times)]
    colours = colours_of(len(hulls))
    for i, colour in enumerate(colours):
        ax.plot(*places[:, i].T, color=colour, linewidth=0.9, zorder=3)
        ax.plot(*shown[:, i].T, ".", color=colour, markersize=3.0, zorder=3.2)
    for place in shown:
        draw_hulls(ax, place, hulls, colours)
    said = f"hull to scale every {period:,.0f} s"
    names = [f"vessel {i + 1}" for i in range(len(hulls))]
    if len(hulls) > len(_COLOURS):
        colours, names = colours[:1], [f"{len(hulls)} vessels"]
    handles = [
        Line2D([], [], color=colour, label=name)
        for colour, name in zip(colours, names, strict=True)
    ]
    dot = Line2D([], [], color=style.GREY, linestyle="", marker=".", label=said)
    return [*handles, dot]


def draw_hulls(
    ax: Axes, place: FloatArray, hulls: FloatArray, colours: list[str]
) -> EllipseCollection:
    """Draw hulls float64[n] (m) to scale at float64[n, 2] (m)."""
    drawn = EllipseCollection(
        2 * hulls,
        2 * hulls,
        np.zeros(len(hulls)),
        units="xy",
        offsets=place,
        offset_transform=ax.transData,
        facecolors=[(colour, 0.3) for colour in colours],
        edgecolors=colours,
        linewidths=0.5,
        zorder=2.8,
    )
    ax.add_collection(drawn, autolim=False)
    return drawn


def draw_ends(ax: Axes, each: Replayed) -> list[Line2D]:
    """Mark starts and goals of the first episode; return the legend's handles."""
    marks = each.recording.grounds[0].marks
    start = draw_marks(ax, marks["start"], "start", "o", 4.0, "white")
    return [start, draw_marks(ax, marks["goal"], "goal", "*", 7.0, style.YELLOW)]


def draw_marks(
    ax: Axes, places: FloatArray, name: str, marker: str, size: float, fill: str
) -> Line2D:
    """Mark places float64[N, 2] (m); return the legend's handle."""
    (mark,) = ax.plot(*places.T, marker, markersize=size, zorder=4, label=name)
    mark.set(markerfacecolor=fill, markeredgecolor=style.BLACK, markeredgewidth=0.6)
    return mark
