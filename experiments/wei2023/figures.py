"""Figs. 7 and 8 of Wei & Zhang 2023 on a scene of ours, and what many scenes add to them."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

from experiments.claims import Numbers
from experiments.grid_figures import end_handles
from experiments.paper import Drawing
from experiments.runs import Found
from experiments.wei2023.compare import SHOWN
from experiments.wei2023.mission import STAGES
from experiments.wei2023.published import AFTER, BEFORE, COLLISION_RADIUS
from experiments.wei2023.runs import FITTED, SEARCHES, study_of
from usvjax.mission import Replayed
from usvjax.plots import style

LOOKS = {
    ("euclidean", "before"): style.Look(style.ORANGE, "-", ""),
    ("octile", "before"): style.Look(style.BLACK, "--", ""),
    ("euclidean", "keys"): style.Look(style.BLUE, "-", ""),
    ("octile", "keys"): style.Look(style.GREEN, ":", ""),
}


def figures(found: Found, numbers: Numbers) -> Iterator[Drawing]:
    """Draw them all."""
    scene = numbers["shown"]["scene"]
    replayed = found.studies[study_of(SHOWN)].replay(FITTED, SHOWN, [scene])
    yield Drawing(
        "fig7_8",
        f"As Figs. 7 and 8, on scene {scene} of ours ({FITTED}, {SEARCHES[SHOWN]}), which was "
        f"chosen for its {BEFORE} turning points: the path before and after smoothing.",
        fig7_8(replayed),
    )
    yield Drawing(
        "turning_points",
        f"Turning points before and after smoothing, and what it does to length and clearance: "
        f"shares of {numbers['scenes']:,} scenes, {FITTED}.",
        turns_figure(found),
    )


@style.styled
def fig7_8(replayed: Replayed) -> Figure:
    """Draw one global path before and after smoothing."""
    fig = style.new_figure(style.DOUBLE_MM, 105)
    side = replayed.case.given.side
    for ax, stage, number in zip(
        fig.subplots(1, 2, sharey=True), ("before", "keys"), (7, 8), strict=True
    ):
        _draw_scene(ax, replayed.scene.circles[0], side)
        _draw_path(ax, replayed.recording.detail[stage][0])
        turns, length, clear = (
            replayed.columns[f"{name}_{stage}"][0] for name in ("turns", "length", "clearance")
        )
        ax.set_title(
            f"{STAGES[stage]} (Fig. {number}): {turns} turning points,\n"
            f"{length:.2f} nm, clearance {clear:.2f} nm"
        )
        ax.set_xlabel("x, east (nm)")
        if number == 7:
            ax.set_ylabel("y, north (nm)")
    handles = [
        Line2D([], [], color=style.VERMILLION, marker=".", label="path, its turning points"),
        *end_handles(),
        Patch(color=style.GREY, label="obstacle"),
        Line2D([], [], color=style.GREY, linestyle="--", label="collision radius 0.25 nm"),
    ]
    style.outside_legend(fig, handles, columns=5)
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
def turns_figure(found: Found) -> Figure:
    """Distribution of turning points, and the change of length and clearance."""
    fig = style.new_figure(style.DOUBLE_MM, 75)
    left, middle, right = fig.subplots(1, 3)
    for (search, stage), look in LOOKS.items():
        own = found.studies[study_of(search)].columns(FITTED, search)
        _ecdf(left, own[f"turns_{stage}"], look)
        if stage == "before":
            continue
        length, clear = (own[f"{name}_{stage}"] for name in ("length", "clearance"))
        _ecdf(middle, 100 * (length / own["length_before"] - 1), look)
        _ecdf(right, clear - own["clearance_before"], look)
    published = {f"published before: {BEFORE}": (BEFORE, "-"), f"after: {AFTER}": (AFTER, ":")}
    for number, line in published.values():
        left.axvline(number, color=style.VERMILLION, linewidth=0.9, linestyle=line)
    left.set(xlabel="turning points", ylabel="scenes with that or less (%)")
    middle.set_xlabel("change of length (%)")
    right.set_xlabel("change of clearance (nm)")
    for ax in (left, middle, right):
        ax.set_ylim(0, 102)
    lines = {
        f"{SEARCHES[search]}: {STAGES[stage]}": (look.colour, look.line)
        for (search, stage), look in LOOKS.items()
    } | {words: (style.VERMILLION, line) for words, (_, line) in published.items()}
    handles = [
        Line2D([], [], color=colour, linestyle=line, label=words)
        for words, (colour, line) in lines.items()
    ]
    style.outside_legend(fig, handles, columns=3)
    return style.settle(fig)


def _ecdf(ax: Axes, values: np.ndarray, look: style.Look) -> None:
    share = np.arange(1, len(values) + 1) / len(values)
    ax.step(np.sort(values), 100 * share, where="post", color=look.colour, linestyle=look.line)
