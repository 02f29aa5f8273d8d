"""Lanes that take a new job when theirs has ended, against lanes that wait for each other."""

from functools import partial
from typing import Any

import jax
import numpy as np

from benchmarks.markdown import table
from benchmarks.timing import in_turns, spread
from benchmarks.workloads import Workload, heavy_tailed
from usvjax.missions.dwa.inputs import pack_episodes
from usvjax.missions.dwa.params import DwaParams, DwaStatic, split
from usvjax.missions.dwa.run import CHUNK, OPTIONS
from usvkernels import lanes
from usvkernels.dwa import episodes
from usvkernels.dwa.episodes import Jobs, Outcome

TITLE = "lanes refilled against lanes that wait"
WIDTHS = (64, 128, 256, 512)
HOW = {
    "refilled": (("refill", True), ("narrow", True)),  # as navigate_dwa has it
    "not narrowed": (("refill", True), ("narrow", False)),
    "waiting": (("refill", False), ("narrow", False)),
}
Options = tuple[tuple[str, bool], ...]


def measure(quick: bool) -> dict[str, Any]:
    """Run the same episodes with and without refill, on one device."""
    work = heavy_tailed(64 if quick else 2048)
    widths = tuple(n // 16 for n in WIDTHS) if quick else WIDTHS
    jobs = jax.device_put(_jobs(work), jax.devices()[0])
    usage: dict[str, lanes.Usage] = {}
    steps: dict[str, np.ndarray] = {}

    def sail(name: str, width: int, options: Options) -> None:
        outcome, usage[name] = jax.block_until_ready(
            _run(jobs, work.params, work.static, width, options)
        )
        steps[name] = np.asarray(outcome.steps)

    calls = {
        name: partial(sail, name, width, options)
        for width in widths
        for name, options in ((f"{width} {how}", HOW[how]) for how in HOW)
    }
    timed = in_turns(calls)
    first = next(iter(steps.values()))
    for name, times in timed.items():
        if not np.array_equal(steps[name], first):
            raise RuntimeError(f"{name}: episodes differ from those of {next(iter(steps))}")
        times["occupancy"] = float(usage[name].busy / usage[name].total)
    quantiles = np.quantile(first, [0.1, 0.5, 0.9, 0.99, 1.0]).tolist()
    lengths = {"mean": float(first.mean()), "quantiles": quantiles}
    return {"episodes": len(work), "lengths": lengths, "widths": widths, "timed": timed}


def _jobs(work: Workload) -> Jobs:
    scene = pack_episodes(
        work.obstacles, work.starts, work.goals, work.valid, work.params, work.static, None
    )
    return scene.rows(np.arange(len(work)))


@partial(jax.jit, static_argnames=("static", "width", "options"), compiler_options=OPTIONS)
def _run(
    jobs: Jobs, params: DwaParams, static: DwaStatic, width: int, options: Options
) -> tuple[Outcome, lanes.Usage]:
    count = jobs.start.shape[0]
    return lanes.run(
        episodes.program(jobs, split(params, static)),
        count,
        capacity=count,
        lanes=width,
        chunk=CHUNK,
        max_steps=static.max_steps,
        **dict(options),
    )


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows = []
    for width in found["widths"]:
        ways = [found["timed"][f"{width} {how}"] for how in HOW]
        gains = [ways[-1]["median"] / way["median"] for way in ways[:-1]]
        rows.append(
            (
                width,
                *(f"{way['occupancy']:.0%}" for way in ways),
                *(f"{way['median']:.2f}" for way in ways),
                *(f"{gain:.2f}" for gain in gains),
                "; ".join(spread(way["seconds"]) for way in ways),
            )
        )
    best = min(found["timed"].items(), key=lambda item: item[1]["median"])[0]
    lengths = found["lengths"]
    tail = ", ".join(f"{q:.0f}" for q in lengths["quantiles"])
    columns = [f"occupancy, {how}" for how in HOW] + [f"s, {how}" for how in HOW]
    columns += [f"gain, {how}" for how in list(HOW)[:-1]]
    return (
        f"{found['episodes']:,} episodes of dwa_scaling on one device, mean length "
        f"{lengths['mean']:.0f} decisions (10, 50, 90, 99, 100 %: {tail}); refills every {CHUNK} "
        "steps. Refilled: as `navigate_dwa` has it, the last jobs in fewer lanes; not narrowed: "
        "refilled without that; waiting: new jobs only when all lanes have ended. Gain is the "
        "time of waiting over that of the others. All results are equal. "
        f"Fastest: {best}.\n\n" + table(("lanes", *columns, "timings"), rows)
    )
