"""D* Lite at work: a vessel on its way while the map changes, as a film."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from numpy.typing import ArrayLike, NDArray

from usvjax.checks import shown
from usvjax.errors import BadInputError, BadTypeError
from usvjax.maps import GridMap
from usvjax.plots import base_map, inputs, style
from usvjax.plots.film import Film
from usvjax.plots.paths import draw_ends
from usvjax.public import public
from usvjax.search.astar import astar

IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class Replanning:
    """One episode of `usvjax.dstar_lite`, with what the vessel knew.

    Attributes:
        grid_map: the first map, which is known.
        position: int[T + 1, 2], cells (x, y); index 0 is the start.
        goal: int[2], cell.
        known: bool[T + 1, H, W], the map as the vessel knows it at each position.
        changed: bool[T, H, W], cells that changed state just before each move, noticed or not.
        ahead: T + 1 paths, int[P, 2] cells from each position to the goal; empty where there
            is none.
        cost_to_go: float[T + 1], cells; inf where cut off.
        expanded: int[T + 1], cells expanded in the replanning that led to each position.
        sensing: (h, w), rows and columns of the window in which changes are noticed, or None.
        title: title of the film.
    """

    grid_map: GridMap
    position: IntArray
    goal: IntArray
    known: BoolArray
    changed: BoolArray
    ahead: list[IntArray]
    cost_to_go: NDArray[np.float64]
    expanded: IntArray
    sensing: tuple[int, int] | None = None
    title: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.grid_map, GridMap):
            raise BadTypeError(f"grid_map: got {shown(self.grid_map)}; wanted a GridMap")
        inputs.check_chart(self.grid_map)
        shape = self.grid_map.shape
        inputs.text("title", self.title)
        count = len(inputs.cells("position", self.position, shape, (None,)))
        inputs.cells("goal", self.goal, shape, ())
        inputs.flags("known", self.known, (count, *shape))
        inputs.flags("changed", self.changed, (count - 1, *shape))
        if not isinstance(self.ahead, list) or len(self.ahead) != count:
            raise BadTypeError(f"ahead: got {shown(self.ahead)}; wanted a list of {count} paths")
        for path in self.ahead:
            inputs.cells("ahead", path, shape, (None,))
        inputs.shaped("cost_to_go", inputs.numbers("cost_to_go", self.cost_to_go, "[n]"), (count,))
        inputs.shaped("expanded", inputs.whole_numbers("expanded", self.expanded), (count,))
        if self.sensing is not None:
            object.__setattr__(self, "sensing", _window_size(self.sensing))


@public(jit=True)
def replanning_of(
    grid_map: GridMap,
    flips: ArrayLike,
    position: ArrayLike,
    goal: ArrayLike,
    cost_to_go: ArrayLike,
    expanded: ArrayLike,
    *,
    sensing: tuple[int, int] | None = None,
    corner_cutting: bool = False,
    title: str = "",
) -> Replanning:
    """Work out what the vessel of one episode knew and which way lay ahead of it.

    Args:
        grid_map: the first map.
        flips: int[T, C, 2], one row of those given to `usvjax.dstar_lite`.
        position: int[T + 1, 2], one row of its result; likewise `cost_to_go` and `expanded`.
        goal: int[2], cell.
        cost_to_go: float[T + 1], cells.
        expanded: int[T + 1].
        sensing: (h, w), as given to `usvjax.dstar_lite`.
        corner_cutting: likewise.
        title: title of the film.

    Returns:
        The episode, for `animate_replanning`. Where several paths ahead are shortest, the one
        shown may be another than the vessel takes.

    Raises:
        BadInputError: shapes that do not agree.
    """
    inputs.titles(title=title)
    if sensing is not None:
        sensing = _window_size(sensing)
    cells, way = inputs.whole_numbers("flips", flips), inputs.whole_numbers("position", position)
    if way.ndim != 2 or way.shape[1] != 2 or len(way) < 2:
        raise BadInputError(f"position has shape {way.shape}; (T + 1, 2) was wanted, T at least 1")
    steps = len(way) - 1
    if cells.ndim != 3 or len(cells) != steps or cells.shape[2] != 2:
        raise BadInputError(f"flips has shape {cells.shape}; ({steps}, C, 2) was wanted")
    way = inputs.cells("position", way, grid_map.shape, (None,))
    end = inputs.cells("goal", goal, grid_map.shape, ())
    inputs.cells("flips", np.maximum(cells, 0), grid_map.shape, (None, None))
    changed = _changes(cells, way, end, grid_map.shape)
    known = _known(grid_map.blocked, changed, way, sensing)
    found = astar(known, way, end, corner_cutting=corner_cutting, on_blocked="status")
    ahead = [
        np.asarray(path[:n], np.int64) for path, n in zip(found.path, found.path_cells, strict=True)
    ]
    return Replanning(
        grid_map=grid_map,
        position=way,
        goal=end,
        known=known,
        changed=changed,
        ahead=ahead,
        cost_to_go=inputs.numbers("cost_to_go", cost_to_go, "[n]"),
        expanded=inputs.whole_numbers("expanded", expanded),
        sensing=sensing,
        title=title,
    )


def _window_size(sensing: object) -> tuple[int, int]:
    """(h, w) of what the vessel senses, checked."""
    found = inputs.whole_numbers("sensing", sensing)
    inputs.shaped("sensing", found, (2,))
    if (found < 1).any():
        raise BadInputError(f"sensing is {shown(sensing)}; (h, w) of 1 or more were wanted")
    return int(found[0]), int(found[1])


def _changes(cells: IntArray, way: IntArray, goal: IntArray, shape: tuple[int, int]) -> BoolArray:
    """Which cells change state before each move, bool[T, H, W].

    A cell named twice changes twice; the vessel's own and the goal do not change.
    """
    changed = np.zeros((len(cells), *shape), bool)
    step = np.broadcast_to(np.arange(len(cells))[:, None], cells.shape[:2])
    ignored = (cells == goal).all(axis=-1) | (cells == way[:-1, None]).all(axis=-1)
    ignored |= (cells < 0).any(axis=-1)
    x, y = cells[~ignored].T
    np.logical_xor.at(changed, (step[~ignored], y, x), True)
    return changed


def _known(
    first: BoolArray, changed: BoolArray, way: IntArray, sensing: tuple[int, int] | None
) -> BoolArray:
    """The map as known at each position, bool[T + 1, H, W]."""
    known = np.empty((len(way), *first.shape), bool)
    known[0] = first
    true = first.copy()
    for step, change in enumerate(changed):
        true ^= change
        known[step + 1] = known[step]
        # What lies in the window is seen before the move and after it.
        for x, y in (way[step], way[step + 1]):
            window = _window(x, y, sensing)
            known[step + 1][window] = true[window]
    return known


def _window(x: int, y: int, sensing: tuple[int, int] | None) -> tuple[slice, slice]:
    if sensing is None:
        return slice(None), slice(None)
    up, along = sensing[0] // 2, sensing[1] // 2
    return slice(max(y - up, 0), y + up + 1), slice(max(x - along, 0), x + along + 1)


@public()
def replanning_film(episode: Replanning) -> Film:
    """An episode, from `replanning_of`, as a film of its moves until it arrives."""
    view = ReplanningView(episode)
    return Film(view.fig, _last_move(episode) + 1, view.show)


def _last_move(episode: Replanning) -> int:
    """The step at which the vessel arrives, or the last."""
    there = (episode.position == episode.goal).all(axis=1)
    return int(there.argmax()) if there.any() else len(episode.position) - 1


class ReplanningView:
    """A figure of one episode that can show any of its steps.

    Attributes:
        fig: the figure, 170 mm wide.
        map: axes of the map as known.
        cost: axes of the length of the path ahead.
        work: axes of the cells expanded at each step.
    """

    @style.styled
    def __init__(self, episode: Replanning) -> None:
        """Draw what does not change from step to step."""
        self.episode = episode
        west, east, south, north = episode.grid_map.extent
        shape = min(max((north - south) / (east - west), 0.5), 1.3)
        self.fig = style.new_figure(style.DOUBLE_MM, style.DOUBLE_MM * 0.6 * shape + 32)
        grid = self.fig.add_gridspec(2, 2, width_ratios=(1.6, 1))
        self.map = self.fig.add_subplot(grid[:, 0])
        self.cost = self.fig.add_subplot(grid[0, 1])
        self.work = self.fig.add_subplot(grid[1, 1], sharex=self.cost)
        self._draw_map()
        self._draw_curves()
        self.show(0)
        # One layout for all frames: quicker, and the axes stand still.
        style.settle(self.fig).set_layout_engine("none")

    @style.styled
    def show(self, step: int) -> None:
        """Show one step: what is known, what has just changed, the way so far and the way ahead.

        Args:
            step: moves since the start, 0 to T.

        Raises:
            BadInputError: there is no such step.
        """
        episode = self.episode
        if not 0 <= step < len(episode.position):
            raise BadInputError(f"step is {step}; 0 to {len(episode.position) - 1} was wanted")
        self._image.set_data(episode.known[step])
        self._show_changes(step)
        self._past.set_data(*self._points(episode.position[: step + 1]).T)
        self._ahead.set_data(*self._points(episode.ahead[step]).T)
        self._vessel.set_data(*self._points(episode.position[step : step + 1]).T)
        if self._window is not None:
            (east, north) = self._points(episode.position[step])[0]
            wide, high = self._window.get_width(), self._window.get_height()
            self._window.set_xy((float(east) - wide / 2, float(north) - high / 2))
        for line in self._cursors:
            line.set_xdata([step, step])
        cost = episode.cost_to_go[step]
        way = "cut off" if np.isinf(cost) else f"{cost:.1f} cells to go"
        if (episode.position[step] == episode.goal).all():
            way = "arrived"
        head = f"move {step}:  {way},  {int(episode.expanded[step]):,} cells expanded"
        # Without a title the line stays, so that the frozen layout fits every frame.
        self.fig.suptitle(f"{episode.title}\n{head}")

    def _points(self, cells: IntArray) -> NDArray[np.float64]:
        return self.episode.grid_map.points_of(cells.reshape(-1, 2))

    def _draw_map(self) -> None:
        ax, grid = self.map, self.episode.grid_map
        base_map.paint_map(ax, grid)
        (self._image,) = ax.images
        # The shore of the first map would be wrong on the next.
        for line in [c for c in ax.collections if c.get_gid() == base_map.SHORE_ID]:
            line.remove()
        self._fresh: list[PatchCollection] = []
        (self._past,) = ax.plot([], [], color=style.BLUE, zorder=3)
        (self._ahead,) = ax.plot([], [], color=style.BLACK, linestyle="--", lw=1.0, zorder=3.1)
        (self._vessel,) = ax.plot([], [], "o", color=style.BLUE, markersize=5, zorder=6)
        self._vessel.set(markeredgecolor="white", markeredgewidth=0.7)
        start, goal = self._points(np.stack([self.episode.position[0], self.episode.goal]))
        handles = draw_ends(ax, start, goal, None)
        base_map.label_axes(ax)
        patches = [
            Patch(facecolor=style.VERMILLION, label="just blocked"),
            Patch(facecolor=style.GREEN, label="just freed"),
        ]
        lines = [
            Line2D([], [], color=style.BLUE, label="way so far"),
            Line2D([], [], color=style.BLACK, linestyle="--", lw=1.0, label="a shortest way ahead"),
        ]
        self._window = self._draw_window()
        if self._window is not None:
            patches.append(self._window)
        style.outside_legend(self.fig, [*handles, *lines, *patches], columns=4)

    def _draw_window(self) -> Rectangle | None:
        """Draw the window in which changes are noticed; `show` puts it in its place."""
        if self.episode.sensing is None:
            return None
        rows, columns = self.episode.sensing
        size = self.episode.grid_map.cell_size
        window = Rectangle((0, 0), columns * size, rows * size, fill=False, label="sensing window")
        window.set(edgecolor=style.PURPLE, linewidth=1.0, linestyle="-.", zorder=4)
        self.map.add_patch(window)
        return window

    def _draw_curves(self) -> None:
        steps = np.arange(_last_move(self.episode) + 1)
        cost, expanded = (a[: len(steps)] for a in (self.episode.cost_to_go, self.episode.expanded))
        self.cost.plot(steps, np.where(np.isfinite(cost), cost, np.nan), color=style.BLACK)
        cut_off = np.flatnonzero(~np.isfinite(cost))
        for step in cut_off:
            self.cost.axvspan(step - 0.5, step + 0.5, color=style.LIGHT_GREY, zorder=0)
        words = "cells; grey: cut off" if len(cut_off) else "cells"
        self.cost.set(title=f"length of the way ahead ({words})", ylim=(0, None))
        self.work.bar(steps, expanded, width=1.0, color=style.SKY)
        self.work.set(title="cells expanded to replan", xlabel="move", yscale="symlog")
        self.work.set(xlim=(-0.5, len(steps) - 0.5), ylim=(0, None))
        self._cursors = [
            ax.axvline(0, color=style.VERMILLION, linewidth=0.9) for ax in (self.cost, self.work)
        ]

    def _show_changes(self, step: int) -> None:
        for collection in self._fresh:
            collection.remove()
        self._fresh = []
        if step == 0:
            return
        before, now = self.episode.known[step - 1], self.episode.known[step]
        for which, colour in ((now & ~before, style.VERMILLION), (before & ~now, style.GREEN)):
            self._fresh.append(_squares(self.map, which, self.episode.grid_map, colour))


def _squares(ax: Axes, cells: BoolArray, grid: GridMap, colour: str) -> PatchCollection:
    """Fill some cells, bool[H, W]."""
    y, x = np.nonzero(cells)
    corners = np.asarray(grid.origin) + grid.cell_size * np.stack([x, y], axis=-1)
    squares = [Rectangle((float(e), float(n)), grid.cell_size, grid.cell_size) for e, n in corners]
    collection = PatchCollection(squares, facecolor=colour, edgecolor="none", zorder=2)
    ax.add_collection(collection, autolim=False)
    return collection
