"""The figures of the mission "aggregate"."""

from collections.abc import Iterator, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from usvjax.mission import Replay, Replayed
from usvjax.missions.aggregate.measures import formation_errors, heading_errors
from usvjax.missions.fleet.figures import examples, fleet_film, overview, plot_separations
from usvjax.missions.fleet.panels import draw_marks, ending_words, plot_fleets
from usvjax.plots import style
from usvjax.plots.film import Film
from usvjax.plots.methods import Comparison, Panel
from usvjax.study import Run
from usvkernels.status import AGGREGATE_ENDINGS, Status

_PANELS = (
    Panel("formed_time", "formed after (s)"),
    Panel("formation_error", "largest distance from a slot (m)"),
    Panel("min_separation", "least distance between hulls (m)"),
)

_ARROW = 0.06
"""Length of a slot's arrow, of how far the tracks reach."""

_LEAST = 0.1
"""m, below which errors of a formation are not told apart."""


def aggregate_figures(run: Run, replay: Replay) -> Iterator[tuple[str, Figure]]:
    """Yield (name, figure) of a run, the cheap ones first.

    - success: rates of every ending;
    - methods: how strategies compare over the fleets that form up under all of them;
    - of each of the first conditions an example under every strategy: its tracks and slots
      ("formation"), errors of formation and headings over time ("errors"), and distances between
      hulls ("separation").
    """
    what = Comparison(Status.REACHED, _PANELS, "fleets that form up under each strategy")
    yield from overview(run, replay.table, AGGREGATE_ENDINGS, what)
    for condition, found, title in examples(run, replay):
        yield f"formation-c{condition}", plot_fleets(found, title, draw_slots)
        yield f"errors-c{condition}", plot_errors(found, title)
        yield f"separation-c{condition}", plot_separations(found, title)


def aggregate_film(replayed: Replayed, row: int) -> Film:
    """An episode as `fleet_film`, with the heading at every slot."""
    film = fleet_film(replayed, row)
    _draw_headings(film.fig.axes[0], replayed, row)
    return film


def draw_slots(ax: Axes, each: Replayed) -> list[Line2D]:
    """Mark starts and slots of the first episode, with the heading; return the legend's handles."""
    marks = each.recording.grounds[0].marks
    _draw_headings(ax, each, 0)
    start = draw_marks(ax, marks["start"], "start", "o", 4.0, "white")
    return [start, draw_marks(ax, marks["slot"], "slot, and heading", "D", 3.0, style.YELLOW)]


def _draw_headings(ax: Axes, each: Replayed, row: int) -> None:
    """Draw an arrow on the heading from every slot of an episode."""
    heading = each.scene.scenes.headings[row]
    reach = np.ptp(each.recording.tracks[row].places.reshape(-1, 2), axis=0).max()
    bow = _ARROW * reach * np.array([np.cos(heading), np.sin(heading)])
    looks = {"arrowstyle": "-|>", "color": style.BLACK, "linewidth": 0.8}
    for slot in each.recording.grounds[row].marks["slot"]:
        ax.annotate("", xy=slot + bow, xytext=slot, arrowprops=looks, zorder=5)


@style.styled
def plot_errors(found: Mapping[str, Replayed], title: str) -> Figure:
    """Draw how far a fleet is from its formation over time, in place and in heading.

    Args:
        found: by strategy, the first episode of each.
        title: of the figure.

    Returns:
        The figure, 170 mm wide; thin lines are the tolerances.
    """
    fig = style.new_figure(style.DOUBLE_MM, 125)
    above, below = fig.subplots(2, 1, sharex=True)
    looks, handles = style.method_looks(found), []
    for name, each in found.items():
        look, time = looks[name], each.recording.tracks[0].along
        states = each.recording.detail[0][None]
        slots = each.recording.grounds[0].marks["slot"][None]
        off = np.maximum(formation_errors(states, slots)[0], _LEAST)
        askew = np.degrees(heading_errors(states, each.scene.scenes.headings[:1])[0])
        for ax, values in ((above, off), (below, askew)):
            ax.plot(time, values, linewidth=1.1, color=look.colour, linestyle=look.line)
            ax.lines[-1].set_zorder(look.zorder)
            ax.plot(time[-1], values[-1], look.marker, color=look.colour, markersize=4)
        handles.append(style.method_handle(look, f"{name}: {ending_words(each)}"))
    params = each.scene.params
    tolerance = {"color": style.BLACK, "linewidth": 0.6, "zorder": 1}
    above.axhline(float(params.goal_tolerance), **tolerance)
    below.axhline(float(np.degrees(params.heading_tolerance)), **tolerance)
    above.set(ylabel="largest distance from a slot (m)", yscale="log")
    style.plain_powers(above.yaxis)
    below.set(ylabel="largest error of a heading (deg)", xlabel="time (s)", ylim=(0, 184))
    below.set_yticks(range(0, 181, 30))
    fig.suptitle(style.folded(title, 95))
    handles.append(Line2D([], [], label="tolerance", color=style.BLACK, linewidth=0.6))
    style.outside_legend(fig, handles, columns=min(len(handles), 3))
    return style.settle(fig)
