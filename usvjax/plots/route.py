"""Routes on a chart: one query under several methods, or many queries at once."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Rectangle
from numpy.typing import ArrayLike, NDArray

from usvjax.checks import shown
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap
from usvjax.plots import base_map, inputs, style
from usvjax.plots.paths import clean_track, draw_ends
from usvjax.plots.route_panels import MOST_TOGETHER, draw_panels
from usvjax.public import public

FloatArray = NDArray[np.float64]

# The part of a chart about some routes: room around them, and its least shape.
_MARGIN = 0.08
_LEAST_SHAPE = 0.35
# Width of a close-up: so many turning radii, or cells where these are larger.
_CLOSEUP_RADII = 16.0
_CLOSEUP_CELLS = 24.0
# Width of a route's line, and of each below it that is the same, in points.
_WIDTH, _WIDER = 1.4, 1.2
# Places that a close-up may be about.
_MOST_PLACES = 1000


@public()
@style.styled
def plot_routes(
    grid_map: GridMap,
    routes: Mapping[str, ArrayLike],
    *,
    labels: Mapping[str, str] | None = None,
    view: base_map.View | None = None,
    closeup: float | None = None,
    turning_radius: float | None = None,
    title: str | None = None,
) -> Figure:
    """Draw routes between the same two points on a chart, north up.

    More than three have a small chart each, on which the others lie below in grey.

    Args:
        grid_map: the map; `blocked` cells are land.
        routes: name to float[P, 2 or more], whose first two columns are (x, y) in m; rows with
            NaN are padding. Names of methods have their own colour and line in every figure.
            Of up to three, later ones lie above earlier ones.
        labels: name to what the legend says; by default the name and the length. It also says
            which routes are the same.
        view: (west, east, south, north), m; by default the part around the routes.
        closeup: width, m, of a second chart of where the first route turns most; None draws
            none.
        turning_radius: R, m; draws the vessel's turning circle to scale into the close-up.
        title: title of the axes.

    Returns:
        The figure, 170 mm wide. Data coordinates are metres; the axes are labelled in
        kilometres from 5 km up.

    Raises:
        BadInputError: no route, one of a wrong shape or without a finite point, or a close-up
            that is not above 0 wide.
    """
    if not routes:
        raise BadInputError("routes is empty; at least one was wanted")
    inputs.check_chart(grid_map)
    inputs.by_name("routes", routes)
    labels = inputs.text_by("labels", labels)
    inputs.titles(title=title)
    for name, width in (("closeup", closeup), ("turning_radius", turning_radius)):
        if width is not None:
            inputs.metres(name, width, inputs.LEAST_METRES)
    lines = {name: clean_track(route, name) for name, route in routes.items()}
    if view is None:
        view = view_around(grid_map, list(lines.values()))
    view = inputs.check_view("view", view)
    views = [view]
    if closeup is not None:
        near = busiest(next(iter(lines.values())), closeup)
        views.append(inputs.check_view("closeup", near))
    captions = ["", *(f"framed part, {_width_words(v[1] - v[0])} wide" for v in views[1:])]
    draw = draw_panels if len(lines) > MOST_TOGETHER else _draw_together
    fig, blocks, handles = draw(grid_map, lines, views, captions)
    handles += _handles(lines, labels)
    for ax in blocks[0] if views[1:] else ():
        _draw_frame(ax, views[1])
    if views[1:] and turning_radius is not None:
        handles += [_draw_circle(ax, turning_radius, list(lines.values())) for ax in blocks[1]][:1]
    if title:
        fig.suptitle(style.folded(title, 95))
    columns = 3 if max(len(str(h.get_label())) for h in handles) < 36 else 2
    style.outside_legend(fig, handles, columns=columns)
    style.settle(fig)
    lowest = max(blocks[0], key=lambda ax: (-ax.get_window_extent().y0, -ax.get_window_extent().x0))
    base_map.write_below(lowest, grid_map.attribution)
    return style.settle(fig)


def _handles(lines: Mapping[str, FloatArray], labels: Mapping[str, str]) -> list[Line2D]:
    """Handles of the legend: the routes, and which of them are the same."""
    firsts = _first_of_same(lines)
    handles = []
    for name, look in style.method_looks(lines).items():
        label = labels.get(name) or f"{name}: {length_words(length_of(lines[name]))}"
        if firsts[name] != name:
            label += f" (same as {firsts[name]})"
        handles.append(Line2D([], [], color=look.colour, linestyle=look.line, label=label))
    return handles


def _draw_together(
    grid_map: GridMap,
    lines: Mapping[str, FloatArray],
    views: Sequence[base_map.View],
    captions: Sequence[str],
) -> tuple[Figure, list[list[Axes]], list[Line2D]]:
    """Draw all routes on one chart for each view; what it returns is as from `draw_panels`."""
    if len(views) == 1:
        fig, ax = base_map.new_sheet(grid_map, views[0])
        axes: Sequence[Axes] = [ax]
    else:
        fig, axes = _two_sheets(grid_map, views)
    handles: list[Line2D] = []
    for ax, caption in zip(axes, captions, strict=True):
        base_map.label_axes(ax)
        ax.set(title=caption, **({"ylabel": ""} if ax is not axes[0] else {}))
        _draw_routes(ax, lines)
        first = next(iter(lines.values()))
        handles = draw_ends(ax, first[0], first[-1], None)
    return fig, [[ax] for ax in axes], handles


def _draw_routes(ax: Axes, lines: Mapping[str, FloatArray]) -> None:
    """Draw routes one above the other."""
    looks, firsts = style.method_looks(lines), _first_of_same(lines)
    for layer, (name, line) in enumerate(lines.items()):
        # Of routes that are the same, those below show beside those above.
        above = sum(firsts[other] == firsts[name] for other in list(lines)[layer + 1 :])
        look: dict[str, Any] = {"color": looks[name].colour, "linestyle": looks[name].line}
        ax.plot(*line.T, linewidth=_WIDTH + _WIDER * above, zorder=3 + 0.01 * layer, **look)


def _first_of_same(lines: Mapping[str, FloatArray]) -> dict[str, str]:
    """By name, the first line that is the very same."""
    names = list(lines)
    return {
        name: next(other for other in names if np.array_equal(lines[other], lines[name]))
        for name in names
    }


def _two_sheets(grid_map: GridMap, views: Sequence[base_map.View]) -> tuple[Figure, Sequence[Axes]]:
    """Make a figure with a chart on the left and, from it, a close-up on the right."""
    west, east, south, north = views[0]
    shape = min(max((north - south) / (east - west), 0.4), 1.6)
    wide = min(max(1.0 / shape, 0.6), 1.6)
    fig = style.new_figure(style.DOUBLE_MM, style.DOUBLE_MM / (1.05 + wide) + 28)
    axes: Sequence[Axes] = fig.subplots(1, 2, width_ratios=(wide, 1.0))
    for ax, (left, right, bottom, top) in zip(axes, views, strict=True):
        base_map.paint_map(ax, grid_map)
        ax.set(xlim=(left, right), ylim=(bottom, top))
    return fig, axes


def _draw_frame(ax: Axes, view: base_map.View) -> None:
    """Frame the part of a chart that another one shows."""
    frame = Rectangle(view[::2], view[1] - view[0], view[3] - view[2], fill=False)
    frame.set(edgecolor=style.BLACK, linewidth=0.8, zorder=4)
    ax.add_patch(frame)


def _draw_circle(ax: Axes, radius: float, lines: Sequence[FloatArray]) -> Line2D:
    """Draw the turning circle into the corner where it is furthest from all lines.

    Returns:
        The legend's handle.
    """
    (west, east), (south, north) = ax.get_xlim(), ax.get_ylim()
    away = 1.3 * radius
    corners = [(x, y) for x in (west + away, east - away) for y in (south + away, north - away)]
    middle = max(corners, key=lambda corner: min(_gap(line, corner) for line in lines))
    look: dict[str, Any] = {"color": style.BLACK, "linewidth": 0.9, "linestyle": ":"}
    ax.add_patch(Circle(middle, radius, fill=False, zorder=4, **look))
    return Line2D([], [], label=f"turning circle, R = {radius:g} m", **look)


def _gap(line: FloatArray, place: tuple[float, float]) -> float:
    """Least distance of a place from a line, m."""
    start, step = line[:-1], np.diff(line, axis=0)
    size = np.maximum((step**2).sum(axis=1), 1e-12)
    share = np.clip(((place - start) * step).sum(axis=1) / size, 0.0, 1.0)
    return float(np.hypot(*(start + share[:, None] * step - place).T).min())


def closeup_width(
    grid_map: GridMap, lines: Sequence[FloatArray], turning_radius: float | None
) -> float | None:
    """Choose how wide a close-up of some routes is.

    Args:
        grid_map: the map.
        lines: float[P, 2] each, m.
        turning_radius: R, m, or None.

    Returns:
        m, so that cells and turning circle show; None where that is most of the chart anyway.
    """
    width = max(_CLOSEUP_RADII * (turning_radius or 0.0), _CLOSEUP_CELLS * grid_map.cell_size)
    west, east, south, north = view_around(grid_map, lines)
    return width if width <= 0.6 * min(east - west, north - south) else None


def busiest(line: FloatArray, width: float) -> base_map.View:
    """Choose the square where a line turns most.

    Args:
        line: float[P, 2], m.
        width: side of the square, m.

    Returns:
        (west, east, south, north), m, about the point with the most turning within reach, the
        first of equals.
    """
    step = np.diff(line, axis=0)
    course = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    turning = np.abs(np.diff(course, prepend=course[:1], append=course[-1:]))
    corners = np.flatnonzero(turning > 0)
    places = line[corners[:: max(1, len(corners) // _MOST_PLACES)]] if len(corners) else line[:1]
    near = (np.abs(places[:, None] - line[None]) < 0.4 * width).all(axis=-1)
    x, y = places[(near @ turning).argmax()]
    return x - width / 2, x + width / 2, y - width / 2, y + width / 2


@public()
@style.styled
def plot_route_chart(
    grid_map: GridMap,
    routes: Sequence[ArrayLike],
    *,
    view: base_map.View | None = None,
    title: str | None = None,
) -> Figure:
    """Draw many routes on one chart, with their ends, north up.

    Args:
        grid_map: the map; `blocked` cells are land.
        routes: float[P, 2 or more] each, whose first two columns are (x, y) in m.
        view: (west, east, south, north), m; by default the whole map.
        title: title of the axes.

    Returns:
        The figure, 170 mm wide, as that of `plot_routes`.

    Raises:
        BadInputError: no route, one of a wrong shape or without a finite point.
    """
    if not isinstance(routes, list | tuple | np.ndarray) or getattr(routes, "ndim", 1) == 0:
        raise BadTypeError(f"routes: got {shown(routes)}; wanted a list of arrays [P, 2]")
    if not len(routes):
        raise BadInputError("routes is empty; at least one was wanted")
    inputs.check_chart(grid_map)
    inputs.titles(title=title)
    if view is not None:
        view = inputs.check_view("view", view)
    lines = [clean_track(route, f"{i}") for i, route in enumerate(routes)]
    fig, ax = base_map.new_sheet(grid_map, view)
    paths = LineCollection(lines, colors=style.BLUE, linewidths=0.7, alpha=0.45, zorder=2)
    ax.add_collection(paths, autolim=False)
    handles: list[Line2D] = [Line2D([], [], color=style.BLUE, label=f"{len(lines):,} routes")]
    for end, marker, fill, label in ((0, "o", "white", "start"), (-1, "s", style.ORANGE, "goal")):
        points = np.array([line[end] for line in lines])
        (mark,) = ax.plot(
            *points.T,
            linestyle="",
            marker=marker,
            markersize=2.6,
            markerfacecolor=fill,
            markeredgecolor=style.BLACK,
            markeredgewidth=0.4,
            zorder=3,
            label=label,
        )
        handles.append(mark)
    if title:
        ax.set_title(style.folded(title, 95))
    style.outside_legend(fig, handles, columns=len(handles))
    return base_map.finish_sheet(fig, ax, grid_map.attribution)


def view_around(grid_map: GridMap, lines: Sequence[FloatArray]) -> base_map.View:
    """Choose the part of a map that shows some lines with room about them.

    Args:
        grid_map: the map; the view lies inside it where it fits.
        lines: float[P, 2] each, m.

    Returns:
        (west, east, south, north), m; neither side is less than a third of the other.
    """
    points = np.concatenate(list(lines))
    low, high = points.min(axis=0), points.max(axis=0)
    room = max(_MARGIN * float((high - low).max()), 3.0 * grid_map.cell_size)
    size = high - low + 2 * room
    size = np.maximum(size, _LEAST_SHAPE * size.max())
    west, east, south, north = grid_map.extent
    edges = []
    for middle, length, least, most in zip(
        (low + high) / 2, size, (west, south), (east, north), strict=True
    ):
        begin = max(min(float(middle - length / 2), most - float(length)), least)
        edges += [begin, min(begin + float(length), most)]
    return edges[0], edges[1], edges[2], edges[3]


def length_of(line: FloatArray) -> float:
    """Length of a line float[P, 2]."""
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def length_words(metres: float) -> str:
    """Write a length in m, or in km from 5 km up, to four digits, noughts included."""
    number, unit = (metres / 1000, "km") if metres >= 5000 else (metres, "m")
    digits = f"{number:#.4g}" if 0.001 <= number < 1000 else f"{number:.4g}"
    return f"{digits} {unit}"


def _width_words(metres: float) -> str:
    """Write the width of a chart, which is a round number."""
    return f"{metres / 1000:.4g} km" if metres >= 5000 else f"{metres:.4g} m"
