"""Decisions per second of usvjax and of the same method as it is written today.

Every contestant steers the same vessels in closed loop: 55 candidates, predicted 30 steps ahead,
among 40 obstacles, 128 decisions per episode whatever happens. Slow contestants get a share of
the episodes, evenly spaced.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from benchmarks.markdown import table, verdict
from benchmarks.peers import Settings, dwa_numba, dwa_numpy, dwa_python
from benchmarks.timing import in_turns, spread
from benchmarks.workloads import FIXED_STEPS, OBSTACLES, Workload, fixed_length, of_method

TITLE = "DWA decisions per second, closed loop"
METHODS = ("traditional", "improved")

OURS = "usvjax, float32"
STEPWISE = "numba prange, stepwise, float64"
CLOSED = "numba prange, our closed form, float64"
STEPWISE_32 = "numba prange, stepwise, float32"
CLOSED_32 = "numba prange, our closed form, float32"
NUMPY = "NumPy, vectorised, float64"
PYTHON = "plain Python"
EPISODES = {
    OURS: 4096,
    STEPWISE: 256,
    STEPWISE_32: 512,
    CLOSED: 1024,
    CLOSED_32: 1024,
    NUMPY: 64,
    PYTHON: 2,
}
QUICK = {name: max(1, n // 64) for name, n in EPISODES.items()}


def measure(quick: bool) -> dict[str, Any]:
    """Time every contestant with both methods."""
    episodes = QUICK if quick else EPISODES
    work = fixed_length(episodes[OURS], METHODS)
    found: dict[str, Any] = {"steps": FIXED_STEPS, "obstacles": OBSTACLES, "episodes": episodes}
    for method in METHODS:
        timed = in_turns(_contestants(of_method(work, method), method, episodes))
        for name, times in timed.items():
            decisions = episodes[name] * FIXED_STEPS
            times["decisions_per_second"] = decisions / times["median"]
            times["compile_seconds"] = max(0.0, times["first"] - times["median"])
        found[method] = timed
    return found


def _contestants(
    work: Workload, method: str, episodes: dict[str, int]
) -> dict[str, Callable[[], Any]]:
    settings = Settings(method=method)
    assert work.valid.all()
    assert work.obstacles.shape[1] == OBSTACLES

    def scene(name: str, dtype: type) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        some = work.rows(slice(None, None, len(work) // episodes[name]))
        poses = np.concatenate([some.starts, np.zeros((len(some), 2))], axis=1)
        return poses.astype(dtype), some.obstacles.astype(dtype), some.goals.astype(dtype)

    def numba(name: str, dtype: type, closed_form: bool) -> Callable[[], Any]:
        return partial(
            dwa_numba.run, *scene(name, dtype), settings, FIXED_STEPS, closed_form=closed_form
        )

    return {
        OURS: partial(_sail, work),
        STEPWISE: numba(STEPWISE, np.float64, False),
        STEPWISE_32: numba(STEPWISE_32, np.float32, False),
        CLOSED: numba(CLOSED, np.float64, True),
        CLOSED_32: numba(CLOSED_32, np.float32, True),
        NUMPY: partial(dwa_numpy.run, *scene(NUMPY, np.float64), settings, FIXED_STEPS),
        PYTHON: partial(_in_python, scene(PYTHON, np.float64), settings),
    }


def _sail(work: Workload) -> None:
    steps = work.sail().steps
    if not (steps == FIXED_STEPS).all():
        raise RuntimeError(f"{(steps != FIXED_STEPS).sum()} episodes ended early")


def _in_python(scene: tuple[np.ndarray, ...], settings: Settings) -> None:
    for pose, obstacles, goal in zip(*(part.tolist() for part in scene), strict=True):
        dwa_python.run(tuple(pose), obstacles, goal, settings, FIXED_STEPS)


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    parts = [
        f"55 candidates x 30 steps x {found['obstacles']} obstacles, closed loop, "
        f"{found['episodes'][OURS]:,} episodes of {found['steps']} decisions each on Tan's "
        "lattice (Table 1 of the paper; maps on which a vessel collides sooner left out). usvjax "
        "is `navigate_dwa` as a user calls it, checks and transfers included, all cores; so is "
        "numba. The peers run fewer of the episodes, evenly spaced, all decisions of each. All "
        "lanes are busy here; what idle lanes cost on episodes of all lengths is in "
        "lane_occupancy and dwa_scaling. Compile seconds: the first call less the median; "
        "those of usvjax are in compile_time."
    ]
    for method in METHODS:
        ours = found[method][OURS]["decisions_per_second"]
        rows = [
            (
                name,
                found["episodes"][name],
                f"{times['decisions_per_second']:,.0f}",
                f"{ours / times['decisions_per_second']:,.1f}",
                "-" if name == OURS else f"{times['compile_seconds']:.1f}",
                spread(times["seconds"]),
            )
            for name, times in found[method].items()
        ]
        header = ("contestant", "episodes", "decisions/s", "usvjax is x", "compile s", "timings")
        parts.append(f"**{method}**\n\n" + table(header, rows))
    parts.append("\n".join(_verdicts(found)))
    return "\n\n".join(parts)


def _verdicts(found: dict[str, Any]) -> list[str]:
    lines = []
    for method in METHODS:
        rate = {name: times["decisions_per_second"] for name, times in found[method].items()}
        for name, bar in ((STEPWISE, 10), (CLOSED, 2)):
            ratio = rate[OURS] / rate[name]
            lines.append(verdict(f"{method}, at least {bar}x {name}: {ratio:.1f}x", ratio >= bar))
    return lines
