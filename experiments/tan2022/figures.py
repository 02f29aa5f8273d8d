"""Figures 2 to 7 of Tan et al. 2022 on our maps, and what the massive runs add to them."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import usvjax.missions.dwa.looks  # noqa: F401
from experiments.claims import Numbers
from experiments.paper import Drawing
from experiments.runs import Found
from experiments.tan2022.episodes import Pair, Sailed
from experiments.tan2022.measures import HYBRID, SHOWN, pairs_of
from experiments.tan2022.published import METHODS, RADII, TABLE4
from experiments.tan2022.readings import (
    ALONG_DEMO,
    ALONG_PRESET,
    CAPS,
    CASES,
    DEMO,
    MAIN,
    PRESET,
    Reading,
)
from experiments.tan2022.tables import Pairs, Shown, one_map, three_maps
from usvjax import plots
from usvjax.plots import style

METRICS_DRAWN = ("time", "path_length")
_BAR: dict[str, Any] = {"markersize": 3.5, "elinewidth": 0.9, "capsize": 2}


def figures(found: Found, numbers: Numbers) -> Iterator[Drawing]:
    """Draw all figures of the page."""
    sailed = Sailed(found)
    for reading in SHOWN:
        pairs = pairs_of(sailed, reading)
        for shown in (*one_map(pairs), *three_maps(pairs)):
            yield _as_printed(sailed, reading, shown)
    full = (*MAIN, ALONG_PRESET, ALONG_DEMO)
    compared = {reading.label: pairs_of(sailed, reading) for reading in full}
    compared[HYBRID] = pairs_of(sailed, DEMO, PRESET)
    for label, pairs in compared.items():
        yield from _distributions(label, pairs)
    del compared[HYBRID]  # made of episodes that are there already
    yield Drawing(
        "endings",
        "How the paired episodes ended under the readings whose numbers are given in full.",
        _endings(compared),
    )
    yield Drawing(
        "cap",
        "Ratio of the mean times and success against the cap on dist, with 95 % intervals; n is "
        "the number of maps that a ratio rests on. Published: the ratio of Table 4's averages.",
        cap_figure(numbers["sensitivities"], CAPS),
    )


def _as_printed(sailed: Sailed, reading: Reading, shown: Shown) -> Drawing:
    """One map in the layout of the paper's figure."""
    replayed = {m: sailed.replay(reading, shown.case, m, [shown.job]) for m in METHODS}
    some = replayed["improved"]
    ground, tolerance = some.recording.grounds[0], some.scene.params.goal_tolerance
    figure = plots.plot_paths(
        ground.circles,
        ground.radius,
        {method: one.recording.tracks[0].places[:, 0] for method, one in replayed.items()},
        ground.marks["start"][0],
        ground.marks["goal"][0],
        endings={
            method: plots.Ending(
                status=int(one.columns["status"][0]),
                time=float(one.columns["time"][0]),
                path_length=float(one.columns["path_length"][0]),
            )
            for method, one in replayed.items()
        },
        goal_tolerance=float(tolerance),
        title=f"As Fig. {shown.figure}: rate {shown.case.rate:g}, {reading.label}",
    )
    return Drawing(
        f"fig{shown.figure}_{_slug(reading.label)}",
        f'As Fig. {shown.figure}, under "{reading.label}": obstacles of r = '
        f"{shown.case.radius:g} m at rate {shown.case.rate:g}, map {shown.job}, the first of the "
        "sequence that both methods cross.",
        figure,
    )


def _slug(name: str) -> str:
    return "".join(letter if letter.isalnum() else "_" for letter in name)


def _distributions(label: str, pairs: Pairs) -> Iterator[Drawing]:
    """Time and length on the maps that both cross; nothing where there is none."""
    table = _table([pairs[case] for case in CASES])
    if plots.both_reached(table).is_empty():
        return
    labels = {i: f"r = {case.radius:g} m, rate {case.rate:g}" for i, case in enumerate(CASES)}
    yield Drawing(
        f"distributions_{_slug(label)}",
        f'Time and path length under "{label}" on the maps where both methods succeed.',
        plots.plot_distributions(
            table, labels=labels, metrics=METRICS_DRAWN, title=label, mark="mean"
        ),
    )


def _endings(compared: Mapping[str, Pairs]) -> Figure:
    """The rates of every ending, reading by reading."""
    short = [label.replace(" the trajectory", "") for label in compared]
    names = [f"{label}\nr = {case.radius:g} m" for label in short for case in CASES]
    table = _table([pairs[case] for pairs in compared.values() for case in CASES])
    return plots.plot_success(table, labels=dict(enumerate(names)), title="Paired maps")


