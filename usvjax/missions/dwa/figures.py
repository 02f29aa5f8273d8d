"""The figures of a run, chosen by what the study varies and where its episodes take place."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from matplotlib.figure import Figure

from usvjax.errors import BadInputError
from usvjax.missions.cruise.figures import cruise_figures
from usvjax.missions.route.figures import route_figures
from usvjax.plots import style
from usvjax.plots.base_map import View
from usvjax.plots.chart import detail, plot_chart
from usvjax.plots.distributions import both_reached, plot_distributions
from usvjax.plots.paths import plot_paths
from usvjax.plots.rates import plot_success
from usvjax.study import Run, load_run
from usvjax.study.looks import look_level, look_schedule
from usvjax.study.replays import Replay, replay

FOLDER = "figures"
MAX_EXAMPLES = 4
MAX_PATHS = 200
MOST_CONDITIONS = 24
"""Conditions of one figure; a study with more has several of its kind."""

_AXES = {"params.radius", "maps.rate"}


def figures_for_run(
    run_dir: str | Path,
    *,
    formats: tuple[str, ...] = (".png",),
    max_examples: int = MAX_EXAMPLES,
    max_paths: int = MAX_PATHS,
    folder: Path | None = None,
    on_written: Callable[[Path], None] | None = None,
) -> list[Path]:
    """Draw the figures of a run into its folder "figures".

    - success: rates of every ending, against radius and obstacle rate where the study varies
      just these;
    - distributions: time and length over the episodes in which all methods reached;
    - of each of the first conditions, episodes simulated again: on obstacle maps the paths of
      all methods on one map ("paths"), on a chart many trajectories by outcome, per method
      ("chart"), and the part of it in which most failed ("detail");
    - of a study of routes instead: how the methods compare ("methods"), and of each of the first
      conditions one query under all methods ("routes"), its curvature ("curvature") and, where
      all share a map, many routes on it ("chart");
    - of a study of cruises: how the methods compare ("methods"), and of each of the first
      conditions the cruise of median length on its chart ("cruise"), with its itinerary as a
      table beside it (.csv; see `usvjax.missions.cruise.itinerary.itinerary`).

    The example on an obstacle map is not picked by eye: of the episodes in which all methods
    reached and took different times, it is the one with the median difference.

    Args:
        run_dir: Directory that `usvjax study` wrote; the run may be unfinished.
        formats: Suffixes to write, of ".png", ".pdf" and ".svg".
        max_examples: Conditions to simulate again; 0 simulates nothing.
        max_paths: Trajectories of a chart.
        folder: What a map file named by the study is relative to; the working directory when
            None. Packaged maps need none.
        on_written: Called with every file as soon as it is there.

    Returns:
        The files written.

    Raises:
        BadInputError: It is no run, it has no episodes yet, a format is unknown, its episodes
            cannot be had back (see `usvjax.study.replays.replay`), or the folder cannot be
            written. What was drawn before stays.
    """
    if not formats:
        raise BadInputError("formats is empty; at least one of .png, .pdf, .svg was wanted")
    for suffix in formats:
        style.check_suffix(Path(f"figure{suffix}"), style.FORMATS)
    for name, value, least in (("max_examples", max_examples, 0), ("max_paths", max_paths, 1)):
        if value < least:
            raise BadInputError(f"{name} is {value}; at least {least} was wanted")
    run = load_run(run_dir)
    table = run.table()
    written = []
    kinds = {"route": route_figures, "cruise": cruise_figures}
    figures = kinds.get(run.manifest["study"]["kind"], _figures)
    for name, drawn in figures(run, table, max_examples, max_paths, folder):
        for suffix in formats if isinstance(drawn, Figure) else (".csv",):
            written.append(_saved(drawn, run.path / FOLDER / f"{name}{suffix}"))
            if on_written is not None:
                on_written(written[-1])
    return written


def _saved(drawn: Figure | pl.DataFrame, path: Path) -> Path:
    if isinstance(drawn, Figure):
        return style.save(drawn, path)
    return style.write_atomically(path, lambda into: drawn.write_csv(into, float_precision=1))


def _figures(
    run: Run, table: pl.DataFrame, max_examples: int, max_paths: int, folder: Path | None
) -> Iterator[tuple[str, Figure]]:
    """Yield (name, figure), the cheap ones first."""
    for page, part in _pages(table):
        yield f"success{page}", _success(run, part)
    for page, part in _pages(table):
        if not both_reached(part).is_empty():
            fig = plot_distributions(part, labels=run.labels, title=run.name)
            yield f"distributions{page}", fig
    for condition in range(min(max_examples, len(run.settings))):
        mine = table.filter(pl.col("condition") == condition)
        if mine.is_empty():
            continue
        if run.settings[condition]["maps"]["source"] == "grid":
            yield from _charts(run, mine, condition, max_paths, folder)
        else:
            yield f"paths-c{condition}", _example(run, mine, condition, folder)


def _pages(table: pl.DataFrame) -> Iterator[tuple[str, pl.DataFrame]]:
    """Yield ("", "-2", "-3" ..., rows) with no more conditions than one figure can label."""
    conditions = table["condition"].unique().sort().to_list()
    for page, first in enumerate(range(0, len(conditions), MOST_CONDITIONS), start=1):
        part = table.filter(pl.col("condition").is_in(conditions[first : first + MOST_CONDITIONS]))
        yield ("" if page == 1 else f"-{page}"), part


def _success(run: Run, table: pl.DataFrame) -> Figure:
    # Against radius and rate only where nothing else tells conditions apart.
    by_axes = all(set(varied) <= _AXES for varied in run.varied)
    settings = list(enumerate(run.settings)) if by_axes else []
    study = run.manifest["study"]
    looks = look_schedule(study["episodes"], study["shard"], study["until"])
    return plot_success(
        table,
        radius={c: s["params"]["radius"] for c, s in settings},
        rate={c: s["maps"]["rate"] for c, s in settings if "rate" in s["maps"]},
        labels=run.labels,
        confidence=look_level(study["confidence"], len(looks)),
        title=run.name,
    )


def _charts(
    run: Run, table: pl.DataFrame, condition: int, max_paths: int, folder: Path | None
) -> Iterator[tuple[str, Figure]]:
    for method in run.methods:
        mine = table.filter(pl.col("method") == method).sort("job")
        if mine.is_empty():
            continue
        # Evenly over the jobs, which are independent draws: no ending is preferred.
        rows = np.unique(np.linspace(0, len(mine) - 1, min(max_paths, len(mine))).astype(int))
        jobs = mine["job"].to_numpy()[rows]
        found = replay(run, table, condition, method, jobs.tolist(), folder=folder)
        name = f"chart-c{condition}-{method}"
        yield name, _chart(run, found, None, len(mine))
        assert found.grid_map is not None
        width = _detail_width(found)
        view = detail(found.grid_map, found.trajectories, found.result.status, width)
        if view is not None:
            yield f"{name}-detail", _chart(run, found, view, len(mine))


def _chart(run: Run, found: Replay, view: View | None, episodes: int) -> Figure:
    assert found.grid_map is not None
    title = found.label if found.label.startswith(run.name) else f"{run.name}, {found.label}"
    return plot_chart(
        found.grid_map,
        found.trajectories,
        found.result.status,
        max_paths=len(found.jobs),
        sampled_from=episodes,
        view=view,
        title=title if view is None else f"{title}, where most failed",
    )


def _detail_width(found: Replay) -> float:
    """Twice the longest straight way from start to goal, m: paths show their shape."""
    way = found.scenarios.goals - found.scenarios.starts[:, :2]
    return 2.0 * float(np.hypot(*way.T).max())


def _example(run: Run, table: pl.DataFrame, condition: int, folder: Path | None) -> Figure:
    job, why = typical_job(table, run.methods)
    found = {m: replay(run, table, condition, m, [job], folder=folder) for m in run.methods}
    first = next(iter(found.values()))
    return plot_paths(
        first.circles(0),
        float(first.params.radius),
        {m: _track(r) for m, r in found.items()},
        first.scenarios.starts[0],
        first.scenarios.goals[0],
        outcomes={m: r.outcome(0) for m, r in found.items()},
        goal_tolerance=float(first.params.goal_tolerance),
        title=f"{run.labels[condition]}, job {job}\n({why})",
    )


def _track(found: Replay) -> Any:
    return found.trajectories[0, : int(found.result.steps[0]) + 1]


def typical_job(table: pl.DataFrame, methods: list[str]) -> tuple[int, str]:
    """Choose the episode to show of one condition, by a rule rather than by eye.

    Args:
        table: Rows of one condition.
        methods: Its methods, the baseline first.

    Returns:
        The job, and why it was chosen: the median difference in time between the last method
        and the first over the episodes in which all reached and these times differ; the
        median time where only one method was run or no times differ; or the first episode
        where none reached.
    """
    kept = both_reached(table)
    if kept.is_empty():
        return int(table["job"].min()), "no episode in which all reached"  # type: ignore[arg-type]
    first, last = (
        kept.filter(pl.col("method") == m).select("job", "time") for m in (methods[0], methods[-1])
    )
    both = first.join(last, on="job", suffix="_last")
    both = both.with_columns(gap=pl.col("time_last") - pl.col("time"))
    differing = both.filter(pl.col("gap") != 0)
    if differing.is_empty():
        return _median_job(both, "time"), "median time"
    return _median_job(differing, "gap"), "median difference in time"


def _median_job(table: pl.DataFrame, column: str) -> int:
    """Return the job at the lower median of a column, the lowest number among equals."""
    return int(table.sort(column, "job")["job"][(len(table) - 1) // 2])
