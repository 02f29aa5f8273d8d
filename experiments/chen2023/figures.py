"""Figures 15 to 18 of Chen et al. 2023 in scenes of ours."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from experiments.chen2023.published import ENDS
from experiments.chen2023.routes import (
    ASTAR,
    CONTACTS,
    PROPOSED,
    SPLINE,
    Method,
    Search,
    contacts,
    make_route,
    of_pair,
    sail,
    search,
)
from experiments.chen2023.runs import Plan, Results
from experiments.chen2023.scenes import SIDE, Scenes, draw_scenes
from usvjax.plots import save, style
from usvjax.plots.base_map import View

DPI = 130
CLOSE_UP = 90.0  # m, its width
LEAST_CORNERS = 3  # corners that the path of Figs. 17 and 18 has at least

_EXPANDED, _ISLAND = "#F2DFC2", "#9C8A63"
_TRACK = style.VERMILLION


@dataclass(frozen=True)
class Shown:
    """A scene that figures show.

    Attributes:
        name: of the file.
        title: of the figure.
        plan: what it is taken from.
        scene: its number.
        pair: of ends.
        methods: one a column, with what the column is called.
        why: how it was chosen.
    """

    name: str
    title: str
    plan: Plan
    scene: int
    pair: int
    methods: tuple[tuple[Method, str], ...]
    why: str

    def described(self) -> dict[str, Any]:
        """For results.json."""
        return {
            "name": self.name,
            "title": self.title,
            "scene": self.scene,
            "expansion": self.plan.expansion,
            "start": ENDS[self.pair][0],
            "end": ENDS[self.pair][1],
            "why": self.why,
        }


def chosen_scenes(main: Plan, bare: Plan | None, results: Results) -> list[Shown]:
    """Choose the scenes of Figs. 15 to 18: the first ones that show what the figures do.

    Args:
        main: the plan with the printed expansion.
        bare: that without any, if there is one.
        results: of both.
    """
    first = ((ASTAR, "As Fig. 15: A*"), (PROPOSED, "As Fig. 16: proposed"))
    second = ((SPLINE, "As Fig. 17: A* + B-spline"), (PROPOSED, "As Fig. 18: proposed"))
    shown = []
    for plan, name, contact, why in (
        (main, "figs_15_16", "entered", "the vessel on A*'s path enters an expanded island"),
        (bare, "figs_15_16_not_expanded", "hit", "the vessel on A*'s path enters an island"),
    ):
        if plan is None:
            continue
        ours, plain = (of_pair(results[plan][m.name], 0) for m in (PROPOSED, ASTAR))
        scene = _first(ours.ok & plain.in_contact(contact))
        if scene is not None:
            title = f"Scene 1, islands expanded by 1 + E = {1 + plan.expansion:g}"
            shown.append(Shown(name, title, plan, scene, 0, first, why))
    ours = of_pair(results[main][PROPOSED.name], 1)
    scene = _first(ours.ok & (ours.corners.sum(axis=1) >= LEAST_CORNERS))
    if scene is not None:
        why = f"the proposed path has {LEAST_CORNERS} corners or more"
        title = f"Scene 2, islands expanded by 1 + E = {1 + main.expansion:g}"
        shown.append(Shown("figs_17_18", title, main, scene, 1, second, why))
    return shown


def _first(flags: np.ndarray) -> int | None:
    places = np.flatnonzero(flags)
    return int(places[0]) if len(places) else None


def draw_shown(shown: Shown, folder: Path) -> Path:
    """Draw one of them: a column a method, the whole scene above a close-up.

    Returns:
        The file.
    """
    scene = draw_scenes(1, shown.plan.waters, first=shown.scene)
    searched = search(scene, shown.plan.expansion).row(shown.pair)
    return save(_sheet(shown, scene, searched), folder / f"{shown.name}.png", dpi=DPI)


@dataclass(frozen=True)
class _Sailed:
    """One column: the path, the vessel's track, where it is in contact, and what is said."""

    path: np.ndarray
    track: np.ndarray
    contact: np.ndarray
    worst: np.ndarray
    words: str

    @property
    def middle(self) -> np.ndarray:
        """What a close-up is about: the first contact, else the place farthest off the path."""
        chosen: np.ndarray = self.contact[0] if len(self.contact) else self.worst
        return chosen


