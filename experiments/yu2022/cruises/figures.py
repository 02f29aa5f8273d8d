"""Figs. 6 to 15 of Yu et al. 2022 on maps of ours, and the spread of many cruises."""

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from experiments.claims import Numbers
from experiments.paper import Drawing
from experiments.runs import Found
from experiments.yu2022.cruises.detection import seen_cells
from experiments.yu2022.cruises.published import RUNS, STATISTICS
from experiments.yu2022.cruises.report import PRINTED
from experiments.yu2022.cruises.runs import (
    CELL,
    LABELS,
    SMOOTHED,
    USUAL,
    label_of,
    sailed_by,
)
from usvjax.plots import style

DRAWN = ("aco", "ga", "cmpso", "gwo", "proposed", "proposed_swap")
_NAMES = {"ordinary": "figs_6_10", "complex": "figs_11_15"}
_GREY, _BLACK = "0.82", "0.2"
_SIZES = {"ordinary": (170.0, 140.0, (2, 3)), "complex": (170.0, 255.0, (3, 2))}
"""Width and height, mm, and rows and columns."""
_DIGIT, _GAP = (0.68, 0.8), 0.35
"""Width and height of a digit, and how far it keeps off, in sizes of its font."""
_NUMBER_SIZE = 5.5  # points


def figures(found: Found, numbers: Numbers) -> Iterator[Drawing]:
    """Draw all figures."""
    for environment in numbers["cases"]:
        jobs = jobs_that_all_complete(found, environment)
        if not len(jobs):
            continue
        job = median_job(found, environment, jobs)
        yield Drawing(
            _NAMES[environment],
            f"One cruise of each algorithm on the same map, {environment} environment, Case 1: "
            f"of the {len(jobs)} of the first {RUNS} that all of these completed, the one of "
            f"median length by the proposed algorithm with random keys (job {job}). Numbers are "
            "the order of visits.",
            maps_figure(found, environment, job),
        )
    yield Drawing(
        "cruises",
        "Lengths and inflection points of all algorithms in Case 1, 3 % of changes in the window, "
        "beside the published means.",
        spread_figure(numbers["cases"]),
    )


def jobs_that_all_complete(found: Found, environment: str) -> np.ndarray:
    """The jobs of Case 1 in which every cruise that is drawn comes home, int[n]."""
    sails = [sailed_by(found, environment, 1, USUAL, name) for name in DRAWN]
    complete = [own.complete for own in sails if own is not None]
    n = min(RUNS, *map(len, complete))
    return np.flatnonzero(np.all([own[:n] for own in complete], axis=0))


