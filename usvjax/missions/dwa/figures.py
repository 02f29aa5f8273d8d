"""The figures of the mission "dwa", chosen by what a study varies and where its episodes are."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import polars as pl
from matplotlib.figure import Figure
from numpy.typing import NDArray

import usvjax.missions.dwa.looks  # noqa: F401
from usvjax.mission import MOST_CONDITIONS, Replay, Replayed
from usvjax.missions.dwa.candidates import DwaCandidates, dwa_candidates
from usvjax.missions.dwa.decision import Decide, Episode, decision_film
from usvjax.missions.dwa.inputs import pack_episodes
from usvjax.missions.dwa.posed import DwaPosed
from usvjax.missions.dwa.run import NavigateResult
from usvjax.plots.base_map import View
from usvjax.plots.chart import detail, plot_chart
from usvjax.plots.distributions import both_reached, plot_distributions
from usvjax.plots.examples import middle_job, spread_jobs
from usvjax.plots.film import Film
from usvjax.plots.paths import Ending, plot_paths
from usvjax.plots.rates import plot_success
from usvjax.study import Run
from usvkernels.status import EPISODE_ENDINGS

_AXES = {"params.radius", "maps.rate"}

FloatArray = NDArray[np.float64]


def dwa_figures(run: Run, replay: Replay) -> Iterator[tuple[str, Figure]]:
    """Yield (name, figure) of a run, the cheap ones first.

    - success: rates of every ending, against radius and obstacle rate where the study varies
      just these;
    - distributions: time and length over the episodes in which all methods reached; neither
      where there are so many conditions that an overview is drawn in their place;
    - of each of the first conditions, episodes simulated again: on obstacle maps the paths of
      all methods on one map ("paths"), on a chart many trajectories by outcome, per method
      ("chart"), and the part of it in which most failed ("detail").
    """
    table = replay.table
    if len(run.settings) <= MOST_CONDITIONS:
        yield "success", _success(run, table)
        if not both_reached(table).is_empty():
            fig = plot_distributions(table, labels=run.labels, title=run.name)
            yield "distributions", fig
    for condition in range(min(replay.examples, len(run.settings))):
        mine = table.filter(pl.col("condition") == condition)
        if mine.is_empty():
            continue
        if run.settings[condition]["maps"]["source"] == "grid":
            yield from _charts(run, replay, mine, condition)
        else:
            yield f"paths-c{condition}", _example(run, replay, condition)


def _success(run: Run, table: pl.DataFrame) -> Figure:
    # Against radius and rate only where nothing else tells conditions apart.
    by_axes = all(set(varied) <= _AXES for varied in run.varied)
    settings = list(enumerate(run.settings)) if by_axes else []
    return plot_success(
        table,
        radius={c: s["params"]["radius"] for c, s in settings},
        rate={c: s["maps"]["rate"] for c, s in settings if "rate" in s["maps"]},
        labels=run.labels,
        confidence=run.level,
        endings=EPISODE_ENDINGS,
        methods=run.methods,
        title=run.name,
    )


def _charts(
    run: Run, replay: Replay, table: pl.DataFrame, condition: int
) -> Iterator[tuple[str, Figure]]:
    for method in run.methods:
        mine = table.filter(pl.col("method") == method)
        if mine.is_empty():
            continue
        found = replay(condition, method, spread_jobs(mine, replay.most))
        name = f"chart-c{condition}-{method}"
        yield name, _chart(run, found, None, mine)
        posed: DwaPosed = found.scene
        assert posed.grid_map is not None
        width = _detail_width(posed)
        view = detail(posed.grid_map, _trajectories(found), found.columns["status"], width)
        if view is not None:
            yield f"{name}-detail", _chart(run, found, view, mine)


def _chart(run: Run, found: Replayed, view: View | None, rows: pl.DataFrame) -> Figure:
    posed: DwaPosed = found.scene
    assert posed.grid_map is not None
    title = found.label if found.label.startswith(run.name) else f"{run.name}, {found.label}"
    return plot_chart(
        posed.grid_map,
        _trajectories(found),
        found.columns["status"],
        max_paths=len(found.jobs),
        sample_of=rows["status"].to_numpy(),
        view=view,
        title=title if view is None else f"{title}, where most of those drawn failed",
    )


def _trajectories(found: Replayed) -> FloatArray:
    """float[J, T, 5]: x, y (m), psi (rad), v (m/s), w (rad/s)."""
    result: NavigateResult = found.recording.detail
    assert result.trajectory is not None
    return result.trajectory


def _detail_width(posed: DwaPosed) -> float:
    """Twice the longest straight way from start to goal, m: paths show their shape."""
    way = posed.scenes.goals - posed.scenes.starts[:, :2]
    return 2.0 * float(np.hypot(*way.T).max())


def _example(run: Run, replay: Replay, condition: int) -> Figure:
    job, why = replay.example(condition)
    found = {m: replay(condition, m, [job]) for m in run.methods}
    posed: DwaPosed = found[run.methods[0]].scene
    return plot_paths(
        posed.circles(0),
        float(posed.params.radius),
        {m: r.recording.tracks[0].places[:, 0] for m, r in found.items()},
        posed.scenes.starts[0],
        posed.scenes.goals[0],
        endings={m: _ending(r.recording.detail) for m, r in found.items()},
        goal_tolerance=float(posed.params.goal_tolerance),
        title=f"{run.labels[condition]}, job {job}\n({why})",
    )


def _ending(result: NavigateResult) -> Ending:
    """How the first episode ended."""
    return Ending(
        status=int(result.status[0]),
        time=float(result.time[0]),
        path_length=float(result.path_length[0]),
    )


def typical_job(table: pl.DataFrame, methods: list[str]) -> tuple[int, str]:
    """Choose the episode to show of one condition, by a rule rather than by eye.

    Args:
        table: rows of one condition.
        methods: its methods, the baseline first.

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
        return middle_job(both, "time"), "median time"
    return middle_job(differing, "gap"), "median difference in time"


