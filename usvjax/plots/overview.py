"""The success rate over everything that a study varies, where it has many conditions."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from usvjax.checks import shown
from usvjax.errors import BadInputError, BadTypeError
from usvjax.plots import inputs, style
from usvjax.public import public
from usvjax.statistics import wilson

ENDS = 6
"""Conditions of either end of a ranking that are named."""

_MAP = "cividis"
_MOST_WRITTEN = 150  # squares of a heat map that hold their number
_MOST_ACROSS = 3  # heat maps side by side

_NEEDED = {
    "condition": "number of the condition",
    "method": "name of the method",
    "status": "how the episode ended",
}

Float = NDArray[np.float64]


@dataclass(frozen=True)
class _Rates:
    """Successes by condition and method, int[C, M], and what there is of each."""

    conditions: list[int]
    methods: list[str]
    count: NDArray[np.int64]
    episodes: NDArray[np.int64]

    @property
    def percent(self) -> Float:
        """float[C, M]; NaN where nothing was run."""
        return 100.0 * self.count / np.where(self.episodes > 0, self.episodes, np.nan)

    def interval(self, row: int, method: int, level: float) -> tuple[float, float]:
        """Wilson's interval, in %."""
        found = wilson(int(self.count[row, method]), int(self.episodes[row, method]), level)
        if found.low is None or found.high is None:
            return np.nan, np.nan
        return 100.0 * found.low, 100.0 * found.high


@public()
@style.styled
def plot_overview(
    table: pl.DataFrame,
    varied: Mapping[int, Mapping[str, object]],
    *,
    success: int,
    methods: Sequence[str],
    labels: Mapping[int, str],
    words: str = "success",
    units: Mapping[str, str] | None = None,
    confidence: float = 0.95,
    title: str | None = None,
) -> Figure:
    """Draw the success rate of every condition and method.

    Over one key that varies it is a line, over two that are crossed a heat map per method; of
    more, conditions are ranked by the success rate of their best method, and the ends are named.

    Args:
        table: one row per episode with columns condition, method and status.
        varied: condition number to what tells it apart, by dotted key.
        success: the status that counts.
        methods: methods, in the order of the figure.
        labels: condition number to its label.
        words: what success is called.
        units: of keys that have one.
        confidence: coverage of every interval.
        title: title of the figure.

    Returns:
        The figure, 170 mm wide.

    Raises:
        BadInputError: a column is missing, or the table is empty.
    """
    inputs.check_table(table, _NEEDED)
    if table.is_empty():
        raise BadInputError("table is empty; at least one episode was wanted")
    methods = inputs.texts("methods", methods)
    labels, units = inputs.text_by("labels", labels), inputs.text_by("units", units)
    inputs.titles(words=words, title=title)
    inputs.share("confidence", confidence)
    inputs.codes("success", [success])
    rates = _rates(table, success, methods)
    _check_told(rates, varied, labels)
    values = {c: {k: _plain(v) for k, v in varied[c].items()} for c in rates.conditions}
    keys = [
        key
        for key in dict.fromkeys(k for one in values.values() for k in one)
        if len({one.get(key) for one in values.values()}) > 1
    ]
    values = {c: {key: one.get(key) for key in keys} for c, one in values.items()}
    names = {key: _named(key, units.get(key)) for key in keys}
    bars = f"bars: {100 * confidence:.4g} % Wilson intervals"
    crossed = _are_crossed(values, keys)
    if len(keys) == 1 and crossed:
        fig = _lines(rates, [values[c][keys[0]] for c in rates.conditions], confidence)
        fig.axes[0].set(xlabel=names[keys[0]], ylabel=f"{words} (%)")
    elif len(keys) == 2 and crossed:
        fig, bars = _heat(rates, values, keys, names, words), "darker is less"
    else:
        fig = _ranked(rates, labels, confidence)
        fig.axes[0].set(xlabel="rank, by the best method", ylabel=f"{words} (%)")
        fig.axes[1].set(xlabel=f"{words} (%)")
        bars = f"below: the {ENDS} best and the {ENDS} worst; {bars}"
    n = sorted(set(rates.episodes[rates.episodes > 0].tolist()))
    each = f"{n[0]:,}" if len(n) == 1 else f"{n[0]:,} to {n[-1]:,}"
    head = f"{title}: " if title else ""
    count = f"{len(rates.conditions):,} conditions of {each} episodes"
    fig.suptitle(f"{head}{words} in {count}\n({bars})")
    if len(keys) != 2 or not crossed:
        looks = style.method_looks(methods)
        joined = len(keys) == 1 and crossed
        handles = [style.method_handle(look, n, joined=joined) for n, look in looks.items()]
        style.outside_legend(fig, handles, columns=min(len(handles), 5))
    return style.settle(fig)


