"""Figures 2 to 7 of Tan et al. 2022 on our maps, and what the massive runs add to them."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import usvjax.missions.dwa.looks  # noqa: F401
from experiments.tan2022.episodes import Episodes, Plan, Results, obstacles, record
from experiments.tan2022.paired import Comparison
from experiments.tan2022.published import METHODS, RADII, TABLE4
from experiments.tan2022.readings import CASES
from experiments.tan2022.tables import Shown
from usvjax import plots
from usvjax.plots import style

DPI = 130
METRICS_DRAWN = ("time", "path_length")
_BAR: dict[str, Any] = {"markersize": 3.5, "elinewidth": 0.9, "capsize": 2}


def draw_maps(shown: Sequence[Shown], results: Results, name: str, folder: Path) -> list[Path]:
    """Draw the maps of Figs. 2 to 7 under one reading.

    Args:
        shown: the maps.
        results: of the episodes shown, for the legends.
        name: of the reading, for titles and file names.
        folder: to write to.

    Returns:
        The files, fig2_NAME.png to fig7_NAME.png.
    """
    chosen = [(run, entry.job) for entry in shown for run in entry.runs.values()]
    tracks = iter(record(chosen))
    files = []
    for entry in shown:
        trajectories = {method: next(tracks) for method in entry.runs}
        some_run = entry.runs["improved"]
        figure = plots.plot_paths(
            obstacles(some_run, entry.job),
            entry.case.radius,
            trajectories,
            trajectories["improved"][0, :2],
            some_run.source.goal,  # type: ignore[attr-defined]
            endings={m: _ending(results[run], entry.job) for m, run in entry.runs.items()},
            goal_tolerance=float(some_run.params.goal_tolerance),
            title=f"As Fig. {entry.figure}: rate {entry.case.rate:g}, map {entry.job}, {name}",
        )
        file = folder / f"fig{entry.figure}_{_slug(name)}.png"
        files.append(plots.save(figure, file, dpi=DPI))
    return files


def _ending(episodes: Episodes, job: int) -> plots.Ending:
    return plots.Ending(
        status=int(episodes.status[job]),
        time=float(episodes.time[job]),
        path_length=float(episodes.path_length[job]),
    )


def _slug(name: str) -> str:
    return "".join(letter if letter.isalnum() else "_" for letter in name)


def draw_paired(
    comparisons: Sequence[Comparison], results: Results, plan: Plan, folder: Path
) -> list[Path]:
    """Draw the distributions of every comparison, and the rates of every ending."""
    tables = [_table(comparison, results, plan) for comparison in comparisons]
    files = []
    labels = {i: f"r = {case.radius:g} m, rate {case.rate:g}" for i, case in enumerate(CASES)}
    for comparison, table in zip(comparisons, tables, strict=True):
        if plots.both_reached(table).is_empty():
            continue
        figure = plots.plot_distributions(
            table, labels=labels, metrics=METRICS_DRAWN, title=comparison.label
        )
        file = folder / f"distributions_{_slug(comparison.label)}.png"
        files.append(plots.save(figure, file, dpi=DPI))
    single = [i for i, c in enumerate(comparisons) if c.traditional == c.improved]
    shifted = [
        tables[i].with_columns(pl.col("condition") + place * len(CASES))
        for place, i in enumerate(single)
    ]
    names = {
        place * len(CASES) + j: f"{comparisons[i].label}\nr = {case.radius:g} m"
        for place, i in enumerate(single)
        for j, case in enumerate(CASES)
    }
    figure = plots.plot_success(pl.concat(shifted), labels=names, title="Paired maps")
    return [*files, plots.save(figure, folder / "endings.png", dpi=DPI)]


def _table(comparison: Comparison, results: Results, plan: Plan) -> pl.DataFrame:
    """Return the episodes of one comparison as plots want them."""
    frames = []
    for condition, case in enumerate(CASES):
        for method, episodes in comparison.episodes(results, plan, case).items():
            columns = {
                "job": np.arange(len(episodes.status)),
                "status": episodes.status,
                **{metric: getattr(episodes, metric) for metric in METRICS_DRAWN},
            }
            frames.append(
                pl.DataFrame(columns).with_columns(
                    pl.lit(condition).alias("condition"), pl.lit(method).alias("method")
                )
            )
    return pl.concat(frames)


@style.styled
def cap_figure(rows: Sequence[Mapping[str, Any]], caps: Mapping[str, str]) -> Figure:
    """Draw time ratio and success against the cap on dist, one column per radius.

    Args:
        rows: of `paired.sensitivities`.
        caps: label of a reading to its place on the axis, in the order wanted.

    Returns:
        The figure, 170 mm wide.
    """
    fig = style.new_figure(style.DOUBLE_MM, 105)
    axes = fig.subplots(2, len(RADII), sharex=True, sharey="row")
    for column, radius in enumerate(RADII):
        found = {r["reading"]: r for r in rows if r["radius"] == radius}
        chosen = [found[label] for label in caps if label in found]
        _draw_ratio(axes[0, column], chosen, column)
        _draw_success(axes[1, column], chosen)
        axes[0, column].set_title(f"r = {radius:g} m, rate {CASES[column].rate:g}")
        ticks = [caps[r["reading"]] for r in chosen]
        axes[1, column].set_xticks(range(len(ticks)), ticks)
        axes[1, column].set_xlim(-0.5, len(ticks) - 0.5)
        axes[1, column].set_xlabel("cap on dist (m)")
    for row in axes:
        # The columns share this axis, so only now is known how far it has to go.
        row[0].set_ylim(bottom=0.0)
    axes[0, 0].set_ylabel("time ratio,\nimproved / traditional")
    axes[1, 0].set_ylabel("success (%)")
    looks = style.method_looks(METHODS)
    handles = [style.method_handle(looks[method], f"{method}, success") for method in METHODS]
    handles.append(
        style.method_handle(style.Look(style.BLACK, "-", "D"), "time ratio, both succeed")
    )
    handles.append(
        style.method_handle(style.Look(style.VERMILLION, "--", ""), "published (Table 4)")
    )
    style.outside_legend(fig, handles, columns=2)
    return style.settle(fig)


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
