"""One decision of an episode: the fan of candidate paths, their scores and the window."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import ArrayLike, NDArray

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.plots import base_map, style
from usvjax.plots.film import Film
from usvjax.plots.paths import (
    clean_points,
    clean_track,
    draw_ends,
    draw_obstacles,
    goal_box,
    view_limits,
)

SCORE_MAP = "viridis"
FloatArray = NDArray[np.float64]


class Decision(Protocol):
    """One DWA decision opened up, as `usvjax.dwa_candidates` returns it."""

    @property
    def v(self) -> NDArray[Any]:
        """float[n_v], m/s."""

    @property
    def w(self) -> NDArray[Any]:
        """float[n_w], rad/s."""

    @property
    def paths(self) -> NDArray[Any]:
        """float[n_v, n_w, horizon + 1, 2], m."""

    @property
    def admissible(self) -> NDArray[Any]:
        """bool[n_v, n_w]."""

    @property
    def score(self) -> NDArray[Any]:
        """float[n_v, n_w], meaningful where admissible."""

    @property
    def chosen(self) -> tuple[int, int] | None:
        """Index (i, j) of the candidate taken; None when the vessel brakes."""


Decide = Callable[[FloatArray], Decision]
"""From a state float[5] (x, y, psi, v, w) to the decision taken there."""


@dataclass(frozen=True)
class Episode:
    """One recorded episode and what stood around it.

    Attributes:
        trajectory: float[T, 5], states (x, y, psi, v, w); NaN rows are padding.
        goal: float[2], m.
        obstacles: float[K, 2], centres in m; rows with NaN are padding.
        radius: radius of the expanded obstacles, m.
        dt: control period, s.
        goal_tolerance: radius of the goal's circle, m, or None.
        status: how it ended, a code of `usvkernels.status.Status`, or None.
        steps: control periods until the end; None takes all rows up to the padding.
        grid_map: land and water to draw below, or None.
        title: title of the figure.
    """

    trajectory: ArrayLike
    goal: ArrayLike
    obstacles: ArrayLike
    radius: float
    dt: float = 0.1
    goal_tolerance: float | None = None
    status: int | None = None
    steps: int | None = None
    grid_map: GridMap | None = None
    title: str = ""


class EpisodeView:
    """A figure of one episode that can show any of its steps.

    Attributes:
        fig: the figure, 170 x 115 mm.
        states: float[T', 5], the states that can be shown.
        map: axes of the whole episode.
        near: axes that follow the vessel, as wide as the candidate paths need.
        window: axes of the dynamic window, one cell per candidate.
    """

    @style.styled
    def __init__(self, episode: Episode, decide: Decide) -> None:
        """Draw what does not change from step to step.

        Args:
            episode: what to show.
            decide: from a state to the decision taken there.

        Raises:
            BadInputError: the trajectory is not float[T, 5] or has no finite state.
        """
        self.episode, self._decide = episode, decide
        self.states = _clean_states(episode)
        self.fig = style.new_figure(style.DOUBLE_MM, 115)
        grid = self.fig.add_gridspec(2, 2, width_ratios=(1.55, 1), height_ratios=(1.35, 1))
        self.map = self.fig.add_subplot(grid[:, 0])
        self.near = self.fig.add_subplot(grid[0, 1])
        self.window = self.fig.add_subplot(grid[1, 1])
        self._fans = [self._draw_map(), self._draw_near()]
        self._draw_window()
        self.show(0)
        # One layout for all frames: quicker, and the axes stand still.
        style.settle(self.fig)
        if episode.grid_map is not None:
            base_map.write_below(self.map, episode.grid_map.attribution)
            style.settle(self.fig)
        self.fig.set_layout_engine("none")

    @style.styled
    def show(self, step: int) -> None:
        """Show the state of one step and the decision taken there.

        Args:
            step: control periods since the start, 0 to len(states) - 1.

        Raises:
            BadInputError: there is no such step.
        """
        if not 0 <= step < len(self.states):
            raise BadInputError(f"step is {step}; 0 to {len(self.states) - 1} was wanted")
        state = self.states[step]
        decision = self._decide(state)
        colours = _score_colours(decision)
        reach = self._reach_of(state, decision)
        self.near.set(xlim=(state[0] - reach, state[0] + reach))
        self.near.set(ylim=(state[1] - reach, state[1] + reach))
        self.near.set_title(f"close-up, {2 * reach:g} m wide")
        for fan, size in zip(self._fans, (self._map_size, 0.08 * reach), strict=True):
            fan.show(self.states[: step + 1], decision, colours, size)
        self._show_window(decision, colours)
        self.fig.suptitle(self._headline(step, state, decision))

    def _draw_map(self) -> "_Fan":
        ax = self.map
        centres, goal, handles = self._draw_world(ax)
        shown = [self.states[:, :2], goal_box(goal, self.episode.goal_tolerance)]
        x, y = view_limits(shown, centres, self.episode.radius)
        ax.set(xlim=x, ylim=y)
        base_map.label_axes(ax)
        handles += [
            Line2D([], [], color=style.BLUE, label="track"),
            Line2D([], [], color=style.VERMILLION, linewidth=1.8, label="chosen candidate"),
            Line2D([], [], color=style.GREY, label="inadmissible candidates"),
        ]
        style.outside_legend(self.fig, handles, columns=3)
        self._map_size = 0.02 * max(x[1] - x[0], y[1] - y[0])
        return _Fan(ax)

    def _draw_near(self) -> "_Fan":
        ax = self.near
        self._draw_world(ax)
        ax.set_aspect("equal")
        ax.tick_params(labelbottom=False, labelleft=False, length=0)
        return _Fan(ax)

    def _reach_of(self, state: FloatArray, decision: Decision) -> float:
        """Half the width of the close-up, m: all candidate paths, in steps of 1, 2, 5, 10 ...

        Steps, because a view that breathed with the speed would hide how fast the vessel is.
        """
        longest = float(np.abs(np.asarray(decision.paths)[..., -1, :] - state[:2]).max())
        needed = max(1.1 * longest, 1.5 * self.episode.radius, 1e-3)
        decade = 10.0 ** math.floor(math.log10(needed))
        return next(step * decade for step in (1, 2, 5, 10) if step * decade >= needed)

    def _draw_world(self, ax: Axes) -> tuple[FloatArray, FloatArray, list[Line2D]]:
        """Draw map, obstacles and ends; return obstacles, goal and legend handles."""
        episode = self.episode
        centres = clean_points(episode.obstacles, "obstacles")
        goal = np.asarray(episode.goal, dtype=float)[:2]
        if episode.grid_map is not None:
            base_map.paint_map(ax, episode.grid_map)
        handles = draw_ends(ax, self.states[0, :2], goal, episode.goal_tolerance)
        handles += draw_obstacles(ax, centres, episode.radius)
        return centres, goal, handles

    def _draw_window(self) -> None:
        ax = self.window
        ax.set_title("dynamic window now")
        ax.set_xlabel("yaw rate w (rad/s)")
        ax.set_ylabel("speed v (m/s)")
        ax.grid(visible=False)
        scale = mpl.cm.ScalarMappable(mpl.colors.Normalize(0, 1), SCORE_MAP)
        bar = self.fig.colorbar(scale, ax=ax, pad=0.02, ticks=(0, 1))
        bar.ax.set_yticklabels(["worst", "best"])
        bar.set_label("score G", labelpad=-8)
        self._cells: list[Any] = []

    def _show_window(self, decision: Decision, colours: FloatArray) -> None:
        # Cells keep their places and the tick labels change, so that nothing jumps.
        for cell in self._cells:
            cell.remove()
        ax = self.window
        self._cells = [ax.imshow(colours, origin="lower", aspect="auto")]
        if decision.chosen is not None:
            i, j = decision.chosen
            mark = Rectangle((j - 0.5, i - 0.5), 1, 1, fill=False, lw=2, ec=style.VERMILLION)
            mark.set_clip_on(False)
            self._cells.append(ax.add_patch(mark))
        for axis, values in ((ax.xaxis, decision.w), (ax.yaxis, decision.v)):
            places = sorted({0, len(values) // 2, len(values) - 1})
            axis.set_ticks(places, [signed(values[k]) for k in places])

    def _headline(self, step: int, state: FloatArray, decision: Decision) -> str:
        parts = [f"t = {step * self.episode.dt:.1f} s"]
        parts += [f"v = {signed(state[3])} m/s", f"w = {signed(state[4])} rad/s"]
        if step == len(self.states) - 1 and self.episode.status is not None:
            parts.append(style.status_name(self.episode.status))
        elif decision.chosen is None:
            parts.append("no admissible candidate")
        # Without a title the line stays, so that the frozen layout fits every frame.
        return f"{self.episode.title}\n" + ",  ".join(parts)


class _Fan:
    """The moving part of a map: vessel, track and candidate paths."""

    def __init__(self, ax: Axes) -> None:
        self._bad = LineCollection([], colors=style.GREY, linewidths=0.6, zorder=3)
        self._good = LineCollection([], linewidths=0.9, zorder=3.1)
        ax.add_collection(self._bad, autolim=False)
        ax.add_collection(self._good, autolim=False)
        (self._track,) = ax.plot([], [], color=style.BLUE, linewidth=1.3, zorder=2.8)
        (self._best,) = ax.plot([], [], color=style.VERMILLION, linewidth=1.8, zorder=3.5)
        self._hull = Polygon(np.zeros((3, 2)), closed=True, fc=style.BLUE, ec="white", lw=0.6)
        self._hull.set_zorder(6)
        ax.add_patch(self._hull)

    def show(self, past: FloatArray, decision: Decision, colours: FloatArray, size: float) -> None:
        """Move everything to the last of the states float[n, 5] so far; size of the hull in m."""
        paths, good = np.asarray(decision.paths), np.asarray(decision.admissible, dtype=bool)
        self._bad.set_segments(list(paths[~good]))
        self._good.set_segments(list(paths[good]))
        self._good.set_color(list(colours[good]))
        best = np.empty((0, 2)) if decision.chosen is None else paths[tuple(decision.chosen)]
        self._best.set_data(*best.T)
        self._track.set_data(*past[:, :2].T)
        self._hull.set_xy(_hull(past[-1], size))


def decision_film(episode: Episode, decide: Decide) -> Film:
    """An episode as a film of its decisions.

    Args:
        episode: what to show.
        decide: from a state to the decision taken there.

    Raises:
        BadInputError: the trajectory is not float[T, 5] or has no finite state.
    """
    view = EpisodeView(episode, decide)
    return Film(view.fig, len(view.states), view.show)


def _clean_states(episode: Episode) -> FloatArray:
    states = np.asarray(episode.trajectory, dtype=float)
    clean_track(states, "of the episode")
    if states.shape[1] != 5:
        raise BadInputError(f"trajectory has shape {states.shape}; (T, 5) was wanted")
    states = states[np.isfinite(states).all(axis=1)]
    if episode.steps is None:
        return states
    return states[: episode.steps + 1]


def _score_colours(decision: Decision) -> FloatArray:
    """float[n_v, n_w, 4]: score as colour, spread over the admissible ones; grey elsewhere."""
    good = np.asarray(decision.admissible, dtype=bool)
    colours = np.empty((*good.shape, 4))
    colours[:] = mpl.colors.to_rgba(style.LIGHT_GREY)
    if good.any():
        score = np.asarray(decision.score, dtype=float)[good]
        spread = float(np.ptp(score))
        relative = (score - score.min()) / spread if spread > 0 else np.ones_like(score)
        colours[good] = mpl.colormaps[SCORE_MAP](relative)
    return colours


def _hull(state: FloatArray, size: float) -> FloatArray:
    """Return a pointed hull about the state, bow ahead; larger than the vessel."""
    outline = size * np.array([(1.2, 0.0), (0.2, 0.55), (-1.0, 0.55), (-1.0, -0.55), (0.2, -0.55)])
    cos, sin = math.cos(state[2]), math.sin(state[2])
    turned: FloatArray = outline @ np.array([(cos, sin), (-sin, cos)]) + state[:2]
    return turned


def signed(value: float) -> str:
    """Write a number with its sign and two decimals; a rounded zero has no sign."""
    text = f"{value:+.2f}"
    return " 0.00" if text in ("+0.00", "-0.00") else text