def _check_told(
    rates: _Rates, varied: Mapping[int, Mapping[str, object]], labels: Mapping[int, str]
) -> None:
    """Check what tells conditions apart, and whether anything was run."""
    if not rates.episodes.any():
        raise BadInputError(f"methods is {shown(rates.methods)}, of which the table has none")
    inputs.keys_of("varied", varied, rates.conditions)
    inputs.keys_of("labels", labels, rates.conditions)
    for condition in rates.conditions:
        told = varied[condition]
        if not isinstance(told, Mapping) or not all(map(inputs.is_setting, told.values())):
            raise BadTypeError(
                f"varied[{condition}]: got {shown(told)}; wanted settings of a study by key"
            )
        inputs.by_name(f"varied[{condition}]", told)


def _rates(table: pl.DataFrame, success: int, methods: list[str]) -> _Rates:
    counted = table.group_by("condition", "method").agg(
        n=pl.len(), k=(pl.col("status") == int(success)).sum()
    )
    conditions = table["condition"].unique().sort().to_list()
    row = {condition: i for i, condition in enumerate(conditions)}
    count = np.zeros((len(conditions), len(methods)), np.int64)
    episodes = np.zeros_like(count)
    for condition, method, n, k in counted.iter_rows():
        if method in methods:
            place = row[condition], methods.index(method)
            count[place], episodes[place] = k, n
    return _Rates(conditions, methods, count, episodes)


def _plain(value: object) -> Hashable:
    """A value as something to compare; lists are told by their text."""
    return value if isinstance(value, int | float | str) else str(value)


def _named(key: str, unit: str | None) -> str:
    return f"{key} ({unit})" if unit else key


def _are_crossed(values: Mapping[int, Mapping[str, Hashable]], keys: Sequence[str]) -> bool:
    """Whether every combination of the values of some keys is there once."""
    places = {tuple(one.get(key) for key in keys) for one in values.values()}
    full = np.prod([len({place[i] for place in places}) for i in range(len(keys))])
    return len(places) == len(values) == full


def _scale(values: Sequence[Hashable]) -> list[Hashable]:
    """Different values: numbers in their order, words as they come."""
    found = list(dict.fromkeys(values))
    return sorted(found, key=float) if _are_numbers(found) else found  # type: ignore[arg-type]


def _are_numbers(values: Sequence[Hashable]) -> bool:
    return all(
        isinstance(v, int | float) and not isinstance(v, bool) and np.isfinite(v) for v in values
    )


def _text(value: Hashable) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _lines(rates: _Rates, values: Sequence[Hashable], level: float) -> Figure:
    fig = style.new_figure(style.DOUBLE_MM, 100)
    ax = fig.subplots()
    scale = _scale(values)
    numbers = _are_numbers(scale)
    where = np.array([v if numbers else scale.index(v) for v in values], float)
    order = np.argsort(where)
    gap = float(np.diff(np.sort(where)).min())
    for index, look in enumerate(style.method_looks(rates.methods).values()):
        # Methods stand a little apart so that their intervals do not cover each other.
        shift = (index - (len(rates.methods) - 1) / 2) * 0.12 * gap
        _bars(ax, where[order] + shift, rates, order, index, level, look)
    if not numbers:
        ticks, how = style.tick_names([_text(v) for v in scale], room=120)
        ax.set_xticks(range(len(scale)), ticks, **how)
    ax.set_ylim(-3, 104)
    return fig


def _bars(
    ax: Axes,
    where: Float,
    rates: _Rates,
    rows: NDArray[np.int64],
    method: int,
    level: float,
    look: style.Look,
) -> None:
    """Success rates with their intervals, from left to right."""
    value = rates.percent[rows, method]
    low, high = np.array([rates.interval(int(row), method, level) for row in rows]).T
    ax.errorbar(
        where,
        value,
        yerr=np.maximum([value - low, high - value], 0.0),
        color=look.colour,
        linestyle=look.line,
        linewidth=1.1,
        marker=look.marker,
        markersize=3.5,
        elinewidth=0.9,
        capsize=2,
    )


