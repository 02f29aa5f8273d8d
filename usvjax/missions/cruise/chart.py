"""One cruise on a chart: the stations in the order of their visits, and the track."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap
from usvjax.plots import base_map, style
from usvjax.plots.labels import draw_labels
from usvjax.plots.paths import clean_track
from usvjax.plots.route import length_of, length_words, view_around

FloatArray = NDArray[np.float64]

TRACK_ID, TOUR_ID = "track", "tour"
"""Artist ids (`get_gid`) of the vessel's track and of the tour in straight lines."""

_ARROWS = 14  # on a track
_TRACK: dict[str, Any] = {"color": style.VERMILLION, "linewidth": 1.3}
_TOUR: dict[str, Any] = {"color": style.BLACK, "linewidth": 0.7, "linestyle": (0, (4, 3))}
_DISC: dict[str, Any] = {
    "linestyle": "",
    "markerfacecolor": "white",
    "markeredgecolor": style.BLACK,
    "markeredgewidth": 0.7,
}
_DISC_SIZE, _HOME_SIZE = 4.0, 6.5


@style.styled
def plot_cruise(
    grid_map: GridMap,
    stations: ArrayLike,
    order: ArrayLike,
    track: ArrayLike,
    *,
    visited: ArrayLike | None = None,
    tour: ArrayLike | None = None,
    track_label: str | None = None,
    tour_label: str | None = None,
    view: base_map.View | None = None,
    title: str | None = None,
) -> Figure:
    """Draw a cruise on a chart, north up.

    Args:
        grid_map: the map; `blocked` cells are land.
        stations: float[d, 2], (x, y) in m; station 0 is home.
        order: int[d], stations in the order of the cruise, home first; they are numbered so.
        track: float[P, 2 or more], m, what the vessel sailed; rows with NaN are padding.
        visited: bool[d], by station; those that were not are marked. By default all were.
        tour: int[d], an order to compare with, drawn as a closed tour in straight lines.
        track_label: what the legend says of the track; by default its length.
        tour_label: likewise of the tour.
        view: (west, east, south, north), m; by default the part around the cruise.
        title: title of the axes.

    Returns:
        The figure, 170 mm wide. Data coordinates are metres; the axes are labelled in
        kilometres from 5 km up.

    Raises:
        BadTypeError: a map that is no `GridMap`.
        BadInputError: arrays of shapes that do not agree, stations that are not finite, an order
            that is not one or does not begin with home, or a tour that is not one.
    """
    if not isinstance(grid_map, GridMap):
        got = type(grid_map).__name__
        raise BadTypeError(f"grid_map is of type {got}; a usvjax.GridMap was wanted")
    places = np.asarray(stations, dtype=float)
    if places.ndim != 2 or places.shape[1] != 2 or len(places) < 2:
        raise BadInputError(f"stations has shape {places.shape}; (d, 2) was wanted, d >= 2")
    if not np.isfinite(places).all():
        raise BadInputError("stations has a number that is not finite")
    visits = _order("order", order, len(places))
    if visits[0] != 0:
        raise BadInputError(f"order is {visits.tolist()}; home, 0, was wanted first")
    seen = np.ones(len(places), bool) if visited is None else np.asarray(visited, bool)
    if seen.shape != (len(places),):
        raise BadInputError(f"visited has shape {seen.shape}; ({len(places)},) was wanted")
    sailed = np.asarray(track, dtype=float)
    if sailed.ndim != 2 or sailed.shape[1] < 2:
        raise BadInputError(f"track has shape {sailed.shape}; (P, 2 or more) was wanted")
    line = clean_track(sailed, "track")
    fig, ax = base_map.new_sheet(grid_map, view or view_around(grid_map, [line, places]))
    handles, ways = [], [line]
    if tour is not None:
        straight = _closed(places[_order("tour", tour, len(places))])
        handles += ax.plot(*straight.T, zorder=2, gid=TOUR_ID, **_TOUR)
        ways.append(straight)
        label = tour_label or f"tour in straight lines: {length_words(length_of(straight))}"
        handles[-1].set_label(label)
    handles += ax.plot(*line.T, zorder=3, gid=TRACK_ID, **_TRACK)
    handles[-1].set_label(track_label or f"track: {length_words(length_of(line))}")
    _draw_arrows(ax, line)
    marks = _draw_stations(ax, places, visits, seen)
    if title:
        ax.set_title("\n".join(style.folded(line, 100) for line in title.split("\n")))
    legend = [*marks, *reversed(handles)]
    widest = max(len(str(handle.get_label())) for handle in legend)
    style.outside_legend(fig, legend, columns=2 if widest > 32 else 3)
    base_map.finish_sheet(fig, ax, grid_map.attribution)
    # In the order of the visits, and where the numbers hide neither track nor tour.
    numbers = [str(n) for n in range(1, len(visits))]
    draw_labels(ax, places[visits[1:]], numbers, ways)
    return fig


def duration_words(seconds: float) -> str:
    """Write a time in s, in min from 2 min up, or in h from 2 h up, to three digits or more."""
    if seconds < 120.0:
        return f"{seconds:.3g} s"
    return f"{seconds / 60.0:.3g} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"


def _order(name: str, value: ArrayLike, count: int) -> NDArray[np.int64]:
    order = np.asarray(value)
    if order.shape != (count,) or not np.array_equal(np.sort(order), np.arange(count)):
        raise BadInputError(f"{name} is {order.tolist()}; each of 0 to {count - 1} was wanted once")
    return order.astype(np.int64)


def _closed(points: FloatArray) -> FloatArray:
    return np.concatenate([points, points[:1]])


def _draw_arrows(ax: Axes, line: FloatArray) -> None:
    """Draw heads of arrows along a line, at even distances, that say which way it was sailed."""
    step = np.hypot(*np.diff(line, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(step)])
    if not along[-1] > 0.0:
        return
    for distance in along[-1] * (np.arange(_ARROWS) + 0.5) / _ARROWS:
        leg = int(np.searchsorted(along, distance, side="right")) - 1
        tail, tip = line[leg], line[leg + 1]
        middle = tail + (tip - tail) * (distance - along[leg]) / step[leg]
        ax.annotate(
            "",
            xy=tuple(middle + 1e-3 * (tip - tail)),
            xytext=tuple(middle),
            arrowprops={"arrowstyle": "-|>", "color": _TRACK["color"], "mutation_scale": 7},
            zorder=3.1,
        )


def _draw_stations(
    ax: Axes, places: FloatArray, order: NDArray[np.int64], visited: NDArray[np.bool_]
) -> list[Line2D]:
    """Draw the stations and home; return the legend's handles."""
    home = {**_DISC, "marker": "s", "markersize": _HOME_SIZE, "markerfacecolor": style.YELLOW}
    handles = ax.plot(*places[0], zorder=4, label="home", **home)
    look = {**_DISC, "marker": "o", "markersize": _DISC_SIZE}
    kinds = (
        ("station, numbered in the order of visits", visited[order], "white"),
        ("station given up", ~visited[order], style.GREY),
    )
    for label, chosen, fill in kinds:
        numbers = [n for n in range(1, len(order)) if chosen[n]]
        if numbers:
            look["markerfacecolor"] = fill
            handles += ax.plot(*places[order[numbers]].T, zorder=4, label=label, **look)
    return handles
