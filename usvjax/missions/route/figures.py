"""The figures of the mission "route"."""

from collections.abc import Iterator, Mapping
from typing import Any

import polars as pl
from matplotlib.figure import Figure

import usvjax.missions.route.looks  # noqa: F401
from usvjax.maps import GridMap
from usvjax.mission import Replay, Replayed
from usvjax.missions.route.posed import RouteCase, RoutePosed
from usvjax.missions.route.run import METHODS, Routes
from usvjax.plots.curvature import Bends, bends_of, plot_curvature
from usvjax.plots.examples import spread_jobs
from usvjax.plots.methods import Comparison, Panel, method_pages
from usvjax.plots.route import closeup_width, length_words, plot_route_chart, plot_routes
from usvjax.study import Run
from usvkernels.status import Status

# Methods whose curvature is drawn, besides the first.
_BENT = ("bspline", "smoothed")


ROUTES = Comparison(
    Status.FOUND,
    (
        Panel("ratio", "length / shortest on the grid"),
        Panel("turns", "turns per route"),
        Panel("expanded", "cells expanded", logarithmic=True),
    ),
    "queries that every method solved",
)


def route_figures(run: Run, replay: Replay) -> Iterator[tuple[str, Figure]]:
    """Yield (name, figure) of a run, the cheap ones first.

    How the methods compare ("methods"), and of each of the first conditions one query under all
    methods ("routes"), its curvature ("curvature") and, where all share a map, many routes on it
    ("chart").
    """
    table = replay.table
    yield from method_pages(
        table,
        run.methods,
        compared=ROUTES,
        labels=run.labels,
        confidence=run.level,
        title=run.name,
    )
    for condition in range(min(replay.examples, len(run.settings))):
        mine = table.filter(pl.col("condition") == condition)
        if not mine.is_empty():
            yield from _examples(run, replay, mine, condition)


def _examples(
    run: Run, replay: Replay, table: pl.DataFrame, condition: int
) -> Iterator[tuple[str, Figure]]:
    """One query under all methods, and many of one method where they share a map."""
    job, why = replay.example(condition)
    replayed = {m: replay(condition, m, [job]) for m in run.methods}
    found: dict[str, Routes] = {m: r.recording.detail for m, r in replayed.items()}
    one = replayed[run.methods[0]]
    given: RouteCase = one.case.given
    lines = {m: r.points[0, : r.counts[0]] for m, r in found.items() if r.counts[0] > 1}
    if lines:
        title = f"{run.labels[condition]}, job {job} ({why})"
        yield f"routes-c{condition}", _route_figure(one, lines, found, title)
        bends = {m: _bends(found[m]) for m in lines if m in (run.methods[0], *_BENT)}
        yield f"curvature-c{condition}", plot_curvature(bends, given.turning_radius, title=title)
    if given.source.chart is not None:
        fig = _chart(run, replay, table, condition, given.source.chart)
        if fig is not None:
            yield f"chart-c{condition}", fig


def _route_figure(
    one: Replayed, lines: Mapping[str, Any], found: Mapping[str, Routes], title: str
) -> Figure:
    given: RouteCase = one.case.given
    posed: RoutePosed = one.scene
    labels = {m: _label(m, found[m]) for m in lines}
    radius = given.turning_radius
    arcs = any(METHODS[m].finish == "arcs" for m in lines)
    grid = posed.land(0)
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
    run: Run, replay: Replay, table: pl.DataFrame, condition: int, chart: GridMap
) -> Figure | None:
    method = run.methods[-1]
    mine = table.filter(pl.col("method") == method)
    found: Routes = replay(condition, method, spread_jobs(mine, replay.most)).recording.detail
    lines = [points[:n] for points, n in zip(found.points, found.counts, strict=True) if n > 1]
    if not lines:
        return None
    title = f"{run.labels[condition]}: {len(lines):,} of {len(mine):,} routes, {method}"
    return plot_route_chart(chart, lines, title=title)
