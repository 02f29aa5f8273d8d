"""The figures of the mission "fleet"."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

import usvjax.missions.fleet.looks  # noqa: F401
from usvjax.maps import GridMap
from usvjax.mission import MOST_CONDITIONS, Replay, Replayed
from usvjax.plots import base_map, style
from usvjax.plots.distributions import both_reached
from usvjax.plots.examples import median_job, middle_job
from usvjax.plots.film import Film
from usvjax.plots.methods import Comparison, Panel, method_pages
from usvjax.plots.paths import draw_obstacles, view_limits
from usvjax.plots.rates import plot_success
from usvjax.plots.route import view_around
from usvjax.plots.tracks import film_of
from usvjax.study import Run
from usvkernels.fleet.approach import closest_approach
from usvkernels.status import FLEET_ENDINGS, Status

FloatArray = NDArray[np.float64]

ALONE = "none"
"""The strategy by which nobody gives way."""

_COLOURS = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.SKY, style.ORANGE)

_TIMES = 8
"""About so many times at which hulls are drawn."""

_TALL = 1.3
"""Panels of a larger height by width stand side by side."""

_PANELS = (
    Panel("extra_distance", "distance over the route's (%)"),
    Panel("delay", "delay (s)"),
    Panel("min_separation", "least distance between hulls (m)"),
)


def fleet_figures(run: Run, replay: Replay) -> Iterator[tuple[str, Figure]]:
    """Yield (name, figure) of a run, the cheap ones first.

    - success: rates of every ending;
    - methods: how strategies compare over the fleets that arrive under all of them; "none" is
      left out, whose fleets arrive only where there is nothing to compare;
    - of each of the first conditions an example under every strategy: its tracks ("tracks"), and
      distances between hulls over time ("separation").
    """
    table = replay.table
    if len(run.settings) <= MOST_CONDITIONS:
        yield (
            "success",
            plot_success(
                table,
                labels=run.labels,
                confidence=run.level,
                endings=[code for code in FLEET_ENDINGS if code in table["status"]],
                methods=run.methods,
                title=run.name,
            ),
        )
    methods = [m for m in run.methods if m != ALONE] or run.methods
    acting = table.filter(pl.col("method").is_in(methods))
    if not both_reached(acting).is_empty():
        yield from method_pages(
            acting,
            methods,
            compared=Comparison(Status.REACHED, _PANELS, "fleets that arrive under each strategy"),
            labels=run.labels,
            confidence=run.level,
            title=run.name,
        )
    for condition in range(min(replay.examples, len(run.settings))):
        if table.filter(pl.col("condition") == condition).is_empty():
            continue
        job, why = replay.example(condition)
        found = {m: replay(condition, m, [job]) for m in run.methods}
        head = run.labels[condition]
        title = f"{head if head.startswith(run.name) else f'{run.name}: {head}'}, job {job} ({why})"
        yield f"tracks-c{condition}", plot_fleets(found, title)
        yield f"separation-c{condition}", plot_separations(found, title)


def telling_job(rows: pl.DataFrame, methods: list[str]) -> tuple[int, str]:
    """Choose the fleet to show of one condition, by a rule rather than by eye.

    Args:
        rows: of one condition.
        methods: its methods, the baseline first.

    Returns:
        The job, and why it was chosen: of the fleets that collide under the baseline and arrive
        under all others, that of median path under the last method; where there are none, of
        those that arrive under all.
    """
    hit = (pl.col("method") == methods[0]) & (pl.col("status") == int(Status.COLLIDED))
    jobs = rows.filter(hit)["job"]
    others = rows.filter(pl.col("job").is_in(jobs.to_list()) & (pl.col("method") != methods[0]))
    kept = both_reached(others).filter(pl.col("method") == methods[-1])
    if kept.is_empty():
        what = "fleet that arrives under all"
        return median_job(rows, methods[0], "path_length", Status.REACHED, what)
    return middle_job(kept, "path_length"), f"collides under {methods[0]}, arrives under the others"


def fleet_film(replayed: Replayed, row: int) -> Film:
    """An episode as `film_of`, with the hulls to scale."""
    film = film_of(replayed, row)
    ax, places = film.fig.axes[0], replayed.recording.tracks[row].places
    radii = replayed.scene.hulls[row]
    hulls = _draw_hulls(ax, places[0], radii, [style.BLACK] * len(radii))

    def show(step: int) -> None:
        film.show(step)
        hulls.set_offsets(places[step])

    return Film(film.fig, film.steps, show)


@style.styled
def plot_fleets(found: Mapping[str, Replayed], title: str) -> Figure:
    """Draw one fleet under several strategies: its tracks, and its hulls at equal times to scale.

    Args:
        found: by strategy, the first episode of each.
        title: of the figure.
    """
    first = next(iter(found.values()))
    ground, hulls = first.recording.grounds[0], first.scene.hulls[0]
    tracks = {name: each.recording.tracks[0] for name, each in found.items()}
    period = _round_up(max(float(t.along[-1]) for t in tracks.values()) / _TIMES)
    points = [t.places.reshape(-1, 2) for t in tracks.values()] + list(ground.marks.values())
    view = _view(points, ground.grid, ground.circles, ground.radius, float(hulls.max()))
    shape = (view[3] - view[2]) / (view[1] - view[0])
    columns = min(len(found), 4 if shape > _TALL else 2)
    rows = -(-len(found) // columns)
    wide = (style.DOUBLE_MM - 20) / columns
    fig = style.new_figure(style.DOUBLE_MM, style.DOUBLE_MM)
    grid = fig.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).reshape(-1)
    for ax in grid[len(found) :]:
        ax.remove()
    axes = list(grid[: len(found)])
    handles: list[Line2D] = []
    gap = "\n" if columns > 2 else " "
    for ax, (name, each) in zip(axes, found.items(), strict=True):
        if ground.grid is not None:
            base_map.paint_map(ax, ground.grid)
        obstacles = draw_obstacles(ax, ground.circles, ground.radius)
        handles = [*_draw_tracks(ax, tracks[name].places, tracks[name].along, hulls, period)]
        handles += [*_draw_ends(ax, ground.marks), *obstacles]
        ax.set(xlim=view[:2], ylim=view[2:], title=f"{name}:{gap}{_ending(each)}")
        base_map.label_axes(ax)
        ax.label_outer()
    for ax in axes[-columns:]:
        # Where nothing stands below, though it is not the last row.
        ax.tick_params(labelbottom=True)
        ax.set_xlabel(axes[-1].get_xlabel())
    fig.suptitle(style.folded(title, 95))
    style.outside_legend(fig, handles, columns=4)
    # The source of a map, and each line of the legend, take room below.
    below = 8 * (ground.grid is not None) + 4.5 * -(-len(handles) // 4)
    height = rows * (wide * min(max(shape, 0.3), 2.5) + 8) + 22 + below
    fig.set_figheight(height / 25.4)
    style.settle(fig)
    if ground.grid is not None:
        base_map.write_below(axes[-1], ground.grid.attribution)
    return style.settle(fig)


@style.styled
def plot_separations(found: Mapping[str, Replayed], title: str) -> Figure:
    """Draw the least distance between two hulls of a fleet over time, now and as foreseen.

    Args:
        found: by strategy, the first episode of each.
        title: of the figure.

    Returns:
        The figure, 170 mm wide. Below, the distance at the closest point if all keep course and
        speed, over the pairs that still approach; nothing where none does.
    """
    fig = style.new_figure(style.DOUBLE_MM, 125)
    above, below = fig.subplots(2, 1, sharex=True)
    looks = style.method_looks(found)
    handles = []
    for name, each in found.items():
        look, time = looks[name], each.recording.tracks[0].along
        now, foreseen = separations(each.recording.detail[0], each.scene.hulls[0])
        drawn: dict[str, Any] = {"color": look.colour, "linestyle": look.line}
        for ax, values in ((above, now), (below, foreseen)):
            ax.plot(time, values, linewidth=1.1, zorder=look.zorder, **drawn)
            last = np.flatnonzero(np.isfinite(values))[-1:]
            ax.plot(time[last], values[last], look.marker, color=look.colour, markersize=4)
        handles.append(style.method_handle(look, f"{name}: {_ending(each)}"))
    for ax in (above, below):
        ax.axhline(0.0, color=style.BLACK, linewidth=0.6, zorder=1)
    above.set(ylabel="between hulls (m)")
    below.set(ylabel="foreseen at closest (m)", xlabel="time (s)")
    fig.suptitle(style.folded(title, 95))
    style.outside_legend(fig, handles, columns=min(len(handles), 2))
    return style.settle(fig)


def separations(states: FloatArray, hulls: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least distances between two hulls of a fleet.

    Args:
        states: float64[T, n, 5], as `FleetResult.trajectory`.
        hulls: float64[n], m.

    Returns:
        float64[T] each, m: at every step; and at the closest point of approach, if all keep course
        and speed, over the pairs that approach, NaN where none does.
    """
    one, other = np.triu_indices(len(hulls), 1)
    velocity = states[..., 3, None] * np.stack(
        [np.cos(states[..., 2]), np.sin(states[..., 2])], axis=-1
    )
    place = states[:, other, :2] - states[:, one, :2]
    relative = velocity[:, other] - velocity[:, one]
    radii = hulls[one] + hulls[other]
    now: FloatArray = (np.hypot(*np.moveaxis(place, -1, 0)) - radii).min(axis=1)
    closest = closest_approach(
        tuple(np.moveaxis(place, -1, 0)), tuple(np.moveaxis(relative, -1, 0))
    )
    ahead = np.asarray(closest.time) > 0.0
    foreseen = np.where(ahead, np.asarray(closest.distance, np.float64) - radii, np.inf).min(axis=1)
    return now, np.where(np.isfinite(foreseen), foreseen, np.nan)


