"""The figures of the mission "cruise"."""

from collections.abc import Iterator, Mapping

import numpy as np
import polars as pl
from matplotlib.figure import Figure

from usvjax.mission import Replay
from usvjax.missions.cruise import (
    CruiseResult,
    looks,  # noqa: F401
)
from usvjax.missions.cruise.chart import duration_words, plot_cruise
from usvjax.missions.cruise.itinerary import itinerary
from usvjax.missions.cruise.methods import (
    CruisePosed,
    first_map,
    leg_lengths,
    shortest_tours,
    tour_lengths,
)
from usvjax.missions.cruise.params import DISTANCES
from usvjax.plots.methods import Comparison, Panel, method_pages
from usvjax.plots.route import length_words
from usvjax.plots.style import status_name
from usvjax.study import Run
from usvkernels.status import Status

_KILOMETRES_FROM_M, _HOURS_FROM_S = 5000.0, 7200.0


def cruise_figures(run: Run, replay: Replay) -> Iterator[tuple[str, Figure | pl.DataFrame]]:
    """Yield (name, figure or table) of a run, the cheap ones first.

    How the methods compare ("methods"), and of each of the first conditions the cruise of median
    length on its chart ("cruise"), with its itinerary as a table (see `itinerary`).
    """
    table = replay.table
    yield from method_pages(
        table,
        run.methods,
        compared=_comparison(table),
        labels=run.labels,
        confidence=run.level,
        title=run.name,
    )
    for condition in range(min(replay.examples, len(run.settings))):
        if not table.filter(pl.col("condition") == condition).is_empty():
            for drawn in _example(run, replay, condition):
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


def _example(run: Run, replay: Replay, condition: int) -> tuple[Figure, pl.DataFrame]:
    """The typical cruise of a condition under the first method, and its itinerary."""
    method = run.methods[0]
    job, why = replay.example(condition)
    replayed = replay(condition, method, [job])
    (posed,), (sailed,) = replayed.scene, replayed.recording.detail
    head = run.labels[condition]
    if not head.startswith(run.name):
        head = f"{run.name}: {head}"
    legs = {
        name: posed.legs
        if name == posed.options.static.distances
        else leg_lengths(posed.scenes, posed.source.cell_size, name)
        for name in DISTANCES
    }
    figure = _cruise_figure(posed, sailed, legs, f"{head}, {method}, job {job} ({why})")
    return figure, _to_decimetres(itinerary(posed, sailed, legs))


def _to_decimetres(stops: pl.DataFrame) -> pl.DataFrame:
    """Round an itinerary to 0.1 m and 0.1 s, each number as it is read rather than ten times it."""
    rounded = pl.col(pl.Float64).map_elements(lambda x: round(x, 1), return_dtype=pl.Float64)
    return stops.with_columns(rounded)


def _cruise_figure(
    posed: CruisePosed, sailed: CruiseResult, legs: Mapping[str, np.ndarray], title: str
) -> Figure:
    params, grid = posed.options.params, first_map(posed)
    tour, words = _straight_tour(posed, legs)
    length, time = float(sailed.smooth_length[0]), float(sailed.smooth_time[0])
    facts = [visits_words(sailed), length_words(length)]
    facts.append(f"{duration_words(time)} at {params.speed:g} m/s")
    if params.flip_rate:
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


def _straight_tour(posed: CruisePosed, legs: Mapping[str, np.ndarray]) -> tuple[np.ndarray, str]:
    """The order of the shortest tour in straight lines, and words for it."""
    tour = shortest_tours(posed.seed, posed.jobs, legs["straight"], "recommended")
    across, along = (length_words(float(tour_lengths(legs[d], tour)[0])) for d in DISTANCES)
    return tour[0], f"shortest tour in straight lines: {across}, from cell to cell {along}"