def median_job(found: Found, environment: str, jobs: np.ndarray) -> int:
    """The job whose cruise by the proposed algorithm has the lower median length."""
    own = sailed_by(found, environment, 1, USUAL, "proposed")
    assert own is not None
    order = jobs[np.argsort(own.length[jobs], kind="stable")]
    return int(order[(len(order) - 1) // 2])


@style.styled
def maps_figure(found: Found, environment: str, job: int) -> Figure:
    """Draw one job's cruise by each algorithm."""
    width, height, shape = _SIZES[environment]
    fig = style.new_figure(width, height)
    label = label_of(environment, 1, USUAL)
    axes = fig.subplots(*shape, sharex=True, sharey=True)
    numbered = []
    for ax, name in zip(axes.flat, DRAWN, strict=True):
        (ran,) = (
            ran
            for ran in found.studies.values()
            if name in ran.spec.methods and label in [c.label for c in ran.spec.conditions]
        )
        replayed = ran.replay(label, name, [job])
        (posed,), (sailed,) = replayed.scene, replayed.recording.detail
        track = sailed.track[0, : sailed.steps[0] + 1]
        line = sailed.smoothed[0, : sailed.smoothed_count[0]] if name in SMOOTHED else track
        stations = posed.scenes.stations[0][sailed.order[0]]
        blocked = posed.scenes.blocked[0]
        _paint(ax, blocked, seen_cells(track, blocked.shape))
        ax.plot(*_metres(line).T, color=style.VERMILLION, linewidth=0.9, zorder=2)
        _mark_stations(ax, stations)
        numbered.append((ax, blocked, line, stations))
        columns = replayed.columns
        kind = "smooth_" if name in SMOOTHED else ""
        ax.set_title(
            f"{LABELS[name]}\n{columns[f'{kind}length'][0]:.0f} m, "
            f"{columns[f'{kind}inflections'][0]} inflections",
            fontsize=7.5,
        )
    for ax in axes[-1]:
        ax.set_xlabel("x, east (m)")
    for ax in axes[:, 0]:
        ax.set_ylabel("y, north (m)")
    style.outside_legend(fig, _handles(), columns=3)
    style.settle(fig)
    for ax, blocked, line, stations in numbered:
        _number(ax, blocked, line, stations)
    return fig


def _handles() -> list[Line2D]:
    square = {"color": "none", "marker": "s", "markeredgecolor": "0.4"}
    disc = {"color": "none", "marker": "o", "markeredgecolor": style.BLACK}
    return [
        Line2D([], [], color=style.VERMILLION, label="line sailed"),
        Line2D([], [], markerfacecolor=_GREY, label="came into sight", **square),
        Line2D([], [], markerfacecolor=_BLACK, label="blocked at first", **square),
        Line2D([], [], markerfacecolor=style.YELLOW, label="start (1)", **disc),
        Line2D([], [], markerfacecolor="white", label="station, by order of visits", **disc),
    ]


def _metres(cells: np.ndarray) -> np.ndarray:
    """Centres of cells (x, y)."""
    centres: np.ndarray = CELL * (cells + 0.5)
    return centres


def _paint(ax: Axes, blocked: np.ndarray, seen: np.ndarray) -> None:
    height, width = blocked.shape
    ax.imshow(
        np.where(blocked, 2, seen),
        cmap=ListedColormap(["white", _GREY, _BLACK]),
        vmin=0,
        vmax=2,
        origin="lower",
        interpolation="nearest",
        extent=(0.0, CELL * width, 0.0, CELL * height),
    )
    ax.grid(visible=False)


def _mark_stations(ax: Axes, stations: np.ndarray) -> None:
    colours = [style.YELLOW, *["white"] * (len(stations) - 1)]
    for (x, y), colour in zip(_metres(stations), colours, strict=True):
        look = {"markerfacecolor": colour, "markeredgecolor": style.BLACK, "markeredgewidth": 0.6}
        ax.plot(x, y, "o", markersize=3, zorder=3, **look)


def _number(ax: Axes, blocked: np.ndarray, line: np.ndarray, stations: np.ndarray) -> None:
    """Write the numbers of stations, in the order of visits, beside them and off the track."""
    points = ax.get_window_extent().width * 72.0 / ax.figure.dpi
    font = _NUMBER_SIZE * blocked.shape[1] / points  # in cells
    spots = clear_spots(line, stations, font, blocked)
    for number, (x, y) in enumerate(spots, 1):
        ax.text(
            *_metres(np.array([x, y])),
            str(number),
            color=style.BLUE,
            fontsize=_NUMBER_SIZE,
            fontweight="bold",
            ha="center",
            va="center_baseline",
            zorder=4,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.3},
        )


def clear_spots(
    line: np.ndarray, stations: np.ndarray, font: float, blocked: np.ndarray
) -> np.ndarray:
    """Where to write the numbers 1, 2, ... of stations so that they cover nothing.

    Args:
        line: int[P, 2], way points of the track, cells.
        stations: int[d, 2].
        font: size of the digits, cells.
        blocked: bool[H, W]; as few of its blocked cells as can be are covered, none of the track.

    Returns:
        float[d, 2], centres of the numbers, cells.
    """
    height, width = blocked.shape
    taken = [_dense(line), stations.astype(float)]
    walls = np.argwhere(blocked)[:, ::-1].astype(float)
    spots = []
    for number, station in enumerate(stations, 1):
        half = 0.5 * font * np.array([_DIGIT[0] * len(str(number)), _DIGIT[1]]) + _GAP * font
        best, least = None, (np.inf, np.inf)
        for ring in range(1, 7):
            reach = half + 0.6 * ring
            angles = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
            for spot in station + reach * np.stack([np.cos(angles), np.sin(angles)], axis=1):
                if (spot - half < -0.5).any() or (spot + half > (width - 0.5, height - 0.5)).any():
                    continue
                covered = sum(_inside(points, spot, half) for points in taken)
                cost = (covered, _inside(walls, spot, half + 0.5) + ring)
                if cost < least:
                    best, least = spot, cost
        spots.append(station if best is None else best)
        corners = np.stack(np.meshgrid([-1, -0.5, 0, 0.5, 1], [-1, -0.5, 0, 0.5, 1]), axis=-1)
        taken.append(spots[-1] + half * corners.reshape(-1, 2))
    return np.array(spots)


def _dense(line: np.ndarray) -> np.ndarray:
    """Points along a line, a quarter of a cell apart or less."""
    ends = list(pairwise(line))
    steps = [max(1, int(4 * np.hypot(*(b - a)))) for a, b in ends]
    parts = [np.linspace(a, b, step + 1) for (a, b), step in zip(ends, steps, strict=True)]
    return np.concatenate(parts)


def _inside(points: np.ndarray, spot: np.ndarray, half: np.ndarray) -> int:
    return int((np.abs(points - spot) < half).all(axis=1).sum())


@style.styled
def spread_figure(cases: Mapping[str, Any]) -> Figure:
    """Mean and range of 95 % of cruises in Case 1, beside the published means."""
    fig = style.new_figure(style.DOUBLE_MM, 45 + 50 * len(cases))
    axes = fig.subplots(len(cases), 2, squeeze=False)
    for row, (environment, found) in zip(axes, cases.items(), strict=True):
        algorithms = found["1"]["algorithms"]
        for ax, indicator in zip(row, ("length", "inflections"), strict=True):
            for place, (name, own) in enumerate(algorithms.items()):
                _mark(ax, own[indicator], place)
                if name in PRINTED:
                    printed = STATISTICS[environment][indicator][PRINTED[name]].mean
                    ax.plot(printed, place + 0.25, "D", color=style.ORANGE, markersize=4)
            ax.set_ylim(len(algorithms) - 0.4, -0.6)
            ax.set_yticks(range(len(algorithms)), [])
            ax.set_title(f"{environment}, Case 1")
        shortest, (low, high) = found["1"]["optimum"], row[0].get_xlim()
        row[0].set_xlim(min(low, shortest - 0.04 * (high - low)), high)
        row[0].axvline(shortest, color=style.GREY, linewidth=0.9, linestyle="--")
        row[0].set_yticks(range(len(algorithms)), [LABELS[name] for name in algorithms])
        row[0].set_xlabel("length (m)")
        row[1].set_xlabel("inflection points")
    handles = [
        Line2D([], [], color=style.BLUE, marker="o", markersize=4),
        Line2D([], [], color="none", marker="D", markersize=4),
        Line2D([], [], color=style.GREY, linestyle="--"),
    ]
    handles[0].set_label("ours: mean, and where 95 % of complete cruises lie")
    handles[1].set(label="published mean", markerfacecolor=style.ORANGE)
    handles[1].set_markeredgecolor(style.ORANGE)
    handles[2].set_label("shortest tour, straight legs")
    style.outside_legend(fig, handles, columns=3)
    return style.settle(fig)


def _mark(ax: Axes, figure: Mapping[str, Any], place: float) -> None:
    if figure["value"] is None:
        return
    ax.plot([figure["low"], figure["high"]], [place, place], color=style.BLUE, linewidth=1.2)
    ax.plot(figure["value"], place, "o", color=style.BLUE, markersize=4)
