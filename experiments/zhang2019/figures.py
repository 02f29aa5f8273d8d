"""Figs. 9 and 10 of Zhang et al. 2019 on a map of ours, and what many maps add to them."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from experiments.claims import Numbers
from experiments.grid_figures import draw_path, end_handles, paint_cells
from experiments.paper import Drawing
from experiments.runs import Found
from experiments.zhang2019.compare import SAVED, WINDOWS, alike, paths
from experiments.zhang2019.mission import BATCHED, named
from experiments.zhang2019.published import TRADITIONAL
from experiments.zhang2019.runs import DENSITIES, FITTED, SIZES
from experiments.zhang2019.verdicts import LEVEL, least_p
from usvjax.plots import style

TITLES = {
    "traditional": "traditional (Fig. 9)",
    "printed": "improved, Eq. 7 as printed (Fig. 10)",
    "accumulated": "improved, e(n) accumulated (Fig. 10)",
    "exact": "least length + turning",
}
LOOKS = {
    "printed": style.Look(style.BLUE, "-", ""),
    "accumulated": style.Look(style.ORANGE, "--", ""),
    "exact": style.Look(style.GREEN, ":", ""),
}
_BY_DENSITY = {
    0.1: style.Look(style.BLUE, "-", "o"),
    0.2: style.Look(style.ORANGE, "-", "s"),
    0.3: style.Look(style.GREEN, "-", "D"),
}
"""Of the densities."""
_PLACE = f"{FITTED.side} x {FITTED.side} cells"


def figures(found: Found, numbers: Numbers) -> Iterator[Drawing]:
    """All figures; see `experiments.paper.Part`."""
    yield Drawing(
        "fig9_10",
        f"Figs. 9 and 10 on the map of {FITTED.label} whose traditional path comes nearest to "
        "Table 3. Costs in squares.",
        paths_figure(found, numbers["shown"]["map"]),
    )
    yield Drawing(
        "sizes",
        "The traditional paths of the batched search on maps of every size, corners not cut: mean "
        "and 95 % range of length and turning cost. In the marks: cells a side.",
        sizes_figure(numbers),
    )
    if panels := _most_alike(numbers):
        yield Drawing(
            "maps_alike",
            "What the rules save on maps like the paper's (batched), by how many maps save that "
            "much or more, for the sizes with the most such maps (19 at least). Where at most "
            f"{100 * LEVEL:g} % save the published 5.0, a reading is excluded.",
            alike_figure(found, panels),
        )
    yield Drawing(
        "changes",
        "Change of the total cost against the traditional path, map by map, batched.",
        changes_figure(found),
    )


@style.styled
def paths_figure(found: Found, job: int) -> Figure:
    """Draw one map with the path of each rule."""
    fig = style.new_figure(style.DOUBLE_MM, 178)
    axes = fig.subplots(2, 2, sharex=True, sharey=True)
    for ax, rule in zip(axes.flat, BATCHED, strict=True):
        method = named(rule, "batched")
        replayed = found.studies["batched"].replay(FITTED.label, method, [job])
        paint_cells(ax, replayed.scene.blocked[0, : FITTED.side, : FITTED.side])
        draw_path(ax, replayed.recording.detail[0])
        own = paths(found.studies["batched"], FITTED.label, rule, "batched")
        own = own.some(np.array([job]))
        ax.set_title(
            f"{TITLES[rule]}\ntotal {own.total()[0]:.1f}, turning {own.turning[0]:.1f}, "
            f"{own.expanded[0]} expanded"
        )
        ax.set(xticks=range(0, FITTED.side, 4), yticks=range(0, FITTED.side, 4))
        ax.set(xlabel="x (squares)", ylabel="y (squares)")
        ax.label_outer()
    path = Line2D([], [], color=style.VERMILLION, label="path")
    blocked = Patch(facecolor="0.15", label="not passable")
    style.outside_legend(fig, [path, *end_handles(), blocked], columns=4)
    return style.settle(fig)


@style.styled
def sizes_figure(numbers: Numbers) -> Figure:
    """Draw where Table 3's traditional path lies among maps of several sizes."""
    fig = style.new_figure(style.DOUBLE_MM, 110)
    ax = fig.subplots()
    for label, (side, density, cutting) in SIZES.items():
        if cutting:
            continue
        own = numbers["programs"]["batched"][label]["traditional"]
        if own["length"]["value"] is None:
            continue
        x, y = own["length"], own["turning"]
        colour, _, marker = _BY_DENSITY[density]
        ax.plot([x["low"], x["high"]], [y["value"]] * 2, color=colour, linewidth=0.8)
        ax.plot([x["value"]] * 2, [y["low"], y["high"]], color=colour, linewidth=0.8)
        place = (x["value"], y["value"])
        ax.plot(*place, marker, color=colour, markersize=13, markerfacecolor="white", zorder=4)
        ax.annotate(f"{side}", place, ha="center", va="center", fontsize=7, zorder=5)
    star = (TRADITIONAL.length, TRADITIONAL.turning)
    ax.plot(*star, marker="*", color=style.VERMILLION, markersize=11, zorder=6)
    ax.set(xlabel="length (squares)", ylabel="turning cost (squares)", ylim=(0, None))
    handles = [
        style.method_handle(look, f"density {density:g}") for density, look in _BY_DENSITY.items()
    ]
    for handle in handles:
        handle.set_markerfacecolor("white")
    handles.append(
        Line2D([], [], color=style.VERMILLION, linestyle="", marker="*", markersize=9,
               label="published (Table 3)")
    )  # fmt: skip
    style.outside_legend(fig, handles, columns=4)
    return style.settle(fig)


