"""Distributions of time and path length, per condition and method."""

from collections.abc import Mapping, Sequence

import numpy as np
import polars as pl
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter
from numpy.typing import NDArray

from usvjax.checks import one_of
from usvjax.errors import BadInputError
from usvjax.plots import inputs, style
from usvjax.public import public
from usvkernels.status import Status

METRICS: dict[str, str] = {"time": "time to the goal (s)", "path_length": "path length (m)"}
AXIS_LABELS: dict[str, str] = {
    **METRICS,
    "mean_speed": "mean speed (m/s)",
    "min_clearance": "least clearance (m)",
}
MOST_ECDF_COLUMNS = 4
"""With more conditions than this, boxes side by side read better than curves."""
MARKS = ("median", "mean")
BOX_QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
BOXES = "boxes: quartiles and median, whiskers: 5th to 95th percentile"

_NEEDED = {
    "job": "number of the episode",
    "condition": "number of the condition",
    "method": "name of the method",
    "status": "how the episode ended",
}


@public()
def both_reached(table: pl.DataFrame, success: int = Status.REACHED) -> pl.DataFrame:
    """Keep the episodes in which every method of that condition reached the goal.

    Comparing times over episodes that only one method survived would compare different maps.

    Args:
        table: one row per (condition, method, job), columns job, condition, method, status.
        success: the status that counts as reached.

    Returns:
        The rows of those episodes, in the order they had.

    Raises:
        BadInputError: a column is missing.
    """
    inputs.check_table(table, _NEEDED)
    inputs.codes("success", [success])
    reached = pl.col("status") == int(success)
    methods = pl.col("method").n_unique().over("condition")
    return table.filter(reached.sum().over("condition", "job") == methods)


@public()
@style.styled
def plot_distributions(
    table: pl.DataFrame,
    *,
    labels: Mapping[int, str] | None = None,
    metrics: Sequence[str] = ("time", "path_length"),
    title: str | None = None,
    mark: str = "median",
) -> Figure:
    """Draw how metrics are distributed over the episodes in which all methods reached.

    Up to four conditions are drawn as cumulative curves, one column each, with a dot at the
    median or the mean; more are drawn as boxes (quartiles and median) with whiskers from the 5th
    to the 95th percentile. The axis ends at the 99th percentile of what is drawn, and says so
    where that cuts a tail.

    Args:
        table: one row per (condition, method, job) with columns job, condition, method,
            status and the metrics (SI units).
        labels: condition number to what it is, for titles.
        metrics: columns to draw, one row of axes each.
        title: title of the figure.
        mark: "median" or "mean", what curves are marked at.

    Returns:
        The figure, 170 mm wide; the number of episodes is written with every condition.

    Raises:
        BadInputError: a column is missing, another mark is asked for, or in no condition did all
            methods reach the goal.
    """
    inputs.titles(title=title)
    one_of("mark", mark, MARKS)
    labels = inputs.text_by("labels", labels)
    metrics = inputs.texts("metrics", metrics)
    inputs.check_table(table, dict.fromkeys(metrics, "a metric to draw"))
    kept = both_reached(table)
    if kept.is_empty():
        raise BadInputError("table has no episode in which every method reached the goal")
    conditions = sorted(table["condition"].unique().to_list())
    names = {c: labels.get(c, f"condition {c}") for c in conditions}
    methods = style.ordered_methods(table["method"].to_list())
    counts = {c: (_episodes(kept, c), _episodes(table, c)) for c in conditions}
    who = "both methods" if len(methods) == 2 else "every method" if methods[1:] else methods[0]
    head = f"{title}: " if title else ""
    caption = style.folded(f"{head}episodes in which {who} reached the goal", 100)
    if len(conditions) <= MOST_ECDF_COLUMNS:
        titles = {
            c: f"{style.folded(names[c], 26)}\nn = {reached:,} of {run:,}"
            for c, (reached, run) in counts.items()
        }
        fig, handles = _ecdf_grid(kept, titles, metrics, methods, mark)
    else:
        ticks = {c: f"{names[c]}, n={reached:,}/{run:,}" for c, (reached, run) in counts.items()}
        fig, handles = _box_rows(kept, ticks, metrics, methods)
        caption += f"\n({BOXES})"
    fig.suptitle(caption)
    style.outside_legend(fig, handles, columns=len(handles))
    return style.settle(fig)


def _episodes(table: pl.DataFrame, condition: int) -> int:
    return table.filter(pl.col("condition") == condition)["job"].n_unique()


def _values(table: pl.DataFrame, condition: int, method: str, metric: str) -> NDArray[np.float64]:
    rows = (pl.col("condition") == condition) & (pl.col("method") == method)
    values: NDArray[np.float64] = table.filter(rows)[metric].to_numpy().astype(float)
    return np.sort(values[np.isfinite(values)])


