"""The figures of a run of kind "cruise"."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl
from matplotlib.figure import Figure

from usvjax.missions.cruise import CruiseResult
from usvjax.missions.cruise.chart import duration_words, plot_cruise
from usvjax.missions.cruise.itinerary import itinerary
from usvjax.missions.cruise.methods import (
    Posed,
    first_map,
    leg_lengths,
    pose,
    sail,
    shortest_tours,
    tour_lengths,
)
from usvjax.missions.cruise.mission import CruiseCondition
from usvjax.missions.cruise.orders import DISTANCES
from usvjax.missions.route.figures import Comparison, Panel, method_pages
from usvjax.plots.distributions import both_reached
from usvjax.plots.route import length_words
from usvjax.plots.style import status_name
from usvjax.study import Run
from usvjax.study.replays import check_same, payload_of, rows_of
from usvkernels.status import Status

_KILOMETRES_FROM_M, _HOURS_FROM_S = 5000.0, 7200.0


def cruise_figures(
    run: Run, table: pl.DataFrame, max_examples: int, max_paths: int, folder: Path | None
) -> Iterator[tuple[str, Figure | pl.DataFrame]]:
    """Yield (name, figure or table) of a run, the cheap ones first; see `figures_for_run`."""
    yield from method_pages(run, table, _comparison(table))
    for condition in range(min(max_examples, len(run.settings))):
        mine = table.filter(pl.col("condition") == condition)
        if not mine.is_empty():
            for drawn in _example(run, mine, condition, folder):
                yield f"cruise-c{condition}", drawn


def _comparison(table: pl.DataFrame) -> Comparison:
    """What is compared, in km and h where cruises are long."""
    length, time = (
        float(table[name].to_numpy().max(initial=0.0)) for name in ("smooth_length", "smooth_time")
    )
    km, hours = length >= _KILOMETRES_FROM_M, time >= _HOURS_FROM_S
    panels = (
        Panel(
            "smooth_length",
            f"length of the cruise ({'km' if km else 'm'})",
            scale=1e-3 if km else 1.0,
        ),
        Panel("smooth_time", f"time ({'h' if hours else 's'})", scale=1 / 3600 if hours else 1.0),
        Panel("smooth_inflections", "changes of course"),
    )
    return Comparison(Status.REACHED, panels, "cruises that every method completed")


def _example(
    run: Run, table: pl.DataFrame, condition: int, folder: Path | None
) -> tuple[Figure, pl.DataFrame]:
    """The typical cruise of a condition under the first method, and its itinerary."""
    payload: CruiseCondition = payload_of(run, condition, folder)
    method = run.methods[0]
    job, why = typical_cruise(table, method)
    seed = int(run.manifest["study"]["seed"])
    posed = pose(payload.source, payload.options, seed, np.asarray([job], np.int64))
    sailed = sail(posed, method)
    rows = rows_of(run, table, condition, method, [job])
    same = rows["status"].to_numpy() == sailed.status
    same &= rows["expanded"].to_numpy() == np.float32(sailed.expanded)
    check_same(run, same, posed.jobs)
    head = run.labels[condition]
    if not head.startswith(run.name):
        head = f"{run.name}: {head}"
    legs = {
        name: posed.legs
        if name == posed.options.distances
        else leg_lengths(
            posed.scenes, posed.source.cell_size, replace(posed.options, distances=name)
        )
        for name in DISTANCES
    }
    figure = _cruise_figure(posed, sailed, legs, f"{head}, {method}, job {job} ({why})")
    return figure, itinerary(posed, sailed, legs)


def _cruise_figure(
    posed: Posed, sailed: CruiseResult, legs: Mapping[str, np.ndarray], title: str
) -> Figure:
    options, grid = posed.options, first_map(posed)
    tour, words = _straight_tour(posed, legs)
    length, time = float(sailed.smooth_length[0]), float(sailed.smooth_time[0])
    facts = [visits_words(sailed), length_words(length)]
    facts.append(f"{duration_words(time)} at {options.speed:g} m/s")
    if options.flip_rate:
        facts.append("chart as it was at the start")
    way = sailed.smoothed[0, : sailed.smoothed_count[0]]
    return plot_cruise(
        grid,
        grid.points_of(posed.scenes.stations[0]),
        sailed.order[0],
        grid.points_of(way),
        visited=sailed.visited[0],
        tour=tour,
        track_label=f"cruise, pulled straight: {length_words(length)}, "
        f"from cell to cell {length_words(float(sailed.length[0]))}",
        tour_label=words,
        title=f"{title}\n{', '.join(facts)}",
    )


def visits_words(sailed: CruiseResult) -> str:
    """How many stations there are; of a cruise that failed, how it ended and how many it saw."""
    count, seen = len(sailed.order[0]), int(sailed.visited[0].sum())
    if sailed.status[0] == Status.REACHED:
        return f"{count} stations"
    return f"{status_name(sailed.status[0])}, {seen} of {count} stations visited"


def _straight_tour(posed: Posed, legs: Mapping[str, np.ndarray]) -> tuple[np.ndarray, str]:
    """The order of the shortest tour in straight lines, and words for it."""
    tour = shortest_tours(posed.seed, posed.jobs, legs["straight"], "recommended")
    across, along = (length_words(float(tour_lengths(legs[d], tour)[0])) for d in DISTANCES)
    return tour[0], f"shortest tour in straight lines: {across}, from cell to cell {along}"


def typical_cruise(table: pl.DataFrame, method: str) -> tuple[int, str]:
    """Choose the cruise to show of one condition, by a rule rather than by eye.

    Args:
        table: Rows of one condition.
        method: Whose cruise is shown.

    Returns:
        The job, and why: the one with the median length among the cruises that every method
        completed; the first cruise where there is none.
    """
    kept = both_reached(table, Status.REACHED).filter(pl.col("method") == method)
    if kept.is_empty():
        return int(table["job"].min()), "no cruise that every method completed"  # type: ignore[arg-type]
    ordered = kept.sort("smooth_length", "job")["job"]
    return int(ordered[(len(ordered) - 1) // 2]), "median length"