def _most_alike(numbers: Numbers) -> list[str]:
    """Up to three sizes, those with the most maps like the paper's; enough to exclude a reading."""
    sizes = numbers["programs"]["batched"]
    counts = {label: own["alike"][f"{WINDOWS[0]:g}"]["n"] for label, own in sizes.items()}
    most = sorted(counts, key=lambda label: -counts[label])[:3]
    return [label for label in most if least_p(counts[label]) <= LEVEL]


@style.styled
def alike_figure(found: Found, labels: Sequence[str]) -> Figure:
    """What the rules save on maps like the paper's, for some sizes."""
    fig = style.new_figure(style.DOUBLE_MM, 80)
    axes = fig.subplots(1, len(labels), sharey=True, sharex=True, squeeze=False)[0]
    ran = found.studies["batched"]
    for ax, label in zip(axes, labels, strict=True):
        old = paths(ran, label, "traditional", "batched")
        chosen = alike(old, WINDOWS[0])
        ax.axvline(SAVED, color=style.VERMILLION, linewidth=0.9)
        ax.axhline(100 * LEVEL, color=style.GREY, linewidth=0.7)
        for rule, look in LOOKS.items():
            own = paths(ran, label, rule, "batched").some(chosen)
            saved = np.sort(old.some(chosen).total() - own.total())
            more = 100 * np.arange(len(saved), 0, -1) / max(len(saved), 1)
            ax.step(saved, more, where="pre", color=look.colour, linestyle=look.line)
        fitted = " (chosen to fit)" * (label == FITTED.label)
        ax.set_title(f"{label}{fitted}\n{chosen.sum()} maps like the paper's")
        ax.set(xlabel="saving of the total (squares)", ylim=(0, 102))
    axes[0].set_ylabel("maps that save it or more (%)")
    lines = [
        Line2D([], [], color=style.VERMILLION, linewidth=0.9, label="published saving"),
        Line2D([], [], color=style.GREY, linewidth=0.7, label=f"{100 * LEVEL:g} % of maps"),
    ]
    style.outside_legend(fig, [*_handles(LOOKS), *lines], columns=3)
    return style.settle(fig)


@style.styled
def changes_figure(found: Found) -> Figure:
    """Change of the total cost against the traditional path, per density."""
    fig = style.new_figure(style.DOUBLE_MM, 80)
    axes = fig.subplots(1, len(DENSITIES), sharex=True, sharey=True)
    ran = found.studies["batched"]
    for ax, density in zip(axes, DENSITIES, strict=True):
        label = FITTED._replace(density=density).label
        old = paths(ran, label, "traditional", "batched")
        ax.axvline(0.0, color=style.GREY, linewidth=0.7)
        for rule, look in LOOKS.items():
            new = paths(ran, label, rule, "batched")
            both = new.found & old.found
            _rising(ax, new.some(both).total() - old.some(both).total(), look)
        ax.set(xlabel="change of the total (squares)", ylim=(0, 102))
        ax.set_title(f"{_PLACE}, density {density:g}")
    axes[0].set_ylabel("maps with that change or less (%)")
    style.outside_legend(fig, _handles(LOOKS), columns=3)
    return style.settle(fig)


def _rising(ax: Axes, values: np.ndarray, look: style.Look) -> None:
    """Draw which share of the values is so large or less."""
    share = 100 * np.arange(1, len(values) + 1) / max(len(values), 1)
    ax.step(np.sort(values), share, where="post", color=look.colour, linestyle=look.line)


def _handles(looks: Mapping[str, style.Look]) -> Sequence[Any]:
    return [
        Line2D([], [], color=look.colour, linestyle=look.line, label=TITLES[rule])
        for rule, look in looks.items()
    ]