def _ecdf_grid(
    table: pl.DataFrame,
    titles: Mapping[int, str],
    metrics: Sequence[str],
    methods: Sequence[str],
    mark: str,
) -> tuple[Figure, list[Artist]]:
    # One condition stands with its metrics side by side, several have a row per metric.
    alone = len(titles) == 1
    fig = style.new_figure(style.DOUBLE_MM, 85 if alone else 20 + 48 * len(metrics))
    shape = (1, len(metrics)) if alone else (len(metrics), len(titles))
    axes = fig.subplots(*shape, squeeze=False, sharey=True)
    looks = style.method_looks(methods)
    for row, metric in enumerate(metrics):
        for column, condition in enumerate(titles):
            ax = axes[0, row] if alone else axes[row, column]
            samples = {m: _values(table, condition, m, metric) for m in methods}
            for method, sample in samples.items():
                _ecdf(ax, sample, looks[method], mark)
            _cut_tail(ax, list(samples.values()))
            ax.set(xlabel=AXIS_LABELS.get(metric, metric), ylim=(0, 1.02))
            if row == 0 or alone:
                ax.set_title(titles[condition])
    for ax in axes[:, 0]:
        ax.yaxis.set_major_formatter(PercentFormatter(xmax=1.0, symbol=""))
        ax.set_ylabel("episodes up to x (%)")
    handles: list[Artist] = [
        style.method_handle(look, f"{m} (mark: {mark})") for m, look in looks.items()
    ]
    return fig, handles


def _ecdf(ax: Axes, sample: NDArray[np.float64], look: style.Look, mark: str) -> None:
    if len(sample) == 0:
        return
    colour, line, marker = look
    share = np.arange(1, len(sample) + 1) / len(sample)
    ax.step(sample, share, where="post", color=colour, linestyle=line, zorder=look.zorder)
    x, y = np.median(sample), 0.5
    if mark == "mean":
        x = sample.mean()
        y = np.searchsorted(sample, x, side="right") / len(sample)
    ax.plot(x, y, color=colour, marker=marker, markersize=4, zorder=4)


def _cut_tail(ax: Axes, samples: Sequence[NDArray[np.float64]]) -> None:
    """End the axis at the 99th percentile of all samples, and say what lies beyond."""
    values = np.concatenate(samples)
    if len(values) == 0:
        ax.text(0.5, 0.5, "no such episode", transform=ax.transAxes, ha="center", va="center")
        return
    low, high, most = (float(x) for x in (*np.quantile(values, (0.0, 0.99)), values.max()))
    cut = most > high + 0.25 * (high - low)
    end = high if cut else most
    margin = 0.04 * (end - low) or 0.5
    ax.set_xlim(low - margin, end + margin)
    if cut:
        note = f"{(values > high).sum():,} beyond,\nup to {most:.4g}"
        ax.text(0.97, 0.05, note, transform=ax.transAxes, ha="right", va="bottom", fontsize=6.5)


def _box_rows(
    table: pl.DataFrame, titles: Mapping[int, str], metrics: Sequence[str], methods: Sequence[str]
) -> tuple[Figure, list[Artist]]:
    slanted = 30 if len(titles) > 8 else 0
    fig = style.new_figure(style.DOUBLE_MM, 25 + 52 * len(metrics) + slanted)
    axes = fig.subplots(len(metrics), 1, squeeze=False, sharex=True)[:, 0]
    looks = style.method_looks(methods)
    width = 0.8 / len(methods)
    for ax, metric in zip(axes, metrics, strict=True):
        for index, method in enumerate(methods):
            shift = (index - (len(methods) - 1) / 2) * width
            boxes = [
                (place + shift, _values(table, condition, method, metric))
                for place, condition in enumerate(titles)
            ]
            draw_boxes(ax, [b for b in boxes if len(b[1])], 0.85 * width, looks[method])
        ax.set_ylabel(AXIS_LABELS.get(metric, metric))
        ax.grid(visible=False, axis="x")
    names, how = style.tick_names(list(titles.values()), room=120)
    axes[-1].set_xticks(range(len(titles)), names, **how)
    handles: list[Artist] = [style.box_handle(looks[m], m) for m in methods]
    return fig, handles


def draw_boxes(
    ax: Axes, samples: Sequence[tuple[float, NDArray[np.float64]]], width: float, look: style.Look
) -> None:
    """Draw boxes: quartiles and median, whiskers from the 5th to the 95th percentile.

    The method's mark is at the median, so that boxes can be told apart in grey.

    Args:
        ax: axes to draw on.
        samples: place on x and values of each, at least one; none draws nothing.
        width: of a box.
        look: of the method.
    """
    if not samples:
        return
    keys = ("whislo", "q1", "med", "q3", "whishi")
    places = [place for place, _ in samples]
    stats = [dict(zip(keys, np.quantile(x, BOX_QUANTILES), strict=True)) for _, x in samples]
    ax.bxp(
        stats,
        positions=places,
        widths=width,
        showfliers=False,
        patch_artist=True,
        manage_ticks=False,
        boxprops={"facecolor": look.fill, "linewidth": 0.6},
        medianprops={"color": style.BLACK, "linewidth": 1.2},
        whiskerprops={"linewidth": 0.6},
        capprops={"linewidth": 0.6},
    )
    ax.plot(places, [one["med"] for one in stats], linestyle="", zorder=3, **look.mark)
