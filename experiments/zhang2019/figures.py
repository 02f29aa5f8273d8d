"""Figs. 9 and 10 of Zhang et al. 2019 on a map of ours, and what many maps add to them."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from experiments.grid_figures import draw_path, paint_cells
from experiments.zhang2019.compare import alike
from experiments.zhang2019.published import IMPROVED, TRADITIONAL
from experiments.zhang2019.runs import DENSITIES, SHOWN_DENSITY, Batch
from usvjax.plots import save, style

DPI = 130
Batches = Mapping[str, Mapping[float, Batch]]

TITLES = {
    "traditional": "traditional (Fig. 9)",
    "printed": "improved, Eq. 7 as printed (Fig. 10)",
    "accumulated": "improved, e(n) accumulated (Fig. 10)",
    "exact": "least length + turning",
}
LOOKS = {
    "traditional": style.Look(style.BLACK, "-", ""),
    "printed": style.Look(style.BLUE, "-", ""),
    "accumulated": style.Look(style.ORANGE, "--", ""),
    "exact": style.Look(style.GREEN, ":", ""),
}


def draw(blocked: np.ndarray, job: int, results: Batches, folder: Path) -> list[Path]:
    """Draw all figures.

    Args:
        blocked: bool[SIDE, SIDE], the map that is shown.
        job: its number at the density that is shown.
        results: of the batched search.
        folder: to write to.
    """
    figures = {
        "fig9_10.png": paths_figure(blocked, job, results),
        "maps_alike.png": alike_figure(results),
        "changes.png": changes_figure(results),
    }
    return [save(figure, folder / name, dpi=DPI) for name, figure in figures.items()]


@style.styled
def paths_figure(blocked: np.ndarray, job: int, results: Batches) -> Figure:
    """Draw one map with the path of each method."""
    fig = style.new_figure(style.DOUBLE_MM, 165)
    for ax, (method, batches) in zip(fig.subplots(2, 2).flat, results.items(), strict=True):
        batch = batches[SHOWN_DENSITY]
        own = batch.paths.some(np.array([job]))
        paint_cells(ax, blocked)
        draw_path(ax, batch.cells[job])
        ax.set_title(
            f"{TITLES[method]}\ntotal {own.total()[0]:.1f}, turning {own.turning[0]:.1f}, "
            f"{own.expanded[0]} expanded"
        )
    return style.settle(fig)


@style.styled
def alike_figure(results: Batches) -> Figure:
    """Total cost of each method on the maps that are like the paper's."""
    fig = style.new_figure(style.DOUBLE_MM, 70)
    ax = fig.subplots()
    old = results["traditional"][SHOWN_DENSITY].paths
    chosen = alike(old)
    for method, batches in results.items():
        totals = np.sort(batches[SHOWN_DENSITY].paths.some(chosen).total())
        if not len(totals):
            continue
        look = LOOKS[method]
        share = np.arange(1, len(totals) + 1) / len(totals)
        ax.step(totals, 100 * share, where="post", color=look.colour, linestyle=look.line)
    for row, name, height in ((TRADITIONAL, "traditional", 0.02), (IMPROVED, "improved", 0.8)):
        ax.axvline(row.total, color=style.VERMILLION, linewidth=0.9)
        ax.annotate(
            f"published\n{name}",
            (row.total, height),
            xycoords=("data", "axes fraction"),
            xytext=(3, 0),
            textcoords="offset points",
            fontsize=7,
            color=style.VERMILLION,
        )
    ax.set(xlabel="total cost (squares)", ylabel="maps (%)", ylim=(0, 102))
    ax.set_title(f"{chosen.sum()} maps on which the traditional path costs about as published")
    style.outside_legend(fig, _handles(list(results)), columns=2)
    return style.settle(fig)


@style.styled
def changes_figure(results: Batches) -> Figure:
    """Change of the total cost against the traditional path, per density."""
    fig = style.new_figure(style.DOUBLE_MM, 75)
    axes = fig.subplots(1, len(DENSITIES), sharey=True)
    others = [method for method in results if method != "traditional"]
    for ax, density in zip(axes, DENSITIES, strict=True):
        old = results["traditional"][density].paths
        for method in others:
            new = results[method][density].paths
            both = new.found & old.found
            change = np.sort(new.some(both).total() - old.some(both).total())
            look = LOOKS[method]
            share = np.arange(1, len(change) + 1) / len(change)
            ax.step(change, 100 * share, where="post", color=look.colour, linestyle=look.line)
        ax.axvline(0.0, color=style.GREY, linewidth=0.7)
        ax.set(xlabel="change of the total (squares)", ylim=(0, 102), xlim=(-12, 6))
        ax.set_title(f"density {density:g}")
    axes[0].set_ylabel("maps with that change or less (%)")
    style.outside_legend(fig, _handles(others), columns=3)
    return style.settle(fig)


def _handles(methods: list[str]) -> list[Line2D]:
    return [
        Line2D([], [], color=LOOKS[m].colour, linestyle=LOOKS[m].line, label=TITLES[m])
        for m in methods
    ]
