"""What the massive runs add to the figures of Chen et al. 2023."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import usvjax.missions.route.looks  # noqa: F401
from experiments.chen2023.published import ENDS, TABLE_3
from experiments.chen2023.routes import (
    ASTAR,
    PROPOSED,
    SPLINE,
    SWEPT,
    Measures,
    degrees,
    of_pair,
)
from usvjax.plots import save, style

DPI = 130
LOOKS = style.method_looks([method.name for method in SWEPT])
_BAR: dict[str, Any] = {"markersize": 4, "elinewidth": 0.9, "capsize": 2}
_MOST_ERROR = 13.0  # m, on the axis; a few routes of A* have more
_ITSELF: dict[str, Any] = {"color": style.GREY, "linestyle": ":", "marker": "o", "markersize": 3}
_PAIRS = ("Scene 1", *(f"row {i}" for i in range(1, len(ENDS))))


def draw_monte_carlo(found: dict[str, Any], measured: dict[str, Measures], folder: Path) -> Path:
    """Draw contacts, distances from the path, lengths and turning; the file.

    Args:
        found: all results, as in results.json.
        measured: of the main plan.
        folder: to write to.
    """
    return save(_sheet(found, measured), folder / "monte_carlo.png", dpi=DPI)


@style.styled
def _sheet(found: dict[str, Any], measured: dict[str, Measures]) -> Figure:
    fig = style.new_figure(style.DOUBLE_MM, 150)
    axes = fig.subplots(2, 2)
    _contacts(axes[0, 0], found)
    _errors(axes[0, 1], measured)
    _lengths(axes[1, 0], measured)
    _turning(axes[1, 1], measured)
    scenes = found["settings"]["main"]["scenes"]
    fig.suptitle(
        f"{scenes:,} scenes, five pairs of ends each (bars: 95 % intervals; boxes: quartiles, "
        "whiskers: 95 % of scenes)"
    )
    handles = [style.method_handle(LOOKS[m.name], m.words) for m in SWEPT]
    handles.append(Line2D([], [], label="A*, in the island itself", **_ITSELF))
    look: dict[str, Any] = {"color": style.BLACK, "marker": "_", "markersize": 10, "linestyle": ""}
    handles.append(Line2D([], [], label="published", **look))
    style.outside_legend(fig, handles, columns=3)
    return style.settle(fig)


def _contacts(ax: Axes, found: dict[str, Any]) -> None:
    """Contacts with the cells of islands, against the expansion that paths keep clear of."""
    main = found["settings"]["main"]["expansion"]
    rows = [*found["expansions"], *({"expansion": main, **row} for row in found["sailing"])]
    for place, method in enumerate(SWEPT):
        own = sorted(
            (row for row in rows if row["method"] == method.name), key=lambda r: r["expansion"]
        )
        where = np.array([row["expansion"] for row in own]) + 0.012 * (place - 1.5)
        _bars(ax, where, [row["touched_scenes"] for row in own], method.name)
        if method is ASTAR:
            itself = [100.0 * (row["hit_scenes"]["value"] or 0.0) for row in own]
            ax.plot(where, itself, **_ITSELF)
    ax.set(xlabel="expansion coefficient E of the search", ylabel="routes (%)")
    ax.set_title("Vessel on a cell of an island, not expanded")


def _bars(ax: Axes, where: np.ndarray, figures: Sequence[dict[str, Any]], name: str) -> None:
    known = [figure["value"] is not None for figure in figures]
    kept = [figure for figure, k in zip(figures, known, strict=True) if k]
    value = np.array([figure["value"] for figure in kept])
    low, high = (
        np.array([f["value"] if f[end] is None else f[end] for f in kept])
        for end in ("low", "high")
    )
    colour, line, marker = LOOKS[name]
    ax.errorbar(
        where[known],
        100.0 * value,
        yerr=100.0 * np.maximum([value - low, high - value], 0.0),
        color=colour,
        linestyle=line,
        linewidth=1.1,
        marker=marker,
        **_BAR,
    )


def _errors(ax: Axes, measured: dict[str, Measures]) -> None:
    """Share of routes on which the vessel was ever farther off than x."""
    for method in SWEPT:
        m = measured[method.name]
        error = np.sort(m.error[m.ok])
        farther = 100.0 * (1.0 - np.arange(len(error)) / max(len(error), 1))
        colour, line, _ = LOOKS[method.name]
        ax.plot(error, farther, color=colour, linestyle=line)
    ax.set(xlabel="largest distance from the path (m)", ylabel="routes with more (%)")
    ax.set(xlim=(0, _MOST_ERROR), ylim=(0, 103))
    ax.set_title("How far vessels leave their paths")


def _lengths(ax: Axes, measured: dict[str, Measures]) -> None:
    """Length over the straight line, pair by pair."""
    published = [(row.bspline.length, row.proposed.length, row.straight) for row in TABLE_3]
    for place, method in enumerate((SPLINE, PROPOSED)):
        values = [
            (m.length / m.straight)[_both_ok(measured, pair)]
            for pair, m in enumerate(_pairs(measured, method.name))
        ]
        _boxes(ax, values, method.name, place)
        marks = [row[place] / row[2] for row in published]
        _marks(ax, marks, place)
    _label(ax, "path length / straight line")
    ax.set_title("Length")


def _turning(ax: Axes, measured: dict[str, Measures]) -> None:
    for place, method in enumerate((SPLINE, PROPOSED)):
        values = [
            degrees(m.turning)[_both_ok(measured, pair)]
            for pair, m in enumerate(_pairs(measured, method.name))
        ]
        _boxes(ax, values, method.name, place)
        _marks(ax, [row.of(("bspline", "proposed")[place]).degrees for row in TABLE_3], place)
    _label(ax, "total turning angle (deg)")
    ax.set_title("Turning (published: digits as decimals)")


def _pairs(measured: dict[str, Measures], name: str) -> list[Measures]:
    return [of_pair(measured[name], pair) for pair in range(len(ENDS))]


def _both_ok(measured: dict[str, Measures], pair: int) -> np.ndarray:
    """Scenes in which both algorithms have a path; the proposed one has the fewer."""
    return of_pair(measured[PROPOSED.name], pair).ok


def _boxes(ax: Axes, values: Sequence[np.ndarray], name: str, place: int) -> None:
    colour = LOOKS[name].colour
    drawn = [v if len(v) else np.array([np.nan]) for v in values]
    ax.boxplot(
        drawn,
        positions=np.arange(len(drawn)) + 0.3 * (place - 0.5),
        widths=0.22,
        whis=(2.5, 97.5),
        showfliers=False,
        patch_artist=True,
        manage_ticks=False,
        boxprops={"facecolor": "white", "edgecolor": colour, "linewidth": 1.0},
        medianprops={"color": colour, "linewidth": 1.2},
        whiskerprops={"color": colour, "linewidth": 0.9},
        capprops={"color": colour, "linewidth": 0.9},
    )


def _marks(ax: Axes, values: Sequence[float], place: int) -> None:
    """Mark what Table 3 prints; Scene 1 has no such row."""
    where = np.arange(1, len(ENDS)) + 0.3 * (place - 0.5)
    ax.plot(where, values, "_", color=style.BLACK, markersize=13, markeredgewidth=1.8, zorder=5)


def _label(ax: Axes, words: str) -> None:
    ax.set_xticks(range(len(ENDS)), _PAIRS)
    ax.set(xlabel="ends (rows of Table 3)", ylabel=words)


def draw_corners(found: dict[str, Any], folder: Path) -> Path:
    """Draw by which template corners are sailed, and how many paths have all of theirs."""
    return save(_corner_sheet(found), folder / "corners.png", dpi=DPI)


_TEMPLATES = {
    "INSIDE": ("1, inside the corner", style.BLUE),
    "LATE": ("2, wide after it", style.GREEN),
    "EARLY": ("3, wide before it", style.ORANGE),
    "UNFITTED": ("none", style.VERMILLION),
}


@style.styled
def _corner_sheet(found: dict[str, Any]) -> Figure:
    rows = [row for row in found["corners"] if row["corners"]]
    fig = style.new_figure(style.DOUBLE_MM, 42 + 9 * len(rows))
    ax = fig.subplots()
    left = np.zeros(len(rows))
    handles = []
    for name, (label, colour) in _TEMPLATES.items():
        share = np.array([100.0 * row["templates"][name] / row["corners"] for row in rows])
        handles.append(
            ax.barh(range(len(rows)), share, left=left, color=colour, label=label, height=0.6)
        )
        left += share
    labels = [
        f"{row['words']}\n{100 * row['fitted'] / row['found']:.1f} % of paths whole" for row in rows
    ]
    ax.set_yticks(range(len(rows)), labels)
    ax.invert_yaxis()
    ax.set(xlim=(0, 100), xlabel="share of corners (%)")
    ax.set_title("Corners by the template of Algorithm 1 that they are sailed by")
    style.outside_legend(fig, handles, columns=4)
    return style.settle(fig)