def _sailed(searched: Search, method: Method) -> _Sailed:
    route = make_route(searched, method)
    tracks = sail(searched, method, route)
    worst = int(tracks.distance[0].argmax())
    track = tracks.poses[0, :, :2]
    touched = contacts(tracks, searched)[0]
    kinds = [kind for kind in ("hit", "entered") if touched[:, list(CONTACTS).index(kind)].any()]
    words = f"enters {CONTACTS[kinds[0]]}" if kinds else "keeps clear of islands"
    return _Sailed(
        path=route.points[0, : route.counts[0]],
        track=track,
        contact=track[touched[:, list(CONTACTS).index("entered")]],
        worst=tracks.poses[0, worst, :2],
        words=f"{tracks.error[0]:.1f} m off at most, {words}",
    )


@style.styled
def _sheet(shown: Shown, scene: Scenes, searched: Search) -> Figure:
    fig = style.new_figure(style.DOUBLE_MM, 195)
    axes = fig.subplots(2, 2)
    columns = [_sailed(searched, method) for method, _ in shown.methods]
    view = _view(columns[0].middle)
    for column, ((_, title), sailed) in enumerate(zip(shown.methods, columns, strict=True)):
        for row, limits in enumerate((_WHOLE, view)):
            ax = axes[row, column]
            _paint(ax, scene, searched, shown.plan.expansion)
            _draw(ax, sailed, shown.pair)
            ax.set(xlim=limits[:2], ylim=limits[2:])
            style.map_axes(ax)
        axes[0, column].set_title(f"{title}\n{sailed.words}")
        frame = Rectangle((view[0], view[2]), CLOSE_UP, CLOSE_UP, fill=False, linewidth=0.8)
        axes[0, column].add_patch(frame)
        axes[1, column].set_title(f"framed part, {CLOSE_UP:g} m wide")
    fig.suptitle(f"{shown.title}, scene {shown.scene} of ours")
    style.outside_legend(fig, _handles(shown.plan.expansion), columns=4)
    return style.settle(fig)


_WHOLE: View = (-SIDE / 2, SIDE / 2, -SIDE / 2, SIDE / 2)


def _view(middle: np.ndarray) -> View:
    """The close-up about a point, within the map."""
    x, y = np.clip(middle, (CLOSE_UP - SIDE) / 2, (SIDE - CLOSE_UP) / 2)
    half = CLOSE_UP / 2
    return float(x - half), float(x + half), float(y - half), float(y + half)


def _paint(ax: Axes, scene: Scenes, searched: Search, expansion: float) -> None:
    """Paint water, the cells that routes keep clear of, islands and their expansion."""
    ax.imshow(
        searched.maps[0],
        origin="lower",
        extent=_WHOLE,
        cmap=ListedColormap([style.WATER, _EXPANDED]),
        interpolation="nearest",
        zorder=0,
    )
    ax.add_collection(PolyCollection(list(scene.corners[0]), facecolors=_ISLAND, zorder=1))
    if expansion > 0:
        rings = PolyCollection(list(scene.expanded(expansion)[0]), facecolors="none", zorder=1)
        rings.set(edgecolors=_ISLAND, linewidths=0.6, linestyles="--")
        ax.add_collection(rings)
    ax.grid(visible=False)


def _draw(ax: Axes, sailed: _Sailed, pair: int) -> None:
    ax.plot(*sailed.path.T, color=style.BLACK, linewidth=1.0, zorder=3)
    ax.plot(*sailed.track.T, color=_TRACK, linewidth=1.2, linestyle="--", zorder=4)
    ax.plot(*sailed.contact.T, ".", color=style.PURPLE, markersize=4, zorder=4.5)
    start, end = ENDS[pair]
    for point, marker in ((start, "o"), (end, "s")):
        ax.plot(*point, marker=marker, color=style.BLUE, markersize=5, zorder=5)


def _handles(expansion: float) -> list[Any]:
    handles: list[Any] = [
        Line2D([], [], color=style.BLACK, linewidth=1.0, label="planned path"),
        Line2D([], [], color=_TRACK, linestyle="--", label="track, 15 m/s, at most 1 rad/s"),
        Line2D([], [], color=style.BLUE, marker="o", linestyle="", label="start"),
        Line2D([], [], color=style.BLUE, marker="s", linestyle="", label="end"),
        Line2D([], [], color=style.PURPLE, marker=".", linestyle="", label="contact"),
        Patch(facecolor=_ISLAND, label="island"),
        Patch(facecolor=_EXPANDED, label="cells kept clear of"),
    ]
    if expansion > 0:
        ring = Line2D(
            [], [], color=_ISLAND, linestyle="--", linewidth=0.6, label="island x (1 + E)"
        )
        handles.insert(6, ring)
    return handles
