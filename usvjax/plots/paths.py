"""Paths of several methods on one map (the layout of Tan et al. 2022, Figs. 2-7)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from usvjax.checks import shown, whole_number
from usvjax.errors import BadInputError, BadTypeError
from usvjax.plots import inputs, style
from usvjax.public import public

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Ending:
    """How one episode ended, for a legend.

    Attributes:
        status: code of `usvkernels.status.Status`.
        time: s.
        path_length: m.
    """

    status: int
    time: float
    path_length: float

    def __post_init__(self) -> None:
        style.status_name(whole_number("status", self.status, 0))
        for name in ("time", "path_length"):
            inputs.shaped(name, inputs.numbers(name, getattr(self, name), "one number"), ())


@public()
@style.styled
def plot_paths(
    obstacles: ArrayLike,
    radius: float,
    trajectories: Mapping[str, ArrayLike],
    start: ArrayLike,
    goal: ArrayLike,
    *,
    endings: Mapping[str, Ending] | None = None,
    goal_tolerance: float | None = None,
    title: str | None = None,
) -> Figure:
    """Draw the paths of several methods on one map of circular obstacles.

    Args:
        obstacles: float[K, 2], centres (x, y) in m; rows with NaN are padding, rows far from
            every path are left out.
        radius: radius of the expanded obstacles, m.
        trajectories: method name to float[T, 2 or more], whose first two columns are (x, y)
            in m; rows with NaN are padding.
        start: float[2 or more], (x, y, ...) in m.
        goal: float[2], (x, y) in m.
        endings: method name to how it ended, said in the legend; without it the legend gives
            the length that is drawn.
        goal_tolerance: radius of the goal's circle, m; None draws no circle.
        title: title of the axes.

    Returns:
        The figure, 85 mm wide.

    Raises:
        BadInputError: no trajectory, one without a finite point, a wrong shape, a negative
            radius, or an ending for a method that has no trajectory.
    """
    centres = clean_points(obstacles, "obstacles")
    tracks = {name: clean_track(track, name) for name, track in trajectories.items()}
    _check(radius, tracks, endings or {})
    begin, end = inputs.point("start", start), inputs.point("goal", goal)
    if goal_tolerance is not None:
        inputs.metres("goal_tolerance", goal_tolerance)
    inputs.titles(title=title)

    fig = style.new_figure(style.SINGLE_MM, style.SINGLE_MM * 1.12 + 5 * len(tracks))
    ax = fig.subplots()
    limits = view_limits(
        [*tracks.values(), begin[None], goal_box(end, goal_tolerance)], centres, radius
    )
    handles = draw_obstacles(ax, centres, radius)
    looks = style.method_looks(tracks)
    for name, track in tracks.items():
        colour, line, marker = looks[name]
        ax.plot(*track.T, color=colour, linestyle=line, zorder=looks[name].zorder)
        ax.plot(*track[-1], color=colour, marker=marker, markersize=4, zorder=4)
        label = _legend_text(name, track, (endings or {}).get(name))
        handles.append(style.method_handle(looks[name], label))
    handles[:0] = draw_ends(ax, begin, end, goal_tolerance)
    ax.set(xlim=limits[0], ylim=limits[1], title=title or "")
    style.map_axes(ax)
    style.outside_legend(fig, handles, columns=1)
    return style.settle(fig)


def _check(radius: float, tracks: Mapping[str, FloatArray], endings: Mapping[str, Ending]) -> None:
    if not tracks:
        raise BadInputError("trajectories is empty; at least one method was wanted")
    inputs.metres("radius", radius)
    inputs.by_name("trajectories", tracks)
    for name, ending in inputs.by_name("endings", endings).items():
        if not isinstance(ending, Ending):
            raise BadTypeError(f"endings[{shown(name)}]: got {shown(ending)}; wanted an Ending")
        if name not in tracks:
            known = ", ".join(tracks)
            raise BadInputError(f"endings names {shown(name)}, trajectories only {known}")


def clean_points(points: ArrayLike, name: str) -> FloatArray:
    """Return the finite rows of a list of points.

    Args:
        points: float[K, 2], m.
        name: name of the argument, for the message.

    Returns:
        float[K', 2], without the rows that hold NaN or infinity.

    Raises:
        BadInputError: the shape is not [K, 2].
    """
    array = inputs.numbers(name, points, "(K, 2)")
    if array.ndim != 2 or array.shape[1] != 2:
        raise BadInputError(f"{name} has shape {array.shape}; (K, 2) was wanted")
    kept: FloatArray = array[np.isfinite(array).all(axis=1)]
    return kept


def clean_track(track: ArrayLike, name: str) -> FloatArray:
    """Return the positions of a recorded trajectory without its padding.

    Args:
        track: float[T, 2 or more]; the first two columns are (x, y) in m.
        name: name of the trajectory, for the message.

    Returns:
        float[T', 2], without rows whose position is NaN.

    Raises:
        BadInputError: a wrong shape, or no finite position.
    """
    array = inputs.numbers(f"trajectory {shown(name)}", track, "(T, 5)")
    if array.ndim != 2 or array.shape[1] < 2:
        raise BadInputError(f"trajectory {shown(name)} has shape {array.shape}; (T, 5) was wanted")
    kept: FloatArray = array[np.isfinite(array[:, :2]).all(axis=1), :2]
    if len(kept) == 0:
        raise BadInputError(f"trajectory {shown(name)} has no finite position")
    return kept


def view_limits(
    tracks: list[FloatArray], centres: FloatArray, radius: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Limits of a map that show all tracks and the obstacles around them.

    An obstacle further from the tracks' box than a quarter of its larger side is taken for
    padding, which lies far away by convention, and does not widen the view.

    Args:
        tracks: arrays float[T, 2], m.
        centres: float[K, 2], m.
        radius: radius of the obstacles, m.

    Returns:
        ((x_min, x_max), (y_min, y_max)), m.
    """
    points = np.concatenate(tracks)
    low, high = points.min(axis=0), points.max(axis=0)
    reach = max(0.25 * float((high - low).max()), 2 * radius, 1.0)
    near = ((centres > low - reach) & (centres < high + reach)).all(axis=1)
    if near.any():
        low = np.minimum(low, centres[near].min(axis=0) - radius)
        high = np.maximum(high, centres[near].max(axis=0) + radius)
    margin = 0.03 * float((high - low).max()) + 1e-6
    low, high = low - margin, high + margin
    return (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))


def goal_box(goal: FloatArray, tolerance: float | None) -> FloatArray:
    """Return the goal and the corners of its circle, float[3, 2] m, for `view_limits`."""
    reach = tolerance or 0.0
    return np.stack([goal - reach, goal, goal + reach])


def draw_obstacles(ax: Axes, centres: FloatArray, radius: float) -> list[Line2D]:
    """Draw circles to scale and their centres; return the legend's handle, if there are any.

    Args:
        ax: axes of a map.
        centres: float[K, 2], m.
        radius: m.

    Returns:
        One legend handle, or none where there is no obstacle.
    """
    if len(centres) == 0:
        return []
    size = np.full(len(centres), 2 * radius)
    circles = EllipseCollection(
        size,
        size,
        np.zeros(len(centres)),
        units="xy",
        offsets=centres,
        offset_transform=ax.transData,
        facecolor=style.LIGHT_GREY,
        edgecolor=style.GREY,
        linewidth=0.5,
        zorder=1.5,
    )
    ax.add_collection(circles)
    ax.plot(*centres.T, ".", color="#5A5A5A", markersize=1.8, zorder=1.6)
    label = f"obstacle, expanded by r = {radius:g} m"
    return [
        Line2D(
            [],
            [],
            linestyle="",
            marker="o",
            markersize=7,
            markerfacecolor=style.LIGHT_GREY,
            markeredgecolor=style.GREY,
            label=label,
        )
    ]


def draw_ends(
    ax: Axes, start: FloatArray, goal: FloatArray, goal_tolerance: float | None
) -> list[Line2D]:
    """Mark start and goal, with the goal's circle where a tolerance is given.

    Args:
        ax: axes of a map.
        start: float[2], m.
        goal: float[2], m.
        goal_tolerance: m, or None.

    Returns:
        Two legend handles.
    """
    if goal_tolerance is not None:
        size = [2 * goal_tolerance]
        ring = EllipseCollection(
            size,
            size,
            [0.0],
            units="xy",
            offsets=[goal],
            offset_transform=ax.transData,
            facecolor="none",
            edgecolor=style.BLACK,
            linewidth=0.7,
            linestyle=":",
            zorder=2,
        )
        ax.add_collection(ring)
    name = "goal" if goal_tolerance is None else f"goal, reached within {goal_tolerance:g} m"
    marks = (("start", "o", 5.5, "white", start), (name, "*", 9.0, style.YELLOW, goal))
    handles = []
    for label, marker, size_pt, fill, point in marks:
        (mark,) = ax.plot(
            *point,
            linestyle="",
            marker=marker,
            markersize=size_pt,
            markerfacecolor=fill,
            markeredgecolor=style.BLACK,
            markeredgewidth=0.8,
            zorder=5,
            label=label,
        )
        handles.append(mark)
    return handles


def _legend_text(name: str, track: FloatArray, ending: Ending | None) -> str:
    if ending is None:
        length = float(np.hypot(*np.diff(track, axis=0).T).sum())
        return f"{name}: {length:.2f} m"
    how = style.status_name(ending.status)
    return f"{name}: {how}, {ending.time:.1f} s, {ending.path_length:.2f} m"
