"""The figures of a run of kind "route"."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from usvjax.errors import BadInputError
from usvjax.maps import GridMap
from usvjax.missions.route.mission import RouteCondition, RouteWorkload
from usvjax.missions.route.run import METHODS, Routes
from usvjax.plots import style
from usvjax.plots.curvature import Bends, bends_of, plot_curvature
from usvjax.plots.distributions import both_reached, draw_boxes
from usvjax.plots.route import closeup_width, length_words, plot_route_chart, plot_routes
from usvjax.statistics import wilson
from usvjax.study import Run
from usvjax.study.looks import look_level, look_schedule
from usvjax.study.replays import check_same, payload_of, rows_of
from usvkernels.status import Status

MOST_CONDITIONS = 6
"""Conditions of one figure; a study with more has several."""

# Methods whose curvature is drawn, besides the first.
_BENT = ("bspline", "smoothed")


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


ROUTES = Comparison(
    Status.FOUND,
    (
        Panel("ratio", "length / shortest on the grid"),
        Panel("turns", "turns per route"),
        Panel("expanded", "cells expanded", logarithmic=True),
    ),
    "queries that every method solved",
)


def route_figures(
    run: Run, table: pl.DataFrame, max_examples: int, max_paths: int, folder: Path | None
) -> Iterator[tuple[str, Figure]]:
    """Yield (name, figure) of a run, the cheap ones first; see `figures_for_run`."""
    yield from method_pages(run, table, ROUTES)
    for condition in range(min(max_examples, len(run.settings))):
        mine = table.filter(pl.col("condition") == condition)
        if not mine.is_empty():
            yield from _examples(run, mine, condition, max_paths, folder)


def method_pages(
    run: Run, table: pl.DataFrame, compared: Comparison
) -> Iterator[tuple[str, Figure]]:
    """Yield (name, figure) of how a run's methods compare, a few conditions in each."""
    study = run.manifest["study"]
    looks = look_schedule(study["episodes"], study["shard"], study["until"])
    level = look_level(study["confidence"], len(looks))
    conditions = table["condition"].unique().sort().to_list()
    for page, first in enumerate(range(0, len(conditions), MOST_CONDITIONS), start=1):
        chosen = conditions[first : first + MOST_CONDITIONS]
        fig = plot_methods(
            table.filter(pl.col("condition").is_in(chosen)),
            run.methods,
            compared=compared,
            labels=run.labels,
            confidence=level,
            title=run.name,
        )
        yield ("methods" if page == 1 else f"methods-{page}"), fig


@style.styled
def plot_methods(
    table: pl.DataFrame,
    methods: Sequence[str],
    *,
    compared: Comparison = ROUTES,
    labels: Mapping[int, str] | None = None,
    confidence: float = 0.95,
    title: str | None = None,
) -> Figure:
    """Draw how methods compare: the share of successes, and boxes of three metrics.

    Args:
        table: One row per (condition, method, job) with columns job, condition, method, status
            and the metrics; for routes ratio, turns and expanded.
        methods: Methods, in the order of the figure.
        compared: What counts as success and which metrics are drawn; by default for routes.
        labels: Condition number to what it is.
        confidence: Coverage of the intervals of the share of successes.
        title: Title of the figure.

    Returns:
        The figure, 170 mm wide. Boxes (quartiles, median, whiskers from the 5th to the 95th
        percentile) are over the jobs in which every method succeeded.

    Raises:
        BadInputError: A column is missing or the table is empty.
    """
    wanted = {panel.column: "a metric to draw" for panel in compared.panels}
    style.require_columns(table.columns, wanted)
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
            draw_boxes(ax, filled, 0.68 / len(methods), _fill(looks[method]))
        ax.set(ylabel=words, yscale="log" if logarithmic else "linear")
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
        handles = [
            Patch(facecolor=_fill(looks[m]), edgecolor=style.BLACK, label=m) for m in methods
        ]
        style.outside_legend(fig, handles, columns=min(len(handles), 5))
    return style.settle(fig)


def _places(conditions: Sequence[int], methods: Sequence[str]) -> dict[tuple[int, str], float]:
    """Where each condition and method stands on x: methods side by side at every condition."""
    return {
        (condition, method): place + ((index + 0.5) / len(methods) - 0.5) * 0.8
        for place, condition in enumerate(conditions)
        for index, method in enumerate(methods)
    }


def _fill(look: style.Look) -> str:
    """Black boxes would hide their medians."""
    return style.GREY if look.colour == style.BLACK else look.colour