def _table(conditions: Sequence[Pair]) -> pl.DataFrame:
    """Episodes as plots want them."""
    return pl.concat(
        pl.DataFrame(
            {
                "job": np.arange(len(episodes.status)),
                "status": episodes.status,
                **{metric: getattr(episodes, metric) for metric in METRICS_DRAWN},
            }
        ).with_columns(pl.lit(condition).alias("condition"), pl.lit(method).alias("method"))
        for condition, pair in enumerate(conditions)
        for method, episodes in pair.items()
    )


@style.styled
def cap_figure(rows: Sequence[Mapping[str, Any]], caps: Mapping[str, str]) -> Figure:
    """Draw time ratio and success against the cap on dist, one column per radius.

    Args:
        rows: of the sensitivities.
        caps: label of a reading to its place on the axis, in the order wanted.

    Returns:
        The figure, 170 mm wide.
    """
    fig = style.new_figure(style.DOUBLE_MM, 105)
    axes = fig.subplots(2, len(RADII), sharex=True, sharey="row")
    for column, radius in enumerate(RADII):
        found = {row["reading"]: row for row in rows if row["radius"] == radius}
        chosen = [found[label] for label in caps if label in found]
        _draw_ratio(axes[0, column], chosen, column)
        _draw_success(axes[1, column], chosen)
        axes[0, column].set_title(f"r = {radius:g} m, rate {CASES[column].rate:g}")
        ticks = [caps[r["reading"]] for r in chosen]
        axes[1, column].set_xticks(range(len(ticks)), ticks)
        axes[1, column].set_xlim(-0.5, len(ticks) - 0.5)
        axes[1, column].set_xlabel("cap on dist (m; 2r: twice the radius)")
    for row in axes:
        # The columns share this axis, so only now is known how far it has to go.
        row[0].set_ylim(bottom=0.0)
    axes[0, 0].set_ylabel("time ratio,\nimproved / traditional")
    axes[1, 0].set_ylabel("success (%)")
    looks = style.method_looks(METHODS)
    handles = [
        _mark(looks[method].colour, looks[method].marker, f"{method}, success")
        for method in METHODS
    ]
    handles.append(_mark(style.BLACK, "D", "time ratio, both succeed"))
    handles.append(
        style.method_handle(style.Look(style.VERMILLION, "--", ""), "published (Table 4)")
    )
    style.outside_legend(fig, handles, columns=2)
    return style.settle(fig)


def _mark(colour: str, marker: str, label: str) -> Line2D:
    """A legend's handle of what is drawn as marks without lines."""
    return Line2D([], [], color=colour, marker=marker, linestyle="", markersize=4, label=label)


def _draw_ratio(ax: Axes, rows: Sequence[Mapping[str, Any]], place: int) -> None:
    """Mark each ratio with its interval, and how many maps it rests on."""
    for x, row in enumerate(rows):
        ratio = row["time_ratio"]
        if ratio["value"] is not None:
            ends = [ratio["low"], ratio["high"]]
            spread = None
            if None not in ends:
                spread = np.abs(np.subtract(ends, ratio["value"]))[:, None]
            ax.errorbar([x], [ratio["value"]], yerr=spread, color=style.BLACK, marker="D", **_BAR)
        ax.annotate(
            f"n={row['both']}",
            (x, 0.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            fontsize=6,
        )
    old, new = (TABLE4.values[method, "time"][place] for method in METHODS)
    ax.axhline(new / old, color=style.VERMILLION, linestyle="--", linewidth=1.0)
    ax.axhline(1.0, color=style.GREY, linewidth=0.6)


def _draw_success(ax: Axes, rows: Sequence[Mapping[str, Any]]) -> None:
    """Success of both methods with Wilson intervals, side by side."""
    looks = style.method_looks(METHODS)
    for shift, method in zip((-0.08, 0.08), METHODS, strict=True):
        rates = [row["endings"][method]["REACHED"] for row in rows]
        value, low, high = (
            100.0 * np.array([rate[key] for rate in rates]) for key in ("value", "low", "high")
        )
        ax.errorbar(
            np.arange(len(rows)) + shift,
            value,
            yerr=np.maximum([value - low, high - value], 0.0),
            color=looks[method].colour,
            marker=looks[method].marker,
            linestyle="",
            **_BAR,
        )
