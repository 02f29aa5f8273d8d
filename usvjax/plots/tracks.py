"""Vessels on their way: any recorded episode as a film."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.mission import Replayed
from usvjax.plots import base_map, style
from usvjax.plots.film import Film
from usvjax.plots.paths import draw_obstacles, view_limits
from usvjax.plots.route import view_around

FloatArray = NDArray[np.float64]

_FEW = 8
"""Vessels that have a colour of their own each."""

_COLOURS = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.SKY, style.ORANGE)
_MARKERS = ("o", "s", "^", "D", "v", "P")


@style.styled
def track_film(
    places: FloatArray,
    along: FloatArray,
    unit: str,
    *,
    grid_map: GridMap | None = None,
    circles: FloatArray | None = None,
    radius: float = 0.0,
    marks: Mapping[str, FloatArray] | None = None,
    title: str = "",
) -> Film:
    """Make a film of vessels on a map, each with the way behind it.

    Args:
        places: float[T, n, 2], (x, y) of n vessels in m; NaN where one is not there.
        along: float[T], when they are there, or how far.
        unit: of `along`, "s" or "m".
        grid_map: land and water to draw below, or None.
        circles: float[K, 2], centres of round obstacles, m.
        radius: of the circles, m.
        marks: places to mark by what they are, float[N, 2] each, m.
        title: title of the figure.

    Returns:
        The film, a step for each row of `places`.

    Raises:
        BadInputError: there is no place to show, or `along` is of another length.
    """
    if places.ndim != 3 or places.shape[2] != 2 or not np.isfinite(places).any():
        raise BadInputError(f"places has shape {places.shape}; (T, n, 2) with a place was wanted")
    if along.shape != places.shape[:1]:
        raise BadInputError(f"along has shape {along.shape}; {places.shape[:1]} was wanted")
    marked = {name: np.asarray(points) for name, points in (marks or {}).items()}
    fig, ax, handles = _sheet(places, grid_map, circles, radius, list(marked.values()))
    handles += _draw_marks(ax, marked)
    lines, vessels = _draw_vessels(ax, places.shape[1])
    style.outside_legend(fig, [*handles, vessels[0]], columns=2 if grid_map is None else 4)
    # Made here, in the style of the package; `show` is called outside it.
    heading = fig.suptitle("")

    def show(step: int) -> None:
        if not 0 <= step < len(places):
            raise BadInputError(f"step is {step}; 0 to {len(places) - 1} was wanted")
        for i, (line, vessel) in enumerate(zip(lines, vessels, strict=True)):
            line.set_data(*places[: step + 1, i].T)
            vessel.set_data(*places[step : step + 1, i].T)
        words = f"after {along[step]:,.1f} {unit} of {along[-1]:,.1f} {unit}"
        heading.set_text(f"{title}\n{words}" if title else words)

    show(0)
    # One layout for all frames: quicker, and the axes stand still.
    if grid_map is None:
        style.settle(fig)
    else:
        base_map.finish_sheet(fig, ax, grid_map.attribution)
    fig.set_layout_engine("none")
    return Film(fig, len(places), show)


def film_of(replayed: Replayed, row: int) -> Film:
    """One of the episodes had back, as `track_film`."""
    track, ground = replayed.recording.tracks[row], replayed.recording.grounds[row]
    return track_film(
        track.places,
        track.along,
        track.unit,
        grid_map=ground.grid,
        circles=ground.circles,
        radius=ground.radius,
        marks=ground.marks,
        title=f"{replayed.label}, job {replayed.jobs[row]}",
    )


def _sheet(
    places: FloatArray,
    grid_map: GridMap | None,
    circles: FloatArray | None,
    radius: float,
    marks: list[FloatArray],
) -> tuple[Figure, Axes, list[Line2D]]:
    """A figure with the obstacles, its axes, and handles for the legend."""
    points = [p[np.isfinite(p).all(axis=1)] for p in (*places.swapaxes(0, 1), *marks)]
    points = [p for p in points if len(p)]
    if grid_map is not None:
        fig, ax = base_map.new_sheet(grid_map, view_around(grid_map, points))
        return fig, ax, []
    centres = np.empty((0, 2)) if circles is None else circles
    (west, east), (south, north) = view_limits(points, centres, radius)
    shape = min(max((north - south) / (east - west), 0.3), 1.2)
    fig = style.new_figure(style.SINGLE_MM, style.SINGLE_MM * shape + 30)
    ax = fig.subplots()
    ax.set(xlim=(west, east), ylim=(south, north))
    style.map_axes(ax)
    return fig, ax, draw_obstacles(ax, centres, radius)


def _draw_marks(ax: Axes, marks: Mapping[str, FloatArray]) -> list[Line2D]:
    """Mark places larger than a vessel, which lies above them and must not hide them."""
    start, goal = ("o", "white", 6.5), ("*", style.YELLOW, 10.0)
    looks = {"start": start, "home": start, "goal": goal}
    handles = []
    for name, points in marks.items():
        marker, fill, size = looks.get(name, ("s", style.LIGHT_GREY, 6.5))
        (mark,) = ax.plot(*points.T, marker, markersize=size, zorder=5, label=name)
        mark.set(markerfacecolor=fill, markeredgecolor=style.BLACK, markeredgewidth=0.8)
        handles.append(mark)
    return handles


def _draw_vessels(ax: Axes, count: int) -> tuple[list[Line2D], list[Line2D]]:
    """A line for the way behind and a mark for each vessel, both without data yet."""
    lines, vessels = [], []
    for i in range(count):
        colour = _COLOURS[i % len(_COLOURS)] if count <= _FEW else style.BLUE
        (line,) = ax.plot([], [], color=colour, linewidth=1.2, zorder=3)
        (vessel,) = ax.plot([], [], _MARKERS[i % len(_MARKERS)], color=colour, markersize=4)
        vessel.set(markeredgecolor="white", markeredgewidth=0.7, zorder=6, label="vessel")
        lines.append(line)
        vessels.append(vessel)
    return lines, vessels
