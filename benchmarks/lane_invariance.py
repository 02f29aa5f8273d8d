"""Whether an episode's result depends on what it shares the machine with."""

from typing import Any

import jax
import numpy as np

from benchmarks.markdown import table, verdict
from benchmarks.workloads import Workload, heavy_tailed, of_method
from usvjax.missions.dwa.run import NavigateResult

TITLE = "the same episode among other lanes, devices and episodes"
METHODS = ("traditional", "improved")
LANES = (64, 256, 1024)
FIELDS = ("status", "steps", "path_length", "min_clearance", "time", "mean_speed")


def measure(quick: bool) -> dict[str, Any]:
    """Compare every result bit for bit with that of the usual call."""
    episodes, alone = (100, 3) if quick else (10_000, 50)
    work = heavy_tailed(episodes)
    found: dict[str, Any] = {"episodes": episodes, "devices": jax.local_device_count()}
    for method in METHODS:
        found[method] = _compare(of_method(work, method), alone)
    return found


def _compare(work: Workload, alone: int) -> dict[str, dict[str, Any]]:
    usual = work.sail()
    found = {}
    for lanes in LANES:
        found[f"{lanes} lanes, all devices"] = _differences(work.sail(lanes), usual)
        with jax.default_device(jax.local_devices()[-1]):
            found[f"{lanes} lanes, one device"] = _differences(work.sail(lanes), usual)
    back = np.arange(len(work))[::-1]
    found["in reverse order"] = _differences(work.rows(back).sail(), usual, back)
    chosen = np.linspace(0, len(work) - 1, alone).astype(int)
    single = [_differences(work.rows(chosen[[i]]).sail(), usual, chosen[[i]]) for i in range(alone)]
    found["alone"] = {
        "episodes": alone,
        "differ": sum(one["differ"] for one in single),
        "most": max(one["most"] for one in single),
    }
    return found


def _differences(
    result: NavigateResult, usual: NavigateResult, rows: np.ndarray | None = None
) -> dict[str, Any]:
    """How many episodes differ in any bit, and by how much their length (m) at most."""
    rows = np.arange(len(usual.steps)) if rows is None else rows
    differ = np.zeros(len(rows), bool)
    for name in FIELDS:
        ours, theirs = getattr(result, name), getattr(usual, name)[rows]
        differ |= ours.view(np.int32) != theirs.view(np.int32)
    apart = np.abs(result.path_length - usual.path_length[rows]).max()
    return {"episodes": len(rows), "differ": int(differ.sum()), "most": float(apart)}


def report(found: dict[str, Any]) -> str:
    """Say it in Markdown."""
    rows, exact = [], True
    for how in found[METHODS[0]]:
        cells = []
        for method in METHODS:
            one = found[method][how]
            exact &= one["differ"] == 0
            cells.append(f"{one['differ']:,} of {one['episodes']:,} (at most {one['most']:g} m)")
        rows.append((how, *cells))
    return (
        f"Results of {found['episodes']:,} episodes of dwa_scaling that differ in any bit of "
        f"{', '.join(FIELDS)} from the usual call (256 lanes, {found['devices']} devices), and "
        "the largest difference in path length.\n\n"
        + table(("episodes run", *METHODS), rows)
        + "\n\n"
        + verdict("equal in every bit", exact)
    )
