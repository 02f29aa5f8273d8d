"""How methods compare: the share of successes, and boxes of some metrics."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from usvjax.errors import BadInputError
from usvjax.mission import MOST_CONDITIONS
from usvjax.plots import inputs, style
from usvjax.plots.distributions import BOXES, both_reached, draw_boxes
from usvjax.statistics import wilson
from usvkernels.status import Status

MOST_ON_A_PAGE = 6
"""Conditions of one figure; a study with more has several."""


class Panel(NamedTuple):
    """One panel of boxes: a column, what it is, and how it is best read."""

    column: str
    label: str
    logarithmic: bool = False
    scale: float = 1.0


class Comparison(NamedTuple):
    """How methods compare: what counts as success, three panels, and what the boxes are over."""

    success: Status
    panels: tuple[Panel, Panel, Panel]
    what: str


def method_pages(
    table: pl.DataFrame,
    methods: Sequence[str],
    *,
    compared: Comparison,
    labels: Mapping[int, str],
    confidence: float,
    title: str,
) -> Iterator[tuple[str, Figure]]:
    """Yield (name, figure) of how methods compare, a few conditions in each; see `plot_methods`.

    Of more conditions than a reader can take in there is none, but an overview in their place.
    """
    conditions = table["condition"].unique().sort().to_list()
    if len(conditions) > MOST_CONDITIONS:
        return
    for page, first in enumerate(range(0, len(conditions), MOST_ON_A_PAGE), start=1):
        chosen = conditions[first : first + MOST_ON_A_PAGE]
        fig = plot_methods(
            table.filter(pl.col("condition").is_in(chosen)),
            methods,
            compared=compared,
            labels=labels,
            confidence=confidence,
            title=title,
        )
        yield ("methods" if page == 1 else f"methods-{page}"), fig


@style.styled
def plot_methods(
    table: pl.DataFrame,
    methods: Sequence[str],
    *,
    compared: Comparison,
    labels: Mapping[int, str] | None = None,
    confidence: float = 0.95,
    title: str | None = None,
) -> Figure:
    """Draw how methods compare: the share of successes, and boxes of three metrics.

    Args:
        table: one row per (condition, method, job) with columns job, condition, method, status
            and the metrics that are compared.
        methods: methods, in the order of the figure.
        compared: what counts as success and which metrics are drawn.
        labels: condition number to what it is.
        confidence: coverage of the intervals of the share of successes.
        title: title of the figure.

    Returns:
        The figure, 170 mm wide. Boxes (quartiles, median, whiskers from the 5th to the 95th
        percentile) are over the jobs in which every method succeeded.

    Raises:
        BadInputError: a column is missing or the table is empty.
    """
    wanted = {panel.column: "a metric to draw" for panel in compared.panels}
    inputs.check_table(table, wanted)
    if table.is_empty():
        raise BadInputError("table is empty; at least one query was wanted")
    kept = both_reached(table, compared.success)
    conditions = table["condition"].unique().sort().to_list()
    names = [(labels or {}).get(c, f"condition {c}") for c in conditions]
    places = _places(conditions, methods)
    fig = style.new_figure(style.DOUBLE_MM, 130)
    axes = fig.subplots(2, 2).reshape(-1)
    looks = style.method_looks(methods)
    for ax, (column, words, logarithmic, scale) in zip(axes[1:], compared.panels, strict=True):
        for method in methods:
            samples = [
                (places[condition, method], scale * _values(kept, condition, method, column))
                for condition in conditions
            ]
            filled = [(x, values) for x, values in samples if len(values)]
            draw_boxes(ax, filled, 0.68 / len(methods), looks[method])
        ax.set(ylabel=words, yscale="log" if logarithmic else "linear")
        if logarithmic:
            style.plain_powers(ax.yaxis)
    _draw_shares(axes[0], table, compared.success, places, looks, confidence)
    alone = len(conditions) == 1
    ticks, how = style.tick_names(list(methods) if alone else names, room=60)
    solved = [kept.filter(pl.col("condition") == c)["job"].n_unique() for c in conditions]
    numbered, how_numbered = style.tick_names(
        [f"{name}\nn = {n:,}" for name, n in zip(names, solved, strict=True)], room=60
    )
    at = [places[conditions[0], m] for m in methods] if alone else list(range(len(names)))
    for ax in axes:
        ax.set_xticks(at, ticks, **how)
        if not alone and ax is not axes[0]:
            ax.set_xticks(at, numbered, **how_numbered)
        ax.set_xlim(-0.5, len(names) - 0.5)
        ax.grid(visible=False, axis="x")
    fig.suptitle(_caption(title, kept, table, compared.what, alone))
    if not alone:
        handles = [style.box_handle(looks[m], m) for m in methods]
        style.outside_legend(fig, handles, columns=min(len(handles), 5))
    return style.settle(fig)


def _places(conditions: Sequence[int], methods: Sequence[str]) -> dict[tuple[int, str], float]:
    """Where each condition and method stands on x: methods side by side at every condition."""
    return {
        (condition, method): place + ((index + 0.5) / len(methods) - 0.5) * 0.8
        for place, condition in enumerate(conditions)
        for index, method in enumerate(methods)
    }


def _caption(
    title: str | None, kept: pl.DataFrame, table: pl.DataFrame, what: str, alone: bool
) -> str:
    """What the boxes are over; of several conditions, the numbers stand below each."""
    head = f"{title}: " if title else ""
    total = max(part["job"].n_unique() for part in table.partition_by("condition"))
    if alone:
        n = kept["job"].n_unique()
        return f"{head}boxes over the {n:,} of {total:,} {what}\n({BOXES})"
    return f"{head}boxes over the n of {total:,} {what}\n({BOXES})"


def _values(table: pl.DataFrame, condition: int, method: str, column: str) -> NDArray[np.float64]:
    mine = (pl.col("condition") == condition) & (pl.col("method") == method)
    values: NDArray[np.float64] = table.filter(mine)[column].to_numpy().astype(float)
    return values[np.isfinite(values)]


def _draw_shares(
    ax: Axes,
    table: pl.DataFrame,
    success: Status,
    places: Mapping[tuple[int, str], float],
    looks: Mapping[str, style.Look],
    confidence: float,
) -> None:
    """Draw the share of successes, with Wilson intervals."""
    for (condition, method), place in places.items():
        mine = (pl.col("condition") == condition) & (pl.col("method") == method)
        status = table.filter(mine)["status"].to_numpy()
        share = wilson(int((status == success).sum()), len(status), confidence)
        value, low, high = 100.0 * np.array([share.value, share.low, share.high], dtype=float)
        ax.errorbar(
            place,
            value,
            yerr=np.maximum([[value - low], [high - value]], 0.0),
            color=looks[method].colour,
            linestyle="",
            marker=looks[method].marker,
            markersize=3.5,
            elinewidth=0.9,
            capsize=2,
        )
    words = f"{style.STATUS_LABEL[success]} (%), {100 * confidence:.4g} % intervals"
    ax.set(ylabel=words, ylim=(0, 104))
