"""Figs. 2 and 16 of Yu et al. 2022, and what longer runs and moved optima add to them."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.claims import Numbers
from experiments.paper import Drawing
from experiments.runs import Found, Ran
from experiments.yu2022.functions.compare import PAIRS, law, linear_law
from experiments.yu2022.functions.mission import MARKS, iteration_at
from experiments.yu2022.functions.published import ITERATIONS, MEAN
from experiments.yu2022.functions.report import BUDGET, WORDS
from experiments.yu2022.functions.runs import label
from usvjax.plots import style
from usvkernels.swarms.functions import TABLE_8

_PUBLISHED_AT = 75  # place of the published values on an axis of iterations
_ZERO_BELOW = 0.12  # room below the least value for zeros, as a share of the decades above it
_LEAST_DECADE = -305.0  # of float64
LOOKS = {
    "aco": style.Look(style.ORANGE, "--", "s"),
    "ga": style.Look(style.GREEN, "-.", "^"),
    "cmpso": style.Look(style.PURPLE, ":", "d"),
    "gwo": style.Look(style.BLACK, "-", "o"),
    "igwo": style.Look(style.BLUE, "-", "v"),
}
_LAW_LOOKS = (
    style.Look(style.BLUE, "-", "v"),
    style.Look(style.SKY, "--", "s"),
    style.Look(style.GREEN, "-.", "^"),
    style.Look(style.PURPLE, ":", "d"),
    style.Look(style.ORANGE, "--", "o"),
)


def figures(found: Found, numbers: Numbers) -> Iterator[Drawing]:
    """Draw them all."""
    functions = numbers["functions"]
    yield Drawing(
        "fig2",
        "As Fig. 2: the convergence factor by Eq. 14 for several lambdas, and the linear law; "
        "right, the first iterations.",
        fig2(),
    )
    yield Drawing(
        "fig16",
        f"As Fig. 16: the mean of the least value so far, {numbers['runs']:,} runs of {BUDGET}.",
        fig16(found.studies["budget"], list(functions)),
    )
    yield Drawing(
        "function_budgets",
        "Mean least value against the number of iterations, beside the published means (open); a "
        "value of exactly 0 stands on the dotted line at the foot.",
        budgets(functions),
    )
    yield Drawing(
        "function_shift",
        f"Median least value of {numbers['runs']:,} runs with the optimum at the origin and "
        "elsewhere.",
        shift(functions),
    )


@style.styled
def fig2() -> Figure:
    """Eq. 14 for several lambdas, over all iterations and over the first."""
    fig = style.new_figure(style.DOUBLE_MM, 75)
    t = np.arange(ITERATIONS)
    axes = fig.subplots(1, 2, sharey=True)
    for ax in axes:
        ax.plot(t, linear_law(), color=style.BLACK, label="linear (Eq. 2)")
        for pair, look in zip(PAIRS, _LAW_LOOKS, strict=True):
            label = f"Eq. 14, \u03bb\u2081 = {pair[0]:g}, \u03bb\u2082 = {pair[1]:g}"
            ax.plot(t, law(pair), color=look.colour, linestyle=look.line, label=label)
        ax.axhline(1.0, color=style.GREY, linewidth=0.8)
        ax.set_xlabel("iteration t")
    axes[0].set_ylabel("convergence factor a(t)")
    axes[0].set_ylim(0, 2.5)
    axes[0].set_xlim(0, ITERATIONS)
    axes[1].set_xlim(0, 20)
    axes[1].set_xticks(range(0, 21, 5))
    axes[1].text(19.7, 1.03, "wide search above", ha="right", va="bottom", fontsize=7)
    style.outside_legend(fig, axes[0].get_legend_handles_labels()[0], columns=3)
    return style.settle(fig)


@style.styled
def fig16(ran: Ran, functions: list[str]) -> Figure:
    """Mean convergence of all five on every function."""
    fig, panels = _panels(len(functions))
    t = [iteration_at(mark, ITERATIONS) for mark in range(1, MARKS + 1)]
    for ax, function in zip(panels, functions, strict=True):
        for name, look in LOOKS.items():
            own = ran.columns(label(function, "budget"), name)
            means = [own[f"at_{mark}"].mean() for mark in range(1, MARKS + 1)]
            ax.plot(t, means, color=look.colour, linestyle=look.line)
        ax.set(yscale="log", xlabel="iteration", ylabel="least value so far, mean")
        style.plain_powers(ax.yaxis)
        ax.set_title(f"{function}, {TABLE_8[function].name}")
        ax.set_xlim(0, ITERATIONS)
    _legend(fig, marker=False)
    return style.settle(fig)


@style.styled
def budgets(found: Mapping[str, Any]) -> Figure:
    """Means against the number of iterations, and the published ones.

    Zeros, which a logarithmic axis has no place for, stand on a line of their own.
    """
    fig, panels = _panels(len(found))
    for ax, (function, own) in zip(panels, found.items(), strict=True):
        floor = _floor(function, own)
        for name, look in LOOKS.items():
            means = {ITERATIONS: own["budget"][name]["printed"]["mean"]}
            means |= {int(t): one["mean"] for t, one in own["longer"][name].items()}
            ax.plot(
                list(means),
                [mean or floor for mean in means.values()],
                color=look.colour,
                linestyle=look.line,
                marker=look.marker,
                markersize=3.5,
            )
            ax.plot(
                [_PUBLISHED_AT],
                [MEAN[function][name] or floor],
                color=look.colour,
                marker=look.marker,
                markersize=6,
                markerfacecolor="none",
                linestyle="none",
            )
        _budget_axes(ax, f"{function}, {TABLE_8[function].name}")
        if floor:
            _zero_line(ax, floor)
    _legend(fig, marker=True)
    return style.settle(fig)


def _floor(function: str, own: Mapping[str, Any]) -> float | None:
    """Where a logarithmic axis shows 0: well below all else; None where nothing is 0."""
    values = [*MEAN[function].values()]
    for name in LOOKS:
        values.append(own["budget"][name]["printed"]["mean"])
        values += [one["mean"] for one in own["longer"][name].values()]
    above = np.log10([value for value in values if value > 0])
    if len(above) == len(values):
        return None
    return float(10.0 ** max(above.min() - _ZERO_BELOW * np.ptp(above), _LEAST_DECADE))


def _zero_line(ax: Axes, floor: float) -> None:
    """Mark the place of 0, and no decade at it or below."""
    low, high = ax.get_ylim()
    ticks = [t for t in ax.get_yticks() if floor * 10 < t < high]
    labels = [f"1e{round(np.log10(t))}" for t in ticks]
    ax.axhline(floor, color=style.GREY, linestyle=":", linewidth=0.9, zorder=0)
    ax.set_yticks([floor, *ticks], ["0", *labels])
    ax.set_ylim(low, high)


def _budget_axes(ax: Axes, title: str) -> None:
    ax.set(xscale="log", yscale="log", xlabel="iterations", ylabel="least value, mean")
    style.plain_powers(ax.yaxis)
    ax.set_title(title)
    ticks = {_PUBLISHED_AT: "published", 200: "200", 500: "500", 1000: "1,000", 5000: "5,000"}
    ax.set_xlim(45, 6500)
    ax.set_xticks(list(ticks), list(ticks.values()))
    ax.minorticks_off()


@style.styled
def shift(found: Mapping[str, Any]) -> Figure:
    """Medians with the optimum at the origin and elsewhere, side by side."""
    fig, panels = _panels(len(found))
    for ax, (function, own) in zip(panels, found.items(), strict=True):
        order = list(own["moved"])
        for place, name in enumerate(order):
            look = LOOKS[name]
            ends = [own[kind][name]["all"]["median"] for kind in ("budget", "moved")]
            at = [place - 0.12, place + 0.12]  # beside one another, where the values are alike
            ax.plot(at, ends, color=look.colour, linewidth=0.8)
            ax.plot(at[:1], ends[:1], marker="o", color=look.colour, markerfacecolor="white")
            ax.plot(at[1:], ends[1:], marker="o", color=look.colour)
        ax.set_xticks(range(len(order)), [WORDS[name].split()[0] for name in order])
        ax.set_xlim(-0.5, len(order) - 0.5)
        ax.set(yscale="log", ylabel="least value, median")
        style.plain_powers(ax.yaxis)
        ax.set_title(f"{function}, {TABLE_8[function].name}")
    handles = [
        panels[0].plot([], [], marker="o", linestyle="none", color=style.BLACK, **face)[0]
        for face in (
            {"markerfacecolor": "white", "label": "optimum at the origin"},
            {"label": "optimum moved"},
        )
    ]
    style.outside_legend(fig, handles, columns=2)
    return style.settle(fig)


def _panels(count: int) -> tuple[Figure, list[Axes]]:
    columns = min(count, 2)
    rows = -(-count // columns)
    fig = style.new_figure(style.DOUBLE_MM, 15 + 58 * rows)
    axes = list(fig.subplots(rows, columns, squeeze=False).flat)
    for spare in axes[count:]:
        spare.remove()
    return fig, axes[:count]


def _legend(fig: Figure, marker: bool) -> None:
    handles = []
    for name, look in LOOKS.items():
        handle = style.method_handle(look, WORDS[name])
        if not marker:
            handle.set_marker("")
        handles.append(handle)
    style.outside_legend(fig, handles, columns=5)
