"""Fig. 5 of Yu et al. 2022 on a map of ours, and what many maps add to it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.grid_figures import draw_path, paint_cells
from experiments.yu2022.heuristic.expansion import Cell
from experiments.yu2022.heuristic.plans import Replanned, Scenes
from experiments.yu2022.heuristic.published import HEURISTICS, TRADITIONAL
from usvjax.plots import save, style

DPI = 130
LOOKS = {
    "chebyshev": style.Look(style.ORANGE, "--", "s"),
    "octile": style.Look(style.BLACK, "-", "o"),
    "weighted": style.Look(style.BLUE, "-", "v"),
    "weighted_octile": style.Look(style.GREEN, "-.", "^"),
}


def draw(
    scene: Scenes,
    sailed: Mapping[str, Replanned],
    expanded: Mapping[str, Sequence[Cell]],
    found: Mapping[str, Any],
    folder: Path,
) -> list[Path]:
    """Draw all figures.

    Args:
        scene: of which the first is shown.
        sailed: heuristic to the episodes on it.
        expanded: heuristic to the cells expanded there.
        found: the tables, as in results.json.
        folder: to write to.
    """
    figures = {
        "fig5.png": fig5(scene, sailed, expanded),
        "heuristics.png": heuristics_figure(found),
    }
    return [save(figure, folder / name, dpi=DPI) for name, figure in figures.items()]


@style.styled
def fig5(
    scene: Scenes, sailed: Mapping[str, Replanned], expanded: Mapping[str, Sequence[Cell]]
) -> Figure:
    """Draw expanded cells (grey) and path (red) of each heuristic on the first map."""
    fig = style.new_figure(style.DOUBLE_MM, 178)
    best = sailed[TRADITIONAL].length[0]
    for ax, (heuristic, name) in zip(fig.subplots(2, 2).flat, HEURISTICS.items(), strict=True):
        own = sailed[heuristic]
        paint_cells(ax, scene.blocked[0], expanded[heuristic])
        draw_path(ax, own.position[0])
        ax.set_title(
            f"{name}\n{own.first[0]} expanded, length {own.length[0]:.1f} "
            f"({own.length[0] / best:.3f} of the shortest)"
        )
    return style.settle(fig)


@style.styled
def heuristics_figure(found: Mapping[str, Any]) -> Figure:
    """Expansions and lengths of each heuristic against the traditional one, per kind of map."""
    fig = style.new_figure(style.DOUBLE_MM, 85)
    left, right = fig.subplots(1, 2, sharey=True)
    tables = {**found["plans"], **found["episodes"]}
    others = [h for h in HEURISTICS if h != TRADITIONAL]
    for place, table in enumerate(tables.values()):
        for shift, heuristic in zip((-0.2, 0.0, 0.2), others, strict=True):
            row = table["heuristics"][heuristic]
            _mark(left, row["times"], place + shift, heuristic)
            _mark(right, row["length_ratio"], place + shift, heuristic)
    for ax in (left, right):
        ax.axvline(1.0, color=style.GREY, linewidth=0.8)
    left.set_yticks(range(len(tables)), [style.folded(label, 22) for label in tables])
    left.set_ylim(len(tables) - 0.5, -0.5)
    left.set(xscale="log", xlabel="cells expanded, relative to chess-board")
    ticks = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0]
    left.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    left.minorticks_off()
    right.set_xlabel("length, relative to chess-board")
    handles = [style.method_handle(LOOKS[h]._replace(line="-"), HEURISTICS[h]) for h in others]
    for handle in handles:
        handle.set_linestyle("none")
    style.outside_legend(fig, handles, columns=3)
    return style.settle(fig)


def _mark(ax: Axes, figure: Mapping[str, Any], y: float, heuristic: str) -> None:
    if figure["value"] is None:
        return
    look = LOOKS[heuristic]
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