def _caption(
    title: str | None, kept: pl.DataFrame, table: pl.DataFrame, what: str, alone: bool
) -> str:
    """What the boxes are over; of several conditions, the numbers stand below each."""
    head = f"{title}: " if title else ""
    total = max(part["job"].n_unique() for part in table.partition_by("condition"))
    if alone:
        n = kept["job"].n_unique()
        return f"{head}boxes over the {n:,} of {total:,} {what}"
    return f"{head}boxes over the n of {total:,} {what}"


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


def _examples(
    run: Run, table: pl.DataFrame, condition: int, max_paths: int, folder: Path | None
) -> Iterator[tuple[str, Figure]]:
    """One query under all methods, and many of one method where they share a map."""
    payload: RouteCondition = payload_of(run, condition, folder)
    job, why = _typical_job(table, run.methods[0])
    found = {m: _routes(run, table, condition, payload, m, [job]) for m in run.methods}
    lines = {m: r.points[0, : r.counts[0]] for m, r in found.items() if r.counts[0] > 1}
    if lines:
        title = f"{run.labels[condition]}, job {job} ({why})"
        yield f"routes-c{condition}", _route_figure(payload, run, job, lines, found, title)
        bends = {m: _bends(found[m]) for m in lines if m in (run.methods[0], *_BENT)}
        yield f"curvature-c{condition}", plot_curvature(bends, payload.turning_radius, title=title)
    if payload.source.chart is not None:
        fig = _chart(run, table, condition, payload, max_paths)
        if fig is not None:
            yield f"chart-c{condition}", fig


def _routes(
    run: Run,
    table: pl.DataFrame,
    condition: int,
    payload: RouteCondition,
    method: str,
    jobs: Sequence[int],
) -> Routes:
    """Find routes of a run again, and check that they are the same."""
    rows = rows_of(run, table, condition, method, jobs)
    numbers = np.asarray(jobs, np.int64)
    seed = int(run.manifest["study"]["seed"])
    found, _ = RouteWorkload().routes(payload, seed, method, numbers)
    same = rows["status"].to_numpy() == found.status
    same &= rows["expanded"].to_numpy() == found.expanded
    check_same(run, same, numbers)
    return found


def _route_figure(
    payload: RouteCondition,
    run: Run,
    job: int,
    lines: Mapping[str, Any],
    found: Mapping[str, Routes],
    title: str,
) -> Figure:
    source = payload.source
    grid = source.chart
    if grid is None:
        scenes = source.draw(int(run.manifest["study"]["seed"]), np.asarray([job]))
        grid = GridMap(scenes.land[0], source.cell_size, source.origin)
    labels = {m: _label(m, found[m]) for m in lines}
    radius = payload.turning_radius
    arcs = any(METHODS[m].finish == "arcs" for m in lines)
    return plot_routes(
        grid,
        lines,
        labels=labels,
        closeup=closeup_width(grid, list(lines.values()), radius),
        turning_radius=radius if arcs else None,
        title=title,
    )


def _label(method: str, found: Routes) -> str:
    label = f"{method}: {length_words(float(found.path_length[0]))}, {found.turns[0]} turns"
    # A grid route turns on the spot everywhere; of one whose corners are rounded this is news.
    if found.left is not None and found.sharp_turns[0]:
        label += f", {found.sharp_turns[0]} not sailable"
    return label


def _bends(found: Routes) -> Bends:
    points = found.points[0, : found.counts[0]]
    if found.curvature is None:
        return bends_of(points)
    return bends_of(points, found.curvature[0], None if found.left is None else found.left[0])


def _chart(
    run: Run, table: pl.DataFrame, condition: int, payload: RouteCondition, max_paths: int
) -> Figure | None:
    method = run.methods[-1]
    mine = table.filter(pl.col("method") == method).sort("job")
    # Evenly over the jobs, which are independent draws.
    rows = np.unique(np.linspace(0, len(mine) - 1, min(max_paths, len(mine))).astype(int))
    jobs = mine["job"].to_numpy()[rows]
    found = _routes(run, table, condition, payload, method, jobs.tolist())
    lines = [points[:n] for points, n in zip(found.points, found.counts, strict=True) if n > 1]
    if not lines or payload.source.chart is None:
        return None
    title = f"{run.labels[condition]}: {len(lines):,} of {len(mine):,} routes, {method}"
    return plot_route_chart(payload.source.chart, lines, title=title)


def _typical_job(table: pl.DataFrame, baseline: str) -> tuple[int, str]:
    """Choose the query to show, by a rule rather than by eye.

    The one with the baseline's median length over the queries that every method solved; the
    first query where there is none.
    """
    kept = both_reached(table, Status.FOUND).filter(pl.col("method") == baseline)
    if kept.is_empty():
        return int(table["job"].min()), "no query that every method solved"  # type: ignore[arg-type]
    ordered = kept.sort("path_length", "job")["job"]
    return int(ordered[(len(ordered) - 1) // 2]), "median length"
