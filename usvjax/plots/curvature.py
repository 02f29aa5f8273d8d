"""Curvature along routes against what a vessel can sail."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from usvjax.angles import wrapped
from usvjax.checks import shown
from usvjax.errors import BadInputError, BadTypeError
from usvjax.plots import inputs, style
from usvjax.plots.paths import clean_points, clean_track
from usvjax.public import public

FloatArray = NDArray[np.float64]

# Below this change of course a path goes straight on, rad.
_STRAIGHT_ON = 1e-6

_LEFT: dict[str, Any] = {
    "color": style.BLACK,
    "linestyle": "",
    "marker": "X",
    "markersize": 6,
    "markeredgecolor": "white",
    "markeredgewidth": 0.5,
}
_BOUND: dict[str, Any] = {"color": "#404040", "linestyle": "--", "linewidth": 0.9}


@dataclass(frozen=True)
class Bends:
    """How a route bends along its way.

    Attributes:
        distance: float[n], from the start, m.
        curvature: float[n], 1/m, positive to port.
        at_corners: whether the route is straight but for corners at these distances; otherwise
            these are samples of a smooth curve.
        left: float[k], where a smooth curve has corners that could not be rounded, which no
            vessel sails; m from the start.
        length: of the route, m; None takes the furthest of the others.
    """

    distance: FloatArray
    curvature: FloatArray
    at_corners: bool
    left: FloatArray = field(default_factory=lambda: np.zeros(0))
    length: float | None = None

    def __post_init__(self) -> None:
        for name in ("distance", "curvature", "left"):
            object.__setattr__(self, name, inputs.series(name, getattr(self, name)))
        if self.distance.shape != self.curvature.shape:
            raise BadInputError(
                f"curvature has {len(self.curvature)} values; {len(self.distance)} were wanted"
            )
        if not isinstance(self.at_corners, bool):
            raise BadTypeError(f"at_corners: got {shown(self.at_corners)}; wanted True or False")
        if self.length is not None:
            inputs.metres("length", self.length)

    @property
    def end(self) -> float:
        """How far the route goes, m: its length, or what is known to be further."""
        known = (self.distance.max(initial=0.0), self.left.max(initial=0.0), self.length or 0.0)
        return float(max(known))


@public()
def bends_of(
    points: ArrayLike, curvature: ArrayLike | None = None, left: ArrayLike | None = None
) -> Bends:
    """How a route bends, for `plot_curvature`.

    Args:
        points: float[P, 2 or more], (x, y) in m; rows with NaN are padding.
        curvature: float[P], 1/m, at the points of a smooth curve. None of a route of straight
            segments: there the discrete curvature of each corner is taken,
            2 sin(w / 2) / ((a + b) / 2) for the deflection w between segments a and b.
        left: float[k, 2], (x, y) in m of corners that a smooth curve still has; rows with NaN
            are padding.

    Raises:
        BadInputError: shapes that do not agree, or no finite point.
    """
    line = clean_track(points, "points")
    step = np.diff(line, axis=0)
    length = np.hypot(*step.T)
    distance = np.concatenate([[0.0], np.cumsum(length)])
    if curvature is not None:
        values = inputs.series("curvature", curvature)
        if len(values) < len(line):
            raise BadInputError(f"curvature has {len(values)} values; {len(line)} were wanted")
        corners = np.zeros((0, 2)) if left is None else clean_points(left, "left")
        places = _along(line, distance, corners)
        return Bends(
            distance, values[: len(line)], at_corners=False, left=places, length=length.sum()
        )
    moved = length > 0
    step, length, distance = step[moved], length[moved], np.cumsum(length[moved])
    course = np.arctan2(step[:, 1], step[:, 0])
    turn = wrapped(np.diff(course))
    bent = np.abs(turn) > _STRAIGHT_ON
    mean = (length[1:] + length[:-1]) / 2
    values = 2 * np.sin(turn[bent] / 2) / mean[bent]
    return Bends(distance[:-1][bent], values, at_corners=True, length=length.sum())


def _along(line: FloatArray, distance: FloatArray, places: FloatArray) -> FloatArray:
    """How far along a line the points are that are nearest to some places, float[k]."""
    gaps = np.hypot(*np.moveaxis(places[:, None] - line[None], -1, 0))
    return distance[gaps.argmin(axis=1)]


@public()
@style.styled
def plot_curvature(
    routes: Mapping[str, Bends], turning_radius: float, *, title: str | None = None
) -> Figure:
    """Draw the curvature along routes, one above the other, with the bounds +-1/R.

    All axes go to the end of the longest route; the line of no curvature ends with its route.

    Args:
        routes: name to how the route bends. Corners are drawn as stems, since a corner's
            curvature depends on how finely the path is cut; curves as steps from sample to
            sample. Corners left in a curve are crosses: their curvature has no bound.
        turning_radius: R, m.
        title: title of the figure.

    Returns:
        The figure, 170 mm wide.

    Raises:
        BadInputError: no route, or a radius that is not above 0.
    """
    if not routes:
        raise BadInputError("routes is empty; at least one was wanted")
    for name, bends in inputs.by_name("routes", routes).items():
        if not isinstance(bends, Bends):
            raise BadTypeError(f"routes[{shown(name)}]: got {shown(bends)}; wanted Bends")
    inputs.metres("turning_radius", turning_radius, inputs.LEAST_METRES)
    inputs.titles(title=title)
    fig = style.new_figure(style.DOUBLE_MM, 28 + 34 * len(routes))
    axes = fig.subplots(len(routes), 1, squeeze=False, sharex=True, sharey=True)[:, 0]
    longest = max(bends.end for bends in routes.values())
    scale, unit = (1000.0, "km") if longest >= 5000 else (1.0, "m")
    bound = 1.0 / turning_radius
    largest = {n: float(np.abs(b.curvature).max(initial=0.0)) for n, b in routes.items()}
    most = max(1.25 * bound, 1.1 * max(largest.values()))
    looks = style.method_looks(routes)
    for ax, (name, bends) in zip(axes, routes.items(), strict=True):
        _draw_bends(ax, bends, scale, looks[name].colour)
        for side in (-bound, bound):
            ax.axhline(side, **_BOUND, zorder=2)
        ax.set(ylim=(-most, most), ylabel="curvature (1/m)")
        ax.ticklabel_format(axis="y", scilimits=(-2, 3))
        what = "discrete curvature of corners" if bends.at_corners else "curvature"
        words = f"{name}: {what} up to {largest[name] / bound:.2f} / R"
        ax.set_title(words + _left_words(len(bends.left)), loc="right")
    axes[-1].set(
        xlabel=f"distance along the route ({unit})", xlim=(0, 1.01 * longest / scale or 1.0)
    )
    if title:
        fig.suptitle(style.folded(title, 95))
    label = f"bounds of a turning radius R = {turning_radius:g} m"
    handles = [Line2D([], [], label=label, **_BOUND)]
    if any(len(bends.left) for bends in routes.values()):
        handles.append(Line2D([], [], label="corner that cannot be sailed", **_LEFT))
    style.outside_legend(fig, handles, columns=len(handles))
    return style.settle(fig)


def _draw_bends(ax: Axes, bends: Bends, scale: float, colour: str) -> None:
    ax.plot([0.0, bends.end / scale], [0.0, 0.0], color=style.GREY, linewidth=1.0, zorder=1)
    along = bends.distance / scale
    if bends.at_corners:
        ax.vlines(along, 0.0, bends.curvature, colors=colour, linewidth=1.0, zorder=3)
        ax.plot(along, bends.curvature, ".", color=colour, markersize=3, zorder=3)
    else:
        # Curvature jumps where a segment meets an arc.
        ax.step(along, bends.curvature, where="mid", color=colour, linewidth=1.0, zorder=3)
    if len(bends.left):
        ax.plot(bends.left / scale, np.zeros(len(bends.left)), zorder=4, **_LEFT)


def _left_words(count: int) -> str:
    return f", {count} corner{'s' * (count > 1)} not sailable" if count else ""
