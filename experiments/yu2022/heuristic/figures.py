"""Fig. 5 of Yu et al. 2022 on a map of ours, and what many maps add to it."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from experiments.claims import Numbers
from experiments.grid_figures import draw_path, end_handles, paint_cells
from experiments.paper import Drawing
from experiments.runs import Found, Ran
from experiments.yu2022.heuristic.compare import NEW
from experiments.yu2022.heuristic.expansion import expand
from experiments.yu2022.heuristic.mission import MISSION, TRADITIONAL
from usvjax.plots import style

LOOKS = {
    "octile": style.Look(style.BLACK, "", "o"),
    "weighted": style.Look(style.BLUE, "", "v"),
    "weighted_octile": style.Look(style.GREEN, "", "^"),
}


def figures(found: Found, numbers: Numbers) -> Iterator[Drawing]:
    """Draw them all."""
    yield Drawing(
        "fig5",
        f"As Fig. 5, on the first map of ours ({numbers['shown']['condition']}; row 0 is the "
        "uppermost): cells expanded for the first plan and the path, with each heuristic.",
        fig5(found.studies["plans"]),
    )
    yield Drawing(
        "heuristics",
        "Expansions (geometric mean of the ratios, t interval) and lengths (mean of the ratios, "
        "bootstrap interval) against the traditional heuristic, map by map, on all kinds of maps; "
        "the last two change with every move.",
        heuristics_figure(numbers),
    )


@style.styled
def fig5(plans: Ran) -> Figure:
    """Draw expanded cells and path of each heuristic on the first map."""
    fig = style.new_figure(style.DOUBLE_MM, 186)
    label = plans.spec.conditions[0].label
    old = plans.columns(label, TRADITIONAL)
    for ax, name in zip(fig.subplots(2, 2).flat, (TRADITIONAL, *NEW), strict=True):
        own = plans.columns(label, name)
        replayed = plans.replay(label, name, [0])
        blocked = replayed.recording.grounds[0].grid.blocked
        position = replayed.recording.detail[0]
        start, goal = (
            tuple(map(int, cells[0])) for cells in (replayed.scene.starts, replayed.scene.goals)
        )
        paint_cells(ax, blocked, expand(blocked, start, goal, name).cells)  # type: ignore[arg-type]
        draw_path(ax, position)
        ax.set_title(
            f"{MISSION.methods[name]}\n{own['first'][0]} expanded, {own['length'][0]:.1f} cells "
            f"long ({own['length'][0] / old['length'][0]:.3f} x the shortest)"
        )
    handles = [
        Patch(facecolor="0.72", label="expanded"),
        Patch(facecolor="0.15", label="blocked"),
        Line2D([], [], color=style.VERMILLION, label="path"),
        *end_handles(),
    ]
    style.outside_legend(fig, handles, columns=5)
    return style.settle(fig)


@style.styled
def heuristics_figure(numbers: Numbers) -> Figure:
    """Expansions and lengths of each heuristic against the traditional one, per kind of map."""
    fig = style.new_figure(style.DOUBLE_MM, 90)
    left, right = fig.subplots(1, 2, sharey=True)
    tables = {**numbers["plans"], **numbers["episodes"]}
    for place, table in enumerate(tables.values()):
        for shift, name in zip((-0.2, 0.0, 0.2), NEW, strict=True):
            row = table["heuristics"][name]
            against = row["against"][TRADITIONAL] if "against" in row else row
            _mark(left, against["times"], place + shift, LOOKS[name])
            _mark(right, row["length_ratio"], place + shift, LOOKS[name])
    for ax in (left, right):
        ax.axvline(1.0, color=style.GREY, linewidth=0.8)
    left.set_yticks(range(len(tables)), [style.folded(label, 22) for label in tables])
    left.set_ylim(len(tables) - 0.5, -0.5)
    left.set(xscale="log", xlabel="cells expanded, relative to chess-board")
    ticks = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0]
    left.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    left.minorticks_off()
    right.set_xlabel("length, relative to chess-board")
    handles = [style.method_handle(LOOKS[name], MISSION.methods[name]) for name in NEW]
    style.outside_legend(fig, handles, columns=3)
    return style.settle(fig)


def _mark(ax: Axes, figure: Mapping[str, Any], y: float, look: style.Look) -> None:
    if figure["value"] is None:
        return
    error = None
    if figure["low"] is not None:
        error = np.abs(np.array([[figure["low"]], [figure["high"]]]) - figure["value"])
    ax.errorbar(
        [figure["value"]],
        [y],
        xerr=error,
        color=look.colour,
        marker=look.marker,
        markersize=4,
        elinewidth=0.9,
        capsize=2,
    )