def episode_film(replayed: Replayed, row: int) -> Film:
    """An episode with its dynamic window: the candidates of every decision by score."""
    return decision_film(_episode(replayed, row), decide_of(replayed, row))


def _episode(replayed: Replayed, row: int) -> Episode:
    posed: DwaPosed = replayed.scene
    result: NavigateResult = replayed.recording.detail
    return Episode(
        trajectory=_trajectories(replayed)[row],
        goal=posed.scenes.goals[row],
        obstacles=posed.circles(row),
        radius=float(posed.params.radius),
        dt=float(posed.params.dt),
        goal_tolerance=float(posed.params.goal_tolerance),
        status=int(result.status[row]),
        steps=int(result.steps[row]),
        grid_map=posed.grid_map,
        title=f"{replayed.label}, job {replayed.jobs[row]}",
    )


def decide_of(replayed: Replayed, row: int) -> Decide:
    """The function from a state of one episode to the decision taken there."""
    posed: DwaPosed = replayed.scene
    params, static = posed.params, replace(posed.static, method=replayed.method)
    starts, goals = posed.scenes.starts[row], posed.scenes.goals[row]
    seen = posed.circles(row) if posed.grid_map is None else posed.grid_map
    packed = pack_episodes(seen, starts, goals, None, params, static, None)
    origin, goal = packed.origin, packed.goal[0]

    # As the kernel does, in the map's frame: single precision is too coarse in the world's.
    def decision(state: FloatArray) -> DwaCandidates:
        state = np.concatenate([state[:2] - origin, state[2:]])
        near = packed.sensed(state[None, :2])[0].T
        found = dwa_candidates(near, state, goal, params=params, static=static)
        return replace(found, end=found.end + origin, paths=found.paths + origin)

    return decision
