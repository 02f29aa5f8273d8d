"""Figs. 6 to 15 of Yu et al. 2022 on maps of ours, and the spread of many cruises."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from experiments.grid_figures import draw_path, paint_cells
from experiments.yu2022.cruises.published import STATISTICS
from experiments.yu2022.cruises.runs import (
    ALGORITHMS,
    CELL,
    ENVIRONMENTS,
    Cruises,
    Environment,
    Results,
    maps_of,
)
from usvjax.plots import save, style

DPI = 130
_NAMES = {"ordinary": "figs_6_10.png", "complex": "figs_11_15.png"}
_REACH = 2
"""Cells that the vessel sees to each side."""


def draw(results: Results, found: Mapping[str, Any], seed: int, folder: Path) -> list[Path]:
    """Draw all figures.

    Args:
        results: of `sail_all`.
        found: of `compare`.
        seed: of the plan.
        folder: to write to.
    """
    files = []
    for environment in ENVIRONMENTS:
        sailed = results.get((environment.name, 1))
        if sailed:
            figure = maps_figure(environment, sailed, seed)
            files.append(save(figure, folder / _NAMES[environment.name], dpi=DPI))
    return [*files, save(spread_figure(found), folder / "cruises.png", dpi=DPI)]


@style.styled
def maps_figure(environment: Environment, sailed: Mapping[str, Cruises], seed: int) -> Figure:
    """Draw one cruise of Case 1 with each algorithm; all on the first map, which is not chosen."""
    fig = style.new_figure(style.DOUBLE_MM, 130)
    blocked = maps_of(environment, 1, 1, seed)[0]
    stations = environment.cases[1]
    for ax, (name, own) in zip(fig.subplots(2, 3).flat, sailed.items(), strict=True):
        _cruise(ax, blocked, stations, own)
        label = style.folded(ALGORITHMS[name].label, 34)
        ax.set_title(f"{label}\n{own.length[0]:.0f} m, {own.inflections[0]} inflections")
    handles = [
        Line2D([], [], color=style.VERMILLION, label="line sailed"),
        Line2D([], [], color="none", marker="s", markerfacecolor="0.75", label="seen"),
        Line2D([], [], color="none", marker="s", markerfacecolor="0.15", label="blocked at first"),
        Line2D([], [], color="none", marker="o", markerfacecolor="white", label="station"),
    ]
    for handle in handles[1:]:
        handle.set_markeredgecolor(style.BLACK)
    style.outside_legend(fig, handles, columns=4)
    return style.settle(fig)


def _cruise(ax: Axes, blocked: np.ndarray, stations: np.ndarray, own: Cruises) -> None:
    track = own.result.track[0][: own.result.steps[0] + 1]
    paint_cells(ax, blocked, _seen(track, blocked), north_up=True)
    line = track
    if own.smoothed:
        line = own.result.smoothed[0][: own.result.smoothed_count[0]]
    draw_path(ax, line, linewidth=0.9)
    for place, station in enumerate(own.result.order[0], 1):
        x, y = stations[station]
        ax.plot(x, y, "o", markersize=3, markerfacecolor="white", markeredgecolor=style.BLACK)
        ax.annotate(
            str(place),
            (x, y),
            xytext=(2.5, 2.5),
            textcoords="offset points",
            color=style.BLUE,
            fontsize=6.5,
            fontweight="bold",
        )


def _seen(track: np.ndarray, blocked: np.ndarray) -> list[tuple[int, int]]:
    """Free cells within the vessel's window, anywhere along its track."""
    seen = np.zeros_like(blocked)
    for x, y in track:
        rows = slice(max(0, y - _REACH), y + _REACH + 1)
        seen[rows, max(0, x - _REACH) : x + _REACH + 1] = True
    return [(int(x), int(y)) for y, x in np.argwhere(seen & ~blocked)]


@style.styled
def spread_figure(found: Mapping[str, Any]) -> Figure:
    """Mean and range of 95 % of cruises in Case 1, beside the published means."""
    fig = style.new_figure(style.DOUBLE_MM, 45 + 40 * len(found))
    axes = fig.subplots(len(found), 2, squeeze=False)
    for row, (environment, cases) in zip(axes, found.items(), strict=True):
        algorithms = cases["1"]["algorithms"]
        for ax, indicator in zip(row, ("length", "inflections"), strict=True):
            for place, (name, own) in enumerate(algorithms.items()):
                _mark(ax, own[indicator], place)
                printed = STATISTICS[environment][indicator].get(name)
                if printed:
                    ax.plot(printed.mean, place + 0.22, "D", color=style.ORANGE, markersize=4)
            ax.set_ylim(len(algorithms) - 0.5, -0.5)
            ax.set_yticks(range(len(algorithms)), [])
        shortest = CELL * cases["1"]["optimum"]
        row[0].axvline(shortest, color=style.GREY, linewidth=0.9, linestyle="--")
        labels = [style.folded(ALGORITHMS[name].label, 24) for name in algorithms]
        row[0].set_yticks(range(len(algorithms)), labels)
        row[0].set(xlabel="length (m)", title=f"{environment}, Case 1")
        row[1].set_xlabel("inflection points")
    handles = [
        Line2D([], [], color=style.BLUE, marker="o", markersize=4, label="ours, mean and 95 %"),
        Line2D([], [], color="none", marker="D", markersize=4, label="published mean"),
        Line2D([], [], color=style.GREY, linestyle="--", label="shortest tour, straight legs"),
    ]
    handles[1].set_markerfacecolor(style.ORANGE)
    handles[1].set_markeredgecolor(style.ORANGE)
    style.outside_legend(fig, handles, columns=3)
    return style.settle(fig)


def _mark(ax: Axes, figure: Mapping[str, Any], place: float) -> None:
    if figure["value"] is None:
        return
    ax.plot([figure["low"], figure["high"]], [place, place], color=style.BLUE, linewidth=1.2)
    ax.plot(figure["value"], place, "o", color=style.BLUE, markersize=4)