def _heat(
    rates: _Rates,
    values: Mapping[int, Mapping[str, Hashable]],
    keys: Sequence[str],
    names: Mapping[str, str],
    words: str,
) -> Figure:
    scales = {key: _scale([one[key] for one in values.values()]) for key in keys}
    across, up = sorted(keys, key=lambda key: -len(scales[key]))
    wide = min(len(rates.methods), _MOST_ACROSS)
    high = -(-len(rates.methods) // wide)
    fig = style.new_figure(style.DOUBLE_MM, 30 + 70 * high)
    axes = fig.subplots(high, wide, squeeze=False, sharex=True, sharey=True)
    shape = len(scales[up]), len(scales[across])
    for index, ax in enumerate(axes.flat):
        if index >= len(rates.methods):
            ax.remove()
            continue
        squares = np.full(shape, np.nan)
        for row, condition in enumerate(rates.conditions):
            one = values[condition]
            place = scales[up].index(one[up]), scales[across].index(one[across])
            squares[place] = rates.percent[row, index]
        image = ax.imshow(squares, origin="lower", aspect="auto", cmap=_MAP, vmin=0.0, vmax=100.0)
        if squares.size * wide <= _MOST_WRITTEN:
            for (y, x), value in np.ndenumerate(squares):
                colour = style.BLACK if value > 55 else "#FFFFFF"
                ax.text(x, y, f"{value:.0f}", ha="center", va="center", color=colour, fontsize=6)
        ax.set_title(rates.methods[index])
        ax.grid(visible=False)
        _ticks(ax, scales[across], scales[up], 110 // wide)
        ax.set_xlabel(names[across])
        if index % wide == 0:
            ax.set_ylabel(names[up])
    fig.colorbar(image, ax=axes, label=f"{words} (%)", shrink=0.9)
    return fig


def _ticks(ax: Axes, across: list[Hashable], up: list[Hashable], room: int) -> None:
    every = max(1, -(-len(across) // 20))
    names, how = style.tick_names([_text(v) for v in across[::every]], room)
    ax.set_xticks(range(0, len(across), every), names, **how)
    every = max(1, -(-len(up) // 20))
    ax.set_yticks(range(0, len(up), every), [_text(v) for v in up[::every]])


def _ranked(rates: _Rates, labels: Mapping[int, str], level: float) -> Figure:
    percent = rates.percent
    order = np.argsort(-np.nanmax(percent, axis=1), kind="stable")
    fig = style.new_figure(style.DOUBLE_MM, 165)
    above, below = fig.subplots(2, 1, height_ratios=(1.0, 1.3))
    rank = np.arange(1, len(order) + 1)
    named = [*range(len(order))]
    if len(order) > 2 * ENDS:
        named = named[:ENDS] + named[-ENDS:]
    looks = style.method_looks(rates.methods)
    for index, look in enumerate(looks.values()):
        above.plot(
            rank, percent[order, index], look.marker, color=look.colour, markersize=2, alpha=0.7
        )
        for line, place in enumerate(named):
            row = int(order[place])
            value = percent[row, index]
            low, high = rates.interval(row, index, level)
            shift = (index - (len(looks) - 1) / 2) * 0.5 / len(looks)
            below.errorbar(
                value,
                line + shift,
                xerr=np.maximum([[value - low], [high - value]], 0.0),
                color=look.colour,
                marker=look.marker,
                markersize=3.5,
                elinewidth=0.9,
                capsize=1.5,
            )
    above.set(ylim=(-3, 104), xlim=(0, len(order) + 1))
    texts = [f"{place + 1:,}. {labels[rates.conditions[order[place]]]}" for place in named]
    below.set_yticks(range(len(named)), [style.folded(text, 50) for text in texts], fontsize=6)
    below.set(xlim=(-3, 104))
    below.invert_yaxis()
    if len(named) < len(order):
        below.axhline(ENDS - 0.5, color=style.GREY, linewidth=0.8, linestyle=":")
    return fig
