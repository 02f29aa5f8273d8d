"""Roses of who gave way: what vessels did that met another, by where they saw it at first sight."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.projections.polar import PolarAxes
from numpy.typing import NDArray

from usvjax.mission import Replayed
from usvjax.missions.fleet.measures import (
    ALTERED,
    LAST_MOMENT,
    SLOWED,
    MeetingKind,
    Meetings,
)
from usvjax.plots import style

MOST_VESSELS = 32
"""Of a fleet whose pairs are judged for a figure."""

ANSWERS = {
    "gave way": style.BLUE,
    f"acted in the last {LAST_MOMENT:g} s": style.ORANGE,
    f"stood on (within {np.degrees(ALTERED):.0f} deg, {100 * SLOWED:.0f} %)": style.LIGHT_GREY,
    "collided": style.VERMILLION,
}
"""What a vessel did about another, and its colour."""

_PETALS = 24

_KINDS = {
    MeetingKind.HEAD_ON: "head-on",
    MeetingKind.CROSSING: "crossing",
    MeetingKind.OVERTAKING: "overtaking",
}

_ANGLES = {0.0: "ahead", 45.0: "45", 90.0: "90", 112.5: "112.5", 180.0: "astern"}
"""Bearings that are labelled, deg to either side; beyond 112.5 another vessel overtakes."""


def tells(found: Replayed) -> bool:
    """Whether it can be told of an episode whom its vessels gave way.

    Obstacles and shores, for which vessels alter course as well, leave that open.
    """
    scenes = found.scene.scenes
    few = scenes.speeds.shape[1] <= MOST_VESSELS
    return few and scenes.water is None and bool(found.scene.params.passing > 0)


def answers(seen: Meetings) -> NDArray[np.int64]:
    """What each vessel did about each other, int64[B, n, n]: places in `ANSWERS`."""
    never, late = np.isinf(seen.action_time), seen.action_contact <= LAST_MOMENT
    return np.select([seen.least_distance <= 0, never, late], [3, 2, 1], 0)


@style.styled
def plot_roses(seen: Mapping[str, Meetings], title: str) -> Figure:
    """Draw what vessels did that met another, by kind of meeting and bearing at first sight.

    Args:
        seen: by strategy, what happened under it.
        title: of the figure.

    Returns:
        The figure, 170 mm wide: a row for each strategy. Areas are numbers of vessels, and the
        circle says how many a petal has that comes to it; starboard is to the right.
    """
    fig = style.new_figure(style.DOUBLE_MM, 28 + 58 * len(seen))
    shape = {"projection": "polar", "theta_offset": np.pi / 2, "theta_direction": -1}
    axes = fig.subplots(len(seen), len(_KINDS), squeeze=False, subplot_kw=shape)
    drawn: set[str] = set()
    for row, (name, each) in zip(axes, seen.items(), strict=True):
        for ax, kind in zip(row, _KINDS, strict=True):
            drawn |= _draw_rose(ax, each, kind)
        row[0].set_ylabel(name, labelpad=24, fontsize=9.0)
    words = "what vessels did about another, by its bearing (deg) at first sight"
    fig.suptitle(f"{style.folded(title, 95)}\n{words}")
    handles = [Patch(color=hue, label=name) for name, hue in ANSWERS.items() if name in drawn]
    style.outside_legend(fig, handles, columns=len(handles) or 1)
    return style.settle(fig)


def _draw_rose(ax: PolarAxes, seen: Meetings, kind: MeetingKind) -> set[str]:
    """Draw one rose; return what vessels of it did."""
    mine = seen.kind == kind
    counts = _counts(-seen.bearing[mine], answers(seen)[mine])
    edge = np.sqrt(np.concatenate([np.zeros((1, _PETALS)), counts.cumsum(axis=0)]))
    middles = 2 * np.pi * np.arange(_PETALS) / _PETALS
    for low, high, hue in zip(edge[:-1], edge[1:], ANSWERS.values(), strict=True):
        there = high > low
        ax.bar(
            middles[there],
            (high - low)[there],
            width=2 * np.pi / _PETALS,
            bottom=low[there],
            color=hue,
            edgecolor=style.BLACK,
            linewidth=0.3,
            zorder=3,
        )
    most = max(int(counts.sum(axis=0).max()), 1)
    ax.set_rgrids([np.sqrt(most)], [f"{most:,}"], angle=157.5, fontsize=6.0)
    ax.set_rlim(0.0, 1.15 * np.sqrt(most))
    sides = {360.0 - angle: words for angle, words in _ANGLES.items() if 0 < angle < 180}
    bearings = _ANGLES | sides
    ax.set_thetagrids(list(bearings), list(bearings.values()), fontsize=6.0)
    ax.tick_params(axis="x", pad=0)
    kept = f"\n{100 * seen.kept[mine].mean():.0f} % by the rules" if mine.any() else "\n"
    ax.set_title(f"{_KINDS[kind]}: {mine.sum():,} vessels{kept}", fontsize=7.5)
    return {name for name, own in zip(ANSWERS, counts, strict=True) if own.any()}


def _counts(bearing: NDArray[np.float64], answer: NDArray[np.int64]) -> NDArray[np.int64]:
    """Vessels by what they did and by petal, int64[answers, petals]; bearings to starboard, rad."""
    petal = np.round(bearing * _PETALS / (2 * np.pi)).astype(np.int64) % _PETALS
    found = np.zeros((len(ANSWERS), _PETALS), np.int64)
    np.add.at(found, (answer, petal), 1)
    return found