def _ending(each: Replayed) -> str:
    """How the first episode ended, and when."""
    status, time = int(each.columns["status"][0]), float(each.columns["time"][0])
    return f"{style.status_name(status)}, {time:,.0f} s"


def _round_up(least: float) -> float:
    """The smallest of 1, 2, 5, 10, 20, ... that is no less."""
    decade = 10.0 ** math.floor(math.log10(max(least, 1.0)))
    return next(step * decade for step in (1, 2, 5, 10) if step * decade >= least)


def _view(
    points: list[FloatArray],
    grid: GridMap | None,
    circles: FloatArray,
    radius: float,
    hull: float,
) -> base_map.View:
    """The part to show: (west, east, south, north), m."""
    about = [p + shift for p in points for shift in (-hull, hull)]
    if grid is not None:
        return view_around(grid, about)
    (west, east), (south, north) = view_limits(about, circles, radius)
    return west, east, south, north


def _colours(count: int) -> list[str]:
    """One for each vessel; of more than a reader can tell apart, one for all."""
    return list(_COLOURS[:count]) if count <= len(_COLOURS) else [style.BLUE] * count


def _draw_tracks(
    ax: Axes, places: FloatArray, along: FloatArray, hulls: FloatArray, period: float
) -> list[Line2D]:
    """Draw tracks, and hulls each period and at the end; return the legend's handles."""
    times = np.append(np.arange(0.0, along[-1], period), along[-1])
    shown = places[np.searchsorted(along, times)]
    colours = _colours(len(hulls))
    for i, colour in enumerate(colours):
        ax.plot(*places[:, i].T, color=colour, linewidth=0.9, zorder=3)
        ax.plot(*shown[:, i].T, ".", color=colour, markersize=3.0, zorder=3.2)
    for place in shown:
        _draw_hulls(ax, place, hulls, colours)
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


def _draw_hulls(
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


def _draw_ends(ax: Axes, marks: Mapping[str, FloatArray]) -> list[Line2D]:
    """Mark starts and goals; return the legend's handles."""
    handles = []
    for name, marker, size, fill in (
        ("start", "o", 4.0, "white"),
        ("goal", "*", 7.0, style.YELLOW),
    ):
        (mark,) = ax.plot(*marks[name].T, marker, markersize=size, zorder=4, label=name)
        mark.set(markerfacecolor=fill, markeredgecolor=style.BLACK, markeredgewidth=0.6)
        handles.append(mark)
    return handles
