"""Rates of every ending against obstacle radius and obstacle rate, with Wilson intervals."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from usvjax.errors import BadInputError
from usvjax.plots import inputs, style
from usvjax.public import public
from usvjax.statistics import wilson
from usvkernels.status import EPISODE_ENDINGS, Status

CONFIDENCE = 0.95
MOST_FOLDED = 10
"""With more places on x than this, axes take the whole width."""

_NEEDED = {
    "condition": "number of the condition",
    "method": "name of the method",
    "status": "how the episode ended",
}


@public()
def wilson_rates(
    table: pl.DataFrame,
    *,
    confidence: float = CONFIDENCE,
    endings: Sequence[Status] = EPISODE_ENDINGS,
) -> pl.DataFrame:
    """Rates of every ending per condition and method, with Wilson's score interval.

    Args:
        table: one row per episode with columns condition, method and status.
        confidence: coverage of the interval.
        endings: those to count.

    Returns:
        A table with columns condition, method, status, k, n, rate, low, high: one row per
        condition, method and ending, endings that never happened included.

    Raises:
        BadInputError: a column is missing, the table or `endings` is empty, or a status is
            unknown.
    """
    for code in inputs.codes("endings", endings):
        style.status_name(code)
    inputs.share("confidence", confidence)
    inputs.check_table(table, _NEEDED)
    if table.is_empty():
        raise BadInputError("table is empty; at least one episode was wanted")
    for status in table["status"].unique().to_list():
        style.status_name(status)
    rows: list[dict[str, Any]] = []
    for (condition, method), group in table.group_by("condition", "method", maintain_order=True):
        n = len(group)
        for status in endings:
            k = int((group["status"] == int(status)).sum())
            share = wilson(k, n, confidence)
            rows.append(
                {
                    "condition": condition,
                    "method": method,
                    "status": int(status),
                    "k": k,
                    "n": n,
                    "rate": share.value,
                    "low": share.low,
                    "high": share.high,
                }
            )
    return pl.DataFrame(rows).sort("condition", "method", "status")


@dataclass(frozen=True)
class _Layout:
    """Where each condition is drawn: column of axes, place on x, and what stands below it."""

    column_titles: list[str]
    column: dict[int, int]
    place: dict[int, float]
    ticks: list[tuple[float, str]]
    x_label: str
    joined: bool

    @property
    def is_folded(self) -> bool:
        """Whether endings stand in pairs side by side rather than one above the other."""
        return len(self.column_titles) == 1 and len(self.ticks) <= MOST_FOLDED

    @property
    def room(self) -> int:
        """Letters of tick labels that fit below one of the axes."""
        return 120 // (2 if self.is_folded else len(self.column_titles))


@public()
@style.styled
def plot_success(
    table: pl.DataFrame,
    *,
    radius: Mapping[int, float] | None = None,
    rate: Mapping[int, float] | None = None,
    labels: Mapping[int, str] | None = None,
    confidence: float = CONFIDENCE,
    endings: Sequence[Status] = EPISODE_ENDINGS,
    methods: Sequence[str] | None = None,
    title: str | None = None,
) -> Figure:
    """Draw the rate of every ending, one row of axes each, with Wilson intervals.

    Where every radius was run at every obstacle rate, x is the radius and each obstacle rate
    has a column; otherwise the conditions stand side by side under their labels.

    Args:
        table: one row per episode with columns condition, method and status.
        radius: condition number to obstacle radius, m.
        rate: condition number to obstacle rate (share of cells), 1.
        labels: condition number to its label, used where radius and rate do not form a grid.
        confidence: coverage of every single interval.
        endings: those to draw, in this order.
        methods: those to draw, in this order, where they have rows; by default all.
        title: title of the figure.

    Returns:
        The figure, 170 mm wide.

    Raises:
        BadInputError: as `wilson_rates`, or none of `methods` has rows.
    """
    radius, rate = inputs.metres_by("radius", radius), inputs.metres_by("rate", rate)
    labels = inputs.text_by("labels", labels)
    inputs.titles(title=title)
    rates = wilson_rates(table, confidence=confidence, endings=endings)
    shown = _shown(rates["method"].to_list(), methods)
    rates = rates.filter(pl.col("method").is_in(shown))
    conditions = rates["condition"].unique().sort().to_list()
    layout = _layout(conditions, radius, rate, labels)
    fig, axes = _grid(layout, len(endings))
    for row, status in enumerate(endings):
        chosen = rates.filter(pl.col("status") == int(status))
        for column, name in enumerate(layout.column_titles):
            inside = [c for c in conditions if layout.column[c] == column]
            part = chosen.filter(pl.col("condition").is_in(inside))
            _draw_rates(axes[row, column], part, layout, shown)
            if row == 0 and len(layout.column_titles) > 1:
                axes[row, column].set_title(name)
        axes[row, 0].set_ylabel(f"{style.STATUS_LABEL[status]} (%)")
        _percent(axes[row], float(chosen["high"].max()))  # type: ignore[arg-type]
    n = sorted(set(rates["n"].to_list()))
    episodes = f"{n[0]:,}" if len(n) == 1 else f"{n[0]:,} to {n[-1]:,}"
    alone = layout.column_titles[0] if len(layout.column_titles) == 1 else ""
    head = "".join(f"{words}: " for words in (title, alone) if words)
    bars = f"bars: {100 * confidence:.4g} % Wilson intervals"
    fig.suptitle(f"{head}endings of {episodes} episodes per point\n({bars})")
    looks = style.method_looks(shown)
    handles = [
        style.method_handle(look, name, joined=layout.joined) for name, look in looks.items()
    ]
    style.outside_legend(fig, handles, columns=min(len(handles), 5))
    return style.settle(fig)


def _shown(there: Sequence[str], methods: Sequence[str] | None) -> list[str]:
    """The methods to draw, in their order."""
    if methods is None:
        return style.ordered_methods(there)
    shown = [name for name in inputs.texts("methods", methods) if name in there]
    if not shown:
        known = ", ".join(style.ordered_methods(there))
        raise BadInputError(f"methods is {list(methods)}; the table has {known}")
    return shown


def _grid(layout: _Layout, endings: int) -> tuple[Figure, Any]:
    """Return a figure and its axes[ending, column]; a short single column is folded in two."""
    columns = len(layout.column_titles)
    if layout.is_folded:
        rows = -(-endings // 2)
        fig = style.new_figure(style.DOUBLE_MM, 25 + 45 * rows)
        axes = fig.subplots(rows, 2, squeeze=False, sharex=True).reshape(2 * rows, 1)
        for ax in axes[endings:, 0]:
            ax.remove()
        axes = axes[:endings]
        lowest = axes[-2:, 0]
    else:
        fig = style.new_figure(style.DOUBLE_MM, (25 if layout.joined else 50) + 35 * endings)
        axes = fig.subplots(endings, columns, squeeze=False, sharex=True, sharey="row")
        lowest = axes[-1]
    for ax in lowest:
        # Where nothing stands below, though it is not the last row.
        ax.tick_params(labelbottom=True)
        ax.set_xlabel(layout.x_label)
    return fig, axes


def _layout(
    conditions: Sequence[int],
    radius: Mapping[int, float],
    rate: Mapping[int, float],
    labels: Mapping[int, str],
) -> _Layout:
    pairs = {(radius[c], rate[c]) for c in conditions if c in radius and c in rate}
    radii, shares = sorted({p[0] for p in pairs}), sorted({p[1] for p in pairs})
    full = len(pairs) == len(conditions) == len(radii) * len(shares)
    if full and len(radii) > 1:
        return _Layout(
            column_titles=[f"obstacle rate {share:g}" for share in shares],
            column={c: shares.index(rate[c]) for c in conditions},
            place={c: radius[c] for c in conditions},
            ticks=[(r, f"{r:g}") for r in radii],
            x_label="obstacle radius r (m)",
            joined=True,
        )
    names = [labels.get(c, f"condition {c}") for c in conditions]
    return _Layout(
        column_titles=[""],
        column=dict.fromkeys(conditions, 0),
        place={c: float(i) for i, c in enumerate(conditions)},
        ticks=[(float(i), name) for i, name in enumerate(names)],
        x_label="condition",
        joined=False,
    )


def _draw_rates(ax: Axes, rates: pl.DataFrame, layout: _Layout, methods: Sequence[str]) -> None:
    places = sorted(tick for tick, _ in layout.ticks)
    gap = min(np.diff(places), default=1.0)
    for index, method in enumerate(methods):
        part = rates.filter(pl.col("method") == method)
        where = np.array([layout.place[c] for c in part["condition"].to_list()])
        # Methods stand a little apart so that their intervals do not cover each other.
        where = where + (index - (len(methods) - 1) / 2) * 0.12 * gap
        order = np.argsort(where)
        value, low, high = (part[name].to_numpy()[order] for name in ("rate", "low", "high"))
        colour, line, marker = style.method_looks(methods)[method]
        ax.errorbar(
            where[order],
            value,
            yerr=np.maximum([value - low, high - value], 0),
            color=colour,
            linestyle=line if layout.joined else "",
            linewidth=1.1,
            marker=marker,
            markersize=3.5,
            elinewidth=0.9,
            capsize=2,
        )
    ax.set_xlim(places[0] - 0.5 * gap, places[-1] + 0.5 * gap)
    names, how = style.tick_names([name for _, name in sorted(layout.ticks)], layout.room)
    ax.set_xticks(places, names, **how)


def _percent(axes: Any, most: float) -> None:
    """Scale one row of axes from 0 to what it needs, in per cent."""
    top = min(1.0, max(1.15 * most, 0.02))
    for ax in axes:
        ax.set_ylim(-0.03 * top, 1.04 * top)
        ax.yaxis.set_major_formatter(lambda share, _: f"{100 * share:g}")
