"""What all scenes add to the figures of Chen et al. 2023."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from experiments.chen2023.angles import DIGITS, ratio, turning
from experiments.chen2023.claims import ALPHA, FEWEST, LITERAL, ROWS
from experiments.chen2023.published import ENDS, EXPANSION, TABLE_3
from experiments.chen2023.routes import (
    ARCS,
    ARCS_3,
    ARCS_WIDE,
    ASTAR,
    METHODS,
    SHORT_ARCS,
    SPLINE,
    Method,
    degrees,
)
from experiments.chen2023.studies import MAIN
from experiments.chen2023.tables import METRICS, Measured, by_scene
from experiments.claims import Numbers
from experiments.paper import Drawing
from experiments.runs import Found
from usvjax.plots import style

_MOST_ERROR = 13.0  # m, on the axis; a few routes of A* have more
_BAR: dict[str, Any] = {"markersize": 3.5, "elinewidth": 0.9, "capsize": 2, "linestyle": ""}
_PRINTED = {"decimals": ("D", -0.04), "minutes": ("^", 0.04)}
"""Marker of what is printed by the reading of angles, and its place beside the other reading."""
_DRAWN = (ASTAR, SPLINE, ARCS, ARCS_3)
LOOKS = {
    ASTAR.name: style.Look(style.BLACK, "-", "o"),
    SPLINE.name: style.Look(style.PURPLE, "--", "X"),
    ARCS.name: style.Look(style.VERMILLION, "-", "*"),
    ARCS_3.name: style.Look(style.GREEN, "-.", "^"),
}
_NOTHING = {"low": None}
_COLOURS = (style.VERMILLION, style.ORANGE, style.GREEN)
_ROWS = [f"row {place}" for place in range(1, ROWS + 1)]


def draw_ratios(numbers: Numbers) -> Drawing:
    """The proposed path over the B-spline under every reading of it."""
    caption = (
        "Proposed over B-spline of A*'s cells, rows of Table 3, where they are of 20 scenes or "
        "more: geometric means with 95 % t intervals; in brackets what does not count."
    )
    return Drawing("ratios", caption, _ratios(numbers))


@style.styled
def _ratios(numbers: Numbers) -> Figure:
    named = [
        (f"{reading}{'' if label == MAIN else ', ' + label}", label, method, (colour, marker))
        for label, marker in zip(numbers["compared"], "os^", strict=False)
        for (reading, method), colour in zip(LITERAL.items(), _COLOURS, strict=True)
    ]
    named.append(("(shortened first, R = 15 m)", MAIN, SHORT_ARCS, (style.GREY, "*")))
    fig = style.new_figure(style.DOUBLE_MM, 115)
    for ax, metric in zip(fig.subplots(1, 2), METRICS, strict=True):
        # What is printed takes the last place of each row.
        shifts = 0.9 * ((np.arange(len(named) + 1) + 0.5) / (len(named) + 1) - 0.5)
        for (_, label, method, look), shift in zip(named, shifts[:-1], strict=True):
            rows = numbers["compared"][label][method.name][SPLINE.name][1:]
            told = [row[metric]["ratio"] if row["n"] >= FEWEST else _NOTHING for row in rows]
            _bars(ax, np.arange(ROWS) + shift, told, *look)
        for digits in METRICS[metric]:
            ratios = [ratio(row, metric, digits) for row in TABLE_3]
            _printed(ax, np.arange(ROWS) + shifts[-1], ratios, digits)
        ax.axhline(1.0, color=style.GREY, linewidth=0.8, zorder=1)
        _by_place(ax, _ROWS)
        ax.set(xlabel="row of Table 3", ylabel=f"proposed / B-spline, {_words(metric)}")
    handles = [
        Line2D([], [], color=colour, marker=marker, linestyle="", markersize=4, label=words)
        for words, _, _, (colour, marker) in named
    ]
    style.outside_legend(fig, [*handles, *_printed_handles(METRICS["turning"])], columns=2)
    return style.settle(fig)


def _by_place(ax: Axes, names: Sequence[str]) -> None:
    """Name places on the x axis, a line between every two of them."""
    ax.set_xticks(range(len(names)), names)
    ax.set_xlim(-0.5, len(names) - 0.5)
    ax.grid(visible=False, axis="x")
    for edge in np.arange(len(names) - 1) + 0.5:
        ax.axvline(edge, color=style.LIGHT_GREY, linewidth=0.5, zorder=0)


def _words(metric: str) -> str:
    return "length" if metric == "length" else "turning angle"


def _printed(ax: Axes, where: np.ndarray, values: Sequence[float], digits: str) -> None:
    marker, shift = _PRINTED[digits]
    ax.plot(
        where + shift, values, marker, color=style.BLACK, markersize=4, fillstyle="none", zorder=5
    )


def _printed_handles(digits: Sequence[str]) -> list[Line2D]:
    look: dict[str, Any] = {"color": style.BLACK, "linestyle": "", "fillstyle": "none"}
    return [
        Line2D([], [], marker=_PRINTED[d][0], label=f"published (as {d})", **look) for d in digits
    ]


def _bars(
    ax: Axes, where: np.ndarray, figures: Sequence[dict[str, Any]], colour: str, marker: str
) -> None:
    """Values with their intervals; what has no interval is left out."""
    known = [(x, f) for x, f in zip(where, figures, strict=True) if f["low"] is not None]
    value, low, high = (np.array([f[name] for _, f in known]) for name in ("value", "low", "high"))
    error = np.maximum([value - low, high - value], 0.0)
    ax.errorbar([x for x, _ in known], value, yerr=error, color=colour, marker=marker, **_BAR)


def draw_values(found: Found, numbers: Numbers) -> Drawing:
    """Length and turning of paths by pair of ends, beside Table 3."""
    caption = (
        "Length and turning by pair of ends, where they are of 20 scenes or more: means, and bars "
        f"over {100 - 100 * ALPHA / ROWS:g} % of the scenes."
    )
    return Drawing("lengths_and_turning", caption, _values(found))


@style.styled
def _values(found: Found) -> Figure:
    fig = style.new_figure(style.DOUBLE_MM, 90)
    length, angle = fig.subplots(1, 2)
    drawn = (SPLINE, ARCS, ARCS_3)
    for place, method in enumerate(drawn):
        m = _measured(found, method)
        shift = 0.24 * (place - 1)
        _ranges(length, m["path_length"] / m["straight"], m["whole"], method, shift)
        _ranges(angle, degrees(m["turning"]), m["whole"], method, shift)
    # Beside the spline, and between the two proposed paths.
    for shift, name in ((-0.36, "bspline"), (0.12, "proposed")):
        where = np.arange(1, len(ENDS)) + shift
        over = [row.of(name).length / row.straight for row in TABLE_3]
        _printed(length, where, over, "decimals")
        for digits in DIGITS:
            _printed(angle, where, [turning(row.of(name), digits) for row in TABLE_3], digits)
    for ax, words in ((length, "length / straight line"), (angle, "total turning angle (deg)")):
        _by_place(ax, ["Scene 1", *_ROWS])
        ax.set(xlabel="ends (rows of Table 3)", ylabel=words)
    handles = [_handle(method) for method in drawn]
    style.outside_legend(fig, [*handles, *_printed_handles(tuple(DIGITS))], columns=3)
    return style.settle(fig)


def _handle(method: Method) -> Line2D:
    colour, _, marker = LOOKS[method.name]
    return Line2D([], [], color=colour, marker=marker, linestyle="", label=method.words)


def _ranges(ax: Axes, values: np.ndarray, whole: np.ndarray, method: Method, shift: float) -> None:
    """Means of each pair, and the range that all but ALPHA / ROWS of its scenes lie in."""
    tail = ALPHA / ROWS / 2
    figures = []
    for own, ok in zip(values.T, whole.T, strict=True):
        if ok.sum() >= FEWEST:
            low, high = np.quantile(own[ok], [tail, 1 - tail])
            figures.append({"value": own[ok].mean(), "low": low, "high": high})
        else:
            figures.append(_NOTHING)
    colour, _, marker = LOOKS[method.name]
    _bars(ax, np.arange(len(figures)) + shift, figures, colour, marker)


def _measured(found: Found, method: Method) -> Measured:
    return by_scene(found.studies[MAIN].columns(MAIN, method.name))


def draw_sailing(found: Found, numbers: Numbers) -> Drawing:
    """Contacts against the expansion of the search, and how far vessels leave their paths."""
    caption = (
        "Left: routes on which the vessel is at some time on a cell of an island, not expanded, "
        f"with 95 % intervals. Right: how far vessels leave their paths at E = {EXPANSION:g}."
    )
    return Drawing("sailing", caption, _sailing(found, numbers))


@style.styled
def _sailing(found: Found, numbers: Numbers) -> Figure:
    fig = style.new_figure(style.DOUBLE_MM, 80)
    left, right = fig.subplots(1, 2)
    expansions = sorted(numbers["sailing"])
    for place, method in enumerate(_DRAWN):
        colour, line, marker = LOOKS[method.name]
        rows = [numbers["sailing"][e][method.name]["contacts"]["touched"] for e in expansions]
        rates = [{end: _percent(row["scenes"][end]) for end in row["scenes"]} for row in rows]
        _bars(left, np.arange(len(rows)) + 0.18 * (place - 1.5), rates, colour, marker)
        m = _measured(found, method)
        error = np.concatenate([[0.0], np.sort(m["error"][m["whole"]]), [_MOST_ERROR]])
        farther = 100.0 * np.linspace(1.0, 0.0, len(error) - 1)
        right.step(error, [*farther, 0.0], where="post", color=colour, linestyle=line)
    _by_place(left, [f"{e:g}" for e in expansions])
    left.set(xlabel="expansion coefficient E of the search", ylabel="routes with contact (%)")
    right.set(xlabel="largest distance from the path (m)", ylabel="routes with more (%)")
    right.set(xlim=(0, _MOST_ERROR), ylim=(0, 103))
    handles = [style.method_handle(LOOKS[m.name], m.words) for m in _DRAWN]
    style.outside_legend(fig, handles, columns=4)
    return style.settle(fig)


def _percent(share: float | None) -> float | None:
    return None if share is None else 100.0 * share


def draw_corners(numbers: Numbers) -> Drawing:
    """By which template corners are sailed, and how many paths have all of theirs."""
    caption = "Corners by the template of Algorithm 1 that they are sailed by."
    return Drawing("corners", caption, _corners(numbers))


_TEMPLATES = {
    "inside": ("1, inside the corner", style.BLUE),
    "late": ("2, wide after it", style.GREEN),
    "early": ("3, wide before it", style.ORANGE),
    "unfitted": ("none", style.VERMILLION),
}


@style.styled
def _corners(numbers: Numbers) -> Figure:
    rows = [
        (METHODS[name].words + ("" if label == MAIN else f", {label}"), row)
        for label, own in numbers["corners"].items()
        for name, row in own.items()
        if row["corners"] and name != ARCS_WIDE.name  # it differs in arcs, not in templates
    ]
    fig = style.new_figure(style.DOUBLE_MM, 25 + 9 * len(rows))
    ax = fig.subplots()
    left = np.zeros(len(rows))
    handles = []
    for name, (label, colour) in _TEMPLATES.items():
        share = np.array([100.0 * row["templates"][name] / row["corners"] for _, row in rows])
        handles.append(
            ax.barh(range(len(rows)), share, left=left, color=colour, label=label, height=0.6)
        )
        left += share
    labels = [
        f"{words}\n{100 * row['fitted'] / row['found']:.1f} % of paths whole" for words, row in rows
    ]
    ax.set_yticks(range(len(rows)), labels)
    ax.set(ylim=(len(rows) - 0.5, -0.5), xlim=(0, 100), xlabel="share of corners (%)")
    style.outside_legend(fig, handles, columns=4)
    return style.settle(fig)
