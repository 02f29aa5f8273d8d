"""Figures 15 to 18 of Chen et al. 2023 in scenes of ours."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from experiments.chen2023.charts import draw_corners, draw_ratios, draw_sailing, draw_values
from experiments.chen2023.mission import Sailed
from experiments.chen2023.published import ENDS
from experiments.chen2023.routes import ARCS, ASTAR, CONTACTS, PAIRS, SPLINE, TEMPLATES, Method
from experiments.chen2023.scenes import SIDE, Scenes
from experiments.chen2023.studies import EXPANSIONS, MAIN
from experiments.chen2023.tables import Measured, by_scene
from experiments.claims import Numbers
from experiments.paper import Drawing
from experiments.runs import Found, Ran
from usvjax.mission import Replayed
from usvjax.plots import style
from usvjax.plots.base_map import View

CLOSE_UP = 90.0  # m, its width
LEAST_CORNERS = 3  # corners that the path of Figs. 17 and 18 has at least

_KEPT_CLEAR, _ISLAND = "#F2DFC2", "#9C8A63"
_TRACK = style.VERMILLION
_WHOLE: View = (-SIDE / 2, SIDE / 2, -SIDE / 2, SIDE / 2)


@dataclass(frozen=True)
class Shown:
    """A scene that a figure shows.

    Attributes:
        name: of the file.
        about: what it shows, for the caption.
        study, label: what it is taken from.
        pair: of ends.
        columns: a method each, with what the column is called.
        why: how the scene was chosen.
    """

    name: str
    about: str
    study: str
    label: str
    pair: int
    columns: tuple[tuple[Method, str], ...]
    why: str


_FIRST = ((ASTAR, "As Fig. 15: A*"), (ARCS, "As Fig. 16: proposed, R = 15 m"))
_SECOND = ((SPLINE, "As Fig. 17: A* + B-spline"), (ARCS, "As Fig. 18: proposed, R = 15 m"))
SHOWN = (
    Shown(
        "figs_15_16",
        "The ends of Scene 1",
        MAIN,
        MAIN,
        0,
        _FIRST,
        "the vessel on A*'s path enters an expanded island",
    ),
    Shown(
        "figs_15_16_not_expanded",
        "The ends of Scene 1, islands not expanded",
        EXPANSIONS,
        "E = 0",
        0,
        _FIRST,
        "the vessel on A*'s path enters an island",
    ),
    Shown(
        "figs_17_18",
        "The ends of Scene 2",
        MAIN,
        MAIN,
        1,
        _SECOND,
        f"the proposed path has {LEAST_CORNERS} corners or more",
    ),
)


def figures(found: Found, numbers: Numbers) -> Iterator[Drawing]:
    """Scenes that show what the figures do, and what all scenes say."""
    for shown in SHOWN:
        ran = found.studies[shown.study]
        scene = _scene(shown, ran)
        if scene is not None:
            yield _drawn(shown, ran, scene)
    yield draw_ratios(numbers)
    yield draw_values(found, numbers)
    yield draw_sailing(found, numbers)
    yield draw_corners(numbers)


def _scene(shown: Shown, ran: Ran) -> int | None:
    """The first in which the proposed path is whole, and that which is wanted happens."""
    ours, other = (
        {name: column[:, shown.pair] for name, column in _measured(ran, shown, method).items()}
        for method in (ARCS, shown.columns[0][0])
    )
    if shown.columns is _FIRST:
        wanted = other["entered" if shown.study == MAIN else "hit"] == 1
    else:
        wanted = sum(ours[name] for name in TEMPLATES) >= LEAST_CORNERS
    places = np.flatnonzero(ours["whole"] & wanted)
    return int(places[0]) if len(places) else None


def _measured(ran: Ran, shown: Shown, method: Method) -> Measured:
    return by_scene(ran.columns(shown.label, method.name))


def _drawn(shown: Shown, ran: Ran, scene: int) -> Drawing:
    job = scene * PAIRS + shown.pair
    replayed = [ran.replay(shown.label, method.name, [job]) for method, _ in shown.columns]
    caption = (
        f"{shown.about}, scene {scene}: the first in which {shown.why} and the proposed path is "
        f"whole; {scene} passed over."
    )
    title = f"{shown.about}, scene {scene} of ours"
    return Drawing(shown.name, caption, _sheet(shown, title, replayed))


@style.styled
def _sheet(shown: Shown, title: str, replayed: list[Replayed]) -> Figure:
    """A column a method, the whole scene above a close-up."""
    expanded = replayed[0].scene.waters.expansion > 0
    fig = style.new_figure(style.DOUBLE_MM, 195)
    axes = fig.subplots(2, 2)
    sailed: list[Sailed] = [one.recording.detail[0] for one in replayed]
    view = _view(_middle(sailed[0]))
    for column, ((_, words), one, own) in enumerate(
        zip(shown.columns, replayed, sailed, strict=True)
    ):
        for row, limits in enumerate((_WHOLE, view)):
            ax = axes[row, column]
            _paint(ax, one, expanded)
            _draw(ax, own, shown.pair)
            ax.set(xlim=limits[:2], ylim=limits[2:])
            style.map_axes(ax)
        axes[0, column].set_title(f"{words}\n{_said(own)}")
        frame = Rectangle((view[0], view[2]), CLOSE_UP, CLOSE_UP, fill=False, linewidth=0.8)
        axes[0, column].add_patch(frame)
        axes[1, column].set_title(f"framed part, {CLOSE_UP:g} m wide")
    fig.suptitle(title)
    contact = any(_entered(own).any() for own in sailed)
    style.outside_legend(fig, _handles(expanded, contact), columns=4)
    return style.settle(fig)


def _entered(sailed: Sailed) -> np.ndarray:
    """bool[T], when the vessel was in an island, expanded as it was searched."""
    chosen: np.ndarray = sailed.contact[:, list(CONTACTS).index("entered")]
    return chosen


def _middle(sailed: Sailed) -> np.ndarray:
    """What a close-up is about: the first contact, else the place farthest off the path."""
    entered = np.flatnonzero(_entered(sailed))
    place = entered[0] if len(entered) else int(sailed.distance.argmax())
    chosen: np.ndarray = sailed.track[place]
    return chosen


def _said(sailed: Sailed) -> str:
    kinds = [k for k in ("hit", "entered") if sailed.contact[:, list(CONTACTS).index(k)].any()]
    words = f"enters {CONTACTS[kinds[0]]}" if kinds else "keeps clear of islands"
    return f"{sailed.distance.max():.1f} m off at most, {words}"


def _view(middle: np.ndarray) -> View:
    """The close-up about a point, within the map."""
    x, y = np.clip(middle, (CLOSE_UP - SIDE) / 2, (SIDE - CLOSE_UP) / 2)
    half = CLOSE_UP / 2
    return float(x - half), float(x + half), float(y - half), float(y + half)


def _paint(ax: Axes, replayed: Replayed, expanded: bool) -> None:
    """Paint water, the cells that routes keep clear of, islands and their expansion."""
    scenes: Scenes = replayed.scene.scenes
    ax.imshow(
        replayed.scene.maps[0],
        origin="lower",
        extent=_WHOLE,
        cmap=ListedColormap([style.WATER, _KEPT_CLEAR]),
        interpolation="nearest",
        zorder=0,
    )
    ax.add_collection(PolyCollection(list(scenes.corners[0]), facecolors=_ISLAND, zorder=1))
    if expanded:
        wider = scenes.expanded(replayed.scene.waters.expansion)
        rings = PolyCollection(list(wider[0]), facecolors="none", zorder=1)
        rings.set(edgecolors=_ISLAND, linewidths=0.6, linestyles="--")
        ax.add_collection(rings)
    ax.grid(visible=False)


def _draw(ax: Axes, sailed: Sailed, pair: int) -> None:
    ax.plot(*sailed.path.T, color=style.BLACK, linewidth=2.2, zorder=3)
    ax.plot(*sailed.track.T, color=_TRACK, linewidth=1.0, zorder=4)
    ax.plot(*sailed.track[_entered(sailed)].T, ".", color=style.PURPLE, markersize=4, zorder=4.5)
    for point, marker in zip(ENDS[pair], ("o", "s"), strict=True):
        ax.plot(*point, marker=marker, color=style.BLUE, markersize=5, zorder=5)


def _handles(expanded: bool, contact: bool) -> list[Any]:
    """What is drawn, and nothing else."""
    handles: list[Any] = [
        Line2D([], [], color=style.BLACK, linewidth=2.2, label="planned path"),
        Line2D([], [], color=_TRACK, linewidth=1.0, label="track, 15 m/s, at most 1 rad/s"),
        Line2D([], [], color=style.BLUE, marker="o", linestyle="", label="start"),
        Line2D([], [], color=style.BLUE, marker="s", linestyle="", label="end"),
        Patch(facecolor=_ISLAND, label="island"),
        Patch(facecolor=_KEPT_CLEAR, label="cells kept clear of"),
    ]
    if contact:
        dot: dict[str, Any] = {"color": style.PURPLE, "marker": ".", "linestyle": ""}
        handles.append(Line2D([], [], label="in an island" + " x (1 + E)" * expanded, **dot))
    if expanded:
        ring: dict[str, Any] = {"color": _ISLAND, "linestyle": "--", "linewidth": 0.6}
        handles.append(Line2D([], [], label="island x (1 + E)", **ring))
    return handles
