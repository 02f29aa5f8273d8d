"""Figs. 7 and 8 of Wei & Zhang 2023 on a scene of ours, and what many scenes add to them."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from experiments.wei2023.paths import Stages
from experiments.wei2023.published import AFTER, BEFORE, COLLISION_RADIUS
from experiments.wei2023.scenes import Scenes, centre_of
from usvjax.plots import save, style

DPI = 130
LOOKS = {
    ("euclidean", "before"): style.Look(style.ORANGE, "-", ""),
    ("octile", "before"): style.Look(style.BLACK, "--", ""),
    ("euclidean", "key points"): style.Look(style.BLUE, "-", ""),
    ("octile", "key points"): style.Look(style.GREEN, ":", ""),
}


def draw(
    scenes: Scenes, job: int, searches: Mapping[str, Stages], side: float, folder: Path
) -> list[Path]:
    """Draw all figures.

    Args:
        scenes: of the kind that is shown.
        job: number of the scene that is shown.
        searches: search to stages, on these scenes.
        side: of the scenes, nm.
        folder: to write to.
    """
    figures = {
        "fig7_8.png": fig7_8(scenes, job, searches["euclidean"], side),
        "turning_points.png": turns_figure(searches),
    }
    return [save(figure, folder / name, dpi=DPI) for name, figure in figures.items()]


@style.styled
def fig7_8(scenes: Scenes, job: int, stages: Stages, side: float) -> Figure:
    """Draw one global path before and after smoothing."""
    fig = style.new_figure(style.DOUBLE_MM, 100)
    for ax, stage, number in zip(
        fig.subplots(1, 2, sharey=True), ("before", "key points"), (7, 8), strict=True
    ):
        own = stages[stage].some([job])
        _draw_scene(ax, scenes.circles[job], side)
        _draw_path(ax, centre_of(own.cells[0]))
        ax.set_title(
            f"{stage} (Fig. {number}): {own.turns[0]} turning points,\n"
            f"{own.length[0]:.2f} nm, clearance {own.clearance[0]:.2f} nm"
        )
        ax.set_xlabel("x, east (nm)")
        if number == 7:
            ax.set_ylabel("y, north (nm)")
    handles = [
        Line2D([], [], color=style.VERMILLION, marker="o", markersize=3, label="path, its turns"),
        Line2D([], [], color=style.GREY, linestyle="--", label="collision radius 0.25 nm"),
    ]
    style.outside_legend(fig, handles, columns=2)
    return style.settle(fig)


def _draw_scene(ax: Axes, circles: np.ndarray, side: float) -> None:
    for x, y, radius in circles:
        ax.add_patch(Circle((x, y), radius, color=style.GREY))
        ring = Circle((x, y), radius + COLLISION_RADIUS, fill=False, linestyle="--")
        ring.set_edgecolor(style.GREY)
        ax.add_patch(ring)
    ax.set(xlim=(0, side), ylim=(0, side), aspect="equal")


def _draw_path(ax: Axes, points: np.ndarray) -> None:
    ax.plot(*points.T, color=style.VERMILLION, linewidth=1.1)
    step = np.diff(points, axis=0)
    course = np.arctan2(step[:, 1], step[:, 0])
    moved = np.hypot(*step.T) > 0
    turned = (np.abs(np.diff(course)) > 1e-6) & moved[1:]
    ax.plot(*points[1:-1][turned].T, ".", color=style.VERMILLION, markersize=4)
    for end, marker in ((0, "o"), (-1, "s")):
        ax.plot(
            *points[end],
            marker=marker,
            markersize=5,
            markerfacecolor="white",
            markeredgecolor=style.BLACK,
            zorder=4,
        )


@style.styled
def turns_figure(searches: Mapping[str, Stages]) -> Figure:
    """Distribution of turning points, and the change of length and clearance."""
    fig = style.new_figure(style.DOUBLE_MM, 75)
    left, middle, right = fig.subplots(1, 3)
    for (search, stage), look in LOOKS.items():
        own, old = searches[search][stage], searches[search]["before"]
        _ecdf(left, own.turns, look)
        if stage == "before":
            continue
        _ecdf(middle, 100 * (own.length / old.length - 1), look)
        _ecdf(right, own.clearance - old.clearance, look)
    for number, words, height in ((BEFORE, "before", 0.35), (AFTER, "after", 0.8)):
        left.axvline(number, color=style.VERMILLION, linewidth=0.8)
        left.annotate(
            f"published,\n{words}",
            (number, height),
            xycoords=("data", "axes fraction"),
            xytext=(3 if number == BEFORE else 12, 0),
            textcoords="offset points",
            fontsize=7,
            color=style.VERMILLION,
        )
    left.set(xlabel="turning points", ylabel="scenes with that or less (%)")
    middle.set_xlabel("change of length (%)")
    right.set_xlabel("change of clearance (nm)")
    for ax in (left, middle, right):
        ax.set_ylim(0, 102)
    handles = [
        Line2D([], [], color=look.colour, linestyle=look.line, label=f"A*, {search}: {stage}")
        for (search, stage), look in LOOKS.items()
    ]
    style.outside_legend(fig, handles, columns=2)
    return style.settle(fig)


def _ecdf(ax: Axes, values: np.ndarray, look: style.Look) -> None:
    share = np.arange(1, len(values) + 1) / len(values)
    ax.step(np.sort(values), 100 * share, where="post", color=look.colour, linestyle=look.line)
