"""The figures of the mission "fleet"."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import polars as pl
from matplotlib.figure import Figure
from numpy.typing import NDArray

import usvjax.missions.fleet.looks  # noqa: F401
from usvjax.mission import MOST_CONDITIONS, Replay, Replayed
from usvjax.missions.fleet.measures import Meetings, meetings_of
from usvjax.missions.fleet.panels import colours_of, draw_hulls, ending_words, plot_fleets
from usvjax.missions.fleet.roses import plot_roses, tells
from usvjax.plots import style
from usvjax.plots.distributions import both_reached
from usvjax.plots.examples import median_job, middle_job, spread_jobs
from usvjax.plots.film import Film
from usvjax.plots.methods import Comparison, Panel, method_pages
from usvjax.plots.rates import plot_success
from usvjax.plots.tracks import film_of
from usvjax.study import Run
from usvkernels.fleet.approach import closest_approach
from usvkernels.status import FLEET_ENDINGS, Status

FloatArray = NDArray[np.float64]

ALONE = "none"
"""The strategy by which nobody gives way."""

_PANELS = (
    Panel("extra_distance", "distance over the route's (%)"),
    Panel("delay", "delay (s)"),
    Panel("min_separation", "least distance between hulls (m)"),
)


def fleet_figures(run: Run, replay: Replay) -> Iterator[tuple[str, Figure]]:
    """Yield (name, figure) of a run, the cheap ones first.

    - success: rates of every ending;
    - methods: how strategies compare over the fleets that arrive under all of them; "none" is
      left out, whose fleets arrive only where there is nothing to compare;
    - of each of the first conditions an example under every strategy: its tracks ("tracks"), and
      distances between hulls over time ("separation");
    - of each of the first conditions in open water, what vessels did that met another ("roses").
    """
    what = Comparison(Status.REACHED, _PANELS, "fleets that arrive under each strategy")
    yield from overview(run, replay.table, FLEET_ENDINGS, what)
    shown = []
    for condition, found, title in examples(run, replay):
        yield f"tracks-c{condition}", plot_fleets(found, title)
        yield f"separation-c{condition}", plot_separations(found, title)
        if tells(next(iter(found.values()))):
            shown.append(condition)
    for condition in shown:
        if seen := _met(run, replay, condition):
            n = len(next(iter(seen.values())).kind)
            yield f"roses-c{condition}", plot_roses(seen, f"{headed(run, condition)}, {n:,} fleets")


def _met(run: Run, replay: Replay, condition: int) -> dict[str, Meetings]:
    """What happened between the vessels of some episodes, by strategy; nobody meets: left out."""
    found = {}
    rows = replay.table.filter(pl.col("condition") == condition)
    for method in run.methods:
        mine = rows.filter(pl.col("method") == method)
        jobs = spread_jobs(mine, replay.most)
        if method == ALONE or not jobs:
            continue
        own = replay(condition, method, jobs)
        seen = meetings_of(own.recording.detail, own.scene.hulls, own.scene.params)
        if seen.kind.any():
            found[method] = seen
    return found


def overview(
    run: Run, table: pl.DataFrame, endings: tuple[Status, ...], compared: Comparison
) -> Iterator[tuple[str, Figure]]:
    """Yield (name, figure) of endings ("success") and of what is compared ("methods")."""
    if len(run.settings) <= MOST_CONDITIONS:
        yield (
            "success",
            plot_success(
                table,
                labels=run.labels,
                confidence=run.level,
                endings=[code for code in endings if code in table["status"]],
                methods=run.methods,
                title=run.name,
            ),
        )
    methods = [m for m in run.methods if m != ALONE] or run.methods
    acting = table.filter(pl.col("method").is_in(methods))
    if not both_reached(acting).is_empty():
        yield from method_pages(
            acting,
            methods,
            compared=compared,
            labels=run.labels,
            confidence=run.level,
            title=run.name,
        )


def examples(run: Run, replay: Replay) -> Iterator[tuple[int, dict[str, Replayed], str]]:
    """Yield of each of the first conditions its number, an example by strategy, and a title."""
    for condition in range(min(replay.examples, len(run.settings))):
        if replay.table.filter(pl.col("condition") == condition).is_empty():
            continue
        job, why = replay.example(condition)
        found = {m: replay(condition, m, [job]) for m in run.methods}
        yield condition, found, f"{headed(run, condition)}, job {job} ({why})"


def headed(run: Run, condition: int) -> str:
    """The run and one of its conditions in words."""
    head = run.labels[condition]
    return head if head.startswith(run.name) else f"{run.name}: {head}"


def telling_job(rows: pl.DataFrame, methods: list[str]) -> tuple[int, str]:
    """Choose the fleet to show of one condition, by a rule rather than by eye.

    Args:
        rows: of one condition.
        methods: its methods, the baseline first.

    Returns:
        The job, and why it was chosen: of the fleets that collide under the baseline and arrive
        under all others, that of median path under the last method; where there are none, of
        those that arrive under all.
    """
    hit = (pl.col("method") == methods[0]) & (pl.col("status") == int(Status.COLLIDED))
    jobs = rows.filter(hit)["job"]
    others = rows.filter(pl.col("job").is_in(jobs.to_list()) & (pl.col("method") != methods[0]))
    kept = both_reached(others).filter(pl.col("method") == methods[-1])
    if kept.is_empty():
        what = "fleet that arrives under all"
        return median_job(rows, methods[0], "path_length", Status.REACHED, what)
    return middle_job(kept, "path_length"), f"collides under {methods[0]}, arrives under the others"


def fleet_film(replayed: Replayed, row: int) -> Film:
    """An episode as `film_of`, with the hulls to scale."""
    film = film_of(replayed, row)
    ax, places = film.fig.axes[0], replayed.recording.tracks[row].places
    radii = replayed.scene.hulls[row]
    hulls = draw_hulls(ax, places[0], radii, colours_of(len(radii)))

    def show(step: int) -> None:
        film.show(step)
        hulls.set_offsets(places[step])

    return Film(film.fig, film.steps, show)


@style.styled
def plot_separations(found: Mapping[str, Replayed], title: str) -> Figure:
    """Draw the least distance between two hulls of a fleet over time, now and as foreseen.

    Args:
        found: by strategy, the first episode of each.
        title: of the figure.

    Returns:
        The figure, 170 mm wide. Below, the distance at the closest point (DCPA) if all keep course
        and speed, over the pairs that still approach; nothing where none does.
    """
    fig = style.new_figure(style.DOUBLE_MM, 125)
    above, below = fig.subplots(2, 1, sharex=True)
    looks = style.method_looks(found)
    handles = []
    for name, each in found.items():
        look, time = looks[name], each.recording.tracks[0].along
        now, foreseen = separations(each.recording.detail[0], each.scene.hulls[0])
        drawn: dict[str, Any] = {"color": look.colour, "linestyle": look.line}
        for ax, values in ((above, now), (below, foreseen)):
            ax.plot(time, values, linewidth=1.1, zorder=look.zorder, **drawn)
            last = np.flatnonzero(np.isfinite(values))[-1:]
            ax.plot(time[last], values[last], look.marker, color=look.colour, markersize=4)
        handles.append(style.method_handle(look, f"{name}: {ending_words(each)}"))
    for ax in (above, below):
        ax.axhline(0.0, color=style.BLACK, linewidth=0.6, zorder=1)
    above.set(ylabel="between hulls (m)")
    # What is foreseen when vessels begin to turn may be many times what matters later.
    below.set(ylabel="least DCPA between hulls (m)", xlabel="time (s)")
    below.set_yscale("symlog", linthresh=100.0)
    style.plain_powers(below.yaxis)
    fig.suptitle(style.folded(title, 95))
    style.outside_legend(fig, handles, columns=min(len(handles), 2))
    return style.settle(fig)


def separations(states: FloatArray, hulls: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least distances between two hulls of a fleet.

    Args:
        states: float64[T, n, 5], as `FleetResult.trajectory`.
        hulls: float64[n], m.

    Returns:
        float64[T] each, m: at every step; and at the closest point of approach, if all keep course
        and speed, over the pairs that approach, NaN where none does.
    """
    one, other = np.triu_indices(len(hulls), 1)
    velocity = states[..., 3, None] * np.stack(
        [np.cos(states[..., 2]), np.sin(states[..., 2])], axis=-1
    )
    place = states[:, other, :2] - states[:, one, :2]
    relative = velocity[:, other] - velocity[:, one]
    radii = hulls[one] + hulls[other]
    now: FloatArray = (np.hypot(*np.moveaxis(place, -1, 0)) - radii).min(axis=1)
    closest = closest_approach(
        tuple(np.moveaxis(place, -1, 0)), tuple(np.moveaxis(relative, -1, 0))
    )
    ahead = np.asarray(closest.time) > 0.0
    foreseen = np.where(ahead, np.asarray(closest.distance, np.float64) - radii, np.inf).min(axis=1)
    return now, np.where(np.isfinite(foreseen), foreseen, np.nan)
